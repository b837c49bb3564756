//! Grounds of many kinds, with their height as a function.

use super::random::Random;
use backstop::glam::{DVec3, Quat, Vec2, Vec3};
use backstop::{BodyDesc, BodyHandle, Error, Geometry, HeightField, Material, ShapeDesc, World};

/// A ground around the origin, along z to [`LENGTH`]; flat within a car's length of the origin.
#[derive(Clone, Copy, Debug)]
pub(super) enum Ground {
    Plane,
    /// Rises towards +z by an angle [rad].
    Tilted(f32),
    /// Hills of a height [m].
    Hills(f32),
    /// Boxes side by side.
    Tiles,
    /// Boxes side by side, of which each other one is higher by so much [m].
    Steps(f32),
    /// A kinematic box.
    Platform,
}

/// Extent to either side [m].
const LENGTH: f32 = 480.0;
const TILE: f32 = 8.0;
const HILLS: f32 = 40.0;

impl Ground {
    /// Any, with bumps in proportion to a size [m].
    pub(super) fn any(random: &mut Random, size: f32) -> Ground {
        match random.below(6) {
            0 => Ground::Plane,
            1 => Ground::Tilted(random.range(-0.2, 0.2)),
            2 => Ground::Hills(random.range(0.1, 1.5) * size),
            3 => Ground::Tiles,
            4 => Ground::Steps(random.range(0.02, 0.15) * size),
            _ => Ground::Platform,
        }
    }

    pub(super) fn add_to(self, world: &mut World, friction: f32) -> Result<BodyHandle, Error> {
        let material = Material::default().with_friction(friction);
        let shape = |geometry: Geometry| ShapeDesc::new(geometry).with_material(material);
        let desc = match self {
            Ground::Plane => BodyDesc::fixed().with_shape(shape(Geometry::Plane)),
            Ground::Tilted(_) => {
                BodyDesc::fixed().with_rotation(self.rotation()).with_shape(shape(Geometry::Plane))
            }
            Ground::Hills(_) => {
                let (cell, n) = (2.0, (LENGTH as usize) + 1);
                let at = |i: usize| f64::from(cell * i as f32 - LENGTH);
                let heights = (0..n * n).map(|i| self.height(at(i % n), at(i / n)) as f32).collect();
                let field = HeightField::new(n, n, Vec2::splat(cell), heights)?;
                let corner = Vec3::new(-LENGTH, 0.0, -LENGTH);
                BodyDesc::fixed().with_shape(shape(Geometry::height_field(field)).with_position(corner))
            }
            Ground::Tiles | Ground::Steps(_) => {
                let count = (LENGTH / TILE) as i32;
                let tile = shape(Geometry::cuboid(120.0, 1.0, 0.5 * TILE));
                (-count..=count).fold(BodyDesc::fixed(), |desc, i| {
                    let z = TILE * i as f32;
                    let y = self.height(0.0, f64::from(z)) as f32 - 1.0;
                    desc.with_shape(tile.clone().with_position(Vec3::new(0.0, y, z)))
                })
            }
            Ground::Platform => {
                let deck = shape(Geometry::cuboid(LENGTH, 1.0, LENGTH)).with_position(-Vec3::Y);
                BodyDesc::kinematic().with_shape(deck)
            }
        };
        world.add_body(&desc)
    }

    pub(super) fn rotation(self) -> Quat {
        Quat::from_rotation_x(if let Ground::Tilted(angle) = self { -angle } else { 0.0 })
    }

    /// Height at a place [m].
    pub(super) fn height(self, x: f64, z: f64) -> f64 {
        match self {
            Ground::Plane | Ground::Tiles | Ground::Platform => 0.0,
            Ground::Tilted(angle) => z * f64::from(libm::tanf(angle)),
            Ground::Hills(height) => {
                let turn = std::f64::consts::TAU / f64::from(HILLS);
                f64::from(height) * (0.5 - 0.25 * (libm::cos(turn * x) + libm::cos(turn * z)))
            }
            Ground::Steps(height) => {
                let tile = libm::round(z / f64::from(TILE)) as i64;
                if tile.rem_euclid(2) == 1 { f64::from(height) } else { 0.0 }
            }
        }
    }

    /// Height above it [m], at least.
    pub(super) fn above(self, at: DVec3) -> f64 {
        at.y - self.height(at.x, at.z)
    }
}
