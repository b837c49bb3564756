//! Bodies that lie on a slope, slide over seams, and ride on platforms.

use super::super::conditions::Conditions;
use super::super::measures::{Gauge, Measure};
use super::setup::{Drive, Setup, about_z, weight};
use backstop::{BodyDesc, BodyKind, Geometry};
use backstop_scene::Scene;
use backstop_scene::builtin::{dynamic, fixed};
use glam::Vec3;
use std::f64::consts::TAU;

/// Speed of a body is kept to 2 %.
fn kept(body: usize) -> Gauge {
    Gauge { measure: Measure::Speed { body }, bounds: [0.02, 0.3] }
}

fn frictionless(mut body: BodyDesc) -> BodyDesc {
    body.shapes.iter_mut().for_each(|shape| shape.material = shape.material.with_friction(0.0));
    body
}

/// A slab on a slope whose tangent is 0.9 of the friction, but at most 3: it stays. Without friction the
/// slope is level, and the slab slides on.
pub(super) fn slope(c: &Conditions) -> Setup {
    const THICK: f32 = 0.05;
    let mut scene = Scene::new("slope");
    let friction = c.friction.unwrap_or(0.6);
    let turn = about_z(-libm::atanf((0.9 * friction).min(3.0)));
    let half = if friction == 0.0 { 100.0 } else { 10.0 } * c.size;
    let slope = fixed(Geometry::cuboid(half, half, half), turn * Vec3::NEG_Y * half);
    scene.add("slope", slope.with_rotation(turn));
    let slab = Geometry::cuboid(0.5 * c.size, THICK * c.size, 0.5 * c.size);
    let mut slab = dynamic(slab, turn * Vec3::Y * (THICK * c.size)).with_rotation(turn);
    if friction == 0.0 {
        slab = slab.with_velocity(Vec3::X * c.size, Vec3::ZERO);
    }
    let slab = scene.add("slab", slab);
    let unit = f64::from(c.size);
    let stays = Gauge { measure: Measure::Moved { unit }, bounds: [0.05, 0.5] };
    let gauges = vec![if friction == 0.0 { kept(slab) } else { stays }];
    Setup { scene, boundaries: Vec::new(), gauges }
}

/// Two lanes of flush boxes: a box slides over one without friction, and a ball rolls over the other. They
/// meet five seams a second or so at any speed.
pub(super) fn tiles(c: &Conditions) -> Setup {
    const TILES: usize = 320;
    let mut scene = Scene::new("tiles");
    let speed = c.speed.unwrap_or(5.0) * c.size;
    let half = 0.5 * (66.0 * speed + 20.0 * c.size) / TILES as f32;
    let extents = Vec3::new(half, 0.5 * c.size, 2.0 * c.size);
    for i in 0..TILES {
        for side in [-1.0, 1.0] {
            let at = Vec3::new((2 * i + 1) as f32 * half - 10.0 * c.size, -extents.y, side * extents.z);
            let tile = fixed(Geometry::Box { half_extents: extents }, at);
            scene.add("tile", if side < 0.0 { frictionless(tile) } else { tile });
        }
    }
    let radius = 0.5 * c.size;
    let along = Vec3::X * speed;
    let at = Vec3::new(0.0, radius, -extents.z);
    let cube = dynamic(Geometry::cuboid(radius, radius, radius), at).with_velocity(along, Vec3::ZERO);
    let cube = scene.add("box", frictionless(cube));
    let ball = dynamic(Geometry::Sphere { radius }, at * Vec3::new(1.0, 1.0, -1.0));
    let ball = scene.add("ball", ball.with_velocity(along, Vec3::NEG_Z * (speed / radius)));
    let aside = Gauge { measure: Measure::Aside { unit: f64::from(c.size) }, bounds: [0.02, 0.5] };
    Setup { scene, boundaries: Vec::new(), gauges: vec![kept(cube), kept(ball), aside] }
}

/// How a platform moves: up and down, to and fro, or round and round; each carries two boxes, the upper of
/// which is the heavy one.
pub(super) fn platforms(c: &Conditions) -> Setup {
    let mut scene = Scene::new("platforms");
    let (thick, half) = (0.25 * c.size, 0.4 * c.size);
    let at = |i: usize| Vec3::X * (i as f32 * 10.0 * c.size);
    for i in 0..3 {
        let mut body = fixed(Geometry::cuboid(3.0 * c.size, thick, 3.0 * c.size), at(i));
        body.kind = BodyKind::Kinematic;
        scene.add("platform", body);
    }
    for Drive { body, linear, angular } in platform_drives(c, 0.0) {
        let desc = &mut scene.bodies[body].desc;
        (desc.linear_velocity, desc.angular_velocity) = (linear, angular);
    }
    let mut pairs = Vec::new();
    for on in 0..3 {
        let BodyDesc { linear_velocity, angular_velocity, .. } = scene.bodies[on].desc;
        for storey in 0..2 {
            let arm = Vec3::new(2.0 * c.size, thick + half * (1 + 2 * storey) as f32, 0.0);
            let mut body = dynamic(Geometry::cuboid(half, half, half), at(on) + arm)
                .with_velocity(linear_velocity + angular_velocity.cross(arm), angular_velocity);
            weight(&mut body, if storey == 1 { c.mass_ratio } else { 1.0 });
            pairs.push([scene.add("box", body), on]);
        }
    }
    let unit = f64::from(c.size);
    let gauges = vec![Gauge { measure: Measure::Carried { unit, pairs }, bounds: [0.05, 0.5] }];
    Setup { scene, boundaries: Vec::new(), gauges }
}

/// Velocities of the platforms at a time [s]: a period of four seconds, and never more than a fifth of
/// gravity.
pub(super) fn platform_drives(c: &Conditions, time: f64) -> Vec<Drive> {
    let omega = TAU / 4.0;
    let most = 0.2 * 9.81 * f64::from(c.gravity);
    let way = f64::from(c.size).min(most / (omega * omega));
    let speed = (way * omega * libm::cos(omega * time)) as f32;
    let turning = libm::sqrt(most / f64::from(2.0 * c.size)).min(0.5) as f32;
    [(Vec3::Y * speed, Vec3::ZERO), (Vec3::Z * speed, Vec3::ZERO), (Vec3::ZERO, Vec3::Y * turning)]
        .into_iter()
        .enumerate()
        .map(|(body, (linear, angular))| Drive { body, linear, angular })
        .collect()
}
