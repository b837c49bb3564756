//! Friction of impacts, for potential points that pushed before they touched.

use super::super::batch::{Batch, BatchRef};
use super::super::body_pair::{BodyPair, Motion};
use super::super::pass::Pass;
use super::FrictionView;
use crate::constraint::schedule::order::Group;
use crate::lanes::{GatherLanes, Lanes, Mask, Vec3, kernel};

kernel! {
    /// Applies friction after a substep in which potential points pushed: against the slip that remains, and
    /// bounded by their load. They have no friction while rows are solved, so that a near miss causes none;
    /// but where they pushed, the surfaces did touch, and friction is due. Without it a ball that lands at an
    /// angle would skid as on ice.
    ///
    /// The velocities before any row acted are changed in the same direction, as warm starting does not
    /// repeat this impulse. Returns whether the change shifts loads.
    ///
    /// # Safety
    /// The bodies of the batch that it may write are in no other batch of the stage.
    pub(crate) unsafe fn solve_impact_friction<'a, L: GatherLanes, const P: usize, const B: usize>(
        batch: &'a Batch<L, P, B>,
        friction: &'a FrictionView<'a, L, B>,
        of: BatchRef,
        group: Group,
        motion: &'a Motion<'a, 'a>,
        pass: &'a Pass<'a>,
    ) -> bool {
        let (load, arm) = potential_load(batch, pass.touch_distance);
        let pushed = load.gt(L::zero());
        if !pushed.any() {
            return false;
        }
        // SAFETY: by the contract.
        let mut v = unsafe { BodyPair::load(batch, motion.velocity) };
        let n = batch.normal;
        // SAFETY: by the contract.
        let f = unsafe { friction.of_impact(of, group, n) };
        // The centre of load: n x (r x n) is r without its component along n, which all points share.
        let aside = n.cross(arm) * L::select(pushed, L::one() / load, L::zero());
        let arm_a = aside + n * f.along;
        let arm_b = if B > 0 { arm_a + f.to_b[0] } else { arm_a };
        let mut u = -(v.va + v.wa.cross(arm_a));
        if B > 0 {
            u += v.vb + v.wb.cross(arm_b);
        }
        if let Some([x, y]) = pass.surfaces.get(batch.surface as usize) {
            let (t1, t2) = n.tangents();
            u += t1 * L::load(x) + t2 * L::load(y);
        }
        let u = u - n * n.dot(u);
        let speed = u.length();
        let slides = speed.gt(L::zero());
        let direction = u * L::select(slides, L::one() / speed, L::zero());
        let (ta, tb) = (arm_a.cross(direction), arm_b.cross(direction));
        let [on_a, on_b] = batch.moving(direction);
        let mut k = on_a.length_squared() * batch.inverse_mass_a + ta.dot(batch.inverse_inertia_a.mul(ta));
        if B > 0 {
            k += on_b.length_squared() * batch.b[0].inverse_mass + tb.dot(batch.b[0].inverse_inertia.mul(tb));
        }
        // No more than stops the slip: where no surface moves, it removes energy and never adds any.
        let most = L::select(slides & k.gt(L::zero()), speed / k, L::zero());
        let p = -(load * f.coefficient).min(most);
        v.apply(batch, direction * p, ta * p, tb * p);
        // SAFETY: by the contract.
        let mut b = unsafe { BodyPair::load(batch, motion.base) };
        b.apply(batch, direction * p, ta * p, tb * p);
        // SAFETY: by the contract.
        unsafe {
            v.save(batch, motion.velocity);
            b.save(batch, motion.base);
        }
        (p.abs() * k).gt(L::splat(pass.load_shift_speed)).any()
    }
}

/// The load of potential points, and the sum of their arms x loads. `real`: a point with a separation up to
/// this touches [m].
#[inline(always)]
pub(crate) fn potential_load<L: Lanes, const P: usize, const B: usize>(
    batch: &Batch<L, P, B>,
    real: f32,
) -> (L, Vec3<L>) {
    let (mut sum, mut arm) = (L::zero(), Vec3::zero());
    for point in &batch.points {
        let load = L::select(point.separation.le(L::splat(real)), L::zero(), point.impulse);
        sum += load;
        arm += point.arm_a * load;
    }
    (sum, arm)
}
