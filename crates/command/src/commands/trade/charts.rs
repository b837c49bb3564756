//! Curves of error over cost, both on logarithmic axes.

use super::outcome::{Outcome, Row};
use crate::report::charts::{
    Area, BLUE, Drawn, GREEN, INK, ORANGE, PALE, RED, RULE, SKY, draw_lines, frame, legend, text,
};
use backstop_lab::trade::{Axis, front as front_of};
use plotters::prelude::*;

/// Smaller errors are drawn at this value.
const LEAST: f64 = 1e-9;
const COLOURS: [RGBColor; 6] = [BLUE, RED, GREEN, ORANGE, SKY, INK];
/// More lines could not be told apart.
const MAX_LINES: usize = COLOURS.len();

/// Powers of ten of the relative cost and of the error; none if it was not timed.
fn point(row: &Row, certain_to: f64) -> Option<(f64, f64)> {
    Some((row.cost_ratio?.log10(), row.error?.max(certain_to).max(LEAST).log10()))
}

/// The range of all points.
fn bounds(outcome: &Outcome) -> [std::ops::Range<f64>; 2] {
    let points: Vec<_> = outcome.cells.iter().filter_map(|row| point(row, outcome.certain_to)).collect();
    let range = |of: fn(&(f64, f64)) -> f64, room: f64| {
        let (low, high) =
            points.iter().map(of).fold((f64::INFINITY, f64::NEG_INFINITY), |(l, h), x| (l.min(x), h.max(x)));
        if low > high { -1.0..1.0 } else { low - 0.1..high + room }
    };
    // Room for the legend on the right.
    [range(|p| p.0, 0.5), range(|p| p.1, 0.2)]
}

macro_rules! log_frame {
    ($area:expr, $outcome:expr, $title:expr) => {{
        let [x, y] = bounds($outcome);
        frame!(
            $area,
            $title,
            x,
            y,
            "time, relative to the default setting",
            format!("{} [{}]", $outcome.error.name(), $outcome.unit),
            &|x| format!("{:.2}", power(*x)),
            &|y| format!("{:.1e}", power(*y))
        )
    }};
}

fn power(exponent: f64) -> f64 {
    10_f64.powf(exponent)
}

/// All settings, and the front.
pub(super) fn front(area: &Area<'_>, outcome: &Outcome) -> Drawn {
    let mut chart = log_frame!(area, outcome, "Error over time");
    let place = |row: &Row| point(row, outcome.certain_to);
    let (kept, broken): (Vec<&Row>, Vec<&Row>) = outcome.cells.iter().partition(|row| row.breaks.is_empty());
    let places = |rows: Vec<&Row>| -> Vec<_> { rows.into_iter().filter_map(place).collect() };
    chart
        .draw_series(places(broken).into_iter().map(|at| Cross::new(at, 3, RED.stroke_width(1))))?
        .label("breaks a condition")
        .legend(|(x, y)| Cross::new((x + 8, y), 3, RED.stroke_width(1)));
    chart
        .draw_series(places(kept).into_iter().map(|at| Circle::new(at, 2, PALE.filled())))?
        .label("a setting")
        .legend(|(x, y)| Circle::new((x + 8, y), 3, PALE.filled()));
    chart
        .draw_series(
            LineSeries::new(outcome.front.iter().filter_map(place), BLUE.stroke_width(2)).point_size(3),
        )?
        .label("the front")
        .legend(|(x, y)| PathElement::new([(x, y), (x + 16, y)], BLUE.stroke_width(3)));
    chart
        .draw_series(place(&outcome.default).map(|at| {
            EmptyElement::at(at) + Polygon::new(vec![(0, -6), (6, 0), (0, 6), (-6, 0)], ORANGE.filled())
        }))?
        .label("default")
        .legend(|(x, y)| Rectangle::new([(x + 4, y - 4), (x + 12, y + 4)], ORANGE.filled()));
    chart
        .draw_series(
            outcome.picked.as_ref().and_then(place).map(|at| Circle::new(at, 7, RED.stroke_width(2))),
        )?
        .label("picked")
        .legend(|(x, y)| Circle::new((x + 8, y), 5, RED.stroke_width(2)));
    legend!(chart);
    Ok(())
}

/// The front of those that have each value of an axis.
pub(super) fn axis(area: &Area<'_>, outcome: &Outcome, at: usize, axis: Axis, values: &[&str]) -> Drawn {
    let mut chart = log_frame!(area, outcome, format!("Error over time, by {}", axis.name()));
    let lines = values.iter().take(MAX_LINES).zip(COLOURS).map(|(value, colour)| {
        let has = |row: &&Row| row.breaks.is_empty() && row.axes.get(at).is_some_and(|own| own == value);
        let points: Vec<(f64, f64)> =
            outcome.cells.iter().filter(has).filter_map(|row| point(row, outcome.certain_to)).collect();
        let pairs: Vec<[f64; 2]> = points.iter().map(|&(x, y)| [x, y]).collect();
        let line: Vec<(f64, f64)> = front_of(&pairs).into_iter().map(|i| points[i]).collect();
        ((*value).to_owned(), colour, line)
    });
    draw_lines!(chart, lines);
    Ok(())
}
