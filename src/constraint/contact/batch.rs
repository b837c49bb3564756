//! Rows of contacts, packed in lanes.

use crate::constraint::schedule::part::Part;
use crate::lanes::{Lanes, Mask, Sym3, Vec3, f32x8};
use bytemuck::{Pod, Zeroable};

// Rounding: of a mobility along locked axes.
/// For bodies with locked axes: share of their mobility below which the rest is rounding.
pub(crate) const GONE: f32 = 1e-6;

/// One normal row per lane.
#[derive(Clone, Copy, Debug)]
#[repr(C)]
pub(crate) struct PointRow<L, const B: usize> {
    /// Arm x normal for each body: the angular part of the row [m].
    pub(crate) arm_a: Vec3<L>,
    pub(crate) arm_b: [Vec3<L>; B],
    /// At the start of the step [m]; infinite in a lane without a point.
    pub(crate) separation: L,
    /// The same after the displacements of the last substep, as of the last relaxation.
    pub(crate) now: L,
    /// Effective mass [kg]; zero in a lane without a point.
    pub(crate) mass: L,
    /// [N s]
    pub(crate) impulse: L,
    /// 1 / effective mass [1/kg].
    pub(crate) stiffness: L,
    /// The lasting part of the impulse, which does not yield [N s].
    pub(crate) lasting: L,
}

/// The bodies `b` of a batch.
#[derive(Clone, Copy, Debug)]
#[repr(C)]
pub(crate) struct OfB<L> {
    pub(crate) inverse_mass: L,
    pub(crate) inverse_inertia: Sym3<L>,
    /// Dense indices; an inert lane repeats that of an active one.
    pub(crate) index: [u32; 8],
}

/// Up to `L::N` manifolds of at most `P` points that share no dynamic body.
///
/// The normal rows of a manifold share one direction, so they are solved in row space: `coupling` says by how
/// much an impulse at one point changes the normal velocity at another, and the bodies' velocities are read
/// and written once.
///
/// `B` is 1, or 0 where all bodies `b` are static: nothing moves them, so nothing is stored for them.
#[derive(Clone, Copy, Debug)]
#[repr(C)]
pub(crate) struct Batch<L, const P: usize, const B: usize> {
    pub(crate) normal: Vec3<L>,
    pub(crate) inverse_mass_a: L,
    pub(crate) inverse_inertia_a: Sym3<L>,
    pub(crate) points: [PointRow<L, B>; P],
    /// For the pairs of points (0,1), (0,2), (1,2), (0,3), (1,3), (2,3) [1/kg]: as many as there are points,
    /// which is enough for three, and the rest for four.
    coupling: [L; P],
    more_coupling: [L; 2],
    /// The largest impulse of potential points in any substep [N s]. A point that hits a body at rest pushes
    /// in the substep of the impact, and bears nothing in those that follow.
    pub(crate) peak: L,
    /// Separation at which springs bear only the lasting impulses, and how far above it they act at most [m].
    pub(crate) rest: L,
    pub(crate) reach: L,
    pub(crate) b: [OfB<L>; B],
    /// Dense indices of the bodies `a`; an inert lane repeats that of an active one.
    pub(crate) a: [u32; 8],
    /// The contacts to which the impulses are written back.
    pub(crate) contact: [Part; 8],
    /// Index in [`Rows::surfaces`](crate::constraint::Rows::surfaces), or beyond its end.
    pub(crate) surface: u32,
    /// Index in [`Rows::rolling`](crate::constraint::Rows::rolling), or beyond its end.
    pub(crate) rolling: u32,
    /// Index in [`Rows::soft`](crate::constraint::Rows::soft), or beyond its end.
    pub(crate) soft: u32,
    /// Bit per lane: body `a` (and `b`) may be written.
    pub(crate) write_a: u8,
    pub(crate) write_b: u8,
    /// Bit per lane: the contact's `a` is this batch's `b`.
    pub(crate) swapped: u8,
    /// Bit per lane: a collider of the contact has events enabled.
    pub(crate) heard: u8,
    /// Axes along which the bodies `a` and `b` are locked: see [`unlocked`].
    pub(crate) locks: [u32; 2],
    /// Padding to a multiple of eight lanes: every byte is initialised.
    _pad: [u32; 2],
}

// SAFETY: zero is a value of every field.
unsafe impl<L: Zeroable, const P: usize, const B: usize> Zeroable for Batch<L, P, B> {}
// SAFETY: all fields are numbers, of which any bits are one, in the order of C and without gaps: see
// `NO_GAPS`.
unsafe impl<L: Lanes + Pod, const P: usize, const B: usize> Pod for Batch<L, P, B> {}

impl<L: Lanes, const P: usize, const B: usize> Batch<L, P, B> {
    /// Numbers per lane: three for the normal, seven for mass and inertia, nine for a point and one for a
    /// coupling, two more couplings, peak, rest and reach; seven for bodies `b` and three for their arms.
    const LANES: usize = 3 + 7 + (9 + 1 + 3 * B) * P + 2 + 3 + 7 * B;
    const NO_GAPS: () =
        assert!(size_of::<Self>() == Self::LANES * size_of::<L>() + (8 + 8 * B + 8 + 1 + 1 + 6) * 4);

    /// The same lanes as another type.
    #[inline(always)]
    pub(crate) fn cast<W: Lanes + Pod>(&mut self) -> &mut Batch<W, P, B>
    where
        L: Pod,
    {
        bytemuck::must_cast_mut(self)
    }

    /// The part of an impulse on both bodies that moves each of them.
    #[inline(always)]
    pub(crate) fn moving(&self, p: Vec3<L>) -> [Vec3<L>; 2] {
        // A branch instead of masks for all: few scenes have a locked body.
        if self.locks == [0; 2] { [p; 2] } else { [unlocked(self.locks[0], p), unlocked(self.locks[1], p)] }
    }

    /// By how much an impulse at point `i` changes the normal velocity at point `k`, and vice versa [1/kg];
    /// `i < k`.
    #[inline(always)]
    pub(crate) fn coupling(&self, i: usize, k: usize) -> L {
        let at = couple(i, k);
        if at < P { self.coupling[at] } else { self.more_coupling[at - P] }
    }

    #[inline(always)]
    pub(crate) fn couple(&mut self, i: usize, k: usize, coupling: L) {
        let at = couple(i, k);
        if at < P {
            self.coupling[at] = coupling;
        } else {
            self.more_coupling[at - P] = coupling;
        }
    }
}

/// The part of an impulse that moves bodies, which nothing does along locked axes. The bytes of
/// `locked_axes` are x, y and z, with a bit per lane.
#[inline(always)]
pub(crate) fn unlocked<L: Lanes>(locks: u32, p: Vec3<L>) -> Vec3<L> {
    let free = |x, bits: u32| L::select(L::Mask::from_bits(bits & 0xff), L::zero(), x);
    Vec3::new(free(p.x, locks), free(p.y, locks >> 8), free(p.z, locks >> 16))
}

/// The bits of a lane in [`Batch::locks`], from those of a body.
pub(crate) fn lock_bits(locks: u8, lane: usize) -> u32 {
    (0..3).map(|axis| u32::from(locks >> axis & 1) << (8 * axis + lane)).sum()
}

/// Index of a pair of points in [`Batch::coupling`]; `i < k`.
const fn couple(i: usize, k: usize) -> usize {
    k * (k - 1) / 2 + i
}

/// A batch by its number of points and its index among those.
#[derive(Clone, Copy, Debug)]
pub(crate) struct BatchRef {
    /// 1 to 4; 0 for a batch of one lane.
    pub(crate) points: u8,
    /// Its contacts are those of one node of a batch of trees, each in the lane of its tree.
    pub(crate) in_tree: bool,
    pub(crate) index: u32,
    /// Its index in the buffers of friction, if there is any: among touching or potential contacts of its
    /// width.
    pub(crate) friction: u32,
}

/// Checked for all types of batches.
const _: () = {
    let () = Batch::<f32x8, 1, 0>::NO_GAPS;
    let () = Batch::<f32x8, 2, 0>::NO_GAPS;
    let () = Batch::<f32x8, 3, 0>::NO_GAPS;
    let () = Batch::<f32x8, 4, 0>::NO_GAPS;
    let () = Batch::<f32, 4, 0>::NO_GAPS;
    let () = Batch::<f32x8, 1, 1>::NO_GAPS;
    let () = Batch::<f32x8, 2, 1>::NO_GAPS;
    let () = Batch::<f32x8, 3, 1>::NO_GAPS;
    let () = Batch::<f32x8, 4, 1>::NO_GAPS;
    let () = Batch::<f32, 4, 1>::NO_GAPS;
};
