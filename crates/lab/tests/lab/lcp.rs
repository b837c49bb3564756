//! Linear complementarity problems of others (`lcp` of `$BACKSTOP_DATA`) by every exact method. The answers
//! are unique where they are stated as such: CPS are examples of Cottle, Pang and Stone, *The Linear
//! Complementarity Problem* (1992), `exp_murty` is Murty's problem that takes 2ⁿ - 1 pivots by the least
//! index; the others are checked by `w = M z + q` itself.

use crate::common::data::data;
use backstop_lab::methods::{Effort, Method, Status};
use backstop_lab::problem::read_problem;
use std::path::PathBuf;

const EXACT: [&str; 8] =
    ["lemke", "dantzig", "keller", "murty", "block-pivoting", "newton-min", "newton-fb", "path"];

/// Problems with one solution, and the solution.
const KNOWN: [(&str, &[f64]); 6] = [
    ("lcp_CPS_2", &[0.0, 1.0, 3.0]),
    ("lcp_CPS_4", &[2.0, 2.0, 2.0, 92.0]),
    ("lcp_Pang_isolated_sol", &[1.0, 0.0, 0.0]),
    ("lcp_deudeu", &[4.0 / 3.0, 7.0 / 3.0]),
    ("lcp_exp_murty", &[0.0, 0.0, 0.0, 0.0, 0.0, 1.0]),
    ("lcp_ortiz", &[2.0 / 3.0, 0.0, 1.0 / 3.0, 0.0]),
];

#[test]
fn exact_methods_solve_the_problems_of_others_to_ten_digits() {
    let Some(folder) = data("lcp") else { return };
    let mut files: Vec<PathBuf> = std::fs::read_dir(folder).unwrap().map(|f| f.unwrap().path()).collect();
    files.sort();
    assert!(!files.is_empty());
    for file in files {
        let name = file.file_stem().unwrap().to_str().unwrap();
        let problem = read_problem(&std::fs::read_to_string(&file).unwrap()).unwrap().problem;
        for method in EXACT {
            let found = (Method::by_name(method).unwrap().solve)(&problem, &Effort::default());
            assert_eq!(found.status, Status::Solved, "{name} by {method}: {found:?}");
            let w = problem.velocities(&found.r);
            for (i, (z, w)) in found.r.iter().zip(&w).enumerate() {
                assert!(*z >= -1e-10 && *w >= -1e-10 && (z * w).abs() < 1e-10, "{name} by {method}: {i}");
            }
            if let Some((_, known)) = KNOWN.iter().find(|(of, _)| *of == name) {
                for (z, known) in found.r.iter().zip(*known) {
                    assert!(
                        (z - known).abs() < 1e-10 * known.abs().max(1.0),
                        "{name} by {method}: {:?}",
                        found.r
                    );
                }
            }
        }
    }
}

/// `z >= 0` with `w = M z + q >= 0` can't be where `q` is negative and no column of M can raise it: none of
/// them claims a solution, and those that can prove it do.
#[test]
fn a_problem_without_a_solution_is_not_solved() {
    use backstop_lab::problem::{Matrix, Problem};
    let m = Matrix::from_entries(2, [(0, 0, 1.0), (0, 1, -1.0), (1, 0, -1.0), (1, 1, 1.0)]);
    let problem = Problem::lcp(m, vec![-1.0, -1.0]).unwrap();
    for method in Method::ALL {
        let found = (method.solve)(&problem, &Effort { iterations: 500, ..Effort::default() });
        assert_ne!(found.status, Status::Solved, "{}", method.name);
        if EXACT.contains(&method.name) {
            assert_eq!(found.status, Status::NoSolution, "{}", method.name);
        }
    }
}
