//! Scenes that tests, benches and the command share. Everything random is seeded, so each is the same
//! everywhere.
//!
//! All bodies have friction 0.6, restitution 0 and, unless said otherwise, density 1000 kg/m³.

pub mod continuous;
mod rain;
#[cfg(feature = "gltf")]
pub(super) mod shipped;
pub(super) mod standing;
pub(super) mod terrain;
#[cfg(test)]
mod tests;

use super::joined::throw;
use super::rng::Rng;
use super::{Scene, SceneJoint, Standing, Terrain};
use backstop::math::Quat;
use backstop::{Axes, Frame, Limit, Motion, Skeleton};
use backstop::{BodyDesc, BodyKind};
use backstop::{ConvexHull, Geometry, ShapeDesc, TriangleMesh};
use glam::{DVec3, Vec3};
use std::f32::consts::{FRAC_1_SQRT_2, TAU};
use std::sync::Arc;

/// The names that [`build`] knows, in the order in which reports list them.
pub const NAMES: &[&str] = &[
    "talk",
    "bullets",
    "bullets_box",
    "large_pyramid",
    "large_pyramid_100",
    "pile",
    "mass_stack_1e3",
    "mass_stack_1e4",
    "mass_stack_1e5",
    "tall_stack",
    "joint_grid",
    "chain",
    "posts",
    "blades",
    "deflector",
    "head_on",
    "ragdoll_wall",
    "ragdolls",
];

/// A scene by its name; a [`Standing`] structure too, as `tower_30`.
pub fn build(name: &str) -> Option<Scene> {
    let mut scene = match name {
        "talk" => talk(),
        "bullets" => bullets(false),
        "bullets_box" => bullets(true),
        "large_pyramid" => large_pyramid(60),
        "large_pyramid_100" => large_pyramid(100),
        "pile" => pile(),
        "mass_stack_1e3" => mass_stack(1e3),
        "mass_stack_1e4" => mass_stack(1e4),
        "mass_stack_1e5" => mass_stack(1e5),
        "tall_stack" => tall_stack(),
        "joint_grid" => joint_grid(100),
        "chain" => chain(true),
        "posts" => continuous::posts(),
        "blades" => continuous::blades(),
        "deflector" => continuous::deflector(),
        "head_on" => continuous::head_on(),
        "ragdoll_wall" => continuous::ragdoll_wall(),
        "ragdolls" => ragdolls(18),
        _ => Standing::named(name, None)?.scene(1.0, 1000.0),
    };
    scene.name = name.into();
    Some(scene)
}

/// The terrain of [`talk`]: 100 352 triangles over 112 m by 112 m.
pub fn talk_terrain() -> Terrain {
    Terrain::bumpy(224, 0.5)
}

/// Eleven fast, spinning bodies of every shape onto a terrain: they hit it between frames 20 and 33, the rest
/// of the time they settle.
pub fn talk() -> Scene {
    let terrain = talk_terrain();
    let mut scene = Scene::new("talk");
    add_terrain(&mut scene, &terrain);
    let mut rng = Rng::new(11);
    let mut shapes = Vec::new();
    for _ in 0..3 {
        shapes.push(Geometry::Sphere { radius: 0.3 });
        shapes.push(Geometry::capsule(0.3, 0.2));
        shapes.push(Geometry::cuboid(0.3, 0.2, 0.4));
    }
    shapes.push(pebble(14, Vec3::new(0.35, 0.3, 0.4), &mut rng));
    shapes.push(pebble(22, Vec3::new(0.4, 0.3, 0.3), &mut rng));
    for (i, shape) in shapes.into_iter().enumerate() {
        throw_at(&mut scene, &terrain, i, shape, &mut rng);
    }
    scene
}

/// The `i`-th thrown body: from above its cell of a 4 by 3 raster, it reaches the ground about 0.35 s later
/// if 55 m/s suffices.
pub(super) fn throw_at(scene: &mut Scene, terrain: &Terrain, i: usize, shape: Geometry, rng: &mut Rng) {
    let x = (i % 4) as f32 * 8.0 - 12.0 + rng.range(-2.0, 2.0);
    let z = (i / 4) as f32 * 8.0 - 8.0 + rng.range(-2.0, 2.0);
    let above = rng.range(10.0, 30.0);
    let down = (above / 0.35).clamp(20.0, 55.0);
    let sideways = rng.range(0.1, 0.45) * down;
    let angle = rng.range(0.0, TAU);
    let rotation = rng.rotation();
    let velocity = Vec3::new(sideways * libm::cosf(angle), -down, sideways * libm::sinf(angle));
    let spin = rng.direction() * rng.range(10.0, 30.0);
    let position = Vec3::new(x, terrain.height(x, z) + above, z);
    let name = format!("{} {}", shape.kind_name(), i + 1);
    let desc = dynamic(shape, position).with_rotation(rotation).with_velocity(velocity, spin);
    scene.add(name, desc);
}

/// A thousand small bodies shot at a floor at 50 to 500 m/s: a mesh without thickness, or boxes 2 cm thick.
pub fn bullets(thin_boxes: bool) -> Scene {
    const HALF: f32 = 200.0;
    let mut scene = Scene::new(if thin_boxes { "bullets_box" } else { "bullets" });
    scene.steps = 120;
    if thin_boxes {
        for (i, k) in (0..10).flat_map(|i| (0..10).map(move |k| (i, k))) {
            let centre = |n: i32| (n as f32 - 4.5) * HALF / 5.0;
            let tile = Geometry::cuboid(HALF / 10.0, 0.01, HALF / 10.0);
            scene.add("floor", fixed(tile, Vec3::new(centre(i), -0.01, centre(k))));
        }
    } else {
        add_terrain(&mut scene, &Terrain::from_fn(40, HALF / 20.0, |_, _| 0.0));
    }
    let mut rng = Rng::new(2);
    for i in 0..1000 {
        let (kind, column, row) = (i % 4, i % 32, i / 32);
        let shape = match kind {
            0 => Geometry::Sphere { radius: 0.05 },
            1 => Geometry::capsule(0.1, 0.05),
            2 => Geometry::cuboid(0.01, 0.5, 0.01),
            _ => Geometry::cuboid(0.01, 0.1, 0.5),
        };
        let spin = if kind >= 2 { 50.0 } else { 10.0 };
        let speed = rng.range(50.0, 500.0);
        let (tilt, turn) = (rng.range(0.0, 1.05), rng.range(0.0, TAU));
        let flat = libm::sinf(tilt);
        let direction = Vec3::new(flat * libm::cosf(turn), -libm::cosf(tilt), flat * libm::sinf(turn));
        let position =
            Vec3::new((column as f32 - 15.5) * 2.5, rng.range(3.0, 12.0), (row as f32 - 15.5) * 2.5);
        let rotation = rng.rotation();
        let spin = rng.direction() * spin;
        scene.add(
            "bullet",
            dynamic(shape, position).with_rotation(rotation).with_velocity(direction * speed, spin),
        );
    }
    scene
}

/// A square net of spheres that are joined to their neighbours, held by seven in the middle of its upper row.
pub fn joint_grid(side: usize) -> Scene {
    let mut scene = Scene::new("joint_grid");
    scene.steps = 100;
    let held = side / 2 - 3.min(side / 2)..side / 2 + 4;
    let ball = || ShapeDesc::new(Geometry::Sphere { radius: 0.4 });
    for k in 0..side {
        for i in 0..side {
            let at = Vec3::new(k as f32, -(i as f32), 0.0);
            let still = i == 0 && held.contains(&k);
            let desc = if still { BodyDesc::fixed() } else { BodyDesc::dynamic() };
            scene.add("ball", desc.with_position(at).with_shape(ball()));
        }
    }
    let mut join = |a: usize, b: usize, half: Vec3| {
        if [a, b].iter().any(|&i| scene.bodies[i].desc.kind == BodyKind::Dynamic) {
            scene.joints.push(ball_joint([a, b], [half, -half]));
        }
    };
    for k in 0..side {
        for i in 0..side {
            let here = k * side + i;
            if i > 0 {
                join(here - 1, here, Vec3::Y * -0.5);
            }
            if k > 0 {
                join(here - side, here, Vec3::X * 0.5);
            }
        }
    }
    scene
}

/// A chain at the origin, hanging or held out level: twenty links of 0.4 m, and at its end a ball a thousand
/// times as heavy as a link.
pub fn chain(level: bool) -> Scene {
    let (half, radius, ball) = (0.15_f32, 0.05_f32, 0.5_f32);
    let pitch = 2.0 * (half + radius);
    let (along, turn) = if level {
        (Vec3::X, Quat::from_xyzw(0.0, 0.0, FRAC_1_SQRT_2, FRAC_1_SQRT_2))
    } else {
        (Vec3::NEG_Y, Quat::IDENTITY)
    };
    let mut scene = Scene::new("chain");
    scene.add("hook", BodyDesc::fixed());
    for i in 0..20 {
        let at = along * (pitch * (i as f32 + 0.5));
        scene.add("link", dynamic(Geometry::capsule(half, radius), at).with_rotation(turn));
    }
    let mut end =
        dynamic(Geometry::Sphere { radius: ball }, along * (pitch * 20.0 + ball)).with_rotation(turn);
    let volume = 2.0 * half * radius * radius + 4.0 / 3.0 * radius * radius * radius;
    end.shapes[0].density *= 1000.0 * volume / (4.0 / 3.0 * ball * ball * ball);
    scene.add("ball", end);
    for i in 0..21 {
        let under = if i == 0 { 0.0 } else { -0.5 * pitch };
        let over = if i == 20 { ball } else { 0.5 * pitch };
        scene.joints.push(ball_joint([i, i + 1], [Vec3::Y * under, Vec3::Y * over]));
    }
    scene
}

/// Figures of bones and joints fall among a hundred boxes, balls, capsules and cylinders: six side by side,
/// the others above them.
pub fn ragdolls(figures: usize) -> Scene {
    let mut scene = Scene::new("ragdolls");
    scene.add("ground", BodyDesc::fixed().with_shape(ShapeDesc::new(Geometry::Plane)));
    for i in 0..100u8 {
        let geometry = match i % 4 {
            0 => Geometry::cuboid(0.2, 0.3, 0.2),
            1 => Geometry::sphere(0.25),
            2 => Geometry::capsule(0.2, 0.15),
            _ => Geometry::cylinder(0.25, 0.2),
        };
        let at = Vec3::new(f32::from(i % 5) - 2.0, 0.5 + 0.7 * f32::from(i / 25), f32::from(i / 5 % 5) - 2.0);
        scene.add("rubble", dynamic(geometry, at));
    }
    let figure = Skeleton::humanoid();
    for i in 0..figures {
        let (column, row) = ((i % 6) as f64, (i / 6) as f64);
        let at = DVec3::new(0.6 * column - 1.5, 4.0 + 0.3 * column + 2.5 * row, 0.0);
        throw(&mut scene, &figure, (at, Quat::IDENTITY), Vec3::new(0.0, -5.0, 1.0));
    }
    scene
}

/// A wall of unit boxes, `base` of them in the lowest row and each row one box shorter than the one below.
/// The last body is the top.
pub fn large_pyramid(base: usize) -> Scene {
    let mut scene = Scene::new("large_pyramid");
    scene.add("floor", fixed(Geometry::cuboid(200.0, 1.0, 200.0), Vec3::new(0.0, -1.0, 0.0)));
    for row in 0..base {
        for column in row..base {
            let x = (row as f32 + 1.0) * 0.5 + (column - row) as f32 - 0.5 * base as f32;
            scene.add("box", dynamic(Geometry::cuboid(0.5, 0.5, 0.5), Vec3::new(x, row as f32 + 0.5, 0.0)));
        }
    }
    scene
}

/// 4096 mixed bodies into an open box of 16 m by 16 m.
pub fn pile() -> Scene {
    const HALF: f32 = 8.0;
    let mut scene = Scene::new("pile");
    scene.steps = 600;
    scene.add("floor", fixed(Geometry::cuboid(HALF + 1.0, 0.5, HALF + 1.0), Vec3::new(0.0, -0.5, 0.0)));
    for side in [-1.0, 1.0] {
        let offset = side * (HALF + 0.5);
        scene.add("wall", fixed(Geometry::cuboid(0.5, 15.0, HALF + 1.0), Vec3::new(offset, 15.0, 0.0)));
        scene.add("wall", fixed(Geometry::cuboid(HALF, 15.0, 0.5), Vec3::new(0.0, 15.0, offset)));
    }
    let mut rng = Rng::new(4);
    let hulls: Vec<Geometry> = (0..4).map(|_| pebble(16, Vec3::new(0.4, 0.35, 0.4), &mut rng)).collect();
    for i in 0..4096usize {
        let (x, z, layer) = (i % 16, i / 16 % 16, i / 256);
        // Shapes shift by one from row to row and layer to layer, so that kinds mix.
        let shape = match (x + z + layer) % 4 {
            0 => Geometry::cuboid(0.35, 0.3, 0.4),
            1 => Geometry::Sphere { radius: 0.35 },
            2 => Geometry::capsule(0.25, 0.25),
            _ => hulls[i / 4 % 4].clone(),
        };
        let mut jitter = || rng.range(-0.04, 0.04);
        let position = Vec3::new(
            (x as f32 - 7.5) * 0.98 + jitter(),
            1.0 + layer as f32 * 1.1,
            (z as f32 - 7.5) * 0.98 + jitter(),
        );
        let name = shape.kind_name();
        scene.add(name, dynamic(shape, position).with_rotation(rng.small_rotation(0.3)));
    }
    scene
}

/// Ten unit boxes, each ten times as heavy as the one below it until `cap` times the lowest, which has 1 kg.
pub fn mass_stack(cap: f32) -> Scene {
    let mut scene = Scene::new("mass_stack");
    scene.add("floor", fixed(Geometry::cuboid(50.0, 1.0, 50.0), Vec3::new(0.0, -1.0, 0.0)));
    let mut density = 1.0f32;
    for i in 0..10 {
        let mut desc = dynamic(Geometry::cuboid(0.5, 0.5, 0.5), Vec3::new(0.0, 0.5 + i as f32, 0.0));
        desc.shapes[0].density = density.min(cap);
        scene.add("box", desc);
        density *= 10.0;
    }
    scene
}

/// Thirty unit boxes on top of each other for 20 s.
pub fn tall_stack() -> Scene {
    let mut scene = Scene::new("tall_stack");
    scene.steps = 1200;
    scene.add("floor", fixed(Geometry::cuboid(50.0, 1.0, 50.0), Vec3::new(0.0, -1.0, 0.0)));
    for i in 0..30 {
        scene.add("box", dynamic(Geometry::cuboid(0.5, 0.5, 0.5), Vec3::new(0.0, 0.5 + i as f32, 0.0)));
    }
    scene
}

fn ball_joint(bodies: [usize; 2], at: [Vec3; 2]) -> SceneJoint {
    SceneJoint {
        name: "joint".into(),
        bodies,
        frames: at.map(Frame::at),
        limits: vec![Limit::lock(Motion::Linear, Axes::All)],
        motors: Vec::new(),
        collide: false,
    }
}

/// A dynamic body of one shape, at `position` [m].
pub fn dynamic(geometry: Geometry, position: Vec3) -> BodyDesc {
    BodyDesc::dynamic().with_position(position).with_shape(ShapeDesc::new(geometry))
}

/// A static body of one shape, at `position` [m].
pub fn fixed(geometry: Geometry, position: Vec3) -> BodyDesc {
    BodyDesc::fixed().with_position(position).with_shape(ShapeDesc::new(geometry))
}

pub(super) fn add_terrain(scene: &mut Scene, terrain: &Terrain) {
    let (vertices, triangles) = terrain.mesh();
    let mesh = TriangleMesh::new(vertices, triangles).expect("a terrain has cells");
    scene.add("terrain", fixed(Geometry::Mesh(Arc::new(mesh)), Vec3::ZERO));
}

/// A convex hull of `count` points spread evenly, but not regularly, over an ellipsoid.
pub fn pebble(count: usize, radii: Vec3, rng: &mut Rng) -> Geometry {
    let point = |i: usize| {
        let y = 1.0 - 2.0 * (i as f32 + 0.5) / count as f32;
        let angle = i as f32 * 2.399_963 + rng.range(-0.2, 0.2);
        let ring = (1.0 - y * y).sqrt();
        Vec3::new(ring * libm::cosf(angle), y, ring * libm::sinf(angle)) * radii
    };
    let points: Vec<Vec3> = (0..count).map(point).collect();
    Geometry::Hull(Arc::new(ConvexHull::new(&points).expect("points of an ellipsoid span a volume")))
}
