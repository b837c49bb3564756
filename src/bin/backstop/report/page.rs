//! `--report`: a page with charts and tables.

use crate::report::accuracy::{Spread, Summary};
use crate::report::charts;
use crate::report::document::{CategoryBytes, Document, Part};
use crate::report::html::{self, escape, figure, put, table};
use crate::report::output::{bytes, count, micros};
use crate::report::summary;
use crate::report::trace::{STAGES, Times, Trace};
use anyhow::anyhow;
use std::fmt::Write;
use std::path::{Path, PathBuf};

/// Writes the page and its pictures into a folder; returns the page's path. `viewer`: the HTML of the scene.
pub(crate) fn write(
    folder: &Path,
    document: &Document,
    trace: &Trace,
    viewer: &str,
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
    put(&path, &page(document, trace, viewer))?;
    Ok(path)
}

fn page(document: &Document, trace: &Trace, viewer: &str) -> String {
    let mut html = html::head(&format!("backstop: {}", document.scene));
    html += viewer;
    html += "<table>\n";
    for (label, value) in summary::rows(document, trace) {
        let _ = writeln!(html, "<tr><th>{label}</th><td>{}</td></tr>", escape(&value));
    }
    html += "</table>\n";
    let slowest = trace.reports.iter().enumerate().max_by(|a, b| a.1.times.step.total_cmp(&b.1.times.step));
    let slowest = slowest.map_or(String::new(), |(i, r)| {
        format!(
            " The slowest step was number {} with {}; the axis ends where 99 of 100 columns fit.",
            i + 1,
            micros(r.times.step.into())
        )
    });
    figure(&mut html, "times.svg", &format!("Stages of a step, piled up.{slowest}"));
    time_table(&mut html, document, trace);
    figure(
        &mut html,
        "contacts.svg",
        "Real points touch, potential points may touch within the step. Pushed manifolds had to stop an \
         approach before the touch; ghosts are those whose gap had not closed by the next step.",
    );
    figure(
        &mut html,
        "energy.svg",
        "Of all dynamic bodies together. Friction, inelastic impacts and kinematic bodies change it; \
         nothing else should raise it.",
    );
    if let Some(accuracy) = &document.accuracy {
        figure(
            &mut html,
            "accuracy.svg",
            "What is left of the laws of contact, friction and joints after each step, the deepest overlap \
             and the greatest error of a joint.",
        );
        accuracy_table(&mut html, accuracy);
    }
    figure(
        &mut html,
        "memory.svg",
        "Live bytes are in use, reserved ones are held, the peak is the most that was ever held. What \
         exists only because of continuous collision is a category of its own.",
    );
    memory_table(&mut html, &document.memory.categories);
    model_table(&mut html, document);
    settings_table(&mut html, &document.settings);
    html += html::TAIL;
    html
}

fn time_table(html: &mut String, document: &Document, trace: &Trace) {
    let row = |name: &str, t: &Times| -> Vec<String> {
        std::iter::once(name.to_owned()).chain([t.median, t.mean, t.p95, t.max].map(micros)).collect()
    };
    let mut rows: Vec<_> = STAGES.iter().map(|(name, stage)| row(name, &trace.stage_times(*stage))).collect();
    rows.push(row("whole step", &document.time_us.step));
    table(html, &["stage", "median", "mean", "p95", "max"], 1, &rows);
}

fn accuracy_table(html: &mut String, accuracy: &Summary) {
    let row = |figure: &Spread| {
        let number = |x: f64| format!("{x:.1e} {}", figure.unit);
        let name = figure.name.replace('_', " ");
        vec![name, number(figure.median), number(figure.worst), figure.worst_step.to_string()]
    };
    let rows: Vec<Vec<String>> = accuracy.figures.iter().map(row).collect();
    table(html, &["accuracy", "median", "worst", "in step"], 1, &rows);
    let rows: Vec<Vec<String>> = accuracy.islands.iter().map(|island| vec![island.text()]).collect();
    table(html, &["islands that were solved worst"], 1, &rows);
}

/// Bytes of each category.
pub(crate) fn memory_table(html: &mut String, categories: &[CategoryBytes]) {
    let rows: Vec<Vec<String>> = categories
        .iter()
        .map(|c| {
            let name = c.name.replace('_', " ");
            vec![name, bytes(c.bytes.live), bytes(c.bytes.reserved), bytes(c.bytes.peak)]
        })
        .collect();
    table(html, &["category", "live", "reserved", "peak"], 1, &rows);
}

fn model_table(html: &mut String, document: &Document) {
    *html += "<h2>What the scene needs</h2>\n";
    let row = |part: &Part| {
        let name = part.name.replace('_', " ");
        if !part.needed {
            return vec![name, "not needed".into(), String::new(), bytes(part.bytes)];
        }
        let time = match (part.time_us, part.stage) {
            (Some(time), _) => micros(time.into()),
            (None, Some(stage)) => format!("in {stage}"),
            (None, None) => String::new(),
        };
        vec![name, format!("{} {}", count(part.count.into()), part.asked_by), time, bytes(part.bytes)]
    };
    let rows: Vec<Vec<String>> = document.model.iter().map(row).collect();
    table(html, &["part", "asked for by", "time in the last step", "bytes"], 3, &rows);
}

pub(crate) fn settings_table(html: &mut String, settings: &impl serde::Serialize) {
    *html += "<h2>Settings</h2>\n<table>\n";
    if let Ok(serde_json::Value::Object(settings)) = serde_json::to_value(settings) {
        for (name, value) in settings {
            let value = value.as_str().map_or_else(|| value.to_string(), str::to_owned);
            let _ = writeln!(
                html,
                "<tr><th>{}</th><td><code>{}</code></td></tr>",
                escape(&name.replace('_', " ")),
                escape(&value)
            );
        }
    }
    *html += "</table>\n";
}
