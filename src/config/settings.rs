//! What a caller may set, with unit, range, default and source.

use super::order::Order;
use crate::error::{Error, positive, within};
use crate::limits;
use crate::memory::Budget;
use glam::Vec3;

/// How a body is kept from passing through others; of two, the greater is the dearer.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, PartialOrd, Ord, Hash)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize), serde(rename_all = "lowercase"))]
pub enum Continuous {
    /// Only where it stands: a fast body may pass through a thin one.
    Discrete,
    /// The segment it moves along within the step, whenever it outruns its margin.
    #[default]
    Segment,
    /// The whole volume it could reach within the step: dearer; finds second impacts behind a first obstacle
    /// and crowds of fast bodies.
    Volume,
}

impl Continuous {
    /// The mode a body, or a pair by the greater of its two, really has in a world with this setting.
    pub(crate) fn of(self, own: Continuous) -> Continuous {
        match (self, own) {
            (Continuous::Discrete, _) | (_, Continuous::Discrete) => Continuous::Discrete,
            (Continuous::Volume, _) => Continuous::Volume,
            (Continuous::Segment, own) => own,
        }
    }
}

/// By which method bodies that are not [`Continuous::Discrete`] are kept from passing through others. All but
/// the first are there to compare with; `docs/continuous.md` says how each works, what it costs and what it
/// misses.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize), serde(rename_all = "kebab-case"))]
pub enum ContinuousMethod {
    /// What the predicted path strikes becomes a manifold of potential points, found at the pose of first
    /// touch and solved with all others (Vincent Robert, GDC 2012), and the guard watches the centres.
    #[default]
    OnePass,
    /// Speculative contacts: whoever is nearer than the relative motion gets the planes of the start of the
    /// step, and is stopped by them whether or not it would have met the other (Paul Firth, *Speculative
    /// contacts*, 2011).
    Speculative,
    /// Discrete contacts, then each fast body is swept straight ahead, turned as at the end of the step. At
    /// the first hit the two stand at the time of impact, where the impact is resolved, and go on from there
    /// with their new velocities: at most 8 times a step, after which a body loses the rest of it (Erin
    /// Catto, *Continuous Collision*, GDC 2013; sweeps in PhysX and Jolt).
    LinearCast,
    /// The same with times of impact by conservative advancement over the whole motion, rotation included
    /// (Mirtich 1996; Zhang et al. 2006), tighter, and up to 64 times: slow, and the reference for the
    /// others.
    ConservativeAdvancement,
    /// The talk's method itself (Vincent Robert, GDC 2012): speculative contacts behind two gates. Planes of
    /// the start of the step stop only whoever crosses them over the face that they are of, and the plane is
    /// that of the axis which is entered last. No cast, no guard.
    Talk,
}

impl ContinuousMethod {
    /// Whether impacts are met one by one, each at its time.
    pub(crate) fn meets_impacts(self) -> bool {
        matches!(self, ContinuousMethod::LinearCast | ContinuousMethod::ConservativeAdvancement)
    }
}

/// The modes that the stages of a step work with.
#[derive(Clone, Copy, Debug)]
pub(crate) struct StageModes {
    pub(crate) broad: Continuous,
    pub(crate) narrow: Continuous,
    pub(crate) finish: Continuous,
}

/// What becomes of the manifold that a pair which is apart, and may close its gap within the step, has at the
/// start of it.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Start {
    /// It is replaced by that of the first touch, which is searched for along the predicted motion.
    Cast,
    /// It stays: its planes stop whoever could reach them, and nothing that is missed is dropped.
    Speculative,
    /// It stays as far as the predicted motion crosses it over the faces that it is of
    /// (`narrow_phase/gates.rs`).
    Gated,
}

/// How friction of two directions is bounded.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize), serde(rename_all = "lowercase"))]
pub enum FrictionCone {
    /// Coulomb's circular cone: the same friction in every direction.
    #[default]
    Cone,
    /// A box per axis: cheaper, up to sqrt 2 too strong along its diagonal.
    Box,
}

/// Where friction acts.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize), serde(rename_all = "lowercase"))]
pub enum FrictionModel {
    /// Once per manifold, at its centre, with a row against twist: two and a third of the rows per point.
    #[default]
    Patch,
    /// At every contact point.
    Point,
}

/// Settings of a world. Change them between steps with [`World::set_settings`](crate::World::set_settings).
#[derive(Clone, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize), serde(default))]
pub struct Settings {
    /// Gravity [m/s²], within [`limits::MAX_ACCELERATION`] along each axis. Default (0, -9.81, 0).
    pub gravity: Vec3,
    /// Substeps of the solver in a step, 1..=64. Default 4. With 1 substep and several iterations the solver
    /// is plain sequential impulses; with several substeps and 1 iteration it is soft substepping (Macklin et
    /// al., *Small Steps in Physics Simulation*, 2019).
    pub substeps: u32,
    /// Gauss-Seidel iterations in each substep, 1..=256. Default 1.
    pub iterations: u32,
    /// Threads that a step may use, at least 1: the caller's own, and others of its rayon pool if they have
    /// nothing else to do; a busy pool is not waited for. Default 1.
    pub threads: usize,
    /// The mode that [`Continuous::Segment`] bodies really use; `Discrete` switches continuous collision off
    /// for the whole world, `Volume` raises all that are not `Discrete`. Default `Segment`: each body's own
    /// mode.
    pub continuous: Continuous,
    /// How bodies that are not `Discrete` are kept from passing through others. Default
    /// [`ContinuousMethod::OnePass`].
    pub method: ContinuousMethod,
    /// Cone or box. Default cone.
    pub friction_cone: FrictionCone,
    /// Per patch or per point. Default patch.
    pub friction_model: FrictionModel,
    /// Length of a typical body [m], 1e-6..=1e6; scales the lengths below. Default 1.
    pub length_unit: f32,
    /// Approach speed below which a contact does not bounce [m/s]. Default 0.3, above what gravity gives a
    /// resting body within a step of 1/30 s.
    pub restitution_threshold: f32,
    /// Overlap that is left alone of what slides, rolls or has just met, and a tenth of the gap over which
    /// springs of what rests act at most [length units]. Default 0.0005.
    pub slop: f32,
    /// Contact stiffness [Hz], capped at what the substeps can keep calm: 0.15 of their rate with one
    /// iteration, growing with the root of the iterations. Default 120.
    pub contact_hertz: f32,
    /// Contact damping ratio. Default 10 (Catto, Box2D v3).
    pub contact_damping: f32,
    /// The fastest that the overlap of two bodies is pushed apart [m/s per length unit]. Where many overlap
    /// each other, what that gives any of them ends at five times as much. Default 3.
    pub push_speed: f32,
    /// Whether old impulses are applied first. Default true.
    pub warm_starting: bool,
    /// Whether contacts of pairs that hardly moved are kept without a new narrow phase. Default true.
    pub recycling: bool,
    /// Whether joints that make trees are solved exactly, as a block. Otherwise all joints are solved row by
    /// row, which is cheaper and lets chains stretch under load; it is there to compare with
    /// (`docs/joints.md`). Default true.
    pub joint_trees: bool,
    /// Whether the paths of continuous bodies are looked at once more after the solver, and cut where a
    /// centre would get through something all the same (`docs/decisions/guard.md`). Without it bodies are
    /// stopped by contacts alone; it is there to measure what these achieve. Default true.
    pub guard: bool,
    /// In which order groups of rows are solved: what comes last is obeyed best. Default: joints before
    /// contacts, static geometry last.
    pub order: Order,
    /// Whether bodies at rest fall asleep, in islands that hang together; until something wakes them they
    /// take no time. Default false.
    pub sleeping: bool,
    /// A body counts as at rest while neither its centre nor, by its rotation alone, any point of it is
    /// faster [m/s per length unit]. Default 0.05.
    pub sleep_speed: f32,
    /// How long all bodies of an island must be at rest before it falls asleep [s]. Default 0.5.
    pub sleep_time: f32,
    /// Contacts that come together at least so fast are heard of as hits [m/s per length unit]. Default 1.
    pub hit_speed: f32,
    /// Most events of each sort that a step keeps; what is beyond is counted in
    /// [`StepReport::events_lost`](crate::StepReport::events_lost). Default 4096.
    pub event_capacity: u32,
    /// Bytes that the world may reserve, in all and of each category. What is added beyond is refused, and a
    /// step leaves out the contacts that don't fit ([`StepReport::shed`](crate::StepReport::shed)). Default:
    /// no limit.
    pub budget: Budget,
}

impl Default for Settings {
    fn default() -> Self {
        Settings {
            gravity: Vec3::new(0.0, -9.81, 0.0),
            substeps: 4,
            iterations: 1,
            threads: 1,
            continuous: Continuous::Segment,
            method: ContinuousMethod::OnePass,
            friction_cone: FrictionCone::Cone,
            friction_model: FrictionModel::Patch,
            length_unit: 1.0,
            restitution_threshold: 0.3,
            slop: 0.0005,
            contact_hertz: 120.0,
            contact_damping: 10.0,
            push_speed: 3.0,
            warm_starting: true,
            recycling: true,
            joint_trees: true,
            guard: true,
            order: Order::default(),
            sleeping: false,
            sleep_speed: 0.05,
            sleep_time: 0.5,
            hit_speed: 1.0,
            event_capacity: 4096,
            budget: Budget::NONE,
        }
    }
}

impl Settings {
    /// What the stages do of continuous collision.
    pub(crate) fn stage_modes(&self) -> StageModes {
        let (own, off) = (self.continuous, Continuous::Discrete);
        match self.method {
            ContinuousMethod::OnePass => StageModes { broad: own, narrow: own, finish: own },
            // What an impact throws off its way is nobody's business.
            ContinuousMethod::Talk => StageModes { broad: own, narrow: own, finish: off },
            ContinuousMethod::Speculative => {
                let all = if own == off { off } else { Continuous::Volume };
                StageModes { broad: all, narrow: all, finish: off }
            }
            // The contacts are discrete ones; what is fast is swept all the same, to know who may be struck.
            ContinuousMethod::LinearCast | ContinuousMethod::ConservativeAdvancement => {
                StageModes { broad: own, narrow: off, finish: off }
            }
        }
    }

    /// What the narrow phase does with manifolds of the start of a step.
    pub(crate) fn start(&self) -> Start {
        match self.method {
            ContinuousMethod::Speculative => Start::Speculative,
            ContinuousMethod::Talk => Start::Gated,
            _ => Start::Cast,
        }
    }

    /// Checks every range.
    ///
    /// # Errors
    /// Names the first setting that is out of range.
    pub fn validate(&self) -> Result<(), Error> {
        limits::acceleration("gravity", self.gravity)?;
        within("substeps", self.substeps as f32, 1.0, 64.0, "in 1..=64")?;
        within("iterations", self.iterations as f32, 1.0, 256.0, "in 1..=256")?;
        within("threads", self.threads as f32, 1.0, 1024.0, "in 1..=1024")?;
        limits::length("length_unit", self.length_unit)?;
        within("restitution_threshold", self.restitution_threshold, 0.0, limits::MAX_SPEED, "in 0..=1e6")?;
        within("slop", self.slop, 0.0, 1.0, "in 0..=1")?;
        for (what, value) in [
            ("contact_hertz", self.contact_hertz),
            ("contact_damping", self.contact_damping),
            ("push_speed", self.push_speed),
        ] {
            positive(what, value)?;
            within(what, value, 1e-6, 1e6, "in 1e-6..=1e6")?;
        }
        within("hit_speed", self.hit_speed, 0.0, f32::MAX, "at least zero")?;
        within("sleep_speed", self.sleep_speed, 0.0, f32::MAX, "at least zero")?;
        within("sleep_time", self.sleep_time, 0.0, f32::MAX, "at least zero")?;
        if !self.order.is_complete() {
            return Err(Error::Incomplete { what: "the order of rows", expected: "each group once" });
        }
        Ok(())
    }
}
