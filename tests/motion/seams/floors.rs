//! Floors of pieces, and hills.

use crate::common::random::Random;
use backstop::glam::{Quat, Vec2, Vec3};
use backstop::{BodyDesc, ConvexHull, Geometry, HeightField, ShapeDesc, TriangleMesh, World};
use std::f32::consts::TAU;

/// The pieces of a floor.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum Tile {
    /// Boxes, each a body.
    Boxes,
    /// Boxes on one body.
    Compound,
    /// Hulls of boxes.
    Hulls,
    /// Meshes of flat quads, some to a side.
    Chunks,
    /// Closed meshes of boxes.
    Slabs,
    Fields,
    /// Each of these at random.
    Mixed,
}

const TILES: [Tile; 7] =
    [Tile::Boxes, Tile::Compound, Tile::Hulls, Tile::Chunks, Tile::Slabs, Tile::Fields, Tile::Mixed];

/// A floor of tiles with its top at y = 0.
#[derive(Clone, Copy, Debug)]
pub(super) struct Floor {
    pub(super) tile: Tile,
    /// Edge of a tile, and its thickness [m].
    pub(super) cell: f32,
    pub(super) depth: f32,
    /// Turn of the grid against the way [rad].
    pub(super) yaw: f32,
    /// Between tiles [m].
    pub(super) gap: f32,
    /// Tiles lie lower by up to this [m].
    pub(super) step: f32,
    /// Whether every other row is shifted by half a tile.
    pub(super) staggered: bool,
    pub(super) friction: f32,
}

pub(super) fn rough(geometry: Geometry, friction: f32) -> ShapeDesc {
    let mut shape = ShapeDesc::new(geometry);
    (shape.material.static_friction, shape.material.dynamic_friction) = (friction, friction);
    shape
}

fn corners(half: Vec3) -> Vec<Vec3> {
    (0..8).map(|i| half * Vec3::new(sign(i), sign(i >> 1), sign(i >> 2))).collect()
}

fn sign(bit: usize) -> f32 {
    if bit & 1 == 0 { -1.0 } else { 1.0 }
}

/// The faces of a box, each two triangles that wind counter-clockwise, as seen from outside.
fn box_mesh(half: Vec3) -> TriangleMesh {
    let quads = [[0, 4, 6, 2], [1, 3, 7, 5], [0, 1, 5, 4], [2, 6, 7, 3], [0, 2, 3, 1], [4, 5, 7, 6]];
    let triangles = quads.iter().flat_map(|&[a, b, c, d]| [[a, b, c], [a, c, d]]).collect();
    TriangleMesh::new(corners(half), triangles).unwrap()
}

/// A flat mesh of so many quads to a side.
pub(super) fn quads(half: f32, count: usize) -> TriangleMesh {
    let at = |i: usize| (2.0 * i as f32 / count as f32 - 1.0) * half;
    let vertices = (0..=count).flat_map(|k| (0..=count).map(move |i| Vec3::new(at(i), 0.0, at(k)))).collect();
    let mut triangles = Vec::new();
    for k in 0..count {
        for i in 0..count {
            let a = (k * (count + 1) + i) as u32;
            let (b, c) = (a + 1, a + count as u32 + 1);
            triangles.extend([[a, c, b], [b, c, c + 1]]);
        }
    }
    TriangleMesh::new(vertices, triangles).unwrap()
}

impl Floor {
    /// Any floor for a way of so many metres, whose tiles lie lower by up to `step` metres.
    pub(super) fn any(random: &mut Random, length: f32, step: f32, friction: f32) -> Floor {
        Floor {
            tile: random.of(&TILES),
            cell: random.range(0.3, 4.0).max(length / 80.0),
            depth: random.range(0.1, 1.0),
            yaw: if random.chance(0.4) { 0.0 } else { random.range(0.0, TAU) },
            gap: if random.chance(0.5) { 0.0 } else { random.range(0.0, 1e-3) },
            step: if random.chance(0.5) { 0.0 } else { random.range(0.0, step) },
            staggered: random.chance(0.3),
            friction,
        }
    }

    /// The shape of a tile with the middle of its top at the origin.
    fn shape(&self, random: &mut Random) -> ShapeDesc {
        let half = Vec3::new(0.5 * (self.cell - self.gap), 0.5 * self.depth, 0.5 * (self.cell - self.gap));
        let below = Vec3::NEG_Y * half.y;
        let kind = match self.tile {
            Tile::Mixed => random.of(&TILES[..6]),
            tile => tile,
        };
        let tile_of = |geometry| rough(geometry, self.friction);
        let count = 1 + random.below(5);
        match kind {
            Tile::Chunks => tile_of(Geometry::mesh(quads(half.x, count))),
            Tile::Slabs => tile_of(Geometry::mesh(box_mesh(half))).with_position(below),
            Tile::Hulls => {
                tile_of(Geometry::hull(ConvexHull::new(&corners(half)).unwrap())).with_position(below)
            }
            Tile::Fields => {
                let cells = Vec2::splat(2.0 * half.x / count as f32);
                let field =
                    HeightField::new(count + 1, count + 1, cells, vec![0.0; (count + 1) * (count + 1)]);
                tile_of(Geometry::height_field(field.unwrap()))
                    .with_position(Vec3::new(-half.x, 0.0, -half.x))
            }
            _ => tile_of(Geometry::cuboid(half.x, half.y, half.z)).with_position(below),
        }
    }

    /// Lays the floor along x, from -3 m to `length`, 3 m to each side.
    pub(super) fn lay(&self, world: &mut World, length: f32, random: &mut Random) {
        let turn = Quat::from_rotation_y(self.yaw);
        let reach = (length + 8.0) / self.cell;
        let most = reach as i32 + 2;
        let mut parts = Vec::new();
        for row in -most..=most {
            for column in -most..=most {
                let shift = if self.staggered && row % 2 != 0 { 0.5 } else { 0.0 };
                let local = Vec3::new((column as f32 + shift) * self.cell, 0.0, row as f32 * self.cell);
                let at = turn * local;
                let side = 0.71 * self.cell + 1.5;
                if at.x < -1.5 - side || at.x > length + side || at.z.abs() > side {
                    continue;
                }
                let at = at - Vec3::Y * random.range(0.0, self.step);
                let shape = self.shape(random);
                if self.tile == Tile::Compound {
                    let place = shape.position;
                    parts.push(shape.with_position(at + turn * place).with_rotation(turn));
                } else {
                    let body =
                        BodyDesc::fixed().with_position(at.as_dvec3()).with_rotation(turn).with_shape(shape);
                    world.add_body(&body).unwrap();
                }
            }
        }
        if !parts.is_empty() {
            world.add_body(&BodyDesc::fixed().with_shapes(parts)).unwrap();
        }
    }
}

/// Height of rolling ground [m], and the way from which it is measured.
pub(super) fn hills(x: f32, z: f32, steep: f32) -> f32 {
    steep * (libm::sinf(0.5 * x) + 0.4 * libm::sinf(0.9 * z + 0.3 * x))
}

/// A mesh of the hills between two corners, of squares of a quarter metre.
pub(super) fn hilly(from: Vec2, to: Vec2, steep: f32) -> TriangleMesh {
    let cells = [(to.x - from.x) * 4.0, (to.y - from.y) * 4.0].map(|n| libm::roundf(n) as usize);
    let mut vertices = Vec::new();
    for k in 0..=cells[1] {
        for i in 0..=cells[0] {
            let at = from + Vec2::new(i as f32, k as f32) * 0.25;
            vertices.push(Vec3::new(at.x, hills(at.x, at.y, steep), at.y));
        }
    }
    let mut triangles = Vec::new();
    let row = cells[0] as u32 + 1;
    for k in 0..cells[1] as u32 {
        for i in 0..cells[0] as u32 {
            let a = k * row + i;
            triangles.extend([[a, a + row, a + 1], [a + 1, a + row, a + row + 1]]);
        }
    }
    TriangleMesh::new(vertices, triangles).unwrap()
}
