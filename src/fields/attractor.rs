//! Points that attract or repel.

use super::region::bodies;
use crate::config::fields;
use crate::error::Error;
use crate::limits;
use crate::world::World;
use glam::{DVec3, Vec3};

fields! {
    /// A planet, a magnet, a black hole: attracts bodies by the inverse square of their distance.
    ///
    /// ```
    /// use backstop::fields::Attractor;
    /// use backstop::glam::{DVec3, Vec3};
    /// use backstop::{BodyDesc, Geometry, Settings, ShapeDesc, World};
    ///
    /// # fn main() -> Result<(), backstop::Error> {
    /// let mut world = World::new(Settings::default().with_gravity(Vec3::ZERO))?;
    /// let moon = BodyDesc::dynamic().with_position(DVec3::X * 10.0).with_linear_velocity(Vec3::Z * 2.0);
    /// let moon = world.add_body(&moon.with_shape(ShapeDesc::new(Geometry::sphere(0.5))))?;
    /// // The speed of a circle is sqrt(strength / radius).
    /// let planet = Attractor::default().with_strength(40.0).with_softening(0.0);
    /// for _ in 0..600 {
    ///     planet.apply_to(&mut world, 1.0 / 60.0)?;
    ///     world.step(1.0 / 60.0)?;
    /// }
    /// assert!((world.position(moon)?.length() - 10.0).abs() < 0.1);
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
    pub struct Attractor {
        /// Where it is [m].
        with_position(position: DVec3, into) = DVec3::ZERO;
        /// Acceleration at a distance of one metre, times a square metre [m³/s²]; below zero it repels.
        with_strength(strength: f32) = 100.0, "attractor strength" [-limits::MAX_FORCE, limits::MAX_FORCE]
            "within 1e18";
        /// Within about this distance the attraction no longer grows, and at its place there is none [m].
        with_softening(softening: f32) = 0.5, "attractor softening" [0.0, limits::MAX_LENGTH] "in 0..=1e6";
        /// The most acceleration [m/s²].
        with_max_acceleration(max_acceleration: f32) = 1000.0,
            "attractor acceleration" [0.0, limits::MAX_ACCELERATION] "in 0..=1e6";
        /// Bodies whose centre of mass is further away are left alone [m].
        with_reach(reach: f32) = 1e6, "attractor reach" [0.0, limits::MAX_LENGTH] "in 0..=1e6";
    }
}

impl Attractor {
    /// Checks every number.
    ///
    /// # Errors
    /// Names the first that is not finite or out of its range.
    pub fn validate(&self) -> Result<(), Error> {
        limits::position(self.position)?;
        self.check_ranges()
    }

    /// Its acceleration at a point of the world [m/s²]; zero beyond its reach.
    pub fn acceleration_at(&self, point: DVec3) -> Vec3 {
        let to = self.position - point;
        let (squared, soft) = (to.length_squared(), f64::from(self.softening).powi(2));
        let distance = (squared + soft).sqrt();
        if squared > f64::from(self.reach).powi(2) || distance == 0.0 {
            return Vec3::ZERO;
        }
        let most = f64::from(self.max_acceleration);
        let size = (f64::from(self.strength) / (squared + soft)).clamp(-most, most);
        (to / distance * size).as_vec3()
    }

    /// Adds its force on all dynamic bodies that are awake and within its reach for the next step, of `dt`
    /// [s]. Returns how many these are. Orbits keep their energy, however long they go on.
    ///
    /// # Errors
    /// If a number is out of range, or a force is beyond [`limits::MAX_FORCE`].
    pub fn apply_to(&self, world: &mut World, dt: f32) -> Result<usize, Error> {
        self.validate()?;
        limits::step(dt)?;
        let mut pulls = Vec::new();
        for body in bodies(world) {
            // In the middle of the step, as by the leapfrog rule: that of where it was would feed an orbit.
            let way = world.linear_velocity(body)?.as_dvec3() * (0.5 * f64::from(dt));
            let pull = self.acceleration_at(world.centre_of_mass(body)? + way);
            if pull != Vec3::ZERO {
                pulls.push((body, pull * world.mass(body)?));
            }
        }
        for &(body, force) in &pulls {
            world.add_force(body, force)?;
        }
        Ok(pulls.len())
    }
}
