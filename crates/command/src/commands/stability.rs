//! `stability`: whether rest is stable, for one structure or for the set that every step has to keep.

use crate::args::StabilityOptions;
use crate::report::output::{self, plural};
use crate::report::table::{list, table};
use anyhow::{Context, bail};
use backstop::{FrictionModel, Settings, World};
use backstop_lab::{Mode, ModeBody, Probe, Rest, Stability, Verdict, find_rest, growth, stability};
use backstop_scene::{Scene, Standing, open};
use serde_json::{Value, json};
use std::collections::HashMap;

/// One world at rest, and its measured stability.
struct Found {
    name: String,
    hertz: f32,
    settings: Settings,
    rest: Rest,
    stability: Stability,
    /// Growth rate by the divergence of two worlds [1/s].
    parting: Option<f64>,
    /// Index in the scene.
    numbers: HashMap<backstop::BodyHandle, usize>,
}

impl Found {
    /// The verdict in a word; only the last one is good.
    fn verdict(&self) -> &'static str {
        let unit = f64::from(self.settings.length_unit);
        match self.stability.verdict() {
            // Half a box is more than springs of a reasonable stiffness yield.
            _ if self.rest.moved > 0.5 * unit => "FELL",
            _ if self.rest.speed > RESTLESS * unit => "RESTLESS",
            Verdict::Unstable => "UNSTABLE",
            Verdict::Unclear => "UNCLEAR",
            Verdict::Stable => STABLE,
        }
    }
}

const STABLE: &str = "stable";
/// Bodies that move faster are not at rest [m/s per length unit].
const RESTLESS: f64 = 1e-4;

pub(crate) fn stability_of(options: &StabilityOptions) -> anyhow::Result<()> {
    match &options.scene {
        Some(scene) => one(options, scene),
        None => set(options),
    }
}

fn settings_of(options: &StabilityOptions) -> Settings {
    let mut settings = Settings::default()
        .with_friction_model(options.friction_model.unwrap_or_default())
        .with_length_unit(options.scale);
    settings.substeps = options.substeps.unwrap_or(settings.substeps);
    settings.iterations = options.iterations.unwrap_or(settings.iterations);
    settings
}

fn scene_of(name: &str, options: &StabilityOptions) -> anyhow::Result<Scene> {
    match Standing::named(name, options.size) {
        Some(structure) => Ok(structure.scene(options.scale, options.density)),
        None => Ok(open(name)?),
    }
}

fn find(scene: &Scene, settings: Settings, hertz: f32, options: &StabilityOptions) -> anyhow::Result<Found> {
    let about = || format!("can't probe {}", scene.name);
    let mut world = World::new(settings.clone().with_gravity(scene.gravity)).with_context(about)?;
    let bodies = scene.add_to(&mut world).with_context(about)?.bodies;
    let defaults = Probe::new(1.0 / hertz);
    let probe = Probe {
        horizon: options.horizon.unwrap_or(defaults.horizon),
        displacement: options.displacement.unwrap_or(defaults.displacement),
        dimension: options.dimension.unwrap_or(defaults.dimension),
        ..defaults
    };
    let rest = find_rest(&mut world, probe.dt, options.settle).with_context(about)?;
    let stability = stability(&world, &probe).with_context(about)?;
    let parting = match options.scene.is_some() {
        true => Some(growth(&world, &probe, 10.0).with_context(about)?),
        false => None,
    };
    let numbers = bodies.into_iter().enumerate().map(|(i, body)| (body, i)).collect();
    Ok(Found { name: scene.name.clone(), hertz, settings, rest, stability, parting, numbers })
}

fn one(options: &StabilityOptions, name: &str) -> anyhow::Result<()> {
    let scene = scene_of(name, options)?;
    let hertz = options.hz.first().copied().unwrap_or(60.0);
    let found = find(&scene, settings_of(options), hertz, options)?;
    if options.json {
        output::print_json(&document(&found))?;
    } else {
        output::print(&text(&found))?;
    }
    verdict(usize::from(found.verdict() != STABLE), 1)
}

/// Both the exit code and the last line say whether everything stands.
fn verdict(unstable: usize, all: usize) -> anyhow::Result<()> {
    match unstable {
        0 => Ok(()),
        _ => bail!("{unstable} of {all} not stable at rest"),
    }
}

fn model_name(model: FrictionModel) -> &'static str {
    match model {
        FrictionModel::Patch => "patch",
        FrictionModel::Point => "point",
    }
}

/// The main direction of a mode, in words.
fn whereabouts(mode: &Mode) -> &'static str {
    let [across, along, turning] = mode.shares;
    match () {
        () if across >= along.max(turning) => "sideways",
        () if along >= turning => "up and down",
        () => "turning",
    }
}

fn text(found: &Found) -> String {
    let (s, settings) = (&found.stability, &found.settings);
    let text = format!(
        "{} at {} Hz, {}, {}, friction per {}\n",
        found.name,
        found.hertz,
        plural(settings.substeps.into(), "substep", "substeps"),
        plural(settings.iterations.into(), "iteration", "iterations"),
        model_name(settings.friction_model)
    );
    let mut rows = vec![
        ("speed at rest", format!("{:.1e} m/s", found.rest.speed)),
        ("unknowns", s.unknowns.to_string()),
        ("spectral radius per step", format!("1 {:+.1e} (noise {:.1e})", s.radius - 1.0, s.noise)),
        ("growth", format!("{:.4} / s", s.growth)),
    ];
    rows.extend(found.parting.map(|parting| ("growth of two worlds' parting", format!("{parting:.4} / s"))));
    rows.push(("points that let go or took hold", s.changed.to_string()));
    rows.push(("verdict", found.verdict().into()));
    let most_moved = |body: &ModeBody| {
        let [x, y, z] = body.linear.to_array();
        let number = found.numbers.get(&body.body).copied().unwrap_or_default();
        format!("{number} ({x:+.2} {y:+.2} {z:+.2})")
    };
    let modes = s.modes.iter().map(|mode| {
        vec![
            whereabouts(mode).to_owned(),
            format!("1 {:+.1e}", mode.modulus - 1.0),
            format!("{:.3} / s", mode.growth),
            format!("{:.2} Hz", mode.frequency),
            format!("{:.0e}", mode.residual),
            mode.bodies.iter().take(3).map(most_moved).collect::<Vec<_>>().join("  "),
        ]
    });
    let headings = ["mode", "modulus per step", "growth", "frequency", "residual", ""];
    text + &list(rows) + "\n" + &table(&headings, 1, modes)
}

fn document(found: &Found) -> Value {
    let (s, settings) = (&found.stability, &found.settings);
    let mode = |mode: &Mode| {
        let body = |b: &ModeBody| {
            json!({
                "body": found.numbers.get(&b.body),
                "linear": b.linear.to_array(),
                "angular": b.angular.to_array(),
            })
        };
        json!({
            "modulus": mode.modulus,
            "growth": mode.growth,
            "frequency": mode.frequency,
            "residual": mode.residual,
            "shares": { "across": mode.shares[0], "along": mode.shares[1], "turning": mode.shares[2] },
            "bodies": mode.bodies.iter().map(body).collect::<Vec<_>>(),
        })
    };
    json!({
        "scene": found.name,
        "hertz": found.hertz,
        "substeps": settings.substeps,
        "iterations": settings.iterations,
        "friction_model": model_name(settings.friction_model),
        "speed": found.rest.speed,
        "unknowns": s.unknowns,
        "steps": s.steps,
        "radius": s.radius,
        "noise": s.noise,
        "growth": s.growth,
        "parting": found.parting,
        "changed": s.changed,
        "moved": found.rest.moved,
        "verdict": found.verdict(),
        "modes": s.modes.iter().map(mode).collect::<Vec<_>>(),
    })
}

/// The structures that have to stand: towers, pyramids, a wall, a box on a light one.
const SET: [&str; 12] = [
    "tower_2",
    "tower_3",
    "tower_5",
    "tower_10",
    "tower_20",
    "tower_30",
    "tower_40",
    "pyramid_5",
    "pyramid_10",
    "pyramid_15",
    "wall_10",
    "light_1000",
];
/// Substeps and iterations.
const EFFORTS: [(u32, u32); 7] = [(1, 1), (2, 1), (4, 1), (8, 1), (1, 2), (1, 4), (1, 8)];

fn set(options: &StabilityOptions) -> anyhow::Result<()> {
    let hertz = if options.hz.is_empty() { vec![30.0, 60.0, 120.0] } else { options.hz.clone() };
    let wanted = |(s, i): (u32, u32)| {
        options.substeps.is_none_or(|n| n == s) && options.iterations.is_none_or(|n| n == i)
    };
    let efforts: Vec<_> = EFFORTS.into_iter().filter(|&e| wanted(e)).collect();
    let models = match options.friction_model {
        Some(model) => vec![model],
        None => vec![FrictionModel::Patch, FrictionModel::Point],
    };
    if efforts.is_empty() {
        bail!("the set has no such number of substeps and iterations");
    }
    let names: Vec<_> = SET
        .iter()
        .filter(|name| options.only.as_ref().is_none_or(|only| name.starts_with(only.as_str())))
        .collect();
    let count = names.len() * hertz.len() * efforts.len() * models.len();
    let bar = output::progress(!options.json, count as u64, "probes");
    let mut all = Vec::with_capacity(count);
    for name in names {
        let scene = scene_of(name, options)?;
        for &hz in &hertz {
            for &(substeps, iterations) in &efforts {
                for &friction_model in &models {
                    let settings = settings_of(options)
                        .with_substeps(substeps)
                        .with_iterations(iterations)
                        .with_friction_model(friction_model);
                    all.push(find(&scene, settings, hz, options)?);
                    bar.inc(1);
                }
            }
        }
    }
    bar.finish_and_clear();
    if options.json {
        output::print_json(&all.iter().map(document).collect::<Vec<_>>())?;
    } else {
        output::print(&table(&HEADINGS, 1, all.iter().map(row)))?;
    }
    verdict(all.iter().filter(|found| found.verdict() != STABLE).count(), all.len())
}

const HEADINGS: [&str; 10] = [
    "scene",
    "Hz",
    "substeps",
    "iterations",
    "friction",
    "at rest m/s",
    "radius - 1",
    "noise",
    "growth/s",
    "",
];

fn row(found: &Found) -> Vec<String> {
    let (s, settings) = (&found.stability, &found.settings);
    vec![
        found.name.clone(),
        found.hertz.to_string(),
        settings.substeps.to_string(),
        settings.iterations.to_string(),
        model_name(settings.friction_model).into(),
        format!("{:.1e}", found.rest.speed),
        format!("{:.1e}", s.radius - 1.0),
        format!("{:.1e}", s.noise),
        format!("{:.4}", s.growth),
        found.verdict().into(),
    ]
}
