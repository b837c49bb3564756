//! The map as a page.

use super::map::counts;
use super::results::Results;
use crate::report::html;
use backstop::lab::envelope::{Axis, Cell, Trial, Verdict};
use std::fmt::Write;
use std::path::Path;

fn colour(verdict: Option<Verdict>) -> &'static str {
    match verdict {
        Some(Verdict::Stable) => "#cfe8d3",
        Some(Verdict::Degraded) => "#fbe6b0",
        Some(Verdict::Lost) => "#f4b8b3",
        None => "#f0f1f3",
    }
}

/// Writes a page with a table for each trial: a row for each point of an axis, a column for each engine.
pub(crate) fn write(file: &Path, cells: &[Cell], ours: &Results, beside: &[Results]) -> anyhow::Result<()> {
    let engines: Vec<_> = std::iter::once(ours).chain(beside).collect();
    let mut page = html::head("Envelope");
    for engine in &engines {
        let [stable, degraded, lost] = counts(cells, engine);
        let name = html::escape(&engine.engine);
        let _ = writeln!(page, "<p>{name}: {stable} stable, {degraded} degraded, {lost} lost.</p>");
    }
    for trial in Trial::ALL {
        let rows: Vec<_> = cells.iter().filter(|cell| cell.trial == trial).collect();
        if rows.is_empty() {
            continue;
        }
        let _ = write!(page, "<h2>{}</h2>\n<table>\n<tr><th>axis</th><th></th>", trial.name());
        engines.iter().for_each(|engine| page += &format!("<th>{}</th>", html::escape(&engine.engine)));
        page += "</tr>\n";
        let mut last: Option<Axis> = None;
        for cell in rows {
            let axis = if last == Some(cell.axis) { "" } else { cell.axis.name() };
            last = Some(cell.axis);
            let _ = write!(page, "<tr><td>{axis}</td><td>{}</td>", html::escape(&cell.label));
            for engine in &engines {
                let worst = engine.worst(&cell.name());
                let text = worst.map_or_else(|| "not run".into(), |worst| worst.text());
                let colour = colour(worst.map(|worst| worst.verdict));
                let _ = write!(page, "<td style=\"background:{colour}\">{}</td>", html::escape(&text));
            }
            page += "</tr>\n";
        }
        page += "</table>\n";
    }
    html::put(file, &(page + html::TAIL))
}
