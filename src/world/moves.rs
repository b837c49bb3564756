//! Bodies that moved in the last step, for callers that draw or copy them.

use super::World;
use crate::handle::BodyHandle;
use glam::{DVec3, Vec3};

/// A body that moved in the last step: where it is and how fast.
#[derive(Clone, Copy, Debug, PartialEq)]
#[non_exhaustive]
pub struct BodyMove {
    /// The body.
    pub body: BodyHandle,
    /// Its [`user_data`](crate::BodyDesc::user_data).
    pub user_data: u64,
    /// Position of its origin in the world [m].
    pub position: DVec3,
    /// Rotation of its axes.
    pub rotation: glam::Quat,
    /// Position of its centre of mass in the world [m].
    pub centre_of_mass: DVec3,
    /// Velocity of its centre of mass [m/s].
    pub linear_velocity: Vec3,
    /// Angular velocity about the world's axes [rad/s].
    pub angular_velocity: Vec3,
    /// Whether it fell asleep since the step began; it is not listed again until it wakes.
    pub fell_asleep: bool,
}

/// # Bodies that moved
impl World {
    /// Awake dynamic bodies.
    pub fn awake_bodies(&self) -> impl Iterator<Item = BodyHandle> + '_ {
        (0..self.bodies.dynamic()).map(|index| self.handle_of(index))
    }

    /// Bodies that the last step moved, with their poses and velocities: first dynamic ones that are awake,
    /// then kinematic ones with a velocity, then dynamic ones that fell asleep at the end of the step, once.
    /// Within each of these the order depends only on the past, not on the number of threads.
    ///
    /// Takes time for these bodies only, and allocates nothing: for a game that draws what moved. A sleeping
    /// world has none.
    ///
    /// To be called after a step, before other calls change bodies: those that were added, woken or given a
    /// velocity since are listed too. [`World::restore`] also moves bodies that sleep, and they are not
    /// listed: after it, go through [`World::bodies`].
    ///
    /// ```
    /// # use backstop::{*, glam::{DVec3, Quat, Vec3}};
    /// # let mut world = World::new(Settings::default().with_sleeping(true))?;
    /// # let ground = world.add_body(&BodyDesc::fixed().with_shape(ShapeDesc::new(Geometry::plane())))?;
    /// # let cube = ShapeDesc::new(Geometry::cuboid(0.5, 0.5, 0.5));
    /// # let desc = BodyDesc::dynamic().with_position(Vec3::Y * 2.0).with_shape(cube);
    /// # let mut drawn = [DVec3::ZERO];
    /// // What is drawn for a body is found by its user data.
    /// let body = world.add_body(&desc.with_user_data(0))?;
    /// for _ in 0..180 {
    ///     world.step(1.0 / 60.0)?;
    ///     for moved in world.body_moves() {
    ///         drawn[moved.user_data as usize] = moved.position;
    ///     }
    /// }
    /// assert_eq!(drawn[0], world.position(body)?);
    /// assert_eq!(world.body_moves().count(), 0, "it sleeps");
    /// # Ok::<(), Error>(())
    /// ```
    pub fn body_moves(&self) -> impl Iterator<Item = BodyMove> + '_ {
        let bodies = &self.bodies;
        let [dynamic, movers] = match self.buffers.dt > 0.0 {
            true => [bodies.dynamic(), bodies.movers()],
            false => [0; 2],
        };
        let moves = |&index: &usize| {
            let velocity = &bodies.velocity[index];
            velocity.linear != Vec3::ZERO || velocity.angular != Vec3::ZERO
        };
        let awake = (0..dynamic).chain((dynamic..movers).filter(moves));
        let slept = self.sleep.fell_asleep.iter().filter_map(|&body| {
            let index = self.index(body).ok()?;
            self.is_sleeping(body).is_ok_and(|asleep| asleep).then(|| self.body_move(index, true))
        });
        awake.map(|index| self.body_move(index, false)).chain(slept)
    }

    #[inline]
    fn body_move(&self, index: usize, fell_asleep: bool) -> BodyMove {
        let (details, velocity) = (&self.bodies.details[index], &self.bodies.velocity[index]);
        let (position, rotation) = details.origin_at(&self.bodies.pose[index]);
        BodyMove {
            body: self.handle_of(index),
            user_data: details.user_data,
            position,
            rotation: rotation.into(),
            centre_of_mass: self.bodies.pose[index].position,
            linear_velocity: velocity.linear,
            angular_velocity: velocity.angular,
            fell_asleep,
        }
    }
}
