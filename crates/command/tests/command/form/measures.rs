//! Profiles, methods, shots and stability.

use super::*;

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
        // A contact that pushed in one frame is confirmed or a ghost in the next.
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
        // Each ball strikes its obstacle. Discrete physics lets them through. Speculative contacts don't:
        // what a bounce throws off its way stands until the next step, which looks along the new one.
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
