//! The envelope: small scenes under extreme conditions, each run for a minute and judged by what became of
//! its bodies.
//!
//! A [`Cell`] is one [`Trial`] at one point of one [`Axis`], all else being ordinary. It runs independently
//! of others and yields its [`Figure`]s, the worst first. [`Watch`], which judges it, sees only poses and
//! velocities, so another engine that runs the same [`Cell::scene`] with the same steps is judged alike.
//! `docs/envelope.md` has the map.

mod conditions;
mod insides;
mod measures;
mod reach;
mod trials;

pub use conditions::{Axis, Conditions, Flaw, Rhythm};
pub use measures::{Figure, State, Verdict, Watch};
pub use trials::{Drive, Trial};

use backstop::BodyHandle;
use backstop::Error;
use backstop::Settings;
use backstop::World;
use backstop_scene::Scene;
use trials::Setup;

/// How long each cell is watched [s].
pub const SECONDS: f64 = 60.0;

/// One trial at one point of one axis.
#[derive(Clone, Debug, PartialEq)]
pub struct Cell {
    /// The scene.
    pub trial: Trial,
    /// The extreme condition.
    pub axis: Axis,
    /// How extreme, in words.
    pub label: String,
    /// The conditions themselves.
    pub conditions: Conditions,
}

impl Cell {
    /// All of them, trial by trial, axis by axis.
    pub fn all() -> Vec<Cell> {
        let of = |trial: Trial| {
            let axes = Axis::ALL.into_iter().filter(move |&axis| trial.has(axis));
            axes.flat_map(move |axis| {
                let cell = move |(label, conditions)| Cell { trial, axis, label, conditions };
                axis.points().into_iter().map(cell)
            })
        };
        Trial::ALL.into_iter().flat_map(of).filter(|cell| cell.trial.allows(&cell.conditions)).collect()
    }

    /// `trial/axis/label`, with no spaces.
    pub fn name(&self) -> String {
        format!("{}/{}/{}", self.trial.name(), self.axis.name(), self.label.replace(' ', "-"))
    }

    /// The scene for an engine to run.
    pub fn scene(&self) -> Scene {
        self.trial.setup(&self.conditions).scene
    }

    /// Velocities of the bodies that are driven, for the step about a time [s]: the same in any engine.
    pub fn drives(&self, time: f64) -> Vec<Drive> {
        self.trial.drives(&self.conditions, time)
    }

    /// The judge of a run of `seconds`.
    pub fn watch(&self, seconds: f64) -> Watch {
        let Setup { scene, boundaries, gauges } = self.trial.setup(&self.conditions);
        Watch::new(&scene, boundaries, gauges, seconds)
    }

    /// Runs it and returns its figures, the worst first; states are observed ten times a second. `settings`
    /// are the world's, except for gravity and length unit.
    ///
    /// # Errors
    /// If the world refuses a setting or a body, or a step fails.
    pub fn run(&self, settings: &Settings, seconds: f64) -> Result<Vec<Figure>, Error> {
        let scene = self.scene();
        let settings = settings.clone().with_gravity(scene.gravity).with_length_unit(self.conditions.size);
        let mut world = World::new(settings)?;
        let bodies = scene.add_to(&mut world)?.bodies;
        let mut watch = self.watch(seconds);
        let (mut time, mut looked) = (0.0, 0.0);
        let mut states = Vec::new();
        for step in 0.. {
            // Half a millisecond of tolerance, so that steps whose rounded sum falls just short are not
            // observed one step late.
            if time >= seconds - 5e-4 || !watch.is_finite() {
                break;
            }
            let dt = self.conditions.rhythm.dt(step);
            for Drive { body, linear, angular } in self.drives(time + 0.5 * f64::from(dt)) {
                world.set_velocity(bodies[body], linear, angular)?;
            }
            world.step(dt)?;
            time += f64::from(dt);
            if time - looked >= 0.1 - 5e-4 || time >= seconds - 5e-4 {
                looked = time;
                look(&world, &bodies, &mut states)?;
                watch.see(time, &states);
            }
        }
        Ok(watch.figures())
    }
}

fn look(world: &World, bodies: &[BodyHandle], states: &mut Vec<State>) -> Result<(), Error> {
    states.clear();
    for &body in bodies {
        states.push(State {
            position: world.position(body)?,
            rotation: world.rotation(body)?,
            linear: world.linear_velocity(body)?,
            angular: world.angular_velocity(body)?,
        });
    }
    Ok(())
}
