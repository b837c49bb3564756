//! Runs the cells of backstop's envelope in another engine, at that engine's defaults, and writes results that
//! `cargo backstop extremes --beside FILE` shows beside its own. The judge is the same, and sees poses and velocities alone.

mod box3d;
mod rapier;

use anyhow::Context;
use backstop::lab::envelope::{Cell, State, Watch};
use backstop::scene::Scene;
use clap::Parser;
use serde_json::{Value, json};
use std::io::Write;
use std::path::PathBuf;

/// An engine with a scene in it.
trait Engine {
    fn step(&mut self, dt: f32);
    /// Of a body by its index in the scene.
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
    let mut out = std::fs::File::create(&options.file).context("can't write the results")?;
    for cell in Cell::all() {
        if options.only.as_ref().is_some_and(|only| !cell.name().contains(only.as_str())) {
            continue;
        }
        let scene = cell.scene();
        let mut engine = build(&scene, cell.conditions.size).with_context(|| cell.name())?;
        let figures = watch(&cell, &scene, engine.as_mut(), options.seconds);
        let run = json!({
            "engine": name,
            "seconds": options.seconds,
            "cell": cell.name(),
            "figures": figures,
        });
        writeln!(out, "{run}").context("can't write the results")?;
    }
    Ok(())
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
