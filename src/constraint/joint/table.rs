//! The batches of one row type, and the operations that batches of all types share.

use super::batch::{JointBatch, Report, Watched};
#[cfg(feature = "observe")]
use super::ends::Ends;
use super::ends::{JointPass, NONE, Recovery};
use crate::constraint::contact::input::PrepareInput;
use crate::constraint::contact::row::Motion;
#[cfg(feature = "observe")]
use crate::lanes::Vec3;
use crate::lanes::{GatherLanes, f32x8, kernel};
use crate::memory::{bytes_of, sum_bytes};
use crate::threads::{Shared, Workers, per_block};

kernel! {
    /// Applies the impulses of the last step.
    ///
    /// # Safety
    /// The bodies of the batch that it may write are in no other batch of the stage.
    unsafe fn warm_start<'a, L: GatherLanes; B: JointBatch<L>>(batch: &'a B, motion: &'a Motion<'a, 'a>) {
        // SAFETY: by the contract.
        unsafe {
            let mut v = batch.ends().load(motion.velocity);
            batch.apply(&mut v);
            batch.ends().save(&v, motion);
        }
    }
}

kernel! {
    /// One Gauss-Seidel step.
    ///
    /// # Safety
    /// The bodies of the batch that it may write are in no other batch of the stage.
    unsafe fn solve<'a, L: GatherLanes; B: JointBatch<L>>(
        batch: &'a mut B,
        motion: &'a Motion<'a, 'a>,
        pass: &'a JointPass,
    ) {
        if pass.moved {
            // SAFETY: displacements are not written while rows are solved.
            let moved = unsafe { batch.ends().load(motion.delta) };
            batch.follow(&moved);
        }
        // SAFETY: by the contract.
        let mut v = unsafe { batch.ends().load(motion.velocity) };
        batch.sweep(&mut v, pass);
        // SAFETY: by the contract.
        unsafe { batch.ends().save(&v, motion) };
    }
}

kernel! {
    /// Moves the bodies of locks so that these are closed.
    ///
    /// # Safety
    /// No other thread works on the bodies of the batch, and none writes their displacements.
    unsafe fn close<'a, L: GatherLanes; B: JointBatch<L>>(
        batch: &'a mut B,
        motion: &'a Motion<'a, 'a>,
        most: Recovery,
    ) {
        if !B::IS_LOCK {
            return;
        }
        // SAFETY: by the contract.
        let mut moved = unsafe { batch.ends().load(motion.delta) };
        batch.follow(&moved);
        batch.correct(&mut moved, most);
        // SAFETY: by the contract.
        unsafe { batch.ends().save_moved(&moved, motion) };
    }
}

/// Batches of one row type: of eight lanes, and of one for rows that found no colour.
#[derive(Debug)]
pub(crate) struct Table<B8, B1> {
    lanes: Vec<B8>,
    single: Vec<B1>,
    owners: Owners,
}

/// The locks or rows in each lane of a table.
#[derive(Debug, Default)]
pub(crate) struct Owners {
    pub(crate) lanes: Vec<[u32; 8]>,
    pub(crate) single: Vec<u32>,
}

/// A table of any type.
pub(crate) trait AnyTable {
    fn is_lock(&self) -> bool;
    fn owners(&mut self) -> &mut Owners;
    /// Makes as many batches as there are owners.
    fn resize(&mut self);
    /// Fills all batches.
    fn fill(&mut self, workers: &Workers<'_>, input: &PrepareInput<'_>);
    /// How many locks or rows there are.
    fn len(&self) -> u32;
    /// Live and reserved bytes.
    fn bytes(&self) -> (usize, usize);
}

impl<B8, B1> Default for Table<B8, B1> {
    fn default() -> Self {
        Table { lanes: Vec::new(), single: Vec::new(), owners: Owners::default() }
    }
}

/// Batches a block.
const BLOCK: usize = per_block(8, 1);

impl<B8: JointBatch<f32x8> + Send, B1: JointBatch<f32>> AnyTable for Table<B8, B1> {
    fn is_lock(&self) -> bool {
        B1::IS_LOCK
    }

    fn owners(&mut self) -> &mut Owners {
        &mut self.owners
    }

    fn resize(&mut self) {
        let Table { lanes, single, owners } = self;
        lanes.resize_with(owners.lanes.len(), B8::default);
        single.resize_with(owners.single.len(), B1::default);
        if owners.lanes.is_empty() {
            (*lanes, owners.lanes) = (Vec::new(), Vec::new());
        }
        if owners.single.is_empty() {
            (*single, owners.single) = (Vec::new(), Vec::new());
        }
    }

    fn fill(&mut self, workers: &Workers<'_>, input: &PrepareInput<'_>) {
        let (lanes, owners) = (Shared::new(&mut self.lanes), &self.owners.lanes);
        workers.run(owners.len().div_ceil(BLOCK), &|block| {
            let first = block * BLOCK;
            for (i, owners) in owners.iter().enumerate().skip(first).take(BLOCK) {
                // SAFETY: each batch is in one block.
                unsafe { lanes.get(i) }.fill(owners, input);
            }
        });
        for (batch, owner) in self.single.iter_mut().zip(&self.owners.single) {
            batch.fill(std::slice::from_ref(owner), input);
        }
    }

    fn len(&self) -> u32 {
        let in_lanes = self.owners.lanes.iter().flatten().filter(|&&owner| owner != NONE).count();
        (in_lanes + self.owners.single.len()) as u32
    }

    fn bytes(&self) -> (usize, usize) {
        sum_bytes([
            bytes_of(&self.lanes),
            bytes_of(&self.single),
            bytes_of(&self.owners.lanes),
            bytes_of(&self.owners.single),
        ])
    }
}

impl<B8: JointBatch<f32x8>, B1: JointBatch<f32>> Table<B8, B1> {
    /// For several threads.
    pub(super) fn view(&mut self) -> TableView<'_, B8, B1> {
        TableView { lanes: Shared::new(&mut self.lanes), single: Shared::new(&mut self.single) }
    }

    /// Reports the impulses of all lanes.
    pub(super) fn report(&self, to: &mut impl Report) {
        report(&self.lanes, &self.single, to);
    }
}

fn report<B8: JointBatch<f32x8>, B1: JointBatch<f32>>(lanes: &[B8], single: &[B1], to: &mut impl Report) {
    for batch in lanes {
        for lane in (0..8).filter(|&lane| batch.ends().owner[lane] != NONE) {
            batch.report(lane, to);
        }
    }
    single.iter().for_each(|batch| batch.report(0, to));
}

/// Batches of one type, for several threads.
pub(crate) struct TableView<'a, B8, B1> {
    lanes: Shared<'a, B8>,
    single: Shared<'a, B1>,
}

impl<B8: JointBatch<f32x8>, B1: JointBatch<f32>> TableView<'_, B8, B1> {
    /// Solves a batch of a stage or, without a pass, applies the impulses of the last step. `W`: eight lanes
    /// of the type `L`.
    ///
    /// # Safety
    /// No other thread works on the batch, or writes its bodies. `W` is `B8` but for the type of its lanes.
    #[inline(always)]
    pub(super) unsafe fn step<L: GatherLanes, W: JointBatch<L>>(
        &self,
        single: bool,
        i: usize,
        motion: &Motion<'_, '_>,
        pass: Option<&JointPass>,
    ) {
        // SAFETY: by the contract; batches are laid out as in C.
        unsafe {
            match (single, pass) {
                (false, None) => warm_start(self.lanes.reinterpret::<W>().get(i), motion),
                (false, Some(pass)) => solve(self.lanes.reinterpret::<W>().get(i), motion, pass),
                (true, None) => warm_start(self.single.get(i), motion),
                (true, Some(pass)) => solve(self.single.get(i), motion, pass),
            }
        }
    }

    /// Closes the locks of a batch. `W`: eight lanes of the type `L`.
    ///
    /// # Safety
    /// No other thread works on the bodies of the batch, and none writes their displacements. `W` is `B8` but
    /// for the type of its lanes.
    #[inline(always)]
    pub(super) unsafe fn close<L: GatherLanes, W: JointBatch<L>>(
        &self,
        single: bool,
        i: usize,
        motion: &Motion<'_, '_>,
        most: Recovery,
    ) {
        // SAFETY: by the contract; batches are laid out as in C.
        unsafe {
            if single {
                close(self.single.get(i), motion, most)
            } else {
                close(self.lanes.reinterpret::<W>().get(i), motion, most)
            }
        }
    }

    /// Calls `f` with a batch.
    ///
    /// # Safety
    /// No other thread works on the batch.
    pub(super) unsafe fn watch(&self, single: bool, i: usize, f: &mut dyn FnMut(&mut dyn Watched)) {
        // SAFETY: by the contract.
        unsafe { if single { f(self.single.get(i)) } else { f(self.lanes.get(i)) } };
    }

    /// Reports the impulses of all lanes.
    ///
    /// # Safety
    /// No other thread works on the batches.
    #[cfg(feature = "observe")]
    pub(super) unsafe fn report(&self, to: &mut impl Report) {
        // SAFETY: by the contract.
        let (lanes, single) = unsafe { (self.lanes.all(), self.single.all()) };
        report(lanes, single, to);
        report_pushes(lanes, to);
        report_pushes(single, to);
    }
}

/// Reports the impulses on the bodies of all lanes.
#[cfg(feature = "observe")]
fn report_pushes<L: GatherLanes, B: JointBatch<L>>(batches: &[B], to: &mut impl Report) {
    for batch in batches {
        batch.ends().report_pushes(batch.acted(), to);
    }
}

#[cfg(feature = "observe")]
impl<L: GatherLanes> Ends<L> {
    /// Reports impulses on both bodies of each lane, given as for [`Ends::apply`].
    pub(super) fn report_pushes(&self, (impulse, moment): (Vec3<L>, [Vec3<L>; 2]), to: &mut impl Report) {
        for (side, sign) in [(0, -1.0), (1, 1.0)] {
            for lane in (0..L::N).filter(|lane| self.write[side] >> lane & 1 != 0) {
                let push = [impulse, moment[side]].map(|part| part.lane(lane) * sign);
                to.push(self.body[side][lane], push);
            }
        }
    }
}
