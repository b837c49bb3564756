//! Steps, and the way back.

use super::*;

fn hashes(page: &mut Page, steps: u32) -> Vec<Value> {
    (0..steps).map(|_| page.steps(1)["hash"].clone()).collect()
}

#[test]
fn steps_back_and_forth_are_the_same_bits() {
    let mut page = Page::open("talk");
    let mut all = vec![page.steps(0)["hash"].clone()];
    all.extend(hashes(&mut page, 60));
    let header = page.command(json!({ "do": "back", "steps": 20 }));
    assert_eq!((&header["step"], &header["hash"]), (&json!(40), &all[40]));
    assert_eq!((&header["past"], &header["future"]), (&json!(40), &json!(20)));
    assert!((header["time"].as_f64().unwrap() - 40.0 / 60.0).abs() < 1e-6);
    for step in [60, 3, 59, 0] {
        let header = page.command(json!({ "do": "seek", "step": step }));
        assert_eq!((&header["step"], &header["hash"]), (&json!(step), &all[step]));
    }
    // From the start again.
    assert_eq!(hashes(&mut page, 60), all[1..]);
    // As far back as it goes.
    assert_eq!(page.command(json!({ "do": "back", "steps": 1_000_000 }))["step"], 0);
    assert_eq!(page.command(json!({ "do": "back", "steps": 1 }))["hash"], all[0]);
}

/// Gears and spins of wheels are beside the world: stepping back brings them back too. At full throttle the
/// gears have changed in between.
#[test]
fn a_car_goes_the_same_way_after_a_step_back() {
    let mut page = Page::open("ray_car");
    page.command(json!({ "do": "controls", "forward": 1.0, "right": 0.2, "jump": false, "action": false }));
    let before = page.steps(60)["hash"].clone();
    let first = hashes(&mut page, 240);
    for _ in 0..2 {
        assert_eq!(page.command(json!({ "do": "seek", "step": 60 }))["hash"], before);
        assert_eq!(hashes(&mut page, 240), first);
    }
}

#[test]
fn bodies_that_came_and_went_are_as_they_were() {
    let mut page = Page::open("dominoes");
    let mut all = vec![page.steps(0)];
    let look = json!({ "origin": [0, 40, 10], "direction": [0, -1, 0] });
    for step in 0..40 {
        let mut commands = Vec::new();
        if step % 7 == 3 {
            commands.push(json!({ "do": "spawn", "shape": "hull", "position": [0, 20, 10] }));
        }
        if step % 14 == 12 {
            commands
                .push(json!({ "do": "remove", "origin": look["origin"], "direction": look["direction"] }));
        }
        if step == 20 {
            commands.push(json!({ "do": "spawn", "shape": "ragdoll", "position": [5, 5, 5] }));
        }
        all.push(page.ask(&json!({ "commands": commands, "steps": 1, "want": ["ledger"] })));
    }
    let bodies = |header: &Value| Page::count(header, "bodies");
    assert!(bodies(&all[25]) > bodies(&all[20]) + 10);
    assert!((0..40).any(|step| bodies(&all[step + 1]) < bodies(&all[step])));
    for step in (0..40).rev().chain([17, 39, 5]) {
        let header = page.command(json!({ "do": "seek", "step": step }));
        // What was made before the step that followed is in it.
        let expected = &all[step as usize];
        let changed = step % 7 == 3 || step % 14 == 12 || step == 20;
        assert_eq!(header["hash"] == expected["hash"], !changed, "{step}");
        // As many poses as shapes: the page is told that they are others.
        let header = page.ask(&json!({ "want": ["scene", "ledger"] }));
        let (poses, instances) = (page.numbers(&header, "poses"), page.numbers(&header, "instances"));
        assert_eq!(poses.len(), 4 * instances.len());
        assert_eq!(instances.len() as u64 / 2, bodies(&header));
    }
    // The same steps lead to the same bits, with what was done before them.
    page.command(json!({ "do": "seek", "step": 20 }));
    let header = page.steps(1);
    assert_eq!(header["hash"], all[21]["hash"]);
    assert_eq!(header["future"], 0);
}

#[test]
fn a_change_ends_what_was_ahead() {
    let mut page = Page::open("dominoes");
    page.steps(10);
    page.command(json!({ "do": "back", "steps": 5 }));
    let header = page.command(json!({ "do": "spawn", "shape": "box", "position": [0, 5, 0] }));
    assert_eq!((&header["step"], &header["future"]), (&json!(5), &json!(0)));
    assert!(page.refused(json!({ "do": "seek", "step": 9 })).contains("not kept"));
    let there = page.steps(0)["hash"].clone();
    page.steps(4);
    assert_eq!(page.command(json!({ "do": "back", "steps": 4 }))["hash"], there);
}

#[test]
fn settings_and_the_length_of_steps_are_those_of_the_time() {
    let mut page = Page::open("dominoes");
    page.steps(5);
    page.command(json!({ "do": "settings", "substeps": 8, "dt": 0.005 }));
    page.steps(5);
    let back = page.command(json!({ "do": "back", "steps": 6 }));
    assert_eq!(back["settings"]["substeps"], 4);
    assert!((back["dt"].as_f64().unwrap() - 1.0 / 60.0).abs() < 1e-6);
}

#[test]
fn a_restart_is_the_start() {
    let mut page = Page::open("windmill");
    let start = page.steps(0);
    let later = page.steps(30);
    let again = page.command(json!({ "do": "restart" }));
    assert_eq!((&again["hash"], &again["time"]), (&start["hash"], &json!(0.0)));
    assert!(again["opened"].as_u64() > later["opened"].as_u64());
    assert_eq!(again["past"], 0);
    assert_eq!(page.steps(30)["hash"], later["hash"]);
}
