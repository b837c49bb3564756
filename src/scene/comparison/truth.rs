//! What is known of a scene without running it: who has got through.

use super::scenes::{DT, RAGDOLL_WALL, blade_times};
use super::{Entrant, builtin};
use crate::query::segment_hits;
use crate::scene::Terrain;
use crate::shape::Collider;
use crate::world::World;
use glam::{DVec3, Vec3};

/// By what it is known that a body got through.
#[derive(Debug)]
pub(super) enum Truth {
    /// Its centre is below the ground.
    Above(Terrain),
    /// Its centre is behind the wall.
    Before(f64),
    /// It spins as if nothing had been there although its post stood in its way: by step, counted from 1.
    Blades(Vec<u32>),
    /// In a step its centre went into or through another's shape, as that moved.
    Way,
}

/// A blade that lost less of its spin was not stopped.
const UNTOUCHED: f32 = 0.005;

impl Truth {
    pub(super) fn of(name: &str) -> Truth {
        match name {
            "talk" => Truth::Above(builtin::talk_terrain()),
            "ragdoll_wall" => Truth::Before(f64::from(RAGDOLL_WALL)),
            "blades" => Truth::Blades(blade_times().map(|time| (time / DT) as u32 + 1).to_vec()),
            _ => Truth::Way,
        }
    }

    /// Adds the bodies that have got through by the end of a step to `through`, by their indices among those that are
    /// dynamic. `spins`: of each at the start of the scene.
    pub(super) fn look(
        &self,
        step: u32,
        entrant: &Entrant,
        dynamic: &[usize],
        spins: &[Vec3],
        through: &mut [bool],
    ) {
        let world = &entrant.world;
        for (k, &body) in dynamic.iter().enumerate() {
            let Ok(i) = world.index(entrant.bodies[body]) else { continue };
            let at = world.bodies.pose[i].position;
            through[k] |= match self {
                Truth::Above(ground) => {
                    let Vec3 { x, y, z } = at.as_vec3();
                    ground.contains(x, z) && y < ground.height(x, z)
                }
                Truth::Before(wall) => at.x > *wall,
                Truth::Blades(steps) => {
                    let now = world.bodies.velocity[i].angular;
                    steps[k] == step && (now - spins[k]).length() < UNTOUCHED * spins[k].length()
                }
                Truth::Way => goes_through(world, i),
            };
        }
    }
}

/// Whether the straight way of a body's centre in the last step enters another's shape.
fn goes_through(world: &World, i: usize) -> bool {
    let colliders = &world.colliders;
    let Some(&own) = world.bodies.colliders[i].as_slice().first() else { return false };
    let (from, to) = (centre_before(world, own), world.bodies.pose[i].position);
    let enters = |c: u32| {
        let (shape, old) = (&colliders.all[c as usize], &colliders.poses[c as usize]);
        let end = &world.bodies.pose[shape.body as usize];
        let new = (end.position + (end.rotation * shape.position).as_dvec3(), end.rotation * shape.rotation);
        let start = old.rotation.conjugate() * (from - old.position).as_vec3();
        let end = new.1.conjugate() * (to - new.0).as_vec3();
        (shape.body as usize != i) && passes(shape, start, end)
    };
    (0..colliders.all.len() as u32).any(enters)
}

fn passes(shape: &Collider, start: Vec3, end: Vec3) -> bool {
    let way = end - start;
    let along = (-start.dot(way) / way.length_squared().max(f32::MIN_POSITIVE)).clamp(0.0, 1.0);
    (start + way * along).length() <= shape.radius && segment_hits(shape, start, end).is_some()
}

/// Centre of mass of a collider's body at the start of the last step.
fn centre_before(world: &World, collider: u32) -> DVec3 {
    let (c, pose) = (&world.colliders.all[collider as usize], &world.colliders.poses[collider as usize]);
    pose.position - (pose.rotation * c.rotation.conjugate() * c.position).as_dvec3()
}
