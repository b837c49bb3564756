//! The order of rows: Gauss-Seidel leaves the least error in the row that it solves last.

/// A group of rows of one kind, of joints or of contacts.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize), serde(rename_all = "snake_case"))]
pub enum RowGroup {
    /// Springs, motors and friction of joints.
    SoftJoints,
    /// Limits of joints.
    JointLimits,
    /// Locked directions of joints.
    Joints,
    /// Contacts between two dynamic bodies.
    Contacts,
    /// Potential contacts between two dynamic bodies.
    PotentialContacts,
    /// Contacts with static geometry.
    StaticContacts,
    /// Potential contacts with static geometry.
    PotentialStaticContacts,
}

/// The order in which groups of rows are solved: the last is obeyed best.
///
/// The default is that of Vincent Robert's talk (Ubisoft, GDC 2012): joints before contacts, so that an error
/// that can't be avoided is left in a joint for a frame and not in a wall for ever.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct Order(pub [RowGroup; Order::LEN]);

impl Default for Order {
    fn default() -> Self {
        use RowGroup::*;
        Order([
            SoftJoints,
            JointLimits,
            Joints,
            Contacts,
            PotentialContacts,
            StaticContacts,
            PotentialStaticContacts,
        ])
    }
}

/// Position of rows among all others: later ones win.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, PartialOrd, Ord)]
pub(crate) struct Place(u8);

impl Order {
    /// Number of groups.
    pub(crate) const LEN: usize = 7;

    /// The opposite: contacts first, joints last. It shows the benefit of the default.
    pub fn reversed(self) -> Order {
        let mut groups = self.0;
        groups.reverse();
        Order(groups)
    }

    /// The position of rows of a group: its own, or right after the group `solved_after`, if that is
    /// later. Rows that are solved after the same group keep their order.
    pub(crate) fn place(self, group: RowGroup, solved_after: Option<RowGroup>) -> Place {
        let own = self.rank(group);
        let after = solved_after.map_or(0, |above| 2 * self.rank(above) + 1);
        Place(((2 * own).max(after) * self.0.len() + own) as u8)
    }

    /// The group after which rows of two bodies are solved: the later one.
    pub(crate) fn higher(self, a: Option<RowGroup>, b: Option<RowGroup>) -> Option<RowGroup> {
        [a, b].into_iter().flatten().max_by_key(|group| self.rank(*group))
    }

    /// Whether each group occurs once.
    pub(crate) fn is_complete(self) -> bool {
        Order::default().0.iter().all(|group| self.0.contains(group))
    }

    fn rank(self, group: RowGroup) -> usize {
        self.0.iter().position(|&g| g == group).unwrap_or(0)
    }
}
