//! `--report`: a page with charts, and the numbers that belong to them.

use crate::charts;
use crate::document::Document;
use crate::output::{bytes, count, micros};
use crate::summary;
use crate::trace::{STAGES, Times, Trace};
use anyhow::{Context, anyhow};
use std::fmt::Write;
use std::path::{Path, PathBuf};

const STYLE: &str = "
body { font: 15px/1.5 system-ui, sans-serif; color: #33383f; background: #fff; max-width: 60rem; margin: 2rem auto; padding: 0 1rem; }
h1 { font-size: 1.6rem; margin: 0 0 1rem; } h2 { font-size: 1.15rem; margin: 2rem 0 .5rem; }
figure { margin: 1.5rem 0; } figure img { width: 100%; height: auto; border: 1px solid #e2e5ea; border-radius: 4px; }
figcaption { color: #5b636e; font-size: .9rem; }
table { border-collapse: collapse; } th, td { padding: .25rem .9rem .25rem 0; text-align: left; vertical-align: top; border-bottom: 1px solid #e2e5ea; }
th { font-weight: 600; } td.n, th.n { text-align: right; font-variant-numeric: tabular-nums; } code { font-size: .95em; }
";

/// Writes the page and its pictures into a folder; returns the page's path.
pub(crate) fn write(folder: &Path, document: &Document, trace: &Trace) -> anyhow::Result<PathBuf> {
    let dt = f64::from(document.settings.dt);
    let save = |name: &str, svg: Result<String, Box<dyn std::error::Error>>| {
        let svg = svg.map_err(|e| anyhow!("can't draw {name}: {e}"))?;
        put(&folder.join(name), &svg)
    };
    save("times.svg", charts::svg(|area| charts::times(area, trace)))?;
    save("contacts.svg", charts::svg(|area| charts::contacts(area, trace)))?;
    save("energy.svg", charts::svg(|area| charts::energy(area, trace, dt)))?;
    save("memory.svg", charts::svg(|area| charts::memory(area, document)))?;
    let path = folder.join("index.html");
    put(&path, &page(document, trace))?;
    Ok(path)
}

fn put(path: &Path, text: &str) -> anyhow::Result<()> {
    std::fs::write(path, text).with_context(|| format!("can't write {}", path.display()))
}

fn page(document: &Document, trace: &Trace) -> String {
    let scene = escape(&document.scene);
    let mut html = format!(
        "<!doctype html>\n<html lang=\"en\">\n<head>\n<meta charset=\"utf-8\">\n<meta name=\"viewport\" \
         content=\"width=device-width, initial-scale=1\">\n<title>backstop: {scene}</title>\n<style>{STYLE}</style>\n\
         </head>\n<body>\n<h1>backstop: {scene}</h1>\n<table>\n"
    );
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
        "Real points touch, potential points may touch within the step. Pushed manifolds had to stop an approach before \
         the touch; ghosts are those whose gap had not closed by the next step.",
    );
    figure(
        &mut html,
        "energy.svg",
        "Of all dynamic bodies together. Friction, inelastic impacts and kinematic bodies change it; nothing else should \
         raise it.",
    );
    figure(
        &mut html,
        "memory.svg",
        "Live bytes are in use, reserved ones are held, the peak is the most that was ever held. What exists only because \
         of continuous collision is a category of its own.",
    );
    memory_table(&mut html, document);
    model_table(&mut html, document);
    settings_table(&mut html, document);
    html += "</body>\n</html>\n";
    html
}

fn figure(html: &mut String, file: &str, caption: &str) {
    let _ = writeln!(
        html,
        "<figure><img src=\"{file}\" alt=\"{0}\"><figcaption>{0}</figcaption></figure>",
        escape(caption)
    );
}

fn time_table(html: &mut String, document: &Document, trace: &Trace) {
    *html += "<table>\n<tr><th>stage</th><th class=\"n\">median</th><th class=\"n\">mean</th><th class=\"n\">p95</th>\
              <th class=\"n\">max</th></tr>\n";
    let mut row = |name: &str, t: &Times| {
        let _ = write!(html, "<tr><td>{name}</td>");
        for value in [t.median, t.mean, t.p95, t.max] {
            let _ = write!(html, "<td class=\"n\">{}</td>", micros(value));
        }
        *html += "</tr>\n";
    };
    for (name, stage) in STAGES {
        row(name, &trace.stage_times(stage));
    }
    row("whole step", &document.time_us.step);
    *html += "</table>\n";
}

fn memory_table(html: &mut String, document: &Document) {
    *html += "<table>\n<tr><th>category</th><th class=\"n\">live</th><th class=\"n\">reserved</th><th class=\"n\">peak\
              </th></tr>\n";
    for category in &document.memory.categories {
        let _ = write!(html, "<tr><td>{}</td>", category.name.replace('_', " "));
        for value in [category.bytes.live, category.bytes.reserved, category.bytes.peak] {
            let _ = write!(html, "<td class=\"n\">{}</td>", bytes(value));
        }
        *html += "</tr>\n";
    }
    *html += "</table>\n";
}

fn model_table(html: &mut String, document: &Document) {
    *html += "<h2>What the scene needs</h2>\n<table>\n<tr><th>part</th><th>asked for by</th><th class=\"n\">bytes</th>\
              <th class=\"n\">time in the last step</th></tr>\n";
    for part in &document.model {
        let name = part.name.replace('_', " ");
        if !part.needed {
            let _ = writeln!(
                html,
                "<tr><td>{name}</td><td>not needed</td><td class=\"n\">{}</td><td></td></tr>",
                bytes(part.bytes)
            );
            continue;
        }
        let time = match (part.time_us, part.stage) {
            (Some(time), _) => micros(time.into()),
            (None, Some(stage)) => format!("in {stage}"),
            (None, None) => String::new(),
        };
        let _ = writeln!(
            html,
            "<tr><td>{name}</td><td>{} {}</td><td class=\"n\">{}</td><td class=\"n\">{time}</td></tr>",
            count(part.count.into()),
            part.asked_by,
            bytes(part.bytes)
        );
    }
    *html += "</table>\n";
}

fn settings_table(html: &mut String, document: &Document) {
    *html += "<h2>Settings</h2>\n<table>\n";
    if let Ok(serde_json::Value::Object(settings)) = serde_json::to_value(&document.settings) {
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

fn escape(text: &str) -> String {
    text.replace('&', "&amp;").replace('<', "&lt;").replace('>', "&gt;").replace('"', "&quot;")
}
