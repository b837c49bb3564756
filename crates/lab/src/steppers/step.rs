//! Input and output of a method for a step.

use crate::methods::{Effort, Solution};
use crate::problem::Problem;
use crate::system::{Stabilisation, System, SystemIsland, Velocity};

/// An island in a step.
#[derive(Clone, Copy, Debug)]
pub struct Step<'a> {
    /// All rows of the world.
    pub system: &'a System,
    /// Which of them are to be solved.
    pub island: &'a SystemIsland,
    /// The problem of the end of the step, with the rows of the island in the order of its laws.
    pub problem: &'a Problem,
    /// The stabilisation in the problem.
    pub stabilisation: Stabilisation,
}

/// The result of a method.
#[derive(Clone, Debug, PartialEq)]
pub struct Resolution {
    /// How it ended, with the impulses of the whole step by the rows of the problem. Its residual is that of
    /// the problem, which asks for another law of impacts than most of these methods have.
    pub solution: Solution,
    /// Velocities of the island's bodies at the end of the step. They may differ from what the impulses
    /// explain: bodies that shock propagation holds take no impulse.
    pub end: Vec<Velocity>,
    /// Their mean velocities over the step, if the method knows them; else bodies move with those at its end.
    pub moving: Option<Vec<Velocity>>,
}

/// A method as a function.
pub type Resolve = fn(&Step<'_>, &Effort) -> Resolution;
