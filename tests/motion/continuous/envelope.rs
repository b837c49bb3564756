//! Every cell of the published envelope that is green stays green: `docs/envelope/backstop.jsonl` has the
//! verdicts.

use backstop::Settings;
use backstop_lab::envelope::{Cell, Figure, SECONDS, Verdict};
use std::collections::HashMap;
use std::sync::Mutex;
use std::sync::atomic::{AtomicUsize, Ordering};

/// The verdicts that are published.
fn published() -> HashMap<String, Verdict> {
    let file = concat!(env!("CARGO_MANIFEST_DIR"), "/../docs/envelope/backstop.jsonl");
    let text = std::fs::read_to_string(file).unwrap();
    let run = |line: &str| {
        let run: serde_json::Value = serde_json::from_str(line).unwrap();
        let verdict = serde_json::from_value(run["figures"][0]["verdict"].clone()).unwrap();
        (run["cell"].as_str().unwrap().to_owned(), verdict)
    };
    text.lines().map(run).collect()
}

/// The figures of each cell that is published as stable, watched for so long, on two threads.
fn green(seconds: f64) -> Vec<(String, Vec<Figure>)> {
    let published = published();
    let cells: Vec<_> = Cell::all()
        .into_iter()
        .filter(|cell| published.get(&cell.name()) == Some(&Verdict::Stable))
        .collect();
    let (next, found) = (AtomicUsize::new(0), Mutex::new(Vec::new()));
    std::thread::scope(|scope| {
        for _ in 0..2 {
            scope.spawn(|| {
                while let Some(cell) = cells.get(next.fetch_add(1, Ordering::Relaxed)) {
                    let figures = cell.run(&Settings::default(), seconds).unwrap();
                    found.lock().unwrap().push((cell.name(), figures));
                }
            });
        }
    });
    found.into_inner().unwrap()
}

#[test]
fn the_published_map_has_every_cell() {
    let published = published();
    let missing: Vec<_> =
        Cell::all().iter().map(Cell::name).filter(|name| !published.contains_key(name)).collect();
    assert!(missing.is_empty() && published.len() >= 400, "{missing:?}");
}

#[test]
fn green_cells_hold_in_their_first_seconds() {
    // A cell that is not lost within a minute is not in three seconds; but some figures count only when
    // bodies have settled.
    let settled = ["depth", "overlap", "stop", "restless"];
    let lost = |figures: &[Figure]| {
        figures.iter().any(|f| f.verdict == Verdict::Lost && !settled.contains(&f.measure))
    };
    let worse: Vec<_> = green(SECONDS / 20.0).into_iter().filter(|(_, figures)| lost(figures)).collect();
    assert!(worse.is_empty(), "{worse:#?}");
}

/// Five minutes on two cores.
#[test]
#[ignore = "long: run in release"]
fn green_cells_are_green() {
    let worse: Vec<_> =
        green(SECONDS).into_iter().filter(|(_, figures)| figures[0].verdict != Verdict::Stable).collect();
    assert!(worse.is_empty(), "{worse:#?}");
}

/// Lengths and gravity by the same factor: the same motion in units of the scene, by dimensional analysis.
/// Factors that are powers of two change no rounding, so that even a heap and tumbling bodies are alike after
/// ten seconds: the causes of a difference are a length, a speed or a mass that the engine compares with a
/// number of its own. Bullets are alike to the last bit down to a sixteenth: below, squares of impulses that
/// are nearly zero leave the range of single precision, and bodies that whirl in a corner amplify that.
#[test]
fn a_scene_scaled_with_its_gravity_is_the_same_run() {
    use backstop::World;
    use backstop_lab::envelope::{Axis, Conditions, Trial};
    for trial in Trial::ALL {
        let run = |size: f32| {
            let conditions = Conditions { size, gravity: size, ..Conditions::default() };
            let cell = Cell { trial, axis: Axis::Size, label: String::new(), conditions };
            let scene = cell.scene();
            let settings = Settings::default().with_gravity(scene.gravity).with_length_unit(size);
            let mut world = World::new(settings).unwrap();
            let bodies = scene.add_to(&mut world).unwrap().bodies;
            for _ in 0..600 {
                world.step(1.0 / 60.0).unwrap();
            }
            bodies.iter().map(|&body| world.position(body).unwrap() / f64::from(size)).collect::<Vec<_>>()
        };
        let metre = run(1.0);
        let least = if trial.name() == "bullets" { 1.0 / 16.0 } else { 1.0 / 64.0 };
        for size in [least, 64.0] {
            let apart = metre.iter().zip(run(size)).map(|(a, b)| (*a - b).length()).fold(0.0, f64::max);
            assert!(apart <= 1e-4, "{} at {size}: {apart}", trial.name());
        }
    }
}

/// Box3D's own test asks a stack at 1e7 m to be within 1 mm of the one at the origin. Positions are doubles,
/// with 2 nm between them there, and pairs are worked on in a frame of their own.
#[test]
fn a_tower_and_a_house_of_cards_stand_alike_however_far_from_the_origin() {
    use backstop::World;
    use backstop_lab::envelope::{Axis, Conditions, Trial};
    for trial in [Trial::Stack, Trial::CardHouse] {
        let run = |distance: f64| {
            let conditions = Conditions { distance, ..Conditions::default() };
            let scene = Cell { trial, axis: Axis::Distance, label: String::new(), conditions }.scene();
            let mut world = World::new(Settings::default().with_gravity(scene.gravity)).unwrap();
            let bodies = scene.add_to(&mut world).unwrap().bodies;
            let start: Vec<_> = bodies.iter().map(|&body| world.position(body).unwrap()).collect();
            for _ in 0..1200 {
                world.step(1.0 / 60.0).unwrap();
            }
            bodies
                .iter()
                .zip(start)
                .map(|(&body, start)| world.position(body).unwrap() - start)
                .collect::<Vec<_>>()
        };
        let here = run(0.0);
        for distance in [1e3, 1e4, 1e5, 1e6, 1e7] {
            let apart = here.iter().zip(run(distance)).map(|(a, b)| (*a - b).length()).fold(0.0, f64::max);
            assert!(apart < 1e-3, "{} at {distance} m: {apart} m", trial.name());
        }
    }
}
