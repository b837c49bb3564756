//! Reports: counts and times of a step, memory, and which parts of the engine a world needs.

use crate::abi::sized::described;
use crate::abi::values::BsBool;
use crate::settings::BS_CATEGORIES;
use backstop::{Category, Feature, MemoryReport, ModelPart, StepReport};
use std::ffi::{CStr, c_char};

/// Counts and times of a step.
#[repr(C)]
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct BsStepReport {
    /// Size of this struct, set by the caller.
    pub size: u32,
    /// Time of the whole step [us].
    pub step_us: f32,
    /// Time of forces, bounds and pairs [us].
    pub broad_us: f32,
    /// Time of manifolds [us].
    pub narrow_us: f32,
    /// Time of restitution, and of sorting, colouring and packing rows [us].
    pub prepare_us: f32,
    /// Time of substeps [us].
    pub solve_us: f32,
    /// Time of poses and the guard [us].
    pub finish_us: f32,
    /// Pairs that the broad phase keeps.
    pub pairs: u32,
    /// Movers whose box in the tree was renewed.
    pub moved: u32,
    /// Movers that were swept along their path.
    pub swept: u32,
    /// Manifolds with at least one point.
    pub manifolds: u32,
    /// Points that touch.
    pub real: u32,
    /// Points that may touch within the step.
    pub potential: u32,
    /// Potential manifolds that had to push.
    pub pushed: u32,
    /// Potential manifolds that pushed in the previous step without closing their gap.
    pub ghosts: u32,
    /// Pairs that kept their manifold without a new narrow phase.
    pub recycled: u32,
    /// Fast pairs whose first touch within the step was searched for.
    pub casts: u32,
    /// Points that bounced.
    pub impacts: u32,
    /// Batches of eight manifolds.
    pub batches: u32,
    /// Contacts that found no colour.
    pub uncoloured: u32,
    /// Bodies whose path the guard cut.
    pub cut: u32,
    /// Bodies that the guard lifted off a surface.
    pub lifted: u32,
    /// Bodies that rows pushed off their predicted path and that were led along static geometry.
    pub settled: u32,
    /// Trees of joints in which a body counts as heavier than it is.
    pub weighted_trees: u32,
    /// Trees of joints that were closed at a loss of energy.
    pub damped_trees: u32,
    /// Bodies that had to be stopped, see `bs_world_stopped_bodies`.
    pub stopped: u32,
    /// Impacts that were solved one by one at their times.
    pub struck: u32,
    /// Bodies that lost the rest of the step after too many of those.
    pub stood: u32,
    /// Bodies that are asleep.
    pub asleep: u32,
    /// Bodies that fell asleep in the step, or since the one before.
    pub slept: u32,
    /// Bodies that woke in the step, or since the one before.
    pub woke: u32,
    /// Events beyond the capacity.
    pub events_lost: u32,
    /// Points of contacts that were left out because memory was not allowed to grow.
    pub shed: u32,
}

described! { BsStepReport, BsStepReport::default(), [
    size, step_us, broad_us, narrow_us, prepare_us, solve_us, finish_us, pairs, moved, swept, manifolds, real,
    potential, pushed, ghosts, recycled, casts, impacts, batches, uncoloured, cut, lifted, settled,
    weighted_trees, damped_trees, stopped, struck, stood, asleep, slept, woke, events_lost, shed,
] }

impl BsStepReport {
    pub(crate) fn of_engine(report: &StepReport) -> BsStepReport {
        BsStepReport {
            size: size_of::<BsStepReport>() as u32,
            step_us: report.times.step,
            broad_us: report.times.broad,
            narrow_us: report.times.narrow,
            prepare_us: report.times.prepare,
            solve_us: report.times.solve,
            finish_us: report.times.finish,
            pairs: report.pairs,
            moved: report.moved,
            swept: report.swept,
            manifolds: report.manifolds,
            real: report.real,
            potential: report.potential,
            pushed: report.pushed,
            ghosts: report.ghosts,
            recycled: report.recycled,
            casts: report.casts,
            impacts: report.impacts,
            batches: report.batches,
            uncoloured: report.uncoloured,
            cut: report.cut,
            lifted: report.lifted,
            settled: report.settled,
            weighted_trees: report.weighted_trees,
            damped_trees: report.damped_trees,
            stopped: report.stopped,
            struck: report.struck,
            stood: report.stood,
            asleep: report.asleep,
            slept: report.slept,
            woke: report.woke,
            events_lost: report.events_lost,
            shed: report.shed,
        }
    }
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

described! { BsMemoryReport, BsMemoryReport::default(), [size, categories, total, of] }

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
pub struct BsModelPart {
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

impl BsModelPart {
    pub(crate) fn of_engine(number: usize, part: &ModelPart) -> BsModelPart {
        BsModelPart {
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
            "joint_drives",
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
