//! Couplings: gears, racks, screws and pulleys out of two motions of joints.

use super::desc::{BS_AXES_ALL, BS_AXIS_X, BS_MOTION_ANGULAR, BS_MOTION_LINEAR};
use super::desc::{BsJointAxes, BsMotion};
use crate::abi::guard::{call, value_or};
use crate::abi::pointers::Out;
use crate::abi::sized::{read, write};
use crate::abi::status::{BsStatus, Outcome};
use crate::abi::twin::{Twin, record};
use crate::abi::values::{BsBool, BsCoupling, BsJoint};
use crate::world::{BsWorld, change, changing, get, get_all, get_two, reading};
use backstop::{CoupledMotion, CouplingDesc};
use std::f64::consts::TAU;

/// A motion of a joint that is coupled to another one.
#[repr(C)]
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct BsCoupledMotion {
    /// The joint. It need not restrict this motion.
    pub joint: BsJoint,
    /// Sliding or turning.
    pub motion: BsMotion,
    /// Along or about which axes. An angle is about one axis.
    pub axes: BsJointAxes,
    /// Factor on the displacement, of magnitude 1e-9 to 1e9.
    pub factor: f64,
}

record! {
    /// A coupling to be added: the sum of two motions, each times its factor, is kept at a value or within a
    /// range.
    #[repr(C)]
    #[derive(Clone, Copy, Debug, PartialEq)]
    pub struct BsCouplingDesc {
        /// Size of this struct; the functions that make one fill it in.
        pub size: u32,
        /// Whether the sum is kept within `min` and `max`, and not at what it is when the coupling is added.
        pub has_range: BsBool,
        /// Zero.
        pub reserved: [u8; 3],
        /// The two motions.
        pub motions: [BsCoupledMotion; 2],
        /// Least sum; minus infinity for none.
        pub min: f64,
        /// Greatest sum; infinity for none.
        pub max: f64,
        /// The coupling breaks if it exerts more on either motion [N] or [N m]. Default infinity.
        pub break_force: [f32; 2],
        /// Free for the caller.
        pub user_data: u64,
    }
    default bs_coupling_desc_default(NO_MOTION, NO_MOTION)
}

const NO_MOTION: BsCoupledMotion =
    BsCoupledMotion { joint: BsJoint::NONE, motion: BS_MOTION_ANGULAR, axes: BS_AXIS_X, factor: 1.0 };

fn angle(joint: BsJoint, factor: f64) -> BsCoupledMotion {
    BsCoupledMotion { joint, motion: BS_MOTION_ANGULAR, axes: BS_AXIS_X, factor }
}

fn distance(joint: BsJoint, factor: f64) -> BsCoupledMotion {
    BsCoupledMotion { joint, motion: BS_MOTION_LINEAR, axes: BS_AXES_ALL, factor }
}

/// Keeps the sum of two motions at what it is.
#[unsafe(no_mangle)]
pub extern "C" fn bs_coupling_desc_default(
    first: BsCoupledMotion,
    second: BsCoupledMotion,
) -> BsCouplingDesc {
    BsCouplingDesc {
        size: size_of::<BsCouplingDesc>() as u32,
        has_range: 0,
        reserved: [0; 3],
        motions: [first, second],
        min: f64::NEG_INFINITY,
        max: f64::INFINITY,
        break_force: [f32::INFINITY; 2],
        user_data: 0,
    }
}

/// Two meshing gears on hinges about the frames' x, by their numbers of teeth. A negative number, for one of
/// the two, makes them turn alike.
#[unsafe(no_mangle)]
pub extern "C" fn bs_coupling_desc_gear(
    first: BsJoint,
    second: BsJoint,
    first_teeth: f64,
    second_teeth: f64,
) -> BsCouplingDesc {
    bs_coupling_desc_default(angle(first, first_teeth), angle(second, second_teeth))
}

/// A pinion on a hinge and a rack on a slider, both along the frames' x: by one turn the rack travels
/// 2 pi `radius` [m].
#[unsafe(no_mangle)]
pub extern "C" fn bs_coupling_desc_rack(hinge: BsJoint, slider: BsJoint, radius: f64) -> BsCouplingDesc {
    let travel = BsCoupledMotion { axes: BS_AXIS_X, ..distance(slider, -1.0) };
    bs_coupling_desc_default(angle(hinge, radius), travel)
}

/// A screw: by one turn about the frames' x of a joint that leaves both free, it travels `lead` [m] along it.
#[unsafe(no_mangle)]
pub extern "C" fn bs_coupling_desc_screw(joint: BsJoint, lead: f64) -> BsCouplingDesc {
    bs_coupling_desc_rack(joint, joint, lead / TAU)
}

/// A rope over two pulleys: the distance of the first joint's frames and `ratio` times that of the second's
/// are together at most `length` [m].
#[unsafe(no_mangle)]
pub extern "C" fn bs_coupling_desc_pulley(
    first: BsJoint,
    second: BsJoint,
    ratio: f64,
    length: f64,
) -> BsCouplingDesc {
    let desc = bs_coupling_desc_default(distance(first, 1.0), distance(second, ratio));
    BsCouplingDesc { has_range: 1, max: length, ..desc }
}

impl BsCouplingDesc {
    fn of_engine(desc: &CouplingDesc) -> BsCouplingDesc {
        let one = |of: &CoupledMotion| BsCoupledMotion {
            joint: of.joint.into(),
            motion: Twin::write(&of.motion),
            axes: Twin::write(&of.axes),
            factor: of.factor,
        };
        let [first, second] = &desc.motions;
        let plain = BsCouplingDesc {
            break_force: desc.break_force,
            user_data: desc.user_data,
            ..bs_coupling_desc_default(one(first), one(second))
        };
        match desc.range {
            Some([min, max]) => BsCouplingDesc { has_range: 1, min, max, ..plain },
            None => plain,
        }
    }

    fn to_engine(self) -> Outcome<CouplingDesc> {
        let one = |of: BsCoupledMotion| -> Outcome<CoupledMotion> {
            let mut motion = CoupledMotion::distance(of.joint.into(), of.factor);
            motion.motion = Twin::read(of.motion)?;
            motion.axes = Twin::read(of.axes)?;
            Ok(motion)
        };
        let desc = CouplingDesc::new([one(self.motions[0])?, one(self.motions[1])?])
            .with_range((self.has_range != 0).then_some([self.min, self.max]))
            .with_break_force(self.break_force)
            .with_user_data(self.user_data);
        Ok(desc)
    }
}

/// Adds a coupling of two motions of joints. `coupling` may be null.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn bs_world_add_coupling(
    world: *mut BsWorld,
    desc: *const BsCouplingDesc,
    coupling: *mut BsCoupling,
) -> BsStatus {
    call(|| {
        // SAFETY: the caller keeps to the header.
        let (mut content, out, desc) = unsafe {
            let out = Out::optional("the place for the coupling", coupling)?;
            (changing(world)?, out, read(desc)?.to_engine()?)
        };
        let coupling = content.add_coupling(&desc)?;
        if let Some(out) = out {
            out.set(coupling.into());
        }
        Ok(())
    })
}

/// Removes a coupling.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn bs_world_remove_coupling(world: *mut BsWorld, coupling: BsCoupling) -> BsStatus {
    // SAFETY: the caller keeps to the header.
    unsafe { change(world, |w| w.remove_coupling(coupling.into())) }
}

/// The displacements of a coupling's two motions [m] or [rad], with whole turns; each pointer may be null.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn bs_coupling_positions(
    world: *const BsWorld,
    coupling: BsCoupling,
    first: *mut f64,
    second: *mut f64,
) -> BsStatus {
    // SAFETY: the caller keeps to the header.
    unsafe { get_two(world, (first, second), |w| Ok(w.coupling_positions(coupling.into())?.into())) }
}

/// The sum that a coupling keeps: of both displacements times their factors.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn bs_coupling_sum(
    world: *const BsWorld,
    coupling: BsCoupling,
    sum: *mut f64,
) -> BsStatus {
    // SAFETY: the caller keeps to the header.
    unsafe { get(world, "the place for the sum", sum, |w| Ok(w.coupling_sum(coupling.into())?)) }
}

/// What a coupling exerted on each of its motions in the last substep [N] or [N m]; each pointer may be null.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn bs_coupling_force(
    world: *const BsWorld,
    coupling: BsCoupling,
    first: *mut f32,
    second: *mut f32,
) -> BsStatus {
    // SAFETY: the caller keeps to the header.
    unsafe { get_two(world, (first, second), |w| Ok(w.coupling_force(coupling.into())?.into())) }
}

/// Sets the factors of a coupling where its motions are: shifts a gear.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn bs_coupling_set_factors(
    world: *mut BsWorld,
    coupling: BsCoupling,
    first: f64,
    second: f64,
) -> BsStatus {
    // SAFETY: the caller keeps to the header.
    unsafe { change(world, |w| w.set_coupling_factors(coupling.into(), [first, second])) }
}

/// Sets the range of a coupling's sum, infinite for no end.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn bs_coupling_set_range(
    world: *mut BsWorld,
    coupling: BsCoupling,
    min: f64,
    max: f64,
) -> BsStatus {
    // SAFETY: the caller keeps to the header.
    unsafe { change(world, |w| w.set_coupling_range(coupling.into(), Some([min, max]))) }
}

/// Couplings that broke in the last step; their handles are stale. `count` becomes their number.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn bs_world_broken_couplings(
    world: *const BsWorld,
    couplings: *mut BsCoupling,
    capacity: usize,
    count: *mut usize,
) -> BsStatus {
    // SAFETY: the caller keeps to the header.
    unsafe {
        get_all(world, "couplings", (couplings, capacity, count), |w| Ok(w.broken_couplings().to_vec()))
    }
}

/// Makes a coupling keep its sum at what it is, instead of within a range.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn bs_coupling_keep(world: *mut BsWorld, coupling: BsCoupling) -> BsStatus {
    // SAFETY: the caller keeps to the header.
    unsafe { change(world, |w| w.set_coupling_range(coupling.into(), None)) }
}

/// Sets what a coupling breaks at on each of its motions [N] or [N m], infinite for never.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn bs_coupling_set_break_force(
    world: *mut BsWorld,
    coupling: BsCoupling,
    first: f32,
    second: f32,
) -> BsStatus {
    // SAFETY: the caller keeps to the header.
    unsafe { change(world, |w| w.set_coupling_break_force(coupling.into(), [first, second])) }
}

/// Sets the caller's number of a coupling.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn bs_coupling_set_user_data(
    world: *mut BsWorld,
    coupling: BsCoupling,
    user_data: u64,
) -> BsStatus {
    // SAFETY: the caller keeps to the header.
    unsafe { change(world, |w| w.set_coupling_user_data(coupling.into(), user_data)) }
}

/// A coupling as it is now, into a description whose `size` says how much of it the caller knows. It always
/// has a range, of no width if it keeps its sum.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn bs_coupling_desc(
    world: *const BsWorld,
    coupling: BsCoupling,
    desc: *mut BsCouplingDesc,
) -> BsStatus {
    call(|| {
        // SAFETY: the caller keeps to the header.
        let found = unsafe { reading(world) }?.coupling(coupling.into())?;
        // SAFETY: the caller keeps to the header.
        unsafe { write(desc, BsCouplingDesc::of_engine(&found)) }
    })
}

/// Whether a handle is that of a coupling of the world; no if there is no such world.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn bs_world_contains_coupling(world: *const BsWorld, coupling: BsCoupling) -> BsBool {
    // SAFETY: the caller keeps to the header.
    let there = || unsafe { reading(world) }.is_ok_and(|content| content.contains_coupling(coupling.into()));
    value_or(0, || there().into())
}

/// Number of couplings of a world.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn bs_world_coupling_count(world: *const BsWorld, count: *mut usize) -> BsStatus {
    // SAFETY: the caller keeps to the header.
    unsafe { get(world, "the count", count, |w| Ok(w.coupling_count())) }
}

/// Couplings of a motion of a joint. `count` becomes their number.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn bs_joint_couplings(
    world: *const BsWorld,
    joint: BsJoint,
    couplings: *mut BsCoupling,
    capacity: usize,
    count: *mut usize,
) -> BsStatus {
    // SAFETY: the caller keeps to the header.
    unsafe {
        get_all(world, "couplings", (couplings, capacity, count), |w| {
            Ok(w.couplings_of(joint.into())?.collect())
        })
    }
}
