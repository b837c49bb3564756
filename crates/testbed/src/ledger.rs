//! The ledger: what the last step took, what there was to do, and the bytes of each part.

use crate::Refusal;
use backstop::{StepReport, World};
use serde_json::{Value, json};

/// The ledger of a world. `step_ms`: time of the last step by the session's clock [ms].
pub(crate) fn of(world: &World, step_ms: f64) -> Result<Value, Refusal> {
    let report = world.report();
    let times = &report.times;
    let stages = [
        ("broad", times.broad),
        ("narrow", times.narrow),
        ("prepare", times.prepare),
        ("solve", times.solve),
        ("finish", times.finish),
    ];
    // Without a clock all are zero.
    let stages: Vec<Value> = stages
        .iter()
        .filter(|_| times.step > 0.0)
        .map(|(name, micros)| json!([name, f64::from(*micros) / 1000.0]))
        .collect();
    let bytes: Vec<Value> = world
        .memory()
        .iter()
        .map(|(category, bytes)| json!([category.name().replace('_', " "), bytes.live, bytes.reserved]))
        .collect();
    Ok(json!({ "stages": stages, "step_ms": step_ms, "counts": counts(world, report)?, "bytes": bytes }))
}

/// Everything that is counted, by name.
fn counts(world: &World, report: &StepReport) -> Result<Vec<Value>, Refusal> {
    let mut counts = vec![
        json!(["bodies", world.body_count()]),
        json!(["joints", world.joint_count()]),
        json!(["couplings", world.coupling_count()]),
        json!(["held", report.held()]),
    ];
    let all = serde_json::to_value(report).map_err(|why| Refusal::told(why.to_string()))?;
    let of_step = StepReport::FIELDS.iter().filter(|field| field.name != "times");
    counts.extend(of_step.map(|field| match field.name {
        // Those of a step would be late after a step back, and these are known.
        "asleep" => json!(["asleep", world.sleeping_body_count()]),
        name => json!([name, all[name]]),
    }));
    Ok(counts)
}
