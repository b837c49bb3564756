//! Scene files do what their names say: the conformance files of the glTF physics extensions if they are at
//! hand (`BACKSTOP_DATA`), files of the same families written here, and samples and level meshes under a rain
//! of bodies.
#![allow(clippy::disallowed_methods, reason = "expected values may use the platform's functions")]
#[path = "../../../../tests/common/data.rs"]
mod data;

mod files;
mod filters;
mod joints;
mod materials;
mod matrix;
mod motion;
mod pairs;
mod rain;
mod samples;

use backstop::glam::{DQuat, DVec3, Quat, Vec3};
use backstop::{BodyHandle, BodyKind, Geometry, JointHandle, Settings, World};
use backstop_scene::{Added, Scene, load};
use data::data;
use serde_json::{Value, json};
use std::path::{Path, PathBuf};

/// Steps that scenes are run at [s].
const STEPS: [f32; 3] = [1.0 / 30.0, 1.0 / 60.0, 1.0 / 240.0];

/// Limits of rest: linear [m/s] and angular [rad/s] speed.
const REST: (f32, f32) = (0.02, 0.05);

/// The files of a family, in order.
fn family(folder: &Path, name: &str) -> Vec<PathBuf> {
    let mut out: Vec<PathBuf> = std::fs::read_dir(folder)
        .unwrap()
        .map(|e| e.unwrap().path())
        .filter(|p| p.extension().is_some_and(|e| e == "gltf" || e == "glb"))
        .filter(|p| p.file_stem().unwrap().to_str().unwrap().contains(name))
        .collect();
    out.sort();
    assert!(!out.is_empty(), "no files of {name} in {}", folder.display());
    out
}

/// A scene in a world.
struct Run {
    world: World,
    /// In the order of the scene's bodies.
    bodies: Vec<BodyHandle>,
    /// In the order of the scene's joints.
    joints: Vec<JointHandle>,
}

/// A body's state.
#[derive(Clone, Copy, Debug)]
struct Is {
    position: DVec3,
    rotation: Quat,
    linear: Vec3,
    angular: Vec3,
}

impl Is {
    fn at_rest(&self) -> bool {
        self.linear.length() < REST.0 && self.angular.length() < REST.1
    }
}

impl Run {
    fn new(scene: &Scene) -> Run {
        Run::with(scene, Settings::default())
    }

    fn with(scene: &Scene, settings: Settings) -> Run {
        let mut world = World::new(settings.with_gravity(scene.gravity)).unwrap();
        let Added { bodies, joints, .. } = scene.add_to(&mut world).unwrap();
        Run { world, bodies, joints }
    }

    fn file(path: &Path) -> Run {
        Run::new(&load(path).unwrap())
    }

    fn for_seconds(&mut self, seconds: f32, dt: f32) {
        for _ in 0..(seconds / dt).round() as u32 {
            self.world.step(dt).unwrap();
        }
    }

    fn body(&self, i: usize) -> Is {
        let (world, body) = (&self.world, self.bodies[i]);
        let is = Is {
            position: world.position(body).unwrap(),
            rotation: world.rotation(body).unwrap(),
            linear: world.linear_velocity(body).unwrap(),
            angular: world.angular_velocity(body).unwrap(),
        };
        let finite = is.position.is_finite()
            && is.rotation.is_finite()
            && is.linear.is_finite()
            && is.angular.is_finite();
        assert!(finite, "body {i}: {is:?}");
        is
    }

    fn dynamic(&self) -> Vec<usize> {
        let dynamic = |i: &usize| self.world.kind(self.bodies[*i]).unwrap() == BodyKind::Dynamic;
        (0..self.bodies.len()).filter(dynamic).collect()
    }
}

/// A node's physics.
fn physics(value: Value) -> Value {
    json!({ "KHR_physics_rigid_bodies": value })
}

/// A file with the given nodes, shapes and root object of the physics extension, loaded.
fn written(test: &str, nodes: Value, shapes: Value, root: Value) -> Scene {
    let children: Vec<u64> = nodes
        .as_array()
        .unwrap()
        .iter()
        .flat_map(|n| n["children"].as_array().into_iter().flatten().filter_map(Value::as_u64))
        .collect();
    let count = nodes.as_array().unwrap().len() as u64;
    let roots: Vec<u64> = (0..count).filter(|n| !children.contains(n)).collect();
    let file = json!({
        "asset": { "version": "2.0" },
        "extensionsUsed": ["KHR_implicit_shapes", "KHR_physics_rigid_bodies"],
        "extensionsRequired": ["KHR_implicit_shapes", "KHR_physics_rigid_bodies"],
        "scene": 0,
        "scenes": [{ "nodes": roots }],
        "nodes": nodes,
        "extensions": { "KHR_implicit_shapes": { "shapes": shapes }, "KHR_physics_rigid_bodies": root }
    });
    let dir = std::env::temp_dir().join(format!("backstop_conformance_{}", std::process::id()));
    std::fs::create_dir_all(&dir).unwrap();
    let path = dir.join(format!("{test}.gltf"));
    std::fs::write(&path, file.to_string()).unwrap();
    load(&path).unwrap()
}

/// Asserts |a - b| <= tolerance, in every component.
#[track_caller]
fn near3(a: Vec3, b: Vec3, tolerance: f32, what: &str) {
    assert!((a - b).abs().max_element() <= tolerance, "{what}: {a} instead of {b}");
}
