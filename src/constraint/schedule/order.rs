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

/// Rows of contacts of one type and importance. Groups are solved in this order, so the last is obeyed best.
///
/// Friction comes before the normal rows of its own contact, and what keeps bodies out of the static world
/// comes last: a body pushed into another can be pushed out again in the next step, a body pushed through the
/// floor is lost. After Vincent Robert's talk (Ubisoft, GDC 2012).
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
#[repr(u8)]
pub(crate) enum Group {
    /// Touching bodies that both can move.
    Dynamic,
    /// Bodies that both can move and may meet within the step.
    PotentialDynamic,
    /// A body that touches static geometry.
    Static,
    /// A body that may reach static geometry within the step.
    PotentialStatic,
}

impl Group {
    pub(crate) const ALL: [Group; 4] =
        [Group::Dynamic, Group::PotentialDynamic, Group::Static, Group::PotentialStatic];

    pub(crate) fn of(is_static: bool, is_potential: bool) -> Group {
        Group::ALL[usize::from(is_static) * 2 + usize::from(is_potential)]
    }

    /// Its name in an [`Order`].
    pub(crate) fn named(self) -> RowGroup {
        match self {
            Group::Dynamic => RowGroup::Contacts,
            Group::PotentialDynamic => RowGroup::PotentialContacts,
            Group::Static => RowGroup::StaticContacts,
            Group::PotentialStatic => RowGroup::PotentialStaticContacts,
        }
    }

    /// Whether body `b` of its rows can't be moved by them and needs no record.
    pub(crate) fn is_static(self) -> bool {
        self >= Group::Static
    }

    /// Whether its rows have no friction and no restitution.
    pub(crate) fn is_potential(self) -> bool {
        matches!(self, Group::PotentialDynamic | Group::PotentialStatic)
    }
}

/// Batches that may be solved at the same time: one colour of one group.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Stage {
    pub(crate) group: Group,
    pub(crate) place: Place,
    /// Range in the schedule.
    pub(crate) start: u32,
    pub(crate) end: u32,
    /// Contacts that found no colour: one lane, one after another.
    pub(crate) serial: bool,
}
