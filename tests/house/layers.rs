//! Which modules at the first level of `src` may use which.

use crate::source::{Source, ident, skip_space, words};
use std::collections::{BTreeMap, BTreeSet};

/// From the ground up. A module uses those of layers before its own.
///
/// Within `stages` the order counts: each may use those before it. Within the others any may use any, as long
/// as there is no cycle.
const LAYERS: &[(&str, &[&str])] = &[
    (
        "foundation",
        &[
            "clock",
            "math",
            "lanes",
            "memory",
            "threads",
            "error",
            "limits",
            "load_limits",
            "words",
            "handle",
            "config",
        ],
    ),
    ("data", &["shape", "body", "joint"]),
    (
        STAGES,
        &[
            "forces",
            "faults",
            "broad_phase",
            "movers",
            "narrow_phase",
            "constraint",
            "statics",
            "solver",
            "finish",
            "time_of_impact",
            "events",
            "sleep",
        ],
    ),
    ("world", &["world", "step"]),
    (
        "on a world",
        &[
            "query",
            "character",
            "snapshot",
            "replay",
            "debug",
            "observe",
            "bench",
            "fields",
            "vehicle",
            "extra",
        ],
    ),
];

/// About in the order of a step: data between stages are defined by the stage that makes them.
const STAGES: &str = "stages";

/// Modules that every unit test may use; no part of the library.
const FOR_TESTS: &[&str] = &["random"];

/// One module of the first level names another.
#[derive(Clone, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub(crate) struct Arrow {
    pub(crate) from: String,
    pub(crate) to: String,
    /// File, line and the path as it is written.
    pub(crate) place: String,
}

/// Arrows of all files but those for unit tests, and of `lib.rs`, which names all.
pub(crate) fn arrows(sources: &[Source]) -> Vec<Arrow> {
    let root = Root::new(sources);
    let tests: Vec<String> = sources.iter().flat_map(Source::test_modules).collect();
    let is_test = |source: &Source| {
        tests.iter().any(|t| source.path == format!("{t}.rs") || source.path.starts_with(&format!("{t}/")))
    };
    let library = |source: &&Source| source.path != "src/lib.rs" && !is_test(source);
    let mut found: Vec<Arrow> = sources.iter().filter(library).flat_map(|s| root.arrows_of(s)).collect();
    found.sort();
    found
}

/// Names that the root of the crate gives out, and the modules that they are from.
struct Root {
    names: BTreeMap<String, String>,
    macros: BTreeMap<String, String>,
}

impl Root {
    fn new(sources: &[Source]) -> Root {
        let mut root = Root { names: BTreeMap::new(), macros: BTreeMap::new() };
        for source in sources {
            let module = source.module().first().cloned().unwrap_or_default();
            for at in words(&source.code, "macro_rules") {
                let name = ident(&source.code, skip_space(&source.code, at + "macro_rules!".len()));
                root.macros.insert(name, module.clone());
            }
        }
        for source in sources.iter().filter(|s| s.path == "src/lib.rs") {
            for at in words(&source.code, "use") {
                root.take_in(&source.code, skip_space(&source.code, at + 3));
            }
        }
        root
    }

    /// The names of one `use` at the root.
    fn take_in(&mut self, code: &[char], at: usize) {
        let module = ident(code, at);
        let statement: String = code[at..].iter().take_while(|&&c| c != ';').collect();
        let Some((_, names)) = statement.split_once("::") else { return };
        for name in names.split(|c: char| !(c.is_alphanumeric() || c == '_')).filter(|name| !name.is_empty())
        {
            self.names.insert(name.to_owned(), module.clone());
        }
    }

    fn arrows_of(&self, source: &Source) -> Vec<Arrow> {
        let own = source.module();
        let Some(from) = own.first() else { return Vec::new() };
        let code = &source.code;
        let mut found = Vec::new();
        let mut add = |at: usize, start: usize| {
            if source.is_for_tests(start) {
                return;
            }
            for name in first_names(code, at) {
                let Some(to) = self.module_of(&name) else { continue };
                if to != *from && !FOR_TESTS.contains(&to.as_str()) {
                    let place = format!("{}:{} {name}", source.path, source.line_of(start));
                    found.push(Arrow { from: from.clone(), to, place });
                }
            }
        };
        for at in words(code, "crate") {
            let visibility = code[..at].ends_with(&['i', 'n', ' ']);
            if let Some(next) = behind_colons(code, at + "crate".len()).filter(|_| !visibility) {
                add(next, at);
            }
        }
        let inline = inline_modules(code);
        for at in words(code, "super") {
            let follows = code[..at].ends_with(&[':', ':']);
            let depth = own.len() + inline.iter().filter(|range| range.contains(&at)).count();
            let (mut ups, mut next) = (1, behind_colons(code, at + 5));
            while let Some(up) = next.filter(|&next| ident(code, next) == "super") {
                (ups, next) = (ups + 1, behind_colons(code, up + 5));
            }
            if let Some(next) = next.filter(|_| !follows && ups == depth) {
                add(next, at);
            }
        }
        found
    }

    /// The module at the first level that a name at the root stands for; none for a name of another crate.
    fn module_of(&self, name: &str) -> Option<String> {
        let named = self.names.get(name).or_else(|| self.macros.get(name));
        match named {
            Some(module) => Some(module.clone()),
            None if name == "glam" || name == "self" => None,
            None => Some(name.to_owned()),
        }
    }
}

/// The names that a path goes on with: one, or those of a group in braces.
fn first_names(code: &[char], at: usize) -> Vec<String> {
    let name = ident(code, at);
    if !name.is_empty() || code.get(at) != Some(&'{') {
        return Vec::from([name]).into_iter().filter(|name| !name.is_empty()).collect();
    }
    let (mut names, mut depth, mut i) = (Vec::new(), 0, at);
    let mut expected = true;
    loop {
        match code.get(i) {
            None => return names,
            Some('{') => depth += 1,
            Some('}') => depth -= 1,
            Some(',') if depth == 1 => expected = true,
            Some(c) if depth == 1 && expected && !c.is_whitespace() => {
                names.push(ident(code, i));
                expected = false;
            }
            Some(_) => {}
        }
        i += 1;
        if depth == 0 {
            return names;
        }
    }
}

/// The name behind `::`.
fn behind_colons(code: &[char], at: usize) -> Option<usize> {
    let colons = code.get(at) == Some(&':') && code.get(at + 1) == Some(&':');
    colons.then(|| skip_space(code, at + 2))
}

/// Bodies of `mod name { ... }`.
fn inline_modules(code: &[char]) -> Vec<std::ops::Range<usize>> {
    let opens = words(code, "mod").into_iter().filter_map(|at| {
        let name = skip_space(code, at + 3);
        let open = skip_space(code, name + ident(code, name).chars().count());
        (code.get(open) == Some(&'{')).then_some(open)
    });
    opens.map(|open| open..crate::source::closing(code, open)).collect()
}

/// Layer, and place in it where that counts.
fn rank(module: &str) -> Option<(usize, usize)> {
    LAYERS.iter().enumerate().find_map(|(layer, (name, modules))| {
        let place = modules.iter().position(|&m| m == module)?;
        Some((layer, if *name == STAGES { place } else { 0 }))
    })
}

/// Arrows that point up, and modules that are in no layer.
pub(crate) fn upward(arrows: &[Arrow]) -> Vec<String> {
    let mut offences = Vec::new();
    for Arrow { from, to, place } in arrows {
        match (rank(from), rank(to)) {
            (Some(own), Some(used)) if used <= own => {}
            (Some(_), Some(_)) => offences.push(format!("{from} -> {to}: {place}")),
            (own, _) => {
                let stranger = if own.is_none() { from } else { to };
                offences.push(format!("{stranger} is in no layer: {from} -> {to}: {place}"));
            }
        }
    }
    offences
}

/// Sets of modules that use each other, each with the arrows among them.
pub(crate) fn cycles(arrows: &[Arrow]) -> Vec<String> {
    let mut uses: BTreeMap<&str, BTreeSet<&str>> = BTreeMap::new();
    for arrow in arrows {
        uses.entry(&arrow.from).or_default().insert(&arrow.to);
    }
    let reach: BTreeMap<&str, BTreeSet<&str>> = uses.keys().map(|&m| (m, reachable(&uses, m))).collect();
    let both = |a: &str, b: &str| {
        let reaches = |a: &str, b: &str| reach.get(a).is_some_and(|all| all.contains(b));
        reaches(a, b) && reaches(b, a)
    };
    let mut offences = Vec::new();
    let mut seen = BTreeSet::new();
    for &module in uses.keys() {
        let members: Vec<&str> = uses.keys().copied().filter(|&other| both(module, other)).collect();
        if members.len() < 2 || !seen.insert(members.clone()) {
            continue;
        }
        let mut places = BTreeMap::<(&str, &str), Vec<&str>>::new();
        for a in arrows.iter().filter(|a| members.contains(&&*a.from) && members.contains(&&*a.to)) {
            places.entry((&a.from, &a.to)).or_default().push(&a.place);
        }
        let lines: Vec<String> = places
            .iter()
            .map(|((from, to), at)| format!("    {from} -> {to}, {} times, first {}", at.len(), at[0]))
            .collect();
        offences.push(format!("a cycle of {}:\n{}", members.join(", "), lines.join("\n")));
    }
    offences
}

pub(crate) fn reachable<'a>(uses: &BTreeMap<&'a str, BTreeSet<&'a str>>, from: &str) -> BTreeSet<&'a str> {
    let (mut found, mut open) = (BTreeSet::new(), Vec::from([from]));
    while let Some(module) = open.pop() {
        for &next in uses.get(module).into_iter().flatten() {
            if found.insert(next) {
                open.push(next);
            }
        }
    }
    found
}
