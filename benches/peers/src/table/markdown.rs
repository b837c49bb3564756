//! A record as tables to read.

use super::row::{Equal, Row};
use crate::run::Outcome;
use std::fmt::{self, Write};

/// The cells of a row in a table; `base` is backstop's row of the same scene and threads.
type Cell = fn(row: &Row, base: &Row) -> Option<String>;

/// The tables of a page.
const TABLES: [(&str, Cell); 12] = [
    ("Mean step [ms], and as a multiple of backstop's", |row, base| timed(row, base, |run| run.ms.mean)),
    ("Median step [ms]", |row, base| timed(row, base, |run| run.ms.median)),
    ("95th percentile of the steps [ms]", |row, base| timed(row, base, |run| run.ms.p95)),
    ("Mean step at an error no larger than backstop's [ms], at so many times the substeps", equal),
    ("The body that moved most, after 3 s / 60 s [mm]", drift),
    ("Deepest overlap at the end [mm], meshes left out", |row, _| mm(row.figures().depth)),
    ("Widest gap of a joint, ever / at the end [mm]", |row, _| {
        let figures = row.figures();
        Some(format!("{} / {}", mm(figures.joint_worst)?, mm(figures.joint)?))
    }),
    ("Bodies that passed through something", |row, _| row.figures().lost.map(|lost| lost.to_string())),
    ("Energy gained at most, as the height to which it lifts all bodies [mm]", |row, _| {
        let figures = row.figures();
        mm(Some(figures.energy_gain? / figures.weight.filter(|weight| *weight > 0.0)?))
    }),
    ("Energy at the end less that at the start, as such a height [mm]", |row, _| {
        let figures = row.figures();
        let change = figures.energy? - figures.energy_start?;
        mm(Some(change / figures.weight.filter(|weight| *weight > 0.0)?))
    }),
    ("All asleep after [s], or how many are after a minute", asleep),
    ("Memory for each body [kB]", |row, _| Some(format!("{:.1}", row.bytes_per_body()? / 1000.0))),
];

/// The whole page.
pub(super) fn page(facts: &[(&str, String)], rows: &[Row], engines: &[String]) -> Result<String, fmt::Error> {
    let mut text = String::from("# Side by side\n\n");
    facts.iter().try_for_each(|(name, value)| writeln!(text, "- {name}: {value}"))?;
    for (title, cell) in TABLES {
        table(&mut text, title, (rows, engines), cell)?;
    }
    Ok(text)
}

fn timed(row: &Row, base: &Row, of: fn(&Outcome) -> f64) -> Option<String> {
    let (ms, ratio) = (row.median(of)?, row.ratio(base, of)?);
    let digits = if ms < 1.0 { 3 } else { 2 };
    Some(format!("{ms:.digits$} ({ratio:.2})"))
}

fn equal(row: &Row, _: &Row) -> Option<String> {
    Some(match row.equal? {
        Equal::At { effort, mean_ms, ratio } => format!("{mean_ms:.2} ({ratio:.2}) at {effort}"),
        Equal::None => "none".into(),
    })
}

fn drift(row: &Row, _: &Row) -> Option<String> {
    let figures = row.figures();
    let late = mm(figures.drift_60).unwrap_or_else(|| "-".into());
    Some(format!("{} / {late}", mm(figures.drift_3)?))
}

fn asleep(row: &Row, _: &Row) -> Option<String> {
    let slept = row.slept.as_ref()?;
    let after = slept.asleep_after.map(|after| format!("{after:.1}"));
    Some(after.unwrap_or_else(|| format!("{} of {}", slept.asleep, slept.bodies)))
}

fn mm(metres: Option<f64>) -> Option<String> {
    let mm = metres? * 1e3;
    Some(if mm.abs() < 10.0 { format!("{mm:.1}") } else { format!("{mm:.0}") })
}

fn table(text: &mut String, title: &str, (rows, engines): (&[Row], &[String]), cell: Cell) -> fmt::Result {
    let mut lines = String::new();
    // backstop is the first of each scene.
    for base in rows.iter().filter(|row| row.engine == engines[0]) {
        let of = |engine: &String| {
            let same =
                |row: &&Row| (&row.scene, row.threads, &row.engine) == (&base.scene, base.threads, engine);
            rows.iter().find(same).and_then(|row| match (cell(row, base), &row.failed) {
                (None, Some(_)) => Some("failed".into()),
                (text, _) => text,
            })
        };
        let cells: Vec<Option<String>> = engines.iter().map(of).collect();
        if cells.iter().flatten().any(|cell| cell != "failed") {
            let cells: Vec<String> = cells.into_iter().map(Option::unwrap_or_default).collect();
            writeln!(lines, "| {} | {} | {} |", base.scene, base.threads, cells.join(" | "))?;
        }
    }
    if !lines.is_empty() {
        writeln!(text, "\n## {title}\n\n| scene | threads | {} |", engines.join(" | "))?;
        writeln!(text, "|---|---|{}\n{}", "---|".repeat(engines.len()), lines.trim_end())?;
    }
    Ok(())
}
