//! The distance of impulses from a solution: the natural map, which is zero at solutions only.

use super::twice::{Real, Twice};
use super::{Law, Matrix, Problem};

/// Below this velocity [m/s] a problem counts as one at rest.
const FLOOR: f64 = 1e-12;
/// A diagonal entry below this share of its row is rounding: for masses it would take a ratio of 1e24.
const ROUNDING: f64 = 1e-12;
/// Impulses above this, in units of q over W, leave no digit of q even in twice the precision.
const GREATEST: f64 = 1e60;

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
    /// `P` projects onto the impulses that the law allows, `s` is the [scale](Problem::scale) of the law, and
    /// for Coulomb's law `u` has `mu |u_t|` added to its normal part (De Saxcé). Infinite if any number is
    /// not finite, or `r` so great that no digit of the velocities is left.
    ///
    /// It is computed in twice the precision of `f64`, and so holds for these very numbers: beside impulses
    /// of 1e16 the velocities of `f64` are nothing but rounding, and a law that fails would seem to hold.
    pub fn residual(&self, r: &[f64]) -> Residual {
        // Powers of two, so that products neither overflow nor lose digits.
        let by_w = power_of_two(self.w().values().iter().copied());
        let by_q = power_of_two(self.q().iter().copied());
        let impulses: Vec<f64> = r.iter().map(|r| r * by_w / by_q).collect();
        if impulses.iter().any(|r| !r.is_finite() || r.abs() > GREATEST) {
            return Residual { relative: f64::INFINITY, worst: f64::INFINITY };
        }
        let impulses: Vec<Twice> = impulses.into_iter().map(Twice::from).collect();
        let velocity = |i: usize| {
            let products = self.w().row(i).map(|(j, w)| Twice::product(w / by_w, impulses[j].rounded()));
            products.fold(Twice::from(self.q()[i] / by_q), |sum, product| sum + product)
        };
        let u: Vec<Twice> = (0..self.rows()).map(velocity).collect();
        let error = |first, law| error_of(self, first, law, &impulses, &u, [by_w, by_w / by_q]).rounded();
        self.sum_of_errors(by_q, self.laws().map(|(first, law)| error(first, law)))
    }

    /// The same in `f64`, where the velocities `u` are known, for instance those that a step ended with.
    pub fn residual_at(&self, r: &[f64], u: &[f64]) -> Residual {
        if r.iter().chain(u).any(|x| !x.is_finite()) {
            return Residual { relative: f64::INFINITY, worst: f64::INFINITY };
        }
        self.sum_of_errors(1.0, self.laws().map(|(first, law)| error_of(self, first, law, r, u, [1.0, 1.0])))
    }

    /// The residual of errors that are in units of `by`.
    fn sum_of_errors(&self, by: f64, errors: impl Iterator<Item = f64>) -> Residual {
        // `hypot` does not overflow.
        let (mut sum, mut worst) = (0.0_f64, 0.0_f64);
        for error in errors {
            sum = sum.hypot(error);
            worst = worst.max(error);
            if !sum.is_finite() {
                return Residual { relative: f64::INFINITY, worst: f64::INFINITY };
            }
        }
        let scale = self.q().iter().fold(0.0_f64, |scale, x| scale.hypot(*x));
        Residual { relative: sum / (scale / by).max(FLOOR / by), worst: worst * by }
    }

    /// The factor from an impulse of a row to a velocity [1/kg]: its diagonal entry if that is positive and
    /// not mere rounding beside the greatest entry of the row, else that entry, or one if there is none.
    pub fn scale(&self, row: usize) -> f64 {
        self.scales[row]
    }
}

/// [`Problem::scale`] of a row of W.
pub(super) fn scale(w: &Matrix, row: usize) -> f64 {
    let most = w.row(row).fold(0.0_f64, |most, (_, value)| most.max(value.abs()));
    let diagonal = w.at(row, row);
    if diagonal > ROUNDING * most {
        diagonal
    } else if most > 0.0 {
        most
    } else {
        1.0
    }
}

/// The error of one law [m/s], where W is divided by `by_w`, and impulses are multiplied by `by_r`.
fn error_of<T: Real>(problem: &Problem, first: usize, law: Law, r: &[T], u: &[T], by: [f64; 2]) -> T {
    let [by_w, by_r] = by;
    let scale = |row: usize| T::from(problem.scale(row) / by_w);
    let s = scale(first);
    match law {
        Law::Bounds { min, max } => {
            let [min, max] = [min, max].map(|bound| T::from(bound * by_r));
            // This equals r - (r - u / s).clamp(min, max), but does not lose u to rounding beside a great r.
            let error = s * (u[first] / s).within(r[first] - max, r[first] - min);
            error.most(-error)
        }
        Law::Contact { mu } => {
            let mu = T::from(mu);
            let own = [r[first], r[first + 1], r[first + 2]];
            let slip = u[first + 1].length(u[first + 2]);
            let moved = [u[first] + mu * slip, u[first + 1], u[first + 2]];
            let to = [0, 1, 2].map(|i| own[i] - moved[i] / s);
            if to[1].length(to[2]) <= mu * to[0] {
                // As the projection does not move it, this is own - to without its rounding.
                return moved[0].length(moved[1]).length(moved[2]);
            }
            let to = nearest_in_cone(to, mu);
            let [n, a, b] = [0, 1, 2].map(|i| own[i] - to[i]);
            s * n.length(a).length(b)
        }
        Law::Patch { mu, arm, first: normals, count } => {
            let (zero, arm) = (T::from(0.0), T::from(arm));
            let normal = r[normals..normals + count].iter().fold(zero, |sum, &x| sum + x.most(zero));
            let (twist, most) = (scale(first + 2), T::from(mu) * normal);
            let own = [r[first], r[first + 1]];
            let to = nearest_in_disc([own[0] - u[first] / s, own[1] - u[first + 1] / s], most);
            let turned = (u[first + 2] / twist).within(r[first + 2] - arm * most, r[first + 2] + arm * most);
            // A twist counts as the velocity of the points, `arm` from their middle.
            s * (own[0] - to[0]).length(own[1] - to[1]) + arm * twist * turned.most(-turned)
        }
    }
}

/// The nearest number in a range: `f64::clamp` without its panic for NaN limits, which overflows cause.
pub(crate) fn nearest_within(x: f64, min: f64, max: f64) -> f64 {
    x.max(min).min(max)
}

/// The greatest power of two that is not above the greatest absolute value, or one where all are zero.
pub(crate) fn power_of_two(values: impl Iterator<Item = f64>) -> f64 {
    let most = values.fold(0.0_f64, |most, x| most.max(x.abs()));
    if most == 0.0 || !most.is_finite() {
        return 1.0;
    }
    f64::from_bits(most.max(f64::MIN_POSITIVE).to_bits() & 0x7ff0_0000_0000_0000)
}

/// The point of the friction cone `|t| <= mu n` that is nearest to `x` (normal first).
pub fn project_cone(x: [f64; 3], mu: f64) -> [f64; 3] {
    nearest_in_cone(x, mu)
}

/// The point of a disc about the origin that is nearest to `x`.
pub fn project_disc(x: [f64; 2], radius: f64) -> [f64; 2] {
    nearest_in_disc(x, radius)
}

fn nearest_in_cone<T: Real>(x: [T; 3], mu: T) -> [T; 3] {
    let (n, t, zero) = (x[0], x[1].length(x[2]), T::from(0.0));
    if t <= mu * n {
        return x;
    }
    if mu * t <= -n {
        return [zero; 3];
    }
    let normal = (n + mu * t) / (T::from(1.0) + mu * mu);
    let share = if t > zero { mu * normal / t } else { zero };
    [normal, x[1] * share, x[2] * share]
}

fn nearest_in_disc<T: Real>(x: [T; 2], radius: T) -> [T; 2] {
    let t = x[0].length(x[1]);
    if t <= radius { x } else { x.map(|x| x * radius / t) }
}

#[cfg(test)]
mod tests {
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
