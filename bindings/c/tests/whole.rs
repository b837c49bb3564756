//! The interface has the whole of the crate's: each public method of these types has its twin, or is named
//! here with what stands for it.

use std::collections::{BTreeMap, BTreeSet};
use std::fs;
use std::path::Path;

/// The sought subject, and the prefix of its functions.
const TYPES: [(&str, &[&str]); 3] =
    [("World", &["world", "body", "shape"]), ("Character", &["character"]), ("Ragdoll", &["ragdoll"])];

/// Methods whose twin is of another name.
const TWINS: [(&str, &str); 30] = [
    ("new", "bs_world_create"),
    ("contacts_of", "bs_body_contacts"),
    ("body_count", "bs_world_counts"),
    ("joint_count", "bs_world_counts"),
    ("sleeping_body_count", "bs_world_counts"),
    ("sleeping_island_count", "bs_world_counts"),
    ("contains", "bs_world_contains_body"),
    ("set_joint_limits", "bs_joint_set"),
    ("set_joint_motors", "bs_joint_set"),
    ("coupling", "bs_coupling_desc"),
    ("couplings_of", "bs_joint_couplings"),
    ("frames_at", "bs_joint_frames_at"),
    ("frames_about", "bs_joint_frames_about"),
    ("joints_of", "bs_body_joints"),
    ("position", "bs_body_pose"),
    ("rotation", "bs_body_pose"),
    ("centre_of_mass", "bs_body_centre_of_mass"),
    ("linear_velocity", "bs_body_velocity"),
    ("angular_velocity", "bs_body_velocity"),
    ("body_of", "bs_shape_body"),
    ("has_events", "bs_shape_has_events"),
    ("set_events", "bs_shape_set_events"),
    ("sensor_overlaps", "bs_sensor_overlaps"),
    ("feet", "bs_character_position"),
    ("with_shape", "bs_character_set_shape"),
    ("set_settings", "bs_character_set_settings"),
    ("drive_to", "bs_ragdoll_drive_to"),
    ("relax", "bs_ragdoll_relax"),
    ("walk", "bs_character_walk"),
    ("set_position", "bs_character_set_position"),
];

/// Methods without a twin: hooks are code in the middle of a step, on its threads; the bytes that a budget
/// promises to rows of joints are for tests of budgets; scenes, which ask for all of their contents at once,
/// are not in C; an explosion is nearest points and impulses, which are.
const WITHOUT: [&str; 6] =
    ["allow", "step_with", "has_hooks", "set_hooks", "memory_promised", "apply_explosion"];

/// Words of a name in order: `set_joint_motor` and `joint_set_drive` are the same.
fn words(name: &str) -> Vec<&str> {
    let mut words: Vec<_> = name.split('_').collect();
    words.sort_unstable();
    words
}

/// The public methods of a type in a source text: those of its `impl` blocks that are formatted.
fn methods<'a>(text: &'a str, of: &str) -> Vec<&'a str> {
    let mut found = Vec::new();
    let begin = format!("impl {of} {{");
    let mut inside = false;
    for line in text.lines() {
        inside = if line.starts_with(&begin) { true } else { inside && line != "}" };
        let name = line.strip_prefix("    pub fn ").or(line.strip_prefix("    pub const fn "));
        if let Some(name) = name.filter(|_| inside) {
            found.extend(name.split(['(', '<']).next());
        }
    }
    found
}

fn texts(folder: &Path, into: &mut Vec<String>) {
    for entry in fs::read_dir(folder).expect("the sources of the engine").flatten() {
        let path = entry.path();
        // The feature `observe` is for measuring the engine.
        if path.is_dir() && !path.ends_with("src/observe") {
            texts(&path, into);
        } else if path.extension().is_some_and(|end| end == "rs") {
            into.push(fs::read_to_string(path).expect("a source in UTF-8"));
        }
    }
}

#[test]
fn every_method_has_its_twin() {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR"));
    // A package without the engine beside it has nothing to compare.
    if !folder.join("../../src/lib.rs").exists() {
        return;
    }
    let header = fs::read_to_string(folder.join("include/backstop.h")).expect("the header");
    let functions: BTreeSet<&str> = header
        .lines()
        .filter(|line| !line.starts_with("//"))
        .filter_map(|line| line.split_once('(')?.0.split([' ', '*']).next_back())
        .filter(|name| name.starts_with("bs_"))
        .collect();
    assert!(functions.len() > 250, "{functions:?}");
    let twins: BTreeMap<&str, &str> = TWINS.into();
    for twin in twins.values() {
        assert!(functions.contains(twin), "{twin} is not in the header");
    }
    let mut sources = Vec::new();
    texts(&folder.join("../../src"), &mut sources);
    for (of, prefixes) in TYPES {
        let mut have = BTreeSet::new();
        for name in functions.iter().filter_map(|name| name.strip_prefix("bs_")) {
            have.insert(words(name));
            if let Some((prefix, rest)) = name.split_once('_')
                && prefixes.contains(&prefix)
            {
                have.insert(words(rest));
            }
        }
        let all: Vec<_> = sources.iter().flat_map(|text| methods(text, of)).collect();
        assert!(!all.is_empty(), "no methods of {of} were found");
        let missing: Vec<_> = all
            .into_iter()
            .filter(|name| {
                !have.contains(&words(name)) && !twins.contains_key(name) && !WITHOUT.contains(name)
            })
            .collect();
        assert!(missing.is_empty(), "methods of {of} without a twin in C: {missing:?}");
    }
}
