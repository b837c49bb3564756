//! The friction of an impact: of what potential points push before it touches.

use super::batch::{Batch, BatchRef};
use super::contact_row::{Motion, Pair, Pass};
use super::friction::FrictionView;
use super::order::Group;
use crate::lanes::{GatherLanes, Lanes, Mask, Vec3};

/// Friction of impacts, after a substep in which potential points pushed: against the slip that is left there, and bounded
/// by what they bore. They have no friction while rows are solved, so that nothing rubs on what it might have missed; but
/// what they did push was touched, and its friction is due. A ball that lands at an angle would skid on as on ice.
///
/// The velocities before any row acted take the same change: what they lack is what warm starting repeats. Says whether
/// the change is one that shifts loads.
///
/// # Safety
/// The bodies of the batch that it may write are in no other batch of the stage.
#[inline(never)]
pub(crate) unsafe fn rub<L: GatherLanes, const P: usize, const TWO: bool>(
    batch: &Batch<L, P>,
    (friction, of, group): (&FrictionView<'_, L>, BatchRef, Group),
    motion: &Motion<'_, '_>,
    pass: &Pass<'_>,
) -> bool {
    let (load, arm) = potential_load(batch);
    let pushed = load.gt(L::zero());
    if !pushed.any() {
        return false;
    }
    // SAFETY: by the contract.
    let mut v = unsafe { Pair::load::<TWO>([&batch.a, &batch.b], motion.velocity) };
    let n = batch.normal;
    // SAFETY: by the contract.
    let f = unsafe { friction.of_impact(of, group, n) };
    // Where the load was: n x (r x n) is r without its part along n, which all points share.
    let aside = n.cross(arm) * L::select(pushed, L::one() / load, L::zero());
    let arm_a = aside + n * f.along;
    let arm_b = arm_a + f.to_b;
    let mut u = -(v.va + v.wa.cross(arm_a));
    if TWO {
        u += v.vb + v.wb.cross(arm_b);
    }
    let u = u - n * n.dot(u);
    let speed = u.length();
    let slides = speed.gt(L::zero());
    let way = u * L::select(slides, L::one() / speed, L::zero());
    let (ta, tb) = (arm_a.cross(way), arm_b.cross(way));
    let mut k = batch.inverse_mass_a + ta.dot(batch.inverse_inertia_a.mul(ta));
    if TWO {
        k += batch.inverse_mass_b + tb.dot(batch.inverse_inertia_b.mul(tb));
    }
    // No more than stops the slip: so it takes energy and never adds any.
    let most = L::select(slides & k.gt(L::zero()), speed / k, L::zero());
    let p = -(load * f.coefficient).min(most);
    v.apply::<P, TWO>(batch, way * p, ta * p, tb * p);
    // SAFETY: by the contract.
    let mut b = unsafe { Pair::load::<TWO>([&batch.a, &batch.b], motion.base) };
    b.apply::<P, TWO>(batch, way * p, ta * p, tb * p);
    // SAFETY: by the contract.
    unsafe {
        v.save::<TWO>([&batch.a, &batch.b], [batch.write_a, batch.write_b], motion.velocity);
        b.save::<TWO>([&batch.a, &batch.b], [batch.write_a, batch.write_b], motion.base);
    }
    (p.abs() * k).gt(L::splat(pass.shift)).any()
}

/// What potential points bear, and the sum of their arms x loads.
#[inline(always)]
pub(super) fn potential_load<L: Lanes, const P: usize>(batch: &Batch<L, P>) -> (L, Vec3<L>) {
    batch.points.iter().fold((L::zero(), Vec3::zero()), |(sum, arm), point| {
        let load = point.impulse * (L::one() - point.real);
        (sum + load, arm + point.arm_a * load)
    })
}
