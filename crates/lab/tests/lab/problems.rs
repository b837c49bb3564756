//! The iterative methods on frictional contact problems and linear complementarity problems that others
//! collected (Siconos and FCLIB): how far each is after so many sweeps from zero. They lie outside of this
//! repository; where `BACKSTOP_DATA` is not set, the tests say that they skip.

use crate::common::data::data;
use backstop_lab::methods::{Effort, Method, Status};
use backstop_lab::problem::{File, Form, Problem, read_problem, write_problem};
use std::path::PathBuf;

fn read(path: PathBuf) -> File {
    let bytes = std::fs::read(&path).unwrap_or_else(|error| panic!("{}: {error}", path.display()));
    read_problem(&String::from_utf8_lossy(&bytes))
        .unwrap_or_else(|error| panic!("{}: {error}", path.display()))
}

fn contacts(name: &str) -> Option<Problem> {
    Some(read(data("contact_problems")?.join(name)).problem)
}

fn residual(problem: &Problem, method: &str, sweeps: u32) -> f64 {
    let effort = Effort { tolerance: 0.0, iterations: sweeps, ..Effort::default() };
    (Method::by_name(method).expect("a method").solve)(problem, &effort).residual
}

/// Sweeps to a residual.
fn sweeps(problem: &Problem, method: &str, tolerance: f64) -> Option<u32> {
    let effort = Effort { tolerance, iterations: 2000, ..Effort::default() };
    let found = (Method::by_name(method).expect("a method").solve)(problem, &effort);
    (found.status == Status::Solved).then_some(found.iterations)
}

fn reaches(problem: &Problem, method: &str, targets: &[(u32, f64)]) {
    for &(sweeps, target) in targets {
        let found = residual(problem, method, sweeps);
        assert!(found <= target, "{method} after {sweeps} sweeps: {found:.2e} instead of {target:.0e}");
    }
}

const KAPLAS: &str = "KaplasTower-i1061-4.hdf5.dat";
const OBJECT: &str = "OneObject-i100000-499.hdf5.dat";

/// The residual of a published block Gauss-Seidel with exact contacts after as many sweeps.
#[test]
fn exact_blocks_reach_what_they_reach_elsewhere() {
    let (Some(tower), Some(object)) = (contacts(KAPLAS), contacts(OBJECT)) else { return };
    reaches(&tower, "gs-cone", &[(10, 7e-2), (100, 1e-3), (1000, 2e-7)]);
    // Without damping the sweeps run in a circle at 1e-3.
    reaches(&object, "gs-cone", &[(10, 2.6e-3), (100, 4e-4), (1000, 5e-7)]);
}

#[cfg(feature = "hdf5")]
#[test]
fn exact_blocks_solve_a_stack_out_of_its_velocities() {
    let Some(folder) = data("contact_problems") else { return };
    let bytes = std::fs::read(folder.join("Box_Stacks-i0122-82-5.hdf5")).expect("a file");
    let problem = backstop_lab::problem::read_fclib(bytes).expect("a problem").problem;
    assert_eq!(problem.rows(), 82 * 3);
    // All that is left after 100 sweeps is rounding.
    reaches(&problem, "gs-cone", &[(10, 6e-4), (100, 1e-15)]);
}

/// Plain sweeps need 608 for 1e-6 (docs/methods.md).
#[test]
fn conjugate_gradients_need_a_quarter_of_the_sweeps() {
    let Some(tower) = contacts(KAPLAS) else { return };
    let needed = sweeps(&tower, "nncg", 1e-6);
    assert!(needed.is_some_and(|sweeps| sweeps <= 155), "{needed:?}");
}

/// Rigid towers: methods that accelerate reach 1e-8 within 1000 rounds, as `gs-cone` nearly does.
#[test]
fn methods_that_accelerate_solve_the_tower() {
    let Some(tower) = contacts(KAPLAS) else { return };
    for (method, most) in [("nncg", 300), ("apgd", 600), ("admm", 200)] {
        let needed = sweeps(&tower, method, 1e-8);
        assert!(needed.is_some_and(|sweeps| sweeps <= most), "{method}: {needed:?}");
    }
}

/// To 1e-6, in at most 2000 sweeps.
#[test]
fn contact_problems_are_solved_by_all_methods_that_claim_to() {
    let Some(folder) = data("contact_problems") else { return };
    for entry in std::fs::read_dir(folder).expect("a folder") {
        let path = entry.expect("an entry").path();
        if path.extension().is_none_or(|ending| ending != "dat") {
            continue;
        }
        let problem = read(path.clone()).problem;
        for method in ["pgs", "gs-cone", "nncg", "apgd", "admm"] {
            let needed = sweeps(&problem, method, 1e-6);
            assert!(needed.is_some(), "{method} on {}", path.display());
        }
    }
}

#[test]
fn forms_are_told_from_their_sizes() {
    let Some(data) = data(".") else { return };
    for (folder, file, form, rows) in [
        ("lcp", "lcp_CPS_2.dat", Form::Complementarity, 3),
        ("lcp", "lcp_mmc.dat", Form::Complementarity, 26),
        ("contact_problems", "FrictionContact3D_1c.dat", Form::Contacts, 3),
        ("contact_problems", "FrictionContactProblem00031.dat", Form::PlaneContacts, 33),
        ("contact_problems", KAPLAS, Form::Contacts, 1710),
    ] {
        let found = read(data.join(folder).join(file));
        assert_eq!((found.form, found.problem.rows()), (form, rows), "{file}");
    }
    // Cottle, Pang and Stone, example 4.4.7: the first row of M is 0 -1 2, and that of the file 0 2 -1.
    let m = read(data.join("lcp/lcp_CPS_2.dat")).problem;
    assert_eq!([0, 1, 2].map(|j| m.w().at(0, j)), [0.0, -1.0, 2.0]);
}

#[test]
fn all_files_are_read_and_written_to_the_last_bit() {
    let Some(data) = data(".") else { return };
    for folder in ["lcp", "contact_problems"] {
        for entry in std::fs::read_dir(data.join(folder)).expect("a folder") {
            let path = entry.expect("an entry").path();
            if path.extension().is_some_and(|ending| ending == "dat") {
                let problem = read(path.clone()).problem;
                let again = read_problem(&write_problem(&problem).expect("a format")).expect("a problem");
                assert!(again.problem == problem, "{}", path.display());
            }
        }
    }
}

/// A text cut off anywhere is refused or, in its last number, read: it never panics.
#[test]
fn a_file_cut_off_is_refused() {
    let Some(folder) = data("contact_problems") else { return };
    let text = std::fs::read_to_string(folder.join("Confeti-ex13-4contact-Fc3D-SBM.dat")).expect("text");
    for end in (0..text.len() - 150).step_by(13) {
        assert!(read_problem(&text[..end]).is_err(), "{end}");
    }
}
