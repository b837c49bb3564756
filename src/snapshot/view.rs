//! The layout of a state: a head, counts, then one column after another.

use super::characters::CHARACTER;
use super::contacts::SavedPairs;
use super::settings;
use crate::broad_phase::{Lists, SavedBroad};
use crate::config::Settings;
use crate::error::Error;
use crate::events::{EventLists, SavedEvents};
use crate::joint::{JointLists, SavedJoints};
use crate::limits;
use crate::sleep::{SavedSleep, SleepLists};
use crate::statics::LONGEST_WAIT;
use crate::words::{Reader, broken};
use bytemuck::{Pod, Zeroable};

/// The version of the format: of these columns, and of the parts that snapshots share.
pub(super) const VERSION: u32 = 9;
/// `BSNP` in the first bytes.
pub(super) const MAGIC: u32 = u32::from_le_bytes(*b"BSNP");

/// The first words.
#[derive(Clone, Copy, Debug, Default, Pod, Zeroable)]
#[repr(C)]
pub(super) struct Head {
    pub(super) magic: u32,
    pub(super) version: u32,
    /// Words of the state, this head included.
    pub(super) words: u32,
    /// Whether the parts follow. This and the fields below are filled in when bytes are made.
    pub(super) whole: u32,
    /// Fingerprints of the parts.
    pub(super) prints: [[[u32; 2]; 2]; 2],
    /// Checksum of all words, computed with zeros in this place.
    pub(super) checksum: [u32; 2],
}

/// Number of entries of each column.
#[derive(Clone, Copy, Debug, Default, Pod, Zeroable)]
#[repr(C)]
pub(super) struct Counts {
    /// Bodies awake, kinematic and asleep.
    pub(super) parts: [u32; 3],
    /// Slots of colliders.
    pub(super) slots: u32,
    /// Columns that may not exist, by bit.
    pub(super) columns: u32,
    /// Bodies with a force.
    pub(super) forces: u32,
    /// Kinematic bodies that are to be somewhere after the next step.
    pub(super) targets: u32,
    /// Bodies that the guard checked, and those that are known to be clear of static shapes.
    pub(super) guarded: u32,
    pub(super) clear: u32,
    pub(super) broad: Lists,
    /// Pairs, those that islands keep, and their contacts, in words and by number.
    pub(super) pairs: u32,
    pub(super) sleeping_pairs: u32,
    pub(super) contact_words: u32,
    pub(super) contacts: u32,
    pub(super) sleep: SleepLists,
    pub(super) joints: JointLists,
    /// Slots of characters.
    pub(super) characters: u32,
    pub(super) events: EventLists,
}

/// Bits of [`Counts::columns`].
pub(super) const FORCE: u32 = 1;
pub(super) const REST: u32 = 2;
/// Not columns: whether bodies may sleep, and whether a force was applied since the last step.
pub(super) const RESTS: u32 = 4;
pub(super) const PUSHED: u32 = 8;
const COLUMNS: u32 = FORCE | REST | RESTS | PUSHED;

pub(super) const HEAD: usize = size_of::<Head>() / 4;
pub(super) const COUNTS: usize = size_of::<Counts>() / 4;
/// Words of a body's pose and velocity; of a force and torque with its body; of the pose that a body is to
/// have after the next step, with the body and the length of the step; of the position at which a body is
/// clear.
pub(super) const BODY: usize = 16;
pub(super) const PUSH: usize = 7;
pub(super) const TARGET: usize = 13;
pub(super) const BALL: usize = 7;

/// A state in its words. Settings and single numbers are checked as they are read, characters where their
/// forms are known, and all else by [`check`](super::check::check).
pub(super) struct View<'a> {
    pub(super) counts: Counts,
    pub(super) settings: Settings,
    pub(super) origin: [f64; 3],
    pub(super) last_h: f32,
    pub(super) usual_h: f32,
    pub(super) evenness: f32,
    /// See [`Statics`](crate::statics::Statics).
    pub(super) wait: u32,
    pub(super) pending: bool,
    /// Slot of each awake or sleeping body, in order.
    pub(super) slots: &'a [u32],
    pub(super) bodies: &'a [u32],
    /// For each moving body, if bodies may sleep, how long it has rested; and, if there is restitution, its
    /// path.
    pub(super) rest: &'a [u32],
    pub(super) forces: &'a [u32],
    pub(super) targets: &'a [u32],
    /// A bit for each guarded body.
    pub(super) is_clear: &'a [u32],
    pub(super) clear: &'a [u32],
    pub(super) broad: SavedBroad<'a>,
    pub(super) pairs: SavedPairs<'a>,
    pub(super) sleep: SavedSleep<'a>,
    pub(super) joints: SavedJoints<'a>,
    /// See [`characters`](super::characters).
    pub(super) characters: &'a [u32],
    pub(super) events: SavedEvents<'a>,
}

impl Counts {
    /// Bodies that move, and those that sleep too.
    pub(super) fn movers(&self) -> u32 {
        self.parts[0].saturating_add(self.parts[1])
    }
    pub(super) fn bodies(&self) -> u32 {
        self.movers().saturating_add(self.parts[2])
    }
    pub(super) fn has(&self, column: u32) -> bool {
        self.columns & column != 0
    }
}

impl<'a> View<'a> {
    /// Finds the columns. `own`: the settings of the restored world, for those that a snapshot does not have.
    pub(super) fn read(words: &'a [u32], own: &Settings) -> Result<View<'a>, Error> {
        let mut from = Reader(words);
        let head: Head = from.record::<_, HEAD>()?;
        if head.magic != MAGIC || head.words as usize != words.len() {
            return Err(broken("it is not one"));
        }
        let counts: Counts = from.record::<_, COUNTS>()?;
        if counts.columns & !COLUMNS != 0 {
            return Err(broken("a column is unknown"));
        }
        let settings = settings::read(&mut from, own)?;
        let origin: [f64; 3] = from.record::<_, 6>()?;
        let last_h = f32::from_bits(from.one()?);
        let usual_h = f32::from_bits(from.one()?);
        let evenness = f32::from_bits(from.one()?);
        let statics = from.one()?;
        limits::position(origin.into())?;
        // Length of a substep, of which a step has 64 at most; zero before the first step.
        let is_length = |h: &f32| *h == 0.0 || (limits::MIN_STEP / 64.0..=limits::MAX_STEP).contains(h);
        if statics >> 1 > LONGEST_WAIT
            || ![last_h, usual_h].iter().all(is_length)
            || !(0.0..=1.0).contains(&evenness)
        {
            return Err(broken("a number is none"));
        }
        let (movers, all) = (counts.movers(), counts.bodies());
        let pairs =
            counts.pairs.checked_add(counts.sleeping_pairs).ok_or_else(|| broken("a count is too large"))?;
        let view = View {
            settings,
            origin,
            last_h,
            usual_h,
            evenness,
            wait: statics >> 1,
            pending: statics & 1 != 0,
            slots: from.table(all, 1)?,
            bodies: from.table(all, BODY)?,
            rest: from.table(if counts.has(REST) { movers } else { 0 }, 1)?,
            forces: from.table(counts.forces, PUSH)?,
            targets: from.table(counts.targets, TARGET)?,
            is_clear: from.table(counts.guarded.div_ceil(32), 1)?,
            clear: from.table(counts.clear, BALL)?,
            broad: SavedBroad::read(&mut from, counts.broad)?,
            pairs: SavedPairs::read(&mut from, pairs, counts.contact_words, counts.slots as usize)?,
            sleep: SavedSleep::read(&mut from, counts.sleep)?,
            joints: SavedJoints::read(&mut from, counts.joints)?,
            characters: from.table(counts.characters, CHARACTER)?,
            events: SavedEvents::read(&mut from, counts.events)?,
            counts,
        };
        if from.0.is_empty() { Ok(view) } else { Err(broken("there is more than its counts say")) }
    }
}
