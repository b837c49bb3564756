//! Ragdolls that are driven to poses.

#![allow(clippy::disallowed_methods, reason = "expected values may use the platform's functions")]

use crate::common;

use backstop::glam::{DVec3, Quat, Vec3};
use backstop::{BodyHandle, BoneJoint, Error, Ragdoll, Settings, Skeleton, Spring, World};

const DT: f32 = 1.0 / 60.0;
const SERVO: Spring = Spring::Frequency { hertz: 8.0, ratio: 1.0 };

/// Each bone's rotation from where it is in the skeleton, in its axes: bent by that share of its limits.
fn pose(figure: &Skeleton, share: f32) -> Vec<Quat> {
    let mut pose: Vec<Quat> = Vec::new();
    for (i, bone) in figure.bones.iter().enumerate() {
        let own = match bone.joint {
            BoneJoint::Ball { swing, twist } => {
                let along = (bone.to - bone.from).normalize();
                let across = along.any_orthonormal_vector();
                let swung = Quat::from_axis_angle(across, 0.5 * share * swing);
                swung * Quat::from_axis_angle(along, 0.5 * share * twist)
            }
            BoneJoint::Hinge { axis, max, .. } => {
                Quat::from_axis_angle(axis.normalize(), 0.5 * share.abs() * max)
            }
            _ => Quat::IDENTITY,
        };
        assert!(bone.parent.is_none_or(|parent| parent < i));
        pose.push(bone.parent.map_or(Quat::IDENTITY, |parent| pose[parent]) * own);
    }
    pose
}

/// How far each bone is turned from where it would be on its parent in a pose [rad].
fn errors(world: &World, figure: &Skeleton, doll: &Ragdoll, rest: &[Quat], pose: &[Quat]) -> Vec<f32> {
    let turned = |bone: usize| world.rotation(doll.bodies[bone]).unwrap() * rest[bone].inverse();
    let own = |bone: usize, parent: usize| turned(parent).inverse() * turned(bone);
    let joined = figure.bones.iter().enumerate().filter_map(|(i, bone)| Some((i, bone.parent?)));
    joined.map(|(i, p)| own(i, p).angle_between(pose[p].inverse() * pose[i])).collect()
}

/// Expected: at rest each bone is turned on its parent as the pose says, to the hundredth of a radian, the
/// other joints too; and while the pose changes, as far off as a critically damped spring without the
/// target's velocity lags: 2 / (2 pi 8 Hz) = 0.04 s of it, and what the limbs pull at each other.
#[test]
fn a_figure_takes_the_pose_and_follows_it() {
    let figure = Skeleton::humanoid().with_friction(0.5);
    let mut world = World::new(Settings::default().with_gravity(Vec3::ZERO)).unwrap();
    let turn = common::turned(Vec3::new(1.0, 2.0, 3.0).normalize(), 80.0);
    let doll = figure.add_to(&mut world, DVec3::new(3.0, 2.0, 1.0), turn, Vec3::ZERO).unwrap();
    // In the skeleton's axes.
    let rest = |body: &BodyHandle| turn.inverse() * world.rotation(*body).unwrap();
    let rest: Vec<Quat> = doll.bodies.iter().map(rest).collect();
    let worst = |world: &World, pose: &[Quat]| {
        errors(world, &figure, &doll, &rest, pose).into_iter().fold(0.0, f32::max)
    };
    for share in [1.0, -0.8, 0.0] {
        let pose = pose(&figure, share);
        doll.drive_to(&mut world, &pose, SERVO, 1e4).unwrap();
        common::steps(&mut world, 300, DT);
        let off = worst(&world, &pose);
        println!("share {share}: {off} rad off");
        assert!(off < 0.01, "{share}: {off}");
    }
    let mut off = 0.0_f32;
    for step in 0..1200_u16 {
        // At 1 rad/s of its share, that is up to 1.2 rad/s of a knee.
        let target = pose(&figure, (f32::from(step) * DT).sin());
        doll.drive_to(&mut world, &target, SERVO, 1e4).unwrap();
        world.step(DT).unwrap();
        off = off.max(worst(&world, &target));
    }
    println!("moving: {off} rad off");
    assert!(off < 0.15, "{off}");
    // Limp again, with the friction that its skeleton has.
    doll.relax(&mut world).unwrap();
    for &joint in &doll.joints {
        assert!(world.joint_motors(joint).unwrap().all(|drive| drive.max_force == 0.5));
    }
    assert!(world.set_joint_user_data(doll.joints[0], 1).is_ok());
}

/// A refused pose changes nothing, and a joint that broke is left out.
#[test]
fn poses_are_refused_whole() {
    let figure = Skeleton::humanoid();
    let mut world = World::new(Settings::default()).unwrap();
    let doll = figure.add_to(&mut world, DVec3::Y, Quat::IDENTITY, Vec3::ZERO).unwrap();
    let good = pose(&figure, 0.5);
    let mut bad = good.clone();
    bad[10] = Quat::from_xyzw(0.0, 0.0, 0.0, 0.0);
    assert!(matches!(doll.drive_to(&mut world, &good[1..], SERVO, 1.0), Err(Error::Incomplete { .. })));
    assert!(doll.drive_to(&mut world, &bad, SERVO, 1.0).is_err());
    assert!(doll.drive_to(&mut world, &good, SERVO, -1.0).is_err());
    let none = |world: &World| doll.joints.iter().all(|&j| world.joint_motors(j).unwrap().count() == 0);
    assert!(none(&world));
    // A joint that broke is left out.
    world.remove_joint(doll.joints[4]).unwrap();
    doll.drive_to(&mut world, &good, SERVO, 100.0).unwrap();
    doll.relax(&mut world).unwrap();
    assert!(doll.joints.iter().filter(|&&j| world.contains_joint(j)).count() == 9);
    // A memory budget that has no place for the motors.
    let budget = backstop::Budget::total(world.memory().total() + 100);
    world.set_settings(world.settings().clone().with_budget(budget)).unwrap();
    assert!(matches!(doll.drive_to(&mut world, &good, SERVO, 100.0), Err(Error::Budget { .. })));
    let left = doll.joints.iter().filter(|&&j| world.contains_joint(j));
    assert!(left.into_iter().all(|&j| world.joint_motors(j).unwrap().count() == 0));
}
