//! What methods of the lab leave to choose: the same options for all commands that have one.

use super::values::{friction, named_of, not_negative, relaxation};
use backstop_lab::methods::{Friction, Order};
use backstop_lab::{Guess, MethodOptions, WorldSolver};
use clap::Args;

/// Options of the lab's methods (docs/lecture.md); a method leaves those that it does not know alone.
#[derive(Args, Clone, Debug, PartialEq)]
pub(crate) struct MethodArgs {
    /// Impulses that a method starts from: zero, last-step or fast-path.
    #[arg(long, value_name = "FROM", default_value = "zero", value_parser = guess)]
    pub(crate) guess: Guess,
    /// Friction of contacts, where the method has a choice: cone, pyramid or box.
    #[arg(long = "friction-shape", value_name = "SHAPE", default_value = "cone", value_parser = friction)]
    pub(crate) friction_shape: Friction,
    /// Over-relaxation of psor.
    #[arg(long, value_name = "W", default_value_t = 1.3, value_parser = relaxation)]
    pub(crate) relaxation: f64,
    /// Frequency of the springs of penalty methods [Hz]; 0: 0.048 of the rate of steps.
    #[arg(long, value_name = "HZ", default_value_t = 0.0, value_parser = not_negative)]
    pub(crate) frequency: f64,
    /// Damping ratio of these springs.
    #[arg(long, value_name = "Z", default_value_t = 0.7, value_parser = not_negative)]
    pub(crate) damping: f64,
    /// Penalty methods forget the direction in which bodies entered each other.
    #[arg(long)]
    pub(crate) no_direction_memory: bool,
    /// Impacts of a pair after which sequential halves its restitution; all of it after four times as many.
    #[arg(long, value_name = "N", default_value_t = 32)]
    #[arg(value_parser = clap::value_parser!(u32).range(1..))]
    pub(crate) calm: u32,
    /// Which pair sequential takes next: fastest, or given, by the order of bodies.
    #[arg(long, value_name = "ORDER", default_value = "fastest", value_parser = order)]
    pub(crate) order: Order,
}

impl MethodArgs {
    pub(crate) fn options(&self) -> MethodOptions {
        MethodOptions {
            guess: self.guess,
            friction: self.friction_shape,
            relaxation: self.relaxation,
            frequency: self.frequency,
            damping: self.damping,
            direction_memory: !self.no_direction_memory,
            calm: self.calm,
            order: self.order,
        }
    }

    /// A method with these; an error if there is none, but some of these.
    pub(crate) fn of(&self, solver: Option<WorldSolver>) -> anyhow::Result<Option<WorldSolver>> {
        if solver.is_none() && self.any() {
            anyhow::bail!("options of the lab's methods need --solver: the engine's own has none of them");
        }
        Ok(solver.map(|solver| solver.with_options(self.options())))
    }

    /// Whether any is given: only a method of the lab has them.
    pub(crate) fn any(&self) -> bool {
        self.options() != MethodOptions::default()
    }
}

fn guess(text: &str) -> Result<Guess, String> {
    named_of(text, &[("zero", Guess::Zero), ("last-step", Guess::LastStep), ("fast-path", Guess::FastPath)])
}

fn order(text: &str) -> Result<Order, String> {
    named_of(text, &[("fastest", Order::Fastest), ("given", Order::Given)])
}
