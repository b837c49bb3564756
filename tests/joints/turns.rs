//! A hinge with a range knows in which turn it is.

#![allow(clippy::disallowed_methods, reason = "expected values may use the platform's functions")]

use crate::common::random::Random;
use backstop::glam::{DVec3, Quat, Vec3};
use backstop::{
    Axes, Axis, BodyDesc, Geometry, JointDesc, Limit, Motion, Motor, Settings, ShapeDesc, Snapshot, World,
};
use std::f64::consts::TAU;

const AXES: Axes = Axes::One(Axis::X);

/// Ranges of up to ten turns, driven by motors or thrown, at 30 to 240 Hz. Expected of the angle, summed from
/// step to step: an end is passed for a moment only, by at most 0.2 rad (a thrown body turns by up to two
/// radians a step); at the end of a motor's range it stays to 0.2 degrees; and the joint's reading is that
/// sum. From a snapshot on the way, as bytes, it goes on to the same bits.
#[test]
fn a_hinge_stops_at_the_ends_of_any_range() {
    let mut wrong = Vec::new();
    for seed in 0..60 {
        let mut random = Random(seed);
        let hertz = random.of(&[30.0_f32, 60.0, 120.0, 240.0]);
        let settings = Settings::default().with_gravity(Vec3::ZERO).with_sleeping(false);
        let trees = random.chance(0.5);
        let settings = settings.with_substeps(random.of(&[1, 2, 4, 8])).with_joint_trees(trees);
        let mut world = World::new(settings).unwrap();
        let ground = world.add_body(&BodyDesc::fixed()).unwrap();
        let shape = ShapeDesc::new(Geometry::cuboid(0.5, 0.05, 0.2)).with_density(100.0);
        let body =
            world.add_body(&BodyDesc::dynamic().with_position(DVec3::X * 0.5).with_shape(shape)).unwrap();
        let about_z = Quat::from_rotation_arc(Vec3::X, Vec3::Z);
        let frames = world.frames_at([ground, body], DVec3::ZERO, about_z).unwrap();
        let (low, high) = (-random.log_range(0.3, 31.0), random.log_range(0.3, 31.0));
        let ends = [low, high].map(f64::from);
        let mut joint =
            JointDesc::hinge([ground, body], frames).with_limit(Limit::new(Motion::Angular, AXES, low, high));
        let way = random.of(&[-1.0_f32, 1.0]);
        let driven = random.chance(0.5);
        if driven {
            let speed = way * random.log_range(1.0, 30.0);
            joint = joint.with_motor(Motor::velocity(Motion::Angular, Axis::X, speed, 5000.0));
        }
        let joint = world.add_joint(&joint).unwrap();
        if !driven {
            // Up to two radians in a step.
            let spin = way * random.log_range(1.0, 60.0);
            world.set_velocity(body, Vec3::Y * (0.5 * spin), Vec3::Z * spin).unwrap();
        }
        let (mut sum, mut last, mut beyond, mut apart) = (0.0_f64, 0.0_f64, 0.0_f64, 0.0_f64);
        let steps = (20.0 * hertz) as u32;
        let (mut snapshot, middle) = (Snapshot::default(), steps / 20);
        for step in 0..steps {
            world.step(1.0 / hertz).unwrap();
            if step == middle {
                world.snapshot(&mut snapshot);
            }
            let [(_, a), (_, b)] = world.joint_frames(joint).unwrap();
            let turn = a.inverse() * b;
            let angle = 2.0 * f64::from(turn.x).atan2(f64::from(turn.w));
            sum += (angle - last) - TAU * ((angle - last) / TAU).round();
            last = angle;
            beyond = beyond.max(sum - ends[1]).max(ends[0] - sum);
            let said = world.joint_position(joint, Motion::Angular, AXES).unwrap();
            apart = apart.max((f64::from(said) - sum).abs());
        }
        let end = ends[usize::from(way > 0.0)];
        let held = !driven || (sum - end).abs() < 0.2_f64.to_radians();
        let hash = world.state_hash();
        world.restore(&Snapshot::from_bytes(&snapshot.to_bytes()).unwrap()).unwrap();
        (middle + 1..steps).for_each(|_| world.step(1.0 / hertz).map(drop).unwrap());
        let same = world.state_hash() == hash;
        if !(beyond < 0.2 && apart < 1e-3 && held && same) {
            wrong.push((seed, hertz, trees, driven, ends, sum, beyond, apart, same));
        }
    }
    assert!(wrong.is_empty(), "{} of 60: {wrong:#?}", wrong.len());
}
