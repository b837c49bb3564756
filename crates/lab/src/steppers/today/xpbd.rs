//! Extended position based dynamics with small steps (Müller, Macklin, Chentanez, Jeschke and Kim, *Detailed
//! rigid body simulation with extended position based dynamics*, 2020).
//!
//! In each substep bodies fly; then positions are corrected, one law after the other, joints first, once:
//! `Δλ = (-C - α λ) / (w + α)` with the compliance α over the square of the substep, which moves bodies by
//! `M⁻¹ Jᵀ Δλ`. Friction takes back the slip of the substep as far as the cone allows it (the authors leave a
//! point beyond its cone to the velocities; a box on an incline then slid off where it should have held).
//! Velocities are what bodies moved over the substep; sliding friction and restitution change them
//! afterwards, and take out the speed that the correction of overlap left. A lock that starts with an error
//! is corrected at once.

use super::points::{Found, Points};
use super::posed::{Place, Posed};
use crate::methods::{Effort, Status};
use crate::problem::{Law, project_disc};
use crate::steppers::moving::Moving;
use crate::steppers::step::{Resolution, Step};
use crate::system::{System, SystemLaw, SystemRow, Velocity};

/// The most substeps of a step.
const SUBSTEPS: u32 = 20;

/// Substeps in which positions are corrected law by law, and velocities follow.
pub fn xpbd(step: &Step<'_>, effort: &Effort) -> Resolution {
    let points = Points::new(step);
    let substeps = effort.iterations.min(SUBSTEPS);
    let mut flow = Flow::new(&points.system, substeps);
    for _ in 0..substeps {
        flow.substep();
    }
    let (dt, bodies) = (points.system.dt, &step.island.bodies);
    let moving = bodies.iter().map(|&i| flow.posed.moved(i).map(|way| way / dt)).collect();
    let end = bodies.iter().map(|&i| flow.velocity[i]).collect();
    let (status, impulses) = (Status::Solved, flow.sum.as_slice());
    points.resolution(step, Found { status, impulses, iterations: substeps, end, moving: Some(moving) })
}

/// A step on its way.
struct Flow<'a> {
    posed: Posed<'a>,
    velocity: Vec<Velocity>,
    substeps: f64,
    /// Length of a substep [s].
    h: f64,
    /// Impulses of rows in this substep times its length.
    lambda: Vec<f64>,
    /// Displacements of rows at the start of the substep.
    past: Vec<f64>,
    /// Impulses over the step.
    sum: Vec<f64>,
}

impl<'a> Flow<'a> {
    fn new(system: &'a System, substeps: u32) -> Flow<'a> {
        let velocity = system.bodies.iter().map(|body| body.start).collect();
        let substeps = f64::from(substeps.max(1));
        let zero = || vec![0.0; system.rows.len()];
        let (lambda, past, sum) = (zero(), zero(), zero());
        Flow { posed: Posed::new(system), velocity, substeps, h: system.dt / substeps, lambda, past, sum }
    }

    fn substep(&mut self) {
        let system = self.posed.system;
        let (contacts, joints) = system.laws.split_at(system.contacts);
        for (velocity, body) in self.velocity.iter_mut().zip(&system.bodies) {
            (0..2).for_each(|k| velocity[k] += (body.free[k] - body.start[k]) / self.substeps);
        }
        self.past = (0..system.rows.len()).map(|row| self.posed.along(row)).collect();
        let before: Vec<Place> = self.posed.places().to_vec();
        for (i, velocity) in self.velocity.iter().enumerate() {
            self.posed.displace(i, velocity.map(|v| v * self.h));
        }
        self.lambda.fill(0.0);
        joints.iter().for_each(|law| self.joint(law));
        // Friction comes after all normals: points that share a body would else slip aside by their order.
        contacts.iter().for_each(|law| self.contact(law));
        contacts.iter().for_each(|law| self.hold(law));
        let arrived = self.velocity.clone();
        for (i, before) in before.iter().enumerate().filter(|(i, _)| system.bodies[*i].dynamic) {
            self.velocity[i] = self.posed.since(before, i).map(|way| way / self.h);
        }
        let mut moving = Moving::new(system, |body| body.start);
        std::mem::swap(&mut moving.velocity, &mut self.velocity);
        contacts.iter().for_each(|law| self.collide(law, &arrived, &mut moving));
        self.velocity = moving.velocity;
        for (sum, lambda) in self.sum.iter_mut().zip(&self.lambda) {
            *sum += lambda / self.h;
        }
    }

    fn joint(&mut self, law: &SystemLaw) {
        let system = self.posed.system;
        let Law::Bounds { min, max } = law.law else { return };
        let (i, now) = (law.first, self.posed.row(law.first));
        let along = self.posed.along(i);
        let compliance = now.compliance * self.substeps * self.substeps;
        let error = match law.gap {
            Some(gap) => gap + along,
            None if compliance > 0.0 => along + now.bias * system.dt,
            None if law.drives || law.law != Law::LOCKED => along - self.past[i] + now.bias * self.h,
            None => law.off + along,
        };
        let scale = system.mobility(&now) + compliance;
        if scale > 0.0 {
            let unit = self.h / self.substeps;
            self.give(i, &now, (-error / scale).max(min * unit).min(max * unit));
        }
    }

    fn contact(&mut self, law: &SystemLaw) {
        let (i, now) = (law.first, self.posed.row(law.first));
        let depth = -law.gap.unwrap_or(0.0) - self.posed.along(i);
        let w = self.posed.system.mobility(&now);
        if depth > 0.0 && w > 0.0 {
            self.give(i, &now, depth / w);
        }
    }

    /// Static friction.
    fn hold(&mut self, law: &SystemLaw) {
        let Law::Contact { mu } = law.law else { return };
        let i = law.first;
        if self.lambda[i] <= 0.0 {
            return;
        }
        let tangents = [1, 2].map(|k| self.posed.row(i + k));
        let w = tangents.iter().map(|row| self.posed.system.mobility(row)).fold(f64::MIN_POSITIVE, f64::max);
        let slip = |k: usize| self.posed.along(i + k) - self.past[i + k] + tangents[k - 1].bias * self.h;
        let hold = project_disc([1, 2].map(|k| -slip(k) / w), mu * self.lambda[i]);
        (0..2).for_each(|k| self.give(i + 1 + k, &tangents[k], hold[k]));
    }

    /// Moves the bodies of a row.
    fn give(&mut self, i: usize, now: &SystemRow, by: f64) {
        self.posed.push(now, by);
        self.lambda[i] += by;
    }

    /// Sliding friction and restitution of a contact that was pushed. `arrived`: velocities before.
    fn collide(&mut self, law: &SystemLaw, arrived: &[Velocity], moving: &mut Moving<'_>) {
        let Law::Contact { mu } = law.law else { return };
        let (i, system) = (law.first, self.posed.system);
        let load = self.lambda[i] / self.h;
        if load <= 0.0 {
            return;
        }
        let rows = [0, 1, 2].map(|k| self.posed.row(i + k));
        let w = rows.map(|row| system.mobility(&row).max(f64::MIN_POSITIVE));
        let held = self.lambda[i + 1].hypot(self.lambda[i + 2]) / self.h;
        let slip = [1, 2].map(|k| -speed(&rows[k], &moving.velocity) / w[1].max(w[2]));
        let friction = project_disc(slip, (mu * load - held).max(0.0));
        let came = speed(&rows[0], arrived);
        let bounce = if -came > system.threshold { law.restitution } else { 0.0 };
        let leaves = if came < 0.0 { -bounce * came } else { came };
        for (k, p) in [(1, friction[0]), (2, friction[1])] {
            moving.push_along(&rows[k], p);
            self.sum[i + k] += p;
        }
        let p = (leaves - speed(&rows[0], &moving.velocity)) / w[0];
        moving.push_along(&rows[0], p);
        self.sum[i] += p;
    }
}

/// Velocity of a row, with its bias.
fn speed(row: &SystemRow, velocity: &[Velocity]) -> f64 {
    let side = |i: usize| {
        row.bodies[i]
            .map_or(0.0, |body| row.linear[i].dot(velocity[body][0]) + row.angular[i].dot(velocity[body][1]))
    };
    side(0) + side(1) + row.bias
}
