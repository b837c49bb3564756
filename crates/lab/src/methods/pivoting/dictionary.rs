//! Complementary pivoting along a path: common parts of Lemke's method and the path search.
//!
//! The system is `w = M z + q + d t` with a covering vector `d`; all points of the path have `z, w >= 0` and
//! `z w = 0`. The path parameter `t` is lowered until it is zero, which is a solution.

use crate::methods::forms::Lcp;
use crate::methods::linear::solve;
use crate::methods::tableau::Tableau;
use crate::methods::{forms, linear};
use crate::problem::power_of_two;
use nalgebra::DMatrix;

/// A pivot counts as zero below this share of the greatest entry of its column.
const SMALL: f64 = 1e-10;
/// Pivots between two checks of rounding errors.
const CHECK: u32 = 50;
/// Residual of the equations, relative to q and d, above which the dictionary is computed anew.
const DRIFT: f64 = 1e-12;
/// Ratios closer than this, relative to the right-hand sides, are a tie.
const TIE: f64 = 1e-12;

/// How a path ended.
#[derive(Clone, Debug, PartialEq)]
pub(super) enum End {
    /// At a solution.
    Solved,
    /// Nothing blocks: a ray, of which this is the part of z.
    Ray(Vec<f64>),
    /// Pivots ran out, or the basis became singular.
    Limit,
}

/// A basis of the system: basic variables as functions of the nonbasic ones.
///
/// Variables are numbered: `i < n` is w_i, `n + i` is z_i, `2 n` is t. Invariant: each of them is in exactly
/// one of `rows` (basic) and `columns` (zero).
pub(super) struct Dictionary<'a> {
    lcp: &'a Lcp,
    cover: Vec<f64>,
    /// Change of each basic variable per unit of each nonbasic one, which are the columns. The last column is
    /// the constant.
    t: DMatrix<f64>,
    rows: Vec<usize>,
    columns: Vec<usize>,
    /// The place of each variable in `rows` or `columns`.
    place: Vec<usize>,
    /// The variables that were basic first: a perturbation of them makes ties differ.
    origin: Vec<usize>,
    pub(super) pivots: u32,
}

impl<'a> Dictionary<'a> {
    /// A basis with the z of `active`, as far as their matrix is regular, and a cover that raises all
    /// negative basic variables equally. `t` is the least value that makes all of them positive.
    pub(super) fn covered(lcp: &'a Lcp, active: &[usize], weights: &[f64]) -> Dictionary<'a> {
        let n = lcp.q.len();
        let mut start = Tableau::new(&lcp.m, &lcp.q);
        start.pivot_all(active);
        let cold = !start.basic.contains(&true);
        let lift: Vec<f64> =
            (0..n).map(|i| if cold || start.b[i] < 0.0 { weights[i] } else { 0.0 }).collect();
        // In terms of w: the basic z_j raised by lift_j change w by -M_j lift_j.
        let mut cover = vec![0.0; n];
        for j in 0..n {
            if !start.basic[j] {
                cover[j] += lift[j];
            } else {
                (0..n).for_each(|i| cover[i] -= lcp.m[(i, j)] * lift[j]);
            }
        }
        Dictionary::assemble(lcp, start, &lift, cover)
    }

    /// A basis with the z of `active`, and the cover for which `t = 1` is the point `z`, `w` (zero where its
    /// pair is basic). None unless all of them can be basic.
    pub(super) fn through(lcp: &'a Lcp, active: &[usize], z: &[f64], w: &[f64]) -> Option<Dictionary<'a>> {
        let mut start = Tableau::new(&lcp.m, &lcp.q);
        start.pivot_all(active);
        if active.iter().any(|&i| !start.basic[i]) {
            return None;
        }
        let values: Vec<f64> = (0..z.len()).map(|i| if start.basic[i] { z[i] } else { w[i] }).collect();
        let lift: Vec<f64> = values.iter().zip(start.b.iter()).map(|(value, b)| value - b).collect();
        let cover = (0..z.len()).map(|i| {
            let moved: f64 = (0..z.len()).map(|j| lcp.m[(i, j)] * z[j]).sum();
            w[i] - moved - lcp.q[i]
        });
        let cover = cover.collect();
        Some(Dictionary::assemble(lcp, start, &lift, cover))
    }

    fn assemble(lcp: &'a Lcp, start: Tableau, lift: &[f64], cover: Vec<f64>) -> Dictionary<'a> {
        let n = lcp.q.len();
        let mut t = DMatrix::zeros(n, n + 2);
        t.view_mut((0, 0), (n, n)).copy_from(&start.t);
        (0..n).for_each(|i| (t[(i, n)], t[(i, n + 1)]) = (lift[i], start.b[i]));
        let rows: Vec<usize> = (0..n).map(|i| if start.basic[i] { n + i } else { i }).collect();
        let mut columns: Vec<usize> = (0..n).map(|i| if start.basic[i] { i } else { n + i }).collect();
        columns.push(2 * n);
        let mut place: Vec<usize> = (0..n).chain(0..n).collect();
        place.push(n);
        Dictionary { place, lcp, cover, t, origin: rows.clone(), rows, columns, pivots: 0 }
    }

    fn n(&self) -> usize {
        self.rows.len()
    }

    /// Lowers `t` from infinity, or from one, until the first basic variable is zero, and goes on by
    /// complementary pivots.
    pub(super) fn descend(&mut self, limit: u32) -> End {
        let n = self.n();
        if (0..n).all(|i| self.t[(i, n + 1)] >= 0.0) {
            return End::Solved;
        }
        let mut out = None;
        for i in (0..n).filter(|&i| self.t[(i, n)] > 0.0) {
            let t = -self.t[(i, n + 1)] / self.t[(i, n)];
            if out.is_none_or(|(_, most)| t > most) {
                out = Some((i, t));
            }
        }
        let Some((first, most)) = out else { return End::Limit };
        if most <= 0.0 {
            return End::Solved;
        }
        let ratio = |i: usize| -self.t[(i, n + 1)] / self.t[(i, n)];
        let tied = (0..n).filter(|&i| self.t[(i, n)] > 0.0);
        let tied = tied.filter(|&i| i == first || (ratio(i) - most).abs() <= TIE * most.abs()).collect();
        let out = self.least(tied, n, 1.0);
        let left = self.rows[out];
        self.exchange(out, n);
        self.follow(self.complement(left), limit)
    }

    fn complement(&self, variable: usize) -> usize {
        let n = self.n();
        if variable < n { variable + n } else { variable - n }
    }

    /// Complementary pivots, beginning with `enters`, until `t` leaves the basis.
    fn follow(&mut self, mut enters: usize, limit: u32) -> End {
        let n = self.n();
        for count in 1..=limit {
            if count % CHECK == 0 && self.drifted() && !self.refactor() {
                return End::Limit;
            }
            let column = self.place[enters];
            let mut row = self.blocking(column);
            if row.is_none() && self.refactor() {
                // Without the rounding errors of the pivots.
                row = self.blocking(column);
            }
            let Some(row) = row else { return End::Ray(self.ray(enters, column)) };
            let left = self.rows[row];
            self.exchange(row, column);
            self.pivots += 1;
            if left == 2 * n {
                return End::Solved;
            }
            enters = self.complement(left);
        }
        End::Limit
    }

    /// The row that reaches zero first as a variable rises: least ratio. Among ties it is that of t, else the
    /// lexicographically least.
    fn blocking(&self, column: usize) -> Option<usize> {
        let n = self.n();
        let values = self.t.column(column);
        let most = values.iter().fold(0.0_f64, |most, x| most.max(x.abs()));
        let small = SMALL * most;
        let ratio = |i: usize| self.t[(i, n + 1)].max(0.0) / -values[i];
        let candidates = (0..n).filter(|&i| values[i] < -small);
        let least = candidates.clone().map(ratio).fold(f64::INFINITY, f64::min);
        if least == f64::INFINITY {
            return None;
        }
        let size = self.t.column(n + 1).iter().fold(0.0_f64, |most, x| most.max(x.abs()));
        let tied: Vec<usize> =
            candidates.filter(|&i| ratio(i) - least <= TIE * (least + size / -values[i])).collect();
        tied.iter().copied().find(|&i| self.rows[i] == 2 * n).or_else(|| Some(self.least(tied, column, -1.0)))
    }

    /// The row among some whose perturbation, divided by its entry of a column, is lexicographically least.
    ///
    /// An entry of the inverse basis is exact to a share of the greatest entry of its column, and not of its
    /// own size: 1e-17 beside ones is zero, and would tell rows apart that are tied.
    fn least(&self, mut tied: Vec<usize>, column: usize, sign: f64) -> usize {
        for &variable in &self.origin {
            if tied.len() == 1 {
                break;
            }
            let place = self.place[variable];
            let nonbasic = self.columns[place] == variable;
            let rounding =
                if nonbasic { TIE * linear::greatest(self.t.column(place).as_slice()) } else { 0.0 };
            let part = |row: usize| {
                let p = sign * self.t[(row, column)];
                let entry =
                    if nonbasic { -self.t[(row, place)] } else { f64::from(self.rows[row] == variable) };
                (entry / p, rounding / p)
            };
            let first = tied.iter().map(|&row| part(row)).min_by(|a, b| a.0.total_cmp(&b.0));
            let Some((least, noise)) = first else { break };
            tied.retain(|&row| {
                let (value, own) = part(row);
                value - least <= noise + own
            });
        }
        tied[0]
    }

    /// Makes the variable of a column basic in place of that of a row.
    fn exchange(&mut self, row: usize, column: usize) {
        let n = self.n();
        let p = 1.0 / self.t[(row, column)];
        let old: Vec<f64> = self.t.column(column).iter().copied().collect();
        for c in 0..n + 2 {
            if c == column {
                continue;
            }
            let f = -self.t[(row, c)] * p;
            if f != 0.0 {
                self.t.column_mut(c).iter_mut().zip(&old).for_each(|(t, o)| *t += f * o);
            }
            self.t[(row, c)] = f;
        }
        self.t.column_mut(column).iter_mut().for_each(|t| *t *= p);
        self.t[(row, column)] = p;
        std::mem::swap(&mut self.rows[row], &mut self.columns[column]);
        self.place[self.rows[row]] = row;
        self.place[self.columns[column]] = column;
    }

    /// The column of a variable in `w - M z - d t = q`.
    fn original(&self, variable: usize, i: usize) -> f64 {
        let n = self.n();
        match variable {
            v if v < n => f64::from(v == i),
            v if v < 2 * n => -self.lcp.m[(i, v - n)],
            _ => -self.cover[i],
        }
    }

    /// Whether the values of the basic variables no longer solve the equations.
    fn drifted(&self) -> bool {
        let n = self.n();
        let mut rest = self.lcp.q.clone();
        let mut size: Vec<f64> = rest.iter().map(|q| q.abs()).collect();
        for (row, &variable) in self.rows.iter().enumerate() {
            let value = self.t[(row, n + 1)];
            for i in 0..n {
                let part = self.original(variable, i) * value;
                rest[i] -= part;
                size[i] += part.abs();
            }
        }
        let size = linear::greatest(&size);
        linear::greatest(&rest) > DRIFT * size
    }

    /// The dictionary of the same basis computed anew. False if it is singular.
    fn refactor(&mut self) -> bool {
        let n = self.n();
        let basis = DMatrix::from_fn(n, n, |i, j| self.original(self.rows[j], i));
        let mut right = DMatrix::from_fn(n, n + 2, |i, j| {
            if j == n + 1 { self.lcp.q[i] } else { -self.original(self.columns[j], i) }
        });
        if !basis.lu().solve_mut(&mut right) || right.iter().any(|x| !x.is_finite()) {
            return false;
        }
        self.t = right;
        true
    }

    /// The change of z along a ray.
    fn ray(&self, enters: usize, column: usize) -> Vec<f64> {
        let n = self.n();
        let mut z = vec![0.0; n];
        if (n..2 * n).contains(&enters) {
            z[enters - n] = 1.0;
        }
        for (row, &variable) in self.rows.iter().enumerate() {
            if (n..2 * n).contains(&variable) {
                z[variable - n] = self.t[(row, column)].max(0.0);
            }
        }
        z
    }

    /// z of the basis, computed anew from the matrix without `t`, if possible.
    pub(super) fn z(&self) -> Vec<f64> {
        let n = self.n();
        let mut z = vec![0.0; n];
        for (row, &variable) in self.rows.iter().enumerate() {
            if (n..2 * n).contains(&variable) {
                z[variable - n] = self.t[(row, n + 1)].max(0.0);
            }
        }
        let active: Vec<usize> =
            self.rows.iter().filter(|v| (n..2 * n).contains(*v)).map(|v| v - n).collect();
        let m = forms::submatrix(&self.lcp.m, &active);
        let right: Vec<f64> = active.iter().map(|&i| -self.lcp.q[i]).collect();
        if let Some(exact) = solve(&m, &right) {
            let mut refined = vec![0.0; n];
            active.iter().zip(exact).for_each(|(&i, x)| refined[i] = x.max(0.0));
            if self.lcp.error(&refined) <= self.lcp.error(&z) {
                return refined;
            }
        }
        z
    }
}

impl Lcp {
    /// The greatest violation of any condition: `|min(z, w)|`.
    pub(super) fn error(&self, z: &[f64]) -> f64 {
        let w = forms::times(&self.m, z, &self.q);
        z.iter().zip(&w).fold(0.0, |most: f64, (z, w)| {
            let e = z.min(*w).abs();
            if z.is_nan() || w.is_nan() { f64::INFINITY } else { most.max(e) }
        })
    }

    /// The problem with rows and columns multiplied by powers of two such that their greatest entries are
    /// near one, and the factors of rows and columns. Complementary pairs stay the same.
    pub(super) fn equilibrated(&self) -> (Lcp, Vec<f64>, Vec<f64>) {
        let n = self.q.len();
        let (mut m, mut q) = (self.m.clone(), self.q.clone());
        let (mut rows, mut factors) = (vec![1.0; n], vec![1.0; n]);
        for _ in 0..3 {
            for (i, q) in q.iter_mut().enumerate() {
                let by = half_power(m.row(i).iter().copied());
                m.row_mut(i).iter_mut().for_each(|x| *x *= by);
                *q *= by;
                rows[i] *= by;
            }
            for (mut column, factor) in m.column_iter_mut().zip(&mut factors) {
                let by = half_power(column.iter().copied());
                column.iter_mut().for_each(|x| *x *= by);
                *factor *= by;
            }
        }
        // One number for all of q and z.
        let by = 1.0 / power_of_two(q.iter().copied());
        q.iter_mut().for_each(|x| *x *= by);
        factors.iter_mut().for_each(|x| *x /= by);
        (Lcp { m, q }, rows, factors)
    }
}

/// A power of two near one over the root of the greatest absolute value.
fn half_power(values: impl Iterator<Item = f64>) -> f64 {
    let most = power_of_two(values);
    1.0 / power_of_two(std::iter::once(most.sqrt()))
}
