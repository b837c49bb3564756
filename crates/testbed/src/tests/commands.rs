//! Every command but those of the hand and of time.

use super::*;
use backstop::Settings;

/// What makes bodies, by the bodies that each makes.
const SHAPES: [(&str, u64); 9] = [
    ("box", 1),
    ("sphere", 1),
    ("capsule", 1),
    ("tapered_capsule", 1),
    ("cylinder", 1),
    ("tapered_cylinder", 1),
    ("cone", 1),
    ("hull", 1),
    ("ragdoll", 11),
];

#[test]
fn every_shape_is_made_and_falls() {
    for (shape, bodies) in SHAPES {
        let mut page = Page::open("dominoes");
        let before = Page::count(&page.steps(0), "bodies");
        let header =
            page.command(json!({ "do": "spawn", "shape": shape, "position": [20, 3, 20], "size": 0.8 }));
        assert_eq!(Page::count(&header, "bodies"), before + bodies, "{shape}");
        page.steps(20);
        // Half of 9.81 m/s² times the square of 1/3 s is 0.55 m.
        let middle = page.made(bodies as usize).iter().map(|at| at[1]).sum::<f32>() / bodies as f32;
        assert!((middle - 2.5).abs() < 0.3, "{shape} at {middle}");
        // It comes to rest on the ground, above it.
        page.steps(300);
        assert!(page.made(bodies as usize).iter().all(|at| at[1] > 0.0), "{shape}");
    }
}

#[test]
fn every_shape_is_shot() {
    for (shape, bodies) in SHAPES {
        let mut page = Page::open("dominoes");
        let [from, ahead] = [[20, 5, 20], [2, 0, 0]];
        let shot = json!({ "do": "shoot", "origin": from, "direction": ahead, "speed": 30, "shape": shape });
        let before = Page::count(&page.steps(0), "bodies");
        let header = page.ask(&json!({ "commands": [shot], "steps": 30, "want": ["ledger"] }));
        assert_eq!(Page::count(&header, "bodies"), before + bodies);
        // Half a second at 30 m/s.
        let made = page.made(bodies as usize).iter().map(|at| at[0]).sum::<f32>() / bodies as f32;
        assert!((made - 35.0).abs() < 0.5, "{shape} at {made}");
    }
    let mut page = Page::open("dominoes");
    page.command(json!({ "do": "shoot", "origin": [20, 5, 20], "direction": [1, 0, 0], "speed": 30 }));
}

#[test]
fn what_is_seen_is_inspected_and_removed() {
    let mut page = Page::open("talk");
    let above = |x: f32| json!({ "origin": [x, 60, 0], "direction": [0, -1, 0] });
    let with = |name: &str, mut sight: Value| {
        sight["do"] = name.into();
        sight
    };
    page.command(json!({ "do": "spawn", "shape": "box", "position": [40, 50, 0], "size": 1 }));
    let header = page.command(with("inspect", above(40.0)));
    let seen = &header["inspected"];
    assert_eq!(
        (&seen["kind"], &seen["shape"], &seen["mass"]),
        (&json!("dynamic"), &json!("box"), &json!(1000.0))
    );
    assert_eq!(seen["point"], json!([40.0, 50.5, 0.0]));
    // It is told of in each frame, with the names of the scene, until it is gone or something else is seen.
    assert!(page.steps(5)["inspected"]["velocity"][1].as_f64().unwrap() < -0.5);
    let bodies = Page::count(&page.steps(0), "bodies");
    let header = page.command(with("remove", above(40.0)));
    assert_eq!((&header["inspected"], Page::count(&header, "bodies")), (&Value::Null, bodies - 1));
    // The ground is static: it is seen, and stays.
    let header = page.command(with("inspect", above(40.0)));
    assert_eq!(
        (&header["inspected"]["kind"], &header["inspected"]["body"]),
        (&json!("static"), &json!("terrain"))
    );
    assert_eq!(Page::count(&page.command(with("remove", above(40.0))), "bodies"), bodies - 1);
    let up = json!({ "do": "inspect", "origin": [40, 60, 0], "direction": [0, 1, 0] });
    assert_eq!(page.command(up)["inspected"], Value::Null);
}

#[test]
fn an_explosion_pushes_what_is_near() {
    let mut page = Page::open("dominoes");
    let spawn =
        |x: f32| json!({ "do": "spawn", "shape": "sphere", "position": [x, 30.0, 20.0], "size": 0.5 });
    page.ask(&json!({ "commands": [spawn(11.0), spawn(6.0)] }));
    let explode = json!({ "do": "explode", "position": [10, 30, 20], "radius": 3, "impulse": 2400 });
    page.ask(&json!({ "commands": [explode], "steps": 30 }));
    let x: Vec<f32> = page.made(2).iter().map(|at| at[0]).collect();
    // One is 0.75 m away of 3: three quarters of 2,400 N s/m² on the 0.196 m² of a ball of 65.4 kg, for half
    // a second. The other is beyond.
    assert!((x[0] - 13.7).abs() < 0.05 && x[1] == 6.0, "{x:?}");
}

#[test]
fn settings_are_set_by_their_names_and_outlive_a_restart() {
    let mut page = Page::open("dominoes");
    let now = page.steps(0)["settings"].clone();
    for field in Settings::FIELDS {
        let command = json!({ "do": "settings", field.name: now[field.name] });
        assert_eq!(page.command(command)["settings"], now, "{}", field.name);
    }
    let header = page.command(
        json!({ "do": "settings", "substeps": 7, "budget": 50_000_000, "continuous": "volume", "dt": 0.01,
            "gravity": [0, -1.5, 0] }),
    );
    let settings = &header["settings"];
    assert_eq!(settings["substeps"], 7);
    assert_eq!(settings["budget"], 50_000_000);
    assert_eq!(settings["continuous"], "volume");
    assert_eq!(settings["gravity"], json!([0.0, -1.5, 0.0]));
    let time = page.steps(10)["time"].as_f64().unwrap();
    assert!((time - 0.1).abs() < 1e-6, "{time}");
    let again = page.command(json!({ "do": "restart" }));
    assert_eq!((&again["settings"], &again["dt"], &again["step"]), (settings, &header["dt"], &json!(0)));
    // What is opened has its own settings.
    assert_eq!(page.command(json!({ "do": "open", "name": "dominoes" }))["settings"], now);
    assert_eq!(page.command(json!({ "do": "settings", "budget": null }))["settings"]["budget"], Value::Null);
}

#[test]
fn a_size_is_brought_into_its_range() {
    let mut page = Page::default();
    for (size, boxes) in [(json!(null), 78), (json!(4), 10), (json!(1), 6), (json!(1000), 820)] {
        let header = page.command(json!({ "do": "open", "name": "large_pyramid", "size": size }));
        assert_eq!(Page::count(&header, "bodies"), boxes + 1);
        assert_eq!(Page::count(&page.command(json!({ "do": "restart" })), "bodies"), boxes + 1);
    }
}

#[test]
fn controls_reach_the_sample() {
    let mut page = Page::open("dominoes");
    page.command(json!({ "do": "controls", "forward": 5, "right": -0.5, "jump": true }));
    page.command(json!({ "do": "controls" }));
}
