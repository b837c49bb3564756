//! Runs the cells of backstop's envelope in another engine, at that engine's defaults, and writes results
//! that `cargo backstop extremes --beside FILE` shows beside its own. The judge is the same, and sees poses
//! and velocities alone.

mod box3d;
mod rapier;

use anyhow::Context;
use backstop_lab::envelope::{Cell, State, Watch};
use backstop_scene::Scene;
use clap::Parser;
use serde_json::{Value, json};
use std::io::Write;
use std::path::PathBuf;
use std::process::{Command, Stdio};
use std::time::{Duration, Instant};

/// An engine with a scene in it.
trait Engine {
    fn step(&mut self, dt: f32);
    /// State of a body, by its index in the scene.
    fn state(&self, body: usize) -> State;
}

#[derive(Parser)]
#[command(about = "Runs the cells of backstop's envelope in another engine")]
struct Options {
    /// box3d or rapier.
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
    #[arg(long, default_value_t = 60)]
    patience: u64,
    /// Seconds that each cell is watched for.
    #[arg(long, default_value_t = 60.0)]
    seconds: f64,
}

fn main() -> anyhow::Result<()> {
    let options = Options::parse();
    type Build = fn(&Scene, f32) -> anyhow::Result<Box<dyn Engine>>;
    let (name, build): (&str, Build) = match options.engine.as_str() {
        "box3d" => ("Box3D", box3d::build),
        "rapier" => ("Rapier", rapier::build),
        other => anyhow::bail!("no engine \"{other}\", but box3d and rapier"),
    };
    let cells = Cell::all();
    if let Some(wanted) = &options.cell {
        let cell = cells.iter().find(|cell| cell.name() == *wanted).context("no such cell")?;
        let scene = cell.scene();
        let mut engine = build(&scene, cell.conditions.size)?;
        println!("{}", watch(cell, &scene, engine.as_mut(), options.seconds));
        return Ok(());
    }
    let mut out = std::fs::File::create(&options.file).context("can't write the results")?;
    for cell in cells.iter().map(Cell::name) {
        if options.only.as_ref().is_some_and(|only| !cell.contains(only.as_str())) {
            continue;
        }
        let figures = apart(&options, &cell)?;
        let run = json!({ "engine": name, "seconds": options.seconds, "cell": cell, "figures": figures });
        writeln!(out, "{run}").context("can't write the results")?;
    }
    Ok(())
}

/// A cell in a process of its own.
fn apart(options: &Options, cell: &str) -> anyhow::Result<Value> {
    let mut child = Command::new(std::env::current_exe()?)
        .arg(&options.engine)
        .arg(&options.file)
        .args(["--cell", cell, "--seconds", &options.seconds.to_string()])
        .stdout(Stdio::piped())
        .stderr(Stdio::null())
        .spawn()?;
    let start = Instant::now();
    while child.try_wait()?.is_none() && start.elapsed().as_secs() < options.patience {
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
fn watch(cell: &Cell, scene: &Scene, engine: &mut dyn Engine, seconds: f64) -> Value {
    let mut watch: Watch = cell.watch(seconds);
    let (mut time, mut looked, mut step) = (0.0, 0.0, 0);
    while time < seconds - 5e-4 && watch.is_finite() {
        let dt = cell.conditions.rhythm.dt(step);
        engine.step(dt);
        (time, step) = (time + f64::from(dt), step + 1);
        if time - looked >= 0.1 - 5e-4 || time >= seconds - 5e-4 {
            looked = time;
            let states: Vec<_> = (0..scene.bodies.len()).map(|body| engine.state(body)).collect();
            watch.see(time, &states);
        }
    }
    serde_json::to_value(watch.figures()).unwrap_or_default()
}
