//! Where bodies went in the last step, and whether they got through something, to judge methods of continuous
//! collision.

use crate::config::tuning::GHOST_GAP;
use crate::error::Error;
use crate::handle::BodyHandle;
use crate::math::Quat;
use crate::narrow_phase::{
    BodyPath, CastResult, MeshCast, Motion, NO_CONTACT, Relative, Support, cast_convex, cast_mesh, distance,
    segment_hits,
};
use crate::shape::Kind;
use crate::time_of_impact::Way;
use crate::world::World;
use glam::{DVec3, Vec3};

/// Number of ghosts in the last step: pairs that were pushed apart before they touched, and did not come near
/// each other on any combination of their free paths and the paths that they took.
pub fn ghosts(world: &World) -> u32 {
    let pushed = world.broad.pairs.iter().filter(|pair| world.contacts.count_pushed(pair.contact) > 0);
    let apart = pushed.filter(|pair| {
        debug_assert!(pair.contact != NO_CONTACT);
        let (a, b) = (ways(world, pair.a), ways(world, pair.b));
        !a.iter().any(|a| b.iter().any(|b| meet(world, (pair.a, a), (pair.b, b))))
    });
    apart.count() as u32
}

/// The free path of a collider's body in the last step, and the path that it took.
fn ways(world: &World, collider: u32) -> [BodyPath; 2] {
    let shape = &world.colliders.all[collider as usize];
    let body = shape.body as usize;
    let end = &world.bodies.pose[body];
    if body >= world.bodies.movers() {
        return [Way::still(end).rest(0.0); 2];
    }
    let placed = &world.colliders.poses[collider as usize];
    let taken = Way::taken(shape, placed, end, world.buffers.solver.delta[body].angular).rest(0.0);
    let meant = &world.buffers.forces.motion[body];
    [BodyPath { displacement: meant.linear, spin: meant.angular, ..taken }, taken]
}

/// Whether two colliders come within 5 mm of each other.
fn meet(world: &World, (a, path_a): (u32, &BodyPath), (b, path_b): (u32, &BodyPath)) -> bool {
    let [a, b] = [a, b].map(|c| &world.colliders.all[c as usize]);
    let motion = Motion::new(a, path_a, b, path_b);
    let near = GHOST_GAP * world.settings.measures().margin;
    match b.kind {
        kind if kind.is_ground() => {
            let cast = MeshCast { any: true, ..MeshCast::first(near, 0.0) };
            let close = MeshCast { alone: near, ..cast };
            let rel = motion.relative(0.0);
            matches!(cast_mesh(a, b, &rel, &motion, cast, None), CastResult::First(_))
                || matches!(cast_mesh(a, b, &rel, &motion, close, None), CastResult::Near)
        }
        _ => cast_convex(a, b, &motion, near).is_some(),
    }
}

/// Whether a body's centre is within another's shape, or went into or through one in a last step of `dt`
/// seconds in which nothing pushed either, so that both paths were straight.
///
/// # Errors
/// If the handle is stale.
pub fn got_through(world: &World, body: BodyHandle, dt: f32) -> Result<bool, Error> {
    let i = world.index(body)?;
    Ok(is_inside(world, i) || is_free(world, i, dt) && goes_through(world, i, dt))
}

/// The distance of a body's furthest point from its centre of mass [m]; of a ball, of its centre, since its
/// rotation does not matter.
///
/// # Errors
/// If the handle is stale.
pub fn reach(world: &World, body: BodyHandle) -> Result<f32, Error> {
    let own = world.bodies.colliders[world.index(body)?].as_slice();
    let own = own.iter().map(|&c| &world.colliders.summaries[c as usize]);
    Ok(own.fold(0.0_f32, |r, hot| r.max(hot.lever + if hot.kind == Kind::Sphere { 0.0 } else { hot.radius })))
}

/// Whether nothing but gravity changed a body's velocity in the last step.
fn is_free(world: &World, i: usize, dt: f32) -> bool {
    let forces = &world.buffers.forces;
    let Some(start) = forces.start.get(i) else { return true };
    let meant = start.linear + forces.acceleration.get(i).map_or(Vec3::ZERO, |pull| pull.linear) * dt;
    (world.bodies.velocity[i].linear - meant).length() <= 1e-4 * (1.0 + meant.length())
}

/// Whether a body's centre is within another's shape.
fn is_inside(world: &World, i: usize) -> bool {
    let at = world.bodies.pose[i].position;
    let point = Support::triangle([Vec3::ZERO; 3]);
    world.colliders.all.iter().filter(|shape| shape.body as usize != i).any(|shape| {
        let here = world.bodies.pose[shape.body as usize].of_part(shape.position, shape.rotation);
        let off = here.rotation.conjugate() * (at - here.position).as_vec3();
        let rel = Relative { position: off, rotation: Quat::IDENTITY };
        off.length() <= shape.radius
            && shape.geometry.support().is_some_and(|shape| {
                let found = distance(&shape, &point, &rel, Vec3::ZERO);
                found.overlap || found.distance < 0.0
            })
    })
}

/// Whether the straight way of a body's centre in the last step enters another's shape, which went straight
/// too.
fn goes_through(world: &World, i: usize, dt: f32) -> bool {
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
            && is_free(world, body, dt)
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
