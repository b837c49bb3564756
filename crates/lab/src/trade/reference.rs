//! A finely resolved run of a scene, and the errors of other runs relative to it.

use super::clock::Clock;
use super::{Cell, Errors, Measure};
use crate::{LabWorld, WorldSolver};
use backstop::BodyHandle;
use backstop::BodyKind;
use backstop::Error;
use backstop::Settings;
use backstop::World;
use backstop::observe::BodyState;
use backstop_scene::Scene;
use glam::{DQuat, DVec3};

/// Mean distance of bodies between the two finest runs, in widths of a body, up to which trajectories are
/// compared: beyond it the chaos of the scene would be measured.
const PARTED: f64 = 0.01;

/// Errors below this are meaningless, whatever the unit: velocities have the seven digits of `f32`.
const ROUNDING: f64 = f32::EPSILON as f64;

/// The time that is simulated, in frames.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Span {
    /// Frames per second: times at which runs are compared.
    pub frame_rate: u32,
    /// Number of frames.
    pub frames: u32,
}

impl Span {
    /// The whole time [s].
    pub fn seconds(&self) -> f64 {
        f64::from(self.frames) / f64::from(self.frame_rate)
    }
}

/// A scene in a world, step by step.
struct Run {
    world: World,
    dynamic: Vec<BodyHandle>,
    dt: f32,
    steps_per_frame: u32,
}

impl Run {
    fn start(
        scene: &Scene,
        how: (&Settings, Option<WorldSolver>),
        hz: u32,
        span: Span,
    ) -> Result<Run, Error> {
        if hz == 0 || span.frame_rate == 0 || !hz.is_multiple_of(span.frame_rate) {
            let expected = "a multiple of the frame rate";
            return Err(Error::OutOfRange { what: "steps per second", expected, value: hz.into() });
        }
        let mut world = World::new(how.0.clone())?;
        world.solve_with(how.1);
        let handles = scene.add_to(&mut world)?.bodies;
        let mut dynamic = Vec::new();
        for handle in handles {
            if world.kind(handle)? == BodyKind::Dynamic {
                dynamic.push(handle);
            }
        }
        Ok(Run { world, dynamic, dt: 1.0 / hz as f32, steps_per_frame: hz / span.frame_rate })
    }

    /// Where bodies are: centres of mass and rotations.
    fn poses(&self) -> Result<Vec<(DVec3, DQuat)>, Error> {
        let world = &self.world;
        let pose = |&body: &BodyHandle| {
            Ok((world.centre_of_mass(body)?, world.rotation(body)?.as_dquat().normalize()))
        };
        self.dynamic.iter().map(pose).collect()
    }

    fn states(&self) -> Result<Vec<BodyState>, Error> {
        self.dynamic.iter().map(|&body| BodyState::of(&self.world, body)).collect()
    }

    /// Kinetic energy of all dynamic bodies [J].
    fn kinetic_energy(&self) -> Result<f64, Error> {
        Ok(self.states()?.iter().map(BodyState::kinetic_energy).sum())
    }
}

/// The width of a body [m]: the side of a cube with its mass and its mean moment of inertia, m a² / 6. It
/// needs no shape, and a ball counts as 0.77 of its diameter.
fn width(body: &BodyState) -> f64 {
    let width = (6.0 * body.inertia.element_sum() / 3.0 / body.mass).sqrt();
    // Bodies that have no extent or can't rotate count as one metre wide.
    if width.is_finite() && width > 0.0 { width } else { 1.0 }
}

/// Where the bodies of a scene are, frame by frame.
#[derive(Clone, Debug)]
pub struct Track {
    span: Span,
    frames: Vec<Frame>,
    widths: Vec<f64>,
    /// The energy that differences are relative to [J].
    scale: f64,
    hash: u64,
}

#[derive(Clone, Debug)]
struct Frame {
    poses: Vec<(DVec3, DQuat)>,
    energy: f64,
}

impl Track {
    /// Runs a scene. Sleeping is off: a slow body that fell asleep would count as exact.
    ///
    /// # Errors
    /// If the world refuses the settings or the scene, or the rate of the cell is no multiple of the frame
    /// rate.
    pub fn of(scene: &Scene, span: Span, cell: &Cell) -> Result<Track, Error> {
        let mut run = Run::start(scene, (&cell.settings(scene), cell.world_solver()), cell.hz, span)?;
        let states = run.states()?;
        let widths: Vec<f64> = states.iter().map(width).collect();
        let mut kinetic = run.kinetic_energy()?;
        let mut frames = Vec::with_capacity(span.frames as usize);
        for _ in 0..span.frames {
            for _ in 0..run.steps_per_frame {
                run.world.step(run.dt)?;
            }
            kinetic = kinetic.max(run.kinetic_energy()?);
            frames.push(Frame { poses: run.poses()?, energy: run.world.energy() });
        }
        // If nothing moves, the energy that would lift every body by its width.
        let gravity = f64::from(scene.gravity.length());
        let lift: f64 = states.iter().zip(&widths).map(|(body, width)| body.mass * gravity * width).sum();
        let scale = kinetic.max(lift).max(f64::MIN_POSITIVE);
        Ok(Track { span, frames, widths, scale, hash: run.world.state_hash() })
    }

    /// Hash of all poses and velocities at the end. It differs if any bit differs, so it tells versions of
    /// scene and engine apart.
    pub fn hash(&self) -> u64 {
        self.hash
    }

    /// The mean distance of centres [widths] and the mean angle [rad] between bodies and those of a frame.
    fn difference(&self, frame: usize, poses: &[(DVec3, DQuat)]) -> [f64; 2] {
        let mut sum = [0.0; 2];
        for (((centre, rotation), (own, turned)), width) in
            poses.iter().zip(&self.frames[frame].poses).zip(&self.widths)
        {
            let between = turned.conjugate() * *rotation;
            sum[0] += (*centre - *own).length() / width;
            sum[1] += 2.0 * libm::atan2(between.xyz().length(), between.w.abs());
        }
        sum.map(|sum| sum / poses.len().max(1) as f64)
    }

    /// The difference of energy from that of a frame, relative to the greatest kinetic energy.
    fn energy_difference(&self, frame: usize, energy: f64) -> f64 {
        (energy - self.frames[frame].energy).abs() / self.scale
    }
}

/// The finest run of a scene, how certain it is, and up to when trajectories can be compared with it.
#[derive(Clone, Debug)]
pub struct Reference {
    fine: Track,
    horizon: usize,
    uncertainty: Errors,
}

impl Reference {
    /// A reference from the finest run and another of half the resolution, of the same scene and span.
    pub fn new(fine: Track, half: &Track) -> Reference {
        let frames = fine.frames.len().min(half.frames.len());
        let apart: Vec<[f64; 2]> = (0..frames).map(|i| fine.difference(i, &half.frames[i].poses)).collect();
        let horizon = apart.iter().take_while(|apart| apart[0] <= PARTED).count().max(1).min(frames);
        let energy = (0..frames).map(|i| fine.energy_difference(i, half.frames[i].energy)).sum::<f64>();
        let mut values = [ROUNDING; Measure::ALL.len()];
        for (measure, apart) in [
            (Measure::Trajectory, mean(&apart[..horizon], 0)),
            (Measure::Rotation, mean(&apart[..horizon], 1)),
            (Measure::Energy, energy / frames.max(1) as f64),
        ] {
            // Not `max`, which would hide NaN.
            if apart > ROUNDING || apart.is_nan() {
                values[measure as usize] = apart;
            }
        }
        Reference { fine, horizon, uncertainty: Errors::new(values) }
    }

    /// The time up to which the two finest runs agree to a hundredth of a body's width, in the mean over
    /// bodies [s].
    pub fn horizon(&self) -> f64 {
        self.horizon as f64 / f64::from(self.fine.span.frame_rate)
    }

    /// The errors of the run of half the resolution, or rounding if that is more: errors below these are
    /// meaningless.
    pub fn uncertainty(&self) -> &Errors {
        &self.uncertainty
    }

    /// Hash of the finest run, see [`Track::hash`].
    pub fn hash(&self) -> u64 {
        self.fine.hash
    }

    /// Runs the scene with other settings and `hz` steps per second, and returns the errors of the run.
    ///
    /// # Errors
    /// If the world refuses the settings or the scene, or the rate is no multiple of the frame rate.
    pub fn measure(
        &self,
        scene: &Scene,
        settings: &Settings,
        solver: Option<WorldSolver>,
        hz: u32,
    ) -> Result<Errors, Error> {
        let span = self.fine.span;
        let mut run = Run::start(scene, (settings, solver), hz, span)?;
        run.world.measure_accuracy(true);
        let (mut apart, mut energy) = (Vec::with_capacity(self.horizon), 0.0);
        let (mut penetration, mut residual, mut joint) = (0.0_f64, 0.0, 0.0_f64);
        for frame in 0..span.frames as usize {
            for _ in 0..run.steps_per_frame {
                run.world.step(run.dt)?;
                let Some(accuracy) = run.world.accuracy() else { continue };
                penetration = penetration.max(accuracy.whole.penetration);
                joint = joint.max(accuracy.whole.joint_length);
                residual += accuracy.whole.residual.worst;
            }
            let poses = run.poses()?;
            if !poses.iter().all(|(centre, rotation)| centre.is_finite() && rotation.is_finite()) {
                return Ok(Errors::LOST);
            }
            if frame < self.horizon {
                apart.push(self.fine.difference(frame, &poses));
            }
            energy += self.fine.energy_difference(frame, run.world.energy());
        }
        let steps = f64::from(span.frames.max(1)) * f64::from(run.steps_per_frame);
        Ok(Errors::new([
            mean(&apart, 0),
            mean(&apart, 1),
            penetration,
            residual / steps,
            joint,
            energy / f64::from(span.frames.max(1)),
        ]))
    }
}

fn mean(values: &[[f64; 2]], of: usize) -> f64 {
    values.iter().map(|value| value[of]).sum::<f64>() / values.len().max(1) as f64
}

/// Runs the scene without measuring errors, and returns the time that a simulated sixtieth of a second took
/// [us]: processor time of the thread if the system provides it, else wall time.
///
/// # Errors
/// As of [`Reference::measure`].
pub fn cost(
    scene: &Scene,
    settings: &Settings,
    solver: Option<WorldSolver>,
    hz: u32,
    span: Span,
) -> Result<f64, Error> {
    let mut run = Run::start(scene, (settings, solver), hz, span)?;
    let clock = Clock::start();
    for _ in 0..u64::from(span.frames) * u64::from(run.steps_per_frame) {
        run.world.step(run.dt)?;
    }
    Ok(clock.stop() / (60.0 * span.seconds()))
}
