//! Soft contacts: where a material yields, a spring acts instead of a rigid row.
//!
//! The spring is a force of its own and not a softened constraint: its impulse over a substep follows from
//! where the surfaces are at both ends of it ([`spring`]), so that the depth at which a body rests and the
//! energy with which it comes back depend neither on the length of the substep nor on iterations. Its lanes
//! have no slop, no lasting force and no limit of push speed; relaxation leaves them alone. Above the surface
//! nothing acts, below it the spring alone, up to a depth at which the surfaces are rigid.
//!
//! A batch with a soft lane is solved by a kernel of its own ([`solve_soft`]), in which other lanes are rigid
//! rows as everywhere. It moves bodies by the mean of their velocities at both ends of a substep, where
//! nothing but soft contacts holds them ([`bodies`]): only so can the spring conserve energy.

pub(crate) mod bodies;
mod row;
mod spring;

use super::batch::Batch;
use super::friction::impact::potential_load;
use super::friction::rows::{follow_load, solve_friction};
use super::friction::{FrictionRow, RollingRow};
use super::row::{BodyPair, Free, ImpulseChange, Motion, NormalRows, Pass, relative, row as spin};
use crate::lanes::{GatherLanes, Mask, kernel};
pub(crate) use row::SoftRow;
pub(in crate::constraint::contact) use row::fill_soft;
use spring::{Course, Spring};

/// Sweeps over the points of a manifold in a pass: the springs of a body that lands flat share its weight.
const SWEEPS: usize = 3;

kernel! {
    /// The step of [`solve`](super::row::solve) for a batch with soft lanes. A function of its own: few
    /// scenes need its code.
    ///
    /// # Safety
    /// As for `solve`.
    pub(crate) unsafe fn solve_soft<'a, L: GatherLanes, const P: usize, const B: usize, const FRICTION: bool>(
        batch: &'a mut Batch<L, P, B>,
        friction: Option<&'a mut FrictionRow<L, B>>,
        rolling: Option<&'a mut RollingRow>,
        soft: &'a mut SoftRow,
        motion: &'a Motion<'a, 'a>,
        pass: &'a Pass<'a>,
    ) -> bool {
        // SAFETY: by the contract.
        let (mut v, base) =
            unsafe { (BodyPair::load(batch, motion.velocity), BodyPair::load(batch, motion.base)) };
        let mut slid = None;
        if FRICTION && let Some(f) = friction {
            let which = solve_friction::<L, P, B, Free>(batch, f, rolling, &mut v, pass, &mut Free);
            slid = Some((f, which));
        }
        let mut rows = NormalRows::new(batch, &v, pass, &Free);
        solve_rows(&mut rows, batch, soft, &base, pass);
        let ImpulseChange { sum, moment_a, moment_b } = rows.store::<B, FRICTION>(batch);
        v.apply(batch, batch.normal * sum, moment_a, moment_b);
        if FRICTION
            && pass.relax
            && let Some((f, which)) = slid
        {
            follow_load(batch, f, which, &mut v, pass, &mut Free);
        }
        // SAFETY: by the contract.
        unsafe { v.save(batch, motion.velocity) };
        pass.relax && potential_load(batch, pass.touch_distance).0.gt(L::zero()).any()
    }
}

/// Solves the normal rows: springs in soft lanes, rigid rows in the others. `base`: velocities before any row
/// acted.
#[inline(always)]
#[allow(clippy::needless_range_loop, reason = "several arrays by point")]
fn solve_rows<L: GatherLanes, const P: usize, const B: usize>(
    rows: &mut NormalRows<L, P>,
    batch: &Batch<L, P, B>,
    soft: &mut SoftRow,
    base: &BodyPair<L>,
    pass: &Pass<'_>,
) {
    let is_soft = L::load(&soft.soft).gt(L::zero());
    if P > 1 {
        let (push, on) = rows.level(batch, &Free);
        let push = L::select(is_soft, L::zero(), push);
        for i in 0..P {
            let change = push * on[i];
            rows.impulse[i] += change;
            rows.accelerate(batch, &Free, i, change);
        }
    }
    let speed = relative::<L, B>(batch.normal, base);
    let (h, stop) = (L::splat(1.0 / pass.inverse_h), L::load(&soft.stop));
    let start_share = L::load(&soft.start_share);
    for _ in 0..SWEEPS {
        for i in 0..P {
            let (point, own) = (&batch.points[i], rows.impulse[i]);
            let spring = Spring { rate: L::load(&soft.rate[i]), drag: L::load(&soft.drag[i]) };
            let new = if pass.relax {
                // A body that the stop threw back keeps only the velocity that the spring gives it.
                let held = L::load(&soft.held[i]).gt(L::zero());
                let least = (spring.rate * -point.now).max(L::zero()).min(own);
                L::select(held, (own - point.mass * rows.u[i]).max(least), own)
            } else {
                // The velocity that moves the bodies is `start + gain * impulse` over h, with the velocity
                // at the start of the substep and the one at its end each at its share.
                let start = speed + spin::<L, B>(base, point) - L::load(&soft.pull[i]);
                let free = rows.u[i] - own * point.stiffness;
                let course = Course {
                    from: point.now,
                    free_way: h * (start_share * start + (L::one() - start_share) * free),
                    gain: h * (L::one() - start_share) * point.stiffness,
                };
                let impulse = spring.impulse(&course);
                // At the stop overlap grows no further; deeper overlap is pushed apart.
                let least = (-(stop + point.now)).min(h * L::splat(pass.push_speed));
                let stopping = (least - course.free_way) / course.gain;
                let held = stopping.gt(impulse);
                L::select(held, L::one(), L::zero()).store(&mut soft.held[i]);
                L::select(held, stopping, impulse)
            };
            // A lane without a point is far apart, and its numbers are none.
            let new = L::select(point.mass.gt(L::zero()), new, L::zero()).max(L::zero());
            rows.impulse[i] = L::select(is_soft, new, rows.solved(batch, i));
            rows.accelerate(batch, &Free, i, rows.impulse[i] - own);
        }
    }
}
