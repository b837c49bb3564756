//! Charts of a run, as SVG.

#[cfg(test)]
mod tests;

use crate::report::accuracy::{Course, FIGURES};
use crate::report::document::Document;
use crate::report::output::{micros, plural};
use crate::report::trace::{STAGES, Stage, Trace};
use plotters::coord::Shift;
use plotters::prelude::*;
use plotters::style::text_anchor::{HPos, Pos, VPos};

pub(crate) type Area<'a> = DrawingArea<SVGBackend<'a>, Shift>;
pub(crate) type Drawn = Result<(), Box<dyn std::error::Error>>;

const SIZE: (u32, u32) = (960, 340);
/// The most columns of a chart: longer runs are drawn with several steps a column.
const COLUMNS: usize = 480;
/// Colours of text and rules, and of background elements.
pub(crate) const INK: RGBColor = RGBColor(51, 56, 64);
pub(crate) const RULE: RGBColor = RGBColor(226, 229, 234);
pub(crate) const PALE: RGBColor = RGBColor(190, 205, 224);
/// Okabe and Ito's colours, which the colour-blind can tell apart.
pub(crate) const BLUE: RGBColor = RGBColor(0, 114, 178);
pub(crate) const SKY: RGBColor = RGBColor(86, 180, 233);
pub(crate) const GREEN: RGBColor = RGBColor(0, 158, 115);
pub(crate) const ORANGE: RGBColor = RGBColor(230, 159, 0);
pub(crate) const RED: RGBColor = RGBColor(213, 94, 0);
const STAGE_COLOURS: [RGBColor; 5] = [BLUE, SKY, GREEN, ORANGE, RED];

/// Steps that share a column, and the number of the last step in each.
pub(crate) struct Columns {
    steps: usize,
    width: usize,
}

impl Columns {
    pub(crate) fn of(steps: usize) -> Columns {
        Columns { steps, width: steps.div_ceil(COLUMNS).max(1) }
    }

    /// Middle of each column [steps] with the value of `f` for its steps.
    pub(crate) fn map<'a, T: 'a>(
        &'a self,
        mut f: impl FnMut(std::ops::Range<usize>) -> T + 'a,
    ) -> impl Iterator<Item = (f64, T)> + 'a {
        (0..self.steps).step_by(self.width).map(move |first| {
            let range = first..(first + self.width).min(self.steps);
            (0.5 * (range.start + range.end + 1) as f64, f(range))
        })
    }

    /// Middle of each column with the mean of its steps.
    pub(crate) fn means(&self, of: impl Fn(usize) -> f64) -> Vec<(f64, f64)> {
        self.map(|range| range.clone().map(&of).sum::<f64>() / range.len() as f64).collect()
    }

    /// Middle of each column with the greatest of its steps, of numbers from `least` up.
    pub(crate) fn greatest(&self, least: f64, of: impl Fn(usize) -> f64) -> Vec<(f64, f64)> {
        self.map(|range| range.map(&of).fold(least, f64::max)).collect()
    }

    /// The axis label, which says if a column has several steps.
    pub(crate) fn axis(&self, what: &str) -> String {
        if self.width == 1 { "step".into() } else { format!("step ({what} of {} a column)", self.width) }
    }
}

pub(crate) fn text(size: u32) -> TextStyle<'static> {
    ("sans-serif", size).into_font().color(&INK)
}

/// Line charts share their frame: title, mesh, labelled axes.
macro_rules! frame {
    ($area:expr, $title:expr, $x:expr, $y:expr, $x_name:expr, $y_name:expr, $label:expr) => {
        frame!($area, $title, $x, $y, $x_name, $y_name, &|x| format!("{x:.0}"), $label)
    };
    ($area:expr, $title:expr, $x:expr, $y:expr, $x_name:expr, $y_name:expr, $x_label:expr, $label:expr) => {{
        $area.fill(&WHITE)?;
        let mut chart = ChartBuilder::on($area)
            .caption($title, text(18))
            .margin(12)
            .margin_right(24)
            .x_label_area_size(42)
            .y_label_area_size(76)
            .build_cartesian_2d($x, $y)?;
        chart
            .configure_mesh()
            .x_desc($x_name)
            .y_desc($y_name)
            .axis_desc_style(text(14))
            .label_style(text(13))
            .axis_style(INK.mix(0.6))
            .bold_line_style(RULE)
            .light_line_style(WHITE)
            .x_labels(10)
            .y_labels(7)
            .x_label_formatter($x_label)
            .y_label_formatter($label)
            .draw()?;
        chart
    }};
}

/// A legend in the upper right corner.
macro_rules! legend {
    ($chart:expr) => {
        $chart
            .configure_series_labels()
            .position(SeriesLabelPosition::UpperRight)
            .background_style(WHITE.mix(0.85))
            .border_style(RULE)
            .label_font(text(13))
            .draw()?
    };
}

/// Lines with their names in a legend.
macro_rules! draw_lines {
    ($chart:expr, $lines:expr) => {
        for (name, colour, line) in $lines {
            $chart
                .draw_series(LineSeries::new(line, colour.stroke_width(2)))?
                .label(name)
                .legend(move |(x, y)| PathElement::new([(x, y), (x + 16, y)], colour.stroke_width(3)));
        }
        legend!($chart);
    };
}

pub(crate) use {draw_lines, frame, legend};

/// How high the bars of a chart are, at most: all but the highest hundredth of them fit.
pub(crate) fn clipped_at(heights: &[f64]) -> f64 {
    let mut sorted = heights.to_vec();
    sorted.sort_unstable_by(f64::total_cmp);
    sorted.get((sorted.len().max(1) - 1) * 99 / 100).copied().unwrap_or(0.0).max(1e-3)
}

/// Time of each stage, stacked. Columns above the 99th percentile are cut off there, marked and counted; the
/// caption of the page says how long the slowest step took.
pub(crate) fn times(area: &Area<'_>, trace: &Trace) -> Drawn {
    let reports = &trace.reports;
    let columns = Columns::of(reports.len());
    let mean = |stage: Stage| columns.means(|i| f64::from(stage(&reports[i])));
    let stages: Vec<Vec<(f64, f64)>> = STAGES.iter().map(|s| mean(s.1)).collect();
    let sums: Vec<f64> = (0..stages[0].len()).map(|i| stages.iter().map(|s| s[i].1).sum()).collect();
    let most = clipped_at(&sums);
    let (unit, scale) = if most >= 1000.0 { ("ms", 1e-3) } else { ("µs", 1.0) };
    // Room for the legend.
    let (most_shown, top) = (most * scale, 1.35 * most * scale);
    let beyond: Vec<f64> =
        stages[0].iter().zip(&sums).filter(|(_, sum)| **sum > most).map(|(column, _)| column.0).collect();
    let mut chart = frame!(
        area,
        "Time per stage",
        0.0..reports.len() as f64 + 1.0,
        0.0..top,
        columns.axis("mean"),
        format!("time [{unit}]"),
        &|y| plain(*y, top)
    );
    // The highest stack first, so that each stage covers the parts of others.
    for last in (0..STAGES.len()).rev() {
        let pile = (0..stages[0].len()).map(|i| {
            let height: f64 = stages[..=last].iter().map(|s| s[i].1).sum();
            (stages[0][i].0, (height * scale).min(most_shown))
        });
        let colour = STAGE_COLOURS[last];
        chart
            .draw_series(AreaSeries::new(pile, 0.0, colour.filled()))?
            .label(STAGES[last].0)
            .legend(move |(x, y)| Rectangle::new([(x, y - 5), (x + 16, y + 5)], colour.filled()));
    }
    if !beyond.is_empty() {
        let name = format!("{} beyond {}", plural(beyond.len() as u64, "column", "columns"), micros(most));
        let marks = beyond.into_iter().map(|x| TriangleMarker::new((x, 1.03 * most_shown), 5, INK.filled()));
        chart
            .draw_series(marks)?
            .label(name)
            .legend(|(x, y)| TriangleMarker::new((x + 8, y), 5, INK.filled()));
    }
    legend!(chart);
    Ok(())
}

/// Contact points and potential manifolds.
pub(crate) fn contacts(area: &Area<'_>, trace: &Trace) -> Drawn {
    type What = fn(&backstop::StepReport) -> u32;
    let lines: [(&str, RGBColor, What); 4] = [
        ("real points", BLUE, |r| r.real),
        ("potential points", SKY, |r| r.potential),
        ("pushed manifolds", ORANGE, |r| r.pushed),
        ("ghosts", RED, |r| r.ghosts),
    ];
    let reports = &trace.reports;
    let columns = Columns::of(reports.len());
    let most = |what: What| columns.greatest(0.0, |i| f64::from(what(&reports[i])));
    let drawn: Vec<_> = lines.iter().map(|&(name, colour, what)| (name, colour, most(what))).collect();
    counts(area, "Contacts", &columns, drawn)
}

/// A line of a chart: its name, and where it goes.
pub(crate) type Line = (&'static str, RGBColor, Vec<(f64, f64)>);

/// Counts in a step, the most of each column.
pub(crate) fn counts(area: &Area<'_>, title: &str, columns: &Columns, lines: Vec<Line>) -> Drawn {
    let top = lines.iter().flat_map(|(_, _, line)| line).fold(4.0f64, |m, p| m.max(p.1));
    // Room for the legend.
    let top = 1.4 * top;
    let mut chart = frame!(
        area,
        title,
        0.0..columns.steps as f64 + 1.0,
        0.0..top,
        columns.axis("most"),
        "count in a step",
        &|y| plain(*y, top)
    );
    draw_lines!(chart, lines);
    Ok(())
}

/// Kinetic and potential energy of all moving bodies.
pub(crate) fn energy(area: &Area<'_>, trace: &Trace, dt: f64) -> Drawn {
    let columns = Columns::of(trace.energy.len());
    let line: Vec<(f64, f64)> = columns
        .map(|range| trace.energy[range.end - 1])
        .map(|(x, e)| (x * dt, if e.is_finite() { e } else { 0.0 }))
        .collect();
    let (mut low, mut high) =
        line.iter().fold((f64::INFINITY, f64::NEG_INFINITY), |(l, h), p| (l.min(p.1), h.max(p.1)));
    // A constant is a line in the middle.
    let room = (0.08 * (high - low)).max(1e-3 * high.abs()).max(1e-6);
    (low, high) = (low - room, high + room);
    let (unit, scale) = match low.abs().max(high.abs()) {
        e if e >= 1e6 => ("MJ", 1e-6),
        e if e >= 1e3 => ("kJ", 1e-3),
        _ => ("J", 1.0),
    };
    let spread = (high - low) * scale;
    let end = line.last().map_or(1.0, |p| p.0).max(dt);
    let mut chart = frame!(
        area,
        "Energy: kinetic and in gravity, above the height zero",
        0.0..end,
        low * scale..high * scale,
        "time [s]",
        format!("energy [{unit}]"),
        &|x| plain(*x, end),
        &|y| plain(*y, spread)
    );
    chart
        .draw_series(LineSeries::new(line.into_iter().map(|(x, e)| (x, e * scale)), BLUE.stroke_width(2)))?;
    Ok(())
}

/// Errors of the laws in each step: the maximum of each column, on a logarithmic axis.
pub(crate) fn accuracy(area: &Area<'_>, course: &Course) -> Drawn {
    let columns = Columns::of(course.figures[0].len());
    let lines: Vec<Line> = [
        ("residual", "residual [m/s]", RED),
        ("penetration", "penetration [m]", BLUE),
        ("joint_length", "joint error [m]", GREEN),
    ]
    .into_iter()
    .filter_map(|(figure, name, colour)| {
        let values = &course.figures[FIGURES.iter().position(|f| f.0 == figure)?];
        let most = columns.greatest(LEAST, |i| values[i]);
        Some((name, colour, most.into_iter().map(|(x, y)| (x, y.log10())).collect()))
    })
    .collect();
    let top =
        lines.iter().flat_map(|(_, _, line)| line).fold(LEAST.log10() + 4.0, |m, p| m.max(p.1)).ceil() + 1.0;
    let mut chart = frame!(
        area,
        "Accuracy: zero is exact",
        0.0..columns.steps as f64 + 1.0,
        LEAST.log10()..top,
        columns.axis("most"),
        "power of ten",
        &|y| format!("1e{y:.0}")
    );
    draw_lines!(chart, lines);
    Ok(())
}

/// Smaller errors are drawn at this value.
const LEAST: f64 = 1e-8;

/// Bytes by category: live inside reserved, with the peak as a mark.
pub(crate) fn memory(area: &Area<'_>, document: &Document) -> Drawn {
    area.fill(&WHITE)?;
    let categories = &document.memory.categories;
    let most = categories.iter().map(|c| c.bytes.peak.max(c.bytes.reserved)).max().unwrap_or(0) as f64;
    let (unit, scale) = if most >= 1e6 { ("MiB", 1.0 / 1048576.0) } else { ("KiB", 1.0 / 1024.0) };
    let top = (most * scale * 1.12).max(1e-3);
    let count = categories.len();
    let mut chart = ChartBuilder::on(area)
        .caption("Memory by category", text(18))
        .margin(12)
        .margin_right(24)
        .x_label_area_size(42)
        .y_label_area_size(110)
        .build_cartesian_2d(0.0..top, 0.0..count as f64)?;
    chart
        .configure_mesh()
        .x_desc(format!("bytes [{unit}]"))
        .axis_desc_style(text(14))
        .label_style(text(13))
        .axis_style(INK.mix(0.6))
        .bold_line_style(RULE)
        .light_line_style(WHITE)
        .disable_y_mesh()
        .y_labels(0)
        .x_label_formatter(&|x| plain(*x, top))
        .draw()?;
    // From the top down, in the order of every other report.
    let bar = |i: usize, bytes: usize, half: f64| {
        let middle = (count - i) as f64 - 0.5;
        [(0.0, middle - half), (bytes as f64 * scale, middle + half)]
    };
    type Part = fn(&backstop::Bytes) -> usize;
    let parts: [(&str, RGBColor, f64, Part); 2] =
        [("reserved", PALE, 0.34, |b| b.reserved), ("live", BLUE, 0.2, |b| b.live)];
    for (name, colour, half, part) in parts {
        let bars = categories.iter().enumerate();
        chart
            .draw_series(bars.map(|(i, c)| Rectangle::new(bar(i, part(&c.bytes), half), colour.filled())))?
            .label(name)
            .legend(move |(x, y)| Rectangle::new([(x, y - 5), (x + 16, y + 5)], colour.filled()));
    }
    let peaks = categories.iter().enumerate().filter(|(_, c)| c.bytes.peak > 0);
    chart
        .draw_series(peaks.map(|(i, c)| {
            let [(_, low), (x, high)] = bar(i, c.bytes.peak, 0.4);
            PathElement::new([(x, low), (x, high)], RED.stroke_width(3))
        }))?
        .label("peak")
        .legend(|(x, y)| PathElement::new([(x + 8, y - 6), (x + 8, y + 6)], RED.stroke_width(3)));
    legend!(chart);
    for (i, category) in categories.iter().enumerate() {
        let at = chart.backend_coord(&(0.0, (count - i) as f64 - 0.5));
        let style = text(13).pos(Pos::new(HPos::Right, VPos::Center));
        area.draw(&Text::new(category.name.replace('_', " "), (at.0 - 8, at.1), style))?;
    }
    Ok(())
}

/// One chart as the text of an SVG file.
pub(crate) fn svg(draw: impl FnOnce(&Area<'_>) -> Drawn) -> Result<String, Box<dyn std::error::Error>> {
    let mut text = String::new();
    {
        let area = SVGBackend::with_string(&mut text, SIZE).into_drawing_area();
        draw(&area)?;
        area.present()?;
    }
    Ok(text)
}

/// A number on an axis that spans `range`, with as many digits as tell its labels apart.
pub(crate) fn plain(value: f64, range: f64) -> String {
    let digits = if range >= 20.0 {
        0
    } else if range >= 2.0 {
        1
    } else if range >= 0.2 {
        2
    } else {
        4
    };
    format!("{value:.digits$}")
}
