//! What `cargo backstop trade` picks, looked at: each pick is run again and judged by measurements that are
//! not trade's own. `BACKSTOP_PICKS=SEED` judges all scenes of a seed on the quick grid, and prints a table.

mod judge;
mod machines;
mod scenes;

use crate::trade::{document, scratch};
use backstop::Settings;
use backstop_lab::WorldSolver;
use backstop_scene::{Scene, load, write_scene};
use judge::{Seen, watch, watch_with};
use serde_json::Value;

/// Scenes in which energy comes from motors, belts and kinematic bodies.
const DRIVEN: [&str; 7] = ["drum", "buggy", "conveyor", "pusher", "gears", "lift", "winch"];

/// Those that are judged without a seed.
const FEW: [&str; 7] = ["dominoes", "bullet", "struck_pyramid", "chain", "bridge", "pusher", "door"];

/// The settings of a world and the rate, as a document has them.
fn settings(row: &Value) -> (Settings, u32) {
    let mut fields = row["settings"].as_object().expect("settings").clone();
    let dt = fields.remove("dt").expect("a step");
    let hz = dt.as_str().and_then(|dt| dt.strip_prefix("1/")).and_then(|hz| hz.parse().ok()).unwrap_or(1);
    fields.remove("solver");
    (serde_json::from_value(Value::Object(fields)).expect("settings of a world"), hz)
}

/// Why a person would not take a run, given what is to be seen in a fine one.
fn faults(seen: &Seen, fine: &Seen, driven: bool, chaos: bool) -> Vec<String> {
    let mut faults = Vec::new();
    let Seen { overlap, overlap_share, lasting, .. } = seen;
    if *overlap_share > (1.5 * fine.overlap_share).max(0.7) || *lasting > (1.5 * fine.lasting).max(0.2) {
        let shares = format!("{overlap_share:.2}, for longer {lasting:.2} of the thinner half");
        faults.push(format!("overlap of {overlap:.3} m, {shares}"));
    }
    if seen.opening > (0.15 * seen.narrowest).max(1.5 * fine.opening) {
        faults.push(format!("joints open by {:.3} m", seen.opening));
    }
    if !driven && seen.gain > fine.gain + 0.15 {
        faults.push(format!("{:.2} of the energy gained, not {:.2}", seen.gain, fine.gain));
    }
    let margin = 0.35 * (fine.high - fine.low).length() + 0.5;
    if (fine.low - seen.low).max_element() > margin || (seen.high - fine.high).max_element() > margin {
        faults.push(format!("bodies got to {:.1}..{:.1}", seen.low, seen.high));
    }
    // With chaos each run comes to rest at its own time.
    let moving = |seen: &Seen| seen.end_speeds.iter().filter(|&&speed| speed > 0.15).count();
    if !chaos && moving(fine) == 0 && moving(seen) > seen.end_speeds.len() / 10 {
        faults.push(format!("{} bodies are not at rest", moving(seen)));
    }
    faults
}

fn judge(scene: &Scene, options: &str, seconds: f64) -> (String, Vec<String>) {
    let file = scratch(&format!("{}.gltf", scene.name));
    write_scene(scene, &file).expect("a scene");
    // What is in the file differs by rounding, and a chaotic scene then takes another course.
    let scene = &load(&file).expect("a scene");
    let found = document(&format!("trade {file} --seconds {seconds} --quiet --json {options}"));
    let driven = DRIVEN.contains(&scene.name.as_str());
    let share = found["share"].as_f64().unwrap_or(0.0);
    let look = |row: &Value| {
        let (settings, hz) = settings(row);
        watch(scene, &settings, hz, seconds)
    };
    let fine = Settings::default().with_substeps(4).with_iterations(4);
    let fine = watch(scene, &fine, 480, seconds);
    let picked = &found["picked"];
    // Where nothing is picked, the default is shown.
    let row = if picked.is_null() { &found["default"] } else { picked };
    let seen = look(row);
    let fastest = seen.end_speeds.iter().copied().fold(0.0, f64::max);
    let line = format!(
        "{} | {share:.2} | {}{} | {:.2} | {:.2e} | {:.3} | {:.2} | {:.2} | {:.4} | {:.3} | {fastest:.3}",
        scene.name,
        if picked.is_null() { "none; default " } else { "" },
        row["name"].as_str().unwrap_or("?"),
        row["cost_ratio"].as_f64().unwrap_or(0.0),
        row["error"].as_f64().unwrap_or(f64::INFINITY),
        seen.overlap,
        seen.overlap_share,
        seen.lasting,
        seen.opening,
        seen.gain,
    );
    let of_default = if picked.is_null() { row["breaks"].to_string() } else { String::new() };
    (
        format!("{line} {of_default}"),
        if picked.is_null() { vec![] } else { faults(&seen, &fine, driven, share < 0.5) },
    )
}

/// A small grid for a second.
const SMALL: &str = "--seconds 1 --rounds 1 --reference-hz 480 --iterations 1 --friction patch \
                     --continuous segment --recycling on --quiet --json";

/// A scene as a file has it, and the settings that were measured.
fn rows(scene: &Scene, options: &str) -> (Scene, Vec<Value>) {
    let file = scratch(&format!("{}-rows.gltf", scene.name));
    write_scene(scene, &file).expect("a scene");
    let found = document(&format!("trade {file} {SMALL} {options}"));
    (load(&file).expect("a scene"), found["cells"].as_array().expect("cells").clone())
}

/// Two methods of the lab that gain energy at these rates, in a chain with a heavy end and in a tall stack.
/// Expected: each run that gets far beyond the energy of its start by measurements of the test's own breaks
/// the condition.
#[test]
fn what_explodes_gains_energy_from_nothing() {
    let all = scenes::all(7);
    let mut exploded = 0;
    for scene in all.iter().filter(|scene| ["chain", "stack"].contains(&scene.name.as_str())) {
        let (scene, rows) = rows(scene, "--hz 30,60 --substeps 4 --joints exact --solver sap,mujoco");
        for row in rows {
            let (settings, hz) = settings(&row);
            let solver = row["settings"]["solver"].as_str().and_then(WorldSolver::by_name);
            let gain = watch_with(&scene, (&settings, solver), hz, 1.0).gain;
            if gain > 0.15 {
                exploded += 1;
                assert!(row["breaks"].to_string().contains("gain"), "{}: {gain}, {row}", scene.name);
            }
        }
    }
    assert!(exploded > 0);
}

/// Planks on joints in closed loops throw a crate back: joints store energy when they are pulled open, and
/// give it back. Expected: at no rate that is a gain, as nothing gets beyond the energy of the start.
#[test]
fn what_joints_store_is_not_gained() {
    let all = scenes::all(7);
    let bridge = all.iter().find(|scene| scene.name == "bridge").expect("it is one of them");
    let (bridge, rows) = rows(bridge, "--hz 60,120 --substeps 4,8 --joints exact --solver none");
    for row in rows {
        let (settings, hz) = settings(&row);
        assert!(watch(&bridge, &settings, hz, 1.0).gain < 0.01, "{row}");
        assert!(!row["breaks"].to_string().contains("gain"), "{row}");
    }
}

#[test]
fn picks_are_what_a_person_would_take() {
    let seed = std::env::var("BACKSTOP_PICKS").ok().and_then(|seed| seed.parse().ok());
    let all = seed.is_some();
    let options = if all {
        "--quick"
    } else {
        "--rounds 1 --reference-hz 480 --hz 30,60,120 --substeps 1,4 --iterations 1 --friction patch \
         --continuous discrete,segment --recycling on --joints exact --solver none"
    };
    let seconds = if all { 2.0 } else { 1.0 };
    let mut bad = Vec::new();
    let few = |scene: &&Scene| all || FEW.contains(&scene.name.as_str());
    for scene in scenes::all(seed.unwrap_or(7)).iter().filter(few) {
        let (line, faults) = judge(scene, options, seconds);
        println!("{line} | {}", faults.join(", "));
        if !faults.is_empty() {
            bad.push(format!("{line}: {}", faults.join(", ")));
        }
    }
    assert!(bad.is_empty(), "{}", bad.join("\n"));
}
