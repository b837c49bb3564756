//! Which handles stay valid, and that removed joints leave nothing behind.

use super::*;

/// All that takes a handle refuses a stale one.
fn is_stale(world: &mut World, joint: JointHandle) -> bool {
    let answers = [
        world.joint_bodies(joint).err(),
        world.joint_force(joint).err(),
        world.joint_frames(joint).err(),
        world.joint_user_data(joint).err(),
        world.joint_limits(joint).map(drop).err(),
        world.joint_motors(joint).map(drop).err(),
        world.joint_position(joint, Motion::Linear, Axes::All).err(),
        world.joint_velocity(joint, Motion::Linear, Axis::X).err(),
        world.joint_local_frames(joint).err(),
        world.joint_collide(joint).err(),
        world.joint_break_force(joint).err(),
        world.joint_thresholds(joint).err(),
        world.set_joint_motor(joint, Motor::friction(Motion::Linear, Axis::X, 1.0)).err(),
        world.remove_joint_motor(joint, Motion::Linear, Axis::X).err(),
        world.set_joint_target(joint, Motion::Linear, Axis::X, 0.0, 0.0).err(),
        world.set_joint_limit(joint, Limit::lock(Motion::Linear, Axes::All)).err(),
        world.remove_joint_limit(joint, Motion::Linear, Axes::All).err(),
        world.set_joint_frames(joint, [Frame::default(); 2]).err(),
        world.set_joint_collide(joint, true).err(),
        world.set_joint_break_force(joint, 1.0, 1.0).err(),
        world.set_joint_thresholds(joint, 1.0, 1.0).err(),
        world.set_joint_user_data(joint, 1).err(),
        world.set_joint_limits(joint, &[]).err(),
        world.set_joint_motors(joint, &[]).err(),
        world.remove_joint(joint).err(),
    ];
    !world.contains_joint(joint) && answers.iter().all(|e| *e == Some(Error::StaleJoint))
}

#[test]
fn handles_go_stale_with_the_joint_with_either_body_and_when_it_breaks() {
    for way in 0..4 {
        let mut world = world(G);
        let ground = world.add_body(&BodyDesc::fixed()).unwrap();
        let [a, b, c] = [1.0, 2.0, 3.0].map(|x| world.add_body(&ball(DVec3::X * x)).unwrap());
        let join = |world: &mut World, bodies, strength: f32| {
            let desc =
                JointDesc::ball(bodies, [Frame::default(); 2]).with_break_force(strength, f32::INFINITY);
            world.add_joint(&desc).unwrap()
        };
        let keep = join(&mut world, [ground, c], f32::INFINITY);
        // A joint of two bodies that fall side by side bears nothing.
        let joint = if way == 3 {
            join(&mut world, [ground, b], 0.0)
        } else {
            join(&mut world, [a, b], f32::INFINITY)
        };
        common::steps(&mut world, 2, DT);
        match way {
            0 => world.remove_joint(joint).unwrap(),
            1 => world.remove_body(a).unwrap(),
            2 => world.remove_body(b).unwrap(),
            _ => {}
        }
        assert!(is_stale(&mut world, joint), "{way}");
        assert_eq!((world.joint_count(), world.contains_joint(keep)), (1, true), "{way}");
        // The next joint in the slot has another handle.
        let [d, e] = [4.0, 5.0].map(|x| world.add_body(&ball(DVec3::X * x)).unwrap());
        let next = join(&mut world, [d, e], f32::INFINITY);
        assert!(is_stale(&mut world, joint) && next != joint, "{way}");
        assert_eq!(world.joint_bodies(next), Ok([d, e]), "{way}");
        assert_eq!(world.joint_bodies(keep), Ok([ground, c]), "{way}");
        common::steps(&mut world, 2, DT);
        assert!(common::all_finite(&world), "{way}");
    }
}

/// The expected state of a joint.
struct Expected {
    joint: JointHandle,
    bodies: [BodyHandle; 2],
    user_data: u64,
    there: bool,
}

/// 10,000 calls, against a list.
#[test]
fn random_calls_match_a_slow_model() {
    let mut random = Random(7);
    let mut world = world(0.0);
    let mut bodies: Vec<BodyHandle> = Vec::new();
    let mut all: Vec<Expected> = Vec::new();
    let mut slots = std::collections::BTreeSet::new();
    for call in 0..10_000_u64 {
        match random.below(100) {
            0..12 if bodies.len() < 60 => {
                let x = random.below(1000) as f64;
                let at = DVec3::new(x % 10.0, (x / 10.0).floor() % 10.0, (x / 100.0).floor()) / 10.0;
                let desc = match random.below(6) {
                    0 => BodyDesc::fixed(),
                    1 => BodyDesc::kinematic(),
                    _ => ball(at),
                };
                bodies.push(world.add_body(&desc).unwrap());
            }
            12..17 if !bodies.is_empty() => {
                let body = bodies.swap_remove(random.below(bodies.len()));
                world.remove_body(body).unwrap();
                all.iter_mut().filter(|e| e.bodies.contains(&body)).for_each(|e| e.there = false);
            }
            17..60 if bodies.len() > 1 => {
                let pair = [0; 2].map(|_| bodies[random.below(bodies.len())]);
                let still = pair.iter().all(|&b| world.mass(b) == Ok(0.0));
                let mut desc = any(pair, &mut random).with_user_data(call);
                // They fit where they are: this is no test of joints that can't be met.
                let frames = world.frames_at(pair, world.position(pair[1]).unwrap(), Quat::IDENTITY).unwrap();
                desc.frames = frames;
                match world.add_joint(&desc) {
                    Ok(joint) => {
                        assert!(!still && pair[0] != pair[1]);
                        slots.insert(format!("{joint:?}").split("generation").next().unwrap().to_owned());
                        all.push(Expected { joint, bodies: pair, user_data: call, there: true });
                    }
                    Err(error) => assert!(still || pair[0] == pair[1], "{error}"),
                }
            }
            60..90 if !all.is_empty() => {
                let i = random.below(all.len());
                let answer = world.remove_joint(all[i].joint);
                assert_eq!(answer, if all[i].there { Ok(()) } else { Err(Error::StaleJoint) });
                all[i].there = false;
            }
            90..95 if !all.is_empty() => {
                let i = random.below(all.len());
                let desc = any(all[i].bodies, &mut random);
                let answer = world.set_joint_limits(all[i].joint, &desc.limits);
                let also = world.set_joint_motors(all[i].joint, &desc.motors);
                assert_eq!(answer, also);
                assert_eq!(answer, if all[i].there { Ok(()) } else { Err(Error::StaleJoint) });
            }
            95..98 => {
                world.step(DT).unwrap();
                assert!(common::all_finite(&world), "{call}");
            }
            _ => {}
        }
        assert_eq!(world.joint_count(), all.iter().filter(|e| e.there).count(), "{call}");
        if call % 50 == 0 {
            for e in &all {
                assert_eq!(world.contains_joint(e.joint), e.there, "{call}");
                let bodies = world.joint_bodies(e.joint);
                assert_eq!(bodies, if e.there { Ok(e.bodies) } else { Err(Error::StaleJoint) }, "{call}");
                let data = world.joint_user_data(e.joint);
                assert_eq!(data, if e.there { Ok(e.user_data) } else { Err(Error::StaleJoint) }, "{call}");
            }
            // Those that are long gone are asked for often enough.
            if all.len() > 600 {
                all.retain(|e| e.there);
            }
        }
    }
    println!("{} slots", slots.len());
    assert!(slots.len() < 1000, "{} slots: they are not used again", slots.len());
}

/// Two worlds that came to the same bodies and joints by different ways behave alike.
#[test]
fn what_was_added_and_removed_in_between_leaves_no_trace() {
    let run = |detour: bool| {
        let mut world = world(G);
        let ground = world.add_body(&BodyDesc::fixed()).unwrap();
        let bodies: Vec<BodyHandle> =
            (0..10).map(|i| world.add_body(&ball(DVec3::X * f64::from(i))).unwrap()).collect();
        let mut last = ground;
        for (i, &body) in bodies.iter().enumerate() {
            let frames = [Frame::default(), Frame::at(Vec3::NEG_X)];
            let desc = JointDesc::ball([last, body], frames);
            if detour && i % 3 == 0 {
                let gone = world.add_joint(&JointDesc::fixed([body, ground], frames)).unwrap();
                world.remove_joint(gone).unwrap();
            }
            world.add_joint(&desc).unwrap();
            last = body;
        }
        common::steps(&mut world, 60, DT);
        world.state_hash()
    };
    assert_eq!(run(true), run(false));
}

#[test]
fn joints_take_no_bytes_where_there_are_none_and_no_more_after_churn() {
    let bytes = |world: &World| world.memory().category(Category::Joints);
    let mut world = world(G);
    let ground = world.add_body(&BodyDesc::fixed()).unwrap();
    let bodies: Vec<BodyHandle> =
        (0..200).map(|i| world.add_body(&ball(DVec3::X * f64::from(i))).unwrap()).collect();
    common::steps(&mut world, 2, DT);
    assert_eq!((bytes(&world).live, bytes(&world).reserved), (0, 0));
    let mut levels = Vec::new();
    for round in 0..10 {
        let mut random = Random(3);
        let mut joints: Vec<JointHandle> =
            bodies.iter().map(|&body| world.add_joint(&any([ground, body], &mut random)).unwrap()).collect();
        world.step(DT).unwrap();
        let full = bytes(&world);
        // Out of order, so that slots come back in another one.
        while !joints.is_empty() {
            let i = (joints.len() * 7 + round) % joints.len();
            world.remove_joint(joints.swap_remove(i)).unwrap();
        }
        world.step(DT).unwrap();
        levels.push((full, bytes(&world)));
    }
    println!("{:?}", levels[0]);
    assert!(levels[0].0.live > 200 * 100);
    for level in &levels[1..] {
        // Live bytes of lists of the free may differ while the slots are in use.
        assert_eq!((level.0.live, level.1.live), (levels[1].0.live, levels[1].1.live));
        assert_eq!((level.0.reserved, level.1.reserved), (levels[1].0.reserved, levels[1].1.reserved));
        assert!(level.1.live < level.0.live);
    }
}

/// Bodies that come and go move others to other places in the columns; joints follow them.
#[test]
fn joints_follow_their_bodies_when_others_come_and_go() {
    let run = |traffic: bool| {
        let mut world = world(G);
        let others = || {
            let aside = DVec3::Z * 100.0;
            [ball(aside), BodyDesc::kinematic(), BodyDesc::fixed(), ball(aside + DVec3::X)]
        };
        let mut extra: Vec<BodyHandle> = Vec::new();
        if traffic {
            extra.extend(others().map(|desc| world.add_body(&desc).unwrap()));
        }
        let ground = world.add_body(&BodyDesc::fixed()).unwrap();
        let mut last = ground;
        let mut chain = Vec::new();
        for i in 0..6 {
            let at = DVec3::X * (f64::from(i) + 1.0);
            let body = world.add_body(&ball(at)).unwrap();
            let frames = world.frames_at([last, body], at - DVec3::X * 0.5, Quat::IDENTITY).unwrap();
            let desc = if i % 2 == 0 {
                JointDesc::ball([last, body], frames)
            } else {
                JointDesc::hinge([last, body], frames).with_motor(Motor::friction(
                    Motion::Angular,
                    Axis::X,
                    0.1,
                ))
            };
            world.add_joint(&desc).unwrap();
            chain.push(body);
            last = body;
        }
        for step in 0..90 {
            if traffic {
                let gone = extra.remove(step % extra.len());
                world.remove_body(gone).unwrap();
                extra.push(world.add_body(&others()[step % 4]).unwrap());
            }
            world.step(DT).unwrap();
        }
        chain.iter().map(|&body| world.position(body).unwrap()).collect::<Vec<_>>()
    };
    assert_eq!(run(true), run(false));
}
