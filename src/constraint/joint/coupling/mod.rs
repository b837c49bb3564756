//! Rows of couplings: two motions of joints that depend on each other.
//!
//! With displacements x and y of two joints, a x + b y stays within a range. Its Jacobian is a times that of
//! x plus b times that of y, each as the row of a limit would have it: a pair of opposite forces and torques
//! on the two bodies of a joint. So an impulse conserves linear and angular momentum, whatever the joints
//! hang on. Bodies may occur twice: two gears have their gearbox in common, and a screw has both motions on
//! the same pair.
//!
//! Angles are counted with whole turns, in `f64`, from step to step; a row has what the sum is off by at the
//! start of the step, and what has changed since. So nothing drifts, however many turns there are.
//!
//! Up to four bodies fit no batch of pairs: rows are solved one after another, in the order of their slots,
//! before the locks at their place in the order.

mod fill;

use super::ends::{Ends, JointPass, Lever, Recovery, turned};
use super::measure::{Distance, Measure, Slide, Twist};
use super::rates::{Link, Watched};
use crate::constraint::contact::row::{BodyPair, Motion};
use crate::lanes::{Record, Vec3};
use std::f32::consts::TAU;

/// What is measured of a joint.
#[derive(Clone, Copy, Debug)]
enum Gauge {
    Slide(Slide<f32>),
    Distance(Distance<f32>),
    Twist(Twist<f32>),
}

/// Calls a method of a gauge.
macro_rules! gauge {
    ($gauge:expr, $it:ident => $call:expr) => {
        match $gauge {
            Gauge::Slide($it) => $call,
            Gauge::Distance($it) => $call,
            Gauge::Twist($it) => $call,
        }
    };
}

/// One of the two motions.
#[derive(Clone, Copy, Debug)]
struct Coupled {
    ends: Ends<f32>,
    gauge: Gauge,
    /// The greater of the two factors has magnitude one.
    factor: f32,
    /// From each centre of mass to the second body's point, at the start of the step [m].
    arm: [Vec3<f32>; 2],
    /// What the joint's own locks add to an impulse so that it does not move what they hold: force and
    /// torque, at the start of the step.
    borne: [Vec3<f32>; 2],
    lever: Lever<f32>,
    /// Displacement at the start of the step, and after the last substep, without whole turns of the steps
    /// before [m] or [rad].
    start: f32,
    now: f32,
    /// How fast it grew when rows were last solved.
    speed: f32,
    /// The impulse as it was applied: its force, and the moments on both bodies.
    acted: Vec3<f32>,
    moment: [Vec3<f32>; 2],
}

impl Coupled {
    fn is_angle(&self) -> bool {
        matches!(self.gauge, Gauge::Twist(_))
    }

    /// Updates direction and displacement to displacements of the bodies since the start of the step, `h`
    /// seconds after the last time.
    fn follow(&mut self, d: &BodyPair<f32>, h: f32) {
        let [at, rb] = self.arm;
        let now = turned(d.wb, rb);
        self.lever.arm = [at + (d.vb - d.va) + (now - rb), now];
        let (lever, start) = (&mut self.lever, self.start);
        let mut now = gauge!(&mut self.gauge, gauge => gauge.follow(d, lever, start));
        if self.is_angle() {
            // Displacements of bodies in trees may lack whole turns.
            let off = (self.now + self.speed * h - now) / TAU;
            now += TAU * if off.is_finite() { off.round() } else { 0.0 };
        }
        self.now = now;
        let [force, torque] = self.borne.map(|borne| turned(d.wa, borne));
        self.lever.force += force;
        self.lever.torque += torque;
    }

    /// Directions at the start of the step.
    fn begin(&mut self) {
        let zero = Vec3::zero();
        self.follow(&BodyPair { va: zero, wa: zero, vb: zero, wb: zero }, 0.0);
    }

    /// Its speed, which is the mean one over `h` seconds.
    fn speed(&self, v: &BodyPair<f32>, h: f32) -> f32 {
        let bend = if h > 0.0 { gauge!(&self.gauge, gauge => gauge.bend(v, &self.lever, h)) } else { 0.0 };
        self.lever.speed(v) + bend
    }

    /// Force and moments of an impulse of the row.
    fn parts(&self, p: f32) -> (Vec3<f32>, [Vec3<f32>; 2]) {
        let p = p * self.factor;
        (self.lever.force * p, self.lever.moments().map(|moment| moment * p))
    }

    /// # Safety
    /// As for [`CouplingRow::solve`].
    unsafe fn apply(&self, motion: &Motion<'_, '_>, p: Vec3<f32>, [ta, tb]: [Vec3<f32>; 2]) {
        // SAFETY: by the contract.
        unsafe {
            let mut v = self.ends.load(motion.velocity);
            self.ends.apply(&mut v, p, ta, tb);
            self.ends.save(&v, motion);
        }
    }

    /// Change of the speed of this motion by an impulse on another one: by the bodies that both move.
    fn answer(&self, other: &Coupled) -> f32 {
        let (own, theirs) = (self.ends.moving(self.lever.force), other.ends.moving(other.lever.force));
        let (m, n) = (self.lever.moments(), other.lever.moments());
        let mut sum = 0.0;
        for (i, k) in [(0, 0), (0, 1), (1, 0), (1, 1)] {
            let same = self.ends.body[i][0] == other.ends.body[k][0];
            if same && self.ends.write[i] & other.ends.write[k] & 1 != 0 {
                let change = own[i].dot(theirs[k]) * self.ends.inverse_mass[i]
                    + m[i].dot(self.ends.inverse_inertia[i].mul(n[k]));
                sum += if i == k { change } else { -change };
            }
        }
        sum
    }
}

/// The row of a coupling.
#[derive(Clone, Copy, Debug)]
pub(crate) struct CouplingRow {
    /// Its slot.
    pub(super) owner: u32,
    motions: [Coupled; 2],
    /// The displacements at the start of the step, with whole turns.
    displacements: [f64; 2],
    /// How far the sum is above the lower end of its range, and below the upper one, at the start of the
    /// step; after the last substep.
    room: [f32; 2],
    gap: [f32; 2],
    /// A range without width: the lower end bears either way.
    equality: bool,
    /// Speed of the sum per impulse.
    mobility: f32,
    /// Impulses of the last substep at the lower and the upper end.
    impulse: [f32; 2],
    /// The lasting part of their difference, which does not yield.
    lasting: f32,
}

/// What a row did in a step.
pub(super) struct CouplingReport {
    /// The displacements after the step, with whole turns [m] or [rad].
    pub(super) displacements: [f64; 2],
    /// At the lower and the upper end, in the last substep.
    pub(super) impulse: [f32; 2],
}

impl CouplingRow {
    /// Gaps and the effective mass, where the motions are.
    fn measure(&mut self) {
        let [a, b] = &self.motions;
        let change = a.factor * (a.now - a.start) + b.factor * (b.now - b.start);
        self.gap = [self.room[0] + change, self.room[1] - change];
        let own = |one: &Coupled| one.factor * one.factor * one.ends.mobility(&one.lever);
        let mobility = own(a) + own(b) + 2.0 * a.factor * b.factor * a.answer(b);
        // Rounding: what two motions of the same bodies leave of each other.
        let least = 1e-6 * (own(a) + own(b));
        self.mobility = if mobility > least { mobility } else { 0.0 };
    }

    /// Applies the impulses of the last step.
    ///
    /// # Safety
    /// No other thread writes the bodies.
    pub(super) unsafe fn warm_start(&self, motion: &Motion<'_, '_>) {
        for one in &self.motions {
            // SAFETY: by the contract.
            unsafe { one.apply(motion, one.acted, one.moment) };
        }
    }

    /// One Gauss-Seidel step.
    ///
    /// # Safety
    /// No other thread writes the bodies.
    pub(super) unsafe fn solve(&mut self, motion: &Motion<'_, '_>, pass: &JointPass) {
        if pass.moved {
            for one in &mut self.motions {
                // SAFETY: displacements are not written while rows are solved.
                let moved = unsafe { one.ends.load(motion.delta) };
                one.follow(&moved, 1.0 / pass.inverse_h);
            }
            self.measure();
        }
        if !pass.relax {
            // As for other rows: turns the impulses of the last substep with the bodies.
            let p = self.impulse[0] - self.impulse[1];
            for one in &mut self.motions {
                let (force, moment) = one.parts(p);
                let turn = [0, 1].map(|i| moment[i] - one.moment[i]);
                // SAFETY: by the contract.
                unsafe { one.apply(motion, force - one.acted, turn) };
                (one.acted, one.moment) = (force, moment);
            }
        }
        let h = if pass.relax { 0.0 } else { 1.0 / pass.inverse_h };
        let mut speed = 0.0;
        for one in &mut self.motions {
            // SAFETY: by the contract.
            let own = one.speed(&unsafe { one.ends.load(motion.velocity) }, h);
            one.speed = own;
            speed += one.factor * own;
        }
        if self.mobility <= 0.0 {
            return;
        }
        let pushed = self.push(speed, pass);
        for one in &mut self.motions {
            let (force, moment) = one.parts(pushed);
            one.acted += force;
            one.moment = [0, 1].map(|i| one.moment[i] + moment[i]);
            // SAFETY: by the contract.
            unsafe { one.apply(motion, force, moment) };
        }
    }

    /// Updates the impulses at both ends, and returns by how much their difference changed.
    fn push(&mut self, speed: f32, pass: &JointPass) -> f32 {
        let (rate, scale, yields) = pass.numbers::<f32>();
        let CouplingRow { equality, mobility, .. } = *self;
        let most = self.most(&pass.recovery);
        // Signs are those of the lower end; the upper one is its mirror image.
        let one = |gap: f32, speed: f32, old: f32, lasting: f32| {
            let open = gap > 0.0 && !equality;
            // Away from an end, only the speed that would pass it within the substep is removed.
            let target = if open { -gap * pass.inverse_h } else { (-gap * rate).clamp(-most, most) };
            let change = (target - speed) / mobility;
            let change = if open { change } else { change * scale - (old - lasting) * yields };
            if equality { old + change } else { (old + change).max(0.0) }
        };
        let lower = if equality { self.lasting } else { self.lasting.max(0.0) };
        let new = one(self.gap[0], speed, self.impulse[0], lower);
        let change = new - self.impulse[0];
        self.impulse[0] = new;
        if equality {
            return change;
        }
        let speed = -(speed + mobility * change);
        let new = one(self.gap[1], speed, self.impulse[1], (-self.lasting).max(0.0));
        let pushed = change - (new - self.impulse[1]);
        self.impulse[1] = new;
        pushed
    }

    /// Maximum speed at which an error of the sum is corrected.
    fn most(&self, recovery: &Recovery) -> f32 {
        let of = |one: &Coupled| {
            one.factor.abs() * if one.is_angle() { recovery.angular } else { recovery.linear }
        };
        of(&self.motions[0]) + of(&self.motions[1])
    }

    pub(super) fn report(&self) -> CouplingReport {
        let mut displacements = self.displacements;
        for (displacement, one) in displacements.iter_mut().zip(&self.motions) {
            let change = one.now - one.start;
            *displacement += f64::from(if change.is_finite() { change } else { 0.0 });
        }
        CouplingReport { displacements, impulse: self.impulse }
    }
}

impl Watched for CouplingRow {
    fn links(&self, f: &mut dyn FnMut(Link)) {
        let [a, b] = self.motions.each_ref().map(|one| &one.ends);
        a.each(&mut |_, link| f(link));
        b.each(&mut |_, link| f(link));
        f(Link { bodies: [a.one(0), b.one(0)], moves: [true; 2] });
    }
    fn forget(&mut self, of: &dyn Fn(u32) -> bool) {
        if self.motions.iter().any(|one| of(one.ends.one(0))) {
            (self.impulse, self.lasting) = ([0.0; 2], 0.0);
            for one in &mut self.motions {
                (one.acted, one.moment) = one.parts(0.0);
            }
        }
    }
    fn turning(&self, motion: &Motion<'_, '_>, h: f32, f: &mut dyn FnMut(u32)) {
        for one in &self.motions {
            let turns =
                |lane: usize, v: [Record; 2]| gauge!(&one.gauge, gauge => gauge.turns(lane, &one.lever, v));
            one.ends.too_fast(motion, h, &turns, f);
        }
    }
}
