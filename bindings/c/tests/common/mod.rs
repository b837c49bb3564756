//! Common parts of several tests.

#![allow(dead_code, reason = "each test uses some of it")]

use backstop_c::*;
use std::ffi::CStr;
use std::ptr::{null, null_mut};

/// A world that is destroyed at the end of the test.
pub(crate) struct World(pub(crate) *mut BsWorld);

impl Drop for World {
    fn drop(&mut self) {
        // SAFETY: it was made here.
        unsafe { bs_world_destroy(self.0) }
    }
}

pub(crate) fn world() -> World {
    let mut world = null_mut();
    // SAFETY: the place is one.
    ok(unsafe { bs_world_create(null(), &mut world) });
    World(world)
}

/// The message of the last call.
pub(crate) fn message() -> String {
    // SAFETY: it is valid until the next call of this thread, and copied before.
    unsafe { CStr::from_ptr(bs_last_error()) }.to_str().unwrap().to_owned()
}

#[track_caller]
pub(crate) fn ok(status: BsStatus) {
    assert_eq!(status, BS_OK, "{}", message());
}

pub(crate) fn vec3(x: f32, y: f32, z: f32) -> BsVec3 {
    BsVec3 { x, y, z }
}

pub(crate) fn dvec3(x: f64, y: f64, z: f64) -> BsDVec3 {
    BsDVec3 { x, y, z }
}

pub(crate) const UPRIGHT: BsQuat = BsQuat { x: 0.0, y: 0.0, z: 0.0, w: 1.0 };
pub(crate) const NO_BODY: BsBody = BsBody { slot: 0, generation: 0 };

/// Adds a body of one shape.
#[track_caller]
pub(crate) fn add(world: &World, kind: BsBodyKind, geometry: BsGeometry, at: BsDVec3) -> BsBody {
    let shape = bs_shape_desc_default(geometry);
    add_shape(world, kind, &shape, at)
}

#[track_caller]
pub(crate) fn add_shape(world: &World, kind: BsBodyKind, shape: &BsShapeDesc, at: BsDVec3) -> BsBody {
    let mut desc = bs_body_desc_default();
    (desc.kind, desc.position, desc.shapes, desc.shape_count) = (kind, at, shape, 1);
    let mut body = NO_BODY;
    // SAFETY: all pointers are to what lives here.
    ok(unsafe { bs_world_add_body(world.0, &desc, &mut body) });
    body
}

#[track_caller]
pub(crate) fn steps(world: &World, count: usize) {
    for _ in 0..count {
        // SAFETY: the world is alive.
        ok(unsafe { bs_world_step(world.0, 1.0 / 60.0) });
    }
}

#[track_caller]
pub(crate) fn hash(world: &World) -> u64 {
    let mut hash = 0;
    // SAFETY: the world is alive.
    ok(unsafe { bs_world_state_hash(world.0, &mut hash) });
    hash
}

#[track_caller]
pub(crate) fn pose(world: &World, body: BsBody) -> BsPose {
    let mut pose = BsPose { position: dvec3(0.0, 0.0, 0.0), rotation: UPRIGHT };
    // SAFETY: the world is alive.
    ok(unsafe { bs_body_pose(world.0, body, &mut pose) });
    pose
}
