//! All batches of a step in one buffer, and their friction in another.

use super::batch::{Batch, BatchRef};
use super::friction::{FrictionRow, FrictionView, ImpactRow, RollingRow};
use super::input::Beside;
use super::soft::SoftRow;
use crate::constraint::articulation::slots::TreeContacts;
use crate::constraint::schedule::order::{Group, Stage};
use crate::lanes::f32x8;
use crate::memory::{Allowance, Buffer, Cut, Slab, buffers, bytes_of, sum_bytes};
use crate::narrow_phase::LEAST_ROWS;
use crate::threads::Shared;

/// Counts for batches whose bodies `b` may move, and for those where all are static: batches of one to four
/// points and of one lane; friction rows of eight lanes and of one; impact rows of eight lanes and of one.
pub(crate) type Tally = [[usize; KINDS]; 2];

const KINDS: usize = 9;
/// The first index that counts friction.
const FRICTION: usize = 5;

const fn sizes<const B: usize>() -> [usize; KINDS] {
    [
        size_of::<Batch<f32x8, 1, B>>(),
        size_of::<Batch<f32x8, 2, B>>(),
        size_of::<Batch<f32x8, 3, B>>(),
        size_of::<Batch<f32x8, 4, B>>(),
        size_of::<Batch<f32, 4, B>>(),
        size_of::<FrictionRow<f32x8, B>>(),
        size_of::<FrictionRow<f32, B>>(),
        size_of::<ImpactRow<f32x8, B>>(),
        size_of::<ImpactRow<f32, B>>(),
    ]
}

/// All batches of a step.
#[derive(Debug, Default)]
pub(crate) struct Rows {
    tally: Tally,
    batches: Slab,
    /// Whether there is any friction.
    has_friction: bool,
    friction: Slab,
    pub(crate) schedule: Vec<BatchRef>,
    pub(crate) stages: Vec<Stage>,
    /// Batches that are solved along with trees, sorted by tree and node.
    pub(crate) tree_contacts: Vec<TreeContacts>,
    /// One for each batch of the schedule; empty unless some surface moves.
    pub(crate) surfaces: Vec<Surface>,
    /// One for each batch of the schedule; empty unless some shape resists rolling or spinning.
    pub(crate) rolling: Vec<RollingRow>,
    pub(crate) soft: SoftRows,
    /// Impulses of [`guard`](crate::constraint::guard) on the points of each contact in the substep [N s],
    /// of which nothing else is kept; empty unless somebody observes the step.
    pub(crate) guarded: Vec<[f32; 4]>,
}

impl Beside {
    /// Bytes of a batch.
    pub(crate) fn bytes(self) -> usize {
        let of = |is_there: bool, bytes: usize| if is_there { bytes } else { 0 };
        of(self.surfaces, size_of::<Surface>())
            + of(self.rolling, size_of::<RollingRow>())
            + of(self.soft, size_of::<SoftRow>())
    }
}

/// Data of soft contacts; empty unless some shape is soft.
#[derive(Debug, Default)]
pub(crate) struct SoftRows {
    /// One for each batch of the schedule.
    pub(crate) rows: Vec<SoftRow>,
    /// Contacts and joints that hold each dynamic body: see [`mark`](super::soft::bodies::mark).
    pub(crate) marks: Vec<u8>,
}

buffers! { SoftRows { bytes { rows, marks } } }

/// Velocity of the surfaces of each lane past each other, along the two tangents of friction [m/s].
pub(crate) type Surface = [[f32; 8]; 2];

impl Rows {
    /// Bytes of each item that [`Tally`] counts.
    pub(crate) const SIZES: Tally = [sizes::<1>(), sizes::<0>()];

    /// Minimum number of contacts for which a batch takes less memory than single rows.
    pub(crate) fn worth(points: usize, group: Group, friction: bool, beside: Beside) -> usize {
        let sizes = &Self::SIZES[usize::from(group.is_static())];
        let of_friction = |single: usize| {
            if friction { sizes[FRICTION + 2 * usize::from(group.is_potential()) + single] } else { 0 }
        };
        let single = sizes[4] + of_friction(1) + size_of::<BatchRef>() + beside.bytes();
        (sizes[points - 1] + of_friction(0) + beside.bytes()).div_ceil(single)
    }

    /// Bytes for so many batches and friction rows.
    fn bytes_of(tally: &Tally) -> [usize; 2] {
        let of = |range: std::ops::Range<usize>| {
            let side =
                |side: usize| range.clone().map(|i| tally[side][i] * Self::SIZES[side][i]).sum::<usize>();
            side(0) + side(1)
        };
        [of(0..FRICTION), of(FRICTION..KINDS)]
    }

    /// Reserves exactly the missing memory for so many, with the other data of the schedule's batches; if
    /// need be, out of the spare memory of the other buffer. Returns whether there is room for all.
    pub(crate) fn reserve(&mut self, wanted: &Tally, beside: Beside, allowance: &mut Allowance) -> bool {
        let [batches, friction] = Self::bytes_of(wanted);
        let count = |is_there: bool| if is_there { self.schedule.len() } else { 0 };
        let [surfaces, rolling, soft] = [beside.surfaces, beside.rolling, beside.soft].map(count);
        let lacking = self.batches.missing(batches)
            + self.friction.missing(friction)
            + self.surfaces.missing(surfaces)
            + self.rolling.missing(rolling)
            + self.soft.rows.missing(soft);
        let least = batches.max(LEAST_ROWS);
        let spare = self.batches.spare(least) + self.friction.spare(friction);
        if lacking > allowance.left().saturating_add(spare) {
            return false;
        }
        if lacking > allowance.left() {
            // Neither keeps anything from step to step.
            allowance.give(spare);
            self.batches.shrink(least);
            self.friction.shrink(friction);
        }
        allowance.take(lacking);
        self.batches.reserve_total(batches);
        self.friction.reserve_total(friction);
        self.surfaces.reserve_total(surfaces);
        self.rolling.reserve_total(rolling);
        self.soft.rows.reserve_total(soft);
        true
    }

    /// Bytes of so many, with the other data of the schedule's batches.
    pub(crate) fn size(&self, tally: &Tally, beside: Beside) -> usize {
        Self::bytes_of(tally).iter().sum::<usize>() + self.schedule.len() * beside.bytes()
    }

    /// Reserved bytes of these.
    pub(crate) fn held(&self) -> usize {
        self.batches.bytes(0).1 + self.friction_bytes() + self.beside_bytes()
    }

    /// Makes so many, for which memory is reserved or unlimited.
    pub(crate) fn resize(&mut self, wanted: &Tally, allowance: &mut Allowance) {
        self.tally = *wanted;
        let [batches, friction] = Self::bytes_of(wanted);
        self.batches.fit(batches, allowance);
        self.friction.fit(friction, allowance);
    }

    /// Sets whether contacts have friction; if that changes, the memory of friction is released.
    pub(crate) fn set_friction(&mut self, friction_needed: bool) {
        if self.has_friction != friction_needed {
            (self.has_friction, self.friction) = (friction_needed, Slab::default());
            self.tally.iter_mut().for_each(|side| side[FRICTION..].fill(0));
        }
    }

    /// Whether there may be friction.
    pub(crate) fn has_friction(&self) -> bool {
        self.has_friction
    }

    /// Number of contacts that found no colour.
    pub(crate) fn uncoloured(&self) -> usize {
        self.tally.iter().map(|side| side[FRICTION - 1]).sum()
    }

    /// All batches for several threads, and the order in which they are solved.
    pub(crate) fn views(&mut self) -> Views<'_> {
        let (friction_needed, batches, friction) =
            (self.has_friction, &mut self.batches.cut(), &mut self.friction.cut());
        let [two, one] = &self.tally;
        // Batches of eight lanes come first, because of their alignment.
        let two_lanes = Lanes8::cut(friction_needed, two, batches, friction);
        let one_lanes = Lanes8::cut(friction_needed, one, batches, friction);
        Views {
            two: Side { lanes: two_lanes, single: Single::cut(friction_needed, two, batches, friction) },
            one: Side { lanes: one_lanes, single: Single::cut(friction_needed, one, batches, friction) },
            schedule: &self.schedule,
            stages: &self.stages,
            tree_contacts: &self.tree_contacts,
            surfaces: &self.surfaces,
            rolling: Shared::new(&mut self.rolling),
            soft: Shared::new(&mut self.soft.rows),
            marks: &self.soft.marks,
            guarded: Shared::new(&mut self.guarded),
        }
    }

    /// Bytes that are missing for so many batches of one to four points, with dynamic and with static bodies
    /// `b`, and so many stages, where there are none yet.
    pub(crate) fn missing(
        &self,
        batches: [[usize; 4]; 2],
        stages: usize,
        friction: bool,
        beside: Beside,
    ) -> usize {
        let mut tally = Tally::default();
        for (side, batches) in tally.iter_mut().zip(batches) {
            side[..4].copy_from_slice(&batches);
            side[FRICTION] = if friction { batches.iter().sum() } else { 0 };
        }
        let [rows, friction] = Self::bytes_of(&tally);
        let all = batches.iter().flatten().sum::<usize>();
        let lists = self.schedule.missing(all) + self.stages.missing(stages) + all * beside.bytes();
        self.batches.missing(rows) + self.friction.missing(friction) + lists
    }

    /// Clears the last step, but keeps its memory.
    fn clear(&mut self) {
        self.tally = Tally::default();
        self.schedule.clear();
        self.stages.clear();
        self.tree_contacts.clear();
        self.surfaces.clear();
        self.rolling.clear();
        self.soft.rows.clear();
        self.soft.marks.clear();
    }

    /// The buffer of batches, of which bodies that can move bring a part ([`LEAST_ROWS`]).
    pub(crate) fn batch_buffer(&mut self) -> &mut dyn Buffer {
        &mut self.batches
    }

    /// Takes the memory of batches, which are dropped.
    pub(crate) fn lend(&mut self) -> Slab {
        self.clear();
        std::mem::take(&mut self.batches)
    }

    /// Releases so many bytes of batches, which are dropped, except for the memory that one point of each of
    /// so many contacts will take. Returns the number of bytes.
    pub(crate) fn give_up(&mut self, bytes: usize, contacts: usize) -> usize {
        self.clear();
        let (before, least) = (self.batches.bytes(0).1, contacts * Self::SIZES[0][0] / 8);
        self.batches.shrink(before.saturating_sub(bytes).max(least).max(LEAST_ROWS));
        before - self.batches.bytes(0).1
    }

    /// Returns the memory of batches, which may have grown or shrunk.
    pub(crate) fn take_back(&mut self, batches: Slab) {
        self.batches = batches;
    }

    /// Reserved bytes of friction.
    pub(crate) fn friction_bytes(&self) -> usize {
        self.friction.bytes(0).1
    }

    /// Reserved bytes of the other data of batches.
    pub(crate) fn beside_bytes(&self) -> usize {
        bytes_of(&self.surfaces).1 + bytes_of(&self.rolling).1 + bytes_of(&self.soft.rows).1
    }

    /// Live and reserved bytes.
    pub(crate) fn bytes(&self) -> (usize, usize) {
        let [batches, friction] = Self::bytes_of(&self.tally);
        sum_bytes([
            self.batches.bytes(batches),
            self.friction.bytes(friction),
            bytes_of(&self.schedule),
            bytes_of(&self.stages),
            bytes_of(&self.tree_contacts),
            bytes_of(&self.surfaces),
            bytes_of(&self.rolling),
            self.soft.bytes(),
        ])
    }
}

/// All batches of a step, for several threads.
pub(crate) struct Views<'a> {
    /// For groups in which both bodies may move, and for those with static bodies.
    pub(crate) two: Side<'a, 1>,
    pub(crate) one: Side<'a, 0>,
    pub(crate) schedule: &'a [BatchRef],
    pub(crate) stages: &'a [Stage],
    pub(crate) tree_contacts: &'a [TreeContacts],
    pub(crate) surfaces: &'a [Surface],
    pub(crate) rolling: Shared<'a, RollingRow>,
    pub(crate) soft: Shared<'a, SoftRow>,
    /// See [`SoftRows`].
    pub(crate) marks: &'a [u8],
    /// See [`Rows::guarded`].
    pub(crate) guarded: Shared<'a, [f32; 4]>,
}

impl Views<'_> {
    /// The rows of a batch against rolling, if it has any.
    ///
    /// # Safety
    /// No other thread works on the batch.
    #[inline(always)]
    #[allow(clippy::mut_from_ref, reason = "the contract is the caller's, see `Shared::get`")]
    pub(crate) unsafe fn rolling_of<L, const P: usize, const B: usize>(
        &self,
        batch: &Batch<L, P, B>,
    ) -> Option<&mut RollingRow> {
        // SAFETY: by the contract; each batch has a row of its own.
        unsafe { self.rolling.find(batch.rolling as usize) }
    }
}

/// See [`Batch`] for the meaning of `B`.
pub(crate) struct Side<'a, const B: usize> {
    pub(crate) lanes: Lanes8<'a, B>,
    pub(crate) single: Single<'a, B>,
}

/// Batches of eight lanes, by their points.
pub(crate) struct Lanes8<'a, const B: usize> {
    pub(crate) p1: Shared<'a, Batch<f32x8, 1, B>>,
    pub(crate) p2: Shared<'a, Batch<f32x8, 2, B>>,
    pub(crate) p3: Shared<'a, Batch<f32x8, 3, B>>,
    pub(crate) p4: Shared<'a, Batch<f32x8, 4, B>>,
    pub(crate) friction: FrictionView<'a, f32x8, B>,
}

/// Batches of one lane: contacts that found no colour, or those of a single tree.
pub(crate) struct Single<'a, const B: usize> {
    pub(crate) all: Shared<'a, Batch<f32, 4, B>>,
    pub(crate) friction: FrictionView<'a, f32, B>,
}

impl<'a, const B: usize> Lanes8<'a, B> {
    fn cut(
        friction_needed: bool,
        count: &[usize; KINDS],
        batches: &mut Cut<'a>,
        friction: &mut Cut<'a>,
    ) -> Self {
        Lanes8 {
            p1: Shared::new(batches.next(count[0])),
            p2: Shared::new(batches.next(count[1])),
            p3: Shared::new(batches.next(count[2])),
            p4: Shared::new(batches.next(count[3])),
            friction: FrictionView::new(friction_needed, friction.next(count[5]), friction.next(count[7])),
        }
    }
}

impl<'a, const B: usize> Single<'a, B> {
    fn cut(
        friction_needed: bool,
        count: &[usize; KINDS],
        batches: &mut Cut<'a>,
        friction: &mut Cut<'a>,
    ) -> Self {
        Single {
            all: Shared::new(batches.next(count[4])),
            friction: FrictionView::new(friction_needed, friction.next(count[6]), friction.next(count[8])),
        }
    }
}

/// Dispatches to the concrete type of a batch of [`Views`] and a group: calls `$body` with it and with the
/// friction of its type, one copy for each type. `$body` may get the batch once, under the contract of
/// [`Shared::get`]. Eight lanes are of the type `$Wide`, if it is given.
macro_rules! with_batch {
    ($views:expr, $group:expr, $of:expr, |$batch:ident, $friction:ident| $body:expr) => {
        $crate::constraint::with_batch!($crate::lanes::f32x8: $views, $group, $of, |$batch, $friction| $body)
    };
    ($Wide:ty: $views:expr, $group:expr, $of:expr, |$batch:ident, $friction:ident| $body:expr) => {
        if $group.is_static() {
            $crate::constraint::with_batch!(@ $Wide, $views.one, $of, $batch, $friction, $body)
        } else {
            $crate::constraint::with_batch!(@ $Wide, $views.two, $of, $batch, $friction, $body)
        }
    };
    (@ $Wide:ty, $side:expr, $of:expr, $batch:ident, $friction:ident, $body:expr) => {{
        let (i, lanes) = ($of.index as usize, &$side.lanes);
        let $friction = &lanes.friction.cast::<$Wide>();
        match $of.points {
            1 => { let $batch = lanes.p1.get(i).cast::<$Wide>(); $body }
            2 => { let $batch = lanes.p2.get(i).cast::<$Wide>(); $body }
            3 => { let $batch = lanes.p3.get(i).cast::<$Wide>(); $body }
            4 => { let $batch = lanes.p4.get(i).cast::<$Wide>(); $body }
            _ => {
                let ($batch, $friction) = ($side.single.all.get(i), &$side.single.friction);
                $body
            }
        }
    }};
}
pub(crate) use with_batch;
