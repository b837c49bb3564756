//! The map in the terminal.

use super::results::Results;
use backstop_lab::envelope::{Axis, Cell, Trial, Verdict};
use std::fmt::Write;

/// One character a cell.
fn mark(verdict: Option<Verdict>) -> char {
    match verdict {
        Some(Verdict::Stable) => '.',
        Some(Verdict::Degraded) => 'o',
        Some(Verdict::Lost) => 'X',
        None => '?',
    }
}

/// How many cells are stable, degraded and lost.
pub(crate) fn counts(cells: &[Cell], results: &Results) -> [usize; 3] {
    let of = |verdict| cells.iter().filter(|cell| results.verdict(&cell.name()) == Some(verdict)).count();
    [Verdict::Stable, Verdict::Degraded, Verdict::Lost].map(of)
}

/// The maps of all engines, and the figures of cells that are not stable here.
pub(crate) fn text(cells: &[Cell], ours: &Results, beside: &[Results]) -> String {
    let mut text = String::new();
    for results in std::iter::once(ours).chain(beside) {
        let [stable, degraded, lost] = counts(cells, results);
        let _ = writeln!(
            text,
            "{}: {stable} stable (.), {degraded} degraded (o), {lost} lost (X)",
            results.engine
        );
        text += &one(cells, results);
        text.push('\n');
    }
    for cell in cells {
        let name = cell.name();
        let Some(worst) = ours.worst(&name).filter(|worst| worst.verdict > Verdict::Stable) else { continue };
        let _ = write!(text, "{name:<34}{:<10}{:<18}", worst.verdict.name(), worst.text());
        for other in beside {
            if let Some(theirs) = other.worst(&name) {
                let _ = write!(text, "  {}: {}, {}", other.engine, theirs.verdict.name(), theirs.text());
            }
        }
        text.push('\n');
    }
    text
}

fn one(cells: &[Cell], results: &Results) -> String {
    let mut text = format!("{:<12}", "");
    let widths = Axis::ALL.map(|axis| axis.name().len().max(axis.points().len()) + 1);
    for (axis, width) in Axis::ALL.iter().zip(widths) {
        let _ = write!(text, "{:<width$}", axis.name());
    }
    text.truncate(text.trim_end().len());
    text.push('\n');
    for trial in Trial::ALL {
        let of = |axis: Axis| cells.iter().filter(move |cell| cell.trial == trial && cell.axis == axis);
        if Axis::ALL.into_iter().all(|axis| of(axis).next().is_none()) {
            continue;
        }
        let mut line = format!("{:<12}", trial.name());
        for (axis, width) in Axis::ALL.into_iter().zip(widths) {
            let marks: String = of(axis).map(|cell| mark(results.verdict(&cell.name()))).collect();
            let _ = write!(line, "{marks:<width$}");
        }
        text += line.trim_end();
        text.push('\n');
    }
    text
}
