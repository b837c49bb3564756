//! Islands: which bodies are connected, and which of these groups fall asleep.
//!
//! Islands are the trees of a disjoint-set forest over the awake bodies, joined by touching contacts and by
//! joints (path halving and union by index: the lowest index of an island is its root, so that nothing
//! depends on the order of unions). They are searched for only when some body has been at rest for long
//! enough, and then not in every step.

use super::{Islands, NONE, Sleep};
use crate::body::{Bodies, BodyKind};
use crate::broad_phase::Pair;
use crate::config::Settings;
use crate::events::Events;
use crate::joint::Joints;
use crate::memory::{Allowance, buffers};
use crate::narrow_phase::{Contacts, NO_CONTACT};
use crate::shape::ColliderSummary;
use crate::threads::{Shared, Workers, per_block};
use glam::Vec3;
use std::sync::atomic::{AtomicBool, Ordering};

/// Steps between two searches for islands while bodies at rest are connected to others that are not.
const PATIENCE: u32 = 8;
/// Bodies in a block of work.
const BLOCK: usize = per_block(512, 1);

/// A disjoint-set forest over awake dynamic bodies.
#[derive(Debug, Default)]
pub(crate) struct Groups {
    parent: Vec<u32>,
    /// For each root: how long all of its island has been at rest [s].
    rest: Vec<f32>,
    /// For each root: the sleeping island that it becomes.
    island: Vec<u32>,
}

/// The edges of islands: touching pairs, and joints.
#[derive(Clone, Copy)]
pub(crate) struct Ties<'a> {
    pub(crate) bodies: &'a Bodies,
    pub(crate) summaries: &'a [ColliderSummary],
    pub(crate) pairs: &'a [Pair],
    pub(crate) contacts: &'a Contacts,
    pub(crate) joints: &'a Joints,
    /// Separation up to which a contact touches [m].
    pub(crate) touching: f32,
}

/// How long bodies count as having been at rest.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum RestTime {
    /// As long as they were.
    Measured,
    /// For ever, if they may sleep: their island falls asleep at once.
    Endless,
}

buffers! { Groups { each(dynamic: usize) { parent(dynamic), rest(dynamic), island(dynamic) } } }

impl Groups {
    fn root(&mut self, mut i: u32) -> u32 {
        while self.parent[i as usize] != i {
            let grandparent = self.parent[self.parent[i as usize] as usize];
            self.parent[i as usize] = grandparent;
            i = grandparent;
        }
        i
    }

    fn join(&mut self, i: u32, k: u32) {
        let (i, k) = (self.root(i), self.root(k));
        self.parent[i.max(k) as usize] = i.min(k);
    }

    /// Finds the islands of all awake bodies.
    fn find(&mut self, ties: &Ties<'_>, rest: RestTime) {
        let Ties { bodies, summaries, pairs, contacts, joints, touching } = *ties;
        let (dynamic, movers) = (bodies.dynamic() as u32, bodies.movers() as u32);
        self.parent.clear();
        self.parent.extend(0..dynamic);
        self.rest.clear();
        // If sleeping is off, there are none.
        self.rest.extend((0..dynamic as usize).map(|i| bodies.rest.get(i).copied().unwrap_or(0.0)));
        for (i, time) in self.rest.iter_mut().enumerate() {
            if bodies.traits[i].sleepless {
                *time = 0.0;
            } else if rest == RestTime::Endless {
                *time = f32::MAX;
            }
        }
        let link = |this: &mut Groups, i: u32, k: u32| {
            let (i, k) = (i.min(k), i.max(k));
            if k < dynamic {
                this.join(i, k);
            } else if i < dynamic && k < movers {
                // A body carried by a kinematic one is at rest as long as that is.
                let rest = &mut this.rest[i as usize];
                *rest = rest.min(bodies.rest.get(k as usize).copied().unwrap_or(0.0));
            }
        };
        for pair in pairs.iter().filter(|pair| pair.contact != NO_CONTACT || pair.touching) {
            if pair.touching || touches(contacts, pair, touching) {
                link(self, summaries[pair.a as usize].body, summaries[pair.b as usize].body);
            }
        }
        if joints.count > 0 {
            for joint in joints.all.iter().filter(|joint| joint.is_there()) {
                let [a, b] = joint.bodies.map(|slot| bodies.slots.dense(slot));
                link(self, a, b);
            }
            for (_, coupling) in joints.couplings.live() {
                let [one, other] = coupling.joints().map(|joint| joints.all[joint as usize].bodies);
                let dense = |slot: u32| bodies.slots.dense(slot);
                one.into_iter().for_each(|a| {
                    other.into_iter().for_each(|b| link(self, dense(a), dense(b)));
                });
            }
        }
        for i in 0..dynamic {
            let root = self.root(i);
            self.parent[i as usize] = root;
            let least = self.rest[root as usize].min(self.rest[i as usize]);
            self.rest[root as usize] = least;
        }
    }

    /// The root of a body's island, as of the last search.
    fn of(&self, i: u32) -> u32 {
        self.parent[i as usize]
    }
}

/// Whether a pair touches, or pushed within the step.
pub(super) fn touches(contacts: &Contacts, pair: &Pair, real: f32) -> bool {
    contacts.chain(pair.contact).any(|(_, contact)| contact.touches(real))
}

/// Counts how long bodies have been at rest. Returns whether a dynamic one has been for long enough to fall
/// asleep.
pub(crate) fn count_rest(
    workers: &Workers<'_>,
    bodies: &mut Bodies,
    summaries: &[ColliderSummary],
    settings: &Settings,
    dt: f32,
) -> bool {
    let (dynamic, movers) = (bodies.dynamic(), bodies.movers());
    let (speed, time) = (settings.sleep_speed * settings.length_unit, settings.sleep_time);
    let tired = AtomicBool::new(false);
    let rest = Shared::new(&mut bodies.rest);
    let (velocity, colliders) = (&bodies.velocity, &bodies.colliders);
    workers.run(movers.div_ceil(BLOCK), &|block| {
        for i in block * BLOCK..((block + 1) * BLOCK).min(movers) {
            let v = &velocity[i];
            let still = if i < dynamic {
                let reach =
                    |r: f32, &c: &u32| r.max(summaries[c as usize].lever + summaries[c as usize].radius);
                let arm = colliders[i].as_slice().iter().fold(0.0, reach);
                v.linear.length().max(v.angular.length() * arm) < speed
            } else {
                v.linear == Vec3::ZERO && v.angular == Vec3::ZERO
            };
            // SAFETY: each body is in one block.
            let rest = unsafe { rest.get(i) };
            *rest = if still { *rest + dt } else { 0.0 };
            if i < dynamic && *rest >= time {
                tired.store(true, Ordering::Relaxed);
            }
        }
    });
    tired.into_inner()
}

impl Sleep {
    /// Whether it is time to search for islands, given that some body is ready to sleep. Counts the steps in
    /// between.
    pub(crate) fn is_due(&mut self, tired: bool) -> bool {
        self.waited += 1;
        let due = tired && self.waited >= PATIENCE;
        if due {
            self.waited = 0;
        }
        due
    }

    /// For each body, the number of a dynamic body's island, for display; `u32::MAX` for other bodies.
    pub(crate) fn numbers(&self, ties: &Ties<'_>) -> Vec<u32> {
        let (mut groups, bodies) = (Groups::default(), ties.bodies);
        groups.find(ties, RestTime::Measured);
        let slot_of = |i: usize| {
            if i < bodies.dynamic() {
                return bodies.slot[groups.of(i as u32) as usize];
            }
            // A sleeping island is named by the first of its bodies.
            let sleeper = bodies.asleep().contains(&i);
            sleeper.then(|| self.first_of(bodies.slot[i])).flatten().unwrap_or(NONE)
        };
        (0..bodies.len()).map(slot_of).collect()
    }
}

impl Islands<'_> {
    /// Puts the islands of the last search to sleep, if all of their bodies have been at rest for so long
    /// [s].
    pub(crate) fn send_tired(&mut self, time: f32, events: &mut Events, allowance: Allowance) {
        self.sleep(|_, rest| rest >= time, events, allowance);
    }

    /// Puts the island of an awake dynamic body to sleep, if all of it may. Islands must have been found with
    /// [`RestTime::Endless`].
    pub(crate) fn send(&mut self, index: u32, events: &mut Events, allowance: Allowance) {
        let root = self.sleep.groups.of(index);
        self.sleep(|island, rest| island == root && rest > 0.0, events, allowance);
    }

    /// Finds the islands of all awake bodies.
    pub(crate) fn find(&mut self, rest: RestTime) {
        let touching = self.measures.touch;
        let Islands { bodies, colliders, broad, contacts, joints, sleep, .. } = self;
        let (summaries, pairs) = (&colliders.summaries, &broad.pairs);
        sleep.groups.find(&Ties { bodies, summaries, pairs, contacts, joints, touching }, rest);
    }

    /// Puts islands to sleep for which `tired` returns true, by their root and how long all of them have been
    /// at rest. `allowance`: bytes that the pairs that they keep may take.
    fn sleep(&mut self, tired: impl Fn(u32, f32) -> bool, events: &mut Events, mut allowance: Allowance) {
        let Islands { bodies, colliders, broad, contacts, sleep, .. } = &mut *self;
        let (dynamic, movers) = (bodies.dynamic() as u32, bodies.movers() as u32);
        let is_tired = |sleep: &Sleep, i: u32| {
            let root = sleep.groups.of(i);
            tired(root, sleep.groups.rest[root as usize])
        };
        if !(0..dynamic).any(|i| is_tired(sleep, i)) {
            return;
        }
        let senses =
            |pair: &Pair| [pair.a, pair.b].iter().any(|&c| colliders.summaries[c as usize].is_sensor());
        let fate = |sleep: &Sleep, pair: &Pair| {
            let [a, b] = [pair.a, pair.b].map(|c| colliders.summaries[c as usize].body);
            let (i, k) = (a.min(b), a.max(b));
            let (of_i, of_k) = (i < dynamic && is_tired(sleep, i), k < dynamic && is_tired(sleep, k));
            match (of_i, of_k) {
                (true, true) if sleep.groups.of(i) == sleep.groups.of(k) => Fate::Sleeps(sleep.groups.of(i)),
                (true, true) => Fate::Dropped,
                (true, false) if k >= movers && bodies.kind[k as usize] == BodyKind::Static => {
                    Fate::Sleeps(sleep.groups.of(i))
                }
                // A sensor keeps its pair with a shape in it while both sleep.
                (true, false) if k >= movers && !(pair.touching && senses(pair)) => Fate::Dropped,
                _ => Fate::Stays,
            }
        };
        if !allowance.is_endless() {
            let sleeping = broad.pairs.iter().filter(|pair| matches!(fate(sleep, pair), Fate::Sleeps(_)));
            let wanted = sleep.pair_count as usize + sleeping.count();
            if allowance.fit(&mut sleep.pairs, wanted) < wanted {
                return;
            }
        }
        sleep.groups.island.clear();
        sleep.groups.island.resize(dynamic as usize, NONE);
        for root in 0..dynamic {
            if sleep.groups.of(root) == root && is_tired(sleep, root) {
                sleep.groups.island[root as usize] = sleep.open();
            }
        }
        broad.take_pairs(|pair| match fate(sleep, pair) {
            Fate::Stays => None,
            Fate::Sleeps(root) => {
                sleep.add_pair(sleep.groups.island[root as usize], *pair);
                Some(true)
            }
            Fate::Dropped => {
                events.part(colliders, pair);
                contacts.remove_chain(pair.contact);
                Some(false)
            }
        });
        self.lay_down(dynamic);
    }

    /// Takes the bodies of the islands that sleep now to the others that do.
    fn lay_down(&mut self, dynamic: u32) {
        let Islands { bodies, colliders, joints, sleep, .. } = self;
        // From the end, so that the body that moves to a freed place is one that stays awake.
        for i in (0..dynamic).rev() {
            let island = sleep.groups.island[sleep.groups.of(i) as usize];
            if island == NONE {
                continue;
            }
            let slot = bodies.slot[i as usize];
            sleep.add_body(island, slot);
            joints.changed |= joints.has_any(slot);
            sleep.slept += 1;
            sleep.fell_asleep.push(bodies.handle(i as usize));
            let index = bodies.sleep(i, colliders);
            bodies.rest[index] = 0.0;
        }
    }
}

/// Where a pair goes when islands fall asleep.
enum Fate {
    Stays,
    /// It sleeps with the island of a root.
    Sleeps(u32),
    /// It is dropped: its two islands don't touch, and the next one that wakes finds it again.
    Dropped,
}
