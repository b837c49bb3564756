//! Time of impact with retroactive detection: step, check whether bodies penetrated each other, and if so go
//! back to the time at which they met.
//!
//! This runs a world without continuous collision, for comparison: detection only ever sees the present
//! poses. The time is bisected until the overlap is within the tolerance; the world steps to that time, finds
//! a touching contact in the next step, and goes on with the rest of the time. After [`Retroactive::rounds`]
//! returns the rest of the step is taken without a check: one bad impact is better than a game that stands
//! still.

use crate::{LabWorld, WorldMethod, meter_of, put_meter};
use backstop::Error;
use backstop::Snapshot;
use backstop::StepReport;
use backstop::World;
use backstop::limits::MIN_STEP;
use backstop::limits::positive;

/// How exactly times of impact are found, and how often a step may be taken back.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Retroactive {
    /// Overlap that a step may add [m].
    pub tolerance: f64,
    /// The most returns in a step.
    pub rounds: u32,
}

impl Default for Retroactive {
    /// A millimetre, and eight returns.
    fn default() -> Retroactive {
        Retroactive { tolerance: 1e-3, rounds: 8 }
    }
}

/// Counts of a step.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Returns {
    /// Steps that were taken and kept.
    pub steps: u32,
    /// Steps that were taken back.
    pub undone: u32,
    /// Whether the rounds ran out before the end of the step.
    pub gave_up: bool,
    /// The report of the last part of the step.
    pub report: StepReport,
}

impl Retroactive {
    /// Whether it is of use where a method of the lab solves the steps: methods that let bodies bear on each
    /// other by overlap would be taken back from every load.
    pub fn serves(method: WorldMethod) -> bool {
        !matches!(method, WorldMethod::Step(stepper) if stepper.yields)
    }

    /// Moves a world on by `dt` seconds. If accuracy is measured, it is afterwards that of the last part of
    /// the step; the system of rows is that of a search for overlap.
    ///
    /// # Errors
    /// If `dt` can't be a step's, or the tolerance is not positive.
    pub fn step(&self, world: &mut World, dt: f32) -> Result<Returns, Error> {
        backstop::limits::step(dt)?;
        positive("tolerance", self.tolerance as f32)?;
        let mut returns = Returns::default();
        let (mut left, mut start) = (dt, Snapshot::default());
        let mut deep = overlap(world)?;
        while left >= MIN_STEP {
            world.snapshot(&mut start);
            let meter = meter_of(world);
            let most = deep.max(0.0) + self.tolerance;
            let mut attempt = |world: &mut World, time: f32| -> Result<f64, Error> {
                world.restore(&start)?;
                put_meter(world, meter.clone());
                returns.report = *world.step(time)?;
                overlap(world)
            };
            let mut time = left;
            deep = attempt(world, time)?;
            returns.steps += 1;
            if deep > most && returns.steps <= self.rounds {
                // Longest time that is known to be good, shortest that is known to be bad.
                let (mut good, mut bad) = (0.0_f32, left);
                for _ in 0..BISECTIONS {
                    time = 0.5 * (good + bad);
                    if time < MIN_STEP {
                        break;
                    }
                    returns.undone += 1;
                    deep = attempt(world, time)?;
                    if deep > most {
                        bad = time;
                    } else {
                        good = time;
                    }
                    if good > 0.0 && (bad - good) < NEAR * dt {
                        break;
                    }
                }
                // If even the shortest step is bad, bodies overlap already, and going back does not help.
                let chosen = if good >= MIN_STEP { good } else { bad.max(MIN_STEP) };
                if chosen != time {
                    time = chosen;
                    deep = attempt(world, time)?;
                }
            } else if deep > most {
                returns.gave_up = true;
            }
            left -= time;
        }
        Ok(returns)
    }
}

/// Halvings of a step.
const BISECTIONS: u32 = 24;
/// Precision of the time of impact as a share of the step.
const NEAR: f32 = 1e-4;

/// The deepest overlap at the present poses [m]; the world stays unchanged, but for the system of its rows.
fn overlap(world: &mut World) -> Result<f64, Error> {
    let mut here = Snapshot::default();
    world.snapshot(&mut here);
    let meter = meter_of(world);
    world.measure_accuracy(true);
    let stepped = world.step(MIN_STEP).map(drop);
    let deep = world.accuracy().map_or(0.0, |accuracy| accuracy.whole.penetration);
    put_meter(world, meter);
    world.restore(&here)?;
    stepped.map(|()| deep)
}
