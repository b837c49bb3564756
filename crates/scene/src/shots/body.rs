//! The projectiles: every dynamic shape, from 2 mm to 1 m, thin ones above all.

use super::super::builtin::pebble;
use super::super::rng::Rng;
use super::draw::{log_range, pick};
use backstop::{Geometry, ShapeDesc};
use glam::Vec3;

/// Names of the shapes that are shot.
pub const SHAPES: [&str; 11] = [
    "sphere",
    "capsule",
    "tapered_capsule",
    "box",
    "rod_box",
    "plate_box",
    "cylinder",
    "tapered_cylinder",
    "cone",
    "hull",
    "compound",
];

/// Half of 2 mm and half of 1 m.
const SMALL: f32 = 0.001;
const LARGE: f32 = 0.5;

pub(super) fn shapes(index: usize, rng: &mut Rng) -> Vec<ShapeDesc> {
    let mut size = |low: f32, high: f32| log_range(rng, low, high);
    let geometry = match SHAPES[index] {
        "sphere" => Geometry::Sphere { radius: size(SMALL, 0.1) },
        "capsule" => Geometry::capsule(size(SMALL, 0.4), size(SMALL, 0.1)),
        "tapered_capsule" => Geometry::Capsule {
            half_height: size(SMALL, 0.3),
            radius_bottom: size(SMALL, 0.1),
            radius_top: size(SMALL, 0.1),
        },
        "box" => Geometry::cuboid(size(SMALL, LARGE), size(SMALL, LARGE), size(SMALL, LARGE)),
        "rod_box" => {
            let half = size(20.0 * SMALL, LARGE);
            let thin = size(SMALL, 0.1 * half);
            Geometry::cuboid(thin, half, size(thin, 1.5 * thin))
        }
        "plate_box" => {
            let half = size(20.0 * SMALL, LARGE);
            Geometry::cuboid(half, size(SMALL, 0.1 * half), size(0.5 * half, half))
        }
        "cylinder" => Geometry::cylinder(size(SMALL, LARGE), size(SMALL, LARGE)),
        "tapered_cylinder" => Geometry::Cylinder {
            half_height: size(SMALL, LARGE),
            radius_bottom: size(SMALL, 0.3),
            radius_top: size(SMALL, 0.3),
        },
        "cone" => Geometry::Cylinder {
            half_height: size(2.0 * SMALL, LARGE),
            radius_bottom: size(2.0 * SMALL, 0.3),
            radius_top: 0.0,
        },
        "hull" => {
            let radii =
                Vec3::new(size(2.0 * SMALL, LARGE), size(2.0 * SMALL, LARGE), size(2.0 * SMALL, LARGE));
            // Thinner than a tenth would be a plate, which the builder may take for flat.
            let radii = radii.max(Vec3::splat(0.1 * radii.max_element()));
            let count = 8 + pick(rng, 40);
            pebble(count, radii, rng)
        }
        _ => return compound(rng),
    };
    vec![ShapeDesc::new(geometry)]
}

/// A dumbbell: a thin rod between a ball and a box.
fn compound(rng: &mut Rng) -> Vec<ShapeDesc> {
    let half = log_range(rng, 0.01, 0.4);
    let part = |geometry, y| ShapeDesc::new(geometry).with_position(Vec3::new(0.0, y, 0.0));
    let mut knob = || log_range(rng, 0.1 * half, 0.5 * half);
    vec![
        part(Geometry::cylinder(half, 0.1 * half), 0.0),
        part(Geometry::Sphere { radius: knob() }, half),
        part(Geometry::cuboid(knob(), knob(), knob()), -half),
    ]
}

/// Largest distance of any point of the body from its origin [m].
pub(super) fn reach(shapes: &[ShapeDesc]) -> f32 {
    shapes.iter().fold(0.0, |r, s| r.max(s.position.length() + s.geometry.radius()))
}
