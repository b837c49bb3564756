//! The scenes that methods of continuous collision are compared on, beside
//! [`talk`](super::talk).
//!
//! Each is short: from the free flight to a few frames after the first impacts, so that all methods still
//! face the same situation and earlier differences do not matter. Steps are of 1/60 s.

use super::{dynamic, fixed};
use crate::joined::throw;
use crate::{Rng, Scene, axis_angle};
use backstop::BodyDesc;
use backstop::Geometry;
use backstop::Skeleton;
use glam::{DVec3, Vec3};
use std::f32::consts::{PI, TAU};

/// The step that all of them are made for [s].
pub const DT: f32 = 1.0 / 60.0;

fn bouncy(mut desc: BodyDesc, restitution: f32) -> BodyDesc {
    desc.shapes.iter_mut().for_each(|shape| shape.material.restitution = restitution);
    desc
}

/// Sixty bodies of 12 to 20 cm thrown at 60 to 300 m/s through eight rows of posts, which are 4 cm thick and
/// 30 cm apart.
pub fn posts() -> Scene {
    let mut scene = Scene::new("posts");
    scene.steps = 30;
    let mut rng = Rng::new(21);
    for row in 0..8 {
        for i in -20..=20 {
            let z = 0.3 * i as f32 + if row % 2 == 0 { 0.0 } else { 0.15 };
            let post = Geometry::cylinder(1.5, 0.02);
            scene.add("post", fixed(post, Vec3::new(0.7 * row as f32, 1.5, z)));
        }
    }
    for i in 0..60 {
        let shape = match i % 3 {
            0 => Geometry::Sphere { radius: rng.range(0.06, 0.1) },
            1 => Geometry::capsule(0.08, 0.06),
            _ => Geometry::cuboid(0.06, 0.08, 0.07),
        };
        let at = Vec3::new(-rng.range(2.0, 8.0), 0.3 + 0.24 * (i % 10) as f32, 0.9 * (i / 10) as f32 - 2.4);
        let way = Vec3::new(1.0, 0.0, rng.range(-0.1, 0.1));
        let velocity = way * rng.range(60.0, 300.0);
        let spin = rng.direction() * rng.range(0.0, 20.0);
        let body = dynamic(shape, at).with_rotation(rng.rotation()).with_velocity(velocity, spin);
        scene.add("thrown", bouncy(body, 0.3));
    }
    scene
}

/// How often the blades of [`blades`] turn in a second.
pub const TURNS: [f32; 16] =
    [1.0, 2.0, 3.0, 5.0, 7.0, 10.0, 15.0, 20.0, 30.0, 50.0, 70.0, 100.0, 130.0, 150.0, 180.0, 200.0];
/// Where the post stands on a blade's circle [m], its radius and half the blade's thickness.
const POST: [f32; 3] = [0.8, 0.02, 0.005];

/// Sixteen blades of 2 m by 1 cm that spin about their middle at 1 to 200 turns a second, each with a post in
/// its way, in zero gravity.
pub fn blades() -> Scene {
    let mut scene = Scene::new("blades");
    (scene.gravity, scene.steps) = (Vec3::ZERO, 40);
    for (i, (turns, angle)) in TURNS.into_iter().zip(post_angles()).enumerate() {
        let centre = Vec3::new(4.0 * (i % 4) as f32, 0.0, 4.0 * (i / 4) as f32);
        let towards = Vec3::new(libm::cosf(angle), 0.0, -libm::sinf(angle));
        scene.add("post", fixed(Geometry::cylinder(0.5, POST[1]), centre + towards * POST[0]));
        let blade = dynamic(Geometry::cuboid(1.0, 0.05, POST[2]), centre);
        scene.add("blade", bouncy(blade.with_velocity(Vec3::ZERO, Vec3::Y * (turns * TAU)), 0.3));
    }
    scene
}

/// How far each blade of [`blades`] is from its post at the start [rad].
fn post_angles() -> impl Iterator<Item = f32> {
    let mut rng = Rng::new(22);
    std::iter::repeat_with(move || rng.range(0.3, PI - 0.3))
}

/// When each blade of [`blades`] strikes its post [s]: the flat side meets the round post where the post's
/// axis is the two radii in front of it.
pub fn blade_times() -> [f32; TURNS.len()] {
    let ahead = libm::asinf((POST[1] + POST[2]) / POST[0]);
    let mut angles = post_angles();
    TURNS.map(|turns| (angles.next().unwrap_or(PI) - ahead) / (turns * TAU))
}

/// Thirty-two balls at 100 to 250 m/s, each flying at a static ball that deflects it onto a wall of 1 cm: for
/// every other ball the wall is beside its path, where it would never have come undeflected.
pub fn deflector() -> Scene {
    let mut scene = Scene::new("deflector");
    (scene.gravity, scene.steps) = (Vec3::ZERO, 12);
    let mut rng = Rng::new(23);
    for i in 0..32 {
        let centre = Vec3::new(0.0, 8.0 * (i % 8) as f32, 8.0 * (i / 8) as f32);
        scene.add("deflector", fixed(Geometry::Sphere { radius: 0.15 }, centre));
        let wall = if i % 2 == 0 {
            fixed(Geometry::cuboid(0.005, 3.5, 3.5), centre + Vec3::X * rng.range(0.5, 1.0))
        } else {
            fixed(Geometry::cuboid(3.5, 0.005, 3.5), centre + Vec3::Y * rng.range(0.5, 0.8))
        };
        scene.add("wall", wall);
        let speed = rng.range(100.0, 250.0);
        let aside = rng.range(0.1, 0.2);
        let at = centre + Vec3::new(-rng.range(3.0, 8.0), aside, 0.0);
        let body = dynamic(Geometry::Sphere { radius: 0.1 }, at).with_velocity(Vec3::X * speed, Vec3::ZERO);
        scene.add("ball", bouncy(body, 0.2));
    }
    scene
}

/// Twelve groups of two to six bodies of 20 to 30 cm that fly at each other at 50 to 200 m/s and meet within
/// one step, in zero gravity.
pub fn head_on() -> Scene {
    let mut scene = Scene::new("head_on");
    (scene.gravity, scene.steps) = (Vec3::ZERO, 12);
    let mut rng = Rng::new(24);
    for group in 0..12 {
        let centre = Vec3::new(60.0 * (group % 4) as f32, 0.0, 60.0 * (group / 4) as f32);
        let count = 2 + group % 5;
        // Somewhere within the sixth step.
        let time = (5.0 + rng.range(0.2, 0.8)) * DT;
        let first = rng.range(0.0, TAU);
        for i in 0..count {
            let shape = match (group + i) % 3 {
                0 => Geometry::Sphere { radius: 0.1 },
                1 => Geometry::capsule(0.08, 0.07),
                _ => Geometry::cuboid(0.1, 0.08, 0.12),
            };
            let turn = axis_angle(Vec3::Y, first + TAU * i as f32 / count as f32);
            let out = turn * Vec3::new(1.0, rng.range(-0.05, 0.05), 0.0);
            let speed = rng.range(50.0, 200.0);
            let spin = rng.direction() * rng.range(0.0, 20.0);
            let body = dynamic(shape, centre + out * (speed * time)).with_rotation(rng.rotation());
            scene.add("body", bouncy(body.with_velocity(-out * speed, spin), 0.3));
        }
    }
    scene
}

/// Where the wall of [`ragdoll_wall`] is, in front of which everything has to stay.
pub const RAGDOLL_WALL: f32 = 0.0;

/// Six figures thrown at 30 to 60 m/s at a wall of 1 cm.
pub fn ragdoll_wall() -> Scene {
    let mut scene = Scene::new("ragdoll_wall");
    (scene.gravity, scene.steps) = (Vec3::ZERO, 24);
    let wall = Geometry::cuboid(0.005, 20.0, 20.0);
    scene.add("wall", fixed(wall, Vec3::new(RAGDOLL_WALL + 0.005, 0.0, 0.0)));
    let mut rng = Rng::new(25);
    let mut figure = Skeleton::humanoid();
    figure.friction = 1.0;
    for i in 0..6 {
        let at = DVec3::new(
            -f64::from(rng.range(3.0, 6.0)),
            5.0 * f64::from(i % 2) - 2.5,
            5.0 * f64::from(i / 2) - 5.0,
        );
        let velocity = Vec3::new(rng.range(30.0, 60.0), rng.range(-5.0, 5.0), rng.range(-5.0, 5.0));
        throw(&mut scene, &figure, (at, rng.rotation()), velocity);
    }
    scene
}
