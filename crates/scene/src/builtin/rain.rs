//! Bodies of mixed shapes that fall onto a scene from above.

use super::{dynamic, pebble};
use crate::Scene;
use crate::rng::Rng;
use backstop::BodyDesc;
use backstop::{Geometry, ShapeDesc};
use glam::Vec3;

/// Bodies are a share of the ground's narrower side, within these sizes [m].
const SHARE: f32 = 1.0 / 30.0;
const SIZES: (f32, f32) = (0.05, 0.35);
/// Side of the cell in which a body falls, in body sizes: neighbours don't touch however they rotate.
const CELL: f32 = 3.6;
/// Share of the ground's sides that stays free at each edge.
const RIM: f32 = 0.1;

impl Scene {
    /// Adds `count` dynamic bodies of mixed shapes above the scene's contents, spread over their width in
    /// layers, none touching another. Above means against the scene's gravity. They start at rest, their own
    /// width above the bodies below them; their sizes suit the ground's. The same seed gives the same bodies.
    pub fn rain(&mut self, count: usize, seed: u64) {
        let ground = Ground::of(self, count);
        let mut rng = Rng::new(seed);
        for i in 0..count {
            let jitter = Vec3::new(rng.range(-0.2, 0.2), rng.range(-0.2, 0.2), rng.range(-0.2, 0.2));
            let place = ground.place(i) + jitter * ground.size;
            let (name, desc) = drop(i, ground.size, &mut rng);
            self.add(format!("{name} {}", i + 1), desc.with_position(place).with_rotation(rng.rotation()));
        }
    }
}

/// Cells over the ground, and how high it is in each. Inside, y is up, whatever it is in the scene.
struct Ground {
    frame: Frame,
    min: Vec3,
    /// Sides of a cell.
    cell: Vec3,
    columns: [usize; 2],
    heights: Vec<f32>,
    /// Size of the bodies.
    size: f32,
}

impl Ground {
    fn of(scene: &Scene, count: usize) -> Ground {
        let frame = Frame::of(scene.gravity);
        let mut parts = Vec::new();
        scene
            .bodies
            .iter()
            .for_each(|b| outline(&b.desc, |corners| parts.push(corners.map(|p| frame.turn(p)))));
        let corners = || parts.iter().flatten();
        let (mut min, mut max) = (
            corners().fold(Vec3::INFINITY, |m, &p| m.min(p)),
            corners().fold(Vec3::NEG_INFINITY, |m, &p| m.max(p)),
        );
        if parts.is_empty() {
            // The scene is empty or has planes only.
            (min, max) = (Vec3::new(-5.0, 0.0, -5.0), Vec3::new(5.0, 0.0, 5.0));
        }
        let wide = (1.0 - 2.0 * RIM) * (max - min);
        let size = (SHARE * wide.x.min(wide.z)).clamp(SIZES.0, SIZES.1);
        // No more columns than in a square layer of all bodies, so that few bodies don't crowd.
        let most = (count as f32).sqrt().ceil().max(1.0);
        let columns = [wide.x, wide.z].map(|w| (w / (CELL * size)).floor().clamp(1.0, most) as usize);
        let mut ground = Ground {
            frame,
            min: min + RIM * (max - min),
            cell: wide / Vec3::new(columns[0] as f32, 1.0, columns[1] as f32),
            columns,
            heights: vec![f32::NEG_INFINITY; columns[0] * columns[1]],
            size,
        };
        parts.iter().for_each(|part| ground.raise(*part));
        // Holes count as high as the highest cell.
        ground.heights.iter_mut().filter(|h| **h == f32::NEG_INFINITY).for_each(|h| *h = max.y);
        ground
    }

    /// Raises cells by a triangle: within a cell it is no higher than its plane at the cell's corners.
    fn raise(&mut self, [a, b, c]: [Vec3; 3]) {
        let (low, high) = (a.min(b).min(c), a.max(b).max(c));
        let range = |axis: usize, count: usize| {
            let at = |x: f32| ((x - self.min[axis]) / self.cell[axis]).clamp(-1.0, count as f32);
            (at(low[axis]).floor().max(0.0) as usize)..((at(high[axis]).floor() + 1.0) as usize).min(count)
        };
        let (xs, zs) = (range(0, self.columns[0]), range(2, self.columns[1]));
        let normal = (b - a).cross(c - a);
        for (ix, iz) in zs.flat_map(|iz| xs.clone().map(move |ix| (ix, iz))) {
            let mut top = f32::NEG_INFINITY;
            for (dx, dz) in [(0, 0), (1, 0), (0, 1), (1, 1)] {
                let x = self.min.x + (ix + dx) as f32 * self.cell.x - a.x;
                let z = self.min.z + (iz + dz) as f32 * self.cell.z - a.z;
                // A steep triangle is as high as its highest corner.
                let y = a.y - (normal.x * x + normal.z * z) / normal.y;
                top = top.max(if y.is_finite() { y } else { high.y });
            }
            let height = &mut self.heights[iz * self.columns[0] + ix];
            *height = height.max(top.clamp(low.y, high.y));
        }
    }

    /// Where the `i`-th body starts: cell by cell, then the next layer.
    fn place(&self, i: usize) -> Vec3 {
        let [nx, nz] = self.columns;
        let (ix, iz, layer) = (i % nx, i / nx % nz, i / (nx * nz));
        let x = self.min.x + (ix as f32 + 0.5) * self.cell.x;
        let z = self.min.z + (iz as f32 + 0.5) * self.cell.z;
        let y = self.heights[iz * nx + ix] + CELL * self.size * (layer as f32 + 1.0);
        self.frame.back(Vec3::new(x, y, z))
    }
}

/// Maps the axis that is up to y. Axes are permuted, so nothing is rounded.
#[derive(Clone, Copy)]
struct Frame {
    up: usize,
    sign: f32,
}

impl Frame {
    fn of(gravity: Vec3) -> Frame {
        let size = gravity.abs();
        let up = if size.x > size.y.max(size.z) {
            0
        } else if size.z > size.y {
            2
        } else {
            1
        };
        Frame { up, sign: if gravity[up] > 0.0 { -1.0 } else { 1.0 } }
    }

    fn turn(self, p: Vec3) -> Vec3 {
        Vec3::new(p[(self.up + 2) % 3], self.sign * p[self.up], p[(self.up + 1) % 3])
    }

    fn back(self, p: Vec3) -> Vec3 {
        let mut turned = Vec3::ZERO;
        (turned[(self.up + 2) % 3], turned[self.up], turned[(self.up + 1) % 3]) = (p.x, self.sign * p.y, p.z);
        turned
    }
}

/// Triangles whose box holds each shape of a body, in the world; planes and height fields have none.
fn outline(body: &BodyDesc, mut add: impl FnMut([Vec3; 3])) {
    for shape in &body.shapes {
        let placed =
            |p: Vec3| body.position.as_vec3() + body.rotation * (shape.position + shape.rotation * p);
        match &shape.geometry {
            Geometry::Plane | Geometry::HeightField(_) => {}
            Geometry::Mesh(mesh) => {
                let corners = (0..mesh.triangle_count() as u32).filter_map(|i| mesh.corners(i));
                corners.for_each(|corners| add(corners.map(placed)));
            }
            Geometry::Box { half_extents } => {
                // Opposite faces, two triangles each: with their rims they reach as far as the box.
                for axis in 0..3 {
                    for side in [-1.0, 1.0] {
                        let corner = |u: f32, v: f32| {
                            let mut p = Vec3::ZERO;
                            (p[axis], p[(axis + 1) % 3], p[(axis + 2) % 3]) = (side, u, v);
                            placed(*half_extents * p)
                        };
                        add([corner(-1.0, -1.0), corner(1.0, -1.0), corner(1.0, 1.0)]);
                        add([corner(-1.0, -1.0), corner(1.0, 1.0), corner(-1.0, 1.0)]);
                    }
                }
            }
            round => {
                // As high as its bounding ball, over the whole square around it.
                let (centre, r) = (placed(Vec3::ZERO), round.radius());
                for side in [-1.0, 1.0] {
                    let corner = |u: f32, v: f32| centre + r * Vec3::new(u, side, v);
                    add([corner(-1.0, -1.0), corner(1.0, -1.0), corner(1.0, 1.0)]);
                    add([corner(-1.0, -1.0), corner(1.0, 1.0), corner(-1.0, 1.0)]);
                }
            }
        }
    }
}

/// The `i`-th body and its name: every kind of shape in turn, at most 1.5 `size` around its origin.
fn drop(i: usize, size: f32, rng: &mut Rng) -> (&'static str, BodyDesc) {
    let s = size * rng.range(0.7, 1.0);
    let geometry = match i % 9 {
        0 => Geometry::Sphere { radius: s },
        1 => Geometry::cuboid(0.7 * s, 0.6 * s, 0.8 * s),
        2 => Geometry::capsule(0.7 * s, 0.5 * s),
        3 => Geometry::cylinder(0.6 * s, 0.7 * s),
        4 => pebble(16, Vec3::new(s, 0.7 * s, 0.8 * s), rng),
        5 => Geometry::Capsule { half_height: 0.6 * s, radius_bottom: 0.6 * s, radius_top: 0.3 * s },
        6 => Geometry::cuboid(s, 0.15 * s, 0.7 * s),
        7 => Geometry::Cylinder { half_height: 0.6 * s, radius_bottom: 0.8 * s, radius_top: 0.0 },
        _ => {
            let part = |geometry, y| ShapeDesc::new(geometry).with_position(Vec3::new(0.0, y, 0.0));
            let dumbbell = BodyDesc::dynamic()
                .with_shape(part(Geometry::cylinder(0.7 * s, 0.2 * s), 0.0))
                .with_shape(part(Geometry::Sphere { radius: 0.5 * s }, 0.7 * s))
                .with_shape(part(Geometry::cuboid(0.35 * s, 0.35 * s, 0.35 * s), -0.7 * s));
            return ("compound", dumbbell);
        }
    };
    (geometry.kind_name(), dynamic(geometry, Vec3::ZERO))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::Terrain;
    use crate::builtin::{add_terrain, fixed};

    #[test]
    fn drops_start_above_the_ground_and_apart() {
        let mut scene = Scene::new("ground");
        let terrain = Terrain::bumpy(16, 0.5);
        add_terrain(&mut scene, &terrain);
        scene.rain(200, 5);
        assert_eq!(scene.dynamic_bodies(), 200);
        let reach = |desc: &BodyDesc| {
            desc.shapes.iter().fold(0.0f32, |r, s| r.max(s.position.length() + s.geometry.radius()))
        };
        let drops: Vec<&BodyDesc> = scene.bodies[1..].iter().map(|b| &b.desc).collect();
        for (i, a) in drops.iter().enumerate() {
            a.validate().unwrap();
            let p = a.position.as_vec3();
            assert!(terrain.contains(p.x, p.z) && p.y - reach(a) > terrain.height(p.x, p.z));
            for b in &drops[..i] {
                assert!(a.position.distance(b.position) as f32 > reach(a) + reach(b));
            }
        }
    }

    #[test]
    fn rain_falls_where_gravity_points_and_starts_low_over_the_ground() {
        // A slope that rises 8 m along x; up is z.
        let slope = Terrain::from_fn(16, 1.0, |x, _| 0.5 * x);
        let (vertices, triangles) = slope.mesh();
        let vertices = vertices.into_iter().map(|p| Vec3::new(p.z, p.x, p.y)).collect();
        let mesh = backstop::TriangleMesh::new(vertices, triangles).unwrap();
        let mut scene = Scene::new("slope");
        scene.gravity = Vec3::new(0.0, 0.0, -9.81);
        scene.add("slope", fixed(Geometry::Mesh(std::sync::Arc::new(mesh)), Vec3::ZERO));
        scene.rain(36, 1);
        for body in &scene.bodies[1..] {
            let p = body.desc.position.as_vec3();
            let above = p.z - 0.5 * p.y;
            assert!(above > 0.3 && above < 4.0, "{above}");
        }
    }

    #[test]
    fn a_plane_alone_is_rained_on_too() {
        let mut scene = Scene::new("plane");
        scene.bodies.push(crate::SceneBody {
            name: "p".into(),
            node: None,
            desc: fixed(Geometry::Plane, Vec3::ZERO),
        });
        scene.rain(3, 0);
        assert!(scene.bodies[1..].iter().all(|b| b.desc.position.is_finite() && b.desc.position.y > 0.0));
    }
}
