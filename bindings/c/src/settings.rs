//! Settings of a world.

use crate::abi::sized::described;
use crate::abi::status::Outcome;
use crate::abi::values::{BsBool, BsVec3, codes};
use backstop::{
    Budget, Category, Continuous, ContinuousMethod, FrictionCone, FrictionModel, Order, RowGroup, Settings,
};

/// How a body is kept from passing through others, one of `BS_CONTINUOUS_...`.
pub type BsContinuous = u32;
/// Collides at its current pose only: a fast body may pass through a thin one.
pub const BS_CONTINUOUS_DISCRETE: BsContinuous = 0;
/// Collides along the segment of its motion within the step, whenever it leaves its margin.
pub const BS_CONTINUOUS_SEGMENT: BsContinuous = 1;
/// Collides in the whole volume that it could reach within the step: more expensive; finds second impacts
/// behind a first obstacle and crowds of fast bodies.
pub const BS_CONTINUOUS_VOLUME: BsContinuous = 2;

codes! { "mode of continuous collision", read_continuous, write_continuous, Continuous {
    BS_CONTINUOUS_DISCRETE = Continuous::Discrete,
    BS_CONTINUOUS_SEGMENT = Continuous::Segment,
    BS_CONTINUOUS_VOLUME = Continuous::Volume,
} }

/// How continuous collision is done, one of `BS_METHOD_...`.
pub type BsMethod = u32;
/// In one pass with all other contacts, at the pose of first touch.
pub const BS_METHOD_ONE_PASS: BsMethod = 0;
/// Speculative contacts.
pub const BS_METHOD_SPECULATIVE: BsMethod = 1;
/// Sweeps after discrete contacts, straight ahead.
/// Only in builds with the feature `methods`.
pub const BS_METHOD_LINEAR_CAST: BsMethod = 2;
/// The same with rotation, by conservative advancement.
/// Only in builds with the feature `methods`.
pub const BS_METHOD_CONSERVATIVE_ADVANCEMENT: BsMethod = 3;
/// Speculative contacts behind two gates (Vincent Robert, GDC 2012).
/// Only in builds with the feature `methods`.
pub const BS_METHOD_TALK: BsMethod = 4;

codes! { "method of continuous collision", read_method, write_method, ContinuousMethod {
    BS_METHOD_ONE_PASS = ContinuousMethod::OnePass,
    BS_METHOD_SPECULATIVE = ContinuousMethod::Speculative,
    BS_METHOD_LINEAR_CAST = ContinuousMethod::LinearCast,
    BS_METHOD_CONSERVATIVE_ADVANCEMENT = ContinuousMethod::ConservativeAdvancement,
    BS_METHOD_TALK = ContinuousMethod::Talk,
} }

/// Shape of the friction cone, one of `BS_FRICTION_CONE` and `BS_FRICTION_BOX`.
pub type BsFrictionCone = u32;
/// Coulomb's circular cone: the same friction in every direction.
pub const BS_FRICTION_CONE: BsFrictionCone = 0;
/// A box per axis: cheaper, up to sqrt 2 too strong along its diagonal.
pub const BS_FRICTION_BOX: BsFrictionCone = 1;

codes! { "friction cone", read_cone, write_cone, FrictionCone {
    BS_FRICTION_CONE = FrictionCone::Cone,
    BS_FRICTION_BOX = FrictionCone::Box,
} }

/// Where friction acts, one of `BS_FRICTION_PER_...`.
pub type BsFrictionModel = u32;
/// Once per manifold, at its centre, with a row against twist.
pub const BS_FRICTION_PER_PATCH: BsFrictionModel = 0;
/// At every contact point.
pub const BS_FRICTION_PER_POINT: BsFrictionModel = 1;

codes! { "friction model", read_friction, write_friction, FrictionModel {
    BS_FRICTION_PER_PATCH = FrictionModel::Patch,
    BS_FRICTION_PER_POINT = FrictionModel::Point,
} }

/// A group of rows of the solver, one of `BS_ROWS_...`.
pub type BsRowGroup = u32;
/// No group: the rows stay in their own place.
pub const BS_ROWS_NONE: BsRowGroup = 0;
/// Springs, drives, motors and friction of joints.
pub const BS_ROWS_SOFT_JOINTS: BsRowGroup = 1;
/// Limits of joints.
pub const BS_ROWS_JOINT_LIMITS: BsRowGroup = 2;
/// Locked directions of joints.
pub const BS_ROWS_JOINTS: BsRowGroup = 3;
/// Contacts between two dynamic bodies.
pub const BS_ROWS_CONTACTS: BsRowGroup = 4;
/// Potential contacts between two dynamic bodies.
pub const BS_ROWS_POTENTIAL_CONTACTS: BsRowGroup = 5;
/// Contacts with static geometry.
pub const BS_ROWS_STATIC_CONTACTS: BsRowGroup = 6;
/// Potential contacts with static geometry.
pub const BS_ROWS_POTENTIAL_STATIC_CONTACTS: BsRowGroup = 7;

codes! { "group of rows", read_group, write_group, RowGroup {
    BS_ROWS_SOFT_JOINTS = RowGroup::SoftJoints,
    BS_ROWS_JOINT_LIMITS = RowGroup::JointLimits,
    BS_ROWS_JOINTS = RowGroup::Joints,
    BS_ROWS_CONTACTS = RowGroup::Contacts,
    BS_ROWS_POTENTIAL_CONTACTS = RowGroup::PotentialContacts,
    BS_ROWS_STATIC_CONTACTS = RowGroup::StaticContacts,
    BS_ROWS_POTENTIAL_STATIC_CONTACTS = RowGroup::PotentialStaticContacts,
} }

/// The group after which rows are solved, if any.
pub(crate) fn read_place(group: BsRowGroup) -> Outcome<Option<RowGroup>> {
    if group == BS_ROWS_NONE { Ok(None) } else { read_group(group).map(Some) }
}

pub(crate) fn write_place(group: Option<RowGroup>) -> BsRowGroup {
    group.map_or(BS_ROWS_NONE, write_group)
}

/// No limit of bytes.
pub const BS_NO_LIMIT: u64 = u64::MAX;
/// Places for categories in budgets and reports; more than there are, so that new ones find theirs.
pub const BS_CATEGORIES: usize = 16;

/// Settings of a world: gravity, solver, continuous collision, sleep, events, memory.
#[repr(C)]
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct BsSettings {
    /// Size of this struct; `bs_settings_default` fills it in.
    pub size: u32,
    /// Gravity [m/s²]. Default (0, -9.81, 0).
    pub gravity: BsVec3,
    /// Substeps of the solver in a step, 1..=64. Default 4.
    pub substeps: u32,
    /// Iterations in each substep, 1..=256. Default 1.
    pub iterations: u32,
    /// Threads that a step may use, at least 1: the caller's, and those of a pool that the process shares,
    /// with a thread for each processor (or RAYON_NUM_THREADS). The result never depends on it. Default 1.
    pub threads: u32,
    /// The actual mode of bodies with the mode segment. Default `BS_CONTINUOUS_SEGMENT`.
    pub continuous: BsContinuous,
    /// Default `BS_METHOD_ONE_PASS`.
    pub method: BsMethod,
    /// Default `BS_FRICTION_CONE`.
    pub friction_cone: BsFrictionCone,
    /// Default `BS_FRICTION_PER_PATCH`.
    pub friction_model: BsFrictionModel,
    /// Length of a typical body [m], 1e-6..=1e6; scales the lengths below. Default 1.
    pub length_unit: f32,
    /// Approach speed below which a contact does not bounce [m/s]. Default 0.3.
    pub restitution_threshold: f32,
    /// Overlap that contacts keep [length units]. Default 0.0005.
    pub slop: f32,
    /// Contact stiffness [Hz]. Default 120.
    pub contact_hertz: f32,
    /// Contact damping ratio. Default 10.
    pub contact_damping: f32,
    /// Maximum speed at which overlap is pushed apart [m/s per length unit]. Default 3.
    pub push_speed: f32,
    /// Whether the solver starts with the impulses of the previous step. Default yes.
    pub warm_starting: BsBool,
    /// Whether contacts of pairs that hardly moved are kept. Default yes.
    pub recycling: BsBool,
    /// Whether joints that form trees are solved exactly. Default yes.
    pub joint_trees: BsBool,
    /// Whether paths of continuous bodies are checked after the solver. Default yes.
    pub guard: BsBool,
    /// Whether bodies at rest fall asleep. Default no.
    pub sleeping: BsBool,
    /// Zero.
    pub reserved: [u8; 7],
    /// Speed below which a body counts as at rest [m/s per length unit]. Default 0.05.
    pub sleep_speed: f32,
    /// How long an island must be at rest before it falls asleep [s]. Default 0.5.
    pub sleep_time: f32,
    /// Contacts with at least this approach speed are reported as hits [m/s per length unit]. Default 1.
    pub hit_speed: f32,
    /// Maximum number of events of each kind in a step. Default 4096.
    pub event_capacity: u32,
    /// The order in which groups of rows are solved, each of the seven once: the last is obeyed best. The
    /// eighth place is not used.
    pub order: [BsRowGroup; 8],
    /// Bytes that the world may reserve in all. Additions beyond it are refused with `BS_ERROR_BUDGET`, and a
    /// step leaves out the contacts that don't fit. Default `BS_NO_LIMIT`.
    pub budget: u64,
    /// The same for each category, by `BS_CATEGORY_...`. Default `BS_NO_LIMIT`.
    pub budget_of: [u64; BS_CATEGORIES],
}

described! { BsSettings, BsSettings::of_engine(&Settings::default()), [
    size, gravity, substeps, iterations, threads, continuous, method, friction_cone, friction_model,
    length_unit, restitution_threshold, slop, contact_hertz, contact_damping, push_speed, warm_starting,
    recycling, joint_trees, guard, sleeping, reserved, sleep_speed, sleep_time, hit_speed, event_capacity,
    order, budget, budget_of,
] }

/// The settings that a world has if nobody says anything else.
#[unsafe(no_mangle)]
pub extern "C" fn bs_settings_default() -> BsSettings {
    BsSettings::of_engine(&Settings::default())
}

impl BsSettings {
    pub(crate) fn to_engine(self) -> Outcome<Settings> {
        let settings = Settings::default()
            .with_gravity(backstop::glam::Vec3::from(self.gravity))
            .with_substeps(self.substeps)
            .with_iterations(self.iterations)
            .with_threads(self.threads as usize)
            .with_continuous(read_continuous(self.continuous)?)
            .with_method(read_method(self.method)?)
            .with_friction_cone(read_cone(self.friction_cone)?)
            .with_friction_model(read_friction(self.friction_model)?)
            .with_length_unit(self.length_unit)
            .with_restitution_threshold(self.restitution_threshold)
            .with_slop(self.slop)
            .with_contact_hertz(self.contact_hertz)
            .with_contact_damping(self.contact_damping)
            .with_push_speed(self.push_speed)
            .with_warm_starting(self.warm_starting != 0)
            .with_recycling(self.recycling != 0)
            .with_joint_trees(self.joint_trees != 0)
            .with_guard(self.guard != 0)
            .with_order(self.order()?)
            .with_sleeping(self.sleeping != 0)
            .with_sleep_speed(self.sleep_speed)
            .with_sleep_time(self.sleep_time)
            .with_hit_speed(self.hit_speed)
            .with_event_capacity(self.event_capacity)
            .with_budget(self.budget());
        Ok(settings)
    }

    fn order(&self) -> Outcome<Order> {
        let mut order = Order::default();
        for (group, &code) in order.0.iter_mut().zip(&self.order) {
            *group = read_group(code)?;
        }
        Ok(order)
    }

    fn budget(&self) -> Budget {
        let bytes = |limit: u64| usize::try_from(limit).unwrap_or(usize::MAX);
        let whole = if self.budget == BS_NO_LIMIT { Budget::NONE } else { Budget::total(bytes(self.budget)) };
        let limited =
            Category::ALL.into_iter().zip(self.budget_of).filter(|(_, limit)| *limit != BS_NO_LIMIT);
        limited.fold(whole, |budget, (category, limit)| budget.with(category, bytes(limit)))
    }

    pub(crate) fn of_engine(settings: &Settings) -> BsSettings {
        let limit = |bytes: Option<usize>| bytes.map_or(BS_NO_LIMIT, |bytes| bytes as u64);
        let mut order = [BS_ROWS_NONE; 8];
        order.iter_mut().zip(settings.order.0).for_each(|(code, group)| *code = write_group(group));
        let mut budget_of = [BS_NO_LIMIT; BS_CATEGORIES];
        for (bytes, category) in budget_of.iter_mut().zip(Category::ALL) {
            *bytes = limit(settings.budget.limit_of(category));
        }
        BsSettings {
            size: size_of::<BsSettings>() as u32,
            gravity: settings.gravity.into(),
            substeps: settings.substeps,
            iterations: settings.iterations,
            threads: u32::try_from(settings.threads).unwrap_or(u32::MAX),
            continuous: write_continuous(settings.continuous),
            method: write_method(settings.method),
            friction_cone: write_cone(settings.friction_cone),
            friction_model: write_friction(settings.friction_model),
            length_unit: settings.length_unit,
            restitution_threshold: settings.restitution_threshold,
            slop: settings.slop,
            contact_hertz: settings.contact_hertz,
            contact_damping: settings.contact_damping,
            push_speed: settings.push_speed,
            warm_starting: settings.warm_starting.into(),
            recycling: settings.recycling.into(),
            joint_trees: settings.joint_trees.into(),
            guard: settings.guard.into(),
            sleeping: settings.sleeping.into(),
            reserved: [0; 7],
            sleep_speed: settings.sleep_speed,
            sleep_time: settings.sleep_time,
            hit_speed: settings.hit_speed,
            event_capacity: settings.event_capacity,
            order,
            budget: limit(settings.budget.limit()),
            budget_of,
        }
    }
}
