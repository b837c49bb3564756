//! Small examples that can be checked by eye.

use super::*;
use crate::problem::write_problem;

fn dense(file: &File) -> Vec<Vec<f64>> {
    let w = file.problem.w();
    (0..w.size()).map(|i| (0..w.size()).map(|j| w.at(i, j)).collect()).collect()
}

#[test]
fn a_complementarity_problem_is_read_column_by_column() {
    let file = read_problem("2\n0\n2\n2\n2 2\n1 2\n3 4\n-5 -6e-1\nfree text 7 8").unwrap();
    assert_eq!(file.form, Form::Complementarity);
    assert_eq!(dense(&file), [[1.0, 3.0], [2.0, 4.0]]);
    assert_eq!(file.problem.q(), [-5.0, -0.6]);
    assert!(file.problem.laws().all(|(_, law)| law == Law::AT_LEAST_ZERO));
}

#[test]
fn three_unknowns_are_not_three_dimensions() {
    let file = read_problem("3 0 3 3 3 3  1 0 0  0 1 0  0 0 1  1 2 3").unwrap();
    assert_eq!(file.form, Form::Complementarity);
    let contact = read_problem("3 1 0 3 3 3 3  1 0 0  0 1 0  0 0 1  1 2 3  0.5").unwrap();
    assert_eq!(contact.form, Form::Contacts);
    assert_eq!(contact.problem.laws().collect::<Vec<_>>(), [(0, Law::Contact { mu: 0.5 })]);
    assert_eq!(contact.problem.w(), file.problem.w());
}

#[test]
fn blocks_are_put_where_their_pointers_say() {
    // Two contacts in a plane: three blocks of 2 x 2, with the lower left one missing.
    let text =
        "2 2 1 4 4 3 2 2  2 4  2 4  3 3  0 2 3  0 1 1  0 1 2 3 4  1 5 6 7 8  2 9 10 11 12  1 2 3 4  0.1 0.2";
    let file = read_problem(text).unwrap();
    assert_eq!(file.form, Form::PlaneContacts);
    let expected = [
        [1.0, 3.0, 0.0, 5.0, 7.0, 0.0],
        [2.0, 4.0, 0.0, 6.0, 8.0, 0.0],
        // The second tangent that the plane does not have.
        [0.0, 0.0, 4.0, 0.0, 0.0, 0.0],
        [0.0, 0.0, 0.0, 9.0, 11.0, 0.0],
        [0.0, 0.0, 0.0, 10.0, 12.0, 0.0],
        [0.0, 0.0, 0.0, 0.0, 0.0, 12.0],
    ];
    assert_eq!(dense(&file), expected);
    assert_eq!(file.problem.q(), [1.0, 2.0, 0.0, 3.0, 4.0, 0.0]);
    assert_eq!(file.unknowns(&[1.0, 2.0, 0.0, 3.0, 4.0, 0.0]), [1.0, 2.0, 3.0, 4.0]);
}

/// 1 2 0 / 0 3 0 / 0 0 4 by columns, by rows, and as triplets.
#[test]
fn a_sparse_matrix_is_read_as_csparse_prints_it() {
    let columns = "3-by-3, nzmax: 4 nnz: 4, 1-norm: 5\n    col 0 : locations 0 to 0\n      0 : 1
        col 1 : locations 1 to 2\n      0 : 2\n      1 : 3\n    col 2 : locations 3 to 3\n      2 : 4";
    let rows =
        "csr: 3-by-3, nzmax: 4 nnz: 4, 1-norm: 5\n    row 0 : locations 0 to 1\n      0 : 1\n      1 : 2
        row 1 : locations 2 to 2\n      1 : 3\n    row 2 : locations 3 to 3\n      2 : 4";
    let triplets = "triplet: 3-by-3, nzmax: 9 nnz: 4\n    2 2 : 4\n    0 0 : 1\n    0 1 : 2\n    1 1 : 3";
    for (origin, matrix) in [(2, columns), (3, rows), (1, triplets)] {
        let version = "CSparse Version 3.1.9, May 4, 2016.  Copyright (c) Timothy A. Davis, 2006-2016";
        let text = format!("3\n1\n2\n3\n3\n{origin}\n{version}\n{matrix}\n-1 2 3\n0.5");
        let file = read_problem(&text).unwrap_or_else(|error| panic!("{error}\n{text}"));
        assert_eq!(dense(&file), [[1.0, 2.0, 0.0], [0.0, 3.0, 0.0], [0.0, 0.0, 4.0]]);
        assert_eq!((file.form, file.problem.q()), (Form::Contacts, &[-1.0, 2.0, 3.0][..]));
    }
}

/// A ball of 1 kg and 0.1 m that lands at 6 m/s, slides at 2 and rolls at 20 rad/s about another axis: each
/// friction opposes its own motion.
#[test]
fn rolling_friction_is_a_second_patch() {
    let text = "5 1 0 5 5 5 5  1 0 0 0 0  0 1 0 0 0  0 0 1 0 0  0 0 0 2 0  0 0 0 0 2  -6 2 0 0 20  0.5 0.1";
    let file = read_problem(text).unwrap();
    assert_eq!((file.form, file.problem.rows()), (Form::RollingContacts, 7));
    for method in crate::methods::Method::ALL {
        let found = (method.solve)(&file.problem, &Default::default());
        let r = file.unknowns(&found.r);
        // 6 N s stop it; 2 of 3 N s of friction hold it, and 0.6 N m s slow it by 1.2 rad/s.
        let close = r.iter().zip([6.0, -2.0, 0.0, 0.0, -0.6]).all(|(r, e)| (r - e).abs() < 1e-8);
        assert!(found.residual <= 1e-10 && close, "{}: {r:?} {found:?}", method.name);
    }
    let negative = text.replace(" 0.1", " -0.1");
    assert!(read_problem(&negative).is_err_and(|error| error.what.contains("negative")));
}

/// Two bodies of 2 and 4 kg that are not coupled but by a zero, and one contact between them and the ground:
/// `W = Hᵀ M⁻¹ H`, `q = b + Hᵀ M⁻¹ f`.
#[test]
fn velocities_of_a_global_problem_are_eliminated() {
    let mass = "2 4 4\n1\nCSparse\ntriplet: 4-by-4, nnz: 5\n0 0 : 2\n1 1 : 2\n2 2 : 4\n3 3 : 4\n0 3 : 0";
    let h = "0 4 3 4 3  1 0 0 -1  0 1 0 0  0 0 1 0";
    let file = read_problem(&format!("3 1\n{mass}\n{h}\n2 0 0 4  -1 0 0  0.5")).unwrap();
    assert_eq!(file.form, Form::Contacts);
    let w = [[0.75, 0.0, 0.0], [0.0, 0.5, 0.0], [0.0, 0.0, 0.25]];
    let close = |a: &f64, b: &f64| (a - b).abs() < 1e-15;
    assert!(dense(&file).iter().flatten().zip(w.as_flattened()).all(|(a, b)| close(a, b)));
    assert!(file.problem.q().iter().zip(&[-1.0, 0.0, 0.0]).all(|(a, b)| close(a, b)));
}

#[test]
fn what_is_wrong_is_said_with_its_line() {
    let cases = [
        ("", 1, "ends before a size"),
        ("2\n0\n2\n2\n2 2\n1 2\n3 x\n1 1", 7, "finite number, not \"x\""),
        ("2\n0\n2\n2\n2 2\n1 2\n3 inf\n1 1", 7, "finite number"),
        ("2\n0\n2\n2\n2 2\n1 2\n3 4\n1", 7, "too short for q"),
        ("6\n4\n7\n8\n", 1, "neither the sizes"),
        ("3\n1\n7\n3\n3", 3, "storage 7"),
        ("3\n1\n2\n3\n3\n1\nCS", 7, "CSparse"),
        ("3\n1\n2\n3\n3\n1\nCSparse\n2-by-2, nnz: 1", 8, "3-by-3 expected"),
        ("3\n1\n2\n3\n3\n1\nCSparse\n3-by-3, nnz: 99999999999\n1", 8, "too short for the entries"),
        ("3\n1\n2\n3\n3\n1\nCSparse\ntriplet: 3-by-3, nnz: 1\n0 3 : 1", 9, "index 3 is outside"),
        ("3\n1\n2\n3\n3\n2\nCSparse\n3-by-3, nnz: 1\ncol 0 : locations 0 to 9\n0 : 1\n1 : 1", 10, "more loc"),
        ("3\n1\n0\n6\n3", 5, "square matrix expected, but found 6-by-3"),
        ("3\n1\n0\n1\n1\n1 1\n7\n1 2 3", 7, "3 rows of the matrix expected, but found 1"),
        ("-2 0 2 2", 1, "whole number"),
        // A billion rows in twenty bytes.
        (
            "1000000000\n0\n1000000000\n1000000000\n1000000000 1000000000\n1 2 3",
            5,
            "too short for the entries",
        ),
        ("3\n18446744073709551615\n0\n1\n1\n1 1\n7", 7, "rows of the matrix expected"),
        // One block of a billion rows, and empty.
        (
            "1000000000 1 1000000000 1000000000\n0 1 1 1000000000 1000000000\n2 0\n0 0\n1",
            4,
            "too short for q",
        ),
        ("3 1 1 3 3\n1 1 1 3 3 2 1\n0 2\n0\n", 3, "must rise from 0"),
        ("3 1 1 3 3\n1 1 1 3 3 2 1\n0 1\n5\n", 4, "too great"),
        ("3 1 1 3 3\n1 1 1 4 3 2 1\n0 1\n5\n", 2, "must rise to 3"),
        ("3 1 1 3 3\n1 1 1 3 3 18446744073709551615 1\n0 1\n5\n", 2, "the row pointer must have 2 numbers"),
        ("3 1 0 3 3 3 3\n1 0 0 0 1 0 0 0 1\n1 2 3\n-0.5", 4, "negative"),
    ];
    for (text, line, what) in cases {
        let error = read_problem(text).expect_err(text);
        assert!(error.line == line && error.what.contains(what), "{text:?}: {error}");
    }
}

#[test]
fn no_beginning_of_a_text_panics() {
    let text =
        "2 2 1 4 4 3 2 2  2 4  2 4  3 3  0 2 3  0 1 1  0 1 2 3 4  1 5 6 7 8  2 9 10 11 12  1 2 3 4  0.1 0.2";
    // The last number may lose digits and still be a number.
    let shortest = text.len() - 2;
    assert!((0..=text.len()).all(|end| read_problem(&text[..end]).is_ok() == (end >= shortest)));
}

#[test]
fn what_is_written_is_read_to_the_last_bit() {
    let third = 1.0 / 3.0;
    let diagonal = |n: usize| Matrix::from_entries(n, (0..n).map(|i| (i, i, third + i as f64)));
    let full = Matrix::from_entries(3, (0..9).map(|k| (k / 3, k % 3, 1e-300 / (k as f64 + 0.1))));
    let problems = [
        Problem::lcp(full, vec![third, -0.0, 1e300]).unwrap(),
        Problem::lcp(diagonal(5), vec![f64::MIN_POSITIVE / 3.0; 5]).unwrap(),
        Problem::lcp(Matrix::from_entries(0, []), vec![]).unwrap(),
        Problem::new(vec![Law::Contact { mu: 0.1 }; 4], diagonal(12), vec![-third; 12]).unwrap(),
        Problem::new(vec![Law::Contact { mu: third }], diagonal(3), vec![-third; 3]).unwrap(),
    ];
    for problem in problems {
        let text = write_problem(&problem).unwrap();
        let again = read_problem(&text).unwrap_or_else(|error| panic!("{error}\n{text}")).problem;
        assert_eq!(again, problem);
        let bits = |problem: &Problem| problem.q().iter().map(|x| x.to_bits()).collect::<Vec<_>>();
        assert_eq!(bits(&again), bits(&problem));
    }
    let locked = Problem::new(vec![Law::LOCKED], diagonal(1), vec![1.0]).unwrap();
    assert!(write_problem(&locked).is_err());
}
