//! What methods of the lab leave to choose: the same options for all commands that have one.

use super::values::{friction, named_of, not_negative, positive_f64, relaxation};
use anyhow::bail;
use backstop_lab::methods::{Friction, Order};
use backstop_lab::reduction::Keep;
use backstop_lab::retroactive::Retroactive;
use backstop_lab::{Guess, MethodOptions, WorldMethod, WorldSolver};
use clap::Args;

/// Options of the lab's methods (docs/lecture.md); a method leaves those that it does not know alone.
#[derive(Args, Clone, Debug, PartialEq)]
pub(crate) struct MethodArgs {
    /// Impulses that a method starts from: zero, last-step or fast-path [default: zero, of avbd last-step].
    #[arg(long, value_name = "FROM", value_parser = guess)]
    pub(crate) guess: Option<Guess>,
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
    /// Which pair sequential takes next: fastest, or given, by the order of bodies; or together, all that
    /// approach at once, and for impulse-based all points of two bodies that meet at one time.
    #[arg(long, value_name = "ORDER", default_value = "fastest", value_parser = order)]
    pub(crate) order: Order,
    /// Contact points of two bodies: hull, all corners of their convex hull, or at most 1 to 4 [default: all
    /// that the engine found, at most four for each two shapes].
    #[arg(long, value_name = "POINTS", value_parser = keep)]
    pub(crate) reduce: Option<Keep>,
}

/// Retroactive detection instead of continuous collision.
#[derive(Args, Clone, Debug, PartialEq)]
pub(crate) struct ReturnArgs {
    /// Detect collisions only where bodies are, and take steps back in which an overlap grows by more than
    /// this [m].
    #[arg(long, value_name = "M", value_parser = positive_f64)]
    pub(crate) retroactive: Option<f64>,
    /// The most returns in a step.
    #[arg(long, value_name = "N", default_value_t = Retroactive::default().rounds, requires = "retroactive")]
    pub(crate) returns: u32,
}

impl ReturnArgs {
    /// How steps are taken back by a method of the lab, or by the engine's own; an error if it can't serve.
    pub(crate) fn of(&self, method: Option<WorldMethod>) -> anyhow::Result<Option<Retroactive>> {
        let Some(tolerance) = self.retroactive else { return Ok(None) };
        if let Some(method) = method.filter(|&method| !Retroactive::serves(method)) {
            bail!("--retroactive can't serve {}: overlap is what its bodies bear on", method.name());
        }
        Ok(Some(Retroactive { tolerance, rounds: self.returns }))
    }
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
            reduce: self.reduce,
        }
    }

    /// A method with these; an error if there is none, but some of these.
    pub(crate) fn of(&self, solver: Option<WorldSolver>) -> anyhow::Result<Option<WorldSolver>> {
        if solver.is_none() && self.any() {
            bail!("options of the lab's methods need --solver: the engine's own has none of them");
        }
        Ok(solver.map(|solver| solver.with_options(self.options())))
    }

    /// An error if some of these are given, and no method is one of the lab.
    pub(crate) fn check(&self, methods: impl IntoIterator<Item = Option<WorldMethod>>) -> anyhow::Result<()> {
        if self.any() && methods.into_iter().all(|method| method.is_none()) {
            bail!("options of the lab's methods need another --method: the engine's own has none of them");
        }
        Ok(())
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
    named_of(text, &[("fastest", Order::Fastest), ("given", Order::Given), ("together", Order::Together)])
}

fn keep(text: &str) -> Result<Keep, String> {
    match text.parse() {
        Ok(most @ 1..=4) => Ok(Keep::Most(most)),
        _ if text == "hull" => Ok(Keep::Hull),
        _ => Err("must be hull or a number in 1..=4".into()),
    }
}
