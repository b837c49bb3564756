//! Traits of the world's bodies: look up and change the values of their descriptions.

use crate::body::{BodyKind, Damping, KeptMass, RareCounts, SpeedCap, Traits};
use crate::config::{ContinuousMode, RowGroup};
use crate::error::Error;
use crate::handle::BodyHandle;
use crate::lanes::Record;
use crate::limits;
use crate::world::{Addition, Change, World};
use glam::Vec3;

/// # Traits of bodies
///
/// Its kind, damping, locked axes, mode of continuous collision.
impl World {
    /// The kind of a body: static, kinematic or dynamic.
    ///
    /// # Errors
    /// If the handle is stale.
    pub fn kind(&self, body: BodyHandle) -> Result<BodyKind, Error> {
        Ok(self.bodies.kind[self.index(body)?])
    }

    /// Makes a body static, kinematic or dynamic. It keeps its handle, pose, shapes and joints, and its
    /// velocity unless it becomes static; forces that were added for the next step are dropped. A body that
    /// becomes dynamic gets its given mass again, or that of its shapes. Joints between bodies of which none
    /// is dynamic stay, and have no effect meanwhile.
    ///
    /// ```
    /// # use backstop::{*, glam::{DVec3, Quat, Vec3}};
    /// # let mut world = World::new(Settings::default())?;
    /// # let ground = world.add_body(&BodyDesc::fixed().with_shape(ShapeDesc::new(Geometry::plane())))?;
    /// # let cube = ShapeDesc::new(Geometry::cuboid(0.5, 0.5, 0.5));
    /// # let desc = BodyDesc::dynamic().with_position(Vec3::Y * 2.0).with_shape(cube);
    /// # let body = world.add_body(&desc)?;
    /// // Held by the player, then dropped.
    /// world.set_kind(body, BodyKind::Kinematic)?;
    /// world.set_kind(body, BodyKind::Dynamic)?;
    /// # Ok::<(), Error>(())
    /// ```
    ///
    /// # Errors
    /// If the handle is stale; if a body that would become dynamic has no mass, or a shape that a dynamic one
    /// can't have; or if the budget does not allow it.
    pub fn set_kind(&mut self, body: BodyHandle, kind: BodyKind) -> Result<(), Error> {
        let index = self.index(body)?;
        if self.bodies.kind[index] == kind {
            return Ok(());
        }
        let mass = if kind == BodyKind::Dynamic { Some(self.mass_as_dynamic(index)?) } else { None };
        self.reserve(Addition::Kind(index, kind))?;
        self.note(Change::SetKind(body, kind));
        let index = self.disturb(index);
        self.revise(index);
        self.each_collider_of(index, World::leave_broad);
        let index = self.become_kind(index, kind);
        if let Some(mass) = mass {
            self.bodies.rare.kept_mass.set(body.slot, None);
            self.replace_mass(index, &mass);
        }
        self.pass_mode_on(index);
        self.place_colliders(index);
        self.each_collider_of(index, World::enter_broad);
        self.revise(index);
        self.joints.changed = true;
        Ok(())
    }

    /// Gives a body its new place in the columns, without the mass of a dynamic one; returns its new index.
    fn become_kind(&mut self, index: usize, kind: BodyKind) -> usize {
        let World { bodies, colliders, .. } = self;
        let (slot, was) = (bodies.slot[index], bodies.kind[index]);
        if was == BodyKind::Dynamic {
            let (details, mass) = (&mut bodies.details[index], bodies.mass[index]);
            let kept = KeptMass { mass: details.mass, moments: mass.inertia };
            let given = !details.mass_from_shapes;
            details.mass = 0.0;
            bodies.rare.kept_mass.set(slot, given.then_some(kept));
            bodies.set_mass(index, crate::body::Mass::default());
        }
        bodies.rare.targets.set(slot, None);
        if kind == BodyKind::Static {
            bodies.velocity[index] = Record::default();
        }
        if let Some(force) = bodies.force.get_mut(index) {
            *force = Record::default();
        }
        if let Some(rest) = bodies.rest.get_mut(index) {
            *rest = 0.0;
        }
        bodies.set_kind(index as u32, kind, colliders) as usize
    }

    /// Calls `f` with each collider of a body.
    pub(super) fn each_collider_of(&mut self, index: usize, f: impl Fn(&mut World, u32)) {
        for place in 0..self.bodies.colliders[index].as_slice().len() {
            let collider = self.bodies.colliders[index].as_slice()[place];
            f(self, collider);
        }
    }

    /// The caller's number of a body.
    ///
    /// # Errors
    /// If the handle is stale.
    pub fn user_data(&self, body: BodyHandle) -> Result<u64, Error> {
        Ok(self.bodies.details[self.index(body)?].user_data)
    }

    /// Replaces the caller's number of a body.
    ///
    /// # Errors
    /// If the handle is stale.
    pub fn set_user_data(&mut self, body: BodyHandle, user_data: u64) -> Result<(), Error> {
        let index = self.index(body)?;
        self.note(Change::SetUserData(body, user_data));
        self.revise(index);
        self.bodies.details[index].user_data = user_data;
        Ok(())
    }

    /// The factor on gravity of a body.
    ///
    /// # Errors
    /// If the handle is stale.
    pub fn gravity_scale(&self, body: BodyHandle) -> Result<f32, Error> {
        Ok(self.bodies.traits[self.index(body)?].gravity_scale)
    }

    /// Sets the factor on gravity. Here and below an equal value changes nothing and wakes no body.
    ///
    /// # Errors
    /// If the handle is stale or the number is beyond 1e6.
    pub fn set_gravity_scale(&mut self, body: BodyHandle, scale: f32) -> Result<(), Error> {
        let index = self.index(body)?;
        limits::acceleration("gravity scale", Vec3::splat(scale))?;
        if self.bodies.traits[index].gravity_scale == scale {
            return Ok(());
        }
        self.note(Change::SetGravityScale(body, scale));
        let index = self.wake_body(index);
        self.revise(index);
        self.bodies.traits[index].gravity_scale = scale;
        Ok(())
    }

    /// Linear and angular damping of a body [1/s]; see
    /// [`BodyDesc::linear_damping`](crate::BodyDesc::linear_damping).
    ///
    /// # Errors
    /// If the handle is stale.
    pub fn damping(&self, body: BodyHandle) -> Result<(f32, f32), Error> {
        let index = self.index(body)?;
        let Damping { linear, angular } = self.bodies.rare.damping(self.bodies.slot[index]);
        Ok((linear, angular))
    }

    /// Sets linear and angular damping of a body [1/s]. Without effect while it is not dynamic. A sleeping
    /// body goes on sleeping: it has no velocity to lose.
    ///
    /// # Errors
    /// If the handle is stale, a number is not in 0..=[`limits::MAX_DAMPING`], or the budget does not allow
    /// it.
    pub fn set_damping(&mut self, body: BodyHandle, linear: f32, angular: f32) -> Result<(), Error> {
        let index = self.index(body)?;
        limits::damping("linear damping", linear)?;
        limits::damping("angular damping", angular)?;
        self.reserve(Addition::Rare(RareCounts { damped: 1, ..RareCounts::default() }))?;
        self.note(Change::SetDamping(body, linear, angular));
        self.revise(index);
        self.bodies.rare.set_damping(self.bodies.slot[index], Damping { linear, angular });
        Ok(())
    }

    /// Greatest linear [m/s] and angular [rad/s] speed of a body, where it has one; see
    /// [`BodyDesc::max_linear_speed`](crate::BodyDesc::max_linear_speed).
    ///
    /// # Errors
    /// If the handle is stale.
    pub fn max_speeds(&self, body: BodyHandle) -> Result<[Option<f32>; 2], Error> {
        let index = self.index(body)?;
        Ok(self.bodies.rare.cap(self.bodies.slot[index]).limits())
    }

    /// Sets the greatest linear [m/s] and angular [rad/s] speed of a body, or takes them away. Without effect
    /// while it is not dynamic; one that is faster slows down in the next step. A sleeping body goes on
    /// sleeping.
    ///
    /// ```
    /// # use backstop::{*, glam::{DVec3, Quat, Vec3}};
    /// # let mut world = World::new(Settings::default())?;
    /// # let ground = world.add_body(&BodyDesc::fixed().with_shape(ShapeDesc::new(Geometry::plane())))?;
    /// # let cube = ShapeDesc::new(Geometry::cuboid(0.5, 0.5, 0.5));
    /// # let desc = BodyDesc::dynamic().with_position(Vec3::Y * 2.0).with_shape(cube);
    /// # let body = world.add_body(&desc)?;
    /// world.set_max_speeds(body, Some(50.0), Some(30.0))?;
    /// # Ok::<(), Error>(())
    /// ```
    ///
    /// # Errors
    /// If the handle is stale, a number is not in 0..=[`limits::MAX_SPEED`], or the budget does not allow it.
    pub fn set_max_speeds(
        &mut self,
        body: BodyHandle,
        linear: Option<f32>,
        angular: Option<f32>,
    ) -> Result<(), Error> {
        let index = self.index(body)?;
        limits::speed_cap("maximum linear speed", linear)?;
        limits::speed_cap("maximum angular speed", angular)?;
        self.reserve(Addition::Rare(RareCounts { capped: 1, ..RareCounts::default() }))?;
        self.note(Change::SetMaxSpeeds(body, linear, angular));
        self.revise(index);
        self.bodies.rare.set_cap(self.bodies.slot[index], SpeedCap::new(linear, angular));
        Ok(())
    }

    /// World axes along which a body can't move, and those about which it can't turn.
    ///
    /// # Errors
    /// If the handle is stale.
    pub fn locked_axes(&self, body: BodyHandle) -> Result<([bool; 3], [bool; 3]), Error> {
        let locks = self.bodies.traits[self.index(body)?].locks;
        let bits = |from: u8| std::array::from_fn(|axis| locks >> (from + axis as u8) & 1 != 0);
        Ok((bits(0), bits(3)))
    }

    /// Sets the world axes along which a body can't move, and those about which it can't turn: see
    /// [`BodyDesc::lock_translation`](crate::BodyDesc::lock_translation). The next step takes away the
    /// velocity that it has along and about them.
    ///
    /// ```
    /// # use backstop::{*, glam::{DVec3, Quat, Vec3}};
    /// # let mut world = World::new(Settings::default())?;
    /// # let ground = world.add_body(&BodyDesc::fixed().with_shape(ShapeDesc::new(Geometry::plane())))?;
    /// # let cube = ShapeDesc::new(Geometry::cuboid(0.5, 0.5, 0.5));
    /// # let desc = BodyDesc::dynamic().with_position(Vec3::Y * 2.0).with_shape(cube);
    /// # let body = world.add_body(&desc)?;
    /// // It moves in the plane z = 0 and does not tumble.
    /// world.set_locked_axes(body, [false, false, true], [true, true, true])?;
    /// # Ok::<(), Error>(())
    /// ```
    ///
    /// # Errors
    /// If the handle is stale.
    pub fn set_locked_axes(
        &mut self,
        body: BodyHandle,
        translation: [bool; 3],
        rotation: [bool; 3],
    ) -> Result<(), Error> {
        let index = self.index(body)?;
        let locks = Traits::lock_bits(translation, rotation);
        if self.bodies.traits[index].locks == locks {
            return Ok(());
        }
        self.note(Change::SetLockedAxes(body, translation, rotation));
        let index = self.wake_body(index);
        self.revise(index);
        self.bodies.set_locked_axes(index, locks);
        // A body that can't rotate is in no tree.
        self.joints.changed = true;
        Ok(())
    }

    /// How a body is kept from passing through others.
    ///
    /// # Errors
    /// If the handle is stale.
    pub fn continuous(&self, body: BodyHandle) -> Result<ContinuousMode, Error> {
        Ok(self.bodies.traits[self.index(body)?].continuous)
    }

    /// Sets how a body is kept from passing through others. Two bodies collide by the greater of their modes;
    /// static bodies have none.
    ///
    /// ```
    /// # use backstop::{*, glam::{DVec3, Quat, Vec3}};
    /// # let mut world = World::new(Settings::default())?;
    /// # let ground = world.add_body(&BodyDesc::fixed().with_shape(ShapeDesc::new(Geometry::plane())))?;
    /// # let cube = ShapeDesc::new(Geometry::cuboid(0.5, 0.5, 0.5));
    /// # let desc = BodyDesc::dynamic().with_position(Vec3::Y * 2.0).with_shape(cube);
    /// # let body = world.add_body(&desc)?;
    /// // A bullet which is long and spins: its whole volume is swept.
    /// world.set_continuous(body, ContinuousMode::Volume)?;
    /// # Ok::<(), Error>(())
    /// ```
    ///
    /// # Errors
    /// If the handle is stale.
    pub fn set_continuous(&mut self, body: BodyHandle, mode: ContinuousMode) -> Result<(), Error> {
        let index = self.index(body)?;
        self.note(Change::SetContinuous(body, mode));
        self.revise(index);
        self.bodies.set_continuous(index, mode);
        self.pass_mode_on(index);
        Ok(())
    }

    /// Tells the shapes of a body how it is kept from passing through others.
    fn pass_mode_on(&mut self, index: usize) {
        let mode = self.bodies.mode(index);
        for &c in self.bodies.colliders[index].as_slice() {
            self.colliders.summaries[c as usize].mode = mode;
        }
    }

    /// The group after which the rows of a body are solved, if any.
    ///
    /// # Errors
    /// If the handle is stale.
    pub fn body_solved_after(&self, body: BodyHandle) -> Result<Option<RowGroup>, Error> {
        Ok(self.bodies.traits[self.index(body)?].solved_after)
    }

    /// Has the rows of a body solved right after those of a group, or in their own place again; see
    /// [`BodyDesc::solved_after`](crate::BodyDesc::solved_after).
    ///
    /// # Errors
    /// If the handle is stale or the budget does not allow it.
    pub fn set_body_solved_after(&mut self, body: BodyHandle, above: Option<RowGroup>) -> Result<(), Error> {
        let index = self.index(body)?;
        if self.bodies.traits[index].solved_after == above {
            return Ok(());
        }
        self.reserve(Addition::SolvedAfter(above.is_some()))?;
        self.note(Change::SetBodySolvedAfter(body, above));
        self.revise(index);
        self.bodies.set_solved_after(index, above);
        self.joints.changed = true;
        Ok(())
    }
}
