//! `--report`: a page with charts and tables.

use crate::report::accuracy::{Spread, Summary};
use crate::report::charts;
#[cfg(test)]
use crate::report::document::RunSettings;
use crate::report::document::{self, CategoryBytes, Document};
use crate::report::html::{Page, Part, put};
use crate::report::output::{self, bytes, count, micros};
use crate::report::summary;
use crate::report::trace::{STAGES, Times, Trace};
use anyhow::anyhow;
use serde_json::Value;
use std::path::{Path, PathBuf};

/// The charts beside a page.
pub(crate) const CHARTS: [&str; 5] =
    ["times.svg", "contacts.svg", "energy.svg", "accuracy.svg", "memory.svg"];

/// Writes the page and its pictures into a folder; returns the page's path. `viewer`: shows the scene.
pub(crate) fn write(
    folder: &Path,
    document: &Document,
    trace: &Trace,
    viewer: Option<Part>,
) -> anyhow::Result<PathBuf> {
    let dt = f64::from(document.settings.dt);
    let save = |name: &str, svg: Result<String, Box<dyn std::error::Error>>| {
        let svg = svg.map_err(|e| anyhow!("can't draw {name}: {e}"))?;
        put(&folder.join(name), &svg)
    };
    save("times.svg", charts::svg(|area| charts::times(area, trace)))?;
    save("contacts.svg", charts::svg(|area| charts::contacts(area, trace)))?;
    save("energy.svg", charts::svg(|area| charts::energy(area, trace, dt)))?;
    if let Some(course) = &trace.accuracy {
        save("accuracy.svg", charts::svg(|area| charts::accuracy(area, course)))?;
    }
    save("memory.svg", charts::svg(|area| charts::memory(area, document)))?;
    let path = folder.join("index.html");
    page(document, trace, viewer)?.write(&path)?;
    Ok(path)
}

fn page(document: &Document, trace: &Trace, viewer: Option<Part>) -> anyhow::Result<Page> {
    let mut page = Page::new(format!("backstop: {}", document.scene));
    viewer.into_iter().for_each(|part| page.add(part));
    page.pairs(summary::rows(document, trace));
    let slowest = trace.reports.iter().enumerate().max_by(|a, b| a.1.times.step.total_cmp(&b.1.times.step));
    let slowest = slowest.map_or(String::new(), |(i, r)| {
        format!(
            " The slowest step was number {} with {}; columns beyond the 99th percentile are cut off and marked.",
            i + 1,
            micros(r.times.step.into())
        )
    });
    page.figure("times.svg", format!("Stages of a step, piled up.{slowest}"));
    time_table(&mut page, document, trace);
    page.figure(
        "contacts.svg",
        "Real points touch, potential points may touch within the step. Pushed manifolds had to stop an \
         approach before the touch; ghosts are those whose gap had not closed by the next step.",
    );
    page.figure(
        "energy.svg",
        "Of all dynamic bodies together. Friction, inelastic impacts and kinematic bodies change it; \
         nothing else should raise it.",
    );
    if let Some(accuracy) = &document.accuracy {
        page.figure(
            "accuracy.svg",
            "What is left of the laws of contact, friction and joints after each step, the deepest overlap \
             and the greatest error of a joint.",
        );
        accuracy_table(&mut page, accuracy);
    }
    page.figure(
        "memory.svg",
        "Live bytes are in use, reserved ones are held, the peak is the most that was ever held. What \
         exists only because of continuous collision is a category of its own.",
    );
    memory_table(&mut page, &document.memory.categories);
    model_table(&mut page, document);
    settings_table(&mut page, &document.settings)?;
    Ok(page)
}

fn time_table(page: &mut Page, document: &Document, trace: &Trace) {
    let row = |name: &str, t: &Times| -> Vec<String> {
        std::iter::once(name.to_owned()).chain([t.median, t.mean, t.p95, t.max].map(micros)).collect()
    };
    let mut rows: Vec<_> = STAGES.iter().map(|(name, stage)| row(name, &trace.stage_times(*stage))).collect();
    rows.push(row("whole step", &document.time_us.step));
    page.table(&["stage", "median", "mean", "p95", "max"], 1, rows);
}

fn accuracy_table(page: &mut Page, accuracy: &Summary) {
    let row = |figure: &Spread| {
        let number = |x: f64| format!("{x:.1e} {}", figure.unit);
        let name = figure.name.replace('_', " ");
        vec![name, number(figure.median), number(figure.worst), figure.worst_step.to_string()]
    };
    let rows: Vec<Vec<String>> = accuracy.figures.iter().map(row).collect();
    page.table(&["accuracy", "median", "worst", "in step"], 1, rows);
    let rows: Vec<Vec<String>> = accuracy.islands.iter().map(|island| vec![island.text()]).collect();
    page.table(&["islands that were solved worst"], 1, rows);
}

/// Bytes of each category.
pub(crate) fn memory_table(page: &mut Page, categories: &[CategoryBytes]) {
    let rows: Vec<Vec<String>> = categories
        .iter()
        .map(|c| {
            let name = c.name.replace('_', " ");
            vec![name, bytes(c.bytes.live), bytes(c.bytes.reserved), bytes(c.bytes.peak)]
        })
        .collect();
    page.table(&["category", "live", "reserved", "peak"], 1, rows);
}

fn model_table(page: &mut Page, document: &Document) {
    page.heading("What the scene needs");
    let row = |part: &document::Part| {
        let name = part.name.replace('_', " ");
        if !part.needed {
            return vec![name, "not needed".into(), String::new(), bytes(part.bytes)];
        }
        let time = match (part.time_us, part.stage) {
            (Some(time), _) => micros(time.into()),
            (None, Some(stage)) => format!("in {stage}"),
            (None, None) => String::new(),
        };
        vec![name, format!("{}: {}", part.asked_by, count(part.count.into())), time, bytes(part.bytes)]
    };
    let rows: Vec<Vec<String>> = document.model.iter().map(row).collect();
    page.table(&["part", "asked for by", "time in the last step", "bytes"], 3, rows);
}

pub(crate) fn settings_table(page: &mut Page, settings: &impl serde::Serialize) -> anyhow::Result<()> {
    page.heading("Settings");
    page.pairs(settings_rows(&output::exact(settings)?));
    Ok(())
}

/// Names and values as a person writes them; a field within a setting is a row of its own.
fn settings_rows(settings: &Value) -> Vec<(String, String)> {
    let mut rows = Vec::new();
    for (name, value) in settings.as_object().into_iter().flatten() {
        let name = name.replace('_', " ");
        match value {
            Value::Object(_) => {
                let parts =
                    settings_rows(value).into_iter().map(|(part, value)| (format!("{name}, {part}"), value));
                rows.extend(parts);
            }
            _ if name == "dt" => {
                rows.push((name, output::seconds(value.as_f64().unwrap_or_default() as f32)))
            }
            _ => rows.push((name, written(value))),
        }
    }
    rows
}

fn written(value: &Value) -> String {
    match value {
        Value::Null => "none".into(),
        Value::Bool(true) => "yes".into(),
        Value::Bool(false) => "no".into(),
        Value::String(text) => text.clone(),
        Value::Array(values) => values.iter().map(written).collect::<Vec<_>>().join(", "),
        _ => value.to_string(),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use backstop::Settings;

    #[test]
    fn settings_are_as_a_person_writes_them() {
        let run = RunSettings { dt: 1.0 / 60.0, world: Settings::default(), drop: 0, seed: 1 };
        let rows = settings_rows(&output::exact(&run).unwrap());
        let of = |name: &str| rows.iter().find(|row| row.0 == name).map(|row| row.1.as_str());
        assert_eq!(of("dt"), Some("1/60 s"));
        assert_eq!(of("gravity"), Some("0.0, -9.81, 0.0"));
        assert_eq!(
            (of("sleeping"), of("budget, total"), of("substeps")),
            (Some("no"), Some("none"), Some("4"))
        );
        assert!(rows.iter().all(|(_, value)| !value.contains(['{', '"'])), "{rows:?}");
    }
}
