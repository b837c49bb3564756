//! Errors of a caller are refused with a status that says so, and change nothing.

mod common;

use backstop_c::*;
use common::*;
use std::ffi::CStr;
use std::ptr::{null, null_mut};

#[test]
fn null_and_misaligned_pointers_are_refused() {
    let world = world();
    let body = add(&world, BS_BODY_DYNAMIC, bs_sphere(0.5), dvec3(0.0, 1.0, 0.0));
    let before = hash(&world);
    let (mut pose, mut found) = (pose(&world, body), NO_BODY);
    let desc = bs_body_desc_default();
    // SAFETY: what is not null is alive.
    unsafe {
        assert_eq!(bs_world_create(null(), null_mut()), BS_ERROR_NULL);
        assert_eq!(bs_world_step(null_mut(), 0.01), BS_ERROR_NULL);
        assert_eq!(message(), "the world is null or misaligned");
        assert_eq!(bs_body_pose(null(), body, &mut pose), BS_ERROR_NULL);
        assert_eq!(bs_body_pose(world.0, body, null_mut()), BS_ERROR_NULL);
        assert_eq!(bs_body_pose(world.0, body, (&raw mut pose).byte_add(1)), BS_ERROR_NULL);
        assert_eq!(bs_world_add_body(world.0, null(), &mut found), BS_ERROR_NULL);
        assert_eq!(bs_world_add_body(world.0, &desc, null_mut()), BS_ERROR_NULL);
        assert_eq!(bs_hull_create(null(), 4, &mut null()), BS_ERROR_NULL);
        assert_eq!(bs_hull_retain(null()), BS_ERROR_NULL);
        assert_eq!(bs_world_contains_body(null(), body), 0);
        assert_eq!(bs_world_restore(world.0, null()), BS_ERROR_NULL);
        let shape = bs_shape_desc_default(bs_hull(null()));
        let compound = BsBodyDesc { shapes: &shape, shape_count: 1, ..desc };
        assert_eq!(bs_world_add_body(world.0, &compound, &mut found), BS_ERROR_NULL);
        let promised = BsBodyDesc { shapes: null(), shape_count: 3, ..desc };
        assert_eq!(bs_world_add_body(world.0, &promised, &mut found), BS_ERROR_NULL);
        // Nothing to destroy is fine.
        bs_world_destroy(null_mut());
        bs_snapshot_destroy(null_mut());
        bs_character_destroy(null_mut());
        bs_hull_release(null());
    }
    assert_eq!(found, NO_BODY);
    assert_eq!(hash(&world), before);
}

#[test]
fn handles_that_are_stale_or_made_up_are_refused() {
    let world = world();
    let body = add(&world, BS_BODY_DYNAMIC, bs_sphere(0.5), dvec3(0.0, 1.0, 0.0));
    let other = BsBody { generation: body.generation + 1, ..body };
    let beyond = BsBody { slot: u32::MAX, generation: u32::MAX };
    let mut place = pose(&world, body);
    // SAFETY: the world is alive.
    unsafe {
        for wrong in [other, beyond, NO_BODY] {
            assert_eq!(bs_body_pose(world.0, wrong, &mut place), BS_ERROR_STALE_BODY);
            assert_eq!(bs_world_remove_body(world.0, wrong), BS_ERROR_STALE_BODY);
            assert_eq!(bs_world_contains_body(world.0, wrong), 0);
        }
        let shape = BsShape { slot: 9, generation: 1 };
        assert_eq!(bs_shape_remove(world.0, shape), BS_ERROR_STALE_SHAPE);
        let joint = BsJoint { slot: 0, generation: 1 };
        assert_eq!(bs_world_remove_joint(world.0, joint), BS_ERROR_STALE_JOINT);
        let both = [body, other];
        assert_eq!(bs_world_remove_bodies(world.0, both.as_ptr(), 2), BS_ERROR_STALE_BODY);
        assert_eq!(bs_world_contains_body(world.0, body), 1);
        ok(bs_world_remove_body(world.0, body));
        assert_eq!(bs_body_pose(world.0, body, &mut place), BS_ERROR_STALE_BODY);
        assert_eq!(message(), "the body handle is stale: its body was removed");
    }
}

/// Expected: a caller with an older header knows of fewer fields, and gets the defaults of the others.
#[test]
fn shorter_descriptions_have_defaults_for_the_rest() {
    let world = world();
    let shape = bs_shape_desc_default(bs_sphere(0.5));
    let mut desc = bs_body_desc_default();
    desc.position = dvec3(1.0, 2.0, 3.0);
    desc.user_data = 7;
    (desc.shapes, desc.shape_count, desc.gravity_scale) = (&shape, 1, f32::NAN);
    let mut body = NO_BODY;
    let mut number = 1;
    // SAFETY: the world is alive.
    unsafe {
        assert_eq!(bs_world_add_body(world.0, &desc, &mut body), BS_ERROR_NOT_FINITE);
        // A version that ended before the factor on gravity.
        desc.size = std::mem::offset_of!(BsBodyDesc, gravity_scale) as u32;
        ok(bs_world_add_body(world.0, &desc, &mut body));
        ok(bs_body_user_data(world.0, body, &mut number));
    }
    assert_eq!((pose(&world, body).position, number), (dvec3(1.0, 2.0, 3.0), 0));
}

#[test]
fn sizes_that_no_version_had_are_refused() {
    let world = world();
    let mut body = NO_BODY;
    let mut desc = bs_body_desc_default();
    let own = desc.size;
    let mut report = BsStepReport::default();
    // SAFETY: the world is alive.
    unsafe {
        // None, half a field, and longer than this version.
        for wrong in [0, 3, 9, own - 1, own + 8, u32::MAX] {
            desc.size = wrong;
            assert_eq!(bs_world_add_body(world.0, &desc, &mut body), BS_ERROR_SIZE, "{wrong}");
        }
        assert_eq!(bs_world_report(world.0, &mut report), BS_ERROR_SIZE);
        // A later version of a report gets the fields that this one has, and their size.
        report.size = u32::MAX;
        ok(bs_world_report(world.0, &mut report));
        assert_eq!(report.size as usize, size_of::<BsStepReport>());
        // An earlier one gets no more than it has place for.
        (report.size, report.pairs) = (8, 77);
        ok(bs_world_report(world.0, &mut report));
        assert_eq!((report.size, report.pairs), (8, 77));
        // An array of different sizes.
        let mut limits = [bs_limit_desc(BS_MOTION_LINEAR, BS_AXES_ALL, 0.0, 1.0); 2];
        limits[1].size = 4;
        let mut joint = bs_joint_desc_default(BS_JOINT_FREE, body, body);
        (joint.limits, joint.limit_count) = (limits.as_ptr(), 2);
        assert_eq!(bs_world_add_joint(world.0, &joint, null_mut()), BS_ERROR_SIZE);
    }
}

#[test]
fn short_buffers_get_the_number_and_nothing_else() {
    let world = world();
    let bodies = [0.0, 2.0, 4.0].map(|x| add(&world, BS_BODY_DYNAMIC, bs_sphere(0.5), dvec3(x, 1.0, 0.0)));
    let (mut found, mut count) = ([NO_BODY; 3], 9);
    // SAFETY: the world is alive, and buffers are as long as they are said to be.
    unsafe {
        assert_eq!(bs_world_bodies(world.0, null_mut(), 0, &mut count), BS_ERROR_BUFFER);
        assert_eq!(count, 3);
        assert_eq!(bs_world_bodies(world.0, found.as_mut_ptr(), 2, &mut count), BS_ERROR_BUFFER);
        assert_eq!(message(), "the buffer for bodies has 2 elements and needs 3");
        assert_eq!(found, [NO_BODY; 3]);
        assert_eq!(bs_world_bodies(world.0, null_mut(), 3, &mut count), BS_ERROR_NULL);
        assert_eq!(bs_world_bodies(world.0, found.as_mut_ptr(), 3, null_mut()), BS_ERROR_NULL);
        ok(bs_world_bodies(world.0, found.as_mut_ptr(), 3, &mut count));
    }
    assert_eq!(found, bodies);
}

#[test]
fn numbers_and_constants_that_mean_nothing_are_refused() {
    let world = world();
    let body = add(&world, BS_BODY_DYNAMIC, bs_sphere(0.5), dvec3(0.0, 1.0, 0.0));
    let before = hash(&world);
    let (desc, mut found) = (bs_body_desc_default(), NO_BODY);
    let nan = vec3(f32::NAN, 0.0, 0.0);
    let none = vec3(0.0, 0.0, 0.0);
    let mut hit = BsOverlap { body, shape: BsShape { slot: 0, generation: 0 } };
    // SAFETY: the world is alive.
    unsafe {
        for dt in [0.0, -1.0, f32::INFINITY] {
            assert!(bs_world_step(world.0, dt) != BS_OK);
        }
        assert_eq!(bs_world_step(world.0, f32::NAN), BS_ERROR_NOT_FINITE);
        assert_eq!(bs_body_set_velocity(world.0, body, nan, none), BS_ERROR_NOT_FINITE);
        assert_eq!(bs_body_add_force_and_torque(world.0, body, none, nan), BS_ERROR_NOT_FINITE);
        assert_eq!(bs_body_set_velocity(world.0, body, vec3(0.0, 1e7, 0.0), none), BS_ERROR_OUT_OF_RANGE);
        assert_eq!(bs_body_set_continuous(world.0, body, 3), BS_ERROR_CONSTANT);
        assert_eq!(message(), "3 is no mode of continuous collision");
        let wrong = [
            BsBodyDesc { kind: 3, ..desc },
            BsBodyDesc { continuous: u32::MAX, ..desc },
            BsBodyDesc { lock_rotation: 8, ..desc },
            BsBodyDesc { solved_after: 8, ..desc },
        ];
        for desc in wrong {
            assert_eq!(bs_world_add_body(world.0, &desc, &mut found), BS_ERROR_CONSTANT);
        }
        assert_eq!(bs_world_add_body(world.0, &desc, &mut found), BS_ERROR_NO_MASS);
        let unknown = BsGeometry { kind: 8, ..bs_sphere(1.0) };
        let at = pose(&world, body);
        let mut count = 0;
        assert_eq!(
            bs_world_overlap(world.0, &unknown, at, null(), &mut hit, 1, &mut count),
            BS_ERROR_CONSTANT
        );
        let plane = bs_plane();
        assert_eq!(
            bs_world_overlap(world.0, &plane, at, null(), &mut hit, 1, &mut count),
            BS_ERROR_NOT_CONVEX
        );
        let flat = [vec3(0.0, 0.0, 0.0), vec3(1.0, 0.0, 0.0), vec3(0.0, 0.0, 1.0)];
        assert_eq!(bs_hull_create(flat.as_ptr(), 3, &mut null()), BS_ERROR_DEGENERATE);
        let mut settings = bs_settings_default();
        settings.substeps = 0;
        assert_eq!(bs_world_set_settings(world.0, &settings), BS_ERROR_OUT_OF_RANGE);
        settings = bs_settings_default();
        settings.order[0] = BS_ROWS_JOINTS;
        assert!(bs_world_set_settings(world.0, &settings) != BS_OK);
    }
    assert_eq!(hash(&world), before);
}

#[test]
fn bytes_that_are_no_snapshot_are_refused() {
    let world = world();
    add(&world, BS_BODY_DYNAMIC, bs_sphere(0.5), dvec3(0.0, 1.0, 0.0));
    let (mut snapshot, mut broken, mut count) = (null_mut(), null_mut(), 0);
    // SAFETY: all objects are alive, and buffers are as long as they are said to be.
    unsafe {
        ok(bs_snapshot_create(&mut snapshot));
        assert_eq!(bs_world_restore(world.0, snapshot), BS_ERROR_BROKEN_SNAPSHOT);
        ok(bs_world_snapshot(world.0, snapshot));
        assert_eq!(bs_snapshot_to_whole_bytes(snapshot, null_mut(), 0, &mut count), BS_ERROR_BUFFER);
        let mut bytes = vec![0; count];
        ok(bs_snapshot_to_whole_bytes(snapshot, bytes.as_mut_ptr(), count, &mut count));
        bytes[count / 2] ^= 1;
        let status = bs_snapshot_from_bytes(bytes.as_ptr(), count, &mut broken);
        assert_eq!((status, broken), (BS_ERROR_BROKEN_SNAPSHOT, null_mut()));
        assert_eq!(bs_snapshot_from_bytes(null(), 0, &mut broken), BS_ERROR_BROKEN_SNAPSHOT);
        bs_snapshot_destroy(snapshot);
    }
}

#[test]
fn every_status_has_its_words() {
    let text = |status| {
        // SAFETY: texts are valid for ever.
        unsafe { CStr::from_ptr(bs_error_text(status)) }.to_str().unwrap()
    };
    let mut texts: Vec<_> = (BS_OK..=BS_ERROR_LIMIT).map(text).collect();
    texts.sort_unstable();
    texts.dedup();
    assert_eq!(texts.len(), 1 + BS_ERROR_LIMIT as usize);
    assert_eq!(text(-1), text(1000));
}

/// A callback may read the world, and is refused when it would change it.
#[test]
fn a_callback_can_read_the_world_and_not_change_it() {
    unsafe extern "C" fn predicate(user: *mut std::ffi::c_void, body: BsBody, _: BsShape) -> BsBool {
        let world = user.cast::<BsWorld>();
        // SAFETY: the test calls with its world.
        unsafe {
            let mut kind = 0;
            ok(bs_body_kind(world, body, &mut kind));
            assert_eq!(bs_world_remove_body(world, body), BS_ERROR_BUSY);
            assert_eq!(bs_world_step(world, 0.01), BS_ERROR_BUSY);
        }
        0
    }
    let world = world();
    add(&world, BS_BODY_DYNAMIC, bs_sphere(0.5), dvec3(0.0, 1.0, 0.0));
    let mut filter = bs_query_filter_default();
    filter.predicate = Some(predicate);
    filter.user = world.0.cast();
    let ray = BsRay { from: dvec3(0.0, 5.0, 0.0), path: vec3(0.0, -10.0, 0.0), reserved: 0 };
    let mut any = 9;
    // SAFETY: the world is alive.
    unsafe {
        ok(bs_world_cast_ray_any(world.0, ray, &filter, &mut any));
        assert_eq!(any, 0);
        ok(bs_world_cast_ray_any(world.0, ray, null(), &mut any));
        assert_eq!(any, 1);
    }
}
