//! Proofs that a problem has no solution.

use super::residual::power_of_two;
use super::twice::{Real, Twice};
use super::{Law, Problem};

/// What counts as zero in a sum of products of W and y, relative to the sum of their magnitudes: the rounding
/// of y and of W, each half a unit in the last place, twice over.
const ROUNDINGS: f64 = 2.0 * f64::EPSILON;
/// The least contradiction, relative to the terms of its sum.
const LEAST: f64 = 1e-9;

impl Problem {
    /// Whether `y`, a number for each row, proves that no impulses obey all laws: each law allows only
    /// velocities with `y u >= 0`, but for all impulses that the laws allow `y (W r + q) < 0` (Farkas' lemma;
    /// for contacts `Wᵀ y` has to be in the polar of the friction cone).
    ///
    /// `y` is not negative in normals of contacts and in rows with a lower bound only, not positive in those
    /// with an upper bound only, of either sign in rows without bounds, and zero in all others. The sums are
    /// computed in twice the precision of `f64`. What the rounding of W and y explains counts as zero, so
    /// that a problem is contradicted too if the last digit of W decides whether it has a solution: none
    /// that `f64` could hold.
    pub fn is_contradicted_by(&self, y: &[f64]) -> bool {
        let greatest = y.iter().fold(0.0_f64, |most, y| most.max(y.abs()));
        if y.len() != self.rows() || !(greatest > 0.0 && greatest.is_finite()) || !self.admits(y) {
            return false;
        }
        let by_w = power_of_two(self.w().values().iter().copied());
        let by_q = power_of_two(self.q().iter().copied());
        let zero = Twice::from(0.0);
        let (mut pressed, mut size) = (vec![zero; y.len()], vec![0.0; y.len()]);
        let (mut sum, mut terms) = (zero, 0.0);
        for (i, y) in y.iter().map(|y| y / greatest).enumerate().filter(|row| row.1 != 0.0) {
            for (j, w) in self.w().row(i) {
                pressed[j] = pressed[j] + Twice::product(w / by_w, y);
                size[j] += (w / by_w * y).abs();
            }
            sum = sum + Twice::product(self.q()[i] / by_q, y);
            terms += (self.q()[i] / by_q * y).abs();
        }
        let pressed: Vec<f64> = pressed.iter().map(|p| p.rounded()).collect();
        // The most that impulses can add, which has to be finite.
        let mut friction = vec![[0.0; 2]; y.len()];
        for (first, law) in self.laws() {
            if let Law::Patch { mu, arm, first: normals, count } = law {
                let of = |p: &[f64]| mu * (p[first].length(p[first + 1]) + arm * p[first + 2].abs());
                let (most, rounding) = (of(&pressed), of(&size));
                friction[normals..normals + count].iter_mut().for_each(|[a, b]| {
                    *a += most;
                    *b += rounding;
                });
            }
        }
        for (first, law) in self.laws() {
            let (p, s) = (pressed[first], ROUNDINGS * size[first]);
            match law {
                Law::Contact { mu } => {
                    let t = pressed[first + 1].length(pressed[first + 2]);
                    let rounding = s + mu * ROUNDINGS * size[first + 1].length(size[first + 2]);
                    if !least(p + mu * t, rounding) {
                        return false;
                    }
                }
                Law::Bounds { min, max } => {
                    let [extra, rounding] = friction[first];
                    let up = p + extra;
                    let most = [(min, if min > 0.0 { up } else { p }), (max, if max > 0.0 { up } else { p })]
                        .map(|(bound, p)| term(p, bound, s + ROUNDINGS * rounding));
                    let inside = if min <= 0.0 && max >= 0.0 { 0.0 } else { f64::NEG_INFINITY };
                    let add = most[0].max(most[1]).max(inside) * (by_w / by_q);
                    if !add.is_finite() {
                        return false;
                    }
                    sum = sum + Twice::from(add);
                    terms += add.abs();
                }
                Law::Patch { .. } => {}
            }
        }
        sum.rounded() < -LEAST * terms
    }

    /// Whether all laws allow only velocities with `y u >= 0`.
    fn admits(&self, y: &[f64]) -> bool {
        self.laws().all(|(first, law)| match law {
            Law::Bounds { min, max } => match (min.is_finite(), max.is_finite()) {
                (true, false) => y[first] >= 0.0,
                (false, true) => y[first] <= 0.0,
                (false, false) => true,
                (true, true) => y[first] == 0.0,
            },
            Law::Contact { .. } => y[first] >= 0.0 && y[first + 1] == 0.0 && y[first + 2] == 0.0,
            Law::Patch { .. } => y[first..first + 3].iter().all(|&y| y == 0.0),
        })
    }
}

/// Whether a number is not positive but by rounding.
fn least(p: f64, rounding: f64) -> bool {
    p <= rounding
}

/// What an impulse at a bound adds.
fn term(p: f64, bound: f64, rounding: f64) -> f64 {
    match p.abs() <= rounding {
        true if bound.is_finite() => 0.0,
        true => f64::NEG_INFINITY,
        false => p * bound,
    }
}

#[cfg(test)]
mod tests {
    use super::super::Matrix;
    use super::*;

    fn contacts(w: &[&[f64]], q: &[f64], mu: f64) -> Problem {
        let entries = w.iter().enumerate().flat_map(|(i, row)| row.iter().enumerate().map(move |e| (i, e)));
        let w = Matrix::from_entries(w.len(), entries.map(|(i, (j, &x))| (i, j, x)));
        Problem::new(vec![Law::Contact { mu }; q.len() / 3], w, q.to_vec()).unwrap()
    }

    /// A body between a floor and a ceiling that approach each other.
    #[test]
    fn what_is_squeezed_from_both_sides_has_no_solution() {
        let w: [[f64; 6]; 6] = [
            [1.0, 0.0, 0.0, -1.0, 0.0, 0.0],
            [0.0, 1.0, 0.0, 0.0, 1.0, 0.0],
            [0.0, 0.0, 1.0, 0.0, 0.0, 1.0],
            [-1.0, 0.0, 0.0, 1.0, 0.0, 0.0],
            [0.0, 1.0, 0.0, 0.0, 1.0, 0.0],
            [0.0, 0.0, 1.0, 0.0, 0.0, 1.0],
        ];
        let w = w.each_ref().map(|row| &row[..]);
        let squeezed = contacts(&w, &[-1.0, 0.0, 0.0, -1.0, 0.0, 0.0], 0.5);
        assert!(squeezed.is_contradicted_by(&[1.0, 0.0, 0.0, 1.0, 0.0, 0.0]));
        // Of one side alone, with friction, or of the wrong sign, it proves nothing.
        for y in
            [[1.0, 0.0, 0.0, 0.0, 0.0, 0.0], [1.0, 0.1, 0.0, 1.0, 0.0, 0.0], [-1.0, 0.0, 0.0, -1.0, 0.0, 0.0]]
        {
            assert!(!squeezed.is_contradicted_by(&y), "{y:?}");
        }
        // The ceiling leaves as fast as the floor comes.
        let free = contacts(&w, &[-1.0, 0.0, 0.0, 1.0, 0.0, 0.0], 0.5);
        assert!(!free.is_contradicted_by(&[1.0, 0.0, 0.0, 1.0, 0.0, 0.0]));
    }

    #[test]
    fn a_bounded_impulse_helps_as_far_as_it_goes() {
        let w = Matrix::from_entries(2, [(0, 1, 1.0), (1, 0, 1.0)]);
        let motor = |max| vec![Law::AT_LEAST_ZERO, Law::Bounds { min: 0.0, max }];
        // u_0 = r_1 - 2, of which r_1 can raise as much as it may.
        for (max, contradicted) in [(1.0, true), (3.0, false), (f64::INFINITY, false)] {
            let problem = Problem::new(motor(max), w.clone(), vec![-2.0, 0.0]).unwrap();
            assert_eq!(problem.is_contradicted_by(&[1.0, 0.0]), contradicted, "{max}");
        }
    }
}
