//! A method of the lab as the solver of a world: of all its islands, of those up to a size, or of those that
//! hold some body, so that a game can have one important mechanism solved exactly and leave the rest to the
//! fast path.
//!
//! The fast path solves every step first. Then each island that is chosen is solved again from the velocities
//! of the start of the step, as one step without substeps: once for its velocities, and once more with
//! overlap and joint errors corrected, for the displacements only, so that the correction adds no energy. If
//! that fails ([`WorldSolver::most_residual`]), or the island has more rows than [`WorldSolver::most_rows`],
//! it keeps the fast path's result, and [`SolverReport`] counts that. A bounce is Newton's law, at the time
//! in the step at which a point would close. Steppers let bodies bounce at the start of the step.
//!
//! A step allocates, and takes a multiple of its time. It is not part of a world's snapshots and recordings.
//!
//! ```
//! use backstop_lab::{LabWorld, WorldSolver};
//! use backstop::{BodyDesc, Geometry, Settings, ShapeDesc, World, glam::DVec3};
//!
//! # fn main() -> Result<(), backstop::Error> {
//! let mut world = World::new(Settings::default())?;
//! world.add_body(&BodyDesc::fixed().with_shape(ShapeDesc::new(Geometry::Plane)))?;
//! let cube = ShapeDesc::new(Geometry::cuboid(0.5, 0.5, 0.5));
//! world.add_body(&BodyDesc::dynamic().with_position(DVec3::Y * 0.5).with_shape(cube))?;
//! world.solve_with(WorldSolver::by_name("admm"));
//! for _ in 0..60 {
//!     world.step(1.0 / 60.0)?;
//! }
//! let report = world.solver_report().expect("a method solves it");
//! assert_eq!((report.islands, report.solved), (1, 1));
//! # Ok(())
//! # }
//! ```

mod apply;
mod options;

use super::methods::{Effort, Method};
use super::reduction::Keep;
use super::steppers::Stepper;
pub(super) use apply::Last;
use backstop::BodyHandle;
pub use options::MethodOptions;

/// A method that can solve a world.
#[derive(Clone, Copy, Debug)]
pub enum WorldMethod {
    /// One that solves the problem of a step.
    Problem(&'static Method),
    /// One that follows the step in time.
    Step(&'static Stepper),
}

impl WorldMethod {
    /// As the command line names it.
    pub fn name(&self) -> &'static str {
        match self {
            WorldMethod::Problem(method) => method.name,
            WorldMethod::Step(stepper) => stepper.name,
        }
    }

    /// The one of that name.
    pub fn by_name(name: &str) -> Option<WorldMethod> {
        let problem = Method::by_name(name).map(WorldMethod::Problem);
        problem.or_else(|| Stepper::by_name(name).map(WorldMethod::Step))
    }

    /// Names of all there are: those of problems, then those of steps.
    pub fn names() -> impl Iterator<Item = &'static str> {
        Method::ALL.iter().map(|m| m.name).chain(Stepper::ALL.iter().map(|s| s.name))
    }
}

impl From<&'static Method> for WorldMethod {
    fn from(method: &'static Method) -> WorldMethod {
        WorldMethod::Problem(method)
    }
}

impl From<&'static Stepper> for WorldMethod {
    fn from(stepper: &'static Stepper) -> WorldMethod {
        WorldMethod::Step(stepper)
    }
}

/// The impulses that a method starts from: how it is warm-started.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Guess {
    /// None.
    #[default]
    Zero,
    /// Those of the step before, contact by contact and joint by joint.
    LastStep,
    /// Those that the fast path found for this step.
    FastPath,
}

/// How a method solves a world.
#[derive(Clone, Debug)]
pub struct WorldSolver {
    /// The method.
    pub method: WorldMethod,
    /// Its limits for an island in a step; the start is replaced by `guess`. Default tolerance: 1e-8.
    pub effort: Effort,
    /// The impulses that it starts from. Default: those of the step before if [`Stepper::warm`], else zero.
    pub guess: Guess,
    /// Islands with more rows keep the answer of the fast path. Default 400.
    pub most_rows: usize,
    /// Only islands with one of these bodies are solved; none: all are.
    pub only: Vec<BodyHandle>,
    /// An island whose solution has a greater unit-free natural-map residual keeps the fast path's result.
    /// Default 1e-2; if infinite, every solution is taken that is finite and adds no energy where nothing can
    /// supply any.
    pub most_residual: f64,
    /// The share of overlap beyond the slop that is corrected per step. Default 0.2.
    pub overlap_share: f64,
    /// The same of joint errors. Default 0.5.
    pub joint_share: f64,
    /// Whether a penalty method keeps the direction in which bodies entered each other. Default true.
    pub direction_memory: bool,
    /// Which contact points of two bodies it has; those that it has not bear no load. Default none: all that
    /// the engine found, which are at most four for each manifold.
    pub reduce: Option<Keep>,
}

impl WorldSolver {
    /// With the defaults.
    pub fn new(method: impl Into<WorldMethod>) -> WorldSolver {
        let method = method.into();
        let warm = matches!(method, WorldMethod::Step(stepper) if stepper.warm);
        WorldSolver {
            method,
            effort: Effort { tolerance: 1e-8, ..Effort::default() },
            guess: if warm { Guess::LastStep } else { Guess::Zero },
            most_rows: 400,
            only: Vec::new(),
            most_residual: 1e-2,
            overlap_share: 0.2,
            joint_share: 0.5,
            direction_memory: true,
            reduce: None,
        }
    }

    /// With the method of that name, and the defaults.
    pub fn by_name(name: &str) -> Option<WorldSolver> {
        WorldMethod::by_name(name).map(WorldSolver::new)
    }
}

/// Counts of a method in the last step.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct SolverReport {
    /// Islands with rows.
    pub islands: usize,
    /// Those that it solved.
    pub solved: usize,
    /// Those with too many rows for it.
    pub too_large: usize,
    /// Those whose solution was not good enough: the fast path's was kept.
    pub refused: usize,
    /// Those whose overlap was not corrected, because that had no solution.
    pub not_pushed: usize,
    /// Rows of those that it solved.
    pub rows: usize,
    /// Sweeps, iterations or collisions, of all islands.
    pub iterations: u64,
    /// Pivots.
    pub pivots: u64,
    /// The greatest unit-free residual among those that it solved.
    pub residual: f64,
}
