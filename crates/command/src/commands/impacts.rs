//! `impacts`: measured impacts of a body on a plate beside the same impacts simulated.

use crate::args::ImpactOptions;
use crate::files;
use crate::report::output;
use anyhow::{Context, ensure};
use backstop::glam::DVec2;
use backstop_lab::impacts::{Body, Deviation, Impact, Motion, simulate};
use serde_json::json;
use std::fmt::Write;
use std::path::Path;

/// Bytes of the largest file that is read.
const LARGEST: u64 = 1 << 26;
/// Number of columns of an impact.
const COLUMNS: usize = 8;

pub(crate) fn impacts(options: &ImpactOptions) -> anyhow::Result<()> {
    let body =
        Body { gyration: options.gyration, friction: options.friction, restitution: options.restitution };
    let (settings, solver) = (options.step.settings(), options.step.solver()?);
    let about = || format!("can't read {}", options.file.display());
    let impacts = read(&options.file).with_context(about)?;
    ensure!(!impacts.is_empty(), "there is no impact in {}", options.file.display());
    let bar = output::progress(!options.json, impacts.len() as u64, "impacts");
    let mut all = Vec::new();
    for (i, impact) in impacts.iter().enumerate() {
        let after = || match options.law {
            Some(law) => impact.validate(&body).map(|()| law.after(impact.before, impact.arm, &body)),
            None => simulate(impact, &body, &settings, solver.as_ref(), 1.0 / options.hz),
        };
        let after =
            after().with_context(|| format!("{}, line {} is refused", options.file.display(), i + 2))?;
        all.push(impact.deviation(after, body.gyration));
        bar.inc(1);
    }
    bar.finish_and_clear();
    if options.json { output::print_json(&document(&all)) } else { output::print(&text(&all)) }
}

fn read(file: &Path) -> anyhow::Result<Vec<Impact>> {
    let motion = |x: &[f64]| Motion { velocity: DVec2::new(x[0], x[1]), spin: x[2] };
    let impact = |x: Vec<f64>| Impact {
        arm: DVec2::new(x[0], x[1]),
        before: motion(&x[2..5]),
        after: motion(&x[5..8]),
    };
    Ok(files::numbers(file, LARGEST, COLUMNS)?.into_iter().map(impact).collect())
}

/// Mean and median.
fn summary(all: &[Deviation], of: fn(&Deviation) -> f64) -> [f64; 2] {
    let mut values: Vec<f64> = all.iter().map(of).collect();
    values.sort_by(f64::total_cmp);
    [values.iter().sum::<f64>() / values.len() as f64, values[values.len() / 2]]
}

fn document(all: &[Deviation]) -> serde_json::Value {
    let one = |of: [f64; 3]| json!({ "motion": of[0], "velocity_m_s": of[1], "spin_rad_s": of[2] });
    let each: Vec<_> = all.iter().map(|d| one([d.motion, d.velocity, d.spin])).collect();
    let fields: [fn(&Deviation) -> f64; 3] = [|d| d.motion, |d| d.velocity, |d| d.spin];
    let summaries = fields.map(|of| summary(all, of));
    let [mean, median] = [0, 1].map(|i| one(summaries.map(|of| of[i])));
    json!({ "impacts": all.len(), "mean": mean, "median": median, "each": each })
}

fn text(all: &[Deviation]) -> String {
    let mut text = format!("{} impacts: how far the motion after them is from the measured one\n", all.len());
    let mut row = |name: &str, share: f64, of: fn(&Deviation) -> f64, unit: &str| {
        let [mean, median] = summary(all, of).map(|value| share * value);
        let _ = writeln!(text, "  {name:<24} mean {mean:8.2} {unit}, median {median:8.2} {unit}");
    };
    row("motion", 100.0, |d| d.motion, "% of that before");
    row("velocity of the centre", 1.0, |d| d.velocity, "m/s");
    row("spin", 1.0, |d| d.spin, "rad/s");
    text
}
