//! A change between steps holds from the next step on: bodies out of the world and back in, many
//! at once.

use backstop::glam::{DVec3, Quat, Vec3};
use backstop::{
    BodyDesc, BodyHandle, BodyKind, Error, Frame, Geometry, JointDesc, QueryFilter, Ray, Settings, ShapeDesc,
    World,
};

const DT: f32 = 1.0 / 60.0;

fn cube() -> ShapeDesc {
    ShapeDesc::new(Geometry::cuboid(0.5, 0.5, 0.5))
}

fn floor(sleeping: bool) -> (World, BodyHandle) {
    let mut world = World::new(Settings::default().with_sleeping(sleeping)).unwrap();
    let floor = world.add_body(&BodyDesc::fixed().with_shape(ShapeDesc::new(Geometry::Plane))).unwrap();
    (world, floor)
}

fn add(world: &mut World, y: f64) -> BodyHandle {
    world.add_body(&BodyDesc::dynamic().with_position(DVec3::Y * y).with_shape(cube())).unwrap()
}

fn run(world: &mut World, seconds: f32) {
    for _ in 0..(seconds / DT).round() as u32 {
        world.step(DT).unwrap();
    }
}

#[test]
fn a_disabled_body_is_not_there_until_it_is_enabled() {
    for sleeping in [false, true] {
        let (mut world, _) = floor(sleeping);
        let bodies = [0.5, 1.5, 2.5].map(|y| add(&mut world, y));
        run(&mut world, 2.0);
        assert_eq!(world.sleeping_body_count(), if sleeping { 3 } else { 0 });
        let at = world.position(bodies[1]).unwrap();
        world.set_enabled(bodies[1], false).unwrap();
        world.set_enabled(bodies[1], false).unwrap();
        assert!(!world.is_enabled(bodies[1]).unwrap() && world.kind(bodies[1]).unwrap() == BodyKind::Dynamic);
        // The third falls on the first, through where it was; no ray meets it.
        run(&mut world, 2.0);
        assert!((world.position(bodies[2]).unwrap().y - 1.5).abs() < 0.01);
        assert_eq!(world.position(bodies[1]).unwrap(), at);
        world.set_pose(bodies[1], DVec3::X * 20.0 + DVec3::Y * 5.0, Quat::IDENTITY).unwrap();
        let ray = Ray::between(DVec3::X * 20.0 + DVec3::Y * 9.0, DVec3::X * 20.0 + DVec3::Y * 1.0);
        assert_eq!(world.cast_ray(&ray, &QueryFilter::new()).unwrap(), None);
        // Changed while it was away.
        world.add_shape(bodies[1], &cube().with_position(Vec3::X)).unwrap();
        world.set_velocity(bodies[1], Vec3::X, Vec3::ZERO).unwrap();
        world.set_enabled(bodies[1], true).unwrap();
        let hit = world.cast_ray(&ray, &QueryFilter::new()).unwrap().unwrap();
        assert_eq!(hit.body, bodies[1]);
        run(&mut world, 0.5);
        let fell = world.position(bodies[1]).unwrap();
        assert!((fell.x - 20.5).abs() < 0.01 && (fell.y - (5.0 - 0.125 * 9.81)).abs() < 0.02, "{fell}");
        run(&mut world, 2.0);
        assert!((world.position(bodies[1]).unwrap().y - 0.5).abs() < 0.01);
    }
}

#[test]
fn a_disabled_floor_bears_nothing_and_a_disabled_end_holds_nothing() {
    let (mut world, floor) = floor(true);
    let body = add(&mut world, 0.5);
    let hook = world
        .add_body(&BodyDesc::dynamic().with_position(DVec3::new(5.0, 6.0, 0.0)).with_shape(cube()))
        .unwrap();
    let hung = world
        .add_body(&BodyDesc::dynamic().with_position(DVec3::new(5.0, 4.0, 0.0)).with_shape(cube()))
        .unwrap();
    world.set_gravity_scale(hook, 0.0).unwrap();
    world.set_gravity_scale(hung, 0.0).unwrap();
    let frames = [Frame::at(Vec3::NEG_Y), Frame::at(Vec3::Y)];
    let joint = world.add_joint(&JointDesc::ball([hook, hung], frames)).unwrap();
    run(&mut world, 2.0);
    assert_eq!(world.sleeping_body_count(), 3);
    world.set_enabled(hook, false).unwrap();
    world.set_gravity_scale(hung, 1.0).unwrap();
    run(&mut world, 0.5);
    assert!((world.position(hung).unwrap().y - (4.0 - 0.125 * 9.81)).abs() < 0.02);
    assert!(world.contains_joint(joint));
    // Back again it holds.
    world.set_enabled(hook, true).unwrap();
    world.set_pose(hung, DVec3::new(5.0, 4.0, 0.0), Quat::IDENTITY).unwrap();
    world.set_velocity(hung, Vec3::X, Vec3::ZERO).unwrap();
    run(&mut world, 1.0);
    let [(a, _), (b, _)] = world.joint_frames(joint).unwrap();
    assert!(a.distance(b) < 1e-3);
    world.set_enabled(floor, false).unwrap();
    run(&mut world, 1.0);
    assert!(world.position(body).unwrap().y < -4.0);
    world.set_enabled(floor, true).unwrap();
    world.set_pose(body, DVec3::Y * 3.0, Quat::IDENTITY).unwrap();
    world.set_velocity(body, Vec3::ZERO, Vec3::ZERO).unwrap();
    run(&mut world, 2.0);
    assert!((world.position(body).unwrap().y - 0.5).abs() < 0.01);
}

#[test]
fn many_go_at_once_or_none() {
    let (mut world, floor) = floor(false);
    let bodies: Vec<BodyHandle> = (0..10).map(|i| add(&mut world, f64::from(i) + 0.5)).collect();
    world.set_enabled(bodies[3], false).unwrap();
    run(&mut world, 0.1);
    world.remove_body(bodies[0]).unwrap();
    assert!(world.remove_bodies(&bodies).is_err_and(|error| *error.innermost() == Error::StaleBody));
    assert_eq!(world.body_count(), 10);
    // One twice is one.
    world.remove_bodies(&[&bodies[1..], &bodies[1..3]].concat()).unwrap();
    assert_eq!((world.body_count(), world.contains(floor)), (1, true));
    assert!(matches!(world.set_enabled(bodies[1], true), Err(Error::StaleBody)));
    run(&mut world, 0.1);
    assert_eq!(world.report().pairs, 0);
}

/// Settings, gravity, masses, filters and materials in the middle of a run: what the next steps do is by the
/// new ones.
#[test]
fn what_is_changed_holds_at_once() {
    let (mut world, _) = floor(true);
    let body = add(&mut world, 0.5);
    run(&mut world, 2.0);
    world.set_settings(world.settings().clone().with_gravity(Vec3::Y * 5.0)).unwrap();
    run(&mut world, 1.0);
    assert!((world.linear_velocity(body).unwrap().y - 5.0).abs() < 0.2);
    world.set_gravity_scale(body, -1.0).unwrap();
    run(&mut world, 1.0);
    assert!(world.linear_velocity(body).unwrap().y.abs() < 0.2);
    let mass = backstop::MassProperties::of(&Geometry::cuboid(0.5, 0.5, 0.5), 2.0);
    world.set_mass(body, mass).unwrap();
    world.set_gravity_scale(body, 0.0).unwrap();
    world.set_velocity(body, Vec3::ZERO, Vec3::ZERO).unwrap();
    world.add_force(body, Vec3::X * 120.0).unwrap();
    world.step(DT).unwrap();
    assert!((world.linear_velocity(body).unwrap().x - 1.0).abs() < 1e-5);
}
