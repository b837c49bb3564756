//! The results of a profile: `profile --json` and `--csv`. docs/json.md says what the fields mean.

use super::each::Each;
use super::measure::{Frame, Measured, StageCost};
use crate::commands::compare::Comparison;
use crate::report::document::CategoryBytes;
use anyhow::Context;
use backstop::{Category, MemoryReport, Settings};
use backstop_scene as scene;
use serde::Serialize;
use std::path::Path;

/// All that is measured of a scene.
#[derive(Debug, Serialize)]
pub(crate) struct Ledger {
    pub(crate) scene: String,
    pub(crate) settings: ProfileSettings,
    pub(crate) steps: usize,
    /// Bodies that can be pushed.
    pub(crate) dynamic_bodies: usize,
    /// At each number of threads.
    pub(crate) runs: Vec<Run>,
    /// Additional time for one body, by shape and ground.
    pub(crate) each: Vec<Each>,
    pub(crate) memory: Memory,
    pub(crate) hash: String,
    /// Methods of continuous collision side by side on their six scenes, unless they were left out.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub(crate) comparison: Option<Comparison>,
}

#[derive(Debug, Serialize)]
pub(crate) struct ProfileSettings {
    pub(crate) dt: f32,
    pub(crate) repeats: usize,
    #[serde(flatten)]
    pub(crate) world: Settings,
}

/// At one number of threads.
#[derive(Debug, Serialize)]
pub(crate) struct Run {
    pub(crate) threads: usize,
    pub(crate) additional: Additional,
    pub(crate) stages: Vec<StageCost>,
    pub(crate) totals: Totals,
    pub(crate) frames: Vec<Frame>,
}

impl Run {
    pub(crate) fn new(threads: usize, measured: Measured) -> Run {
        let Measured { frames, stages, .. } = measured;
        Run { threads, additional: Additional::of(&frames), stages, totals: Totals::of(&frames), frames }
    }
}

/// Additional time of continuous over discrete physics [%].
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize)]
pub(crate) struct Additional {
    /// Mean over all frames.
    pub(crate) average: f64,
    /// Mean over the frames in which most moving bodies touch nothing; `None` if there are none.
    pub(crate) falling: Option<f64>,
    pub(crate) falling_frames: usize,
    /// That of the most expensive frame, and the number of that frame.
    pub(crate) max: f64,
    pub(crate) max_step: u32,
    /// That of the cheapest frame.
    pub(crate) min: f64,
    /// That of the sums of all times.
    pub(crate) whole: f64,
    /// Mean times of a frame [us].
    pub(crate) discrete_us: f64,
    pub(crate) continuous_us: f64,
}

impl Additional {
    /// The costs of `frames`, at least one.
    fn of(frames: &[Frame]) -> Additional {
        let mean = |frames: &mut dyn Iterator<Item = f64>| {
            let (sum, count) = frames.fold((0.0, 0usize), |(sum, n), x| (sum + x, n + 1));
            (count > 0).then(|| sum / count as f64)
        };
        let of_all = |what: fn(&Frame) -> f64| mean(&mut frames.iter().map(what)).unwrap_or_default();
        let dearest = frames.iter().max_by(|a, b| a.additional.total_cmp(&b.additional));
        let (discrete_us, continuous_us) = (of_all(|f| f.discrete_us), of_all(|f| f.continuous_us));
        let falling = || frames.iter().filter(|f| f.falling);
        Additional {
            average: of_all(|f| f.additional),
            falling: mean(&mut falling().map(|f| f.additional)),
            falling_frames: falling().count(),
            max: dearest.map_or(0.0, |f| f.additional),
            max_step: dearest.map_or(0, |f| f.step),
            min: frames.iter().map(|f| f.additional).fold(f64::INFINITY, f64::min),
            whole: 100.0 * (continuous_us / discrete_us - 1.0),
            discrete_us,
            continuous_us,
        }
    }
}

/// Counts of all frames added up.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize)]
pub(crate) struct Totals {
    pub(crate) swept: u64,
    pub(crate) swept_pairs: u64,
    pub(crate) casts: u64,
    pub(crate) made: u64,
    pub(crate) pushed: u64,
    pub(crate) confirmed: u64,
    pub(crate) ghosts: u64,
    pub(crate) cut: u64,
    pub(crate) lifted: u64,
}

impl Totals {
    fn of(frames: &[Frame]) -> Totals {
        let sum = |what: fn(&Frame) -> u32| frames.iter().map(|f| u64::from(what(f))).sum();
        Totals {
            swept: sum(|f| f.swept),
            swept_pairs: sum(|f| f.swept_pairs),
            casts: sum(|f| f.casts),
            made: sum(|f| f.made),
            pushed: sum(|f| f.pushed),
            confirmed: sum(|f| f.confirmed),
            ghosts: sum(|f| f.ghosts),
            cut: sum(|f| f.cut),
            lifted: sum(|f| f.lifted),
        }
    }
}

/// Bytes by category, and the share of continuous collision.
#[derive(Debug, Serialize)]
pub(crate) struct Memory {
    pub(crate) categories: Vec<CategoryBytes>,
    /// Reserved bytes of all categories.
    pub(crate) total: usize,
    pub(crate) meshes: usize,
    pub(crate) continuous: usize,
    /// Share of `continuous` in everything [%].
    pub(crate) of_all: f64,
    /// Share in everything but meshes [%].
    pub(crate) without_meshes: f64,
    /// Bytes per dynamic body.
    pub(crate) per_body: f64,
}

impl Memory {
    pub(crate) fn new(report: &MemoryReport, dynamic: usize) -> Memory {
        let reserved = |category| report.category(category).reserved;
        let (total, meshes) = (report.total(), reserved(Category::Meshes));
        let continuous = reserved(Category::Continuous);
        let share = |of: usize| 100.0 * continuous as f64 / of.max(1) as f64;
        Memory {
            categories: report.iter().map(|(c, bytes)| CategoryBytes { name: c.name(), bytes }).collect(),
            total,
            meshes,
            continuous,
            of_all: share(total),
            without_meshes: share(total - meshes),
            per_body: continuous as f64 / dynamic.max(1) as f64,
        }
    }
}

/// One line for each frame and number of threads.
pub(crate) fn write_csv(path: &Path, runs: &[Run]) -> anyhow::Result<()> {
    let about = || format!("can't write {}", path.display());
    let write = |file: &mut scene::AtomicFile| {
        let mut table = csv::Writer::from_writer(file);
        for run in runs {
            for frame in &run.frames {
                table.serialize(frame)?;
            }
        }
        table.flush()
    };
    scene::write_file(path, write).with_context(about)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn figures_are_those_of_the_talk() {
        let frame = |step, discrete_us, continuous_us, falling| {
            let additional = 100.0 * (continuous_us / discrete_us - 1.0);
            Frame { step, discrete_us, continuous_us, additional, falling, pushed: step, ..Frame::default() }
        };
        let frames = [frame(1, 10.0, 11.0, true), frame(2, 10.0, 13.0, true), frame(3, 40.0, 42.0, false)];
        let a = Additional::of(&frames);
        let near = |x: f64, y: f64| (x - y).abs() < 1e-9;
        // (10 + 30 + 5) / 3, (10 + 30) / 2, 66 / 60
        assert!(near(a.average, 15.0) && near(a.falling.unwrap(), 20.0) && near(a.whole, 10.0), "{a:?}");
        assert!(near(a.max, 30.0) && near(a.min, 5.0) && a.max_step == 2 && a.falling_frames == 2, "{a:?}");
        assert_eq!(Totals::of(&frames).pushed, 6);
        assert_eq!(Additional::of(&frames[2..]).falling, None);
    }
}
