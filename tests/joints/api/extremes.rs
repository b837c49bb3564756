//! Joints that start far apart, bodies with locks, extreme numbers.

use super::*;

/// Joints whose frames are metres apart at first pull hard, and swing long levers; they stay numbers.
#[test]
fn joints_that_start_far_apart_stay_finite() {
    for seed in 0..200 {
        let mut random = Random(seed);
        let mut world = world(0.0);
        let a =
            world.add_body(&if seed % 2 == 0 { BodyDesc::fixed() } else { ball(DVec3::new(3.0, 2.0, 1.0)) });
        let a = a.unwrap();
        let at = [0; 3].map(|_| random.below(10) as f64);
        let b = world.add_body(&ball(DVec3::from_array(at))).unwrap();
        let desc = any([b, a], &mut random);
        world.add_joint(&desc).unwrap();
        for step in 0..120 {
            world.step(DT).unwrap();
            assert!(common::all_finite(&world), "{seed} {step}: from {at:?} by {desc:?}");
        }
    }
}

/// A body that can't turn has no inertia to be turned against.
#[test]
fn locked_bodies_can_be_joined() {
    for locks in 1..8_u32 {
        let lock_rotation = [0, 1, 2].map(|axis| locks >> axis & 1 != 0);
        for both in [false, true] {
            for kind in 0..4 {
                let mut world = world(G);
                let ground = world.add_body(&BodyDesc::fixed()).unwrap();
                let first = if both {
                    world.add_body(&ball(DVec3::ZERO).with_lock_rotation(lock_rotation)).unwrap()
                } else {
                    ground
                };
                if both {
                    world.add_joint(&JointDesc::ball([ground, first], [Frame::default(); 2])).unwrap();
                }
                let body = ball(DVec3::NEG_Y).with_lock_rotation(lock_rotation);
                let body = world.add_body(&body).unwrap();
                let bodies = [first, body];
                let frames = world.frames_at(bodies, DVec3::NEG_Y * 0.5, Quat::IDENTITY).unwrap();
                let desc = match kind {
                    0 => JointDesc::fixed(bodies, frames),
                    1 => JointDesc::hinge(bodies, frames),
                    2 => JointDesc::ball(bodies, frames)
                        .with_limit(Limit::new(Motion::Angular, Axes::One(Axis::X), 0.0, 0.0))
                        .with_motor(Motor::velocity(Motion::Angular, Axis::Y, 1.0, f32::INFINITY)),
                    _ => JointDesc::ball(bodies, frames)
                        .with_limit(Limit::lock(Motion::Angular, Axes::Perpendicular(Axis::Z))),
                };
                world.add_joint(&desc).unwrap();
                common::steps(&mut world, 60, DT);
                let at = world.position(body).unwrap();
                assert!(common::all_finite(&world), "{locks:03b} {both} {kind}: {at}");
                assert!((at - DVec3::NEG_Y).length() < 5e-3, "{locks:03b} {both} {kind}: {at}");
            }
        }
    }
}

/// Limits and motors at the ends of the allowed ranges.
#[test]
fn extreme_numbers_stay_numbers() {
    let springs = [
        Spring::Coefficients { stiffness: 1e20, damping: 1e20 },
        Spring::Coefficients { stiffness: 1e20, damping: f32::INFINITY },
        Spring::Coefficients { stiffness: 0.0, damping: 0.0 },
        Spring::Acceleration { stiffness: 1e20, damping: 1e20 },
        Spring::Frequency { hertz: 1e20, ratio: 1e20 },
        Spring::Frequency { hertz: 0.0, ratio: 1.0 },
        Spring::Frequency { hertz: 1e9, ratio: 1.0 },
    ];
    for spring in springs {
        for motion in [Motion::Linear, Motion::Angular] {
            for (min, max) in [(0.0, 0.0), (-0.1, 0.1), (f32::NEG_INFINITY, 0.1), (0.1, f32::INFINITY)] {
                for axes in [Axes::One(Axis::X), Axes::Perpendicular(Axis::X), Axes::All] {
                    let mut world = world(G);
                    let (ground, body, _) = hanging(&mut world);
                    let drive = Motor {
                        position: 0.5,
                        velocity: 10.0,
                        max_force: 1e20,
                        ..Motor::position(motion, Axis::Z, 0.5, spring)
                    };
                    let desc = JointDesc::new([ground, body], [Frame::default(), Frame::at(Vec3::Y)])
                        .with_limit(Limit::new(motion, axes, min, max).with_spring(spring));
                    let desc = if motion == Motion::Angular { desc.with_motor(drive) } else { desc };
                    if desc.validate().is_err() {
                        continue;
                    }
                    world.add_joint(&desc).unwrap();
                    common::steps(&mut world, 10, DT);
                    assert!(common::all_finite(&world), "{desc:?}");
                }
            }
        }
    }
}

/// Something stiff, up to the most that is allowed, holds where it is told to, and not just still.
#[test]
fn the_stiffest_drives_hold_their_position() {
    for spring in [
        Spring::Frequency { hertz: 1e3, ratio: 1.0 },
        Spring::Frequency { hertz: 1e6, ratio: 1.0 },
        Spring::Frequency { hertz: 1e19, ratio: 1.0 },
        Spring::Coefficients { stiffness: 1e20, damping: 0.0 },
    ] {
        let desc = Motor::position(Motion::Linear, Axis::X, 0.5, spring);
        let mut world = world(0.0);
        let ground = world.add_body(&BodyDesc::fixed()).unwrap();
        let body = world.add_body(&ball(DVec3::ZERO)).unwrap();
        let slider = JointDesc::slider([ground, body], [Frame::default(); 2]).with_motor(desc);
        if world.add_joint(&slider).is_err() {
            continue;
        }
        common::steps(&mut world, 60, DT);
        let x = world.position(body).unwrap().x;
        assert!((x - 0.5).abs() < 1e-3, "{spring:?}: {x}");
    }
}
