//! Couplings of joints.

use super::extension::{self, CoupledMotion};
use super::joints;
use super::loader::Loader;
use crate::{SceneCoupling, SceneError};
use backstop::JointHandle;
use backstop::{Axes, Motion};

impl Loader<'_> {
    /// In the order of the file. One of a joint that was left out is left out too.
    pub(super) fn add_couplings(&mut self) -> Result<(), SceneError> {
        let file = &self.parts.path;
        for (i, coupling) in std::mem::take(&mut self.couplings).iter().enumerate() {
            let beyond = |source| SceneError::Limit { file: file.clone(), source };
            self.tally.joints.take(1).map_err(beyond)?;
            let wrong =
                |why| SceneError::Malformed { file: file.clone(), what: format!("coupling {i}: {why}") };
            match self.coupling(coupling).map_err(wrong)? {
                Some(coupling) => self.scene.couplings.push(coupling),
                None => {
                    let note = format!("coupling {i} is left out: the joint of one of its motions is");
                    self.scene.notes.push(note);
                }
            }
        }
        Ok(())
    }

    fn coupling(&self, coupling: &extension::Coupling) -> Result<Option<SceneCoupling>, String> {
        let [a, b] = &coupling.motions;
        let ((motion_a, axes_a), (motion_b, axes_b)) = (motion(a)?, motion(b)?);
        let (Some(joint_a), Some(joint_b)) = (self.joint_of(a)?, self.joint_of(b)?) else {
            return Ok(None);
        };
        let infinite =
            |[min, max]: [Option<f64>; 2]| [min.unwrap_or(f64::NEG_INFINITY), max.unwrap_or(f64::INFINITY)];
        let coupling = SceneCoupling {
            joints: [joint_a, joint_b],
            motions: [motion_a, motion_b],
            axes: [axes_a, axes_b],
            factors: [a.factor, b.factor],
            range: coupling.range.map(infinite),
            break_force: coupling.strength.map(|most| most.unwrap_or(f32::INFINITY)),
            user_data: coupling.user_data,
        };
        let handles: Vec<JointHandle> =
            (0..self.scene.joints.len() as u64).map(JointHandle::from_bits).collect();
        let valid = coupling.desc(&handles).map_or(Ok(()), |desc| desc.validate());
        valid.map_err(|e| e.to_string())?;
        Ok(Some(coupling))
    }

    /// The joint at the node of a motion; nothing if it was left out.
    fn joint_of(&self, motion: &CoupledMotion) -> Result<Option<usize>, String> {
        let node = motion.node;
        match self.joint_at.get(&node) {
            Some(joint) => Ok(*joint),
            None if node >= self.tree.parent.len() => Err(format!("node {node} does not exist")),
            None if !self.tree.in_scene[node] => Ok(None),
            None => Err(format!("node {node} has no joint")),
        }
    }
}

fn motion(of: &CoupledMotion) -> Result<(Motion, Axes), String> {
    match (&of.linear_axes, &of.angular_axes) {
        (Some(list), None) => Ok((Motion::Linear, joints::axes(list)?)),
        (None, Some(list)) => Ok((Motion::Angular, joints::axes(list)?)),
        _ => Err("a motion must have either linearAxes or angularAxes".into()),
    }
}
