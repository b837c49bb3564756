//! Poses and velocities of bodies: look up, set, push.

use crate::body::{AfterTarget, BodyKind, RareCounts, Target};
use crate::error::Error;
use crate::forces::world_inertia;
use crate::handle::BodyHandle;
use crate::lanes::Record;
use crate::limits;
use crate::limits::unit_quat;
use crate::world::{Addition, Change, World};
use glam::{DVec3, Vec3};

/// # Poses, velocities, forces
///
/// Forces act over the next step, impulses at once.
impl World {
    /// Position of a body's origin in the world [m].
    ///
    /// # Errors
    /// If the handle is stale.
    pub fn position(&self, body: BodyHandle) -> Result<DVec3, Error> {
        let index = self.index(body)?;
        Ok(self.bodies.details[index].origin_at(&self.bodies.pose[index]).0)
    }

    /// Position of a body's origin relative to [`World::origin`] [m].
    ///
    /// # Errors
    /// If the handle is stale.
    pub fn local_position(&self, body: BodyHandle) -> Result<Vec3, Error> {
        Ok((self.position(body)? - self.origin).as_vec3())
    }

    /// Rotation of a body's axes.
    ///
    /// # Errors
    /// If the handle is stale.
    pub fn rotation(&self, body: BodyHandle) -> Result<glam::Quat, Error> {
        let index = self.index(body)?;
        Ok(self.bodies.details[index].origin_at(&self.bodies.pose[index]).1.into())
    }

    /// Position of a body's centre of mass in the world [m].
    ///
    /// # Errors
    /// If the handle is stale.
    pub fn centre_of_mass(&self, body: BodyHandle) -> Result<DVec3, Error> {
        Ok(self.bodies.pose[self.index(body)?].position)
    }

    /// Velocity of a body's centre of mass [m/s].
    ///
    /// # Errors
    /// If the handle is stale.
    pub fn linear_velocity(&self, body: BodyHandle) -> Result<Vec3, Error> {
        Ok(self.bodies.velocity[self.index(body)?].linear)
    }

    /// Angular velocity of a body about the world's axes [rad/s].
    ///
    /// # Errors
    /// If the handle is stale.
    pub fn angular_velocity(&self, body: BodyHandle) -> Result<Vec3, Error> {
        Ok(self.bodies.velocity[self.index(body)?].angular)
    }

    /// Moves a body to a pose of its origin, at once. The pose that it has, as [`World::position`] and
    /// [`World::rotation`] return it, changes nothing and wakes no body.
    ///
    /// ```
    /// # use backstop::{*, glam::{DVec3, Quat, Vec3}};
    /// # let mut world = World::new(Settings::default())?;
    /// # let ground = world.add_body(&BodyDesc::fixed().with_shape(ShapeDesc::new(Geometry::plane())))?;
    /// # let cube = ShapeDesc::new(Geometry::cuboid(0.5, 0.5, 0.5));
    /// # let desc = BodyDesc::dynamic().with_position(Vec3::Y * 2.0).with_shape(cube);
    /// # let body = world.add_body(&desc)?;
    /// world.set_pose(body, DVec3::new(10.0, 1.0, 0.0), Quat::from_rotation_y(0.5))?;
    /// assert_eq!(world.position(body)?.x, 10.0);
    /// # Ok::<(), Error>(())
    /// ```
    ///
    /// # Errors
    /// If the handle is stale, the pose is not one, or it is beyond [`limits::MAX_POSITION`].
    pub fn set_pose(&mut self, body: BodyHandle, position: DVec3, rotation: glam::Quat) -> Result<(), Error> {
        let index = self.index(body)?;
        limits::position(position)?;
        let unit = unit_quat("rotation", rotation)?;
        let target = self.bodies.rare.targets.get(body.slot);
        let aims = target.is_some_and(|target| target.after != AfterTarget::Stops);
        if !aims && self.position(body)? == position && self.rotation(body)? == rotation {
            return Ok(());
        }
        // As given: normalising twice may change a bit.
        self.note(Change::SetPose(body, position, rotation));
        let rotation = unit;
        let index = self.disturb(index);
        let details = &self.bodies.details[index];
        self.bodies.pose[index] = details.pose_at(position, rotation);
        // One that was to stop does, here.
        let target = target.filter(|target| target.after != AfterTarget::MoveOn);
        let target = target.map(|target| Target { after: AfterTarget::Stops, ..target });
        self.bodies.rare.targets.set(body.slot, target);
        self.place_colliders(index);
        self.note_move(index);
        if self.bodies.kind[index] == BodyKind::Static {
            self.revise(index);
            self.each_collider_of(index, |world, collider| {
                world.leave_broad(collider);
                world.enter_broad(collider);
            });
        }
        Ok(())
    }

    /// Sets linear [m/s] and angular [rad/s] velocity. Has no effect on a static body. Here and below a
    /// velocity that is equal changes nothing and wakes no body.
    ///
    /// # Errors
    /// If the handle is stale or a number is beyond [`limits::MAX_SPEED`].
    pub fn set_velocity(&mut self, body: BodyHandle, linear: Vec3, angular: Vec3) -> Result<(), Error> {
        let index = self.index(body)?;
        limits::speed("linear velocity", linear)?;
        limits::speed("angular velocity", angular)?;
        let change = Change::SetVelocity(body, linear, angular);
        self.put_velocity(index, [Some(linear), Some(angular)], None, change);
        Ok(())
    }

    /// Sets the velocity of a body's centre of mass [m/s]. Has no effect on a static body.
    ///
    /// ```
    /// # use backstop::{*, glam::{DVec3, Quat, Vec3}};
    /// # let mut world = World::new(Settings::default())?;
    /// # let ground = world.add_body(&BodyDesc::fixed().with_shape(ShapeDesc::new(Geometry::plane())))?;
    /// # let cube = ShapeDesc::new(Geometry::cuboid(0.5, 0.5, 0.5));
    /// # let desc = BodyDesc::dynamic().with_position(Vec3::Y * 2.0).with_shape(cube);
    /// # let body = world.add_body(&desc)?;
    /// world.set_linear_velocity(body, Vec3::X * 3.0)?;
    /// assert_eq!(world.linear_velocity(body)?, Vec3::X * 3.0);
    /// # Ok::<(), Error>(())
    /// ```
    ///
    /// # Errors
    /// If the handle is stale or a number is beyond [`limits::MAX_SPEED`].
    pub fn set_linear_velocity(&mut self, body: BodyHandle, linear: Vec3) -> Result<(), Error> {
        let index = self.index(body)?;
        limits::speed("linear velocity", linear)?;
        self.put_velocity(index, [Some(linear), None], None, Change::SetLinearVelocity(body, linear));
        Ok(())
    }

    /// Sets the angular velocity of a body about the world's axes [rad/s]. Has no effect on a static body.
    ///
    /// # Errors
    /// If the handle is stale or a number is beyond [`limits::MAX_SPEED`].
    pub fn set_angular_velocity(&mut self, body: BodyHandle, angular: Vec3) -> Result<(), Error> {
        let index = self.index(body)?;
        limits::speed("angular velocity", angular)?;
        self.put_velocity(index, [None, Some(angular)], None, Change::SetAngularVelocity(body, angular));
        Ok(())
    }

    /// Sets the linear and the angular velocity of a body, or one of them, and the pose that it is to reach
    /// by that.
    fn put_velocity(
        &mut self,
        index: usize,
        [linear, angular]: [Option<Vec3>; 2],
        target: Option<Target>,
        change: Change<'_>,
    ) {
        let (slot, old) = (self.bodies.slot[index], self.bodies.velocity[index]);
        let new =
            Record { linear: linear.unwrap_or(old.linear), angular: angular.unwrap_or(old.angular), ..old };
        let same = new == old && self.bodies.rare.targets.get(slot) == target;
        if same || self.bodies.kind[index] == BodyKind::Static {
            return;
        }
        self.note(change);
        let index = if new == old { index } else { self.wake_body(index) };
        self.bodies.velocity[index] = new;
        self.bodies.rare.targets.set(slot, target);
    }

    /// Velocity of the point of a body that is at a point of the world now [m/s].
    ///
    /// ```
    /// # use backstop::{*, glam::{DVec3, Quat, Vec3}};
    /// # let mut world = World::new(Settings::default())?;
    /// # let ground = world.add_body(&BodyDesc::fixed().with_shape(ShapeDesc::new(Geometry::plane())))?;
    /// # let cube = ShapeDesc::new(Geometry::cuboid(0.5, 0.5, 0.5));
    /// # let desc = BodyDesc::dynamic().with_position(Vec3::Y * 2.0).with_shape(cube);
    /// # let body = world.add_body(&desc)?;
    /// world.set_angular_velocity(body, Vec3::Y * 2.0)?;
    /// let rim = world.velocity_at(body, DVec3::new(0.5, 2.0, 0.0))?;
    /// assert!((rim - Vec3::NEG_Z).length() < 1e-6);
    /// # Ok::<(), Error>(())
    /// ```
    ///
    /// # Errors
    /// If the handle is stale or the point is beyond [`limits::MAX_POSITION`].
    pub fn velocity_at(&self, body: BodyHandle, point: DVec3) -> Result<Vec3, Error> {
        let index = self.index(body)?;
        limits::position(point)?;
        let (pose, velocity) = (&self.bodies.pose[index], &self.bodies.velocity[index]);
        Ok(velocity.linear + velocity.angular.cross((point - pose.position).as_vec3()))
    }

    /// Moves a kinematic body to a pose of its origin within the next step, which takes `dt` seconds: gives
    /// it the velocity that leads there, and after the step it is exactly where [`World::set_pose`] would
    /// have put it. In a step of another length it moves with that velocity too, and **in the steps after it
    /// moves on**, as with a velocity that was set: call it before each step, or
    /// [`World::move_kinematic_and_stop`]. The last call before a step counts; setting the pose or the
    /// velocity takes it back. A dynamic body just gets the velocity, a static one stays.
    ///
    /// ```
    /// # use backstop::{*, glam::{DVec3, Quat, Vec3}};
    /// # let mut world = World::new(Settings::default())?;
    /// # let ground = world.add_body(&BodyDesc::fixed().with_shape(ShapeDesc::new(Geometry::plane())))?;
    /// # let cube = ShapeDesc::new(Geometry::cuboid(0.5, 0.5, 0.5));
    /// # let desc = BodyDesc::dynamic().with_position(Vec3::Y * 2.0).with_shape(cube);
    /// # let body = world.add_body(&desc)?;
    /// // A lift: bodies on it are carried along.
    /// let slab = ShapeDesc::new(Geometry::cuboid(2.0, 0.1, 2.0));
    /// let lift = world.add_body(&BodyDesc::kinematic().with_position(Vec3::X * 9.0).with_shape(slab))?;
    /// let dt = 1.0 / 60.0;
    /// for i in 1..=60 {
    ///     let height = f64::from(i) / 60.0;
    ///     world.move_kinematic(lift, DVec3::new(9.0, height, 0.0), Quat::IDENTITY, dt)?;
    ///     world.step(dt)?;
    /// }
    /// assert!((world.position(lift)?.y - 1.0).abs() < 1e-4);
    /// # Ok::<(), Error>(())
    /// ```
    ///
    /// # Errors
    /// If the handle is stale, the pose is not one, `dt` is not the length of a step, the velocity is beyond
    /// [`limits::MAX_SPEED`], or the budget does not allow it.
    pub fn move_kinematic(
        &mut self,
        body: BodyHandle,
        position: DVec3,
        rotation: glam::Quat,
        dt: f32,
    ) -> Result<(), Error> {
        self.aim(body, position, rotation, dt, AfterTarget::MoveOn)
    }

    /// Moves a kinematic body to a pose of its origin within the next step, as [`World::move_kinematic`]
    /// does, and has it stand there in the steps after, until it is moved again, as a platform does. After
    /// the step it still has the velocity that led there, for readers; the next step begins by removing it.
    /// Other bodies are treated as there.
    ///
    /// # Errors
    /// As for [`World::move_kinematic`].
    pub fn move_kinematic_and_stop(
        &mut self,
        body: BodyHandle,
        position: DVec3,
        rotation: glam::Quat,
        dt: f32,
    ) -> Result<(), Error> {
        self.aim(body, position, rotation, dt, AfterTarget::Stop)
    }

    /// Gives a body the velocity that leads to a pose of its origin in `dt` seconds.
    fn aim(
        &mut self,
        body: BodyHandle,
        position: DVec3,
        rotation: glam::Quat,
        dt: f32,
        after: AfterTarget,
    ) -> Result<(), Error> {
        let index = self.index(body)?;
        limits::position(position)?;
        let given = rotation;
        let rotation = unit_quat("rotation", rotation)?;
        limits::step(dt)?;
        let target = Target { position, rotation, dt, after };
        let (pose, details) = (&self.bodies.pose[index], &self.bodies.details[index]);
        let centre = position + (rotation * details.centre).as_dvec3();
        let linear = ((centre - pose.position) / f64::from(dt)).as_vec3();
        let mut turn = rotation * details.axes * pose.rotation.conjugate();
        if turn.w < 0.0 {
            turn = -turn;
        }
        // Not glam's `to_scaled_axis`: it uses the platform's arc tangent.
        let part = turn.xyz();
        let sine = part.length();
        let angle = if sine > 0.0 { 2.0 * libm::atan2f(sine, turn.w) / sine } else { 2.0 };
        let angular = part * (angle / dt);
        limits::speed("linear velocity", linear)?;
        limits::speed("angular velocity", angular)?;
        let kinematic = self.bodies.kind[index] == BodyKind::Kinematic;
        if kinematic {
            self.reserve(Addition::Rare(RareCounts { targets: 1, ..RareCounts::default() }))?;
        }
        // As given: normalising twice may change a bit.
        let change = match after {
            AfterTarget::Stop => Change::MoveKinematicAndStop(body, position, given, dt),
            _ => Change::MoveKinematic(body, position, given, dt),
        };
        let target = kinematic.then_some(target);
        self.put_velocity(index, [Some(linear), Some(angular)], target, change);
        Ok(())
    }

    /// Adds a force [N] at the centre of mass of a dynamic body, for the next step. Forces and impulses on
    /// other bodies, here and below, are checked and have no effect.
    ///
    /// ```
    /// # use backstop::{*, glam::{DVec3, Quat, Vec3}};
    /// # let mut world = World::new(Settings::default())?;
    /// # let ground = world.add_body(&BodyDesc::fixed().with_shape(ShapeDesc::new(Geometry::plane())))?;
    /// # let cube = ShapeDesc::new(Geometry::cuboid(0.5, 0.5, 0.5));
    /// # let desc = BodyDesc::dynamic().with_position(Vec3::Y * 2.0).with_shape(cube);
    /// # let body = world.add_body(&desc)?;
    /// // As strong as its weight: it hovers.
    /// let weight = 9.81 * world.mass(body)?;
    /// world.add_force(body, Vec3::Y * weight)?;
    /// world.step(1.0 / 60.0)?;
    /// assert!(world.linear_velocity(body)?.y.abs() < 1e-3);
    /// # Ok::<(), Error>(())
    /// ```
    ///
    /// # Errors
    /// If the handle is stale, a number or the sum for this step is beyond [`limits::MAX_FORCE`], or, for the
    /// first force of a world, the budget does not allow it.
    pub fn add_force(&mut self, body: BodyHandle, force: Vec3) -> Result<(), Error> {
        self.add_force_and_torque(body, force, Vec3::ZERO)
    }

    /// Adds a torque [N m] to a dynamic body, for the next step.
    ///
    /// # Errors
    /// As for [`World::add_force`].
    pub fn add_torque(&mut self, body: BodyHandle, torque: Vec3) -> Result<(), Error> {
        self.add_force_and_torque(body, Vec3::ZERO, torque)
    }

    /// Adds a force [N] at the centre of mass and a torque [N m] to a dynamic body, for the next step.
    ///
    /// # Errors
    /// As for [`World::add_force`].
    pub fn add_force_and_torque(&mut self, body: BodyHandle, force: Vec3, torque: Vec3) -> Result<(), Error> {
        let index = self.index(body)?;
        limits::force("force", force)?;
        limits::force("torque", torque)?;
        if self.bodies.kind[index] != BodyKind::Dynamic {
            return Ok(());
        }
        let sum = self.bodies.force.get(index).copied().unwrap_or_default();
        limits::force("sum of forces", sum.linear + force)?;
        limits::force("sum of torques", sum.angular + torque)?;
        if self.bodies.force.is_empty() {
            // The column exists only once a force was applied.
            self.reserve(Addition::Force)?;
            self.bodies.make_forces();
        }
        self.note(Change::AddForce(body, force, torque));
        let index = self.wake_body(index);
        self.bodies.note_push();
        let sum = &mut self.bodies.force[index];
        sum.linear += force;
        sum.angular += torque;
        Ok(())
    }

    /// Adds a force [N] at a point of the world to a dynamic body, for the next step.
    ///
    /// # Errors
    /// As for [`World::add_force`]; the torque follows from the point. Also if the point is beyond
    /// [`limits::MAX_POSITION`].
    pub fn add_force_at(&mut self, body: BodyHandle, force: Vec3, point: DVec3) -> Result<(), Error> {
        limits::position(point)?;
        let arm = (point - self.bodies.pose[self.index(body)?].position).as_vec3();
        self.add_force_and_torque(body, force, arm.cross(force))
    }

    /// Changes the angular velocity of a dynamic body by an impulse about its centre of mass [N m s].
    ///
    /// # Errors
    /// If the handle is stale, a number is beyond [`limits::MAX_FORCE`], or the velocity would be beyond
    /// [`limits::MAX_SPEED`].
    pub fn apply_angular_impulse(&mut self, body: BodyHandle, impulse: Vec3) -> Result<(), Error> {
        let index = self.index(body)?;
        limits::force("angular impulse", impulse)?;
        if self.bodies.kind[index] != BodyKind::Dynamic {
            return Ok(());
        }
        let velocity = self.after_impulses(index, Vec3::ZERO, impulse);
        limits::speed("angular velocity after the impulse", velocity.angular)?;
        self.note(Change::ApplyAngularImpulse(body, impulse));
        let index = self.wake_body(index);
        self.bodies.velocity[index] = velocity;
        Ok(())
    }

    /// Changes the linear velocity of a dynamic body by an impulse [N s] at its centre of mass.
    ///
    /// ```
    /// # use backstop::{*, glam::{DVec3, Quat, Vec3}};
    /// # let mut world = World::new(Settings::default())?;
    /// # let ground = world.add_body(&BodyDesc::fixed().with_shape(ShapeDesc::new(Geometry::plane())))?;
    /// # let cube = ShapeDesc::new(Geometry::cuboid(0.5, 0.5, 0.5));
    /// # let desc = BodyDesc::dynamic().with_position(Vec3::Y * 2.0).with_shape(cube);
    /// # let body = world.add_body(&desc)?;
    /// // A jump of 3 m/s.
    /// let impulse = 3.0 * world.mass(body)?;
    /// world.apply_impulse(body, Vec3::Y * impulse)?;
    /// assert!((world.linear_velocity(body)?.y - 3.0).abs() < 1e-5);
    /// # Ok::<(), Error>(())
    /// ```
    ///
    /// # Errors
    /// As for [`World::apply_impulse_at`].
    pub fn apply_impulse(&mut self, body: BodyHandle, impulse: Vec3) -> Result<(), Error> {
        self.apply_impulse_at(body, impulse, self.centre_of_mass(body)?)
    }

    /// Changes the velocity of a dynamic body by an impulse [N s] at a point of the world [m].
    ///
    /// ```
    /// # use backstop::{*, glam::{DVec3, Quat, Vec3}};
    /// # let mut world = World::new(Settings::default())?;
    /// # let ground = world.add_body(&BodyDesc::fixed().with_shape(ShapeDesc::new(Geometry::plane())))?;
    /// # let cube = ShapeDesc::new(Geometry::cuboid(0.5, 0.5, 0.5));
    /// # let desc = BodyDesc::dynamic().with_position(Vec3::Y * 2.0).with_shape(cube);
    /// # let body = world.add_body(&desc)?;
    /// // A kick above the centre also turns it.
    /// world.apply_impulse_at(body, Vec3::X * 100.0, DVec3::new(-0.5, 2.3, 0.0))?;
    /// assert!(world.angular_velocity(body)?.z < 0.0);
    /// # Ok::<(), Error>(())
    /// ```
    ///
    /// # Errors
    /// If the handle is stale, a number is beyond [`limits::MAX_FORCE`], or the velocity would be beyond
    /// [`limits::MAX_SPEED`].
    pub fn apply_impulse_at(&mut self, body: BodyHandle, impulse: Vec3, point: DVec3) -> Result<(), Error> {
        let index = self.index(body)?;
        limits::force("impulse", impulse)?;
        limits::position(point)?;
        if self.bodies.kind[index] != BodyKind::Dynamic {
            return Ok(());
        }
        let arm = (point - self.bodies.pose[index].position).as_vec3();
        let velocity = self.after_impulses(index, impulse, arm.cross(impulse));
        limits::speed("linear velocity after the impulse", velocity.linear)?;
        limits::speed("angular velocity after the impulse", velocity.angular)?;
        self.note(Change::ApplyImpulse(body, impulse, point));
        let index = self.wake_body(index);
        self.bodies.velocity[index] = velocity;
        Ok(())
    }

    /// Refuses what [`World::apply_impulse`] and [`World::apply_angular_impulse`] would refuse, one after the
    /// other.
    pub(crate) fn check_impulses(&self, body: BodyHandle, impulse: Vec3, about: Vec3) -> Result<(), Error> {
        let index = self.index(body)?;
        limits::force("impulse", impulse)?;
        limits::force("angular impulse", about)?;
        if self.bodies.kind[index] != BodyKind::Dynamic {
            return Ok(());
        }
        let velocity = self.after_impulses(index, impulse, about);
        limits::speed("linear velocity after the impulse", velocity.linear)?;
        limits::speed("angular velocity after the impulse", velocity.angular)
    }

    /// The velocity of a body after an impulse at its centre of mass, and `t` about it.
    fn after_impulses(&self, index: usize, impulse: Vec3, t: Vec3) -> Record {
        let mass = &self.bodies.mass[index];
        let inverse = world_inertia(&self.bodies, index);
        let mut velocity = self.bodies.velocity[index];
        velocity.linear += impulse * mass.inverse;
        velocity.angular += inverse.mul(crate::lanes::Vec3::new(t.x, t.y, t.z)).lane(0);
        self.bodies.traits[index].lock(&mut velocity);
        velocity
    }
}

pub(crate) fn finite_position(position: DVec3) -> Result<(), Error> {
    match position.to_array().into_iter().find(|v| !v.is_finite()) {
        Some(value) => Err(Error::NotFinite { what: "position", value }),
        None => Ok(()),
    }
}
