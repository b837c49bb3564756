//! Shapes of the world's bodies: their form, place and density.

use super::mass::movable;
use crate::body::{BodyDetails, BodyKind};
use crate::error::Error;
use crate::handle::ShapeHandle;
use crate::limits;
use crate::limits::unit_quat;
use crate::math::Quat;
use crate::shape::{Collider, Geometry, MassProperties};
use crate::world::{Addition, Change, World};
use glam::Vec3;

/// Contribution of a shape to the mass of its body, in the body's axes.
struct Part<'a> {
    geometry: &'a Geometry,
    density: f32,
    position: Vec3,
    rotation: Quat,
}

/// # Forms of shapes
impl World {
    /// Form of a shape.
    ///
    /// # Errors
    /// If the handle is stale.
    pub fn geometry(&self, shape: ShapeHandle) -> Result<&Geometry, Error> {
        Ok(&self.colliders.all[self.collider(shape)? as usize].geometry)
    }

    /// Replaces the form of a shape; the mass follows if it is that of the shapes. The shape keeps its handle
    /// and its place; its contacts and its overlaps as a sensor end and begin again. Its present form (of
    /// shared geometry the same, not a copy of it) changes nothing.
    ///
    /// # Errors
    /// If the handle is stale, a number is out of range, the body or a sensor can't have the form, a dynamic
    /// body would be left without mass, or the budget does not allow it.
    pub fn set_geometry(&mut self, shape: ShapeHandle, geometry: Geometry) -> Result<(), Error> {
        let collider = self.collider(shape)?;
        geometry.validate()?;
        let old = &self.colliders.all[collider as usize];
        if old.geometry.is_same(&geometry) {
            return Ok(());
        }
        let kind = self.bodies.kind[old.body as usize];
        if kind == BodyKind::Dynamic || (old.is_sensor() && !matches!(geometry, Geometry::Plane)) {
            geometry.require_convex()?;
        }
        let mass = self.mass_with(collider, &Part { geometry: &geometry, ..self.part_of(collider) })?;
        self.reserve(Addition::Form(&geometry))?;
        self.note(Change::SetGeometry(shape, &geometry));
        let own = self.colliders.rare(collider);
        // Its bytes count before the ends of pairs take any.
        let kept = geometry.clone();
        self.assets.add(&kept);
        self.reshape(collider, mass, |collider, _| collider.set_geometry(geometry, own));
        self.assets.remove(&kept);
        Ok(())
    }

    /// Where a shape's frame is in its body's [m], and how it is turned there.
    ///
    /// # Errors
    /// If the handle is stale.
    pub fn shape_pose(&self, shape: ShapeHandle) -> Result<(Vec3, glam::Quat), Error> {
        let Part { position, rotation, .. } = self.part_of(self.collider(shape)?);
        Ok((position, rotation.into()))
    }

    /// Moves a shape on its body, to a place within 1e6 m along each axis; the mass follows if it is that of
    /// the shapes. Contacts of the shape begin anew. The pose that [`World::shape_pose`] returns changes
    /// nothing.
    ///
    /// # Errors
    /// If the handle is stale, or the pose is not one or out of range.
    pub fn set_shape_pose(
        &mut self,
        shape: ShapeHandle,
        position: Vec3,
        rotation: glam::Quat,
    ) -> Result<(), Error> {
        let collider = self.collider(shape)?;
        limits::offset("shape position", position)?;
        let unit = unit_quat("shape rotation", rotation)?;
        if self.shape_pose(shape)? == (position, rotation) {
            return Ok(());
        }
        let mass = self.mass_with(collider, &Part { position, rotation: unit, ..self.part_of(collider) })?;
        // As given: normalising twice may change a bit.
        self.note(Change::SetShapePose(shape, position, rotation));
        self.reshape(collider, mass, |collider, details| {
            let to_axes = details.axes.conjugate();
            collider.position = to_axes * (position - details.centre);
            collider.rotation = (to_axes * unit).normalize();
        });
        Ok(())
    }

    /// Density of a shape [kg/m³].
    ///
    /// # Errors
    /// If the handle is stale.
    pub fn density(&self, shape: ShapeHandle) -> Result<f32, Error> {
        Ok(self.colliders.all[self.collider(shape)? as usize].density)
    }

    /// Changes the density of a shape [kg/m³], to one in 0..=[`limits::MAX_DENSITY`]; the mass follows if it
    /// is that of the shapes.
    ///
    /// # Errors
    /// If the handle is stale, the number is out of range, or a dynamic body would be left without mass.
    pub fn set_density(&mut self, shape: ShapeHandle, density: f32) -> Result<(), Error> {
        let collider = self.collider(shape)?;
        limits::density(density)?;
        if self.colliders.all[collider as usize].density == density {
            return Ok(());
        }
        let mass = self.mass_with(collider, &Part { density, ..self.part_of(collider) })?;
        self.note(Change::SetDensity(shape, density));
        let index = self.disturb(self.colliders.all[collider as usize].body as usize);
        self.revise(index);
        self.colliders.all[collider as usize].density = density;
        if let Some(mass) = mass {
            self.replace_mass(index, &mass);
        }
        Ok(())
    }

    fn part_of(&self, collider: u32) -> Part<'_> {
        let Collider { body, position, rotation, geometry, density, .. } =
            &self.colliders.all[collider as usize];
        let BodyDetails { centre, axes, .. } = self.bodies.details[*body as usize];
        let (position, rotation) = (centre + axes * *position, axes * *rotation);
        Part { geometry, density: *density, position, rotation }
    }

    /// The mass of a body once a shape of it has changed; `None` if it stays the same.
    ///
    /// # Errors
    /// If it is not that of a dynamic body, which this one is.
    fn mass_with(&self, collider: u32, changed: &Part<'_>) -> Result<Option<MassProperties>, Error> {
        let index = self.colliders.all[collider as usize].body as usize;
        if !self.bodies.details[index].mass_from_shapes {
            return Ok(None);
        }
        let own = self.bodies.colliders[index].as_slice();
        let parts: Vec<MassProperties> = own
            .iter()
            .zip(self.parts_of(index))
            .map(|(&c, part)| {
                if c != collider {
                    return part;
                }
                let Part { geometry, density, position, rotation } = *changed;
                MassProperties::of(geometry, density).transformed(position, rotation.into())
            })
            .collect();
        let mass = MassProperties::combine(&parts);
        if self.bodies.kind[index] == BodyKind::Dynamic {
            if mass.mass <= 0.0 {
                return Err(Error::NoMass);
            }
            movable(&mass)?;
        }
        Ok(Some(mass).filter(|mass| mass.mass > 0.0))
    }

    /// Changes the form or the place of a shape, and gives its body the mass that follows.
    fn reshape(
        &mut self,
        collider: u32,
        mass: Option<MassProperties>,
        change: impl FnOnce(&mut Collider, &BodyDetails),
    ) {
        let index = self.disturb(self.colliders.all[collider as usize].body as usize);
        self.revise(index);
        self.leave_broad(collider);
        let World { colliders, bodies, needs, assets, .. } = self;
        let own = &mut colliders.all[collider as usize];
        needs.count(own, -1);
        assets.remove(&own.geometry);
        change(own, &bodies.details[index]);
        needs.count(own, 1);
        assets.add(&own.geometry);
        colliders.summaries[collider as usize] = own.summaries(bodies.mode(index));
        if let Some(mass) = mass {
            self.replace_mass(index, &mass);
        }
        self.colliders.place(collider, &self.bodies.pose[index]);
        self.enter_broad(collider);
    }
}
