//! Kinematic bodies end exactly where they were told to.

use backstop::glam::{DVec3, Quat, Vec3};
use backstop::{BodyDesc, Geometry, Settings, ShapeDesc, World};

fn table(centre: Vec3) -> BodyDesc {
    let mut shape = ShapeDesc::new(Geometry::cuboid(1.0, 0.2, 0.5));
    shape.position = centre;
    shape.rotation = if centre == Vec3::ZERO { Quat::IDENTITY } else { Quat::from_rotation_z(0.4) };
    BodyDesc::kinematic().with_position(DVec3::new(1e5, 3.0, -7.0)).with_shape(shape)
}

/// To the bit where another body of the kind is that was put there; around half a turn in a step, far from
/// the origin, at steps of any length and any number of substeps.
#[test]
fn a_kinematic_body_is_where_it_was_told_to_be() {
    for dt in [1.0 / 30.0, 1.0 / 60.0, 1.0 / 144.0, 0.001, 0.25] {
        for (substeps, centre) in [(1, Vec3::ZERO), (4, Vec3::ZERO), (3, Vec3::new(0.3, -0.2, 0.7))] {
            let mut world = World::new(Settings::default().with_substeps(substeps)).unwrap();
            let [moved, put] = [(); 2].map(|()| world.add_body(&table(centre)).unwrap());
            for step in 0..50 {
                let s = f64::from(step);
                let at = DVec3::new(1e5 + (0.1 * s).sin(), 3.0 + 0.03 * s, 0.01 * s * s);
                let turn = Quat::from_axis_angle(Vec3::new(0.6, 0.0, 0.8), 0.061 * step as f32 * step as f32);
                world.move_kinematic(moved, at, turn, dt).unwrap();
                world.step(dt).unwrap();
                world.set_pose(put, at, turn).unwrap();
                assert_eq!(world.position(moved), world.position(put), "dt {dt}, step {step}");
                assert_eq!(world.rotation(moved), world.rotation(put), "dt {dt}, step {step}");
                // Within one rounding of the requested pose.
                let (p, q) = (world.position(moved).unwrap(), world.rotation(moved).unwrap());
                let ulp = if centre == Vec3::ZERO { 0.0 } else { 1e-6 };
                assert!((p - at).abs().max_element() <= ulp, "{p} for {at}");
                assert!(q.dot(turn).abs() > 1.0 - 1e-6, "{q} for {turn}");
            }
        }
    }
}

/// A step of another length than announced moves by the velocity.
#[test]
fn a_step_of_another_length_goes_on_with_the_velocity() {
    let mut world = World::new(Settings::default()).unwrap();
    let body = world.add_body(&BodyDesc::kinematic()).unwrap();
    world.move_kinematic(body, DVec3::X, Quat::IDENTITY, 0.02).unwrap();
    world.step(0.01).unwrap();
    assert!((world.position(body).unwrap().x - 0.5).abs() < 1e-6);
    // The call was for that step.
    world.step(0.02).unwrap();
    assert!((world.position(body).unwrap().x - 1.5).abs() < 1e-6);
}

#[test]
fn what_is_called_later_counts() {
    let mut world = World::new(Settings::default()).unwrap();
    let body = world.add_body(&BodyDesc::kinematic()).unwrap();
    let go =
        |world: &mut World, x: f64| world.move_kinematic(body, DVec3::X * x, Quat::IDENTITY, 0.02).unwrap();
    go(&mut world, 1.0);
    go(&mut world, 2.0);
    world.step(0.02).unwrap();
    assert_eq!(world.position(body), Ok(DVec3::X * 2.0));
    go(&mut world, 3.0);
    world.set_velocity(body, Vec3::Z, Vec3::ZERO).unwrap();
    world.step(0.02).unwrap();
    assert!((world.position(body).unwrap() - DVec3::new(2.0, 0.0, 0.02)).length() < 1e-6);
    go(&mut world, 5.0);
    world.set_pose(body, DVec3::ZERO, Quat::IDENTITY).unwrap();
    world.set_velocity(body, Vec3::ZERO, Vec3::ZERO).unwrap();
    world.step(0.02).unwrap();
    assert_eq!(world.position(body), Ok(DVec3::ZERO));
}

/// A platform that is told where to be stands there when it is told no more, where one that is only moved
/// goes on. Expected: places by the calls, to the bit; a velocity of 0.01 m in 0.02 s until the next step
/// begins; bodies on it stand, too.
#[test]
fn a_platform_that_is_to_stop_stands_where_it_was_told_to_be() {
    let mut world = World::new(Settings::default()).unwrap();
    let slab = ShapeDesc::new(Geometry::cuboid(2.0, 0.1, 2.0));
    let body = world.add_body(&BodyDesc::kinematic().with_shape(slab)).unwrap();
    let load = ShapeDesc::new(Geometry::cuboid(0.2, 0.2, 0.2));
    let load = world.add_body(&BodyDesc::dynamic().with_position(DVec3::Y * 0.3).with_shape(load)).unwrap();
    for step in 1..=10 {
        let to = DVec3::X * 0.01 * f64::from(step);
        world.move_kinematic_and_stop(body, to, Quat::IDENTITY, 0.02).unwrap();
        world.step(0.02).unwrap();
        assert_eq!(world.position(body), Ok(to));
        assert!((world.linear_velocity(body).unwrap() - Vec3::X * 0.5).length() < 1e-5);
    }
    for _ in 0..50 {
        world.step(0.02).unwrap();
        assert_eq!((world.position(body), world.linear_velocity(body)), (Ok(DVec3::X * 0.1), Ok(Vec3::ZERO)));
    }
    let (at, v) = (world.position(load).unwrap(), world.linear_velocity(load).unwrap());
    assert!((at.y - 0.3).abs() < 1e-3 && v.length() < 1e-3, "{at} {v}");
}

/// Expected: as the documentation says of each; also through a snapshot between the step and the stop, which
/// `snapshot::` tests of its bytes.
#[test]
fn a_stop_is_taken_back_by_a_velocity_and_not_by_a_pose() {
    let world = || {
        let mut world = World::new(Settings::default()).unwrap();
        let body = world.add_body(&BodyDesc::kinematic()).unwrap();
        world.move_kinematic_and_stop(body, DVec3::X, Quat::IDENTITY, 0.02).unwrap();
        (world, body)
    };
    // A step of another length: the velocity, for that step.
    let (mut one, body) = world();
    for _ in 0..3 {
        one.step(0.01).unwrap();
        assert!((one.position(body).unwrap().x - 0.5).abs() < 1e-6);
    }
    let (mut one, body) = world();
    one.step(0.02).unwrap();
    let mut saved = backstop::Snapshot::new();
    one.snapshot(&mut saved);
    let bytes = backstop::Snapshot::from_bytes(&saved.to_bytes()).unwrap();
    for (restored, velocity) in [(&saved, false), (&bytes, false), (&bytes, true)] {
        one.restore(restored).unwrap();
        if velocity {
            one.set_velocity(body, Vec3::X * 50.0, Vec3::ZERO).unwrap();
        }
        one.step(0.02).unwrap();
        let x = one.position(body).unwrap().x;
        assert!((x - if velocity { 2.0 } else { 1.0 }).abs() < 1e-6, "{x}");
    }
    // Put elsewhere, before the step and after it.
    for steps in [0, 1] {
        let (mut one, body) = world();
        (0..steps).for_each(|_| assert!(one.step(0.02).is_ok()));
        one.set_pose(body, DVec3::Y, Quat::IDENTITY).unwrap();
        one.step(0.02).unwrap();
        assert_eq!((one.position(body), one.linear_velocity(body)), (Ok(DVec3::Y), Ok(Vec3::ZERO)));
    }
}
