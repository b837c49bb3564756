//! The page of a profile, and its summary in the terminal.

use super::charts;
use super::each::Each;
use super::ledger::{Additional, Ledger, Memory, Run, Totals};
use crate::commands::compare;
use crate::report::charts::{Drawn, svg};
use crate::report::html::{Page, put};
use crate::report::output::{bytes, count, count_threads, micros, seconds};
use crate::report::page::{memory_table, settings_table};
use anyhow::anyhow;
use std::path::{Path, PathBuf};

/// The charts beside a page of runs with so many threads.
pub(crate) fn charts(threads: &[usize]) -> Vec<String> {
    let of_run = |n: &usize| [format!("cost-{n}.svg"), format!("additional-{n}.svg")];
    let of_all = ["potential.svg", "memory.svg"].map(str::to_owned);
    threads.iter().flat_map(of_run).chain(of_all).collect()
}

/// Writes the page and its pictures into a folder; returns the page's path.
pub(crate) fn write(folder: &Path, ledger: &Ledger) -> anyhow::Result<PathBuf> {
    let save = |name: &str, draw: &dyn Fn(&crate::report::charts::Area<'_>) -> Drawn| {
        let svg = svg(draw).map_err(|e| anyhow!("can't draw {name}: {e}"))?;
        put(&folder.join(name), &svg)
    };
    for run in &ledger.runs {
        save(&format!("cost-{}.svg", run.threads), &|area| charts::cost(area, run))?;
        save(&format!("additional-{}.svg", run.threads), &|area| charts::additional(area, run))?;
    }
    if let Some(run) = ledger.runs.first() {
        save("potential.svg", &|area| charts::potential(area, run))?;
    }
    save("memory.svg", &|area| charts::memory(area, ledger))?;
    let path = folder.join("index.html");
    page(ledger)?.write(&path)?;
    Ok(path)
}

fn page(ledger: &Ledger) -> anyhow::Result<Page> {
    let mut page = Page::new(format!("backstop: what continuous collision costs in {}", ledger.scene));
    page.pairs(rows(ledger));
    for run in &ledger.runs {
        page.figure(
            format!("cost-{}.svg", run.threads),
            "In each frame the step is run both ways from the same snapshot, in turn and often; these are \
             the medians. Then the run goes on from the continuous one.",
        );
        page.figure(
            format!("additional-{}.svg", run.threads),
            format!(
                "How much longer the continuous step takes. Most in frame {} with {:.0} %; the axis ends \
                 where 19 of 20 columns fit.",
                run.additional.max_step, run.additional.max
            ),
        );
        stages(&mut page, run);
    }
    page.figure(
        "potential.svg",
        "Pairs that a discrete step from the same state does not have; points that may touch within the \
         step; manifolds that had to stop an approach before the touch; those whose gap had not closed by \
         the next step.",
    );
    page.figure(
        "memory.svg",
        "Reserved bytes. Continuous: what exists only because of continuous collision.",
    );
    memory_table(&mut page, &ledger.memory.categories);
    if let Some(comparison) = &ledger.comparison {
        page.heading("Methods side by side");
        page.text("Six scenes, seven methods; docs/continuous.md says what the columns mean.");
        for scene in &comparison.scenes {
            page.text(format!("{}: {} steps", scene.scene, scene.steps));
            page.table(&compare::HEAD, 1, compare::rows(scene));
        }
    }
    settings_table(&mut page, &ledger.settings)?;
    Ok(page)
}

fn stages(page: &mut Page, run: &Run) {
    let rows: Vec<Vec<String>> = run
        .stages
        .iter()
        .map(|s| {
            let more = s.continuous_us - s.discrete_us;
            vec![s.stage.to_owned(), micros(s.discrete_us), micros(s.continuous_us), micros(more)]
        })
        .collect();
    page.table(&["stage, mean of a frame", "discrete", "continuous", "more"], 1, rows);
}

/// The rows of the summary, for page and terminal.
pub(crate) fn rows(ledger: &Ledger) -> Vec<(String, String)> {
    let mut rows = vec![("scene".into(), ledger.scene.clone()), ("frames".into(), frames(ledger))];
    rows.extend(ledger.runs.iter().map(|run| (count_threads(run.threads), cost(&run.additional))));
    if let Some(run) = ledger.runs.first() {
        rows.push(("found".into(), found(&run.totals)));
        rows.push(("potential".into(), potential(&run.totals)));
    }
    rows.extend(ledger.each.iter().map(|each| ("each body".into(), each_body(each))));
    rows.push(("memory".into(), memory(&ledger.memory)));
    rows.push(("categories".into(), categories(&ledger.memory)));
    rows
}

fn frames(ledger: &Ledger) -> String {
    format!(
        "{} of {}, each {} times both ways, {} bodies that can be pushed",
        count(ledger.steps as u64),
        seconds(ledger.settings.dt),
        ledger.settings.repeats,
        count(ledger.dynamic_bodies as u64)
    )
}

fn cost(a: &Additional) -> String {
    let falling = a.falling.map_or("never falling".into(), |falling| {
        format!("falling {falling:+.1} % ({} frames)", count(a.falling_frames as u64))
    });
    format!(
        "discrete {}, continuous {} a step: average {:+.1} %, {falling}, most {:+.1} % (frame {}), least \
         {:+.1} %, of all time {:+.1} %",
        micros(a.discrete_us),
        micros(a.continuous_us),
        a.average,
        a.max,
        a.max_step,
        a.min,
        a.whole
    )
}

fn found(t: &Totals) -> String {
    format!(
        "{} swept bodies, {} pairs by the sweep alone, {} looks for a first touch",
        count(t.swept),
        count(t.swept_pairs),
        count(t.casts)
    )
}

fn potential(t: &Totals) -> String {
    format!(
        "{} points made; {} manifolds pushed, {} confirmed, {} ghosts; the guard cut {} paths and lifted {} \
         ends",
        count(t.made),
        count(t.pushed),
        count(t.confirmed),
        count(t.ghosts),
        count(t.cut),
        count(t.lifted)
    )
}

fn each_body(each: &Each) -> String {
    format!(
        "{} on {}: in flight {:+.2} µs, a strike {:+.2} µs ({:.1} times a resting contact of {:.2} µs), {} \
         {:+.2} µs",
        each.shape,
        each.ground,
        each.flight_us,
        each.strike_us,
        each.strike_ratio,
        each.resting_us,
        if matches!(each.shape, "sphere" | "capsule") { "rolling" } else { "sliding" },
        each.rolling_us
    )
}

fn memory(m: &Memory) -> String {
    format!(
        "{} of {} are continuous: {:.1} % of all, {:.1} % without meshes, {:.0} bytes a body",
        bytes(m.continuous),
        bytes(m.total),
        m.of_all,
        m.without_meshes,
        m.per_body
    )
}

fn categories(m: &Memory) -> String {
    let reserved = m.categories.iter().filter(|c| c.bytes.reserved > 0);
    let named = reserved.map(|c| format!("{} {}", c.name.replace('_', " "), bytes(c.bytes.reserved)));
    named.collect::<Vec<_>>().join(", ")
}
