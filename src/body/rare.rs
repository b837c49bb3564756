//! Rare fields of bodies, by slot: a body without them pays nothing, neither in bytes nor in a step.

use super::targets::Target;
use crate::lanes::Record;
use crate::memory::{Buffer, List, buffers, bytes_of};
use glam::Vec3;

/// Rates at which a dynamic body loses velocity [1/s].
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(crate) struct Damping {
    pub(crate) linear: f32,
    pub(crate) angular: f32,
}

/// Greatest speeds of a dynamic body [m/s], [rad/s]; infinite if there is none.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct SpeedCap {
    pub(crate) linear: f32,
    pub(crate) angular: f32,
}

impl SpeedCap {
    pub(crate) const NONE: SpeedCap = SpeedCap { linear: f32::INFINITY, angular: f32::INFINITY };

    pub(crate) fn new(linear: Option<f32>, angular: Option<f32>) -> SpeedCap {
        SpeedCap { linear: linear.unwrap_or(f32::INFINITY), angular: angular.unwrap_or(f32::INFINITY) }
    }

    /// As the caller gives them.
    pub(crate) fn limits(self) -> [Option<f32>; 2] {
        [self.linear, self.angular].map(|cap| Some(cap).filter(|cap| cap.is_finite()))
    }

    /// The velocity that is left of one.
    pub(crate) fn hold(self, mut velocity: Record) -> Record {
        velocity.linear = shortened(velocity.linear, self.linear);
        velocity.angular = shortened(velocity.angular, self.angular);
        velocity
    }
}

/// A vector no longer than `most`.
fn shortened(v: Vec3, most: f32) -> Vec3 {
    let length = v.length();
    // Rounding: the product would be longer than the cap by as much.
    if length > most { v * (most / length * (1.0 - 4.0 * f32::EPSILON)) } else { v }
}

/// Mass of a body that is not dynamic, and its principal moments: given by the caller, for the time when the
/// body becomes dynamic.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct KeptMass {
    pub(crate) mass: f32,
    pub(crate) moments: Vec3,
}

/// Entries by body slot, sorted.
#[derive(Debug)]
pub(crate) struct BySlot<T>(Vec<(u32, T)>);

impl<T> Default for BySlot<T> {
    fn default() -> Self {
        BySlot(Vec::new())
    }
}

impl<T: Copy> BySlot<T> {
    pub(crate) fn get(&self, slot: u32) -> Option<T> {
        self.find(slot).ok().map(|place| self.0[place].1)
    }

    /// Sets or removes the entry of a slot.
    pub(crate) fn set(&mut self, slot: u32, entry: Option<T>) {
        match (self.find(slot), entry) {
            (Ok(place), Some(entry)) => self.0[place].1 = entry,
            (Ok(place), None) => drop(self.0.remove(place)),
            (Err(place), Some(entry)) => self.0.insert(place, (slot, entry)),
            (Err(_), None) => {}
        }
    }

    pub(crate) fn iter(&self) -> impl ExactSizeIterator<Item = (u32, T)> + '_ {
        self.0.iter().copied()
    }

    pub(crate) fn len(&self) -> usize {
        self.0.len()
    }

    pub(crate) fn clear(&mut self) {
        self.0.clear();
    }

    /// Keeps the entries for which `keep` returns true; it may change them.
    pub(crate) fn retain(&mut self, mut keep: impl FnMut(u32, &mut T) -> bool) {
        self.0.retain_mut(|(slot, entry)| keep(*slot, entry));
    }

    fn find(&self, slot: u32) -> Result<usize, usize> {
        // Most come in the order of their slots.
        if self.0.last().is_none_or(|last| last.0 < slot) {
            return Err(self.0.len());
        }
        self.0.binary_search_by_key(&slot, |entry| entry.0)
    }
}

impl<T> List for BySlot<T> {
    fn bytes(&self) -> (usize, usize) {
        bytes_of(&self.0)
    }
    fn each(&mut self, len: usize, f: &mut dyn FnMut(&mut dyn Buffer, usize)) {
        f(&mut self.0, len);
    }
}

/// Rare fields of a body.
#[derive(Debug, Default)]
pub(crate) struct RareColumns {
    pub(crate) damping: BySlot<Damping>,
    pub(crate) caps: BySlot<SpeedCap>,
    pub(crate) kept_mass: BySlot<KeptMass>,
    pub(crate) targets: BySlot<Target>,
}

/// How many bodies have each.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct RareCounts {
    pub(crate) damped: usize,
    pub(crate) capped: usize,
    pub(crate) kept_masses: usize,
    pub(crate) targets: usize,
}

buffers! {
    RareColumns {
        each(n: RareCounts) {
            damping(n.damped), caps(n.capped), kept_mass(n.kept_masses), targets(n.targets)
        }
    }
}

impl RareColumns {
    pub(crate) fn counts(&self) -> RareCounts {
        RareCounts {
            damped: self.damping.len(),
            capped: self.caps.len(),
            kept_masses: self.kept_mass.len(),
            targets: self.targets.len(),
        }
    }

    pub(crate) fn damping(&self, slot: u32) -> Damping {
        self.damping.get(slot).unwrap_or_default()
    }

    pub(crate) fn set_damping(&mut self, slot: u32, damping: Damping) {
        self.damping.set(slot, Some(damping).filter(|damping| *damping != Damping::default()));
    }

    pub(crate) fn cap(&self, slot: u32) -> SpeedCap {
        self.caps.get(slot).unwrap_or(SpeedCap::NONE)
    }

    pub(crate) fn set_cap(&mut self, slot: u32, cap: SpeedCap) {
        self.caps.set(slot, Some(cap).filter(|cap| *cap != SpeedCap::NONE));
    }

    /// The body in a slot is gone.
    pub(super) fn forget(&mut self, slot: u32) {
        self.damping.set(slot, None);
        self.caps.set(slot, None);
        self.kept_mass.set(slot, None);
        self.targets.set(slot, None);
    }

    pub(super) fn clear(&mut self) {
        self.damping.clear();
        self.caps.clear();
        self.kept_mass.clear();
        self.targets.clear();
    }
}

impl std::ops::Add for RareCounts {
    type Output = RareCounts;

    fn add(self, more: RareCounts) -> RareCounts {
        RareCounts {
            damped: self.damped + more.damped,
            capped: self.capped + more.capped,
            kept_masses: self.kept_masses + more.kept_masses,
            targets: self.targets + more.targets,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn entries_are_found_by_slot_in_whatever_order_they_come() {
        let mut entries = BySlot::default();
        for slot in [7u32, 3, 9, 1] {
            entries.set(slot, Some(slot * 10));
        }
        entries.set(3, None);
        entries.set(8, None);
        entries.set(9, Some(5));
        assert_eq!(entries.iter().collect::<Vec<_>>(), [(1, 10), (7, 70), (9, 5)]);
        assert_eq!([0, 3, 7, 10].map(|slot| entries.get(slot)), [None, None, Some(70), None]);
    }
}
