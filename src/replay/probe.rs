//! Hashes of the results of each stage of a step.

use super::hash::Hash;
use super::hooks::Decision;
use crate::lanes::Record;
use crate::world::World;
use serde::{Deserialize, Serialize};

/// A stage of a step, as docs/architecture.md has them.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum Stage {
    /// Before the step: a call was refused that was not refused when it was recorded.
    Calls,
    /// The input of the step: poses, velocities, masses, accelerations.
    Forces,
    /// Pairs.
    Broad,
    /// Contacts.
    Narrow,
    /// Decisions of hooks, restitution, and the number of rows of each type.
    Prepare,
    /// Velocities and displacements.
    Solve,
    /// Poses and velocities at the end, and which bodies fell asleep.
    Finish,
}

impl Stage {
    /// Those that are hashed.
    pub(super) const HASHED: [Stage; 6] =
        [Stage::Forces, Stage::Broad, Stage::Narrow, Stage::Prepare, Stage::Solve, Stage::Finish];

    /// In lower case, as JSON and messages have it.
    pub fn name(self) -> &'static str {
        match self {
            Stage::Calls => "calls",
            Stage::Forces => "forces",
            Stage::Broad => "broad",
            Stage::Narrow => "narrow",
            Stage::Prepare => "prepare",
            Stage::Solve => "solve",
            Stage::Finish => "finish",
        }
    }
}

/// A hash of a body. Two bytes are enough to find which body differs, once it is known that one does: one in
/// 65,536 differing bodies is overlooked.
pub(super) type Short = [u8; 2];

/// The record of a step.
#[derive(Clone, Debug, Serialize, Deserialize)]
pub(crate) struct StepRecord {
    /// Length of the step [s].
    pub(super) dt: f32,
    pub(super) decisions: Vec<Decision>,
    pub(super) stages: [[u8; 4]; Stage::HASHED.len()],
    /// `World::state_hash` after it.
    pub(super) hash: [u8; 8],
    /// Slots of bodies that the caller changed since the previous step, or that were added or woke, with
    /// hashes of their state at the start of the step.
    pub(super) touched: Vec<(u32, Short)>,
    /// Slots of all bodies that can move and are awake, as differences; none if they are those of the step
    /// before.
    pub(super) awake: Option<Vec<u32>>,
    /// A hash of each after the step.
    pub(super) bodies: Vec<Short>,
}

/// The hashes of the step.
#[derive(Debug, Default)]
pub(super) struct Seen {
    pub(super) stages: [[u8; 4]; Stage::HASHED.len()],
    pub(super) hash: [u8; 8],
    pub(super) touched: Vec<(u32, Short)>,
    /// Slots, ascending.
    pub(super) awake: Vec<u32>,
    /// Those of the previous step.
    pub(super) before: Vec<u32>,
    pub(super) bodies: Vec<Short>,
    /// Slots of bodies that calls changed since the step before.
    pub(super) changed: Vec<u32>,
}

impl Seen {
    /// Hashes the results of `stage`.
    pub(super) fn look(&mut self, world: &World, stage: Stage) {
        if stage == Stage::Forces {
            self.look_at_start(world);
        }
        let mut hash = Hash::new();
        match stage {
            Stage::Calls => return,
            Stage::Forces => forces(world, &mut hash),
            Stage::Broad => broad(world, &mut hash),
            Stage::Narrow => narrow(world, &mut hash),
            Stage::Prepare => prepare(world, &mut hash),
            Stage::Solve => solve(world, &mut hash),
            Stage::Finish => {
                self.look_at_end(world);
                hash.word(u64::from_le_bytes(self.hash));
                // Sleeping bodies come after awake ones. The order of static bodies, behind them, decides
                // nothing, and a restored world may have another.
                let order = &world.bodies.slot[..world.bodies.asleep().end];
                order.chunks(2).for_each(|s| hash.pair(s[0], s.get(1).copied().unwrap_or(0)));
                hash.pair(world.bodies.movers() as u32, world.bodies.asleep().end as u32);
            }
        }
        if let Some(at) = Stage::HASHED.iter().position(|&s| s == stage) {
            self.stages[at] = hash.middle().to_le_bytes();
        }
    }

    /// The world was restored: earlier observations do not apply.
    pub(super) fn restart(&mut self) {
        self.awake.clear();
        self.changed.clear();
    }

    fn look_at_start(&mut self, world: &World) {
        std::mem::swap(&mut self.before, &mut self.awake);
        self.awake.clear();
        self.awake.extend_from_slice(&world.bodies.slot[..world.bodies.movers()]);
        self.awake.sort_unstable();
        if self.awake != self.before {
            let came = self.awake.iter().filter(|slot| self.before.binary_search(slot).is_err());
            self.changed.extend(came);
        }
        self.changed.sort_unstable();
        self.changed.dedup();
        self.touched.clear();
        for slot in self.changed.drain(..) {
            // Some were removed since.
            if let Some((_, index)) = world.bodies.slots.live(slot) {
                self.touched.push((slot, start_of(world, index as usize)));
            }
        }
    }

    fn look_at_end(&mut self, world: &World) {
        self.hash = world.state_hash().to_le_bytes();
        self.bodies.clear();
        let hash_of = |&slot: &u32| end_of(world, world.bodies.slots.dense(slot) as usize);
        self.bodies.extend(self.awake.iter().map(hash_of));
    }

    /// The record to be written.
    pub(super) fn record(&self, dt: f32, decisions: Vec<Decision>) -> StepRecord {
        let mut last = 0;
        let differences =
            || self.awake.iter().map(|&slot| slot - std::mem::replace(&mut last, slot)).collect();
        StepRecord {
            dt,
            decisions,
            stages: self.stages,
            hash: self.hash,
            touched: self.touched.clone(),
            awake: (self.awake != self.before).then(differences),
            bodies: self.bodies.clone(),
        }
    }
}

/// Pose and velocity.
fn end(world: &World, index: usize, hash: &mut Hash) {
    let (pose, v) = (&world.bodies.pose[index], &world.bodies.velocity[index]);
    hash.place(pose.position, pose.rotation);
    hash.vectors(v.linear, v.angular);
}

fn end_of(world: &World, index: usize) -> Short {
    let mut hash = Hash::new();
    end(world, index, &mut hash);
    hash.short().to_le_bytes()
}

/// The state of a body at the start of a step.
fn start(world: &World, index: usize, hash: &mut Hash) {
    let bodies = &world.bodies;
    end(world, index, hash);
    let (mass, traits) = (&bodies.mass[index], &bodies.traits[index]);
    hash.vectors(mass.inertia, mass.inverse_inertia);
    hash.pair(mass.inverse.to_bits(), traits.gravity_scale.to_bits());
    let flags = [traits.locks, traits.continuous as u8, traits.sleepless.into()];
    let solved_after = traits.solved_after.map_or(0, |above| above as u32 + 1);
    hash.pair(solved_after, flags.iter().fold(0, |all, &flag| all << 8 | u32::from(flag)));
    // A zero force equals none that was ever applied.
    let force = bodies.force.get(index).copied().unwrap_or_default();
    hash.vectors(force.linear, force.angular);
}

fn start_of(world: &World, index: usize) -> Short {
    let mut hash = Hash::new();
    start(world, index, &mut hash);
    hash.short().to_le_bytes()
}

fn records(records: &[Record], hash: &mut Hash) {
    records.iter().for_each(|r| hash.vectors(r.linear, r.angular));
}

fn forces(world: &World, hash: &mut Hash) {
    let movers = world.bodies.movers();
    (0..movers).for_each(|index| start(world, index, hash));
    let forces = &world.buffers.forces;
    records(&forces.acceleration[..movers.min(forces.acceleration.len())], hash);
    records(&forces.motion[..movers.min(forces.motion.len())], hash);
}

fn broad(world: &World, hash: &mut Hash) {
    for pair in &world.broad.pairs {
        hash.pair(pair.a, pair.b);
        hash.word(pair.fast.into());
    }
}

fn narrow(world: &World, hash: &mut Hash) {
    for pair in &world.broad.pairs {
        for (slot, contact) in world.contacts.chain(pair.contact) {
            hash.pair(contact.a, contact.b);
            hash.pair(contact.count.into(), contact.fraction.to_bits());
            hash.vectors(contact.normal, contact.friction);
            hash.number(contact.twist);
            if world.needs.rolling > 0 {
                hash.vector(world.contacts.rolling(slot));
            }
            hash.pair(contact.lasting_force.to_bits(), contact.static_load.to_bits());
            hash.number(contact.rest);
            for point in contact.points() {
                hash.vector(point.position);
                hash.pair(point.separation.to_bits(), point.impulse.to_bits());
                hash.pair(point.share.to_bits(), point.key);
            }
        }
    }
}

fn prepare(world: &World, hash: &mut Hash) {
    let rows = &world.buffers.rows;
    hash.pair(rows.schedule.len() as u32, rows.uncoloured() as u32);
    for &(a, b) in &world.events.vetoed {
        hash.pair(a, b);
    }
    // In the order of pairs: the places of contacts depend on what was there before, and decide nothing.
    let pairs = world.broad.pairs.iter().filter(|_| !world.events.tweaks.is_empty());
    for (slot, _) in pairs.flat_map(|pair| world.contacts.chain(pair.contact)) {
        let Some(tweak) = world.events.tweaks.get(slot as usize) else { continue };
        let [friction, other] = tweak.friction.map(f32::to_bits);
        hash.pair(friction, other);
        hash.number(tweak.restitution);
        hash.vector(tweak.surface);
    }
    records(&world.bodies.velocity[..world.bodies.movers()], hash);
}

fn solve(world: &World, hash: &mut Hash) {
    let movers = world.bodies.movers();
    records(&world.bodies.velocity[..movers], hash);
    let delta = &world.buffers.solver.delta;
    records(&delta[..movers.min(delta.len())], hash);
}
