//! Bodies come, go and change at any time between steps.

#![allow(clippy::disallowed_methods, reason = "expected values may use the platform's functions")]

use crate::common::random::Random;
use crate::common::{self, Floor, G, dynamic, shape};
use backstop::glam::{DVec3, Mat3, Quat, Vec3};
use backstop::{
    BodyDesc, BodyHandle, BodyKind, ContinuousMode, Error, Filter, Geometry, MassProperties, Material,
    Settings, ShapeDesc, World,
};

const DT: f32 = 1.0 / 60.0;

fn any_geometry(random: &mut Random) -> Geometry {
    let (a, b) = (random.range(0.1, 0.5), random.range(0.1, 0.5));
    match random.below(4) {
        0 => Geometry::Sphere { radius: a },
        1 => Geometry::capsule(a, b),
        2 => Geometry::cuboid(a, b, 0.3),
        _ => Geometry::cylinder(a, b),
    }
}

fn any_body(random: &mut Random) -> BodyDesc {
    let at = random.cube() * 6.0 + Vec3::Y * 7.0;
    let kind = [BodyKind::Dynamic, BodyKind::Dynamic, BodyKind::Kinematic, BodyKind::Static][random.below(4)];
    let mut desc = BodyDesc::new(kind).with_position(at).with_rotation(random.rotation());
    for _ in 0..1 + random.below(3) {
        let material = Material::default().with_restitution(if random.below(3) == 0 { 0.5 } else { 0.0 });
        let mut part = shape(any_geometry(random), material);
        part.position = random.cube() * 0.3;
        part.filter.category = 1 << random.below(3);
        desc.shapes.push(part);
    }
    desc.user_data = random.bits();
    desc.with_velocity(random.cube() * 5.0, random.cube() * 5.0)
}

/// Changes one thing about a body that the world has.
fn change(world: &mut World, body: BodyHandle, what: usize, random: &mut Random) {
    match what {
        6 => {
            let at = (random.cube() * 6.0 + Vec3::Y * 7.0).as_dvec3();
            world.set_pose(body, at, random.rotation()).unwrap();
        }
        7 => world.set_velocity(body, random.cube() * 50.0, random.cube() * 50.0).unwrap(),
        8 => world.add_force_and_torque(body, random.cube() * 1e4, random.cube() * 1e3).unwrap(),
        9 => {
            let at = world.position(body).unwrap() + random.cube().as_dvec3();
            world.apply_impulse_at(body, random.cube() * 1e3, at).unwrap();
        }
        10 => {
            let part = shape(any_geometry(random), Material::default());
            if world.shapes(body).unwrap().count() < 5 {
                world.add_shape(body, &part).unwrap();
            }
        }
        11 => {
            let part = world.shapes(body).unwrap().last();
            // The last shape of a dynamic body stays.
            if let Some(part) = part {
                let last = world.shapes(body).unwrap().count() == 1;
                let removed = world.remove_shape(part);
                assert!(removed.is_ok() || last && removed == Err(Error::NoMass), "{removed:?}");
            }
        }
        12 => {
            let part = world.shapes(body).unwrap().next();
            if let Some(part) = part {
                let material = Material::default().with_friction(random.range(0.0, 2.0));
                world.set_material(part, material.with_restitution(random.range(0.0, 1.0))).unwrap();
                let mask = random.bits() & 7;
                world.set_filter(part, Filter::default().with_mask(mask)).unwrap();
            }
        }
        13 => {
            let inertia = Mat3::from_diagonal(Vec3::new(20.0, 25.0, 30.0));
            let mass = MassProperties { mass: 100.0, centre_of_mass: random.cube() * 0.2, inertia };
            world.set_mass(body, mass).unwrap();
        }
        14 => {
            let mode =
                [ContinuousMode::Discrete, ContinuousMode::Segment, ContinuousMode::Volume][random.below(3)];
            world.set_continuous(body, mode).unwrap();
            world.set_gravity_scale(body, random.range(-1.0, 2.0)).unwrap();
        }
        _ => {
            let at = world.position(body).unwrap() + (random.cube() * 0.2).as_dvec3();
            world.move_kinematic(body, at, random.rotation(), DT).unwrap();
        }
    }
}

/// 80,000 random calls, a step after every twenty: nothing panics, everything stays a number, handles name
/// what they named, and memory does not grow once the world no longer does.
#[test]
fn a_world_survives_any_sequence_of_calls() {
    let mut world = World::new(Settings::default()).unwrap();
    let ground = world.add_body(&Floor::Mesh.desc(Material::default())).unwrap();
    let mut random = Random(7);
    // Each live body with the number it was given.
    let mut live: Vec<(BodyHandle, u64)> = Vec::new();
    let mut dead: Vec<BodyHandle> = Vec::new();
    let mut totals = Vec::new();
    for call in 0..80_000 {
        let pick = (!live.is_empty()).then(|| random.below(live.len()));
        match (random.below(16), pick) {
            (0..=2, _) | (_, None) if live.len() < 120 => {
                let desc = any_body(&mut random);
                live.push((world.add_body(&desc).unwrap(), desc.user_data));
            }
            (0..=5, Some(i)) => {
                let (body, _) = live.swap_remove(i);
                world.remove_body(body).unwrap();
                assert_eq!(world.remove_body(body), Err(Error::StaleBody));
                dead.push(body);
            }
            (what, Some(i)) => change(&mut world, live[i].0, what, &mut random),
            _ => {}
        }
        if call % 20 == 19 {
            world.step(random.range(1.0 / 240.0, 1.0 / 30.0)).unwrap();
            assert!(common::all_finite(&world), "call {call}");
            assert_eq!(world.body_count(), live.len() + 1);
            assert!(live.iter().all(|&(b, number)| world.user_data(b) == Ok(number)), "call {call}");
            assert!(dead.iter().all(|&b| !world.contains(b)), "call {call}");
            // Bodies that have fallen or flown away are put back.
            for &(body, _) in &live {
                if world.position(body).unwrap().length() > 100.0 {
                    world.set_pose(body, DVec3::Y * 5.0, Quat::IDENTITY).unwrap();
                    world.set_velocity(body, Vec3::ZERO, Vec3::ZERO).unwrap();
                }
            }
        }
        if call % 5000 == 4999 {
            totals.push(world.memory().total());
        }
    }
    println!("{} bodies, memory {totals:?}", live.len());
    // The densest crowds were there in the first half; their buffers are used again.
    assert!(totals[15] < totals[7] * 5 / 4, "{totals:?}");
    assert!(world.contains(ground));
    for (body, _) in live {
        world.remove_body(body).unwrap();
    }
    world.step(DT).unwrap();
    assert_eq!((world.body_count(), world.report().pairs, world.report().manifolds), (1, 0, 0));
}

#[test]
fn a_kinematic_body_pushes_and_is_not_pushed() {
    let mut world = World::new(Settings::default()).unwrap();
    let material = Material::default();
    world.add_body(&Floor::Plane.desc(material)).unwrap();
    let wall = shape(Geometry::cuboid(0.1, 1.0, 1.0), material);
    let wall = BodyDesc::kinematic().with_position(Vec3::new(-1.0, 1.0, 0.0)).with_shape(wall);
    let wall = world.add_body(&wall.with_velocity(Vec3::X, Vec3::ZERO)).unwrap();
    let crate_ = dynamic(Geometry::cuboid(0.5, 0.5, 0.5), material, Vec3::new(0.0, 0.5, 0.0));
    let crate_ = world.add_body(&crate_).unwrap();
    common::steps(&mut world, 180, DT);
    // Three metres along its path, also through obstacles; the box in front of it, at its speed.
    assert!((world.position(wall).unwrap() - DVec3::new(2.0, 1.0, 0.0)).length() < 1e-4);
    assert!((world.position(crate_).unwrap().x - 2.6).abs() < 0.01, "{}", world.position(crate_).unwrap());
    assert!((world.linear_velocity(crate_).unwrap() - Vec3::X).length() < 0.01);

    // It stops where it is told to.
    world.move_kinematic(wall, DVec3::new(2.5, 1.0, 0.0), Quat::from_rotation_y(0.3), DT).unwrap();
    world.step(DT).unwrap();
    assert!((world.position(wall).unwrap().x - 2.5).abs() < 1e-5);
    assert!(world.rotation(wall).unwrap().angle_between(Quat::from_rotation_y(0.3)) < 1e-3);
}

/// A platform carries the bodies on it, by friction.
#[test]
fn a_platform_carries_what_stands_on_it() {
    let mut world = World::new(Settings::default()).unwrap();
    let floor = shape(Geometry::cuboid(5.0, 0.5, 5.0), Material::default());
    let floor =
        world.add_body(&BodyDesc::kinematic().with_position(Vec3::Y * -0.5).with_shape(floor)).unwrap();
    let body = dynamic(Geometry::cuboid(0.5, 0.5, 0.5), Material::default(), Vec3::new(0.0, 0.5, 0.0));
    let body = world.add_body(&body).unwrap();
    world.set_velocity(floor, Vec3::new(1.0, 0.5, 0.0), Vec3::ZERO).unwrap();
    common::steps(&mut world, 120, DT);
    let speed = world.linear_velocity(body).unwrap();
    assert!((speed - Vec3::new(1.0, 0.5, 0.0)).length() < 0.01, "{speed}");
}

#[test]
fn locked_axes_do_not_move() {
    let mut world = World::new(Settings::default()).unwrap();
    world.add_body(&Floor::Box.desc(Material::default())).unwrap();
    let mut desc = dynamic(Geometry::cuboid(0.5, 0.5, 0.5), Material::default(), Vec3::new(0.0, 0.5, 0.0));
    desc.lock_translation = [false, false, true];
    desc.lock_rotation = [true, true, false];
    let body =
        world.add_body(&desc.with_velocity(Vec3::new(2.0, 0.0, 3.0), Vec3::new(4.0, 5.0, 0.0))).unwrap();
    // Something else bumps into it from the side.
    let bump = dynamic(Geometry::Sphere { radius: 0.5 }, Material::default(), Vec3::new(2.0, 0.9, -3.0));
    world.add_body(&bump.with_velocity(Vec3::Z * 6.0, Vec3::ZERO)).unwrap();
    for _ in 0..120 {
        world.step(DT).unwrap();
        let (at, turn) = (world.position(body).unwrap(), world.rotation(body).unwrap());
        assert!(at.z.abs() < 1e-6, "{at}");
        let axis = turn * Vec3::Z;
        assert!((axis - Vec3::Z).length() < 1e-5, "turned about a locked axis: {axis}");
    }
    assert!(world.position(body).unwrap().x > 0.1, "{}", world.position(body).unwrap());
}

/// s = g t² / 2, times the factor.
#[test]
fn gravity_scale_scales_gravity() {
    for scale in [-0.5f32, 0.0, 0.5, 1.0, 2.0] {
        let mut world = World::new(Settings::default()).unwrap();
        let mut desc = dynamic(Geometry::Sphere { radius: 0.5 }, Material::default(), Vec3::ZERO);
        desc.gravity_scale = scale;
        let body = world.add_body(&desc).unwrap();
        common::steps(&mut world, 60, DT);
        let (fell, want) = (-world.position(body).unwrap().y, 0.5 * G * f64::from(scale));
        assert!((fell - want).abs() < 1e-4, "{scale}: {fell} for {want}");
        world.set_gravity_scale(body, 0.0).unwrap();
        let before = world.linear_velocity(body).unwrap();
        common::steps(&mut world, 60, DT);
        assert_eq!(world.linear_velocity(body).unwrap(), before);
    }
}

/// v = F t / m and w = T t / I, for the steps in which they act; an impulse acts at once.
#[test]
fn forces_act_for_a_step_and_impulses_at_once() {
    let mut world = World::new(Settings::default().with_gravity(Vec3::ZERO)).unwrap();
    let mut desc = BodyDesc::dynamic();
    let inertia = Mat3::from_diagonal(Vec3::splat(3.0));
    desc.mass = Some(MassProperties { mass: 2.0, centre_of_mass: Vec3::ZERO, inertia });
    let body = world.add_body(&desc).unwrap();
    for _ in 0..60 {
        world.add_force_and_torque(body, Vec3::X * 1.0, Vec3::Y * 4.0).unwrap();
        world.add_force_and_torque(body, Vec3::X * 3.0, Vec3::Y * 2.0).unwrap();
        world.step(DT).unwrap();
    }
    common::steps(&mut world, 60, DT);
    let (v, w) = (world.linear_velocity(body).unwrap(), world.angular_velocity(body).unwrap());
    assert!((v - Vec3::X * 2.0).length() < 1e-4 && (w - Vec3::Y * 2.0).length() < 1e-4, "{v} {w}");

    world.set_velocity(body, Vec3::ZERO, Vec3::ZERO).unwrap();
    let point = world.centre_of_mass(body).unwrap() + DVec3::X;
    world.apply_impulse_at(body, Vec3::Y * 6.0, point).unwrap();
    let (v, w) = (world.linear_velocity(body).unwrap(), world.angular_velocity(body).unwrap());
    assert!((v - Vec3::Y * 3.0).length() < 1e-5 && (w - Vec3::Z * 2.0).length() < 1e-5, "{v} {w}");
}

/// A dumbbell of two balls has their common mass and centre, lies on both, and can lose one.
#[test]
fn a_compound_is_one_body() {
    let mut world = World::new(Settings::default()).unwrap();
    world.add_body(&Floor::Plane.desc(Material::default())).unwrap();
    let ball = |x: f32, density: f32| {
        let mut ball = ShapeDesc::new(Geometry::Sphere { radius: 0.5 });
        (ball.position, ball.density) = (Vec3::X * x, density);
        ball
    };
    let desc = BodyDesc::dynamic()
        .with_position(Vec3::Y)
        .with_shape(ball(-1.0, 1000.0))
        .with_shape(ball(1.0, 3000.0));
    let body = world.add_body(&desc).unwrap();
    let one = 4.0 / 3.0 * std::f32::consts::PI * 0.125 * 1000.0;
    assert!((world.mass(body).unwrap() - 4.0 * one).abs() < 1e-3 * one);
    assert!((world.centre_of_mass(body).unwrap() - DVec3::new(0.5, 1.0, 0.0)).length() < 1e-6);
    common::steps(&mut world, 120, DT);
    let at = world.position(body).unwrap();
    assert!((at - DVec3::Y * 0.5).length() < 5e-3, "{at}");

    let heavy = world.shapes(body).unwrap().last().unwrap();
    world.remove_shape(heavy).unwrap();
    assert!((world.mass(body).unwrap() - one).abs() < 1e-3 * one);
    // The body's origin stays where it was; its centre is that of the ball that is left.
    assert!((world.position(body).unwrap() - at).length() < 1e-5);
    assert!((world.centre_of_mass(body).unwrap() - at + DVec3::X).length() < 1e-2);
}

#[test]
fn user_data_and_origin_are_the_callers() {
    let mut world = World::new(Settings::default()).unwrap();
    let mut desc = dynamic(Geometry::Sphere { radius: 0.5 }, Material::default(), Vec3::new(1.0, 2.0, 3.0));
    (desc.user_data, desc.shapes[0].user_data) = (u64::MAX, 42);
    let body = world.add_body(&desc).unwrap();
    let part = world.shapes(body).unwrap().next().unwrap();
    assert_eq!((world.user_data(body), world.shape_user_data(part)), (Ok(u64::MAX), Ok(42)));
    world.set_origin(DVec3::new(1.0, 1.0, 1.0)).unwrap();
    assert_eq!(world.local_position(body), Ok(Vec3::new(0.0, 1.0, 2.0)));
    assert_eq!(world.position(body), Ok(DVec3::new(1.0, 2.0, 3.0)));
}

/// A floor that is taken away no longer holds, one that is put there does.
#[test]
fn a_static_body_can_be_moved() {
    let mut world = World::new(Settings::default()).unwrap();
    let floor = world.add_body(&Floor::Box.desc(Material::default())).unwrap();
    let body = dynamic(Geometry::cuboid(0.5, 0.5, 0.5), Material::default(), Vec3::new(0.0, 0.5, 0.0));
    let body = world.add_body(&body).unwrap();
    common::steps(&mut world, 60, DT);
    assert!((world.position(body).unwrap().y - 0.5).abs() < 2e-3);
    world.set_pose(floor, DVec3::Y * -3.0, Quat::IDENTITY).unwrap();
    common::steps(&mut world, 120, DT);
    assert!((world.position(body).unwrap().y + 2.5).abs() < 2e-3, "{}", world.position(body).unwrap());
    world.remove_body(floor).unwrap();
    common::steps(&mut world, 60, DT);
    assert!(world.position(body).unwrap().y < -6.0);
}

/// The list of a body with many shapes was gone through for each that was taken off it. Expected: the same
/// shapes are left whatever the order, each where it was, and a snapshot knows them.
#[test]
fn shapes_are_taken_off_a_body_in_any_order() {
    let mut world = World::new(Settings::default()).unwrap();
    let body = world.add_body(&BodyDesc::fixed()).unwrap();
    let mut shapes = Vec::new();
    for i in 0..200u64 {
        let mut shape = ShapeDesc::new(Geometry::Sphere { radius: 0.25 });
        (shape.position, shape.user_data) = (Vec3::X * i as f32, i);
        shapes.push(world.add_shape(body, &shape).unwrap());
    }
    let mut snapshot = backstop::Snapshot::new();
    // Every seventh, from the middle on, until few are left.
    let mut at = 100;
    while shapes.len() > 3 {
        at = (at + 7) % shapes.len();
        let gone = shapes.swap_remove(at);
        world.remove_shape(gone).unwrap();
        assert!(world.remove_shape(gone).is_err());
        if shapes.len() == 120 {
            world.snapshot(&mut snapshot);
            world.restore(&snapshot).unwrap();
        }
    }
    let mut left: Vec<_> = world.shapes(body).unwrap().collect();
    let mut expected = shapes.clone();
    left.sort_unstable();
    expected.sort_unstable();
    assert_eq!(left, expected);
    for shape in shapes {
        let x = world.shape_user_data(shape).unwrap() as f64;
        let ray = backstop::Ray::new(DVec3::new(x, 2.0, 0.0), Vec3::NEG_Y * 4.0);
        let hit = world.cast_ray(&ray, &backstop::QueryFilter::default()).unwrap().unwrap();
        assert_eq!(hit.shape, shape);
    }
}
