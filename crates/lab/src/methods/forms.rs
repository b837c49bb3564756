//! A problem in the forms that exact methods solve: with bounds on every row, or as a linear complementarity
//! problem.
//!
//! Friction is no bound, so it is approximated: in the boxed form by bounds `±mu N` with the normal impulses
//! `N` of the round before, in the other by a pyramid of four sides with a slack that is the speed of slip
//! (Stewart and Trinkle 1996). Both have two axes in each tangent plane; either is exact for a contact that
//! slides along an axis, which is why [`super::rounds`] turns them.

use super::linear::solve;
use super::tableau::Tableau;
use crate::problem::{Law, Problem, nearest_within};
use nalgebra::DMatrix;
use std::ops::Range;

/// Find `lo <= x <= hi` with `w = M x + q` zero between the bounds, `w >= 0` at `lo` and `w <= 0` at `hi`.
#[derive(Clone, Debug)]
pub(super) struct Boxed {
    pub(super) m: DMatrix<f64>,
    pub(super) q: Vec<f64>,
    pub(super) lo: Vec<f64>,
    pub(super) hi: Vec<f64>,
}

impl Boxed {
    pub(super) fn rows(&self) -> usize {
        self.q.len()
    }

    /// `M x + q`.
    pub(super) fn w(&self, x: &[f64]) -> Vec<f64> {
        times(&self.m, x, &self.q)
    }

    pub(super) fn is_free(&self, i: usize) -> bool {
        self.lo[i] == f64::NEG_INFINITY && self.hi[i] == f64::INFINITY
    }

    /// The bound that a row starts at: the finite one that is nearer to zero, or zero for a free row.
    pub(super) fn bound(&self, i: usize) -> f64 {
        nearest_within(0.0, self.lo[i], self.hi[i]).clamp(-f64::MAX, f64::MAX)
    }

    /// The factor from an impulse of a row to a velocity.
    pub(super) fn scale(&self, i: usize) -> f64 {
        let diagonal = self.m[(i, i)];
        if diagonal > 0.0 {
            return diagonal;
        }
        let most = self.m.row(i).iter().fold(0.0_f64, |most, x| most.max(x.abs()));
        if most > 0.0 { most } else { 1.0 }
    }

    /// The natural map's greatest entry, as a velocity.
    pub(super) fn error(&self, x: &[f64]) -> f64 {
        let w = self.w(x);
        let errors = (0..self.rows()).map(|i| {
            let s = self.scale(i);
            s * nearest_within(w[i] / s, x[i] - self.hi[i], x[i] - self.lo[i]).abs()
        });
        errors.fold(0.0, |most: f64, e| if e.is_nan() { f64::INFINITY } else { most.max(e) })
    }

    /// The values of all rows where those of `free` have `w = 0` and the others have the values given; none
    /// if singular.
    pub(super) fn with_free(&self, free: &[usize], x: &[f64]) -> Option<Vec<f64>> {
        let mut x = x.to_vec();
        free.iter().for_each(|&i| x[i] = 0.0);
        let right: Vec<f64> = self.w(&x).iter().map(|w| -w).collect();
        let right: Vec<f64> = free.iter().map(|&i| right[i]).collect();
        let found = solve(&submatrix(&self.m, free), &right)?;
        free.iter().zip(found).for_each(|(&i, value)| x[i] = value);
        Some(x)
    }

    /// x computed exactly for the sides that a point suggests; none if singular.
    pub(super) fn snapped(&self, x: &[f64]) -> Option<Vec<f64>> {
        let (w, mut at, mut free) = (self.w(x), x.to_vec(), Vec::new());
        for i in 0..x.len() {
            let to = x[i] - w[i] / self.scale(i);
            at[i] = nearest_within(to, self.lo[i], self.hi[i]);
            if to > self.lo[i] && to < self.hi[i] {
                free.push(i);
            }
        }
        let x = self.with_free(&free, &at)?;
        Some((0..x.len()).map(|i| nearest_within(x[i], self.lo[i], self.hi[i])).collect())
    }

    /// The problem of a proximal step: `eps` is added to the diagonal, and q adjusted so that `x` remains a
    /// solution if it is one.
    pub(super) fn proximal(&self, eps: f64, x: &[f64]) -> Boxed {
        let mut near = self.clone();
        for (i, x) in x.iter().enumerate() {
            let add = eps * self.scale(i);
            near.m[(i, i)] += add;
            near.q[i] -= add * x;
        }
        near
    }
}

/// `M x + q`, by columns.
pub(super) fn times(m: &DMatrix<f64>, x: &[f64], q: &[f64]) -> Vec<f64> {
    let mut w = q.to_vec();
    for (j, column) in m.column_iter().enumerate() {
        if x[j] != 0.0 {
            w.iter_mut().zip(column.iter()).for_each(|(w, m)| *w += m * x[j]);
        }
    }
    w
}

/// Rows and columns of a matrix.
pub(super) fn submatrix(m: &DMatrix<f64>, index: &[usize]) -> DMatrix<f64> {
    DMatrix::from_fn(index.len(), index.len(), |i, j| m[(index[i], index[j])])
}

/// Rows that share one bound of friction.
#[derive(Clone, Debug)]
pub(super) struct Group {
    /// The first of two tangent rows.
    pub(super) tangent: usize,
    /// The normals whose sum bounds it.
    pub(super) normals: Range<usize>,
    pub(super) mu: f64,
    /// A row of twist and its arm.
    pub(super) twist: Option<(usize, f64)>,
    /// The first axis of box or pyramid among the two tangents: a unit vector.
    pub(super) axis: [f64; 2],
}

impl Group {
    /// The sum of the normal impulses.
    pub(super) fn load(&self, r: &[f64]) -> f64 {
        r[self.normals.clone()].iter().map(|x| x.max(0.0)).sum()
    }
}

/// Where a problem has friction.
pub(super) fn groups(problem: &Problem) -> Vec<Group> {
    let axis = [1.0, 0.0];
    let group = |(row, law)| match law {
        Law::Bounds { .. } => None,
        Law::Contact { mu } => Some(Group { tangent: row + 1, normals: row..row + 1, mu, twist: None, axis }),
        Law::Patch { mu, arm, first, count } => {
            let twist = (arm > 0.0).then_some((row + 2, arm));
            Some(Group { tangent: row, normals: first..first + count, mu, twist, axis })
        }
    };
    problem.laws().filter_map(group).collect()
}

/// The bounds of each row; those of friction rows are zero.
fn bounds(problem: &Problem) -> (Vec<f64>, Vec<f64>) {
    let (mut lo, mut hi) = (vec![0.0; problem.rows()], vec![0.0; problem.rows()]);
    for (row, law) in problem.laws() {
        match law {
            Law::Bounds { min, max } => (lo[row], hi[row]) = (min, max),
            Law::Contact { .. } => hi[row] = f64::INFINITY,
            Law::Patch { .. } => {}
        }
    }
    (lo, hi)
}

/// The boxed form, with the bounds of friction that the normal impulses of `r` give. Tangents are along the
/// groups' axes.
pub(super) fn boxed(problem: &Problem, groups: &[Group], r: &[f64]) -> Boxed {
    let (mut m, mut q) = (problem.w().dense(), problem.q().to_vec());
    let (mut lo, mut hi) = bounds(problem);
    for group in groups {
        let (t, [c, s]) = (group.tangent, group.axis);
        for i in 0..q.len() {
            let (a, b) = (m[(i, t)], m[(i, t + 1)]);
            (m[(i, t)], m[(i, t + 1)]) = (c * a + s * b, c * b - s * a);
        }
        for j in 0..q.len() {
            let (a, b) = (m[(t, j)], m[(t + 1, j)]);
            (m[(t, j)], m[(t + 1, j)]) = (c * a + s * b, c * b - s * a);
        }
        (q[t], q[t + 1]) = (c * q[t] + s * q[t + 1], c * q[t + 1] - s * q[t]);
        let most = group.mu * group.load(r);
        for (row, most) in
            [(t, most), (t + 1, most)].into_iter().chain(group.twist.map(|(row, arm)| (row, arm * most)))
        {
            (lo[row], hi[row]) = (-most, most);
        }
    }
    Boxed { m, q, lo, hi }
}

/// Impulses along the axes of the groups.
pub(super) fn to_axes(groups: &[Group], r: &[f64]) -> Vec<f64> {
    let mut x = r.to_vec();
    for Group { tangent: t, axis: [c, s], .. } in groups {
        (x[*t], x[t + 1]) = (c * r[*t] + s * r[t + 1], c * r[t + 1] - s * r[*t]);
    }
    x
}

/// The way back from [`to_axes`].
pub(super) fn from_axes(groups: &[Group], x: &[f64]) -> Vec<f64> {
    let mut r = x.to_vec();
    for Group { tangent: t, axis: [c, s], .. } in groups {
        (r[*t], r[t + 1]) = (c * x[*t] - s * x[t + 1], s * x[*t] + c * x[t + 1]);
    }
    r
}

/// Find `z >= 0` with `w = M z + q >= 0` and `z w = 0`.
#[derive(Clone, Debug)]
pub(super) struct Lcp {
    pub(super) m: DMatrix<f64>,
    pub(super) q: Vec<f64>,
}

/// A linear complementarity problem that is equivalent to another problem, and the way back.
pub(super) struct Reduced {
    pub(super) lcp: Lcp,
    /// `x = at + sum of columns z`: entries (row, factor) of the columns.
    columns: Vec<Vec<(usize, f64)>>,
    at: Vec<f64>,
    extras: Vec<Extra>,
    /// Rows without bounds whose `w = 0` was solved for them.
    solved: Tableau,
}

/// How the complementary pairs of a [`Reduced`] depend on each other beside M.
enum Extra {
    /// The slack of a finite upper bound over a finite lower one: (pair, slack, width).
    Width(usize, usize, f64),
    /// The slack of a bound of friction: (pairs, slack, normals, factor).
    Slack(Vec<usize>, usize, Range<usize>, f64),
}

/// As a linear complementarity problem: rows without bounds are solved for (those that are redundant are
/// split into two signs), finite bounds on both sides become two pairs, and friction a pyramid with a slack
/// whose sides are along the axes of the groups.
pub(super) fn pyramid(problem: &Problem, groups: &[Group]) -> Reduced {
    let (lo, hi) = bounds(problem);
    let boxed = Boxed { m: problem.w().dense(), q: problem.q().to_vec(), lo, hi };
    reduce(&boxed, groups)
}

/// [`pyramid`] of a boxed form; the bounds of rows in `groups` are ignored.
pub(super) fn reduce(boxed: &Boxed, groups: &[Group]) -> Reduced {
    let n = boxed.rows();
    let mut solved = Tableau::new(&boxed.m, &boxed.q);
    let free: Vec<usize> = (0..n).filter(|&i| boxed.is_free(i)).collect();
    solved.pivot_all(&free);
    let mut is_friction = vec![false; n];
    let (mut columns, mut at, mut extras) = (Vec::new(), vec![0.0; n], Vec::new());
    for group in groups {
        let t = group.tangent;
        (is_friction[t], is_friction[t + 1]) = (true, true);
        let [c, s] = group.axis;
        let first = columns.len();
        columns.extend([vec![(t, c), (t + 1, s)], vec![(t, -c), (t + 1, -s)]]);
        columns.extend([vec![(t, -s), (t + 1, c)], vec![(t, s), (t + 1, -c)], Vec::new()]);
        extras.push(Extra::Slack((first..first + 4).collect(), first + 4, group.normals.clone(), group.mu));
        if let Some((row, arm)) = group.twist {
            is_friction[row] = true;
            columns.extend([vec![(row, 1.0)], vec![(row, -1.0)], Vec::new()]);
            let factor = group.mu * arm;
            extras.push(Extra::Slack(vec![first + 5, first + 6], first + 7, group.normals.clone(), factor));
        }
    }
    for i in (0..n).filter(|&i| !is_friction[i] && !solved.basic[i]) {
        let (lo, hi) = (boxed.lo[i], boxed.hi[i]);
        if lo == hi {
            at[i] = lo;
        } else if lo.is_finite() {
            at[i] = lo;
            columns.push(vec![(i, 1.0)]);
            if hi.is_finite() {
                extras.push(Extra::Width(columns.len() - 1, columns.len(), hi - lo));
                columns.push(Vec::new());
            }
        } else if hi.is_finite() {
            at[i] = hi;
            columns.push(vec![(i, -1.0)]);
        } else {
            columns.extend([vec![(i, 1.0)], vec![(i, -1.0)]]);
        }
    }
    let lcp = assemble(&solved, &columns, &at, &extras);
    Reduced { lcp, columns, at, extras, solved }
}

fn assemble(solved: &Tableau, columns: &[Vec<(usize, f64)>], at: &[f64], extras: &[Extra]) -> Lcp {
    let size = columns.len();
    let constant = solved.values(at);
    let mut q: Vec<f64> = columns.iter().map(|c| c.iter().map(|&(i, f)| f * constant[i]).sum()).collect();
    let mut m = DMatrix::zeros(size, size);
    for (b, right) in columns.iter().enumerate() {
        for (a, left) in columns.iter().enumerate() {
            let terms =
                left.iter().flat_map(|&(i, f)| right.iter().map(move |&(j, g)| f * g * solved.t[(i, j)]));
            m[(a, b)] = terms.sum();
        }
    }
    for extra in extras {
        match extra {
            Extra::Width(pair, slack, width) => {
                (m[(*pair, *slack)], m[(*slack, *pair)]) = (1.0, -1.0);
                q[*slack] = *width;
            }
            Extra::Slack(pairs, slack, normals, factor) => {
                for &pair in pairs {
                    (m[(pair, *slack)], m[(*slack, pair)]) = (1.0, -1.0);
                }
                for normal in normals.clone() {
                    // A normal that was eliminated depends on all others.
                    if solved.basic[normal] {
                        q[*slack] += factor * constant[normal];
                        for (b, right) in columns.iter().enumerate() {
                            m[(*slack, b)] +=
                                right.iter().map(|&(j, g)| factor * g * solved.t[(normal, j)]).sum::<f64>();
                        }
                        continue;
                    }
                    q[*slack] += factor * at[normal];
                    for (b, right) in columns.iter().enumerate() {
                        m[(*slack, b)] +=
                            right.iter().filter(|x| x.0 == normal).map(|x| factor * x.1).sum::<f64>();
                    }
                }
            }
        }
    }
    Lcp { m, q }
}

impl Reduced {
    /// The impulses of the problem.
    pub(super) fn back(&self, z: &[f64]) -> Vec<f64> {
        let mut x = self.at.clone();
        for (column, &z) in self.columns.iter().zip(z) {
            column.iter().for_each(|&(i, factor)| x[i] += factor * z);
        }
        let values = self.solved.values(&x);
        (0..x.len()).map(|i| if self.solved.basic[i] { values[i] } else { x[i] }).collect()
    }

    /// The variables for impulses `r`: where a method may start.
    pub(super) fn forth(&self, r: &[f64]) -> Vec<f64> {
        let along = |column: &Vec<(usize, f64)>| {
            column.iter().map(|&(i, factor)| factor * (r[i] - self.at[i])).sum::<f64>().max(0.0)
        };
        let mut z: Vec<f64> = self.columns.iter().map(along).collect();
        let w = times(&self.lcp.m, &z, &self.lcp.q);
        for extra in &self.extras {
            match extra {
                Extra::Width(pair, slack, _) => z[*slack] = (-w[*pair]).max(0.0),
                Extra::Slack(pairs, slack, ..) => {
                    z[*slack] = pairs.iter().fold(0.0, |most: f64, &pair| most.max(-w[pair]));
                }
            }
        }
        z
    }
}
