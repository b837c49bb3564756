//! `shots`: how many bodies get through thin targets, with and without continuous collision, and how deep the
//! others get.

use crate::args::ShotOptions;
use crate::report::output;
use crate::report::table;
use anyhow::Context;
use backstop_scene::shots::{
    Count, Flights, MODES, MOVING_TARGETS, MovingShot, Outcome, Quantiles, SHAPES, Shot, TARGETS, Tally,
    Targets, Through,
};
use rayon::prelude::*;
use serde_json::{Map, Value, json};
use std::fmt::Write;

/// The most shots that are named among those that got through wrongly.
const NAMED: usize = 10;
/// Shots that a thread takes at a time.
const BLOCK: usize = 64;

/// Counts, and the numbers of the shots that got through with continuous collision.
#[derive(Clone, Debug, Default)]
struct Result {
    tally: Tally,
    through: Vec<(u64, [Outcome; 3])>,
    /// In the order of [`MOVING_TARGETS`].
    moving: [Through; MOVING_TARGETS.len()],
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
        return output::print_json(&document(options, &result));
    }
    output::print(&table(options, &result))
}

fn run(options: &ShotOptions, targets: &Targets) -> anyhow::Result<Result> {
    let moving = options.moving.unwrap_or(options.count / 10);
    let bar = output::progress(!options.quiet, options.count + moving, "shots");
    let blocks: Vec<u64> = (0..options.count).step_by(BLOCK).collect();
    let block = |&first: &u64| {
        let mut result = Result::default();
        let last = options.count.min(first + BLOCK as u64);
        for number in first..last {
            let shot = Shot::new(targets, options.seed, number);
            let flights: Flights =
                shot.run_all(targets).with_context(|| format!("shot {number} is refused"))?;
            result.tally.add(&shot, &flights);
            let outcomes = flights.guarded.map(|flight| flight.outcome);
            if outcomes[1..].iter().any(|o| *o != Outcome::Kept) {
                result.through.push((number, outcomes));
            }
        }
        bar.inc(last - first);
        anyhow::Ok(result)
    };
    let results: Vec<Result> = blocks.par_iter().map(block).collect::<anyhow::Result<_>>()?;
    let blocks: Vec<u64> = (0..moving).step_by(BLOCK).collect();
    let block = |&first: &u64| {
        let mut counts = [Through::default(); MOVING_TARGETS.len()];
        let last = moving.min(first + BLOCK as u64);
        for number in first..last {
            let shot = MovingShot::new(options.seed, number);
            let passed = shot.run_all().with_context(|| format!("shot {number} at what moves is refused"))?;
            let [guarded, unguarded] = passed;
            counts[shot.target].add(guarded, unguarded);
        }
        bar.inc(last - first);
        anyhow::Ok(counts)
    };
    let counts: Vec<_> = blocks.par_iter().map(block).collect::<anyhow::Result<_>>()?;
    bar.finish_and_clear();
    let mut all = fixed(results);
    for counts in counts {
        all.moving.iter_mut().zip(&counts).for_each(|(all, one)| all.merge(one));
    }
    Ok(all)
}

/// The sum of the counts of all threads.
fn fixed(results: Vec<Result>) -> Result {
    results.into_iter().fold(Result::default(), |mut all, one| {
        all.tally = all.tally.merge(&one.tally);
        all.through.extend(one.through);
        all
    })
}

fn mode_names() -> [String; 3] {
    MODES.map(|m| format!("{m:?}").to_lowercase())
}

/// A value for each mode, by its name.
fn by_mode(of: impl Fn(usize) -> Value) -> Value {
    mode_names().into_iter().enumerate().map(|(mode, name)| (name, of(mode))).collect::<Map<_, _>>().into()
}

fn counts(of: &[u64; 3]) -> Value {
    by_mode(|mode| json!(of[mode]))
}

fn passed(through: &Through) -> Value {
    json!({
        "shots": through.shots,
        "through": counts(&through.guarded),
        "through_unguarded": counts(&through.unguarded),
    })
}

fn one(count: &Count) -> Value {
    let mut told = passed(&count.through);
    let more = json!({
        "gained": counts(&count.gained),
        "guard": { "cut": counts(&count.cut), "lifted": counts(&count.lifted) },
        "settled": counts(&count.settled),
        "depth": by_mode(|mode| {
            let depths = &count.depths[mode];
            let (m, share) = (depths.metres(), depths.shares());
            json!({
                "shots": depths.count(),
                "median_mm": 1e3 * m.median, "p99_mm": 1e3 * m.p99, "worst_mm": 1e3 * m.worst,
                "median_share": share.median, "p99_share": share.p99, "worst_share": share.worst,
                "over": depths.over, "stuck": depths.stuck,
            })
        }),
    });
    if let (Value::Object(told), Value::Object(more)) = (&mut told, more) {
        told.extend(more);
    }
    told
}

fn document(options: &ShotOptions, Result { tally, moving, .. }: &Result) -> Value {
    let groups = |names: &[&str], counts: &[Count]| -> Value {
        names.iter().zip(counts).map(|(n, c)| ((*n).to_owned(), one(c))).collect::<Map<_, _>>().into()
    };
    let mut document = one(&tally.all);
    document["seed"] = json!(options.seed);
    document["by_shape"] = groups(&SHAPES, &tally.by_shape);
    let targets =
        MOVING_TARGETS.iter().zip(moving).map(|(name, through)| ((*name).to_owned(), passed(through)));
    document["moving"] = targets.collect::<Map<_, _>>().into();
    document["by_target"] = groups(&TARGETS, &tally.by_target);
    document
}

fn table(options: &ShotOptions, result: &Result) -> String {
    let tally = &result.tally;
    let shapes = SHAPES.into_iter().zip(&tally.by_shape);
    let targets = TARGETS.into_iter().zip(&tally.by_target);
    let groups: Vec<(&str, &Count)> =
        std::iter::once(("all", &tally.all)).chain(shapes).chain(targets).collect();
    let still: Vec<_> = groups.iter().map(|&(name, count)| (name, &count.through)).collect();
    let moving: Vec<_> = MOVING_TARGETS.into_iter().zip(&result.moving).collect();
    let mut text = String::new();
    through_table(&mut text, "through", &still, |through| through.guarded);
    through_table(&mut text, "through, no guard", &still, |through| through.unguarded);
    through_table(&mut text, "through what moves", &moving, |through| through.guarded);
    through_table(&mut text, "the same, no guard", &moving, |through| through.unguarded);
    // Depths for the default mode, and for the volume mode.
    [1, 2].into_iter().for_each(|mode| depth_table(&mut text, mode, &groups));
    for (number, outcomes) in result.through.iter().take(NAMED) {
        let _ = writeln!(
            text,
            "shot {number}: {outcomes:?}; again with: shots --seed {} --only {number}",
            options.seed
        );
    }
    if result.through.len() > NAMED {
        let _ = writeln!(text, "and {} more", result.through.len() - NAMED);
    }
    text
}

fn through_table(text: &mut String, title: &str, groups: &[(&str, &Through)], of: fn(&Through) -> [u64; 3]) {
    let headings = [title.to_owned(), "shots".into()].into_iter().chain(mode_names()).collect::<Vec<_>>();
    let row = |(name, count): &(&str, &Through)| {
        let shares = of(count).map(|through| {
            let share = 100.0 * through as f64 / count.shots.max(1) as f64;
            format!("{through} ({share:.2}%)")
        });
        [name.replace('_', " "), count.shots.to_string()].into_iter().chain(shares).collect()
    };
    *text += &table::table(&headings, 1, groups.iter().map(row));
    text.push('\n');
}

fn depth_table(text: &mut String, mode: usize, groups: &[(&str, &Count)]) {
    let title = format!("depth, {}", mode_names()[mode]);
    let measures = ["met", "median mm", "99 % mm", "worst mm", "99 % share"];
    let counts = ["over", "stuck", "settled", "cut", "lifted", "gained"];
    let headings = [&[title.as_str()], &measures[..], &counts[..]].concat();
    let row = |(name, count): &(&str, &Count)| {
        let depths = &count.depths[mode];
        let Quantiles { median, p99, worst } = depths.metres();
        let mut row = vec![name.replace('_', " "), depths.count().to_string()];
        row.extend([median, p99, worst].map(|depth| format!("{:.2}", 1e3 * depth)));
        row.extend([
            format!("{:.2}", depths.shares().p99),
            depths.over.to_string(),
            depths.stuck.to_string(),
        ]);
        row.extend(
            [&count.settled, &count.cut, &count.lifted, &count.gained].map(|all| all[mode].to_string()),
        );
        row
    };
    *text += &table::table(&headings, 1, groups.iter().map(row));
    text.push('\n');
}

/// One shot in full, step by step, to look into it.
fn describe(targets: &Targets, seed: u64, number: u64) -> anyhow::Result<()> {
    let shot = Shot::new(targets, seed, number);
    let mut text = format!("{} at {}\n{:#?}\n", SHAPES[shot.shape], TARGETS[shot.target], shot.body);
    let _ = writeln!(text, "substeps, iterations {:?}", shot.solver);
    for (mode, name) in MODES.into_iter().zip(mode_names()) {
        let mut steps = shot.steps.iter();
        let flight = shot.run_seen(targets, mode, true, |world, body| {
            let (report, dt) = (world.report(), steps.next().copied().unwrap_or_default());
            let (Ok(p), Ok(v), Ok(w)) =
                (world.centre_of_mass(body), world.linear_velocity(body), world.angular_velocity(body))
            else {
                return;
            };
            let _ = writeln!(
                text,
                "  dt {dt:.5}  centre {p:10.5}  velocity {v:9.3}  spin {:8.2}  real {} potential {} settled \
                 {} cut {} lifted {}",
                w.length(),
                report.real,
                report.potential,
                report.settled,
                report.cut,
                report.lifted
            );
        })?;
        let _ = writeln!(text, "{name}: {flight:#?}");
    }
    output::print(&text)
}
