//! The parts that all pages share.

use anyhow::Context;
use backstop::scene;
use std::fmt::Write as _;
use std::io::Write as _;
use std::path::Path;

const STYLE: &str = "
body { font: 15px/1.5 system-ui, sans-serif; color: #33383f; background: #fff; max-width: 60rem; margin: 2rem auto; padding: 0 1rem; }
h1 { font-size: 1.6rem; margin: 0 0 1rem; } h2 { font-size: 1.15rem; margin: 2rem 0 .5rem; }
figure { margin: 1.5rem 0; } figure img { width: 100%; height: auto; border: 1px solid #e2e5ea; border-radius: 4px; }
figcaption { color: #5b636e; font-size: .9rem; }
table { border-collapse: collapse; } th, td { padding: .25rem .9rem .25rem 0; text-align: left; vertical-align: top; border-bottom: 1px solid #e2e5ea; }
th { font-weight: 600; } td.n, th.n { text-align: right; font-variant-numeric: tabular-nums; } code { font-size: .95em; }
";

/// The start of a page, up to its heading.
pub(crate) fn head(title: &str) -> String {
    let title = escape(title);
    format!(
        "<!doctype html>\n<html lang=\"en\">\n<head>\n<meta charset=\"utf-8\">\n<meta name=\"viewport\" \
         content=\"width=device-width, initial-scale=1\">\n<title>{title}</title>\n<style>{STYLE}</style>\n\
         </head>\n<body>\n<h1>{title}</h1>\n"
    )
}

/// Its end.
pub(crate) const TAIL: &str = "</body>\n</html>\n";

/// Writes a file of the page.
pub(crate) fn put(path: &Path, text: &str) -> anyhow::Result<()> {
    scene::write_file(path, |file| file.write_all(text.as_bytes()))
        .with_context(|| format!("can't write {}", path.display()))
}

/// A picture with its caption.
pub(crate) fn figure(html: &mut String, file: &str, caption: &str) {
    let _ = writeln!(
        html,
        "<figure><img src=\"{file}\" alt=\"{0}\"><figcaption>{0}</figcaption></figure>",
        escape(caption)
    );
}

/// A table: headings, and rows of which all but the first `words` columns are numbers.
pub(crate) fn table(html: &mut String, headings: &[&str], words: usize, rows: &[Vec<String>]) {
    let class = |i: usize| if i < words { "" } else { " class=\"n\"" };
    *html += "<table>\n<tr>";
    for (i, heading) in headings.iter().enumerate() {
        let _ = write!(html, "<th{}>{}</th>", class(i), escape(heading));
    }
    *html += "</tr>\n";
    for row in rows {
        *html += "<tr>";
        for (i, cell) in row.iter().enumerate() {
            let _ = write!(html, "<td{}>{}</td>", class(i), escape(cell));
        }
        *html += "</tr>\n";
    }
    *html += "</table>\n";
}

pub(crate) fn escape(text: &str) -> String {
    text.replace('&', "&amp;").replace('<', "&lt;").replace('>', "&gt;").replace('"', "&quot;")
}
