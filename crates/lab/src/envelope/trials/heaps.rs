//! Heaps in a closed room.

use super::super::conditions::Conditions;
use super::super::measures::{Gauge, Measure};
use super::moving::{inside, room, shallow};
use super::setup::{Setup, weight};
use backstop::{BodyDesc, Geometry, ShapeDesc};
use backstop_scene::builtin::dynamic;
use backstop_scene::{Rng, Scene};
use glam::{DVec3, Vec3};

/// Bodies are no deeper in each other than a tenth of a length, and come to rest to 2 % of the speed of a
/// fall.
pub(super) fn settles(c: &Conditions, thick: f32) -> Vec<Gauge> {
    let mut gauges = vec![overlap(thick)];
    // Without friction nothing slows them.
    if c.friction != Some(0.0) {
        let unit = f64::from((9.81 * c.gravity * c.size).sqrt());
        gauges.push(Gauge { measure: Measure::Restless { unit }, bounds: [0.02, f64::INFINITY] });
    }
    gauges
}

pub(super) fn overlap(unit: f32) -> Gauge {
    Gauge { measure: Measure::Overlap { unit: f64::from(unit) }, bounds: [0.1, 1.0] }
}

/// Bodies that fall into a heap in a closed room as wide as their number asks for; every other is heavy.
fn heap(c: &Conditions, name: &str, thick: f32, body: impl Fn(usize) -> BodyDesc) -> Setup {
    let mut scene = Scene::new(name);
    let side = libm::cbrtf(c.bodies as f32).ceil() as usize;
    let apart = 1.3;
    let half = 0.5 * apart * (side + 1) as f32 * c.size;
    let boundaries = room(&mut scene, half, 0.5 * c.size);
    let mut rng = Rng::new(13);
    for i in 0..c.bodies {
        let cell = |n: usize| (n as f32 - 0.5 * (side - 1) as f32) * apart;
        let at = Vec3::new(cell(i % side), cell(i / (side * side)), cell(i / side % side)) * c.size;
        let mut desc = body(i).with_position(at).with_rotation(rng.rotation());
        weight(&mut desc, if i % 2 == 0 { c.mass_ratio } else { 1.0 });
        scene.add(name, desc);
    }
    let mut gauges = settles(c, thick);
    gauges.extend([inside(), shallow(thick, 0.1)]);
    Setup { scene, boundaries, gauges }
}

/// Planks, ten times as long as thick.
pub(super) fn planks(c: &Conditions) -> Setup {
    let half = Vec3::new(0.5, 0.05, 0.15) * c.size;
    heap(c, "plank", 2.0 * half.y, |_| dynamic(Geometry::Box { half_extents: half }, Vec3::ZERO))
}

/// Jacks of three bars, tables and dumb-bells.
pub(super) fn compounds(c: &Conditions) -> Setup {
    let at = |geometry: Geometry, at: Vec3| ShapeDesc::new(geometry).with_position(at * c.size);
    let bar = |half: Vec3, place: Vec3| at(Geometry::Box { half_extents: half * c.size }, place);
    let ball = |place: Vec3| at(Geometry::Sphere { radius: 0.2 * c.size }, place);
    let thin = Vec3::splat(0.1);
    heap(c, "compound", 0.2 * c.size, |i| {
        let shapes = match i % 3 {
            0 => [Vec3::X, Vec3::Y, Vec3::Z].map(|axis| bar(thin + axis * 0.4, Vec3::ZERO)).to_vec(),
            1 => vec![
                bar(Vec3::new(0.5, 0.1, 0.3), Vec3::ZERO),
                bar(Vec3::new(0.1, 0.25, 0.3), Vec3::new(-0.4, -0.3, 0.0)),
                bar(Vec3::new(0.1, 0.25, 0.3), Vec3::new(0.4, -0.3, 0.0)),
            ],
            _ => vec![
                bar(Vec3::new(0.4, 0.1, 0.1), Vec3::ZERO),
                ball(Vec3::new(-0.4, 0.0, 0.0)),
                ball(Vec3::new(0.4, 0.0, 0.0)),
            ],
        };
        BodyDesc::dynamic().with_shapes(shapes)
    })
}

/// Balls and boxes in a closed room that overlap by a part of their size at the start; the heavy ones are
/// every other.
pub(super) fn crammed(c: &Conditions) -> Setup {
    let mut scene = Scene::new("crammed");
    let boundaries = room(&mut scene, 4.0 * c.size, 0.5 * c.size);
    let radius = 0.5 * c.size;
    let apart = (1.0 - c.overlap) * 2.0 * radius;
    for i in 0..27 {
        let cell = |n: usize| (n as f32 - 1.0) * apart;
        let at = Vec3::new(cell(i % 3), cell(i / 9), cell(i / 3 % 3)) - Vec3::Y * (2.0 * c.size);
        let shape =
            if i % 2 == 0 { Geometry::Sphere { radius } } else { Geometry::cuboid(radius, radius, radius) };
        let mut body = dynamic(shape, at);
        weight(&mut body, if i % 2 == 0 { c.mass_ratio } else { 1.0 });
        scene.add("body", body);
    }
    // That of a fall from the height of the room is no burst.
    let unit = f64::from((2.0 * 9.81 * c.gravity * 8.0 * c.size).sqrt());
    let fastest = Gauge { measure: Measure::Fastest { unit }, bounds: [1.0, 4.0] };
    let mut gauges = settles(c, radius);
    gauges.extend([fastest, inside(), shallow(radius, 0.05)]);
    Setup { scene, boundaries, gauges }
}

/// A figure is thrown down a flight of stairs.
pub(super) fn stairs(c: &Conditions) -> Setup {
    const STEPS: usize = 12;
    const RISE: f32 = 0.2;
    const TREAD: f32 = 0.3;
    let (mut setup, limb) = (super::jointed::ragdoll(c), 0.1 * c.size);
    let scene = &mut setup.scene;
    let width = 2.0 * c.size;
    // Each reaches down to the floor; the figure starts above the highest.
    for i in 0..STEPS {
        let half = 0.5 * (STEPS - i) as f32 * RISE * c.size;
        let deep = if i == 0 { 1.0 } else { 0.5 * TREAD } * c.size;
        let front = (i + 1) as f32 * TREAD * c.size;
        scene.add(
            "step",
            backstop_scene::builtin::fixed(
                Geometry::cuboid(deep, half, width),
                Vec3::new(front - deep, half, 0.0),
            ),
        );
    }
    for body in &mut scene.bodies[1..] {
        if body.name == "limb" {
            body.desc.position += DVec3::Y * f64::from(STEPS as f32 * RISE * c.size);
        }
    }
    setup.gauges.push(overlap(limb));
    setup.gauges.push(Gauge { measure: Measure::Inside, bounds: [0.0, 0.0] });
    setup
}
