//! The tables of a sweep, for people.

use super::outcome::{Outcome, Row};
use crate::report::output::micros;
use crate::report::table::table;
use backstop_lab::trade::Measure;
use std::fmt::Write;

/// The reference and its accuracy.
pub(super) fn about(outcome: &Outcome) -> String {
    let header = &outcome.header;
    let mut text = format!(
        "{}: {} settings, {} s, against a reference of {} Hz\n",
        header.scene,
        outcome.cells.len(),
        outcome.seconds,
        header.reference_hz
    );
    let until = if header.share < 1.0 {
        format!(
            ", until runs of {} and {} Hz, or of slightly other starts, part by 5 % of a body",
            header.reference_hz,
            header.reference_hz / 2
        )
    } else {
        String::new()
    };
    let _ = writeln!(text, "Paths are compared for {:.0} % of the run{until}.", 100.0 * header.share);
    if let Some(warning) = &outcome.warning {
        let _ = writeln!(text, "Warning: {warning}.");
    }
    let _ = writeln!(
        text,
        "Errors are told by {} [{}]; those marked ~ are below what the reference is certain to, {}.",
        outcome.error.name(),
        outcome.unit,
        number(Some(outcome.certain_to))
    );
    let limit = |(measure, most): (&Measure, &f64)| format!("{} {}", measure.name(), short(*most));
    let limits: Vec<String> = outcome.limits.iter().map(limit).collect();
    let broken = outcome.cells.iter().filter(|row| !row.breaks.is_empty()).count();
    let _ = writeln!(
        text,
        "Conditions of a pick, at most: {}. {broken} of {} settings break one.",
        limits.join(", "),
        outcome.cells.len()
    );
    text
}

pub(super) fn text(outcome: &Outcome) -> String {
    let mut text = about(outcome) + "\n";
    let row = |note: &str, row: &Row| {
        let notes: Vec<String> =
            [note.to_owned(), breaks(row)].into_iter().filter(|note| !note.is_empty()).collect();
        [vec![row.name.clone()], cells(row), vec![notes.join("; ")]].concat()
    };
    let front = outcome.front.iter().map(|one| row("", one));
    let excluded = outcome.excluded.iter().map(|one| row("not on the front", one));
    let picked = format!("picked, {}", outcome.rule);
    let picked = outcome.picked.iter().map(|one| row(&picked, one));
    let rows = front.chain(excluded).chain([row("the default setting", &outcome.default)]).chain(picked);
    let headings = [&["setting"], &COLUMNS[..], &[""]].concat();
    text += &table(&headings, 1, rows);
    if !outcome.axes.is_empty() {
        let mut last = "";
        let rows = outcome.axes.iter().map(|value| {
            let axis = if value.axis.name() == last { "" } else { value.axis.name() };
            last = value.axis.name();
            let cheapest =
                value.cheapest_ratio.map_or("none".into(), |ratio| format!("{ratio:.2} of default"));
            let (count, least) = (value.on_front.to_string(), number(value.least_error));
            vec![axis.to_owned(), value.value.clone(), count, least, cheapest]
        });
        let headings = ["axis", "value", "on front", "least error", "cheapest as good"];
        text += &format!("\n{}", table(&headings, 2, rows));
    }
    text
}

/// The conditions that a setting breaks, in words.
pub(super) fn breaks(row: &Row) -> String {
    let of = |&measure: &Measure| format!("{} {}", measure.name(), short(row.errors.of(measure)));
    if row.error.is_none() {
        return "lost: not finite".into();
    }
    let broken: Vec<String> = row.breaks.iter().map(of).collect();
    if broken.is_empty() { String::new() } else { format!("breaks {}", broken.join(", ")) }
}

/// With two digits.
fn short(value: f64) -> String {
    match value {
        _ if !value.is_finite() => "lost".into(),
        0.0 => "0".into(),
        1e-3..1e4 => {
            let digits = (1.0 - value.log10().floor()).max(0.0) as usize;
            let text = format!("{value:.digits$}");
            if text.contains('.') { text.trim_end_matches('0').trim_end_matches('.').into() } else { text }
        }
        _ => format!("{value:.1e}"),
    }
}

/// Headings of [`cells`].
pub(super) const COLUMNS: [&str; 12] = [
    "cost",
    "relative",
    "error",
    Measure::Worst.name(),
    Measure::Overlap.name(),
    Measure::Lasting.name(),
    Measure::Opening.name(),
    Measure::Gain.name(),
    Measure::Lost.name(),
    Measure::Unrest.name(),
    Measure::Deviation.name(),
    Measure::Heap.name(),
];

/// Cost, relative cost, error, that of the worst body, and conditions of a setting.
pub(super) fn cells(row: &Row) -> Vec<String> {
    let mark = if row.certain || row.error.is_none() { "" } else { "~" };
    let of = |measure| Some(row.errors.of(measure)).filter(|error| error.is_finite());
    let mut cells = vec![
        row.cost_us.map_or("not timed".into(), micros),
        row.cost_ratio.map_or(String::new(), |ratio| format!("{ratio:.2}")),
        format!("{mark}{}", number(row.error)),
        number(of(Measure::Worst)),
    ];
    cells.extend(Measure::CONDITIONS.map(|measure| short(row.errors.of(measure))));
    cells
}

/// With three digits.
pub(super) fn number(value: Option<f64>) -> String {
    match value {
        Some(0.0) => "0".into(),
        Some(value) => format!("{value:.2e}"),
        None => "lost".into(),
    }
}
