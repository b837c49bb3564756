//! Bodies that fly, fall and roll.

use super::super::conditions::{Conditions, Flaw};
use super::super::measures::{Boundary, Gauge, Measure};
use super::setup::{Setup, floor, weight};
use backstop::BodyDesc;
use backstop::{ConvexHull, Geometry, TriangleMesh};
use backstop_scene::Rng;
use backstop_scene::Scene;
use backstop_scene::builtin::{dynamic, fixed, pebble};
use glam::{DVec3, Vec3};
use std::sync::Arc;

/// No body may get through.
pub(super) fn inside() -> Gauge {
    Gauge { measure: Measure::Through, bounds: [0.0, 0.0] }
}

/// Overlap with walls and floor, relative to the size of a body.
pub(super) fn shallow(unit: f32, stable: f64) -> Gauge {
    Gauge { measure: Measure::Depth { unit: f64::from(unit) }, bounds: [stable, 0.5] }
}

/// A closed room of six boxes, and its inner faces.
pub(super) fn room(scene: &mut Scene, half: f32, thick: f32) -> Vec<Boundary> {
    let mut boundaries = Vec::new();
    for axis in [Vec3::X, Vec3::Y, Vec3::Z] {
        for normal in [axis, -axis] {
            let extents = (Vec3::ONE - axis) * (half + 2.0 * thick) + axis * thick;
            scene.add("wall", fixed(Geometry::Box { half_extents: extents }, -normal * (half + thick)));
            boundaries.push(Boundary { point: (-normal * half).as_dvec3(), normal });
        }
    }
    boundaries
}

/// One of five shapes, within a ball of radius `radius`.
fn mixed(i: usize, radius: f32, rng: &mut Rng) -> Geometry {
    match i % 5 {
        0 => Geometry::Sphere { radius },
        1 => Geometry::capsule(0.5 * radius, 0.5 * radius),
        2 => Geometry::cuboid(0.6 * radius, 0.5 * radius, 0.4 * radius),
        3 => pebble(12, Vec3::new(0.9, 0.7, 0.6) * radius, rng),
        _ => Geometry::cuboid(0.15 * radius, 0.9 * radius, 0.15 * radius),
    }
}

/// Bodies of five shapes in a closed room, where they fall into a pile; if a speed is given, each
/// starts in a direction of its own.
pub(super) fn pile(c: &Conditions) -> Setup {
    let mut scene = Scene::new("pile");
    let side = libm::cbrtf(c.bodies as f32).ceil() as usize;
    let boundaries = room(&mut scene, (0.6 * side as f32 + 0.1) * c.size, 0.25 * c.size);
    let mut rng = Rng::new(7);
    for i in 0..c.bodies {
        let cell = |n: usize| (n as f32 - 0.5 * (side - 1) as f32) * 1.2;
        let at = Vec3::new(cell(i % side), cell(i / side % side), cell(i / (side * side))) * c.size;
        let mut body = dynamic(mixed(i, 0.4 * c.size, &mut rng), at).with_rotation(rng.rotation());
        weight(&mut body, if i % 2 == 0 { c.mass_ratio } else { 1.0 });
        let velocity = rng.direction() * c.speed.unwrap_or(0.0) * c.size;
        scene.add("body", body.with_velocity(velocity, rng.direction() * c.spin.unwrap_or(0.0)));
    }
    Setup { scene, boundaries, gauges: vec![inside(), shallow(0.4 * c.size, 0.05)] }
}

/// Sixteen bullets of 5 mm in a closed room with walls of 1 mm.
pub(super) fn bullets(c: &Conditions) -> Setup {
    const RADIUS: f32 = 0.0025;
    let mut scene = Scene::new("bullets");
    let boundaries = room(&mut scene, 0.5 * c.size, 0.0005 * c.size);
    let mut rng = Rng::new(11);
    let slender = c.slenderness.sqrt();
    for i in 0..16 {
        let at = Vec3::new((i % 4) as f32 - 1.5, 0.0, (i / 4) as f32 - 1.5) * (0.2 * c.size);
        let radius = RADIUS * c.size;
        let shape = match c.slenderness {
            1.0 => mixed(i, radius, &mut rng),
            _ => Geometry::capsule(radius, radius / slender),
        };
        // A third of them graze.
        let mut direction = rng.direction();
        if i % 3 == 0 {
            direction = (direction * Vec3::new(1.0, 0.01, 1.0)).normalize();
        }
        let spin = rng.direction() * c.spin.unwrap_or(20.0);
        let velocity = direction * (c.speed.unwrap_or(300.0) * c.size);
        scene.add("bullet", dynamic(shape, at).with_rotation(rng.rotation()).with_velocity(velocity, spin));
    }
    Setup { scene, boundaries, gauges: vec![inside(), shallow(RADIUS * c.size, 0.1)] }
}

/// A ball that rolls with nothing to slow it.
pub(super) fn ball(c: &Conditions) -> Setup {
    let mut scene = Scene::new("ball");
    let speed = c.speed.unwrap_or(5.0) * c.size;
    let boundaries = floor(&mut scene, 66.0 * speed + 20.0 * c.size, c.size);
    let radius = 0.5 * c.size;
    let body = dynamic(Geometry::Sphere { radius }, Vec3::Y * radius);
    let body = scene.add("ball", body.with_velocity(Vec3::X * speed, Vec3::NEG_Z * (speed / radius)));
    let kept = Gauge { measure: Measure::Speed { body }, bounds: [0.02, 0.3] };
    Setup { scene, boundaries, gauges: vec![kept, shallow(radius, 0.02), inside()] }
}

/// A brick that tumbles freely, almost about its middle axis.
pub(super) fn tumbling(c: &Conditions) -> Setup {
    let mut scene = Scene::new("tumbling");
    scene.gravity = Vec3::ZERO;
    let half = match c.slenderness {
        1.0 => Vec3::new(0.5, 0.3, 0.1),
        ratio => Vec3::new(0.5, 0.5 / ratio.sqrt(), 0.6 / ratio.sqrt()),
    };
    let spin = Vec3::new(0.1, 1.0, 0.02) * c.spin.unwrap_or(10.0);
    let body = dynamic(Geometry::Box { half_extents: half * c.size }, Vec3::ZERO);
    scene.add("brick", body.with_velocity(Vec3::X * c.speed.unwrap_or(0.0) * c.size, spin));
    let mass = super::super::measures::mass_of(&scene.bodies[0].desc);
    let energy = 0.5 * f64::from((mass.inertia * spin).dot(spin));
    let gauge = |measure, bounds| Gauge { measure, bounds };
    let gauges = vec![
        gauge(Measure::Gain { unit: energy }, [0.01, 0.1]),
        gauge(Measure::Loss { unit: energy }, [0.02, 0.5]),
    ];
    Setup { scene, boundaries: Vec::new(), gauges }
}

/// Bodies of five shapes that fall on triangles; either the triangles or the bodies are degenerate.
pub(super) fn shards(c: &Conditions) -> Setup {
    let mut scene = Scene::new("shards");
    scene.add("ground", fixed(Geometry::Mesh(Arc::new(ground(c))), Vec3::ZERO));
    let mut rng = Rng::new(3);
    for i in 0..20 {
        let at = Vec3::new((i % 5) as f32 - 2.0, 0.6, (i / 5) as f32 - 1.5) * (1.5 * c.size);
        let body: BodyDesc = dynamic(shard(c, i, &mut rng), at).with_rotation(rng.rotation());
        scene.add("body", body);
    }
    let boundaries = vec![Boundary { point: DVec3::ZERO, normal: Vec3::Y }];
    Setup { scene, boundaries, gauges: vec![inside(), shallow(0.4 * c.size, 0.05)] }
}

fn shard(c: &Conditions, i: usize, rng: &mut Rng) -> Geometry {
    let flat = match c.flaw {
        Flaw::Needles => Vec3::new(1e-3, 1.0, 1e-3),
        Flaw::Flakes => Vec3::new(1.0, 1e-3, 1.0),
        _ => return mixed(i, 0.4 * c.size, rng),
    };
    let points: Vec<_> = (0..16).map(|_| rng.direction() * flat * (0.4 * c.size)).collect();
    Geometry::Hull(Arc::new(ConvexHull::new(&points).expect("sixteen points that are not in a plane")))
}

/// A square of 24 length units in triangles.
fn ground(c: &Conditions) -> TriangleMesh {
    let (columns, rows) = match c.flaw {
        Flaw::Slivers => (2_u32, 2000_u32),
        _ => (24, 24),
    };
    let (mut vertices, mut triangles) = (Vec::new(), Vec::new());
    for row in 0..=rows {
        for column in 0..=columns {
            let side = |n: u32, of: u32| (n as f32 / of as f32 - 0.5) * 24.0 * c.size;
            vertices.push(Vec3::new(side(column, columns), 0.0, side(row, rows)));
        }
    }
    let vertex = |row: u32, column: u32| row * (columns + 1) + column;
    for (row, column) in (0..rows).flat_map(|row| (0..columns).map(move |column| (row, column))) {
        let [a, b] = [vertex(row, column), vertex(row, column + 1)];
        let [d, e] = [vertex(row + 1, column), vertex(row + 1, column + 1)];
        let mut two = vec![[a, d, b], [b, d, e]];
        match c.flaw {
            Flaw::Doubled => two.extend([[a, d, b], [b, d, e]]),
            // Along the diagonal and along a side: corners that coincide, and corners in a line.
            Flaw::NoArea => {
                let middle = (vertices[b as usize] + vertices[d as usize]) * 0.5;
                vertices.push(middle);
                two.extend([[b, d, d], [b, vertices.len() as u32 - 1, d]]);
            }
            _ => {}
        }
        triangles.extend(two);
    }
    TriangleMesh::new(vertices, triangles).expect("triangles with area among them")
}
