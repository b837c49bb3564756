//! `table`: engines in turn on scenes, and a record of it.

mod markdown;
pub(crate) mod row;

use crate::machine;
use crate::programs::Programs;
use crate::scenes;
use anyhow::Context;
use row::{Equal, Row};
use std::fmt::Write;
use std::path::PathBuf;

/// What is run, and where it goes.
#[derive(clap::Args)]
pub(crate) struct Args {
    /// Where the record goes; a table of it goes beside, as `.md`.
    #[arg(long)]
    out: PathBuf,
    /// Engines, in the order in which they take turns; what this program lacks is built. backstop is always
    /// among them, and the first.
    #[arg(long, value_delimiter = ',', default_value = "box3d,rapier,rapier-simd8,rapier-parallel,jolt")]
    engines: Vec<String>,
    /// Scenes; all by default.
    #[arg(long, value_delimiter = ',')]
    scenes: Vec<String>,
    /// Numbers of threads.
    #[arg(long, value_delimiter = ',', default_value = "1,2")]
    threads: Vec<usize>,
    /// Runs that are timed, of which the median counts.
    #[arg(long, default_value_t = 5)]
    rounds: usize,
    /// Stages.
    #[arg(long, value_enum, value_delimiter = ',', default_value = "time,quality,minute,sleep,equal")]
    stages: Vec<Stage>,
    /// Steps, instead of each scene's.
    #[arg(long)]
    steps: Option<u32>,
    /// A program that has an engine, as `ENGINE=PATH`.
    #[arg(long = "program")]
    programs: Vec<String>,
    /// Seconds after which a run counts as failed.
    #[arg(long, default_value_t = 900)]
    patience: u64,
}

/// The stages of a scene.
#[derive(Clone, Copy, Debug, PartialEq, clap::ValueEnum)]
enum Stage {
    /// Times it, with nobody asleep.
    Time,
    /// Judges its motion.
    Quality,
    /// Judges a minute of what stands.
    Minute,
    /// Sees when it is asleep.
    Sleep,
    /// Times peers at an error no larger than backstop's.
    Equal,
}

/// backstop's name.
const BASE: &str = "backstop";
/// Steps in a minute.
const MINUTE: u32 = 3600;
/// Efforts that are tried at equal error.
const EFFORTS: [u32; 4] = [1, 2, 4, 8];
/// Errors below count as none: they are chance [m].
const NO_ERROR: f64 = 1e-3;

/// Runs it all and writes the record, anew after each scene.
pub(crate) fn main(args: &Args) -> anyhow::Result<()> {
    let mut engines = vec![BASE.to_owned()];
    engines.extend(args.engines.iter().filter(|engine| *engine != BASE).cloned());
    let all = || scenes::ALL.iter().map(|scene| scene.0.to_owned()).collect();
    let names: Vec<String> = if args.scenes.is_empty() { all() } else { args.scenes.clone() };
    let programs = Programs::new(&engines, &args.programs, args.patience)?;
    let session = Session { args, engines, programs };
    let facts = machine::facts();
    let mut rows = Vec::new();
    for name in &names {
        let subject = scenes::build(name)?;
        for &threads in &args.threads {
            rows.extend(session.scene(name, &subject, threads));
        }
        session.write(&facts, &rows)?;
    }
    Ok(())
}

struct Session<'a> {
    args: &'a Args,
    engines: Vec<String>,
    programs: Programs,
}

impl Session<'_> {
    fn does(&self, stage: Stage) -> bool {
        self.args.stages.contains(&stage)
    }

    /// All rows of a scene with so many threads: backstop's first.
    fn scene(&self, name: &str, subject: &scenes::Subject, threads: usize) -> Vec<Row> {
        let able = |engine: &&String| is_for(engine, threads);
        let mut rows: Vec<Row> = self
            .engines
            .iter()
            .filter(able)
            .map(|engine| Row { scene: name.into(), engine: engine.clone(), threads, ..Row::default() })
            .collect();
        if self.does(Stage::Time) {
            for _ in 0..self.args.rounds {
                for row in rows.iter_mut().filter(|row| row.failed.is_none()) {
                    let outcome = self.run(row, &["--blind"]);
                    row.timed.push(outcome);
                }
            }
        }
        // Motion is judged once: it is the same with any number of threads, or as good.
        if threads == self.args.threads[0] {
            self.judge(subject, &mut rows);
        }
        rows.iter().for_each(say);
        rows
    }

    fn judge(&self, subject: &scenes::Subject, rows: &mut [Row]) {
        let minute = MINUTE.to_string();
        // Builds of Rapier move alike: the plain one is judged for all, if it takes part.
        let plain = rows.iter().any(|row| row.engine == "rapier");
        let is_judged =
            |row: &&mut Row| row.failed.is_none() && !(plain && row.engine.starts_with("rapier-"));
        for row in rows.iter_mut().filter(is_judged) {
            if self.does(Stage::Quality) {
                row.judged = self.run(row, &[]);
            }
            if self.does(Stage::Minute) && subject.stands {
                row.minute = self.run(row, &["--steps", &minute]);
            }
            if self.does(Stage::Sleep) && subject.rests {
                row.slept = self.run(row, &["--sleep", "--blind", "--steps", &minute]);
            }
        }
        if self.does(Stage::Equal)
            && let Some((base, peers)) = rows.split_first_mut()
        {
            let own = base.judged.as_ref().and_then(|run| run.figures.error(subject.error));
            let Some(own) = own else { return };
            for row in peers.iter_mut().filter(is_judged) {
                row.equal = self.equal(subject, base, row, own.max(NO_ERROR));
            }
        }
    }

    /// The least effort at which a peer is no worse than `most`, and its time then.
    fn equal(&self, subject: &scenes::Subject, base: &Row, row: &mut Row, most: f64) -> Option<Equal> {
        for effort in EFFORTS {
            let asked = effort.to_string();
            let judged = self.run(row, &["--effort", &asked])?;
            if judged.figures.error(subject.error).is_some_and(|error| error <= most) {
                let (mut times, mut ratios) = (Vec::new(), Vec::new());
                for _ in 0..self.args.rounds.min(3) {
                    let own = self.run(&mut base.clone(), &["--blind"])?.ms.mean;
                    let peer = self.run(row, &["--blind", "--effort", &asked])?.ms.mean;
                    times.push(peer);
                    ratios.push(peer / own);
                }
                let (mean_ms, ratio) = (row::median(times)?, row::median(ratios)?);
                return Some(Equal::At { effort, mean_ms, ratio });
            }
        }
        Some(Equal::None)
    }

    /// A run; if it fails, the row says why.
    fn run(&self, row: &mut Row, options: &[&str]) -> Option<crate::run::Outcome> {
        let mut options: Vec<String> = options.iter().map(|option| option.to_string()).collect();
        options.extend(["--threads".into(), row.threads.to_string()]);
        if let Some(steps) = self.args.steps
            && !options.iter().any(|option| option == "--steps")
        {
            options.extend(["--steps".into(), steps.to_string()]);
        }
        match self.programs.run(&row.engine, &row.scene, &options) {
            Ok(outcome) => Some(outcome),
            Err(error) => {
                row.failed = Some(format!("{error}"));
                None
            }
        }
    }

    fn write(&self, facts: &[(&str, String)], rows: &[Row]) -> anyhow::Result<()> {
        let mut text = String::new();
        facts.iter().try_for_each(|(name, value)| writeln!(text, "# {name}: {value}"))?;
        writeln!(text, "{}", row::COLUMNS)?;
        for row in rows {
            let is_base = |base: &&Row| {
                (&base.scene, base.threads, base.engine.as_str()) == (&row.scene, row.threads, BASE)
            };
            let base = rows.iter().find(is_base).context("backstop is in each scene")?;
            writeln!(text, "{}", row::line(row, base))?;
        }
        let out = &self.args.out;
        std::fs::write(out, text).with_context(|| format!("can't write {}", out.display()))?;
        let page = out.with_extension("md");
        let text = markdown::page(facts, rows, &self.engines)?;
        std::fs::write(&page, text).with_context(|| format!("can't write {}", page.display()))
    }
}

/// Whether a build runs with so many threads, and is the one for it: one Rapier is for one thread, the other
/// for more.
fn is_for(engine: &str, threads: usize) -> bool {
    match engine {
        "rapier" | "rapier-simd8" => threads == 1,
        "rapier-parallel" => threads > 1,
        _ => true,
    }
}

/// A line for whoever waits.
fn say(row: &Row) {
    let Row { scene, engine, threads, .. } = row;
    match (&row.failed, row.median(|run| run.ms.mean)) {
        (Some(reason), _) => eprintln!("{scene} {threads} {engine}: {reason}"),
        (None, Some(ms)) => eprintln!("{scene} {threads} {engine}: {ms:.3} ms"),
        (None, None) => eprintln!("{scene} {threads} {engine}"),
    }
}
