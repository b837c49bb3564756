//! Pages, as parts that a template puts together: it escapes all text.

use crate::files;
use anyhow::Context;
use askama::Template;
use backstop_scene as scene;
use std::io::Write as _;
use std::path::Path;

#[derive(Template)]
#[template(path = "page.html")]
pub(crate) struct Page {
    title: String,
    mark: &'static str,
    parts: Vec<Part>,
}

/// Parts of a page, in their order.
pub(crate) enum Part {
    Heading(String),
    Text(String),
    /// HTML of its own.
    Viewer(String),
    /// A picture's file, and its caption.
    Figure(String, String),
    /// A table of names and values.
    Pairs(Vec<(String, String)>),
    Table(Table),
}

/// Headings, and rows of which all but the first `words` columns are numbers.
pub(crate) struct Table {
    headings: Vec<String>,
    words: usize,
    rows: Vec<Vec<Cell>>,
}

impl Table {
    fn class(&self, column: &usize) -> &'static str {
        if *column < self.words { "" } else { "n" }
    }
}

pub(crate) struct Cell {
    pub(crate) text: String,
    /// Class of its style, if it is not that of its column.
    pub(crate) class: Option<&'static str>,
}

impl Cell {
    fn class_or(&self, other: &'static str) -> &'static str {
        self.class.unwrap_or(other)
    }
}

impl From<String> for Cell {
    fn from(text: String) -> Cell {
        Cell { text, class: None }
    }
}

impl Page {
    pub(crate) fn new(title: impl Into<String>) -> Page {
        Page { title: title.into(), mark: files::MARK, parts: Vec::new() }
    }

    pub(crate) fn add(&mut self, part: Part) {
        self.parts.push(part);
    }

    pub(crate) fn heading(&mut self, text: impl Into<String>) {
        self.add(Part::Heading(text.into()));
    }

    pub(crate) fn text(&mut self, text: impl Into<String>) {
        self.add(Part::Text(text.into()));
    }

    pub(crate) fn figure(&mut self, file: impl Into<String>, caption: impl Into<String>) {
        self.add(Part::Figure(file.into(), caption.into()));
    }

    pub(crate) fn pairs(&mut self, rows: impl IntoIterator<Item = (impl Into<String>, String)>) {
        self.add(Part::Pairs(rows.into_iter().map(|(name, value)| (name.into(), value)).collect()));
    }

    pub(crate) fn table<C: Into<Cell>>(
        &mut self,
        headings: &[impl AsRef<str>],
        words: usize,
        rows: impl IntoIterator<Item = Vec<C>>,
    ) {
        let headings = headings.iter().map(|heading| heading.as_ref().to_owned()).collect();
        let rows = rows.into_iter().map(|row| row.into_iter().map(Into::into).collect()).collect();
        self.add(Part::Table(Table { headings, words, rows }));
    }

    pub(crate) fn write(&self, path: &Path) -> anyhow::Result<()> {
        put(path, &self.render().context("can't make the page")?)
    }
}

/// Writes a file of a page, a chart with the mark that the page has from its template.
pub(crate) fn put(path: &Path, text: &str) -> anyhow::Result<()> {
    let mark = if text.starts_with("<svg") { files::MARK } else { "" };
    scene::write_file(path, |file| write!(file, "{mark}{text}"))
        .with_context(|| format!("can't write {}", path.display()))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_is_put_in_is_text_and_numbers_are_on_the_right() {
        let mut page = Page::new("a <b> & c");
        page.text("</p><script>");
        page.figure("x\".svg", "say \"x\"");
        page.pairs([("<i>", "<u>".to_owned())]);
        page.table(&["name", "count"], 1, [vec!["<td>".to_owned(), "7".to_owned()]]);
        let html = page.render().unwrap();
        for raw in ["<b>", "<script", "<i>", "<u>", "<td>", "x\".svg"] {
            let free = html.replace("<td>&#60;", "").replace("<th>&#60;i&#62;</th><td>", "");
            assert!(raw == "<td>" || !free.contains(raw), "{raw} in {html}");
        }
        assert!(html.contains(r#"<td class="n">7</td>"#) && html.contains("a &#60;b&#62; &#38; c"), "{html}");
    }
}
