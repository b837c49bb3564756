//! Couplings that share bodies, and the motors of the coupled motions: one dense system.
//!
//! Solved one after another, a motor that turns the slow end of a train of gears knows its own wheel, a
//! hundredth of a percent of the inertia that hangs on it by the ratios, and each pass brings the train a
//! hundredth of a percent nearer to its speed: the teeth of four pairs of 4 : 1 were eleven radians apart.
//! Together they are exact. A motor at its bound is fixed there, and the others are solved again.

use super::{CouplingRow, Owner};
use crate::constraint::contact::input::PrepareInput;
use crate::constraint::contact::row::Motion;
use crate::constraint::joint::batch::{Link, Report, RowImpulse, Watched};
use crate::constraint::joint::ends::JointPass;
use crate::lanes::Record;

/// The most rows of a block: beyond, trains are cut in pieces that are solved one after another.
pub(super) const MAX_ROWS: usize = 32;

// Rounding: of a pivot.
/// Share of its mobility below which a row is held by the others already.
const HELD: f64 = 1e-6;

/// Rows that are solved together.
#[derive(Debug)]
pub(crate) struct CouplingBlock {
    owners: Vec<Owner>,
    pub(in crate::constraint::joint) rows: Vec<CouplingRow>,
    /// Changes of speeds per impulse, row by row.
    answers: Vec<f32>,
}

impl CouplingBlock {
    pub(in crate::constraint::joint) fn new(owners: &[Owner]) -> CouplingBlock {
        let n = owners.len();
        let (rows, answers) = (Vec::with_capacity(n), Vec::with_capacity(n * n));
        CouplingBlock { owners: owners.to_vec(), rows, answers }
    }

    /// Reserved bytes, but for its own record.
    pub(in crate::constraint::joint) fn reserved(&self) -> usize {
        size_of::<Owner>() * self.owners.capacity()
            + size_of::<CouplingRow>() * self.rows.capacity()
            + size_of::<f32>() * self.answers.capacity()
    }

    /// Rows of a step.
    pub(in crate::constraint::joint) fn fill(&mut self, input: &PrepareInput<'_>) {
        self.rows.clear();
        self.rows.extend(self.owners.iter().map(|&owner| CouplingRow::new(owner, input)));
        self.couple();
    }

    fn couple(&mut self) {
        let n = self.rows.len();
        self.answers.clear();
        for (i, a) in self.rows.iter().enumerate() {
            for (k, b) in self.rows.iter().enumerate() {
                let answer = if k < i { self.answers[k * n + i] } else { a.answer(b) };
                self.answers.push(answer);
            }
        }
    }

    /// Applies the impulses of the last step.
    ///
    /// # Safety
    /// No other thread writes the bodies.
    pub(in crate::constraint::joint) unsafe fn warm_start(&self, motion: &Motion<'_, '_>) {
        for one in self.rows.iter().flat_map(CouplingRow::motions) {
            // SAFETY: by the contract.
            unsafe { one.apply(motion, one.acted, one.moment) };
        }
    }

    /// One step of Gauss-Seidel, of the block.
    ///
    /// # Safety
    /// No other thread writes the bodies.
    pub(in crate::constraint::joint) unsafe fn solve(&mut self, motion: &Motion<'_, '_>, pass: &JointPass) {
        let h = 1.0 / pass.inverse_h;
        // SAFETY: by the contract; displacements are not written while rows are solved.
        unsafe {
            if pass.moved {
                self.rows.iter_mut().for_each(|row| row.follow(motion, h));
                self.couple();
            }
            if !pass.relax {
                self.rows.iter_mut().for_each(|row| row.turn(motion));
            }
        }
        let h = if pass.relax { 0.0 } else { h };
        if let [row] = &mut self.rows[..]
            && !row.equality
            && row.drive.is_none()
        {
            // SAFETY: by the contract.
            let speed = unsafe { row.speed(motion, h) };
            if row.mobility > 0.0 {
                let change = row.bound(speed, pass);
                // SAFETY: by the contract.
                unsafe { row.push(motion, change) };
            }
            return;
        }
        let mut system = System::default();
        for row in &mut self.rows {
            // SAFETY: by the contract.
            let speed = unsafe { row.speed(motion, h) };
            system.add(row, speed, pass);
        }
        system.solve(&self.answers);
        for (row, change) in self.rows.iter_mut().zip(system.change) {
            let change = change as f32;
            row.impulse[0] += change;
            // SAFETY: by the contract.
            unsafe { row.push(motion, change) };
        }
    }

    /// Reports the impulses of motors.
    pub(in crate::constraint::joint) fn report_drives(&self, to: &mut impl Report) {
        for row in &self.rows {
            if let Owner::Motor(owner) = row.owner {
                let lever = &row.motions[0].lever;
                let (force, torque) = (lever.force.lane(0), lever.torque.lane(0));
                to.row(owner, RowImpulse { ends: [row.impulse[0], 0.0], force, torque, now: None });
            }
        }
    }

    /// Reports the impulses on the bodies of couplings and motors.
    #[cfg(feature = "observe")]
    pub(in crate::constraint::joint) fn report_pushes(&self, to: &mut impl Report) {
        for one in self.rows.iter().flat_map(CouplingRow::motions) {
            one.ends.report_pushes((one.acted, one.moment), to);
        }
    }

    /// Calls `f` with each coupling by its slot, its impulses, and force and torque on each of its joints per
    /// impulse.
    #[cfg(feature = "observe")]
    pub(in crate::constraint::joint) fn report_levers(
        &self,
        f: &mut dyn FnMut(u32, [f32; 2], [[glam::Vec3; 2]; 2]),
    ) {
        for row in &self.rows {
            if let Owner::Coupling(slot) = row.owner {
                let levers = [0, 1].map(|i| {
                    let one = &row.motions[i];
                    [one.lever.force, one.lever.torque].map(|part| part.lane(0) * one.factor)
                });
                f(slot, row.impulse, levers);
            }
        }
    }

    /// Calls `f` with each coupling by its slot, its displacements and impulses.
    pub(in crate::constraint::joint) fn report(&self, f: &mut dyn FnMut(u32, [f64; 2], [f32; 2])) {
        for row in &self.rows {
            if let Owner::Coupling(slot) = row.owner {
                f(slot, row.displacements_now(), row.impulse);
            }
        }
    }
}

/// The rows of a block as one system: (A + C) change = wanted, with a compliance of each row.
#[derive(Default)]
struct System {
    count: usize,
    compliance: [f64; MAX_ROWS],
    wanted: [f64; MAX_ROWS],
    /// Least and greatest change of each impulse.
    range: [[f64; 2]; MAX_ROWS],
    change: [f64; MAX_ROWS],
}

impl System {
    /// Adds a row that goes at a speed.
    fn add(&mut self, row: &CouplingRow, speed: f32, pass: &JointPass) {
        let (rate, ..) = pass.numbers::<f32>();
        let (i, old) = (self.count, row.impulse[0]);
        self.count += 1;
        let (wanted, compliance, range) = match row.drive {
            // Springs act once per substep.
            _ if row.mobility <= 0.0 => (0.0, 0.0, [0.0; 2]),
            Some(drive) if pass.relax && drive.give > 0.0 => (0.0, 0.0, [0.0; 2]),
            Some(drive) => {
                let target = drive.speed - row.gap[0] * drive.pull;
                (target - speed - drive.give * old, drive.give, [-drive.most - old, drive.most - old])
            }
            None => {
                // Rigid, unlike other rows: a soft row is late by a fifth of the speed that a motor asks for
                // at once, and the teeth were 0.03 rad apart when one started at 60 rad/s.
                let target = row.correction(row.gap[0], rate, &pass.recovery);
                (target - speed, 0.0, [f32::NEG_INFINITY, f32::INFINITY])
            }
        };
        (self.wanted[i], self.compliance[i]) = (wanted.into(), compliance.into());
        self.range[i] = range.map(f64::from);
    }

    fn solve(&mut self, answers: &[f32]) {
        let n = self.count;
        let mut free = [false; MAX_ROWS];
        for (i, free) in free.iter_mut().enumerate().take(n) {
            *free = self.range[i][0] < self.range[i][1];
        }
        // Each round fixes one row at least.
        for _ in 0..=n {
            self.solve_free(answers, &free);
            let mut fixed = false;
            for (i, free) in free.iter_mut().enumerate().take(n).filter(|(_, free)| **free) {
                let [low, high] = self.range[i];
                let within = self.change[i].max(low).min(high);
                if within != self.change[i] {
                    (self.change[i], *free, fixed) = (within, false, true);
                }
            }
            if !fixed {
                return;
            }
        }
    }

    /// Solves the free rows, given the changes of the others, by elimination without square roots.
    fn solve_free(&mut self, answers: &[f32], free: &[bool; MAX_ROWS]) {
        let n = self.count;
        let mut a = [[0.0_f64; MAX_ROWS]; MAX_ROWS];
        let mut b = [0.0_f64; MAX_ROWS];
        for i in (0..n).filter(|&i| free[i]) {
            b[i] = self.wanted[i];
            for k in 0..n {
                let answer = f64::from(answers[i * n + k]);
                if free[k] {
                    a[i][k] = answer;
                } else {
                    b[i] -= answer * self.change[k];
                }
            }
            a[i][i] += self.compliance[i];
        }
        let mut held = [false; MAX_ROWS];
        for i in (0..n).filter(|&i| free[i]) {
            let own = f64::from(answers[i * n + i]) + self.compliance[i];
            let pivot = a[i];
            held[i] = pivot[i] <= HELD * own || pivot[i].is_nan();
            if held[i] {
                continue;
            }
            for k in (i + 1..n).filter(|&k| free[k]) {
                // Wheels that don't mesh know nothing of each other.
                if a[k][i] == 0.0 {
                    continue;
                }
                let share = a[k][i] / pivot[i];
                for (entry, of_pivot) in a[k][i..n].iter_mut().zip(&pivot[i..n]) {
                    *entry -= share * of_pivot;
                }
                b[k] -= share * b[i];
            }
        }
        for i in (0..n).rev().filter(|&i| free[i]) {
            let known: f64 = (i + 1..n).filter(|&k| free[k]).map(|k| a[i][k] * self.change[k]).sum();
            self.change[i] = if held[i] { 0.0 } else { (b[i] - known) / a[i][i] };
        }
    }
}

impl Watched for CouplingBlock {
    fn links(&self, f: &mut dyn FnMut(Link)) {
        let ends = || self.rows.iter().flat_map(CouplingRow::motions).map(|one| &one.ends);
        let Some(first) = ends().next() else { return };
        for end in ends() {
            end.each(&mut |_, link| f(link));
            f(Link { bodies: [first.one(0), end.one(0)], moves: [true; 2] });
        }
    }
    fn forget(&mut self, of: &dyn Fn(u32) -> bool) {
        for row in &mut self.rows {
            if row.motions().iter().any(|one| of(one.ends.one(0))) {
                (row.impulse, row.lasting) = ([0.0; 2], 0.0);
                for one in row.motions_mut() {
                    (one.acted, one.moment) = one.parts(0.0);
                }
            }
        }
    }
    fn turning(&mut self, motion: &Motion<'_, '_>, h: f32, f: &mut dyn FnMut(u32)) {
        for one in self.rows.iter().flat_map(CouplingRow::motions) {
            let turns = |_: usize, v: [Record; 2]| one.turns(v);
            one.ends.too_fast(motion, h, &turns, f);
        }
    }
    fn stored(&self, h: f32, f: &mut dyn FnMut(u32, [f32; 2])) {
        for row in &self.rows {
            if let Some(drive) = &row.drive {
                let energy = drive.energy(row.gap[0].abs(), row.impulse[0], h, row.mobility);
                f(row.motions[0].ends.one(0), energy);
            }
        }
    }
}
