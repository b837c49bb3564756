//! Seven tests of SimBenchmark (ETH Zürich, <https://leggedrobotics.github.io/SimBenchmark/>), rebuilt from
//! the description: the same scenes, the same metrics, and the numbers that were published for other engines
//! ([`Test::published`]). `docs/simbench.md` has the source of each number and the results.
//!
//! As there, a metric is taken before each step, at the times 0, `dt`, 2 `dt` and so on, and averaged over
//! the run.
//!
//! ```
//! use backstop_lab::simbench::{Setting, Test};
//!
//! # fn main() -> Result<(), backstop::Error> {
//! let setting = Setting { seconds: Some(2.0), ..Setting::default() };
//! // Balls that fall by 5 m and bounce with restitution 1.
//! assert!(Test::Bouncing.run(&setting)?.relative < 1e-3);
//! # Ok(())
//! # }
//! ```

mod bouncing;
mod published;
mod robot;
mod rolling;
mod run;
mod spheres;
mod test;
mod tower;

pub use published::Published;
pub use rolling::accelerations;
pub use run::{Outcome, Setting};
pub use test::Test;

use backstop::Error;
use backstop::limits::within;

/// The most steps of a run.
const MAX_STEPS: f32 = 1e7;

impl Test {
    /// Runs it.
    ///
    /// # Errors
    /// If a number of the setting is out of range, or there would be more than ten million steps.
    pub fn run(self, setting: &Setting) -> Result<Outcome, Error> {
        backstop::limits::step(setting.dt)?;
        let seconds = setting.seconds.unwrap_or(self.seconds());
        within("steps", seconds / setting.dt, 1.0, MAX_STEPS, "in 1..=10000000")?;
        match self {
            Test::Rolling => rolling::run(setting, seconds),
            Test::Bouncing => bouncing::run(setting, seconds),
            Test::Spheres => spheres::run(setting, seconds),
            Test::Elastic => spheres::run_elastic(setting, seconds),
            Test::Momentum => robot::momentum(setting, seconds),
            Test::Energy => robot::energy(setting, seconds),
            Test::Tower => tower::run(setting, seconds),
        }
    }

    /// Published results of other engines.
    pub fn published(self) -> &'static [Published] {
        published::of(self)
    }
}
