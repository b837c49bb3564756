//! Principal pivots: `w = M x + q` with some pairs exchanged.

use crate::methods::linear::greatest;
use nalgebra::{DMatrix, DVector};

/// A pivot counts as zero below this share of the greatest entry of its column.
pub(super) const SMALL: f64 = 1e-11;

/// A principal pivot transform: for each pair (x_i, w_i) one is basic and depends on all that are not,
/// `basic = T nonbasic + b`.
#[derive(Clone, Debug)]
pub(super) struct Tableau {
    pub(super) t: DMatrix<f64>,
    pub(super) b: DVector<f64>,
    /// Whether x_i is the basic one.
    pub(super) basic: Vec<bool>,
    /// The greatest entry of M, of 1 where M is zero.
    pub(super) size: f64,
}

impl Tableau {
    /// All w basic.
    pub(super) fn new(m: &DMatrix<f64>, q: &[f64]) -> Tableau {
        let size = greatest(m.as_slice());
        Tableau {
            t: m.clone(),
            b: DVector::from_column_slice(q),
            basic: vec![false; q.len()],
            size: if size > 0.0 { size } else { 1.0 },
        }
    }

    /// The basic variable of each pair for values of the others.
    pub(super) fn values(&self, nonbasic: &[f64]) -> Vec<f64> {
        let mut values = self.b.as_slice().to_vec();
        for (j, column) in self.t.column_iter().enumerate() {
            let x = if self.basic[j] { 0.0 } else { nonbasic[j] };
            if x != 0.0 {
                values.iter_mut().zip(column.iter()).for_each(|(value, t)| *value += t * x);
            }
        }
        values
    }

    /// Whether the diagonal entry of a pair can be pivoted on.
    pub(super) fn can_pivot(&self, k: usize) -> bool {
        let column = greatest(self.t.column(k).as_slice());
        let pivot = self.t[(k, k)].abs();
        pivot > SMALL * column && (self.basic[k] || pivot > SMALL * SMALL * self.size)
    }

    /// Exchanges a pair on its diagonal entry, which must not be zero.
    pub(super) fn pivot(&mut self, k: usize) {
        let n = self.b.len();
        let p = 1.0 / self.t[(k, k)];
        let column: Vec<f64> = self.t.column(k).iter().copied().collect();
        for j in 0..n {
            if j == k {
                continue;
            }
            let f = -self.t[(k, j)] * p;
            if f != 0.0 {
                self.t.column_mut(j).iter_mut().zip(&column).for_each(|(t, c)| *t += f * c);
            }
            self.t[(k, j)] = f;
        }
        let f = -self.b[k] * p;
        self.b.iter_mut().zip(&column).for_each(|(b, c)| *b += f * c);
        self.b[k] = f;
        self.t.column_mut(k).iter_mut().for_each(|t| *t *= p);
        self.t[(k, k)] = p;
        self.basic[k] = !self.basic[k];
    }

    /// Exchanges two pairs at once, on the 2x2 block of both; false if that is singular.
    pub(super) fn pivot_two(&mut self, r: usize, s: usize) -> bool {
        let (a, b, c, d) = (self.t[(r, r)], self.t[(r, s)], self.t[(s, r)], self.t[(s, s)]);
        let det = a * d - b * c;
        if det.abs() <= SMALL * SMALL * (a * d).abs().max((b * c).abs()).max(f64::MIN_POSITIVE) || det == 0.0
        {
            return false;
        }
        let inverse = [d / det, -b / det, -c / det, a / det];
        let n = self.b.len();
        let first: Vec<f64> = self.t.column(r).iter().copied().collect();
        let second: Vec<f64> = self.t.column(s).iter().copied().collect();
        let solve = |x: f64, y: f64| (-(inverse[0] * x + inverse[1] * y), -(inverse[2] * x + inverse[3] * y));
        for j in (0..n).filter(|&j| j != r && j != s) {
            let (f, g) = solve(self.t[(r, j)], self.t[(s, j)]);
            let mut column = self.t.column_mut(j);
            for i in 0..n {
                column[i] += f * first[i] + g * second[i];
            }
            (column[r], column[s]) = (f, g);
        }
        let (f, g) = solve(self.b[r], self.b[s]);
        for i in 0..n {
            self.b[i] += f * first[i] + g * second[i];
            self.t[(i, r)] = first[i] * inverse[0] + second[i] * inverse[2];
            self.t[(i, s)] = first[i] * inverse[1] + second[i] * inverse[3];
        }
        (self.b[r], self.b[s]) = (f, g);
        (self.t[(r, r)], self.t[(r, s)], self.t[(s, r)], self.t[(s, s)]) =
            (inverse[0], inverse[1], inverse[2], inverse[3]);
        self.basic[r] = !self.basic[r];
        self.basic[s] = !self.basic[s];
        true
    }

    /// Makes the x of these pairs basic, greatest pivot first, as long as there is a pivot; redundant ones
    /// stay nonbasic.
    pub(super) fn pivot_all(&mut self, pairs: &[usize]) {
        let mut left: Vec<usize> = pairs.iter().copied().filter(|&k| !self.basic[k]).collect();
        let first = self.size;
        while !left.is_empty() {
            let (mut at, mut most) = (0, 0.0);
            for (place, &k) in left.iter().enumerate() {
                if self.t[(k, k)].abs() > most {
                    (at, most) = (place, self.t[(k, k)].abs());
                }
            }
            if most > SMALL * first && self.can_pivot(left[at]) {
                self.pivot(left.swap_remove(at));
                continue;
            }
            // No diagonal pivot is left: exchange two pairs at once, as an indefinite matrix needs.
            let pairs = (0..left.len()).flat_map(|a| (0..a).map(move |b| (a, b)));
            let found = pairs.filter(|&(a, b)| {
                let (r, s) = (left[a], left[b]);
                self.t[(r, s)].abs().min(self.t[(s, r)].abs()) > SMALL.sqrt() * first
            });
            let Some((a, b)) = found.take(1).next() else { return };
            if !self.pivot_two(left[a], left[b]) {
                return;
            }
            left.swap_remove(a);
            left.swap_remove(b);
        }
    }
}
