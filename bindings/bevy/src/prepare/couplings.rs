//! Couplings: new ones, and changes of those that are there.

use crate::components::coupling::Coupling;
use crate::messages::Problem;
use crate::world::{COUPLINGS, CouplingState, PhysicsWorld, in_order};
use backstop::{CouplingDesc, CouplingHandle, Error, World};
use bevy_ecs::prelude::{Changed, Entity, Query, ResMut};

/// Adds new couplings, takes over what changed about others, and has those wait whose joints are gone.
pub(crate) fn sync_couplings(
    mut physics: ResMut<PhysicsWorld>,
    couplings: Query<&Coupling>,
    changed: Query<Entity, Changed<Coupling>>,
) {
    let physics = &mut *physics;
    let moved = |(entity, state): (&Entity, &CouplingState)| {
        let joints = state.joints.map(|joint| physics.joint(joint));
        (joints != state.desc.motions.map(|motion| Some(motion.joint))).then_some(*entity)
    };
    let moved = in_order(physics.couplings.iter().filter_map(moved));
    for &entity in &moved {
        physics.remove_coupling_of(entity);
    }
    for entity in physics.candidates(COUPLINGS, moved.into_iter().chain(&changed)) {
        let Ok(coupling) = couplings.get(entity) else { continue };
        match sync(physics, entity, coupling) {
            Ok(state) => {
                physics.waiting[COUPLINGS].remove(&entity);
                physics.couplings.insert(entity, state);
            }
            // What is there stays as it was.
            Err(problem) if physics.couplings.contains_key(&entity) => physics.refuse(entity, problem),
            Err(problem) => physics.wait(COUPLINGS, entity, problem),
        }
    }
}

/// The coupling of a component: the one that is there with what changed, or a new one.
fn sync(physics: &mut PhysicsWorld, entity: Entity, coupling: &Coupling) -> Result<CouplingState, Problem> {
    let mut desc = coupling.desc.with_user_data(entity.to_bits());
    for (motion, joint) in desc.motions.iter_mut().zip(coupling.joints) {
        motion.joint = physics.joint(joint).ok_or(Problem::NoJoint(joint))?;
    }
    let handle = match physics.couplings.get(&entity) {
        Some(state) if physics.contains_coupling(state.handle) && alike(&state.desc, &desc) => {
            let (handle, old) = (state.handle, state.desc);
            set_coupling(physics, handle, &old, &desc)?;
            handle
        }
        _ => {
            let handle = physics.add_coupling(&desc)?;
            physics.remove_coupling_of(entity);
            handle
        }
    };
    Ok(CouplingState { handle, joints: coupling.joints, desc })
}

/// Whether two descriptions couple the same motions.
fn alike(old: &CouplingDesc, new: &CouplingDesc) -> bool {
    let motions = |desc: &CouplingDesc| desc.motions.map(|motion| (motion.joint, motion.motion, motion.axes));
    motions(old) == motions(new)
}

/// Sets what differs from what was last set.
fn set_coupling(
    world: &mut World,
    coupling: CouplingHandle,
    old: &CouplingDesc,
    new: &CouplingDesc,
) -> Result<(), Error> {
    new.validate()?;
    if old.motions != new.motions {
        world.set_coupling_factors(coupling, new.motions.map(|motion| motion.factor))?;
    }
    if old.range != new.range {
        world.set_coupling_range(coupling, new.range)?;
    }
    if old.break_force != new.break_force {
        world.set_coupling_break_force(coupling, new.break_force)?;
    }
    Ok(())
}
