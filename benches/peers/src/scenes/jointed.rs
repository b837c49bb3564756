//! Bodies with joints.

use super::{Error, Subject, add_mesh, below, beyond_pen, pen};
use crate::engines::Continuous;
use crate::engines::content::{Turning, turning};
use backstop::glam::{DVec3, Quat, Vec3};
use backstop::math::Quat as Rotation;
use backstop::{Axes, Axis, Frame, Geometry, JointDesc, Limit, Motion, Skeleton};
use backstop_scene::builtin::{self, dynamic, fixed, talk_terrain};
use backstop_scene::{Rng, Scene, SceneJoint, axis_angle, throw};
use std::sync::Arc;

/// How far hinges of ragdolls turn to either side [rad].
const HINGE: f32 = 1.2;

/// Adds a figure of 11 capsules, six ball joints and four hinges.
///
/// Ball joints turn freely and hinges as far to both sides: engines differ in what a cone is, and in the sign
/// of an angle.
fn add_figure(scene: &mut Scene, at: DVec3, turn: Rotation) {
    let first = scene.joints.len();
    throw(scene, &Skeleton::humanoid(), (at, turn), Vec3::ZERO);
    for joint in &mut scene.joints[first..] {
        let hinge = turning(joint, true) != Turning::Ball;
        joint.motors.clear();
        joint.limits.retain(|limit| limit.motion == Motion::Linear);
        if hinge {
            joint.limits.push(Limit::lock(Motion::Angular, Axes::Perpendicular(Axis::X)));
            joint.limits.push(Limit::new(Motion::Angular, Axes::One(Axis::X), -HINGE, HINGE));
        }
    }
}

/// A hundred figures in a pen of 8 m.
pub(super) fn ragdolls() -> Subject {
    let (half, height) = (4.0, 20.0);
    let mut scene = Scene::new("ragdolls");
    pen(&mut scene, half, height);
    let mut rng = Rng::new(38);
    for i in 0..100 {
        let (x, z, layer) = (i % 4, i / 4 % 5, i / 20);
        let at = Vec3::new((x as f32 - 1.5) * 1.9, 0.5 + 2.2 * layer as f32, (z as f32 - 2.0) * 1.4);
        add_figure(&mut scene, at.as_dvec3(), axis_angle(Vec3::Y, rng.range(-0.2, 0.2)));
    }
    Subject { beyond: beyond_pen(half, height), ..Subject::new(scene, Error::Joint) }
}

/// Two hundred figures on a terrain with balls of triangles on it.
pub(super) fn ragdoll_rain() -> Subject {
    let terrain = talk_terrain();
    let mut scene = Scene::new("ragdoll_rain");
    add_mesh(&mut scene, "terrain", Vec3::ZERO, terrain.mesh());
    for i in 0..25 {
        let (x, z) = ((i % 5) as f32 * 4.0 - 8.0, (i / 5) as f32 * 4.0 - 8.0);
        add_mesh(&mut scene, "ball", Vec3::new(x, terrain.height(x, z) + 1.0, z), ball_mesh(1.2));
    }
    let mut rng = Rng::new(39);
    for i in 0..200 {
        let (x, z, layer) = (i % 7, i / 7 % 7, i / 49);
        let at = Vec3::new((x as f32 - 3.0) * 2.6, 7.0 + 2.6 * layer as f32, (z as f32 - 3.0) * 2.6);
        add_figure(&mut scene, at.as_dvec3(), axis_angle(Vec3::Y, rng.range(0.0, 6.2)));
    }
    let subject = Subject::new(scene, Error::Joint);
    Subject { continuous: Continuous::On, beyond: below(terrain), ..subject }
}

/// A ball of 48 by 24 squares.
fn ball_mesh(radius: f32) -> (Vec<Vec3>, Vec<[u32; 3]>) {
    use std::f32::consts::{PI, TAU};
    let (around, up) = (48u32, 24u32);
    let mut vertices = vec![Vec3::Y * radius];
    for (ring, i) in (1..up).flat_map(|ring| (0..around).map(move |i| (ring, i))) {
        let (polar, angle) = (ring as f32 * PI / up as f32, i as f32 * TAU / around as f32);
        let flat = libm::sinf(polar);
        let way = Vec3::new(flat * libm::cosf(angle), libm::cosf(polar), -flat * libm::sinf(angle));
        vertices.push(way * radius);
    }
    vertices.push(Vec3::NEG_Y * radius);
    let at = |ring: u32, i: u32| 1 + (ring - 1) * around + i % around;
    let last = vertices.len() as u32 - 1;
    let mut triangles = Vec::new();
    for i in 0..around {
        triangles.push([0, at(1, i), at(1, i + 1)]);
        triangles.push([last, at(up - 1, i + 1), at(up - 1, i)]);
        for ring in 1..up - 1 {
            triangles.push([at(ring, i), at(ring + 1, i), at(ring + 1, i + 1)]);
            triangles.push([at(ring, i), at(ring + 1, i + 1), at(ring, i + 1)]);
        }
    }
    (vertices, triangles)
}

/// Fifty ropes of thirty links that swing down from level, each with a ball of thirty links' mass at its end.
pub(super) fn ropes() -> Subject {
    const LINKS: usize = 30;
    let (half, radius, ball) = (0.15_f32, 0.05_f32, 0.25_f32);
    let pitch = 2.0 * (half + radius);
    let lying = Quat::from_rotation_arc(Vec3::Y, Vec3::X);
    let mut scene = Scene::new("ropes");
    for rope in 0..50 {
        let top = Vec3::new(0.0, 0.0, 1.5 * rope as f32);
        scene.add("hook", fixed(Geometry::sphere(0.02), top));
        let first = scene.bodies.len() - 1;
        for i in 0..LINKS {
            let at = top + Vec3::X * (pitch * (i as f32 + 0.5));
            scene.add("link", dynamic(Geometry::capsule(half, radius), at).with_rotation(lying));
        }
        let end = top + Vec3::X * (pitch * LINKS as f32 + ball);
        let mut weight = dynamic(Geometry::sphere(ball), end).with_rotation(lying);
        let volume = 2.0 * half * radius * radius + 4.0 / 3.0 * radius * radius * radius;
        weight.shapes[0].density *= LINKS as f32 * volume / (4.0 / 3.0 * ball * ball * ball);
        scene.add("weight", weight);
        for i in 0..=LINKS {
            let under = if i == 0 { 0.0 } else { -0.5 * pitch };
            let over = if i == LINKS { ball } else { 0.5 * pitch };
            // The y axis of a lying body points to the hook.
            let frames = [Vec3::Y * -under, Vec3::Y * -over].map(Frame::at);
            scene.joints.push(ball_joint([first + i, first + i + 1], frames));
        }
    }
    let beyond = Arc::new(|_: Vec3| f32::NEG_INFINITY);
    Subject { rests: false, beyond, ..Subject::new(scene, Error::Joint) }
}

fn ball_joint(bodies: [usize; 2], frames: [Frame; 2]) -> SceneJoint {
    let JointDesc { limits, .. } = JointDesc::ball([backstop::BodyHandle::from_bits(0); 2], frames);
    SceneJoint { name: "joint".into(), bodies, frames, limits, motors: Vec::new(), collide: false }
}

/// A net of 100 by 100 balls and 19,800 joints, held by seven of them.
pub(super) fn grid() -> Subject {
    let beyond = Arc::new(|_: Vec3| f32::NEG_INFINITY);
    let subject = Subject::new(builtin::joint_grid(100), Error::Joint);
    Subject { steps: 100, rests: false, beyond, ..subject }
}
