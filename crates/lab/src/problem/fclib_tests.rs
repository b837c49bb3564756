//! Files written in FCLIB's layout, read back.

use super::*;
use hdf5_pure::FileBuilder;

/// A matrix by its storage: rows, columns, nz, p, i, x.
type Stored<'a> = (i32, i32, i32, &'a [i32], &'a [i32], &'a [f64]);

fn file(kind: &str, matrices: &[(&str, Stored)], vectors: &[(&str, &[f64])]) -> Vec<u8> {
    let mut file = FileBuilder::new();
    let mut top = file.create_group(kind);
    top.create_dataset("spacedim").with_i32_data(&[3]);
    for &(name, (m, n, nz, p, i, x)) in matrices {
        let mut group = top.create_group(name);
        for (name, number) in [("m", m), ("n", n), ("nz", nz), ("nzmax", x.len() as i32)] {
            group.create_dataset(name).with_i32_data(&[number]);
        }
        group.create_dataset("p").with_i32_data(p);
        group.create_dataset("i").with_i32_data(i);
        group.create_dataset("x").with_f64_data(x);
        top.add_group(group.finish());
    }
    let mut group = top.create_group("vectors");
    for (name, numbers) in vectors {
        group.create_dataset(name).with_f64_data(numbers);
    }
    top.add_group(group.finish());
    file.add_group(top.finish());
    file.finish().unwrap()
}

/// 1 2 0 / 0 3 0 / 0 0 4 in each of the three storages.
const STORAGES: [Stored; 3] = [
    (3, 3, 4, &[0, 1, 1, 2], &[0, 0, 1, 2], &[1.0, 2.0, 3.0, 4.0]),
    (3, 3, -1, &[0, 1, 3, 4], &[0, 0, 1, 2], &[1.0, 2.0, 3.0, 4.0]),
    (3, 3, -2, &[0, 2, 3, 4], &[0, 1, 1, 2], &[1.0, 2.0, 3.0, 4.0]),
];

#[test]
fn a_local_problem_is_read_in_all_storages() {
    for stored in STORAGES {
        let bytes = file("fclib_local", &[("W", stored)], &[("q", &[-1.0, 2.0, 3.0]), ("mu", &[0.5])]);
        let found = read_fclib(bytes).unwrap();
        let w = Matrix::from_entries(3, [(0, 0, 1.0), (0, 1, 2.0), (1, 1, 3.0), (2, 2, 4.0)]);
        let expected = Problem::new(vec![Law::Contact { mu: 0.5 }], w, vec![-1.0, 2.0, 3.0]).unwrap();
        assert_eq!(found, File { problem: expected, form: Form::Contacts });
    }
}

/// M = 2 1 0 / 1 2 0 / 0 0 4, its inverse 2/3 -1/3 0 / -1/3 2/3 0 / 0 0 1/4; H the unit matrix.
const MASS: Stored = (3, 3, 5, &[0, 1, 0, 1, 2], &[0, 0, 1, 1, 2], &[2.0, 1.0, 1.0, 2.0, 4.0]);
const UNIT: Stored = (3, 3, 3, &[0, 1, 2], &[0, 1, 2], &[1.0, 1.0, 1.0]);

#[test]
fn velocities_of_a_global_problem_are_eliminated() {
    let vectors: &[(&str, &[f64])] = &[("f", &[3.0, 0.0, 8.0]), ("w", &[0.0, 0.5, 0.0]), ("mu", &[0.5])];
    let found = read_fclib(file("fclib_global", &[("M", MASS), ("H", UNIT)], vectors)).unwrap().problem;
    let close = |a: f64, b: f64| (a - b).abs() < 1e-15;
    let third = 1.0 / 3.0;
    for (i, row) in
        [[2.0 * third, -third, 0.0], [-third, 2.0 * third, 0.0], [0.0, 0.0, 0.25]].iter().enumerate()
    {
        assert!(row.iter().enumerate().all(|(j, &x)| close(found.w().at(i, j), x)));
    }
    // M⁻¹ f = (2, -1, 2).
    assert!([2.0, -0.5, 2.0].iter().zip(found.q()).all(|(&a, &b)| close(a, b)), "{:?}", found.q());
}

#[test]
fn joints_of_a_global_problem_are_locked_rows_after_the_contacts() {
    let vectors: &[(&str, &[f64])] = &[("f", &[0.0; 3]), ("w", &[0.0; 3]), ("b", &[7.0]), ("mu", &[0.5])];
    let joint: Stored = (3, 1, 1, &[0], &[2], &[1.0]);
    let found = read_fclib(file("fclib_global", &[("M", MASS), ("H", UNIT), ("G", joint)], vectors)).unwrap();
    let laws: Vec<_> = found.problem.laws().collect();
    assert_eq!(laws, [(0, Law::Contact { mu: 0.5 }), (3, Law::LOCKED)]);
    let w = found.problem.w();
    assert_eq!([w.at(3, 3), w.at(3, 2), w.at(2, 3), w.at(3, 0)], [0.25, 0.25, 0.25, 0.0]);
    assert_eq!(found.problem.q()[3], 7.0);
}

#[test]
fn what_is_wrong_is_said() {
    let vectors: &[(&str, &[f64])] = &[("q", &[-1.0, 2.0, 3.0]), ("mu", &[0.5])];
    let local = |stored: Stored| file("fclib_local", &[("W", stored)], vectors);
    let joints = [("W", UNIT), ("V", UNIT), ("R", UNIT)];
    let global: &[(&str, &[f64])] = &[("f", &[0.0; 3]), ("w", &[0.0; 3]), ("mu", &[0.5])];
    let heavy: Stored = (3, 3, 1, &[0], &[0], &[-1.0]);
    let cases = [
        (b"not HDF5".to_vec(), "no HDF5"),
        (file("fclib_other", &[], &[]), "neither"),
        (file("fclib_local", &joints, vectors), "joints"),
        (local((3, 3, -3, &[], &[], &[])), "W/nz must be at least -2"),
        (local((3, -3, 0, &[], &[], &[])), "W/n must not be negative"),
        (local((3, 3, 1, &[3], &[0], &[1.0])), "outside"),
        (local((3, 3, 5, &[0], &[0], &[1.0])), "missing"),
        (local((3, 3, -1, &[0, 2, 1, 1], &[0, 1], &[1.0, 1.0])), "must rise"),
        (local((2, 2, 1, &[0], &[0], &[1.0])), "as many rows"),
        (local((3, 3, 1, &[0], &[0], &[f64::NAN])), "not finite"),
        (local((i32::MAX, i32::MAX, 1, &[0], &[0], &[1.0])), "has 1 entries only"),
        (file("fclib_global", &[("M", heavy), ("H", UNIT)], global), "positive definite"),
        (file("fclib_global", &[("M", MASS), ("H", MASS)], &global[..2]), "mu can't be read"),
    ];
    for (bytes, what) in cases {
        let error = read_fclib(bytes).expect_err(what).to_string();
        assert!(error.contains(what), "{error:?} does not say {what:?}");
    }
    let whole = local(UNIT);
    assert!(read_fclib(whole.clone()).is_ok());
    for end in (0..whole.len()).step_by(7) {
        // A truncated file may still be complete except for data that is not read.
        let _ = read_fclib(whole[..end].to_vec());
    }
}
