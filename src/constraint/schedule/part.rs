//! The unit of scheduling: a contact, or some of its points, in a lane of a batch.

use crate::narrow_phase::ContactRef;
use bytemuck::Zeroable;

/// A contact, or some of its points, in a lane of a batch.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Zeroable)]
pub(crate) struct Part(pub(crate) u32);

impl Part {
    const SLOT: u32 = (1 << 27) - 1;
    /// The other points of the contact have parts of their own.
    const APART: u32 = 1 << 27;
    /// The first of four bits, one for each point; none of them if the part has all.
    const POINTS: u32 = 28;
    /// An inert lane.
    pub(crate) const NONE: Part = Part(u32::MAX);

    /// Some points of a contact, by bits; zero for all.
    pub(super) fn of(slot: u32, points: u32) -> Part {
        Part(slot | points << Self::POINTS)
    }
    pub(super) fn point(slot: u32, point: usize) -> Part {
        Part(slot | Self::APART | 1 << (Self::POINTS + point as u32))
    }
    pub(crate) fn slot(self) -> usize {
        (self.0 & Self::SLOT) as usize
    }
    /// The point, if the others are not in this part but in others.
    pub(crate) fn only(self) -> Option<usize> {
        (self.0 & Self::APART != 0).then(|| (self.0 >> Self::POINTS).trailing_zeros() as usize)
    }
    /// Whether some points of the contact have no rows.
    pub(crate) fn is_cut(self) -> bool {
        self.0 & Self::APART == 0 && self.0 >> Self::POINTS != 0
    }
    /// Its points, a bit each.
    pub(crate) fn points(self, contact: ContactRef<'_>) -> u32 {
        let own = self.0 >> Self::POINTS;
        if own == 0 { (1 << contact.count) - 1 } else { own }
    }
}
