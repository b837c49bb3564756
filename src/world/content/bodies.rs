//! Bodies of the world: add, remove, change, look up.

use super::mass::{MassColumns, columns_of, mass_of, movable};
use crate::body::{BodyDesc, BodyKind, Damping, NewBody, SpeedCap, Traits};
use crate::error::{Error, each};
use crate::handle::BodyHandle;
use crate::lanes::Record;
use crate::math::Quat;
use crate::world::{Addition, Change, World};
use glam::Vec3;

/// # Bodies
impl World {
    /// Adds a body.
    ///
    /// ```
    /// # use backstop::{*, glam::{DVec3, Quat, Vec3}};
    /// # let mut world = World::new(Settings::default())?;
    /// # let ground = world.add_body(&BodyDesc::fixed().with_shape(ShapeDesc::new(Geometry::plane())))?;
    /// # let cube = ShapeDesc::new(Geometry::cuboid(0.5, 0.5, 0.5));
    /// # let desc = BodyDesc::dynamic().with_position(Vec3::Y * 2.0).with_shape(cube);
    /// # let body = world.add_body(&desc)?;
    /// let ball = ShapeDesc::new(Geometry::sphere(0.2)).with_density(500.0);
    /// let ball = world.add_body(&BodyDesc::dynamic().with_position(Vec3::Y * 5.0).with_shape(ball))?;
    /// assert_eq!(world.position(ball)?.y, 5.0);
    /// # Ok::<(), Error>(())
    /// ```
    ///
    /// # Errors
    /// If its description is out of range, a dynamic body has no mass or a shape that only a static one may
    /// have, or the budget does not allow it.
    pub fn add_body(&mut self, desc: &BodyDesc) -> Result<BodyHandle, Error> {
        let mass = self.check(desc)?;
        self.reserve(Addition::Bodies(std::slice::from_ref(desc)))?;
        self.note(Change::AddBody(desc));
        Ok(self.insert(desc, &mass))
    }

    /// Adds many bodies: all of them, or none.
    ///
    /// ```
    /// # use backstop::{*, glam::{DVec3, Quat, Vec3}};
    /// # let mut world = World::new(Settings::default())?;
    /// # let ground = world.add_body(&BodyDesc::fixed().with_shape(ShapeDesc::new(Geometry::plane())))?;
    /// # let cube = ShapeDesc::new(Geometry::cuboid(0.5, 0.5, 0.5));
    /// # let desc = BodyDesc::dynamic().with_position(Vec3::Y * 2.0).with_shape(cube);
    /// # let body = world.add_body(&desc)?;
    /// let row = |i: u32| desc.clone().with_position(Vec3::X * (2 * i) as f32);
    /// let bodies = world.add_bodies(&(1..=10).map(row).collect::<Vec<_>>())?;
    /// assert_eq!(bodies.len(), 10);
    /// # Ok::<(), Error>(())
    /// ```
    ///
    /// # Errors
    /// As for [`World::add_body`], and which of several it is ([`Error::One`]).
    pub fn add_bodies(&mut self, descs: &[BodyDesc]) -> Result<Vec<BodyHandle>, Error> {
        let mut masses = Vec::with_capacity(descs.len());
        each("body", descs, |desc| self.check(desc).map(|mass| masses.push(mass)))?;
        self.reserve(Addition::Bodies(descs))?;
        self.note(Change::AddBodies(descs));
        self.bodies.reserve(descs.len());
        let shapes = descs.iter().map(|d| d.shapes.len()).sum();
        self.colliders.slots.reserve(shapes);
        self.colliders.reserve(shapes);
        Ok(descs.iter().zip(&masses).map(|(desc, mass)| self.insert(desc, mass)).collect())
    }

    /// Removes a body with its shapes.
    ///
    /// ```
    /// # use backstop::{*, glam::{DVec3, Quat, Vec3}};
    /// # let mut world = World::new(Settings::default())?;
    /// # let ground = world.add_body(&BodyDesc::fixed().with_shape(ShapeDesc::new(Geometry::plane())))?;
    /// # let cube = ShapeDesc::new(Geometry::cuboid(0.5, 0.5, 0.5));
    /// # let desc = BodyDesc::dynamic().with_position(Vec3::Y * 2.0).with_shape(cube);
    /// # let body = world.add_body(&desc)?;
    /// world.remove_body(body)?;
    /// assert!(matches!(world.position(body), Err(Error::StaleBody)));
    /// # Ok::<(), Error>(())
    /// ```
    ///
    /// # Errors
    /// If the handle is stale.
    pub fn remove_body(&mut self, body: BodyHandle) -> Result<(), Error> {
        let index = self.index(body)?;
        self.note(Change::RemoveBody(body));
        let index = self.disturb(index);
        self.revise(index);
        self.remove_joints_of(body);
        let colliders = self.bodies.take_colliders(index);
        for &collider in colliders.as_slice() {
            self.drop_collider(collider);
        }
        self.bodies.remove(index as u32, &mut self.colliders);
        Ok(())
    }

    /// Removes many bodies: all of them, or none.
    ///
    /// # Errors
    /// If a handle is stale.
    pub fn remove_bodies(&mut self, bodies: &[BodyHandle]) -> Result<(), Error> {
        each("body", bodies, |&body| self.index(body).map(drop))?;
        // A body that is listed twice is already removed the second time.
        for &body in bodies {
            if self.contains(body) {
                self.remove_body(body)?;
            }
        }
        Ok(())
    }

    /// Disables a body, or enables it again, with its shapes and joints. A disabled body does not move,
    /// touches nothing, and is invisible to queries; its joints have no effect. It keeps its handles, its
    /// pose and its velocities, and may be changed in the meantime.
    ///
    /// ```
    /// # use backstop::{*, glam::{DVec3, Quat, Vec3}};
    /// # let mut world = World::new(Settings::default())?;
    /// # let ground = world.add_body(&BodyDesc::fixed().with_shape(ShapeDesc::new(Geometry::plane())))?;
    /// # let cube = ShapeDesc::new(Geometry::cuboid(0.5, 0.5, 0.5));
    /// # let desc = BodyDesc::dynamic().with_position(Vec3::Y * 2.0).with_shape(cube);
    /// # let body = world.add_body(&desc)?;
    /// // Far away from the player: kept, but not simulated.
    /// world.set_enabled(body, false)?;
    /// world.step(1.0 / 60.0)?;
    /// assert_eq!(world.position(body)?.y, 2.0);
    /// world.set_enabled(body, true)?;
    /// # Ok::<(), Error>(())
    /// ```
    ///
    /// # Errors
    /// If the handle is stale, or the budget no longer allows it to be enabled.
    pub fn set_enabled(&mut self, body: BodyHandle, enabled: bool) -> Result<(), Error> {
        let index = self.index(body)?;
        if self.bodies.traits[index].disabled != enabled {
            return Ok(());
        }
        if enabled {
            self.reserve(Addition::Enabled(index))?;
        }
        self.note(Change::SetEnabled(body, enabled));
        let index = self.disturb(index);
        self.revise(index);
        if !enabled {
            self.each_collider_of(index, World::leave_broad);
        }
        let index = self.bodies.set_enabled(index as u32, enabled, &mut self.colliders) as usize;
        if enabled {
            self.place_colliders(index);
            self.each_collider_of(index, World::enter_broad);
        }
        self.joints.changed = true;
        Ok(())
    }

    /// Whether a body takes part in the world; see [`World::set_enabled`].
    ///
    /// # Errors
    /// If the handle is stale.
    pub fn is_enabled(&self, body: BodyHandle) -> Result<bool, Error> {
        Ok(!self.bodies.traits[self.index(body)?].disabled)
    }

    /// Number of bodies.
    pub fn body_count(&self) -> usize {
        self.bodies.len()
    }

    /// All bodies: first dynamic ones, then kinematic ones, then dynamic ones that are asleep and those that
    /// are disabled, then static ones.
    ///
    /// ```
    /// # use backstop::{*, glam::{DVec3, Quat, Vec3}};
    /// # let mut world = World::new(Settings::default())?;
    /// # let ground = world.add_body(&BodyDesc::fixed().with_shape(ShapeDesc::new(Geometry::plane())))?;
    /// # let cube = ShapeDesc::new(Geometry::cuboid(0.5, 0.5, 0.5));
    /// # let desc = BodyDesc::dynamic().with_position(Vec3::Y * 2.0).with_shape(cube);
    /// # let body = world.add_body(&desc)?;
    /// let heights = world.bodies().filter_map(|body| world.position(body).ok()).map(|at| at.y);
    /// let lowest = heights.min_by(f64::total_cmp);
    /// assert_eq!(lowest, Some(0.0));
    /// # Ok::<(), Error>(())
    /// ```
    pub fn bodies(&self) -> impl Iterator<Item = BodyHandle> + '_ {
        (0..self.bodies.len()).map(|index| self.handle_of(index))
    }

    /// Whether the handle is not stale.
    pub fn contains(&self, body: BodyHandle) -> bool {
        self.index(body).is_ok()
    }

    /// Checks a description and computes the entries of the body's columns.
    fn check(&self, desc: &BodyDesc) -> Result<MassColumns, Error> {
        desc.validate()?;
        let total = desc.mass.unwrap_or_else(|| mass_of(&desc.shapes));
        if desc.kind == BodyKind::Dynamic && desc.mass.is_none() && total.mass <= 0.0 {
            return Err(Error::NoMass);
        }
        if desc.kind == BodyKind::Dynamic {
            movable(&total)?;
        }
        Ok(columns_of(&total, desc.kind, desc.user_data, desc.mass.is_none()))
    }

    fn insert(&mut self, desc: &BodyDesc, columns: &MassColumns) -> BodyHandle {
        let MassColumns { details, mass, kept } = *columns;
        let rotation = Quat::from(desc.rotation).normalize();
        let locks = Traits::lock_bits(desc.lock_translation, desc.lock_rotation);
        let moves = desc.kind != BodyKind::Static;
        let new = NewBody {
            kind: desc.kind,
            pose: details.pose_at(desc.position, rotation),
            velocity: Record {
                linear: if moves { desc.linear_velocity } else { Vec3::ZERO },
                angular: if moves { desc.angular_velocity } else { Vec3::ZERO },
                ..Record::default()
            },
            mass,
            traits: Traits {
                gravity_scale: desc.gravity_scale,
                continuous: desc.continuous,
                locks,
                solved_after: desc.solved_after,
                sleepless: !desc.can_sleep,
                disabled: false,
            },
            details,
            damping: Damping { linear: desc.linear_damping, angular: desc.angular_damping },
            cap: SpeedCap::new(desc.max_linear_speed, desc.max_angular_speed),
            kept_mass: kept,
        };
        let (slot, generation) = self.bodies.insert(new, &mut self.colliders);
        let index = self.bodies.slots.get(slot, generation).unwrap_or(0) as usize;
        self.revise(index);
        for shape in &desc.shapes {
            self.new_collider(index, shape);
        }
        BodyHandle { slot, generation }
    }

    /// Records that something about a body changed that snapshots share.
    pub(in crate::world) fn revise(&mut self, index: usize) {
        self.revisions.moving += 1;
        self.revisions.fixed += u64::from(self.bodies.kind[index] == BodyKind::Static);
    }
}
