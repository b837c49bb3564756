//! `cargo backstop trade` keeps its promises: errors that are the same however a sweep is cut up or stopped,
//! and a pick that keeps its tolerance when it is run again.
use backstop::glam::{DVec3, Quat, Vec3};
use backstop::{Axes, Axis, BodyDesc, Frame, Geometry, Limit, Motion, ShapeDesc};
use backstop_scene::{Scene, SceneJoint, write_scene};
use serde_json::Value;
use std::path::PathBuf;
use std::process::{Command, Output};

fn backstop(arguments: &[&str]) -> Output {
    Command::new(env!("CARGO_BIN_EXE_backstop"))
        .args(arguments)
        .current_dir(env!("CARGO_TARGET_TMPDIR"))
        .output()
        .expect("the command starts")
}

pub(crate) fn document(arguments: &str) -> Value {
    let output = backstop(&arguments.split_whitespace().collect::<Vec<_>>());
    assert!(output.status.success(), "{arguments}: {}", String::from_utf8_lossy(&output.stderr));
    serde_json::from_slice(&output.stdout).expect("one JSON document")
}

fn refused(arguments: &str, reason: &str) {
    let output = backstop(&arguments.split_whitespace().collect::<Vec<_>>());
    let errors = String::from_utf8_lossy(&output.stderr);
    assert!(!output.status.success() && errors.contains(reason), "{arguments}: {errors}");
}

/// A file of this test run that is not there yet.
pub(crate) fn scratch(name: &str) -> String {
    let folder = PathBuf::from(env!("CARGO_TARGET_TMPDIR")).join("trade");
    std::fs::create_dir_all(&folder).expect("a folder for tests");
    let path = folder.join(name);
    drop(std::fs::remove_file(&path));
    path.to_str().expect("a path in UTF-8").into()
}

/// A small sweep: 9 cells.
const SMALL: &str = "--quick --seconds 0.2 --rounds 1 --reference-hz 480 --hz 30,60 --substeps 1,2 --iterations 1 \
                     --friction patch --quiet";

/// Errors of all cells, by their numbers.
fn errors(document: &Value) -> Vec<Value> {
    let cells = document["cells"].as_array().expect("cells");
    cells.iter().map(|cell| cell["errors"].clone()).collect()
}

/// Costs are the machine's and pick another front from run to run; with all of them equal there is one.
#[test]
fn the_document_is_that_of_its_description() {
    let found = document(&format!("trade tower_2 {SMALL} --json"));
    let keys: Vec<&str> = found.as_object().expect("an object").keys().map(String::as_str).collect();
    let expected = [
        "trade",
        "version",
        "scene",
        "frame_rate",
        "frames",
        "reference_hz",
        "reference_hash",
        "share",
        "uncertainty",
        "grid",
        "settings",
        "seconds",
        "error",
        "unit",
        "certain_to",
        "limits",
        "warning",
        "default",
        "front",
        "excluded",
        "picked",
        "rule",
        "axes",
        "cells",
    ];
    assert!(expected.iter().all(|key| keys.contains(key)) && keys.len() == expected.len(), "{keys:?}");
    // 2 rates, 2 numbers of substeps, discrete and segment, and the default with its 4 substeps.
    let cells = found["cells"].as_array().expect("cells");
    assert_eq!((cells.len(), &found["scene"], &found["unit"]), (9, &"tower_2".into(), &"body widths".into()));
    assert_eq!(found["default"]["cost_ratio"], 1.0);
    // No setting beats one on the front, and each other setting is beaten by one on the front.
    let point = |row: &Value| {
        let certain_to = found["certain_to"].as_f64().expect("a number");
        [
            row["cost_ratio"].as_f64().expect("a cost"),
            row["error"].as_f64().expect("an error").max(certain_to),
        ]
    };
    let front = found["front"].as_array().expect("a list");
    let beats = |a: &Value, b: &Value| (0..2).all(|i| point(a)[i] <= point(b)[i]) && a["cell"] != b["cell"];
    let kept = |cell: &&Value| cell["breaks"].as_array().is_some_and(Vec::is_empty);
    for cell in cells.iter().filter(kept) {
        let on_front = front.iter().any(|one| one["cell"] == cell["cell"]);
        assert_eq!(front.iter().any(|one| beats(one, cell)), !on_front, "{cell}");
    }
    // Two boxes at rest need nothing dear.
    let picked = &found["picked"];
    assert!(picked["cost_ratio"].as_f64() < Some(1.0), "{picked}");
    let error = |row: &Value| point(row)[1];
    assert!(error(picked) <= error(&found["default"]), "{picked}");
}

#[test]
fn shares_of_a_grid_are_merged_into_what_one_run_says() {
    let [all, one, two] = ["share-all.jsonl", "share-1.jsonl", "share-2.jsonl"].map(scratch);
    let whole = document(&format!("trade tower_2 {SMALL} --results {all} --json"));
    // One to a file, one to standard output.
    let first = format!("trade tower_2 {SMALL} --cell 1/2 --results {one}");
    assert!(backstop(&first.split_whitespace().collect::<Vec<_>>()).status.success());
    refused(&format!("trade --merge {one} --json"), "4 of 9 cells are missing");
    let second =
        backstop(&format!("trade tower_2 {SMALL} --cell 2/2").split_whitespace().collect::<Vec<_>>());
    std::fs::write(&two, &second.stdout).expect("a file");
    let merged = document(&format!("trade --merge {two} {one} --json"));
    assert_eq!(errors(&merged), errors(&whole));
    for name in ["reference_hash", "uncertainty", "share", "grid", "scene"] {
        assert_eq!(merged[name], whole[name], "{name}");
    }

    let three = scratch("share-of-another.jsonl");
    let other = format!("trade tower_3 {SMALL} --cell 1/2 --results {three}");
    assert!(backstop(&other.split_whitespace().collect::<Vec<_>>()).status.success());
    refused(&format!("trade --merge {one} {three}"), "it is of another sweep");
    refused(&format!("trade tower_2 {SMALL} --cell 1/2 --results {three}"), "its scene is \"tower_3\"");
}

/// A stop in the middle of a line leaves half of it.
#[test]
fn a_sweep_that_was_stopped_goes_on() {
    let results = scratch("stopped.jsonl");
    let arguments = format!("trade tower_2 {SMALL} --results {results} --json");
    let whole = document(&arguments);
    let text = std::fs::read_to_string(&results).expect("results");
    let lines: Vec<&str> = text.split_inclusive('\n').collect();
    // A header, errors of nine cells, times of nine.
    assert_eq!(lines.len(), 1 + 9 + 9);

    let half = lines[4].len() / 2;
    std::fs::write(&results, lines[..4].concat() + &lines[4][..half]).expect("results");
    let again = document(&arguments);
    assert_eq!(errors(&again), errors(&whole));
    let text = std::fs::read_to_string(&results).expect("results");
    assert!(text.starts_with(&lines[..4].concat()) && text.lines().count() == 1 + 9 + 9);

    // Complete: the same words, times included.
    assert_eq!(document(&arguments), again);

    // With other steps it is another sweep.
    refused(&format!("{arguments} --seconds 0.3"), "cannot be used multiple times");
    refused(&format!("trade tower_2 --quick --seconds 0.3 --results {results}"), "it is of another sweep");
    std::fs::write(&results, "nonsense\n").expect("results");
    refused(&arguments, "it holds something else");
    std::fs::write(&results, "{\"trade\": nonsense}\n").expect("results");
    refused(&arguments, "line 1 is no result of a trade");
}

/// A plank on a pivot, and a ball that falls on its end.
fn seesaw() -> Scene {
    let mut scene = ground("seesaw");
    let edge = ShapeDesc::new(Geometry::cuboid(0.1, 0.2, 0.5));
    scene.add("pivot", BodyDesc::fixed().with_position(DVec3::Y * 0.2).with_shape(edge));
    let plank = ShapeDesc::new(Geometry::cuboid(1.2, 0.05, 0.3));
    scene.add("plank", BodyDesc::dynamic().with_position(DVec3::Y * 0.45).with_shape(plank));
    let ball = ShapeDesc::new(Geometry::Sphere { radius: 0.15 });
    scene.add("ball", BodyDesc::dynamic().with_position(DVec3::new(0.9, 1.2, 0.0)).with_shape(ball));
    scene
}

/// Five dominoes and a ball that rolls into them.
fn dominoes() -> Scene {
    let mut scene = ground("dominoes");
    for i in 0..5 {
        let stone = ShapeDesc::new(Geometry::cuboid(0.04, 0.25, 0.12));
        let at = DVec3::new(0.3 * f64::from(i), 0.25, 0.0);
        scene.add("stone", BodyDesc::dynamic().with_position(at).with_shape(stone));
    }
    let ball = ShapeDesc::new(Geometry::Sphere { radius: 0.2 });
    let ball = BodyDesc::dynamic().with_position(DVec3::new(-0.5, 0.35, 0.0)).with_shape(ball);
    scene.add("ball", ball.with_velocity(Vec3::X * 2.5, Vec3::ZERO));
    scene
}

/// Three links that swing from level on hinges.
fn links() -> Scene {
    let mut scene = Scene::new("links");
    let mut bodies = vec![scene.add("anchor", BodyDesc::fixed())];
    for i in 0..3 {
        let link = ShapeDesc::new(Geometry::cuboid(0.25, 0.05, 0.1));
        let at = DVec3::X * (0.25 + 0.5 * f64::from(i));
        bodies.push(scene.add("link", BodyDesc::dynamic().with_position(at).with_shape(link)));
    }
    for pair in bodies.windows(2) {
        let ends = [if pair[0] == 0 { 0.0 } else { 0.25 }, -0.25].map(|x| {
            // The hinge turns about the frame's x: that is z of the links.
            Frame { position: Vec3::X * x, rotation: Quat::from_rotation_arc(Vec3::X, Vec3::Z) }
        });
        let limits = vec![
            Limit::lock(Motion::Linear, Axes::All),
            Limit::lock(Motion::Angular, Axes::Perpendicular(Axis::X)),
        ];
        let bodies = [pair[0], pair[1]];
        scene.joints.push(SceneJoint {
            name: "hinge".into(),
            bodies,
            frames: ends,
            limits,
            motors: vec![],
            collide: false,
        });
    }
    scene
}

fn ground(name: &str) -> Scene {
    let mut scene = Scene::new(name);
    let floor = ShapeDesc::new(Geometry::cuboid(5.0, 0.5, 5.0));
    scene.add("floor", BodyDesc::fixed().with_position(DVec3::Y * -0.5).with_shape(floor));
    scene
}

/// Three scenes that nothing was tuned for. Expected: the setting that is picked has an error within the
/// tolerance, it has the very same error when its file is measured again, and `run` takes it.
#[test]
fn what_is_picked_keeps_its_tolerance_when_it_is_run_again() {
    let scenes = [(seesaw(), "trajectory", 0.05), (dominoes(), "heap", 0.8), (links(), "trajectory", 0.01)];
    for (scene, error, tolerance) in scenes {
        let name = scene.name.clone();
        let [file, out] = [format!("{name}.gltf"), format!("{name}.json")].map(|name| scratch(&name));
        write_scene(&scene, &file).expect("a scene");
        let sweep = format!(
            "--seconds 1 --rounds 1 --reference-hz 960 --error {error} --max-error {tolerance} --quiet --json"
        );
        let found = document(&format!(
            "trade {file} {sweep} --hz 30,60,120 --substeps 1,4 --iterations 1 --continuous segment \
             --recycling on --out {out}"
        ));
        let picked = &found["picked"];
        assert!(picked["error"].as_f64() <= Some(tolerance), "{name}: {picked}");
        let again = document(&format!("trade {file} {sweep} --hz 30,60,120 --settings {out}"));
        assert_eq!(again["cells"][1]["errors"], picked["errors"], "{name}");

        let run = document(&format!("run {file} --settings {out} --steps 2 --json"));
        for (setting, value) in picked["settings"].as_object().expect("settings") {
            if setting != "dt" {
                assert_eq!(&run["settings"][setting], value, "{name}: {setting}");
            }
        }
        let hz = picked["settings"]["dt"].as_str().and_then(|dt| dt.strip_prefix("1/")).expect("a fraction");
        let dt = 1.0 / hz.parse::<f32>().expect("a number");
        assert_eq!(run["settings"]["dt"].as_f64().map(|found| found as f32), Some(dt), "{name}");
    }
}

#[test]
fn what_can_not_be_is_refused() {
    let results = scratch("refused.jsonl");
    let small = format!("{SMALL} --results {results}");
    refused(
        &format!("trade tower_2 {small} --max-error 1e-30"),
        "no setting is the cheapest with an error of",
    );
    refused(&format!("trade tower_2 {small} --budget-us 1e-9"), "no setting is the most accurate within");
    refused("trade tower_2 --hz 61 --quiet", "at least 10, so that trajectories have times in common");
    refused("trade tower_2 --hz 240 --reference-hz 240 --quiet", "is too coarse");
    refused("trade tower_2 --cell 3/2", "must be like 1/8");
    refused("trade tower_2 --error beauty", "must be one of trajectory, worst, rotation");
    refused("trade nothing_at_all --quiet", "nothing_at_all");
    let settings = scratch("wrong.json");
    std::fs::write(&settings, "{\"substep\": 3}").expect("a file");
    refused(&format!("run tower_2 --settings {settings}"), "there is no setting \"substep\"");
    refused(&format!("trade tower_2 --settings {settings}"), "there is no setting \"substep\"");
    std::fs::write(&settings, "{\"substeps\": 3, \"dt\": \"1/50\"}").expect("a file");
    // An option beside a file overrides it.
    let run = document(&format!("run tower_2 --settings {settings} --substeps 2 --steps 2 --json"));
    assert_eq!((&run["settings"]["substeps"], run["settings"]["dt"].as_f64()), (&2.into(), Some(0.02)));
}
