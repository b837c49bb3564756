//! A run of the reference.

use super::Cell;
use super::run::{Frame, Run, Span, pace, width};
use crate::LabWorld;
use backstop::Error;
use backstop_scene::{Rng, Scene};
use glam::Vec3;

/// How much the velocities of a perturbed run differ at the start, by the [`pace`] of each body: too little
/// to see, and enough for chaos to grow from.
const PERTURBATION: f64 = 1e-4;

/// Where the bodies of a scene are, frame by frame.
#[derive(Clone, Debug)]
pub struct Track {
    pub(super) span: Span,
    /// The start, then all frames.
    pub(super) frames: Vec<Frame>,
    pub(super) widths: Vec<f64>,
    /// [`pace`] of each body [m/s].
    pub(super) paces: Vec<f64>,
    /// The energy that differences are relative to [J].
    pub(super) scale: f64,
    /// Direction of gravity, upwards.
    pub(super) up: Vec3,
    /// Deepest overlap as a share of the thinner body, for an instant and for longer, and greatest error of a
    /// joint as a share of the narrowest body with joints, in the last step of each frame.
    pub(super) flaws: [f64; 3],
    hash: u64,
}

impl Track {
    /// How many runs a reference is made of.
    pub const MEMBERS: usize = 5;

    /// One of the runs that a reference of `hz` steps per second is made of: the finest, one of half its
    /// resolution, and others of that resolution whose bodies start with slightly other velocities.
    /// Sleeping is off: a slow body that fell asleep would count as exact.
    ///
    /// # Errors
    /// If the world refuses the scene, or half of `hz` is no multiple of the frame rate.
    pub fn member(scene: &Scene, span: Span, hz: u32, member: usize) -> Result<Track, Error> {
        let hz = if member == 0 { hz } else { hz / 2 };
        let cell = Cell::reference(hz);
        let mut run = Run::start(scene, (&cell.settings(scene), None), hz, span)?;
        let states = run.states()?;
        let gravity = f64::from(scene.gravity.length());
        let widths: Vec<f64> = states.iter().map(width).collect();
        let paces: Vec<f64> = widths.iter().map(|&width| pace(gravity, width)).collect();
        if member > 1 {
            let mut random = Rng::new(member as u64);
            for (&body, pace) in run.dynamic.iter().zip(&paces) {
                let linear = run.world.linear_velocity(body)?;
                let more = random.direction() * (PERTURBATION * pace) as f32;
                run.world.set_linear_velocity(body, linear + more)?;
            }
        }
        let joined = run.narrowest_joined(&widths)?;
        let kinetic = |run: &Run| -> Result<f64, Error> {
            Ok(run.states()?.iter().map(backstop::observe::BodyState::kinetic_energy).sum())
        };
        let (mut most, mut flaws) = (kinetic(&run)?, [0.0_f64; 3]);
        let mut overlaps = Vec::new();
        let mut frames = vec![run.frame(&widths)?];
        for _ in 0..span.frames {
            for step in 1..=run.steps_per_frame {
                // Measured in one of these runs, and once in a frame: it takes longer than the step.
                run.world.measure_accuracy(member == 1 && step == run.steps_per_frame);
                run.world.step(run.dt)?;
            }
            if let Some(accuracy) = run.world.accuracy() {
                overlaps.push(accuracy.whole.penetration_share);
                flaws[2] = flaws[2].max(accuracy.whole.joint_length / joined);
            }
            most = most.max(kinetic(&run)?);
            frames.push(run.frame(&widths)?);
        }
        let overlaps = beyond_start(&overlaps);
        flaws[0] = lasting(&overlaps, 1);
        flaws[1] = lasting(&overlaps, window(span.frame_rate));
        // If nothing moves, the energy that would lift every body by its width.
        let lift: f64 = states.iter().zip(&widths).map(|(body, width)| body.mass * gravity * width).sum();
        let scale = most.max(lift).max(f64::MIN_POSITIVE);
        let up = (-scene.gravity).try_normalize().unwrap_or(Vec3::Y);
        Ok(Track { span, frames, widths, paces, scale, up, flaws, hash: run.world.state_hash() })
    }

    /// Hash of all poses and velocities at the end. It differs if any bit differs, so it tells versions of
    /// scene and engine apart.
    pub fn hash(&self) -> u64 {
        self.hash
    }

    /// From when on each body moves: the first frame in which it is a hundredth of its width or of a radian
    /// from its start.
    pub(super) fn first_moves(&self) -> Vec<usize> {
        let moved = |body: usize, frame: &Frame| {
            frame.apart(&self.frames[0], body, self.widths[body]).iter().any(|&apart| apart > MOVED)
        };
        let first = |body| self.frames.iter().position(|frame| moved(body, frame));
        (0..self.widths.len()).map(|body| first(body).unwrap_or(self.frames.len())).collect()
    }

    /// The mean speed of a body in the last frames, by its [`pace`].
    pub(super) fn end_speed(&self, body: usize) -> f64 {
        let tail = self.span.tail();
        let sum: f64 = self.frames[1..][tail.clone()].iter().map(|frame| frame.speeds[body]).sum();
        sum / tail.len() as f64 / self.paces[body]
    }
}

/// How far a body moved once it counts as moving [widths] or [rad].
const MOVED: f64 = 0.01;

/// The greatest rise of a quantity from any earlier time.
pub(super) fn rise(values: impl Iterator<Item = f64>) -> f64 {
    let (mut least, mut most) = (f64::INFINITY, 0.0_f64);
    for value in values {
        least = least.min(value);
        most = most.max(value - least);
    }
    most
}

/// Overlaps by what they exceed the least so far: bodies that the scene starts with in each other are no
/// fault of a setting, for as long as they get no deeper.
pub(super) fn beyond_start(values: &[f64]) -> Vec<f64> {
    let mut least = f64::INFINITY;
    let beyond = |&value: &f64| {
        least = least.min(value);
        value - least
    };
    values.iter().map(beyond).collect()
}

/// The greatest value that so many steps in sequence reach or exceed.
pub(super) fn lasting(values: &[f64], steps: usize) -> f64 {
    let least = |window: &[f64]| window.iter().copied().fold(f64::INFINITY, f64::min);
    values.windows(steps).map(least).fold(0.0, f64::max)
}

/// Steps of the time after which an overlap lasts, a tenth of a second.
pub(super) fn window(hz: u32) -> usize {
    (hz / 10).max(1) as usize + 1
}

#[cfg(test)]
mod tests {
    use super::*;

    /// By hand: the scene starts with 2, which shrink as bodies part; an impact of 1.5 comes when 0.5 are
    /// left, and one of 0.75 when none are.
    #[test]
    fn overlaps_of_the_start_do_not_count() {
        let found = beyond_start(&[2.0, 2.0, 1.0, 0.5, 1.5, 0.5, 0.0, 0.75]);
        assert_eq!(found, [0.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.75]);
        assert_eq!(beyond_start(&[0.0, 3.0, 1.0]), [0.0, 3.0, 1.0]);
    }

    #[test]
    fn what_lasts_is_the_least_of_a_window() {
        let values = [0.0, 3.0, 1.0, 2.0, 0.0];
        assert_eq!([1, 2, 3, 4].map(|steps| lasting(&values, steps)), [3.0, 1.0, 1.0, 0.0]);
        assert_eq!(rise(values.into_iter()), 3.0);
    }
}
