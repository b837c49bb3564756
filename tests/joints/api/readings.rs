//! Properties and motion of a joint, as they are read back.

use super::*;

/// Expected: each limit and motor of a description, as it was given, and nothing else; the order is that of
/// the documentation.
#[test]
fn limits_and_drives_are_read_as_they_were_given() {
    let mut world = world(0.0);
    let bodies = [DVec3::ZERO, DVec3::X].map(|at| world.add_body(&ball(at)).unwrap());
    let new = || JointDesc::new(bodies, [Frame::default(); 2]);
    let spring = Spring::Frequency { hertz: 3.0, ratio: 0.7 };
    let lock = |motion, axis| Limit::lock(motion, Axes::One(axis));
    let range = Limit::new(Motion::Linear, Axes::One(Axis::Y), -0.1, 0.2).with_spring(spring);
    let [drive, motor] = [
        Motor::position(Motion::Linear, Axis::Y, 0.3, spring).with_max_force(9.0),
        Motor::velocity(Motion::Linear, Axis::Y, 2.0, 5.0),
    ];
    let descs = [
        new(),
        JointDesc::fixed(bodies, [Frame::default(); 2]),
        JointDesc::wheel(bodies, [Frame::default(); 2], 0.3, spring),
        JointDesc::hinge(bodies, [Frame::default(); 2]).with_limit(range).with_motor(drive).with_motor(motor),
        new().with_limit(lock(Motion::Linear, Axis::Z)),
        new().with_limit(lock(Motion::Angular, Axis::X)).with_limit(lock(Motion::Angular, Axis::Z)),
        Axis::ALL.into_iter().fold(new(), |desc, axis| desc.with_limit(lock(Motion::Linear, axis))),
        JointDesc::distance(bodies, [Frame::default(); 2], 0.2, f32::INFINITY),
    ];
    let read = |world: &World, joint| -> (Vec<Limit>, Vec<Motor>) {
        (world.joint_limits(joint).unwrap().collect(), world.joint_motors(joint).unwrap().collect())
    };
    let joints = world.add_joints(&descs).unwrap();
    for _ in 0..2 {
        for (&joint, desc) in joints.iter().zip(&descs) {
            let (limits, drives) = read(&world, joint);
            assert_eq!(limits.len(), desc.limits.len(), "{limits:?}");
            assert!(desc.limits.iter().all(|limit| limits.contains(limit)), "{limits:?}");
            assert_eq!(drives, desc.motors);
        }
        // Others come and go, and a snapshot keeps them.
        let other = world.add_joint(&descs[2]).unwrap();
        world.step(DT).unwrap();
        world.remove_joint(other).unwrap();
        let mut snapshot = backstop::Snapshot::new();
        world.snapshot(&mut snapshot);
        world.set_joint_limits(joints[6], &[]).unwrap();
        world.set_joint_motors(joints[3], &[]).unwrap();
        assert_eq!((read(&world, joints[6]).0.len(), read(&world, joints[3]).1.len()), (0, 0));
        world.restore(&snapshot).unwrap();
        common::steps(&mut world, 10, DT);
    }
    // One of the three single locks goes: the other two stay.
    assert_eq!(world.remove_joint_limit(joints[6], Motion::Linear, Axes::One(Axis::Y)), Ok(true));
    assert_eq!(world.remove_joint_limit(joints[6], Motion::Linear, Axes::One(Axis::Y)), Ok(false));
    assert_eq!(read(&world, joints[6]).0, [Axis::X, Axis::Z].map(|axis| lock(Motion::Linear, axis)));
    // A limit that restricts nothing is not kept.
    let free = Limit::new(Motion::Linear, Axes::One(Axis::Z), f32::NEG_INFINITY, f32::INFINITY);
    world.set_joint_limit(joints[6], free).unwrap();
    assert_eq!(read(&world, joints[6]).0, [lock(Motion::Linear, Axis::X)]);
}

#[test]
fn a_body_knows_its_joints() {
    let mut world = world(0.0);
    let [a, b, c] = [0.0, 1.0, 2.0].map(|x| world.add_body(&ball(DVec3::X * x)).unwrap());
    let mut join = |bodies| world.add_joint(&JointDesc::new(bodies, [Frame::default(); 2])).unwrap();
    let (ab, bc, cb) = (join([a, b]), join([b, c]), join([c, b]));
    let of = |world: &World, body| world.joints_of(body).map(Iterator::collect::<Vec<_>>);
    assert_eq!(of(&world, a), Ok(vec![ab]));
    assert_eq!(of(&world, b), Ok(vec![cb, bc, ab]));
    world.remove_joint(bc).unwrap();
    assert_eq!(of(&world, b), Ok(vec![cb, ab]));
    assert_eq!(of(&world, c), Ok(vec![cb]));
    world.remove_body(c).unwrap();
    assert_eq!((of(&world, b), of(&world, c)), (Ok(vec![ab]), Err(Error::StaleBody)));
}

/// Expected by geometry: the second frame is put where its displacements are known, in axes that are askew in
/// the world, on bodies that are far from its origin.
#[test]
fn displacements_are_those_of_the_frames() {
    let mut world = world(0.0);
    let base = common::turned(Vec3::new(1.0, -2.0, 0.5).normalize(), 50.0);
    let far = DVec3::new(2000.0, -300.0, 1000.0);
    let a = world.add_body(&cube(far).with_rotation(base)).unwrap();
    let b = world.add_body(&cube(far)).unwrap();
    let frames = [
        Frame::at(Vec3::new(0.1, 0.2, 0.3)).with_rotation(common::turned(Vec3::Y, 30.0)),
        Frame::at(Vec3::new(-0.2, 0.1, 0.0)).with_rotation(common::turned(Vec3::Z, -70.0)),
    ];
    let joint = world.add_joint(&JointDesc::new([a, b], frames)).unwrap();
    for frame in [0, 1] {
        let (read, given) = (world.joint_local_frames(joint).unwrap()[frame], frames[frame]);
        assert!((read.position - given.position).length() < 1e-6);
        assert!(read.rotation.dot(given.rotation).abs() > 1.0 - 1e-6);
    }
    let first = world.joint_frames(joint).unwrap()[0];
    for (axis, along) in Axis::ALL.into_iter().zip([Vec3::X, Vec3::Y, Vec3::Z]) {
        for angle in [-3.0_f32, -0.4, 0.0, 0.7, 2.9] {
            let offset = Vec3::new(0.4, -0.3, 1.2);
            // The pose of the second body at which its frame is there.
            let turn = first.1 * Quat::from_axis_angle(along, angle) * frames[1].rotation.inverse();
            let at = first.0 + (first.1 * offset - turn * frames[1].position).as_dvec3();
            world.set_pose(b, at, turn).unwrap();
            let read = |motion, axes| world.joint_position(joint, motion, axes).unwrap();
            let across = offset - along * along.dot(offset);
            let expected = [
                (Motion::Linear, Axes::One(axis), offset.dot(along)),
                (Motion::Linear, Axes::Perpendicular(axis), across.length()),
                (Motion::Linear, Axes::All, 1.3),
                (Motion::Angular, Axes::One(axis), angle),
                (Motion::Angular, Axes::Perpendicular(axis), 0.0),
                (Motion::Angular, Axes::All, angle.abs()),
                (Motion::Angular, Axes::Perpendicular(Axis::ALL[(axis as usize + 1) % 3]), angle.abs()),
            ];
            for (motion, axes, value) in expected {
                let read = read(motion, axes);
                assert!((read - value).abs() < 2e-3, "{motion:?} {axes:?}: {read} for {value}");
            }
        }
    }
}

/// Speeds are the rates at which displacements grow: expected, the difference of two of them over a short
/// time, of bodies that both move and turn.
#[test]
fn speeds_are_the_rates_of_displacements() {
    let mut random = Random(3);
    for _ in 0..50 {
        let mut world = world(0.0);
        let bodies = [0.0, 0.4].map(|x| {
            let body = world.add_body(&ball(DVec3::X * x).with_rotation(random.rotation())).unwrap();
            world.set_velocity(body, random.cube(), random.cube()).unwrap();
            body
        });
        let frame = |random: &mut Random| Frame::at(random.cube() * 0.3).with_rotation(random.rotation());
        let joint = JointDesc::new(bodies, [frame(&mut random), frame(&mut random)]);
        let joint = world.add_joint(&joint).unwrap();
        for motion in [Motion::Linear, Motion::Angular] {
            for axis in Axis::ALL {
                let value =
                    |world: &World| f64::from(world.joint_position(joint, motion, Axes::One(axis)).unwrap());
                let (before, speed) = (value(&world), world.joint_velocity(joint, motion, axis).unwrap());
                // Balls without loads keep their velocities. The mean of the speeds at both ends is that of
                // the time between, but for its square.
                world.step(1e-3).unwrap();
                let rate = (value(&world) - before) / 1e-3;
                let mean = 0.5 * (speed + world.joint_velocity(joint, motion, axis).unwrap());
                // A twist of half a turn goes on at the other end of its range.
                let goes_around = (rate * 1e-3).abs() > 3.0;
                let off = (rate - f64::from(mean)).abs();
                assert!(goes_around || off < 5e-3 + 1e-3 * rate.abs(), "{motion:?} {axis:?}: {mean} {rate}");
            }
        }
    }
}

/// Statics: a hanging body pulls with m g, in every step. Three joints side by side: one asks for less than
/// it bears, one for more, one not at all; a fourth breaks.
#[test]
fn joints_above_their_thresholds_are_reported() {
    let mut world = world(G);
    let ground = world.add_body(&BodyDesc::fixed()).unwrap();
    let mut hang = |x: f64, change: &dyn Fn(JointDesc, f32) -> JointDesc| {
        let body = world.add_body(&ball(DVec3::new(x, -1.0, 0.0))).unwrap();
        let weight = world.mass(body).unwrap() * G as f32;
        let frames = [Frame::at(Vec3::X * x as f32), Frame::at(Vec3::Y)];
        world.add_joint(&change(JointDesc::ball([ground, body], frames), weight)).unwrap()
    };
    let none = f32::INFINITY;
    let breaks = hang(-1.0, &|desc, w| desc.with_thresholds(0.5 * w, none).with_break_force(0.9 * w, none));
    let below = hang(0.0, &|desc, w| desc.with_thresholds(0.9 * w, none));
    hang(1.0, &|desc, w| desc.with_thresholds(1.1 * w, none));
    let silent = hang(2.0, &|desc, _| desc);
    let weight = world.mass(world.joint_bodies(below).unwrap()[1]).unwrap() * G as f32;
    let mut broke = 0;
    for step in 0..300 {
        world.step(DT).unwrap();
        broke += world.broken_joints().len();
        let events = world.strained_joints();
        if step >= 30 {
            assert_eq!(events.iter().map(|e| e.joint).collect::<Vec<_>>(), [below], "{step}");
            assert!((events[0].force - Vec3::Y * weight).length() < 0.01 * weight, "{step}: {events:?}");
            assert_eq!(world.joint_force(below), Ok((events[0].force, events[0].torque)));
        }
        assert!(events.iter().all(|event| world.contains_joint(event.joint)), "{step}: broken and reported");
    }
    assert_eq!((broke, world.contains_joint(breaks)), (1, false));
    // In the order of handles, and from now on.
    world.set_joint_thresholds(silent, 0.5 * weight, none).unwrap();
    assert_eq!(world.joint_thresholds(silent), Ok((0.5 * weight, none)));
    world.step(DT).unwrap();
    assert_eq!(world.strained_joints().iter().map(|e| e.joint).collect::<Vec<_>>(), [below, silent]);
    world.set_joint_thresholds(below, none, none).unwrap();
    world.step(DT).unwrap();
    assert_eq!(world.strained_joints().len(), 1);
    // A torque: a weld an arm of half a metre away bears m g / 2.
    let body = world.add_body(&ball(DVec3::new(0.5, 5.0, 0.0))).unwrap();
    let frames = [Frame::at(Vec3::Y * 5.0), Frame::at(Vec3::NEG_X * 0.5)];
    let desc = JointDesc::fixed([ground, body], frames).with_thresholds(none, 0.45 * weight);
    let arm = world.add_joint(&desc).unwrap();
    common::steps(&mut world, 60, DT);
    let event = world.strained_joints().iter().find(|event| event.joint == arm).unwrap();
    assert!((event.torque.length() - 0.5 * weight).abs() < 0.02 * weight, "{event:?}");
    for bad in [f32::NAN, -1.0] {
        assert!(world.set_joint_thresholds(arm, bad, none).is_err());
        assert!(world.set_joint_break_force(arm, none, bad).is_err());
    }
    // A world without joints has none to report.
    for joint in [below, silent, arm] {
        world.remove_joint(joint).unwrap();
    }
    world.remove_body(ground).unwrap();
    world.step(DT).unwrap();
    assert!(world.strained_joints().is_empty());
}

/// A sleeping joint is not solved and not reported; it is when it wakes.
#[test]
fn joints_that_sleep_are_not_reported() {
    let settings = Settings::default().with_sleeping(true).with_gravity(Vec3::Y * -G as f32);
    let mut world = World::new(settings).unwrap();
    let (_, body, joint) = hanging(&mut world);
    world.set_joint_thresholds(joint, 1.0, f32::INFINITY).unwrap();
    common::steps(&mut world, 30, DT);
    assert_eq!(world.strained_joints().len(), 1);
    common::steps(&mut world, 300, DT);
    assert!(world.is_sleeping(body).unwrap());
    assert!(world.strained_joints().is_empty());
    world.wake(body).unwrap();
    common::steps(&mut world, 2, DT);
    assert_eq!(world.strained_joints().len(), 1);
}
