//! Passes over the rows of joints.

use super::parameters::PassParameters;
use super::{BLOCK, PassKind, Passes, share_out};
use crate::constraint::{JointPass, JointStage, JointType, JointViews, Recovery, TouchInput, TreeRef};

/// Batches of joint rows, in the order in which they are solved.
pub(super) struct JointBatches<'a> {
    pub(super) stages: &'a [JointStage],
    pub(super) views: JointViews<'a>,
}

impl JointBatches<'_> {
    pub(super) fn exist(&self) -> bool {
        !self.stages.is_empty()
    }
}

/// Number of sweeps over the rows of joints in a pass: a net of 10,000 points of which seven are held
/// stretches by 1.75 m with one sweep, by 0.84 m with two, which cost a fifth more, and by 0.78 m with three.
const JOINT_SWEEPS: u32 = 2;

impl Passes<'_> {
    /// A pass over some types of joint rows.
    pub(super) fn run_joints(&self, kind: PassKind, stages: &[JointStage], contacts: &TouchInput<'_>) {
        if kind == PassKind::ImpactFriction {
            return;
        }
        let relax = kind == PassKind::Relax;
        let sweeps = if kind == PassKind::WarmStart { 1 } else { JOINT_SWEEPS };
        for (sweep, stage) in (0..sweeps).flat_map(|sweep| stages.iter().map(move |stage| (sweep, stage))) {
            // Trees are solved exactly: once is enough, in the last sweep.
            let is_tree = stage.kind == JointType::Tree;
            if is_tree && sweep + 1 < sweeps {
                continue;
            }
            let pass = JointPass {
                moved: relax && (is_tree || sweep == 0),
                fresh: !relax && sweep == 0,
                relax,
                ..self.joint_pass()
            };
            let pass = (kind != PassKind::WarmStart).then_some(&pass);
            // SAFETY: each batch is in one stage; no dynamic body is twice in it, unless its rows found no
            // colour, and then one thread has all of it.
            let one = |i: usize| unsafe { self.joints.views.step(stage, i, self.motion, pass, contacts) };
            self.share(stage, &one);
        }
    }

    /// Lets joints of trees that conserve energy act before any row of the substep is solved.
    pub(super) fn predict_trees(&self) {
        let pass = JointPass { fresh: true, ..self.joint_pass() };
        for stage in self.joints.stages.iter().filter(|stage| stage.kind == JointType::Tree) {
            // SAFETY: each batch is in one stage, and no dynamic body is in two.
            let one = |i: usize| unsafe {
                self.joints.views.predict(TreeRef::new(i, stage.single), self.motion, &pass);
            };
            self.share(stage, &one);
        }
    }

    /// Closes locks outside trees, moves the bodies of trees that conserve energy, and closes the joints of
    /// trees. `slop`: overlap that contacts leave alone [m].
    pub(super) fn close_joints(&self, slop: f32) {
        let Recovery { linear, angular } = self.parameters.recovery;
        let inverse_h = self.parameters.inverse_h;
        let most = Recovery { linear: linear / inverse_h, angular: angular / inverse_h };
        let JointBatches { stages, views } = &self.joints;
        for stage in (0..JOINT_SWEEPS).flat_map(|_| *stages).filter(|stage| stage.kind.is_lock()) {
            // SAFETY: each batch is in one stage; no dynamic body is twice in it, unless its rows found no
            // colour, and then one thread has all of it.
            let one = |i: usize| unsafe { views.close_locks(stage, i, self.motion, most) };
            self.share(stage, &one);
        }
        for stage in stages.iter().filter(|stage| stage.kind == JointType::Tree) {
            // SAFETY: each batch is in one stage, and no dynamic body is in two.
            let one = |i: usize| unsafe {
                let tree = TreeRef::new(i, stage.single);
                views.go(tree, self.motion, slop, &self.contacts);
            };
            self.share(stage, &one);
        }
    }

    #[inline(always)]
    fn share(&self, stage: &JointStage, one: &(impl Fn(usize) + Sync)) {
        // A batch of trees takes as long as hundreds of others.
        let block = match stage.kind {
            JointType::Tree => 1,
            // Rows without a colour have to be solved in order.
            _ if stage.single => usize::MAX,
            _ => BLOCK,
        };
        share_out(self.workers, stage.start as usize..stage.end as usize, block, one);
    }

    fn joint_pass(&self) -> JointPass {
        let PassParameters { inverse_h, joint, recovery, .. } = self.parameters;
        JointPass { inverse_h, softness: joint, recovery, moved: false, fresh: false, relax: false }
    }
}
