//! `cases`: errors of cases with known answers, by method and setting (docs/cases.md).

use crate::args::{AnyMethod, CaseOptions};
use crate::report::output;
use crate::report::table;
use anyhow::{Context, bail};
use backstop_lab::WorldSolver;
use backstop_lab::cases::{Case, Outcome, Setting};
use serde::Serialize;
use std::sync::atomic::{AtomicUsize, Ordering};
use std::sync::{Mutex, PoisonError};

/// One case by one method at one setting; docs/json.md says what its fields mean.
#[derive(Debug, Serialize)]
struct Run {
    case: &'static str,
    unit: &'static str,
    method: &'static str,
    setting: String,
    expected: f64,
    /// None if the event to be measured never happened.
    measured: Option<f64>,
    error: Option<f64>,
    bar: f64,
    within: bool,
}

pub(crate) fn cases(options: &CaseOptions) -> anyhow::Result<()> {
    let asked = |case: &&Case| {
        options.cases.is_empty() || options.cases.iter().any(|name| case.name.contains(name.as_str()))
    };
    let cases: Vec<_> = Case::all().filter(asked).collect();
    if cases.is_empty() {
        bail!("no case has such a name (--list names them)");
    }
    if options.list {
        return output::print(&list(&cases));
    }
    let methods = if options.methods.is_empty() { usual_methods() } else { options.methods.clone() };
    options.lab.check(methods.iter().map(|method| method.0))?;
    let columns: Vec<_> =
        methods.iter().map(|method| settings(options, *method)).collect::<anyhow::Result<_>>()?;
    let runs = run_all(&cases, &columns, options)?;
    if options.json {
        return output::print_json(&runs);
    }
    output::print(&tables(&cases, &columns, &runs))
}

/// The engine's own solver and three of the lab: sweeps to convergence, a splitting with factors, and impact
/// after impact.
fn usual_methods() -> Vec<AnyMethod> {
    let lab = ["gs-cone", "admm", "sequential"].into_iter().filter_map(WorldSolver::by_name);
    let lab = lab.map(|solver| AnyMethod(Some(solver.method)));
    std::iter::once(AnyMethod(None)).chain(lab).collect()
}

/// The requested settings, or the usual ones.
fn settings(options: &CaseOptions, method: AnyMethod) -> anyhow::Result<Vec<Setting>> {
    let asked =
        options.substeps.is_some() || options.iterations.is_some() || options.friction_model.is_some();
    let lab = options.lab.any().then(|| options.lab.options());
    let retroactive = options.returns.of(method.0)?;
    if options.hz.is_empty() && !asked {
        let with = |setting| Setting { options: lab, retroactive, ..setting };
        return Ok(Setting::usual(method.0).into_iter().map(with).collect());
    }
    let reference = Setting::REFERENCE;
    let at = |dt| Setting {
        dt,
        substeps: options.substeps.unwrap_or(reference.substeps),
        iterations: options.iterations.unwrap_or(reference.iterations),
        friction: options.friction_model.unwrap_or(reference.friction),
        method: method.0,
        options: lab,
        retroactive,
    };
    Ok(if options.hz.is_empty() {
        vec![at(reference.dt)]
    } else {
        options.hz.iter().map(|hz| at(1.0 / hz)).collect()
    })
}

/// Every case at every setting of every method, in this order.
fn run_all(
    cases: &[&'static Case],
    columns: &[Vec<Setting>],
    options: &CaseOptions,
) -> anyhow::Result<Vec<Run>> {
    let settings = || columns.iter().flatten();
    let jobs: Vec<_> =
        cases.iter().flat_map(|&case| settings().map(move |setting| (case, setting))).collect();
    let bar = output::progress(!options.quiet && !options.json, jobs.len() as u64, "runs");
    let (next, done) = (AtomicUsize::new(0), Mutex::new(Vec::new()));
    let work = || -> anyhow::Result<()> {
        loop {
            let number = next.fetch_add(1, Ordering::Relaxed);
            let Some(&(case, setting)) = jobs.get(number) else { return Ok(()) };
            let about =
                || format!("can't run {} by {} at {}", case.name, setting.method_name(), setting.name());
            let outcome = case.run(setting).with_context(about)?;
            done.lock().unwrap_or_else(PoisonError::into_inner).push((number, run(case, setting, outcome)));
            bar.inc(1);
        }
    };
    let threads = options.jobs.unwrap_or_else(|| std::thread::available_parallelism().map_or(1, |n| n.get()));
    std::thread::scope(|scope| {
        let workers: Vec<_> = (0..threads).map(|_| scope.spawn(work)).collect();
        workers.into_iter().try_for_each(|worker| match worker.join() {
            Ok(done) => done,
            Err(_) => bail!("a case panicked"),
        })
    })?;
    bar.finish_and_clear();
    let mut done = done.into_inner().unwrap_or_else(PoisonError::into_inner);
    done.sort_by_key(|&(number, _)| number);
    Ok(done.into_iter().map(|(_, run)| run).collect())
}

fn run(case: &'static Case, setting: &Setting, outcome: Outcome) -> Run {
    let error = outcome.error();
    Run {
        case: case.name,
        unit: case.unit,
        method: setting.method_name(),
        setting: setting.name(),
        expected: outcome.expected,
        measured: Some(outcome.measured).filter(|x| x.is_finite()),
        error: Some(error).filter(|x| x.is_finite()),
        bar: case.bar,
        within: error <= case.bar,
    }
}

/// A table for each method: a row for each case, a column for each setting. `!` is beyond the bar.
fn tables(cases: &[&Case], columns: &[Vec<Setting>], runs: &[Run]) -> String {
    let mut text = String::from(
        "What cases are off by, as a share of the exact answer, or in its unit if that is zero; ! is beyond \
         the bar, - is none.\n",
    );
    let in_all = columns.iter().map(Vec::len).sum();
    let mut first = 0;
    for settings in columns {
        let rows: Vec<_> = runs.chunks(in_all).map(|row| &row[first..first + settings.len()]).collect();
        text += &table(cases, settings, &rows);
        first += settings.len();
    }
    text
}

fn table(cases: &[&Case], settings: &[Setting], rows: &[&[Run]]) -> String {
    let halved = halved(settings);
    let mut headings = vec![settings[0].method_name().to_owned(), "bar".into()];
    headings.extend(settings.iter().map(|setting| setting.name() + " "));
    headings.extend(halved.map(|_| "order".into()));
    let line = |(case, row): (&&Case, &&[Run])| {
        let mut line = vec![case.name.to_string(), figure(case.bar)];
        line.extend(row.iter().map(|run| {
            let mark = if run.within { ' ' } else { '!' };
            format!("{}{mark}", run.error.map_or("-".into(), figure))
        }));
        line.extend(halved.map(|[coarse, fine]| order(row, coarse, fine, settings)));
        line
    };
    let mut last = vec!["within the bar".into(), format!("of {}", cases.len())];
    last.extend((0..settings.len()).map(|i| format!("{} ", rows.iter().filter(|row| row[i].within).count())));
    format!("\n{}", table::table(&headings, 1, cases.iter().zip(rows).map(line).chain([last])))
}

/// The first setting, and the one that differs from it only by the shortest steps.
fn halved(settings: &[Setting]) -> Option<[usize; 2]> {
    let first = settings.first()?;
    let same = |s: &Setting| {
        (s.substeps, s.iterations, s.friction) == (first.substeps, first.iterations, first.friction)
    };
    let finer = settings.iter().enumerate().filter(|(_, s)| same(s) && s.dt < first.dt);
    finer.min_by(|a, b| a.1.dt.total_cmp(&b.1.dt)).map(|(i, _)| [0, i])
}

/// Order of convergence of the error with the step; none if the error is rounding or a count.
fn order(row: &[Run], coarse: usize, fine: usize, settings: &[Setting]) -> String {
    match (row[coarse].error, row[fine].error) {
        (Some(a), Some(b)) if a > 1e-6 && b > 1e-6 => {
            format!("{:.1}", (a / b).ln() / f64::from(settings[coarse].dt / settings[fine].dt).ln())
        }
        _ => String::new(),
    }
}

fn figure(x: f64) -> String {
    if x == 0.0 { "0".into() } else { format!("{x:.1e}") }
}

fn list(cases: &[&Case]) -> String {
    let about = |case: &Case| format!("{}\n{}; bar {}", case.about, case.formula, figure(case.bar));
    table::list(cases.iter().map(|case| (case.name, about(case))))
}
