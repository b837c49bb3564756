//! What counts as important: Gauss-Seidel leaves the least error in the row it solves last.

/// Rows of one kind, of joints and of contacts.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize), serde(rename_all = "snake_case"))]
pub enum RowGroup {
    /// Springs, drives, motors and friction of joints.
    SoftJoints,
    /// Ends of ranges that joints may move within.
    JointLimits,
    /// What joints keep together.
    Joints,
    /// Contacts of bodies that both can move.
    Contacts,
    /// Those that such bodies may have within the step.
    PotentialContacts,
    /// Contacts with what is static.
    StaticContacts,
    /// Those that a body may have with what is static within the step.
    PotentialStaticContacts,
}

/// In which order groups of rows are solved: what is solved last is obeyed best.
///
/// The default is that of Vincent Robert's talk (Ubisoft, GDC 2012): joints before contacts, so that what
/// can't be met is left in a joint for a frame and not in a wall for ever.
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

/// Where rows are solved among all others: what comes later wins.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, PartialOrd, Ord)]
pub(crate) struct Place(u8);

impl Order {
    /// How many groups there are.
    pub(crate) const LEN: usize = 7;

    /// The other way round: contacts first, joints last. To see what the default is good for.
    pub fn reversed(self) -> Order {
        let mut groups = self.0;
        groups.reverse();
        Order(groups)
    }

    /// The place of rows of a group: its own, or right after another that they are raised above, if that is
    /// later. What is raised above the same keeps the order among itself.
    pub(crate) fn place(self, group: RowGroup, raised: Option<RowGroup>) -> Place {
        let own = self.rank(group);
        let after = raised.map_or(0, |above| 2 * self.rank(above) + 1);
        Place(((2 * own).max(after) * self.0.len() + own) as u8)
    }

    /// What rows are raised above that belong to two.
    pub(crate) fn higher(self, a: Option<RowGroup>, b: Option<RowGroup>) -> Option<RowGroup> {
        [a, b].into_iter().flatten().max_by_key(|group| self.rank(*group))
    }

    /// Whether each group stands in it once.
    pub(crate) fn is_complete(self) -> bool {
        Order::default().0.iter().all(|group| self.0.contains(group))
    }

    fn rank(self, group: RowGroup) -> usize {
        self.0.iter().position(|&g| g == group).unwrap_or(0)
    }
}
