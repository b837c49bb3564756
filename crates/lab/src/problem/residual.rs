//! The distance of impulses from a solution: the natural map, which is zero at solutions only.

use super::{Law, Problem};

/// Below this velocity [m/s] a problem counts as one at rest.
const FLOOR: f64 = 1e-12;

/// The natural-map residual of impulses.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Residual {
    /// The norm of all errors over that of `q`: unit-free.
    pub relative: f64,
    /// The greatest error of one law [m/s].
    pub worst: f64,
}

impl Problem {
    /// The natural-map residual of impulses `r`: for each law `e = s (r - P(r - u / s))`, a velocity, where
    /// `P` projects onto the impulses that the law allows, `s` is the law's entry on the diagonal of W, and
    /// for Coulomb's law `u` has `mu |u_t|` added to its normal part (De Saxcé). Infinite if any number is
    /// not finite.
    pub fn residual(&self, r: &[f64]) -> Residual {
        self.residual_at(r, &self.velocities(r))
    }

    /// The same where the velocities `u` are known, for instance those that a step ended with.
    pub fn residual_at(&self, r: &[f64], u: &[f64]) -> Residual {
        if r.iter().chain(u).any(|x| !x.is_finite()) {
            return Residual { relative: f64::INFINITY, worst: f64::INFINITY };
        }
        // `hypot` does not overflow.
        let (mut sum, mut worst) = (0.0_f64, 0.0_f64);
        for (first, law) in self.laws() {
            let rows = first..first + law.rows();
            let error = self.law_error(first, law, r, &u[rows]);
            sum = sum.hypot(error);
            worst = worst.max(error);
            if !sum.is_finite() {
                return Residual { relative: f64::INFINITY, worst: f64::INFINITY };
            }
        }
        let scale = self.q().iter().fold(0.0_f64, |scale, x| scale.hypot(*x));
        Residual { relative: sum / scale.max(FLOOR), worst }
    }

    /// The factor from an impulse of a row to a velocity [1/kg]: its diagonal entry if positive, else the
    /// greatest entry of the row, else one.
    pub fn scale(&self, row: usize) -> f64 {
        let diagonal = self.w().at(row, row);
        if diagonal > 0.0 {
            return diagonal;
        }
        let most = self.w().row(row).fold(0.0_f64, |most, (_, value)| most.max(value.abs()));
        if most > 0.0 { most } else { 1.0 }
    }

    /// The error of one law [m/s]; `u` are the velocities of its rows.
    pub fn law_error(&self, first: usize, law: Law, r: &[f64], u: &[f64]) -> f64 {
        match law {
            Law::Bounds { min, max } => {
                let s = self.scale(first);
                // This equals r - (r - u / s).clamp(min, max), but does not lose u to rounding beside a great
                // r.
                s * nearest_within(u[0] / s, r[first] - max, r[first] - min).abs()
            }
            Law::Contact { mu } => {
                let s = self.scale(first);
                let slip = u[1].hypot(u[2]);
                let own = [r[first], r[first + 1], r[first + 2]];
                let to = [own[0] - (u[0] + mu * slip) / s, own[1] - u[1] / s, own[2] - u[2] / s];
                let to = project_cone(to, mu);
                s * norm([own[0] - to[0], own[1] - to[1], own[2] - to[2]])
            }
            Law::Patch { mu, arm, first: normals, count } => {
                let normal: f64 = r[normals..normals + count].iter().map(|x| x.max(0.0)).sum();
                let (s, twist) = (self.scale(first), self.scale(first + 2));
                let own = [r[first], r[first + 1]];
                let to = project_disc([own[0] - u[0] / s, own[1] - u[1] / s], mu * normal);
                let most = mu * arm * normal;
                let turned = r[first + 2] - nearest_within(r[first + 2] - u[2] / twist, -most, most);
                // A twist counts as the velocity of the points, `arm` from their middle.
                s * (own[0] - to[0]).hypot(own[1] - to[1]) + arm * twist * turned.abs()
            }
        }
    }
}

/// The nearest number in a range: `f64::clamp` without its panic for NaN limits, which overflows cause.
pub(crate) fn nearest_within(x: f64, min: f64, max: f64) -> f64 {
    x.max(min).min(max)
}

fn norm(x: [f64; 3]) -> f64 {
    x[0].hypot(x[1]).hypot(x[2])
}

/// The point of the friction cone `|t| <= mu n` that is nearest to `x` (normal first).
pub fn project_cone(x: [f64; 3], mu: f64) -> [f64; 3] {
    let (n, t) = (x[0], x[1].hypot(x[2]));
    if t <= mu * n {
        return x;
    }
    if mu * t <= -n {
        return [0.0; 3];
    }
    let normal = (n + mu * t) / (1.0 + mu * mu);
    let share = if t > 0.0 { mu * normal / t } else { 0.0 };
    [normal, x[1] * share, x[2] * share]
}

/// The point of a disc about the origin that is nearest to `x`.
pub fn project_disc(x: [f64; 2], radius: f64) -> [f64; 2] {
    let t = x[0].hypot(x[1]);
    if t <= radius { x } else { x.map(|x| x * radius / t) }
}

#[cfg(test)]
mod tests {
    use super::super::Matrix;
    use super::*;

    /// A ball of 2 kg that falls at 3 m/s and slides at 4 on a floor with mu = 0.5: 6 N s stop it, 3 N s
    /// brake it, to 2.5 m/s.
    #[test]
    fn the_impulse_of_a_sliding_ball_has_no_residual() {
        let w = Matrix::from_entries(3, (0..3).map(|i| (i, i, 0.5)));
        let problem = Problem::new(vec![Law::Contact { mu: 0.5 }], w, vec![-3.0, 4.0, 0.0]).unwrap();
        assert!(problem.residual(&[6.0, -3.0, 0.0]).relative < 1e-15);
        // Too little, too much, none, and friction to the wrong side.
        for wrong in [[5.0, -2.5, 0.0], [7.0, -3.5, 0.0], [0.0; 3], [6.0, 3.0, 0.0], [6.0, -2.0, 0.0]] {
            assert!(problem.residual(&wrong).worst > 0.1, "{wrong:?}");
        }
    }

    #[test]
    fn the_projection_onto_the_cone_leaves_what_is_perpendicular_to_it() {
        for (x, mu) in
            [([1.0, 3.0, 4.0], 0.5), ([-1.0, 3.0, 4.0], 0.5), ([-9.0, 3.0, 4.0], 0.5), ([2.0, 0.5, 0.5], 0.7)]
        {
            let p = project_cone(x, mu);
            let rest = [x[0] - p[0], x[1] - p[1], x[2] - p[2]];
            assert!(p[1].hypot(p[2]) <= mu * p[0] + 1e-15);
            assert!((0..3).map(|i| p[i] * rest[i]).sum::<f64>().abs() < 1e-12, "{x:?}");
            // The remainder lies in the polar cone.
            assert!(mu * rest[1].hypot(rest[2]) <= -rest[0] + 1e-12, "{x:?}");
        }
    }
}
