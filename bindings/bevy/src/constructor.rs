//! Shapes made of Bevy's meshes, when these have loaded (feature `mesh`).

use crate::components::shape::{Shape, ShapeOffset};
use crate::messages::{PhysicsError, Problem};
use crate::world::PhysicsWorld;
use backstop::{ConvexHull, Geometry, TriangleMesh, glam};
use bevy_app::prelude::*;
use bevy_asset::{AssetId, Assets};
use bevy_ecs::name::Name;
use bevy_ecs::prelude::*;
use bevy_mesh::{Mesh, Mesh3d, PrimitiveTopology, VertexAttributeValues};
use std::collections::HashMap;

/// Makes [`Shape`]s of meshes: [`ShapeConstructor`] and [`ShapeConstructorHierarchy`]. Needs Bevy's
/// `AssetPlugin` and `MeshPlugin`, which `DefaultPlugins` has.
#[derive(Clone, Copy, Debug, Default)]
pub struct BackstopMeshPlugin;

/// What shape is made of the `Mesh3d` beside it, when its mesh has loaded: the component then goes, and
/// [`Shape`] and [`ShapeOffset`] are there. A mesh that can't be such a shape is a
/// [`PhysicsError`].
///
/// Boxes, spheres, capsules and cylinders are of the axis-aligned box around the vertices: a sphere is around
/// its centre, as far as the farthest vertex; capsules and cylinders stand along y. The mesh has to be in
/// memory: `RenderAssetUsages` with `MAIN_WORLD`, as by default.
#[derive(Component, Clone, Copy, Debug, PartialEq, Eq)]
pub enum ShapeConstructor {
    /// The box around the vertices.
    Cuboid,
    /// A ball around all vertices.
    Sphere,
    /// A capsule along y, as high and wide as the box around the vertices.
    Capsule,
    /// A cylinder along y, as high and wide as that.
    Cylinder,
    /// The convex hull of the vertices.
    Hull,
    /// The triangles themselves; only static or kinematic.
    Mesh,
}

/// Gives each entity at or below its own that has a `Mesh3d` and no [`Shape`] a [`ShapeConstructor`]: those
/// that are there, and those that come later, as a scene's do when it has been spawned. Put it beside the
/// scene and a [`RigidBody`](crate::RigidBody).
#[derive(Component, Clone, Debug, Default)]
pub struct ShapeConstructorHierarchy {
    /// What each mesh becomes; none for nothing.
    pub default: Option<ShapeConstructor>,
    /// What meshes on entities of this `Name` become instead; none for nothing.
    pub by_name: HashMap<String, Option<ShapeConstructor>>,
}

impl ShapeConstructorHierarchy {
    /// Each mesh becomes such a shape.
    pub fn new(constructor: ShapeConstructor) -> Self {
        ShapeConstructorHierarchy { default: Some(constructor), by_name: HashMap::new() }
    }
    /// Meshes on entities of this `Name` become another shape, or none.
    #[must_use]
    pub fn with_name(mut self, name: impl Into<String>, constructor: Option<ShapeConstructor>) -> Self {
        self.by_name.insert(name.into(), constructor);
        self
    }
}

impl Plugin for BackstopMeshPlugin {
    fn build(&self, app: &mut App) {
        // Before the fixed schedules of the same frame.
        app.add_systems(PreUpdate, (spread, construct).chain());
    }
}

/// What may be newly below a hierarchy: its mesh or its parent is new.
type New = (With<Mesh3d>, Without<Shape>, Without<ShapeConstructor>, Or<(Changed<Mesh3d>, Changed<ChildOf>)>);

/// Any mesh without a shape.
type Bare = (With<Mesh3d>, Without<Shape>, Without<ShapeConstructor>);

/// Gives meshes at and below hierarchies their constructors.
fn spread(
    mut commands: Commands,
    hierarchies: Query<Ref<ShapeConstructorHierarchy>>,
    new: Query<Entity, New>,
    bare: Query<Entity, Bare>,
    parents: Query<&ChildOf>,
    names: Query<&Name>,
) {
    if hierarchies.is_empty() {
        return;
    }
    let mut give = |entity: Entity, always: bool| {
        let mut upwards = std::iter::once(entity).chain(parents.iter_ancestors(entity));
        let Some(hierarchy) = upwards.find_map(|above| hierarchies.get(above).ok()) else { return };
        if !always && !hierarchy.is_changed() {
            return;
        }
        let own = names.get(entity).ok().and_then(|name| hierarchy.by_name.get(name.as_str()));
        if let Some(constructor) = own.copied().unwrap_or(hierarchy.default) {
            commands.entity(entity).try_insert(constructor);
        }
    };
    new.iter().for_each(|entity| give(entity, true));
    if hierarchies.iter().any(|hierarchy| hierarchy.is_changed()) {
        bare.iter().for_each(|entity| give(entity, false));
    }
}

/// Shapes of meshes that were made already, by mesh and constructor.
type Made = HashMap<(AssetId<Mesh>, u8), Result<(Shape, ShapeOffset), Problem>>;

/// Makes shapes of meshes that have loaded.
fn construct(
    mut commands: Commands,
    meshes: Option<Res<Assets<Mesh>>>,
    waiting: Query<(Entity, &ShapeConstructor, &Mesh3d)>,
    mut physics: Option<ResMut<PhysicsWorld>>,
    mut made: Local<Made>,
) {
    let Some(meshes) = meshes else { return };
    for (entity, constructor, mesh) in &waiting {
        let Some(loaded) = meshes.get(&mesh.0) else { continue };
        let key = (mesh.0.id(), *constructor as u8);
        let shape = made.entry(key).or_insert_with(|| constructor.construct(loaded)).clone();
        let mut commands = commands.entity(entity);
        commands.try_remove::<ShapeConstructor>();
        match shape {
            Ok(shape) => drop(commands.try_insert(shape)),
            Err(problem) => {
                if let Some(physics) = &mut physics {
                    physics.problems.push(PhysicsError { entity: Some(entity), problem });
                }
            }
        }
    }
    // A mesh that is met again in a later frame may have changed.
    made.clear();
}

impl ShapeConstructor {
    /// The shape of a mesh, and where it is in the mesh's axes.
    ///
    /// # Errors
    /// [`Problem::Mesh`] if the mesh has no positions in memory, or no list of triangles where they are asked
    /// for; [`Problem::Engine`] if the engine can't make such a shape of it.
    pub fn construct(self, mesh: &Mesh) -> Result<(Shape, ShapeOffset), Problem> {
        let vertices = positions(mesh)?;
        let at = |position: glam::Vec3| ShapeOffset::at(crate::ToBevy::to_bevy(position));
        match self {
            ShapeConstructor::Hull => {
                return Ok((Shape::hull(ConvexHull::new(&vertices)?), ShapeOffset::default()));
            }
            ShapeConstructor::Mesh => {
                let triangles = triangles(mesh, vertices.len())?;
                return Ok((Shape::mesh(TriangleMesh::new(vertices, triangles)?), ShapeOffset::default()));
            }
            _ => {}
        }
        let low = vertices.iter().copied().reduce(glam::Vec3::min).unwrap_or_default();
        let high = vertices.iter().copied().reduce(glam::Vec3::max).unwrap_or_default();
        let (centre, half) = (0.5 * (low + high), 0.5 * (high - low));
        let across = half.x.max(half.z);
        let geometry = match self {
            ShapeConstructor::Sphere => {
                let far = vertices.iter().map(|vertex| vertex.distance(centre)).fold(0.0, f32::max);
                Geometry::sphere(far)
            }
            ShapeConstructor::Capsule if half.y <= across => Geometry::sphere(across),
            ShapeConstructor::Capsule => Geometry::capsule(half.y - across, across),
            ShapeConstructor::Cylinder => Geometry::cylinder(half.y, across),
            _ => Geometry::cuboid(half.x, half.y, half.z),
        };
        geometry.validate()?;
        Ok((Shape(geometry), at(centre)))
    }
}

fn positions(mesh: &Mesh) -> Result<Vec<glam::Vec3>, Problem> {
    match mesh.try_attribute(Mesh::ATTRIBUTE_POSITION) {
        Ok(VertexAttributeValues::Float32x3(all)) if !all.is_empty() => {
            Ok(all.iter().copied().map(glam::Vec3::from).collect())
        }
        _ => Err(Problem::Mesh("it has no positions in memory")),
    }
}

fn triangles(mesh: &Mesh, vertices: usize) -> Result<Vec<[u32; 3]>, Problem> {
    if mesh.primitive_topology() != PrimitiveTopology::TriangleList {
        return Err(Problem::Mesh("it is no list of triangles"));
    }
    let corners: Vec<u32> = match mesh.try_indices_option() {
        Ok(Some(indices)) => indices.iter().map(|index| index as u32).collect(),
        Ok(None) => (0..vertices as u32).collect(),
        Err(_) => return Err(Problem::Mesh("it has no triangles in memory")),
    };
    Ok(corners.chunks_exact(3).map(|corners| [corners[0], corners[1], corners[2]]).collect())
}
