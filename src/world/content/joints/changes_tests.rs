//! Changes of joints leave other rows and impulses as they are.

use super::*;
use crate::body::BodyDesc;
use crate::config::Settings;
use crate::joint::{JointDesc, Spring};
use crate::shape::{Geometry, ShapeDesc};
use crate::snapshot::Snapshot;
use glam::{DVec3, Vec3};

const SPRINGS: [Spring; 2] =
    [Spring::Coefficients { stiffness: 500.0, damping: 20.0 }, Spring::Frequency { hertz: 5.0, ratio: 1.0 }];

/// Doors on hinges whose motors are solved with trees, and in rows of their own.
fn doors(world: &mut World) -> Vec<JointHandle> {
    let ground = world.add_body(&BodyDesc::fixed()).unwrap();
    let doors = SPRINGS.into_iter().cycle().take(12).enumerate().map(|(i, spring)| {
        let at = Vec3::Y * (2.0 * i as f32);
        let leaf = ShapeDesc::new(Geometry::cuboid(0.1, 0.5, 0.5));
        let door =
            world.add_body(&BodyDesc::dynamic().with_position(at.as_dvec3()).with_shape(leaf)).unwrap();
        let frames = [Frame::at(at + Vec3::Z * 0.5), Frame::at(Vec3::Z * 0.5)];
        let desc = JointDesc::hinge([ground, door], frames)
            .with_limit(Limit::new(Motion::Angular, Axes::One(Axis::X), -1.0, 1.0))
            .with_motor(Motor::position(Motion::Angular, Axis::X, 0.0, spring));
        world.add_joint(&desc).unwrap()
    });
    doors.collect()
}

/// Expected: values that change leave the arrangement of the first step, and impulses; a motor of another
/// kind, or one more, makes it anew.
#[test]
fn nothing_is_arranged_for_other_values() {
    let mut world = World::new(Settings::default()).unwrap();
    let joints = doors(&mut world);
    world.step(1.0 / 60.0).unwrap();
    let arranged = |world: &World| world.buffers.joints.arrangement;
    let first = arranged(&world);
    for step in 0..600_u16 {
        let t = f32::from(step) * 0.05;
        for (i, &joint) in joints.iter().enumerate() {
            let drive = world.joint_motors(joint).unwrap().next().unwrap();
            let before = world.joints.rows[world.joints.row_range(joint.slot)].to_vec();
            world.set_joint_target(joint, Motion::Angular, Axis::X, 0.5 * libm::sinf(t), 0.1).unwrap();
            world.set_joint_motor(joint, drive.with_max_force(50.0 + t)).unwrap();
            let ends = Limit::new(Motion::Angular, Axes::One(Axis::X), -1.0, 0.5 + 0.1 * libm::cosf(t));
            world.set_joint_limit(joint, ends).unwrap();
            let after = &world.joints.rows[world.joints.row_range(joint.slot)];
            assert!(before.iter().zip(after).all(|(a, b)| a.impulse == b.impulse), "{step} {i}");
        }
        assert!(!world.joints.changed);
        world.step(1.0 / 60.0).unwrap();
        assert_eq!(arranged(&world), first, "{step}");
    }
    assert!(world.joints.rows.iter().any(|row| row.impulse[0] != 0.0));
    // A motor of a tree that is a row of its own from now on.
    let drive = Motor::position(Motion::Angular, Axis::X, 0.0, SPRINGS[1]);
    world.set_joint_motor(joints[0], drive).unwrap();
    assert!(world.joints.changed);
    world.step(1.0 / 60.0).unwrap();
    assert_ne!(arranged(&world), first);
    let held: Vec<Vec3> = world.joints.locks.iter().map(|lock| lock.impulse).collect();
    world.set_joint_motor(joints[3], Motor::friction(Motion::Angular, Axis::Y, 1.0)).unwrap();
    assert!(world.joints.changed);
    // Locks keep their loads, of any joint and at any place.
    let sorted = |mut all: Vec<Vec3>| {
        all.sort_unstable_by_key(|v| v.to_array().map(f32::to_bits));
        all
    };
    assert_eq!(sorted(world.joints.locks.iter().map(|lock| lock.impulse).collect()), sorted(held));
}

/// A world goes back to the targets that it had, though snapshots share the list of its joints, and goes on
/// to the same bits; from bytes too.
#[test]
fn snapshots_keep_targets_and_share_the_list() {
    let mut world = World::new(Settings::default()).unwrap();
    let joints = doors(&mut world);
    let turn = |world: &mut World, steps: std::ops::Range<u16>| {
        for step in steps {
            let t = f32::from(step) * 0.05;
            for &joint in &joints {
                world.set_joint_target(joint, Motion::Angular, Axis::X, libm::sinf(t), 0.1).unwrap();
                let ends = Limit::new(Motion::Angular, Axes::One(Axis::X), -1.0, 0.5 + 0.1 * libm::cosf(t));
                world.set_joint_limit(joint, ends).unwrap();
            }
            world.step(1.0 / 60.0).unwrap();
        }
        world.state_hash()
    };
    turn(&mut world, 0..100);
    let (mut old, mut new) = (Snapshot::new(), Snapshot::new());
    world.snapshot(&mut old);
    let revision = world.revisions.moving;
    turn(&mut world, 100..200);
    world.snapshot(&mut new);
    assert_eq!(world.revisions.moving, revision, "the list is not written again");
    // Without further changes, so that only the content of the snapshots counts.
    let go = |world: &mut World, snapshot: &Snapshot| {
        world.restore(snapshot).unwrap();
        for _ in 0..60 {
            world.step(1.0 / 60.0).unwrap();
        }
        world.state_hash()
    };
    let ends = [go(&mut world, &old), go(&mut world, &new)];
    assert_ne!(ends[0], ends[1]);
    assert_eq!([go(&mut world, &old), go(&mut world, &new)], ends);
    let mut other = World::new(Settings::default()).unwrap();
    doors(&mut other);
    for (snapshot, end) in [old, new].iter().zip(ends) {
        let bytes = snapshot.to_bytes();
        let again = Snapshot::from_bytes(&bytes).unwrap();
        assert_eq!(go(&mut other, &again), end);
    }
    assert!(world.position(world.joint_bodies(joints[0]).unwrap()[1]).unwrap().distance(DVec3::ZERO) < 2.0);
}
