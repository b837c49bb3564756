//! The output of `run --json`; docs/json.md explains its fields.

use crate::args::RunOptions;
use crate::report::accuracy::{Course, Summary};
use crate::report::trace::{SolverSum, Times, Trace};
use backstop::{BodyHandle, BodyKind, Bytes, Category, Error, FeatureCost, Settings, World};
use backstop_scene::Scene;
use serde::Serialize;

#[derive(Debug, Serialize)]
pub(crate) struct Document {
    pub(crate) scene: String,
    pub(crate) settings: RunSettings,
    pub(crate) steps: usize,
    pub(crate) bodies: Vec<Body>,
    pub(crate) joints: usize,
    pub(crate) time_us: StageTimes,
    pub(crate) contacts: Contacts,
    pub(crate) memory: Memory,
    pub(crate) model: Vec<Part>,
    pub(crate) accuracy: Option<Summary>,
    pub(crate) solver: Option<SolverSum>,
    pub(crate) hash: String,
}

/// The world's settings, and those of the run.
#[derive(Debug, Serialize)]
pub(crate) struct RunSettings {
    pub(crate) dt: f32,
    #[serde(flatten)]
    pub(crate) world: Settings,
    pub(crate) drop: usize,
    pub(crate) seed: u64,
}

#[derive(Debug, Serialize)]
pub(crate) struct Body {
    pub(crate) name: String,
    pub(crate) kind: BodyKind,
    pub(crate) position: [f64; 3],
    pub(crate) rotation: [f32; 4],
    pub(crate) linear_velocity: [f32; 3],
    pub(crate) angular_velocity: [f32; 3],
    pub(crate) asleep: bool,
}

#[derive(Debug, Serialize)]
pub(crate) struct StageTimes {
    pub(crate) step: Times,
    pub(crate) broad: Times,
    pub(crate) narrow: Times,
    pub(crate) prepare: Times,
    pub(crate) solve: Times,
    pub(crate) finish: Times,
}

#[derive(Debug, Serialize)]
pub(crate) struct Contacts {
    pub(crate) real: u64,
    pub(crate) potential: u64,
    pub(crate) pushed: u64,
    pub(crate) ghosts: u64,
}

#[derive(Debug, Serialize)]
pub(crate) struct Memory {
    pub(crate) categories: Vec<CategoryBytes>,
    pub(crate) total: usize,
    pub(crate) continuous: usize,
    pub(crate) meshes: usize,
}

#[derive(Debug, Serialize)]
pub(crate) struct CategoryBytes {
    pub(crate) name: &'static str,
    #[serde(flatten)]
    pub(crate) bytes: Bytes,
}

/// An optional part of the engine, after the last step.
#[derive(Debug, Serialize)]
pub(crate) struct Part {
    pub(crate) name: &'static str,
    pub(crate) needed: bool,
    pub(crate) count: u32,
    pub(crate) asked_by: &'static str,
    pub(crate) bytes: usize,
    pub(crate) time_us: Option<f32>,
    pub(crate) stage: Option<&'static str>,
}

impl Part {
    fn of(part: &FeatureCost) -> Part {
        Part {
            name: part.feature.name(),
            needed: part.is_needed(),
            count: part.count,
            asked_by: part.feature.asked_by(),
            bytes: part.bytes,
            time_us: part.time_us,
            stage: part.feature.stage(),
        }
    }
}

impl Document {
    pub(crate) fn new(
        options: &RunOptions,
        dt: f32,
        scene: &Scene,
        world: &World,
        handles: &[BodyHandle],
        trace: &Trace,
    ) -> Result<Document, Error> {
        let stage = |stage| trace.stage_times(stage);
        let last = trace.last();
        let memory = world.memory();
        let reserved = |category| memory.category(category).reserved;
        Ok(Document {
            scene: scene.name.clone(),
            settings: RunSettings {
                dt,
                world: world.settings().clone(),
                drop: options.drop,
                seed: options.seed,
            },
            steps: trace.reports.len(),
            bodies: bodies(scene, world, handles)?,
            joints: world.joint_count(),
            time_us: StageTimes {
                step: trace.step_times(),
                broad: stage(|r| r.times.broad),
                narrow: stage(|r| r.times.narrow),
                prepare: stage(|r| r.times.prepare),
                solve: stage(|r| r.times.solve),
                finish: stage(|r| r.times.finish),
            },
            contacts: Contacts {
                real: last.real.into(),
                potential: last.potential.into(),
                pushed: trace.total(|r| r.pushed),
                ghosts: trace.total(|r| r.ghosts),
            },
            memory: Memory {
                categories: memory.iter().map(|(c, bytes)| CategoryBytes { name: c.name(), bytes }).collect(),
                total: memory.total(),
                continuous: reserved(Category::Continuous),
                meshes: reserved(Category::Meshes),
            },
            model: world.feature_report().iter().map(Part::of).collect(),
            accuracy: trace.accuracy.as_ref().map(Course::summary),
            solver: trace.solver.clone(),
            hash: format!("{:016x}", world.state_hash()),
        })
    }
}

fn bodies(scene: &Scene, world: &World, handles: &[BodyHandle]) -> Result<Vec<Body>, Error> {
    let one = |(body, &handle): (&backstop_scene::SceneBody, &BodyHandle)| {
        Ok(Body {
            name: body.name.clone(),
            kind: world.kind(handle)?,
            position: world.position(handle)?.to_array(),
            rotation: world.rotation(handle)?.to_array(),
            linear_velocity: world.linear_velocity(handle)?.to_array(),
            angular_velocity: world.angular_velocity(handle)?.to_array(),
            asleep: world.is_sleeping(handle)?,
        })
    };
    scene.bodies.iter().zip(handles).map(one).collect()
}
