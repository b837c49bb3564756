//! Components of shapes.

use crate::ToEngine;
use crate::world::PhysicsWorld;
use backstop::{ConvexHull, Filter, Geometry, HeightField, Material, ShapeDesc, TriangleMesh};
use bevy_ecs::lifecycle::HookContext;
use bevy_ecs::prelude::*;
use bevy_ecs::query::QueryData;
use bevy_ecs::world::DeferredWorld;
use bevy_math::{Quat, Vec3};
#[cfg(feature = "reflect")]
use bevy_reflect::std_traits::ReflectDefault;
use bevy_transform::components::Transform;
use std::sync::Arc;

/// A shape of the nearest [`RigidBody`](crate::RigidBody) on its entity or above it. Below the body it is
/// where its `Transform` puts it, in the body's frame; several shapes make a compound.
///
/// A scale, its own or from above, scales balls, capsules and cylinders by one factor, all others by three. A
/// scaled hull, mesh or field is built anew whenever the scale changes. Other scales are refused.
#[derive(Component, Clone, Debug)]
#[cfg_attr(feature = "reflect", derive(bevy_reflect::TypePath, serde::Serialize, serde::Deserialize))]
#[require(Transform)]
#[component(on_remove = shape_removed)]
#[component(summary_tick)]
pub struct Shape(pub Geometry);

impl Shape {
    /// A ball.
    pub fn sphere(radius: f32) -> Self {
        Shape(Geometry::sphere(radius))
    }
    /// A box by its half extents.
    pub fn cuboid(x: f32, y: f32, z: f32) -> Self {
        Shape(Geometry::cuboid(x, y, z))
    }
    /// A capsule around the y axis.
    pub fn capsule(half_height: f32, radius: f32) -> Self {
        Shape(Geometry::capsule(half_height, radius))
    }
    /// A cylinder around the y axis.
    pub fn cylinder(half_height: f32, radius: f32) -> Self {
        Shape(Geometry::cylinder(half_height, radius))
    }
    /// A cone around the y axis, with its tip up.
    pub fn cone(half_height: f32, radius: f32) -> Self {
        Shape(Geometry::cone(half_height, radius))
    }
    /// A convex hull.
    pub fn hull(hull: impl Into<Arc<ConvexHull>>) -> Self {
        Shape(Geometry::hull(hull))
    }
    /// The half-space y <= 0; only static or kinematic.
    pub fn plane() -> Self {
        Shape(Geometry::plane())
    }
    /// A triangle mesh; only static or kinematic.
    pub fn mesh(mesh: impl Into<Arc<TriangleMesh>>) -> Self {
        Shape(Geometry::mesh(mesh))
    }
    /// A grid of heights; only static or kinematic.
    pub fn height_field(field: impl Into<Arc<HeightField>>) -> Self {
        Shape(Geometry::height_field(field))
    }
}

impl From<Geometry> for Shape {
    fn from(geometry: Geometry) -> Self {
        Shape(geometry)
    }
}

/// Friction and restitution of a shape; the default [`Material`] without this.
#[derive(Component, Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "reflect", derive(bevy_reflect::TypePath, serde::Serialize, serde::Deserialize))]
#[component(on_remove = trait_removed)]
pub struct ShapeMaterial(pub Material);

/// Which shapes a shape collides with; all without this.
#[derive(Component, Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "reflect", derive(bevy_reflect::TypePath, serde::Serialize, serde::Deserialize))]
#[component(on_remove = trait_removed)]
pub struct ShapeFilter(pub Filter);

/// Where a shape is in the axes of its own entity; at its origin without this.
#[derive(Component, Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "reflect", derive(bevy_reflect::Reflect), reflect(Component, Clone, Default))]
#[component(on_remove = trait_removed)]
pub struct ShapeOffset {
    /// Of the shape's origin [m], before any scale.
    pub position: Vec3,
    /// How the shape is turned.
    pub rotation: Quat,
}

impl Default for ShapeOffset {
    fn default() -> Self {
        ShapeOffset { position: Vec3::ZERO, rotation: Quat::IDENTITY }
    }
}

impl ShapeOffset {
    /// At a point, not turned.
    pub fn at(position: Vec3) -> Self {
        ShapeOffset { position, rotation: Quat::IDENTITY }
    }
}

/// Density of a shape [kg/m³]; 1000 without this.
#[derive(Component, Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "reflect", derive(bevy_reflect::Reflect), reflect(Component, Clone))]
#[component(on_remove = trait_removed)]
pub struct Density(pub f32);

/// A shape that pushes nothing and notices what comes into it: [`SensorEntered`](crate::SensorEntered),
/// [`SensorLeft`](crate::SensorLeft).
#[derive(Component, Clone, Copy, Debug, Default, PartialEq)]
#[cfg_attr(feature = "reflect", derive(bevy_reflect::Reflect), reflect(Component, Clone, Default))]
#[component(on_remove = trait_removed)]
pub struct Sensor;

/// A [`Sensor`] that also notices static bodies, and the surfaces of meshes and height fields.
#[derive(Component, Clone, Copy, Debug, Default, PartialEq)]
#[cfg_attr(feature = "reflect", derive(bevy_reflect::Reflect), reflect(Component, Clone, Default))]
#[require(Sensor)]
#[component(on_remove = trait_removed)]
pub struct SensesStatic;

/// A shape whose contacts are reported: [`ContactBegan`](crate::ContactBegan),
/// [`ContactEnded`](crate::ContactEnded), [`ContactHit`](crate::ContactHit).
#[derive(Component, Clone, Copy, Debug, Default, PartialEq)]
#[cfg_attr(feature = "reflect", derive(bevy_reflect::Reflect), reflect(Component, Clone, Default))]
#[component(on_remove = trait_removed)]
pub struct ContactMessages;

/// A shape whose contacts are shown to [`PhysicsHooks`](crate::PhysicsHooks).
#[derive(Component, Clone, Copy, Debug, Default, PartialEq)]
#[cfg_attr(feature = "reflect", derive(bevy_reflect::Reflect), reflect(Component, Clone, Default))]
#[component(on_remove = trait_removed)]
pub struct ContactHooked;

impl ShapeMaterial {
    /// One coefficient of friction.
    pub fn friction(friction: f32) -> Self {
        ShapeMaterial(Material::default().with_friction(friction))
    }
    /// A share of the approach speed that comes back, 0..=1.
    pub fn restitution(restitution: f32) -> Self {
        ShapeMaterial(Material::default().with_restitution(restitution))
    }
}

/// All that is said of a shape but its place.
#[derive(QueryData)]
pub(crate) struct ShapeParts {
    pub(crate) shape: &'static Shape,
    material: Option<&'static ShapeMaterial>,
    filter: Option<&'static ShapeFilter>,
    density: Option<&'static Density>,
    sensor: Has<Sensor>,
    senses_static: Has<SensesStatic>,
    messages: Has<ContactMessages>,
    hooked: Has<ContactHooked>,
}

/// A change of any of it but the form.
pub(crate) type ShapeChanged = Or<(
    Changed<ShapeMaterial>,
    Changed<ShapeFilter>,
    Changed<ShapeOffset>,
    Changed<Density>,
    Changed<Sensor>,
    Changed<SensesStatic>,
    Changed<ContactMessages>,
    Changed<ContactHooked>,
)>;

impl ShapePartsItem<'_, '_> {
    /// The description, at its body's origin.
    pub(crate) fn desc(&self, entity: Entity, scale: Vec3) -> Option<ShapeDesc> {
        let mut desc = ShapeDesc::new(scaled(&self.shape.0, scale)?).with_user_data(entity.to_bits());
        desc.material = self.material.map_or(desc.material, |material| material.0);
        desc.filter = self.filter.map_or(desc.filter, |filter| filter.0);
        desc.density = self.density.map_or(desc.density, |density| density.0);
        (desc.sensor, desc.senses_static) = (self.sensor, self.senses_static);
        (desc.events, desc.hooks) = (self.messages, self.hooked);
        Some(desc)
    }
}

/// A form with a scale, if that is such a form again.
fn scaled(geometry: &Geometry, scale: Vec3) -> Option<Geometry> {
    if scale == Vec3::ONE {
        return Some(geometry.clone());
    }
    if scale.min_element() <= 0.0 || !scale.is_finite() {
        return None;
    }
    geometry.scaled(scale.to_engine()).ok()
}
fn shape_removed(mut world: DeferredWorld, context: HookContext) {
    if let Some(mut physics) = world.get_resource_mut::<PhysicsWorld>() {
        physics.remove_shape_of(context.entity);
    }
}

fn trait_removed(mut world: DeferredWorld, context: HookContext) {
    if let Some(mut physics) = world.get_resource_mut::<PhysicsWorld>() {
        physics.changed_shapes.push(context.entity);
    }
}
