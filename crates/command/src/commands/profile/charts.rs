//! The charts of the talk for a scene.

use super::ledger::{Ledger, Run};
use super::measure::Frame;
use crate::report::charts::{
    Area, BLUE, Columns, Drawn, GREEN, INK, ORANGE, PALE, RED, RULE, SKY, counts, draw_lines, frame, legend,
    plain, text,
};
use crate::report::output::{bytes, count_threads};
use plotters::prelude::*;
use plotters::style::text_anchor::{HPos, Pos, VPos};

/// A line of a chart: its name, and its value of a frame.
type Line<T> = (&'static str, RGBColor, fn(&Frame) -> T);
/// A slice of a pie: its name and its bytes.
type Slice = (&'static str, usize);

/// Median times of both steps, frame by frame.
pub(crate) fn cost(area: &Area<'_>, run: &Run) -> Drawn {
    let lines: [Line<f64>; 2] =
        [("continuous", RED, |f| f.continuous_us), ("discrete", BLUE, |f| f.discrete_us)];
    let columns = Columns::of(run.frames.len());
    let drawn: Vec<_> = lines
        .iter()
        .map(|&(name, colour, what)| (name, colour, columns.means(|i| what(&run.frames[i]))))
        .collect();
    let top = 1.2 * drawn.iter().flat_map(|(_, _, line)| line).fold(1e-3f64, |m, p| m.max(p.1));
    let (unit, scale) = if top >= 1000.0 { ("ms", 1e-3) } else { ("µs", 1.0) };
    let top = top * scale;
    let mut chart = frame!(
        area,
        format!("Time of a step from the same state, {}", count_threads(run.threads)),
        0.0..run.frames.len() as f64 + 1.0,
        0.0..top,
        columns.axis("mean"),
        format!("time [{unit}]"),
        &|y| plain(*y, top)
    );
    let scaled = |line: Vec<(f64, f64)>| line.into_iter().map(|(x, y)| (x, y * scale)).collect::<Vec<_>>();
    let lines = drawn.into_iter().map(|(name, colour, line)| (name, colour, scaled(line)));
    draw_lines!(chart, lines);
    Ok(())
}

/// By how much the continuous step takes longer, frame by frame. The axis ends where 19 of 20 columns fit.
pub(crate) fn additional(area: &Area<'_>, run: &Run) -> Drawn {
    let columns = Columns::of(run.frames.len());
    let line = columns.means(|i| run.frames[i].additional);
    let mut sorted: Vec<f64> = line.iter().map(|p| p.1).collect();
    sorted.sort_unstable_by(f64::total_cmp);
    let top = 1.4 * sorted[(sorted.len() - 1) * 19 / 20].max(5.0);
    let low = sorted[0].clamp(-0.5 * top, 0.0);
    let mut chart = frame!(
        area,
        format!("Additional time of the continuous step, {}", count_threads(run.threads)),
        0.0..run.frames.len() as f64 + 1.0,
        low..top,
        columns.axis("mean"),
        "more than discrete [%]",
        &|y| plain(*y, top - low)
    );
    let end = run.frames.len() as f64 + 1.0;
    let average = run.additional.average;
    chart.draw_series(AreaSeries::new(line.into_iter().map(|(x, y)| (x, y.min(top))), 0.0, SKY.filled()))?;
    chart
        .draw_series(LineSeries::new([(0.0, average), (end, average)], ORANGE.stroke_width(2)))?
        .label(format!("average {average:.1} %"))
        .legend(|(x, y)| PathElement::new([(x, y), (x + 16, y)], ORANGE.stroke_width(3)));
    legend!(chart);
    Ok(())
}

/// Three pies: everything, everything with the meshes apart, everything without meshes.
pub(crate) fn memory(area: &Area<'_>, ledger: &Ledger) -> Drawn {
    area.fill(&WHITE)?;
    let memory = &ledger.memory;
    let (continuous, meshes) = (("continuous", memory.continuous), ("meshes", memory.meshes));
    let rest = memory.total - memory.continuous;
    let pies: [(&str, Vec<Slice>); 3] = [
        ("Everything", vec![continuous, ("discrete", rest)]),
        ("Meshes apart", vec![continuous, meshes, ("discrete", rest - memory.meshes)]),
        ("Without meshes", vec![continuous, ("discrete", rest - memory.meshes)]),
    ];
    let (width, height) = area.dim_in_pixel();
    let third = width as i32 / 3;
    for (i, (title, slices)) in pies.iter().enumerate() {
        // The pies do not get areas of their own: they are drawn in coordinates of the whole picture.
        pie(area, (third / 2 + third * i as i32, height as i32), title, slices)?;
    }
    Ok(())
}

/// `middle`: how far across it is drawn; and the height of the picture.
fn pie(area: &Area<'_>, (middle, height): (i32, i32), title: &str, slices: &[Slice]) -> Drawn {
    let all = slices.iter().map(|s| s.1).sum();
    let sizes: Vec<f64> = slices.iter().map(|s| s.1 as f64).collect();
    let colours: Vec<RGBColor> = slices.iter().map(|s| colour(s.0)).collect();
    let heading = text(16).pos(Pos::new(HPos::Center, VPos::Top));
    area.draw(&Text::new(format!("{title}: {}", bytes(all)), (middle, 16), heading))?;
    if all > 0 {
        // Names are listed below: a slice of one percent has no room for its name.
        let (centre, names) = ((middle, height / 2 - 22), vec![String::new(); slices.len()]);
        let mut drawn = Pie::new(&centre, &92.0, &sizes, &colours, &names);
        drawn.start_angle(-90.0);
        area.draw(&drawn)?;
    }
    for (i, (&(name, of), colour)) in slices.iter().zip(colours).enumerate() {
        let (x, y) = (middle - 100, height - 80 + 20 * i as i32);
        area.draw(&Rectangle::new([(x, y), (x + 12, y + 12)], colour.filled()))?;
        area.draw(&Text::new(label(name, of, all), (x + 20, y), text(13)))?;
    }
    Ok(())
}

fn label(name: &str, of: usize, all: usize) -> String {
    format!("{name} {}, {:.1} %", bytes(of), 100.0 * of as f64 / all.max(1) as f64)
}

fn colour(name: &str) -> RGBColor {
    match name {
        "continuous" => RED,
        "meshes" => PALE,
        _ => BLUE,
    }
}

/// Outcomes of potential contacts.
pub(crate) fn potential(area: &Area<'_>, run: &Run) -> Drawn {
    let lines: [Line<u32>; 4] = [
        ("pairs only by the sweep", GREEN, |f| f.swept_pairs),
        ("potential points", SKY, |f| f.made),
        ("pushed manifolds", ORANGE, |f| f.pushed),
        ("ghosts", RED, |f| f.ghosts),
    ];
    let columns = Columns::of(run.frames.len());
    let most = |what: fn(&Frame) -> u32| columns.greatest(0.0, |i| f64::from(what(&run.frames[i])));
    let drawn: Vec<_> = lines.iter().map(|&(name, colour, what)| (name, colour, most(what))).collect();
    counts(area, "What continuous collision found", &columns, drawn)
}

#[cfg(test)]
mod tests {
    use super::super::ledger::{Memory, ProfileSettings};
    use super::super::measure::Measured;
    use super::*;
    use crate::report::charts::svg;
    use backstop::{MemoryReport, Settings};

    #[test]
    fn every_figure_is_drawn_for_long_and_short_runs() {
        for steps in [1, 5000] {
            let frame =
                |i: u32| Frame { step: i, discrete_us: 10.0, continuous_us: 11.0, ..Frame::default() };
            let frames: Vec<Frame> = (1..=steps).map(frame).collect();
            let memory = MemoryReport::default();
            let measured = Measured { frames, stages: Vec::new(), memory: memory.clone(), hash: 0 };
            let ledger = Ledger {
                scene: "empty".into(),
                settings: ProfileSettings { dt: 0.01, repeats: 1, world: Settings::default() },
                steps: steps as usize,
                dynamic_bodies: 0,
                runs: vec![Run::new(1, measured)],
                each: Vec::new(),
                memory: Memory::new(&memory, 0),
                hash: String::new(),
                comparison: None,
            };
            let run = &ledger.runs[0];
            for drawn in [
                svg(|a| cost(a, run)),
                svg(|a| additional(a, run)),
                svg(|a| potential(a, run)),
                svg(|a| super::memory(a, &ledger)),
            ] {
                let text = drawn.unwrap();
                assert!(text.starts_with("<svg") && !text.contains("NaN"));
            }
        }
    }
}
