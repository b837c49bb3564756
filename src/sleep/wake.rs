//! Waking of islands.
//!
//! An island wakes before the solver sees the body that reaches it: when a dynamic or kinematic body moves so
//! near within the step that their boxes meet, or when a body at rest touches it. It also wakes when the
//! caller changes anything about one of its bodies, their joints, or bodies that they touch.

use super::islands::touches;
use super::{Islands, Sleep};
use crate::broad_phase::{Aabb, Pair, aabb_of};
use crate::lanes::Record;
use crate::narrow_phase::NO_CONTACT;
use glam::Vec3;

impl Islands<'_> {
    /// Wakes the islands that something reaches within the step; returns whether there were any. Pairs and
    /// `motion`, predicted for each movable body, must be those of the step.
    pub(crate) fn wake_what_is_reached(&mut self, motion: &[Record]) -> bool {
        if self.sleep.count() == 0 {
            return false;
        }
        let mut waking = self.islands_to_wake();
        let asleep = self.bodies.asleep();
        for pair in &self.broad.pairs {
            let [a, b] = [pair.a, pair.b].map(|c| self.colliders.summaries[c as usize].body as usize);
            let (sleeper, comer) = match (asleep.contains(&a), asleep.contains(&b)) {
                (true, false) => (pair.a, pair.b),
                (false, true) => (pair.b, pair.a),
                _ => continue,
            };
            let sensor = |c: u32| self.colliders.summaries[c as usize].is_sensor();
            let body = self.colliders.summaries[sleeper as usize].body as usize;
            // Bodies that are frozen for this step only are in no island.
            let Some(island) = self.sleep.island_of(self.bodies.slot[body]) else { continue };
            if !(sensor(comer) || sensor(sleeper)) && self.reaches(comer, sleeper, pair, motion) {
                Sleep::note(&mut waking, island);
            }
        }
        // Bodies that a kinematic body drags along.
        for i in self.bodies.dynamic()..self.bodies.movers() {
            if self.bodies.rest[i] == 0.0 && self.joints.count > 0 {
                self.note_joined(self.bodies.slot[i], &mut waking);
            }
        }
        let any = !waking.is_empty();
        self.wake_all_of(waking);
        any
    }

    /// Whether a collider of an awake moving body gets so near to a sleeping one within the step that their
    /// boxes meet; or, of a body at rest, touches it.
    fn reaches(&self, comer: u32, sleeper: u32, pair: &Pair, motion: &[Record]) -> bool {
        let real = self.measures.touch;
        let body = self.colliders.summaries[comer as usize].body as usize;
        let (bodies, colliders) = (&*self.bodies, &self.colliders.all);
        if bodies.rest[body] > 0.0 {
            return body < bodies.dynamic()
                && pair.contact != NO_CONTACT
                && touches(self.contacts, pair, real);
        }
        let bounds = |c: u32| {
            let collider = &colliders[c as usize];
            let pose = &bodies.pose[collider.body as usize];
            aabb_of(collider, pose.position, pose.rotation)
        };
        let (motion, from) = (&motion[body], bounds(comer));
        let collider = &colliders[comer as usize];
        let turned = motion.turn_angle * (collider.position.length() + collider.radius);
        let reach = Vec3::splat(turned + real);
        let swept = Aabb {
            min: from.min + motion.linear.min(Vec3::ZERO) - reach,
            max: from.max + motion.linear.max(Vec3::ZERO) + reach,
        };
        swept.overlaps(&bounds(sleeper))
    }

    /// Wakes a body with its island, if it sleeps, and marks it as moving. Returns its new index.
    pub(crate) fn wake_body(&mut self, index: usize) -> usize {
        let slot = self.bodies.slot[index];
        if let Some(rest) = self.bodies.rest.get_mut(index) {
            *rest = 0.0;
        }
        if let Some(island) = self.sleep.island_of(slot) {
            self.wake_island(island);
        }
        self.bodies.slots.dense(slot) as usize
    }

    /// Wakes a body and all others that it touches or may touch, because something about it changed. Returns
    /// its new index.
    pub(crate) fn disturb(&mut self, index: usize) -> usize {
        let slot = self.bodies.slot[index];
        let index = self.wake_body(index);
        if self.bodies.sleepers() == 0 {
            return index;
        }
        let mut waking = self.islands_to_wake();
        let summaries = &self.colliders.summaries;
        let own = |c: u32| summaries[c as usize].body as usize == index;
        let island_of = |c: u32| self.sleep.island_of(self.bodies.slot[summaries[c as usize].body as usize]);
        let sleeping = self.sleep.sleeping_pairs();
        for pair in self.broad.pairs.iter().chain(sleeping) {
            if own(pair.a) || own(pair.b) {
                let islands = island_of(pair.a).into_iter().chain(island_of(pair.b));
                islands.for_each(|island| Sleep::note(&mut waking, island));
            }
        }
        self.note_joined(slot, &mut waking);
        self.wake_all_of(waking);
        self.bodies.slots.dense(slot) as usize
    }

    /// Wakes all bodies whose boxes overlap a new one.
    pub(crate) fn disturb_box(&mut self, bounds: &Aabb) {
        if self.bodies.sleepers() == 0 {
            return;
        }
        let mut waking = self.islands_to_wake();
        for i in self.bodies.asleep() {
            let pose = &self.bodies.pose[i];
            let meets = self.bodies.colliders[i].as_slice().iter().any(|&c| {
                let collider = &self.colliders.all[c as usize];
                aabb_of(collider, pose.position, pose.rotation).overlaps(bounds)
            });
            if meets {
                let island = self.sleep.island_of(self.bodies.slot[i]);
                island.into_iter().for_each(|island| Sleep::note(&mut waking, island));
            }
        }
        self.wake_all_of(waking);
    }

    /// Wakes all bodies.
    pub(crate) fn wake_all(&mut self) {
        let mut waking = self.islands_to_wake();
        let islands = self.bodies.asleep().filter_map(|i| self.sleep.island_of(self.bodies.slot[i]));
        islands.for_each(|island| Sleep::note(&mut waking, island));
        self.wake_all_of(waking);
    }

    /// An empty list of islands, for [`Islands::wake_all_of`].
    fn islands_to_wake(&mut self) -> Vec<u32> {
        let mut waking = std::mem::take(&mut self.sleep.waking);
        waking.clear();
        waking
    }

    /// Adds the islands of a body and of those that it is joined to.
    fn note_joined(&self, slot: u32, waking: &mut Vec<u32>) {
        let bodies = self.joints.of_body(slot).flat_map(|joint| self.joints.all[joint as usize].bodies);
        let islands = bodies.filter_map(|slot| self.sleep.island_of(slot));
        islands.for_each(|island| Sleep::note(waking, island));
    }

    fn wake_all_of(&mut self, mut waking: Vec<u32>) {
        waking.sort_unstable();
        waking.dedup();
        waking.iter().for_each(|&island| self.wake_island(island));
        self.sleep.waking = waking;
    }

    fn wake_island(&mut self, island: u32) {
        let Islands { bodies, colliders, broad, sleep, joints, .. } = self;
        let mut woke = 0;
        let body = |slot: u32| {
            let index = bodies.wake(bodies.slots.dense(slot), colliders);
            bodies.rest[index as usize] = 0.0;
            woke += 1;
            joints.changed |= joints.has_any(slot);
            // Pairs with other sleeping bodies were not kept.
            bodies.colliders[index as usize].as_slice().iter().for_each(|&c| broad.look_again(c));
        };
        sleep.take_bodies(island, body);
        sleep.close(island, |pair| broad.put_back(pair));
        sleep.woke += woke;
    }
}
