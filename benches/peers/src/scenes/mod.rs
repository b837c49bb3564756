//! Scenes of the comparison, as backstop's own, with facts for the judge.
//!
//! All bodies have friction 0.6, restitution 0 unless said otherwise, and density 1000 kg/m³; y points up,
//! and gravity is 9.81 m/s². Everything random is seeded, so every engine gets the same scene to the bit.

mod fast;
mod heaps;
mod jointed;
mod machines;
mod scaled;
mod stacks;

use crate::engines::{Config, Continuous};
use backstop::glam::Vec3;
use backstop::{Geometry, TriangleMesh};
use backstop_scene::builtin::{dynamic, fixed, pebble};
use backstop_scene::{Rng, Scene, Terrain};
use std::sync::Arc;

pub(crate) use scaled::Scaling;

/// Length of a step [s].
pub(crate) const DT: f32 = 1.0 / 60.0;

/// How far a centre is beyond a border that it can't have passed [m]; nothing or less where all is well.
pub(crate) type Beyond = Arc<dyn Fn(Vec3) -> f32>;

/// A scene and the measures of its motion.
pub(crate) struct Subject {
    pub(crate) scene: Scene,
    /// Steps that are timed.
    pub(crate) steps: u32,
    pub(crate) continuous: Continuous,
    /// Whether it is at rest at the start and ought to stay so: then drift is error.
    pub(crate) stands: bool,
    /// Whether it comes to rest, and so can fall asleep.
    pub(crate) rests: bool,
    pub(crate) beyond: Beyond,
    /// The error by which engines are compared at equal error.
    pub(crate) error: Error,
}

/// A figure of the judge that grows with the error.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) enum Error {
    /// How far any body of a structure has moved after 3 s.
    Drift,
    /// The deepest overlap at the end.
    Depth,
    /// The widest gap of a joint at any time.
    Joint,
    /// Bodies that passed through something.
    Lost,
}

impl Subject {
    /// Something that comes to rest on a floor at y = 0.
    fn new(scene: Scene, error: Error) -> Subject {
        Subject {
            scene,
            steps: 300,
            continuous: Continuous::Off,
            stands: false,
            rests: true,
            beyond: Arc::new(|p: Vec3| -p.y),
            error,
        }
    }

    /// How an engine is to run it.
    pub(crate) fn config(&self, threads: usize, effort: u32, sleeping: bool) -> Config {
        Config {
            threads,
            effort,
            continuous: self.continuous,
            sleeping,
            length_unit: 1.0,
            max_speed: Some(1000.0),
            max_spin: 200.0,
            hinge_ranges: true,
        }
    }
}

type Make = fn() -> Subject;

/// Every scene by name, in the order of reports, with a description.
pub(crate) const ALL: &[(&str, &str, Make)] = &[
    ("pyramid_60", "pyramid of 60 rows", || stacks::pyramid(60)),
    ("pyramid_100", "pyramid of 100 rows", || stacks::pyramid(100)),
    ("pyramids_196", "196 pyramids of ten rows", stacks::pyramids),
    ("pile", "pile of 4,096 mixed bodies", heaps::pile),
    ("hulls", "1,500 hulls of 32 points in a shaft", heaps::hulls),
    ("mesh_heap", "1,000 hulls and boxes on 100k triangles", heaps::on_mesh),
    ("bullets", "1,000 bullets on a mesh", fast::bullets),
    ("fast_room", "5,000 bodies at 250 m/s in a room", fast::room),
    ("talk", "11 bodies on 100k triangles", fast::talk),
    ("ragdolls", "100 ragdolls in a pen", jointed::ragdolls),
    ("ragdoll_rain", "200 ragdolls on meshes", jointed::ragdoll_rain),
    ("ropes", "50 ropes of 30 links with a weight", jointed::ropes),
    ("joint_grid", "net of 100 by 100 balls", jointed::grid),
    ("drum", "1,500 mixed bodies in a washing drum", machines::drum),
    ("voxels", "1,000 mixed bodies on voxels", heaps::voxels),
    ("planks", "heap of 800 planks", heaps::planks),
    ("chairs", "heap of 250 chairs", heaps::chairs),
    ("cars", "64 cars on hills", machines::cars),
];

/// A scene by its name; those of a scaling too, as `bodies_10000`.
pub(crate) fn build(name: &str) -> anyhow::Result<Subject> {
    let make = ALL.iter().find(|scene| scene.0 == name).map(|scene| scene.2());
    let mut subject = match make {
        Some(subject) => subject,
        None => scaled::named(name).ok_or_else(|| anyhow::anyhow!("no scene \"{name}\""))?,
    };
    subject.scene.name = name.into();
    Ok(subject)
}

/// Half width of walls and floors of pens [m].
const WALL: f32 = 0.5;

/// A floor at y = 0 and four walls, with `half` [m] of free space from the middle to each.
fn pen(scene: &mut Scene, half: f32, height: f32) {
    let floor = Geometry::cuboid(half + 2.0 * WALL, WALL, half + 2.0 * WALL);
    scene.add("floor", fixed(floor, Vec3::new(0.0, -WALL, 0.0)));
    for side in [-1.0, 1.0] {
        let offset = side * (half + WALL);
        let wall = Geometry::cuboid(WALL, 0.5 * height, half + 2.0 * WALL);
        scene.add("wall", fixed(wall, Vec3::new(offset, 0.5 * height, 0.0)));
        let wall = Geometry::cuboid(half, 0.5 * height, WALL);
        scene.add("wall", fixed(wall, Vec3::new(0.0, 0.5 * height, offset)));
    }
}

/// How far beyond the inside of a pen.
fn beyond_pen(half: f32, height: f32) -> Beyond {
    Arc::new(move |p: Vec3| {
        let aside = p.x.abs().max(p.z.abs()) - half;
        (-p.y).max(if p.y < height { aside } else { f32::NEG_INFINITY })
    })
}

/// A mesh at the origin that doesn't move.
fn add_mesh(scene: &mut Scene, name: &str, at: Vec3, (vertices, triangles): (Vec<Vec3>, Vec<[u32; 3]>)) {
    let mesh = TriangleMesh::new(vertices, triangles).expect("triangles made here are in order");
    scene.add(name, fixed(Geometry::Mesh(Arc::new(mesh)), at));
}

/// How far below a terrain.
fn below(terrain: Terrain) -> Beyond {
    Arc::new(move |p: Vec3| match terrain.contains(p.x, p.z) {
        true => terrain.height(p.x, p.z) - p.y,
        false => f32::NEG_INFINITY,
    })
}

/// Boxes, balls, capsules and hulls by turns, each about `size` [m] from its middle to its end.
struct Mixed {
    hulls: Vec<Geometry>,
    size: f32,
}

impl Mixed {
    fn new(size: f32, rng: &mut Rng) -> Mixed {
        let hulls = (0..4).map(|_| pebble(16, Vec3::new(0.95, 0.85, 0.95) * size, rng)).collect();
        Mixed { hulls, size }
    }

    fn shape(&self, i: usize) -> Geometry {
        let s = self.size;
        match i % 4 {
            0 => Geometry::cuboid(0.8 * s, 0.7 * s, 0.9 * s),
            1 => Geometry::sphere(0.85 * s),
            2 => Geometry::capsule(0.6 * s, 0.6 * s),
            _ => self.hulls[i / 4 % 4].clone(),
        }
    }
}

/// Adds `count` bodies in layers of `side` by `side`, `pitch` [m] apart, from `bottom` up.
fn grid(
    scene: &mut Scene,
    (count, side): (usize, usize),
    (pitch, bottom): (f32, f32),
    rng: &mut Rng,
    mut shape: impl FnMut(usize) -> Geometry,
) {
    for i in 0..count {
        let (x, z, layer) = (i % side, i / side % side, i / (side * side));
        let middle = 0.5 * (side as f32 - 1.0);
        let jitter = Vec3::new(rng.range(-0.04, 0.04), 0.0, rng.range(-0.04, 0.04)) * pitch;
        let at = Vec3::new(x as f32 - middle, layer as f32, z as f32 - middle) * pitch + jitter;
        // Shapes shift by one from row to row and layer to layer, so that kinds mix.
        let shape = shape(i + z + layer);
        let name = shape.kind_name();
        scene.add(name, dynamic(shape, at + Vec3::Y * bottom).with_rotation(rng.small_rotation(0.3)));
    }
}
