//! The pages of the guide: what they refer to is there, on its own and in the documentation of the crate.

use std::collections::BTreeSet;
use std::path::Path;

const GUIDE: &str = include_str!("../../src/guide.rs");

/// A page's file, and the sources that `src/guide.rs` says it refers to.
fn pages() -> Vec<(String, BTreeSet<String>)> {
    let (_, list) = GUIDE.split_once("pages! {").expect("the list of pages");
    let quoted = |text: &str| text.split('"').skip(1).step_by(2).map(str::to_owned).collect::<Vec<_>>();
    let page = |entry: &str| {
        let (file, sources) = entry.split_once('[')?;
        Some((quoted(file).pop()?, quoted(sources).into_iter().collect()))
    };
    list.split(']').filter_map(page).collect()
}

/// Offences of one page: references without a meaning in one of the two places.
fn offences(file: &str, sources: &BTreeSet<String>) -> Vec<String> {
    let root = Path::new(env!("CARGO_MANIFEST_DIR"));
    let text = std::fs::read_to_string(root.join("docs").join(file)).expect("a page");
    let mut found = Vec::new();
    let mut referred = BTreeSet::new();
    for line in text.lines() {
        let Some((label, to)) = line.strip_prefix('[').and_then(|rest| rest.split_once("]: ")) else {
            continue;
        };
        if label != to {
            found.push(format!("{file}: [{label}] is {to}"));
        }
        if let Some(source) = to.strip_prefix("../src/") {
            referred.insert(source.to_owned());
        } else if !GUIDE.contains(&format!("\"[{to}]: ")) {
            found.push(format!("{file}: {to} is no page of the guide"));
        }
        let path = to.split('#').next().expect("a path");
        if !root.join("docs").join(path).exists() {
            found.push(format!("{file}: {to} is not there"));
        }
    }
    if referred != *sources {
        found.push(format!("{file}: refers to {referred:?}, src/guide.rs knows {sources:?}"));
    }
    // Links within a line lead nowhere in the documentation of the crate.
    for (before, after) in text.match_indices("](").map(|(at, _)| text.split_at(at)) {
        let to = &after[2..after.find(')').expect("a link's end")];
        let image = before.rsplit_once('[').is_some_and(|(start, _)| start.ends_with('!'));
        if !image && !to.starts_with('#') && !to.starts_with("https://") {
            found.push(format!("{file}: a link within a line, to {to}"));
        }
    }
    found
}

#[test]
fn references_of_the_guide_lead_somewhere() {
    let pages = pages();
    assert_eq!(pages.len(), 12, "pages of the guide");
    let found: Vec<String> = pages.iter().flat_map(|(file, sources)| offences(file, sources)).collect();
    super::none("references of the guide", &found);
}
