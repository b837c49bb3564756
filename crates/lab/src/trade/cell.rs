//! A setting that is measured.

use crate::WorldSolver;
use backstop::{ContinuousMethod, ContinuousMode, FrictionCone, FrictionModel, Settings};
use backstop_scene::Scene;

/// How fast bodies are kept from passing through others: the mode and the method in one.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, serde::Serialize, serde::Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum ContinuousChoice {
    /// [`ContinuousMode::Discrete`].
    Discrete,
    /// [`ContinuousMode::Segment`] in one pass.
    #[default]
    Segment,
    /// [`ContinuousMode::Volume`] in one pass.
    Volume,
    /// [`ContinuousMethod::Speculative`].
    Speculative,
    /// [`ContinuousMethod::Talk`].
    TalkMethod,
    /// [`ContinuousMethod::LinearCast`].
    LinearCast,
    /// [`ContinuousMethod::ConservativeAdvancement`].
    ConservativeAdvancement,
}

impl ContinuousChoice {
    /// All of them.
    pub const ALL: [ContinuousChoice; 7] = [
        ContinuousChoice::Discrete,
        ContinuousChoice::Segment,
        ContinuousChoice::Volume,
        ContinuousChoice::Speculative,
        ContinuousChoice::TalkMethod,
        ContinuousChoice::LinearCast,
        ContinuousChoice::ConservativeAdvancement,
    ];

    /// As the command line names it.
    pub fn name(self) -> &'static str {
        match self {
            ContinuousChoice::Discrete => "discrete",
            ContinuousChoice::Segment => "segment",
            ContinuousChoice::Volume => "volume",
            ContinuousChoice::Speculative => "speculative",
            ContinuousChoice::TalkMethod => "talk-method",
            ContinuousChoice::LinearCast => "linear-cast",
            ContinuousChoice::ConservativeAdvancement => "conservative-advancement",
        }
    }

    /// What a world is set to.
    pub fn settings(self) -> (ContinuousMode, ContinuousMethod) {
        match self {
            ContinuousChoice::Discrete => (ContinuousMode::Discrete, ContinuousMethod::OnePass),
            ContinuousChoice::Segment => (ContinuousMode::Segment, ContinuousMethod::OnePass),
            ContinuousChoice::Volume => (ContinuousMode::Volume, ContinuousMethod::OnePass),
            ContinuousChoice::Speculative => (ContinuousMode::Segment, ContinuousMethod::Speculative),
            ContinuousChoice::TalkMethod => (ContinuousMode::Segment, ContinuousMethod::Talk),
            ContinuousChoice::LinearCast => (ContinuousMode::Segment, ContinuousMethod::LinearCast),
            ContinuousChoice::ConservativeAdvancement => {
                (ContinuousMode::Segment, ContinuousMethod::ConservativeAdvancement)
            }
        }
    }
}

/// Where friction acts and how it is bounded: [`FrictionModel`] and [`FrictionCone`] in one.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, serde::Serialize, serde::Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum FrictionLaw {
    /// A cone for each manifold.
    #[default]
    Patch,
    /// A box for each manifold.
    PatchBox,
    /// A cone for each contact point.
    Point,
    /// A box for each contact point.
    PointBox,
}

impl FrictionLaw {
    /// All of them.
    pub const ALL: [FrictionLaw; 4] =
        [FrictionLaw::Patch, FrictionLaw::PatchBox, FrictionLaw::Point, FrictionLaw::PointBox];

    /// As the command line names it.
    pub fn name(self) -> &'static str {
        match self {
            FrictionLaw::Patch => "patch",
            FrictionLaw::PatchBox => "patch-box",
            FrictionLaw::Point => "point",
            FrictionLaw::PointBox => "point-box",
        }
    }

    /// What a world is set to.
    pub fn settings(self) -> (FrictionModel, FrictionCone) {
        match self {
            FrictionLaw::Patch => (FrictionModel::Patch, FrictionCone::Cone),
            FrictionLaw::PatchBox => (FrictionModel::Patch, FrictionCone::Box),
            FrictionLaw::Point => (FrictionModel::Point, FrictionCone::Cone),
            FrictionLaw::PointBox => (FrictionModel::Point, FrictionCone::Box),
        }
    }
}

/// One setting of a grid: what users trade, all else being as [`Settings::default`] has it.
#[derive(Clone, Debug, PartialEq, serde::Serialize, serde::Deserialize)]
pub struct Cell {
    /// Steps per second.
    pub hz: u32,
    /// Substeps of a step.
    pub substeps: u32,
    /// Iterations of a substep.
    pub iterations: u32,
    /// Friction.
    pub friction: FrictionLaw,
    /// Continuous collision.
    pub continuous: ContinuousChoice,
    /// Whether contacts of pairs that hardly moved are kept.
    pub recycling: bool,
    /// Whether joints that make trees are solved exactly, or row by row.
    pub joint_trees: bool,
    /// Name of the method of the lab that solves steps; none: the engine's own solver.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub solver: Option<String>,
}

impl Default for Cell {
    /// 60 Hz and the default settings of a world.
    fn default() -> Cell {
        Cell {
            hz: 60,
            substeps: 4,
            iterations: 1,
            friction: FrictionLaw::Patch,
            continuous: ContinuousChoice::Segment,
            recycling: true,
            joint_trees: true,
            solver: None,
        }
    }
}

impl Cell {
    /// What a reference of so many steps per second is computed with: Coulomb's cone at every point, contacts
    /// found anew in each step, eight iterations.
    pub fn reference(hz: u32) -> Cell {
        Cell {
            hz,
            substeps: 1,
            iterations: 8,
            friction: FrictionLaw::Point,
            continuous: ContinuousChoice::Segment,
            recycling: false,
            joint_trees: true,
            solver: None,
        }
    }

    /// Length of a step [s].
    pub fn dt(&self) -> f32 {
        1.0 / self.hz as f32
    }

    /// The method that solves its world, if not the engine's own solver.
    pub fn world_solver(&self) -> Option<WorldSolver> {
        self.solver.as_deref().and_then(WorldSolver::by_name)
    }

    /// Settings of a world of a scene.
    pub fn settings(&self, scene: &Scene) -> Settings {
        let (continuous, method) = self.continuous.settings();
        let (friction_model, friction_cone) = self.friction.settings();
        Settings::default()
            .with_gravity(scene.gravity)
            .with_substeps(self.substeps)
            .with_iterations(self.iterations)
            .with_continuous(continuous)
            .with_continuous_method(method)
            .with_friction_cone(friction_cone)
            .with_friction_model(friction_model)
            .with_recycling(self.recycling)
            .with_joint_trees(self.joint_trees)
    }

    /// All of it in a line; recycling and joints are mentioned only if they differ from the default.
    pub fn name(&self) -> String {
        let Cell { hz, substeps, iterations, friction, continuous, recycling, joint_trees, solver } = self;
        let recycling = if *recycling { "" } else { ", no recycling" };
        let joints = if *joint_trees { "" } else { ", joints row by row" };
        let (friction, continuous) = (friction.name(), continuous.name());
        let solver = solver.as_ref().map_or_else(|| format!("{substeps}x{iterations}"), Clone::clone);
        format!("{hz} Hz, {solver}, {friction}, {continuous}{recycling}{joints}")
    }
}
