//! Measured impacts.

use super::*;

const HEADINGS: &str = "rx_m,ry_m,vx_m_s,vy_m_s,w_rad_s,vx_after_m_s,vy_after_m_s,w_after_rad_s";

fn file(name: &str, lines: &str) -> String {
    let path = scratch(name);
    std::fs::write(&path, format!("{HEADINGS}\n{lines}")).expect("a file");
    path.to_str().expect("a path").into()
}

/// A ball of 20 mm that grips keeps 5/7 of its speed along the plate and half of that across; at the second
/// line the measured speed along it is 0.6 m/s more.
#[test]
fn impacts_are_compared_with_measured_ones() {
    let lines = "0,-0.02,0.7,-2,0,0.5,1,-25\n0,-0.02,0.7,-2,0,1.1,1,-25\n";
    let path = file("impacts.csv", lines);
    let ball = ["--gyration", "0.012649110640673518", "--friction", "0.5", "--restitution", "0.5"];
    for how in [&[][..], &["--law", "newton"], &["--law", "stronge"], &["--solver", "impulse-based"]] {
        let document = document(&backstop(&[&["impacts", &path, "--json"][..], &ball, how].concat()));
        has_keys(&document, &["impacts", "mean", "median", "each"]);
        assert_eq!(document["impacts"], 2);
        let each = document["each"].as_array().expect("a list");
        for (one, off) in each.iter().zip([0.0, 0.6]) {
            has_keys(one, &["motion", "velocity_m_s", "spin_rad_s"]);
            let is = |name: &str, value: f64| (one[name].as_f64().expect("a number") - value).abs() < 2e-3;
            assert!(is("velocity_m_s", off) && is("motion", off / 0.7f64.hypot(2.0)), "{how:?}: {one}");
        }
        assert!((document["mean"]["velocity_m_s"].as_f64().expect("a number") - 0.3).abs() < 2e-3);
    }
    let text = backstop(&[&["impacts", &path][..], &ball].concat());
    let text = String::from_utf8_lossy(&text.stdout).into_owned();
    assert!(text.starts_with("2 impacts: ") && text.contains("0.30 m/s"), "{text}");
}

#[test]
fn files_without_impacts_are_refused() {
    let refused = |name: &str, lines: &str, more: &[&str], reason: &str| {
        let path = file(name, lines);
        super::refused(&[&["impacts", &path][..], more].concat(), 1, reason);
    };
    let good = "0,-0.02,0.7,-2,0,0.5,1,-25\n";
    refused("none.csv", "", &[], "there is no impact in");
    refused("few.csv", "1,2,3\n", &[], "3 fields");
    refused("seven.csv", "1,2,3,4,5,6,7,\n", &[], "line 2: ");
    refused("away.csv", &format!("{good}0,-0.02,0,2,0,0,2,0\n"), &[], "line 3 is refused");
    refused("nan.csv", "0,-0.02,0.7,-2,0,nan,1,-25\n", &["--law", "poisson"], "must be finite");
    refused("good.csv", good, &["--gyration", "0"], "radius of gyration");
    refused("good.csv", good, &["--restitution", "2", "--law", "newton"], "restitution must be in 0..=1");
    super::refused(&["impacts", "nowhere.csv"], 1, "can't read nowhere.csv");
}
