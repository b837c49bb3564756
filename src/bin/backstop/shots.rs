//! `shots`: how many bodies get through thin targets, with and without continuous collision.

use crate::args::ShotOptions;
use crate::output;
use anyhow::Context;
use backstop::scene::shots::{Count, MODES, Outcome, SHAPES, Shot, TARGETS, Tally, Targets};
use rayon::prelude::*;
use serde_json::{Map, Value, json};
use std::fmt::Write;

/// Shots that got through although they should not are named, up to this many.
const NAMED: usize = 10;
/// Shots that a thread takes at a time.
const BLOCK: usize = 64;

/// Counts, and the numbers of the shots that got through with continuous collision.
#[derive(Clone, Debug, Default)]
struct Result {
    tally: Tally,
    through: Vec<(u64, [Outcome; 3])>,
}

pub(crate) fn shots(options: &ShotOptions) -> anyhow::Result<()> {
    let targets = Targets::new()?;
    if let Some(number) = options.only {
        return describe(&targets, options.seed, number);
    }
    let result = match options.threads {
        Some(threads) => {
            let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build();
            pool.context("can't start threads")?.install(|| run(options, &targets))
        }
        None => run(options, &targets),
    }?;
    if options.json {
        return output::print_json(&document(options, &result.tally));
    }
    output::print(&table(options, &result))
}

fn run(options: &ShotOptions, targets: &Targets) -> anyhow::Result<Result> {
    let bar = output::progress(!options.quiet, options.count, "shots");
    let blocks: Vec<u64> = (0..options.count).step_by(BLOCK).collect();
    let block = |&first: &u64| {
        let mut result = Result::default();
        let last = options.count.min(first + BLOCK as u64);
        for number in first..last {
            let shot = Shot::new(targets, options.seed, number);
            let outcomes = shot.run_all(targets).with_context(|| format!("shot {number} is refused"))?;
            result.tally.add(&shot, &outcomes);
            if outcomes[1..].iter().any(|o| *o != Outcome::Kept) {
                result.through.push((number, outcomes));
            }
        }
        bar.inc(last - first);
        anyhow::Ok(result)
    };
    let results: Vec<Result> = blocks.par_iter().map(block).collect::<anyhow::Result<_>>()?;
    bar.finish_and_clear();
    Ok(results.into_iter().fold(Result::default(), |mut all, one| {
        all.tally = all.tally.merge(&one.tally);
        all.through.extend(one.through);
        all
    }))
}

fn mode_names() -> [String; 3] {
    MODES.map(|m| format!("{m:?}").to_lowercase())
}

fn document(options: &ShotOptions, tally: &Tally) -> Value {
    let through = |count: &Count| -> Value {
        mode_names().into_iter().zip(count.through).map(|(m, n)| (m, json!(n))).collect::<Map<_, _>>().into()
    };
    let groups = |names: &[&str], counts: &[Count]| -> Value {
        let one = |c: &Count| json!({ "shots": c.shots, "through": through(c) });
        names.iter().zip(counts).map(|(n, c)| ((*n).to_owned(), one(c))).collect::<Map<_, _>>().into()
    };
    json!({
        "shots": tally.all.shots,
        "seed": options.seed,
        "through": through(&tally.all),
        "by_shape": groups(&SHAPES, &tally.by_shape),
        "by_target": groups(&TARGETS, &tally.by_target),
    })
}

fn table(options: &ShotOptions, result: &Result) -> String {
    let tally = &result.tally;
    let [discrete, segment, volume] = mode_names();
    let mut text = format!("{:<20}{:>10}{discrete:>18}{segment:>18}{volume:>18}\n", "through", "shots");
    let mut row = |name: &str, count: &Count| {
        let _ = write!(text, "{:<20}{:>10}", name.replace('_', " "), count.shots);
        for through in count.through {
            let share = 100.0 * through as f64 / count.shots.max(1) as f64;
            let _ = write!(text, "{:>18}", format!("{through} ({share:.2}%)"));
        }
        text.push('\n');
    };
    row("all", &tally.all);
    SHAPES.iter().zip(&tally.by_shape).for_each(|(name, count)| row(name, count));
    TARGETS.iter().zip(&tally.by_target).for_each(|(name, count)| row(name, count));
    for (number, outcomes) in result.through.iter().take(NAMED) {
        let _ = writeln!(
            text,
            "shot {number}: {outcomes:?}; again with: cargo backstop shots --seed {} --only {number}",
            options.seed
        );
    }
    if result.through.len() > NAMED {
        let _ = writeln!(text, "and {} more", result.through.len() - NAMED);
    }
    text
}

/// One shot in full, step by step, to look into it.
fn describe(targets: &Targets, seed: u64, number: u64) -> anyhow::Result<()> {
    let shot = Shot::new(targets, seed, number);
    let mut text = format!("{} at {}\n{:#?}\n", SHAPES[shot.shape], TARGETS[shot.target], shot.body);
    let _ = writeln!(text, "substeps, iterations {:?}", shot.solver);
    for (mode, name) in MODES.into_iter().zip(mode_names()) {
        let mut steps = shot.steps.iter();
        let outcome = shot.run_seen(targets, mode, |world, body| {
            let (report, dt) = (world.report(), steps.next().copied().unwrap_or_default());
            let (Ok(p), Ok(v), Ok(w)) =
                (world.centre_of_mass(body), world.linear_velocity(body), world.angular_velocity(body))
            else {
                return;
            };
            let _ = writeln!(
                text,
                "  dt {dt:.5}  centre {p:10.5}  velocity {v:9.3}  spin {:8.2}  real {} potential {} held {}",
                w.length(),
                report.real,
                report.potential,
                report.held
            );
        })?;
        let _ = writeln!(text, "{name}: {outcome:?}");
    }
    output::print(&text)
}
