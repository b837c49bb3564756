//! A shot at a static target, and its outcome.

use super::body::{self, SHAPES};
use super::draw::{generator, log_range, pick, step_lengths, until};
use super::target::{Side, TARGETS, Targets};
use backstop::BodyDesc;
use backstop::BodyHandle;
use backstop::Error;
use backstop::World;
use backstop::{ContinuousMode, Settings};

/// The modes that shots are run with, in the order of every count.
pub const MODES: [ContinuousMode; 3] =
    [ContinuousMode::Discrete, ContinuousMode::Segment, ContinuousMode::Volume];

/// Substeps and iterations that a shot may be solved with.
const SOLVERS: [(u32, u32); 3] = [(1, 1), (1, 8), (4, 1)];
/// A shot ends after so many steps at the latest.
pub(super) const MAX_STEPS: usize = 60;
/// Steps within which a shot reaches its target, unless gravity alone brings it there.
const MAX_FLIGHT_TIME: f32 = 20.0;
/// Time that is simulated after the impact, on top of the time of flight [s].
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

/// The result of a shot.
#[derive(Clone, Copy, Debug)]
pub struct Flight {
    /// How it ended.
    pub outcome: Outcome,
    /// Whether it touched its target, or was stopped at it.
    pub met: bool,
    /// How deep its deepest point was beyond the surface after the step in which it met it [m].
    pub depth_at_impact: f32,
    /// The same after any step [m].
    pub depth: f32,
    /// Most steps in a row after which a point was deeper than [`STUCK`].
    pub steps_deep: u32,
    /// Largest extent of the body, twice its reach from its origin [m].
    pub size: f32,
    /// Radius of the ball that fits into the body: its smallest half width [m].
    pub half_width: f32,
    /// Its gain of energy as a share of the initial energy; zero if it lost energy.
    pub gained: f32,
    /// Whether the guard cut its path at least once.
    pub cut: bool,
    /// Whether the guard lifted it off a surface at least once.
    pub lifted: bool,
    /// Whether it was settled at least once ([`StepReport::settled`](backstop::StepReport)).
    pub settled: bool,
}

/// A body that is deeper than this after more than [`STUCK_STEPS`] steps in a row is stuck [m].
pub const STUCK: f32 = 0.02;
/// See [`STUCK`].
pub const STUCK_STEPS: u32 = 3;
/// A stop is over if its deepest point, after the step of the impact, is deeper than this [m] ...
pub const DEEP: f32 = 0.005;
/// ... and deeper than this share of the body's size.
pub const DEEP_SHARE: f32 = 0.02;
/// A gain of energy that counts, as a share. Rounding of a speed of 2 km/s is a hundredth of it.
pub const GAIN: f32 = 1e-3;

impl Flight {
    /// Whether it is deeper after its impact than it may be: see [`DEEP`].
    pub fn is_over(&self) -> bool {
        self.depth_at_impact > DEEP.max(DEEP_SHARE * self.size)
    }

    /// Whether it stayed deep: see [`STUCK`].
    pub fn is_stuck(&self) -> bool {
        self.steps_deep > STUCK_STEPS
    }
}

impl Shot {
    /// The shot of that number.
    pub fn new(targets: &Targets, seed: u64, number: u64) -> Shot {
        let mut rng = generator(seed, number);
        // Every shape meets every target: the number counts through the pairs.
        let shape = (number % SHAPES.len() as u64) as usize;
        let target = (number / SHAPES.len() as u64 % TARGETS.len() as u64) as usize;
        let solver = SOLVERS[pick(&mut rng, SOLVERS.len())];
        let shapes = body::shapes(shape, &mut rng);
        let reach = body::reach(&shapes);

        let speed = log_range(&mut rng, 10.0, 2000.0);
        let spin = rng.direction() * rng.range(0.0, 200.0);
        let (steps, mean) = step_lengths(&mut rng, MAX_STEPS);

        // Where it would go through, how steeply, and how far away it starts.
        let (aim, normal) = targets.aim(target, &mut rng);
        let slowest = 1.5 * reach / (speed * MAX_FLIGHT_TIME * mean);
        let steep = rng.range(0.01, 1.0).max(slowest.min(1.0));
        let around = rng.range(0.0, std::f32::consts::TAU);
        let (u, v) = normal.any_orthonormal_pair();
        let flat = (1.0 - steep * steep).max(0.0).sqrt();
        let direction = (u * libm::cosf(around) + v * libm::sinf(around)) * flat - normal * steep;
        let direction = targets.turned(target, direction);
        let away = reach + speed * steps[0] * rng.range(0.0, 2.5);
        let start = targets.start(target, aim, direction, away, reach);

        // At least as long as the longest path that it may take to the surface.
        let flight = (start.distance(aim) / speed).max(1.5 * reach / (steep * speed));
        let mut body = BodyDesc::dynamic();
        body.shapes = shapes;
        let body =
            body.with_position(start).with_rotation(rng.rotation()).with_velocity(direction * speed, spin);
        Shot { shape, target, solver, steps: until(steps, 2.0 * flight + AFTER), body }
    }

    /// Runs it, with the guard or without ([`Settings::guard`]).
    ///
    /// # Errors
    /// None that a shot of [`Shot::new`] should give.
    pub fn run(&self, targets: &Targets, mode: ContinuousMode, guard: bool) -> Result<Flight, Error> {
        self.run_seen(targets, mode, guard, |_, _| {})
    }

    /// Runs it and shows the world and its body after each step.
    ///
    /// # Errors
    /// As [`Shot::run`].
    pub fn run_seen(
        &self,
        targets: &Targets,
        mode: ContinuousMode,
        guard: bool,
        mut see: impl FnMut(&World, BodyHandle),
    ) -> Result<Flight, Error> {
        let (substeps, iterations) = self.solver;
        let settings = Settings::default()
            .with_substeps(substeps)
            .with_iterations(iterations)
            .with_continuous(mode)
            .with_guard(guard);
        let mut world = World::new(settings)?;
        world.add_bodies(targets.bodies(self.target))?;
        let body = world.add_body(&self.body)?;
        let mut before = world.centre_of_mass(body)?;
        let energy = world.energy();
        let inner = self.body.shapes.iter().map(|s| s.geometry.inner_radius()).fold(0.0, f32::max);
        let mut flight = Flight {
            outcome: Outcome::Kept,
            met: false,
            depth_at_impact: 0.0,
            depth: 0.0,
            steps_deep: 0,
            size: 2.0 * body::reach(&self.body.shapes),
            half_width: inner,
            gained: 0.0,
            cut: false,
            lifted: false,
            settled: false,
        };
        let mut in_a_row = 0;
        for (done, &dt) in self.steps.iter().enumerate() {
            world.step(dt)?;
            see(&world, body);
            let now = world.centre_of_mass(body)?;
            flight.outcome = match targets.side(self.target, before, now) {
                Side::Right => Outcome::Kept,
                Side::Wrong => Outcome::Through(done + 1),
                // Nothing is known from here on.
                Side::Beyond => return Ok(flight),
                Side::Nowhere => Outcome::Lost(done + 1),
            };
            if flight.outcome != Outcome::Kept {
                return Ok(flight);
            }
            before = now;
            let (at, rotation) = (world.position(body)?, world.rotation(body)?.as_dquat());
            let depth = targets.depth_of(self.target, &self.body.shapes, at, rotation).max(0.0) as f32;
            let report = world.report();
            (flight.cut, flight.lifted) =
                (flight.cut | (report.cut > 0), flight.lifted | (report.lifted > 0));
            flight.settled |= report.settled > 0;
            if !flight.met && (report.real > 0 || report.pushed > 0 || report.held() > 0 || depth > 0.0) {
                (flight.met, flight.depth_at_impact) = (true, depth);
            }
            flight.depth = flight.depth.max(depth);
            in_a_row = if depth > STUCK { in_a_row + 1 } else { 0 };
            flight.steps_deep = flight.steps_deep.max(in_a_row);
            flight.gained = flight.gained.max(((world.energy() - energy) / energy.abs().max(1e-9)) as f32);
        }
        Ok(flight)
    }

    /// Runs it under each of [`MODES`], with the guard and without.
    ///
    /// # Errors
    /// As [`Shot::run`].
    pub fn run_all(&self, targets: &Targets) -> Result<Flights, Error> {
        let [a, b, c] = MODES.map(|mode| self.run(targets, mode, true));
        let guarded = [a?, b?, c?];
        // Without continuous collision there is no guard.
        let unguarded = [
            guarded[0].outcome,
            self.run(targets, MODES[1], false)?.outcome,
            self.run(targets, MODES[2], false)?.outcome,
        ];
        Ok(Flights { guarded, unguarded })
    }
}

/// A shot under each of [`MODES`].
#[derive(Clone, Copy, Debug)]
pub struct Flights {
    /// With the guard.
    pub guarded: [Flight; 3],
    /// How it ends without the guard.
    pub unguarded: [Outcome; 3],
}
