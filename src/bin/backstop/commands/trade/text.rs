//! The tables of a sweep, for people.

use super::outcome::{Outcome, Row};
use crate::report::output::micros;
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
    let horizon = if header.horizon < outcome.seconds {
        format!(
            "until {:.2} s, when runs of {} and {} Hz part by 1 % of a body",
            header.horizon,
            header.reference_hz,
            header.reference_hz / 2
        )
    } else {
        "to the end".into()
    };
    let _ = writeln!(text, "Trajectories are compared {horizon}.");
    let _ = writeln!(
        text,
        "Errors are told by {} [{}]; those marked ~ are below what the reference is certain to, {}.",
        outcome.error.name(),
        outcome.unit,
        number(Some(outcome.certain_to))
    );
    text
}

pub(super) fn text(outcome: &Outcome) -> String {
    let mut text = about(outcome);
    let line = |row: &Row| {
        let [cost, ratio, error] = cells(row);
        format!("  {cost:>10} {ratio:>9} {error:>11}  {}\n", row.name)
    };
    let _ = writeln!(text, "\n  {:>10} {:>9} {:>11}  setting", "cost", "relative", "error");
    outcome.front.iter().for_each(|row| text += &line(row));
    text += "The default setting:\n";
    text += &line(&outcome.default);
    if let Some(picked) = &outcome.picked {
        let _ = writeln!(text, "Picked, {}:", outcome.rule);
        text += &line(picked);
    }
    if !outcome.axes.is_empty() {
        let _ = writeln!(
            text,
            "\n  {:<22} {:<26} {:>8} {:>12} {:>22}",
            "axis", "value", "on front", "least error", "cheapest as good"
        );
    }
    let mut last = "";
    for value in &outcome.axes {
        let axis = if value.axis.name() == last { "" } else { value.axis.name() };
        last = value.axis.name();
        let _ = writeln!(
            text,
            "  {axis:<22} {:<26} {:>8} {:>12} {:>22}",
            value.value,
            value.on_front,
            number(value.least_error),
            value.cheapest_ratio.map_or("none".into(), |ratio| format!("{ratio:.2} of default"))
        );
    }
    text
}

/// Cost, relative cost and error of a setting.
pub(super) fn cells(row: &Row) -> [String; 3] {
    let mark = if row.certain || row.error.is_none() { "" } else { "~" };
    [
        row.cost_us.map_or("not timed".into(), micros),
        row.cost_ratio.map_or(String::new(), |ratio| format!("{ratio:.2}")),
        format!("{mark}{}", number(row.error)),
    ]
}

/// With three digits.
pub(super) fn number(value: Option<f64>) -> String {
    match value {
        Some(0.0) => "0".into(),
        Some(value) => format!("{value:.2e}"),
        None => "lost".into(),
    }
}
