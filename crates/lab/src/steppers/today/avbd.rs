//! Augmented vertex block descent (Giles, Diaz and Yuksel, *Augmented vertex block descent*, 2025).
//!
//! A step is implicit Euler: positions minimise `½ |x - y|² M / dt²`, with y where bodies would fly, plus the
//! energy `½ k C² - λ C` of each row. Each iteration minimises over one body after the other, six numbers at
//! a time, with Newton's matrix of the body's own rows and the stiffness of turning directions, lumped; then
//! multipliers become the forces, `λ = clamp(λ - k C)`, and penalties k of rows within their bounds grow with
//! the error, to hold without oscillating. Springs keep their own stiffness and have no multiplier.
//!
//! Penalties begin at the row's mass over `dt²` and grow by that for each millimetre of error times
//! [`GROWTH`]; the authors' numbers have units. Multipliers carry over to the next step, penalties do not. Of
//! the error of the start of a step, [`KEPT`] stays, which keeps its correction from being a jump. Nothing
//! bounces.

use super::convex::root;
use super::points::{Found, Points};
use super::posed::Posed;
use crate::methods::{Effort, Status};
use crate::problem::{Law, project_disc};
use crate::steppers::step::{Resolution, Step};
use crate::system::{SIDES, System, SystemLaw, SystemRow};
use glam::{DMat3, DVec3};
use nalgebra::{Matrix6, Vector6};

/// The most iterations of a step.
const ITERATIONS: u32 = 20;
/// Penalty to begin with, in masses over the square of the step.
const FIRST: f64 = 1.0;
/// By how much it grows in the same unit per millimetre.
const GROWTH: f64 = 1.0;
/// The greatest penalty in the same unit.
const MOST: f64 = 1e5;
/// Share of the error of the start that is not corrected in the step (the authors' α).
const KEPT: f64 = 0.95;
/// Share of multipliers that carries over (their α γ).
const WARM: f64 = 0.95 * 0.99;

/// Body after body by Newton's method on the energy of penalties, which multipliers make exact.
pub fn avbd(step: &Step<'_>, effort: &Effort) -> Resolution {
    let points = Points::new(step);
    let iterations = effort.iterations.min(ITERATIONS);
    let start = points.start(step, effort.start.as_deref());
    let mut descent = Descent::new(&points.system, &step.island.bodies, start);
    for _ in 0..iterations {
        descent.primal();
        descent.dual();
    }
    let dt = points.system.dt;
    let impulses: Vec<f64> = descent.force.iter().map(|force| force * dt).collect();
    let end = step.island.bodies.iter().map(|&i| descent.posed.travelled(i).map(|way| way / dt)).collect();
    let (status, impulses) = (Status::Solved, impulses.as_slice());
    points.resolution(step, Found { status, impulses, iterations, end, moving: None })
}

/// A step on its way.
struct Descent<'a> {
    posed: Posed<'a>,
    bodies: Vec<Body>,
    /// Multipliers [N], and the forces that follow from them.
    lambda: Vec<f64>,
    force: Vec<f64>,
    /// Penalties [N/m], and the stiffness of springs or the greatest penalty.
    k: Vec<f64>,
    most: Vec<f64>,
}

/// The forces of a law by its rows, clamped [N].
struct Forces {
    force: [f64; 3],
    /// Whether a row resists with its penalty.
    resists: [bool; 3],
    /// Of a point that slides, the force over its slip, as a share of the penalty, with which it resists:
    /// with the derivative of friction, which is zero along the slip, points slip back and forth.
    slides: f64,
}

/// A body with the square root of its inverse mass.
struct Body {
    index: usize,
    root: (DVec3, DMat3),
    /// How far it is from where it would fly, in the unit in which its mass is one.
    off: Vector6<f64>,
    laws: Vec<usize>,
}

impl<'a> Descent<'a> {
    fn new(system: &'a System, bodies: &[usize], start: Option<Vec<f64>>) -> Descent<'a> {
        let mut posed = Posed::new(system);
        for (i, body) in system.bodies.iter().enumerate() {
            posed.displace(i, body.free.map(|v| v * system.dt));
        }
        let touches = |law: &SystemLaw, body: usize| system.rows[law.first].bodies.contains(&Some(body));
        let body = |&index: &usize| Body {
            index,
            root: root(system, index),
            off: Vector6::zeros(),
            laws: (0..system.laws.len()).filter(|&i| touches(&system.laws[i], index)).collect(),
        };
        let unit = |row: &SystemRow| {
            let mobility = system.mobility(row);
            if mobility > 0.0 { 1.0 / (mobility * system.dt * system.dt) } else { 0.0 }
        };
        let spring = |row: &SystemRow| 1.0 / (row.compliance * system.dt * system.dt);
        let most = |row: &SystemRow| if row.compliance > 0.0 { spring(row) } else { MOST * unit(row) };
        let most: Vec<f64> = system.rows.iter().map(most).collect();
        let first = |row: &SystemRow| if row.compliance > 0.0 { spring(row) } else { FIRST * unit(row) };
        let k = system.rows.iter().map(first).collect();
        let mut lambda = start.unwrap_or_else(|| vec![0.0; system.rows.len()]);
        for (lambda, row) in lambda.iter_mut().zip(&system.rows) {
            *lambda *= if row.compliance > 0.0 { 0.0 } else { WARM / system.dt };
        }
        let force = lambda.clone();
        Descent { posed, bodies: bodies.iter().map(body).collect(), lambda, force, k, most }
    }

    /// The error of a law's row at the present positions [m] or [rad].
    fn error(&self, law: &SystemLaw, k: usize) -> f64 {
        let system = self.posed.system;
        let row = law.first + k;
        let (along, drift) = (self.posed.along(row), system.rows[row].bias * system.dt);
        match law.gap {
            _ if k > 0 => along + drift,
            Some(gap) if gap > 0.0 => gap + along,
            Some(gap) => (1.0 - KEPT) * gap + along,
            None if law.law == Law::LOCKED && !law.drives => (1.0 - KEPT) * law.off + along + drift,
            None => along + drift,
        }
    }

    /// The forces of a law, and how they change.
    fn forces(&self, law: &SystemLaw) -> Forces {
        let i = law.first;
        let asked = |k: usize| self.lambda[i + k] - self.k[i + k] * self.error(law, k);
        match law.law {
            Law::Bounds { min, max } => {
                let dt = self.posed.system.dt;
                let (min, max, asked) = (min / dt, max / dt, asked(0));
                let resists = [min < asked && asked < max, false, false];
                Forces { force: [asked.max(min).min(max), 0.0, 0.0], resists, slides: 0.0 }
            }
            Law::Contact { mu } => {
                let normal = asked(0).max(0.0);
                let asked = [asked(1), asked(2)];
                let [x, y] = project_disc(asked, mu * normal);
                let (pushes, most) = (normal > 0.0, asked[0].hypot(asked[1]));
                let sticks = pushes && most <= mu * normal;
                let slides = if pushes && !sticks { mu * normal / most } else { 0.0 };
                Forces { force: [normal, x, y], resists: [pushes, sticks, sticks], slides }
            }
            Law::Patch { .. } => Forces { force: [0.0; 3], resists: [false; 3], slides: 0.0 },
        }
    }

    /// Newton's step for one body after the other.
    fn primal(&mut self) {
        let square = 1.0 / (self.posed.system.dt * self.posed.system.dt);
        for at in 0..self.bodies.len() {
            let body = &self.bodies[at];
            let mut matrix = Matrix6::identity() * square;
            let mut push = -body.off * square;
            for law in body.laws.iter().map(|&i| &self.posed.system.laws[i]) {
                let Forces { force, resists, slides } = self.forces(law);
                let now = [0, 1, 2].map(|k| self.posed.row(law.first + k.min(law.law.rows() - 1)));
                let Some(side) = (0..SIDES).find(|&side| now[0].bodies[side] == Some(body.index)) else {
                    continue;
                };
                let j = now.map(|row| body.scaled(row.linear[side], row.angular[side]));
                for k in 0..law.law.rows() {
                    let row = law.first + k;
                    push += j[k] * force[k];
                    let share = if resists[k] { 1.0 } else { f64::from(u8::from(k > 0)) * slides };
                    if share > 0.0 {
                        matrix += j[k] * j[k].transpose() * (share * self.k[row]);
                    }
                    let lump = force[k].abs() * self.posed.arm(row, side);
                    if lump > 0.0 {
                        matrix += body.turning(lump);
                    }
                }
            }
            let Some(factor) = matrix.cholesky() else { continue };
            let step = factor.solve(&push);
            let body = &mut self.bodies[at];
            body.off += step;
            let (linear, angular) = &body.root;
            let by = [DVec3::new(step[0], step[1], step[2]), DVec3::new(step[3], step[4], step[5])];
            let index = body.index;
            let by = [*linear * by[0], *angular * by[1]];
            self.posed.displace(index, by);
        }
    }

    /// Multipliers follow the forces, and penalties grow.
    fn dual(&mut self) {
        let system = self.posed.system;
        for law in &system.laws {
            let Forces { force, resists, .. } = self.forces(law);
            for k in 0..law.law.rows() {
                let row = law.first + k;
                self.force[row] = force[k];
                if system.rows[row].compliance > 0.0 {
                    continue;
                }
                self.lambda[row] = force[k];
                if resists[k] {
                    let unit = self.most[row] / MOST;
                    let grown = self.k[row] + GROWTH * unit * 1e3 * self.error(law, k).abs();
                    self.k[row] = grown.min(self.most[row]);
                }
            }
        }
    }
}

impl Body {
    /// J in the unit in which the body's mass is one.
    fn scaled(&self, linear: DVec3, angular: DVec3) -> Vector6<f64> {
        let (mass, inertia) = &self.root;
        let ([a, b, c], [d, e, f]) =
            ((*mass * linear).to_array(), (inertia.transpose() * angular).to_array());
        Vector6::new(a, b, c, d, e, f)
    }

    /// A stiffness against rotation in the same unit.
    fn turning(&self, stiffness: f64) -> Matrix6<f64> {
        let own = self.root.1.transpose() * self.root.1 * stiffness;
        Matrix6::from_fn(|i, j| if i < 3 || j < 3 { 0.0 } else { own.col(j - 3)[i - 3] })
    }
}
