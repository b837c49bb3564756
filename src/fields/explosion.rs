//! Explosions: one impulse on all that is near.

use super::silhouette::silhouette;
use crate::config::fields;
use crate::error::Error;
use crate::handle::BodyHandle;
use crate::limits;
use crate::math::Quat;
use crate::query::{ClosestPoint, QueryFilter, Ray};
use crate::shape::Filter;
use crate::world::World;
use glam::{DVec3, Vec3};

fields! {
    /// A pressure wave that pushes dynamic bodies away from a point, all at once:
    /// [`World::apply_explosion`].
    ///
    /// Each shape gets [`impulse_per_area`](Explosion::impulse_per_area) times the area that it shows to
    /// the centre, at its nearest point. A large body is pushed more than a small one; a heavy one moves
    /// less.
    ///
    /// ```
    /// use backstop::glam::{DVec3, Vec3};
    /// use backstop::{BodyDesc, Explosion, Geometry, Settings, ShapeDesc, World};
    ///
    /// # fn main() -> Result<(), backstop::Error> {
    /// let mut world = World::new(Settings::default())?;
    /// let crate_of_wood = ShapeDesc::new(Geometry::cuboid(0.5, 0.5, 0.5)).with_density(400.0);
    /// let body = BodyDesc::dynamic().with_position(DVec3::X * 3.0).with_shape(crate_of_wood);
    /// let body = world.add_body(&body)?;
    /// // A face of 1 m² is 2.5 m away, in the middle of the falloff: 400 N s on 400 kg.
    /// let explosion = Explosion::default().with_radius(2.0).with_falloff(1.0).with_impulse_per_area(800.0);
    /// assert_eq!(world.apply_explosion(&explosion)?, 1);
    /// assert!((world.linear_velocity(body)? - Vec3::X).length() < 1e-5);
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
    pub struct Explosion {
        /// Its centre [m].
        with_position(position: DVec3, into) = DVec3::ZERO;
        /// Shapes up to this distance get the whole impulse [m].
        with_radius(radius: f32) = 2.0, "explosion radius" [0.0, limits::MAX_LENGTH] "in 0..=1e6";
        /// Beyond the radius the impulse falls linearly to zero over this distance [m].
        with_falloff(falloff: f32) = 4.0, "explosion falloff" [0.0, limits::MAX_LENGTH] "in 0..=1e6";
        /// Impulse on each square metre that is seen from the centre [N s/m²]; below zero it pulls.
        with_impulse_per_area(impulse_per_area: f32) = 500.0,
            "explosion impulse" [-limits::MAX_FORCE, limits::MAX_FORCE] "within 1e18";
        /// Whether static shapes give shelter: a shape is spared if rays from the centre to its nearest point
        /// and to the middle of its box are both blocked. Put the centre above the ground then, not on it.
        with_occluded(occluded: bool) = false;
        /// If set, only shapes that would collide with one of this filter are pushed.
        with_filter(filter: Option<Filter>, into) = None;
        /// A body that is not pushed, such as the one that explodes. A stale handle excludes nothing.
        with_exclude_body(exclude_body: Option<BodyHandle>, into) = None;
    }
}

impl Explosion {
    /// Checks every number.
    ///
    /// # Errors
    /// Names the first that is not finite or out of its range.
    pub fn validate(&self) -> Result<(), Error> {
        limits::position(self.position)?;
        self.check_ranges()
    }

    /// The share of the impulse at a distance.
    fn share(&self, distance: f32) -> f32 {
        let beyond = distance - self.radius;
        if beyond <= 0.0 { 1.0 } else { (1.0 - beyond / self.falloff).max(0.0) }
    }

    /// The impulse on one shape: impulse [N s] and the point of the world where it acts [m].
    fn push(&self, world: &World, near: &ClosestPoint) -> Result<(Vec3, DVec3), Error> {
        let bounds = world.shape_aabb(near.shape)?;
        let middle = bounds.centre();
        if self.occluded && self.is_hidden(world, near.point)? && self.is_hidden(world, middle)? {
            return Ok((Vec3::ZERO, near.point));
        }
        // From within a shape the middle of it is pushed away; from the middle, up.
        let way = if near.inside { middle - self.position } else { near.point - self.position };
        let way = limits::direction("direction", way.as_vec3()).unwrap_or(Vec3::Y);
        let (_, rotation) = world.shape_world_pose(near.shape)?;
        let area = silhouette(world.geometry(near.shape)?, Quat::from(rotation).conjugate() * way);
        let at = if near.inside { middle } else { near.point };
        Ok((way * (self.impulse_per_area * area * self.share(near.distance)), at))
    }

    /// Whether something static is between the centre and a point.
    fn is_hidden(&self, world: &World, point: DVec3) -> Result<bool, Error> {
        // Rounding: the point may lie on a static surface.
        let ray = Ray::new(self.position, ((point - self.position) * (1.0 - 1e-3)).as_vec3());
        world.cast_ray_any(&ray, &QueryFilter::only_static().skipping_inside())
    }
}

/// # Explosions
impl World {
    /// Pushes all dynamic bodies that an explosion reaches, and wakes them: an impulse for each of their
    /// shapes. Returns how many bodies were pushed. Sensors are not pushed.
    ///
    /// # Errors
    /// If a number of the explosion is out of range, a body would be faster than [`limits::MAX_SPEED`], or
    /// the budget does not allow the tree of moving shapes ([`World::cast_ray`]).
    pub fn apply_explosion(&mut self, explosion: &Explosion) -> Result<usize, Error> {
        explosion.validate()?;
        let filter = QueryFilter {
            filter: explosion.filter,
            exclude_body: explosion.exclude_body,
            ..QueryFilter::only_dynamic()
        };
        let reach = explosion.radius + explosion.falloff;
        let mut near = Vec::new();
        self.closest_point_all(explosion.position, reach, &filter, &mut near)?;
        let mut pushes: Vec<(BodyHandle, Vec3, Vec3)> = Vec::new();
        near.sort_unstable_by_key(|near| (near.body, near.shape));
        for near in &near {
            let (impulse, at) = explosion.push(self, near)?;
            if impulse == Vec3::ZERO {
                continue;
            }
            let about = (at - self.centre_of_mass(near.body)?).as_vec3().cross(impulse);
            match pushes.last_mut().filter(|last| last.0 == near.body) {
                Some(last) => *last = (near.body, last.1 + impulse, last.2 + about),
                None => pushes.push((near.body, impulse, about)),
            }
        }
        // None is pushed unless all can be.
        for &(body, impulse, about) in &pushes {
            self.check_impulses(body, impulse, about)?;
        }
        for &(body, impulse, about) in &pushes {
            self.apply_impulse(body, impulse)?;
            self.apply_angular_impulse(body, about)?;
        }
        Ok(pushes.len())
    }
}
