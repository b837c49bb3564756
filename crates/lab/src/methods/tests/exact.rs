//! Exact methods on small problems, against an oracle that tries all 2ⁿ choices of positive variables.

use crate::methods::*;
use crate::problem::{Law, Matrix};
use crate::random::Random;
use nalgebra::{DMatrix, DVector};

const ALL: [(&str, Solve); 8] = [
    ("lemke", lemke),
    ("dantzig", dantzig),
    ("keller", keller),
    ("murty", murty),
    ("block_pivoting", block_pivoting),
    ("newton_min", newton_min),
    ("newton_fb", newton_fb),
    ("path", path),
];

fn random_matrix(random: &mut Random, rows: usize, columns: usize) -> DMatrix<f64> {
    DMatrix::from_fn(rows, columns, |_, _| random.range64(-1.0, 1.0))
}

/// Whether any choice of positive variables solves it.
fn solvable(m: &DMatrix<f64>, q: &[f64]) -> bool {
    let n = q.len();
    (0..1_usize << n).any(|mask| {
        let active: Vec<usize> = (0..n).filter(|i| mask >> i & 1 == 1).collect();
        let mut z = DVector::zeros(n);
        if !active.is_empty() {
            let part = DMatrix::from_fn(active.len(), active.len(), |i, j| m[(active[i], active[j])]);
            let right = DVector::from_fn(active.len(), |i, _| -q[active[i]]);
            let Ok(x) = part.clone().svd(true, true).solve(&right, 1e-11) else { return false };
            if (&part * &x - &right).amax() > 1e-9 {
                return false;
            }
            active.iter().zip(x.iter()).for_each(|(&i, &x)| z[i] = x);
        }
        let w = m * &z + DVector::from_column_slice(q);
        z.iter().chain(w.iter()).all(|&x| x >= -1e-9)
    })
}

fn lcp(m: &DMatrix<f64>, q: &[f64]) -> Problem {
    Problem::lcp(Matrix::from_dense(m), q.to_vec()).unwrap()
}

/// Positive semidefinite matrices of half rank with any q: solved if the oracle solves them, else proved
/// unsolvable. That a ray is such a proof is Lemke's theorem for copositive-plus matrices.
#[test]
fn semidefinite_problems_are_solved_or_proved_unsolvable() {
    let mut random = Random(7);
    let mut without = 0;
    for case in 0..120 {
        let n = 2 + case % 7;
        let b = random_matrix(&mut random, n, n.div_ceil(2));
        let (m, q) = (&b * b.transpose(), random_matrix(&mut random, n, 1));
        let expected = if solvable(&m, q.as_slice()) { Status::Solved } else { Status::NoSolution };
        without += u32::from(expected == Status::NoSolution);
        for (name, solve) in ALL {
            let found = solve(&lcp(&m, q.as_slice()), &Effort::default());
            assert_eq!(found.status, expected, "{name}, case {case}: {found:?}");
        }
    }
    assert!(without > 10, "{without}");
}

/// A method may fail on an indefinite problem, but it must not call a problem unsolvable that the oracle
/// solves.
#[test]
fn no_method_denies_a_solution_that_there_is() {
    let mut random = Random(3);
    for case in 0..120 {
        let n = 2 + case % 7;
        let (m, q) = (random_matrix(&mut random, n, n), random_matrix(&mut random, n, 1));
        let any = solvable(&m, q.as_slice());
        for (name, solve) in ALL {
            let found = solve(&lcp(&m, q.as_slice()), &Effort { iterations: 300, ..Effort::default() });
            assert!(!any || found.status != Status::NoSolution, "{name}, case {case}");
            assert!(any || found.status != Status::Solved, "{name}, case {case}: {found:?}");
        }
    }
}

/// Murty's example (1978): upper triangular with ones and twos, q = -1. The solution is the last unit vector,
/// and his rule takes 2^n - 1 pivots.
#[test]
fn murtys_example_takes_his_rule_all_pivots() {
    for n in [4, 8, 12] {
        let m = DMatrix::from_fn(n, n, |i, j| if i == j { 1.0 } else { 2.0 * f64::from(i < j) });
        for (name, solve) in ALL {
            let found = solve(&lcp(&m, &vec![-1.0; n]), &Effort::default());
            assert_eq!(found.status, Status::Solved, "{name}");
            let expected = (0..n).map(|i| f64::from(i + 1 == n));
            assert!(
                found.r.iter().zip(expected).all(|(z, e)| (z - e).abs() < 1e-12),
                "{name}: {:?}",
                found.r
            );
            if name == "murty" {
                assert_eq!(found.pivots, (1 << n) - 1);
            }
        }
    }
}

/// A bimatrix game: M is zero on both diagonal blocks, so that the path from the ray of `t` ends in another
/// ray, while Lemke and Howson's start proves that there is an equilibrium (1964).
#[test]
fn lemke_solves_bimatrix_games() {
    let mut random = Random(11);
    for n in [2, 4, 6, 8] {
        let half = n / 2;
        let m = random_matrix(&mut random, n, n);
        let m = DMatrix::from_fn(n, n, |i, j| if (i < half) != (j < half) { 1.5 + m[(i, j)] } else { 0.0 });
        let found = lemke(&lcp(&m, &vec![-1.0; n]), &Effort::default());
        assert_eq!(found.status, Status::Solved, "{n}: {found:?}");
    }
}

/// Bounds of every kind at once. By hand: row 0 is held at 2, row 1 at its upper bound -1 (u = 2 - 2 - 2 = -2
/// <= 0), row 2 at its lower bound 1 (u = 2 + 3 >= 0), and the joint 3 x = 4 - 0.
#[test]
fn bounds_of_all_kinds_are_met() {
    let m = DMatrix::from_diagonal(&DVector::from_vec(vec![2.0, 2.0, 2.0, 3.0]));
    let bounds =
        [(2.0, 2.0), (f64::NEG_INFINITY, -1.0), (1.0, f64::INFINITY), (f64::NEG_INFINITY, f64::INFINITY)];
    let laws = bounds.map(|(min, max)| Law::Bounds { min, max }).to_vec();
    // Everything is coupled to the first row, so that the problem is one part.
    let mut m = m;
    (1..4).for_each(|i| m[(i, 0)] = 0.5);
    let q = vec![1.0, -1.0, 2.0, -5.0];
    let problem = Problem::new(laws, Matrix::from_dense(&m), q).unwrap();
    for (name, solve) in ALL {
        let found = solve(&problem, &Effort::default());
        assert_eq!(found.status, Status::Solved, "{name}: {found:?}");
        let expected = [2.0, -1.0, 1.0, 4.0 / 3.0];
        assert!(found.r.iter().zip(expected).all(|(r, e)| (r - e).abs() < 1e-12), "{name}: {:?}", found.r);
    }
}

/// A ball of 2 kg that falls at 3 m/s and slides at 5 across all axes: 6 N s stop it and mu = 0.5 brakes it
/// by 3 N s against its own direction, which neither a box nor a pyramid along the axes finds.
#[test]
fn friction_is_against_the_slip_and_not_along_an_axis() {
    let w = Matrix::from_entries(3, (0..3).map(|i| (i, i, 0.5)));
    let problem = Problem::new(vec![Law::Contact { mu: 0.5 }], w, vec![-3.0, 3.0, 4.0]).unwrap();
    for (name, solve) in ALL {
        let found = solve(&problem, &Effort::default());
        assert_eq!(found.status, Status::Solved, "{name}: {found:?}");
        let expected = [6.0, -1.8, -2.4];
        assert!(found.r.iter().zip(expected).all(|(r, e)| (r - e).abs() < 1e-9), "{name}: {:?}", found.r);
        let friction = if matches!(name, "lemke" | "path") { Friction::Pyramid } else { Friction::Box };
        let along_axes = solve(&problem, &Effort { friction, ..Effort::default() });
        assert_eq!(along_axes.status, Status::Limit, "{name}");
    }
}

/// A box on four points is supported redundantly: W has rank 6 with 12 rows. A method may start from a
/// solution, and then has nothing left to do.
#[test]
fn a_box_on_four_points_sticks_and_slides() {
    let corners = [(-0.5, -0.5), (-0.5, 0.5), (0.5, -0.5), (0.5, 0.5)];
    let jacobian = DMatrix::from_fn(12, 6, |row, column| {
        let (x, y) = corners[row / 3];
        // Normal z, tangents x and y, of a point half a metre below the centre; then arm x direction.
        let rows =
            [[0.0, 0.0, 1.0, y, -x, 0.0], [1.0, 0.0, 0.0, 0.0, -0.5, -y], [0.0, 1.0, 0.0, 0.5, 0.0, x]];
        rows[row % 3][column]
    });
    let masses = DMatrix::from_diagonal(&DVector::from_vec(vec![1.0, 1.0, 1.0, 6.0, 6.0, 6.0]));
    let w = &jacobian * masses * jacobian.transpose();
    for (slide, mu) in [(0.1, 0.6), (3.0, 0.2), (0.5, 1.2)] {
        let q = &jacobian * DVector::from_vec(vec![slide, 0.4 * slide, -1.0, 0.1, 0.2, 0.3]);
        let laws = vec![Law::Contact { mu }; 4];
        let problem = Problem::new(laws, Matrix::from_dense(&w), q.as_slice().to_vec()).unwrap();
        for (name, solve) in ALL {
            let found = solve(&problem, &Effort::default());
            assert_eq!(found.status, Status::Solved, "{name}, {slide} m/s: {found:?}");
            let again = solve(&problem, &Effort { start: Some(found.r.clone()), ..Effort::default() });
            assert_eq!((again.status, again.iterations, again.r), (Status::Solved, 0, found.r), "{name}");
        }
    }
}

/// Numbers at the ends of the range, zero matrices, and no rows at all: the result is finite.
#[test]
fn nothing_panics_or_is_infinite() {
    let diagonal = |n: usize, x: f64| Matrix::from_entries(n, (0..n).map(|i| (i, i, x)));
    let contact = vec![Law::Contact { mu: 0.5 }];
    let problems = [
        Problem::new(Vec::new(), diagonal(0, 1.0), Vec::new()),
        Problem::new(contact.clone(), diagonal(3, 0.0), vec![-1.0, 1.0, 0.0]),
        Problem::new(contact.clone(), diagonal(3, 1e200), vec![-1e200, 1e200, 1.0]),
        Problem::new(contact, diagonal(3, 1e-200), vec![-1e200, 1e200, 1.0]),
        Problem::lcp(diagonal(3, f64::MAX), vec![-f64::MAX, f64::MAX, 0.0]),
        Problem::lcp(diagonal(3, -1.0), vec![-1.0, 1.0, 0.0]),
        Problem::lcp(diagonal(3, 5e-324), vec![-5e-324, 1.0, 0.0]),
    ];
    for (case, problem) in problems.into_iter().enumerate() {
        let problem = problem.unwrap();
        for (name, solve) in ALL {
            for start in [None, Some(vec![1e300; problem.rows()]), Some(vec![f64::NAN; problem.rows()])] {
                let found = solve(&problem, &Effort { start, iterations: 200, ..Effort::default() });
                assert_eq!(found.r.len(), problem.rows());
                assert!(found.r.iter().all(|x| x.is_finite()), "{name}, case {case}: {found:?}");
                assert!(found.status != Status::Solved || found.residual <= 1e-10, "{name}, case {case}");
            }
        }
    }
}
