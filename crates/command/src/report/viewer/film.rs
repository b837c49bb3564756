//! Data of the viewer: meshes, shapes that are instances of them, and how these move.

use super::motion::Motion;
use crate::report::output::count;
use backstop::glam::Vec3;
use backstop::{BodyKind, Geometry, GeometryKey, debug};
use backstop_scene::Scene;
use base64::Engine;
use base64::engine::general_purpose::STANDARD;
use serde::Serialize;
use std::collections::HashMap;

/// Triangles of all meshes, at most.
const MAX_TRIANGLES: usize = 400_000;

/// A mesh: numbers little endian, in base64.
#[derive(Debug, Serialize)]
struct Mesh {
    /// Three `f32` each.
    vertices: String,
    /// Three `u32` each, counter-clockwise from outside.
    triangles: String,
}

#[derive(Debug, Serialize)]
pub(crate) struct Film {
    meshes: Vec<Mesh>,
    /// Mesh and tone of each shape, and its body among those that move, or -1.
    shapes: Vec<[i32; 3]>,
    /// Pose of each shape on its body; in the world if that does not move.
    places: Vec<[f32; 7]>,
    /// Pairs of shapes whose bodies are joined.
    links: Vec<[usize; 2]>,
    bodies: usize,
    frames: usize,
    interval: f32,
    positions: String,
    rotations: String,
    /// A bit for each pose, from the lowest.
    asleep: String,
    #[serde(skip)]
    pub(crate) notes: Vec<String>,
}

/// The colour of a shape, as an index into the renderer's list.
fn tone(kind: BodyKind, geometry: &Geometry) -> i32 {
    match (kind, geometry) {
        (_, Geometry::Plane) => 8,
        _ if !geometry.is_convex() => 7,
        (BodyKind::Static, _) => 6,
        (BodyKind::Kinematic, _) => 5,
        (_, Geometry::Sphere { .. }) => 0,
        (_, Geometry::Capsule { .. }) => 1,
        (_, Geometry::Box { .. }) => 2,
        (_, Geometry::Cylinder { .. }) => 3,
        _ => 4,
    }
}

/// Numbers as bytes in base64.
fn packed<const N: usize>(bytes: impl Iterator<Item = [u8; N]>) -> String {
    STANDARD.encode(bytes.flatten().collect::<Vec<u8>>())
}

impl Film {
    /// The film of a scene, and how it moved; an error says why that can't be shown.
    pub(crate) fn of(scene: &Scene, motion: &Motion) -> Result<Film, &'static str> {
        if motion.bodies.is_empty() {
            return Err("nothing in the scene can move");
        }
        if motion.is_too_large() {
            return Err("there are too many bodies for a page");
        }
        let bits = motion
            .asleep
            .chunks(8)
            .map(|bits| [bits.iter().enumerate().fold(0u8, |byte, (i, &bit)| byte | u8::from(bit) << i)]);
        let mut film = Film {
            meshes: Vec::new(),
            shapes: Vec::new(),
            places: Vec::new(),
            links: Vec::new(),
            bodies: motion.bodies.len(),
            frames: motion.frames(),
            interval: motion.interval,
            positions: packed(motion.positions.iter().flatten().map(|x| x.to_le_bytes())),
            rotations: packed(motion.rotations.iter().flatten().map(|x| x.to_le_bytes())),
            asleep: packed(bits),
            notes: Vec::new(),
        };
        film.add_shapes(scene, motion);
        Ok(film)
    }

    pub(crate) fn json(&self) -> String {
        // Numbers, names of fields and base64: nothing in it ends a script, and nothing can fail.
        serde_json::to_string(self).unwrap_or_default()
    }

    fn add_shapes(&mut self, scene: &Scene, motion: &Motion) {
        let mut made = HashMap::<GeometryKey, Option<i32>>::new();
        let mut room = MAX_TRIANGLES;
        let mut moving = vec![-1; scene.bodies.len()];
        (0..).zip(&motion.bodies).for_each(|(slot, &body)| moving[body] = slot);
        // The first shape of each body.
        let mut first = vec![None; scene.bodies.len()];
        for (i, body) in scene.bodies.iter().enumerate() {
            let desc = &body.desc;
            for shape in &desc.shapes {
                let mesh = *made
                    .entry(shape.geometry.key())
                    .or_insert_with(|| self.add_mesh(&shape.geometry, &mut room));
                let Some(mesh) = mesh else { continue };
                first[i].get_or_insert(self.shapes.len());
                self.shapes.push([mesh, tone(desc.kind, &shape.geometry), moving[i]]);
                self.places.push(if moving[i] < 0 {
                    let at = desc.position + (desc.rotation * shape.position).as_dvec3();
                    motion.pose(at, desc.rotation * shape.rotation)
                } else {
                    let ([x, y, z], [a, b, c, w]) = (shape.position.to_array(), shape.rotation.to_array());
                    [x, y, z, a, b, c, w]
                });
            }
        }
        let link = |bodies: [usize; 2]| Some([first[bodies[0]]?, first[bodies[1]]?]);
        self.links = scene.joints.iter().filter_map(|joint| link(joint.bodies)).collect();
    }

    /// The index of a new mesh; none if there is no room for its triangles.
    fn add_mesh(&mut self, geometry: &Geometry, room: &mut usize) -> Option<i32> {
        let mut known = HashMap::<[u32; 3], u32>::new();
        let (mut vertices, mut triangles) = (Vec::<Vec3>::new(), Vec::new());
        debug::triangles(geometry, None, &mut |corners| {
            triangles.extend(corners.map(|corner| {
                *known.entry(corner.to_array().map(f32::to_bits)).or_insert_with(|| {
                    vertices.push(corner);
                    vertices.len() as u32 - 1
                })
            }));
        });
        let number = triangles.len() / 3;
        if number > *room {
            self.notes.push(format!("A mesh of {} triangles is left out.", count(number as u64)));
            return None;
        }
        *room -= number;
        self.meshes.push(Mesh {
            vertices: packed(vertices.iter().flat_map(Vec3::to_array).map(f32::to_le_bytes)),
            triangles: packed(triangles.into_iter().map(u32::to_le_bytes)),
        });
        Some(self.meshes.len() as i32 - 1)
    }
}
