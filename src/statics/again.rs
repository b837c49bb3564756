//! Contacts to be weighed again when a collider is removed: bodies that rested on it, and all that bear these
//! or bore it.

use super::Statics;
use crate::body::{Bodies, Colliders};
use crate::broad_phase::{BroadPhase, Pair, Places};
use crate::config::tuning::STEEPEST_SUPPORT;
use crate::narrow_phase::{ContactRef, Contacts, NO_CONTACT};
use glam::Vec3;

/// The world once the pairs of a collider are out of the list.
pub(crate) struct Remains<'a> {
    pub(crate) bodies: &'a Bodies,
    pub(crate) colliders: &'a Colliders,
    pub(crate) broad: &'a BroadPhase,
    /// Those of the pairs that are gone are still among them.
    pub(crate) contacts: &'a mut Contacts,
    pub(crate) gravity: Vec3,
}

impl Statics {
    /// Makes loads unknown that a collider's going changes, so that the next step estimates them. `gone`: its
    /// pairs.
    ///
    /// If nothing rested on it none do: without its weight, lasting forces below it are cut to the actual
    /// loads. A contact whose load is unknown already ends the search, so that many removals before a step
    /// take no longer than one, beside their own pairs.
    pub(crate) fn weigh_again(&mut self, remains: &mut Remains<'_>, collider: u32, gone: &[Pair]) {
        let own = remains.colliders.all[collider as usize].body;
        let reached = &mut self.by_height;
        reached.clear();
        let mut bore = false;
        for pair in gone {
            for [upper, lower] in remains.contacts.chain(pair.contact).filter_map(|(_, c)| remains.weighed(c))
            {
                bore |= lower == own;
                remains.list(if lower == own { upper } else { lower }, reached);
            }
        }
        if !bore {
            return;
        }
        while let Some(body) = reached.pop() {
            remains.forget_below(body, reached);
        }
        (self.pending, self.wait) = (true, 0);
    }
}

impl Remains<'_> {
    /// The upper and the lower body of a contact with a load by statics.
    fn weighed(&self, contact: ContactRef<'_>) -> Option<[u32; 2]> {
        let down = (contact.frame * contact.normal).dot(self.gravity.normalize_or_zero());
        let [a, b] = [contact.a, contact.b].map(|c| self.colliders.all[c as usize].body);
        let bodies = if down > 0.0 { [a, b] } else { [b, a] };
        (contact.static_load > 0.0 && down.abs() >= STEEPEST_SUPPORT).then_some(bodies)
    }

    /// Lists a dynamic body, once: so there is room.
    fn list(&self, body: u32, reached: &mut Vec<u32>) {
        if (body as usize) < self.bodies.dynamic() && !reached.contains(&body) {
            reached.push(body);
        }
    }

    /// Makes the loads of the contacts below a body unknown, and lists the bodies under them.
    fn forget_below(&mut self, body: u32, reached: &mut Vec<u32>) {
        let all = &self.broad.pairs;
        let places = self.broad.places_of(self.bodies.colliders[body as usize].as_slice());
        let rest = if places.is_none() { all.as_slice() } else { &[] };
        for pair in places.into_iter().flat_map(Places::into_iter).map(|place| &all[place]).chain(rest) {
            let mut next = pair.contact;
            while next != NO_CONTACT {
                let (slot, contact) = (next, self.contacts.at(next));
                next = contact.next;
                if let Some([_, lower]) = self.weighed(contact).filter(|[upper, _]| *upper == body) {
                    self.contacts.at_mut(slot).forget_weight();
                    self.list(lower, reached);
                }
            }
        }
    }
}
