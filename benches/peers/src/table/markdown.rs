//! A record as tables to read.

use super::row::{Equal, Row};
use std::fmt::{self, Write};

/// A column of a table: its name, and the text of a row.
type Column = (&'static str, fn(&Row, &Row) -> Option<String>);

/// The whole page.
pub(super) fn page(facts: &[(&str, String)], rows: &[Row], engines: &[String]) -> Result<String, fmt::Error> {
    let mut text = String::from("# Side by side\n\n");
    facts.iter().try_for_each(|(name, value)| writeln!(text, "- {name}: {value}"))?;
    let tables: [(&str, Column); 11] = [
        ("Mean step [ms], and against backstop's", ("time", |row, base| timed(row, base, |run| run.ms.mean))),
        ("Median step [ms]", ("median", |row, base| timed(row, base, |run| run.ms.median))),
        ("95th percentile of the steps [ms]", ("p95", |row, base| timed(row, base, |run| run.ms.p95))),
        (
            "Mean step at an error no larger than backstop's [ms], at so many times the substeps",
            ("equal", equal),
        ),
        (
            "The body that moved most, after 3 s / 60 s [mm]",
            ("drift", |row, _| {
                let figures = row.figures();
                let late = figures.drift_60.map_or_else(|| "-".into(), |m| mm(Some(m)).unwrap_or_default());
                Some(format!("{} / {late}", mm(figures.drift_3)?))
            }),
        ),
        ("Deepest overlap at the end [mm], meshes left out", ("depth", |row, _| mm(row.figures().depth))),
        (
            "Widest gap of a joint, ever / at the end [mm]",
            ("joints", |row, _| {
                let figures = row.figures();
                Some(format!("{} / {}", mm(figures.joint_worst)?, mm(figures.joint)?))
            }),
        ),
        (
            "Bodies that passed through something",
            ("lost", |row, _| row.figures().lost.map(|lost| lost.to_string())),
        ),
        (
            "Energy gained at most, in parts of the start's",
            ("energy", |row, _| {
                let figures = row.figures();
                let start = figures.energy_start?.abs().max(1.0);
                Some(format!("{:.1e}", figures.energy_gain? / start))
            }),
        ),
        (
            "All asleep after [s], or how many are after a minute",
            ("sleep", |row, _| {
                let slept = row.slept.as_ref()?;
                let after = slept.asleep_after.map(|after| format!("{after:.1}"));
                Some(after.unwrap_or_else(|| format!("{} of {}", slept.asleep, slept.bodies)))
            }),
        ),
        (
            "Memory for each body [kB]",
            ("memory", |row, _| Some(format!("{:.1}", row.bytes_per_body()? / 1000.0))),
        ),
    ];
    for (title, (_, cell)) in tables {
        table(&mut text, title, rows, engines, cell)?;
    }
    Ok(text)
}

fn timed(row: &Row, base: &Row, of: fn(&crate::run::Outcome) -> f64) -> Option<String> {
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

fn mm(metres: Option<f64>) -> Option<String> {
    let mm = metres? * 1e3;
    Some(if mm.abs() < 10.0 { format!("{mm:.1}") } else { format!("{mm:.0}") })
}

fn table(
    text: &mut String,
    title: &str,
    rows: &[Row],
    engines: &[String],
    cell: impl Fn(&Row, &Row) -> Option<String>,
) -> fmt::Result {
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
