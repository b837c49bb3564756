//! Names in backticks in pages exist: paths, types with their items, and functions.

use crate::guide::all_pages;
use std::collections::BTreeSet;
use std::path::{Component, Path, PathBuf};

/// Pages whose names are those of another time, or of other engines.
const ELSEWHERE: &[&str] = &["docs/coming-from.md"];
/// Crates whose items are not defined here.
const CRATES: &[&str] = &["std", "core", "glam", "rayon", "ThreadPool", "bevy"];
/// A path with one of these says which name one gives.
const OWN: &[&str] = &["NAME", "FILE", "sphere_cylinder"];

/// Files of the repository with their paths, and all words in those that are code.
#[derive(Default)]
struct Repository {
    files: BTreeSet<PathBuf>,
    folders: BTreeSet<PathBuf>,
    words: BTreeSet<String>,
}

impl Repository {
    fn read(root: &Path) -> Repository {
        let mut all = Repository::default();
        let mut folders = vec![PathBuf::new()];
        while let Some(folder) = folders.pop() {
            for entry in std::fs::read_dir(root.join(&folder)).into_iter().flatten().flatten() {
                let path = folder.join(entry.file_name());
                let name = entry.file_name().to_string_lossy().into_owned();
                if !entry.path().is_dir() {
                    all.add(root, path);
                } else if !["target", "node_modules", ".git", "corpus"].contains(&name.as_str()) {
                    all.folders.insert(path.clone());
                    folders.push(path);
                }
            }
        }
        all
    }

    fn add(&mut self, root: &Path, path: PathBuf) {
        let is_code = match path.extension().and_then(|end| end.to_str()) {
            Some(end) => ["rs", "h", "c", "cpp", "toml", "html", "js", "mjs", "awk", "yml"].contains(&end),
            None => path.starts_with("scripts") || path.starts_with(".ci"),
        };
        if is_code && let Ok(text) = std::fs::read_to_string(root.join(&path)) {
            let words = text.split(|c: char| !(c.is_alphanumeric() || c == '_'));
            self.words.extend(words.map(str::to_owned));
        }
        self.files.insert(path);
    }

    /// Whether a path is one from the root or from the folder of a page, or the end of one.
    fn has(&self, path: &str, page: &Path) -> bool {
        let is_there = |path: &Path| self.files.contains(path) || self.folders.contains(path);
        let from_page = normal(&page.parent().unwrap_or(Path::new("")).join(path));
        is_there(Path::new(path))
            || is_there(&from_page)
            || self.files.iter().chain(&self.folders).any(|own| own.ends_with(path))
    }
}

/// A path without `..`.
fn normal(path: &Path) -> PathBuf {
    path.components().fold(PathBuf::new(), |mut out, part| {
        match part {
            Component::ParentDir => drop(out.pop()),
            part => out.push(part),
        }
        out
    })
}

/// Whether a name in backticks is a path: it ends as files of ours do, or as a folder.
fn is_path(span: &str) -> bool {
    let plain = span.chars().all(|c| c.is_alphanumeric() || "_-./".contains(c));
    let ends = [".rs", ".md", ".toml", ".h", ".jsonl"].iter().any(|end| span.ends_with(end));
    plain && (ends || (span.contains('/') && span.ends_with('/'))) && span.len() > 1
}

/// The names of `Type::method`, `module::function()` or `function()`.
fn names(span: &str) -> Option<Vec<&str>> {
    let bare = span.strip_suffix("()");
    let path = bare.unwrap_or(span);
    let names: Vec<&str> = path.split("::").collect();
    let is_name = |name: &&str| {
        name.starts_with(|c: char| c.is_alphabetic() || c == '_')
            && name.chars().all(|c| c.is_alphanumeric() || c == '_')
    };
    (names.iter().all(is_name) && (names.len() > 1 || bare.is_some())).then_some(names)
}

fn offences(all: &Repository, page: &Path, text: &str) -> Vec<String> {
    let mut found = Vec::new();
    let mut within = false;
    for line in text.lines() {
        if line.trim_start().starts_with("```") {
            within = !within;
        } else if !within {
            for span in line.split('`').skip(1).step_by(2) {
                let missing = if OWN.iter().any(|own| span.contains(own)) {
                    false
                } else if is_path(span) {
                    !all.has(span.trim_end_matches('/'), page)
                } else if let Some(names) = names(span) {
                    !CRATES.contains(&names[0]) && names.iter().any(|name| !all.words.contains(*name))
                } else {
                    false
                };
                if missing {
                    found.push(format!("{}: {span}", page.display()));
                }
            }
        }
    }
    found
}

#[test]
fn what_pages_name_exists() {
    let all = Repository::read(Path::new(env!("CARGO_MANIFEST_DIR")));
    let pages = all_pages();
    let own = pages.iter().filter(|(page, _)| !ELSEWHERE.iter().any(|other| page == Path::new(other)));
    let found: Vec<String> = own.flat_map(|(page, text)| offences(&all, page, text)).collect();
    crate::none("names in backticks", &found);
}

/// The rule finds its offences.
#[test]
fn a_name_that_is_gone_is_found() {
    let mut all = Repository::default();
    all.files.insert("src/a.rs".into());
    all.folders.insert("src".into());
    all.words.extend(["World", "step"].map(str::to_owned));
    let text = "`src/a.rs` `a.rs` `src/` `World::step` `step()` `0.5`\n```sh\n`b.rs`\n```\n\
                `b.rs` `World::stop` `stop()` `old/`";
    let found = offences(&all, Path::new("docs/page.md"), text);
    let expected = ["`b.rs`", "`World::stop`", "`stop()`", "`old/`"]
        .map(|span| format!("docs/page.md: {}", span.trim_matches('`')));
    assert_eq!(found, expected);
}
