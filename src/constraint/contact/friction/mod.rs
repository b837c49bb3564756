//! Friction of batches. Kept in buffers of its own, so that scenes without friction pay nothing, and passes
//! over normal rows do not read it.

pub(crate) mod impact;
pub(super) mod rows;

use super::batch::BatchRef;
use crate::constraint::schedule::order::Group;
use crate::lanes::{GatherLanes, Lanes, Mask, Vec3, kernel, turned};
use crate::threads::Shared;
use bytemuck::{Pod, Zeroable};

/// Friction of a manifold that touches, at its centre: two rows along the tangents and one against twist.
#[derive(Clone, Copy, Debug)]
#[repr(C)]
pub(crate) struct FrictionRow<L, const B: usize> {
    pub(crate) tangent: Vec3<L>,
    pub(crate) arm_a: Vec3<L>,
    pub(crate) arm_b: [Vec3<L>; B],
    /// Inverse of the 2x2 matrix of the tangential rows [kg]: (11, 12, 22).
    pub(crate) mass: [L; 3],
    /// The smaller eigenvalue of that inverse [kg]: a step against the slip with it never overshoots.
    pub(crate) slide_mass: L,
    pub(crate) twist_mass: L,
    /// By how much unit impulses along the tangents change the twist [1/(kg m)].
    pub(crate) twist_by: [L; 2],
    /// Mean distance of the points from the centre, the lever arm of twist [m].
    pub(crate) radius: L,
    pub(crate) coefficient: L,
    /// [N s]
    pub(crate) impulse: [L; 2],
    /// [N m s]
    pub(crate) twist: L,
}

/// Data of a potential manifold for friction once it touches.
#[derive(Clone, Copy, Debug)]
#[repr(C)]
pub(crate) struct ImpactRow<L, const B: usize> {
    /// The component of the arm of body `a` along the normal, which all points share [m].
    pub(crate) along: L,
    /// From the arm of body `a` to that of body `b` [m].
    pub(crate) to_b: [Vec3<L>; B],
    pub(crate) coefficient: L,
}

/// Rows against rolling of a batch of touching contacts, about both tangents of its friction, and the
/// addition of spinning friction to the bound of its twist; a lane each. The torque against rolling is
/// bounded by a lever arm times the load: T. Pöschel et al., *Rolling friction of a hard cylinder on a
/// viscous plane* (1999), derive such an arm.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct RollingRow {
    /// Lever arms of the load against rolling and spinning [m].
    pub(crate) arm: [f32; 8],
    pub(crate) spin_arm: [f32; 8],
    /// Inverse of the 2x2 matrix of the rows [kg m²]: (11, 12, 22), and its smaller eigenvalue.
    pub(crate) mass: [[f32; 8]; 3],
    pub(crate) least_mass: [f32; 8],
    /// On body `b`, about the tangents [N m s].
    pub(crate) impulse: [[f32; 8]; 2],
}

impl RollingRow {
    /// The angular impulse on body `b` [N m s].
    #[inline(always)]
    pub(crate) fn on_b<L: Lanes>(&self, normal: Vec3<L>, tangent: Vec3<L>) -> Vec3<L> {
        let [x, y] = &self.impulse;
        tangent * L::load(x) + normal.cross(tangent) * L::load(y)
    }
}

// SAFETY: zero is a value of every field.
unsafe impl<L: Zeroable, const B: usize> Zeroable for FrictionRow<L, B> {}
// SAFETY: it is nothing but lanes, of which any bits are numbers, in the order of C.
unsafe impl<L: Lanes + Pod, const B: usize> Pod for FrictionRow<L, B> {}
// SAFETY: zero is a value of every field.
unsafe impl<L: Zeroable, const B: usize> Zeroable for ImpactRow<L, B> {}
// SAFETY: as for `FrictionRow`.
unsafe impl<L: Lanes + Pod, const B: usize> Pod for ImpactRow<L, B> {}

impl<L: Lanes, const B: usize> FrictionRow<L, B> {
    /// The part of it that friction of impacts needs.
    #[inline(always)]
    pub(crate) fn of_impact(&self, normal: Vec3<L>) -> ImpactRow<L, B> {
        ImpactRow {
            along: normal.dot(self.arm_a),
            to_b: self.arm_b.map(|arm_b| arm_b - self.arm_a),
            coefficient: self.coefficient,
        }
    }
}

kernel! {
    /// Takes the arms of bodies `b` that can't be pushed, those of `lanes`, on by a time, as these turn
    /// [rad/s], [s]. The direction in which ground carries turns within a step, and the carried bodies have
    /// to follow. Rows are solved for the middle of a substep, in which the body moves along the chord of its
    /// circle.
    #[cold]
    pub(crate) fn carry<'a, L: GatherLanes, const B: usize>(
        row: &'a mut FrictionRow<L, B>,
        lanes: u32,
        turn: &'a Vec3<L>,
        time: f32,
    ) {
        if B > 0 && lanes != 0 {
            let arm = row.arm_b[0];
            row.arm_b[0] = Vec3::select(L::Mask::from_bits(lanes), turned(*turn * L::splat(time), arm), arm);
        }
    }
}

/// The friction of a batch, to be filled.
pub(crate) enum FrictionToFill<'a, L, const B: usize> {
    None,
    Touching(&'a mut FrictionRow<L, B>),
    Impact(&'a mut ImpactRow<L, B>),
}

/// Friction of batches of one type, for several threads; empty where no shape has friction.
pub(crate) struct FrictionView<'a, L, const B: usize> {
    needed: bool,
    /// For batches of touching contacts, and of potential ones.
    rows: Shared<'a, FrictionRow<L, B>>,
    impacts: Shared<'a, ImpactRow<L, B>>,
}

impl<'a, L: Lanes, const B: usize> FrictionView<'a, L, B> {
    pub(crate) fn new(
        needed: bool,
        rows: &'a mut [FrictionRow<L, B>],
        impacts: &'a mut [ImpactRow<L, B>],
    ) -> Self {
        FrictionView { needed, rows: Shared::new(rows), impacts: Shared::new(impacts) }
    }

    /// The same lanes as another type.
    #[inline(always)]
    pub(crate) fn cast<W: Lanes + Pod>(&self) -> FrictionView<'_, W, B>
    where
        L: Pod,
    {
        FrictionView { needed: self.needed, rows: self.rows.cast(), impacts: self.impacts.cast() }
    }

    /// The rows of a batch of touching contacts; none if there is no friction.
    ///
    /// # Safety
    /// No other thread works on the batch.
    #[inline(always)]
    #[allow(clippy::mut_from_ref, reason = "the contract is the caller's, see `Shared::get`")]
    pub(crate) unsafe fn touching(&self, batch: BatchRef) -> Option<&mut FrictionRow<L, B>> {
        // SAFETY: by the contract; each batch has rows of its own.
        if self.needed { Some(unsafe { self.rows.get(batch.friction as usize) }) } else { None }
    }

    /// Data of a batch of potential contacts, if any shape has friction.
    ///
    /// # Safety
    /// No other thread works on the batch.
    #[cfg(feature = "observe")]
    pub(crate) unsafe fn impact(&self, batch: BatchRef) -> Option<ImpactRow<L, B>> {
        // SAFETY: by the contract; each batch has rows of its own.
        if self.needed { Some(unsafe { *self.impacts.get(batch.friction as usize) }) } else { None }
    }

    /// Input of the friction of impacts from a batch whose contacts bear load before they touch.
    ///
    /// # Safety
    /// No other thread works on the batch.
    #[inline(always)]
    pub(crate) unsafe fn of_impact(&self, batch: BatchRef, group: Group, normal: Vec3<L>) -> ImpactRow<L, B> {
        let i = batch.friction as usize;
        // SAFETY: by the contract; each batch has rows of its own.
        unsafe {
            if group.is_potential() { *self.impacts.get(i) } else { self.rows.get(i).of_impact(normal) }
        }
    }

    /// # Safety
    /// As for [`FrictionView::touching`].
    #[inline(always)]
    pub(crate) unsafe fn to_fill(&self, batch: BatchRef, group: Group) -> FrictionToFill<'_, L, B> {
        let i = batch.friction as usize;
        // SAFETY: by the contract; each batch has rows of its own.
        unsafe {
            match (self.needed, group.is_potential()) {
                (false, _) => FrictionToFill::None,
                (true, false) => FrictionToFill::Touching(self.rows.get(i)),
                (true, true) => FrictionToFill::Impact(self.impacts.get(i)),
            }
        }
    }
}
