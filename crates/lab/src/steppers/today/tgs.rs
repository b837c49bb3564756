//! Temporal Gauss-Seidel, as PhysX has it (Macklin, Storey, Lu, Terdiman, Chentanez, Jeschke and Müller,
//! *Small steps in physics simulation*, 2019; PhysX's solver of this name).
//!
//! Contacts are found once a step. Each sweep over the laws is a substep: bodies take their share of gravity
//! and forces, rows are solved once with the gaps and errors that the substeps before have left, and bodies
//! move. Impulses of contacts and limits add up over the step, so that a later substep may take back what an
//! earlier one gave. In the end one sweep without the correction of overlap takes out the velocity that this
//! left. Compliance and bounds of drives are shared by the substeps.

use super::points::{Found, Points};
use super::posed::Posed;
use super::relax::Relaxed;
use crate::methods::{Effort, Status};
use crate::problem::Law;
use crate::steppers::moving::Moving;
use crate::steppers::step::{Resolution, Step};
use crate::system::{Owner, System, Velocity};

/// The most substeps of a step.
const SUBSTEPS: u32 = 16;
/// The fastest correction of overlap [m/s].
const PUSH: f64 = 3.0;

/// A sweep is a substep: gaps follow the motion, errors are corrected over the step.
pub fn temporal_gauss_seidel(step: &Step<'_>, effort: &Effort) -> Resolution {
    let points = Points::new(step);
    let substeps = effort.iterations.min(SUBSTEPS);
    let mut flow = Flow::new(&points.system, substeps);
    flow.warm(points.start(step, effort.start.as_deref()));
    for _ in 0..substeps {
        flow.substep();
    }
    flow.settle();
    let system = &points.system;
    let dt = system.dt;
    let end: Vec<_> = step.island.bodies.iter().map(|&i| flow.velocity[i]).collect();
    let moving = step.island.bodies.iter().map(|&i| flow.posed.moved(i).map(|way| way / dt)).collect();
    let found = Found {
        status: Status::Solved,
        impulses: &flow.sum,
        iterations: substeps,
        end,
        moving: Some(moving),
    };
    points.resolution(step, found)
}

/// A step on its way.
pub(super) struct Flow<'a> {
    posed: Posed<'a>,
    pub(super) velocity: Vec<Velocity>,
    substeps: f64,
    /// Impulses of rows: of contacts and limits over the step so far, of others in this substep.
    r: Vec<f64>,
    /// Impulses over the step.
    sum: Vec<f64>,
    /// Offsets of laws that have bounced: minus the speed with which they leave.
    bounced: Vec<Option<f64>>,
    /// Time since the start of the step [s].
    time: f64,
}

impl<'a> Flow<'a> {
    pub(super) fn new(system: &'a System, substeps: u32) -> Flow<'a> {
        let velocity = system.bodies.iter().map(|body| body.start).collect();
        let r = vec![0.0; system.rows.len()];
        let substeps = f64::from(substeps.max(1));
        let bounced = vec![None; system.laws.len()];
        Flow { posed: Posed::new(system), velocity, substeps, sum: r.clone(), r, bounced, time: 0.0 }
    }

    /// Starts with impulses.
    fn warm(&mut self, start: Option<Vec<f64>>) {
        let Some(start) = start else { return };
        let mut moving = Moving::new(self.posed.system, |body| body.start);
        for law in self.posed.system.laws.iter().filter(|law| law.gap.is_some()) {
            for (k, &r) in start[law.first..law.first + law.law.rows()].iter().enumerate() {
                let row = law.first + k;
                moving.push(row, r);
                (self.r[row], self.sum[row]) = (r, r);
            }
        }
        self.velocity = moving.velocity;
    }

    pub(super) fn substep(&mut self) {
        let system = self.posed.system;
        for (velocity, body) in self.velocity.iter_mut().zip(&system.bodies) {
            (0..2).for_each(|k| velocity[k] += (body.free[k] - body.start[k]) / self.substeps);
        }
        let share = (2.0 / self.substeps.sqrt()).min(1.0);
        self.sweep(share);
        let h = system.dt / self.substeps;
        self.time += h;
        for (i, velocity) in self.velocity.iter().enumerate() {
            self.posed.displace(i, velocity.map(|v| v * h));
        }
    }

    /// How far a row has come.
    #[cfg(test)]
    pub(super) fn along(&self, row: usize) -> f64 {
        self.posed.along(row)
    }

    /// The sweep without correction.
    fn settle(&mut self) {
        self.sweep(0.0);
    }

    /// One sweep, joints first, which corrects a share of the errors.
    fn sweep(&mut self, share: f64) {
        let system = self.posed.system;
        let n = self.substeps;
        let mut now = system.clone();
        let mut offsets = vec![0.0; system.rows.len()];
        for row in 0..system.rows.len() {
            now.rows[row] = self.posed.row(row);
            now.rows[row].compliance *= n;
        }
        for law in now.laws.iter_mut().filter(|law| law.gap.is_none()) {
            if let Law::Bounds { min, max } = law.law {
                law.law = Law::Bounds { min: min / n, max: max / n };
                if share > 0.0 {
                    self.r[law.first] = 0.0;
                }
            }
        }
        let mut moving = Moving::new(&now, |body| body.start);
        std::mem::swap(&mut moving.velocity, &mut self.velocity);
        for (i, law) in system.laws.iter().enumerate() {
            offsets[law.first] = self.offset(i, moving.speed(law.first), share);
            if let Law::Contact { mu } = law.law
                && self.r[law.first + 1].hypot(self.r[law.first + 2]) < mu * self.r[law.first]
            {
                // A point that sticks goes back to where it was.
                let tangents = law.first + 1..law.first + 3;
                for (row, offset) in tangents.clone().zip(&mut offsets[tangents]) {
                    let slip = self.posed.along(row) + system.rows[row].bias * self.time;
                    *offset = share * slip * n / system.dt;
                }
            }
        }
        let before = self.r.clone();
        let (contacts, joints): (Vec<_>, Vec<_>) =
            now.laws.iter().partition(|law| matches!(law.owner, Owner::Contact(_)));
        let laws = joints.into_iter().chain(contacts).copied();
        Relaxed::new(&moving, laws).sweep(&mut moving, &offsets, &mut self.r);
        self.velocity = moving.velocity;
        for (sum, (r, before)) in self.sum.iter_mut().zip(self.r.iter().zip(before)) {
            *sum += r - before;
        }
    }

    /// What is added to the velocity of a law's first row, which is `speed` now: the gap or the error over a
    /// substep.
    fn offset(&mut self, i: usize, speed: f64, share: f64) -> f64 {
        let system = self.posed.system;
        let (law, h) = (&system.laws[i], system.dt / self.substeps);
        let along = self.posed.along(law.first);
        let Some(gap) = law.gap else {
            let locks = law.law == Law::LOCKED && !law.drives && !law.yields;
            return if locks { share * (law.off + along) / h } else { 0.0 };
        };
        let gap = gap + along;
        let row = &system.rows[law.first];
        let start = system.speed(row, |body| body.start) + row.bias;
        let bounces = law.restitution > 0.0 && -start > system.threshold;
        if bounces && self.bounced[i].is_none() && gap + speed * h <= 0.0 {
            self.bounced[i] = Some(law.restitution * speed);
        }
        if let Some(leaves) = self.bounced[i].filter(|_| gap + speed * h <= 0.0) {
            return leaves;
        }
        if gap > 0.0 {
            // It has left, and keeps what it got.
            self.r[law.first..law.first + law.law.rows()].fill(0.0);
            return gap / h;
        }
        (share * gap / h).max(-PUSH)
    }
}
