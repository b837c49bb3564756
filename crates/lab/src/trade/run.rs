//! A scene that is run, and where its bodies are.

use super::clock::Clock;
use crate::{LabWorld, WorldSolver};
use backstop::observe::BodyState;
use backstop::{BodyHandle, BodyKind, Error, JointHandle, Settings, World};
use backstop_scene::Scene;
use glam::{DQuat, DVec3};

/// The acceleration of bodies where a scene has no gravity, for the scale of their speeds [m/s²].
const WEIGHTLESS: f64 = 9.81;

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

    /// The last frames, in which bodies are looked at for rest: half a second, a quarter of the time at most.
    pub(super) fn tail(&self) -> std::ops::Range<usize> {
        let last = (self.frame_rate / 2).min(self.frames / 4).max(1);
        self.frames.saturating_sub(last) as usize..self.frames as usize
    }
}

/// A scene in a world, step by step.
pub(super) struct Run {
    pub(super) world: World,
    pub(super) dynamic: Vec<BodyHandle>,
    joints: Vec<JointHandle>,
    pub(super) dt: f32,
    pub(super) steps_per_frame: u32,
}

impl Run {
    pub(super) fn start(
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
        let added = scene.add_to(&mut world)?;
        let mut dynamic = Vec::new();
        for handle in added.bodies {
            if world.kind(handle)? == BodyKind::Dynamic {
                dynamic.push(handle);
            }
        }
        let steps_per_frame = hz / span.frame_rate;
        Ok(Run { world, dynamic, joints: added.joints, dt: 1.0 / hz as f32, steps_per_frame })
    }

    pub(super) fn states(&self) -> Result<Vec<BodyState>, Error> {
        self.dynamic.iter().map(|&body| BodyState::of(&self.world, body)).collect()
    }

    /// Where bodies are now and how fast, given their widths.
    pub(super) fn frame(&self, widths: &[f64]) -> Result<Frame, Error> {
        let states = self.states()?;
        let pose = |(&body, state): (&BodyHandle, &BodyState)| {
            Ok((state.centre, self.world.rotation(body)?.as_dquat().normalize()))
        };
        let speed =
            |(state, width): (&BodyState, &f64)| state.linear.length() + 0.5 * width * state.angular.length();
        Ok(Frame {
            poses: self.dynamic.iter().zip(&states).map(pose).collect::<Result<_, Error>>()?,
            speeds: states.iter().zip(widths).map(speed).collect(),
            energy: self.world.energy(),
        })
    }

    /// The width of the narrowest body that has joints [m]; infinite without joints.
    pub(super) fn narrowest_joined(&self, widths: &[f64]) -> Result<f64, Error> {
        let mut least = f64::INFINITY;
        for &joint in &self.joints {
            let bodies = self.world.joint_bodies(joint)?;
            let joined = self.dynamic.iter().zip(widths).filter(|(body, _)| bodies.contains(body));
            least = joined.fold(least, |least, (_, width)| least.min(*width));
        }
        Ok(least)
    }
}

/// The width of a body [m]: the side of a cube with its mass and its mean moment of inertia, m a² / 6. It
/// needs no shape, and a ball counts as 0.77 of its diameter.
pub(super) fn width(body: &BodyState) -> f64 {
    let width = (6.0 * body.inertia.element_sum() / 3.0 / body.mass).sqrt();
    // Bodies that have no extent or can't rotate count as one metre wide.
    if width.is_finite() && width > 0.0 { width } else { 1.0 }
}

/// The speed that a body of some width has after it fell by half of that [m/s]: speeds of bodies of all sizes
/// are told by it.
pub(super) fn pace(gravity: f64, width: f64) -> f64 {
    (if gravity > 0.0 { gravity } else { WEIGHTLESS } * width).sqrt()
}

/// Bodies at one time.
#[derive(Clone, Debug)]
pub(super) struct Frame {
    /// Centres of mass and rotations.
    pub(super) poses: Vec<(DVec3, DQuat)>,
    /// Speed of the fastest point, about [m/s].
    pub(super) speeds: Vec<f64>,
    /// Of all bodies [J].
    pub(super) energy: f64,
}

impl Frame {
    pub(super) fn is_finite(&self) -> bool {
        self.energy.is_finite()
            && self.poses.iter().all(|(centre, rotation)| centre.is_finite() && rotation.is_finite())
    }

    /// The distance of a body's centres [widths] and the angle of its rotations [rad] in two frames.
    pub(super) fn apart(&self, other: &Frame, body: usize, width: f64) -> [f64; 2] {
        let ((centre, rotation), (own, turned)) = (&self.poses[body], &other.poses[body]);
        let between = turned.conjugate() * *rotation;
        let angle = 2.0 * libm::atan2(between.xyz().length(), between.w.abs());
        [(*centre - *own).length() / width, angle]
    }
}

/// Runs the scene without measuring errors, and returns the time that a simulated sixtieth of a second took
/// [us]: processor time of the thread if the system provides it, else wall time.
///
/// # Errors
/// If the world refuses the settings or the scene, or the rate is no multiple of the frame rate.
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
