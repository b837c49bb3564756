//! Changes of shapes that are there.

use super::hierarchy::Hierarchy;
use crate::components::body::RigidBody;
use crate::components::shape::{Shape, ShapeChanged, ShapeParts, ShapePartsItem};
use crate::convert::ToEngine;
use crate::messages::Problem;
use crate::world::{PhysicsWorld, Place, SHAPES};
use backstop::{Error, ShapeDesc, ShapeHandle, World};
use bevy_ecs::prelude::{ChildOf, Entity, Query, ResMut, With, Without};

/// The description of a shape at its place.
pub(super) fn describe(entity: Entity, parts: &ShapePartsItem, place: &Place) -> Result<ShapeDesc, Problem> {
    let refused = Problem::Scale { shape: parts.shape.0.kind_name(), scale: place.scale };
    let desc = parts
        .desc(entity, place.scale)
        .ok_or(refused)?
        .with_position(place.position.to_engine())
        .with_rotation(place.rotation.to_engine());
    desc.validate()?;
    Ok(desc)
}

/// The shape on the entity of a body that is below another entity.
type OnBodyBelow = (With<Shape>, With<RigidBody>, With<ChildOf>);

/// Takes over what changed about shapes that are there, and where they are on their bodies.
pub(crate) fn change_shapes(
    mut physics: ResMut<PhysicsWorld>,
    changed: Query<Entity, ShapeChanged>,
    bodies_below: Query<Entity, OnBodyBelow>,
    below: Query<Entity, (With<Shape>, Without<RigidBody>)>,
    shapes: Query<ShapeParts>,
    hierarchy: Hierarchy,
) {
    let physics = &mut *physics;
    // What is below a body, or above it, may have been moved by anything in between.
    let moved = std::mem::take(&mut physics.moved);
    for shape in moved.iter().copied().chain(&bodies_below).chain(&below) {
        let Some(state) = physics.shapes.get(&shape) else { continue };
        let place = hierarchy.place(shape);
        if place == Some((state.body, state.place)) {
            continue;
        }
        match place {
            Some((body, _)) if body == state.body => physics.changed_shapes.push(shape),
            _ => {
                physics.remove_shape_of(shape);
                physics.waiting[SHAPES].insert(shape, String::new());
            }
        }
    }
    physics.moved = moved;
    let lost = std::mem::take(&mut physics.changed_shapes);
    let forms = std::mem::take(&mut physics.new_shapes);
    let others = changed.iter().chain(lost).map(|shape| (shape, false));
    for (shape, formed) in forms.iter().map(|&shape| (shape, true)).chain(others) {
        let Some(state) = physics.shapes.get(&shape) else { continue };
        let (handle, body, scale) = (state.handle, state.body, state.place.scale);
        let (Ok(parts), Some((_, place))) = (shapes.get(shape), hierarchy.place(shape)) else { continue };
        let result = describe(shape, &parts, &place).and_then(|desc| {
            let reshaped = formed || place.scale != scale;
            Ok(update_shape(physics, handle, &desc, reshaped)?)
        });
        match result {
            Ok(()) => {
                physics.follow_shapes(body);
                if let Some(state) = physics.shapes.get_mut(&shape) {
                    state.place = place;
                }
            }
            Err(problem) => physics.refuse(shape, problem),
        }
    }
    physics.new_shapes = forms;
}

/// Sets what differs from a description.
fn update_shape(
    world: &mut World,
    shape: ShapeHandle,
    desc: &ShapeDesc,
    reshaped: bool,
) -> Result<(), Error> {
    if reshaped {
        world.set_geometry(shape, desc.geometry.clone())?;
    }
    if world.shape_pose(shape)? != (desc.position, desc.rotation) {
        world.set_shape_pose(shape, desc.position, desc.rotation)?;
    }
    if world.material(shape)? != desc.material {
        world.set_material(shape, desc.material)?;
    }
    if world.filter(shape)? != desc.filter {
        world.set_filter(shape, desc.filter)?;
    }
    if world.density(shape)? != desc.density {
        world.set_density(shape, desc.density)?;
    }
    if world.is_sensor(shape)? != desc.sensor {
        world.set_sensor(shape, desc.sensor)?;
    }
    if world.senses_static(shape)? != desc.senses_static {
        world.set_senses_static(shape, desc.senses_static)?;
    }
    if (world.has_events(shape)?, world.has_hooks(shape)?) != (desc.events, desc.hooks) {
        world.set_events(shape, desc.events)?;
        world.set_hooks(shape, desc.hooks)?;
    }
    Ok(())
}
