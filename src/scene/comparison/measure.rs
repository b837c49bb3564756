//! Measures of a world: ghosts of a step, openings of joints, and the motion of groups of bodies.

use super::{Entrant, Scene};
use crate::config::tuning::CONTACT_MARGIN;
use crate::config::tuning::GHOST_GAP;
use crate::narrow_phase::{
    BodyPath, CastResult, MeshCast, Motion, NO_CONTACT, cast_convex, cast_mesh, cast_plane,
};
use crate::shape::Kind;
use crate::time_of_impact::Way;
use crate::world::World;
use glam::{DQuat, DVec3, Vec3};

/// Number of ghosts in the last step: pairs that were pushed apart before they touched, and did not come near
/// each other on any combination of their free paths and the paths that they took.
pub(super) fn ghosts(world: &World) -> u32 {
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
    let near = GHOST_GAP * CONTACT_MARGIN * world.settings.length_unit;
    match b.kind {
        Kind::Plane => cast_plane(a, b, &motion, near).is_some(),
        Kind::Mesh | Kind::HeightField => {
            let cast = MeshCast { any: true, ..MeshCast::first(near, 0.0) };
            let close = MeshCast { alone: near, ..cast };
            let rel = motion.relative(0.0);
            matches!(cast_mesh(a, b, &rel, &motion, cast, None), CastResult::First(_))
                || matches!(cast_mesh(a, b, &rel, &motion, close, None), CastResult::Near)
        }
        _ => cast_convex(a, b, &motion, near).is_some(),
    }
}

/// The greatest distance between the two anchors of a joint [m].
pub(super) fn opening(scene_joints: &[([usize; 2], [Vec3; 2])], entrant: &Entrant) -> f64 {
    let world = &entrant.world;
    let end = |body: usize, at: Vec3| {
        let body = entrant.bodies[body];
        let pose = world.position(body).ok().zip(world.rotation(body).ok());
        pose.map_or(DVec3::NAN, |(position, rotation)| position + (rotation * at).as_dvec3())
    };
    let gap =
        |(bodies, at): &([usize; 2], [Vec3; 2])| (end(bodies[0], at[0]) - end(bodies[1], at[1])).length();
    scene_joints.iter().map(gap).fold(0.0, f64::max)
}

/// Where the joints of a scene are on their bodies.
pub(super) fn joints_of(scene: &Scene) -> Vec<([usize; 2], [Vec3; 2])> {
    scene.joints.iter().map(|joint| (joint.bodies, joint.frames.map(|frame| frame.position))).collect()
}

/// How a group of bodies moves as a whole.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Moving {
    pub(super) mass: f64,
    /// Momentum [kg m/s].
    pub(super) momentum: DVec3,
    /// Angular momentum about the centre of mass [kg m²/s].
    pub(super) spin: DVec3,
    /// Kinetic energy, and its sum with the potential energy [J].
    pub(super) kinetic: f64,
    pub(super) energy: f64,
}

/// Motion of the bodies with these indices in the scene.
pub(super) fn moving(entrant: &Entrant, group: &[usize]) -> Moving {
    let world = &entrant.world;
    let mut all = Moving::default();
    let mut centre = DVec3::ZERO;
    let indices = || group.iter().filter_map(|&body| world.index(entrant.bodies[body]).ok());
    for i in indices() {
        let m = f64::from(world.bodies.details[i].mass);
        all.mass += m;
        centre += world.bodies.pose[i].position * m;
        all.momentum += world.bodies.velocity[i].linear.as_dvec3() * m;
    }
    centre /= all.mass;
    for i in indices() {
        let (pose, v) = (&world.bodies.pose[i], &world.bodies.velocity[i]);
        let m = f64::from(world.bodies.details[i].mass);
        let turn: DQuat = pose.rotation.as_dquat().normalize();
        let local = turn.conjugate() * v.angular.as_dvec3();
        let own = world.bodies.mass[i].inertia.as_dvec3() * local;
        all.spin += turn * own + (pose.position - centre).cross(v.linear.as_dvec3() * m);
        let kinetic = 0.5 * m * v.linear.as_dvec3().length_squared() + 0.5 * local.dot(own);
        all.kinetic += kinetic;
        all.energy += kinetic - m * world.settings.gravity.as_dvec3().dot(pose.position);
    }
    all
}

/// Mean distance of a group's bodies between two worlds, for the furthest point of each [m].
pub(super) fn apart(one: &Entrant, other: &Entrant, group: &[usize]) -> f64 {
    let of = |body: usize| {
        let (i, k) = (one.world.index(one.bodies[body]).ok()?, other.world.index(other.bodies[body]).ok()?);
        let (p, q) = (&one.world.bodies.pose[i], &other.world.bodies.pose[k]);
        let hot = |&c: &u32| &one.world.colliders.summaries[c as usize];
        let own = one.world.bodies.colliders[i].as_slice().iter().map(hot);
        // The rotation of a ball does not matter.
        let reach = own.fold(0.0_f32, |r, hot| {
            r.max(hot.lever + if hot.kind == Kind::Sphere { 0.0 } else { hot.radius })
        });
        let turn = q.rotation * p.rotation.conjugate();
        let swing = 2.0 * turn.xyz().length().min(1.0) * reach;
        Some((q.position - p.position).length() + f64::from(swing))
    };
    group.iter().filter_map(|&body| of(body)).sum::<f64>() / group.len() as f64
}
