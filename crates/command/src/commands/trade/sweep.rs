//! Runs the cells of a grid: errors on all threads, then times one after another.

use super::lines::{FORMAT, Figures, Header, Line, Measured, Results, STARTS, Sink, Timed, read};
use super::options::TradeOptions;
use crate::interrupt;
use crate::json_lines;
use crate::report::output;
use crate::settings_file::{self, SettingsFile};
use anyhow::{Context, bail};
use backstop::Settings;
use backstop_lab::trade::{Cell, Measure, Reference, Span, Track, cost};
use backstop_lab::{WorldMethod, WorldSolver};
use backstop_scene::Scene;
use std::path::{Path, PathBuf};
use std::sync::atomic::{AtomicUsize, Ordering};
use std::sync::{Mutex, PoisonError};
use std::time::{Duration, Instant};

/// Cells that are timed between two timings of the default setting, so that a slowdown of the machine affects
/// both.
const BETWEEN: usize = 4;
/// A time is the least of some runs: the same work is never done faster than it can be, but often slower,
/// because others use the machine. It counts once a second run comes within so much of it,
const AGREE: f64 = 1.05;
/// runs took this long together,
const TIMING: Duration = Duration::from_millis(10);
/// or there were so many.
const MAX_RUNS: usize = 10;
/// What breaks a condition is never picked, and told by one run.
const RUNS_IF_BROKEN: usize = 1;

/// A setting to be measured.
#[derive(Clone, Debug)]
pub(super) struct Candidate {
    pub(super) name: String,
    pub(super) hz: u32,
    pub(super) settings: Settings,
    pub(super) solver: Option<WorldMethod>,
    /// None if the setting is from a file.
    pub(super) cell: Option<Cell>,
}

impl Candidate {
    pub(super) fn of(cell: &Cell, scene: &Scene) -> Candidate {
        Candidate {
            name: cell.name(),
            hz: cell.hz,
            settings: cell.settings(scene),
            solver: cell.solver.as_deref().and_then(WorldMethod::by_name),
            cell: Some(cell.clone()),
        }
    }

    /// The setting of a file; gravity is the scene's, and a world has one thread.
    fn of_file(path: &Path, scene: &Scene) -> anyhow::Result<Candidate> {
        let file = SettingsFile::read(path)?;
        let dt = file.dt.unwrap_or(Cell::default().dt());
        let hz = (1.0 / dt).round();
        if 1.0 / hz != dt {
            bail!("{}: its dt, {dt} s, does not make a whole number of steps per second", path.display());
        }
        let settings = file.world.clone().with_gravity(scene.gravity).with_threads(1);
        let name = path.display().to_string();
        Ok(Candidate { name, hz: hz as u32, settings, solver: file.solver, cell: None })
    }
}

/// The swept scene and settings.
pub(super) struct Sweep<'a> {
    pub(super) header: Header,
    pub(super) candidates: Vec<Candidate>,
    scene: &'a Scene,
    span: Span,
    reference: Reference,
}

impl<'a> Sweep<'a> {
    /// Runs the reference.
    pub(super) fn new(options: &TradeOptions, scene: &'a Scene) -> anyhow::Result<Sweep<'a>> {
        let (mut candidates, mut grid) = (vec![Candidate::of(&Cell::default(), scene)], None);
        let mut of_scene = options.grid(!scene.joints.is_empty());
        let mut settings = None;
        if let Some(path) = &options.settings {
            let candidate = Candidate::of_file(path, scene)?;
            settings = Some(settings_file::fields(candidate.hz, &candidate.settings, candidate.solver)?);
            of_scene.hz.push(candidate.hz);
            candidates.push(candidate);
        }
        let rate = of_scene.frame_rate()?;
        if settings.is_none() {
            candidates = of_scene.cells().iter().map(|cell| Candidate::of(cell, scene)).collect();
            grid = Some(of_scene);
        }
        let frames = (options.seconds() * f64::from(rate)).round();
        if !(1.0..=1e6).contains(&frames) {
            bail!("{} s are no time for {rate} poses per second", options.seconds());
        }
        let span = Span { frame_rate: rate, frames: frames as u32 };
        // Half as many steps must be a multiple of the frame rate too.
        let half = options.reference_hz.div_ceil(2 * rate) * rate;
        let finest = candidates.iter().map(|candidate| candidate.hz).max().unwrap_or(0);
        if half < finest {
            bail!(
                "a reference of {} Hz is too coarse: it has to be twice as fine as {finest} Hz at least",
                2 * half
            );
        }
        let reference = reference(scene, span, 2 * half, options)?;
        let header = Header {
            trade: FORMAT,
            version: env!("CARGO_PKG_VERSION").into(),
            scene: scene.name.clone(),
            frame_rate: rate,
            frames: span.frames,
            reference_hz: 2 * half,
            reference_hash: format!("{:016x}", reference.hash()),
            share: reference.share(),
            uncertainty: reference.uncertainty().into(),
            grid,
            settings,
        };
        Ok(Sweep { header, candidates, scene, span, reference })
    }

    /// Runs the missing cells among the requested ones, and returns all results.
    pub(super) fn run(&self, options: &TradeOptions) -> anyhow::Result<Results> {
        let mut results = Results::none(self.candidates.len());
        let _watch = interrupt::watch()?;
        let (mut sink, temporary) = self.open(options, &mut results)?;
        let mine: Vec<usize> = (0..self.candidates.len())
            .filter(|i| options.cell.is_none_or(|share| i % share.of == share.first))
            .collect();
        self.measure(options, &mine, &mut results, &mut sink)?;
        self.time(options, &mine, &mut results, &mut sink)?;
        if let Some(path) = temporary.as_ref().filter(|_| interrupt::asked()) {
            eprintln!("note: the same command goes on with what is in {}", path.display());
        } else if let Some(path) = temporary {
            drop(sink);
            std::fs::remove_file(&path).with_context(|| format!("can't remove {}", path.display()))?;
        }
        Ok(results)
    }

    /// Opens the file of results, or a temporary one, and reads its lines. The second value: a file to be
    /// removed in the end.
    fn open(&self, options: &TradeOptions, results: &mut Results) -> anyhow::Result<(Sink, Option<PathBuf>)> {
        let (path, temporary) = match &options.results {
            Some(path) => (path.clone(), None),
            None if options.cell.is_some() => {
                let mut sink = Sink::Stdout;
                sink.put(&Line::Header(Box::new(self.header.clone())))?;
                return Ok((sink, None));
            }
            None => {
                // The name is unique to this sweep.
                let sum = crc32fast::hash(serde_json::to_string(&self.header)?.as_bytes());
                let path = PathBuf::from(format!("{}-{sum:08x}.trade.jsonl", self.scene.name));
                (path.clone(), Some(path))
            }
        };
        let mut has_header = false;
        if path.exists() {
            let about = || format!("can't go on with {}", path.display());
            let known = read(&path).with_context(about)?;
            if let Some(header) = &known.header {
                self.header.expect(header).with_context(about)?;
                has_header = true;
            }
            for line in known.lines {
                results.take(line).with_context(about)?;
            }
        }
        let mut sink = Sink::File(json_lines::open(&path, &STARTS).context("--results names another file")?);
        if !has_header {
            sink.put(&Line::Header(Box::new(self.header.clone())))?;
        } else if !options.common.quiet {
            let known = results.measured.iter().flatten().count();
            eprintln!("note: {} has {known} of {} cells", path.display(), self.candidates.len());
        }
        Ok((sink, temporary))
    }

    /// Measures the missing errors, on all threads.
    fn measure(
        &self,
        options: &TradeOptions,
        mine: &[usize],
        results: &mut Results,
        sink: &mut Sink,
    ) -> anyhow::Result<()> {
        let missing: Vec<usize> = mine.iter().copied().filter(|&i| results.measured[i].is_none()).collect();
        let bar = output::progress(!options.common.quiet, missing.len() as u64, "cells measured");
        let (next, shared) = (AtomicUsize::new(0), Mutex::new((results, sink)));
        let work = || -> anyhow::Result<()> {
            while !interrupt::asked()
                && let Some(&cell) = missing.get(next.fetch_add(1, Ordering::Relaxed))
            {
                let candidate = &self.candidates[cell];
                let errors = self
                    .reference
                    .measure(
                        self.scene,
                        &candidate.settings,
                        candidate.solver.map(WorldSolver::new),
                        candidate.hz,
                    )
                    .with_context(|| format!("can't run at {}", candidate.name))?;
                let line = Line::Measured(Measured { cell, errors: (&errors).into() });
                let (results, sink) = &mut *shared.lock().unwrap_or_else(PoisonError::into_inner);
                sink.put(&line)?;
                results.take(line)?;
                bar.inc(1);
            }
            Ok(())
        };
        let threads = options.threads.unwrap_or_else(all_threads).min(missing.len());
        on_threads(threads, work)?;
        bar.finish_and_clear();
        Ok(())
    }

    /// Takes the missing times one after another, with the default setting in between.
    fn time(
        &self,
        options: &TradeOptions,
        mine: &[usize],
        results: &mut Results,
        sink: &mut Sink,
    ) -> anyhow::Result<()> {
        // Runs that were not finite are not timed.
        let worth = |i: &usize| {
            let finite = |errors: &Figures| errors.of(Measure::Energy).is_finite();
            results.measured[*i].as_ref().is_some_and(finite)
        };
        let timed: Vec<usize> = mine.iter().copied().filter(worth).collect();
        let limits = options.conditions.limits().all(|measure| self.header.uncertainty.of(measure));
        let keeps = |results: &Results, cell: usize| {
            let within = |errors: &Figures| limits.iter().all(|&(of, most)| errors.of(of) <= most);
            results.measured[cell].as_ref().is_some_and(within)
        };
        let lacks = |results: &Results, cell: usize, round: u32| {
            results.timed[cell].iter().all(|timed| timed.round != round)
        };
        let rounds = (0..options.rounds()).flat_map(|round| timed.iter().map(move |&cell| (cell, round)));
        let missing: Vec<(usize, u32)> =
            rounds.filter(|&(cell, round)| lacks(results, cell, round)).collect();
        let bar = output::progress(!options.common.quiet, missing.len() as u64, "times taken");
        for some in missing.chunks(BETWEEN).take_while(|_| !interrupt::asked()) {
            let default_us = self.cost(0, MAX_RUNS)?;
            for &(cell, round) in some {
                if interrupt::asked() {
                    break;
                }
                let runs = if keeps(results, cell) { MAX_RUNS } else { RUNS_IF_BROKEN };
                let us = if cell == 0 { default_us } else { self.cost(cell, runs)? };
                let line = Line::Timed(Timed { cell, round, us, default_us });
                sink.put(&line)?;
                results.take(line)?;
                bar.inc(1);
            }
        }
        bar.finish_and_clear();
        Ok(())
    }

    /// Time of a cell [us for 1/60 s], in so many runs at most.
    fn cost(&self, cell: usize, runs: usize) -> anyhow::Result<f64> {
        let Candidate { name, hz, settings, solver, .. } = &self.candidates[cell];
        let (start, mut least) = (Instant::now(), [f64::INFINITY; 2]);
        for _ in 0..runs {
            let us = cost(self.scene, settings, solver.map(WorldSolver::new), *hz, self.span)
                .with_context(|| format!("can't run at {name}"))?;
            if us < least[0] {
                least = [us, least[0]];
            } else {
                least[1] = least[1].min(us);
            }
            if least[1] <= AGREE * least[0] && start.elapsed() > TIMING {
                break;
            }
        }
        // Never zero, as others are divided by it.
        Ok((least[0] * 1e3).round().max(1.0) / 1e3)
    }
}

/// The runs of the reference, on all threads.
fn reference(scene: &Scene, span: Span, hz: u32, options: &TradeOptions) -> anyhow::Result<Reference> {
    let bar = output::progress(!options.common.quiet, Track::MEMBERS as u64, "runs of the reference");
    let next = AtomicUsize::new(0);
    let tracks = Mutex::new(vec![None; Track::MEMBERS]);
    let work = || -> anyhow::Result<()> {
        loop {
            let member = next.fetch_add(1, Ordering::Relaxed);
            if member >= Track::MEMBERS {
                return Ok(());
            }
            let track = Track::member(scene, span, hz, member)
                .with_context(|| format!("scene {} is refused", scene.name))?;
            tracks.lock().unwrap_or_else(PoisonError::into_inner)[member] = Some(track);
            bar.inc(1);
        }
    };
    on_threads(options.threads.unwrap_or_else(all_threads).min(Track::MEMBERS), work)?;
    bar.finish_and_clear();
    let tracks = tracks.into_inner().unwrap_or_else(PoisonError::into_inner);
    let reference = Reference::new(tracks.into_iter().flatten().collect())?;
    if !Measure::ALL.iter().all(|&measure| reference.uncertainty().of(measure).is_finite()) {
        bail!("the reference came to numbers that are none");
    }
    Ok(reference)
}

/// Does the same on some threads.
fn on_threads(threads: usize, work: impl Fn() -> anyhow::Result<()> + Sync) -> anyhow::Result<()> {
    std::thread::scope(|scope| {
        let workers: Vec<_> = (0..threads).map(|_| scope.spawn(&work)).collect();
        workers.into_iter().try_for_each(|worker| match worker.join() {
            Ok(done) => done,
            Err(_) => bail!("a run panicked"),
        })
    })
}

fn all_threads() -> usize {
    std::thread::available_parallelism().map_or(1, usize::from)
}
