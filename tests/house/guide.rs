//! The pages of the guide: their references hold, on their own and in the documentation of the crate.
//! Code of all pages: each block is of a language that something checks.

use std::collections::BTreeSet;
use std::path::{Path, PathBuf};

/// The pages whose code is compiled.
const COMPILED: &str = include_str!("../lib.rs");
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
    // Links within a line, those of images too, lead nowhere in the documentation of the crate.
    for (_, after) in text.match_indices("](").map(|(at, _)| text.split_at(at)) {
        let to = &after[2..after.find(')').expect("a link's end")];
        if !to.starts_with('#') && !to.starts_with("https://") {
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

/// The documentation of the crate has pictures as text, which is made of them by
/// `printf 'data:%s;base64,%s\\n' image/png "$(base64 -w0 FILE)" > FILE.uri`.
#[test]
fn pictures_as_text_are_the_pictures() {
    use base64::Engine;
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("docs/images");
    for (file, kind) in [("debug-drawing.png", "image/png"), ("orders.svg", "image/svg+xml")] {
        let bytes = std::fs::read(folder.join(file)).expect("a picture");
        let text = base64::engine::general_purpose::STANDARD.encode(bytes);
        let kept = std::fs::read_to_string(folder.join(format!("{file}.uri"))).expect("its text");
        assert!(kept == format!("data:{kind};base64,{text}\n"), "{file}.uri is of another picture");
    }
}

/// All pages of the repository, but for those that a build made.
pub(crate) fn all_pages() -> Vec<(PathBuf, String)> {
    let root = Path::new(env!("CARGO_MANIFEST_DIR"));
    let (mut folders, mut found) = (vec![PathBuf::from("docs"), PathBuf::from("bindings")], Vec::new());
    found.extend(["README.md", "CONTRIBUTING.md"].map(PathBuf::from));
    while let Some(folder) = folders.pop() {
        for entry in std::fs::read_dir(root.join(&folder)).into_iter().flatten() {
            let entry = entry.expect("a file");
            let path = folder.join(entry.file_name());
            if entry.path().is_dir() && !path.ends_with("target") && !path.ends_with("node_modules") {
                folders.push(path);
            } else if path.extension().is_some_and(|ending| ending == "md") {
                found.push(path);
            }
        }
    }
    found.sort();
    let read = |path: PathBuf| {
        let text = std::fs::read_to_string(root.join(&path)).expect("a page");
        (path, text)
    };
    found.into_iter().map(read).collect()
}

/// Blocks of code of a page: the word behind the fence, and the text.
fn blocks(page: &str) -> Vec<(&str, String)> {
    let mut found: Vec<(&str, String)> = Vec::new();
    let mut within = false;
    for line in page.lines() {
        match line.trim_start().strip_prefix("```") {
            Some(language) if !within => found.push((language, String::new())),
            Some(_) => {}
            None if within => {
                let (_, text) = found.last_mut().expect("a block");
                text.push_str(line);
                text.push('\n');
                continue;
            }
            None => continue,
        }
        within = !within;
    }
    found
}

/// Rust is compiled as documentation (`tests/lib.rs`, and the README of the plugin), C by
/// `scripts/bindings-c`, Python by `bindings/python/tests`, commands are parsed by
/// `crates/command/src/args/documented.rs` and here. Text is no code.
#[test]
fn each_block_of_code_is_checked_by_something() {
    let mut found = Vec::new();
    for (path, page) in all_pages() {
        let name = path.display();
        let is_compiled = COMPILED.contains(&format!("\"{name}\"")) || path.starts_with("bindings/bevy");
        for (language, text) in blocks(&page) {
            match language {
                "rust" | "rust,no_run" if is_compiled => {}
                "c" | "cmake" if path.starts_with("bindings/c") => {}
                "python" if path.starts_with("bindings/python") => {}
                "toml" => {
                    let table = text.parse::<toml::Table>().map_err(|e| e.to_string());
                    let path_of = |table: &toml::Table| {
                        let path = table.get("dependencies")?.get(own_name(&path))?.get("path")?.as_str()?;
                        Some(path.to_owned())
                    };
                    match table.as_ref().map(|table| (table.contains_key("dependencies"), path_of(table))) {
                        Ok((false, _)) | Ok((true, Some(_))) => {}
                        other => found.push(format!("{name}: {other:?} of a block of TOML")),
                    }
                }
                "json" if serde_json::from_str::<serde_json::Value>(&text).is_ok() => {}
                "sh" | "text" => {}
                _ => found.push(format!("{name}: nothing checks a block of \"{language}\"")),
            }
        }
        // A block that is indented has no language: rustdoc would take it for Rust, and nothing else for
        // anything.
        let mut last = "";
        let mut fence = false;
        for line in page.lines() {
            fence ^= line.trim_start().starts_with("```");
            if !fence && last.is_empty() && line.starts_with("    ") {
                found.push(format!("{name}: an indented block, {line}"));
            }
            last = line;
        }
    }
    super::none("blocks of code", &found);
}

/// The package that a page is about.
fn own_name(page: &Path) -> &'static str {
    if page.starts_with("bindings/bevy") { "backstop-bevy" } else { "backstop" }
}

/// The packages whose tests, benches, examples and features commands may name; files of the last lie in
/// folders of the first.
fn members() -> impl Iterator<Item = &'static str> {
    crate::PACKAGES.iter().copied().chain(["tests"])
}

fn features_of(member: &Path) -> Vec<String> {
    let manifest = std::fs::read_to_string(member.join("Cargo.toml")).expect("a manifest");
    let manifest: toml::Table = manifest.parse().expect("TOML");
    let features = manifest.get("features").and_then(toml::Value::as_table);
    features.into_iter().flat_map(|table| table.keys().cloned()).collect()
}

/// `cargo` with tests, benches, examples, features and manifests that there are, in blocks and within lines.
#[test]
fn commands_of_cargo_name_what_there_is() {
    let root = Path::new(env!("CARGO_MANIFEST_DIR"));
    let features: BTreeSet<String> = members().flat_map(|member| features_of(&root.join(member))).collect();
    let exists = |folder: &str, name: &str| {
        let of = |member: &str| {
            let path = root.join(member).join(folder).join(name);
            path.with_extension("rs").exists() || path.join("main.rs").exists()
        };
        name == "NAME" || members().any(of)
    };
    let mut found = Vec::new();
    for (path, page) in all_pages() {
        let lines = blocks(&page).into_iter().filter(|(language, _)| *language == "sh").map(|(_, text)| text);
        let spans = page.split('`').skip(1).step_by(2).map(str::to_owned);
        let text = lines.chain(spans).collect::<Vec<_>>().join("\n");
        for line in text.lines().filter_map(|line| line.trim_start_matches("$ ").strip_prefix("cargo ")) {
            let words: Vec<&str> = line.split_whitespace().take_while(|word| *word != "--").collect();
            let folder = words.iter().position(|word| *word == "--manifest-path").and_then(|at| {
                let manifest = Path::new(words.get(at + 1)?);
                if !root.join(manifest).exists() {
                    found.push(format!("{}: {line}", path.display()));
                }
                manifest.parent().and_then(Path::to_str)
            });
            for pair in words.windows(2) {
                let folder = |own: &str| folder.map_or(own.to_owned(), |folder| format!("{folder}/{own}"));
                let there = match pair[0] {
                    "--test" if words[0] != "backstop" => exists(&folder("tests"), pair[1]),
                    "--bench" => exists(&folder("benches"), pair[1]),
                    "--example" => exists(&folder("examples"), pair[1]),
                    "--features" => pair[1].split(',').all(|one| features.contains(one)),
                    _ => true,
                };
                if !there {
                    found.push(format!("{}: {line}", path.display()));
                }
            }
        }
    }
    super::none("commands of cargo", &found);
}
