//! Geometric stiffness of joints under load, as additional inertia.

use super::node::{Node, TreeWidth, on_nodes, with_parent};
use super::spatial::plus;
use super::tree::TreeBatch;
use crate::config::tuning::TREE_SAFE_FREQUENCY;
use crate::constraint::joint::ends::inverse;
use crate::lanes::{Lanes, Mask, Sym3, Vec3};

impl<L: TreeWidth> TreeBatch<L> {
    /// A load that pulls at an arm turns the body back, the faster the lighter it is: a chain that bears a
    /// thousand times its own weight is a string whose frequency is too high for the substep, and would tear
    /// itself apart. Where that is so, the stiffness of the load is added to the inertia, as if it were
    /// followed implicitly through the substep (Andrews, Teichmann and Kry, *Geometric Stiffness for
    /// Real-time Constrained Multibody Dynamics*, 2017).
    pub(crate) fn add_geometric_stiffness(&mut self) {
        self.add_geometric_stiffness_where(self.is_alone());
    }

    /// The same; `alone`: lanes in which no impulse counts as a blow.
    pub(crate) fn add_geometric_stiffness_where(&mut self, alone: L::Mask) {
        stiffen(&mut self.nodes, self.real, self.h, alone.bits());
        self.turn_inertias();
    }

    /// Turns the inertias of trees that conserve energy to the current orientation. Those of others stay as
    /// at the start of the step.
    pub(super) fn turn_inertias(&mut self) {
        if self.exact == 0 {
            return;
        }
        turn_inertias(&mut self.nodes, self.exact);
    }
}

on_nodes! {
    /// See [`TreeBatch::add_geometric_stiffness_where`].
    fn stiffen<'a, L>(nodes, real: usize, h: f32, alone: u32) {
        let (h, alone) = (L::splat(h), L::Mask::from_bits(alone));
        for node in &mut *nodes {
            (node.stiffened, node.pulled) = (Sym3::default(), L::zero());
        }
        for i in 0..nodes.len() {
            let (parent, node) = with_parent(nodes, i);
            if !node.jointed {
                continue;
            }
            let size = node.impulse.length();
            let blow = size.gt(node.steady) & !alone;
            let steady = L::select(blow, node.steady / L::select(blow, size, L::one()), L::one());
            let impulse = node.impulse * steady;
            let [arm, other] = node.arm_now;
            if let Some(parent) = parent {
                parent.pull(-impulse, other, h);
            }
            let body = if i < real { i } else { node.own as usize };
            nodes[body].pull(impulse, arm, h);
        }
        for node in nodes {
            let Sym3 { xx, yy, zz, .. } = node.inertia;
            let (pull, own) = (node.pulled, L::splat(0.5 * TREE_SAFE_FREQUENCY) * (xx + yy + zz));
            let share = L::select(pull.gt(own), L::one() - own / pull, L::zero());
            node.stiffened = plus(&node.inertia, &node.stiffened.scaled(share));
            node.stiffened_inverse = inverse(&node.stiffened);
        }
    }
}

on_nodes! {
    /// See [`TreeBatch::turn_inertias`].
    fn turn_inertias<'a, L>(nodes, exact: u32) {
        let exact = L::Mask::from_bits(exact);
        for node in nodes {
            let [inertia, inverse] = node.drift.turned(node.turn);
            node.stiffened = Sym3::select(exact, inertia, node.stiffened);
            node.stiffened_inverse = Sym3::select(exact, inverse, node.stiffened_inverse);
        }
    }
}

impl<L: Lanes> Node<L> {
    /// Adds the stiffness of an impulse at an arm, if it pulls.
    #[inline(always)]
    fn pull(&mut self, impulse: Vec3<L>, arm: Vec3<L>, h: L) {
        let along = impulse.dot(arm);
        let pulls = along.gt(L::zero());
        let k = L::select(pulls, along * h, L::zero());
        let over = k / L::select(pulls, arm.length_squared(), L::one());
        self.pulled += k;
        let b = &mut self.stiffened;
        b.xx += k - over * arm.x * arm.x;
        b.yy += k - over * arm.y * arm.y;
        b.zz += k - over * arm.z * arm.z;
        b.xy += -(over * arm.x * arm.y);
        b.xz += -(over * arm.x * arm.z);
        b.yz += -(over * arm.y * arm.z);
    }
}
