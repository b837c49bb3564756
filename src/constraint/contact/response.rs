//! How the bodies of a batch respond to impulses.

use super::batch::Batch;
use super::body_pair::BodyPair;
use super::friction::FrictionRow;
use crate::lanes::{GatherLanes, Vec3};

/// By how much impulses of a batch change the velocities of its bodies.
pub(crate) trait Response<L: GatherLanes, const P: usize, const B: usize> {
    /// Effective mass of a point's row [kg]; zero without a point.
    #[inline(always)]
    fn mass(&self, batch: &Batch<L, P, B>, i: usize) -> L {
        batch.points[i].mass
    }
    /// By how much a unit impulse at one point changes the normal velocity of another [1/kg].
    #[inline(always)]
    fn stiffness(&self, batch: &Batch<L, P, B>, i: usize, k: usize) -> L {
        if i == k { batch.points[i].stiffness } else { batch.coupling(i.min(k), i.max(k)) }
    }
    #[inline(always)]
    fn friction(&self, f: &FrictionRow<L, B>) -> FrictionResponse<L> {
        let FrictionRow { mass, slide_mass, twist_mass, twist_by, .. } = *f;
        FrictionResponse { mass, slide_mass, twist_mass, twist_by }
    }
    /// Applies an impulse `p` on `b` and `-p` on `a`, with angular impulses `ta` (taken from `a`) and `tb`.
    #[inline(always)]
    fn apply(&mut self, batch: &Batch<L, P, B>, v: &mut BodyPair<L>, p: Vec3<L>, ta: Vec3<L>, tb: Vec3<L>) {
        v.apply(batch, p, ta, tb);
    }
}

/// The response of bodies to friction; see the fields of [`FrictionRow`].
#[derive(Clone, Copy)]
pub(crate) struct FrictionResponse<L> {
    pub(crate) mass: [L; 3],
    pub(crate) slide_mass: L,
    pub(crate) twist_mass: L,
    pub(crate) twist_by: [L; 2],
}

/// The response of two bodies that nothing else holds.
pub(crate) struct Free;

impl<L: GatherLanes, const P: usize, const B: usize> Response<L, P, B> for Free {}
