//! The impulses of joints on the bodies of trees, for the lab.

use super::TreeBatch;
use crate::constraint::articulation::node::TreeWidth;
use crate::constraint::articulation::spatial::Twist;

/// The impulses of all its joints on a body.
#[derive(Clone, Copy, Debug)]
pub(crate) struct TreePush {
    /// Their sum [N s].
    pub(crate) impulse: glam::Vec3,
    /// The angular velocity that they give it where bodies are now [rad/s].
    pub(crate) turned: glam::Vec3,
    /// Whether it counts as harder to turn than it is, by geometric stiffness.
    pub(crate) stiffened: bool,
}

impl<L: TreeWidth> TreeBatch<L> {
    /// Calls `f` with each body and the impulses of the substep on it, as if all had acted where bodies are
    /// now.
    pub(crate) fn each_push(&self, f: &mut dyn FnMut(u32, TreePush)) {
        let mut sums = vec![Twist::<L>::zero(); self.real];
        let mut push = |node: usize, force: Twist<L>| {
            let [arm, above] = self.arms_of(node);
            sums[self.body_of(node)].add(force.moved(arm));
            if let Some(parent) = sums.get_mut(self.nodes[node].parent as usize) {
                parent.subtract(force.moved(above));
            }
        };
        for (i, node) in self.nodes.iter().enumerate().filter(|(_, node)| node.jointed) {
            push(i, Twist { linear: node.impulse, angular: node.twist });
        }
        for (i, motor) in self.extra.motors.iter().enumerate() {
            let angular = self.axis_of(i) * motor.impulse;
            push(motor.node as usize, Twist { angular, ..Twist::zero() });
        }
        for (node, sum) in self.of_bodies().iter().zip(sums) {
            let turned = node.stiffened_inverse.mul(sum.angular);
            let stiffness = [
                node.stiffened.xx - node.inertia.xx,
                node.stiffened.yy - node.inertia.yy,
                node.stiffened.zz - node.inertia.zz,
            ];
            for lane in (0..L::N).filter(|lane| node.write >> lane & 1 != 0) {
                let is_exact = self.exact >> lane & 1 != 0;
                let push = TreePush {
                    impulse: sum.linear.lane(lane),
                    turned: turned.lane(lane),
                    stiffened: !is_exact && stiffness.iter().any(|more| more.lane(lane) != 0.0),
                };
                f(node.body[lane], push);
            }
        }
    }
}
