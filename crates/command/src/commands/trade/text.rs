//! The tables of a sweep, for people.

use super::outcome::{Outcome, Row};
use crate::report::output::micros;
use crate::report::table::table;
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
    let mut text = about(outcome) + "\n";
    let row = |name: &str, row: &Row| {
        [std::slice::from_ref(&row.name), &cells(row)[..], &[name.to_owned()]].concat()
    };
    let front = outcome.front.iter().map(|one| row("", one));
    let picked = format!("picked, {}", outcome.rule);
    let picked = outcome.picked.iter().map(|one| row(&picked, one));
    let rows = front.chain([row("the default setting", &outcome.default)]).chain(picked);
    text += &table(&["setting", "cost", "relative", "error", ""], 1, rows);
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
