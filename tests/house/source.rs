//! A source file as the rules look at it: its lines, and its code without comments and strings.

use std::fs;
use std::ops::Range;
use std::path::{Path, PathBuf};

/// The kind of text that a character belongs to.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Part {
    Code,
    Comment,
    /// A string or a character literal, with its quotes.
    Literal,
}

/// A file of Rust.
pub(crate) struct Source {
    /// From the root of the repository, with `/` between folders.
    pub(crate) path: String,
    pub(crate) chars: Vec<char>,
    /// As long as `chars`.
    pub(crate) parts: Vec<Part>,
    /// `chars` with spaces for comments and literals; ends of lines stay.
    pub(crate) code: Vec<char>,
    /// Where items begin and end that are only compiled for unit tests.
    tests: Vec<Range<usize>>,
}

/// A function, by its lines.
pub(crate) struct Function {
    pub(crate) name: String,
    /// From 1.
    pub(crate) line: usize,
    /// From the line of `fn` to that of the closing brace.
    pub(crate) lines: usize,
}

impl Source {
    pub(crate) fn new(path: impl Into<String>, text: &str) -> Source {
        let chars: Vec<char> = text.chars().collect();
        let parts = parts(&chars);
        let code: Vec<char> = chars
            .iter()
            .zip(&parts)
            .map(|(&c, &part)| if part == Part::Code || c == '\n' { c } else { ' ' })
            .collect();
        let tests = test_items(&code, &chars);
        Source { path: path.into(), chars, parts, code, tests }
    }

    /// Every `.rs` file in some folders of the repository, in the order of their paths.
    pub(crate) fn all(folders: &[&str]) -> Vec<Source> {
        let root = Path::new(env!("CARGO_MANIFEST_DIR"));
        let mut paths = Vec::new();
        folders.iter().for_each(|folder| find(&root.join(folder), &mut paths));
        paths.sort();
        let of = |path: &PathBuf| {
            let name = path.strip_prefix(root).expect("a path in the repository");
            let name: Vec<_> = name.iter().map(|part| part.to_string_lossy()).collect();
            Source::new(name.join("/"), &fs::read_to_string(path).expect("a file of text"))
        };
        paths.iter().map(of).collect()
    }

    pub(crate) fn lines(&self) -> usize {
        self.chars.split(|&c| c == '\n').count() - usize::from(self.chars.last() == Some(&'\n'))
    }

    /// The line of a character, from 1.
    pub(crate) fn line_of(&self, at: usize) -> usize {
        self.chars[..at].iter().filter(|&&c| c == '\n').count() + 1
    }

    /// Whether a character is in an item that is only compiled for unit tests.
    pub(crate) fn is_for_tests(&self, at: usize) -> bool {
        self.tests.iter().any(|range| range.contains(&at))
    }

    /// The path of the module that the file is: `["solver", "warm"]` for `src/solver/warm.rs`.
    pub(crate) fn module(&self) -> Vec<String> {
        let mut path: Vec<String> = self.path.split('/').skip(1).map(str::to_owned).collect();
        let file = path.pop().unwrap_or_default();
        match file.trim_end_matches(".rs") {
            "mod" | "lib" | "main" => {}
            name => path.push(name.to_owned()),
        }
        path
    }

    pub(crate) fn functions(&self) -> Vec<Function> {
        let mut found = Vec::new();
        for at in words(&self.code, "fn") {
            let name_at = skip_space(&self.code, at + 2);
            let name = ident(&self.code, name_at);
            if name.is_empty() {
                continue; // a type: fn(u32) -> u32
            }
            let Some(open) = body(&self.code, name_at) else { continue };
            let (line, last) = (self.line_of(at), self.line_of(closing(&self.code, open)));
            found.push(Function { name, line, lines: last - line + 1 });
        }
        found
    }

    /// Files that `mod name;` brings in for unit tests only: `path/name` for `path/name.rs` and all below it.
    pub(crate) fn test_modules(&self) -> Vec<String> {
        let (folder, file) = self.path.rsplit_once('/').unwrap_or(("", &self.path));
        let folder = match file {
            "mod.rs" | "lib.rs" | "main.rs" => folder.to_owned(),
            _ => format!("{folder}/{}", file.trim_end_matches(".rs")),
        };
        let mut found = Vec::new();
        for at in words(&self.code, "mod").into_iter().filter(|&at| self.is_for_tests(at)) {
            let name_at = skip_space(&self.code, at + 3);
            let name = ident(&self.code, name_at);
            if self.code.get(skip_space(&self.code, name_at + name.len())) == Some(&';') {
                found.push(self.path_above(at).unwrap_or_else(|| format!("{folder}/{name}")));
            }
        }
        found
    }

    /// The file of `#[path = "..."]` above an item, from the root of the repository and without `.rs`.
    fn path_above(&self, at: usize) -> Option<String> {
        let folder = self.path.rsplit_once('/').map_or("", |(folder, _)| folder);
        let line = self.chars[..at].iter().rposition(|&c| c == '\n').unwrap_or(0);
        let above = String::from_iter(&self.chars[..line]);
        let mut attributes = above.lines().rev().map(str::trim).take_while(|line| line.starts_with("#["));
        let file = attributes.find_map(|line| line.strip_prefix("#[path = \"")?.strip_suffix(".rs\"]"))?;
        Some(format!("{folder}/{file}"))
    }
}

fn find(folder: &Path, paths: &mut Vec<PathBuf>) {
    for entry in fs::read_dir(folder).into_iter().flatten() {
        let path = entry.expect("an entry of a folder").path();
        if path.is_dir() && !path.ends_with("target") {
            find(&path, paths);
        } else if path.extension().is_some_and(|extension| extension == "rs") {
            paths.push(path);
        }
    }
}

/// Tells code from comments and literals.
fn parts(chars: &[char]) -> Vec<Part> {
    let mut parts = vec![Part::Code; chars.len()];
    let mut i = 0;
    while i < chars.len() {
        let (end, part) = match (chars[i], chars.get(i + 1)) {
            ('/', Some('/')) => (line_end(chars, i), Part::Comment),
            ('/', Some('*')) => (block_comment_end(chars, i), Part::Comment),
            ('"', _) => (string_end(chars, i), Part::Literal),
            ('\'', _) => (char_end(chars, i), Part::Literal),
            ('r', _) => (raw_string_end(chars, i), Part::Literal),
            _ => (i, Part::Code),
        };
        parts[i..end].fill(part);
        i = end.max(i + 1);
    }
    parts
}

fn line_end(chars: &[char], from: usize) -> usize {
    chars[from..].iter().position(|&c| c == '\n').map_or(chars.len(), |n| from + n)
}

fn block_comment_end(chars: &[char], from: usize) -> usize {
    let (mut depth, mut i) = (0, from);
    while i + 1 < chars.len() {
        match (chars[i], chars[i + 1]) {
            ('/', '*') => (depth, i) = (depth + 1, i + 2),
            ('*', '/') => (depth, i) = (depth - 1, i + 2),
            _ => i += 1,
        }
        if depth == 0 {
            return i;
        }
    }
    chars.len()
}

/// End of a string that begins with a quote.
fn string_end(chars: &[char], from: usize) -> usize {
    let mut i = from + 1;
    while i < chars.len() && chars[i] != '"' {
        i += 1 + usize::from(chars[i] == '\\');
    }
    (i + 1).min(chars.len())
}

/// `from` itself where a lifetime begins.
fn char_end(chars: &[char], from: usize) -> usize {
    match chars.get(from + 1) {
        // The escaped character may be a quote itself.
        Some('\\') => {
            let rest = chars.iter().skip(from + 3).position(|&c| c == '\'');
            rest.map_or(chars.len(), |n| from + 4 + n)
        }
        _ if chars.get(from + 2) == Some(&'\'') => from + 3,
        _ => from,
    }
}

/// `from` itself where no raw string begins.
fn raw_string_end(chars: &[char], from: usize) -> usize {
    let before = |n: usize| from.checked_sub(n).map(|i| chars[i]);
    let prefixed = matches!(before(1), Some('b' | 'c')) && !before(2).is_some_and(is_word);
    let hashes = chars[from + 1..].iter().take_while(|&&c| c == '#').count();
    if before(1).is_some_and(is_word) && !prefixed || chars.get(from + 1 + hashes) != Some(&'"') {
        return from;
    }
    let end: Vec<char> = std::iter::once('"').chain(std::iter::repeat_n('#', hashes)).collect();
    let inside = from + 2 + hashes;
    let found = chars[inside..].windows(end.len()).position(|w| w == end);
    found.map_or(chars.len(), |n| inside + n + end.len())
}

/// Items below `#[cfg(test)]` or `#[cfg(all(test, ...))]`; all of the file below `#![cfg(test)]`.
fn test_items(code: &[char], chars: &[char]) -> Vec<Range<usize>> {
    let mut found = Vec::new();
    for at in words(code, "cfg") {
        let open = skip_space(code, at + 3);
        if code.get(open) != Some(&'(') || at == 0 || code[at - 1] != '[' {
            continue;
        }
        let end = closing(code, open);
        let says: String = chars[open + 1..end].iter().filter(|c| !c.is_whitespace()).collect();
        if says != "test" && !says.starts_with("all(test,") {
            continue;
        }
        if at >= 2 && code[at - 2] == '!' {
            return std::iter::once(0..code.len()).collect();
        }
        let mut item = skip_space(code, closing(code, at - 1) + 1);
        while code.get(item) == Some(&'#') {
            item = skip_space(code, closing(code, skip_space(code, item + 1)) + 1);
        }
        found.push(at..item_end(code, item));
    }
    found
}

/// Behind the `;` or the closing brace of an item.
fn item_end(code: &[char], from: usize) -> usize {
    let mut i = from;
    while i < code.len() {
        match code[i] {
            ';' => return i + 1,
            '{' => return closing(code, i) + 1,
            '(' | '[' => i = closing(code, i) + 1,
            _ => i += 1,
        }
    }
    code.len()
}

/// The brace that opens a function's body; none where it is only declared.
fn body(code: &[char], from: usize) -> Option<usize> {
    let mut i = from;
    while i < code.len() {
        match code[i] {
            ';' => return None,
            '{' => return Some(i),
            '(' | '[' => i = closing(code, i) + 1,
            _ => i += 1,
        }
    }
    None
}

/// The bracket that closes the one at `open`; the last character where there is none.
pub(crate) fn closing(code: &[char], open: usize) -> usize {
    let mut depth = 0;
    for (i, c) in code.iter().enumerate().skip(open) {
        match c {
            '(' | '[' | '{' => depth += 1,
            ')' | ']' | '}' => depth -= 1,
            _ => {}
        }
        if depth == 0 {
            return i;
        }
    }
    code.len().saturating_sub(1)
}

fn is_word(c: char) -> bool {
    c.is_alphanumeric() || c == '_'
}

/// Where a word stands in code.
pub(crate) fn words(code: &[char], word: &str) -> Vec<usize> {
    let word: Vec<char> = word.chars().collect();
    let joined = |i: usize| code.get(i).copied().is_some_and(is_word);
    let alone = |&i: &usize| !joined(i.wrapping_sub(1)) && !joined(i + word.len());
    let windows = code.windows(word.len()).enumerate();
    windows.filter(|(_, w)| *w == word).map(|(i, _)| i).filter(alone).collect()
}

/// The identifier that begins here; empty where none does.
pub(crate) fn ident(code: &[char], at: usize) -> String {
    code.iter().skip(at).take_while(|c| is_word(**c)).collect()
}

pub(crate) fn skip_space(code: &[char], at: usize) -> usize {
    at + code.iter().skip(at).take_while(|c| c.is_whitespace()).count()
}
