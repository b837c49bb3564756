//! Loads that joints bear, report and break at.

use super::*;

/// Impulses of the last step start the next in proportion to its length.
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
    let anchor = ball(DVec3::ZERO).with_lock_translation([true; 3]).with_lock_rotation([true; 3]);
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

/// Statics: a hanging mass pulls with m g; its joint holds it with as much, on whichever side of the joint it
/// is.
#[test]
fn force_of_a_hanging_mass() {
    for flip in [false, true] {
        for (substeps, iterations) in [(1, 8), (4, 1)] {
            let gravity = Vec3::Y * -G as f32;
            let mut world = World::new(
                Settings::default().with_gravity(gravity).with_substeps(substeps).with_iterations(iterations),
            )
            .unwrap();
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
    let beam = world.add_body(&BodyDesc::dynamic().with_position(DVec3::X * 0.5).with_shape(beam)).unwrap();
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
        let joint = world.add_joint(&desc.with_break_force(share * weight, f32::INFINITY)).unwrap();
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
    // By torque: m g l. The load comes slowly, since a sudden one rings.
    for (share, holds) in [(1.02, true), (0.98, false)] {
        let mut world = world(0.0);
        let ground = world.add_body(&BodyDesc::fixed()).unwrap();
        let body = world.add_body(&cube(DVec3::X * 0.5)).unwrap();
        let weight = world.mass(body).unwrap() * G as f32;
        let frames = world.frames_at([ground, body], DVec3::ZERO, Quat::IDENTITY).unwrap();
        let desc =
            JointDesc::fixed([ground, body], frames).with_break_force(f32::INFINITY, share * weight * 0.5);
        let joint = world.add_joint(&desc).unwrap();
        for step in 1..=240_u8 {
            let gravity = Vec3::Y * -(G as f32 * f32::from(step.min(120)) / 120.0);
            world.set_settings(world.settings().clone().with_gravity(gravity)).unwrap();
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
        let desc = JointDesc::ball([ground, body], frames).with_break_force(strength, f32::INFINITY);
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
