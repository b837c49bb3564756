//! The column of forces, which exists once a force was applied, and for a while after.

use super::store::{Bodies, IDLE};
use crate::lanes::Record;
use crate::memory::Buffer;

impl Bodies {
    /// Whether a force was applied since the last step. That the column exists says nothing: it outlasts its
    /// forces for a while, and longer in a world with a budget.
    pub(crate) fn is_pushed(&self) -> bool {
        !self.force.is_empty() && self.unpushed == 0
    }

    /// A force is about to be applied; the column is there.
    pub(crate) fn note_push(&mut self) {
        self.pushes = self.pushes.saturating_add(1);
        self.unpushed = 0;
    }

    /// Makes the column, of which there is none yet.
    pub(crate) fn make_forces(&mut self) {
        let bodies = self.len();
        self.force.reserve_total(bodies);
        self.force.resize(bodies, Record::default());
    }

    /// Forces last for a step. After some steps without forces their column is freed, if it may.
    pub(crate) fn forget_forces(&mut self, may_go: bool) {
        if self.force.is_empty() {
            return;
        }
        if self.unpushed == 0 {
            self.force.fill(Record::default());
        }
        self.unpushed = self.unpushed.saturating_add(1);
        if may_go && self.unpushed > IDLE {
            (self.force, self.pushes, self.unpushed) = (Vec::new(), 0, 0);
        }
    }
}
