//! Rows of couplings: two motions of joints that depend on each other.
//!
//! With displacements x and y of two joints, a x + b y stays within a range. Its Jacobian is a times that of
//! x plus b times that of y, each as the row of a limit would have it: a pair of opposite forces and torques
//! on the two bodies of a joint. So an impulse conserves linear and angular momentum, regardless of the
//! carriers of the joints. Bodies may occur twice: two gears have their gearbox in common, and a screw has
//! both motions on the same pair.
//!
//! Angles are counted with whole turns, in `f64`, from step to step; a row has the error of the sum at the
//! start of the step, and the change since then. So nothing drifts, however many turns there are.
//!
//! Up to four bodies fit no batch of pairs. Rows that share bodies are a *block*, solved as one dense system
//! along with the motors of the coupled motions ([`block`]), by one thread, before the locks at their place
//! in the order.

pub(super) mod block;
mod fill;
pub(super) mod plan;

use super::ends::{Ends, JointPass, Lever, Recovery};
use super::measure::{Distance, Measure, Slide, Twist};
use super::spring::Spring;
use crate::constraint::contact::row::{BodyPair, Motion};
use crate::joint::MAX_DISPLACEMENT;
use crate::lanes::{Record, Vec3, turned};
use crate::limits::MAX_LEFT_SPEED;
use std::f32::consts::TAU;

/// Measured motion of a joint.
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
    /// The impulse of the joint's own locks per impulse of the row, which keeps them closed: force and
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
            // Displacements of bodies in trees may lack whole turns. A row that diverges has a speed that no
            // body may keep, and its turns would stay.
            let speed = self.speed.clamp(-MAX_LEFT_SPEED, MAX_LEFT_SPEED);
            let off = (self.now + speed * h - now) / TAU;
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

    /// How fast its direction turns [rad/s].
    fn turns(&self, v: [Record; 2]) -> f32 {
        gauge!(&self.gauge, gauge => gauge.turns(0, &self.lever, v))
    }

    /// Force and moments of an impulse of the row.
    fn parts(&self, p: f32) -> (Vec3<f32>, [Vec3<f32>; 2]) {
        let p = p * self.factor;
        (self.lever.force * p, self.lever.moments().map(|moment| moment * p))
    }

    /// # Safety
    /// No other thread writes the bodies.
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

/// Whose row it is. In a block motors come after couplings.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub(crate) enum Owner {
    /// A coupling, by its slot.
    Coupling(u32),
    /// The motor of a coupled motion, by the index of its row.
    Motor(u32),
}

/// The row of a coupling, or of a motor of a coupled motion.
#[derive(Clone, Copy, Debug)]
pub(crate) struct CouplingRow {
    pub(super) owner: Owner,
    /// A motor has the first only.
    motions: [Coupled; 2],
    drive: Option<Spring<f32>>,
    /// The displacements at the start of the step, with whole turns.
    displacements: [f64; 2],
    /// How far the sum is above the lower end of its range, and below the upper one, at the start of the
    /// step; after the last substep. For a motor: above its target.
    room: [f32; 2],
    gap: [f32; 2],
    /// A range without width: the lower end bears either way.
    equality: bool,
    /// Speed of the sum per impulse; zero if nothing can move it.
    mobility: f32,
    /// Impulses of the last substep at the lower and the upper end; a motor has the first only.
    impulse: [f32; 2],
    /// The lasting part of their difference, which does not yield.
    lasting: f32,
}

// Rounding: two motions of the same bodies may cancel each other.
/// Share of the mobility of each motion for itself below which the sum can't be moved.
const LEAST: f32 = 1e-6;

impl CouplingRow {
    fn motions(&self) -> &[Coupled] {
        &self.motions[..if self.drive.is_some() { 1 } else { 2 }]
    }

    fn motions_mut(&mut self) -> &mut [Coupled] {
        &mut self.motions[..if self.drive.is_some() { 1 } else { 2 }]
    }

    /// Gaps and the effective mass, where the motions are.
    fn measure(&mut self) {
        let change: f32 = self.motions().iter().map(|one| one.factor * (one.now - one.start)).sum();
        self.gap = [self.room[0] + change, self.room[1] - change];
        let own = |one: &Coupled| one.factor * one.factor * one.ends.mobility(&one.lever);
        let alone: f32 = self.motions().iter().map(own).sum();
        let [a, b] = &self.motions;
        let shared = if self.drive.is_some() { 0.0 } else { 2.0 * a.factor * b.factor * a.answer(b) };
        let mobility = alone + shared;
        self.mobility = if mobility > LEAST * alone { mobility } else { 0.0 };
    }

    /// Change of the speed of this sum per impulse of another row.
    fn answer(&self, other: &CouplingRow) -> f32 {
        let pairs = self.motions().iter().flat_map(|a| other.motions().iter().map(move |b| (a, b)));
        pairs.map(|(a, b)| a.factor * b.factor * a.answer(b)).sum()
    }

    /// Updates directions to where bodies are.
    ///
    /// # Safety
    /// Displacements are not written while rows are solved.
    unsafe fn follow(&mut self, motion: &Motion<'_, '_>, h: f32) {
        for one in self.motions_mut() {
            // SAFETY: by the contract.
            let moved = unsafe { one.ends.load(motion.delta) };
            one.follow(&moved, h);
        }
        self.measure();
    }

    /// Turns the impulses of the last substep with the bodies, as other rows do.
    ///
    /// # Safety
    /// No other thread writes the bodies.
    unsafe fn turn(&mut self, motion: &Motion<'_, '_>) {
        let p = self.impulse[0] - self.impulse[1];
        for one in self.motions_mut() {
            let (force, moment) = one.parts(p);
            let turn = [0, 1].map(|i| moment[i] - one.moment[i]);
            // SAFETY: by the contract.
            unsafe { one.apply(motion, force - one.acted, turn) };
            (one.acted, one.moment) = (force, moment);
        }
    }

    /// The speed of the sum, which is the mean one over `h` seconds.
    ///
    /// # Safety
    /// No other thread writes the bodies.
    unsafe fn speed(&mut self, motion: &Motion<'_, '_>, h: f32) -> f32 {
        let mut speed = 0.0;
        for one in self.motions_mut() {
            // SAFETY: by the contract.
            let own = one.speed(&unsafe { one.ends.load(motion.velocity) }, h);
            one.speed = own;
            speed += one.factor * own;
        }
        speed
    }

    /// Applies a change of the impulse.
    ///
    /// # Safety
    /// No other thread writes the bodies.
    unsafe fn push(&mut self, motion: &Motion<'_, '_>, change: f32) {
        for one in self.motions_mut() {
            let (force, moment) = one.parts(change);
            one.acted += force;
            one.moment = [0, 1].map(|i| one.moment[i] + moment[i]);
            // SAFETY: by the contract.
            unsafe { one.apply(motion, force, moment) };
        }
    }

    /// The speed that corrects an error of the sum.
    fn correction(&self, gap: f32, rate: f32, recovery: &Recovery) -> f32 {
        let of = |one: &Coupled| {
            one.factor.abs() * if one.is_angle() { recovery.angular } else { recovery.linear }
        };
        let most = of(&self.motions[0]) + of(&self.motions[1]);
        (-gap * rate).clamp(-most, most)
    }

    /// One Gauss-Seidel step of the ends of a range: updates the impulses at both, and returns by how much
    /// their difference changed.
    fn bound(&mut self, speed: f32, pass: &JointPass) -> f32 {
        let (rate, scale, yields) = pass.numbers::<f32>();
        let mobility = self.mobility;
        // Signs are those of the lower end; the upper one is its mirror image.
        let one = |gap: f32, speed: f32, old: f32, lasting: f32| {
            let open = gap > 0.0;
            // Away from an end, only the speed that would pass it within the substep is removed.
            let target =
                if open { -gap * pass.inverse_h } else { self.correction(gap, rate, &pass.recovery) };
            let change = (target - speed) / mobility;
            let change = if open { change } else { change * scale - (old - lasting) * yields };
            (old + change).max(0.0)
        };
        let low = one(self.gap[0], speed, self.impulse[0], self.lasting.max(0.0));
        let change = low - self.impulse[0];
        let high = one(self.gap[1], -(speed + mobility * change), self.impulse[1], (-self.lasting).max(0.0));
        let pushed = change - (high - self.impulse[1]);
        self.impulse = [low, high];
        pushed
    }

    /// The displacements after the step, with whole turns [m] or [rad].
    fn displacements_now(&self) -> [f64; 2] {
        let mut displacements = self.displacements;
        for (displacement, one) in displacements.iter_mut().zip(self.motions()) {
            let change = one.now - one.start;
            let now = *displacement + f64::from(if change.is_finite() { change } else { 0.0 });
            *displacement = now.clamp(-MAX_DISPLACEMENT, MAX_DISPLACEMENT);
        }
        displacements
    }
}
