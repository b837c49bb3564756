//! Settings of a world.

use crate::abi::status::Outcome;
use crate::abi::twin::{Twin, codes, record};
use crate::abi::values::{BsBool, BsVec3};
use backstop::{
    Budget, Category, ContinuousMethod, ContinuousMode, FrictionCone, FrictionModel, Order, RowGroup,
    Settings,
};

/// How a body is kept from passing through others, one of `BS_CONTINUOUS_...`.
pub type BsContinuousMode = u32;
/// Collides at its current pose only: a fast body may pass through a thin one.
pub const BS_CONTINUOUS_DISCRETE: BsContinuousMode = 0;
/// Collides along the segment of its motion within the step, whenever it leaves its margin.
pub const BS_CONTINUOUS_SEGMENT: BsContinuousMode = 1;
/// Collides in the whole volume that it could reach within the step: more expensive; finds second impacts
/// behind a first obstacle and crowds of fast bodies.
pub const BS_CONTINUOUS_VOLUME: BsContinuousMode = 2;

codes! { "mode of continuous collision", ContinuousMode {
    BS_CONTINUOUS_DISCRETE = ContinuousMode::Discrete,
    BS_CONTINUOUS_SEGMENT = ContinuousMode::Segment,
    BS_CONTINUOUS_VOLUME = ContinuousMode::Volume,
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

codes! { "method of continuous collision", ContinuousMethod {
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

codes! { "friction cone", FrictionCone {
    BS_FRICTION_CONE = FrictionCone::Cone,
    BS_FRICTION_BOX = FrictionCone::Box,
} }

/// Where friction acts, one of `BS_FRICTION_PER_...`.
pub type BsFrictionModel = u32;
/// Once per manifold, at its centre, with a row against twist.
pub const BS_FRICTION_PER_PATCH: BsFrictionModel = 0;
/// At every contact point.
pub const BS_FRICTION_PER_POINT: BsFrictionModel = 1;

codes! { "friction model", FrictionModel {
    BS_FRICTION_PER_PATCH = FrictionModel::Patch,
    BS_FRICTION_PER_POINT = FrictionModel::Point,
} }

/// A group of rows of the solver, one of `BS_ROWS_...`.
pub type BsRowGroup = u32;
/// No group: the rows stay in their own place.
pub const BS_ROWS_NONE: BsRowGroup = 0;
/// Springs, motors and friction of joints.
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

codes! { "group of rows", RowGroup {
    BS_ROWS_SOFT_JOINTS = RowGroup::SoftJoints,
    BS_ROWS_JOINT_LIMITS = RowGroup::JointLimits,
    BS_ROWS_JOINTS = RowGroup::Joints,
    BS_ROWS_CONTACTS = RowGroup::Contacts,
    BS_ROWS_POTENTIAL_CONTACTS = RowGroup::PotentialContacts,
    BS_ROWS_STATIC_CONTACTS = RowGroup::StaticContacts,
    BS_ROWS_POTENTIAL_STATIC_CONTACTS = RowGroup::PotentialStaticContacts,
} }

/// The group after which rows are solved, if any.
impl Twin<Option<RowGroup>> for BsRowGroup {
    fn read(self) -> Outcome<Option<RowGroup>> {
        if self == BS_ROWS_NONE { Ok(None) } else { Twin::read(self).map(Some) }
    }

    fn write(group: &Option<RowGroup>) -> BsRowGroup {
        group.as_ref().map_or(BS_ROWS_NONE, Twin::write)
    }
}

/// No limit of bytes.
pub const BS_NO_LIMIT: u64 = u64::MAX;
/// Places for categories in budgets and reports; more than there are, so that new ones find theirs.
pub const BS_CATEGORIES: usize = 16;

record! {
    /// Settings of a world: gravity, solver, continuous collision, sleep, events, memory.
    #[repr(C)]
    #[derive(Clone, Copy, Debug, PartialEq)]
    pub struct BsSettings of settings: Settings {
        /// Size of this struct; `bs_settings_default` fills it in.
        pub size: u32 = size_of::<BsSettings>() as u32,
        pub gravity: BsVec3,
        pub substeps: u32,
        pub iterations: u32,
        /// Threads that a step may use, at least 1: the caller's, and those of a pool that the process
        /// shares, with a thread for each processor (or RAYON_NUM_THREADS). The result never depends on it.
        /// Default 1.
        pub threads: u32,
        /// The actual mode of bodies with the mode segment. Default `BS_CONTINUOUS_SEGMENT`.
        pub continuous: BsContinuousMode,
        /// Default `BS_METHOD_ONE_PASS`.
        pub continuous_method: BsMethod,
        /// Default `BS_FRICTION_CONE`.
        pub friction_cone: BsFrictionCone,
        /// Default `BS_FRICTION_PER_PATCH`.
        pub friction_model: BsFrictionModel,
        pub length_unit: f32,
        pub restitution_threshold: f32,
        pub slop: f32,
        pub contact_hertz: f32,
        pub contact_damping: f32,
        pub push_speed: f32,
        pub warm_starting: BsBool,
        pub recycling: BsBool,
        pub joint_trees: BsBool,
        pub guard: BsBool,
        pub sleeping: BsBool,
        /// Zero.
        pub reserved: [u8; 7] = [0; 7],
        pub sleep_speed: f32,
        pub sleep_time: f32,
        pub hit_speed: f32,
        pub event_capacity: u32,
        /// The order in which groups of rows are solved, each of the seven once: the last is obeyed best. The
        /// eighth place is not used.
        pub order: [BsRowGroup; 8] = write_order(settings.order),
        /// Bytes that the world may reserve in all. Additions beyond it are refused with `BS_ERROR_BUDGET`,
        /// and a step leaves out the contacts that don't fit. Default `BS_NO_LIMIT`.
        pub budget: u64 = limit(settings.budget.limit()),
        /// The same for each category, by `BS_CATEGORY_...`. Default `BS_NO_LIMIT`.
        pub budget_of: [u64; BS_CATEGORIES] = limits(&settings.budget),
    }
    default BsSettings::of_engine(&Settings::default())
}

/// The settings that a world has if nobody says anything else.
#[unsafe(no_mangle)]
pub extern "C" fn bs_settings_default() -> BsSettings {
    BsSettings::of_engine(&Settings::default())
}

fn write_order(order: Order) -> [BsRowGroup; 8] {
    let mut codes = [BS_ROWS_NONE; 8];
    codes.iter_mut().zip(&order.0).for_each(|(code, group)| *code = Twin::write(group));
    codes
}

fn limit(bytes: Option<usize>) -> u64 {
    bytes.map_or(BS_NO_LIMIT, |bytes| bytes as u64)
}

fn limits(budget: &Budget) -> [u64; BS_CATEGORIES] {
    let mut of = [BS_NO_LIMIT; BS_CATEGORIES];
    of.iter_mut().zip(Category::ALL).for_each(|(bytes, category)| *bytes = limit(budget.limit_of(category)));
    of
}

impl BsSettings {
    pub(crate) fn to_engine(self) -> Outcome<Settings> {
        let mut order = Order::default();
        for (group, &code) in order.0.iter_mut().zip(&self.order) {
            *group = Twin::read(code)?;
        }
        Ok(self.on(Settings::default())?.with_order(order).with_budget(self.budget()))
    }

    fn budget(&self) -> Budget {
        let bytes = |limit: u64| usize::try_from(limit).unwrap_or(usize::MAX);
        let whole = if self.budget == BS_NO_LIMIT { Budget::NONE } else { Budget::total(bytes(self.budget)) };
        let limited =
            Category::ALL.into_iter().zip(self.budget_of).filter(|(_, limit)| *limit != BS_NO_LIMIT);
        limited.fold(whole, |budget, (category, limit)| budget.with(category, bytes(limit)))
    }
}
