//! `--report`: a page with curves and tables.

use super::charts;
use super::outcome::{Outcome, Row};
use super::text::{self, number};
use crate::report::html::{Page, put};
use anyhow::anyhow;
use backstop_lab::trade::{Axis, Measure};
use std::path::Path;

/// The charts beside a page.
pub(super) fn charts() -> Vec<String> {
    std::iter::once("front.svg".to_owned()).chain(Axis::ALL.into_iter().map(chart_of)).collect()
}

fn chart_of(axis: Axis) -> String {
    format!("{}.svg", axis.name().replace(' ', "-"))
}

/// Writes the page and its pictures into a folder.
pub(super) fn write(folder: &Path, outcome: &Outcome) -> anyhow::Result<()> {
    let save = |name: &str, svg: Result<String, Box<dyn std::error::Error>>| {
        let svg = svg.map_err(|e| anyhow!("can't draw {name}: {e}"))?;
        put(&folder.join(name), &svg)
    };
    let mut page = Page::new(format!("backstop: the trade of {}", outcome.header.scene));
    for line in text::about(outcome).lines() {
        page.text(line);
    }
    save("front.svg", crate::report::charts::svg(|area| charts::front(area, outcome)))?;
    page.figure(
        "front.svg",
        "Each setting is a point, a cross if it breaks a condition. The line joins those which keep all \
         conditions and than which no other such setting is both cheaper and more accurate; the diamond is \
         the default setting, the circle the picked one.",
    );
    rows(&mut page, "The front", &outcome.front);
    if !outcome.excluded.is_empty() {
        rows(&mut page, "Not on the front, as they break a condition", &outcome.excluded);
    }
    rows(&mut page, "The default setting", std::slice::from_ref(&outcome.default));
    if let Some(picked) = &outcome.picked {
        rows(&mut page, &format!("Picked: {}", outcome.rule), std::slice::from_ref(picked));
    }
    for (at, axis) in Axis::ALL.into_iter().enumerate() {
        let values: Vec<_> = outcome.axes.iter().filter(|value| value.axis == axis).collect();
        if values.is_empty() {
            continue;
        }
        let name = chart_of(axis);
        let names: Vec<&str> = values.iter().map(|value| value.value.as_str()).collect();
        save(&name, crate::report::charts::svg(|area| charts::axis(area, outcome, at, axis, &names)))?;
        page.heading(axis.name());
        page.figure(name, "The front of the settings that have each value, all else being free.");
        let list: Vec<Vec<String>> = values
            .iter()
            .map(|value| {
                let ratio = value.cheapest_ratio.map_or("none".into(), |ratio| format!("{ratio:.2}"));
                vec![value.value.clone(), value.on_front.to_string(), number(value.least_error), ratio]
            })
            .collect();
        page.table(
            &["value", "on the front", "least error", "cheapest as good as the pick, of default"],
            1,
            list,
        );
    }
    rows(&mut page, "All settings", &outcome.cells);
    page.heading("Other errors of all settings");
    let others: Vec<Measure> =
        Measure::ALL.into_iter().filter(|measure| !Measure::CONDITIONS.contains(measure)).collect();
    let headings = std::iter::once("setting").chain(others.iter().map(|measure| measure.name()));
    let row = |row: &Row| -> Vec<String> {
        let finite = |error: f64| number(Some(error).filter(|error| error.is_finite()));
        let others = others.iter().map(|&measure| finite(row.errors.of(measure)));
        std::iter::once(row.name.clone()).chain(others).collect()
    };
    page.table(&headings.collect::<Vec<_>>(), 1, outcome.cells.iter().map(row));
    page.heading("Units");
    page.pairs(Measure::ALL.map(|measure| (measure.name(), measure.unit().to_owned())));
    page.write(&folder.join("index.html"))
}

/// Costs, errors and conditions.
fn rows(page: &mut Page, title: &str, rows: &[Row]) {
    page.heading(title);
    let headings = [&["setting", "breaks"], &text::COLUMNS[..]].concat();
    let row = |row: &Row| {
        let broken = text::breaks(row).trim_start_matches("breaks ").to_owned();
        [vec![row.name.clone(), broken], text::cells(row)].concat()
    };
    page.table(&headings, 2, rows.iter().map(row));
}
