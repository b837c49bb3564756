//! The rows of a step as one system (see [`System`]), as problems for methods.
//!
//! [`LabWorld::system`](crate::LabWorld::system) has that of the last step.

mod contact_problem;
mod impacts;
mod problem;
mod reduced;

use crate::problem::Problem;
use backstop::Error;
pub use backstop::observe::{
    Owner, SIDES, System, SystemBody, SystemIsland, SystemLaw, SystemRow, Velocity, of_two,
};
pub use contact_problem::Reduction;
pub(crate) use contact_problem::with_points;
use glam::DVec3;
pub(crate) use impacts::with_impacts;
pub use problem::Stabilisation;
pub(crate) use problem::{gains, needs_push, target};
pub(crate) use reduced::reduced;

/// Problems of a system.
pub trait SystemProblems {
    /// The problem of the whole step, with q for a method to solve: velocities with gravity and forces
    /// applied, plus for open gaps the speed that would close them within the step, for approaches above the
    /// threshold the speed after the bounce, and the pull of springs.
    ///
    /// # Errors
    /// If a number is not finite.
    fn problem(&self, stabilisation: Stabilisation) -> Result<Problem, Error>;

    /// The problem of some laws, in ascending order: those of an island for instance. Other rows are left
    /// out.
    ///
    /// # Errors
    /// If a number is not finite, or a patch is among the laws without its normals.
    fn problem_of(&self, laws: &[usize], stabilisation: Stabilisation) -> Result<Problem, Error>;

    /// The problem of the step with contacts only. Friction of a patch is Coulomb's at each of its points,
    /// with the patch's coefficient and without its row against twist, which the points resist by their arms;
    /// points that do not touch yet have no friction. Joints are eliminated (a Schur complement, exact for
    /// what is locked and for springs): `W - W_cj W_jj⁻¹ W_jc`.
    ///
    /// # Errors
    /// If a number is not finite.
    fn contact_problem(&self) -> Result<(Problem, Reduction), Error>;
}

impl SystemProblems for System {
    fn problem(&self, stabilisation: Stabilisation) -> Result<Problem, Error> {
        problem::problem(self, stabilisation)
    }

    fn problem_of(&self, laws: &[usize], stabilisation: Stabilisation) -> Result<Problem, Error> {
        problem::problem_of(self, laws, stabilisation)
    }

    fn contact_problem(&self) -> Result<(Problem, Reduction), Error> {
        contact_problem::contact_problem(self)
    }
}
