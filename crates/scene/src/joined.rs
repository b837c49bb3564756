//! Bodies that are joined, by their indices in a scene.

use super::{Scene, SceneJoint};
use backstop::BodyHandle;
use backstop::math::Quat;
use backstop::{Frame, JointDesc, Skeleton};
use glam::{DVec3, Vec3};

/// A placeholder where a joint's bodies are given by their indices.
const NOBODY: BodyHandle = BodyHandle::from_bits(0);

/// Joins two bodies of a scene at a point, with frames whose axes are those of a rotation.
pub fn join(
    scene: &mut Scene,
    bodies: [usize; 2],
    point: DVec3,
    axes: Quat,
    describe: impl Fn([BodyHandle; 2], [Frame; 2]) -> JointDesc,
) {
    let frames = bodies.map(|body| {
        let desc = &scene.bodies[body].desc;
        let back = Quat::from(desc.rotation).conjugate();
        let position = back * (point - desc.position).as_vec3();
        Frame { rotation: (back * axes).normalize().into(), ..Frame::at(position) }
    });
    let JointDesc { limits, motors, collide, .. } = describe([NOBODY; 2], frames);
    scene.joints.push(SceneJoint { name: "joint".into(), bodies, frames, limits, motors, collide });
}

/// Adds a figure that stands somewhere [m], turned, and moves as one [m/s].
pub fn throw(scene: &mut Scene, figure: &Skeleton, (at, turn): (DVec3, Quat), velocity: Vec3) {
    let first = scene.bodies.len();
    for bone in &figure.bones {
        scene.add("limb", figure.body(bone, (at, turn), velocity));
    }
    for (i, bone) in figure.bones.iter().enumerate() {
        let Some(parent) = bone.parent else { continue };
        let point = at + (turn * bone.joint_at).as_dvec3();
        let axes = (turn * bone.axes()).normalize();
        join(scene, [first + parent, first + i], point, axes, |bodies, frames| {
            figure.joint(bone, JointDesc::ball(bodies, frames))
        });
    }
}
