//! The house is in order: rules of the sources themselves, read from the files. No rule needs the
//! compiler.
//!
//! - No folder has more than 15 `.rs` files side by side: it has rooms by subject then.
//! - No file is longer than 600 lines.
//! - No function is longer than 80 lines, from the line of its `fn` to that of its closing brace, unit tests
//!   too.
//! - Modules at the first level of `src` use those of layers below their own, in the order that `layers.rs`
//!   states, and never each other in a circle. Unit tests may use all; `lib.rs` names all.
//! - No more than three files know each other in a circle, as `circles.rs` finds it, in any package.
//! - No line is longer than 110 columns; strings don't count, nor a line with a URL in it.
//! - Numbers that were chosen are in `src/config/tuning.rs`, and limits of what a caller may say in
//!   `src/limits.rs`: elsewhere `const NAME: f32` and `f64` are no choices, and a comment above says which
//!   kind they are: `// Rounding: ...` bounds rounding errors, `// Sentinel: ...` marks a state,
//!   `// Guard: ...` ends a range or a search. Unit tests may have others.
//! - glam's types whose arithmetic differs between instruction sets are not imported: engine code computes
//!   with `crate::math::Quat`, and says `glam::Quat` where a caller passes or gets one. Tests may.
//! - Paths, types and functions that pages name in backticks exist.
//! - Pages of the guide refer to each other and to sources so that the links hold in `docs/` and in rustdoc.

mod circles;
mod guide;
mod layers;
mod names;
mod source;

use source::{Part, Source, ident, skip_space, words};
use std::collections::BTreeMap;

const LIBRARY: &[&str] = &["src"];
/// All that is written here but the library.
const AROUND: &[&str] = &["tests", "benches", "examples", "fuzz", "loom", "bindings", "crates"];

const FILES: usize = 15;
const LINES: usize = 600;
const FUNCTION: usize = 80;
const COLUMNS: usize = 110;
/// Files that may know each other in a circle.
const CIRCLE: usize = 3;
/// Folders of the packages of the workspace; the first is that of the library.
const PACKAGES: &[&str] =
    &["", "crates/command/", "crates/lab/", "crates/samples/", "crates/scene/", "crates/testbed/"];

/// Files whose purpose float constants are.
const TUNED: &[&str] = &["src/config/tuning.rs", "src/limits.rs"];

/// Beginnings of the comment above a float constant that is no choice.
const MARKS: &[&str] = &["// Rounding:", "// Sentinel:", "// Guard:"];

/// Types of glam that are SIMD where the target has it, and sum in an order of its own. `Vec3A` is only
/// compared.
const SIMD_TYPES: &[&str] = &["Quat", "Vec4", "Mat2", "Mat3A", "Mat4", "Affine3A"];

/// Fails with all offences at once.
#[track_caller]
fn none(rule: &str, offences: &[String]) {
    assert!(offences.is_empty(), "{rule}: {} offences\n{}", offences.len(), offences.join("\n"));
}

fn crowded_folders(sources: &[Source]) -> Vec<String> {
    let mut files = BTreeMap::<&str, usize>::new();
    for source in sources {
        *files.entry(source.path.rsplit_once('/').map_or("", |(folder, _)| folder)).or_default() += 1;
    }
    let crowded = files.into_iter().filter(|(_, count)| *count > FILES);
    crowded.map(|(folder, count)| format!("{folder}: {count} files")).collect()
}

fn long_files(sources: &[Source]) -> Vec<String> {
    let long = sources.iter().filter(|s| s.lines() > LINES);
    long.map(|s| format!("{}: {} lines", s.path, s.lines())).collect()
}

fn long_functions(sources: &[Source]) -> Vec<String> {
    let mut offences = Vec::new();
    for source in sources {
        let long = source.functions().into_iter().filter(|f| f.lines > FUNCTION);
        offences.extend(long.map(|f| format!("{}:{} {}: {} lines", source.path, f.line, f.name, f.lines)));
    }
    offences
}

fn long_lines(sources: &[Source]) -> Vec<String> {
    let mut offences = Vec::new();
    for source in sources {
        let mut start = 0;
        for (number, line) in source.chars.split(|&c| c == '\n').enumerate() {
            let parts = &source.parts[start..start + line.len()];
            start += line.len() + 1;
            let columns = parts.iter().filter(|&&part| part != Part::Literal).count();
            let url = line.windows(3).any(|w| *w == [':', '/', '/']);
            if columns > COLUMNS && !url {
                offences.push(format!("{}:{}: {columns} columns", source.path, number + 1));
            }
        }
    }
    offences
}

fn stray_constants(sources: &[Source]) -> Vec<String> {
    let tests: Vec<String> = sources.iter().flat_map(Source::test_modules).collect();
    let is_test =
        |path: &str| tests.iter().any(|t| path == format!("{t}.rs") || path.starts_with(&format!("{t}/")));
    let mut offences = Vec::new();
    for source in sources.iter().filter(|s| !TUNED.contains(&&*s.path) && !is_test(&s.path)) {
        let lines: Vec<String> = source.chars.split(|&c| c == '\n').map(String::from_iter).collect();
        for at in words(&source.code, "const").into_iter().filter(|&at| !source.is_for_tests(at)) {
            let name_at = skip_space(&source.code, at + "const".len());
            let name = ident(&source.code, name_at);
            let colon = skip_space(&source.code, name_at + name.chars().count());
            let of = ident(&source.code, skip_space(&source.code, colon + 1));
            // Parameters of types begin with `<` or `,`; they can't be floats.
            if source.code.get(colon) != Some(&':') || !matches!(&*of, "f32" | "f64") {
                continue;
            }
            let line = source.line_of(at);
            let above = lines[..line - 1].iter().rev().map(|l| l.trim());
            let mut comment = above.take_while(|l| l.starts_with("//") || l.starts_with("#["));
            if !comment.any(|l| MARKS.iter().any(|mark| l.starts_with(mark))) {
                offences.push(format!("{}:{line} {name}", source.path));
            }
        }
    }
    offences
}

/// Imports of types whose bits depend on the target.
fn imports_of_simd(sources: &[Source]) -> Vec<String> {
    let mut offences = Vec::new();
    for source in sources.iter().filter(|s| !s.path.ends_with("tests.rs")) {
        let text: String = source.code.iter().collect();
        // Unit tests at the end of a file are indented.
        for import in text.split("\nuse glam::").skip(1) {
            let import: Vec<char> = import.chars().take_while(|c| *c != ';').collect();
            let simd = SIMD_TYPES.iter().filter(|name| !words(&import, name).is_empty());
            offences.extend(simd.map(|name| format!("{}: {name}", source.path)));
        }
    }
    offences
}

#[test]
fn no_bit_depends_on_the_types_of_glam() {
    none("imports of glam's SIMD types", &imports_of_simd(&Source::all(LIBRARY)));
    let source = Source::new("src/a.rs", "\nuse glam::{Quat, Vec3};\nmod tests {\n    use glam::Quat;\n}");
    assert_eq!(imports_of_simd(&[source]), ["src/a.rs: Quat"]);
}

#[test]
fn no_folder_of_the_library_is_crowded() {
    none("more than 15 files side by side", &crowded_folders(&Source::all(LIBRARY)));
}

#[test]
fn no_file_of_the_library_is_long() {
    none("files of more than 600 lines", &long_files(&Source::all(LIBRARY)));
}

#[test]
fn no_function_of_the_library_is_long() {
    none("functions of more than 80 lines", &long_functions(&Source::all(LIBRARY)));
}

#[test]
fn no_line_of_the_library_is_long() {
    none("lines of more than 110 columns", &long_lines(&Source::all(LIBRARY)));
}

#[test]
fn chosen_numbers_are_where_they_are_tuned() {
    none("float constants that are not where numbers are tuned", &stray_constants(&Source::all(LIBRARY)));
}

#[test]
fn no_module_uses_one_above_it() {
    none("arrows that point up", &layers::upward(&layers::arrows(&Source::all(LIBRARY))));
}

#[test]
fn no_modules_use_each_other() {
    none("cycles", &layers::cycles(&layers::arrows(&Source::all(LIBRARY))));
}

#[test]
fn no_more_than_three_files_know_each_other_in_a_circle() {
    let mut offences = Vec::new();
    for package in PACKAGES {
        let mut sources = Source::all(&[&format!("{package}src")]);
        // Paths of modules begin at `src`.
        sources.iter_mut().for_each(|source| source.path = source.path[package.len()..].to_owned());
        let circles = circles::circles(&circles::arrows(&sources), CIRCLE);
        offences.extend(circles.iter().map(|circle| format!("{package}: {circle}")));
    }
    none("wide circles of files", &offences);
}

#[test]
fn no_folder_around_the_library_is_crowded() {
    none("more than 15 files side by side", &crowded_folders(&Source::all(AROUND)));
}

#[test]
fn no_file_around_the_library_is_long() {
    none("files of more than 600 lines", &long_files(&Source::all(AROUND)));
}

#[test]
fn no_function_around_the_library_is_long() {
    none("functions of more than 80 lines", &long_functions(&Source::all(AROUND)));
}

#[test]
fn no_line_around_the_library_is_long() {
    none("lines of more than 110 columns", &long_lines(&Source::all(AROUND)));
}

/// The reader itself: text like code in comments and literals is none, and lifetimes are no characters.
#[test]
fn the_reader_knows_code_from_comments_and_literals() {
    let text = r##"
fn one<'a>(x: &'a str) -> char { /* fn no() { /* } */ */ '{' } // fn neither() {
fn two() -> [u8; { 1 + 1 }] {
    let _ = ("}\"", r#"fn three() { ""#, br"\", b'\'', '\\', '"', "\\");
    [0; 2]
}
trait T { fn four(); const F: fn(u32) -> u32; }
"##;
    let source = Source::new("src/a/b.rs", text);
    let functions = source.functions().into_iter().map(|f| (f.name, f.line, f.lines));
    assert_eq!(functions.collect::<Vec<_>>(), [("one".to_owned(), 2, 1), ("two".to_owned(), 3, 4)]);
    assert_eq!((source.module(), source.lines()), (vec!["a".to_owned(), "b".to_owned()], 7));
}

/// The reader of imports: groups, `super` up to the root, names that the root gives out; not tests and
/// visibilities.
#[test]
fn the_reader_finds_what_a_file_uses() {
    let root = Source::new("src/lib.rs", "mod a; mod c; pub use c::{Cat, d::Dog};");
    let text = "
use crate::{one::X, two::{self, y}, Cat};
use super::super::three::Z;
use super::near;
pub(in crate::four) fn f() -> crate::Dog { crate::a::g() }
mod inside { use super::super::super::five; use super::super::near; }
#[cfg(test)]
use crate::six;
#[cfg(all(test, feature = \"lab\"))]
#[path = \"seven_tests.rs\"]
mod seven;
#[cfg(test)]
mod tests { use crate::eight::X; }
";
    let sources =
        [root, Source::new("src/a/b.rs", text), Source::new("src/a/seven_tests.rs", "use crate::nine;")];
    let used: Vec<String> = layers::arrows(&sources).into_iter().map(|arrow| arrow.to).collect();
    assert_eq!(used, ["c", "c", "five", "one", "three", "two"]);
}
