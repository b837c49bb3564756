//! `methods`: the same structures under every method of contact resolution.

use crate::args::{AnyMethod, MethodsOptions};
use crate::report::output;
use crate::report::table::table;
use anyhow::Context;
use backstop_lab::structures::{Outcome, Structure};
use backstop_lab::{WorldMethod, WorldSolver};
use serde::Serialize;

#[derive(Serialize)]
struct Row {
    structure: &'static str,
    method: &'static str,
    time_us: f64,
    /// Residual [m/s].
    residual: f64,
    drift_m: f64,
    joint_error_m: f64,
    gained_j: f64,
    refused: usize,
}

pub(crate) fn methods(options: &MethodsOptions) -> anyhow::Result<()> {
    let structures =
        if options.structure.is_empty() { Structure::ALL.to_vec() } else { options.structure.clone() };
    let all = || WorldMethod::names().map(WorldMethod::by_name).map(AnyMethod);
    let methods: Vec<AnyMethod> = if options.method.is_empty() {
        std::iter::once(AnyMethod(None)).chain(all()).collect()
    } else {
        options.method.clone()
    };
    options.methods.check(methods.iter().map(|method| method.0))?;
    let returns: Vec<_> =
        methods.iter().map(|method| options.returns.of(method.0)).collect::<anyhow::Result<_>>()?;
    let bar = output::progress(!options.json, (structures.len() * methods.len()) as u64, "runs");
    let mut rows = Vec::new();
    for &structure in &structures {
        for (&method, &retroactive) in methods.iter().zip(&returns) {
            let name = method.name();
            let solver = method.0.map(|method| {
                let mut solver = WorldSolver {
                    most_rows: usize::MAX,
                    most_residual: f64::INFINITY,
                    ..WorldSolver::new(method)
                }
                .with_options(options.methods.options());
                (solver.effort.iterations, solver.effort.tolerance) = (options.iterations, options.tolerance);
                solver
            });
            let found = structure
                .run(solver, retroactive, options.dt, options.seconds)
                .with_context(|| format!("can't run {} by {name}", structure.name()))?;
            let Outcome { time, residual, drift, joint_error, gained, refused } = found;
            rows.push(Row {
                structure: structure.name(),
                method: name,
                time_us: time * 1e6,
                residual,
                drift_m: drift,
                joint_error_m: joint_error,
                gained_j: gained,
                refused,
            });
            bar.inc(1);
        }
    }
    bar.finish_and_clear();
    if options.json { output::print_json(&rows) } else { output::print(&text(&rows)) }
}

fn text(rows: &[Row]) -> String {
    let headings = [
        "structure",
        "method",
        "time a step",
        "residual m/s",
        "drift m",
        "joints off m",
        "gained J",
        "refused",
    ];
    let row = |row: &Row| {
        let [residual, drift, joints, gained] =
            [row.residual, row.drift_m, row.joint_error_m, row.gained_j].map(|x| format!("{x:.1e}"));
        let (time, refused) = (output::micros(row.time_us), row.refused.to_string());
        vec![
            row.structure.to_string(),
            row.method.to_string(),
            time,
            residual,
            drift,
            joints,
            gained,
            refused,
        ]
    };
    table(&headings, 2, rows.iter().map(row))
}
