//! Limits, drives and targets that a game changes while the world runs.

use super::*;

/// A door of 1 m by 2 m about the vertical frame x, its frame's y towards its edge.
fn door(world: &mut World) -> (BodyHandle, JointHandle) {
    let ground = world.add_body(&BodyDesc::fixed()).unwrap();
    let mut leaf = ShapeDesc::new(Geometry::cuboid(0.5, 1.0, 0.02));
    leaf.density = 500.0;
    let door = world.add_body(&BodyDesc::dynamic().with_position(DVec3::X * 0.5).with_shape(leaf)).unwrap();
    // The frames' x is the world's y.
    let upright = Quat::from_rotation_arc(Vec3::X, Vec3::Y);
    let frames = world.frames_at([ground, door], DVec3::ZERO, upright).unwrap();
    (door, world.add_joint(&JointDesc::hinge([ground, door], frames)).unwrap())
}

/// The door's angle about the vertical by its pose.
fn angle(world: &World, door: BodyHandle) -> f32 {
    let along = world.rotation(door).unwrap() * Vec3::X;
    (-along.z).atan2(along.x)
}

fn read(world: &World, joint: JointHandle) -> f32 {
    world.joint_position(joint, Motion::Angular, Axes::One(Axis::X)).unwrap()
}

const SERVOS: [Spring; 3] = [
    Spring::Coefficients { stiffness: 2e5, damping: 2e4 },
    Spring::Frequency { hertz: 20.0, ratio: 1.0 },
    Spring::Acceleration { stiffness: 2e4, damping: 300.0 },
];

/// Expected: the angle is that of the target, which a stiff servo with the target's velocity lags by the
/// acceleration over the square of its frequency, 0.8 rad/s² / (2 pi 20 Hz)²; angles and speeds as they are
/// read are those of pose and angular velocity; and the locks of the hinge stay.
#[test]
fn a_door_follows_its_target_for_as_long_as_it_changes() {
    for servo in SERVOS {
        let mut world = world(G);
        let (door, joint) = door(&mut world);
        world.set_joint_motor(joint, Motor::position(Motion::Angular, Axis::X, 0.0, servo)).unwrap();
        for step in 1..=1200 {
            let t = step as f32 * DT;
            let (target, speed) = (0.8 * t.sin(), 0.8 * t.cos());
            world.set_joint_target(joint, Motion::Angular, Axis::X, target, speed).unwrap();
            world.step(DT).unwrap();
            let angle = angle(&world, door);
            assert!((read(&world, joint) - angle).abs() < 1e-4, "{step}: {} {angle}", read(&world, joint));
            let spin = world.angular_velocity(door).unwrap().y;
            let read = world.joint_velocity(joint, Motion::Angular, Axis::X).unwrap();
            assert!((read - spin).abs() < 1e-4, "{step}: {read} {spin}");
            // The step ends where the target is, or leads or lags by a step of its speed.
            let off = (angle - target).abs();
            assert!(step < 60 || off < 0.8 * DT + 2e-3, "{servo:?} {step}: {angle} for {target}");
            let open = world.joint_position(joint, Motion::Linear, Axes::All).unwrap();
            let tilt = world.joint_position(joint, Motion::Angular, Axes::Perpendicular(Axis::X)).unwrap();
            assert!(open < 1e-3 && tilt < 1e-3, "{step}: {open} {tilt}");
        }
        assert_eq!(world.joint_limits(joint).unwrap().count(), 2);
    }
}

/// A motor on its own takes nothing away: it turns the door at its speed, and its hinge holds.
#[test]
fn a_motor_leaves_the_hinge_its_locks() {
    let mut world = world(G);
    let (_, joint) = door(&mut world);
    for speed in [2.0, -1.0, 0.5] {
        world.set_joint_motor(joint, Motor::velocity(Motion::Angular, Axis::X, speed, 1e4)).unwrap();
        for _ in 0..300 {
            world.step(DT).unwrap();
            let frames = world.joint_frames(joint).unwrap();
            assert!((frames[1].0 - frames[0].0).length() < 1e-3, "{frames:?}");
        }
        assert!((world.joint_velocity(joint, Motion::Angular, Axis::X).unwrap() - speed).abs() < 1e-3);
    }
    // With less force from the next step on: a torque of 1 N m is all that it gets.
    let weak = Motor::velocity(Motion::Angular, Axis::X, 100.0, 1.0);
    world.set_joint_motor(joint, weak).unwrap();
    for _ in 0..60 {
        world.step(DT).unwrap();
        assert!(world.joint_force(joint).unwrap().1.y.abs() < 1.0 + 1e-3);
    }
}

/// A target or a drive that changes in every step gives the bits of a joint whose drives are made anew in
/// every step, which keeps impulses too; with trees, without, and with the door in a chain.
#[test]
fn a_change_in_place_is_as_good_as_another_joint() {
    for (joint_trees, servo) in [true, false].into_iter().flat_map(|trees| SERVOS.map(|servo| (trees, servo)))
    {
        let run = |in_place: bool| {
            let gravity = Vec3::Y * -G as f32;
            let mut world =
                World::new(Settings::default().with_gravity(gravity).with_joint_trees(joint_trees)).unwrap();
            let (door, joint) = door(&mut world);
            let bob = world.add_body(&ball(DVec3::new(1.0, -0.5, 0.0))).unwrap();
            let frames = world.frames_at([door, bob], DVec3::X, Quat::IDENTITY).unwrap();
            world.add_joint(&JointDesc::ball([door, bob], frames)).unwrap();
            let stop = Limit::new(Motion::Angular, Axes::One(Axis::X), -1.0, 0.5);
            world.set_joint_limit(joint, stop).unwrap();
            let drive = Motor::position(Motion::Angular, Axis::X, 0.0, servo);
            world.set_joint_motor(joint, drive).unwrap();
            let mut hashes = Vec::new();
            for step in 1..=600_u16 {
                let target = 0.8 * (f32::from(step) * DT).sin();
                let stop = stop.with_range(-1.0, 0.5 + 0.1 * (f32::from(step) * 0.01).cos());
                if in_place {
                    world.set_joint_target(joint, Motion::Angular, Axis::X, target, 0.1).unwrap();
                    world.set_joint_limit(joint, stop).unwrap();
                } else {
                    let limits: Vec<Limit> =
                        world.joint_limits(joint).unwrap().filter(|l| l.axes != stop.axes).collect();
                    world.set_joint_limits(joint, &[limits, vec![stop]].concat()).unwrap();
                    world.set_joint_motors(joint, &[drive.with_target(target, 0.1)]).unwrap();
                }
                world.step(DT).unwrap();
                hashes.push(world.state_hash());
            }
            hashes
        };
        assert_eq!(run(true), run(false), "{joint_trees} {servo:?}");
    }
}

/// Expected: from the next steps on a range holds, to a milliradian what leans on it and to what turns in a
/// substep, 3 rad/s / 240 Hz, what swings against it; a range that widens lets go; locks that come and go do
/// as they say.
#[test]
fn limits_that_change_hold() {
    let mut world = world(G);
    let (door, joint) = door(&mut world);
    let range = |most: f32| Limit::new(Motion::Angular, Axes::One(Axis::X), -most, most);
    for most in [1.2_f32, 0.5, 0.9, 0.2, 1.0] {
        world.set_joint_limit(joint, range(most)).unwrap();
        for step in 0..1200 {
            let push = if step / 300 % 2 == 0 { 20.0 } else { -20.0 };
            world.add_torque(door, Vec3::Y * push).unwrap();
            world.step(DT).unwrap();
            let beyond = read(&world, joint).abs() - most;
            // What was beyond a range that got narrower is back within half a second.
            assert!(step < 30 || beyond < 3.0 / 240.0, "{most} {step}: {beyond}");
            assert!(step % 300 < 270 || beyond.abs() < 1e-3, "{most} {step}: {beyond} at rest");
        }
    }
    // Locked where it is, as a range without width, for ten seconds under load.
    let at = read(&world, joint);
    world.set_joint_limit(joint, Limit::new(Motion::Angular, Axes::One(Axis::X), at, at)).unwrap();
    for _ in 0..600 {
        world.add_torque(door, Vec3::Y * 20.0).unwrap();
        world.step(DT).unwrap();
        assert!((read(&world, joint) - at).abs() < 1e-3);
    }
    assert_eq!(world.remove_joint_limit(joint, Motion::Angular, Axes::One(Axis::X)), Ok(true));
    // Free: a torque turns it on and on, past where it was held.
    for _ in 0..60 {
        world.add_torque(door, Vec3::Y * 20.0).unwrap();
        world.step(DT).unwrap();
    }
    assert!((read(&world, joint) - at).abs() > 0.3);
    // Without the lock of its point it is a free body that falls: g t² / 2 after a second.
    let before = world.position(door).unwrap().y;
    assert_eq!(world.remove_joint_limit(joint, Motion::Linear, Axes::All), Ok(true));
    world.set_joint_motors(joint, &[]).unwrap();
    common::steps(&mut world, 60, DT);
    let fallen = before - world.position(door).unwrap().y;
    assert!((fallen - 0.5 * G).abs() < 0.1, "{fallen}");
}

/// A rope that is reeled in: its length follows the limit.
#[test]
fn a_rope_is_reeled_in() {
    let mut world = world(G);
    let ground = world.add_body(&BodyDesc::fixed()).unwrap();
    let body = world.add_body(&ball(DVec3::NEG_Y * 3.0)).unwrap();
    let rope = JointDesc::distance([ground, body], [Frame::default(); 2], 0.0, 3.0);
    let joint = world.add_joint(&rope).unwrap();
    for step in 0..600_u16 {
        let length = 3.0 - 2.0 * f32::from(step) / 600.0;
        world.set_joint_limit(joint, Limit::new(Motion::Linear, Axes::All, 0.0, length)).unwrap();
        world.step(DT).unwrap();
        let read = world.joint_position(joint, Motion::Linear, Axes::All).unwrap();
        let depth = world.position(body).unwrap().length() as f32;
        assert!((read - depth).abs() < 1e-5 && (read - length).abs() < 0.01, "{step}: {read} {length}");
    }
}

/// The anchor of a pendulum at rest moves by half a metre: it ends up below the new one, hanging.
#[test]
fn frames_move_on_their_bodies() {
    let mut world = world(G);
    let (_, body, joint) = hanging(&mut world);
    world.set_joint_motor(joint, Motor::friction(Motion::Angular, Axis::Z, 2.0)).unwrap();
    common::steps(&mut world, 30, DT);
    for x in [0.1, 0.2, 0.3, 0.4, 0.5] {
        let frames = [Frame::at(Vec3::X * x), Frame::at(Vec3::Y)];
        world.set_joint_frames(joint, frames).unwrap();
        common::steps(&mut world, 60, DT);
        assert_eq!(world.joint_local_frames(joint).unwrap()[0].position, Vec3::X * x);
    }
    world.remove_joint_motor(joint, Motion::Angular, Axis::Z).unwrap();
    let anchor = DVec3::X * 0.5;
    common::steps(&mut world, 600, DT);
    let arm = world.position(body).unwrap() - anchor;
    assert!((arm.length() - 1.0).abs() < 1e-3, "{arm}");
    let bad = Frame::at(Vec3::splat(f32::NAN));
    assert!(world.set_joint_frames(joint, [bad, Frame::default()]).is_err());
}

/// Strength, collisions and the caller's number, changed and read back.
#[test]
fn what_else_a_joint_has_changes_too() {
    let mut world = world(0.0);
    let bodies = [DVec3::ZERO, DVec3::Y * 0.499].map(|at| world.add_body(&cube(at)).unwrap());
    let frames = world.frames_at(bodies, DVec3::Y * 0.25, Quat::IDENTITY).unwrap();
    let desc = JointDesc::ball(bodies, frames).with_break_force(1e9, f32::INFINITY).with_user_data(3);
    let joint = world.add_joint(&desc).unwrap();
    let contacts = |world: &mut World| world.step(DT).unwrap().manifolds;
    assert_eq!((contacts(&mut world), world.joint_collide(joint)), (0, Ok(false)));
    world.set_joint_collide(joint, true).unwrap();
    assert_eq!((contacts(&mut world), world.joint_collide(joint)), (1, Ok(true)));
    world.set_joint_collide(joint, false).unwrap();
    assert_eq!(contacts(&mut world), 0);
    assert_eq!(world.joint_user_data(joint), Ok(3));
    world.set_joint_user_data(joint, u64::MAX).unwrap();
    assert_eq!(world.joint_user_data(joint), Ok(u64::MAX));
    assert_eq!(world.joint_break_force(joint), Ok((1e9, f32::INFINITY)));
    let pull = |world: &mut World| {
        for (body, sign) in bodies.into_iter().zip([-1.0, 1.0]) {
            world.add_force(body, Vec3::Y * (sign * 100.0)).unwrap();
        }
        world.step(DT).unwrap();
        world.broken_joints().to_vec()
    };
    // It bears the 100 N with which its two bodies are pulled apart.
    for strength in [f32::INFINITY, 110.0] {
        world.set_joint_break_force(joint, strength, f32::INFINITY).unwrap();
        for _ in 0..120 {
            assert_eq!(pull(&mut world), []);
        }
    }
    world.set_joint_break_force(joint, 90.0, f32::INFINITY).unwrap();
    assert_eq!(pull(&mut world), [joint]);
    assert!(!world.contains_joint(joint));
}

/// What is refused is refused by name and changes nothing; what changes nothing wakes nobody.
#[test]
fn targets_without_a_drive_are_refused_and_the_same_target_wakes_nobody() {
    let settings = Settings::default().with_sleeping(true).with_gravity(Vec3::Y * -G as f32);
    let mut world = World::new(settings).unwrap();
    let (body, joint) = door(&mut world);
    let target = |world: &mut World, axis, position| {
        world.set_joint_target(joint, Motion::Angular, axis, position, 0.0)
    };
    assert_eq!(target(&mut world, Axis::X, 0.0), Err(Error::NoMotor));
    world.set_joint_motor(joint, Motor::position(Motion::Angular, Axis::X, 0.3, SERVOS[0])).unwrap();
    assert_eq!(target(&mut world, Axis::Y, 0.0), Err(Error::NoMotor));
    assert!(matches!(target(&mut world, Axis::X, f32::NAN), Err(Error::NotFinite { .. })));
    assert!(matches!(target(&mut world, Axis::X, 2e9), Err(Error::OutOfRange { .. })));
    for _ in 0..600 {
        target(&mut world, Axis::X, 0.3).unwrap();
        world.step(DT).unwrap();
    }
    assert!(world.is_sleeping(body).unwrap(), "the same target over and over");
    assert!((read(&world, joint) - 0.3).abs() < 1e-3);
    target(&mut world, Axis::X, -0.3).unwrap();
    assert!(!world.is_sleeping(body).unwrap());
    common::steps(&mut world, 300, DT);
    assert!((read(&world, joint) + 0.3).abs() < 1e-3);
}

/// A drive that is added, or taken away and added again, before the first step gives the bits of a joint that
/// had it all along: rows keep the order of their joints.
#[test]
fn rows_keep_the_order_of_their_joints() {
    let run = |late: bool, joint_trees: bool| {
        let gravity = Vec3::Y * -G as f32;
        let mut world =
            World::new(Settings::default().with_gravity(gravity).with_joint_trees(joint_trees)).unwrap();
        let mut last = world.add_body(&BodyDesc::fixed()).unwrap();
        let mut joints = Vec::new();
        let motor = Motor::velocity(Motion::Angular, Axis::Z, 1.0, 5.0);
        let stop = Limit::new(Motion::Angular, Axes::One(Axis::Z), -0.5, 1.5);
        for i in 1..8 {
            let at = DVec3::X * (0.3 * f64::from(i));
            let body = world.add_body(&ball(at)).unwrap();
            let frames = world.frames_at([last, body], at - DVec3::X * 0.15, Quat::IDENTITY).unwrap();
            let mut desc = JointDesc::new([last, body], frames)
                .with_limit(Limit::lock(Motion::Linear, Axes::All))
                .with_limit(Limit::lock(Motion::Angular, Axes::Perpendicular(Axis::Z)));
            if !late {
                desc = desc.with_limit(stop).with_motor(motor);
            }
            joints.push(world.add_joint(&desc).unwrap());
            last = body;
        }
        if late {
            for &joint in &joints {
                world.set_joint_limit(joint, stop).unwrap();
                world.set_joint_motor(joint, motor).unwrap();
            }
            for &joint in joints.iter().rev().step_by(2) {
                world.remove_joint_motor(joint, Motion::Angular, Axis::Z).unwrap();
                world.set_joint_motor(joint, motor).unwrap();
            }
        }
        common::steps(&mut world, 300, DT);
        world.state_hash()
    };
    for joint_trees in [true, false] {
        assert_eq!(run(false, joint_trees), run(true, joint_trees), "{joint_trees}");
    }
}
