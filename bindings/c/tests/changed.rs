//! Readings of a changed world are the values that were set; wrong values are refused.

mod common;

use backstop_c::*;
use common::*;
use std::ptr::{null, null_mut};

/// Expected: each value as it was set.
#[test]
fn bodies_and_shapes_are_read_as_they_were_set() {
    let world = world();
    let body = add(&world, BS_BODY_DYNAMIC, bs_sphere(0.5), dvec3(0.0, 1.0, 0.0));
    let (mut shapes, mut count) = ([BsShape { slot: 0, generation: 0 }], 0);
    let (mut a, mut b, mut kind, mut bits, mut more) = (0.0, 0.0, 0, 0, 0);
    let mut surface = BsSurface::default();
    // SAFETY: the world is alive, and all places are.
    unsafe {
        ok(bs_body_shapes(world.0, body, shapes.as_mut_ptr(), 1, &mut count));
        ok(bs_body_set_damping(world.0, body, 0.25, 0.5));
        ok(bs_body_damping(world.0, body, &mut a, &mut b));
        assert_eq!((a, b), (0.25, 0.5));
        ok(bs_body_set_max_speeds(world.0, body, 3.0, f32::INFINITY));
        ok(bs_body_max_speeds(world.0, body, &mut a, &mut b));
        assert_eq!((a, b), (3.0, f32::INFINITY));
        ok(bs_body_set_locked_axes(world.0, body, BS_AXIS_BIT_Z, BS_AXIS_BIT_X | BS_AXIS_BIT_Y));
        ok(bs_body_locked_axes(world.0, body, &mut bits, &mut more));
        assert_eq!((bits, more), (4, 3));
        ok(bs_body_set_kind(world.0, body, BS_BODY_KINEMATIC));
        ok(bs_body_kind(world.0, body, &mut kind));
        assert_eq!(kind, BS_BODY_KINEMATIC);
        let belt = BsSurface { rolling_friction: 0.01, surface_velocity: vec3(1.0, 0.0, 0.0), ..surface };
        let belt = BsSurface { contact_hertz: 10.0, contact_damping: 0.5, ..belt };
        ok(bs_shape_set_surface(world.0, shapes[0], belt));
        // The other part of the material leaves it.
        ok(bs_shape_set_material(world.0, shapes[0], bs_material_default()));
        ok(bs_shape_surface(world.0, shapes[0], &mut surface));
        assert_eq!(surface, belt);
        ok(bs_shape_set_surface(world.0, shapes[0], BsSurface::default()));
        ok(bs_shape_surface(world.0, shapes[0], &mut surface));
        assert_eq!(surface, BsSurface::default());
        let mut asked = 0;
        ok(bs_shape_set_senses_static(world.0, shapes[0], 1));
        ok(bs_shape_senses_static(world.0, shapes[0], &mut asked));
        assert_eq!(asked, 1);
    }
}

/// Expected: after the step, and after all that follow, the place that it was told; of one that is only
/// moved, as far again with each.
#[test]
fn a_platform_stops_where_it_was_told_to_be() {
    let world = world();
    let [stops, goes] =
        [1.0, 9.0].map(|y| add(&world, BS_BODY_KINEMATIC, bs_sphere(0.5), dvec3(0.0, y, 0.0)));
    let to = |y: f64| BsPose { position: dvec3(0.5, y, 0.0), rotation: UPRIGHT };
    // SAFETY: the world is alive.
    unsafe {
        ok(bs_body_move_kinematic_and_stop(world.0, stops, to(1.0), 1.0 / 60.0));
        ok(bs_body_move_kinematic(world.0, goes, to(9.0), 1.0 / 60.0));
    }
    steps(&world, 4);
    assert_eq!(pose(&world, stops).position, dvec3(0.5, 1.0, 0.0));
    assert!((pose(&world, goes).position.x - 2.0).abs() < 1e-5);
}

/// A soft triangle beside a rigid one, and a field with a cell that is soft and becomes a hole. Expected: the
/// balls on them sink by g / (2 pi f)² = 2.485 mm of 10 Hz, and one falls through the hole.
#[test]
fn triangles_and_cells_have_materials_and_holes() {
    let world = world();
    let corners = [vec3(-4.0, 0.0, -4.0), vec3(4.0, 0.0, -4.0), vec3(4.0, 0.0, 4.0), vec3(-4.0, 0.0, 4.0)];
    let (indices, numbers) = ([0, 2, 1, 0, 3, 2], [0, 1]);
    let spring = BsSurface { contact_hertz: 10.0, contact_damping: 1.0, ..BsSurface::default() };
    let (material, one) = (bs_material_default(), spring);
    let (mut mesh, mut field, mut soft) = (null(), null(), null());
    let (mut number, heights) = (0, [0.0; 9]);
    // SAFETY: all are alive, and of the lengths that are told.
    unsafe {
        let from = (corners.as_ptr(), indices.as_ptr());
        let make = |numbers: &[u8; 2], mesh| {
            bs_mesh_create_with_materials(from.0, 4, from.1, numbers.as_ptr(), 2, &material, &one, 1, mesh)
        };
        assert_eq!(make(&[0, 2], &mut mesh), BS_ERROR_OUT_OF_RANGE);
        assert!(mesh.is_null());
        ok(make(&numbers, &mut mesh));
        ok(bs_height_field_create(3, 3, 4.0, 4.0, heights.as_ptr(), &mut field));
        let cells = [1, 1, 1, 1];
        ok(bs_height_field_with_materials(field, cells.as_ptr(), 4, &material, &one, 1, &mut soft));
        ok(bs_height_field_material_of(soft, 3, &mut number));
        assert_eq!(number, 1);
        add(&world, BS_BODY_STATIC, bs_mesh(mesh), dvec3(0.0, 0.0, 0.0));
        let ground = add(&world, BS_BODY_STATIC, bs_height_field(soft), dvec3(20.0, 0.0, 0.0));
        let at = [dvec3(2.0, 0.5, -2.0), dvec3(-2.0, 0.5, 2.0), dvec3(22.0, 0.5, 2.0)];
        let balls = at.map(|at| add(&world, BS_BODY_DYNAMIC, bs_sphere(0.5), at));
        steps(&world, 300);
        let depths = balls.map(|ball| 0.5 - pose(&world, ball).position.y);
        let sag = 9.81 / (std::f64::consts::TAU * 10.0).powi(2);
        for (depth, expected) in depths.into_iter().zip([0.0, sag, sag]) {
            assert!((depth - expected).abs() < 0.01 * sag, "{depths:?}");
        }
        let (mut shape, mut count) = ([BsShape { slot: 0, generation: 0 }], 0);
        ok(bs_body_shapes(world.0, ground, shape.as_mut_ptr(), 1, &mut count));
        assert_eq!(bs_shape_set_holes(world.0, shape[0], 2, 0, 1, 1, [1].as_ptr()), BS_ERROR_OUT_OF_RANGE);
        ok(bs_shape_set_holes(world.0, shape[0], 0, 0, 1, 1, [1].as_ptr()));
        steps(&world, 60);
        assert!(pose(&world, balls[2]).position.y < -3.0);
        bs_mesh_release(mesh);
        bs_height_field_release(field);
        bs_height_field_release(soft);
    }
}

#[test]
fn changes_that_are_wrong_are_refused() {
    let world = world();
    let body = add(&world, BS_BODY_DYNAMIC, bs_sphere(0.5), dvec3(0.0, 1.0, 0.0));
    let (shape, joint) = (BsShape { slot: 9, generation: 1 }, BsJoint { slot: 9, generation: 1 });
    let (before, mut number) = (hash(&world), 0.0);
    // SAFETY: what is not null is alive.
    unsafe {
        assert_eq!(bs_body_set_damping(null_mut(), body, 0.0, 0.0), BS_ERROR_NULL);
        assert_eq!(bs_body_set_damping(world.0, body, f32::NAN, 0.0), BS_ERROR_NOT_FINITE);
        assert_eq!(bs_body_set_damping(world.0, NO_BODY, 0.0, 0.0), BS_ERROR_STALE_BODY);
        assert_eq!(bs_body_set_kind(world.0, body, 3), BS_ERROR_CONSTANT);
        assert_eq!(bs_body_set_locked_axes(world.0, body, 8, 0), BS_ERROR_CONSTANT);
        assert_eq!(bs_body_gravity_scale(world.0, body, null_mut()), BS_ERROR_NULL);
        assert_eq!(bs_shape_density(world.0, shape, &mut number), BS_ERROR_STALE_SHAPE);
        assert_eq!(bs_shape_set_geometry(world.0, shape, null()), BS_ERROR_NULL);
        assert_eq!(bs_joint_set_motor(world.0, joint, null()), BS_ERROR_NULL);
        let status = bs_joint_set_target(world.0, joint, BS_MOTION_ANGULAR, BS_AXIS_X, 0.0, 0.0);
        assert_eq!(status, BS_ERROR_STALE_JOINT);
        let mut hull = null();
        assert_eq!(bs_hull_from_bytes([1, 2, 3].as_ptr(), 3, &mut hull), BS_ERROR_BROKEN_SHAPE);
        assert!(hull.is_null());
    }
    assert_eq!(hash(&world), before);
}

/// Expected: bytes that are read and written again are the same bytes; a ball on a plane has one contact.
#[test]
fn baked_hulls_come_back_and_contacts_are_told() {
    let points = [vec3(0.0, 0.0, 0.0), vec3(1.0, 0.0, 0.0), vec3(0.0, 1.0, 0.0), vec3(0.0, 0.0, 1.0)];
    let (mut hull, mut again, mut count) = (null(), null(), 0);
    let world = world();
    add(&world, BS_BODY_STATIC, bs_plane(), dvec3(0.0, 0.0, 0.0));
    let ball = add(&world, BS_BODY_DYNAMIC, bs_sphere(0.5), dvec3(0.0, 0.5, 0.0));
    steps(&world, 60);
    // SAFETY: all objects are alive, and buffers are as long as they are said to be.
    unsafe {
        ok(bs_hull_create(points.as_ptr(), 4, &mut hull));
        assert_eq!(bs_hull_to_bytes(hull, null_mut(), 0, &mut count), BS_ERROR_BUFFER);
        let (mut one, mut two) = (vec![0; count], vec![1; count]);
        ok(bs_hull_to_bytes(hull, one.as_mut_ptr(), count, &mut count));
        ok(bs_hull_from_bytes(one.as_ptr(), count, &mut again));
        ok(bs_hull_to_bytes(again, two.as_mut_ptr(), count, &mut count));
        assert_eq!(one, two);
        bs_hull_release(hull);
        bs_hull_release(again);
        assert_eq!(bs_body_contacts(world.0, ball, null_mut(), 0, &mut count), BS_ERROR_BUFFER);
        assert_eq!(count, 1);
    }
}

/// A rope over two pulleys with 3 kg and 1 kg at its ends. Expected: (3 - 1) / (3 + 1) g of acceleration, so
/// 2.4525 m/s after half a second, and the joint that hangs a lamp of 1 kg strained by its weight, 9.81 N.
#[test]
fn a_rope_joins_two_weights_and_a_lamp_strains_its_joint() {
    let world = world();
    let wall = add(&world, BS_BODY_STATIC, bs_sphere(0.1), dvec3(0.0, 9.0, 9.0));
    let weight = |x: f64, mass: f32| {
        let mut shape = bs_shape_desc_default(bs_box(0.1, 0.1, 0.1));
        shape.density = mass / 0.008;
        add_shape(&world, BS_BODY_DYNAMIC, &shape, dvec3(x, 0.0, 0.0))
    };
    let (heavy, light, lamp) = (weight(-1.0, 3.0), weight(1.0, 1.0), weight(3.0, 1.0));
    let join = |kind: BsJointKind, body: BsBody, above: BsVec3| {
        let mut desc = bs_joint_desc_default(kind, wall, body);
        // In the frame of the wall's body.
        desc.frames[0].position = above;
        desc.force_threshold = 5.0;
        let mut joint = BsJoint { slot: 0, generation: 0 };
        // SAFETY: the world is alive, and both places are.
        ok(unsafe { bs_world_add_joint(world.0, &desc, &mut joint) });
        joint
    };
    let ropes = [(heavy, -1.0), (light, 1.0)].map(|(body, x)| join(BS_JOINT_FREE, body, vec3(x, -5.0, -9.0)));
    let hook = join(BS_JOINT_BALL, lamp, vec3(3.0, -9.0, -9.0));
    let mut coupling = BsCoupling { slot: 0, generation: 0 };
    let mut desc = bs_coupling_desc_pulley(ropes[0], ropes[1], 1.0, 8.0);
    let (mut velocity, mut sum, mut count) = (vec3(0.0, 0.0, 0.0), 0.0, 0);
    let mut strained = [BsStrainedJoint { joint: hook, force: velocity, torque: velocity }];
    // SAFETY: the world is alive, and all places are.
    unsafe {
        ok(bs_world_add_coupling(world.0, &desc, &mut coupling));
        desc.motions[0].factor = 0.0;
        assert_eq!(bs_world_add_coupling(world.0, &desc, null_mut()), BS_ERROR_OUT_OF_RANGE);
        steps(&world, 30);
        ok(bs_body_velocity(world.0, light, &mut velocity, null_mut()));
        assert!((velocity.y - 2.4525).abs() < 0.01, "{velocity:?}");
        ok(bs_coupling_sum(world.0, coupling, &mut sum));
        assert!((sum - 8.0).abs() < 1e-3, "{sum}");
        ok(bs_world_strained_joints(world.0, strained.as_mut_ptr(), 1, &mut count));
        assert_eq!((count, strained[0].joint), (1, hook));
        assert!((strained[0].force.y - 9.81).abs() < 0.05, "{:?}", strained[0]);
        couplings_are_read_as_they_were_set(&world, coupling, ropes[0]);
        ok(bs_world_remove_coupling(world.0, coupling));
        assert_eq!(bs_world_contains_coupling(world.0, coupling), 0);
        assert_eq!(bs_coupling_keep(world.0, coupling), BS_ERROR_STALE_COUPLING);
        assert_eq!(bs_coupling_desc(world.0, coupling, &mut desc), BS_ERROR_STALE_COUPLING);
        assert_eq!(bs_coupling_sum(world.0, coupling, &mut sum), BS_ERROR_STALE_COUPLING);
    }
}

/// Expected: each value as it was set.
fn couplings_are_read_as_they_were_set(world: &World, coupling: BsCoupling, rope: BsJoint) {
    let (mut found, mut count) = ([BsCoupling { slot: 0, generation: 0 }], 0);
    let mut desc = bs_coupling_desc_pulley(rope, rope, 1.0, 1.0);
    // SAFETY: the world is alive, and all places are.
    unsafe {
        assert_eq!(bs_world_contains_coupling(world.0, coupling), 1);
        ok(bs_world_coupling_count(world.0, &mut count));
        assert_eq!(count, 1);
        ok(bs_joint_couplings(world.0, rope, found.as_mut_ptr(), 1, &mut count));
        assert_eq!((count, found[0]), (1, coupling));
        ok(bs_coupling_set_break_force(world.0, coupling, 1e4, 2e4));
        assert!(bs_coupling_set_break_force(world.0, coupling, f32::NAN, 1.0) != BS_OK);
        ok(bs_coupling_set_user_data(world.0, coupling, 7));
        ok(bs_coupling_desc(world.0, coupling, &mut desc));
        assert_eq!((desc.has_range, desc.max, desc.motions[0].joint), (1, 8.0, rope));
        assert_eq!((desc.break_force, desc.user_data), ([1e4, 2e4], 7));
        ok(bs_coupling_keep(world.0, coupling));
        ok(bs_coupling_desc(world.0, coupling, &mut desc));
        // Its range has no width, and is where the sum is.
        let mut sum = 0.0;
        ok(bs_coupling_sum(world.0, coupling, &mut sum));
        assert_eq!((desc.has_range, desc.min, desc.max), (1, sum, sum));
    }
}

/// Expected: the one shape whose box meets the area, and its box.
#[test]
fn boxes_are_found_by_a_box() {
    let world = world();
    let ball = add(&world, BS_BODY_STATIC, bs_sphere(0.5), dvec3(0.0, 1.0, 0.0));
    add(&world, BS_BODY_STATIC, bs_sphere(0.5), dvec3(5.0, 1.0, 0.0));
    let area = BsAabb { min: dvec3(-1.0, 0.0, -1.0), max: dvec3(0.0, 0.6, 0.0) };
    let mut found = [BsOverlap { body: NO_BODY, shape: BsShape { slot: 0, generation: 0 } }; 2];
    let mut count = 0;
    // SAFETY: the world is alive, and all places are.
    ok(unsafe { bs_world_overlap_aabb(world.0, area, null(), found.as_mut_ptr(), 2, &mut count) });
    assert_eq!((count, found[0].body), (1, ball));
}
