//! Each frame from one snapshot, discrete and continuous in turn.

use crate::report::trace::{STAGES, median};
use anyhow::Context;
use backstop::{Category, ContinuousMode, MemoryReport, Settings, Snapshot, StepReport, World};
use backstop_scene::Scene;
use serde::Serialize;
use std::time::Instant;

/// Times of a frame both ways, from the same state: medians [us].
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize)]
pub(crate) struct Frame {
    pub(crate) threads: usize,
    /// Counted from 1.
    pub(crate) step: u32,
    pub(crate) discrete_us: f64,
    pub(crate) continuous_us: f64,
    /// Additional time of the continuous step [%].
    pub(crate) additional: f64,
    /// Whether most moving bodies touch nothing.
    pub(crate) falling: bool,
    /// Bodies that moved further than their margin.
    pub(crate) swept: u32,
    /// Pairs that only their paths found.
    pub(crate) swept_pairs: u32,
    /// Pairs whose first touch was looked for.
    pub(crate) casts: u32,
    /// Contact points that touch.
    pub(crate) real: u32,
    /// Contact points that may touch within the step.
    pub(crate) made: u32,
    /// Potential manifolds that had to push.
    pub(crate) pushed: u32,
    /// Pushed manifolds of the frame before whose gap closed.
    pub(crate) confirmed: u32,
    /// Pushed manifolds whose gap did not close.
    pub(crate) ghosts: u32,
    /// Bodies whose path the guard cut, and those that it lifted off a surface.
    pub(crate) cut: u32,
    pub(crate) lifted: u32,
}

/// Mean time of a stage in a frame, both ways [us].
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub(crate) struct StageCost {
    pub(crate) stage: &'static str,
    pub(crate) discrete_us: f64,
    pub(crate) continuous_us: f64,
}

/// A run at one number of threads.
#[derive(Clone, Debug)]
pub(crate) struct Measured {
    pub(crate) frames: Vec<Frame>,
    pub(crate) stages: Vec<StageCost>,
    /// Memory in the frame in which continuous collision needed most.
    pub(crate) memory: MemoryReport,
    pub(crate) hash: u64,
}

/// How to measure.
#[derive(Clone, Debug)]
pub(crate) struct Way {
    pub(crate) dt: f32,
    pub(crate) steps: u32,
    /// Times that each frame is stepped each way, at least 1.
    pub(crate) repeats: usize,
    /// Settings of the run; their mode is the continuous one.
    pub(crate) settings: Settings,
}

/// Times of one frame in one mode: of the whole step, and of its stages.
#[derive(Debug, Default)]
struct Times {
    step: Vec<f64>,
    stages: [Vec<f64>; STAGES.len()],
}

impl Times {
    fn clear(&mut self) {
        self.step.clear();
        self.stages.iter_mut().for_each(Vec::clear);
    }

    fn push(&mut self, seconds: f64, report: &StepReport) {
        self.step.push(seconds * 1e6);
        for (times, (_, stage)) in self.stages.iter_mut().zip(STAGES) {
            times.push(stage(report).into());
        }
    }
}

/// Runs a scene. In each frame both modes start from the same snapshot, in turn and often; then the run goes
/// on from the continuous one. `each` is called after every frame.
pub(crate) fn measure(scene: &Scene, way: &Way, mut each: impl FnMut()) -> anyhow::Result<Measured> {
    let mut world = World::new(way.settings.clone()).context("these settings are refused")?;
    scene.add_to(&mut world).with_context(|| format!("scene {} is refused", scene.name))?;
    let discrete = way.settings.clone().with_continuous(ContinuousMode::Discrete);
    let modes = [discrete, way.settings.clone()];
    let mut before = Snapshot::new();
    let mut times: [Times; 2] = Default::default();
    let mut frames: Vec<Frame> = Vec::new();
    let mut stages = [[0.0; STAGES.len()]; 2];
    let mut memory = MemoryReport::default();
    for step in 1..=way.steps {
        world.snapshot(&mut before);
        times.iter_mut().for_each(Times::clear);
        let mut reports = [StepReport::default(); 2];
        for round in 0..=way.repeats {
            // The order alternates, as the first and the second find different caches.
            for mode in if round % 2 == 0 { [0, 1] } else { [1, 0] } {
                world.restore(&before)?;
                world.set_settings(modes[mode].clone())?;
                let start = Instant::now();
                reports[mode] = *world.step(way.dt)?;
                let seconds = start.elapsed().as_secs_f64();
                // The first round does not count: buffers grow in it.
                if round > 0 {
                    times[mode].push(seconds, &reports[mode]);
                }
            }
        }
        world.restore(&before)?;
        world.set_settings(modes[1].clone())?;
        world.step(way.dt)?;
        let (now, continuous) = (world.memory(), Category::Continuous);
        if step == 1 || now.category(continuous).reserved > memory.category(continuous).reserved {
            memory = now;
        }
        let [discrete_us, continuous_us] = [0, 1].map(|mode| median(&mut times[mode].step));
        for (sums, times) in stages.iter_mut().zip(&mut times) {
            sums.iter_mut().zip(&mut times.stages).for_each(|(sum, times)| *sum += median(times));
        }
        let threads = way.settings.threads;
        let frame = Frame { threads, step, discrete_us, continuous_us, ..Frame::default() };
        frames.push(count(frame, frames.last(), &reports, scene.dynamic_bodies() as u32));
        each();
    }
    let stage = |(i, (name, _)): (usize, &(&'static str, _))| {
        let [discrete_us, continuous_us] = stages.map(|sums| sums[i] / f64::from(way.steps));
        StageCost { stage: name, discrete_us, continuous_us }
    };
    Ok(Measured {
        frames,
        stages: STAGES.iter().enumerate().map(stage).collect(),
        memory,
        hash: world.state_hash(),
    })
}

/// Fills in the counts of the steps.
fn count(
    frame: Frame,
    before: Option<&Frame>,
    [discrete, continuous]: &[StepReport; 2],
    dynamic: u32,
) -> Frame {
    let pushed_before = before.map_or(0, |frame| frame.pushed);
    Frame {
        additional: 100.0 * (frame.continuous_us / frame.discrete_us - 1.0),
        falling: 2 * discrete.manifolds < dynamic.saturating_sub(discrete.asleep),
        swept: continuous.swept,
        swept_pairs: continuous.pairs.saturating_sub(discrete.pairs),
        casts: continuous.casts,
        real: continuous.real,
        made: continuous.potential,
        pushed: continuous.pushed,
        confirmed: pushed_before.saturating_sub(continuous.ghosts),
        ghosts: continuous.ghosts,
        cut: continuous.cut,
        lifted: continuous.lifted,
        ..frame
    }
}
