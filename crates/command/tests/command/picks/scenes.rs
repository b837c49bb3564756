//! Scenes that nothing was tuned for, drawn from a seed.
use super::machines::FAMILIES;
use backstop::glam::{DVec3, Quat, Vec3};
use backstop::math;
use backstop::{BodyDesc, ConvexHull, Geometry, JointDesc, ShapeDesc, Skeleton};
use backstop_scene::{Rng, Scene, axis_angle, join, throw};
use std::f32::consts::PI;

/// All of them, by what a person would watch in each.
pub(super) fn all(seed: u64) -> Vec<Scene> {
    let scenes: [fn(&mut Rng) -> Scene; 12] =
        [dominoes, bullet, struck_pyramid, chain, stairs, bridge, car, heap, arch, gyroscope, drum, top];
    scenes.iter().chain(&FAMILIES).map(|scene| scene(&mut Rng::new(seed))).collect()
}

pub(super) fn fixed(geometry: Geometry, at: DVec3) -> BodyDesc {
    BodyDesc::fixed().with_position(at).with_shape(ShapeDesc::new(geometry))
}

pub(super) fn dynamic(geometry: Geometry, at: DVec3) -> BodyDesc {
    BodyDesc::dynamic().with_position(at).with_shape(ShapeDesc::new(geometry))
}

pub(super) fn heavy(geometry: Geometry, at: DVec3, density: f32) -> BodyDesc {
    BodyDesc::dynamic().with_position(at).with_shape(ShapeDesc::new(geometry).with_density(density))
}

pub(super) fn ground(name: &str) -> Scene {
    let mut scene = Scene::new(name);
    scene.add("floor", fixed(Geometry::cuboid(30.0, 1.0, 30.0), DVec3::NEG_Y));
    scene
}

pub(super) fn pin(scene: &mut Scene, bodies: [usize; 2], point: DVec3) {
    join(scene, bodies, point, math::Quat::from(Quat::IDENTITY), JointDesc::ball);
}

pub(super) fn hinge(scene: &mut Scene, bodies: [usize; 2], point: DVec3, axis: Vec3) {
    join(scene, bodies, point, Quat::from_rotation_arc(Vec3::X, axis).into(), JointDesc::hinge);
}

/// Ten boxes of 1 m, and a ball of 8 t.
fn struck_pyramid(random: &mut Rng) -> Scene {
    let mut scene = ground("struck_pyramid");
    for row in 0..4 {
        for i in 0..4 - row {
            let at = DVec3::new(1.02 * (f64::from(i) + 0.5 * f64::from(row)), 0.5 + f64::from(row), 0.0);
            scene.add("box", dynamic(Geometry::cuboid(0.5, 0.5, 0.5), at));
        }
    }
    let at = DVec3::new(-5.0, 1.2, f64::from(random.range(-0.2, 0.2)));
    let ball = heavy(Geometry::sphere(1.0), at, 8000.0 / (4.0 / 3.0 * PI));
    scene.add("ball", ball.with_velocity(Vec3::X * random.range(9.0, 11.0), Vec3::ZERO));
    scene
}

fn stairs(random: &mut Rng) -> Scene {
    let mut scene = ground("stairs");
    for i in 0..8 {
        let height = 0.1 * f64::from(8 - i);
        let step = Geometry::cuboid(0.15, height as f32, 1.5);
        scene.add("step", fixed(step, DVec3::new(0.3 * f64::from(i), height, 0.0)));
    }
    let figure = Skeleton::humanoid().with_friction(3.0);
    let turn = axis_angle(Vec3::Z, random.range(-0.6, -0.3));
    throw(&mut scene, &figure, (DVec3::new(-0.1, 2.8, 0.0), turn), Vec3::new(2.0, 0.0, 0.2));
    scene
}

/// Planks between two banks, and a crate that falls on them.
fn bridge(random: &mut Rng) -> Scene {
    let mut scene = ground("bridge");
    let left = scene.add("bank", fixed(Geometry::cuboid(1.0, 1.0, 1.0), DVec3::new(-1.0, 1.0, 0.0)));
    let right = scene.add("bank", fixed(Geometry::cuboid(1.0, 1.0, 1.0), DVec3::new(5.0, 1.0, 0.0)));
    let mut last = left;
    for i in 0..10 {
        let at = DVec3::new(0.2 + 0.4 * f64::from(i), 1.95, 0.0);
        let plank = scene.add("plank", heavy(Geometry::cuboid(0.18, 0.04, 0.6), at, 500.0));
        for z in [-0.5, 0.5] {
            pin(&mut scene, [last, plank], DVec3::new(0.4 * f64::from(i), 1.95, z));
        }
        last = plank;
    }
    for z in [-0.5, 0.5] {
        pin(&mut scene, [last, right], DVec3::new(4.0, 1.95, z));
    }
    let at = DVec3::new(f64::from(random.range(1.7, 2.3)), 3.2, f64::from(random.range(-0.1, 0.1)));
    scene.add("crate", heavy(Geometry::cuboid(0.3, 0.3, 0.3), at, 300.0));
    scene
}

/// A chassis on four wheels that rolls over two sills.
fn car(random: &mut Rng) -> Scene {
    let mut scene = ground("car");
    let speed = Vec3::X * random.range(4.0, 5.0);
    let body = heavy(Geometry::cuboid(1.0, 0.2, 0.5), DVec3::Y * 0.6, 300.0);
    let body = scene.add("chassis", body.with_velocity(speed, Vec3::ZERO));
    for (x, z) in [(-0.7, -0.7), (-0.7, 0.7), (0.7, -0.7), (0.7, 0.7)] {
        let at = DVec3::new(x, 0.3, z);
        let wheel = heavy(Geometry::sphere(0.3), at, 200.0);
        let wheel = scene.add("wheel", wheel.with_velocity(speed, Vec3::NEG_Z * (speed.x / 0.3)));
        hinge(&mut scene, [body, wheel], at, Vec3::Z);
    }
    for x in [3.0, 4.3] {
        scene.add("sill", fixed(Geometry::cuboid(0.15, 0.05, 2.0), DVec3::new(x, 0.05, 0.0)));
    }
    scene
}

fn heap(random: &mut Rng) -> Scene {
    let mut scene = ground("heap");
    for i in 0..24 {
        let size = random.range(0.15, 0.3);
        let geometry = match i % 3 {
            0 => Geometry::sphere(size),
            1 => Geometry::cuboid(size, 0.7 * size, 1.2 * size),
            _ => Geometry::capsule(size, 0.6 * size),
        };
        let at = DVec3::new(
            f64::from(random.range(-0.6, 0.6)),
            0.7 + 0.45 * f64::from(i),
            f64::from(random.range(-0.6, 0.6)),
        );
        scene.add("piece", dynamic(geometry, at).with_rotation(random.rotation()));
    }
    scene
}

fn dominoes(random: &mut Rng) -> Scene {
    let mut scene = ground("dominoes");
    for i in 0..12 {
        let at = DVec3::new(0.28 * f64::from(i), 0.3, 0.0);
        scene.add("stone", dynamic(Geometry::cuboid(0.05, 0.3, 0.15), at));
    }
    let ball = dynamic(Geometry::sphere(0.15), DVec3::new(-0.5, 0.45, 0.0));
    scene.add("ball", ball.with_velocity(Vec3::X * random.range(1.8, 2.4), Vec3::ZERO));
    scene
}

/// Eleven stones of a half circle, that stand by themselves.
fn arch(random: &mut Rng) -> Scene {
    let mut scene = ground("arch");
    let (inner, outer) = (1.5, 1.5 + random.range(0.5, 0.7));
    let half = PI / 22.0;
    for i in 0..11 {
        let middle = (2.0 * i as f32 + 1.0) * half;
        let at = Vec3::new(cosine(middle), sine(middle), 0.0) * (0.5 * (inner + outer));
        let mut points = Vec::new();
        for angle in [middle - half, middle + half] {
            for radius in [inner, outer] {
                for z in [-0.4, 0.4] {
                    points.push(Vec3::new(cosine(angle) * radius, sine(angle) * radius, z) - at);
                }
            }
        }
        let stone = Geometry::hull(ConvexHull::new(&points).expect("a wedge"));
        scene.add("stone", dynamic(stone, at.as_dvec3()));
    }
    scene
}

fn cosine(angle: f32) -> f32 {
    (axis_angle(Vec3::Z, angle) * Vec3::X).x
}

fn sine(angle: f32) -> f32 {
    (axis_angle(Vec3::Z, angle) * Vec3::X).y
}

fn bullet(random: &mut Rng) -> Scene {
    let mut scene = ground("bullet");
    scene.add("wall", fixed(Geometry::cuboid(0.01, 1.5, 1.5), DVec3::new(3.0, 1.5, 0.0)));
    let at = DVec3::new(0.0, 1.5, f64::from(random.range(-0.5, 0.5)));
    let ball = heavy(Geometry::sphere(0.05), at, 5000.0);
    scene.add("bullet", ball.with_velocity(Vec3::X * random.range(100.0, 200.0), Vec3::ZERO));
    scene
}

/// Ten links, and a weight that is a hundred times as heavy as one of them.
fn chain(random: &mut Rng) -> Scene {
    let mut scene = Scene::new("chain");
    let mut last = scene.add("anchor", BodyDesc::fixed());
    for i in 0..10 {
        let link = dynamic(Geometry::cuboid(0.1, 0.03, 0.03), DVec3::X * (0.1 + 0.2 * f64::from(i)));
        let link = scene.add("link", link);
        pin(&mut scene, [last, link], DVec3::X * (0.2 * f64::from(i)));
        last = link;
    }
    let weight = heavy(Geometry::cuboid(0.2, 0.2, 0.2), DVec3::X * 2.2, random.range(1000.0, 1300.0));
    let weight = scene.add("weight", weight);
    pin(&mut scene, [last, weight], DVec3::X * 2.0);
    scene
}

/// A wheel on a pivot at one end of its axle.
fn gyroscope(random: &mut Rng) -> Scene {
    let mut scene = Scene::new("gyroscope");
    let pivot = scene.add("pivot", BodyDesc::fixed());
    let wheel = dynamic(Geometry::cuboid(0.03, 0.25, 0.25), DVec3::X * 0.3);
    let wheel = wheel.with_velocity(Vec3::ZERO, Vec3::X * random.range(50.0, 70.0));
    let wheel = scene.add("wheel", wheel);
    pin(&mut scene, [pivot, wheel], DVec3::ZERO);
    scene
}

/// A drum of eight walls that turns, and bodies in it.
fn drum(random: &mut Rng) -> Scene {
    let mut scene = Scene::new("drum");
    let mut drum = BodyDesc::kinematic().with_velocity(Vec3::ZERO, Vec3::Z * 1.5);
    for i in 0..8 {
        let turn: Quat = axis_angle(Vec3::Z, 0.25 * PI * i as f32).into();
        let wall = ShapeDesc::new(Geometry::cuboid(0.1, 0.7, 0.8)).with_position(turn * Vec3::X * 1.5);
        drum = drum.with_shape(wall.with_rotation(turn));
    }
    for z in [-0.9, 0.9] {
        let lid = Geometry::cuboid(1.6, 1.6, 0.1);
        drum = drum.with_shape(ShapeDesc::new(lid).with_position(Vec3::Z * z));
    }
    scene.add("drum", drum);
    for i in 0..12 {
        let size = random.range(0.12, 0.2);
        let geometry = if i % 2 == 0 { Geometry::sphere(size) } else { Geometry::cuboid(size, size, size) };
        let at = DVec3::new(
            0.5 * f64::from(i % 3 - 1) + f64::from(random.range(-0.04, 0.04)),
            0.5 * f64::from(i / 6) - 0.5,
            0.5 * f64::from(i / 3 % 2) - 0.25,
        );
        scene.add("piece", dynamic(geometry, at));
    }
    scene
}

/// A box that spins on a peg below it.
fn top(random: &mut Rng) -> Scene {
    let mut scene = ground("top");
    let disc = ShapeDesc::new(Geometry::cuboid(0.3, 0.05, 0.3));
    let peg = ShapeDesc::new(Geometry::sphere(0.05)).with_position(Vec3::NEG_Y * 0.2);
    let body = BodyDesc::dynamic().with_position(DVec3::Y * 0.25).with_shape(disc).with_shape(peg);
    let tilt = axis_angle(Vec3::Z, random.range(0.05, 0.1));
    scene.add("top", body.with_rotation(tilt).with_velocity(Vec3::ZERO, Vec3::Y * 40.0));
    scene
}
