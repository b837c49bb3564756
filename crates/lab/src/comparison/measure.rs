//! Measures of a world: openings of joints, and the motion of groups of bodies.

use super::entrant::Entrant;
use backstop::observe::BodyState;
use backstop::observe::paths::reach;
use backstop_scene::Scene;
use glam::{DVec3, Vec3};

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
    let states = || group.iter().filter_map(|&body| state(entrant, body));
    let mut all = Moving::default();
    let mut centre = DVec3::ZERO;
    for body in states() {
        all.mass += body.mass;
        centre += body.centre * body.mass;
        all.momentum += body.linear * body.mass;
    }
    centre /= all.mass;
    let gravity = entrant.world.settings().gravity.as_dvec3();
    for body in states() {
        all.spin += body.spin() + (body.centre - centre).cross(body.linear * body.mass);
        let kinetic = body.kinetic_energy();
        all.kinetic += kinetic;
        all.energy += kinetic - body.mass * gravity.dot(body.centre);
    }
    all
}

fn state(entrant: &Entrant, body: usize) -> Option<BodyState> {
    BodyState::of(&entrant.world, entrant.bodies[body]).ok()
}

/// Mean distance of a group's bodies between two worlds, for the furthest point of each [m].
pub(super) fn apart(one: &Entrant, other: &Entrant, group: &[usize]) -> f64 {
    let of = |body: usize| {
        let (p, q) = (state(one, body)?, state(other, body)?);
        let reach = reach(&one.world, one.bodies[body]).ok()?;
        let turn = q.axes * p.axes.conjugate();
        let swing = 2.0 * turn.xyz().length().min(1.0) * f64::from(reach);
        Some((q.centre - p.centre).length() + swing)
    };
    group.iter().filter_map(|&body| of(body)).sum::<f64>() / group.len() as f64
}
