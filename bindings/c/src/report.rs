//! Reports: counts and times of a step, memory, and which parts of the engine a world needs.

use crate::abi::twin::record;
use crate::abi::values::BsBool;
use crate::settings::BS_CATEGORIES;
use backstop::{Category, Feature, FeatureCost, MemoryReport, StepReport};
use std::ffi::{CStr, c_char};

record! {
    /// Counts and times of a step.
    #[repr(C)]
    #[derive(Clone, Copy, Debug, Default, PartialEq)]
    pub struct BsStepReport of report: StepReport {
        /// Size of this struct, set by the caller.
        pub size: u32 = size_of::<BsStepReport>() as u32,
        /// Time of the whole step [us].
        pub step_us: f32 = report.times.step,
        /// Time of forces, bounds and pairs [us].
        pub broad_us: f32 = report.times.broad,
        /// Time of manifolds [us].
        pub narrow_us: f32 = report.times.narrow,
        /// Time of restitution, and of sorting, colouring and packing rows [us].
        pub prepare_us: f32 = report.times.prepare,
        /// Time of substeps [us].
        pub solve_us: f32 = report.times.solve,
        /// Time of poses and the guard [us].
        pub finish_us: f32 = report.times.finish,
        pub pairs: u32,
        pub moved: u32,
        pub swept: u32,
        pub manifolds: u32,
        pub real: u32,
        pub potential: u32,
        pub pushed: u32,
        pub ghosts: u32,
        pub recycled: u32,
        pub casts: u32,
        pub impacts: u32,
        pub batches: u32,
        pub uncoloured: u32,
        pub cut: u32,
        pub lifted: u32,
        pub settled: u32,
        pub weighted_trees: u32,
        pub damped_trees: u32,
        /// Bodies that had to be stopped, see `bs_world_faulted_bodies`.
        pub faulted: u32,
        /// Impacts that were solved one by one at their times.
        pub struck: u32,
        pub stood: u32,
        pub asleep: u32,
        pub slept: u32,
        pub woke: u32,
        pub events_lost: u32,
        pub shed: u32,
    }
    default BsStepReport::default()
}

/// What memory is for, one of `BS_CATEGORY_...`: an index into `BsMemoryReport::of` and
/// `BsSettings::budget_of`.
pub type BsCategory = u32;
/// Poses, velocities, masses, handles.
pub const BS_CATEGORY_BODIES: BsCategory = 0;
/// Colliders, materials, convex hulls.
pub const BS_CATEGORY_SHAPES: BsCategory = 1;
/// Triangle meshes and height fields, with their trees.
pub const BS_CATEGORY_MESHES: BsCategory = 2;
/// Trees of the world, bounds, pairs.
pub const BS_CATEGORY_BROAD_PHASE: BsCategory = 3;
/// Contact manifolds and their impulses.
pub const BS_CATEGORY_MANIFOLDS: BsCategory = 4;
/// Solver rows in their batches.
pub const BS_CATEGORY_ROWS: BsCategory = 5;
/// Joints.
pub const BS_CATEGORY_JOINTS: BsCategory = 6;
/// Event buffers.
pub const BS_CATEGORY_EVENTS: BsCategory = 7;
/// Buffers of one step.
pub const BS_CATEGORY_SCRATCH: BsCategory = 8;
/// Memory that exists only because of continuous collision.
pub const BS_CATEGORY_CONTINUOUS: BsCategory = 9;

/// Bytes of one category.
#[repr(C)]
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct BsBytes {
    /// In use now.
    pub live: u64,
    /// Held, in use or not.
    pub reserved: u64,
    /// The most that was ever reserved.
    pub peak: u64,
}

record! {
    /// Bytes of a world by category. Arrays of events that this interface hands out are not counted.
    #[repr(C)]
    #[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
    pub struct BsMemoryReport {
        /// Size of this struct, set by the caller.
        pub size: u32,
        /// How many categories there are.
        pub categories: u32,
        /// Reserved bytes of all.
        pub total: u64,
        /// Bytes by `BS_CATEGORY_...`; zeros beyond those.
        pub of: [BsBytes; BS_CATEGORIES],
    }
    default BsMemoryReport::default()
}

impl BsMemoryReport {
    pub(crate) fn of_engine(report: &MemoryReport) -> BsMemoryReport {
        let mut of = [BsBytes::default(); BS_CATEGORIES];
        for (own, (_, bytes)) in of.iter_mut().zip(report.iter()) {
            *own =
                BsBytes { live: bytes.live as u64, reserved: bytes.reserved as u64, peak: bytes.peak as u64 };
        }
        BsMemoryReport {
            size: size_of::<BsMemoryReport>() as u32,
            categories: Category::ALL.len() as u32,
            total: report.total() as u64,
            of,
        }
    }
}

/// Features that 0.1.0 did not have, in the order in which they came: numbers of features stay as they were.
const LATER: [Feature; 2] = [Feature::Couplings, Feature::SoftContacts];

/// All features by their numbers.
pub(crate) fn features() -> Vec<Feature> {
    let first = Feature::ALL.into_iter().filter(|feature| !LATER.contains(feature));
    first.chain(LATER).collect()
}

/// An optional part of the engine, and its cost in a world.
#[repr(C)]
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct BsFeatureCost {
    /// Which: its place in the list, which a later version may add to at its end; `bs_feature_name` has its
    /// name.
    pub feature: u32,
    /// Number of objects that need it; zero if nothing does.
    pub count: u32,
    /// Bytes that are reserved for it alone.
    pub bytes: u64,
    /// Its time in the last step [us], where that is known.
    pub time_us: f32,
    /// Whether the time is known.
    pub has_time: BsBool,
    /// Zero.
    pub reserved: [u8; 3],
}

impl BsFeatureCost {
    pub(crate) fn of_engine(number: usize, part: &FeatureCost) -> BsFeatureCost {
        BsFeatureCost {
            feature: number as u32,
            count: part.count,
            bytes: part.bytes as u64,
            time_us: part.time_us.unwrap_or(0.0),
            has_time: part.time_us.is_some().into(),
            reserved: [0; 3],
        }
    }
}

/// The name of a category of memory; empty for none. Valid for ever.
#[unsafe(no_mangle)]
pub extern "C" fn bs_category_name(category: BsCategory) -> *const c_char {
    let name: &CStr = match category {
        BS_CATEGORY_BODIES => c"bodies",
        BS_CATEGORY_SHAPES => c"shapes",
        BS_CATEGORY_MESHES => c"meshes",
        BS_CATEGORY_BROAD_PHASE => c"broad_phase",
        BS_CATEGORY_MANIFOLDS => c"manifolds",
        BS_CATEGORY_ROWS => c"rows",
        BS_CATEGORY_JOINTS => c"joints",
        BS_CATEGORY_EVENTS => c"events",
        BS_CATEGORY_SCRATCH => c"scratch",
        BS_CATEGORY_CONTINUOUS => c"continuous",
        _ => c"",
    };
    name.as_ptr()
}

/// The name of a part of the engine by its number; empty for none. Valid for ever.
#[unsafe(no_mangle)]
pub extern "C" fn bs_feature_name(feature: u32) -> *const c_char {
    static NAMES: std::sync::OnceLock<Vec<std::ffi::CString>> = std::sync::OnceLock::new();
    crate::abi::guard::value_or(c"".as_ptr(), || {
        let names = NAMES.get_or_init(|| {
            let name = |feature: Feature| std::ffi::CString::new(feature.name()).unwrap_or_default();
            features().into_iter().map(name).collect()
        });
        names.get(feature as usize).map_or(c"".as_ptr(), |name| name.as_ptr())
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Expected: the engine's own names, in its order.
    #[test]
    fn names_are_those_of_the_engine() {
        for (place, category) in Category::ALL.into_iter().enumerate() {
            // SAFETY: names are valid for ever.
            let name = unsafe { CStr::from_ptr(bs_category_name(place as u32)) };
            assert_eq!(name.to_str(), Ok(category.name()));
        }
        assert!(Category::ALL.len() <= BS_CATEGORIES);
        assert_eq!(features().len(), Feature::ALL.len());
    }

    /// Expected: the numbers of 0.1.0, and those that came later after them.
    #[test]
    fn numbers_of_features_stay() {
        let names = [
            "friction",
            "surface_velocities",
            "rolling_friction",
            "restitution",
            "continuous_collision",
            "acceleration",
            "forces",
            "locked_axes",
            "gyroscopic_turning",
            "kinematic_bodies",
            "compounds",
            "convex_hulls",
            "meshes",
            "height_fields",
            "joints",
            "joint_trees",
            "joint_locks",
            "joint_limits",
            "joint_motors",
            "joint_springs",
            "breakable_joints",
            "sleeping",
            "contact_events",
            "sensors",
            "contact_hooks",
            "queries",
            "solved_after",
            "couplings",
            "soft_contacts",
        ];
        assert_eq!(features().len(), names.len());
        for (number, expected) in names.into_iter().enumerate() {
            // SAFETY: names are valid for ever.
            let name = unsafe { CStr::from_ptr(bs_feature_name(number as u32)) };
            assert_eq!(name.to_str(), Ok(expected), "{number}");
        }
    }
}
