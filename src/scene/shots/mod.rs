//! Seeded shots at static targets, to measure tunnelling.
//!
//! A [`Shot`] is a world of its own: one dynamic body, one target, a velocity, and how time is stepped. It is through
//! if the body's centre of mass is on the wrong side of the target at the end of any step. Everything follows from
//! seed and number of the shot, so one that gets through can be run again alone, under any mode, in a test.

mod body;
mod target;

pub use body::SHAPES;
pub use target::{TARGETS, Targets};

use super::rng::Rng;
use crate::body::BodyDesc;
use crate::config::{Continuous, Settings};
use crate::error::Error;
use crate::handle::BodyHandle;
use crate::world::World;
use target::Side;

/// The modes that shots are run with, in the order of every count.
pub const MODES: [Continuous; 3] = [Continuous::Discrete, Continuous::Segment, Continuous::Volume];

/// Steps that a shot may take [s].
const STEPS: [f32; 5] = [1.0 / 20.0, 1.0 / 30.0, 1.0 / 60.0, 1.0 / 120.0, 1.0 / 240.0];
/// Mean of those.
const MEAN_STEP: f32 = 0.0225;
/// Substeps and iterations that a shot may be solved with.
const SOLVERS: [(u32, u32); 3] = [(1, 1), (1, 8), (4, 1)];
/// A shot ends after so many steps at the latest.
const MOST_STEPS: usize = 60;
/// Steps within which a shot reaches its target, unless gravity alone brings it there.
const MOST_FLIGHT: f32 = 20.0;
/// What is watched after the impact, on top of the time of flight [s].
const AFTER: f32 = 0.5;

/// One body on its way to a target.
#[derive(Clone, Debug)]
pub struct Shot {
    /// Index in [`SHAPES`].
    pub shape: usize,
    /// Index in [`TARGETS`].
    pub target: usize,
    /// Substeps and iterations.
    pub solver: (u32, u32),
    /// Length of each step [s]: about half of the shots have steps of one length.
    pub steps: Vec<f32>,
    /// The body, with pose and velocities.
    pub body: BodyDesc,
}

/// How a shot ended.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Outcome {
    /// On the right side of the target, or beyond its edge.
    Kept,
    /// On the wrong side after this many steps.
    Through(usize),
    /// A position that is not a number after this many steps.
    Lost(usize),
}

impl Shot {
    /// The shot of that number.
    pub fn new(targets: &Targets, seed: u64, number: u64) -> Shot {
        // Far apart in the generator's sequence, whatever the seed.
        let mut rng = Rng::new(Rng::new(seed ^ number.wrapping_mul(0xD134_2543_DE82_EF95)).next());
        // Every shape meets every target: the number counts through the pairs.
        let shape = (number % SHAPES.len() as u64) as usize;
        let target = (number / SHAPES.len() as u64 % TARGETS.len() as u64) as usize;
        let solver = SOLVERS[pick(&mut rng, SOLVERS.len())];
        let shapes = body::shapes(shape, &mut rng);
        let reach = body::reach(&shapes);

        let speed = log_range(&mut rng, 10.0, 2000.0);
        let spin = rng.direction() * rng.range(0.0, 200.0);
        let varying = rng.next() & 1 == 0;
        let fixed = STEPS[pick(&mut rng, STEPS.len())];
        let steps: Vec<f32> = (0..MOST_STEPS)
            .map(|_| if varying { STEPS[pick(&mut rng, STEPS.len())] } else { fixed })
            .collect();

        // Where it would go through, how steeply, and how far away it starts.
        let (aim, normal) = targets.aim(target, &mut rng);
        let mean = if varying { MEAN_STEP } else { fixed };
        let slowest = 1.5 * reach / (speed * MOST_FLIGHT * mean);
        let steep = rng.range(0.01, 1.0).max(slowest.min(1.0));
        let around = rng.range(0.0, std::f32::consts::TAU);
        let (u, v) = normal.any_orthonormal_pair();
        let flat = (1.0 - steep * steep).max(0.0).sqrt();
        let direction = (u * libm::cosf(around) + v * libm::sinf(around)) * flat - normal * steep;
        let direction = targets.turned(target, direction);
        let away = reach + speed * steps[0] * rng.range(0.0, 2.5);
        let start = targets.start(target, aim, direction, away, reach);

        // As long as the longest of the ways that it may take to the surface.
        let flight = (start.distance(aim) / speed).max(1.5 * reach / (steep * speed));
        let body = BodyDesc { shapes, ..BodyDesc::dynamic() }
            .at(start)
            .rotated(rng.rotation())
            .moving(direction * speed, spin);
        Shot { shape, target, solver, steps: until(steps, 2.0 * flight + AFTER), body }
    }

    /// Runs it.
    ///
    /// # Errors
    /// None that a shot of [`Shot::new`] should give.
    pub fn run(&self, targets: &Targets, mode: Continuous) -> Result<Outcome, Error> {
        self.run_seen(targets, mode, |_, _| {})
    }

    /// Runs it and shows the world and its body after each step.
    ///
    /// # Errors
    /// As [`Shot::run`].
    pub fn run_seen(
        &self,
        targets: &Targets,
        mode: Continuous,
        mut see: impl FnMut(&World, BodyHandle),
    ) -> Result<Outcome, Error> {
        let (substeps, iterations) = self.solver;
        let mut world =
            World::new(Settings { substeps, iterations, continuous: mode, ..Settings::default() })?;
        world.add_bodies(targets.bodies(self.target))?;
        let body = world.add_body(&self.body)?;
        let mut before = world.centre_of_mass(body)?;
        for (done, &dt) in self.steps.iter().enumerate() {
            world.step(dt)?;
            see(&world, body);
            let now = world.centre_of_mass(body)?;
            match targets.side(self.target, before, now) {
                Side::Right => before = now,
                Side::Wrong => return Ok(Outcome::Through(done + 1)),
                Side::Beyond => return Ok(Outcome::Kept),
                Side::Nowhere => return Ok(Outcome::Lost(done + 1)),
            }
        }
        Ok(Outcome::Kept)
    }

    /// Runs it under each of [`MODES`].
    ///
    /// # Errors
    /// As [`Shot::run`].
    pub fn run_all(&self, targets: &Targets) -> Result<[Outcome; 3], Error> {
        let [a, b, c] = MODES;
        Ok([self.run(targets, a)?, self.run(targets, b)?, self.run(targets, c)?])
    }
}

/// Shots, and how many of them got through (or were lost) under each of [`MODES`].
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Count {
    /// How many were run.
    pub shots: u64,
    /// How many got through.
    pub through: [u64; 3],
}

impl Count {
    /// Counts one more shot.
    pub fn add(&mut self, outcomes: &[Outcome; 3]) {
        self.shots += 1;
        for (through, outcome) in self.through.iter_mut().zip(outcomes) {
            *through += u64::from(*outcome != Outcome::Kept);
        }
    }

    /// Adds what was counted elsewhere.
    pub fn merge(&mut self, other: &Count) {
        self.shots += other.shots;
        self.through.iter_mut().zip(&other.through).for_each(|(a, b)| *a += b);
    }
}

/// Counts in all, by shape and by target.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Tally {
    /// In all.
    pub all: Count,
    /// In the order of [`SHAPES`].
    pub by_shape: [Count; SHAPES.len()],
    /// In the order of [`TARGETS`].
    pub by_target: [Count; TARGETS.len()],
}

impl Tally {
    /// Counts one more shot.
    pub fn add(&mut self, shot: &Shot, outcomes: &[Outcome; 3]) {
        self.all.add(outcomes);
        self.by_shape[shot.shape].add(outcomes);
        self.by_target[shot.target].add(outcomes);
    }

    /// Adds what was counted elsewhere.
    pub fn merge(mut self, other: &Tally) -> Tally {
        self.all.merge(&other.all);
        self.by_shape.iter_mut().zip(&other.by_shape).for_each(|(a, b)| a.merge(b));
        self.by_target.iter_mut().zip(&other.by_target).for_each(|(a, b)| a.merge(b));
        self
    }
}

/// The steps that cover a time [s].
fn until(mut steps: Vec<f32>, time: f32) -> Vec<f32> {
    let mut left = time;
    steps.retain(|dt| {
        let wanted = left > 0.0;
        left -= dt;
        wanted
    });
    steps
}

fn pick(rng: &mut Rng, count: usize) -> usize {
    (rng.next() >> 33) as usize % count
}

/// Even in the logarithm.
fn log_range(rng: &mut Rng, low: f32, high: f32) -> f32 {
    low * libm::expf(rng.range(0.0, libm::logf(high / low)))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn shots_start_on_the_right_side_and_clear_of_their_target() {
        let targets = Targets::new().unwrap();
        for number in 0..3000 {
            let shot = Shot::new(&targets, 7, number);
            shot.body.validate().unwrap();
            let clear = targets.clearance(shot.target, shot.body.position);
            let reach = f64::from(body::reach(&shot.body.shapes));
            assert!(clear >= 0.99 * reach, "{number}: {clear} m is less than its reach of {reach} m");
            assert!(!shot.steps.is_empty() && shot.steps.len() <= MOST_STEPS);
            let speed = shot.body.linear_velocity.length();
            assert!((9.99..2001.0).contains(&speed));
        }
    }

    #[test]
    fn a_shot_follows_from_seed_and_number() {
        let targets = Targets::new().unwrap();
        let text = |seed, number| format!("{:?}", Shot::new(&targets, seed, number));
        assert_eq!(text(1, 41), text(1, 41));
        assert_ne!(text(1, 41), text(2, 41));
    }

    #[test]
    fn bodies_fly_from_the_right_side_to_the_wrong_one_if_nothing_is_there() {
        // The same flight without a target: most cross where they were aimed at. What remains is slow or grazing and
        // ends before, or leaves over the edge.
        let targets = Targets::new().unwrap();
        let mut crossed = 0;
        for number in 0..1000 {
            let shot = Shot::new(&targets, 3, number);
            let mut p = shot.body.position;
            let v = shot.body.linear_velocity.as_dvec3();
            for &dt in &shot.steps {
                let next = p + v * f64::from(dt);
                match targets.side(shot.target, p, next) {
                    Side::Wrong => {
                        crossed += 1;
                        break;
                    }
                    Side::Right => p = next,
                    _ => break,
                }
            }
        }
        assert!(crossed > 900, "{crossed} of 1000");
    }
}
