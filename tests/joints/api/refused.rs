//! Bad input is refused, and the error says why.

use super::*;

/// A joint with something wrong in it.
fn bad(good: &JointDesc) -> Vec<(&'static str, JointDesc)> {
    let mut all: Vec<(&'static str, JointDesc)> = Vec::new();
    let [a, _] = good.bodies;
    let mut add = |what, change: &dyn Fn(&mut JointDesc)| {
        let mut desc = good.clone();
        change(&mut desc);
        all.push((what, desc));
    };
    add("to itself", &|d| d.bodies = [a, a]);
    for side in 0..2 {
        for bad in [f32::NAN, f32::INFINITY] {
            add("position", &|d| d.frames[side].position.y = bad);
            add("rotation", &|d| d.frames[side].rotation.z = bad);
        }
        add("rotation of no length", &|d| d.frames[side].rotation = Quat::from_xyzw(0.0, 0.0, 0.0, 0.0));
        add("rotation of length 2", &|d| d.frames[side].rotation = Quat::from_xyzw(0.0, 0.0, 0.0, 2.0));
    }
    for bad in bad_limits() {
        add("limit", &|d| d.limits.push(bad));
    }
    for bad in bad_drives() {
        add("drive", &|d| d.motors.push(bad));
    }
    for bad in [f32::NAN, -1.0, f32::NEG_INFINITY] {
        add("break force", &|d| d.break_force = bad);
        add("break torque", &|d| d.break_torque = bad);
    }
    all
}

fn bad_springs() -> Vec<Spring> {
    let mut all = Vec::new();
    for bad in [f32::NAN, -1.0, f32::NEG_INFINITY] {
        all.push(Spring::Coefficients { stiffness: bad, damping: 0.0 });
        all.push(Spring::Coefficients { stiffness: 0.0, damping: bad });
        all.push(Spring::Acceleration { stiffness: bad, damping: 0.0 });
        all.push(Spring::Acceleration { stiffness: 0.0, damping: bad });
        all.push(Spring::Frequency { hertz: bad, ratio: 1.0 });
        all.push(Spring::Frequency { hertz: 1.0, ratio: bad });
    }
    // Nothing is infinitely stiff but a rigid limit.
    all.push(Spring::Coefficients { stiffness: f32::INFINITY, damping: 0.0 });
    all.push(Spring::Frequency { hertz: f32::INFINITY, ratio: 1.0 });
    // A ratio of damping to the critical one of a spring that is not there.
    all.push(Spring::Frequency { hertz: 0.0, ratio: f32::INFINITY });
    all
}

fn bad_limits() -> Vec<Limit> {
    let (nan, inf) = (f32::NAN, f32::INFINITY);
    let mut all = Vec::new();
    for motion in [Motion::Linear, Motion::Angular] {
        for axes in [Axes::One(Axis::X), Axes::Perpendicular(Axis::Y), Axes::All] {
            for (min, max) in [(1.0, 0.5), (nan, 1.0), (0.0, nan), (nan, nan), (inf, inf), (-inf, -inf)] {
                all.push(Limit::new(motion, axes, min, max));
            }
            for spring in bad_springs() {
                all.push(Limit::new(motion, axes, 0.0, 1.0).with_spring(spring));
            }
        }
        // A distance is never negative.
        all.push(Limit::new(motion, Axes::Perpendicular(Axis::Z), -1.0, -0.5));
        all.push(Limit::new(motion, Axes::All, -1.0, -0.5));
    }
    all
}

fn bad_drives() -> Vec<Motor> {
    let mut all = Vec::new();
    let good = Motor::velocity(Motion::Angular, Axis::X, 1.0, 10.0);
    for bad in [f32::NAN, f32::INFINITY, f32::NEG_INFINITY] {
        all.push(Motor { position: bad, ..good });
        all.push(Motor { velocity: bad, ..good });
    }
    for bad in [f32::NAN, -1.0, f32::NEG_INFINITY] {
        all.push(Motor { max_force: bad, ..good });
    }
    all.extend(bad_springs().into_iter().map(|spring| Motor { spring, ..good }));
    all
}

/// Refused calls leave no trace: not in the counts, not in the bytes, not in the bits of later steps.
#[test]
fn bad_input_is_refused_and_changes_nothing() {
    let run = |bother: bool| {
        let mut world = world(G);
        let (ground, body, joint) = hanging(&mut world);
        let other = world.add_body(&ball(DVec3::X)).unwrap();
        let good = JointDesc::fixed([body, other], [Frame::default(); 2]);
        if bother {
            let before = (world.state_hash(), world.joint_count(), world.memory());
            for (what, desc) in bad(&good) {
                assert!(world.add_joint(&desc).is_err(), "{what}: {desc:?}");
                assert!(desc.validate().is_err(), "{what}: {desc:?}");
            }
            for limit in bad_limits() {
                assert!(world.set_joint_limits(joint, &[limit]).is_err(), "{limit:?}");
                assert!(world.set_joint_limit(joint, limit).is_err(), "{limit:?}");
            }
            for drive in bad_drives() {
                assert!(world.set_joint_motors(joint, &[drive]).is_err(), "{drive:?}");
                assert!(world.set_joint_motor(joint, drive).is_err(), "{drive:?}");
            }
            assert_eq!((world.state_hash(), world.joint_count(), world.memory()), before);
            assert!(world.frames_at([ground, body], DVec3::splat(f64::NAN), Quat::IDENTITY).is_err());
            assert!(
                world.frames_at([ground, body], DVec3::ZERO, Quat::from_xyzw(0.0, 0.0, 0.0, 0.0)).is_err()
            );
        }
        common::steps(&mut world, 30, DT);
        world.state_hash()
    };
    assert_eq!(run(true), run(false));
}

#[test]
fn the_error_says_what_is_wrong() {
    let mut world = world(G);
    let still = [BodyDesc::fixed(), BodyDesc::fixed(), BodyDesc::kinematic(), BodyDesc::kinematic()]
        .map(|desc| world.add_body(&desc).unwrap());
    for (a, b) in [(0, 1), (0, 2), (2, 0), (2, 3)] {
        let desc = JointDesc::ball([still[a], still[b]], [Frame::default(); 2]);
        assert_eq!(world.add_joint(&desc), Err(Error::JointOfStill), "{a} {b}");
    }
    let body = world.add_body(&ball(DVec3::ZERO)).unwrap();
    let itself = JointDesc::ball([body; 2], [Frame::default(); 2]);
    assert_eq!(world.add_joint(&itself), Err(Error::JointToItself));
    let gone = world.add_body(&ball(DVec3::ZERO)).unwrap();
    world.remove_body(gone).unwrap();
    for bodies in [[gone, body], [body, gone], [gone, gone]] {
        let desc = JointDesc::ball(bodies, [Frame::default(); 2]);
        assert_eq!(world.add_joint(&desc), Err(Error::StaleBody));
        assert_eq!(world.frames_at(bodies, DVec3::ZERO, Quat::IDENTITY), Err(Error::StaleBody));
    }
    assert_eq!(world.joint_count(), 0);
}

#[test]
fn a_joint_beyond_the_budget_is_refused_and_changes_nothing() {
    let run = |budget: usize| {
        // Limited from the start, so that a step has its place already.
        let gravity = Vec3::Y * -G as f32;
        let mut world =
            World::new(Settings::default().with_gravity(gravity).with_budget(Budget::total(1 << 30)))
                .unwrap();
        let ground = world.add_body(&BodyDesc::fixed()).unwrap();
        let bodies: Vec<BodyHandle> =
            (0..300).map(|i| world.add_body(&ball(DVec3::X * f64::from(i))).unwrap()).collect();
        world.step(DT).unwrap();
        let used = world.memory().total();
        world.set_settings(world.settings().clone().with_budget(Budget::total(used + budget))).unwrap();
        let mut random = Random(5);
        for (i, &body) in bodies.iter().enumerate() {
            let before = (world.state_hash(), world.joint_count(), world.memory());
            match world.add_joint(&any([ground, body], &mut random)) {
                Ok(_) => {}
                Err(error) => {
                    assert!(matches!(error, Error::Budget { category: Category::Joints, .. }), "{error}");
                    assert_eq!((world.state_hash(), world.joint_count(), world.memory()), before);
                    return (i, world, used + budget);
                }
            }
        }
        (bodies.len(), world, used + budget)
    };
    let mut before = 0;
    for budget in [0, 60_000, 120_000, 300_000] {
        let (added, mut world, most) = run(budget);
        println!("{budget}: {added} joints, {} of {most}", world.memory().total());
        assert!(added < 300, "{budget}");
        assert!(added > before || budget == 0, "{budget}: {added}");
        before = added;
        assert!(world.memory().total() <= most, "{budget}: {} of {most}", world.memory().total());
        common::steps(&mut world, 3, DT);
        // The buffers that a step needs for them were counted too.
        assert!(world.memory().total() <= most, "{budget}: {} of {most}", world.memory().total());
        assert!(common::all_finite(&world));
    }
    assert_eq!(run(1 << 24).0, 300);
}

/// One joint with many rows is as dear as they are.
#[test]
fn rows_count_towards_the_budget() {
    let settings = Settings::default().with_budget(Budget::total(1 << 30));
    let mut world = World::new(settings).unwrap();
    let (ground, body, joint) = hanging(&mut world);
    world.step(DT).unwrap();
    let budget = world.memory().total() + 100_000;
    world.set_settings(world.settings().clone().with_budget(Budget::total(budget))).unwrap();
    let mut desc = JointDesc::new([ground, body], [Frame::default(); 2]);
    desc.motors = vec![Motor::friction(Motion::Angular, Axis::X, 1.0); 10_000];
    assert!(matches!(world.add_joint(&desc), Err(Error::Budget { category: Category::Joints, .. })));
    assert!(matches!(
        world.set_joint_motors(joint, &desc.motors),
        Err(Error::Budget { category: Category::Joints, .. })
    ));
    assert!(world.memory().total() <= budget);
}
