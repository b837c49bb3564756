//! Shapes of the world's bodies: add, remove, change, look up.

use super::mass::movable;
use crate::body::BodyKind;
use crate::error::Error;
use crate::handle::{BodyHandle, ShapeHandle};
use crate::shape::{
    Collider, EVENTS, Filter, Geometry, HOOKS, MassProperties, Material, SENSOR, STATICS, ShapeDesc,
};
use crate::world::{Addition, Change, World};

/// # Shapes of bodies
impl World {
    /// Adds a shape to a body; the mass follows if it is that of the shapes.
    ///
    /// ```
    /// # use backstop::{*, glam::{DVec3, Quat, Vec3}};
    /// # let mut world = World::new(Settings::default())?;
    /// # let ground = world.add_body(&BodyDesc::fixed().with_shape(ShapeDesc::new(Geometry::plane())))?;
    /// # let cube = ShapeDesc::new(Geometry::cuboid(0.5, 0.5, 0.5));
    /// # let desc = BodyDesc::dynamic().with_position(Vec3::Y * 2.0).with_shape(cube);
    /// # let body = world.add_body(&desc)?;
    /// let top = ShapeDesc::new(Geometry::sphere(0.3)).with_position(Vec3::Y * 0.8);
    /// let top = world.add_shape(body, &top)?;
    /// assert_eq!(world.body_of(top)?, body);
    /// # Ok::<(), Error>(())
    /// ```
    ///
    /// # Errors
    /// If the handle is stale, or the shape or the budget does not allow it.
    pub fn add_shape(&mut self, body: BodyHandle, shape: &ShapeDesc) -> Result<ShapeHandle, Error> {
        let index = self.index(body)?;
        shape.validate()?;
        if self.bodies.kind[index] == BodyKind::Dynamic {
            shape.geometry.require_convex()?;
        }
        let mass =
            MassProperties::of(&shape.geometry, shape.density).transformed(shape.position, shape.rotation);
        if self.bodies.kind[index] == BodyKind::Dynamic && mass.mass != 0.0 {
            movable(&mass)?;
            if self.bodies.details[index].mass_from_shapes {
                // Two shapes far apart have more inertia than each of them.
                let parts: Vec<MassProperties> = self.parts_of(index).chain([mass]).collect();
                movable(&MassProperties::combine(&parts))?;
            }
        }
        let has = self.bodies.colliders[index].as_slice().len();
        self.reserve(Addition::Shape(self.bodies.kind[index], shape, has))?;
        self.note(Change::AddShape(body, shape));
        let index = self.disturb(index);
        self.revise(index);
        let collider = self.new_collider(index, shape);
        if self.bodies.details[index].mass_from_shapes && mass.mass > 0.0 {
            self.refresh_mass(index);
        }
        Ok(self.shape_handle(collider))
    }

    /// Removes a shape from its body; the mass follows if it is that of the shapes, unless none would be
    /// left. The body's last shape takes its place in [`World::shapes`]. The time does not depend on the
    /// number of shapes, unless the mass follows: that is summed anew.
    ///
    /// # Errors
    /// If the handle is stale, or a dynamic body would be left without mass.
    pub fn remove_shape(&mut self, shape: ShapeHandle) -> Result<(), Error> {
        let collider = self.collider(shape)?;
        let index = self.colliders.all[collider as usize].body as usize;
        let from_shapes =
            self.bodies.details[index].mass_from_shapes && self.bodies.kind[index] == BodyKind::Dynamic;
        let mut mass = None;
        if from_shapes {
            let rest = self.bodies.colliders[index].as_slice().iter().filter(|&&c| c != collider);
            if !rest.clone().any(|&c| self.colliders.all[c as usize].density > 0.0) {
                return Err(Error::NoMass);
            }
            let own = self.bodies.colliders[index].as_slice().iter().zip(self.parts_of(index));
            let rest: Vec<_> = own.filter(|(c, _)| **c != collider).map(|(_, mass)| mass).collect();
            let rest = MassProperties::combine(&rest);
            movable(&rest)?;
            mass = Some(rest);
        }
        self.note(Change::RemoveShape(shape));
        let index = self.disturb(index);
        self.revise(index);
        let place = self.colliders.all[collider as usize].place;
        if let Some(moved) = self.bodies.detach(index, place as usize) {
            self.colliders.all[moved as usize].place = place;
        }
        self.drop_collider(collider);
        if let Some(mass) = mass {
            self.replace_mass(index, &mass);
        }
        Ok(())
    }

    /// The shapes of a body.
    ///
    /// # Errors
    /// If the handle is stale.
    pub fn shapes(&self, body: BodyHandle) -> Result<impl Iterator<Item = ShapeHandle> + '_, Error> {
        let index = self.index(body)?;
        Ok(self.bodies.colliders[index].as_slice().iter().map(|&c| self.shape_handle(c)))
    }

    /// The body that a shape is on.
    ///
    /// # Errors
    /// If the handle is stale.
    pub fn body_of(&self, shape: ShapeHandle) -> Result<BodyHandle, Error> {
        Ok(self.handle_of(self.colliders.all[self.collider(shape)? as usize].body as usize))
    }

    /// The material of a shape.
    ///
    /// # Errors
    /// If the handle is stale.
    pub fn material(&self, shape: ShapeHandle) -> Result<Material, Error> {
        Ok(self.colliders.material(self.collider(shape)?))
    }

    /// Changes the material of a shape: a belt that starts, ice that melts. An equal one changes nothing and
    /// wakes no body.
    ///
    /// ```
    /// # use backstop::{*, glam::{DVec3, Quat, Vec3}};
    /// # let mut world = World::new(Settings::default())?;
    /// # let ground = world.add_body(&BodyDesc::fixed().with_shape(ShapeDesc::new(Geometry::plane())))?;
    /// # let cube = ShapeDesc::new(Geometry::cuboid(0.5, 0.5, 0.5));
    /// # let desc = BodyDesc::dynamic().with_position(Vec3::Y * 2.0).with_shape(cube);
    /// # let body = world.add_body(&desc)?;
    /// let shape = world.shapes(body)?.next().expect("its cube");
    /// world.set_material(shape, Material::default().with_friction(0.05).with_restitution(0.3))?;
    /// # Ok::<(), Error>(())
    /// ```
    ///
    /// # Errors
    /// If the handle is stale, a value is out of range, or the budget does not allow it.
    pub fn set_material(&mut self, shape: ShapeHandle, material: Material) -> Result<(), Error> {
        material.validate()?;
        let index = self.collider(shape)? as usize;
        if self.colliders.material(index as u32) == material {
            return Ok(());
        }
        let rare = material.rare();
        self.reserve(Addition::RareMaterial(rare.flags() != 0))?;
        self.note(Change::SetMaterial(shape, material));
        let body = self.disturb(self.colliders.all[index].body as usize);
        self.revise(body);
        self.change_flags(index as u32, |collider| collider.set_material(&material));
        self.colliders.set_rare(index as u32, rare);
        Ok(())
    }

    /// Which shapes a shape collides with.
    ///
    /// # Errors
    /// If the handle is stale.
    pub fn filter(&self, shape: ShapeHandle) -> Result<Filter, Error> {
        Ok(self.colliders.all[self.collider(shape)? as usize].filter)
    }

    /// Changes which shapes a shape collides with. An equal filter changes nothing and wakes no body.
    ///
    /// # Errors
    /// If the handle is stale.
    pub fn set_filter(&mut self, shape: ShapeHandle, filter: Filter) -> Result<(), Error> {
        let index = self.collider(shape)?;
        if self.colliders.all[index as usize].filter == filter {
            return Ok(());
        }
        self.note(Change::SetFilter(shape, filter));
        let body = self.disturb(self.colliders.all[index as usize].body as usize);
        self.revise(body);
        self.colliders.all[index as usize].filter = filter;
        self.broad.touch(index);
        self.disturb_box(&self.bounds(index));
        Ok(())
    }

    /// Whether contacts of a shape are reported as events.
    ///
    /// # Errors
    /// If the handle is stale.
    pub fn has_events(&self, shape: ShapeHandle) -> Result<bool, Error> {
        Ok(self.colliders.summaries[self.collider(shape)? as usize].has_events())
    }

    /// Whether contacts of a shape are passed to hooks.
    ///
    /// # Errors
    /// If the handle is stale.
    pub fn has_hooks(&self, shape: ShapeHandle) -> Result<bool, Error> {
        Ok(self.colliders.summaries[self.collider(shape)? as usize].has_hooks())
    }

    /// Sets whether contacts of a shape are reported as events. A shape which no longer asks for events gets
    /// no end of its current contacts; its island wakes.
    ///
    /// # Errors
    /// If the handle is stale.
    pub fn set_events(&mut self, shape: ShapeHandle, events: bool) -> Result<(), Error> {
        self.set_listening(shape, events, self.has_hooks(shape)?)
    }

    /// Sets whether contacts of a shape are passed to hooks.
    ///
    /// # Errors
    /// If the handle is stale.
    pub fn set_hooks(&mut self, shape: ShapeHandle, hooks: bool) -> Result<(), Error> {
        self.set_listening(shape, self.has_events(shape)?, hooks)
    }

    pub(crate) fn set_listening(
        &mut self,
        shape: ShapeHandle,
        events: bool,
        hooks: bool,
    ) -> Result<(), Error> {
        let index = self.collider(shape)? as usize;
        self.note(Change::SetListening(shape, events, hooks));
        let mut body = self.colliders.all[index].body as usize;
        let stops = !events && self.colliders.summaries[index].has_events();
        if stops {
            // The pairs that it touches must be in the list.
            body = self.disturb(body);
        }
        self.change_flags(index as u32, |collider| {
            collider.flags = collider.flags & !(EVENTS | HOOKS)
                | if events { EVENTS } else { 0 }
                | if hooks { HOOKS } else { 0 };
        });
        if stops {
            self.forget_touches(index as u32);
        }
        self.revise(body);
        Ok(())
    }

    /// Whether a shape is a sensor.
    ///
    /// # Errors
    /// If the handle is stale.
    pub fn is_sensor(&self, shape: ShapeHandle) -> Result<bool, Error> {
        Ok(self.colliders.summaries[self.collider(shape)? as usize].is_sensor())
    }

    /// Makes a shape a sensor, or solid again. Nothing happens if it is that already.
    ///
    /// # Errors
    /// If the handle is stale, or the shape is neither convex nor a plane and can't be a sensor.
    pub fn set_sensor(&mut self, shape: ShapeHandle, sensor: bool) -> Result<(), Error> {
        let index = self.collider(shape)?;
        if self.colliders.all[index as usize].is_sensor() == sensor {
            return Ok(());
        }
        let geometry = &self.colliders.all[index as usize].geometry;
        if sensor && !matches!(geometry, Geometry::Plane) {
            geometry.require_convex()?;
        }
        self.note(Change::SetSensor(shape, sensor));
        self.set_sense(index, SENSOR, sensor);
        Ok(())
    }

    /// Whether a shape, as a sensor, also notices static shapes; see
    /// [`ShapeDesc::senses_static`](crate::ShapeDesc::senses_static).
    ///
    /// # Errors
    /// If the handle is stale.
    pub fn senses_static(&self, shape: ShapeHandle) -> Result<bool, Error> {
        Ok(self.colliders.all[self.collider(shape)? as usize].flags & STATICS != 0)
    }

    /// Sets whether a shape, as a sensor, also notices static shapes. Shapes in the sensor leave and enter
    /// again. Nothing happens if the value is the same.
    ///
    /// # Errors
    /// If the handle is stale.
    pub fn set_senses_static(&mut self, shape: ShapeHandle, senses_static: bool) -> Result<(), Error> {
        let index = self.collider(shape)?;
        if self.senses_static(shape)? == senses_static {
            return Ok(());
        }
        self.note(Change::SetSensesStatic(shape, senses_static));
        self.set_sense(index, STATICS, senses_static);
        Ok(())
    }

    /// Sets a flag that decides about the pairs of a shape.
    fn set_sense(&mut self, index: u32, flag: u8, set: bool) {
        let body = self.disturb(self.colliders.all[index as usize].body as usize);
        self.revise(body);
        self.leave_broad(index);
        self.change_flags(index, |collider| {
            collider.flags = collider.flags & !flag | if set { flag } else { 0 };
        });
        self.enter_broad(index);
    }

    /// Changes flags of a shape, or their causes, and the counts that follow from them.
    fn change_flags(&mut self, index: u32, change: impl FnOnce(&mut Collider)) {
        let collider = &mut self.colliders.all[index as usize];
        self.needs.count(collider, -1);
        change(collider);
        self.needs.count(collider, 1);
        self.colliders.summaries[index as usize].flags = collider.flags;
    }

    /// The caller's number of a shape.
    ///
    /// # Errors
    /// If the handle is stale.
    pub fn shape_user_data(&self, shape: ShapeHandle) -> Result<u64, Error> {
        Ok(self.colliders.all[self.collider(shape)? as usize].user_data)
    }

    /// Replaces the caller's number of a shape.
    ///
    /// # Errors
    /// If the handle is stale.
    pub fn set_shape_user_data(&mut self, shape: ShapeHandle, user_data: u64) -> Result<(), Error> {
        let index = self.collider(shape)? as usize;
        self.note(Change::SetShapeUserData(shape, user_data));
        self.revise(self.colliders.all[index].body as usize);
        self.colliders.all[index].user_data = user_data;
        Ok(())
    }
}
