//! Locks of joints: two points stay together, two bodies turn as one, two bodies share an axis. There are no
//! bounds, so all directions are solved together.
//!
//! Bodies turn within a step, and a lock linearised at its start would let a swinging chain drift apart: arms
//! turn with the bodies, and so does the effective mass.

use super::batch::{JointBatch, Report};
use super::ends::{Ends, JointPass, Recovery, TINY, across, inverse, swerve};
use crate::constraint::contact::row::BodyPair;
use crate::lanes::{GatherLanes, Lanes, Sym3, Vec3, turned};
use bytemuck::Zeroable;

/// Points that stay together.
#[derive(Clone, Copy, Debug, Zeroable)]
#[repr(C)]
pub(crate) struct PointBatch<L> {
    pub(crate) ends: Ends<L>,
    /// From each centre of mass to its point, at the start of the step [m].
    pub(crate) arm: [Vec3<L>; 2],
    /// From the first point to the second, at the start of the step [m].
    pub(crate) apart: Vec3<L>,
    /// Arms and separation after the last substep.
    pub(crate) arm_now: [Vec3<L>; 2],
    /// Moments of the impulse, at the arms at which its parts acted [N m s].
    pub(crate) moment: [Vec3<L>; 2],
    pub(crate) apart_now: Vec3<L>,
    /// Impulse per velocity error [kg].
    pub(crate) mass: Sym3<L>,
    /// Impulse of the last substep [N s].
    pub(crate) impulse: Vec3<L>,
    /// The lasting part of it, which does not yield.
    pub(crate) lasting: Vec3<L>,
}

impl<L: Lanes> Default for PointBatch<L> {
    #[inline(always)]
    fn default() -> Self {
        PointBatch { ends: Ends::default(), ..Zeroable::zeroed() }
    }
}

/// Velocity of the second point per impulse on it: the matrix whose inverse is the effective mass [1/kg].
#[inline(always)]
pub(crate) fn mobility<L: GatherLanes>(ends: &Ends<L>, arm: &[Vec3<L>; 2]) -> Sym3<L> {
    let one = L::one();
    let [on_a, on_b] = ends.moving(Vec3::new(one, one, one));
    let mass = on_a * ends.inverse_mass[0] + on_b * ends.inverse_mass[1];
    let mut sum = Sym3 { xx: mass.x, yy: mass.y, zz: mass.z, ..Sym3::default() };
    for (r, inertia) in arm.iter().zip(&ends.inverse_inertia) {
        let (x, y, z) = (
            Vec3::new(L::zero(), r.z, -r.y),
            Vec3::new(-r.z, L::zero(), r.x),
            Vec3::new(r.y, -r.x, L::zero()),
        );
        let (ix, iy, iz) = (inertia.mul(x), inertia.mul(y), inertia.mul(z));
        sum.xx += x.dot(ix);
        sum.yy += y.dot(iy);
        sum.zz += z.dot(iz);
        sum.xy += x.dot(iy);
        sum.xz += x.dot(iz);
        sum.yz += y.dot(iz);
    }
    // If bodies are locked, some directions may be missing.
    let tiny = (sum.xx + sum.yy + sum.zz) * L::splat(TINY);
    sum.xx += tiny;
    sum.yy += tiny;
    sum.zz += tiny;
    sum
}

impl<L: GatherLanes> PointBatch<L> {
    /// Applies the impulse against a velocity of the second point relative to the first.
    #[inline(always)]
    pub(super) fn stop(&mut self, v: &mut BodyPair<L>, slip: Vec3<L>) {
        let [ra, rb] = self.arm_now;
        let p = -self.mass.mul(slip);
        let (ta, tb) = (ra.cross(p), rb.cross(p));
        self.impulse += p;
        self.moment[0] += ta;
        self.moment[1] += tb;
        self.ends.apply(v, p, ta, tb);
    }
}

impl<L: GatherLanes> JointBatch<L> for PointBatch<L> {
    const IS_LOCK: bool = true;
    const SLIDES: bool = false;

    fn ends(&self) -> &Ends<L> {
        &self.ends
    }

    #[inline(always)]
    fn follow(&mut self, d: &BodyPair<L>) {
        let [ra, rb] = self.arm;
        self.arm_now = [turned(d.wa, ra), turned(d.wb, rb)];
        let [now_a, now_b] = self.arm_now;
        self.apart_now = self.apart + (d.vb - d.va) + (now_b - rb) - (now_a - ra);
        self.mass = inverse(&mobility(&self.ends, &self.arm_now));
    }

    #[inline(always)]
    fn apply(&self, v: &mut BodyPair<L>) {
        let [ra, rb] = self.arm_now;
        self.ends.apply(v, self.impulse, ra.cross(self.impulse), rb.cross(self.impulse));
    }

    #[inline(always)]
    fn sweep(&mut self, v: &mut BodyPair<L>, pass: &JointPass) {
        let [ra, rb] = self.arm_now;
        if pass.fresh {
            // Warm starting added impulses as if bodies had not turned. They have to be turned with the arms,
            // or a pendulum gains energy.
            let moment = [ra.cross(self.impulse), rb.cross(self.impulse)];
            v.wa -= self.ends.inverse_inertia[0].mul(moment[0] - self.moment[0]);
            v.wb += self.ends.inverse_inertia[1].mul(moment[1] - self.moment[1]);
            self.moment = moment;
        }
        let slip = v.vb + v.wb.cross(rb) - v.va - v.wa.cross(ra);
        self.stop(v, slip);
    }

    #[inline(always)]
    fn correct(&self, d: &mut BodyPair<L>, most: Recovery) {
        let [ra, rb] = self.arm_now;
        let p = -self.mass.mul(at_most(self.apart_now, most.linear));
        self.ends.apply(d, p, ra.cross(p), rb.cross(p));
    }

    #[cfg(feature = "observe")]
    fn acted(&self) -> (Vec3<L>, [Vec3<L>; 2]) {
        (self.impulse, self.moment)
    }

    fn report(&self, lane: usize, to: &mut impl Report) {
        to.lock(self.ends.owner[lane], self.impulse.lane(lane));
    }
}

/// Limits the part of an error that is corrected at once.
#[inline(always)]
pub(crate) fn at_most<L: Lanes>(error: Vec3<L>, most: f32) -> Vec3<L> {
    let (length, most) = (error.length(), L::splat(most));
    error * L::select(length.gt(most), most / length, L::one())
}

/// Bodies that turn as one, or (`HINGE`) about one axis only.
#[derive(Clone, Copy, Debug, Zeroable)]
#[repr(C)]
pub(crate) struct TurnBatch<L, const HINGE: bool> {
    pub(crate) ends: Ends<L>,
    /// The axis on each body at the start of the step, if there is one.
    pub(crate) axis: [Vec3<L>; 2],
    /// That of the first body after the last substep.
    pub(crate) axis_now: Vec3<L>,
    /// Rotation vector from the first to the second at the start of the step, and after the last substep
    /// [rad].
    pub(crate) error: Vec3<L>,
    pub(crate) error_now: Vec3<L>,
    /// Angular impulse per error of angular velocity [kg m²].
    pub(crate) mass: Sym3<L>,
    /// Angular impulse of the last substep [N m s].
    pub(crate) impulse: Vec3<L>,
    /// The lasting part of it, which does not yield.
    pub(crate) lasting: Vec3<L>,
}

impl<L: Lanes, const HINGE: bool> Default for TurnBatch<L, HINGE> {
    #[inline(always)]
    fn default() -> Self {
        TurnBatch { ends: Ends::default(), ..Zeroable::zeroed() }
    }
}

impl<L: GatherLanes, const HINGE: bool> JointBatch<L> for TurnBatch<L, HINGE> {
    const IS_LOCK: bool = true;
    const SLIDES: bool = false;

    fn ends(&self) -> &Ends<L> {
        &self.ends
    }

    #[inline(always)]
    fn follow(&mut self, d: &BodyPair<L>) {
        if HINGE {
            self.axis_now = turned(d.wa, self.axis[0]);
            self.error_now = self.axis_now.cross(turned(d.wb, self.axis[1]));
            self.mass = across(&self.ends.turning(), self.axis_now);
        } else {
            // A common rotation of both changes nothing.
            self.error_now = self.error + (d.wb - d.wa);
        }
    }

    #[inline(always)]
    fn apply(&self, v: &mut BodyPair<L>) {
        self.ends.turn(v, self.impulse);
    }

    #[inline(always)]
    fn sweep(&mut self, v: &mut BodyPair<L>, pass: &JointPass) {
        if HINGE && pass.fresh {
            // A hinge transmits nothing about its axis, which has turned.
            let about = self.axis_now * self.axis_now.dot(self.impulse);
            self.impulse -= about;
            self.ends.turn(v, -about);
            self.lasting -= self.axis_now * self.axis_now.dot(self.lasting);
        }
        let mut slip = v.wb - v.wa;
        if HINGE {
            slip += swerve(v.wb, self.axis_now, pass.ahead()) - swerve(v.wa, self.axis_now, pass.ahead());
        }
        let t = -self.mass.mul(slip);
        self.impulse += t;
        self.ends.turn(v, t);
    }

    #[inline(always)]
    fn correct(&self, d: &mut BodyPair<L>, most: Recovery) {
        let t = -self.mass.mul(at_most(self.error_now, most.angular));
        self.ends.turn(d, t);
    }

    #[cfg(feature = "observe")]
    fn acted(&self) -> (Vec3<L>, [Vec3<L>; 2]) {
        (Vec3::zero(), [self.impulse; 2])
    }

    fn report(&self, lane: usize, to: &mut impl Report) {
        to.lock(self.ends.owner[lane], self.impulse.lane(lane));
    }
}
