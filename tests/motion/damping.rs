//! Damping: velocity decays as exp(-c t), at any length of step.

use backstop::glam::{DVec3, Quat, Vec3};
use backstop::{BodyDesc, BodyHandle, Geometry, Settings, ShapeDesc, Snapshot, World};

/// At 30, 60 and 144 Hz.
const RATES: [u32; 3] = [30, 60, 144];

fn ball() -> BodyDesc {
    BodyDesc::dynamic().with_shape(ShapeDesc::new(Geometry::Sphere { radius: 0.5 }))
}

fn free(desc: &BodyDesc, gravity: Vec3, substeps: u32) -> (World, BodyHandle) {
    let mut world = World::new(Settings::default().with_gravity(gravity).with_substeps(substeps)).unwrap();
    let body = world.add_body(desc).unwrap();
    (world, body)
}

fn run(world: &mut World, hertz: u32, seconds: u32) {
    for _ in 0..hertz * seconds {
        world.step(1.0 / hertz as f32).unwrap();
    }
}

/// dv/dt = -c v has the solution v exp(-c t). Each step rounds: 288 of them by some 1e-7 each.
#[test]
fn velocity_decays_exponentially_at_any_rate() {
    let (linear, angular) = (0.7f32, 1.9f32);
    let (v, w) = (Vec3::new(3.0, -2.0, 8.0), Vec3::new(1.0, 5.0, -2.0));
    let mut desc = ball().with_velocity(v, w);
    (desc.linear_damping, desc.angular_damping) = (linear, angular);
    for hertz in RATES {
        for substeps in [1, 4] {
            let (mut world, body) = free(&desc, Vec3::ZERO, substeps);
            run(&mut world, hertz, 2);
            let wanted = |rate: f32| (-2.0 * f64::from(rate)).exp() as f32;
            let ended = (world.linear_velocity(body).unwrap(), world.angular_velocity(body).unwrap());
            assert!((ended.0 - v * wanted(linear)).length() < 3e-5 * v.length(), "{hertz} Hz: {ended:?}");
            assert!((ended.1 - w * wanted(angular)).length() < 3e-5 * w.length(), "{hertz} Hz: {ended:?}");
            // It gets v (1 - exp(-c t)) / c far. The error of the steps is (c dt)² / 24: 2e-5 at 30 Hz.
            let far = v * (1.0 - wanted(linear)) / linear;
            let at = world.position(body).unwrap().as_vec3();
            assert!((at - far).length() < 1e-4 * far.length(), "{hertz} Hz: {at} for {far}");
        }
    }
}

/// In gravity a damped body comes to fall with g / c.
#[test]
fn a_damped_body_has_a_terminal_velocity() {
    for hertz in RATES {
        let (mut world, body) = free(&ball().with_linear_damping(2.0), Vec3::NEG_Y * 10.0, 4);
        run(&mut world, hertz, 10);
        let speed = world.linear_velocity(body).unwrap().y;
        // (c dt)² / 24 at 30 Hz: 2e-4.
        assert!((speed + 5.0).abs() < 1e-3, "{hertz} Hz: {speed}");
    }
}

/// Only bodies with damping are damped, and only while they are dynamic.
#[test]
fn others_keep_their_velocity() {
    let (mut world, damped) = free(&ball().with_velocity(Vec3::X, Vec3::Y), Vec3::ZERO, 4);
    let other =
        world.add_body(&ball().with_position(DVec3::Z * 9.0).with_velocity(Vec3::X, Vec3::Y)).unwrap();
    let carrier = BodyDesc::kinematic().with_position(DVec3::Z * 20.0).with_velocity(Vec3::X, Vec3::Y);
    let carrier = world.add_body(&carrier.clone().with_linear_damping(3.0)).unwrap();
    world.set_damping(damped, 1.0, 2.0).unwrap();
    assert_eq!((world.damping(damped), world.damping(other)), (Ok((1.0, 2.0)), Ok((0.0, 0.0))));
    assert_eq!(world.damping(carrier), Ok((3.0, 0.0)));
    run(&mut world, 60, 1);
    assert!((world.linear_velocity(damped).unwrap().x - (-1.0f64).exp() as f32).abs() < 1e-5);
    assert_eq!((world.linear_velocity(other), world.linear_velocity(carrier)), (Ok(Vec3::X), Ok(Vec3::X)));
    world.set_damping(damped, 0.0, 0.0).unwrap();
    let before = world.linear_velocity(damped);
    run(&mut world, 60, 1);
    assert_eq!(world.linear_velocity(damped), before);
    for bad in [-1.0, f32::NAN, f32::INFINITY, 1e7] {
        assert!(world.set_damping(damped, bad, 0.0).is_err() && world.set_damping(damped, 0.0, bad).is_err());
        assert!(world.add_body(&ball().with_angular_damping(bad)).is_err());
    }
}

#[test]
fn a_snapshot_keeps_damping_and_where_kinematic_bodies_are_to_be() {
    let mut desc = ball().with_velocity(Vec3::X * 4.0, Vec3::Y);
    (desc.linear_damping, desc.angular_damping) = (0.5, 0.25);
    let (mut world, body) = free(&desc, Vec3::NEG_Y, 4);
    let mut table = BodyDesc::kinematic()
        .with_position(DVec3::Z * 10.0)
        .with_shape(ShapeDesc::new(Geometry::cuboid(1.0, 1.0, 1.0)));
    table.shapes[0].position = Vec3::new(0.3, 0.2, 0.1);
    let table = world.add_body(&table).unwrap();
    run(&mut world, 60, 1);
    let (to, turn) = (DVec3::new(0.123_456_789, 2.0, 10.5), Quat::from_rotation_y(0.3));
    world.move_kinematic(table, to, turn, 1.0 / 60.0).unwrap();
    let mut saved = Snapshot::new();
    world.snapshot(&mut saved);
    let whole = saved.to_whole_bytes();
    run(&mut world, 60, 1);
    let hash = world.state_hash();
    for snapshot in [saved, Snapshot::from_bytes(&whole).unwrap()] {
        world.set_damping(body, 0.0, 9.0).unwrap();
        world.restore(&snapshot).unwrap();
        assert_eq!(world.damping(body), Ok((0.5, 0.25)));
        run(&mut world, 60, 1);
        assert_eq!(world.state_hash(), hash);
    }
    let mut other = World::new(Settings::default()).unwrap();
    other.restore(&Snapshot::from_bytes(&whole).unwrap()).unwrap();
    run(&mut other, 60, 1);
    assert_eq!(other.state_hash(), hash);
}
