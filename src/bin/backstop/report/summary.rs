//! What a person reads after a run.

use crate::report::accuracy::Summary;
use crate::report::document::Document;
use crate::report::output::{bytes, count, micros};
use crate::report::trace::Trace;
use backstop::BodyKind;
use std::fmt::Write;
use std::path::PathBuf;

pub(crate) fn text(document: &Document, trace: &Trace, written: &[PathBuf]) -> String {
    let mut text = String::new();
    for (label, value) in rows(document, trace) {
        let _ = writeln!(text, "{label:<12}{value}");
    }
    for path in written {
        let _ = writeln!(text, "{:<12}{}", "written", path.display());
    }
    text
}

/// What the summary and the page say in words.
pub(crate) fn rows(document: &Document, trace: &Trace) -> Vec<(&'static str, String)> {
    let kinds = |kind| document.bodies.iter().filter(|b| b.kind == kind).count() as u64;
    let world = &document.settings.world;
    let seconds = document.steps as f64 * f64::from(document.settings.dt);
    let step = &document.time_us.step;
    let contacts = &document.contacts;
    let most = |what: fn(&backstop::StepReport) -> u32| trace.reports.iter().map(what).max().unwrap_or(0);
    let (cut, lifted) = (trace.total(|r| r.cut), trace.total(|r| r.lifted));
    let mut memory = format!("{} in all", bytes(document.memory.total));
    for category in document.memory.categories.iter().filter(|c| c.bytes.reserved > 0) {
        let _ = write!(memory, ", {} {}", category.name.replace('_', " "), bytes(category.bytes.reserved));
    }
    let mut rows = vec![
        ("scene", document.scene.clone()),
        (
            "bodies",
            format!(
                "{} dynamic, {} kinematic, {} static",
                count(kinds(BodyKind::Dynamic)),
                count(kinds(BodyKind::Kinematic)),
                count(kinds(BodyKind::Static))
            ),
        ),
        (
            "steps",
            format!(
                "{} of {:.2} ms ({seconds:.2} s), {} substeps, {} iterations, {} threads, {}",
                count(document.steps as u64),
                document.settings.dt * 1000.0,
                world.substeps,
                world.iterations,
                world.threads,
                format!("{:?}", world.continuous).to_lowercase(),
            ),
        ),
        (
            "step time",
            format!("{} median, {} p95, {} longest", micros(step.median), micros(step.p95), micros(step.max)),
        ),
        (
            "contacts",
            format!(
                "{} real and {} potential points in the last step (most: {} and {})",
                count(contacts.real),
                count(contacts.potential),
                count(most(|r| r.real).into()),
                count(most(|r| r.potential).into()),
            ),
        ),
        (
            "potential",
            format!(
                "{} manifolds pushed before they touched, {} of them ghosts",
                count(contacts.pushed),
                count(contacts.ghosts)
            ),
        ),
        (
            "guard",
            match (cut, lifted) {
                (0, 0) => "never had to hold a body".to_owned(),
                (cut, lifted) => {
                    format!(
                        "cut {} paths that led through something, lifted {} off a surface",
                        count(cut),
                        count(lifted)
                    )
                }
            },
        ),
    ];
    if document.joints > 0 {
        // Beside the bodies that they join.
        rows.insert(2, ("joints", count(document.joints as u64)));
    }
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
    rows.push(("memory", memory));
    let spare = document.model.iter().filter(|part| !part.needed).map(|part| part.name.replace('_', " "));
    rows.push(("not needed", spare.collect::<Vec<_>>().join(", ")));
    rows.push(("hash", document.hash.clone()));
    rows
}
