//! Memory for restoring a snapshot, requested from the budget before anything changes.

use super::budget::{Counts, check, list_bytes};
use crate::body::{BodyKind, Damping, NewBody, RareCounts, SpeedCap};
use crate::broad_phase::PairLists;
use crate::config::Settings;
use crate::constraint::WIDEST_JOINT_BATCH;
use crate::error::Error;
use crate::events::Events;
use crate::joint::JointRecords;
use crate::memory::{Amounts, Buffer, Category};
use crate::narrow_phase::{ContactCount, Contacts};
use crate::shape::{Geometry, Kind, RARE};
use crate::world::{Assets, Buffers, World};
use std::mem::swap;

/// Buffers that a step makes again, or a snapshot brings as a whole: events, contacts, pairs, and buffers of
/// steps but for those of joints, which may be arranged already.
#[derive(Default)]
struct Passing {
    buffers: Buffers,
    contacts: Contacts,
    pairs: PairLists,
    events: Events,
}

impl Passing {
    fn swap(&mut self, world: &mut World) {
        swap(&mut self.buffers, &mut world.buffers);
        swap(&mut self.buffers.joints, &mut world.buffers.joints);
        swap(&mut self.buffers.dt, &mut world.buffers.dt);
        swap(&mut self.contacts, &mut world.contacts);
        world.broad.swap_pairs(&mut self.pairs);
        swap(&mut self.events, &mut world.events);
    }
}

/// The bodies and joints that replace those of a world.
pub(crate) struct Replacement<'a> {
    counts: Counts,
    joints: &'a JointRecords,
    /// Bytes that their rows held or were promised, if that is known.
    joint_rows: Option<usize>,
}

/// The content of a snapshot.
pub(crate) struct Brings<'a> {
    pub(crate) settings: &'a Settings,
    pub(crate) pairs: usize,
    /// Number of those pairs that sleeping islands keep.
    pub(crate) sleeping_pairs: usize,
    pub(crate) contacts: ContactCount,
    /// Whether any shape resists rolling.
    pub(crate) rolling: bool,
    pub(crate) forced: bool,
    /// Number of kinematic bodies that are to be somewhere after the next step.
    pub(crate) targets: usize,
    /// Bodies that the guard checked; some may have been disabled since.
    pub(crate) guarded: usize,
    /// Slots of characters.
    pub(crate) characters: usize,
    /// Bytes of their hulls, as far as neither the world nor `new` has them.
    pub(crate) forms: Amounts,
    pub(crate) rests: bool,
    /// Whether it did not fit in the budget when it was taken.
    pub(crate) over_budget: bool,
    /// `None` if bodies, shapes and joints stay as they are.
    pub(crate) new: Option<Replacement<'a>>,
}

impl<'a> Replacement<'a> {
    /// `slots`: numbers of slots of bodies and of shapes.
    pub(crate) fn new(
        bodies: usize,
        shapes: usize,
        joints: &'a JointRecords,
        joint_rows: Option<usize>,
        geometry: impl Iterator<Item = &'a Geometry>,
    ) -> Replacement<'a> {
        let (once, assets) = Assets::default().cost(geometry);
        let mut counts = Counts { bodies, joined: joints.any(), once, assets, ..Counts::default() };
        counts.colliders.slots = shapes;
        Replacement { counts, joints, joint_rows }
    }

    /// A body with shapes of these kinds and flags.
    pub(crate) fn add(&mut self, body: &NewBody, shapes: impl Iterator<Item = (Kind, u8)>) {
        let (counts, kind, traits) = (&mut self.counts, body.kind, &body.traits);
        let rare = RareCounts {
            damped: usize::from(body.damping != Damping::default()),
            capped: usize::from(body.cap != SpeedCap::NONE),
            kept_masses: usize::from(body.kept_mass.is_some()),
            targets: 0,
        };
        counts.rare = counts.rare + rare;
        counts.movers += usize::from(kind != BodyKind::Static);
        counts.solved_after |= traits.solved_after.is_some();
        counts.dynamic += usize::from(kind == BodyKind::Dynamic && !traits.disabled);
        let (mut own, slots) = (0, counts.colliders.slots);
        for (shape, flags) in shapes {
            own += 1;
            counts.rare_materials |= flags & RARE != 0;
            if !traits.disabled {
                counts.add_collider(kind, shape);
            }
        }
        // They are included in the number of slots.
        counts.colliders.slots = slots;
        counts.once.add(Category::Bodies, list_bytes(0, own));
    }
}

impl World {
    /// Bytes of geometry that the world does not have yet.
    pub(crate) fn cost_of<'a>(&self, geometries: impl Iterator<Item = &'a Geometry>) -> Amounts {
        self.assets.cost(geometries).0
    }

    /// Whether more is held or promised than the budget allows, because it was lowered.
    pub(crate) fn is_over_budget(&self) -> bool {
        let budget = &self.settings.budget;
        if budget.is_none() {
            return false;
        }
        let mut held = self.memory();
        held.add(Category::Joints, (0, self.memory_promised()));
        let over = |limit: Option<usize>, held: usize| limit.is_some_and(|limit| held > limit);
        over(budget.limit(), held.total())
            || held.iter().any(|(category, bytes)| over(budget.limit_of(category), bytes.reserved))
    }

    /// Bytes that rows of joints hold or are promised.
    pub(crate) fn bytes_of_joint_rows(&self) -> usize {
        self.buffers.joints.arranged_bytes() + self.memory_promised()
    }

    /// Bytes beyond those that rows of joints hold that are to be promised to these joints, whose rows took
    /// or were promised `known` bytes.
    pub(crate) fn promised_to(&self, joints: &JointRecords, known: Option<usize>) -> usize {
        match known {
            Some(bytes) => {
                let most = joints.row_count() * WIDEST_JOINT_BATCH;
                bytes.min(most).saturating_sub(self.buffers.joints.arranged_bytes())
            }
            None => self.joints.rows_missing_for(joints) * WIDEST_JOINT_BATCH,
        }
    }

    /// Reserves memory for the content of a snapshot, as far as it is missing: in the world that took it
    /// nothing is, unless bodies, shapes or joints have changed since.
    ///
    /// # Errors
    /// If the budget does not allow it.
    pub(crate) fn reserve_to_restore(&mut self, brings: &Brings<'_>) -> Result<(), Error> {
        if self.settings.budget.is_none() {
            return Ok(());
        }
        let (mut asked, mut gone) = (Amounts::default(), Amounts::default());
        if let Some(new) = &brings.new {
            self.assets.bytes().for_each(|(category, (_, reserved))| gone.add(category, reserved));
            gone.add(Category::Bodies, self.bodies.list_bytes());
            asked += new.counts.once;
            let rows = self.promised_to(new.joints, new.joint_rows);
            asked.add(Category::Joints, rows.saturating_sub(self.memory_promised()));
        }
        asked += brings.forms;
        let mut anew = asked;
        asked.add(Category::BroadPhase, self.broad.missing(brings.pairs));
        self.each_restored(brings, &mut |category, buffer, len| asked.add(category, buffer.missing(len)));
        let allowed = check(&asked, &self.rooms_without(&self.settings.budget, &gone));
        if allowed.is_err() {
            let on = self.switched_on(brings);
            if on.rests || on.meets || on.forced || (on.settles && on.meshed) {
                // Asked for as it is when such settings are set.
                return allowed;
            }
            // Steps have grown into the memory that was free when the snapshot was taken. Buffers that
            // restoring and the next step make again are given up.
            let held = self.buffers_by_category().reserved();
            let mut passing = Passing::default();
            passing.swap(self);
            gone += held.without(&self.buffers_by_category().reserved());
            passing.swap(self);
            let room = self.rooms_without(&self.settings.budget, &gone);
            passing.swap(self);
            anew.add(Category::BroadPhase, self.broad.missing(brings.pairs));
            self.each_restored(brings, &mut |category, buffer, len| anew.add(category, buffer.missing(len)));
            let allowed = check(&anew, &room);
            // A rollback to the same bodies, shapes and joints is never refused.
            let same = brings.new.is_none() && brings.forms == Amounts::default();
            if allowed.is_err() && !same && !brings.over_budget {
                passing.swap(self);
                return allowed;
            }
        }
        self.each_restored(brings, &mut |_, buffer, len| buffer.reserve_total(len));
        self.broad.reserve_total(brings.pairs);
        Ok(())
    }

    /// The columns switched on by settings and forces that a snapshot brings and the world does not have.
    fn switched_on(&self, brings: &Brings<'_>) -> Counts {
        let now = self.counts(Counts::default());
        let Settings { sleeping, continuous_method, .. } = brings.settings;
        Counts {
            rests: (brings.rests || *sleeping) && !now.rests,
            meets: continuous_method.meets_impacts() && !now.meets,
            settles: continuous_method.settles() && !now.settles,
            forced: brings.forced && !now.forced,
            ..now
        }
    }

    /// Calls `f` with each buffer, its category, and the capacity that it needs.
    fn each_restored(&mut self, brings: &Brings<'_>, f: &mut dyn FnMut(Category, &mut dyn Buffer, usize)) {
        if let Some(new) = &brings.new {
            let Settings { sleeping, continuous_method, .. } = brings.settings;
            let (rests, forced) = (brings.rests || *sleeping, brings.forced);
            let (meets, settles) = (continuous_method.meets_impacts(), continuous_method.settles());
            let rare = RareCounts { targets: brings.targets, ..new.counts.rare };
            let once = Amounts::default();
            self.each_buffer(Counts { rests, meets, settles, forced, once, rare, ..new.counts }, f);
            self.joints.each(new.joints.more(), &mut |buffer, len| f(Category::Joints, buffer, len));
        } else {
            let on = self.switched_on(brings);
            if on.forced {
                f(Category::Bodies, &mut self.bodies.force, on.bodies);
            }
            let rare = RareCounts { targets: brings.targets, ..RareCounts::default() };
            self.bodies.rare.each(rare, &mut |buffer, len| f(Category::Bodies, buffer, len));
            self.each_of_switched(on, f);
        }
        self.contacts.each(brings.contacts, &mut |buffer, len| f(Category::Manifolds, buffer, len));
        if brings.rolling {
            f(Category::Manifolds, self.contacts.rolling_buffer(), brings.contacts.contacts);
        }
        f(Category::Scratch, &mut self.buffers.finish.clear, brings.guarded);
        f(Category::BroadPhase, self.sleep.pair_buffer(), brings.sleeping_pairs);
        f(Category::Bodies, self.character_buffer(), brings.characters);
        self.buffers.narrow.each(brings.pairs, &mut |buffer, len| f(Category::Scratch, buffer, len));
    }
}
