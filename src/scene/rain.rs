//! Bodies of mixed shapes above what a scene has, to fall onto it.

use super::Scene;
use super::builtin::{dynamic, kind_name, pebble};
use super::rng::Rng;
use crate::body::BodyDesc;
use crate::shape::{Geometry, ShapeDesc};
use glam::{DVec3, Vec3};

/// Bodies are a share of the ground's narrower side, within these sizes [m].
const SHARE: f32 = 1.0 / 30.0;
const SIZES: (f32, f32) = (0.05, 0.35);
/// Side of the cell that a body falls through, in its sizes: neighbours don't touch however they turn.
const CELL: f32 = 3.6;
/// Bodies keep this share of the ground's sides free at each edge.
const RIM: f32 = 0.1;

impl Scene {
    /// Adds `count` dynamic bodies of mixed shapes above everything there is, spread over its width in layers, none
    /// touching another. They start at rest; their sizes suit the ground's. The same seed gives the same bodies.
    pub fn rain(&mut self, count: usize, seed: u64) {
        let (min, max) = self.bounds();
        let (rim, wide) = (RIM * (max - min), (1.0 - 2.0 * RIM) * (max - min));
        let size = (SHARE * wide.x.min(wide.z)).clamp(SIZES.0, SIZES.1);
        let cell = CELL * size;
        // No more columns than make a layer of a square, so that few bodies fall close together.
        let most = (count as f32).sqrt().ceil().max(1.0);
        let columns = |width: f32| (width / cell).floor().clamp(1.0, most) as usize;
        let (nx, nz) = (columns(wide.x), columns(wide.z));
        let mut rng = Rng::new(seed);
        for i in 0..count {
            let (x, z, layer) = (i % nx, i / nx % nz, i / (nx * nz));
            let spread = |n: usize, columns: usize, start: f32, width: f32| {
                start + width * (n as f32 + 0.5) / columns as f32
            };
            let jitter = Vec3::new(rng.range(-0.2, 0.2), rng.range(-0.2, 0.2), rng.range(-0.2, 0.2)) * size;
            let place = Vec3::new(
                spread(x, nx, min.x + rim.x, wide.x),
                max.y + cell * (layer as f32 + 1.0),
                spread(z, nz, min.z + rim.z, wide.z),
            );
            let (name, desc) = drop(i, size, &mut rng);
            self.add(format!("{name} {}", i + 1), desc.at(place + jitter).rotated(rng.rotation()));
        }
    }

    /// Box around all shapes, planes aside [m]; a square of 10 m at the height zero if there are none.
    fn bounds(&self) -> (Vec3, Vec3) {
        let (mut min, mut max) = (Vec3::INFINITY, Vec3::NEG_INFINITY);
        let mut add = |p: DVec3, around: f32| {
            (min, max) = (min.min(p.as_vec3() - around), max.max(p.as_vec3() + around));
        };
        for body in self.bodies.iter().map(|b| &b.desc) {
            for shape in &body.shapes {
                let placed = |p: Vec3| {
                    body.position + (body.rotation * (shape.position + shape.rotation * p)).as_dvec3()
                };
                match &shape.geometry {
                    Geometry::Plane | Geometry::HeightField(_) => {}
                    Geometry::Mesh(mesh) => (0..mesh.triangle_count() as u32)
                        .flat_map(|i| mesh.triangle(i))
                        .for_each(|p| add(placed(p), 0.0)),
                    Geometry::Box { half_extents } => {
                        for corner in 0..8 {
                            let sign = |bit: i32| if corner & bit == 0 { -1.0 } else { 1.0 };
                            add(placed(*half_extents * Vec3::new(sign(1), sign(2), sign(4))), 0.0);
                        }
                    }
                    round => add(placed(Vec3::ZERO), round.radius()),
                }
            }
        }
        if min.cmple(max).all() { (min, max) } else { (Vec3::new(-5.0, 0.0, -5.0), Vec3::new(5.0, 0.0, 5.0)) }
    }
}

/// The `i`-th body and what to call it: every kind of shape in turn, at most 1.5 `size` around its origin.
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
            let part =
                |geometry, y| ShapeDesc { position: Vec3::new(0.0, y, 0.0), ..ShapeDesc::new(geometry) };
            let dumbbell = BodyDesc::dynamic()
                .with_shape(part(Geometry::cylinder(0.7 * s, 0.2 * s), 0.0))
                .with_shape(part(Geometry::Sphere { radius: 0.5 * s }, 0.7 * s))
                .with_shape(part(Geometry::cuboid(0.35 * s, 0.35 * s, 0.35 * s), -0.7 * s));
            return ("compound", dumbbell);
        }
    };
    (kind_name(&geometry), dynamic(geometry, Vec3::ZERO))
}

#[cfg(test)]
mod tests {
    use super::super::Terrain;
    use super::super::builtin::{add_terrain, fixed};
    use super::*;

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
    fn a_plane_alone_is_rained_on_too() {
        let mut scene = Scene::new("plane");
        scene.bodies.push(super::super::SceneBody {
            name: "p".into(),
            node: None,
            desc: fixed(Geometry::Plane, Vec3::ZERO),
        });
        scene.rain(3, 0);
        assert!(scene.bodies[1..].iter().all(|b| b.desc.position.is_finite() && b.desc.position.y > 0.0));
    }
}
