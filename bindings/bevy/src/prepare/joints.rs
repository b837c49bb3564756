//! Joints: new ones, and changes of those that are there.

use crate::components::joint::Joint;
use crate::convert::ToEngine;
use crate::messages::Problem;
use crate::world::{JOINTS, JointState, PhysicsWorld};
use backstop::{Error, JointDesc, JointHandle, World};
use bevy_ecs::prelude::{Changed, Entity, Query, ResMut};
use std::collections::HashSet;

/// Adds new joints and takes over what changed about those that are there.
pub(crate) fn sync_joints(
    mut physics: ResMut<PhysicsWorld>,
    joints: Query<&Joint>,
    changed: Query<Entity, Changed<Joint>>,
) {
    let physics = &mut *physics;
    for entity in physics.candidates(JOINTS, changed.iter()) {
        let Ok(joint) = joints.get(entity) else { continue };
        if let Some(state) = physics.joints.get(&entity) {
            if state.bodies == joint.bodies && physics.contains_joint(state.handle) {
                if let Err(error) = update_joint(physics, entity, joint) {
                    physics.refuse(entity, error);
                }
                continue;
            }
            physics.remove_joint_of(entity);
        }
        match add_joint(physics, entity, joint) {
            Ok(state) => {
                physics.waiting[JOINTS].remove(&entity);
                physics.joints.insert(entity, state);
            }
            Err(problem) => physics.wait(JOINTS, entity, problem),
        }
    }
}

/// The description of a joint with its bodies and frames.
fn describe_joint(physics: &PhysicsWorld, entity: Entity, joint: &Joint) -> Result<JointDesc, Problem> {
    let [a, b] = joint.bodies;
    let handle = |body: Entity| physics.body(body).ok_or(Problem::NoBody(body));
    let mut desc = joint.desc.clone().with_user_data(entity.to_bits());
    desc.bodies = [handle(a)?, handle(b)?];
    if let Some((point, rotation)) = joint.anchor {
        let point = physics.to_world(point).to_engine();
        desc.frames = physics.frames_at(desc.bodies, point, rotation.to_engine())?;
    }
    Ok(desc)
}

fn add_joint(physics: &mut PhysicsWorld, entity: Entity, joint: &Joint) -> Result<JointState, Problem> {
    let desc = describe_joint(physics, entity, joint)?;
    let handle = physics.add_joint(&desc)?;
    Ok(JointState { handle, bodies: joint.bodies, desc, anchor: joint.anchor })
}

/// Sets what differs from what was last set.
fn update_joint(physics: &mut PhysicsWorld, entity: Entity, joint: &Joint) -> Result<(), Problem> {
    let mut desc = describe_joint(physics, entity, joint)?;
    let Some(JointState { handle, desc: old, anchor, .. }) = physics.joints.remove(&entity) else {
        return Ok(());
    };
    if joint.anchor.is_some() && joint.anchor == anchor {
        // The bodies have moved since; the frames are where they were put.
        desc.frames = old.frames;
    }
    let set = set_joint(physics, handle, &old, &desc);
    let desc = if set.is_ok() { desc } else { old };
    physics.joints.insert(entity, JointState { handle, bodies: joint.bodies, desc, anchor: joint.anchor });
    Ok(set?)
}

fn set_joint(world: &mut World, joint: JointHandle, old: &JointDesc, new: &JointDesc) -> Result<(), Error> {
    new.validate()?;
    if new.frames != old.frames {
        world.set_joint_frames(joint, new.frames)?;
    }
    if new.limits != old.limits {
        world.set_joint_limits(joint, &new.limits)?;
    }
    let axes =
        |desc: &JointDesc| -> Vec<_> { desc.motors.iter().map(|drive| (drive.motion, drive.axis)).collect() };
    let of = axes(new);
    if of == axes(old) && of.iter().collect::<HashSet<_>>().len() == of.len() {
        // A target that changes in every step is to cost no more than that.
        for (drive, _) in new.motors.iter().zip(&old.motors).filter(|(drive, old)| drive != old) {
            world.set_joint_motor(joint, *drive)?;
        }
    } else {
        world.set_joint_motors(joint, &new.motors)?;
    }
    if new.collide != old.collide {
        world.set_joint_collide(joint, new.collide)?;
    }
    if (new.break_force, new.break_torque) != (old.break_force, old.break_torque) {
        world.set_joint_break_force(joint, new.break_force, new.break_torque)?;
    }
    if (new.force_threshold, new.torque_threshold) != (old.force_threshold, old.torque_threshold) {
        world.set_joint_thresholds(joint, new.force_threshold, new.torque_threshold)?;
    }
    if new.solved_after != old.solved_after {
        world.set_joint_solved_after(joint, new.solved_after)?;
    }
    Ok(())
}
