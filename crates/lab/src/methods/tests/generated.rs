//! Problems made at random, of which it is known by construction whether they have a solution.

use crate::problem::{Law, Matrix, Problem};
use crate::random::Random;
use nalgebra::{DMatrix, DVector};

/// What is known of a problem.
#[derive(Clone, Debug, PartialEq)]
pub(super) enum Known {
    /// It has these impulses as its one solution.
    One(Vec<f64>),
    /// It has a solution.
    Some,
    /// It has none.
    None,
    /// Nothing.
    Nothing,
}

/// A kind of problems.
pub(super) struct Kind {
    pub(super) name: &'static str,
    pub(super) make: fn(&mut Random) -> (Problem, Known),
}

pub(super) const KINDS: &[Kind] = &[
    Kind { name: "P-matrix", make: positive },
    Kind { name: "semidefinite", make: semidefinite },
    Kind { name: "copositive", make: copositive },
    Kind { name: "degenerate", make: degenerate },
    Kind { name: "badly scaled", make: badly_scaled },
    Kind { name: "indefinite", make: indefinite },
    Kind { name: "contradictory", make: contradictory },
    Kind { name: "all but contradictory", make: all_but_contradictory },
    Kind { name: "bounds", make: bounds },
    Kind { name: "pile", make: pile },
    Kind { name: "pile, known", make: known_pile },
    Kind { name: "pile, jointed", make: jointed_pile },
    Kind { name: "rolling", make: rolling },
    Kind { name: "squeezed", make: squeezed },
    Kind { name: "locked apart", make: locked_apart },
];

fn number(random: &mut Random) -> f64 {
    random.range64(-1.0, 1.0)
}

fn matrix(random: &mut Random, rows: usize, columns: usize) -> DMatrix<f64> {
    DMatrix::from_fn(rows, columns, |_, _| number(random))
}

fn whole(random: &mut Random, rows: usize, columns: usize) -> DMatrix<f64> {
    DMatrix::from_fn(rows, columns, |_, _| random.below(7) as f64 - 3.0)
}

fn size(random: &mut Random) -> usize {
    2 + random.below(14)
}

/// A matrix plus one that is skew.
fn skewed(random: &mut Random, m: DMatrix<f64>) -> DMatrix<f64> {
    let s = matrix(random, m.nrows(), m.nrows());
    m + &s - s.transpose()
}

/// `M z + q = w` with complementary z and w, of which as many are zero both as `degenerate` says.
fn with_solution(random: &mut Random, m: &DMatrix<f64>, degenerate: f32) -> (Vec<f64>, Vec<f64>) {
    let n = m.nrows();
    let (mut z, mut w) = (DVector::zeros(n), DVector::zeros(n));
    for i in 0..n {
        let value = 1.0 + random.below(4) as f64;
        match random.unit() {
            x if x < degenerate => {}
            x if x < 0.5 + 0.5 * degenerate => z[i] = value,
            _ => w[i] = value,
        }
    }
    let q = w - m * &z;
    (q.as_slice().to_vec(), z.as_slice().to_vec())
}

fn lcp(m: &DMatrix<f64>, q: Vec<f64>) -> Problem {
    Problem::lcp(Matrix::from_dense(m), q).unwrap()
}

fn positive(random: &mut Random) -> (Problem, Known) {
    let n = size(random);
    let b = matrix(random, n, n);
    let m = &b * b.transpose() + DMatrix::identity(n, n);
    let m = if random.chance(0.5) { skewed(random, m) } else { m };
    let (q, z) = with_solution(random, &m, 0.0);
    (lcp(&m, q), Known::One(z))
}

fn semidefinite(random: &mut Random) -> (Problem, Known) {
    let n = size(random);
    let b = matrix(random, n, n.div_ceil(2));
    let m = &b * b.transpose();
    let m = if random.chance(0.5) { skewed(random, m) } else { m };
    let (q, _) = with_solution(random, &m, 0.0);
    (lcp(&m, q), Known::Some)
}

/// Strictly copositive, as all entries of the part that is not semidefinite are at least zero: each q has a
/// solution.
fn copositive(random: &mut Random) -> (Problem, Known) {
    let n = size(random);
    let b = matrix(random, n, 2);
    let more = DMatrix::from_fn(n, n, |i, j| if i == j { 1.0 } else { random.range64(0.0, 10.0) });
    let q = (0..n).map(|_| number(random)).collect();
    (lcp(&(&b * b.transpose() + more), q), Known::Some)
}

/// Whole numbers, with many ratios that are equal and rows that occur twice.
fn degenerate(random: &mut Random) -> (Problem, Known) {
    let n = size(random);
    let mut b = whole(random, n, n.div_ceil(3));
    for i in 1..n {
        if random.chance(0.3) {
            let row = b.row(random.below(i)).into_owned();
            b.set_row(i, &row);
        }
    }
    let mut m = &b * b.transpose();
    if random.chance(0.5) {
        m += DMatrix::identity(n, n) + DMatrix::from_element(n, n, 1.0);
    }
    let (q, _) = with_solution(random, &m, 0.5);
    (lcp(&m, q), Known::Some)
}

fn badly_scaled(random: &mut Random) -> (Problem, Known) {
    let n = size(random);
    let b = matrix(random, n, n);
    let mut m = &b * b.transpose() + DMatrix::identity(n, n);
    let by: Vec<f64> = (0..n).map(|_| 10.0_f64.powi(random.below(5) as i32 - 2)).collect();
    (0..n * n).for_each(|k| m[(k / n, k % n)] *= by[k / n] * by[k % n]);
    let all = 10.0_f64.powi(random.below(17) as i32 - 8);
    m *= all;
    let (q, _) = with_solution(random, &m, 0.1);
    (lcp(&m, q), Known::Some)
}

fn indefinite(random: &mut Random) -> (Problem, Known) {
    let n = 2 + random.below(6);
    let m = if random.chance(0.5) { whole(random, n, n) } else { matrix(random, n, n) };
    (lcp(&m, (0..n).map(|_| number(random)).collect()), Known::Nothing)
}

/// `y M = 0` and `y q < 0` with `y >= 0`, in whole numbers.
fn contradictory(random: &mut Random) -> (Problem, Known) {
    let n = size(random);
    let mut b = whole(random, n, n.div_ceil(2));
    let y: Vec<f64> = (0..n).map(|i| if i == 0 { 1.0 } else { random.below(3) as f64 }).collect();
    for column in 0..b.ncols() {
        b[(0, column)] = -(1..n).map(|i| y[i] * b[(i, column)]).sum::<f64>();
    }
    let mut q: Vec<f64> = (0..n).map(|_| random.below(9) as f64 - 4.0).collect();
    q[0] -= 1.0 + (0..n).map(|i| y[i] * q[i]).sum::<f64>();
    (lcp(&(&b * b.transpose()), q), Known::None)
}

/// The same with so little added to the diagonal that the solution, which there is then, is far away.
fn all_but_contradictory(random: &mut Random) -> (Problem, Known) {
    let (problem, _) = if random.chance(0.5) { contradictory(random) } else { squeezed(random) };
    let add = 10.0_f64.powi(-3 - random.below(9) as i32) * problem.scale(0);
    let w = problem.w().dense() + add * DMatrix::identity(problem.rows(), problem.rows());
    let laws = problem.laws().map(|(_, law)| law).collect();
    (Problem::new(laws, Matrix::from_dense(&w), problem.q().to_vec()).unwrap(), Known::Some)
}

/// Rows with bounds of all kinds.
fn bounds(random: &mut Random) -> (Problem, Known) {
    let n = size(random);
    let b = matrix(random, n, n);
    let m = &b * b.transpose() + 0.1 * DMatrix::identity(n, n);
    let (mut laws, mut r, mut u) = (Vec::new(), DVector::zeros(n), DVector::zeros(n));
    for i in 0..n {
        let (min, max) = [
            (0.0, f64::INFINITY),
            (f64::NEG_INFINITY, 1.0),
            (-1.0, 2.0),
            (f64::NEG_INFINITY, f64::INFINITY),
            (0.5, 0.5),
        ][random.below(5)];
        laws.push(Law::Bounds { min, max });
        let (low, high) = (min.max(-3.0), max.min(3.0));
        match random.below(3) {
            0 if min.is_finite() => (r[i], u[i]) = (min, random.range64(0.0, 1.0)),
            1 if max.is_finite() => (r[i], u[i]) = (max, random.range64(-1.0, 0.0)),
            _ => r[i] = random.range64(low, high),
        }
    }
    let q = u - &m * &r;
    (
        Problem::new(laws, Matrix::from_dense(&m), q.as_slice().to_vec()).unwrap(),
        Known::One(r.as_slice().to_vec()),
    )
}

/// Rows of contacts at random between some bodies and the ground, normal first, over the velocities of the
/// bodies scaled by the roots of their masses.
fn contact_rows(random: &mut Random, bodies: usize, contacts: usize) -> DMatrix<f64> {
    let mut rows = DMatrix::zeros(3 * contacts, 6 * bodies);
    let weights: Vec<f64> = (0..bodies).map(|_| random.range64(0.3, 2.0)).collect();
    for contact in 0..contacts {
        let axes = matrix(random, 3, 3).qr().q();
        let (a, b) = (random.below(bodies), random.below(bodies + 1));
        for (body, sign) in [(a, 1.0), (b, -1.0)] {
            if body == bodies || a == b {
                continue;
            }
            let arm = [number(random), number(random), number(random)];
            for row in 0..3 {
                let d = [0, 1, 2].map(|k| axes[(k, row)]);
                let turn = [
                    arm[1] * d[2] - arm[2] * d[1],
                    arm[2] * d[0] - arm[0] * d[2],
                    arm[0] * d[1] - arm[1] * d[0],
                ];
                for k in 0..3 {
                    rows[(3 * contact + row, 6 * body + k)] = sign * weights[body] * d[k];
                    rows[(3 * contact + row, 6 * body + 3 + k)] = 2.0 * sign * weights[body] * turn[k];
                }
            }
        }
    }
    rows
}

fn friction(random: &mut Random) -> f64 {
    random.of(&[0.0, 0.3, 0.7, 1.0])
}

/// Contacts of bodies that move anyhow: that all of them come to rest is possible, so there is a solution.
fn pile(random: &mut Random) -> (Problem, Known) {
    let (bodies, contacts) = (1 + random.below(3), 1 + random.below(6));
    let rows = contact_rows(random, bodies, contacts);
    let v = DVector::from_fn(6 * bodies, |_, _| number(random));
    let laws = (0..contacts).map(|_| Law::Contact { mu: friction(random) }).collect();
    (of_rows(&rows, v, laws), Known::Some)
}

fn of_rows(rows: &DMatrix<f64>, v: DVector<f64>, laws: Vec<Law>) -> Problem {
    let w = Matrix::from_dense(&(rows * rows.transpose()));
    Problem::new(laws, w, (rows * v).as_slice().to_vec()).unwrap()
}

/// The same with impulses and velocities that obey the law.
fn known_pile(random: &mut Random) -> (Problem, Known) {
    let contacts = 1 + random.below(6);
    let bodies = 1 + random.below(3);
    let rows = contact_rows(random, bodies, contacts);
    let w = &rows * rows.transpose();
    let (mut laws, mut r, mut u) = (Vec::new(), DVector::zeros(3 * contacts), DVector::zeros(3 * contacts));
    for contact in 0..contacts {
        let (mu, first) = (friction(random), 3 * contact);
        laws.push(Law::Contact { mu });
        let angle = random.range64(0.0, std::f64::consts::TAU);
        let (x, y) = (angle.cos(), angle.sin());
        let (load, slip) = (random.range64(0.1, 2.0), random.range64(0.1, 2.0));
        let share = match random.below(3) {
            // It leaves.
            0 => {
                (u[first], u[first + 1], u[first + 2]) = (slip, x, y);
                continue;
            }
            // It slides.
            1 => {
                (u[first + 1], u[first + 2]) = (-slip * x, -slip * y);
                1.0
            }
            _ if mu == 0.0 => 0.0,
            _ => 0.5,
        };
        (r[first], r[first + 1], r[first + 2]) = (load, share * mu * load * x, share * mu * load * y);
    }
    let q = u - &w * &r;
    (Problem::new(laws, Matrix::from_dense(&w), q.as_slice().to_vec()).unwrap(), Known::Some)
}

fn jointed_pile(random: &mut Random) -> (Problem, Known) {
    let (bodies, contacts) = (2 + random.below(2), 1 + random.below(4));
    let rows = contact_rows(random, bodies, contacts + 1);
    let v = DVector::from_fn(6 * bodies, |_, _| number(random));
    let mut laws = vec![Law::Contact { mu: 0.5 }; contacts];
    laws.extend([Law::LOCKED; 3]);
    (of_rows(&rows, v, laws), Known::Some)
}

/// As files with rolling friction are read: a normal with two patches.
fn rolling(random: &mut Random) -> (Problem, Known) {
    let contacts = 1 + random.below(3);
    let rows = contact_rows(random, 2, 2 * contacts);
    let own = |row: usize| row / 5 * 6 + [0, 1, 2, 4, 5][row % 5];
    let rows = DMatrix::from_fn(5 * contacts, 12, |i, j| rows[(own(i), j)]);
    let q = &rows * DVector::from_fn(12, |_, _| number(random));
    let w = Matrix::from_dense(&(&rows * rows.transpose()));
    let mu: Vec<f64> = (0..contacts).map(|_| friction(random)).collect();
    let mu_r: Vec<f64> = (0..contacts).map(|_| 0.1 * friction(random)).collect();
    let file = crate::problem::File::of_rolling_contacts(w, q.as_slice().to_vec(), &mu, &mu_r).unwrap();
    (file.problem, Known::Some)
}

/// A row of balls between two walls that approach each other, each with three contact rows, in whole numbers.
fn squeezed(random: &mut Random) -> (Problem, Known) {
    let contacts = 2 + random.below(5);
    let mut rows = DMatrix::zeros(3 * contacts, 3 * (contacts - 1));
    for contact in 0..contacts {
        for axis in 0..3 {
            let row = 3 * contact + axis;
            if contact + 1 < contacts {
                rows[(row, 3 * contact + axis)] = 1.0;
            }
            if contact > 0 {
                rows[(row, 3 * (contact - 1) + axis)] = -1.0;
            }
        }
    }
    let mut q: Vec<f64> = (0..3 * contacts).map(|_| random.below(5) as f64 - 2.0).collect();
    q[0] -= 1.0 + (0..contacts).map(|contact| q[3 * contact]).sum::<f64>();
    let laws = (0..contacts).map(|_| Law::Contact { mu: friction(random) }).collect();
    let scale = 10.0_f64.powi(random.below(9) as i32 - 4);
    let w = Matrix::from_dense(&(scale * &rows * rows.transpose()));
    (Problem::new(laws, w, q).unwrap(), Known::None)
}

/// Two joints that want different velocities of the same point, beside contacts.
fn locked_apart(random: &mut Random) -> (Problem, Known) {
    let contacts = 1 + random.below(3);
    let rows = contact_rows(random, 2, contacts + 1);
    let twice = DMatrix::from_fn(3 * contacts + 6, 12, |i, j| {
        rows[(if i < 3 * contacts + 3 { i } else { i - 3 }, j)]
    });
    let q = &twice * DVector::from_fn(12, |_, _| number(random));
    let mut q = q.as_slice().to_vec();
    q[3 * contacts] += 0.5;
    let mut laws = vec![Law::Contact { mu: friction(random) }; contacts];
    laws.extend([Law::LOCKED; 6]);
    (Problem::new(laws, Matrix::from_dense(&(&twice * twice.transpose())), q).unwrap(), Known::None)
}
