//! Casts of shapes that turn on their way.

use super::{BsHit, BsQueryFilter, ask, ask_all, geometry};
use crate::abi::guard::call;
use crate::abi::pointers::Out;
use crate::abi::sized::read;
use crate::abi::status::{BsStatus, Outcome};
use crate::abi::twin::record;
use crate::abi::values::{BsBool, BsDVec3, BsPose, BsQuat, BsVec3};
use crate::shape::BsGeometry;
use crate::world::BsWorld;
use backstop::glam::Quat;
use backstop::{Geometry, ShapeCast};
use std::ptr::null;

record! {
    /// A convex shape that moves and turns.
    #[repr(C)]
    #[derive(Clone, Copy, Debug, PartialEq)]
    pub struct BsShapeCast {
        /// Size of this struct; `bs_shape_cast_default` fills it in.
        pub size: u32,
        /// Path of its pivot [m].
        pub path: BsVec3,
        /// Where its origin is at the start, and how it is turned.
        pub pose: BsPose,
        /// By how much it turns on the way: a rotation vector in the world [rad]. Default zero.
        pub spin: BsVec3,
        /// The point that follows the path, in the shape's frame [m]. Default its origin.
        pub pivot: BsVec3,
        /// The shape.
        pub shape: *const BsGeometry,
    }
    default bs_shape_cast_default(null(), ORIGIN, ZERO)
}

const ZERO: BsVec3 = BsVec3 { x: 0.0, y: 0.0, z: 0.0 };
const ORIGIN: BsPose = BsPose { position: BsDVec3 { x: 0.0, y: 0.0, z: 0.0 }, rotation: BsQuat::IDENTITY };

/// A shape that moves from a pose along a path [m] and does not turn.
#[unsafe(no_mangle)]
pub extern "C" fn bs_shape_cast_default(shape: *const BsGeometry, pose: BsPose, path: BsVec3) -> BsShapeCast {
    BsShapeCast { size: size_of::<BsShapeCast>() as u32, path, pose, spin: ZERO, pivot: ZERO, shape }
}

/// A shape that moves from one pose to another: its origin straight, its rotation the shorter way about one
/// axis. The rotations are unit quaternions.
#[unsafe(no_mangle)]
pub extern "C" fn bs_shape_cast_between(shape: *const BsGeometry, from: BsPose, to: BsPose) -> BsShapeCast {
    let pose = |pose: BsPose| (pose.position.into(), Quat::from(pose.rotation));
    // The shape does not matter to the motion.
    let cast = ShapeCast::between(&Geometry::Plane, pose(from), pose(to));
    BsShapeCast { spin: cast.spin.into(), ..bs_shape_cast_default(shape, from, cast.path.into()) }
}

impl BsShapeCast {
    fn to_engine(self, shape: &Geometry) -> ShapeCast<'_> {
        ShapeCast::new(shape, self.pose.position, self.path.into())
            .with_rotation(Quat::from(self.pose.rotation))
            .with_spin(self.spin.into())
            .with_pivot(self.pivot.into())
    }
}

/// Calls `work` with the engine's cast.
///
/// # Safety
/// The pointer is null or that of a cast, whose shape is null or a geometry.
unsafe fn with_cast<T>(
    cast: *const BsShapeCast,
    work: impl FnOnce(&ShapeCast<'_>) -> Result<T, backstop::Error>,
) -> Outcome<T> {
    // SAFETY: as this function.
    let cast = unsafe { read(cast) }?;
    // SAFETY: as this function.
    let shape = unsafe { geometry(cast.shape) }?;
    Ok(work(&cast.to_engine(&shape))?)
}

/// The first shape that one touches that moves and turns; `hit->hit` says whether there is one.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn bs_world_cast_turning(
    world: *const BsWorld,
    cast: *const BsShapeCast,
    filter: *const BsQueryFilter,
    hit: *mut BsHit,
) -> BsStatus {
    // SAFETY: the caller keeps to the header.
    unsafe {
        ask(world, filter, hit, |world, filter| {
            let hit = with_cast(cast, |cast| world.cast_shape(cast, filter))?;
            Ok(hit.as_ref().map_or(BsHit::NONE, BsHit::of_shape))
        })
    }
}

/// Whether a shape that moves and turns touches anything at all.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn bs_world_cast_turning_any(
    world: *const BsWorld,
    cast: *const BsShapeCast,
    filter: *const BsQueryFilter,
    any: *mut BsBool,
) -> BsStatus {
    // SAFETY: the caller keeps to the header.
    unsafe {
        ask(world, filter, any, |world, filter| {
            Ok(with_cast(cast, |cast| world.cast_shape_any(cast, filter))?.into())
        })
    }
}

/// All shapes that one would touch that moves and turns if none stopped it, by fraction. `count` becomes
/// their number.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn bs_world_cast_turning_all(
    world: *const BsWorld,
    cast: *const BsShapeCast,
    filter: *const BsQueryFilter,
    hits: *mut BsHit,
    capacity: usize,
    count: *mut usize,
) -> BsStatus {
    // SAFETY: the caller keeps to the header.
    unsafe {
        ask_all(world, filter, (hits, capacity, count), BsHit::of_shape, |world, filter, found| {
            with_cast(cast, |cast| world.cast_shape_all(cast, filter, found))
        })
    }
}

/// Where the shape of a cast is at a fraction of its way.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn bs_shape_cast_pose(
    cast: *const BsShapeCast,
    fraction: f32,
    pose: *mut BsPose,
) -> BsStatus {
    call(|| {
        // SAFETY: the caller keeps to the header.
        let (out, cast) = unsafe { (Out::new("the place for the pose", pose)?, read(cast)?) };
        let cast = cast.to_engine(&Geometry::Plane);
        out.set((cast.position_at(fraction), cast.rotation_at(fraction)).into());
        Ok(())
    })
}
