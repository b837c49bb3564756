//! `tosses`: measured tosses of a cube beside the same tosses simulated.

use crate::args::TossOptions;
use crate::files;
use crate::report::output;
use anyhow::{Context, ensure};
use backstop::glam::{DQuat, DVec3};
use backstop_lab::tosses::{Cube, Deviation, Sample, deviation};
use serde_json::json;
use std::fmt::Write;
use std::path::{Path, PathBuf};

/// Bytes of the largest file that is read.
const LARGEST: u64 = 1 << 26;
/// Number of columns of a sample.
const COLUMNS: usize = 14;

pub(crate) fn tosses(options: &TossOptions) -> anyhow::Result<()> {
    let cube = Cube {
        friction: options.friction,
        restitution: options.restitution,
        lowered: options.lowered,
        ..Cube::default()
    };
    let (settings, solver) = (options.step.settings(), options.step.solver()?);
    let mut deviations = Vec::new();
    let files = files(&options.folder)?;
    let bar = output::progress(!options.json, files.len() as u64, "tosses");
    for file in files {
        let samples = read(&file).with_context(|| format!("can't read {}", file.display()))?;
        let one = deviation(&samples, &cube, &settings, solver.as_ref(), options.parts)
            .with_context(|| format!("{} is refused", file.display()))?;
        deviations.push((file, one));
        bar.inc(1);
    }
    bar.finish_and_clear();
    let all: Vec<Deviation> = deviations.iter().map(|(_, one)| *one).collect();
    let mean = Deviation::mean(&all);
    if options.json {
        let one = |d: &Deviation| {
            json!({
                "position_widths": d.position,
                "rotation_degrees": d.rotation.to_degrees(),
                "last_position_widths": d.last_position,
                "last_rotation_degrees": d.last_rotation.to_degrees(),
            })
        };
        let name = |file: &Path| file.file_name().unwrap_or_default().to_string_lossy().into_owned();
        let list: serde_json::Map<_, _> = deviations.iter().map(|(file, d)| (name(file), one(d))).collect();
        return output::print_json(&json!({ "tosses": all.len(), "mean": one(&mean), "each": list }));
    }
    let median = |of: fn(&Deviation) -> f64| {
        let mut values: Vec<f64> = all.iter().map(of).collect();
        values.sort_by(f64::total_cmp);
        values[values.len() / 2]
    };
    let mut text = format!("{} tosses: how far the simulated cube is from the measured one\n", all.len());
    let mut row = |name: &str, mean: f64, median: f64, unit: &str| {
        let _ = writeln!(text, "  {name:<24} mean {mean:8.2} {unit}, median {median:8.2} {unit}");
    };
    let percent = "% of the width";
    row("centre", 100.0 * mean.position, 100.0 * median(|d| d.position), percent);
    row("rotation", mean.rotation.to_degrees(), median(|d| d.rotation).to_degrees(), "degrees");
    row("centre at the end", 100.0 * mean.last_position, 100.0 * median(|d| d.last_position), percent);
    row(
        "rotation at the end",
        mean.last_rotation.to_degrees(),
        median(|d| d.last_rotation).to_degrees(),
        "degrees",
    );
    output::print(&text)
}

/// The CSV files of a folder, by name.
fn files(folder: &Path) -> anyhow::Result<Vec<PathBuf>> {
    let about = || format!("can't read the folder {}", folder.display());
    let mut files = Vec::new();
    for entry in std::fs::read_dir(folder).with_context(about)? {
        let path = entry.with_context(about)?.path();
        if path.extension().is_some_and(|e| e.eq_ignore_ascii_case("csv")) {
            files.push(path);
        }
    }
    ensure!(!files.is_empty(), "there is no CSV file in {}", folder.display());
    files.sort();
    Ok(files)
}

fn read(file: &Path) -> anyhow::Result<Vec<Sample>> {
    let sample = |numbers: Vec<f64>| {
        let vec = |i: usize| DVec3::new(numbers[i], numbers[i + 1], numbers[i + 2]);
        Sample {
            time: numbers[0],
            position: vec(1),
            rotation: DQuat::from_xyzw(numbers[5], numbers[6], numbers[7], numbers[4]),
            velocity: vec(8),
            body_spin: vec(11),
        }
    };
    Ok(files::numbers(file, LARGEST, COLUMNS)?.into_iter().map(sample).collect())
}
