//! `envelope`: the cells of backstop's envelope in another engine, at that engine's defaults, as results
//! that `cargo backstop extremes --beside FILE` shows beside its own. The judge is the same, and sees poses
//! and velocities alone.

use crate::engines::content::Meshes;
use crate::engines::{self, Config, Continuous, Engine};
use anyhow::Context;
use backstop_lab::envelope::{Cell, Drive, Trial, Watch};
use serde_json::{Value, json};
use std::io::Write;
use std::path::PathBuf;
use std::process::{Command, Stdio};
use std::time::{Duration, Instant};

/// What is run, and where results go.
#[derive(clap::Args)]
pub(crate) struct Args {
    /// box3d, rapier or jolt.
    engine: String,
    /// Where results go, a line of JSON for each cell.
    file: PathBuf,
    /// Only cells with this in their names.
    #[arg(long)]
    only: Option<String>,
    /// Only the cell of this name, here: what a run starts for each cell, as an engine may crash or never
    /// come back.
    #[arg(long, hide = true)]
    cell: Option<String>,
    /// Seconds after which a cell counts as lost.
    #[arg(long, default_value_t = 300)]
    patience: u64,
    /// Seconds that each cell is watched for.
    #[arg(long, default_value_t = 60.0)]
    seconds: f64,
}

/// The name by which the envelope knows an engine, and how it is asked: all else is its default.
fn asked(engine: &str, length_unit: f32, hinge_ranges: bool) -> anyhow::Result<(&'static str, Config)> {
    let config = Config {
        threads: 1,
        effort: 1,
        continuous: Continuous::All,
        sleeping: false,
        length_unit,
        max_speed: None,
        max_spin: 1e5,
        hinge_ranges,
    };
    Ok(match engine {
        // Cells are faster than its limit.
        "box3d" => ("Box3D", Config { max_speed: Some(1e5), ..config }),
        "rapier" => ("Rapier", config),
        "jolt" => ("Jolt", Config { max_speed: Some(1e5 * length_unit), ..config }),
        other => anyhow::bail!("the envelope is run in box3d, rapier and jolt, not in \"{other}\""),
    })
}

/// Runs all cells, or the one that is asked for.
pub(crate) fn main(args: &Args) -> anyhow::Result<()> {
    let (name, _) = asked(&args.engine, 1.0, false)?;
    let cells = Cell::all();
    if let Some(wanted) = &args.cell {
        let cell = cells.iter().find(|cell| cell.name() == *wanted).context("no such cell")?;
        println!("{}", watch(cell, &args.engine, args.seconds)?);
        return Ok(());
    }
    let mut out = std::fs::File::create(&args.file).context("can't write the results")?;
    for cell in cells.iter().map(Cell::name) {
        if args.only.as_ref().is_some_and(|only| !cell.contains(only.as_str())) {
            continue;
        }
        let figures = apart(args, &cell)?;
        let run = json!({ "engine": name, "seconds": args.seconds, "cell": cell, "figures": figures });
        writeln!(out, "{run}").context("can't write the results")?;
    }
    Ok(())
}

/// A cell in a process of its own.
fn apart(args: &Args, cell: &str) -> anyhow::Result<Value> {
    let mut child = Command::new(std::env::current_exe()?)
        .arg("envelope")
        .arg(&args.engine)
        .arg(&args.file)
        .args(["--cell", cell, "--seconds", &args.seconds.to_string()])
        .stdout(Stdio::piped())
        .stderr(Stdio::null())
        .spawn()?;
    let start = Instant::now();
    while child.try_wait()?.is_none() && start.elapsed().as_secs() < args.patience {
        std::thread::sleep(Duration::from_millis(20));
    }
    let lost = |measure: &str| json!([{ "measure": measure, "value": null, "verdict": "lost" }]);
    if child.try_wait()?.is_none() {
        child.kill()?;
        child.wait()?;
        return Ok(lost("never ended"));
    }
    let output = child.wait_with_output()?;
    Ok(serde_json::from_slice(&output.stdout).unwrap_or_else(|_| lost("refused or crashed")))
}

/// As `Cell::run` does.
fn watch(cell: &Cell, engine: &str, seconds: f64) -> anyhow::Result<Value> {
    // Ragdolls are without ranges, as their cones are left out too.
    let (_, config) = asked(engine, cell.conditions.size, cell.trial == Trial::Motor)?;
    let entry = engines::find(engine).with_context(|| format!("this program is built without {engine}"))?;
    let scene = cell.scene();
    let mut engine: Box<dyn Engine> = (entry.build)(&scene, &Meshes::of(&scene), &config)?;
    let mut watch: Watch = cell.watch(seconds);
    let (mut time, mut looked, mut step) = (0.0, 0.0, 0);
    while time < seconds - 5e-4 && watch.is_finite() {
        let dt = cell.conditions.rhythm.dt(step);
        for Drive { body, linear, angular } in cell.drives(time + 0.5 * f64::from(dt)) {
            engine.drive(body, linear, angular)?;
        }
        engine.step(dt)?;
        (time, step) = (time + f64::from(dt), step + 1);
        if time - looked >= 0.1 - 5e-4 || time >= seconds - 5e-4 {
            looked = time;
            let states: Vec<_> = (0..scene.bodies.len()).map(|body| engine.state(body)).collect();
            watch.see(time, &states);
        }
    }
    Ok(serde_json::to_value(watch.figures())?)
}
