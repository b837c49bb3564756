//! Content of a scene for the adapters.

use anyhow::Context;
use backstop::glam::Vec3;
use backstop::{Geometry, Motion, TriangleMesh};
use backstop_scene::{Scene, SceneJoint};
use std::collections::HashMap;
use std::sync::Arc;

/// How a joint turns, in the words that every engine has. Cones and twists of ball joints are left out: no
/// two engines mean the same by them.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) enum Turning {
    /// Freely about a point.
    Ball,
    /// About the x axis of its frames, within a range if there is one [rad].
    Hinge(Option<[f32; 2]>),
}

/// How a joint turns; with `ranges` also how far.
pub(crate) fn turning(joint: &SceneJoint, ranges: bool) -> Turning {
    let mut angular = joint.limits.iter().filter(|limit| limit.motion == Motion::Angular);
    let locked = |min: f32, max: f32| min == 0.0 && max == 0.0;
    if !angular.clone().any(|limit| locked(limit.min, limit.max)) {
        return Turning::Ball;
    }
    let range = angular.find(|limit| !locked(limit.min, limit.max) && limit.min.is_finite());
    Turning::Hinge(range.filter(|_| ranges).map(|limit| [limit.min, limit.max]))
}

/// The vertices of a mesh, each once, and its triangles.
pub(crate) type Triangles = (Vec<Vec3>, Vec<[u32; 3]>);

/// The meshes of a scene as engines take them, made before memory and times are measured.
pub(crate) struct Meshes(HashMap<usize, Triangles>);

impl Meshes {
    pub(crate) fn of(scene: &Scene) -> Meshes {
        let shapes = scene.bodies.iter().flat_map(|body| &body.desc.shapes);
        let meshes = shapes.filter_map(|shape| match &shape.geometry {
            Geometry::Mesh(mesh) => Some((key(mesh), triangles(mesh))),
            _ => None,
        });
        Meshes(meshes.collect())
    }

    /// Those of one of the scene's.
    pub(super) fn get(&self, mesh: &Arc<TriangleMesh>) -> anyhow::Result<&Triangles> {
        self.0.get(&key(mesh)).context("a mesh of another scene")
    }
}

/// Identity of a shared geometry: bodies that share it in the scene share it in engines that can.
pub(super) fn key<T>(shared: &Arc<T>) -> usize {
    Arc::as_ptr(shared) as usize
}

fn triangles(mesh: &TriangleMesh) -> Triangles {
    let (mut vertices, mut numbers) = (Vec::new(), HashMap::new());
    let triangles = (0..).map_while(|triangle| mesh.corners(triangle)).map(|corners| {
        corners.map(|corner| {
            *numbers.entry(corner.to_array().map(f32::to_bits)).or_insert_with(|| {
                vertices.push(corner);
                vertices.len() as u32 - 1
            })
        })
    });
    let triangles = triangles.collect();
    (vertices, triangles)
}
