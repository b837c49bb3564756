//! `run --accuracy`: how accurately each step was solved, over a run.

use crate::report::trace::median;
use backstop::{BodyHandle, World};
use backstop_lab::LabWorld;
use backstop_lab::system::SystemProblems;
use backstop_lab::system::{Owner, System};
use backstop_lab::{Accuracy, Measures};
use backstop_scene::Scene;
use serde::Serialize;
use std::collections::BTreeMap;

/// A number of a step, and its unit.
type Figure = (&'static str, &'static str, fn(&Measures) -> f64);

/// The figures of a run, in the order of reports.
pub(crate) const FIGURES: [Figure; 17] = [
    ("residual", "m/s", |m| m.residual.worst),
    ("relative_residual", "", |m| m.residual.relative),
    ("approach", "m/s", |m| m.approach),
    ("parting", "J", |m| m.parting),
    ("cone", "", |m| m.cone),
    ("slip_angle", "", |m| m.slip_angle),
    ("penetration", "m", |m| m.penetration),
    ("penetration_squares", "m²", |m| m.penetration_squares),
    ("penetration_share", "", |m| m.penetration_share),
    ("joint_length", "m", |m| m.joint_length),
    ("joint_angle", "rad", |m| m.joint_angle),
    ("gained_energy", "J", Measures::gained),
    ("momentum", "N s", |m| m.momentum),
    ("angular_momentum", "N m s", |m| m.angular_momentum),
    ("unexplained", "m/s", |m| m.unexplained),
    ("unexplained_turn", "m/s", |m| m.unexplained_turn),
    ("unconserved", "m/s", |m| m.unconserved),
];

/// Islands that are named.
const NAMED: usize = 5;
/// Bodies of an island that are named.
const BODIES: usize = 4;

/// A figure over all steps.
#[derive(Clone, Debug, Serialize)]
pub(crate) struct Spread {
    pub(crate) name: &'static str,
    pub(crate) unit: &'static str,
    pub(crate) median: f64,
    pub(crate) worst: f64,
    /// Step, from 1.
    pub(crate) worst_step: usize,
}

/// An island in the step in which it was solved worst.
#[derive(Clone, Debug, Serialize)]
pub(crate) struct Island {
    /// The first few.
    pub(crate) bodies: Vec<String>,
    pub(crate) size: usize,
    pub(crate) step: usize,
    pub(crate) residual: f64,
    /// The two bodies of the worst law, and whether it is a joint's.
    pub(crate) at: Vec<String>,
    pub(crate) joint: bool,
}

#[derive(Clone, Debug, Serialize)]
pub(crate) struct Summary {
    pub(crate) figures: Vec<Spread>,
    pub(crate) islands: Vec<Island>,
    /// The most laws in a step, and the most that were left out.
    pub(crate) laws: usize,
    pub(crate) soft: usize,
}

/// The accuracy of all steps so far.
#[derive(Debug, Default)]
pub(crate) struct Course {
    /// By figures, then steps.
    pub(crate) figures: [Vec<f64>; FIGURES.len()],
    laws: usize,
    soft: usize,
    /// By the first body of each island.
    worst: BTreeMap<BodyHandle, Island>,
}

impl Course {
    pub(crate) fn add(&mut self, world: &World, scene: &Scene, handles: &[BodyHandle]) {
        let Some(Accuracy { whole, islands, .. }) = world.accuracy() else { return };
        let step = self.figures[0].len() + 1;
        for (values, (.., figure)) in self.figures.iter_mut().zip(FIGURES) {
            values.push(figure(whole));
        }
        self.laws = self.laws.max(whole.laws);
        self.soft = self.soft.max(whole.soft);
        let name = |body: &BodyHandle| {
            let place = handles.iter().position(|handle| handle == body);
            place.and_then(|i| scene.bodies.get(i)).map_or_else(|| "?".to_owned(), |body| body.name.clone())
        };
        for island in islands {
            let Some(first) = island.bodies.first() else { continue };
            let residual = island.measures.residual.worst;
            if self.worst.get(first).is_some_and(|old| old.residual >= residual) {
                continue;
            }
            let (pair, joint) = match island.measures.worst {
                Some(Owner::Contact(pair)) => (Some(pair), false),
                Some(Owner::Joint(joint)) => (world.joint_bodies(joint).ok(), true),
                Some(Owner::Coupling(coupling)) => {
                    let of = world.coupling(coupling).ok().map(|desc| desc.motions[0].joint);
                    (of.and_then(|joint| world.joint_bodies(joint).ok()), true)
                }
                None => (None, false),
            };
            let found = Island {
                bodies: island.bodies.iter().take(BODIES).map(name).collect(),
                size: island.bodies.len(),
                step,
                residual,
                at: pair.iter().flatten().map(name).collect(),
                joint,
            };
            self.worst.insert(*first, found);
        }
    }

    pub(crate) fn summary(&self) -> Summary {
        let spread = |(values, (name, unit, _)): (&Vec<f64>, Figure)| {
            let worst = (0..values.len()).max_by(|&i, &j| values[i].total_cmp(&values[j])).unwrap_or(0);
            Spread {
                name,
                unit,
                median: if values.is_empty() { 0.0 } else { median(&mut values.clone()) },
                worst: values.get(worst).copied().unwrap_or(0.0),
                worst_step: worst + 1,
            }
        };
        let mut islands: Vec<Island> = self.worst.values().cloned().collect();
        islands.sort_by(|a, b| b.residual.total_cmp(&a.residual));
        islands.truncate(NAMED);
        Summary {
            figures: self.figures.iter().zip(FIGURES).map(spread).collect(),
            islands,
            laws: self.laws,
            soft: self.soft,
        }
    }
}

impl Summary {
    pub(crate) fn rows(&self) -> Vec<(&'static str, String)> {
        let mut rows = vec![("accuracy", "median and worst over the steps (docs/accuracy.md)".to_owned())];
        for figure in &self.figures {
            let Spread { name, unit, median, worst, worst_step } = figure;
            let text = format!(
                "{}: {median:.1e}{space}{unit}, worst {worst:.1e}{space}{unit} in step {worst_step}",
                name.replace('_', " "),
                space = if unit.is_empty() { "" } else { " " }
            );
            rows.push(("", text));
        }
        for island in &self.islands {
            rows.push(("island", island.text()));
        }
        rows
    }
}

impl Island {
    pub(crate) fn text(&self) -> String {
        let more = self.size - self.bodies.len();
        let more = if more > 0 { format!(" and {more} more") } else { String::new() };
        let kind = if self.joint { "joint of" } else { "contact of" };
        let (bodies, at) = (self.bodies.join(", "), self.at.join(" and "));
        let at = if at.is_empty() { String::new() } else { format!(", at the {kind} {at}") };
        format!("{bodies}{more}: residual {:.1e} m/s in step {}{at}", self.residual, self.step)
    }
}

/// The contact problem of a step as text, and how rows were treated.
pub(crate) fn export(system: &System) -> anyhow::Result<(String, String)> {
    let (problem, told) = system.contact_problem()?;
    let text = backstop_lab::problem::write_problem(&problem)?;
    let about = format!(
        "{} contact points; {} rows of joints eliminated, {} held at their impulse, {} open ends left out",
        problem.rows() / 3,
        told.eliminated,
        told.held,
        told.open
    );
    Ok((text, about))
}
