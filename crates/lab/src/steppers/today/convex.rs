//! The convex problem of soft constraints, which Drake's SAP and MuJoCo share: each row has a regularisation
//! `R` and a velocity `v̂` that it strives for, and the velocities of the bodies minimise
//! `½ (v - v*)ᵀ M (v - v*) + Σ ½ γᵀ R γ` with the impulses `γ = P(R⁻¹ (v̂ - J v))`, projected onto their
//! bounds or their cones in the norm of R (Castro, Permenter and Han 2022; Todorov 2014). The objective is
//! strictly convex, so that there is one answer, to which Newton's method with an exact line search converges
//! from anywhere. At it `M (v - v*) = Jᵀ γ`.
//!
//! Friction on the cone is part of the objective and not Coulomb's law: a sliding contact separates at
//! `mu |v_t|`.

use crate::methods::{Effort, Status};
use crate::problem::Law;
use crate::system::{SIDES, System};
use glam::{DMat3, DVec3};
use nalgebra::{Cholesky, DMatrix, DVector};

/// Below this share of its scale the gradient is zero.
const FLOOR: f64 = 1e-12;

/// What a row is asked for.
#[derive(Clone, Copy, Debug)]
pub(super) struct Soft {
    /// Regularisation [1/kg] or [1/(kg m²)], above zero.
    pub(super) r: f64,
    /// The velocity that it strives for [m/s] or [rad/s].
    pub(super) target: f64,
    /// Whether it acts at all.
    pub(super) acts: bool,
}

/// The problem of some bodies.
pub(super) struct Convex {
    /// Law and first row; the normal comes first in a cone.
    laws: Vec<(Law, usize)>,
    soft: Vec<Soft>,
    /// J M^-1/2, and J v* minus the targets.
    b: DMatrix<f64>,
    free: DVector<f64>,
}

/// The answer.
pub(super) struct Minimum {
    pub(super) status: Status,
    pub(super) impulses: Vec<f64>,
    pub(super) iterations: u32,
}

impl Convex {
    /// `soft`: by the rows of the system.
    pub(super) fn new(system: &System, bodies: &[usize], soft: Vec<Soft>) -> Convex {
        let rows = system.rows.len();
        let mut b = DMatrix::zeros(rows, 6 * bodies.len());
        let roots: Vec<(DVec3, DMat3)> = bodies.iter().map(|&i| root(system, i)).collect();
        let mut free = DVector::zeros(rows);
        for (i, row) in system.rows.iter().enumerate() {
            free[i] = system.speed(row, |body| body.free) + row.bias - soft[i].target;
            for side in 0..SIDES {
                let place = row.bodies[side].and_then(|body| bodies.binary_search(&body).ok());
                let Some(place) = place else { continue };
                let (linear, angular) = &roots[place];
                let halves = [*linear * row.linear[side], angular.transpose() * row.angular[side]];
                for (k, x) in halves.iter().flat_map(DVec3::to_array).enumerate() {
                    b[(i, 6 * place + k)] += x;
                }
            }
        }
        let laws = system.laws.iter().filter(|law| soft[law.first].acts).map(|law| (law.law, law.first));
        Convex { laws: laws.collect(), soft, b, free }
    }

    /// Newton's method. The unknowns are `z = M^1/2 (v - v*)`, in which the masses are one.
    pub(super) fn minimise(&self, effort: &Effort) -> Minimum {
        let mut z = DVector::zeros(self.b.ncols());
        let (mut status, mut iterations) = (Status::Limit, 0);
        let mut impulses = self.impulses(&(&self.b * &z + &self.free));
        while iterations < effort.iterations.min(200) {
            let given = self.b.tr_mul(&impulses);
            let gradient = &z - &given;
            let scale = z.norm().max(given.norm()).max(FLOOR);
            if gradient.norm() <= effort.tolerance.max(1e-14) * scale {
                status = Status::Solved;
                break;
            }
            iterations += 1;
            let u = &self.b * &z + &self.free;
            let Some(factor) = Cholesky::new(self.hessian(&u)) else { break };
            let step = -factor.solve(&gradient);
            let along = &self.b * &step;
            let far = self.search(&z, &step, &u, &along);
            if !(far > 0.0 && far.is_finite()) {
                break;
            }
            z += far * step;
            impulses = self.impulses(&(u + far * along));
        }
        Minimum { status, impulses: impulses.as_slice().to_vec(), iterations }
    }

    /// How far to go along a step: where the derivative of the objective is zero, which grows with the way.
    /// Newton's method in a bracket.
    fn search(&self, z: &DVector<f64>, step: &DVector<f64>, u: &DVector<f64>, along: &DVector<f64>) -> f64 {
        let slope =
            |t: f64| z.dot(step) + t * step.norm_squared() - self.impulses(&(u + t * along)).dot(along);
        let (mut low, mut high) = (0.0, 1.0);
        let start = slope(0.0);
        let mut end = slope(high);
        while end < 0.0 && high < 1e6 {
            (low, high) = (high, 2.0 * high);
            end = slope(high);
        }
        let mut begin = if low > 0.0 { slope(low) } else { start };
        if end.abs() <= 1e-13 * start.abs() {
            return high;
        }
        for _ in 0..100 {
            // The secant, kept off the ends, which one side alone would hold on to.
            let t = low + (high - low) * (begin / (begin - end)).clamp(0.05, 0.95);
            let now = slope(t);
            if now.abs() <= 1e-13 * start.abs() || high - low <= 1e-15 * high {
                return t;
            }
            if now < 0.0 {
                (low, begin) = (t, now);
            } else {
                (high, end) = (t, now);
            }
        }
        0.5 * (low + high)
    }

    /// The projected impulses at velocities `u`, from which targets are already subtracted.
    pub(super) fn impulses(&self, u: &DVector<f64>) -> DVector<f64> {
        let mut impulses = DVector::zeros(u.len());
        for &(law, first) in &self.laws {
            let asked = |k: usize| -u[first + k] / self.soft[first + k].r;
            match law {
                Law::Bounds { min, max } => impulses[first] = asked(0).max(min).min(max),
                Law::Contact { mu } => {
                    let own = project([asked(0), asked(1), asked(2)], mu, self.ratio(first)).0;
                    (0..3).for_each(|k| impulses[first + k] = own[k]);
                }
                Law::Patch { .. } => {}
            }
        }
        impulses
    }

    fn ratio(&self, first: usize) -> f64 {
        self.soft[first + 1].r / self.soft[first].r
    }

    /// W with the regularisation, and q of the dual problem.
    #[cfg(test)]
    pub(super) fn dual(&self) -> (DMatrix<f64>, DVector<f64>) {
        let mut w = &self.b * self.b.transpose();
        self.soft.iter().enumerate().for_each(|(i, soft)| w[(i, i)] += soft.r);
        (w, self.free.clone())
    }

    /// `I + Bᵀ G B`, with G the derivative of minus the impulses by the velocities.
    fn hessian(&self, u: &DVector<f64>) -> DMatrix<f64> {
        let size = self.b.ncols();
        let mut g = DMatrix::zeros(self.b.nrows(), size);
        for &(law, first) in &self.laws {
            let inverse = |k: usize| 1.0 / self.soft[first + k].r;
            match law {
                Law::Bounds { min, max } => {
                    let y = -u[first] * inverse(0);
                    if min < y && y < max {
                        g.row_mut(first).copy_from(&(self.b.row(first) * inverse(0)));
                    }
                }
                Law::Contact { mu } => {
                    let y = [0, 1, 2].map(|k| -u[first + k] * inverse(k));
                    let (_, by) = project(y, mu, self.ratio(first));
                    for (i, by) in by.iter().enumerate() {
                        for (j, by) in by.iter().enumerate().filter(|(_, by)| **by != 0.0) {
                            let add = self.b.row(first + j) * (by * inverse(j));
                            let mut row = g.row_mut(first + i);
                            row += add;
                        }
                    }
                }
                Law::Patch { .. } => {}
            }
        }
        let mut hessian = self.b.tr_mul(&g);
        (0..size).for_each(|i| hessian[(i, i)] += 1.0);
        hessian
    }
}

/// The projection of an impulse onto a cone in the norm of R, and its derivative.
/// `ratio`: the regularisation of both tangents over that of the normal.
pub(super) fn project(y: [f64; 3], mu: f64, ratio: f64) -> ([f64; 3], [[f64; 3]; 3]) {
    let ratio = mu * ratio;
    let slip = y[1].hypot(y[2]);
    if slip <= mu * y[0] {
        return (y, [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]]);
    }
    if y[0] <= -ratio * slip {
        return ([0.0; 3], [[0.0; 3]; 3]);
    }
    let share = 1.0 / (1.0 + mu * ratio);
    let normal = (y[0] + ratio * slip) * share;
    let t = if slip > 0.0 { [y[1] / slip, y[2] / slip] } else { [0.0; 2] };
    let over = if slip > 0.0 { normal / slip } else { 0.0 };
    let tangent = |i: usize, j: usize| {
        let (along, same) = (t[i] * t[j], f64::from(u8::from(i == j)));
        mu * (over * (same - along) + ratio * share * along)
    };
    let derivative = [
        [share, ratio * share * t[0], ratio * share * t[1]],
        [mu * share * t[0], tangent(0, 0), tangent(0, 1)],
        [mu * share * t[1], tangent(1, 0), tangent(1, 1)],
    ];
    ([normal, mu * normal * t[0], mu * normal * t[1]], derivative)
}

/// The square root of a body's inverse mass by axis, and a factor of its inverse inertia: `L Lᵀ`. An axis
/// that is locked has none.
pub(super) fn root(system: &System, body: usize) -> (DVec3, DMat3) {
    let body = &system.bodies[body];
    let mass = body.inverse_mass;
    let linear = DVec3::new(mass.x.sqrt(), mass.y.sqrt(), mass.z.sqrt());
    let mut l = [[0.0_f64; 3]; 3];
    let most = (0..3).map(|i| body.inverse_inertia.col(i)[i]).fold(0.0, f64::max);
    for i in 0..3 {
        for j in 0..=i {
            let known: f64 = (0..j).map(|k| l[i][k] * l[j][k]).sum();
            let rest = body.inverse_inertia.col(j)[i] - known;
            l[i][j] = if i == j {
                if rest > 1e-14 * most { rest.sqrt() } else { 0.0 }
            } else if l[j][j] > 0.0 {
                rest / l[j][j]
            } else {
                0.0
            };
        }
    }
    (linear, DMat3::from_cols_array_2d(&l).transpose())
}
