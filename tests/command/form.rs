//! The command keeps to the form that docs/json.md promises, and says what is wrong.
#![allow(clippy::disallowed_methods, reason = "expected values may use the platform's functions")]
use serde_json::Value;
use std::path::PathBuf;
use std::process::{Command, Output};

fn backstop(arguments: &[&str]) -> Output {
    Command::new(env!("CARGO_BIN_EXE_backstop"))
        .args(arguments)
        .current_dir(env!("CARGO_MANIFEST_DIR"))
        .output()
        .expect("the command starts")
}

/// The one document on standard output.
fn document(output: &Output) -> Value {
    assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
    serde_json::from_slice(&output.stdout).expect("one JSON document")
}

fn keys(value: &Value) -> Vec<&str> {
    value.as_object().map(|o| o.keys().map(String::as_str).collect()).unwrap_or_default()
}

/// Keys in any order.
fn has_keys(value: &Value, expected: &[&str]) {
    let (mut found, mut expected) = (keys(value), expected.to_vec());
    found.sort_unstable();
    expected.sort_unstable();
    assert_eq!(found, expected);
}

fn numbers(value: &Value, count: usize) {
    let list = value.as_array().expect("an array");
    assert!(list.len() == count && list.iter().all(Value::is_f64), "{value}");
}

/// A file or folder of this test run.
fn scratch(name: &str) -> PathBuf {
    let folder = PathBuf::from(env!("CARGO_TARGET_TMPDIR")).join("command");
    std::fs::create_dir_all(&folder).expect("a folder for tests");
    folder.join(name)
}

fn refused(arguments: &[&str], code: i32, reason: &str) {
    let output = backstop(arguments);
    let errors = String::from_utf8_lossy(&output.stderr);
    assert_eq!(output.status.code(), Some(code), "{errors}");
    assert!(errors.contains(reason), "{errors}");
    assert!(output.stdout.is_empty());
}

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
    assert_eq!(document["settings"]["method"], "one-pass");
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
    assert_eq!(settings["method"], "linear-cast");
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
    refused(&[], 2, "Usage");
}

#[test]
fn a_profile_has_both_costs_of_every_frame() {
    let (folder, table) = (scratch("profile"), scratch("profile-table/frames.csv"));
    let (folder, table) = (folder.to_str().expect("a path"), table.to_str().expect("a path"));
    let arguments =
        ["profile", "--steps", "26", "--repeats", "3", "--threads", "1,2", "--json", "--no-compare"];
    let more = ["--report", folder, "--csv", table];
    let document = document(&backstop(&[&arguments[..], &more].concat()));
    has_keys(&document, &["scene", "settings", "steps", "dynamic_bodies", "runs", "each", "memory", "hash"]);
    assert_eq!((&document["scene"], &document["dynamic_bodies"]), (&"talk".into(), &11.into()));
    let runs = document["runs"].as_array().expect("runs");
    assert_eq!(runs.len(), 2);
    for run in runs {
        has_keys(run, &["threads", "additional", "stages", "totals", "frames"]);
        let frames = run["frames"].as_array().expect("frames");
        assert_eq!(frames.len(), 26);
        for (i, frame) in frames.iter().enumerate() {
            assert_eq!(frame["step"], i + 1);
            let (discrete, continuous) = (&frame["discrete_us"], &frame["continuous_us"]);
            assert!(discrete.as_f64() > Some(0.0) && continuous.as_f64() > Some(0.0), "{frame}");
        }
        // All eleven fly towards the ground, and some reach it in these frames (see the scene's generator).
        assert_eq!((&frames[0]["swept"], &frames[0]["falling"]), (&11.into(), &true.into()));
        let totals = &run["totals"];
        assert!(totals["casts"].as_u64() > Some(0) && totals["pushed"].as_u64() > Some(0), "{totals}");
        // What was pushed in one frame is confirmed or a ghost in the next.
        let pushed: u64 = frames[..25].iter().filter_map(|f| f["pushed"].as_u64()).sum();
        let told = totals["confirmed"].as_u64().zip(totals["ghosts"].as_u64()).map(|(a, b)| a + b);
        assert_eq!(told, Some(pushed));
    }
    let each = document["each"].as_array().expect("pairs of a shape and a ground");
    assert_eq!(each.len(), 8);
    for pair in each {
        let times = ["flight_us", "strike_us", "rolling_us", "resting_us", "strike_ratio"];
        has_keys(pair, &[&["shape", "ground", "bodies", "strikes"], &times[..]].concat());
        // All of them reach the ground in the step of strikes.
        assert_eq!((&pair["bodies"], &pair["strikes"]), (&64.into(), &64.into()), "{pair}");
        assert!(times.iter().all(|time| pair[time].is_number()), "{pair}");
    }
    // Nothing but times differs between numbers of threads: the counts are those of one run.
    assert_eq!(runs[0]["totals"], runs[1]["totals"]);
    // The run is the one that `run` makes.
    let run = self::document(&backstop(&["run", "scenes/talk.glb", "--steps", "26", "--json"]));
    assert_eq!(document["hash"], run["hash"]);
    for file in ["index.html", "cost-1.svg", "additional-2.svg", "potential.svg", "memory.svg"] {
        assert!(std::fs::metadata(format!("{folder}/{file}")).is_ok_and(|m| m.len() > 100), "{file}");
    }
    let lines = std::fs::read_to_string(table).expect("a table");
    assert_eq!(lines.lines().count(), 1 + 2 * 26);
    assert!(lines.starts_with("threads,step,discrete_us,continuous_us,additional,falling,swept,"));
}

#[test]
fn methods_are_compared_on_a_scene() {
    let run = |threads| {
        let arguments = ["compare", "--scene", "deflector", "--rounds", "2", "--json", "--threads", threads];
        document(&backstop(&arguments))
    };
    let comparison = run("1");
    has_keys(&comparison, &["threads", "rounds", "scenes"]);
    let scenes = comparison["scenes"].as_array().expect("scenes");
    assert_eq!(scenes.len(), 1);
    has_keys(&scenes[0], &["scene", "steps", "methods"]);
    let methods = scenes[0]["methods"].as_array().expect("methods");
    let names: Vec<_> = methods.iter().map(|method| method["name"].as_str().expect("a name")).collect();
    let expected = [
        "discrete",
        "linear-cast",
        "speculative",
        "talk-method",
        "segment",
        "volume",
        "conservative-advancement",
    ];
    assert_eq!(names, expected);
    let measures = [
        "tunnelled",
        "ghosts",
        "energy_lost",
        "energy_error",
        "distance_lost",
        "distance_worst",
        "joint_opening",
        "impacts",
        "bytes",
        "continuous_bytes",
    ];
    let again = run("2");
    for (i, method) in methods.iter().enumerate() {
        has_keys(&method["time_us"], &["median", "mean", "p95", "max"]);
        for measure in measures {
            assert!(method[measure].is_number(), "{measure}");
            if !measure.contains("bytes") {
                assert_eq!(method[measure], again["scenes"][0]["methods"][i][measure], "{measure}");
            }
        }
        // Each ball strikes its obstacle. Discrete physics lets them through. Speculative contacts don't: what a bounce throws
        // off its way stands until the next step, which looks along the new one.
        assert_eq!(method["impacts"], 32);
        assert_eq!(method["tunnelled"].as_u64() > Some(0), names[i] == "discrete", "{method}");
    }
    // The reference is off itself by nothing.
    assert_eq!((&methods[6]["energy_error"], &methods[6]["distance_lost"]), (&0.0.into(), &0.0.into()));
    refused(&["compare", "--scene", "nowhere"], 1, "there is no scene");
}

#[test]
fn shots_are_counted_in_all_by_shape_and_by_target() {
    let run = |threads| {
        let arguments =
            ["shots", "--count", "200", "--moving", "20", "--seed", "5", "--json", "--threads", threads];
        document(&backstop(&arguments))
    };
    let document = run("1");
    let counts = ["shots", "through", "through_unguarded", "gained", "guard", "settled", "depth"];
    let modes = ["discrete", "segment", "volume"];
    let form = |value: &Value| {
        for name in ["through", "through_unguarded", "gained", "settled", "depth"] {
            has_keys(&value[name], &modes);
        }
        has_keys(&value["guard"], &["cut", "lifted"]);
        for mode in modes {
            has_keys(
                &value["depth"][mode],
                &[
                    "shots",
                    "median_mm",
                    "p99_mm",
                    "worst_mm",
                    "median_share",
                    "p99_share",
                    "worst_share",
                    "over",
                    "stuck",
                ],
            );
        }
    };
    has_keys(&document, &[&counts[..], &["seed", "by_shape", "by_target", "moving"]].concat());
    form(&document);
    assert_eq!(document["shots"], 200);
    assert_eq!(document["seed"], 5);
    for parts in [&document["by_shape"], &document["by_target"]] {
        let mut shots = 0;
        let mut discrete = 0;
        for name in keys(parts) {
            has_keys(&parts[name], &counts);
            form(&parts[name]);
            shots += parts[name]["shots"].as_u64().expect("a count");
            discrete += parts[name]["through"]["discrete"].as_u64().expect("a count");
        }
        assert_eq!(shots, 200);
        assert_eq!(document["through"]["discrete"], discrete);
    }
    let moving = &document["moving"];
    has_keys(moving, &["free_plate", "hinged_plate", "stack", "crowd"]);
    for target in keys(moving) {
        has_keys(&moving[target], &["shots", "through", "through_unguarded"]);
        has_keys(&moving[target]["through"], &modes);
    }
    assert_eq!(document, run("2"));
}

#[test]
fn shipped_scenes_are_the_generator_s() {
    let folder = scratch("scenes");
    assert!(backstop(&["scenes", "write", folder.to_str().expect("a path in UTF-8")]).status.success());
    let committed = PathBuf::from(env!("CARGO_MANIFEST_DIR")).join("scenes");
    // Not byte by byte: in which order the triangles of a mesh are written is the engine's business.
    let bodies = |path: PathBuf| -> Vec<String> {
        let scene = backstop::scene::load(path).expect("a scene");
        let text = |b: &backstop::scene::SceneBody| {
            let d = &b.desc;
            format!("{} {:?} {} {} {}", b.name, d.kind, d.position, d.rotation, d.linear_velocity)
        };
        scene.bodies.iter().map(text).collect()
    };
    for file in backstop::scene::SHIPPED {
        assert_eq!(bodies(folder.join(file)), bodies(committed.join(file)), "{file}");
    }
    let list = String::from_utf8(backstop(&["scenes", "list"]).stdout).expect("UTF-8");
    assert!(list.contains("large_pyramid") && list.contains("talk.glb"));
}

#[test]
fn a_file_with_joints_runs_and_is_filmed() {
    use backstop::glam::{DVec3, Vec3};
    use backstop::scene::{Scene, SceneJoint};
    use backstop::{Axes, BodyDesc, Frame, Geometry, Limit, Motion, ShapeDesc};
    let mut scene = Scene::new("rope");
    let ball = ShapeDesc::new(Geometry::Sphere { radius: 0.1 });
    scene.add("ball", BodyDesc::dynamic().at(DVec3::new(0.5, 2.0, 0.0)).with_shape(ball));
    scene.add("world", BodyDesc::fixed());
    scene.joints.push(SceneJoint {
        name: "rope".into(),
        bodies: [1, 0],
        frames: [Frame::at(Vec3::new(0.0, 2.0, 0.0)), Frame::default()],
        limits: vec![Limit::new(Motion::Linear, Axes::All, 0.0, 1.0)],
        drives: Vec::new(),
        collide: false,
    });
    let [file, film] = ["rope.gltf", "rope-moving.glb"].map(scratch);
    backstop::scene::write_scene(&scene, &file).expect("a file");
    let [file, film] = [&file, &film].map(|p| p.to_str().expect("a path of characters"));
    let document = document(&backstop(&["run", file, "--steps", "600", "--json", "--out", film]));
    assert_eq!((&document["joints"], &document["bodies"][1]["name"]), (&1.into(), &"world".into()));
    let place = document["bodies"][0]["position"].as_array().expect("three numbers");
    let place: Vec<f64> = place.iter().filter_map(Value::as_f64).collect();
    assert!(DVec3::new(place[0], place[1] - 2.0, place[2]).length() < 1.01, "{place:?}");
    let output = backstop(&["run", file, "--steps", "1"]);
    assert!(String::from_utf8_lossy(&output.stdout).contains("\njoints      1\n"));
    // The film is a scene with its joints, too.
    assert_eq!(backstop::scene::load(film).expect("a film").joints.len(), 1);
}

#[test]
fn a_recorded_run_is_replayed_at_any_number_of_threads() {
    let file = scratch("tower.replay");
    let file = file.to_str().expect("a path in UTF-8");
    let run = ["run", "scenes/tower.gltf", "--steps", "40", "--json", "--sleep", "--record", file];
    let hash = document(&backstop(&run))["hash"].clone();
    for threads in ["1", "3"] {
        let replayed = document(&backstop(&["replay", file, "--json", "--threads", threads]));
        has_keys(
            &replayed,
            &["file", "bytes", "engine", "threads", "steps", "calls", "seconds", "hash", "divergence"],
        );
        assert_eq!(replayed["hash"], hash);
        assert_eq!((&replayed["steps"], &replayed["calls"]["step"]), (&40.into(), &40.into()));
        assert_eq!(replayed["divergence"], Value::Null);
    }
    let output = backstop(&["replay", file]);
    let text = String::from_utf8_lossy(&output.stdout);
    assert!(text.contains("ok: every step is the same to the bit"), "{text}");
    let output = backstop(&["replay", file, "--quiet"]);
    assert!(output.status.success() && output.stdout.is_empty() && output.stderr.is_empty());
}

/// Writes postcard by hand: a recording whose first step was made with other bits than this engine makes.
#[test]
fn a_replay_that_goes_another_way_is_told_and_is_an_error() {
    let file = scratch("forged.replay");
    let path = file.to_str().expect("a path in UTF-8");
    let mut world = backstop::World::new(backstop::Settings::default()).expect("a world");
    let buffer = backstop::replay::RecordingBuffer::default();
    world.start_recording(buffer.clone()).expect("a recording");
    let ball = backstop::ShapeDesc::new(backstop::Geometry::Sphere { radius: 0.5 });
    let body = world.add_body(&backstop::BodyDesc::dynamic().with_shape(ball)).expect("a body");
    world.name_recorded(body, "the ball");
    world.step(1.0 / 60.0).expect("a step");
    world.stop_recording().expect("a recording");
    let mut bytes = buffer.bytes();
    // The last call is the step, and its last bytes are the hash of the ball: before the checksum of its block and the block
    // of the end, which has a head of five bytes, two numbers and a checksum.
    let last = bytes.len() - (5 + 2 + 4) - 4 - 1;
    bytes[last] ^= 1;
    let end = last + 1;
    let start = (0..end)
        .rev()
        .find(|&i| bytes[i] == 2 && bytes[i + 1..].starts_with(&((end - i - 5) as u32).to_le_bytes()));
    let start = start.expect("the block's head");
    let sum = crc(&bytes[start..end]);
    bytes[end..end + 4].copy_from_slice(&sum.to_le_bytes());
    std::fs::write(&file, &bytes).expect("a file");

    refused(
        &["replay", path, "--quiet"],
        1,
        "step 1 goes another way in stage finish, first body 0.1 \"the ball\"",
    );
    let output = backstop(&["replay", path, "--json"]);
    assert_eq!(output.status.code(), Some(1));
    let document: Value = serde_json::from_slice(&output.stdout).expect("one JSON document");
    let found = &document["divergence"];
    has_keys(found, &["step", "stage", "body", "bodies", "refused", "recorded", "replayed"]);
    assert_eq!((&found["step"], &found["stage"]), (&1.into(), &"finish".into()));
    assert_eq!((&found["body"]["name"], &found["body"]["handle"]["slot"]), (&"the ball".into(), &0.into()));

    bytes.truncate(end);
    std::fs::write(&file, &bytes).expect("a file");
    refused(&["replay", path], 1, "is cut off after step 0");
    refused(&["replay", "scenes/tower.gltf"], 1, "no recording of backstop");
    refused(&["replay", "no/such/file"], 1, "no/such/file");
}

/// CRC-32 bit by bit.
fn crc(bytes: &[u8]) -> u32 {
    let bit = |crc: u32| if crc & 1 == 1 { crc >> 1 ^ 0xEDB8_8320 } else { crc >> 1 };
    !bytes.iter().fold(u32::MAX, |crc, &byte| (0..8).fold(crc ^ u32::from(byte), |crc, _| bit(crc)))
}

#[test]
fn a_plan_is_compared_with_a_run() {
    let planned = document(&backstop(&["plan", "scenes/tower.gltf", "--steps", "30", "--json", "--quiet"]));
    has_keys(&planned, &["scene", "steps", "categories", "planned", "measured", "budget"]);
    for line in planned["categories"].as_array().expect("a list") {
        has_keys(line, &["name", "planned", "measured"]);
        // What bodies and shapes take is no guess.
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

/// A box on the ground has modes that neither grow nor fade, those that friction holds, and none that grows.
#[test]
fn a_box_at_rest_is_stable() {
    let output = backstop(&["stability", "tower", "--size", "1", "--settle", "3", "--json"]);
    let found = document(&output);
    assert_eq!(found["verdict"], "stable");
    assert_eq!(found["scene"], "tower_1");
    // Twelve numbers of the body, one for each of four points, friction and twist.
    assert_eq!(found["unknowns"], 20);
    let [radius, growth] = ["radius", "growth"].map(|key| found[key].as_f64().expect("a number"));
    assert!((radius - 1.0).abs() < 1e-3 && growth.abs() < 0.06, "{found}");
    let text = backstop(&["stability", "tower_1", "--settle", "3"]).stdout;
    let text = String::from_utf8(text).expect("UTF-8");
    assert!(text.contains("spectral radius") && text.contains("stable"), "{text}");
    refused(&["stability", "nonsense"], 1, "nor a builtin scene");
    refused(&["stability", "--friction-model", "glue"], 2, "patch or point");
}

/// A disk that was full halfway turned an existing film into half of one, and `--out` replaced the scene itself. Here the
/// system lets no file grow beyond 4 or 8 KiB (`ulimit -f 8`, in blocks of 512 bytes or 1 KiB). Expected: the old contents.
#[cfg(target_os = "linux")]
#[test]
fn a_full_disk_leaves_outputs_as_they_were_and_no_output_is_the_input() {
    let folder = scratch("atomic");
    let _ = std::fs::remove_dir_all(&folder);
    std::fs::create_dir_all(&folder).expect("a folder");
    let path = |name: &str| folder.join(name).to_str().expect("a path").to_owned();
    let limited = |arguments: &str| {
        let command =
            format!("trap '' XFSZ; ulimit -f 8; exec {} {arguments}", env!("CARGO_BIN_EXE_backstop"));
        Command::new("sh").args(["-c", &command]).output().expect("a shell")
    };
    let names = ["film.glb", "run.replay", "page/index.html", "pictures/frame-00000.png", "table.csv"];
    for name in names {
        std::fs::create_dir_all(folder.join(name).parent().expect("a folder")).expect("a folder");
        std::fs::write(folder.join(name), "old").expect("a file");
    }
    let [film, replay, page, pictures, table] =
        ["film.glb", "run.replay", "page", "pictures", "table.csv"].map(path);
    let run = |more: &str| format!("run tall_stack --steps 60 --quiet {more}");
    let commands = [
        run(&format!("--out {film}")),
        run(&format!("--record {replay}")),
        run(&format!("--report {page}")),
        run(&format!("--frames {pictures}")),
        format!("profile tall_stack --steps 200 --repeats 1 --threads 1 --no-compare --quiet --csv {table}"),
    ];
    for (name, command) in names.iter().zip(&commands) {
        let output = limited(command);
        let errors = String::from_utf8_lossy(&output.stderr);
        assert_eq!(output.status.code(), Some(1), "{command}: {errors}");
        assert!(errors.contains("too large"), "{errors}");
        assert_eq!(std::fs::read(folder.join(name)).expect("a file"), b"old", "{command}");
        let beside = std::fs::read_dir(folder.join(name).parent().expect("a folder")).expect("a folder");
        let left =
            beside.filter_map(|f| f.ok()?.file_name().into_string().ok()).find(|f| f.ends_with(".tmp"));
        assert_eq!(left, None, "{command}");
    }
    let scene = path("scene.gltf");
    std::fs::copy("scenes/tower.gltf", &scene).expect("a copy");
    let again = path("pictures/../scene.gltf");
    for option in ["--out", "--record"] {
        refused(&["run", &scene, "--steps", "1", option, &again], 1, "it would replace");
    }
    refused(&["profile", &scene, "--steps", "1", "--csv", &again], 1, "it would replace");
    assert_eq!(std::fs::read(&scene).expect("a scene"), std::fs::read("scenes/tower.gltf").expect("a scene"));
    refused(&["run", &scene, "--out", &film, "--record", &film], 1, "two outputs");
}

/// A film could take the place of the buffer or of the image that its scene refers to. Expected: refused however it is spelled,
/// and both are what they were.
#[test]
fn no_output_is_a_file_that_the_scene_refers_to() {
    let folder = scratch("referred");
    std::fs::create_dir_all(folder.join("parts")).expect("a folder");
    let path = |name: &str| folder.join(name).to_str().expect("a path").to_owned();
    let corners: [f32; 9] = [0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 0.0, 1.0];
    let bytes: Vec<u8> = corners.iter().flat_map(|x| x.to_le_bytes()).collect();
    std::fs::write(path("a b.bin"), &bytes).expect("a buffer");
    std::fs::write(path("parts/skin.png"), "image").expect("an image");
    let scene = serde_json::json!({ "asset": { "version": "2.0" }, "nodes": [{ "mesh": 0 }],
        "scenes": [{ "nodes": [0] }], "images": [{ "uri": "parts/skin.png" }],
        "buffers": [{ "byteLength": 36, "uri": "a%20b.bin" }], "bufferViews": [{ "buffer": 0, "byteLength": 36 }],
        "meshes": [{ "primitives": [{ "attributes": { "POSITION": 0 } }] }],
        "accessors": [{ "bufferView": 0, "componentType": 5126, "type": "VEC3", "count": 3, "min": [0, 0, 0],
            "max": [1, 1, 1] }] });
    std::fs::write(path("scene.gltf"), scene.to_string()).expect("a scene");
    let scene = path("scene.gltf");
    for file in ["a b.bin", "parts/../a b.bin", "parts/skin.png"].map(path) {
        refused(&["run", &scene, "--steps", "1", "--out", &file], 1, "it would replace");
        refused(&["run", &scene, "--steps", "1", "--record", &file], 1, "it would replace");
        refused(&["profile", &scene, "--steps", "1", "--csv", &file], 1, "it would replace");
    }
    assert_eq!(std::fs::read(path("a b.bin")).expect("a buffer"), bytes);
    assert_eq!(std::fs::read(path("parts/skin.png")).expect("an image"), b"image");
    assert!(
        backstop(&["run", &scene, "--steps", "1", "--quiet", "--out", &path("film.glb")]).status.success()
    );
}

/// Expected: the limit's name and value, and none with `--no-limits`.
#[test]
fn a_file_that_asks_for_too_much_is_refused_unless_it_is_trusted() {
    let nodes: Vec<Value> = (1..1002).map(|i| serde_json::json!({ "children": [i] })).collect();
    let mut scene = serde_json::json!({ "asset": { "version": "2.0" }, "nodes": nodes, "scenes": [{ "nodes": [0] }],
        "extensions": { "KHR_implicit_shapes": { "shapes": [{ "type": "box" }] } } });
    let collider = serde_json::json!({ "collider": { "geometry": { "shape": 0 } } });
    scene["nodes"][1000] = serde_json::json!({ "extensions": { "KHR_physics_rigid_bodies": collider } });
    let (path, text) = (scratch("deep.gltf"), scene.to_string());
    std::fs::write(&path, text).expect("a scene");
    let path = path.to_str().expect("a path");
    for command in ["run", "plan", "profile"] {
        refused(
            &[command, path, "--steps", "1", "--quiet"],
            1,
            "the load limit `depth` allows, which is 1000",
        );
    }
    assert!(backstop(&["run", path, "--steps", "1", "--quiet", "--no-limits"]).status.success());
}

/// A node's name could clear the screen, forge a line or turn the text round. Expected: no control character but the ends of
/// lines, wherever the name is told.
#[test]
fn names_of_a_file_do_not_reach_the_terminal_raw() {
    let name = "a\u{1b}[2J\nerror: none\u{202e}";
    let node = |shape: u32| {
        serde_json::json!({ "name": name, "extensions": { "KHR_physics_rigid_bodies": {
            "motion": {}, "collider": { "geometry": { "shape": shape } } } } })
    };
    let scene = |nodes: Vec<Value>, required: &str| {
        serde_json::json!({ "asset": { "version": "2.0" }, "nodes": nodes, "extensionsRequired": [required],
            "extensions": { "KHR_implicit_shapes": { "shapes": [{ "type": "sphere", "sphere": { "radius": 0.5 } }] } } })
    };
    let run = |file: &str, text: &str| {
        let path = scratch(file);
        std::fs::write(&path, text).expect("a scene");
        let output = backstop(&["run", path.to_str().expect("a path"), "--steps", "1"]);
        String::from_utf8([output.stderr, output.stdout].concat()).expect("UTF-8")
    };
    let texts = [
        run("control.gltf", &scene(vec![node(7)], "KHR_physics_rigid_bodies").to_string()),
        run("control.gltf", &scene(vec![node(0)], name).to_string()),
        run("control.obj", &format!("v 0 0 0\no {}\nf 1 2 3\n", name.replace('\n', " "))),
        run("control.gltf", "{\"asset\": \u{1b}[2J"),
    ];
    for text in &texts {
        let raw = text.chars().find(|&c| c.is_control() && c != '\n' || c == '\u{202e}');
        assert_eq!(raw, None, "{text:?}");
        assert!(!text.lines().any(|line| line.starts_with("error: none")), "{text:?}");
    }
    assert!(texts[0].contains(r"\u{1b}[2J") && texts[1].contains(r"\u{1b}[2J"), "{texts:?}");
}

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
    refused(&["run", "tall_stack", "--steps", "5", "--export-problem", "6", path], 1, "step 6 of 5");
    refused(&["run", "tall_stack", "--export-problem", "none", path], 1, "the number of a step");
}
