//! The summary of a run, for people.

use crate::report::accuracy::Summary;
use crate::report::document::Document;
use crate::report::output::{self, bytes, count, count_threads, micros, plural};
use crate::report::table::list;
use crate::report::trace::Trace;
use backstop::BodyKind;
use std::fmt::Write;
use std::path::PathBuf;

pub(crate) fn text(document: &Document, trace: &Trace, written: &[PathBuf]) -> String {
    list(rows(document, trace).into_iter().chain(written.iter().map(|path| output::written(path))))
}

/// The rows of the summary, for page and terminal.
pub(crate) fn rows(document: &Document, trace: &Trace) -> Vec<(&'static str, String)> {
    let mut rows = vec![("scene", document.scene.clone()), ("bodies", bodies(document))];
    if document.joints > 0 {
        rows.push(("joints", count(document.joints as u64)));
    }
    rows.extend([
        ("steps", steps(document)),
        ("step time", step_time(document)),
        ("contacts", contacts(document, trace)),
        ("potential", potential(document)),
        ("guard", guard(trace)),
    ]);
    let struck = trace.total(|r| r.struck);
    if struck > 0 {
        let stood = count(trace.total(|r| r.stood));
        let text =
            format!("{} met at their times; {stood} times a body lost the rest of a step", count(struck));
        rows.push(("impacts", text));
    }
    let shed = trace.total(|r| r.shed);
    if shed > 0 {
        rows.push(("shed", format!("{} points for lack of memory", count(shed))));
    }
    rows.extend(trace.solver.iter().map(|solver| ("solver", solver.text())));
    rows.extend(document.accuracy.iter().flat_map(Summary::rows));
    rows.push(("memory", memory(document)));
    let spare = document.model.iter().filter(|part| !part.needed).map(|part| part.name.replace('_', " "));
    rows.push(("not needed", spare.collect::<Vec<_>>().join(", ")));
    rows.push(("hash", document.hash.clone()));
    rows
}

fn bodies(document: &Document) -> String {
    let kinds = |kind| count(document.bodies.iter().filter(|b| b.kind == kind).count() as u64);
    format!(
        "{} dynamic, {} kinematic, {} static",
        kinds(BodyKind::Dynamic),
        kinds(BodyKind::Kinematic),
        kinds(BodyKind::Static)
    )
}

fn steps(document: &Document) -> String {
    let world = &document.settings.world;
    let seconds = document.steps as f64 * f64::from(document.settings.dt);
    format!(
        "{} of {} ({seconds:.2} s), {}, {}, {}, {}",
        count(document.steps as u64),
        output::seconds(document.settings.dt),
        plural(world.substeps.into(), "substep", "substeps"),
        plural(world.iterations.into(), "iteration", "iterations"),
        count_threads(world.threads),
        format!("{:?}", world.continuous).to_lowercase(),
    )
}

fn step_time(document: &Document) -> String {
    let step = &document.time_us.step;
    format!("{} median, {} p95, {} longest", micros(step.median), micros(step.p95), micros(step.max))
}

fn contacts(document: &Document, trace: &Trace) -> String {
    let most = |what: fn(&backstop::StepReport) -> u32| trace.reports.iter().map(what).max().unwrap_or(0);
    format!(
        "{} real and {} potential points in the last step (most: {} and {})",
        count(document.contacts.real),
        count(document.contacts.potential),
        count(most(|r| r.real).into()),
        count(most(|r| r.potential).into()),
    )
}

fn potential(document: &Document) -> String {
    let contacts = &document.contacts;
    format!(
        "{} manifolds pushed before they touched, {} of them ghosts",
        count(contacts.pushed),
        count(contacts.ghosts)
    )
}

fn guard(trace: &Trace) -> String {
    match (trace.total(|r| r.cut), trace.total(|r| r.lifted)) {
        (0, 0) => "never had to hold a body".to_owned(),
        (cut, lifted) => format!(
            "cut {} paths that led through something, lifted {} off a surface",
            count(cut),
            count(lifted)
        ),
    }
}

fn memory(document: &Document) -> String {
    let mut memory = format!("{} in all", bytes(document.memory.total));
    for category in document.memory.categories.iter().filter(|c| c.bytes.reserved > 0) {
        let _ = write!(memory, ", {} {}", category.name.replace('_', " "), bytes(category.bytes.reserved));
    }
    memory
}
