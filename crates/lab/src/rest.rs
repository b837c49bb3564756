//! Finding the state about which to linearise.

use super::map::copy_of;
use backstop::Error;
use backstop::Snapshot;
use backstop::World;
use backstop::limits::{positive, within};
use backstop::observe::BodyState;

/// The calmest moment that was found.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Rest {
    /// Steps until then.
    pub steps: u32,
    /// Root of the mean square of the bodies' speeds then [m/s].
    pub speed: f64,
    /// The greatest distance that any body had moved [m]: a structure that has fallen is at rest too.
    pub moved: f64,
}

/// Steps between two measurements.
const EVERY: u32 = 30;

/// Root of the mean square of the speeds of dynamic bodies [m/s].
fn speed(world: &World) -> f64 {
    let bodies = BodyState::of_awake(world);
    let sum: f64 = bodies.iter().map(|body| body.linear.length_squared()).sum();
    (sum / bodies.len().max(1) as f64).sqrt()
}

/// Lets a world come to rest for `seconds` [s] and restores its calmest moment: an unstable structure moves
/// again later.
///
/// # Errors
/// If a number is out of range.
pub fn find_rest(world: &mut World, dt: f32, seconds: f32) -> Result<Rest, Error> {
    positive("dt", dt)?;
    within("seconds", seconds, 0.0, 1e6, "in 0..=1e6")?;
    let mut calmest = Snapshot::new();
    let mut copy = copy_of(world, &mut calmest)?;
    let mut best = Rest { steps: 0, speed: f64::INFINITY, moved: 0.0 };
    let steps = (seconds / dt).round() as u32;
    for step in 1..=steps {
        copy.step(dt)?;
        if step % EVERY == 0 || step == steps {
            let speed = speed(&copy);
            if speed < best.speed {
                best = Rest { steps: step, speed, moved: 0.0 };
                copy.snapshot(&mut calmest);
            }
        }
    }
    let places =
        |world: &World| world.bodies().map(|b| world.centre_of_mass(b)).collect::<Result<Vec<_>, _>>();
    let start = places(world)?;
    world.restore(&calmest)?;
    let way = start.iter().zip(places(world)?).map(|(a, b)| (b - *a).length());
    best.moved = way.fold(0.0, f64::max);
    Ok(best)
}
