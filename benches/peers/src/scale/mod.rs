//! `scale`: time of a step as a scene grows, as a record and a plot.

mod plot;

use crate::machine;
use crate::programs::Programs;
use crate::run::Outcome;
use crate::scenes::Scaling;
use crate::table::row::median;
use anyhow::Context;
use std::fmt::Write;
use std::path::PathBuf;

/// What is swept, and where it goes.
#[derive(clap::Args)]
pub(crate) struct Args {
    /// What grows.
    #[arg(value_enum)]
    of: Scaling,
    /// Where the record goes; the plot goes beside, as `.svg`.
    #[arg(long)]
    out: PathBuf,
    /// Engines, in the order in which they take turns; what this program lacks is built.
    #[arg(long, value_delimiter = ',', default_value = "backstop,box3d,rapier,jolt")]
    engines: Vec<String>,
    /// Sizes; by default 1,000 to 100,000 bodies, or 1,000 to 10,000,000 triangles.
    #[arg(long, value_delimiter = ',')]
    sizes: Vec<usize>,
    /// Threads that a step may use.
    #[arg(long, default_value_t = 1)]
    threads: usize,
    /// Runs of which the median counts.
    #[arg(long, default_value_t = 3)]
    rounds: usize,
    /// A program that has an engine, as `ENGINE=PATH`.
    #[arg(long = "program")]
    programs: Vec<String>,
    /// Seconds after which a run counts as failed.
    #[arg(long, default_value_t = 900)]
    patience: u64,
}

/// Names of the columns.
const COLUMNS: &str = "of,size,engine,threads,bodies,steps,rounds,mean_ms,median_ms,p95_ms,us_per_body,\
build_ms,grown_mib,lost,failed";

/// An engine at a size.
struct Point {
    size: usize,
    engine: String,
    runs: Vec<Outcome>,
    failed: Option<String>,
}

impl Point {
    fn median(&self, of: impl Fn(&Outcome) -> f64) -> Option<f64> {
        median(self.runs.iter().map(of).collect())
    }

    /// What is plotted: microseconds a body and step, or milliseconds a step.
    fn cost(&self, of: Scaling) -> Option<f64> {
        match of {
            Scaling::Bodies => self.median(|run| run.ms.mean * 1e3 / run.bodies.max(1) as f64),
            // One that is not the first: a few engines finish a large mesh there.
            Scaling::Triangles => self.median(|run| run.ms.median),
        }
    }
}

/// Runs it all and writes the record, anew after each size.
pub(crate) fn main(args: &Args) -> anyhow::Result<()> {
    let programs = Programs::new(&args.engines, &args.programs, args.patience)?;
    let facts = machine::facts();
    let sizes = if args.sizes.is_empty() { args.of.sizes().to_vec() } else { args.sizes.clone() };
    let mut points: Vec<Point> = Vec::new();
    for size in sizes {
        let first = points.len();
        let engines = args.engines.iter().cloned();
        points.extend(engines.map(|engine| Point { size, engine, runs: Vec::new(), failed: None }));
        for _ in 0..args.rounds {
            for point in points[first..].iter_mut().filter(|point| point.failed.is_none()) {
                let scene = format!("{}_{size}", args.of.name());
                let mut options = vec!["--threads".to_owned(), args.threads.to_string()];
                // Bodies that fall through a mesh cost nothing: there it is looked for them.
                if args.of == Scaling::Bodies {
                    options.push("--blind".into());
                }
                match programs.run(&point.engine, &scene, &options) {
                    Ok(outcome) => point.runs.push(outcome),
                    Err(error) => point.failed = Some(error.to_string()),
                }
            }
        }
        points[first..].iter().for_each(|point| say(point, args.of));
        write(args, &facts, &points)?;
    }
    Ok(())
}

/// A line for whoever waits.
fn say(point: &Point, of: Scaling) {
    let Point { size, engine, failed, .. } = point;
    match (failed, point.cost(of)) {
        (Some(reason), _) => eprintln!("{size} {engine}: {reason}"),
        (None, cost) => eprintln!("{size} {engine}: {:.3}", cost.unwrap_or_default()),
    }
}

fn write(args: &Args, facts: &[(&str, String)], points: &[Point]) -> anyhow::Result<()> {
    let mut text = String::new();
    facts.iter().try_for_each(|(name, value)| writeln!(text, "# {name}: {value}"))?;
    writeln!(text, "{COLUMNS}")?;
    for point in points {
        let number = |value: Option<f64>| value.map(|value| format!("{value:.6}")).unwrap_or_default();
        let any = point.runs.first();
        let fields = [
            args.of.name().into(),
            point.size.to_string(),
            point.engine.clone(),
            args.threads.to_string(),
            any.map(|run| run.bodies.to_string()).unwrap_or_default(),
            any.map(|run| run.steps.to_string()).unwrap_or_default(),
            point.runs.len().to_string(),
            number(point.median(|run| run.ms.mean)),
            number(point.median(|run| run.ms.median)),
            number(point.median(|run| run.ms.p95)),
            number(point.median(|run| run.ms.mean * 1e3 / run.bodies.max(1) as f64)),
            number(point.median(|run| run.build_ms)),
            number(point.median(|run| run.grown_kib.unwrap_or_default() as f64 / 1024.0)),
            any.and_then(|run| run.figures.lost).map(|lost| lost.to_string()).unwrap_or_default(),
            point.failed.as_deref().unwrap_or_default().replace([',', '\n', '"'], " "),
        ];
        writeln!(text, "{}", fields.join(","))?;
    }
    let out = &args.out;
    std::fs::write(out, text).with_context(|| format!("can't write {}", out.display()))?;
    let curves: Vec<plot::Curve> = args.engines.iter().map(|engine| curve(engine, points, args.of)).collect();
    let (title, y) = match args.of {
        Scaling::Bodies => ("A step, for each body", "microseconds a body"),
        Scaling::Triangles => ("The median step of 200 bodies on a mesh", "milliseconds"),
    };
    let page = plot::page(title, (args.of.name(), y), &curves)?;
    let file = out.with_extension("svg");
    std::fs::write(&file, page).with_context(|| format!("can't write {}", file.display()))
}

fn curve(engine: &str, points: &[Point], of: Scaling) -> plot::Curve {
    let own = points.iter().filter(|point| point.engine == engine);
    let points = own.filter_map(|point| Some((point.size as f64, point.cost(of)?))).collect();
    plot::Curve { name: engine.into(), points }
}
