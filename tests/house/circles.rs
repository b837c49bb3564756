//! Which files of the library know each other in a circle.
//!
//! An arrow goes from a file to the one that *defines* an item that it names: paths are followed through
//! `use`, through reexports of a `mod.rs`, and through `*`. To declare a module, or to reexport a name
//! without using it, is no arrow. Methods of a type count with the file of the type, wherever their `impl`
//! is; unit tests don't count.

use crate::layers::reachable;
use crate::source::Source;
use std::collections::{BTreeMap, BTreeSet};
use std::fmt;

/// A module by its names from the root of the crate, or a path as it is written.
type Path = Vec<String>;

/// The meaning of a path: an item defined in a file, by the place of the file; or a module.
#[derive(Clone, Debug, PartialEq)]
enum Target {
    Item(usize),
    Module(Path),
}

/// Names of a module, besides the modules below it.
#[derive(Default)]
struct Scope {
    file: usize,
    items: BTreeSet<String>,
    /// The meaning of an imported name.
    imports: BTreeMap<String, Path>,
    /// Paths before a `*`.
    globs: Vec<Path>,
}

/// A path in the code of a file.
struct Mention {
    module: Path,
    path: Path,
}

/// Names that are followed at most, where imports go in a circle themselves.
const STEPS: usize = 16;

/// Files that name each other: for each pair of them the names.
pub(crate) type Arrows = BTreeMap<(String, String), BTreeSet<String>>;

/// Arrows among the files of the library.
pub(crate) fn arrows(sources: &[Source]) -> Arrows {
    let tests: Vec<String> = sources.iter().flat_map(Source::test_modules).collect();
    let is_test =
        |path: &str| tests.iter().any(|t| path == format!("{t}.rs") || path.starts_with(&format!("{t}/")));
    let mut library = Library::default();
    let mut mentions = Vec::new();
    for (file, source) in sources.iter().enumerate().filter(|(_, source)| !is_test(&source.path)) {
        let mut reader = Reader { file, tokens: tokens(source), at: 0, module: source.module() };
        library.enter(&reader.module, file);
        reader.read(usize::MAX, &mut library, &mut |mention| mentions.push((file, mention)));
    }
    let mut found = Arrows::new();
    for (file, mention) in &mentions {
        if let Some(to) = library.target(mention).filter(|to| to != file) {
            let ends = (sources[*file].path.clone(), sources[to].path.clone());
            found.entry(ends).or_default().insert(mention.path.last().cloned().unwrap_or_default());
        }
    }
    found
}

/// Files of which each reaches each other one, and the names that they use of each other.
pub(crate) struct Circle {
    pub(crate) files: Vec<String>,
    arrows: Arrows,
}

impl fmt::Display for Circle {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{} files", self.files.len())?;
        self.arrows.iter().try_for_each(|((from, to), names)| {
            let names: Vec<&str> = names.iter().map(String::as_str).collect();
            write!(f, "\n    {from} -> {to}: {}", names.join(", "))
        })
    }
}

/// The circles of more than `most` files.
pub(crate) fn circles(arrows: &Arrows, most: usize) -> Vec<Circle> {
    let mut uses: BTreeMap<&str, BTreeSet<&str>> = BTreeMap::new();
    for (from, to) in arrows.keys() {
        uses.entry(from).or_default().insert(to);
    }
    let reach: BTreeMap<&str, BTreeSet<&str>> =
        uses.keys().map(|&file| (file, reachable(&uses, file))).collect();
    let mut found = Vec::new();
    let mut seen = BTreeSet::new();
    for (file, reached) in reach.iter().filter(|(file, reached)| reached.contains(*file)) {
        let comes_back = |other: &&str| reach.get(other).is_some_and(|back| back.contains(file));
        let files: BTreeSet<&str> = reached.iter().copied().filter(comes_back).collect();
        if files.len() <= most || !seen.insert(files.clone()) {
            continue;
        }
        let inside = |file: &String| files.contains(file.as_str());
        let among = arrows.iter().filter(|((from, to), _)| inside(from) && inside(to));
        let arrows = among.map(|(ends, names)| (ends.clone(), names.clone())).collect();
        found.push(Circle { files: files.into_iter().map(str::to_owned).collect(), arrows });
    }
    found
}

/// The modules of the crate.
#[derive(Default)]
struct Library {
    scopes: BTreeMap<Path, Scope>,
}

impl Library {
    fn enter(&mut self, module: &[String], file: usize) {
        self.scopes.entry(module.to_vec()).or_default().file = file;
    }

    fn scope(&mut self, module: &[String]) -> &mut Scope {
        self.scopes.entry(module.to_vec()).or_default()
    }

    /// The file that defines what is meant. An import of a module is none of what is in it: that is named
    /// where it is used.
    fn target(&self, mention: &Mention) -> Option<usize> {
        match self.resolve(&mention.module, &mention.path, STEPS)? {
            Target::Item(file) => Some(file),
            Target::Module(_) => None,
        }
    }

    /// The meaning of a path in a module; none for a path into another crate.
    fn resolve(&self, module: &[String], path: &[String], steps: usize) -> Option<Target> {
        let steps = steps.checked_sub(1)?;
        let mut here = module.to_vec();
        let mut rest = path;
        let mut led_here = false;
        while let [first, others @ ..] = rest {
            match first.as_str() {
                "crate" => here.clear(),
                "self" => {}
                "super" => drop(here.pop()?),
                _ => break,
            }
            (rest, led_here) = (others, true);
        }
        while let [first, others @ ..] = rest {
            match self.look_up(&here, first, others.is_empty(), steps) {
                Some(Target::Module(module)) => (here, rest, led_here) = (module, others, true),
                // Items of macros are not seen, but must be in the module: the compiler found them.
                None if led_here => return Some(Target::Item(self.scopes.get(&here)?.file)),
                found => return found,
            }
        }
        Some(Target::Module(here))
    }

    /// What a name in a module stands for. A function may be called as a module is: at the end of a path the
    /// function is meant.
    fn look_up(&self, module: &[String], name: &str, last: bool, steps: usize) -> Option<Target> {
        let steps = steps.checked_sub(1)?;
        let scope = self.scopes.get(module)?;
        let below: Path = module.iter().cloned().chain([name.to_owned()]).collect();
        let is_module = self.scopes.contains_key(&below);
        if scope.items.contains(name) && (last || !is_module) {
            return Some(Target::Item(scope.file));
        }
        let import = scope.imports.get(name).and_then(|path| self.resolve(module, path, steps));
        if is_module && !(last && matches!(import, Some(Target::Item(_)))) {
            return Some(Target::Module(below));
        }
        import.or_else(|| {
            scope.globs.iter().find_map(|glob| match self.resolve(module, glob, steps)? {
                Target::Module(of) => self.look_up(&of, name, last, steps),
                Target::Item(_) => None,
            })
        })
    }
}

/// Goes through the code of a file.
struct Reader {
    file: usize,
    tokens: Vec<String>,
    at: usize,
    module: Path,
}

impl Reader {
    fn token(&self, ahead: usize) -> &str {
        self.tokens.get(self.at + ahead).map_or("", String::as_str)
    }

    /// Reads up to the bracket that closes the module, and hands out the paths.
    fn read(&mut self, end: usize, library: &mut Library, mention: &mut impl FnMut(Mention)) {
        let mut depth = 0;
        // Of the item that is read: whether it is given out, and where its visibility begins.
        let mut public = false;
        while self.at < self.tokens.len().min(end) {
            let token = self.token(0).to_owned();
            match token.as_str() {
                "{" => depth += 1,
                "}" => depth -= 1,
                "pub" => {
                    public = true;
                    if self.token(1) == "(" {
                        self.at = matching(&self.tokens, self.at + 1);
                    }
                    self.at += 1;
                    continue;
                }
                "use" => {
                    self.at += 1;
                    let mut leaves = Vec::new();
                    self.leaves(&mut Vec::new(), &mut leaves);
                    for (name, path) in leaves {
                        let scope = library.scope(&self.module);
                        match name.as_str() {
                            "*" => scope.globs.push(path),
                            _ => {
                                scope.imports.insert(name, path.clone());
                                if !public {
                                    mention(Mention { module: self.module.clone(), path });
                                }
                            }
                        }
                    }
                }
                "mod" if self.token(2) == "{" => {
                    let inside = matching(&self.tokens, self.at + 2);
                    self.module.push(self.token(1).to_owned());
                    library.enter(&self.module, self.file);
                    self.at += 3;
                    self.read(inside, library, mention);
                    self.module.pop();
                }
                "mod" => self.at += 1,
                "macro_rules" => {
                    let name = self.token(2).to_owned();
                    library.scope(&self.module).items.insert(name);
                    self.at += 2;
                }
                "fn" | "struct" | "enum" | "union" | "trait" | "type" | "const" | "static"
                    if depth == 0 && !matches!(self.token(1), "fn" | "unsafe" | "extern" | "async") =>
                {
                    let name = if self.token(1) == "mut" { self.token(2) } else { self.token(1) };
                    library.scope(&self.module).items.insert(name.to_owned());
                    self.at += 1;
                }
                "." => self.at += 1, // a field or a method
                _ if is_name(&token) => {
                    let mut path = Vec::from([token]);
                    while self.token(1) == ":" && self.token(2) == ":" && is_name(self.token(3)) {
                        path.push(self.token(3).to_owned());
                        self.at += 3;
                    }
                    mention(Mention { module: self.module.clone(), path });
                }
                _ => {}
            }
            public &= !matches!(self.token(0), ";" | "{" | "}" | ",");
            self.at += 1;
        }
    }

    /// The names that a `use` brings in, with their paths; ends before what follows.
    fn leaves(&mut self, path: &mut Path, leaves: &mut Vec<(String, Path)>) {
        let above = path.len();
        loop {
            match self.token(0) {
                "{" => {
                    self.at += 1;
                    while !matches!(self.token(0), "}" | "") {
                        self.leaves(path, leaves);
                        self.at += usize::from(self.token(0) == ",");
                    }
                    self.at += 1;
                    break;
                }
                "*" => {
                    leaves.push(("*".to_owned(), path.clone()));
                    self.at += 1;
                    break;
                }
                ":" => self.at += 1,
                name => {
                    let name = name.to_owned();
                    if name != "self" || path.is_empty() {
                        path.push(name);
                    }
                    self.at += 1;
                    if self.token(0) == ":" {
                        continue;
                    }
                    let mut called = path.last().cloned().unwrap_or_default();
                    if self.token(0) == "as" {
                        called = self.token(1).to_owned();
                        self.at += 2;
                    }
                    leaves.push((called, path.clone()));
                    break;
                }
            }
        }
        path.truncate(above);
    }
}

/// Words and signs of a file's code, without that of unit tests.
fn tokens(source: &Source) -> Vec<String> {
    let mut found: Vec<String> = Vec::new();
    let mut joined = false;
    for (at, &c) in source.code.iter().enumerate() {
        let word = c.is_alphanumeric() || c == '_';
        if c.is_whitespace() || source.is_for_tests(at) {
            joined = false;
        } else if word && joined {
            found.last_mut().expect("a word that goes on").push(c);
        } else {
            found.push(c.to_string());
            joined = word;
        }
    }
    found
}

/// The bracket that closes the one at `open`.
fn matching(tokens: &[String], open: usize) -> usize {
    let mut depth = 0;
    for (at, token) in tokens.iter().enumerate().skip(open) {
        match token.as_str() {
            "(" | "[" | "{" => depth += 1,
            ")" | "]" | "}" => depth -= 1,
            _ => {}
        }
        if depth == 0 {
            return at;
        }
    }
    tokens.len()
}

fn is_name(token: &str) -> bool {
    token.starts_with(|c: char| c.is_alphabetic() || c == '_')
}

/// A circle of four, each by another way to name an item of a file: through a reexport of a `mod.rs`, by a
/// module that is imported, within a group, by `*`. A name for tests, only declared, only reexported, or of
/// another crate is no arrow.
#[test]
fn a_circle_is_found_through_every_way_to_name_a_thing() {
    let sources = |last: &str| {
        [
            ("src/lib.rs", "mod room; mod other; pub use room::a::A;"),
            ("src/room/mod.rs", "pub(crate) mod a; mod b; mod c; mod d; pub(crate) use b::{B as Bee, b};"),
            ("src/room/a.rs", "use super::Bee; pub struct A(Bee); use std::fmt; fn f() -> fmt::Result {}"),
            ("src/room/b.rs", "use crate::room::{c, a::x}; pub(crate) struct B; fn b() { c::turn::<u8>() }"),
            ("src/room/c.rs", "use super::d::*; pub(crate) fn turn<T>() -> D { x.a() }"),
            ("src/room/d.rs", last),
            ("src/other.rs", "use crate::A; fn other() -> A {}"),
        ]
        .map(|(path, text)| Source::new(path, text))
    };
    let of = |last: &str| {
        let circles = circles(&arrows(&sources(last)), 3);
        circles.iter().map(ToString::to_string).collect::<Vec<String>>()
    };
    let expected = "4 files
    src/room/a.rs -> src/room/b.rs: Bee
    src/room/b.rs -> src/room/a.rs: x
    src/room/b.rs -> src/room/c.rs: turn
    src/room/c.rs -> src/room/d.rs: D
    src/room/d.rs -> src/room/a.rs: A";
    assert_eq!(of("pub(crate) struct D(crate::A);"), [expected]);
    let none: [String; 0] = [];
    assert_eq!(of("pub(crate) struct D; #[cfg(test)] mod tests { use super::super::a::A; }"), none);
    assert_eq!(of("pub(crate) struct D; pub(crate) use super::a::A; /* crate::A */"), none);
}
