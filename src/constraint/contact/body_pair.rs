//! The two bodies of each lane of a batch: their solver state, gathered and written back.

use super::batch::Batch;
use crate::lanes::{GatherLanes, Record, Vec3, gather, kernel, scatter};
use crate::threads::Shared;

/// The bodies' solver state: velocities, displacements since the start of the step, and velocities of the
/// substep before any row acted.
pub(crate) struct Motion<'a, 'b> {
    pub(crate) velocity: &'a Shared<'b, Record>,
    pub(crate) delta: &'a Shared<'b, Record>,
    pub(crate) base: &'a Shared<'b, Record>,
}

/// Bodies to write back.
#[derive(Clone, Copy)]
pub(crate) struct Written<'a> {
    /// Where their records are.
    pub(crate) index: &'a [u32; 8],
    /// Bit per lane: the body may be written.
    pub(crate) lanes: u32,
}

kernel! {
    /// A function of its own: inlined into the kernels of joints, it costs nets of them 2 %.
    ///
    /// # Safety
    /// A body that may be written is in no other lane, and no other thread works on it in this stage.
    unsafe fn write<'a, L: GatherLanes>(
        to: Written<'a>,
        linear: &'a Vec3<L>,
        angular: &'a Vec3<L>,
        records: &'a Shared<'a, Record>,
    ) {
        let out = scatter(*linear, *angular);
        for (lane, record) in out.iter().enumerate().take(L::N) {
            if to.lanes >> lane & 1 != 0 {
                // SAFETY: by the contract.
                unsafe { *records.get(to.index[lane] as usize) = *record };
            }
        }
    }
}

/// Velocities, or displacements, of the two bodies of each lane.
pub(crate) struct BodyPair<L> {
    pub(crate) va: Vec3<L>,
    pub(crate) wa: Vec3<L>,
    pub(crate) vb: Vec3<L>,
    pub(crate) wb: Vec3<L>,
}

impl<L: GatherLanes> BodyPair<L> {
    /// # Safety
    /// No other thread writes the bodies of the batch in this stage.
    #[inline(always)]
    pub(crate) unsafe fn load<const P: usize, const B: usize>(
        batch: &Batch<L, P, B>,
        records: &Shared<'_, Record>,
    ) -> Self {
        // SAFETY: by the contract.
        unsafe { Self::load_bodies(&batch.a, if B > 0 { Some(&batch.b[0].index) } else { None }, records) }
    }

    /// The same for bodies by index.
    ///
    /// # Safety
    /// As for [`BodyPair::load`].
    #[inline(always)]
    pub(crate) unsafe fn load_bodies(
        a: &[u32; 8],
        b: Option<&[u32; 8]>,
        records: &Shared<'_, Record>,
    ) -> Self {
        // SAFETY: by the contract. One by one: a slice of all would include those that other threads write.
        let record = |i| unsafe { records.read(i) };
        let (va, wa) = gather(record, a);
        let (vb, wb) = match b {
            Some(b) => gather(record, b),
            None => (Vec3::zero(), Vec3::zero()),
        };
        BodyPair { va, wa, vb, wb }
    }

    /// # Safety
    /// As for [`BodyPair::load`].
    #[inline(always)]
    pub(crate) unsafe fn save<const P: usize, const B: usize>(
        &self,
        batch: &Batch<L, P, B>,
        records: &Shared<'_, Record>,
    ) {
        let a = Written { index: &batch.a, lanes: u32::from(batch.write_a) };
        let b = if B > 0 {
            Some(Written { index: &batch.b[0].index, lanes: u32::from(batch.write_b) })
        } else {
            None
        };
        // SAFETY: by the contract.
        unsafe { self.save_bodies(a, b, records) };
    }

    /// The same for bodies by index.
    ///
    /// # Safety
    /// As for [`BodyPair::load`].
    #[inline(always)]
    pub(crate) unsafe fn save_bodies(
        &self,
        a: Written<'_>,
        b: Option<Written<'_>>,
        records: &Shared<'_, Record>,
    ) {
        // SAFETY: by the contract.
        unsafe {
            write(a, &self.va, &self.wa, records);
            if let Some(b) = b {
                write(b, &self.vb, &self.wb, records);
            }
        }
    }

    /// Applies an impulse `p` on `b` and `-p` on `a`, with angular impulses `ta` (taken from `a`) and `tb`.
    #[inline(always)]
    pub(crate) fn apply<const P: usize, const B: usize>(
        &mut self,
        batch: &Batch<L, P, B>,
        p: Vec3<L>,
        ta: Vec3<L>,
        tb: Vec3<L>,
    ) {
        let [on_a, on_b] = batch.moving(p);
        self.va -= on_a * batch.inverse_mass_a;
        self.wa -= batch.inverse_inertia_a.mul(ta);
        if B > 0 {
            let b = &batch.b[0];
            self.vb += on_b * b.inverse_mass;
            self.wb += b.inverse_inertia.mul(tb);
        }
    }
}
