//! Impossible input is refused, by an error that says why; a refused call changes nothing.

#![allow(clippy::disallowed_methods, reason = "expected values may use the platform's functions")]

use crate::common::{self, Floor, dynamic, flat_mesh};
use backstop::glam::{DVec3, Mat3, Quat, Vec2, Vec3};
use backstop::limits;
use backstop::{
    Axes, Axis, BodyDesc, BodyHandle, Budget, Category, ContinuousMode, ConvexHull, Error, Filter, Frame,
    Geometry, HeightField, JointDesc, Limit, MassProperties, Material, Motion, Motor, Settings, ShapeDesc,
    TriangleMesh, World,
};

const BAD: [f32; 3] = [f32::NAN, f32::INFINITY, f32::NEG_INFINITY];

/// A world in which something happens, some steps old, and one of its bodies.
fn world() -> (World, BodyHandle) {
    let mut world = World::new(Settings::default()).unwrap();
    world.add_body(&Floor::Box.desc(Material::default())).unwrap();
    let body = dynamic(Geometry::cuboid(0.5, 0.5, 0.5), Material::default(), Vec3::new(0.0, 0.6, 0.0));
    let body = world.add_body(&body.with_velocity(Vec3::X, Vec3::Y)).unwrap();
    common::steps(&mut world, 30, 1.0 / 60.0);
    (world, body)
}

/// Makes the call, which must fail and leave the world as it was. Returns why it was refused.
#[track_caller]
fn refused<T>(what: &str, world: &mut World, call: impl FnOnce(&mut World) -> Result<T, Error>) -> Error {
    let state = |w: &World| (w.state_hash(), w.memory(), w.body_count(), *w.report(), w.settings().clone());
    let before = state(world);
    let Err(error) = call(world) else { panic!("{what} was accepted") };
    assert_eq!(state(world), before, "{what} changed the world");
    assert!(!error.to_string().is_empty());
    error
}

#[track_caller]
fn refused_body(what: &str, desc: &BodyDesc) -> Error {
    let (mut world, _) = world();
    // All of several bodies, or none.
    let good = BodyDesc::dynamic().with_shape(ShapeDesc::new(Geometry::Sphere { radius: 0.1 }));
    refused(what, &mut world, |w| w.add_bodies(&[good.clone(), desc.clone(), good.clone()]));
    refused(what, &mut world, |w| w.add_body(desc))
}

fn ball() -> BodyDesc {
    BodyDesc::dynamic().with_shape(ShapeDesc::new(Geometry::Sphere { radius: 0.5 }))
}

#[test]
fn numbers_of_a_body_must_be_finite() {
    for bad in BAD {
        for axis in 0..3 {
            let (mut at, mut v) = (DVec3::ZERO, Vec3::ZERO);
            (at[axis], v[axis]) = (bad.into(), bad);
            refused_body("position", &ball().with_position(at));
            refused_body("velocity", &ball().with_velocity(v, Vec3::ZERO));
            refused_body("spin", &ball().with_velocity(Vec3::ZERO, v));
            let mut desc = ball();
            desc.shapes[0].position = v;
            refused_body("shape position", &desc);
        }
        refused_body("rotation", &ball().with_rotation(Quat::from_xyzw(0.0, bad, 0.0, 1.0)));
        let mut desc = ball();
        desc.gravity_scale = bad;
        refused_body("gravity scale", &desc);
        let mut desc = ball();
        desc.shapes[0].rotation.w = bad;
        refused_body("shape rotation", &desc);
    }
    refused_body("rotation of length 0", &ball().with_rotation(Quat::from_xyzw(0.0, 0.0, 0.0, 0.0)));
    refused_body("rotation of length 2", &ball().with_rotation(Quat::from_xyzw(0.0, 0.0, 0.0, 2.0)));
}

#[test]
fn mass_must_be_that_of_a_body() {
    let good = MassProperties { mass: 1.0, centre_of_mass: Vec3::ZERO, inertia: Mat3::IDENTITY };
    let mut bad = Vec::new();
    for mass in [0.0, -1.0, f32::NAN, f32::INFINITY] {
        bad.push(("mass", MassProperties { mass, ..good }));
    }
    for x in [0.0, -1.0, f32::NAN, f32::INFINITY] {
        let inertia = Mat3::from_diagonal(Vec3::new(1.0, x, 1.0));
        bad.push(("inertia", MassProperties { inertia, ..good }));
    }
    // No body turns harder about one axis than about the two others together.
    let inertia = Mat3::from_diagonal(Vec3::new(1.0, 1.0, 3.0));
    bad.push(("triangle inequality", MassProperties { inertia, ..good }));
    let mut inertia = Mat3::IDENTITY;
    inertia.y_axis.x = 0.5;
    bad.push(("asymmetry", MassProperties { inertia, ..good }));
    bad.push(("centre", MassProperties { centre_of_mass: Vec3::new(f32::NAN, 0.0, 0.0), ..good }));
    for (what, mass) in bad {
        let mut desc = ball();
        desc.mass = Some(mass);
        refused_body(what, &desc);
        let (mut world, body) = world();
        refused(what, &mut world, |w| w.set_mass(body, mass));
    }
    for density in [-1.0, f32::NAN, f32::INFINITY] {
        let mut desc = ball();
        desc.shapes[0].density = density;
        refused_body("density", &desc);
    }
    let mut weightless = ball();
    weightless.shapes[0].density = 0.0;
    assert_eq!(refused_body("no density", &weightless), Error::NoMass);
    assert_eq!(refused_body("no shape", &BodyDesc::dynamic()), Error::NoMass);
    // The last shape that gives a body its mass stays.
    let (mut world, body) = world();
    let shape = world.shapes(body).unwrap().next().unwrap();
    assert_eq!(refused("last shape", &mut world, |w| w.remove_shape(shape)), Error::NoMass);
}

/// Finite, but so that mass or inertia is not: infinitely heavy or light bodies must be said to be so.
#[test]
fn mass_must_stay_in_the_range_of_numbers() {
    for radius in [1e20, 1e-20] {
        refused_body(
            "a radius",
            &BodyDesc::dynamic().with_shape(ShapeDesc::new(Geometry::Sphere { radius })),
        );
    }
    let mut desc = BodyDesc::dynamic().with_shape(ShapeDesc::new(Geometry::Sphere { radius: 1.0 }));
    desc.shapes[0].density = f32::MAX;
    refused_body("density", &desc);
}

#[test]
fn shapes_must_have_a_size() {
    let mut shapes = Vec::new();
    for bad in [0.0, -1.0, f32::NAN, f32::INFINITY] {
        shapes.push(Geometry::Sphere { radius: bad });
        shapes.push(Geometry::capsule(0.5, bad));
        shapes.push(Geometry::Capsule { half_height: 0.5, radius_bottom: 0.2, radius_top: bad });
        for axis in 0..3 {
            let mut half_extents = Vec3::ONE;
            half_extents[axis] = bad;
            shapes.push(Geometry::Box { half_extents });
        }
        shapes.push(Geometry::cylinder(0.5, bad));
        shapes.push(Geometry::cylinder(bad, 0.5));
    }
    for bad in [-1.0, f32::NAN, f32::INFINITY] {
        shapes.push(Geometry::capsule(bad, 0.5));
        shapes.push(Geometry::Cylinder { half_height: 0.5, radius_bottom: bad, radius_top: 0.5 });
    }
    for geometry in shapes {
        let what = format!("{geometry:?}");
        let shape = ShapeDesc::new(geometry);
        refused_body(&what, &BodyDesc::dynamic().with_shape(shape.clone()));
        refused_body(&what, &BodyDesc::fixed().with_shape(shape.clone()));
        let (mut world, body) = world();
        refused(&what, &mut world, |w| w.add_shape(body, &shape));
    }
}

#[test]
fn geometry_without_volume_or_area_is_refused() {
    assert!(ConvexHull::new(&[]).is_err());
    assert!(ConvexHull::new(&[Vec3::ZERO; 10]).is_err());
    assert!(ConvexHull::new(&[Vec3::ZERO, Vec3::X, Vec3::Y, Vec3::X + Vec3::Y]).is_err());
    assert!(ConvexHull::new(&[Vec3::ZERO, Vec3::X, Vec3::Y, Vec3::Z * f32::NAN]).is_err());
    let corners = vec![Vec3::ZERO, Vec3::X, Vec3::Y];
    assert!(TriangleMesh::new(vec![], vec![]).is_err());
    assert!(TriangleMesh::new(corners.clone(), vec![[0, 1, 3]]).is_err());
    assert!(TriangleMesh::new(corners.clone(), vec![[0, 1, 1]]).is_err());
    assert!(TriangleMesh::new(vec![Vec3::ZERO, Vec3::X, Vec3::INFINITY], vec![[0, 1, 2]]).is_err());
    assert!(HeightField::new(1, 1, Vec2::ONE, vec![0.0]).is_err());
    assert!(HeightField::new(2, 2, Vec2::ONE, vec![0.0; 3]).is_err());
    assert!(HeightField::new(2, 2, Vec2::ZERO, vec![0.0; 4]).is_err());
    assert!(HeightField::new(2, 2, Vec2::ONE, vec![f32::NAN; 4]).is_err());
}

#[test]
fn what_has_no_inside_can_not_be_dynamic() {
    let field = HeightField::new(2, 2, Vec2::ONE, vec![0.0; 4]).unwrap();
    for geometry in [Geometry::Plane, flat_mesh(2, 1.0), Geometry::HeightField(field.into())] {
        let mut desc = ball();
        desc.shapes.push(ShapeDesc::new(geometry.clone()));
        assert!(matches!(refused_body("dynamic", &desc).innermost(), Error::StaticOnly { .. }));
        let (mut world, body) = world();
        let shape = ShapeDesc::new(geometry.clone());
        let error = refused("dynamic", &mut world, |w| w.add_shape(body, &shape));
        assert!(matches!(error, Error::StaticOnly { .. }));
        world.add_body(&BodyDesc::kinematic().with_shape(shape.clone())).unwrap();
        world.add_body(&BodyDesc::fixed().with_shape(shape)).unwrap();
    }
}

#[test]
fn materials_must_be_in_range() {
    let good = Material::default();
    let mut bad = Vec::new();
    for x in [-0.1, f32::NAN, f32::INFINITY] {
        bad.push(good.with_static_friction(x));
        bad.push(good.with_dynamic_friction(x));
        bad.push(good.with_restitution(x));
        bad.push(good.with_rolling_friction(x));
        bad.push(good.with_spinning_friction(x));
        bad.push(good.with_contact_hertz(x));
        bad.push(good.with_contact_damping(x));
    }
    bad.push(good.with_surface_velocity(Vec3::new(0.0, f32::NAN, 0.0)));
    bad.push(good.with_surface_velocity(Vec3::X * 1e7));
    bad.push(good.with_restitution(1.1));
    for material in bad {
        let mut desc = ball();
        desc.shapes[0].material = material;
        refused_body("material", &desc);
        let (mut world, body) = world();
        let shape = world.shapes(body).unwrap().next().unwrap();
        refused("material", &mut world, |w| w.set_material(shape, material));
    }
}

#[test]
fn what_a_body_is_told_must_be_finite() {
    let (mut world, body) = world();
    let w = &mut world;
    for bad in BAD {
        let v = Vec3::new(0.0, bad, 0.0);
        refused("velocity", w, |w| w.set_velocity(body, v, Vec3::ZERO));
        refused("spin", w, |w| w.set_velocity(body, Vec3::ZERO, v));
        refused("force", w, |w| w.add_force(body, v));
        refused("torque", w, |w| w.add_torque(body, v));
        refused("impulse", w, |w| w.apply_impulse_at(body, v, DVec3::ZERO));
        refused("point", w, |w| w.apply_impulse_at(body, Vec3::X, v.as_dvec3()));
        refused("pose", w, |w| w.set_pose(body, v.as_dvec3(), Quat::IDENTITY));
        refused("rotation", w, |w| w.set_pose(body, DVec3::ZERO, Quat::from_xyzw(bad, 0.0, 0.0, 1.0)));
        refused("target", w, |w| w.move_kinematic(body, v.as_dvec3(), Quat::IDENTITY, 0.1));
        refused("dt", w, |w| w.move_kinematic(body, DVec3::ZERO, Quat::IDENTITY, bad));
        refused("gravity scale", w, |w| w.set_gravity_scale(body, bad));
        refused("origin", w, |w| w.set_origin(v.as_dvec3()));
    }
    refused("dt", w, |w| w.move_kinematic(body, DVec3::ZERO, Quat::IDENTITY, 0.0));
}

#[test]
fn a_step_must_last() {
    let (mut world, _) = world();
    for dt in [0.0, -0.0, -1.0 / 60.0, f32::NAN, f32::INFINITY, f32::NEG_INFINITY] {
        refused("dt", &mut world, |w| w.step(dt).map(drop));
    }
    world.step(1.0 / 60.0).unwrap();
}

#[test]
fn settings_must_be_in_range() {
    let good = Settings::default();
    let mut bad = vec![
        good.clone().with_substeps(0),
        good.clone().with_substeps(65),
        good.clone().with_iterations(0),
        good.clone().with_iterations(257),
        good.clone().with_threads(0),
        good.clone().with_threads(1025),
        good.clone().with_slop(1.1),
    ];
    for x in [-1.0, f32::NAN, f32::INFINITY] {
        bad.push(good.clone().with_length_unit(x));
        bad.push(good.clone().with_restitution_threshold(x));
        bad.push(good.clone().with_slop(x));
        bad.push(good.clone().with_contact_hertz(x));
        bad.push(good.clone().with_contact_damping(x));
        bad.push(good.clone().with_push_speed(x));
    }
    for x in BAD {
        bad.push(good.clone().with_gravity(Vec3::new(0.0, x, 0.0)));
    }
    let (mut world, _) = world();
    for settings in bad {
        let what = format!("{settings:?}");
        assert!(World::new(settings.clone()).is_err(), "{what}");
        refused(&what, &mut world, |w| w.set_settings(settings));
    }
}

#[test]
fn a_stale_handle_never_names_another_body() {
    let (mut world, keep) = world();
    let old = world.add_body(&ball().with_position(DVec3::Y * 9.0)).unwrap();
    let old_shape = world.shapes(old).unwrap().next().unwrap();
    world.remove_body(old).unwrap();
    for reuse in [false, true] {
        if reuse {
            // The slots of body and shape are used again.
            for i in 0..4 {
                world.add_body(&ball().with_position(DVec3::Y * (12.0 + 3.0 * f64::from(i)))).unwrap();
            }
        }
        assert!(!world.contains(old) && world.contains(keep));
        let w = &mut world;
        let body = |what: &str, w: &mut World, call: &dyn Fn(&mut World) -> Result<(), Error>| {
            assert_eq!(refused(what, w, call), Error::StaleBody, "{what}");
        };
        body("remove", w, &|w| w.remove_body(old));
        body("position", w, &|w| w.position(old).map(drop));
        body("local position", w, &|w| w.local_position(old).map(drop));
        body("rotation", w, &|w| w.rotation(old).map(drop));
        body("centre", w, &|w| w.centre_of_mass(old).map(drop));
        body("velocity", w, &|w| w.linear_velocity(old).map(drop));
        body("spin", w, &|w| w.angular_velocity(old).map(drop));
        body("mass", w, &|w| w.mass(old).map(drop));
        body("kind", w, &|w| w.kind(old).map(drop));
        body("user data", w, &|w| w.user_data(old).map(drop));
        body("shapes", w, &|w| w.shapes(old).map(drop));
        body("set pose", w, &|w| w.set_pose(old, DVec3::ZERO, Quat::IDENTITY));
        body("set velocity", w, &|w| w.set_velocity(old, Vec3::X, Vec3::X));
        body("move", w, &|w| w.move_kinematic(old, DVec3::ZERO, Quat::IDENTITY, 0.1));
        body("force", w, &|w| w.add_force_and_torque(old, Vec3::X, Vec3::X));
        body("impulse", w, &|w| w.apply_impulse_at(old, Vec3::X, DVec3::ZERO));
        body("gravity scale", w, &|w| w.set_gravity_scale(old, 0.0));
        body("continuous", w, &|w| w.set_continuous(old, ContinuousMode::Discrete));
        let mass = MassProperties { mass: 1.0, centre_of_mass: Vec3::ZERO, inertia: Mat3::IDENTITY };
        body("set mass", w, &|w| w.set_mass(old, mass));
        let shape = ShapeDesc::new(Geometry::Sphere { radius: 0.1 });
        body("add shape", w, &|w| w.add_shape(old, &shape).map(drop));
        let shape = |what: &str, w: &mut World, call: &dyn Fn(&mut World) -> Result<(), Error>| {
            assert_eq!(refused(what, w, call), Error::StaleShape, "{what}");
        };
        shape("remove", w, &|w| w.remove_shape(old_shape));
        shape("geometry", w, &|w| w.geometry(old_shape).map(drop));
        shape("material", w, &|w| w.material(old_shape).map(drop));
        shape("set material", w, &|w| w.set_material(old_shape, Material::default()));
        shape("filter", w, &|w| w.set_filter(old_shape, Filter::default()));
        shape("user data", w, &|w| w.shape_user_data(old_shape).map(drop));
    }
}

#[test]
fn a_budget_refuses_what_does_not_fit() {
    let (mut world, body) = world();
    let used = world.memory().total();
    world.set_settings(Settings::default().with_budget(Budget::total(used + 100_000))).unwrap();
    world.add_body(&ball().with_position(DVec3::Y * 20.0)).unwrap();
    let many: Vec<BodyDesc> =
        (0..10_000).map(|i| ball().with_position(DVec3::Y * (30.0 + f64::from(i)))).collect();
    let error = refused("many bodies", &mut world, |w| w.add_bodies(&many));
    let Error::Budget { asked, left, .. } = error else { panic!("{error}") };
    assert!(asked > left && left <= 100_000, "{asked} asked, {left} left");

    let terrain = BodyDesc::fixed().with_shape(ShapeDesc::new(flat_mesh(100, 1.0)));
    let error = refused("a mesh", &mut world, |w| w.add_body(&terrain));
    assert!(matches!(error, Error::Budget { category: Category::Meshes, .. }), "{error}");

    world.set_settings(Settings::default().with_budget(Budget::total(used))).unwrap();
    let shape = ShapeDesc::new(Geometry::Sphere { radius: 0.1 });
    let error = refused("a shape", &mut world, |w| w.add_shape(body, &shape));
    assert!(matches!(error, Error::Budget { .. }), "{error}");
    let error = refused("a first force", &mut world, |w| w.add_force(body, Vec3::Y));
    assert!(matches!(error, Error::Budget { category: Category::Bodies, .. }), "{error}");
    world.step(1.0 / 60.0).unwrap();
}

/// Its length is beyond all numbers, and so were the ends of a range that the guard asked for.
#[test]
fn a_speed_beyond_all_numbers_is_no_panic() {
    for floor in common::Floor::ALL {
        let mut world = World::new(Settings::default()).unwrap();
        world.add_body(&floor.desc(Material::default())).unwrap();
        let ball = common::dynamic(Geometry::Sphere { radius: 0.5 }, Material::default(), Vec3::Y);
        let ball = world.add_body(&ball).unwrap();
        for speed in [1e15, 1e22, 1e38] {
            let velocity = Vec3::new(speed, -speed, 0.0);
            refused("speed", &mut world, |w| w.set_velocity(ball, velocity, Vec3::ZERO));
            let speed = limits::MAX_SPEED;
            world.set_velocity(ball, Vec3::new(speed, -speed, 0.0), Vec3::ZERO).unwrap();
            common::steps(&mut world, 2, 1.0 / 60.0);
        }
    }
}

/// Finite, but what a step made of it was no number, and indices went out of bounds. Expected: the ranges of
/// `limits`.
#[test]
fn what_is_beyond_any_scene_is_refused_though_it_is_finite() {
    let (mut world, body) = world();
    let w = &mut world;
    for far in [1.1e9, 1e30, f64::from(f32::MAX)] {
        let at = DVec3::new(0.0, -far, 0.0);
        refused_body("position", &ball().with_position(at));
        refused("pose", w, |w| w.set_pose(body, at, Quat::IDENTITY));
        refused("origin", w, |w| w.set_origin(at));
        refused("point", w, |w| w.apply_impulse_at(body, Vec3::X, at));
        refused("target", w, |w| w.move_kinematic(body, at, Quat::IDENTITY, 0.1));
        refused("frames", w, |w| w.frames_at([body, body], at, Quat::IDENTITY));
    }
    for fast in [1.1e6, 1e30, f32::MAX] {
        let v = Vec3::new(0.0, 0.0, fast);
        refused_body("velocity", &ball().with_velocity(v, Vec3::ZERO));
        refused_body("spin", &ball().with_velocity(Vec3::ZERO, v));
        refused("velocity", w, |w| w.set_velocity(body, v, Vec3::ZERO));
        refused("spin", w, |w| w.set_velocity(body, Vec3::ZERO, -v));
        refused("gravity", w, |w| w.set_settings(Settings::default().with_gravity(v)));
        refused("gravity scale", w, |w| w.set_gravity_scale(body, fast));
    }
    for size in [1.1e6, 1.8e19, f32::MAX, 0.9e-6, 1e-30] {
        let shapes = [
            Geometry::Sphere { radius: size },
            Geometry::cuboid(1.0, size, 1.0),
            Geometry::capsule(size, 1.0),
            Geometry::cylinder(1.0, size),
        ];
        for geometry in shapes {
            let shape = ShapeDesc::new(geometry);
            refused_body("size", &BodyDesc::fixed().with_shape(shape.clone()));
            refused("size", w, |w| w.add_shape(body, &shape));
        }
        let corners = [Vec3::ZERO, Vec3::X, Vec3::Y, Vec3::Z].map(|p| p * size);
        assert!(ConvexHull::new(&corners).is_err());
    }
    let mut far = ball();
    far.shapes[0].position = Vec3::X * 1.1e6;
    refused_body("shape position", &far);
    for dt in [1e-30, 0.9e-6, 10.1, 1e10] {
        refused("dt", w, |w| w.step(dt).map(drop));
        refused("dt", w, |w| w.move_kinematic(body, DVec3::ZERO, Quat::IDENTITY, dt));
    }
    // Each is allowed, the sum is not. The impulse is too large by its arm: 1e9 N s at 1e8 m on a cube of a
    // ton.
    refused("force", w, |w| w.add_force(body, Vec3::X * 1.1e18));
    w.add_force_and_torque(body, Vec3::X * 0.9e18, Vec3::X * 0.9e18).unwrap();
    refused("sum of forces", w, |w| w.add_force(body, Vec3::X * 0.9e18));
    refused("sum of torques", w, |w| w.add_torque(body, Vec3::X * 0.9e18));
    refused("impulse", w, |w| w.apply_impulse_at(body, Vec3::X * 1e9, DVec3::Y * 1e8));
    refused("impulse", w, |w| w.apply_impulse_at(body, Vec3::X * 1e10, DVec3::ZERO));
    w.step(1.0 / 60.0).unwrap();
    // Joints.
    let other = w.add_body(&ball().with_position(DVec3::Y * 9.0)).unwrap();
    let far = [Frame::at(Vec3::X * 1.1e6), Frame::default()];
    refused("frame", w, |w| w.add_joint(&JointDesc::ball([body, other], far)));
    let near = [Frame::default(); 2];
    let free = || JointDesc::new([body, other], near);
    let limit = Limit::new(Motion::Linear, Axes::All, 0.0, 1e10);
    refused("limit", w, |w| w.add_joint(&free().with_limit(limit)));
    let motor = Motor::velocity(Motion::Linear, Axis::X, 1e7, 1.0);
    refused("drive", w, |w| w.add_joint(&free().with_motor(motor)));
    // One over it is infinite.
    let mass = MassProperties { mass: 1.0, centre_of_mass: Vec3::ZERO, inertia: Mat3::IDENTITY * 1e-40 };
    refused("moments", w, |w| w.set_mass(body, mass));
}

/// Expected: with any allowed input, a step leaves numbers, within the ranges for places.
#[test]
fn at_the_ends_of_the_ranges_steps_leave_numbers() {
    for size in [limits::MIN_LENGTH, 1.0, limits::MAX_LENGTH] {
        for speed in [1.0, limits::MAX_SPEED] {
            for dt in [limits::MIN_STEP, 1.0 / 60.0, limits::MAX_STEP] {
                for at in [0.0, 0.99 * limits::MAX_POSITION] {
                    let mut world = World::new(Settings::default()).unwrap();
                    let at = DVec3::new(at, -at, at);
                    world.set_origin(at).unwrap();
                    let floor = ShapeDesc::new(Geometry::cuboid(size, size, size));
                    let step = DVec3::Y * f64::from(size) * 2.001;
                    world.add_body(&BodyDesc::fixed().with_position(at).with_shape(floor)).unwrap();
                    for (i, geometry) in [
                        Geometry::cuboid(size, size, size),
                        Geometry::Sphere { radius: size },
                        Geometry::cylinder(size, size),
                        Geometry::capsule(size, size),
                    ]
                    .into_iter()
                    .enumerate()
                    {
                        let v = Vec3::new(speed, -speed, 0.5 * speed);
                        let desc =
                            BodyDesc::dynamic().with_position(at + step * (i + 1) as f64).with_velocity(v, v);
                        world.add_body(&desc.with_shape(ShapeDesc::new(geometry))).unwrap();
                    }
                    for _ in 0..10 {
                        world.step(dt).unwrap();
                        assert!(common::all_finite(&world), "{size} {speed} {dt} {at}");
                        for body in world.bodies() {
                            let centre = world.centre_of_mass(body).unwrap().abs().max_element();
                            assert!(centre <= limits::MAX_POSITION, "{size} {speed} {dt} {at}: {centre}");
                        }
                    }
                }
            }
        }
    }
}
