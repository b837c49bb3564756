//! The crate has layers without a cycle: a module uses those before it in this list and none after it, and nothing below the
//! world knows the world.

#![allow(clippy::disallowed_methods, reason = "tests may use all of std")]

use std::path::{Path, PathBuf};

/// The modules of `src/`, from the lowest to the highest.
const LAYERS: &[&[&str]] = &[
    // Foundation.
    &["lanes", "memory", "random", "threads", "error", "limits", "load_limits", "words", "handle", "config"],
    // Data.
    &["shape", "body", "joint"],
    // Stages.
    &["forces", "faults", "broad_phase", "movers", "narrow_phase", "constraint", "statics", "solver"],
    &["finish", "time_of_impact", "events", "sleep"],
    // World.
    &["world", "step"],
    // On a world.
    &["query", "character", "snapshot", "replay", "debug", "scene", "lab", "bench"],
];

/// Code for benches and tests, which build a world for what is below it.
const HARNESS: &[&str] = &["bench.rs", "fixtures.rs", "tests.rs"];

fn sources(folder: &Path, into: &mut Vec<PathBuf>) {
    for entry in std::fs::read_dir(folder).unwrap() {
        let path = entry.unwrap().path();
        if path.is_dir() {
            sources(&path, into);
        } else if path.extension().is_some_and(|ending| ending == "rs") {
            into.push(path);
        }
    }
}

#[test]
fn modules_use_only_what_is_below_them() {
    let order: Vec<&str> = LAYERS.concat();
    let rank = |module: &str| order.iter().position(|&m| m == module);
    let src = Path::new(env!("CARGO_MANIFEST_DIR")).join("src");
    let mut files = Vec::new();
    sources(&src, &mut files);
    let mut wrong = Vec::new();
    for file in &files {
        let inside = file.strip_prefix(&src).unwrap();
        let name = inside.file_name().unwrap().to_str().unwrap();
        let module = inside.iter().next().unwrap().to_str().unwrap().trim_end_matches(".rs");
        if ["lib", "bin"].contains(&module) || HARNESS.contains(&name) || name.ends_with("_tests.rs") {
            continue;
        }
        let own = rank(module).unwrap_or_else(|| panic!("src/{module} has no layer"));
        let text = std::fs::read_to_string(file).unwrap();
        // Tests stand at the end, and may use anything.
        let code = text.split("#[cfg(test)]\nmod tests {").next().unwrap();
        for (number, line) in
            code.lines().enumerate().filter(|(_, line)| !line.trim_start().starts_with("//"))
        {
            for rest in line.split("crate::").skip(1) {
                // One name, or a list of them.
                let list = rest.strip_prefix('{').and_then(|list| list.split('}').next()).unwrap_or(rest);
                let names = list.split(',').take(if rest.starts_with('{') { usize::MAX } else { 1 });
                for used in names {
                    let used = used.trim().split(|c: char| !c.is_alphanumeric() && c != '_').next().unwrap();
                    // What is no module is an item at the root, which is above all.
                    if rank(used).is_none_or(|used| used > own) {
                        wrong.push(format!("{}:{}: {}", inside.display(), number + 1, line.trim()));
                    }
                }
            }
        }
    }
    assert!(files.len() > 200, "the sources were found");
    assert!(wrong.is_empty(), "these use what is above them:\n{}", wrong.join("\n"));
}
