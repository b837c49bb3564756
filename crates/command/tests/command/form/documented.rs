//! docs/json.md names the fields that there are, two other pages the examples and commands, and no other.

use super::*;
use std::collections::{BTreeMap, BTreeSet};

/// The rows of a section's table: names in their first cell, and the text of the second.
fn rows(section: &str) -> Vec<(Vec<String>, String)> {
    let page = include_str!("../../../../../docs/json.md");
    let start = page.find(&format!("## `cargo backstop {section}")).expect("a section");
    let section = page[start + 2..].split("\n## ").next().expect("its text");
    let row = |line: &str| {
        let (names, text) = line.strip_prefix("| `")?.split_once("` | ")?;
        Some((names.split("`, `").map(str::to_owned).collect(), text.to_owned()))
    };
    section.lines().filter_map(row).collect()
}

/// Names within a place of the document, by that place: `""` is the whole.
fn documented(rows: &[(Vec<String>, String)]) -> BTreeMap<String, BTreeSet<String>> {
    let mut places = BTreeMap::<String, BTreeSet<String>>::new();
    for path in rows.iter().flat_map(|(names, _)| names) {
        let mut place = String::new();
        for name in path.split('.').map(|part| part.trim_end_matches("[]")) {
            places.entry(place.clone()).or_default().insert(name.into());
            place = if place.is_empty() { name.into() } else { format!("{place}.{name}") };
        }
    }
    places
}

fn agrees(document: &Value, section: &str) {
    let rows = rows(section);
    for (place, names) in documented(&rows) {
        let mut value = document;
        for part in place.split('.').filter(|part| !part.is_empty()) {
            value = &value[part];
            value = value.get(0).unwrap_or(value);
        }
        // `null` has nothing to compare.
        if value.is_null() {
            continue;
        }
        let found: BTreeSet<String> = keys(value).into_iter().map(str::to_owned).collect();
        assert_eq!(found, names, "{section}: {place}");
    }
    // Fields that a row's text names rather than rows of their own.
    for (field, inner) in document.as_object().expect("an object") {
        let own = documented(&rows).contains_key(field.as_str());
        let inner = inner.get(0).unwrap_or(inner);
        let Some((_, text)) = rows.iter().find(|(names, _)| names.contains(field)).filter(|_| !own) else {
            continue;
        };
        for key in keys(inner) {
            let told = text.contains(&format!("`{key}`"))
                || field == "settings" && text.starts_with("As for `run`")
                || text.contains("as for `run`");
            assert!(told, "{section}: {field} has `{key}`, which its row does not name");
        }
    }
}

#[test]
fn fields_are_those_that_are_documented() {
    let run = ["run", "scenes/tower.gltf", "--steps", "5", "--json", "--accuracy", "--solver", "gs-cone"];
    agrees(&document(&backstop(&run)), "run");
    let plan = ["plan", "scenes/tower.gltf", "--steps", "5", "--json", "--budget", "4MiB"];
    agrees(&document(&backstop(&plan)), "plan");
    let profile = ["profile", "scenes/tower.gltf", "--steps", "2", "--repeats", "1", "--json"];
    let profile = [&profile[..], &["--threads", "1", "--no-compare"]].concat();
    let mut document = document(&backstop(&profile));
    // The output of `compare`, which `--no-compare` leaves out.
    document["comparison"] = Value::Null;
    agrees(&document, "profile");
}

/// Expected: the step as it was given, in as few digits as tell it from its neighbours.
#[test]
fn numbers_are_as_short_as_they_can_be() {
    let output = backstop(&["run", "tall_stack", "--steps", "1", "--json"]);
    let text = String::from_utf8(output.stdout).expect("UTF-8");
    assert!(text.contains("\"dt\": 0.016666668,"), "{text}");
}

#[test]
fn a_cause_is_told_once_and_one_is_no_plural() {
    let errors = String::from_utf8(backstop(&["run", "no/such/file.glb"]).stderr).expect("UTF-8");
    assert_eq!(errors.matches("o such file").count(), 1, "{errors}");
    let text = String::from_utf8(backstop(&["run", "tall_stack", "--steps", "2"]).stdout).expect("UTF-8");
    assert!(text.contains("2 of 1/60 s (0.03 s), 4 substeps, 1 iteration, 1 thread, segment"), "{text}");
}

/// Names in backquotes at the start of a page's line that `starts` with this.
fn named(page: &str, starts: &str) -> BTreeSet<String> {
    let names = |line: &str| Some(line.strip_prefix(starts)?.split(['|', ':']).next()?.to_owned());
    let cells = page.lines().filter_map(names);
    let name = |part: &str| part.split([' ', '`']).next().map(str::to_owned);
    cells.flat_map(|cell| cell.split("`, `").filter_map(name).collect::<Vec<_>>()).collect()
}

#[test]
fn a_page_names_every_example() {
    let named = named(include_str!("../../../../../docs/features.md"), "| `");
    for file in std::fs::read_dir(concat!(env!("CARGO_MANIFEST_DIR"), "/../../examples")).expect("examples") {
        let path = file.expect("a file").path();
        let name = path.file_stem().and_then(|name| name.to_str()).expect("a name");
        assert!(named.contains(name), "{name}");
    }
}

#[test]
fn a_page_names_every_command() {
    let named = named(include_str!("../../../../../docs/command.md"), "`");
    let help = String::from_utf8(backstop(&["--help"]).stdout).expect("UTF-8");
    let commands = help.split("Commands:\n").nth(1).and_then(|text| text.split("\n\n").next());
    for line in commands
        .expect("commands")
        .lines()
        .filter(|line| line.starts_with("  ") && line.as_bytes()[2] != b' ')
    {
        let name = line.split_whitespace().next().expect("a name");
        assert!(name == "help" || named.contains(name), "{name}");
    }
}
