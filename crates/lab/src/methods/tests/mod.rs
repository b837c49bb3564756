//! Problems with known solutions, for every method, and ill-posed problems.

mod exact;
mod generated;
mod verdicts;

use super::{Effort, Friction, Method, Solution, Solve, Status};
use crate::problem::{Law, Matrix, Problem};

fn problem(laws: Vec<Law>, w: &[&[f64]], q: &[f64]) -> Problem {
    let entries =
        w.iter().enumerate().flat_map(|(i, row)| row.iter().enumerate().map(move |(j, &x)| (i, j, x)));
    Problem::new(laws, Matrix::from_entries(w.len(), entries), q.to_vec()).unwrap()
}

fn expect(solve: Solve, problem: &Problem, expected: &[f64]) {
    let found = solve(problem, &Effort::default());
    assert_eq!(found.status, Status::Solved, "{found:?}");
    assert!(found.residual <= 1e-10 && found.residual == problem.residual(&found.r).relative);
    assert!(
        found.r.iter().zip(expected).all(|(r, e)| (r - e).abs() < 1e-8),
        "{:?} is not {expected:?}",
        found.r
    );
}

/// Single rows with all kinds of bounds.
pub(super) fn check_rows(solve: Solve) {
    // 1 kg lies on 2 kg and both fall at 1 m/s: the floor stops 3 kg, the lower mass 1 kg.
    let chain: &[&[f64]] = &[&[0.5, -0.5], &[-0.5, 1.5]];
    expect(solve, &problem(vec![Law::AT_LEAST_ZERO; 2], chain, &[-1.0, 0.0]), &[3.0, 1.0]);
    // Separating bodies need no impulse.
    expect(solve, &problem(vec![Law::AT_LEAST_ZERO; 2], chain, &[1.0, 2.0]), &[0.0, 0.0]);
    // A joint, and a motor at its limit: 0 = r_0 + r_1 / 2 - 3 with r_1 = 2; the motor's velocity is -1.
    let motor = Law::Bounds { min: -2.0, max: 2.0 };
    let coupled: &[&[f64]] = &[&[1.0, 0.5], &[0.5, 1.0]];
    expect(solve, &problem(vec![Law::LOCKED, motor], coupled, &[-3.0, -4.0]), &[2.0, 2.0]);
    // The other limit, and a one-sided bound away from zero: 0 = r_0 + 1/2 - 3.
    let pushed = Law::Bounds { min: 1.0, max: f64::INFINITY };
    expect(solve, &problem(vec![Law::LOCKED, pushed], coupled, &[-3.0, 4.0]), &[2.5, 1.0]);
    let pulled = Law::Bounds { min: f64::NEG_INFINITY, max: 0.0 };
    expect(solve, &problem(vec![pulled], &[&[2.0]], &[3.0]), &[-1.5]);
    // Murty's, of three unknowns; not symmetric.
    let murty: &[&[f64]] = &[&[1.0, 0.0, 0.0], &[2.0, 1.0, 0.0], &[2.0, 2.0, 1.0]];
    expect(solve, &problem(vec![Law::AT_LEAST_ZERO; 3], murty, &[-1.0; 3]), &[1.0, 0.0, 0.0]);
}

/// Coulomb's law: a ball of 2 kg on a floor with mu = 0.5, the same as a patch, and a box.
pub(super) fn check_contacts(solve: Solve) {
    let ball: &[&[f64]] = &[&[0.5, 0.0, 0.0], &[0.0, 0.5, 0.0], &[0.0, 0.0, 0.5]];
    let contact = vec![Law::Contact { mu: 0.5 }];
    // It falls at 3 m/s, which takes 6 N s, so that friction may take 3: it slides on at 5 - 1.5 m/s.
    expect(solve, &problem(contact.clone(), ball, &[-3.0, 3.0, 4.0]), &[6.0, -1.8, -2.4]);
    // It sticks.
    expect(solve, &problem(contact.clone(), ball, &[-3.0, 1.0, -0.5]), &[6.0, -2.0, 1.0]);
    // It leaves.
    expect(solve, &problem(contact, ball, &[1.0, 4.0, 0.0]), &[0.0; 3]);
    expect(solve, &problem(vec![Law::Contact { mu: 0.0 }], ball, &[-3.0, 4.0, 1.0]), &[6.0, 0.0, 0.0]);

    // One normal and a patch. Friction of 3 N s; twist of 0.05 * 6 = 0.3 N m s, which at 4 / (kg m²) stops
    // 1.2 rad/s.
    let laws = vec![Law::AT_LEAST_ZERO, Law::Patch { mu: 0.5, arm: 0.1, first: 0, count: 1 }];
    let disc: &[&[f64]] =
        &[&[0.5, 0.0, 0.0, 0.0], &[0.0, 0.5, 0.0, 0.0], &[0.0, 0.0, 0.5, 0.0], &[0.0, 0.0, 0.0, 4.0]];
    expect(solve, &problem(laws.clone(), disc, &[-3.0, 3.0, 4.0, 1.0]), &[6.0, -1.8, -2.4, -0.25]);
    expect(solve, &problem(laws, disc, &[-3.0, 1.0, 0.0, 2.0]), &[6.0, -2.0, 0.0, -0.3]);
    check_box(solve);
}

/// A cube of 6 kg and 1 m on its four lower corners, which falls at 1 m/s and slides at 1: 6 N s stop it, 3
/// brake it to 1/2 m/s. Twelve rows, of rank six: how the corners share is open.
fn check_box(solve: Solve) {
    let found = solve(&box_on_floor(), &Effort::default());
    assert_eq!(found.status, Status::Solved, "{found:?}");
    let sum = |k: usize| (0..4).map(|c| found.r[3 * c + k]).sum::<f64>();
    for (k, expected) in [6.0, -3.0, 0.0].into_iter().enumerate() {
        assert!((sum(k) - expected).abs() < 1e-7, "{k}: {}", sum(k));
    }
    let u = box_on_floor().velocities(&found.r);
    assert!((0..4).all(|c| u[3 * c].abs() < 1e-8 && (u[3 * c + 1] - 0.5).abs() < 1e-8), "{u:?}");
}

fn box_on_floor() -> Problem {
    // Normal z, tangents x and y; the inertia of the cube is m / 6 = 1.
    let corners = [[-0.5, -0.5], [0.5, -0.5], [-0.5, 0.5], [0.5, 0.5]];
    let axes = [[0.0, 0.0, 1.0], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0]];
    let rows: Vec<[f64; 6]> = corners
        .iter()
        .flat_map(|&[x, y]| axes.map(|[a, b, c]| [a, b, c, y * c + 0.5 * b, -0.5 * a - x * c, x * b - y * a]))
        .collect();
    let inverse_mass = [1.0 / 6.0, 1.0 / 6.0, 1.0 / 6.0, 1.0, 1.0, 1.0];
    let entry = |a: &[f64; 6], b: &[f64; 6]| (0..6).map(|k| a[k] * inverse_mass[k] * b[k]).sum::<f64>();
    let entries = (0..144).map(|k| (k / 12, k % 12, entry(&rows[k / 12], &rows[k % 12])));
    let q = (0..12).map(|i| [-1.0, 1.0, 0.0][i % 3]).collect();
    Problem::new(vec![Law::Contact { mu: 0.5 }; 4], Matrix::from_entries(12, entries), q).unwrap()
}

fn dire_problems() -> Vec<Problem> {
    let locked = Law::LOCKED;
    let contact = |mu| Law::Contact { mu };
    let patch = |count| Law::Patch { mu: 0.5, arm: 0.3, first: 0, count };
    let everything =
        vec![Law::AT_LEAST_ZERO, contact(0.5), locked, patch(1), Law::Bounds { min: 2.0, max: 2.0 }];
    let rows = 9;
    let diagonal = |x: f64| Matrix::from_entries(rows, (0..rows).map(|i| (i, i, x)));
    let full = |f: fn(usize, usize) -> f64| {
        Matrix::from_entries(rows, (0..rows * rows).map(|k| (k / rows, k % rows, f(k / rows, k % rows))))
    };
    let matrices = [
        diagonal(0.0),
        diagonal(1.0),
        diagonal(-1.0),
        diagonal(1e-300),
        diagonal(1e300),
        full(|_, _| 1.0),
        full(|_, _| 1e200),
        full(|_, _| -1e308),
        full(|i, j| if i == j { 0.0 } else { i as f64 - j as f64 }),
        full(|i, j| ((i * 7 + j * 3) % 5) as f64 - 2.0),
        full(|i, j| [1e150, 1e-150, 1.0][(i + 2 * j) % 3]),
    ];
    let qs = [
        vec![-1.0; rows],
        vec![0.0; rows],
        vec![-1e200; rows],
        vec![1e308, -1e308, 1e-308, 1.0, -1.0, 3.0, -4.0, 0.0, 1.0],
    ];
    let mut problems = vec![
        Problem::lcp(Matrix::from_entries(0, []), vec![]).unwrap(),
        Problem::new(vec![patch(0)], Matrix::from_entries(3, []), vec![1.0; 3]).unwrap(),
        Problem::new(
            vec![contact(1e200)],
            Matrix::from_entries(3, [(0, 0, 1.0), (1, 1, 1.0)]),
            vec![-1.0, 2.0, 3.0],
        )
        .unwrap(),
    ];
    for w in matrices {
        for q in &qs {
            problems.push(Problem::new(everything.clone(), w.clone(), q.clone()).unwrap());
        }
    }
    problems
}

fn is_honest(problem: &Problem, effort: &Effort, found: &Solution) -> bool {
    found.r.len() == problem.rows()
        && found.r.iter().all(|x| x.is_finite())
        && found.residual.is_finite()
        && found.residual == problem.residual(&found.r).relative.min(f64::MAX)
        // An exact method does not claim a residual below the rounding errors of W r.
        && (found.status != Status::Solved || found.residual <= effort.tolerance)
        && found.iterations <= effort.iterations
}

#[test]
fn no_problem_makes_a_method_panic_or_lie() {
    for method in Method::ALL {
        for friction in [Friction::Cone, Friction::Pyramid, Friction::Box] {
            for (number, problem) in dire_problems().iter().enumerate() {
                for start in [
                    None,
                    Some(vec![1.0; problem.rows()]),
                    Some(vec![f64::NAN; 2]),
                    Some(vec![1e308; problem.rows()]),
                ] {
                    let effort = Effort { iterations: 60, friction, start, ..Effort::default() };
                    let found = (method.solve)(problem, &effort);
                    assert!(
                        is_honest(problem, &effort, &found),
                        "{} of {number}: {found:?} {effort:?}",
                        method.name
                    );
                }
            }
        }
    }
}

#[test]
fn a_problem_without_rows_is_solved_at_once() {
    let problem = Problem::lcp(Matrix::from_entries(0, []), vec![]).unwrap();
    for method in Method::ALL {
        assert_eq!((method.solve)(&problem, &Effort::default()).status, Status::Solved, "{}", method.name);
    }
}

#[test]
fn without_iterations_the_start_is_the_answer() {
    let problem = box_on_floor();
    for method in Method::ALL {
        let start = vec![0.5; 12];
        let effort = Effort { iterations: 0, start: Some(start.clone()), ..Effort::default() };
        let found = (method.solve)(&problem, &effort);
        assert_eq!((found.status, found.r), (Status::Limit, start), "{}", method.name);
    }
}

#[test]
fn names_are_those_of_a_command_line_and_differ() {
    for (i, method) in Method::ALL.iter().enumerate() {
        assert!(method.name.bytes().all(|b| b.is_ascii_lowercase() || b == b'-'), "{}", method.name);
        assert!(Method::ALL[..i].iter().all(|other| other.name != method.name));
        assert_eq!(Method::by_name(method.name).map(|found| found.name), Some(method.name));
    }
}

/// Box and pyramid are other laws: a ball that slides along (3, 4) keeps its speed along y by what they
/// allow.
#[test]
fn friction_has_the_shape_that_is_asked_for() {
    let ball: &[&[f64]] = &[&[0.5, 0.0, 0.0], &[0.0, 0.5, 0.0], &[0.0, 0.0, 0.5]];
    let problem = problem(vec![Law::Contact { mu: 0.5 }], ball, &[-3.0, 3.0, 4.0]);
    // mu r_n is 3 N s: each tangent has that much in a box; |x| + |y| has in the pyramid, and most of it goes
    // where it slides fastest.
    for (friction, expected) in [(Friction::Box, [6.0, -3.0, -3.0]), (Friction::Pyramid, [6.0, -0.5, -2.5])] {
        for solve in [super::jacobi, super::pgs, super::psor] {
            let effort = Effort { friction, iterations: 1, ..Effort::default() };
            let found = solve(&problem, &Effort { relaxation: 1.0, ..effort });
            assert!(
                found.r.iter().zip(expected).all(|(r, e)| (r - e).abs() < 1e-12),
                "{friction:?} {:?}",
                found.r
            );
        }
    }
}
