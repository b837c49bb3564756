//! The description of a body that a caller adds.

use crate::config::{ContinuousMode, RowGroup, fields};
use crate::error::{Error, each};
use crate::limits;
use crate::limits::unit_quat;
use crate::shape::{MassProperties, ShapeDesc};
use glam::{DVec3, Vec3};

/// How a body moves.
///
/// Calls that make no sense for a kind are no errors, so that an explosion need not check the kind of each
/// body; they check their numbers and change nothing:
///
/// | Call | Static | Kinematic | Dynamic |
/// | --- | --- | --- | --- |
/// | [`set_velocity`] and the like | no effect | yes | yes |
/// | [`move_kinematic`], [`move_kinematic_and_stop`] | no effect | yes | sets the velocity |
/// | [`add_force`], [`apply_impulse`] and the like | no effect | no effect | yes |
/// | [`set_mass`] | kept for a change of kind | the same | yes |
/// | damping, caps of speeds, gravity scale, locks | kept for a change of kind | the same | yes |
/// | [`wake`], [`sleep`] | no effect | no effect | yes |
///
/// [`set_velocity`]: crate::World::set_velocity
/// [`move_kinematic`]: crate::World::move_kinematic
/// [`move_kinematic_and_stop`]: crate::World::move_kinematic_and_stop
/// [`add_force`]: crate::World::add_force
/// [`apply_impulse`]: crate::World::apply_impulse_at
/// [`set_mass`]: crate::World::set_mass
/// [`wake`]: crate::World::wake
/// [`sleep`]: crate::World::sleep
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize), serde(rename_all = "lowercase"))]
pub enum BodyKind {
    /// Nothing: it has no velocity.
    Static,
    /// Its velocity alone, which nothing changes but the caller: it pushes and is not pushed.
    Kinematic,
    /// Forces and contacts.
    #[default]
    Dynamic,
}

fields! {
    /// A body to be added.
    ///
    /// With the feature `serde` fields with their default may be left out.
    ///
    /// ```
    /// use backstop::{BodyDesc, Geometry, ShapeDesc, glam::Vec3};
    ///
    /// // A hammer that flies to the right and turns: a handle and a head.
    /// let handle = ShapeDesc::new(Geometry::cuboid(0.02, 0.3, 0.02));
    /// let head = ShapeDesc::new(Geometry::cuboid(0.1, 0.05, 0.05)).with_position(Vec3::Y * 0.3);
    /// let hammer = BodyDesc::dynamic()
    ///     .with_position(Vec3::new(0.0, 2.0, 0.0))
    ///     .with_velocity(Vec3::X * 5.0, Vec3::Z * -10.0)
    ///     .with_shape(handle)
    ///     .with_shape(head);
    /// assert_eq!(hammer.shapes.len(), 2);
    /// ```
    #[derive(Clone, Debug)]
    #[cfg_attr(
        feature = "serde",
        derive(serde::Serialize, serde::Deserialize),
        serde(default, deny_unknown_fields)
    )]
    #[non_exhaustive]
    pub struct BodyDesc {
        /// What moves it.
        with_kind(kind: BodyKind) = BodyKind::Dynamic;
        /// Where its origin is [m], within [`limits::MAX_POSITION`] along each axis.
        with_position(position: DVec3, into) = DVec3::ZERO;
        /// How its axes are turned; a unit quaternion.
        with_rotation(rotation: glam::Quat, into) = glam::Quat::IDENTITY;
        /// Velocity of its centre of mass [m/s].
        with_linear_velocity(linear_velocity: Vec3, into) = Vec3::ZERO,
            "linear velocity" [-limits::MAX_SPEED, limits::MAX_SPEED] "within 1e6 along each axis";
        /// About the world's axes [rad/s].
        with_angular_velocity(angular_velocity: Vec3, into) = Vec3::ZERO,
            "angular velocity" [-limits::MAX_SPEED, limits::MAX_SPEED] "within 1e6 along each axis";
        /// Its shapes; several make a compound.
        _(shapes: Vec<ShapeDesc>) = Vec::new();
        /// Mass, centre and inertia in the body's axes; `None`: from the shapes and their densities.
        with_mass(mass: Option<MassProperties>, into) = None;
        /// Factor on gravity.
        with_gravity_scale(gravity_scale: f32) = 1.0,
            "gravity scale" [-limits::MAX_ACCELERATION, limits::MAX_ACCELERATION]
            "within 1e6 along each axis";
        /// Share of its linear velocity that it loses in a second, while that share is small: the velocity of
        /// a body that nothing else acts on falls as exp(-c t), whatever the length of steps [1/s]. Dynamic
        /// bodies only.
        with_linear_damping(linear_damping: f32) = 0.0,
            "linear damping" [0.0, limits::MAX_DAMPING] "in 0..=1e6";
        /// The same for its angular velocity [1/s].
        with_angular_damping(angular_damping: f32) = 0.0,
            "angular damping" [0.0, limits::MAX_DAMPING] "in 0..=1e6";
        /// Greatest speed of its centre of mass [m/s]: whatever would make it faster makes it as fast as
        /// this, in the same direction, in each substep and at the end of a step. Momentum and energy beyond
        /// it are lost. Dynamic bodies only.
        with_max_linear_speed(max_linear_speed: Option<f32>, into) = None,
            "maximum linear speed" [0.0, limits::MAX_SPEED] "in 0..=1e6";
        /// The same for its angular velocity [rad/s].
        with_max_angular_speed(max_angular_speed: Option<f32>, into) = None,
            "maximum angular speed" [0.0, limits::MAX_SPEED] "in 0..=1e6";
        /// World axes along which it can't move.
        with_lock_translation(lock_translation: [bool; 3]) = [false; 3];
        /// World axes about which it can't turn.
        with_lock_rotation(lock_rotation: [bool; 3]) = [false; 3];
        /// How it is kept from passing through others: two collide by the greater of their modes, save that
        /// what is static has none.
        with_continuous(continuous: ContinuousMode) = ContinuousMode::Segment;
        /// Has its rows, those of its contacts and joints, solved right after those of this group, unless
        /// their own place is later: what is solved later wins.
        with_solved_after(solved_after: Option<RowGroup>, into) = None;
        /// Whether it may fall asleep, and its island with it.
        with_can_sleep(can_sleep: bool) = true;
        /// Free for the caller.
        with_user_data(user_data: u64) = 0;
    }
}

impl BodyDesc {
    /// A body of the given kind at the origin, without shapes.
    pub fn new(kind: BodyKind) -> Self {
        BodyDesc { kind, ..Default::default() }
    }
    /// A body that nothing moves.
    pub fn fixed() -> Self {
        Self::new(BodyKind::Static)
    }
    /// A body that its velocity alone moves.
    pub fn kinematic() -> Self {
        Self::new(BodyKind::Kinematic)
    }
    /// A body that forces and contacts move.
    pub fn dynamic() -> Self {
        Self::new(BodyKind::Dynamic)
    }
    /// Linear [m/s] and angular [rad/s] velocity.
    pub fn with_velocity(mut self, linear: Vec3, angular: Vec3) -> Self {
        (self.linear_velocity, self.angular_velocity) = (linear, angular);
        self
    }
    /// All shapes, instead of those that it has.
    #[must_use]
    pub fn with_shapes(mut self, shapes: impl IntoIterator<Item = ShapeDesc>) -> Self {
        self.shapes = shapes.into_iter().collect();
        self
    }
    /// One more shape.
    pub fn with_shape(mut self, shape: ShapeDesc) -> Self {
        self.shapes.push(shape);
        self
    }

    /// Checks every range.
    ///
    /// # Errors
    /// Names the first number that is out of range, or a shape that the kind of body can't have.
    pub fn validate(&self) -> Result<(), Error> {
        limits::position(self.position)?;
        unit_quat("rotation", self.rotation)?;
        self.check_ranges()?;
        each("shape", &self.shapes, |shape| {
            shape.validate()?;
            if self.kind == BodyKind::Dynamic { shape.geometry.require_convex() } else { Ok(()) }
        })?;
        if let Some(mass) = &self.mass {
            mass.validate()?;
        }
        Ok(())
    }
}
