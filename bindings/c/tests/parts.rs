//! The interface besides bodies, joints and queries: settings, shared shapes, sensors, characters,
//! drawing, sleep.

mod common;

use backstop_c::*;
use common::*;
use std::ffi::{CStr, c_void};
use std::ptr::{null, null_mut};

#[test]
fn settings_come_back_as_they_were_given() {
    let world = world();
    let mut given = bs_settings_default();
    given.gravity = vec3(1.0, -2.0, 3.0);
    given.threads = 3;
    given.continuous_method = BS_METHOD_TALK;
    given.friction_model = BS_FRICTION_PER_POINT;
    given.order.swap(0, 6);
    given.sleeping = 1;
    given.budget = 1 << 30;
    given.budget_of[BS_CATEGORY_ROWS as usize] = 1 << 20;
    let mut found = bs_settings_default();
    // SAFETY: the world is alive.
    unsafe {
        ok(bs_world_set_settings(world.0, &given));
        ok(bs_world_settings(world.0, &mut found));
    }
    assert_eq!(found, given);
    // Null is the defaults.
    // SAFETY: the world is alive.
    unsafe {
        ok(bs_world_set_settings(world.0, null()));
        ok(bs_world_settings(world.0, &mut found));
    }
    assert_eq!(found, bs_settings_default());
}

#[test]
fn a_budget_refuses_what_does_not_fit() {
    let world = world();
    let mut settings = bs_settings_default();
    settings.budget = 1000;
    let shape = bs_shape_desc_default(bs_sphere(0.5));
    let mut desc = bs_body_desc_default();
    (desc.shapes, desc.shape_count) = (&shape, 1);
    let descs = [desc; 100];
    let mut count = 9;
    // SAFETY: the world is alive.
    unsafe {
        ok(bs_world_set_settings(world.0, &settings));
        assert_eq!(bs_world_add_bodies(world.0, descs.as_ptr(), 100, null_mut()), BS_ERROR_BUDGET);
        ok(bs_world_counts(world.0, &mut count, null_mut(), null_mut(), null_mut()));
        assert_eq!(count, 0);
        ok(bs_world_set_settings(world.0, null()));
        ok(bs_world_add_bodies(world.0, descs.as_ptr(), 100, null_mut()));
        ok(bs_world_counts(world.0, &mut count, null_mut(), null_mut(), null_mut()));
        assert_eq!(count, 100);
    }
}

/// A hull lives as long as any reference or shape: it can be read after its maker has let go of it.
#[test]
fn shared_shapes_live_as_long_as_somebody_has_them() {
    let world = world();
    let corner = |i: u8| vec3(f32::from(i & 1), f32::from(i >> 1 & 1), f32::from(i >> 2));
    let points = [0, 1, 2, 3, 4, 5, 6, 7].map(corner);
    let (mut hull, mut count) = (null(), 0);
    let mut vertices = [vec3(0.0, 0.0, 0.0); 8];
    // SAFETY: all references are counted, and the world is alive.
    unsafe {
        ok(bs_hull_create(points.as_ptr(), 8, &mut hull));
        let body = add(&world, BS_BODY_DYNAMIC, bs_hull(hull), dvec3(0.0, 0.0, 0.0));
        bs_hull_release(hull);
        let mut shape = BsShape::NONE;
        ok(bs_body_shapes(world.0, body, &mut shape, 1, &mut count));
        let mut geometry = bs_plane();
        ok(bs_shape_geometry(world.0, shape, &mut geometry));
        assert_eq!((geometry.kind, geometry.hull), (BS_GEOMETRY_HULL, hull));
        ok(bs_hull_retain(geometry.hull));
        ok(bs_world_remove_body(world.0, body));
        ok(bs_hull_vertices(geometry.hull, vertices.as_mut_ptr(), 8, &mut count));
        let mut mass = BsMassProperties { mass: 0.0, centre_of_mass: vec3(0.0, 0.0, 0.0), inertia: [0.0; 9] };
        // A cube of 1 m and 1000 kg: its centre in the middle, m/6 about each axis.
        ok(bs_geometry_mass(&geometry, 1000.0, &mut mass));
        assert!((mass.mass - 1000.0).abs() < 0.01 && (mass.centre_of_mass.x - 0.5).abs() < 1e-5);
        assert!((mass.inertia[0] - 1000.0 / 6.0).abs() < 0.01);
        assert_eq!(bs_geometry_triangles(&geometry, null_mut(), 0, &mut count), BS_ERROR_BUFFER);
        bs_hull_release(geometry.hull);
    }
    assert_eq!(vertices, points);
    // Two triangles a side.
    assert_eq!(count, 36);
}

/// Expected: two triangles of a square, its corners in the order that was given; two triangles for each cell.
#[test]
fn meshes_and_fields_tell_their_triangles() {
    let square = [vec3(0.0, 0.0, 0.0), vec3(0.0, 0.0, 1.0), vec3(1.0, 0.0, 1.0), vec3(1.0, 0.0, 0.0)];
    let indices = [0_u32, 1, 2, 0, 2, 3, 0, 0, 1];
    let heights = [0.0_f32; 6];
    let (mut mesh, mut field, mut count) = (null(), null(), 0);
    let mut corners = [vec3(9.0, 9.0, 9.0); 3];
    // SAFETY: all pointers are to what lives here.
    unsafe {
        ok(bs_mesh_create(square.as_ptr(), 4, indices.as_ptr(), 3, &mut mesh));
        ok(bs_mesh_triangle_count(mesh, &mut count));
        assert_eq!(count, 2);
        ok(bs_mesh_corners(mesh, 0, corners.as_mut_ptr()));
        assert!(corners.iter().all(|corner| square.contains(corner)));
        assert_eq!(bs_mesh_corners(mesh, 2, corners.as_mut_ptr()), BS_ERROR_CONSTANT);
        bs_mesh_release(mesh);
        ok(bs_height_field_create(3, 2, 1.0, 1.0, heights.as_ptr(), &mut field));
        ok(bs_height_field_triangle_count(field, &mut count));
        assert_eq!(count, 4);
        ok(bs_height_field_corners(field, 3, corners.as_mut_ptr()));
        bs_height_field_release(field);
        let huge = usize::MAX / 2;
        assert_eq!(bs_height_field_create(huge, 4, 1.0, 1.0, heights.as_ptr(), &mut field), BS_ERROR_NULL);
    }
}

/// Expected: a ball that falls from rest crosses a box at its own time, `v = g t` on the way.
#[test]
fn a_sensor_notices_what_falls_through_it() {
    let world = world();
    let mut desc = bs_shape_desc_default(bs_box(1.0, 0.5, 1.0));
    desc.sensor = 1;
    let sensor = add_shape(&world, BS_BODY_STATIC, &desc, dvec3(0.0, 0.0, 0.0));
    let ball = add(&world, BS_BODY_DYNAMIC, bs_sphere(0.25), dvec3(0.0, 2.0, 0.0));
    let (mut entered, mut left, mut inside) = (0, 0, 0);
    let (mut sensor_shape, mut ball_shape, mut count) = (BsShape::NONE, BsShape::NONE, 0);
    // SAFETY: the world is alive, and arrays are read before the next step.
    unsafe {
        ok(bs_body_shapes(world.0, sensor, &mut sensor_shape, 1, &mut count));
        ok(bs_body_shapes(world.0, ball, &mut ball_shape, 1, &mut count));
        for _ in 0..90 {
            steps(&world, 1);
            let mut events = null();
            ok(bs_world_sensor_begins(world.0, &mut events, &mut count));
            for event in std::slice::from_raw_parts(events, count) {
                assert_eq!((event.sensor, event.visitor), (sensor_shape, ball_shape));
                entered += 1;
            }
            ok(bs_world_sensor_ends(world.0, &mut events, &mut count));
            left += count;
            let mut visitor = BsShape::NONE;
            ok(bs_sensor_overlaps(world.0, sensor_shape, &mut visitor, 1, &mut count));
            inside += count;
        }
    }
    assert_eq!((entered, left), (1, 1));
    // From 1.25 m below its start to 2.75 m: sqrt(2 h / g) = 0.51 s to 0.75 s, 14 or 15 steps.
    assert!((14..=15).contains(&inside), "{inside}");
}

/// Expected: on level ground a character moves by velocity times time and stands a skin above it.
#[test]
fn a_character_walks_and_stops_at_a_wall() {
    let world = world();
    add(&world, BS_BODY_STATIC, bs_plane(), dvec3(0.0, 0.0, 0.0));
    add(&world, BS_BODY_STATIC, bs_box(0.5, 5.0, 5.0), dvec3(3.5, 0.0, 0.0));
    let mut report = BsCharacterReport::default();
    let (mut walker, mut count) = (null_mut(), 0);
    let (mut middle, mut feet) = (dvec3(0.0, 0.0, 0.0), dvec3(0.0, 0.0, 0.0));
    // SAFETY: all objects are alive.
    unsafe {
        ok(bs_character_create(null(), dvec3(0.0, 0.92, 0.0), &mut walker));
        let walk =
            |velocity, report| bs_character_walk(walker, world.0, null(), velocity, 1.0 / 60.0, report);
        assert_eq!(walk(vec3(f32::NAN, 0.0, 0.0), &mut report), BS_ERROR_NOT_FINITE);
        ok(walk(vec3(0.0, -0.1, 0.0), &mut report));
        assert_eq!(report.on_ground, 1);
        for _ in 0..60 {
            ok(walk(vec3(2.0, 0.0, 0.0), &mut report));
        }
        assert!((report.position.x - 2.0).abs() < 1e-4, "{report:?}");
        for _ in 0..60 {
            ok(walk(vec3(2.0, 0.0, 0.0), null_mut()));
        }
        ok(bs_character_position(walker, &mut middle, &mut feet));
        // The wall's face is at 3 m; radius and skin are 0.32 m.
        assert!((middle.x - 2.68).abs() < 1e-3, "{middle:?}");
        assert!(feet.y.abs() < 1e-3, "{feet:?}");
        let mut hits = [BsCharacterHit::default(); 8];
        ok(bs_character_hits(walker, hits.as_mut_ptr(), 8, &mut count));
        assert!(count > 0 && (hits[0].normal.x + 1.0).abs() < 1e-3);
        ok(bs_character_push(walker, world.0));
        let mut settings = bs_character_settings_default();
        settings.radius = -1.0;
        assert_eq!(bs_character_set_settings(walker, &settings), BS_ERROR_OUT_OF_RANGE);
        ok(bs_character_settings(walker, &mut settings));
        assert_eq!(settings.radius, 0.3);
        bs_character_destroy(walker);
    }
}

/// Expected: functions and arrays get the same lines and points.
#[test]
fn a_world_is_drawn_by_functions_and_into_arrays() {
    #[derive(Default)]
    struct Seen {
        lines: Vec<BsLine>,
        points: Vec<BsPoint>,
        shapes: Vec<BsBodyKind>,
    }
    unsafe extern "C" fn line(user: *mut c_void, line: *const BsLine) {
        // SAFETY: the test calls with what it has.
        unsafe { (*user.cast::<Seen>()).lines.push(*line) }
    }
    unsafe extern "C" fn point(user: *mut c_void, point: *const BsPoint) {
        // SAFETY: the test calls with what it has.
        unsafe { (*user.cast::<Seen>()).points.push(*point) }
    }
    unsafe extern "C" fn shape(user: *mut c_void, shape: *const BsDrawnShape) {
        // SAFETY: the test calls with what it has.
        unsafe { (*user.cast::<Seen>()).shapes.push((*shape).kind) }
    }
    let world = world();
    add(&world, BS_BODY_STATIC, bs_box(2.0, 0.5, 2.0), dvec3(0.0, -0.5, 0.0));
    add(&world, BS_BODY_DYNAMIC, bs_box(0.5, 0.5, 0.5), dvec3(0.0, 0.5, 0.0));
    steps(&world, 10);
    let mut seen = Seen::default();
    let mut calls = bs_draw_calls_default();
    (calls.user, calls.line, calls.point) = ((&raw mut seen).cast(), Some(line as _), Some(point as _));
    let (mut line_count, mut point_count) = (0, 0);
    // SAFETY: the world is alive, and buffers are as long as they are said to be.
    unsafe {
        ok(bs_world_draw(world.0, null(), &calls));
        let (no, none) = (null_mut(), null_mut());
        let counted =
            bs_world_draw_arrays(world.0, null(), no, 0, &mut line_count, none, 0, &mut point_count);
        assert_eq!(counted, BS_ERROR_BUFFER);
        let mut lines = seen.lines.clone();
        let mut points = seen.points.clone();
        lines.iter_mut().for_each(|line| line.ink.element = BS_ELEMENT_OTHER);
        points.iter_mut().for_each(|point| point.ink.element = BS_ELEMENT_OTHER);
        assert_eq!((lines.len(), points.len()), (line_count, point_count));
        let (l, p) = (lines.as_mut_ptr(), points.as_mut_ptr());
        let (lc, pc) = (lines.len(), points.len());
        ok(bs_world_draw_arrays(world.0, null(), l, lc, &mut line_count, p, pc, &mut point_count));
        assert_eq!((&lines, &points), (&seen.lines, &seen.points));
        calls.shape = Some(shape as _);
        ok(bs_world_draw(world.0, null(), &calls));
    }
    // Twelve edges of two boxes; four points of contact.
    assert!(seen.lines.len() >= 24 && seen.points.len() >= 4);
    seen.shapes.sort_unstable();
    assert_eq!(seen.shapes, [BS_BODY_STATIC, BS_BODY_DYNAMIC]);
}

#[test]
fn bodies_sleep_wake_and_are_switched_off() {
    let world = world();
    let mut settings = bs_settings_default();
    settings.sleeping = 1;
    add(&world, BS_BODY_STATIC, bs_plane(), dvec3(0.0, 0.0, 0.0));
    let body = add(&world, BS_BODY_DYNAMIC, bs_box(0.5, 0.5, 0.5), dvec3(0.0, 0.5, 0.0));
    let (mut asleep, mut enabled, mut count) = (9, 9, 9);
    // SAFETY: the world is alive.
    unsafe {
        ok(bs_world_set_settings(world.0, &settings));
        steps(&world, 60);
        ok(bs_body_is_sleeping(world.0, body, &mut asleep));
        ok(bs_world_counts(world.0, null_mut(), null_mut(), &mut count, null_mut()));
        assert_eq!((asleep, count), (1, 1));
        ok(bs_body_wake(world.0, body));
        ok(bs_body_is_sleeping(world.0, body, &mut asleep));
        ok(bs_body_set_enabled(world.0, body, 0));
        ok(bs_body_is_enabled(world.0, body, &mut enabled));
        assert_eq!((asleep, enabled), (0, 0));
        ok(bs_body_set_enabled(world.0, body, 7));
        ok(bs_body_is_enabled(world.0, body, &mut enabled));
        assert_eq!(enabled, 1);
    }
}

#[test]
fn the_model_names_what_the_content_needs() {
    let world = world();
    add(&world, BS_BODY_DYNAMIC, bs_sphere(0.5), dvec3(0.0, 1.0, 0.0));
    let (mut parts, mut count) = ([BsFeatureCost::default(); 64], 0);
    // SAFETY: the world is alive, and the buffer is as long as it is said to be.
    ok(unsafe { bs_world_feature_report(world.0, parts.as_mut_ptr(), 64, &mut count) });
    let needed = |name: &str| {
        let is = |part: &&BsFeatureCost| {
            // SAFETY: names are valid for ever.
            unsafe { CStr::from_ptr(bs_feature_name(part.feature)) }.to_str() == Ok(name)
        };
        parts[..count].iter().find(is).map(|part| part.count)
    };
    assert_eq!((needed("joints"), needed("friction")), (Some(0), Some(1)));
}

/// Expected: threads that only read get the answer of one alone, and none is refused.
#[test]
fn any_number_of_threads_may_ask_at_once() {
    let world = world();
    add(&world, BS_BODY_DYNAMIC, bs_sphere(0.5), dvec3(0.0, 1.0, 0.0));
    let ray = BsRay { from: dvec3(0.0, 5.0, 0.0), path: vec3(0.0, -10.0, 0.0), reserved: 0 };
    // The address crosses threads; the interface says that it may.
    let address = world.0 as usize;
    let ask = move || {
        let (mut hit, world) = (BsHit::default(), address as *const BsWorld);
        for _ in 0..1000 {
            // SAFETY: the world outlives the scope of the threads.
            ok(unsafe { bs_world_cast_ray(world, ray, null(), &mut hit) });
        }
        hit
    };
    let hits: Vec<_> = std::thread::scope(|scope| {
        let threads = [0; 4].map(|_| scope.spawn(ask));
        threads.into_iter().map(|thread| thread.join().unwrap()).collect()
    });
    // The top is at 1.5 m: 3.5 m of 10.
    assert!(hits.iter().all(|hit| *hit == hits[0] && (hit.fraction - 0.35).abs() < 1e-6));
}
