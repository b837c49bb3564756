//! Ground truth of a scene: which bodies have got through.

use super::scenes::{DT, RAGDOLL_WALL, blade_times};
use super::{Entrant, Scene, builtin};
use crate::math::Quat;
use crate::narrow_phase::segment_hits;
use crate::narrow_phase::{Relative, Support, distance};
use crate::scene::{SceneBody, Terrain};
use crate::shape::Geometry;
use crate::world::World;
use glam::{DVec3, Vec3};

/// The criterion by which a body got through.
#[derive(Debug)]
pub(super) enum Truth {
    /// Its centre is below the ground.
    Above(Terrain),
    /// Its centre is behind a wall: by body.
    Before(Vec<Wall>),
    /// It spins undisturbed although its post stood in its way; by step, counted from 1.
    Blades(Vec<u32>),
    /// Its centre went into or through the shape of another body in a step in which neither was pushed, so
    /// that both paths were straight; or it ends within another's shape.
    Way,
}

/// A wall that no body may get behind.
#[derive(Clone, Copy, Debug)]
pub(super) struct Wall {
    middle: DVec3,
    /// Unit vector from its front to its back.
    behind: DVec3,
    /// A body further from its middle than this went around it [m].
    half: f64,
}

/// A blade that lost less of its spin was not stopped.
const UNTOUCHED: f32 = 0.005;

impl Truth {
    pub(super) fn of(scene: &Scene) -> Truth {
        match scene.name.as_str() {
            "talk" => Truth::Above(builtin::talk_terrain()),
            "ragdoll_wall" => {
                let middle = DVec3::X * f64::from(RAGDOLL_WALL);
                let wall = Wall { middle, behind: DVec3::X, half: 19.0 };
                Truth::Before(vec![wall; scene.dynamic_bodies()])
            }
            "deflector" => Truth::Before(deflector_walls(scene)),
            "blades" => Truth::Blades(blade_times().map(|time| (time / DT) as u32 + 1).to_vec()),
            _ => Truth::Way,
        }
    }

    /// Adds the bodies that have got through by the end of a step to `through`, by their indices among
    /// dynamic bodies. `spins`: the spin of each at the start of the scene.
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
                Truth::Before(walls) => {
                    let Wall { middle, behind, half } = walls[k];
                    let off = at - middle;
                    off.dot(behind) > 0.0 && (off - behind * off.dot(behind)).abs().max_element() < half
                }
                Truth::Blades(steps) => {
                    let now = world.bodies.velocity[i].angular;
                    steps[k] == step && (now - spins[k]).length() < UNTOUCHED * spins[k].length()
                }
                Truth::Way => is_inside(world, i) || is_free(world, i) && goes_through(world, i),
            };
        }
    }
}

/// The wall of each ball, which it is not to get behind: bodies come as deflector, wall, ball.
fn deflector_walls(scene: &Scene) -> Vec<Wall> {
    let one = |three: &[SceneBody]| {
        let wall = &three[1].desc;
        let thin = match wall.shapes[0].geometry {
            Geometry::Box { half_extents } if half_extents.x < half_extents.y => DVec3::X,
            _ => DVec3::Y,
        };
        // They are 3.5 m to each side.
        Wall { middle: wall.position, behind: thin, half: 3.4 }
    };
    scene.bodies.chunks_exact(3).map(one).collect()
}

/// Whether nothing but gravity changed a body's velocity in the last step.
fn is_free(world: &World, i: usize) -> bool {
    let forces = &world.buffers.forces;
    let Some(start) = forces.start.get(i) else { return true };
    let meant = start.linear + forces.acceleration.get(i).map_or(Vec3::ZERO, |pull| pull.linear) * DT;
    (world.bodies.velocity[i].linear - meant).length() <= 1e-4 * (1.0 + meant.length())
}

/// Whether a body's centre is within another's shape.
fn is_inside(world: &World, i: usize) -> bool {
    let at = world.bodies.pose[i].position;
    let point = Support::triangle([Vec3::ZERO; 3]);
    world.colliders.all.iter().filter(|shape| shape.body as usize != i).any(|shape| {
        let body = &world.bodies.pose[shape.body as usize];
        let origin = body.position + (body.rotation * shape.position).as_dvec3();
        let back = (body.rotation * shape.rotation).conjugate();
        let off = back * (at - origin).as_vec3();
        let rel = Relative { position: off, rotation: Quat::IDENTITY };
        off.length() <= shape.radius
            && Support::of(shape).is_some_and(|shape| {
                let found = distance(&shape, &point, &rel, Vec3::ZERO);
                found.overlap || found.distance < 0.0
            })
    })
}

/// Whether the straight way of a body's centre in the last step enters another's shape, which went straight
/// too.
fn goes_through(world: &World, i: usize) -> bool {
    let colliders = &world.colliders;
    let Some(&own) = world.bodies.colliders[i].as_slice().first() else { return false };
    let (from, to) = (centre_before(world, own), world.bodies.pose[i].position);
    let enters = |c: u32| {
        let (shape, old) = (&colliders.all[c as usize], &colliders.poses[c as usize]);
        let body = shape.body as usize;
        let pose = &world.bodies.pose[body];
        let back = old.rotation.conjugate();
        let start = back * (from - old.position).as_vec3();
        let new = pose.position + (pose.rotation * shape.position).as_dvec3();
        let end = back * (to - new).as_vec3();
        // However the other body rotated on its way, its inscribed ball was there.
        let size = if body < world.bodies.movers() { shape.inner_radius } else { shape.radius };
        body != i
            && nearest(start, end) <= size
            && (body < world.bodies.movers() || segment_hits(shape, start, end).is_some())
            && is_free(world, body)
    };
    (0..colliders.all.len() as u32).any(enters)
}

/// How near a way comes to the origin.
fn nearest(start: Vec3, end: Vec3) -> f32 {
    let way = end - start;
    let along = (-start.dot(way) / way.length_squared().max(f32::MIN_POSITIVE)).clamp(0.0, 1.0);
    (start + way * along).length()
}

/// Centre of mass of a collider's body at the start of the last step.
fn centre_before(world: &World, collider: u32) -> DVec3 {
    let (c, pose) = (&world.colliders.all[collider as usize], &world.colliders.poses[collider as usize]);
    pose.position - (pose.rotation * c.rotation.conjugate() * c.position).as_dvec3()
}
