//! The poses of a run, compact enough for a page.

use backstop::glam::{DVec3, Quat, Vec3};
use backstop::{BodyHandle, BodyKind, World};
use backstop_scene::Scene;

/// Bytes of all poses, at most: more would make a page that browsers are slow to open.
const MAX_BYTES: usize = 12 << 20;
/// Bytes of a pose: a position in `f32`, a rotation in `i16`, whether the body is asleep.
const POSE_BYTES: usize = 3 * 4 + 4 * 2 + 1;
/// Further from the world's origin than this a film has an origin of its own, so that `f32` suffices [m].
const NEAR: f64 = 1000.0;

/// Poses of all bodies that can move, frame by frame. Where they would be too many, only every second, fourth
/// and so on is kept.
#[derive(Debug)]
pub(crate) struct Motion {
    /// Indices in the scene.
    pub(crate) bodies: Vec<usize>,
    /// Positions are relative to this [m].
    pub(crate) origin: DVec3,
    pub(crate) positions: Vec<[f32; 3]>,
    /// In units of 1/32767.
    pub(crate) rotations: Vec<[i16; 4]>,
    pub(crate) asleep: Vec<bool>,
    /// Time between frames [s].
    pub(crate) interval: f32,
    max_bytes: usize,
    /// One of so many frames is kept.
    stride: f32,
}

impl Motion {
    /// For a run that will show a frame every `interval` seconds.
    pub(crate) fn new(scene: &Scene, interval: f32) -> Motion {
        let moving = |i: &usize| scene.bodies[*i].desc.kind != BodyKind::Static;
        let bodies: Vec<usize> = (0..scene.bodies.len()).filter(moving).collect();
        let sum: DVec3 = bodies.iter().map(|&i| scene.bodies[i].desc.position).sum();
        let middle = sum / bodies.len().max(1) as f64;
        Motion {
            origin: if middle.length() > NEAR { middle.round() } else { DVec3::ZERO },
            bodies,
            positions: Vec::new(),
            rotations: Vec::new(),
            asleep: Vec::new(),
            interval,
            max_bytes: MAX_BYTES,
            stride: 1.0,
        }
    }

    /// Adds the present poses at `time` [s], given the handles of all bodies of the scene. A frame that comes
    /// before its time, as the last of a run may, is left out.
    pub(crate) fn add(&mut self, world: &World, handles: &[BodyHandle], time: f32) {
        let due = self.frames() as f32 * self.interval;
        if time < due - 0.25 * self.interval / self.stride {
            return;
        }
        if self.frames() > 2 && (self.asleep.len() + self.bodies.len()) * POSE_BYTES > self.max_bytes {
            self.thin();
            return self.add(world, handles, time);
        }
        for &i in &self.bodies {
            // Handles are fresh: nothing was removed.
            let position = world.position(handles[i]).unwrap_or_default();
            let rotation = world.rotation(handles[i]).unwrap_or_default();
            self.positions.push((position - self.origin).as_vec3().to_array());
            self.rotations.push(rotation.to_array().map(|x| (x.clamp(-1.0, 1.0) * 32767.0).round() as i16));
            self.asleep.push(world.is_sleeping(handles[i]).unwrap_or(false));
        }
    }

    pub(crate) fn frames(&self) -> usize {
        self.asleep.len().checked_div(self.bodies.len()).unwrap_or(0)
    }

    /// Keeps every second frame.
    fn thin(&mut self) {
        let (frames, count) = (self.frames(), self.bodies.len());
        for (to, from) in (0..frames).step_by(2).enumerate() {
            let from = from * count..(from + 1) * count;
            self.positions.copy_within(from.clone(), to * count);
            self.rotations.copy_within(from.clone(), to * count);
            self.asleep.copy_within(from, to * count);
        }
        let kept = frames.div_ceil(2) * count;
        self.positions.truncate(kept);
        self.rotations.truncate(kept);
        self.asleep.truncate(kept);
        self.stride *= 2.0;
        self.interval *= 2.0;
    }

    /// Whether even its first frames are too much for a page.
    pub(crate) fn is_too_large(&self) -> bool {
        self.asleep.len() * POSE_BYTES > self.max_bytes
    }

    /// A pose of the world in the numbers of a film.
    pub(crate) fn pose(&self, position: DVec3, rotation: Quat) -> [f32; 7] {
        let at: Vec3 = (position - self.origin).as_vec3();
        let [x, y, z, w] = rotation.to_array();
        [at.x, at.y, at.z, x, y, z, w]
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use backstop::{BodyDesc, Geometry, Settings, ShapeDesc};

    #[test]
    fn long_runs_keep_fewer_frames_evenly_spaced() {
        let mut scene = Scene::new("one");
        scene.add("floor", BodyDesc::fixed());
        let far = DVec3::new(5000.25, 0.0, 0.0);
        let ball = ShapeDesc::new(Geometry::Sphere { radius: 0.5 });
        scene.add(
            "ball",
            BodyDesc::dynamic().with_position(far).with_velocity(Vec3::X, Vec3::ZERO).with_shape(ball),
        );
        let mut world = World::new(Settings::default().with_gravity(Vec3::ZERO)).unwrap();
        let handles = scene.add_to(&mut world).unwrap().bodies;
        let mut motion = Motion { max_bytes: 10 * POSE_BYTES, ..Motion::new(&scene, 0.5) };
        assert_eq!((&motion.bodies[..], motion.origin.x), (&[1][..], 5000.0));
        for i in 0..35 {
            motion.add(&world, &handles, 0.5 * i as f32);
            world.step(0.5).unwrap();
        }
        // 35 frames; every fourth of them, from the first, are nine. The ball moves 2 m from one to the next.
        assert_eq!((motion.frames(), motion.interval), (9, 2.0));
        for (i, at) in motion.positions.iter().enumerate() {
            assert!((at[0] - 0.25 - 2.0 * i as f32).abs() < 1e-3, "{i}: {at:?}");
        }
        assert_eq!(motion.rotations[3], [0, 0, 0, 32767]);
    }
}
