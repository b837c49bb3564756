//! Up to eight trees and their data.

use crate::config::tuning::TREE_RECOVERY_TOUCHING;
use crate::constraint::articulation::cut::Extra;
use crate::constraint::articulation::node::{Node, TreeWidth, with_parent};
use crate::constraint::schedule::order::Place;
use crate::lanes::Mask;

/// Up to eight trees of one shape, parents before children.
#[derive(Clone, Debug, Default)]
pub(crate) struct TreeBatch<L> {
    /// A node for each body, then one for each cut joint.
    pub(crate) nodes: Vec<Node<L>>,
    /// Number of bodies in a tree.
    pub(crate) real: usize,
    /// Rows of cut joints and motors.
    pub(crate) extra: Extra<L>,
    /// Bodies have turned since the last solution.
    pub(crate) fresh: bool,
    /// Share of an error that velocities correct within a substep.
    pub(crate) share: L,
    /// Lanes of trees that conserve energy (see [`rattle`](super::super::rattle)). Those of the others are
    /// warm-started.
    pub(crate) exact: u32,
    /// Lanes of trees in which a body bears several times its mass; those of warm-started trees whose
    /// substeps are checked afterwards; and those on which only joints and external forces act in the
    /// substep.
    pub(crate) laden: u32,
    pub(crate) watched: u32,
    pub(crate) calm: u32,
    /// Lanes of which a substep was solved again (see [`damp`](super::super::damp)).
    pub(crate) damped: u32,
    /// Lanes whose bodies turn as predicted last.
    pub(crate) known: u32,
    /// Lanes for which no impulses were found that close the joints.
    pub(crate) lost: u32,
    /// The same, in any part of the substep.
    pub(crate) astray: u32,
    /// External forces act for so much longer in the first substep [s].
    pub(crate) late: L,
    /// The same within a substep that began with it.
    pub(crate) caught: L,
    /// Lanes whose substep was solved in parts.
    pub(crate) whirled: u32,
    /// Half a substep where only joints and external forces act on the tree, else zero [s].
    pub(crate) lag: L,
    /// Its place in the order of all rows.
    pub(crate) place: Place,
    /// Contacts that are solved along with the trees: their range among all such.
    pub(crate) contacts: (u32, u32),
    /// Substep [s].
    pub(crate) h: f32,
    /// The length unit [m].
    pub(crate) unit: f32,
    /// Lanes in which a body counts as heavier than it is.
    pub(crate) weighted: u32,
}

impl<L> TreeBatch<L> {
    pub(crate) fn of_bodies(&self) -> &[Node<L>] {
        &self.nodes[..self.real]
    }
    /// Whether it has loops, which were cut.
    pub(crate) fn is_cut(&self) -> bool {
        self.real < self.nodes.len()
    }
    /// Number of bodies in all its trees.
    pub(crate) fn bodies(&self) -> u32 {
        self.of_bodies().iter().map(|node| node.write.count_ones()).sum()
    }
}

impl<L: TreeWidth> TreeBatch<L> {
    /// Forgets the last step: state that outlives it is in the joints, and a restored world has nothing else.
    pub(crate) fn forget(&mut self) {
        let TreeBatch { mut nodes, mut extra, real, place, .. } = std::mem::take(self);
        nodes.iter_mut().for_each(Node::forget);
        extra.forget();
        *self = TreeBatch { nodes, extra, real, place, ..TreeBatch::default() };
    }

    /// A node and its parent, which precedes it.
    #[inline(always)]
    pub(crate) fn with_parent(&mut self, i: usize) -> (Option<&mut Node<L>>, &mut Node<L>) {
        with_parent(&mut self.nodes, i)
    }

    /// Lanes of trees that conserve energy.
    pub(crate) fn exact(&self) -> L::Mask {
        L::Mask::from_bits(self.exact)
    }

    /// Whether all trees conserve energy.
    pub(crate) fn all_exact(&self) -> bool {
        self.nodes.first().is_none_or(|root| root.write == self.exact)
    }

    /// Whether there are rows beside the tree.
    #[inline(always)]
    pub(crate) fn has_extra(&self) -> bool {
        self.is_cut() || !self.extra.motors.is_empty()
    }

    /// Trees that touch nothing and are warm-started: no load in them is a blow.
    pub(crate) fn is_alone(&self) -> L::Mask {
        self.share.gt(L::splat(TREE_RECOVERY_TOUCHING))
    }
}
