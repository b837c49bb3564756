//! The map as a page.

use super::map::counts;
use super::results::Results;
use crate::report::html::{Cell as Entry, Page};
use backstop_lab::envelope::{Axis, Cell, Trial, Verdict};
use std::path::Path;

fn class(verdict: Option<Verdict>) -> &'static str {
    verdict.map_or("unknown", Verdict::name)
}

/// Writes a page with a table for each trial: a row for each point of an axis, a column for each engine.
pub(crate) fn write(file: &Path, cells: &[Cell], ours: &Results, beside: &[Results]) -> anyhow::Result<()> {
    let engines: Vec<_> = std::iter::once(ours).chain(beside).collect();
    let mut page = Page::new("Envelope");
    for results in &engines {
        let [stable, degraded, lost] = counts(cells, results);
        page.text(format!("{}: {stable} stable, {degraded} degraded, {lost} lost.", results.engine));
    }
    let names = engines.iter().map(|results| results.engine.as_str());
    let headings: Vec<&str> = ["axis", ""].into_iter().chain(names).collect();
    for trial in Trial::ALL {
        let mut last: Option<Axis> = None;
        let row = |cell: &Cell| {
            let axis = if last == Some(cell.axis) { "" } else { cell.axis.name() };
            last = Some(cell.axis);
            let mut row: Vec<Entry> = vec![axis.to_owned().into(), cell.label.clone().into()];
            row.extend(engines.iter().map(|results| {
                let worst = results.worst(&cell.name());
                let text = worst.map_or_else(|| "not run".into(), |worst| worst.text());
                Entry { text, class: Some(class(worst.map(|worst| worst.verdict))) }
            }));
            row
        };
        let rows: Vec<_> = cells.iter().filter(|cell| cell.trial == trial).map(row).collect();
        if !rows.is_empty() {
            page.heading(trial.name());
            page.table(&headings, headings.len(), rows);
        }
    }
    page.write(file)
}
