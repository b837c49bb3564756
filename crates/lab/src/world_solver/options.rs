//! What the methods of the lab leave to choose, as one value for a command line.

use super::{Guess, WorldSolver};
use crate::methods::{Effort, Friction, Order};
use crate::reduction::Keep;

/// Choices of methods; each leaves those that it does not know alone.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct MethodOptions {
    /// The impulses that a method starts from; none: those that it starts from by itself.
    pub guess: Option<Guess>,
    /// The model of friction, if the method has a choice.
    pub friction: Friction,
    /// Over-relaxation of `psor`, in (0, 2).
    pub relaxation: f64,
    /// Frequency of the springs of penalty methods [Hz]; zero: 0.048 of the rate of steps.
    pub frequency: f64,
    /// Damping ratio of these springs.
    pub damping: f64,
    /// Whether a penalty method keeps the direction in which bodies entered each other.
    pub direction_memory: bool,
    /// Impacts of a pair after which `sequential` halves its restitution.
    pub calm: u32,
    /// The order of what `sequential` and `impulse-based` take one after the other.
    pub order: Order,
    /// Which contact points of two bodies are kept; none: all.
    pub reduce: Option<Keep>,
}

impl Default for MethodOptions {
    fn default() -> MethodOptions {
        let usual = Effort::default();
        MethodOptions {
            guess: None,
            friction: usual.friction,
            relaxation: usual.relaxation,
            frequency: usual.frequency,
            damping: usual.damping,
            direction_memory: true,
            calm: usual.calm,
            order: usual.order,
            reduce: None,
        }
    }
}

impl WorldSolver {
    /// With these choices.
    pub fn with_options(mut self, options: MethodOptions) -> WorldSolver {
        let MethodOptions {
            guess,
            friction,
            relaxation,
            frequency,
            damping,
            direction_memory,
            calm,
            order,
            reduce,
        } = options;
        self.guess = guess.unwrap_or(self.guess);
        (self.direction_memory, self.reduce) = (direction_memory, reduce);
        self.effort = Effort { friction, relaxation, frequency, damping, calm, order, ..self.effort };
        self
    }
}
