//! Settings, with unit, range, default and source.

use super::fields;
use super::order::Order;
use crate::error::Error;
use crate::limits;
use crate::memory::Budget;
use glam::Vec3;

/// How a body is kept from passing through others. The modes are in the order of their cost.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, PartialOrd, Ord, Hash)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize), serde(rename_all = "lowercase"))]
#[non_exhaustive]
pub enum ContinuousMode {
    /// Collides at its current pose only: a fast body may pass through a thin one.
    Discrete,
    /// Collides along the segment of its motion within the step, whenever it leaves its margin.
    #[default]
    Segment,
    /// Collides in the whole volume that it could reach within the step: more expensive; finds second impacts
    /// behind a first obstacle and crowds of fast bodies.
    Volume,
}

impl ContinuousMode {
    /// The mode that a body, or a pair by the greater of its two, has in a world with this setting.
    pub fn of(self, own: ContinuousMode) -> ContinuousMode {
        match (self, own) {
            (ContinuousMode::Discrete, _) | (_, ContinuousMode::Discrete) => ContinuousMode::Discrete,
            (ContinuousMode::Volume, _) => ContinuousMode::Volume,
            (ContinuousMode::Segment, own) => own,
        }
    }
}

/// Method that keeps bodies which are not [`ContinuousMode::Discrete`] from passing through others. All but
/// the first exist for comparison, and all but the first two only in builds with the feature `methods`;
/// `docs/continuous.md` says how each works, its cost and what it misses.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize), serde(rename_all = "kebab-case"))]
#[non_exhaustive]
pub enum ContinuousMethod {
    /// Obstacles on the predicted path become manifolds of potential points, found at the pose of first touch
    /// and solved with all others (Vincent Robert, GDC 2012), and the guard checks the centres.
    #[default]
    OnePass,
    /// Speculative contacts: pairs that are nearer than their relative motion get the planes of the start of
    /// the step, and are stopped by them whether or not they would have met (Paul Firth, *Speculative
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
    /// The method of the talk (Vincent Robert, GDC 2012): speculative contacts behind two gates. Planes of
    /// the start of the step stop only bodies that cross them within the face to which they belong, and the
    /// plane is that of the axis which is entered last. No cast, no guard.
    Talk,
}

impl ContinuousMethod {
    /// Whether this build has the methods that exist for comparison only and have code of their own. Where it
    /// has not, settings that choose one are refused, and no step carries their code.
    pub(crate) const COMPARED: bool = cfg!(any(test, feature = "methods"));

    /// Whether impacts are solved one by one, each at its time.
    pub(crate) fn meets_impacts(self) -> bool {
        matches!(self, ContinuousMethod::LinearCast | ContinuousMethod::ConservativeAdvancement)
    }

    /// Whether this build has it.
    fn is_there(self) -> bool {
        use ContinuousMethod::{OnePass, Speculative};
        ContinuousMethod::COMPARED || matches!(self, OnePass | Speculative)
    }

    /// Whether bodies that leave their paths are settled.
    pub(crate) fn settles(self) -> bool {
        self == ContinuousMethod::OnePass
    }
}

/// The modes that the stages of a step use.
#[derive(Clone, Copy, Debug)]
pub(crate) struct StageModes {
    pub(crate) broad: ContinuousMode,
    pub(crate) narrow: ContinuousMode,
    pub(crate) finish: ContinuousMode,
}

/// Treatment of the manifold at the start of the step of a separate pair that may close its gap within the
/// step.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Start {
    /// It is replaced by that of the first touch, which is searched for along the predicted motion.
    Cast,
    /// It stays: its planes stop all bodies that could reach them, and no miss is dropped.
    Speculative,
    /// It stays if the predicted motion crosses it within its faces (`narrow_phase/cast/gates.rs`).
    Gated,
}

impl Start {
    /// Known while compiling where no method has gates.
    pub(crate) fn is_gated(self) -> bool {
        ContinuousMethod::COMPARED && self == Start::Gated
    }
}

/// Bound on friction in two directions.
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

fields! {
    /// Settings of a world. Change them between steps with
    /// [`World::set_settings`](crate::World::set_settings).
    ///
    /// ```
    /// # use backstop::{*, glam::{DVec3, Quat, Vec3}};
    /// let settings = Settings::default().with_substeps(8).with_sleeping(true).with_threads(2);
    /// assert!(settings.validate().is_ok());
    /// let world = World::new(settings)?;
    /// # Ok::<(), Error>(())
    /// ```
    #[derive(Clone, Debug, PartialEq)]
    #[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize), serde(default))]
    #[non_exhaustive]
    pub struct Settings {
        /// Gravity [m/s²].
        with_gravity(gravity: Vec3, into) = Vec3::new(0.0, -9.81, 0.0),
            "gravity" [-limits::MAX_ACCELERATION, limits::MAX_ACCELERATION] "within 1e6 along each axis";
        /// Substeps of the solver in a step. With 1 substep and several iterations the solver is plain
        /// sequential impulses; with several substeps and 1 iteration it is soft substepping (Macklin et al.,
        /// *Small Steps in Physics Simulation*, 2019).
        with_substeps(substeps: u32) = 4, "substeps" [1.0, 64.0] "in 1..=64";
        /// Gauss-Seidel iterations in each substep.
        with_iterations(iterations: u32) = 1, "iterations" [1.0, 256.0] "in 1..=256";
        /// Threads that a step may use: the caller's own, and others of its rayon pool if they have nothing
        /// else to do; a busy pool is not waited for.
        with_threads(threads: usize) = 1, "threads" [1.0, 1024.0] "in 1..=1024";
        /// The mode of [`ContinuousMode::Segment`] bodies; `Discrete` switches continuous collision off for
        /// the whole world, `Volume` raises all that are not `Discrete`, and `Segment` leaves each body
        /// its own mode.
        with_continuous(continuous: ContinuousMode) = ContinuousMode::Segment;
        /// How bodies that are not `Discrete` are kept from passing through others.
        with_continuous_method(continuous_method: ContinuousMethod) = ContinuousMethod::OnePass;
        /// Cone or box.
        with_friction_cone(friction_cone: FrictionCone) = FrictionCone::Cone;
        /// Per patch or per point.
        with_friction_model(friction_model: FrictionModel) = FrictionModel::Patch;
        /// Length of a typical body [m]; scales the lengths below.
        with_length_unit(length_unit: f32) = 1.0,
            "length_unit" [limits::MIN_LENGTH, limits::MAX_LENGTH] "in 1e-6..=1e6 m";
        /// Approach speed below which a contact does not bounce [m/s]: by default more than gravity gives a
        /// resting body within a step of 1/30 s.
        with_restitution_threshold(restitution_threshold: f32) = 0.3,
            "restitution_threshold" [0.0, limits::MAX_SPEED] "in 0..=1e6";
        /// Overlap that sliding, rolling and new contacts keep, and a tenth of the maximum gap at which the
        /// springs of resting contacts act [length units].
        with_slop(slop: f32) = 0.0005, "slop" [0.0, 1.0] "in 0..=1";
        /// Contact stiffness where both materials are rigid (see
        /// [`Material::contact_hertz`](crate::Material::contact_hertz)) [Hz], limited to the stable maximum:
        /// 0.15 of the rate of substeps with one iteration, growing with the root of the number of
        /// iterations.
        with_contact_hertz(contact_hertz: f32) = 120.0, "contact_hertz" [1e-6, 1e6] "in 1e-6..=1e6";
        /// Contact damping ratio (by default that of Catto, Box2D v3).
        with_contact_damping(contact_damping: f32) = 10.0, "contact_damping" [1e-6, 1e6] "in 1e-6..=1e6";
        /// Maximum speed at which overlap is pushed apart [m/s per length unit]. Where many bodies overlap
        /// each other, they add up to at most five times as much.
        with_push_speed(push_speed: f32) = 3.0, "push_speed" [1e-6, 1e6] "in 1e-6..=1e6";
        /// Whether the solver starts with the impulses of the previous step.
        with_warm_starting(warm_starting: bool) = true;
        /// Whether contacts of pairs that hardly moved are kept without a new narrow phase.
        with_recycling(recycling: bool) = true;
        /// Whether joints that form trees are solved exactly, as a block. Otherwise all joints are solved row
        /// by row, which is cheaper and lets chains stretch under load; it exists for comparison
        /// (`docs/joints.md`).
        with_joint_trees(joint_trees: bool) = true;
        /// Whether the paths of continuous bodies are checked after the solver, and cut where a centre would
        /// still pass through something (`docs/decisions/guard.md`). Without it bodies are stopped by
        /// contacts alone; this exists to measure how well.
        with_guard(guard: bool) = true;
        /// The order in which groups of rows are solved: the last is obeyed best. By default joints come
        /// before contacts, and static geometry last.
        with_order(order: Order) = Order::default();
        /// Whether bodies at rest fall asleep, in islands of connected bodies; until something wakes them
        /// they take no time.
        with_sleeping(sleeping: bool) = false;
        /// A body counts as at rest while neither its centre nor, by its rotation alone, any point of it is
        /// faster [m/s per length unit].
        with_sleep_speed(sleep_speed: f32) = 0.05, "sleep_speed" [0.0, f32::MAX] "at least zero";
        /// How long all bodies of an island must be at rest before it falls asleep [s].
        with_sleep_time(sleep_time: f32) = 0.5, "sleep_time" [0.0, f32::MAX] "at least zero";
        /// Contacts with at least this approach speed are reported as hits [m/s per length unit].
        with_hit_speed(hit_speed: f32) = 1.0, "hit_speed" [0.0, f32::MAX] "at least zero";
        /// Maximum number of events of each kind in a step; those beyond are counted in
        /// [`StepReport::events_lost`](crate::StepReport::events_lost).
        with_event_capacity(event_capacity: u32) = 4096;
        /// Bytes that the world may reserve, in total and in each category. Additions beyond it are refused,
        /// and a step leaves out the contacts that don't fit ([`StepReport::shed`](crate::StepReport::shed)).
        with_budget(budget: Budget) = Budget::NONE;
    }
}

impl Settings {
    /// The parts of continuous collision that the stages do.
    pub(crate) fn stage_modes(&self) -> StageModes {
        let (own, off) = (self.continuous, ContinuousMode::Discrete);
        match self.continuous_method {
            ContinuousMethod::OnePass => StageModes { broad: own, narrow: own, finish: own },
            // Bodies that an impact pushes off their path are not checked.
            ContinuousMethod::Talk => StageModes { broad: own, narrow: own, finish: off },
            ContinuousMethod::Speculative => {
                let all = if own == off { off } else { ContinuousMode::Volume };
                StageModes { broad: all, narrow: all, finish: off }
            }
            // Contacts are discrete; fast bodies are swept all the same, to find bodies that they may strike.
            ContinuousMethod::LinearCast | ContinuousMethod::ConservativeAdvancement => {
                StageModes { broad: own, narrow: off, finish: off }
            }
        }
    }

    /// Treatment of manifolds of the start of a step in the narrow phase.
    pub(crate) fn start(&self) -> Start {
        match self.continuous_method {
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
        self.check_ranges()?;
        if !self.continuous_method.is_there() {
            return Err(Error::Incomplete {
                what: "a build with this method",
                expected: "the feature `methods`",
            });
        }
        if !self.order.is_complete() {
            return Err(Error::Incomplete { what: "the order of rows", expected: "each group once" });
        }
        Ok(())
    }
}
