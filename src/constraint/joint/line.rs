//! Locks a point of the second body to a line of the first: sliders, and the hubs of wheels. Its two
//! directions are solved together, and turn with the first body.

use super::arrange::JointInput;
use super::ends::{Ends, JointPass, Recovery, across, seen, turned};
use super::fill::fill_line;
use super::lock::{at_most, mobility};
use super::store::Report;
use super::table::JointBatch;
use crate::constraint::contact::row::BodyPair;
use crate::lanes::{GatherLanes, Lanes, Sym3, Vec3};

/// Points on lines.
#[derive(Clone, Copy, Debug)]
#[repr(C)]
pub(crate) struct LineBatch<L> {
    pub(crate) ends: Ends<L>,
    /// Direction of the line at the start of the step.
    pub(crate) axis: Vec3<L>,
    /// From each centre of mass to its own point, at the start of the step [m].
    pub(crate) arm: [Vec3<L>; 2],
    /// From the first point to the second, at the start of the step [m].
    pub(crate) apart: Vec3<L>,
    /// The same after the last substep; both arms are to the second body's point, and of the separation only
    /// the part across the line is left.
    pub(crate) axis_now: Vec3<L>,
    pub(crate) arm_now: [Vec3<L>; 2],
    apart_now: Vec3<L>,
    /// Moments of the impulse, at the arms at which its parts acted [N m s].
    pub(crate) moment: [Vec3<L>; 2],
    /// Impulse per velocity error, across the line [kg].
    mass: Sym3<L>,
    /// Impulse of the last substep [N s].
    pub(crate) impulse: Vec3<L>,
    /// The lasting part of it, which does not yield.
    pub(crate) lasting: Vec3<L>,
}

impl<L: Lanes> Default for LineBatch<L> {
    #[inline(always)]
    fn default() -> Self {
        let zero = Vec3::zero();
        LineBatch {
            ends: Ends::default(),
            axis: Vec3::new(L::one(), L::zero(), L::zero()),
            arm: [zero; 2],
            apart: zero,
            axis_now: zero,
            arm_now: [zero; 2],
            apart_now: zero,
            moment: [zero; 2],
            mass: Sym3::default(),
            impulse: zero,
            lasting: zero,
        }
    }
}

impl<L: GatherLanes> LineBatch<L> {
    /// Initialises the batch at the start of a step.
    pub(crate) fn begin(&mut self) {
        let zero = Vec3::zero();
        self.follow(&BodyPair { va: zero, wa: zero, vb: zero, wb: zero });
        self.bear();
        self.moment = self.arm_now.map(|arm| arm.cross(self.impulse));
    }

    /// Removes the impulse along the line, where nothing is transmitted, and returns it.
    #[inline(always)]
    fn bear(&mut self) -> Vec3<L> {
        let along = self.axis_now * self.axis_now.dot(self.impulse);
        self.impulse -= along;
        self.lasting -= self.axis_now * self.axis_now.dot(self.lasting);
        along
    }
}

impl<L: GatherLanes> JointBatch<L> for LineBatch<L> {
    const IS_LOCK: bool = true;
    const SLIDES: bool = true;

    fn ends(&self) -> &Ends<L> {
        &self.ends
    }

    fn fill(&mut self, owners: &[u32], input: &JointInput<'_>) {
        fill_line(self, owners, input);
    }

    #[inline(always)]
    fn follow(&mut self, d: &BodyPair<L>) {
        let [ra, rb] = self.arm;
        let (now_a, now_b) = (turned(d.wa, ra), turned(d.wb, rb));
        let apart = self.apart + (d.vb - d.va) + (now_b - rb) - (now_a - ra);
        self.axis_now = turned(d.wa, self.axis);
        self.arm_now = [now_a + apart, now_b];
        self.apart_now = apart - self.axis_now * self.axis_now.dot(apart);
        self.mass = across(&mobility(&self.ends, &self.arm_now), self.axis_now);
    }

    #[inline(always)]
    fn apply(&self, v: &mut BodyPair<L>) {
        self.ends.apply(v, self.impulse, self.moment[0], self.moment[1]);
    }

    #[inline(always)]
    fn sweep(&mut self, v: &mut BodyPair<L>, pass: &JointPass) {
        let [ra, rb] = self.arm_now;
        if !pass.relax {
            // As for points: turns the impulses of the last substep with the bodies.
            let along = self.bear();
            let moment = self.arm_now.map(|arm| arm.cross(self.impulse));
            let [ta, tb] = [moment[0] - self.moment[0], moment[1] - self.moment[1]];
            self.ends.apply(v, -along, ta, tb);
            self.moment = moment;
        }
        let slip = seen(v, &self.arm_now, pass.ahead());
        let p = -self.mass.mul(slip);
        let (ta, tb) = (ra.cross(p), rb.cross(p));
        self.impulse += p;
        self.moment[0] += ta;
        self.moment[1] += tb;
        self.ends.apply(v, p, ta, tb);
    }

    #[inline(always)]
    fn correct(&self, d: &mut BodyPair<L>, most: Recovery) {
        let [ra, rb] = self.arm_now;
        let p = -self.mass.mul(at_most(self.apart_now, most.linear));
        self.ends.apply(d, p, ra.cross(p), rb.cross(p));
    }

    fn report(&self, lane: usize, to: &mut impl Report) {
        to.lock(self.ends.owner[lane], self.impulse.lane(lane));
    }
}
