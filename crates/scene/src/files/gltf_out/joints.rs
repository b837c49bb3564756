//! Joints as nodes: one below each body for its frame, the first with the joint.
//!
//! A joint to a static body without shapes is a joint to the world in a file, and is read back as one to a
//! body at the origin. A file has force springs only for limits, so limits with springs by acceleration or
//! frequency are written rigid; it has no frequencies for drives, which get the equivalent acceleration.
//! Couplings are in the `extras` of the physics extension, and name joints by their nodes.

use super::super::gltf_in::extension::RIGID_BODIES;
use super::build::{Builder, alone, intern, place};
use crate::{SceneBody, SceneCoupling, SceneJoint};
use backstop::BodyKind;
use backstop::{Axes, Frame, Limit, Motion, Motor, Spring, SpringCoefficients};
use serde_json::{Value, json};

impl Builder<'_> {
    /// Adds a joint between bodies that are at these nodes; returns its node. One that refers to other bodies
    /// is left out.
    pub(super) fn joint(
        &mut self,
        joint: &SceneJoint,
        bodies: &[SceneBody],
        nodes: &[usize],
    ) -> Option<usize> {
        if joint.bodies.iter().any(|&b| b >= bodies.len().min(nodes.len())) {
            return None;
        }
        let [first, second] = [0, 1].map(|side| {
            let body = joint.bodies[side];
            self.frame(&bodies[body], nodes[body], joint.frames[side])
        });
        let description = intern(&mut self.joints, description(joint));
        let mut physics = json!({ "connectedNode": second, "joint": description });
        if joint.collide {
            physics["enableCollision"] = json!(true);
        }
        let node = &mut self.document.list("nodes")[first];
        node["name"] = json!(joint.name);
        node["extensions"] = json!({ RIGID_BODIES: { "joint": physics } });
        Some(first)
    }

    /// Adds a coupling of joints that are at these nodes. One that refers to other joints is left out.
    pub(super) fn coupling(&mut self, coupling: &SceneCoupling, joints: &[Option<usize>]) {
        let node = |i: usize| joints.get(coupling.joints[i]).copied().flatten();
        let motion = |i: usize| {
            let mut out = json!({ "node": node(i)?, "factor": coupling.factors[i] });
            out[axes_name(coupling.motions[i])] = json!(axes(coupling.axes[i]));
            Some(out)
        };
        let (Some(first), Some(second)) = (motion(0), motion(1)) else { return };
        let mut out = json!({ "motions": [first, second] });
        if let Some(range) = coupling.range {
            out["range"] = json!(range);
        }
        // An infinite number is null.
        if coupling.break_force != [f32::INFINITY; 2] {
            out["strength"] = json!(coupling.break_force);
        }
        if coupling.user_data != 0 {
            out["userData"] = json!(coupling.user_data);
        }
        self.couplings.push(out);
    }

    /// A node for a frame of a body.
    fn frame(&mut self, body: &SceneBody, mut above: usize, mut frame: Frame) -> usize {
        // Shapes of a static body that have nodes of their own are read back as bodies of their own: the
        // joint is attached to the first of them, with which it then does not collide.
        let first = body.desc.shapes.first().filter(|s| body.desc.shapes.len() > 1 || !alone(s));
        if let (BodyKind::Static, Some(shape)) = (body.desc.kind, first)
            && let Some(child) = self.document.list("nodes")[above]["children"][0].as_u64()
        {
            let back = shape.rotation.normalize().inverse();
            above = child as usize;
            frame = Frame {
                position: back * (frame.position - shape.position),
                rotation: (back * frame.rotation).normalize(),
            };
        }
        let mut node = json!({});
        place(&mut node, frame.position.as_dvec3(), frame.rotation);
        let index = self.document.push("nodes", node);
        match &mut self.document.list("nodes")[above]["children"] {
            Value::Array(children) => children.push(json!(index)),
            none => *none = json!([index]),
        }
        index
    }
}

fn description(joint: &SceneJoint) -> Value {
    let mut out = json!({});
    let limits: Vec<Value> = joint.limits.iter().map(limit).collect();
    let drives: Vec<Value> = joint.motors.iter().map(drive).collect();
    for (name, list) in [("limits", limits), ("drives", drives)] {
        if !list.is_empty() {
            out[name] = json!(list);
        }
    }
    out
}

fn axes_name(motion: Motion) -> &'static str {
    match motion {
        Motion::Linear => "linearAxes",
        Motion::Angular => "angularAxes",
    }
}

fn axes(axes: Axes) -> Vec<usize> {
    match axes {
        Axes::One(axis) => vec![axis as usize],
        Axes::Perpendicular(axis) => (0..3).filter(|&i| i != axis as usize).collect(),
        Axes::All => vec![0, 1, 2],
    }
}

fn limit(limit: &Limit) -> Value {
    let mut out = json!({ axes_name(limit.motion): axes(limit.axes) });
    for (name, bound) in [("min", limit.min), ("max", limit.max)] {
        if bound.is_finite() {
            out[name] = json!(bound);
        }
    }
    if let Some(Spring::Coefficients { stiffness, damping }) = limit.spring {
        out["stiffness"] = json!(stiffness);
        out["damping"] = json!(finite(damping));
    }
    out
}

fn drive(drive: &Motor) -> Value {
    let SpringCoefficients { stiffness, damping, per_mass } = drive.spring.coefficients();
    let mut out = json!({
        "type": match drive.motion { Motion::Linear => "linear", Motion::Angular => "angular" },
        "mode": if per_mass { "acceleration" } else { "force" },
        "axis": drive.axis as usize,
        "positionTarget": drive.position,
        "velocityTarget": drive.velocity,
        "stiffness": stiffness,
        "damping": finite(damping),
    });
    if drive.max_force.is_finite() {
        out["maxForce"] = json!(drive.max_force);
    }
    out
}

/// JSON has no infinity: the largest allowed number stands for it when read.
fn finite(damping: f32) -> f32 {
    damping.min(Spring::MAX_COEFFICIENT)
}
