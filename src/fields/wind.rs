//! Wind and the resistance of air.

use super::region::{apply, shapes};
use super::silhouette::silhouette;
use crate::config::fields;
use crate::error::Error;
use crate::limits;
use crate::shape::Filter;
use crate::world::World;
use glam::Vec3;

fields! {
    /// Moving or still air: `density drag area speed² / 2` on each shape, by the area that it shows to the
    /// wind and its speed against it. A falling body reaches its terminal speed in it.
    ///
    /// ```
    /// use backstop::fields::Wind;
    /// use backstop::glam::Vec3;
    /// use backstop::{BodyDesc, Geometry, Settings, ShapeDesc, World};
    ///
    /// # fn main() -> Result<(), backstop::Error> {
    /// let mut world = World::new(Settings::default().with_gravity(Vec3::ZERO))?;
    /// let leaf = ShapeDesc::new(Geometry::cuboid(0.05, 0.05, 0.001)).with_density(100.0);
    /// let leaf = world.add_body(&BodyDesc::dynamic().with_shape(leaf))?;
    /// for _ in 0..600 {
    ///     Wind::default().with_velocity(Vec3::Z * 5.0).apply_to(&mut world, 1.0 / 60.0)?;
    ///     world.step(1.0 / 60.0)?;
    /// }
    /// assert!((world.linear_velocity(leaf)?.z - 5.0).abs() < 0.1);
    /// # Ok(())
    /// # }
    /// ```
    #[derive(Clone, Copy, Debug, PartialEq)]
    #[cfg_attr(
        feature = "serde",
        derive(serde::Serialize, serde::Deserialize),
        serde(default, deny_unknown_fields)
    )]
    #[non_exhaustive]
    pub struct Wind {
        /// Velocity of the air [m/s].
        with_velocity(velocity: Vec3, into) = Vec3::ZERO,
            "wind" [-limits::MAX_SPEED, limits::MAX_SPEED] "within 1e6 along each axis";
        /// Density of the air [kg/m³].
        with_density(density: f32) = 1.2, "air density" [0.0, limits::MAX_DENSITY] "in 0..=1e15";
        /// Coefficient of drag: 0.47 of a sphere, about 1 of a cube.
        with_drag(drag: f32) = 1.0, "drag coefficient" [0.0, 1e6] "in 0..=1e6";
        /// If set, only shapes that would collide with one of this filter are blown at.
        with_filter(filter: Option<Filter>, into) = None;
    }
}

impl Wind {
    /// Checks every range.
    ///
    /// # Errors
    /// Names the first that is out of range.
    pub fn validate(&self) -> Result<(), Error> {
        self.check_ranges()
    }

    /// Adds the force of the air for the next step, of `dt` [s], to all dynamic bodies that are awake.
    /// Returns how many these are.
    ///
    /// # Errors
    /// If a number is out of range, or a force is beyond [`limits::MAX_FORCE`].
    pub fn apply_to(&self, world: &mut World, dt: f32) -> Result<usize, Error> {
        self.validate()?;
        limits::step(dt)?;
        let gravity = world.settings().gravity;
        let mut pushes = Vec::new();
        for shape in shapes(world, None, self.filter)? {
            let (mass, scale) = (world.mass(shape.body)?, world.gravity_scale(shape.body)?);
            let fall = gravity * (scale * dt);
            let against = self.velocity - world.velocity_at(shape.body, shape.position)? - fall;
            let speed = against.length();
            let Ok(along) = limits::direction("wind", against) else { continue };
            let area = silhouette(shape.geometry, shape.rotation.conjugate() * along);
            // The speed after the step (implicit Euler): a light body takes the velocity of the air at most,
            // and one that falls its terminal speed.
            let drag = 0.5 * self.density * self.drag * area;
            let after = 2.0 * speed / (1.0 + (1.0 + 4.0 * drag * speed * dt / mass).sqrt());
            pushes.push((shape.body, along * (drag * after * after), shape.position, Vec3::ZERO));
        }
        apply(world, &pushes)
    }
}
