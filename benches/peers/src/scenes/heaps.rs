//! Bodies that fall and come to rest in a heap.

use super::{Error, Mixed, Subject, add_mesh, below, beyond_pen, grid, pen};
use backstop::glam::Vec3;
use backstop::{BodyDesc, Geometry, ShapeDesc};
use backstop_scene::builtin::{self, dynamic, pebble, talk_terrain};
use backstop_scene::{Rng, Scene, axis_angle};
use std::f32::consts::TAU;
use std::sync::Arc;

/// 4,096 boxes, balls, capsules and hulls in an open box of 16 m.
pub(super) fn pile() -> Subject {
    Subject { beyond: beyond_pen(8.0, 30.0), ..Subject::new(builtin::pile(), Error::Depth) }
}

/// 1,500 hulls in a shaft of 9.2 m.
pub(super) fn hulls() -> Subject {
    let (half, height) = (4.6, 20.0);
    let mut scene = Scene::new("hulls");
    pen(&mut scene, half, height);
    let mut rng = Rng::new(32);
    let hulls: Vec<Geometry> = (0..16).map(|_| pebble(32, Vec3::new(0.42, 0.35, 0.38), &mut rng)).collect();
    grid(&mut scene, (1500, 10), (0.9, 0.6), &mut rng, |i| hulls[i % hulls.len()].clone());
    Subject { beyond: beyond_pen(half, height), ..Subject::new(scene, Error::Depth) }
}

/// 1,000 hulls and boxes on the terrain of [`builtin::talk`].
pub(super) fn on_mesh() -> Subject {
    let terrain = talk_terrain();
    let mut scene = Scene::new("mesh_heap");
    add_mesh(&mut scene, "terrain", Vec3::ZERO, terrain.mesh());
    let mut rng = Rng::new(33);
    let hulls: Vec<Geometry> = (0..8).map(|_| pebble(16, Vec3::new(0.4, 0.3, 0.35), &mut rng)).collect();
    grid(&mut scene, (1000, 16), (1.2, 5.0), &mut rng, |i| match i % 2 {
        0 => Geometry::cuboid(0.35, 0.25, 0.4),
        _ => hulls[i / 2 % hulls.len()].clone(),
    });
    Subject { beyond: below(terrain), ..Subject::new(scene, Error::Lost) }
}

/// Columns of the voxels along x and z, of 1 m.
const COLUMNS: i32 = 64;

/// How many voxels stand in a column: none outside.
fn voxels_at(x: i32, z: i32) -> i32 {
    if !(0..COLUMNS).contains(&x) || !(0..COLUMNS).contains(&z) {
        return 0;
    }
    let (u, v) = (x as f32, z as f32);
    let hills = 2.0 * libm::sinf(0.23 * u) * libm::cosf(0.19 * v) + libm::sinf(0.71 * u + 1.3 * v);
    // Single columns and holes between the hills.
    let rough = (x * 7 + z * 13 + x * z) % 5 == 0;
    (4.0 + hills) as i32 + i32::from(rough)
}

/// Two triangles for each face of a voxel that one can see.
fn voxel_mesh() -> (Vec<Vec3>, Vec<[u32; 3]>) {
    let (mut vertices, mut triangles) = (Vec::new(), Vec::new());
    // A square from a corner and its two sides; seen from where they turn counter-clockwise.
    let mut face = |corner: Vec3, a: Vec3, b: Vec3| {
        let first = vertices.len() as u32;
        vertices.extend([corner, corner + a, corner + a + b, corner + b]);
        triangles.extend([[first, first + 1, first + 2], [first, first + 2, first + 3]]);
    };
    for (x, z) in (0..COLUMNS).flat_map(|x| (0..COLUMNS).map(move |z| (x, z))) {
        let height = voxels_at(x, z);
        let at = |y: i32| Vec3::new((x - COLUMNS / 2) as f32, y as f32, (z - COLUMNS / 2) as f32);
        face(at(height), Vec3::Z, Vec3::X);
        for y in 0..height {
            if voxels_at(x - 1, z) <= y {
                face(at(y), Vec3::Z, Vec3::Y);
            }
            if voxels_at(x + 1, z) <= y {
                face(at(y) + Vec3::X, Vec3::Y, Vec3::Z);
            }
            if voxels_at(x, z - 1) <= y {
                face(at(y), Vec3::Y, Vec3::X);
            }
            if voxels_at(x, z + 1) <= y {
                face(at(y) + Vec3::Z, Vec3::X, Vec3::Y);
            }
        }
    }
    (vertices, triangles)
}

/// 1,000 mixed bodies on the faces of voxels, as a game of blocks has them.
pub(super) fn voxels() -> Subject {
    let mut scene = Scene::new("voxels");
    let (vertices, triangles) = voxel_mesh();
    add_mesh(&mut scene, "voxels", Vec3::ZERO, welded(&vertices, &triangles));
    let mut rng = Rng::new(34);
    let mixed = Mixed::new(0.4, &mut rng);
    grid(&mut scene, (1000, 20), (1.3, 9.0), &mut rng, |i| mixed.shape(i));
    let beyond = Arc::new(|p: Vec3| {
        let column = |x: f32| x.floor() as i32 + COLUMNS / 2;
        match voxels_at(column(p.x), column(p.z)) {
            0 => f32::NEG_INFINITY,
            height => height as f32 - p.y,
        }
    });
    Subject { beyond, ..Subject::new(scene, Error::Lost) }
}

/// The same triangles with each vertex once, so that neighbours know each other.
fn welded(vertices: &[Vec3], triangles: &[[u32; 3]]) -> (Vec<Vec3>, Vec<[u32; 3]>) {
    let (mut once, mut places) = (Vec::new(), std::collections::HashMap::new());
    let mut vertex = |i: u32| {
        let p = vertices[i as usize];
        *places.entry(p.to_array().map(|x| x as i32)).or_insert_with(|| {
            once.push(p);
            once.len() as u32 - 1
        })
    };
    let triangles = triangles.iter().map(|corners| corners.map(&mut vertex)).collect();
    (once, triangles)
}

/// 800 planks of 1.2 by 0.08 by 0.24 m, thrown together in a pen of 6 m.
pub(super) fn planks() -> Subject {
    let (half, height) = (3.0, 24.0);
    let mut scene = Scene::new("planks");
    pen(&mut scene, half, height);
    let mut rng = Rng::new(35);
    for i in 0..800 {
        let (x, z, layer) = (i % 4, i / 4 % 4, i / 16);
        let at = Vec3::new((x as f32 - 1.5) * 1.35, 0.5 + 0.42 * layer as f32, (z as f32 - 1.5) * 1.35);
        let flat = axis_angle(Vec3::Y, rng.range(0.0, TAU));
        let rotation = rng.small_rotation(0.2) * flat;
        scene
            .add("plank", dynamic(Geometry::cuboid(0.6, 0.04, 0.12), at).with_rotation(rotation.normalize()));
    }
    Subject { beyond: beyond_pen(half, height), ..Subject::new(scene, Error::Depth) }
}

/// A chair of six boxes: seat, back and legs.
fn chair(at: Vec3) -> BodyDesc {
    let part = |half: [f32; 3], at: [f32; 3]| {
        ShapeDesc::new(Geometry::cuboid(half[0], half[1], half[2])).with_position(Vec3::from_array(at))
    };
    let mut desc = BodyDesc::dynamic()
        .with_position(at)
        .with_shape(part([0.22, 0.02, 0.22], [0.0, 0.0, 0.0]))
        .with_shape(part([0.22, 0.25, 0.02], [0.0, 0.27, -0.2]));
    for (x, z) in [(-1.0, -1.0), (-1.0, 1.0), (1.0, -1.0), (1.0, 1.0)] {
        desc = desc.with_shape(part([0.02, 0.22, 0.02], [0.2 * x, -0.24, 0.2 * z]));
    }
    desc
}

/// 250 chairs in a pen of 5 m, each of six boxes.
pub(super) fn chairs() -> Subject {
    let (half, height) = (2.5, 24.0);
    let mut scene = Scene::new("chairs");
    pen(&mut scene, half, height);
    let mut rng = Rng::new(36);
    for i in 0..250 {
        let (x, z, layer) = (i % 4, i / 4 % 4, i / 16);
        let at = Vec3::new((x as f32 - 1.5) * 1.2, 0.8 + 1.25 * layer as f32, (z as f32 - 1.5) * 1.2);
        scene.add("chair", chair(at).with_rotation(rng.rotation()));
    }
    Subject { beyond: beyond_pen(half, height), ..Subject::new(scene, Error::Depth) }
}
