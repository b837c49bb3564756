//! Which contacts are solved along with a tree of joints: those of its bodies with static geometry.

use crate::constraint::contact::batch::BatchRef;
use crate::constraint::joint::ends::NONE;
use crate::memory::buffers;

/// A batch of trees.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub(crate) struct TreeRef(u32);

impl TreeRef {
    const SINGLE: u32 = 1 << 31;

    pub(crate) fn new(index: usize, single: bool) -> TreeRef {
        TreeRef(index as u32 | if single { TreeRef::SINGLE } else { 0 })
    }
    pub(crate) fn index(self) -> usize {
        (self.0 & !TreeRef::SINGLE) as usize
    }
    /// Whether it is a single tree, whose contacts are in batches of one lane.
    pub(crate) fn is_single(self) -> bool {
        self.0 & TreeRef::SINGLE != 0
    }
}

/// The place of a body in the trees.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub(crate) struct TreeSlot {
    tree: TreeRef,
    node: u32,
    lane: u32,
}

impl TreeSlot {
    const NOWHERE: TreeSlot = TreeSlot { tree: TreeRef(NONE), node: NONE, lane: NONE };

    pub(crate) fn new(tree: TreeRef, node: usize, lane: usize) -> TreeSlot {
        TreeSlot { tree, node: node as u32, lane: lane as u32 }
    }
    /// The same for all bodies of a tree.
    pub(crate) fn of_tree(self) -> (TreeRef, u32) {
        (self.tree, self.lane)
    }
    /// The same for all contacts of a batch.
    pub(crate) fn place(self) -> (TreeRef, u32) {
        (self.tree, self.node)
    }
    pub(crate) fn lane(self) -> usize {
        self.lane as usize
    }
}

/// The slots of all dynamic bodies; empty if nothing is solved along with trees.
#[derive(Debug, Default)]
pub(crate) struct TreeSlots {
    all: Vec<TreeSlot>,
}

buffers! { TreeSlots { each(dynamic: usize) { all(dynamic) } } }

impl TreeSlots {
    pub(crate) fn clear(&mut self) {
        self.all.clear();
    }
    /// No body has a slot yet.
    pub(crate) fn reset(&mut self, dynamic: usize) {
        self.all.clear();
        self.all.resize(dynamic, TreeSlot::NOWHERE);
    }
    pub(crate) fn put(&mut self, body: usize, slot: TreeSlot) {
        self.all[body] = slot;
    }
    pub(crate) fn is_empty(&self) -> bool {
        self.all.is_empty()
    }
    #[inline]
    pub(crate) fn of(&self, body: usize) -> Option<TreeSlot> {
        self.all.get(body).copied().filter(|slot| *slot != TreeSlot::NOWHERE)
    }
}

/// The contacts of one node of a batch of trees.
#[derive(Clone, Copy, Debug)]
pub(crate) struct TreeContacts {
    pub(crate) tree: TreeRef,
    pub(crate) node: u32,
    /// Whether they have no friction.
    pub(crate) potential: bool,
    pub(crate) batch: BatchRef,
}
