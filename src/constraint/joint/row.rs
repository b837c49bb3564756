//! Rows of joints with one direction: limits that have a width, springs beyond them, motors, friction.
//!
//! A spring with stiffness k and damping c is solved implicitly, so that it is stable for any values: with d
//! = h k + c, its impulse obeys p = h (c target - k displacement - d speed), where `speed` is that after the
//! impulse.

use super::batch::{JointBatch, Report, RowImpulse};
use super::ends::{Ends, JointPass, Lever};
use super::measure::Measure;
use super::spring::{ENDLESS, Spring, before_stops};
use crate::constraint::contact::row::BodyPair;
use crate::lanes::{GatherLanes, Lanes, Mask, Vec3, turned};
use bytemuck::Zeroable;

/// Up to eight rows.
#[derive(Clone, Copy, Debug, Zeroable)]
#[repr(C)]
pub(crate) struct RowBatch<L, M> {
    pub(crate) ends: Ends<L>,
    pub(crate) measure: M,
    /// From each centre of mass to the second body's point, at the start of the step [m].
    pub(crate) arm: [Vec3<L>; 2],
    /// The impulse of the joint's own locks per impulse of the row, which keeps them closed: force and
    /// torque, at the start of the step.
    pub(crate) borne: [Vec3<L>; 2],
    /// The direction in which velocities change the displacement, after the last substep.
    pub(crate) lever: Lever<L>,
    /// Speed per impulse [1/kg] or [1/(kg m²)].
    pub(crate) mobility: L,
    /// Displacement at the start of the step, and after the last substep [m] or [rad].
    pub(crate) value: L,
    pub(crate) now: L,
    /// Range; for a motor both ends are its target.
    pub(crate) min: L,
    pub(crate) max: L,
    /// Where rigid ends of the joint's own range stop a motor; infinite for all other rows.
    pub(crate) stops: [L; 2],
    pub(crate) spring: Spring<L>,
    /// Impulses of the last substep at the lower and the upper end; a motor has the first only.
    pub(crate) impulse: [L; 2],
    /// The impulse as it was applied, part by part, while directions turned: its force, and the moments [N
    /// s], [N m s].
    acted: Vec3<L>,
    moment: [Vec3<L>; 2],
    /// The lasting part of the impulse at the lower end less that at the upper one, which does not yield.
    pub(crate) lasting: L,
    /// Lanes of motors, of springs, and of ranges without width.
    pub(crate) drives: u32,
    pub(crate) springs: u32,
    pub(crate) both: u32,
}

impl<L: Lanes, M: Default + Zeroable> Default for RowBatch<L, M> {
    #[inline(always)]
    fn default() -> Self {
        RowBatch {
            ends: Ends::default(),
            measure: M::default(),
            mobility: L::one(),
            min: L::splat(f32::NEG_INFINITY),
            max: L::splat(f32::INFINITY),
            stops: ENDLESS.map(L::splat),
            ..Zeroable::zeroed()
        }
    }
}

impl<L: GatherLanes, M: Measure<L>> RowBatch<L, M> {
    /// Initialises directions at the start of a step.
    pub(crate) fn begin(&mut self) {
        let zero = Vec3::zero();
        self.follow(&BodyPair { va: zero, wa: zero, vb: zero, wb: zero });
    }

    /// Initialises the impulses of the last step.
    pub(crate) fn resume(&mut self) {
        (self.acted, self.moment) = self.parts(self.impulse[0] - self.impulse[1]);
    }

    /// Force and moments of an impulse.
    #[inline(always)]
    fn parts(&self, p: L) -> (Vec3<L>, [Vec3<L>; 2]) {
        let [a, b] = self.lever.moments();
        (self.lever.force * p, [a * p, b * p])
    }
}

/// Quantities that both ends of rows are solved with.
struct End<L: Lanes> {
    drives: L::Mask,
    springs: L::Mask,
    both: L::Mask,
    /// Lanes that keep their impulse in this pass.
    waits: L::Mask,
    inverse_h: L,
    rate: L,
    scale: L,
    yields: L,
    push: L,
}

impl<L: Lanes> End<L> {
    /// The impulse at an end that is `gap` away.
    #[inline(always)]
    fn solve<M>(
        &self,
        row: &RowBatch<L, M>,
        gap: L,
        speed: L,
        requested: L,
        (old, lasting): (L, L),
        (low, high): (L, L),
    ) -> L {
        let &End { drives, springs, both, waits, inverse_h, rate, scale, yields, push } = self;
        let open = gap.gt(L::zero()) & !both;
        // Away from a rigid end, only the speed that would pass it within the substep is removed.
        let rigid = L::select(open, -(gap * inverse_h), -(gap * rate).max(-push).min(push));
        let soft = requested - gap * row.spring.pull;
        let target = L::select(drives | springs, soft, rigid);
        let give = row.spring.give;
        let change = (target - speed - give * old) / (row.mobility + give);
        let change = L::select(drives | springs | open, change, change * scale - (old - lasting) * yields);
        let mut new = (old + change).max(low).min(high);
        // A spring at the end of a range does not act inside of it.
        new = L::select(springs & open, L::zero(), new);
        L::select(waits, old, new)
    }
}

impl<L: GatherLanes, M: Measure<L>> JointBatch<L> for RowBatch<L, M> {
    const IS_LOCK: bool = false;
    const SLIDES: bool = !M::IS_ANGLE;

    fn ends(&self) -> &Ends<L> {
        &self.ends
    }

    #[inline(always)]
    fn follow(&mut self, d: &BodyPair<L>) {
        let [at, rb] = self.arm;
        let now = turned(d.wb, rb);
        self.lever.arm = [at + (d.vb - d.va) + (now - rb), now];
        self.now = self.measure.follow(d, &mut self.lever, self.value);
        let [force, torque] = self.borne;
        self.lever.force += turned(d.wa, force);
        self.lever.torque += turned(d.wa, torque);
        let mobility = self.ends.mobility(&self.lever);
        self.mobility = L::select(mobility.gt(L::zero()), mobility, L::one());
    }

    #[inline(always)]
    fn apply(&self, v: &mut BodyPair<L>) {
        self.ends.apply(v, self.acted, self.moment[0], self.moment[1]);
    }

    /// The lower end, then the upper one.
    #[inline(always)]
    fn sweep(&mut self, v: &mut BodyPair<L>, pass: &JointPass) {
        let (zero, none) = (L::zero(), L::splat(f32::NEG_INFINITY));
        let (drives, springs, both) = (
            L::Mask::from_bits(self.drives),
            L::Mask::from_bits(self.springs),
            L::Mask::from_bits(self.both),
        );
        if !pass.relax {
            // As for locks: turns the impulses of the last substep with the bodies.
            let (force, [ta, tb]) = self.parts(self.impulse[0] - self.impulse[1]);
            let turn = [ta - self.moment[0], tb - self.moment[1]];
            self.ends.apply(v, force - self.acted, turn[0], turn[1]);
            (self.acted, self.moment) = (force, [ta, tb]);
        }
        let mut speed = self.lever.speed(v);
        if !pass.relax {
            speed += self.measure.bend(v, &self.lever, pass.ahead());
        }
        // Springs act once per substep; a motor that stops has its speed when velocities relax, too.
        let waits = if pass.relax {
            let stops = self.stops[1].lt(L::splat(f32::INFINITY)) | self.stops[0].gt(none);
            (drives & !stops) | springs
        } else {
            zero.gt(zero)
        };
        let inverse_h = L::splat(pass.inverse_h);
        let (rate, scale, yields) = pass.numbers::<L>();
        let push = L::splat(if M::IS_ANGLE { pass.recovery.angular } else { pass.recovery.linear });
        // Signs are those of the lower end; the upper one is its mirror image.
        let mut pushed = zero;
        let end = End { drives, springs, both, waits, inverse_h, rate, scale, yields, push };
        let lowest = L::select(drives, -self.spring.most, L::select(both, none, zero));
        let highest = L::select(drives, self.spring.most, L::splat(f32::INFINITY));
        // A range has one loaded end; one without width may bear either way.
        let lower = L::select(both, self.lasting, self.lasting.max(zero));
        let finite = |gap: L| L::select(gap.lt(L::splat(f32::MAX)), gap, L::splat(f32::MAX));
        let requested = if self.drives == 0 {
            self.spring.speed
        } else {
            before_stops(self.spring.speed, self.now, &self.stops, inverse_h, [rate, push])
        };
        let gap = finite(self.now - self.min);
        let new = end.solve(self, gap, speed, requested, (self.impulse[0], lower), (lowest, highest));
        let change = new - self.impulse[0];
        self.impulse[0] = new;
        pushed += change;
        let speed = -(speed + self.mobility * change);
        let idle = drives | both;
        let new = end.solve(
            self,
            finite(self.max - self.now),
            speed,
            zero,
            (self.impulse[1], (-self.lasting).max(zero)),
            (zero, L::splat(f32::INFINITY)),
        );
        let new = L::select(idle, zero, new);
        pushed -= new - self.impulse[1];
        self.impulse[1] = new;
        let (force, [ta, tb]) = self.parts(pushed);
        self.acted += force;
        self.moment[0] += ta;
        self.moment[1] += tb;
        self.ends.apply(v, force, ta, tb);
    }

    #[cfg(feature = "observe")]
    fn acted(&self) -> (Vec3<L>, [Vec3<L>; 2]) {
        (self.acted, self.moment)
    }

    fn report(&self, lane: usize, to: &mut impl Report) {
        let ends = self.impulse.map(|p| p.lane(lane));
        let (force, torque) = (self.lever.force.lane(lane), self.lever.torque.lane(lane));
        to.row(self.ends.owner[lane], RowImpulse { ends, force, torque, now: Some(self.now.lane(lane)) });
    }
}
