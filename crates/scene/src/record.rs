//! Poses of moving bodies over time.

use super::Scene;
use backstop::BodyKind;
use glam::{DVec3, Quat};

/// Collects the pose of each body that can move, frame by frame; `write_animation` makes a film of it.
#[derive(Clone, Debug)]
pub struct Recorder {
    bodies: Vec<usize>,
    times: Vec<f32>,
    /// Frame by frame, in the order of `bodies`.
    poses: Vec<(DVec3, Quat)>,
}

impl Recorder {
    /// For all bodies of the scene that are not static.
    pub fn new(scene: &Scene) -> Self {
        let moving = |i: &usize| scene.bodies[*i].desc.kind != BodyKind::Static;
        Recorder {
            bodies: (0..scene.bodies.len()).filter(moving).collect(),
            times: Vec::new(),
            poses: Vec::new(),
        }
    }

    /// Adds a frame at `time` [s]; `pose` gives position and rotation of a body by its index in the scene. A
    /// frame that is not later than the last one is left out.
    pub fn record(&mut self, time: f32, mut pose: impl FnMut(usize) -> (DVec3, Quat)) {
        if self.times.last().is_some_and(|&last| time <= last) || !time.is_finite() {
            return;
        }
        self.times.push(time);
        for slot in 0..self.bodies.len() {
            let (position, mut rotation) = pose(self.bodies[slot]);
            // q and -q are one rotation, but a viewer interpolates the numbers: stay on one side.
            if self.times.len() > 1 && rotation.dot(self.poses[self.poses.len() - self.bodies.len()].1) < 0.0
            {
                rotation = -rotation;
            }
            self.poses.push((position, rotation));
        }
    }

    /// The bodies it follows, as indices in the scene.
    pub fn bodies(&self) -> &[usize] {
        &self.bodies
    }

    /// Time of each frame [s].
    pub fn times(&self) -> &[f32] {
        &self.times
    }

    /// Poses of `bodies()[slot]` over time.
    #[cfg(any(feature = "gltf", test))]
    pub(crate) fn track(&self, slot: usize) -> impl Iterator<Item = (DVec3, Quat)> + '_ {
        self.poses.iter().skip(slot).step_by(self.bodies.len().max(1)).copied()
    }

    /// Pose of `bodies()[slot]` in one frame.
    #[cfg(feature = "gltf")]
    pub(crate) fn pose(&self, slot: usize, frame: usize) -> (DVec3, Quat) {
        self.poses[frame * self.bodies.len() + slot]
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use backstop::BodyDesc;

    #[test]
    fn static_bodies_are_not_recorded_and_rotations_stay_on_one_side() {
        let mut scene = Scene::new("two");
        scene.add("floor", BodyDesc::fixed());
        let ball = scene.add("ball", BodyDesc::dynamic());
        let mut recorder = Recorder::new(&scene);
        assert_eq!(recorder.bodies(), [ball]);
        recorder.record(0.0, |_| (DVec3::ZERO, Quat::IDENTITY));
        recorder.record(0.1, |_| (DVec3::X, -Quat::IDENTITY));
        recorder.record(0.1, |_| (DVec3::Y, Quat::IDENTITY));
        let track: Vec<_> = recorder.track(0).collect();
        assert_eq!(track, [(DVec3::ZERO, Quat::IDENTITY), (DVec3::X, Quat::IDENTITY)]);
    }
}
