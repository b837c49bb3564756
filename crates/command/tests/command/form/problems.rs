//! Problems of the lab: solved, measured, refused.

use super::*;

/// A ball of 2 kg that falls at 3 m/s and slides at 4, mu = 0.5: 6 N s stop it, 3 N s brake it.
const BALL: &str = "3\n1\n0\n3\n3\n3 3\n0.5 0 0\n0 0.5 0\n0 0 0.5\n-3 4 0\n0.5\nfree text";

#[test]
fn a_problem_is_solved_as_is_promised() {
    let file = scratch("ball.dat");
    std::fs::write(&file, BALL).expect("a file");
    let file = file.to_str().expect("a name");
    let found = document(&backstop(&["solve", file, "--method", "gs-cone", "--json"]));
    has_keys(&found, &["status", "iterations", "pivots", "residual", "time_us", "solution"]);
    assert_eq!(
        (&found["status"], &found["iterations"], &found["pivots"]),
        (&Value::from("solved"), &Value::from(1), &Value::from(0))
    );
    numbers(&found["solution"], 3);
    let close = |i: usize, x: f64| (found["solution"][i].as_f64().expect("a number") - x).abs() < 1e-12;
    assert!(close(0, 6.0) && close(1, -3.0) && close(2, 0.0), "{found}");

    // One round of ADMM is not enough.
    let limited = backstop(&["solve", file, "--method", "admm", "--iterations", "1", "--json"]);
    assert_eq!(limited.status.code(), Some(3));
    let limited: Value = serde_json::from_slice(&limited.stdout).expect("one JSON document");
    assert_eq!(limited["status"], "limit");

    let text = backstop(&["solve", file, "--method", "pgs"]);
    let text = String::from_utf8_lossy(&text.stdout);
    assert!(text.starts_with("pgs: solved\n") && text.contains("median of 5 runs"), "{text}");
    let list = backstop(&["solve", "--list"]);
    assert!(String::from_utf8_lossy(&list.stdout).contains("nncg"));
}

/// A contact whose body no impulse moves, and a ball that rolls: the one has no solution, the other five
/// numbers a contact.
#[test]
fn what_has_no_solution_is_said_and_rolling_is_solved() {
    let write = |name: &str, text: &str| {
        let file = scratch(name);
        std::fs::write(&file, text).expect("a file");
        file.to_str().expect("a name").to_owned()
    };
    let fixed = write("fixed.dat", "3 1 0 3 3 3 3  0 0 0 0 0 0 0 0 0  -1 0 0  0.5");
    let rolling =
        "5 1 0 5 5 5 5  1 0 0 0 0  0 1 0 0 0  0 0 1 0 0  0 0 0 2 0  0 0 0 0 2  -6 2 0 0 20  0.5 0.1";
    let rolling = write("rolling.dat", rolling);
    for method in ["lemke", "apgd", "pgs"] {
        let found = backstop(&["solve", &fixed, "--method", method, "--json"]);
        assert_eq!(found.status.code(), Some(3));
        let found: Value = serde_json::from_slice(&found.stdout).expect("one JSON document");
        assert_eq!(found["status"], "no_solution", "{method}");
        numbers(&document(&backstop(&["solve", &rolling, "--method", method, "--json"]))["solution"], 5);
    }
}

#[test]
fn cases_tell_what_they_are_off_by() {
    let asked =
        ["cases", "--case", "cradle-3", "--hz", "60,120", "--method", "backstop", "--method", "gs-cone"];
    let document = document(&backstop(&[&asked[..], &["--json"]].concat()));
    let runs = document.as_array().expect("a list");
    assert_eq!(runs.len(), 4);
    for run in runs {
        has_keys(
            run,
            &["case", "unit", "method", "setting", "expected", "measured", "error", "bar", "within"],
        );
        assert_eq!((&run["case"], &run["within"]), (&Value::from("cradle-3"), &Value::from(true)));
    }
    let text = backstop(&asked);
    let text = String::from_utf8_lossy(&text.stdout);
    assert!(text.contains("\nbackstop ") && text.contains("\ngs-cone "), "{text}");
    let list = backstop(&["cases", "--list"]);
    assert!(String::from_utf8_lossy(&list.stdout).contains("v0² / (49 mu g)"));
    refused(&["cases", "--case", "guess"], 1, "no case has such a name");
    refused(&["cases", "--method", "guess"], 2, "must be backstop or one of");
}

#[test]
fn problems_that_are_wrong_are_refused() {
    let write = |name: &str, bytes: &[u8]| {
        let file = scratch(name);
        std::fs::write(&file, bytes).expect("a file");
        file.to_str().expect("a name").to_owned()
    };
    let cut = write("cut.dat", &BALL.as_bytes()[..40]);
    refused(&["solve", &cut, "--method", "pgs"], 1, "line ");
    let hdf5 = write("broken.hdf5", b"\x89HDF\r\n\x1a\n and no more");
    refused(
        &["solve", &hdf5, "--method", "pgs"],
        1,
        if cfg!(feature = "hdf5") { "HDF5" } else { "feature `hdf5`" },
    );
    refused(&["solve", &cut, "--method", "guess"], 2, "must be one of");
    refused(&["solve", &cut], 2, "--method");
    refused(&["solve", "no such file", "--method", "pgs"], 1, "can't read");
}

/// The problem that is written is one that `solve` reads, and measuring changes no bit.
#[test]
fn a_run_says_how_accurate_it_is_and_writes_the_problem_of_a_step() {
    let file = scratch("problem.dat");
    let path = file.to_str().expect("a name");
    let run = ["run", "scenes/tower.gltf", "--steps", "10", "--json"];
    let plain = document(&backstop(&run));
    assert!(plain["accuracy"].is_null());
    let with = [&run[..], &["--accuracy", "--export-problem", "10", path]].concat();
    let measured = document(&backstop(&with));
    assert_eq!(measured["hash"], plain["hash"]);
    has_keys(&measured["accuracy"], &["figures", "islands", "laws", "soft"]);
    let figures = measured["accuracy"]["figures"].as_array().expect("a list");
    assert!(figures.iter().any(|one| one["name"] == "residual" && one["unit"] == "m/s"));
    for figure in figures {
        has_keys(figure, &["name", "unit", "median", "worst", "worst_step"]);
        assert!(figure["median"].is_f64() && figure["worst"].is_f64(), "{figure}");
    }
    let text = std::fs::read_to_string(&file).expect("it was written");
    assert!(text.starts_with("3\n"), "three rows a contact");
    let solved =
        document(&backstop(&["solve", path, "--method", "gs-cone", "--tolerance", "1e-3", "--json"]));
    assert!(solved.is_object());
    // From its own solution there is nothing left to do.
    let start = scratch("start.json");
    std::fs::write(&start, solved.to_string()).expect("a document");
    let start = start.to_str().expect("a name");
    let again = ["solve", path, "--method", "gs-cone", "--tolerance", "1e-3", "--json", "--guess", start];
    let again = document(&backstop(&again));
    assert!(again["iterations"].as_u64() < solved["iterations"].as_u64(), "{again}");
    let other = scratch("other.dat");
    std::fs::write(&other, BALL).expect("a problem");
    let other = other.to_str().expect("a name");
    refused(&["solve", other, "--method", "pgs", "--guess", start], 1, "the solution of another problem");
    refused(&["solve", other, "--method", "pgs", "--guess", other], 1, "can't start from");
    refused(&["run", "tall_stack", "--steps", "5", "--export-problem", "6", path], 1, "step 6 of 5");
    refused(&["run", "tall_stack", "--export-problem", "none", path], 1, "the number of a step");
}
