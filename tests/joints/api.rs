//! Joints as their caller sees them: what is refused, which handles stay good, what is reported.

#![allow(clippy::disallowed_methods, reason = "expected values may use the platform's functions")]

use crate::common::random::Random;
use crate::common::{self, G};
use backstop::glam::{DVec3, Mat3, Quat, Vec3};
use backstop::{
    Axes, Axis, BodyDesc, BodyHandle, Budget, Category, Drive, Error, Frame, Geometry, JointDesc,
    JointHandle, Limit, MassProperties, Material, Motion, Settings, ShapeDesc, Spring, World,
};

const DT: f32 = 1.0 / 60.0;

fn world(gravity: f64) -> World {
    World::new(Settings { gravity: Vec3::Y * -gravity as f32, ..Settings::default() }).unwrap()
}

fn ball(at: DVec3) -> BodyDesc {
    BodyDesc::dynamic().at(at).with_shape(ShapeDesc::new(Geometry::Sphere { radius: 0.1 }))
}

fn cube(at: DVec3) -> BodyDesc {
    BodyDesc::dynamic().at(at).with_shape(ShapeDesc::new(Geometry::cuboid(0.25, 0.25, 0.25)))
}

/// A ball on a rod of 1 m, hanging at rest; its joint to the ground.
fn hanging(world: &mut World) -> (BodyHandle, BodyHandle, JointHandle) {
    let ground = world.add_body(&BodyDesc::fixed()).unwrap();
    let body = world.add_body(&ball(DVec3::NEG_Y)).unwrap();
    let joint = world.add_joint(&JointDesc::ball([ground, body], [Frame::default(), Frame::at(Vec3::Y)]));
    (ground, body, joint.unwrap())
}

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
        add("drive", &|d| d.drives.push(bad));
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
        for axes in [Axes::One(Axis::X), Axes::Around(Axis::Y), Axes::All] {
            for (min, max) in [(1.0, 0.5), (nan, 1.0), (0.0, nan), (nan, nan), (inf, inf), (-inf, -inf)] {
                all.push(Limit::new(motion, axes, min, max));
            }
            for spring in bad_springs() {
                all.push(Limit::new(motion, axes, 0.0, 1.0).with_spring(spring));
            }
        }
        // A distance is never negative.
        all.push(Limit::new(motion, Axes::Around(Axis::Z), -1.0, -0.5));
        all.push(Limit::new(motion, Axes::All, -1.0, -0.5));
    }
    all
}

fn bad_drives() -> Vec<Drive> {
    let mut all = Vec::new();
    let good = Drive::motor(Motion::Angular, Axis::X, 1.0, 10.0);
    for bad in [f32::NAN, f32::INFINITY, f32::NEG_INFINITY] {
        all.push(Drive { position: bad, ..good });
        all.push(Drive { velocity: bad, ..good });
    }
    for bad in [f32::NAN, -1.0, f32::NEG_INFINITY] {
        all.push(Drive { max_force: bad, ..good });
    }
    all.extend(bad_springs().into_iter().map(|spring| Drive { spring, ..good }));
    all
}

/// What is refused leaves no trace: not in the counts, not in the bytes, not in the bits of what follows.
#[test]
fn bad_input_is_refused_and_changes_nothing() {
    let run = |bother: bool| {
        let mut world = world(G);
        let (ground, body, joint) = hanging(&mut world);
        let other = world.add_body(&ball(DVec3::X)).unwrap();
        let good = JointDesc::fixed([body, other], [Frame::default(); 2]);
        if bother {
            let before = (world.hash(), world.joint_count(), world.memory());
            for (what, desc) in bad(&good) {
                assert!(world.add_joint(&desc).is_err(), "{what}: {desc:?}");
                assert!(desc.validate().is_err(), "{what}: {desc:?}");
            }
            for limit in bad_limits() {
                assert!(world.set_joint(joint, &[limit], &[]).is_err(), "{limit:?}");
            }
            for drive in bad_drives() {
                assert!(world.set_joint(joint, &[], &[drive]).is_err(), "{drive:?}");
            }
            assert_eq!((world.hash(), world.joint_count(), world.memory()), before);
            assert!(world.frames_at([ground, body], DVec3::splat(f64::NAN), Quat::IDENTITY).is_err());
            assert!(
                world.frames_at([ground, body], DVec3::ZERO, Quat::from_xyzw(0.0, 0.0, 0.0, 0.0)).is_err()
            );
        }
        common::steps(&mut world, 30, DT);
        world.hash()
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

/// All that takes a handle refuses a stale one.
fn is_stale(world: &mut World, joint: JointHandle) -> bool {
    let answers = [
        world.joint_bodies(joint).err(),
        world.joint_force(joint).err(),
        world.joint_frames(joint).err(),
        world.joint_user_data(joint).err(),
        world.set_joint(joint, &[], &[]).err(),
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
            let desc = JointDesc::ball(bodies, [Frame::default(); 2]).breaking(strength, f32::INFINITY);
            world.add_joint(&desc).unwrap()
        };
        let keep = join(&mut world, [ground, c], f32::INFINITY);
        // Of two that fall side by side a joint bears nothing.
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
        // Whoever gets the slot next is someone else.
        let [d, e] = [4.0, 5.0].map(|x| world.add_body(&ball(DVec3::X * x)).unwrap());
        let next = join(&mut world, [d, e], f32::INFINITY);
        assert!(is_stale(&mut world, joint) && next != joint, "{way}");
        assert_eq!(world.joint_bodies(next), Ok([d, e]), "{way}");
        assert_eq!(world.joint_bodies(keep), Ok([ground, c]), "{way}");
        common::steps(&mut world, 2, DT);
        assert!(common::all_finite(&world), "{way}");
    }
}

/// Some joint of many kinds.
fn any(bodies: [BodyHandle; 2], random: &mut Random) -> JointDesc {
    let frames = [Frame::default(); 2];
    let spring = Spring::Frequency { hertz: 3.0, ratio: 0.7 };
    match random.below(9) {
        0 => JointDesc::fixed(bodies, frames),
        1 => JointDesc::ball(bodies, frames).with_limit(Limit::new(
            Motion::Angular,
            Axes::Around(Axis::X),
            0.0,
            0.8,
        )),
        2 => JointDesc::hinge(bodies, frames).with_limit(Limit::new(
            Motion::Angular,
            Axes::One(Axis::X),
            -0.5,
            0.7,
        )),
        3 => JointDesc::slider(bodies, frames).with_limit(Limit::new(
            Motion::Linear,
            Axes::One(Axis::X),
            -0.5,
            0.7,
        )),
        4 => JointDesc::distance(bodies, frames, 0.0, 0.5),
        5 => JointDesc::wheel(bodies, frames, 0.3, spring),
        6 => JointDesc::hinge(bodies, frames).with_drive(Drive::motor(Motion::Angular, Axis::X, 3.0, 5.0)),
        7 => JointDesc::new(bodies, frames)
            .with_limit(Limit::new(Motion::Linear, Axes::All, 0.0, 0.2).with_spring(spring))
            .with_drive(Drive::friction(Motion::Angular, Axis::Y, 0.1)),
        _ => JointDesc::new(bodies, frames),
    }
}

/// What the world should know of its joints.
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
                let desc = JointDesc { user_data: call, ..any(pair, &mut random) };
                // They fit where they are: what joints do that can't be met is not asked here.
                let frames = world.frames_at(pair, world.position(pair[1]).unwrap(), Quat::IDENTITY).unwrap();
                let desc = JointDesc { frames, ..desc };
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
                let answer = world.set_joint(all[i].joint, &desc.limits, &desc.drives);
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
        world.hash()
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
                JointDesc::hinge([last, body], frames).with_drive(Drive::friction(
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

/// What acted in the last step starts the next in proportion to its length.
#[test]
fn steps_of_changing_length_bear_the_same_load() {
    let mut world = world(G);
    let (_, body, joint) = hanging(&mut world);
    let weight = world.mass(body).unwrap() * G as f32;
    for step in 0..120 {
        let dt = [1.0 / 60.0, 1.0 / 30.0, 1.0 / 240.0][step % 3];
        world.step(dt).unwrap();
        let (force, _) = world.joint_force(joint).unwrap();
        if step > 20 {
            assert!((force - Vec3::Y * weight).length() < 0.01 * weight, "{step}: {force} for {weight}");
        }
    }
    assert!((world.position(body).unwrap() - DVec3::NEG_Y).length() < 1e-3);
}

/// A body that can't move is as good as the ground.
#[test]
fn a_mass_hangs_from_a_body_that_is_locked_in_place() {
    let mut world = world(G);
    let anchor = BodyDesc { lock_translation: [true; 3], lock_rotation: [true; 3], ..ball(DVec3::ZERO) };
    let anchor = world.add_body(&anchor).unwrap();
    let body = world.add_body(&ball(DVec3::NEG_Y)).unwrap();
    let frames = [Frame::default(), Frame::at(Vec3::Y)];
    let joint = world.add_joint(&JointDesc::ball([anchor, body], frames)).unwrap();
    common::steps(&mut world, 240, DT);
    let (at, v) = (world.position(body).unwrap(), world.linear_velocity(body).unwrap());
    let force = world.joint_force(joint).unwrap().0.y / (world.mass(body).unwrap() * G as f32);
    println!("{at} {v} {force}");
    assert!((at - DVec3::NEG_Y).length() < 1e-3 && v.length() < 1e-3, "{at} {v}");
    assert!((force - 1.0).abs() < 1e-2, "{force}");
    assert_eq!(world.position(anchor).unwrap(), DVec3::ZERO);
}

/// Contacts that a step found.
fn contacts(world: &mut World) -> u32 {
    world.step(DT).unwrap().manifolds
}

#[test]
fn joined_bodies_collide_only_if_asked_to() {
    for first_is in ["dynamic", "fixed", "kinematic"] {
        let pair = |world: &mut World| {
            let first = match first_is {
                "dynamic" => cube(DVec3::ZERO),
                kind => {
                    let kind = if kind == "fixed" { BodyDesc::fixed() } else { BodyDesc::kinematic() };
                    kind.with_shape(ShapeDesc::new(Geometry::cuboid(0.25, 0.25, 0.25)))
                }
            };
            [world.add_body(&first).unwrap(), world.add_body(&cube(DVec3::Y * 0.499)).unwrap()]
        };
        for flip in [false, true] {
            let mut world = world(0.0);
            let [a, b] = pair(&mut world);
            let bodies = if flip { [b, a] } else { [a, b] };
            let frames = world.frames_at(bodies, DVec3::Y * 0.25, Quat::IDENTITY).unwrap();
            let desc = JointDesc::ball(bodies, frames);
            let what = format!("{first_is} {flip}");
            assert_eq!(contacts(&mut world), 1, "{what}: they touch");
            let joint = world.add_joint(&desc).unwrap();
            assert_eq!(contacts(&mut world), 0, "{what}: joined, what touched lets go");
            let second = world.add_joint(&desc.clone().colliding(true)).unwrap();
            assert_eq!(contacts(&mut world), 0, "{what}: one that collides does not overrule the other");
            world.remove_joint(joint).unwrap();
            assert_eq!(contacts(&mut world), 1, "{what}: only the one that collides is left");
            world.remove_joint(second).unwrap();
            assert_eq!(contacts(&mut world), 1, "{what}: no joint");
            let joint = world.add_joint(&desc.clone().breaking(0.0, f32::INFINITY)).unwrap();
            world.set_velocity(b, Vec3::X * 0.1, Vec3::ZERO).unwrap();
            assert_eq!(contacts(&mut world), 0, "{what}: joined again");
            assert!(!world.contains_joint(joint), "{what}");
            assert_eq!(contacts(&mut world), 1, "{what}: broken");
            // One body's joint to a third says nothing about these two.
            let third = world.add_body(&ball(DVec3::X * 5.0)).unwrap();
            world.add_joint(&JointDesc::new([b, third], [Frame::default(); 2])).unwrap();
            assert_eq!(contacts(&mut world), 1, "{what}: joined to another");
        }
    }
}

#[test]
fn a_change_of_mass_leaves_joints_where_they_are() {
    let mut world = world(0.0);
    let turn = Quat::from_euler(backstop::glam::EulerRot::XYZ, 0.3, -0.8, 1.1);
    let [a, b] = [DVec3::new(1.0, 2.0, 3.0), DVec3::new(1.5, 2.5, 3.0)]
        .map(|at| world.add_body(&cube(at).rotated(turn)).unwrap());
    let frames = world.frames_at([a, b], DVec3::new(1.2, 2.2, 3.1), turn.inverse()).unwrap();
    let joint = world.add_joint(&JointDesc::fixed([a, b], frames)).unwrap();
    let before = world.joint_frames(joint).unwrap();
    let same = |world: &World, what: &str| {
        for (now, before) in world.joint_frames(joint).unwrap().iter().zip(&before) {
            assert!((now.0 - before.0).length() < 1e-6, "{what}: {} {}", now.0, before.0);
            assert!(now.1.dot(before.1).abs() > 1.0 - 1e-6, "{what}: {} {}", now.1, before.1);
        }
    };
    same(&world, "as it is");
    // Off the centre and askew: the principal axes turn.
    let mut more = ShapeDesc::new(Geometry::capsule(0.5, 0.1));
    (more.position, more.rotation) = (Vec3::new(0.4, -0.3, 0.2), common::turned(Vec3::X, 30.0));
    let shape = world.add_shape(b, &more).unwrap();
    same(&world, "a shape more");
    world.remove_shape(shape).unwrap();
    same(&world, "a shape less");
    let inertia = Mat3::from_diagonal(Vec3::new(1.0, 2.0, 2.5));
    world.set_mass(a, MassProperties { mass: 7.0, center: Vec3::new(0.1, 0.2, -0.3), inertia }).unwrap();
    same(&world, "another mass");
    // And nothing pulls, as nothing moved.
    world.step(DT).unwrap();
    let speed = [a, b].map(|body| world.linear_velocity(body).unwrap().length());
    assert!(speed.iter().all(|v| *v < 1e-4), "{speed:?}");
}

#[test]
fn frames_at_a_point_coincide_there() {
    let mut world = world(0.0);
    let turn = common::turned(Vec3::new(1.0, 2.0, -1.0).normalize(), 70.0);
    let mut off = ShapeDesc::new(Geometry::cuboid(0.1, 0.2, 0.3));
    off.position = Vec3::new(0.5, 0.1, 0.0);
    // Far from the world's origin, where single precision has steps of 60 mm.
    let far = DVec3::new(1e6, 0.0, -1e6);
    let a = world.add_body(&BodyDesc::dynamic().at(far).rotated(turn).with_shape(off)).unwrap();
    let b = world.add_body(&cube(far + DVec3::Y)).unwrap();
    let (point, axes) = (far + DVec3::new(0.1, 0.7, 0.2), common::turned(Vec3::Z, 20.0));
    let frames = world.frames_at([a, b], point, axes).unwrap();
    let joint = world.add_joint(&JointDesc::fixed([a, b], frames)).unwrap();
    for (at, rotation) in world.joint_frames(joint).unwrap() {
        assert!((at - point).length() < 1e-6, "{}", at - point);
        assert!(rotation.dot(axes).abs() > 1.0 - 1e-6);
    }
}

#[test]
fn set_joint_changes_what_is_driven_and_limited() {
    let mut world = world(0.0);
    let ground = world.add_body(&BodyDesc::fixed()).unwrap();
    let wheel = world.add_body(&ball(DVec3::ZERO)).unwrap();
    let hinge = JointDesc::hinge([ground, wheel], [Frame::default(); 2]);
    let motor = |speed| Drive::motor(Motion::Angular, Axis::X, speed, 1e3);
    let joint = world.add_joint(&hinge.clone().with_drive(motor(2.0))).unwrap();
    for speed in [2.0, -5.0, 0.0, 3.0] {
        world.set_joint(joint, &hinge.limits, &[motor(speed)]).unwrap();
        common::steps(&mut world, 3, DT);
        let spin = world.angular_velocity(wheel).unwrap();
        assert!((spin - Vec3::X * speed).length() < 1e-4, "{spin} for {speed}");
    }
    // Without a drive it coasts; without a limit it flies off.
    world.set_joint(joint, &hinge.limits, &[]).unwrap();
    common::steps(&mut world, 30, DT);
    assert!((world.angular_velocity(wheel).unwrap() - Vec3::X * 3.0).length() < 1e-4);
    world.set_joint(joint, &[], &[]).unwrap();
    world.set_velocity(wheel, Vec3::Y, Vec3::ZERO).unwrap();
    common::steps(&mut world, 60, DT);
    assert!((world.position(wheel).unwrap() - DVec3::Y).length() < 1e-4);
    assert_eq!(world.joint_count(), 1);
}

/// A joint with nothing to it bears nothing, whatever it bore before.
#[test]
fn a_joint_that_was_emptied_bears_nothing() {
    let mut world = world(G);
    let (_, _, joint) = hanging(&mut world);
    common::steps(&mut world, 10, DT);
    assert!(world.joint_force(joint).unwrap().0.y > 1.0);
    world.set_joint(joint, &[], &[]).unwrap();
    common::steps(&mut world, 2, DT);
    assert_eq!(world.joint_force(joint), Ok((Vec3::ZERO, Vec3::ZERO)));
}

/// Statics: a hanging mass pulls with m g; its joint holds it with as much, on whichever side of the joint it is.
#[test]
fn force_of_a_hanging_mass() {
    for flip in [false, true] {
        for (substeps, iterations) in [(1, 8), (4, 1)] {
            let gravity = Vec3::Y * -G as f32;
            let mut world =
                World::new(Settings { gravity, substeps, iterations, ..Settings::default() }).unwrap();
            let ground = world.add_body(&BodyDesc::fixed()).unwrap();
            let body = world.add_body(&ball(DVec3::NEG_Y)).unwrap();
            let (mut bodies, mut frames) = ([ground, body], [Frame::default(), Frame::at(Vec3::Y)]);
            if flip {
                bodies.reverse();
                frames.reverse();
            }
            let joint = world.add_joint(&JointDesc::ball(bodies, frames)).unwrap();
            common::steps(&mut world, 60, DT);
            let weight = world.mass(body).unwrap() * G as f32;
            // On the second body of the joint: the ball, or the ground that the ball pulls down.
            let expected = Vec3::Y * if flip { -weight } else { weight };
            let (force, torque) = world.joint_force(joint).unwrap();
            assert!((force - expected).length() < 1e-3 * weight, "{force} for {expected}");
            assert!(torque.length() < 1e-3 * weight, "{torque}");
        }
    }
}

/// Statics: a beam fixed at its end, its centre l from there, needs a torque of m g l.
#[test]
fn torque_of_a_cantilever() {
    let mut world = world(G);
    let ground = world.add_body(&BodyDesc::fixed()).unwrap();
    let beam = ShapeDesc::new(Geometry::cuboid(0.5, 0.05, 0.05));
    let beam = world.add_body(&BodyDesc::dynamic().at(DVec3::X * 0.5).with_shape(beam)).unwrap();
    let frames = world.frames_at([ground, beam], DVec3::ZERO, common::turned(Vec3::Y, 40.0)).unwrap();
    let joint = world.add_joint(&JointDesc::fixed([ground, beam], frames)).unwrap();
    common::steps(&mut world, 120, DT);
    let weight = world.mass(beam).unwrap() * G as f32;
    let (force, torque) = world.joint_force(joint).unwrap();
    assert!((force - Vec3::Y * weight).length() < 2e-3 * weight, "{force} {weight}");
    // Gravity turns the beam about -z; the joint holds against it.
    assert!((torque - Vec3::Z * weight * 0.5).length() < 2e-3 * weight, "{torque} {}", weight * 0.5);
    let tip = world.position(beam).unwrap();
    assert!((tip - DVec3::X * 0.5).length() < 2e-3, "{tip}");
}

#[test]
fn a_joint_breaks_above_its_strength_and_not_below() {
    let weight = {
        let mut world = world(G);
        let (_, body, _) = hanging(&mut world);
        world.mass(body).unwrap() * G as f32
    };
    for (share, holds) in [(1.02, true), (0.98, false)] {
        let mut world = world(G);
        let ground = world.add_body(&BodyDesc::fixed()).unwrap();
        let body = world.add_body(&ball(DVec3::NEG_Y)).unwrap();
        let desc = JointDesc::ball([ground, body], [Frame::default(), Frame::at(Vec3::Y)]);
        let joint = world.add_joint(&desc.breaking(share * weight, f32::INFINITY)).unwrap();
        let mut broken = Vec::new();
        for _ in 0..60 {
            world.step(DT).unwrap();
            broken.extend_from_slice(world.broken_joints());
        }
        assert_eq!(broken, if holds { vec![] } else { vec![joint] });
        assert_eq!((world.contains_joint(joint), world.joint_count()), (holds, usize::from(holds)));
        let y = world.position(body).unwrap().y;
        assert!(if holds { (y + 1.0).abs() < 1e-3 } else { y < -4.0 }, "{y}");
    }
    // By torque: m g l. The load comes slowly, since what is suddenly loaded rings.
    for (share, holds) in [(1.02, true), (0.98, false)] {
        let mut world = world(0.0);
        let ground = world.add_body(&BodyDesc::fixed()).unwrap();
        let body = world.add_body(&cube(DVec3::X * 0.5)).unwrap();
        let weight = world.mass(body).unwrap() * G as f32;
        let frames = world.frames_at([ground, body], DVec3::ZERO, Quat::IDENTITY).unwrap();
        let desc = JointDesc::fixed([ground, body], frames).breaking(f32::INFINITY, share * weight * 0.5);
        let joint = world.add_joint(&desc).unwrap();
        for step in 1..=240_u8 {
            let gravity = Vec3::Y * -(G as f32 * f32::from(step.min(120)) / 120.0);
            world.set_settings(Settings { gravity, ..world.settings().clone() }).unwrap();
            world.step(DT).unwrap();
        }
        assert_eq!(world.contains_joint(joint), holds, "{share}");
    }
}

/// A chain of joints that all break at once: each is told once, in the order of nothing but the world.
#[test]
fn many_break_at_once() {
    let mut world = world(G);
    let ground = world.add_body(&BodyDesc::fixed()).unwrap();
    let mut joints = Vec::new();
    for i in 0..100 {
        let body = world.add_body(&ball(DVec3::X * f64::from(i))).unwrap();
        let frames = world.frames_at([ground, body], DVec3::X * f64::from(i), Quat::IDENTITY).unwrap();
        let strength = if i % 2 == 0 { 0.0 } else { f32::INFINITY };
        let desc = JointDesc::ball([ground, body], frames).breaking(strength, f32::INFINITY);
        joints.push(world.add_joint(&desc).unwrap());
    }
    world.step(DT).unwrap();
    let mut broken = world.broken_joints().to_vec();
    broken.sort_unstable();
    broken.dedup();
    assert_eq!((broken.len(), world.joint_count()), (50, 50));
    assert!(joints.iter().enumerate().all(|(i, &j)| world.contains_joint(j) == (i % 2 == 1)));
    world.step(DT).unwrap();
    assert!(world.broken_joints().is_empty());
}

/// A crowd on chains, doors, sliders, wheels and ropes, that falls onto a floor.
fn fair() -> World {
    let mut world = world(G);
    world.add_body(&common::Floor::Plane.desc(Material::default())).unwrap();
    let platform = common::shape(Geometry::cuboid(3.0, 0.1, 3.0), Material::default());
    let platform = world
        .add_body(
            &BodyDesc::kinematic().at(DVec3::Y * 0.5).moving(Vec3::ZERO, Vec3::Y * 0.5).with_shape(platform),
        )
        .unwrap();
    let mut random = Random(11);
    for chain in 0..42 {
        let mut last = platform;
        for link in 0..10 {
            let at = DVec3::new(
                f64::from(chain % 7) * 1.5 - 4.5,
                f64::from(link) * 0.45 + 1.0,
                f64::from(chain / 7) * 1.5 - 4.5,
            );
            let geometry = match (chain + link) % 3 {
                0 => Geometry::cuboid(0.15, 0.15, 0.15),
                1 => Geometry::Sphere { radius: 0.2 },
                _ => Geometry::capsule(0.1, 0.1),
            };
            let spin = Vec3::new(0.0, f64::from(chain).sin() as f32, 1.0);
            let body = common::dynamic(geometry, Material::default(), at.as_vec3()).moving(Vec3::ZERO, spin);
            let body = world.add_body(&body).unwrap();
            if link > 0 || chain % 6 == 0 {
                let point = at - DVec3::Y * 0.225;
                let frames = world.frames_at([last, body], point, Quat::IDENTITY).unwrap();
                let mut desc = any([last, body], &mut random);
                (desc.frames, desc.collide) = (frames, link % 4 == 0);
                if link == 5 {
                    desc = desc.breaking(2000.0, f32::INFINITY);
                }
                world.add_joint(&desc).unwrap();
            }
            last = body;
        }
    }
    world
}

fn fair_after(steps: u32, threads: usize) -> (u64, usize) {
    let mut world = fair();
    world.set_settings(Settings { threads, ..world.settings().clone() }).unwrap();
    let all = world.joint_count();
    common::steps(&mut world, steps, DT);
    assert!(world.body_count() > 400 && world.report().real > 0 && common::all_finite(&world));
    assert!(world.joint_count() < all && world.joint_count() > all / 2, "some broke, not most");
    (world.hash(), world.joint_count())
}

#[test]
fn a_second_run_gives_the_same_bits() {
    assert_eq!(fair_after(60, 1), fair_after(60, 1));
}

#[cfg(feature = "parallel")]
#[test]
fn any_number_of_threads_gives_the_same_bits() {
    let alone = fair_after(60, 1);
    for threads in [2, 3, 8] {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
        assert_eq!(pool.install(|| fair_after(60, threads)), alone, "{threads} threads");
    }
}

#[test]
fn a_kinematic_platform_drags_a_body() {
    for speed in [0.5_f64, 20.0] {
        let mut world = world(0.0);
        let platform =
            world.add_body(&BodyDesc::kinematic().moving(Vec3::X * speed as f32, Vec3::ZERO)).unwrap();
        let body = world.add_body(&cube(DVec3::Z)).unwrap();
        let frames = world.frames_at([platform, body], DVec3::Z * 0.75, Quat::IDENTITY).unwrap();
        let joint = world.add_joint(&JointDesc::fixed([platform, body], frames)).unwrap();
        common::steps(&mut world, 120, DT);
        // Nothing pushes the platform, and the body stays beside it.
        let (at, with) = (world.position(platform).unwrap(), world.position(body).unwrap());
        assert!((at - DVec3::X * speed * 2.0).length() < 1e-3 * speed, "{at}");
        assert!((with - at - DVec3::Z).length() < 1e-3, "{speed}: {}", with - at);
        let v = world.linear_velocity(body).unwrap();
        assert!((v - Vec3::X * speed as f32).length() < 1e-3 * speed as f32, "{speed}: {v}");
        assert!(world.contains_joint(joint));
    }
    // On a turntable the body goes round: v = w r.
    let mut world = world(0.0);
    let table = world.add_body(&BodyDesc::kinematic().moving(Vec3::ZERO, Vec3::Y * 2.0)).unwrap();
    let body = world.add_body(&ball(DVec3::X)).unwrap();
    let frames = world.frames_at([table, body], DVec3::ZERO, Quat::IDENTITY).unwrap();
    world.add_joint(&JointDesc::fixed([table, body], frames)).unwrap();
    let mut widest = 0.0_f64;
    for step in 0..180 {
        world.step(DT).unwrap();
        if step > 60 {
            widest = widest.max((world.position(body).unwrap().length() - 1.0).abs());
        }
    }
    assert!(widest < 1e-3, "{widest}");
    let v = world.linear_velocity(body).unwrap().length();
    assert!((v - 2.0).abs() < 0.01, "{v}");
}

/// Hangs masses from a hub by so many rods, lets it rest, and gives the rods' worst error [m] and the load of the hub's own
/// joint over all the weight.
fn hub(rods: u32, mass_of_all: f32) -> (f64, f64) {
    let mut world = world(G);
    let ground = world.add_body(&BodyDesc::fixed()).unwrap();
    let lump = |mass: f32, inertia: f32, at: DVec3| {
        let inertia = Mat3::from_diagonal(Vec3::splat(inertia));
        let mass = Some(MassProperties { mass, center: Vec3::ZERO, inertia });
        BodyDesc { mass, ..BodyDesc::dynamic().at(at) }
    };
    let hub = world.add_body(&lump(2000.0, 200.0, DVec3::ZERO)).unwrap();
    let top = world.add_joint(&JointDesc::fixed([ground, hub], [Frame::default(); 2])).unwrap();
    let mut joints = Vec::new();
    for i in 0..rods {
        let angle = f64::from(i) * std::f64::consts::TAU / f64::from(rods);
        let at = DVec3::new(3.0 * angle.cos(), 0.0, 3.0 * angle.sin());
        let mass = mass_of_all / rods as f32;
        let body = world.add_body(&lump(mass, 0.01 * mass, at - DVec3::Y)).unwrap();
        let frames = [Frame::at(at.as_vec3()), Frame::default()];
        joints.push(world.add_joint(&JointDesc::distance([hub, body], frames, 1.0, 1.0)).unwrap());
    }
    common::steps(&mut world, 240, DT);
    assert!(common::all_finite(&world));
    let worst = joints.iter().map(|&joint| {
        let [(a, _), (b, _)] = world.joint_frames(joint).unwrap();
        ((b - a).length() - 1.0).abs()
    });
    let weight = (2000.0 + f64::from(mass_of_all)) * G;
    (worst.fold(0.0, f64::max), f64::from(world.joint_force(top).unwrap().0.y) / weight)
}

/// A body with more than 31 is solved rod by rod, and bears the same.
#[test]
fn a_body_may_have_many_joints() {
    for rods in [6, 31, 32, 60, 300] {
        let (worst, load) = hub(rods, 60.0);
        println!("{rods}: {worst:.2e} {load:.5}");
        assert!(worst < 1e-4, "{rods}: {worst}");
        assert!((load - 1.0).abs() < 1e-3, "{rods}: {load}");
    }
}

/// The rods' masses have five times the hub's moment of inertia about it.
#[test]
fn a_light_body_may_have_many_joints() {
    for rods in [30, 60] {
        let (worst, load) = hub(rods, 240.0);
        println!("{rods}: {worst:.2e} {load:.5}");
        assert!(worst < 1e-2, "{rods}: {worst}");
        assert!((load - 1.0).abs() < 0.05, "{rods}: {load}");
    }
}

/// A ball on a stick: the load has 250 times the ball's own moment of inertia.
#[test]
fn a_long_lever_does_not_sag() {
    for arm in [0.2, 0.5, 1.0] {
        let mut world = world(G);
        let ground = world.add_body(&BodyDesc::fixed()).unwrap();
        let body = world.add_body(&ball(DVec3::X * arm)).unwrap();
        let frames = world.frames_at([ground, body], DVec3::ZERO, Quat::IDENTITY).unwrap();
        world.add_joint(&JointDesc::fixed([ground, body], frames)).unwrap();
        common::steps(&mut world, 240, DT);
        let y = world.position(body).unwrap().y;
        println!("{arm}: {y:.4}");
        assert!(y.abs() < 0.01 * arm, "{arm}: {y}");
    }
}

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

#[test]
fn a_joint_beyond_the_budget_is_refused_and_changes_nothing() {
    let run = |budget: usize| {
        // Limited from the start, so that a step has its place already.
        let gravity = Vec3::Y * -G as f32;
        let mut world =
            World::new(Settings { gravity, budget: Budget::total(1 << 30), ..Settings::default() }).unwrap();
        let ground = world.add_body(&BodyDesc::fixed()).unwrap();
        let bodies: Vec<BodyHandle> =
            (0..300).map(|i| world.add_body(&ball(DVec3::X * f64::from(i))).unwrap()).collect();
        world.step(DT).unwrap();
        let used = world.memory().total();
        world
            .set_settings(Settings { budget: Budget::total(used + budget), ..world.settings().clone() })
            .unwrap();
        let mut random = Random(5);
        for (i, &body) in bodies.iter().enumerate() {
            let before = (world.hash(), world.joint_count(), world.memory());
            match world.add_joint(&any([ground, body], &mut random)) {
                Ok(_) => {}
                Err(error) => {
                    assert!(matches!(error, Error::Budget { category: Category::Joints, .. }), "{error}");
                    assert_eq!((world.hash(), world.joint_count(), world.memory()), before);
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
        // What a step needs for them was counted too.
        assert!(world.memory().total() <= most, "{budget}: {} of {most}", world.memory().total());
        assert!(common::all_finite(&world));
    }
    assert_eq!(run(1 << 24).0, 300);
}

/// One joint with many rows is as dear as they are.
#[test]
fn rows_count_towards_the_budget() {
    let settings = Settings { budget: Budget::total(1 << 30), ..Settings::default() };
    let mut world = World::new(settings).unwrap();
    let (ground, body, joint) = hanging(&mut world);
    world.step(DT).unwrap();
    let budget = world.memory().total() + 100_000;
    world.set_settings(Settings { budget: Budget::total(budget), ..world.settings().clone() }).unwrap();
    let mut desc = JointDesc::new([ground, body], [Frame::default(); 2]);
    desc.drives = vec![Drive::friction(Motion::Angular, Axis::X, 1.0); 10_000];
    assert!(matches!(world.add_joint(&desc), Err(Error::Budget { category: Category::Joints, .. })));
    assert!(matches!(
        world.set_joint(joint, &desc.limits, &desc.drives),
        Err(Error::Budget { category: Category::Joints, .. })
    ));
    assert!(world.memory().total() <= budget);
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
                    world.add_body(&BodyDesc { lock_rotation, ..ball(DVec3::ZERO) }).unwrap()
                } else {
                    ground
                };
                if both {
                    world.add_joint(&JointDesc::ball([ground, first], [Frame::default(); 2])).unwrap();
                }
                let body = BodyDesc { lock_rotation, ..ball(DVec3::NEG_Y) };
                let body = world.add_body(&body).unwrap();
                let bodies = [first, body];
                let frames = world.frames_at(bodies, DVec3::NEG_Y * 0.5, Quat::IDENTITY).unwrap();
                let desc = match kind {
                    0 => JointDesc::fixed(bodies, frames),
                    1 => JointDesc::hinge(bodies, frames),
                    2 => JointDesc::ball(bodies, frames)
                        .with_limit(Limit::new(Motion::Angular, Axes::One(Axis::X), 0.0, 0.0))
                        .with_drive(Drive::motor(Motion::Angular, Axis::Y, 1.0, f32::INFINITY)),
                    _ => JointDesc::ball(bodies, frames)
                        .with_limit(Limit::lock(Motion::Angular, Axes::Around(Axis::Z))),
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

/// What is asked for at the ends of the ranges that are allowed.
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
                for axes in [Axes::One(Axis::X), Axes::Around(Axis::X), Axes::All] {
                    let mut world = world(G);
                    let (ground, body, _) = hanging(&mut world);
                    let drive = Drive {
                        position: 0.5,
                        velocity: 10.0,
                        max_force: 1e20,
                        ..Drive::spring(motion, Axis::Z, 0.5, spring)
                    };
                    let desc = JointDesc::new([ground, body], [Frame::default(), Frame::at(Vec3::Y)])
                        .with_limit(Limit::new(motion, axes, min, max).with_spring(spring));
                    let desc = if motion == Motion::Angular { desc.with_drive(drive) } else { desc };
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
        let desc = Drive::spring(Motion::Linear, Axis::X, 0.5, spring);
        let mut world = world(0.0);
        let ground = world.add_body(&BodyDesc::fixed()).unwrap();
        let body = world.add_body(&ball(DVec3::ZERO)).unwrap();
        let slider = JointDesc::slider([ground, body], [Frame::default(); 2]).with_drive(desc);
        if world.add_joint(&slider).is_err() {
            continue;
        }
        common::steps(&mut world, 60, DT);
        let x = world.position(body).unwrap().x;
        assert!((x - 0.5).abs() < 1e-3, "{spring:?}: {x}");
    }
}
