//! Couplings of a scene.

use backstop::JointHandle;
use backstop::{Axes, CoupledMotion, CouplingDesc, Motion};

/// A coupling of a scene: [`CouplingDesc`] with joints by their indices.
#[derive(Clone, Debug, PartialEq)]
#[non_exhaustive]
pub struct SceneCoupling {
    /// Indices in [`Scene::joints`](super::Scene::joints), of the joint of each of the two motions.
    pub joints: [usize; 2],
    /// The coupled motion of each.
    pub motions: [Motion; 2],
    /// Along or about which axes.
    pub axes: [Axes; 2],
    /// Factors on the displacements.
    pub factors: [f64; 2],
    /// See [`CouplingDesc::range`].
    pub range: Option<[f64; 2]>,
    /// See [`CouplingDesc::break_force`].
    pub break_force: [f32; 2],
    /// The caller's own.
    pub user_data: u64,
}

impl SceneCoupling {
    /// A coupling of joints with these indices; `describe` gets handles that stand for them:
    /// `SceneCoupling::new([0, 1], |hinges| CouplingDesc::gear(hinges, [20.0, 31.0]))`.
    pub fn new(joints: [usize; 2], describe: impl FnOnce([JointHandle; 2]) -> CouplingDesc) -> SceneCoupling {
        let stand_ins = [0, 1].map(JointHandle::from_bits);
        let desc = describe(stand_ins);
        SceneCoupling {
            joints: desc.motions.map(|motion| joints[usize::from(motion.joint == stand_ins[1])]),
            motions: desc.motions.map(|motion| motion.motion),
            axes: desc.motions.map(|motion| motion.axes),
            factors: desc.motions.map(|motion| motion.factor),
            range: desc.range,
            break_force: desc.break_force,
            user_data: desc.user_data,
        }
    }

    /// What a world adds, given the handles of all joints of the scene; `None` if an index is beyond them.
    pub fn desc(&self, joints: &[JointHandle]) -> Option<CouplingDesc> {
        let motion = |i: usize| {
            let joint = *joints.get(self.joints[i])?;
            let (motion, axes, factor) = (self.motions[i], self.axes[i], self.factors[i]);
            Some(CoupledMotion::new(joint, motion, axes, factor))
        };
        let desc = CouplingDesc::new([motion(0)?, motion(1)?]).with_range(self.range);
        Some(desc.with_break_force(self.break_force).with_user_data(self.user_data))
    }
}
