//! Things that turn.

use super::{Error, Mixed, Subject, add_mesh, below};
use backstop::glam::{Quat, Vec3};
use backstop::{BodyDesc, Geometry, JointDesc, ShapeDesc};
use backstop_scene::builtin::{dynamic, fixed};
use backstop_scene::{Rng, Scene, Terrain, axis_angle, join};
use std::f32::consts::TAU;
use std::sync::Arc;

/// Inner radius and half the length of the drum [m].
const DRUM: (f32, f32) = (4.0, 3.0);

/// The wall of the drum and six paddles in it, turning about z.
fn drum_body() -> BodyDesc {
    let (radius, length) = DRUM;
    let (staves, thickness) = (24, 0.25);
    let mut desc = BodyDesc::kinematic().with_velocity(Vec3::ZERO, Vec3::Z);
    let mut part = |half: Vec3, angle: f32, away: f32| {
        let turn = axis_angle(Vec3::Z, angle);
        let shape = ShapeDesc::new(Geometry::Box { half_extents: half });
        let at = Vec3::new(away * libm::cosf(angle), away * libm::sinf(angle), 0.0);
        desc.shapes.push(shape.with_position(at).with_rotation(turn));
    };
    let width = radius * libm::tanf(0.5 * TAU / staves as f32) + 0.08;
    for i in 0..staves {
        part(Vec3::new(thickness, width, length), i as f32 * TAU / staves as f32, radius + thickness);
    }
    for i in 0..6 {
        part(Vec3::new(0.3, 0.1, length), (i as f32 + 0.25) * TAU / 6.0, radius - 0.3);
    }
    desc
}

/// 1,500 mixed bodies in a drum that makes ten turns a minute between two walls.
pub(super) fn drum() -> Subject {
    let (radius, length) = DRUM;
    let mut scene = Scene::new("drum");
    scene.add("drum", drum_body());
    for side in [-1.0, 1.0] {
        let wall = Geometry::cuboid(radius + 1.0, radius + 1.0, 0.5);
        scene.add("wall", fixed(wall, Vec3::Z * (side * (length + 0.5))));
    }
    let mut rng = Rng::new(40);
    let mixed = Mixed::new(0.18, &mut rng);
    let places = (0..13 * 13 * 12).map(|cell| {
        let (z, x, y) = (cell % 12, cell / 12 % 13, cell / 156);
        Vec3::new(x as f32 - 6.0, y as f32 - 6.0, z as f32 - 5.5) * 0.45
    });
    // Clear of the wall and the paddles.
    let places = places.filter(|at| at.truncate().length() < radius - 0.95);
    for (i, at) in places.take(1500).enumerate() {
        scene.add("body", dynamic(mixed.shape(i), at).with_rotation(rng.small_rotation(0.3)));
    }
    let beyond =
        Arc::new(move |p: Vec3| (p.truncate().length() - radius - 0.25).max(p.z.abs() - length - 0.25));
    Subject { rests: false, beyond, ..Subject::new(scene, Error::Depth) }
}

/// Adds a car that drives along x at `speed` [m/s], with its wheels on the ground below `at`.
fn add_car(scene: &mut Scene, at: Vec3, speed: f32) {
    let radius = 0.4;
    let forward = Vec3::X * speed;
    let part = |half: [f32; 3], at: Vec3| {
        ShapeDesc::new(Geometry::cuboid(half[0], half[1], half[2])).with_position(at)
    };
    let chassis = BodyDesc::dynamic()
        .with_position(at + Vec3::Y * (radius + 0.3))
        .with_velocity(forward, Vec3::ZERO)
        .with_shape(part([1.6, 0.25, 0.6], Vec3::ZERO))
        .with_shape(part([0.8, 0.25, 0.55], Vec3::new(-0.2, 0.5, 0.0)));
    let body = scene.add("chassis", chassis);
    // A car of water is too heavy.
    scene.bodies[body].desc.shapes.iter_mut().for_each(|shape| shape.density = 300.0);
    for (x, z) in [(1.1, -0.85), (1.1, 0.85), (-1.1, -0.85), (-1.1, 0.85)] {
        let place = at + Vec3::new(x, radius, z);
        let spin = Vec3::Z * (-speed / radius);
        let wheel = scene.add("wheel", dynamic(Geometry::sphere(radius), place).with_velocity(forward, spin));
        let axes = Quat::from_rotation_arc(Vec3::X, Vec3::Z);
        join(scene, [body, wheel], place.as_dvec3(), axes.into(), JointDesc::hinge);
    }
}

/// 64 cars that coast over hills of 100,352 triangles from 15 m/s.
pub(super) fn cars() -> Subject {
    let terrain = Terrain::from_fn(224, 1.0, |x, z| {
        1.2 * libm::sinf(0.11 * x) * libm::cosf(0.09 * z) + 0.15 * libm::sinf(0.8 * x + 0.3 * z)
    });
    let mut scene = Scene::new("cars");
    add_mesh(&mut scene, "terrain", Vec3::ZERO, terrain.mesh());
    for i in 0..64 {
        let (x, z) = ((i % 8) as f32 * 8.0 - 90.0, (i / 8) as f32 * 6.0 - 21.0);
        let ground =
            [-1.5, 0.0, 1.5].map(|dx| terrain.height(x + dx, z)).into_iter().fold(f32::MIN, f32::max);
        add_car(&mut scene, Vec3::new(x, ground + 0.3, z), 15.0);
    }
    Subject { rests: false, beyond: below(terrain), ..Subject::new(scene, Error::Joint) }
}
