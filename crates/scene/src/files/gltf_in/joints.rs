//! Joints: their limits, motors and frames.

use super::extension::{self, NodeJoint};
use super::file::Parts;
use super::loader::Loader;
use super::problem::{Problem, problem};
use crate::{SceneError, SceneJoint};
use backstop::Error;
use backstop::limits::finite3;
use backstop::{Axes, Axis, Frame, Limit, Motion, Motor, Spring};
use backstop::{BodyDesc, BodyKind};
use glam::DQuat;

/// Limits and motors of one joint description, which several nodes may use.
#[derive(Clone, Debug)]
pub(super) struct Rows {
    limits: Vec<Limit>,
    drives: Vec<Motor>,
}

/// All descriptions of a file.
pub(super) fn rows(parts: &Parts, joints: &[extension::Joint]) -> Result<Vec<Rows>, SceneError> {
    let wrong = |joint: usize, what: &str, index: usize, why: String| SceneError::Malformed {
        file: parts.path.clone(),
        what: format!("joint {joint}, {what} {index}: {why}"),
    };
    let one = |(i, joint): (usize, &extension::Joint)| {
        let limits = joint.limits.iter().enumerate();
        let drives = joint.drives.iter().enumerate();
        Ok(Rows {
            limits: limits
                .map(|(k, l)| limit(l).map_err(|why| wrong(i, "limit", k, why)))
                .collect::<Result<_, _>>()?,
            drives: drives
                .map(|(k, d)| drive(d).map_err(|why| wrong(i, "drive", k, why)))
                .collect::<Result<_, _>>()?,
        })
    };
    joints.iter().enumerate().map(one).collect()
}

fn limit(limit: &extension::Limit) -> Result<Limit, String> {
    let (motion, list) = match (&limit.linear_axes, &limit.angular_axes) {
        (Some(list), None) => (Motion::Linear, list),
        (None, Some(list)) => (Motion::Angular, list),
        _ => return Err("it must have either linearAxes or angularAxes".into()),
    };
    let damping = or_infinite(limit.damping);
    let spring = limit.stiffness.map(|stiffness| Spring::Coefficients { stiffness, damping });
    let (min, max) = (limit.min.unwrap_or(f32::NEG_INFINITY), limit.max.unwrap_or(f32::INFINITY));
    let limit = Limit { motion, axes: axes(list)?, min, max, spring };
    limit.validate().map_err(|e| e.to_string())?;
    Ok(limit)
}

pub(super) fn axes(list: &[usize]) -> Result<Axes, String> {
    let mut has = [false; 3];
    for &i in list {
        let Some(has) = has.get_mut(i) else { return Err(beyond(i)) };
        if std::mem::replace(has, true) {
            return Err(format!("axis {i} is there twice"));
        }
    }
    let only = |wanted: bool| Axis::ALL.into_iter().find(|&axis| has[axis as usize] == wanted);
    match (list.len(), only(true), only(false)) {
        (1, Some(axis), _) => Ok(Axes::One(axis)),
        (2, _, Some(axis)) => Ok(Axes::Perpendicular(axis)),
        (3, ..) => Ok(Axes::All),
        _ => Err("it has no axes".into()),
    }
}

fn drive(drive: &extension::Motor) -> Result<Motor, String> {
    let motion = match drive.kind.as_str() {
        "linear" => Motion::Linear,
        "angular" => Motion::Angular,
        other => return Err(format!("drives of type {other:?} are not known")),
    };
    let (stiffness, damping) = (drive.stiffness, or_infinite(drive.damping));
    let spring = match drive.mode.as_str() {
        "force" => Spring::Coefficients { stiffness, damping },
        "acceleration" => Spring::Acceleration { stiffness, damping },
        other => return Err(format!("the mode {other:?} is not known")),
    };
    let drive = Motor {
        motion,
        axis: Axis::ALL.get(drive.axis).copied().ok_or_else(|| beyond(drive.axis))?,
        position: drive.position_target,
        velocity: drive.velocity_target,
        spring,
        max_force: drive.max_force.unwrap_or(f32::INFINITY),
    };
    drive.validate().map_err(|e| e.to_string())?;
    Ok(drive)
}

/// A motor that holds a speed exactly has infinite damping, and a file has the largest number for it.
fn or_infinite(damping: f32) -> f32 {
    if damping >= Spring::MAX_COEFFICIENT { f32::INFINITY } else { damping }
}

fn beyond(axis: usize) -> String {
    format!("there is no axis {axis}, only 0, 1 and 2")
}

impl Loader<'_> {
    /// In the order of their nodes in the file.
    pub(super) fn add_joints(&mut self) -> Result<(), SceneError> {
        let mut nodes = self.tree.order.clone();
        nodes.sort_unstable();
        // One body for all joints to the world.
        let mut world = None;
        for &node in &nodes {
            let Some(joint) = self.physics[node].as_mut().and_then(|p| p.joint.take()) else { continue };
            self.joint_at.insert(node, None);
            let there = nodes.binary_search(&joint.connected_node).is_ok();
            if there || joint.connected_node >= self.tree.parent.len() {
                self.add_joint(node, &joint, &mut world)?;
            } else {
                self.note(node, "its joint is left out: the connected node is not in the scene");
            }
        }
        Ok(())
    }

    fn add_joint(
        &mut self,
        node: usize,
        joint: &NodeJoint,
        world: &mut Option<usize>,
    ) -> Result<(), SceneError> {
        let parts = self.parts;
        let missing = |what: &str, index: usize| {
            problem(parts, node, Problem::Text(format!("{what} {index} does not exist")))
        };
        let Some(rows) = self.joints.get(joint.joint) else {
            return Err(missing("joint", joint.joint));
        };
        let other = joint.connected_node;
        if other >= self.tree.parent.len() {
            return Err(missing("connected node", other));
        }
        let on = [node, other].map(|n| self.body[n].or(self.ground[n]));
        let dynamic =
            |body: Option<usize>| body.is_some_and(|b| self.scene.bodies[b].desc.kind == BodyKind::Dynamic);
        if !on.into_iter().any(dynamic) {
            self.note(node, "its joint is left out: neither of its bodies is dynamic");
            return Ok(());
        }
        if on[0] == on[1] {
            self.note(node, "its joint is left out: both its nodes are on the same body");
            return Ok(());
        }
        let rows_of_it = 1 + rows.limits.len() + rows.drives.len();
        self.tally.joints.take(rows_of_it).map_err(|e| problem(self.parts, node, e.into()))?;
        let frame = |n, body| self.frame(n, body).map_err(|e| problem(self.parts, node, Problem::Engine(e)));
        let frames = [frame(node, on[0])?, frame(other, on[1])?];
        let bodies = on.map(|body| {
            body.unwrap_or_else(|| *world.get_or_insert_with(|| self.scene.add("world", BodyDesc::fixed())))
        });
        let Rows { limits, drives } = self.joints[joint.joint].clone();
        let (name, collide) = (self.name(node), joint.enable_collision);
        self.joint_at.insert(node, Some(self.scene.joints.len()));
        self.scene.joints.push(SceneJoint { name, bodies, frames, limits, motors: drives, collide });
        Ok(())
    }

    /// Where a node is on its body, or in the world.
    fn frame(&self, node: usize, body: Option<usize>) -> Result<Frame, Error> {
        let (position, rotation): (_, DQuat) = match body.and_then(|b| self.scene.bodies[b].node) {
            Some(home) => self.relative(home, node),
            None => (self.tree.global[node].translation, self.tree.rotation[node]),
        };
        let position = finite3("joint frame position", position.as_vec3())?;
        Ok(Frame { position, rotation: rotation.normalize().as_quat() })
    }
}
