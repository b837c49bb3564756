//! Bodies in the hand.

use super::*;

/// A box of half a metre which rests on the ground, seized at its top.
fn held() -> Page {
    let mut page = Page::open("dominoes");
    let spawn = json!({ "do": "spawn", "shape": "box", "position": [20, 0.25, 20], "size": 0.5 });
    page.ask(&json!({ "commands": [spawn], "steps": 30 }));
    let header = page.command(json!({ "do": "grab", "origin": [20, 10, 20], "direction": [0, -2, 0] }));
    let grabbed: Vec<f64> = serde_json::from_value(header["grabbed"].clone()).unwrap();
    assert!((grabbed[1] - 0.5).abs() < 1e-2 && (grabbed[1] - grabbed[4]).abs() < 1e-6, "{grabbed:?}");
    page
}

#[test]
fn a_box_is_lifted_and_held() {
    let mut page = held();
    page.command(json!({ "do": "drag", "to": [20, 3, 20] }));
    let header = page.steps(120);
    // Its middle is a quarter of a metre below the hand, and its weight stretches the spring by g / (2 π f)².
    let [x, y, z] = page.made(1)[0];
    assert!((x - 20.0).abs() < 0.01 && (y - 2.74).abs() < 0.03 && (z - 20.0).abs() < 0.01, "{x} {y} {z}");
    assert_eq!(header["grabbed"][4], 3.0);
    // Let go, it falls.
    let header = page.ask(&json!({ "commands": [{ "do": "release" }], "steps": 20 }));
    assert_eq!(header["grabbed"], Value::Null);
    assert!(page.made(1)[0][1] < 2.4);
}

#[test]
fn a_throw_keeps_the_velocity() {
    let mut page = held();
    page.command(json!({ "do": "drag", "to": [20, 4, 20] }));
    page.steps(90);
    // The hand moves at 6 m/s.
    for step in 1..=30u8 {
        let drag = json!({ "do": "drag", "to": [20.0 + 0.1 * f32::from(step), 4, 20] });
        page.ask(&json!({ "commands": [drag], "steps": 1 }));
    }
    page.command(json!({ "do": "release" }));
    let before = page.made(1)[0];
    page.steps(30);
    let after = page.made(1)[0];
    let speed = (after[0] - before[0]) / 0.5;
    assert!((5.0..7.0).contains(&speed), "{speed} m/s");
}

#[test]
fn what_sleeps_is_woken_and_what_is_static_is_not_seized() {
    let mut page = Page::open("large_pyramid");
    page.ask(&json!({ "commands": [{ "do": "settings", "sleeping": true }], "steps": 120 }));
    assert_eq!(Page::count(&page.steps(0), "asleep"), 78);
    let header = page.command(json!({ "do": "grab", "origin": [0, 50, 0], "direction": [0, -1, 0] }));
    assert_eq!(Page::count(&header, "asleep"), 0);
    page.command(json!({ "do": "drag", "to": [0, 20, 0] }));
    let header = page.steps(60);
    let top = page.numbers(&header, "poses").chunks(8).map(|pose| pose[1]).fold(0.0, f32::max);
    assert!(top > 18.0, "{top}");
    page.command(json!({ "do": "release" }));
    let header = page.command(json!({ "do": "grab", "origin": [100, 50, 0], "direction": [0, -1, 0] }));
    assert_eq!(header["grabbed"], Value::Null);
    let header = page.command(json!({ "do": "grab", "origin": [0, 50, 0], "direction": [0, 1, 0] }));
    assert_eq!(header["grabbed"], Value::Null);
    // With an empty hand nothing is dragged.
    page.command(json!({ "do": "drag", "to": [0, 1e300, 0] }));
}

#[test]
fn a_step_back_ends_a_grab_and_comes_to_the_same_bits() {
    let mut page = held();
    page.command(json!({ "do": "drag", "to": [20, 3, 20] }));
    let mut all = Vec::new();
    for _ in 0..20 {
        all.push(page.steps(1)["hash"].clone());
    }
    let header = page.command(json!({ "do": "back", "steps": 10 }));
    assert_eq!((&header["hash"], &header["grabbed"]), (&all[9], &Value::Null));
    let bodies = Page::count(&header, "bodies");
    // The page drags on before it knows.
    page.command(json!({ "do": "drag", "to": [20, 9, 20] }));
    let header = page.steps(1);
    // The hand is gone, and the box falls.
    assert_eq!(Page::count(&header, "bodies"), bodies - 1);
    assert_ne!(header["hash"], all[10]);
    page.steps(120);
    assert!(page.made(1)[0][1] < 0.3);
    // A hand that is too far away is refused, and still holds.
    let mut page = held();
    assert!(page.refused(json!({ "do": "drag", "to": [0, 1e300, 0] })).contains("position"));
    assert_ne!(page.steps(1)["grabbed"], Value::Null);
}
