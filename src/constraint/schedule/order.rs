//! The groups of contact rows, and the stages that a schedule of them has.

pub(crate) use crate::config::Place;
use crate::config::RowGroup;

/// Rows of contacts of one type and importance. Groups are solved in this order, so the last is obeyed best.
///
/// Friction comes before the normal rows of its own contact, and contacts with static geometry come last: a
/// body pushed into another can be pushed out again in the next step, a body pushed through the floor is
/// lost. After Vincent Robert's talk (Ubisoft, GDC 2012).
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
