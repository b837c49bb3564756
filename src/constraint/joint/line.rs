//! Locks a point of the second body to a line of the first: sliders, and the hubs of wheels. Its two
//! directions are solved together, and turn with the first body.

use super::batch::{JointBatch, Report};
use super::ends::{Ends, JointPass, Recovery, across, seen};
use super::lock::{PointBatch, mobility};
use crate::constraint::contact::row::BodyPair;
use crate::lanes::{GatherLanes, Lanes, Vec3, turned};

/// Points on lines.
#[derive(Clone, Copy, Debug)]
#[repr(C)]
pub(crate) struct LineBatch<L> {
    /// After the last substep both arms are to the second body's point, and of the separation only the part
    /// across the line is left. The effective mass is that across the line.
    pub(crate) point: PointBatch<L>,
    /// Direction of the line at the start of the step, and after the last substep.
    pub(crate) axis: Vec3<L>,
    pub(crate) axis_now: Vec3<L>,
}

impl<L: Lanes> Default for LineBatch<L> {
    #[inline(always)]
    fn default() -> Self {
        let axis = Vec3::new(L::one(), L::zero(), L::zero());
        LineBatch { point: PointBatch::default(), axis, axis_now: Vec3::zero() }
    }
}

impl<L: GatherLanes> LineBatch<L> {
    /// Initialises the batch at the start of a step.
    pub(crate) fn begin(&mut self) {
        let zero = Vec3::zero();
        self.follow(&BodyPair { va: zero, wa: zero, vb: zero, wb: zero });
        self.bear();
        self.point.moment = self.moments();
    }

    /// Moments of the impulse at the arms of this substep [N m s].
    #[inline(always)]
    fn moments(&self) -> [Vec3<L>; 2] {
        let [a, b] = self.point.arm_now;
        [a.cross(self.point.impulse), b.cross(self.point.impulse)]
    }

    /// Removes the impulse along the line, where nothing is transmitted, and returns it.
    #[inline(always)]
    fn bear(&mut self) -> Vec3<L> {
        let PointBatch { impulse, lasting, .. } = &mut self.point;
        let along = self.axis_now * self.axis_now.dot(*impulse);
        *impulse -= along;
        *lasting -= self.axis_now * self.axis_now.dot(*lasting);
        along
    }
}

impl<L: GatherLanes> JointBatch<L> for LineBatch<L> {
    const IS_LOCK: bool = true;
    const SLIDES: bool = true;

    fn ends(&self) -> &Ends<L> {
        &self.point.ends
    }

    #[inline(always)]
    fn follow(&mut self, d: &BodyPair<L>) {
        let point = &mut self.point;
        let [ra, rb] = point.arm;
        let (now_a, now_b) = (turned(d.wa, ra), turned(d.wb, rb));
        let apart = point.apart + (d.vb - d.va) + (now_b - rb) - (now_a - ra);
        self.axis_now = turned(d.wa, self.axis);
        point.arm_now = [now_a + apart, now_b];
        point.apart_now = apart - self.axis_now * self.axis_now.dot(apart);
        point.mass = across(&mobility(&point.ends, &point.arm_now), self.axis_now);
    }

    #[inline(always)]
    fn apply(&self, v: &mut BodyPair<L>) {
        self.point.ends.apply(v, self.point.impulse, self.point.moment[0], self.point.moment[1]);
    }

    #[inline(always)]
    fn sweep(&mut self, v: &mut BodyPair<L>, pass: &JointPass) {
        if !pass.relax {
            // As for points: turns the impulses of the last substep with the bodies.
            let along = self.bear();
            let moment = self.moments();
            let [ta, tb] = [moment[0] - self.point.moment[0], moment[1] - self.point.moment[1]];
            self.point.ends.apply(v, -along, ta, tb);
            self.point.moment = moment;
        }
        let slip = seen(v, &self.point.arm_now, pass.ahead());
        self.point.stop(v, slip);
    }

    #[inline(always)]
    fn correct(&self, d: &mut BodyPair<L>, most: Recovery) {
        self.point.correct(d, most);
    }

    #[cfg(feature = "observe")]
    fn acted(&self) -> (Vec3<L>, [Vec3<L>; 2]) {
        self.point.acted()
    }

    fn report(&self, lane: usize, to: &mut impl Report) {
        self.point.report(lane, to);
    }
}
