//! glTF 2.0 in, with `KHR_physics_rigid_bodies` and `KHR_implicit_shapes` (Khronos, drafts of 2024).
//!
//! A node with `motion` is a body at that node, made of its own collider and those of its descendants up to
//! the next `motion`. A collider without such an ancestor is a static body. A file without physics is one
//! static mesh.
//!
//! A joint is between the bodies of its node and of the connected one. A node without `motion` at or above it
//! stands on the nearest static body at or above it, so that the joined body doesn't collide with its
//! support, and where there is none on a body without shapes, the world.
//!
//! Properties without names in the extension are in the object `backstop` of the `extras` of its objects:
//! rolling and spinning friction and the surface velocity of a material, caps and damping of a motion's
//! speeds, and at its root the couplings of joints (docs/levels.md).

mod accessor;
mod couplings;
pub(super) mod extension;
pub(super) mod file;
mod filter;
mod joints;
mod loader;
mod motion;
mod problem;
mod shapes;
pub(super) mod tree;

#[cfg(test)]
mod tests;

use super::assets;
use super::resolve::Resolver;
use crate::weld::Welded;
use crate::{Scene, SceneError};
use backstop::BodyDesc;
use backstop::Tally;
use backstop::{Geometry, ShapeDesc};
use extension::{NodePhysics, RIGID_BODIES};
use file::Parts;
use loader::{Loader, parse};
use problem::problem;
use std::path::Path;
use tree::Tree;

pub(super) fn read(
    path: &Path,
    bytes: &[u8],
    resolve: &Resolver<'_>,
    mut tally: Tally,
) -> Result<Scene, SceneError> {
    let parts = Parts::parse(path, bytes, resolve, &mut tally)?;
    let tree = Tree::new(&parts, &mut tally)?;
    let name = path.file_stem().and_then(|s| s.to_str()).unwrap_or("scene");
    let mut scene = Scene::new(name);
    scene.parts = file::referred(path, &parts.json);
    for unknown in &parts.unknown_required {
        scene.notes.push(format!("the extension {unknown}, which the file requires, is ignored"));
    }
    let physics: Vec<Option<NodePhysics>> = parts
        .document
        .nodes()
        .map(|n| n.extension_value(RIGID_BODIES).map(|v| parse(&parts, v)).transpose())
        .collect::<Result<_, _>>()?;
    if physics.iter().all(Option::is_none) {
        static_mesh(&parts, &tree, &mut scene, &mut tally)?;
        return Ok(scene);
    }
    let mut loader = Loader::new(&parts, &tree, physics, scene, tally)?;
    loader.charge()?;
    for &node in &tree.order {
        loader.visit(node)?;
    }
    loader.finish()
}

/// All meshes of the scene as one static body at the origin.
fn static_mesh(parts: &Parts, tree: &Tree, scene: &mut Scene, tally: &mut Tally) -> Result<(), SceneError> {
    let mut welded = Welded::default();
    let nodes: Vec<gltf::Node> = parts.document.nodes().collect();
    // All of them are one mesh: before the first is made it is known how large that is.
    for &node in &tree.order {
        for primitive in nodes[node].mesh().iter().flat_map(|m| m.primitives()) {
            shapes::charge(&primitive, &mut tally.vertices, &mut tally.triangles)
                .map_err(|p| problem(parts, node, p))?;
        }
    }
    for &node in &tree.order {
        for primitive in nodes[node].mesh().iter().flat_map(|m| m.primitives()) {
            shapes::add_primitive(parts, &primitive, &tree.global[node], &mut welded)
                .map_err(|p| problem(parts, node, p))?;
        }
    }
    if welded.triangles.is_empty() {
        let what = "it has neither physics (KHR_physics_rigid_bodies) nor a triangle with an area".into();
        return Err(SceneError::Malformed { file: parts.path.clone(), what });
    }
    let name = scene.name.clone();
    let mesh = assets::mesh(&welded.vertices, &welded.triangles).map_err(|source| SceneError::Body {
        file: parts.path.clone(),
        node: name.clone(),
        source,
    })?;
    scene.add(name, BodyDesc::fixed().with_shape(ShapeDesc::new(Geometry::Mesh(mesh))));
    Ok(())
}
