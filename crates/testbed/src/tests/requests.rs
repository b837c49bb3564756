//! What can be said and what is answered.

use super::*;
use backstop::Settings;
use std::collections::HashSet;

#[test]
fn a_request_that_is_none_changes_nothing_and_is_told_so() {
    let mut page = Page::open("dominoes");
    let hash = page.steps(3)["hash"].clone();
    for text in [
        "",
        "{",
        "[]",
        "null",
        "\u{0}",
        r#"{"steps": -1}"#,
        r#"{"steps": 1e99}"#,
        r#"{"steps": 1001}"#,
        r#"{"step": 1}"#,
        r#"{"want": ["all"]}"#,
        r#"{"layers": ["paint"]}"#,
        r#"{"commands": [{"do": "restart"}, {"do": "dance"}], "steps": 1}"#,
        r#"{"commands": [{"do": "open"}]}"#,
        r#"{"commands": [{"do": "drag", "to": [1, 2]}]}"#,
        r#"{"commands": [{"do": "drag", "to": [1, 2, null]}]}"#,
        r#"{"commands": [{"do": "drag", "to": [1, 2, 1e999]}]}"#,
    ] {
        let header = page.say(text);
        assert!(header["error"].as_str().is_some_and(|why| !why.is_empty()), "{text}");
        assert_eq!((&header["hash"], &header["step"]), (&hash, &json!(3)), "{text}");
    }
}

#[test]
fn numbers_out_of_range_are_refused() {
    let mut page = Page::open("dominoes");
    page.steps(2);
    let ahead = [0.0, 0.0, -1.0];
    for (command, reason) in [
        (json!({ "do": "open", "name": "no\nsuch" }), "there is no sample or scene \"no\\u{a}such\""),
        (json!({ "do": "seek", "step": 77 }), "step 77 is not kept"),
        (json!({ "do": "grab", "origin": [0, 0, 0], "direction": [0, 0, 0] }), "no length"),
        (json!({ "do": "grab", "origin": [1e30, 0, 0], "direction": ahead }), "ray"),
        (json!({ "do": "shoot", "origin": [0, 1, 0], "direction": ahead, "speed": 1e9 }), "speed must be in"),
        (json!({ "do": "shoot", "origin": [0, 1, 0], "direction": ahead, "speed": -1 }), "speed must be in"),
        (json!({ "do": "spawn", "shape": "box", "position": [0, 1e300, 0] }), "position"),
        (json!({ "do": "spawn", "shape": "box", "position": [0, 1, 0], "size": 0 }), "size must be in"),
        (json!({ "do": "explode", "position": [0, 1, 0], "radius": -1, "impulse": 1 }), "radius"),
        (json!({ "do": "explode", "position": [0, 1, 0], "radius": 1, "impulse": 1e30 }), "impulse"),
        (json!({ "do": "settings", "substeps": 65 }), "substeps must be in 1..=64"),
        (json!({ "do": "settings", "substeps": "many" }), "\"substeps\" can't be"),
        (json!({ "do": "settings", "substep": 4 }), "no setting \"substep\""),
        (json!({ "do": "settings", "substeps": 8, "dt": 0 }), "\"dt\" can't be 0"),
        (json!({ "do": "settings", "gravity": [0, 1e30, 0] }), "gravity"),
        (json!({ "do": "settings", "budget": -5 }), "budget"),
    ] {
        let why = page.refused(command.clone());
        assert!(why.contains(reason), "{command}: {why}");
    }
}

#[test]
fn nothing_can_be_done_before_something_is_open() {
    let mut page = Page::default();
    let header = page.say(r#"{"commands": [{"do": "release"}], "want": ["catalogue", "fields", "scene"]}"#);
    assert_eq!(header["error"], "no scene is open");
    assert_eq!(header["sections"], json!([]));
    let names =
        |key: &str| header[key].as_array().unwrap().iter().map(|e| e["name"].clone()).collect::<Vec<_>>();
    assert!(["dominoes", "talk", "rain"].iter().all(|name| names("catalogue").contains(&json!(name))));
    assert_eq!(names("fields").len(), Settings::FIELDS.len());
    // A session with nothing open has no steps.
    assert_eq!(page.steps(5)["error"], Value::Null);
}

/// Expected: every entry of the catalogue opens, and its parts fit together.
#[test]
fn what_the_catalogue_names_is_opened_and_drawn() {
    let mut page = Page::default();
    let catalogue = page.ask(&json!({ "want": ["catalogue"] }))["catalogue"].clone();
    let names: HashSet<&str> =
        catalogue.as_array().unwrap().iter().map(|entry| entry["name"].as_str().unwrap()).collect();
    assert_eq!(names.len(), catalogue.as_array().unwrap().len(), "two entries have one name");
    for entry in catalogue.as_array().unwrap() {
        let open = json!({ "do": "open", "name": entry["name"], "size": entry["least"] });
        let header = page.ask(&json!({ "commands": [open], "steps": 2, "want": ["scene", "ledger"] }));
        assert!(!entry["title"].as_str().unwrap().is_empty() && !entry["about"].as_str().unwrap().is_empty());
        let instances = page.numbers(&header, "instances");
        let poses = page.numbers(&header, "poses");
        assert_eq!(4 * instances.len(), poses.len());
        assert!(poses.iter().all(|number| number.is_finite()));
        let meshes = header["meshes"]["count"].as_u64().unwrap();
        for index in 0..meshes {
            let corners = page.numbers(&header, &format!("mesh{index}")).len();
            assert!(corners > 0 && corners.is_multiple_of(9));
        }
        assert!(instances.chunks(2).all(|pair| (pair[0] as u64) < meshes && pair[1] < 9.0));
        let links = page.numbers(&header, "links");
        assert!(links.iter().all(|&place| (place as usize) < instances.len() / 2));
        // A body without shapes has no place to lead to.
        assert!(Page::count(&header, "joints") as usize >= links.len() / 2, "{}", entry["name"]);
        assert!(!links.is_empty() || !["ragdolls", "windmill"].iter().any(|name| entry["name"] == *name));
        assert!(crate::knows(entry["name"].as_str().unwrap()));
    }
    assert!(crate::knows("deflector") && crate::knows("tower_5") && !crate::knows("file"));
}

#[test]
fn a_page_gets_only_the_meshes_that_it_lacks() {
    let mut page = Page::open("dominoes");
    let first = page.ask(&json!({ "want": ["scene"] }));
    let known = json!([first["opened"], first["meshes"]["count"]]);
    let spawn = json!({ "do": "spawn", "shape": "cone", "position": [0, 3, 0] });
    let second = page.ask(&json!({ "commands": [spawn], "want": ["scene"], "meshes": known }));
    assert_ne!(first["revision"], second["revision"]);
    let count = first["meshes"]["count"].as_u64().unwrap();
    assert_eq!(second["meshes"], json!({ "first": count, "count": count + 1 }));
    assert!(!page.numbers(&second, &format!("mesh{count}")).is_empty());
    // Those of another opening are none of this one.
    let third = page.ask(&json!({ "commands": [{ "do": "restart" }], "want": ["scene"], "meshes": known }));
    assert_eq!(third["meshes"], json!({ "first": 0, "count": count }));
}

#[test]
fn layers_have_points_lines_and_tints() {
    let mut page = Page::open("ragdolls");
    let layers = [
        "contacts",
        "normals",
        "impulses",
        "joints",
        "aabbs",
        "fat_aabbs",
        "motion",
        "centres",
        "colours",
        "islands",
        "trees",
        "sleep",
    ];
    page.steps(80);
    for layer in layers {
        let header = page.ask(&json!({ "layers": [layer] }));
        let [points, lines, tints] = ["points", "lines", "tints"].map(|name| page.numbers(&header, name));
        let tones = header["tones"].as_array().unwrap().len() as f32;
        match layer {
            "contacts" => assert!(!points.is_empty() && points.chunks(4).all(|p| p[3] < 3.0)),
            "centres" => assert!(points.chunks(4).all(|p| p[3] == 3.0) && !lines.is_empty()),
            "islands" | "trees" | "sleep" => {
                assert!(tints.iter().any(|&t| t >= 0.0) && tints.iter().all(|&t| t < tones), "{layer}");
            }
            _ => assert!(!lines.is_empty() || layer == "motion", "{layer}"),
        }
        assert!(lines.chunks(4).all(|end| end[3] >= 0.0 && end[3] < tones));
        let shapes = page.numbers(&header, "poses").len() / 8;
        assert!(tints.is_empty() || tints.len() == shapes);
    }
    // Six figures of ten joints each: six trees.
    let trees = page.ask(&json!({ "layers": ["trees"] }));
    assert_eq!(trees["tones"].as_array().unwrap().len(), 6);
}

/// Expected: whatever is asked for, a frame whose numbers are finite.
#[test]
fn no_numbers_make_it_panic() {
    let mut rng = backstop_scene::Rng::new(7);
    let extremes = [0.0, -0.0, 1.0, -1.0, 0.3, 5.0, 60.0, -1e-30, 1e6, -1e6, 1e9, 1e15, 1e38, -1e300];
    let mut number = move || extremes[rng.range(0.0, extremes.len() as f32) as usize % extremes.len()];
    let shapes = ["box", "sphere", "capsule", "tapered_capsule", "cylinder", "cone", "hull", "ragdoll"];
    let names = ["dominoes", "windmill", "chain", "deflector"];
    let mut page = Page::open("dominoes");
    let mut refusals = 0;
    for i in 0..3000_usize {
        let [a, b] = [(); 2].map(|()| json!([number(), number(), number()]));
        let (x, y) = (number(), number());
        let command = match i % 13 {
            0 => json!({ "do": "spawn", "shape": shapes[i / 13 % 8], "position": a, "size": x }),
            1 => {
                json!({ "do": "shoot", "origin": a, "direction": b, "speed": x, "shape": shapes[i / 13 % 8] })
            }
            2 => json!({ "do": "grab", "origin": a, "direction": b }),
            3 => json!({ "do": "drag", "to": a }),
            4 => json!({ "do": "remove", "origin": a, "direction": b }),
            5 => json!({ "do": "explode", "position": a, "radius": x, "impulse": y }),
            6 => json!({ "do": "inspect", "origin": a, "direction": b }),
            7 => json!({ "do": "controls", "forward": x, "right": y, "jump": i % 2 == 0 }),
            8 => json!({ "do": "settings", "gravity": a, "dt": x }),
            9 => json!({ "do": "settings", "slop": x, "contact_hertz": y, "sleeping": i % 2 == 0 }),
            10 => json!({ "do": "back", "steps": i % 5 }),
            11 => json!({ "do": if i % 2 == 0 { "release" } else { "restart" } }),
            _ if i % 100 == 12 => json!({ "do": "open", "name": names[i / 100 % 4] }),
            _ => json!({ "do": "seek", "step": i % 40 }),
        };
        let layers = ["contacts", "joints", "islands", "centres", "motion", "trees"];
        let request = json!({ "commands": [command], "steps": i % 3, "layers": layers, "want": ["scene"] });
        let header = page.say(&request.to_string());
        refusals += usize::from(header["error"] != Value::Null);
        assert!(page.numbers(&header, "poses").iter().all(|n| n.is_finite()), "{request}");
    }
    // Most are out of some range; many are not.
    assert!((500..2800).contains(&refusals), "{refusals}");
}
