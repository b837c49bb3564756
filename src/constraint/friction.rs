//! Friction of batches, in buffers of their own: a scene in which nothing rubs has none of it, and no pass over its rows
//! comes past any.

use super::batch::BatchRef;
use super::order::Group;
use crate::lanes::{Lanes, Vec3, f32x8};
use crate::memory::bytes_of;
use crate::threads::Shared;

/// Friction of a manifold that touches, at its centre: two rows along the tangents and one against twist.
#[derive(Clone, Copy, Debug, Default)]
#[repr(C)]
pub(crate) struct FrictionRow<L> {
    pub(crate) tangent: Vec3<L>,
    pub(crate) arm_a: Vec3<L>,
    pub(crate) arm_b: Vec3<L>,
    /// Inverse of the 2x2 matrix of the tangential rows [kg]: (11, 12, 22).
    pub(crate) mass: [L; 3],
    /// The smaller eigenvalue of that inverse [kg]: a step against the slip that never overshoots.
    pub(crate) slide_mass: L,
    pub(crate) twist_mass: L,
    /// Mean distance of the points from the centre: the lever of twist [m].
    pub(crate) radius: L,
    pub(crate) coefficient: L,
    /// [N s]
    pub(crate) impulse: [L; 2],
    /// [N m s]
    pub(crate) twist: L,
}

/// What the friction of an impact takes: all that is kept of a manifold that may touch, which rubs on nothing before it does.
#[derive(Clone, Copy, Debug, Default)]
#[repr(C)]
pub(crate) struct ImpactRow<L> {
    /// Of the arm of body `a` the part along the normal, which all points share [m].
    pub(crate) along: L,
    /// From the arm of body `a` to that of body `b` [m].
    pub(crate) to_b: Vec3<L>,
    pub(crate) coefficient: L,
}

impl<L: Lanes> FrictionRow<L> {
    /// What of it the friction of an impact takes.
    #[inline(always)]
    pub(super) fn of_impact(&self, normal: Vec3<L>) -> ImpactRow<L> {
        ImpactRow {
            along: normal.dot(self.arm_a),
            to_b: self.arm_b - self.arm_a,
            coefficient: self.coefficient,
        }
    }
}

/// Friction of batches of one width.
#[derive(Debug, Default)]
pub(crate) struct FrictionRows<L> {
    /// Of batches of contacts that touch, and of those that may.
    pub(crate) rows: Vec<FrictionRow<L>>,
    pub(crate) impacts: Vec<ImpactRow<L>>,
}

/// All friction of a step; nothing where no shape has any.
#[derive(Debug, Default)]
pub(crate) struct Friction {
    /// Whether there is any.
    pub(crate) needed: bool,
    pub(crate) lanes: FrictionRows<f32x8>,
    pub(crate) single: FrictionRows<f32>,
}

impl Friction {
    /// Live and reserved bytes.
    pub(crate) fn bytes(&self) -> (usize, usize) {
        let of = [
            bytes_of(&self.lanes.rows),
            bytes_of(&self.lanes.impacts),
            bytes_of(&self.single.rows),
            bytes_of(&self.single.impacts),
        ];
        of.into_iter().fold((0, 0), |s, b| (s.0 + b.0, s.1 + b.1))
    }

    /// Whether contacts rub from now on; if not, their place is given back.
    pub(crate) fn set_needed(&mut self, needed: bool) {
        if self.needed != needed {
            *self = Friction { needed, ..Friction::default() };
        }
    }
}

/// The friction of a batch, to be filled.
pub(super) enum Rub<'a, L> {
    Nothing,
    Touching(&'a mut FrictionRow<L>),
    Impact(&'a mut ImpactRow<L>),
}

/// Friction of batches of one width, for several threads.
pub(crate) struct FrictionView<'a, L> {
    needed: bool,
    rows: Shared<'a, FrictionRow<L>>,
    impacts: Shared<'a, ImpactRow<L>>,
}

impl<'a, L: Lanes> FrictionView<'a, L> {
    pub(super) fn new(needed: bool, of: &'a mut FrictionRows<L>) -> Self {
        FrictionView { needed, rows: Shared::new(&mut of.rows), impacts: Shared::new(&mut of.impacts) }
    }

    /// The rows of a batch of contacts that touch; nothing if there is no friction.
    ///
    /// # Safety
    /// No other thread works on the batch.
    #[inline(always)]
    #[allow(clippy::mut_from_ref, reason = "the contract is the caller's, see `Shared::get`")]
    pub(crate) unsafe fn touching(&self, batch: BatchRef) -> Option<&mut FrictionRow<L>> {
        // SAFETY: by the contract; each batch has rows of its own.
        if self.needed { Some(unsafe { self.rows.get(batch.friction as usize) }) } else { None }
    }

    /// What the friction of impacts takes of a batch whose contacts bear load before they touch.
    ///
    /// # Safety
    /// No other thread works on the batch.
    #[inline(always)]
    pub(crate) unsafe fn of_impact(&self, batch: BatchRef, group: Group, normal: Vec3<L>) -> ImpactRow<L> {
        let i = batch.friction as usize;
        // SAFETY: by the contract; each batch has rows of its own.
        unsafe {
            if group.is_potential() { *self.impacts.get(i) } else { self.rows.get(i).of_impact(normal) }
        }
    }

    /// # Safety
    /// As for [`FrictionView::touching`].
    #[inline(always)]
    pub(super) unsafe fn to_fill(&self, batch: BatchRef, group: Group) -> Rub<'_, L> {
        let i = batch.friction as usize;
        // SAFETY: by the contract; each batch has rows of its own.
        unsafe {
            match (self.needed, group.is_potential()) {
                (false, _) => Rub::Nothing,
                (true, false) => Rub::Touching(self.rows.get(i)),
                (true, true) => Rub::Impact(self.impacts.get(i)),
            }
        }
    }
}
