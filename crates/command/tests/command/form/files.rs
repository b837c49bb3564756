//! Scenes, films and recordings as files, and refused ones.

use super::*;

#[test]
fn shipped_scenes_are_the_generator_s() {
    let folder = scratch("scenes");
    assert!(backstop(&["scenes", "write", folder.to_str().expect("a path in UTF-8")]).status.success());
    let committed = PathBuf::from(concat!(env!("CARGO_MANIFEST_DIR"), "/../..")).join("scenes");
    // Not byte by byte: in which order the triangles of a mesh are written is the engine's business.
    let bodies = |path: PathBuf| -> Vec<String> {
        let scene = backstop_scene::load(path).expect("a scene");
        let text = |b: &backstop_scene::SceneBody| {
            let d = &b.desc;
            format!("{} {:?} {} {} {}", b.name, d.kind, d.position, d.rotation, d.linear_velocity)
        };
        scene.bodies.iter().map(text).collect()
    };
    for file in backstop_scene::SHIPPED {
        assert_eq!(bodies(folder.join(file)), bodies(committed.join(file)), "{file}");
    }
    let list = String::from_utf8(backstop(&["scenes", "list"]).stdout).expect("UTF-8");
    assert!(list.contains("large_pyramid") && list.contains("talk.glb"));
}

#[test]
fn a_file_with_joints_runs_and_is_filmed() {
    use backstop::glam::{DVec3, Vec3};
    use backstop::{Axes, BodyDesc, Frame, Geometry, Limit, Motion, ShapeDesc};
    use backstop_scene::{Scene, SceneJoint};
    let mut scene = Scene::new("rope");
    let ball = ShapeDesc::new(Geometry::Sphere { radius: 0.1 });
    scene.add("ball", BodyDesc::dynamic().with_position(DVec3::new(0.5, 2.0, 0.0)).with_shape(ball));
    scene.add("world", BodyDesc::fixed());
    scene.joints.push(SceneJoint {
        name: "rope".into(),
        bodies: [1, 0],
        frames: [Frame::at(Vec3::new(0.0, 2.0, 0.0)), Frame::default()],
        limits: vec![Limit::new(Motion::Linear, Axes::All, 0.0, 1.0)],
        motors: Vec::new(),
        collide: false,
    });
    let [file, film] = ["rope.gltf", "rope-moving.glb"].map(scratch);
    backstop_scene::write_scene(&scene, &file).expect("a file");
    let [file, film] = [&file, &film].map(|p| p.to_str().expect("a path of characters"));
    let document = document(&backstop(&["run", file, "--steps", "600", "--json", "--out", film]));
    assert_eq!((&document["joints"], &document["bodies"][1]["name"]), (&1.into(), &"world".into()));
    let place = document["bodies"][0]["position"].as_array().expect("three numbers");
    let place: Vec<f64> = place.iter().filter_map(Value::as_f64).collect();
    assert!(DVec3::new(place[0], place[1] - 2.0, place[2]).length() < 1.01, "{place:?}");
    let output = backstop(&["run", file, "--steps", "1"]);
    assert!(String::from_utf8_lossy(&output.stdout).contains("\njoints      1\n"));
    // The film is a scene with its joints, too.
    assert_eq!(backstop_scene::load(film).expect("a film").joints.len(), 1);
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
    // The last call is the step, and its last bytes are the hash of the ball: before the checksum of its
    // block and the block of the end, which has a head of five bytes, two numbers and a checksum.
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

/// A disk that was full halfway turned an existing film into half of one, and `--out` replaced the scene
/// itself. Here the system lets no file grow beyond 4 or 8 KiB (`ulimit -f 8`, in blocks of 512 bytes or 1
/// KiB). Expected: the old contents.
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
    // As the command tells its own by their beginnings.
    let old: [(&str, &[u8]); 4] = [
        ("film.glb", b"glTF old"),
        ("run.replay", b"backstop replay\nold"),
        ("page/index.html", b"<!-- by backstop -->"),
        ("table.csv", b"threads,step,old"),
    ];
    for (name, content) in old {
        std::fs::create_dir_all(folder.join(name).parent().expect("a folder")).expect("a folder");
        std::fs::write(folder.join(name), content).expect("a file");
    }
    let [film, replay, page, table] = ["film.glb", "run.replay", "page", "table.csv"].map(path);
    let run = |more: &str| format!("run tall_stack --steps 60 --quiet {more}");
    let commands = [
        run(&format!("--out {film}")),
        run(&format!("--record {replay}")),
        run(&format!("--report {page}")),
        format!("profile tall_stack --steps 200 --repeats 1 --threads 1 --no-compare --quiet --csv {table}"),
    ];
    for ((name, content), command) in old.iter().zip(&commands) {
        let output = limited(command);
        let errors = String::from_utf8_lossy(&output.stderr);
        assert_eq!(output.status.code(), Some(1), "{command}: {errors}");
        assert!(errors.contains("too large"), "{errors}");
        assert_eq!(std::fs::read(folder.join(name)).expect("a file"), *content, "{command}");
        let beside = std::fs::read_dir(folder.join(name).parent().expect("a folder")).expect("a folder");
        let left =
            beside.filter_map(|f| f.ok()?.file_name().into_string().ok()).find(|f| f.ends_with(".tmp"));
        assert_eq!(left, None, "{command}");
    }
    let scene = path("scene.gltf");
    std::fs::copy("../../scenes/tower.gltf", &scene).expect("a copy");
    let again = path("page/../scene.gltf");
    for option in ["--out", "--record"] {
        refused(&["run", &scene, "--steps", "1", option, &again], 1, "it would replace");
    }
    refused(&["profile", &scene, "--steps", "1", "--csv", &again], 1, "it would replace");
    assert_eq!(
        std::fs::read(&scene).expect("a scene"),
        std::fs::read("../../scenes/tower.gltf").expect("a scene")
    );
    refused(&["run", &scene, "--out", &film, "--record", &film], 1, "two outputs");
}

/// A film could take the place of the buffer or of the image that its scene refers to. Expected: refused
/// however it is spelled, and both are what they were.
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

/// A node's name could clear the screen, forge a line or turn the text round. Expected: no control character
/// but the ends of lines, wherever the name is told.
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
