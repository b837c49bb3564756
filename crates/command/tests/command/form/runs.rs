//! Runs, their options, and their files.

use super::*;

#[test]
fn a_run_prints_the_document_that_is_promised() {
    let document = document(&backstop(&["run", "scenes/tower.gltf", "--steps", "10", "--json"]));
    has_keys(
        &document,
        &[
            "scene", "settings", "solver", "steps", "bodies", "joints", "time_us", "contacts", "memory",
            "model", "accuracy", "hash",
        ],
    );
    let model = document["model"].as_array().expect("a list");
    for part in model {
        has_keys(part, &["name", "needed", "count", "asked_by", "bytes", "time_us", "stage"]);
        assert_eq!(part["needed"], part["count"] != 0, "{part}");
    }
    let part = |name: &str| model.iter().find(|part| part["name"] == name).expect("a part");
    assert_eq!(part("friction")["needed"], true);
    assert_eq!((&part("joints")["needed"], &part("joints")["bytes"]), (&Value::Bool(false), &Value::from(0)));
    assert_eq!(document["scene"], "tower");
    assert_eq!(document["steps"], 10);
    assert_eq!(document["settings"]["substeps"], 4);
    assert_eq!(document["settings"]["continuous"], "segment");
    assert_eq!(document["settings"]["continuous_method"], "one-pass");
    numbers(&document["settings"]["gravity"], 3);
    // A floor, 12 layers of three bricks, three balls.
    let bodies = document["bodies"].as_array().expect("bodies");
    assert_eq!(bodies.len(), 1 + 36 + 3);
    for body in bodies {
        has_keys(
            body,
            &["name", "kind", "position", "rotation", "linear_velocity", "angular_velocity", "asleep"],
        );
        numbers(&body["position"], 3);
        numbers(&body["rotation"], 4);
        numbers(&body["linear_velocity"], 3);
        numbers(&body["angular_velocity"], 3);
        assert!(body["name"].is_string() && body["asleep"].is_boolean());
    }
    assert_eq!(bodies[0]["kind"], "static");
    assert_eq!(bodies[1]["kind"], "dynamic");
    has_keys(&document["time_us"], &["step", "broad", "narrow", "prepare", "solve", "finish"]);
    for stage in keys(&document["time_us"]) {
        has_keys(&document["time_us"][stage], &["median", "mean", "p95", "max"]);
    }
    has_keys(&document["contacts"], &["real", "potential", "pushed", "ghosts"]);
    has_keys(&document["memory"], &["categories", "total", "continuous", "meshes"]);
    let categories = document["memory"]["categories"].as_array().expect("categories");
    let sum: u64 = categories.iter().map(|c| c["reserved"].as_u64().expect("bytes")).sum();
    assert_eq!(document["memory"]["total"], sum);
    categories.iter().for_each(|c| has_keys(c, &["name", "live", "reserved", "peak"]));
    let hash = document["hash"].as_str().expect("a hash");
    assert!(hash.len() == 16 && hash.chars().all(|c| c.is_ascii_hexdigit()));
}

#[test]
fn options_reach_the_world() {
    let arguments = "run tall_stack --steps 3 --dt 1/120 --substeps 1 --iterations 8 --threads 2 --continuous volume \
                     --method linear-cast --gravity 1,-2.5,0 --json";
    let document = document(&backstop(&arguments.split_whitespace().collect::<Vec<_>>()));
    let settings = &document["settings"];
    for (name, expected) in [("substeps", 1), ("iterations", 8), ("threads", 2)] {
        assert_eq!(settings[name], expected);
    }
    assert_eq!(settings["continuous"], "volume");
    assert_eq!(settings["continuous_method"], "linear-cast");
    assert_eq!(settings["gravity"], serde_json::json!([1.0, -2.5, 0.0]));
    assert!((settings["dt"].as_f64().expect("dt") - 1.0 / 120.0).abs() < 1e-8);
}

#[test]
fn the_same_run_has_the_same_hash_with_any_number_of_threads() {
    let hash = |threads| {
        let run = ["run", "scenes/tower.gltf", "--steps", "30", "--json", "--threads", threads];
        document(&backstop(&run))["hash"].clone()
    };
    assert_eq!(hash("1"), hash("3"));
}

#[test]
fn a_mesh_is_ground_for_rain_and_film_and_page_are_written() {
    let (mesh, film, page) = (scratch("ground.obj"), scratch("rain.glb"), scratch("rain"));
    std::fs::write(&mesh, "v -9 0 -9\nv 9 0 -9\nv 9 0 9\nv -9 0 9\nf 1 4 3 2\n").expect("a mesh");
    let [mesh, out, report] = [&mesh, &film, &page].map(|p| p.to_str().expect("a path in UTF-8"));
    let run = ["run", mesh, "--drop", "12", "--steps", "90", "--json", "--out", out, "--report", report];
    let document = document(&backstop(&run));
    let bodies = document["bodies"].as_array().expect("bodies");
    assert_eq!(bodies.len(), 13);
    for body in &bodies[1..] {
        let height = body["position"][1].as_f64().expect("a number");
        assert!((0.0..2.0).contains(&height), "{body}");
    }
    assert!(std::fs::read(film).expect("a film").starts_with(b"glTF"));
    let html = std::fs::read_to_string(page.join("index.html")).expect("a page");
    for picture in ["times.svg", "contacts.svg", "energy.svg", "memory.svg"] {
        assert!(html.contains(picture) && page.join(picture).exists(), "{picture}");
    }
}

#[test]
fn the_summary_is_for_people_and_quiet_is_quiet() {
    let text = backstop(&["run", "scenes/tower.gltf", "--steps", "5"]).stdout;
    let text = String::from_utf8(text).expect("UTF-8");
    assert!(text.contains("39 dynamic") && text.contains("step time") && text.contains("guard"), "{text}");
    let output = backstop(&["run", "scenes/tower.gltf", "--steps", "5", "--quiet"]);
    assert!(output.stdout.is_empty() && output.stderr.is_empty());
}

#[test]
fn errors_name_the_file_and_the_cause() {
    refused(&["run", "no/such/file.glb", "--json"], 1, "no/such/file.glb");
    refused(&["run", "nonsense"], 1, "nor a builtin scene");
    let broken = scratch("broken.glb");
    std::fs::write(&broken, b"glTF\x02\0\0\0\xff\xff\0\0not JSON at all").expect("a broken file");
    refused(&["run", broken.to_str().expect("a path in UTF-8")], 1, "broken.glb");
    refused(&["run", "scenes/tower.gltf", "--dt", "0"], 2, "--dt");
    refused(&["run", "scenes/tower.gltf", "--substeps", "0"], 1, "substeps");
    refused(&["run", "scenes/tower.gltf", "--continuous", "maybe"], 2, "discrete, segment or volume");
    refused(&["run", "scenes/tower.gltf", "--guess", "last-step"], 1, "need --solver");
    refused(&["tosses", "crates", "--calm", "4"], 1, "need --solver");
    refused(&["run", "scenes/tower.gltf", "--guess", "lucky"], 2, "zero, last-step, fast-path");
    refused(&["run", "scenes/tower.gltf", "--reduce", "4"], 1, "need --solver");
    refused(
        &["run", "scenes/tower.gltf", "--solver", "pgs", "--reduce", "5"],
        2,
        "hull or a number in 1..=4",
    );
    refused(&["methods", "--method", "backstop", "--reduce", "3"], 1, "another --method");
    refused(&["methods", "--method", "penalty", "--retroactive", "1e-3"], 1, "can't serve penalty");
    let returns = ["run", "scenes/tower.gltf", "--retroactive", "1e-3"];
    refused(&[&returns[..], &["--continuous", "volume"]].concat(), 1, "--continuous discrete");
    refused(&[&returns[..], &["--export-problem", "1", "x.dat"]].concat(), 1, "takes steps back");
    refused(&["run", "scenes/tower.gltf", "--retroactive", "0"], 2, "above 0");
    refused(&[], 2, "Usage");
}

/// Sweeps from zero do not solve a stack with a body a thousand times as heavy; from the impulses of the step
/// before they do.
#[test]
fn options_of_methods_reach_the_method() {
    let solved = |guess: &str| {
        let run = ["run", "mass_stack_1e3", "--steps", "5", "--json", "--quiet", "--solver", "gs-cone"];
        document(&backstop(&[&run[..], &["--guess", guess]].concat()))["solver"]["solved"].as_u64()
    };
    assert_eq!([solved("zero"), solved("last-step")], [Some(0), Some(5)]);
}

/// Without continuous collision, fast bodies of this scene end behind what they hit; taken back they do not.
#[test]
fn steps_are_taken_back() {
    let deepest = |more: &[&str]| {
        let run = ["run", "scenes/tower.gltf", "--steps", "60", "--dt", "1/30", "--json", "--accuracy"];
        let run = document(&backstop(&[&run[..], more].concat()));
        let figures = run["accuracy"]["figures"].as_array().expect("a list").clone();
        let figure = figures.iter().find(|one| one["name"] == "penetration").expect("a figure");
        figure["worst"].as_f64().expect("a number")
    };
    let (plain, back) = (deepest(&["--continuous", "discrete"]), deepest(&["--retroactive", "1e-3"]));
    assert!(back < 0.5 * plain, "{back} m, {plain} m");
}

#[test]
fn a_plan_is_compared_with_a_run() {
    let planned = document(&backstop(&["plan", "scenes/tower.gltf", "--steps", "30", "--json", "--quiet"]));
    has_keys(&planned, &["scene", "steps", "categories", "planned", "measured", "budget"]);
    for line in planned["categories"].as_array().expect("a list") {
        has_keys(line, &["name", "planned", "measured"]);
        // Bytes of bodies and shapes are exact.
        if ["bodies", "shapes", "meshes"].iter().any(|name| line["name"] == *name) {
            assert_eq!(line["planned"], line["measured"], "{line}");
        }
    }
    let of = |key: &str| planned[key].as_f64().expect("a number");
    assert!((0.75..1.25).contains(&(of("planned") / of("measured"))), "{planned}");

    let half = format!("{}", (of("measured") * 0.7) as u64);
    let arguments =
        ["plan", "scenes/tower.gltf", "--steps", "30", "--json", "--quiet", "--budget", half.as_str()];
    let tight = document(&backstop(&arguments));
    let trial = &tight["budget"];
    has_keys(trial, &["bytes", "refused", "held", "shed", "first"]);
    assert!(trial["held"].as_f64() <= trial["bytes"].as_f64(), "{trial}");
    let output = backstop(&["plan", "scenes/tower.gltf", "--steps", "5", "--budget", "1KiB"]);
    let text = String::from_utf8_lossy(&output.stdout);
    assert!(output.status.success() && text.contains("does not fit"), "{text}");
    let ran =
        document(&backstop(&["run", "scenes/tower.gltf", "--steps", "5", "--json", "--budget", "2MiB"]));
    assert_eq!(ran["settings"]["budget"]["total"], 2 << 20);
    refused(&["plan", "scenes/tower.gltf", "--budget", "1MB"], 2, "is no number of bytes");
}
