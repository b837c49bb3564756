//! `extremes`: the envelope, each cell a job of its own (docs/envelope.md).

mod map;
mod page;
mod results;

use crate::args::ExtremesOptions;
use crate::files::{self, Kind};
use crate::interrupt;
use crate::json_lines;
use crate::report::output;
use anyhow::{Context, bail};
use backstop::Settings;
use backstop_lab::envelope::{Cell, Verdict};
use results::{OURS, Results, Run};
use std::sync::Mutex;
use std::sync::atomic::{AtomicUsize, Ordering};

pub(crate) fn extremes(options: &ExtremesOptions) -> anyhow::Result<()> {
    let mut cells = Cell::all();
    if let Some(only) = &options.only {
        cells.retain(|cell| cell.name().contains(only.as_str()));
        if cells.is_empty() {
            bail!("no cell has \"{only}\" in its name; names are like {}", Cell::all()[0].name());
        }
    }
    if options.list {
        return output::print(&cells.iter().map(|cell| cell.name() + "\n").collect::<String>());
    }
    // Files are read and checked first, so that errors come before an hour of work.
    if let Some(file) = &options.page {
        files::expect_place(file, Kind::Page)?;
    }
    let guard = options.guard.as_deref().map(Results::read).transpose()?;
    let beside = options.beside.iter().map(|file| Results::read(file)).collect::<anyhow::Result<Vec<_>>>()?;
    let runs = run_all(&cells, options)?;
    let ours = Results { engine: OURS.into(), runs };
    if options.json {
        output::print_json(&ours.runs)?;
    } else {
        output::print(&map::text(&cells, &ours, &beside))?;
    }
    if let Some(file) = &options.page {
        output::make_folder_of(file)?;
        page::write(file, &cells, &ours, &beside)?;
    }
    judge(&cells, &ours, guard.as_ref(), &beside)
}

/// Runs the cells that the results file does not have yet, on several threads, and adds each cell to it as it
/// ends.
fn run_all(cells: &[Cell], options: &ExtremesOptions) -> anyhow::Result<Vec<Run>> {
    let build = results::build_number()?;
    options.results.as_deref().map(|file| json_lines::expect(file, &results::STARTS)).transpose()?;
    let kept = match &options.results {
        Some(file) if file.exists() => Results::read(file)?.of_build(build, options.seconds),
        _ => Vec::new(),
    };
    let out = options.results.as_deref().map(|file| json_lines::open(file, &results::STARTS)).transpose()?;
    let missing: Vec<_> =
        cells.iter().filter(|cell| kept.iter().all(|run| run.cell != cell.name())).collect();
    let settings = Settings::default();
    let _watch = interrupt::watch()?;
    let bar = output::progress(true, missing.len() as u64, "cells");
    let (next, done) = (AtomicUsize::new(0), Mutex::new((kept, out)));
    let work = || -> anyhow::Result<()> {
        while !interrupt::asked()
            && let Some(cell) = missing.get(next.fetch_add(1, Ordering::Relaxed))
        {
            let figures = cell
                .run(&settings, f64::from(options.seconds))
                .with_context(|| format!("can't run {}", cell.name()))?;
            let figures = figures.into_iter().map(Into::into).collect();
            let run =
                Run { engine: OURS.into(), build, seconds: options.seconds, cell: cell.name(), figures };
            let mut done = done.lock().unwrap_or_else(std::sync::PoisonError::into_inner);
            let (runs, out) = &mut *done;
            if let Some(file) = out {
                json_lines::put(file, &run)?;
            }
            runs.push(run);
            bar.inc(1);
        }
        Ok(())
    };
    std::thread::scope(|scope| {
        let workers: Vec<_> = (0..options.jobs).map(|_| scope.spawn(work)).collect();
        workers.into_iter().try_for_each(|worker| match worker.join() {
            Ok(done) => done,
            Err(_) => bail!("a cell's run panicked"),
        })
    })?;
    bar.finish_and_clear();
    Ok(done.into_inner().unwrap_or_else(std::sync::PoisonError::into_inner).0)
}

/// The exit code and the last line say whether a cell is worse than it has to be.
fn judge(cells: &[Cell], ours: &Results, guard: Option<&Results>, beside: &[Results]) -> anyhow::Result<()> {
    let mut bad = Vec::new();
    for cell in cells {
        let name = cell.name();
        let Some(verdict) = ours.verdict(&name) else { continue };
        if let Some(was) = guard.and_then(|guard| guard.verdict(&name)).filter(|&was| was < verdict) {
            bad.push(format!("{name} was {} and is {}", was.name(), verdict.name()));
        }
        let holds = |other: &&Results| other.verdict(&name) == Some(Verdict::Stable);
        if let Some(other) = beside.iter().find(holds).filter(|_| verdict == Verdict::Lost) {
            bad.push(format!("{name} is lost and {} is stable there", other.engine));
        }
    }
    if bad.is_empty() { Ok(()) } else { bail!("{}", bad.join("; ")) }
}
