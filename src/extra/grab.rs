//! A body held by a point: a mouse, a hand, a crane, a gravity gun.

use crate::body::BodyDesc;
use crate::config::fields;
use crate::error::Error;
use crate::handle::{BodyHandle, JointHandle};
use crate::joint::{Axis, JointDesc, Motion, Motor, Spring};
use crate::limits;
use crate::world::World;
use glam::DVec3;

fields! {
    /// How a [`Grab`] pulls.
    #[derive(Clone, Copy, Debug, PartialEq)]
    #[cfg_attr(
        feature = "serde",
        derive(serde::Serialize, serde::Deserialize),
        serde(default, deny_unknown_fields)
    )]
    #[non_exhaustive]
    pub struct GrabSettings {
        /// How fast the point follows: the frequency of an undamped spring [Hz], whatever the mass.
        with_hertz(hertz: f32) = 5.0, "grab frequency" [0.0, 1e9] "in 0..=1e9";
        /// 1 is critical damping: the fastest without overshoot.
        with_damping_ratio(damping_ratio: f32) = 1.0, "grab damping ratio" [0.0, 1e9] "in 0..=1e9";
        /// The most force along each axis, in multiples of the body's weight at 9.81 m/s²; infinite for no
        /// bound.
        #[cfg_attr(feature = "serde", serde(with = "crate::config::unbounded"))]
        with_max_force(max_force: f32) = 20.0;
        /// How fast the rotation of the held body dies down [1/s]; zero lets it swing freely about the point.
        with_angular_damping(angular_damping: f32) = 5.0,
            "grab damping" [0.0, limits::MAX_DAMPING] "in 0..=1e6";
    }
}

// Guard: the weight that forces are multiples of does not follow a world's gravity, which may be zero.
const STANDARD_GRAVITY: f32 = 9.81;

/// A soft spring from a point of a dynamic body to a place in the world.
///
/// It is a joint to a body without shapes, which the grab adds and [`Grab::release`] removes. Snapshots and
/// recordings of the world have both; the grab itself is three handles.
///
/// ```
/// use backstop::glam::{DVec3, Vec3};
/// use backstop::{BodyDesc, Geometry, Grab, Settings, ShapeDesc, World};
///
/// # fn main() -> Result<(), backstop::Error> {
/// let mut world = World::new(Settings::default())?;
/// let ball = BodyDesc::dynamic().with_shape(ShapeDesc::new(Geometry::sphere(0.2)));
/// let ball = world.add_body(&ball)?;
/// let grab = Grab::new(&mut world, ball, DVec3::ZERO)?;
/// for i in 0..60 {
///     // To the right at 3 m/s.
///     grab.move_to(&mut world, DVec3::X * (0.05 * f64::from(i)))?;
///     world.step(1.0 / 60.0)?;
/// }
/// // It flies on as it moved.
/// grab.release(&mut world)?;
/// assert!((world.linear_velocity(ball)?.x - 3.0).abs() < 0.2);
/// # Ok(())
/// # }
/// ```
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct Grab {
    body: BodyHandle,
    anchor: BodyHandle,
    joint: JointHandle,
}

impl Grab {
    /// Grabs the point of a dynamic body that is at a point of the world now [m], and holds it there.
    ///
    /// # Errors
    /// If the handle is stale, the body is not dynamic, the point is beyond [`limits::MAX_POSITION`] or more
    /// than 1e6 m from the body's origin, or the budget does not allow a joint and a body more.
    pub fn new(world: &mut World, body: BodyHandle, point: DVec3) -> Result<Grab, Error> {
        Grab::with_settings(world, body, point, &GrabSettings::default())
    }

    /// [`Grab::new`] with other settings.
    ///
    /// # Errors
    /// As there, and if a setting is out of range.
    pub fn with_settings(
        world: &mut World,
        body: BodyHandle,
        point: DVec3,
        settings: &GrabSettings,
    ) -> Result<Grab, Error> {
        settings.validate()?;
        let mass = world.mass(body)?;
        let anchor = world.add_body(&BodyDesc::kinematic().with_position(point))?;
        let added = Grab::join(world, body, anchor, point, settings, mass);
        if added.is_err() {
            world.remove_body(anchor)?;
        }
        let joint = added?;
        world.wake(body)?;
        Ok(Grab { body, anchor, joint })
    }

    fn join(
        world: &mut World,
        body: BodyHandle,
        anchor: BodyHandle,
        point: DVec3,
        settings: &GrabSettings,
        mass: f32,
    ) -> Result<JointHandle, Error> {
        let spring = Spring::Frequency { hertz: settings.hertz, ratio: settings.damping_ratio };
        let most = settings.max_force * STANDARD_GRAVITY * mass;
        let brake = Spring::Acceleration { stiffness: 0.0, damping: settings.angular_damping };
        let bodies = [anchor, body];
        let mut joint = JointDesc::new(bodies, world.frames_at(bodies, point, glam::Quat::IDENTITY)?);
        for axis in Axis::ALL {
            joint = joint
                .with_motor(Motor::position(Motion::Linear, axis, 0.0, spring).with_max_force(most))
                .with_motor(Motor::position(Motion::Angular, axis, 0.0, brake));
        }
        world.add_joint(&joint)
    }

    /// Sets where the point is to be [m], and wakes the body if that is another place.
    ///
    /// # Errors
    /// If the grab was released, the body removed, or the place is beyond [`limits::MAX_POSITION`].
    pub fn move_to(&self, world: &mut World, target: DVec3) -> Result<(), Error> {
        if !world.contains(self.body) {
            return Err(Error::StaleBody);
        }
        if world.position(self.anchor)? != target {
            world.set_pose(self.anchor, target, glam::Quat::IDENTITY)?;
            world.wake(self.body)?;
        }
        Ok(())
    }

    /// Lets go: the body keeps its velocity, so a moving one is thrown.
    ///
    /// # Errors
    /// If the grab was released already.
    pub fn release(self, world: &mut World) -> Result<(), Error> {
        world.remove_body(self.anchor)
    }

    /// The body.
    pub fn body(&self) -> BodyHandle {
        self.body
    }

    /// The joint that pulls: its force is [`World::joint_force`].
    pub fn joint(&self) -> JointHandle {
        self.joint
    }

    /// Where the point is to be [m].
    ///
    /// # Errors
    /// If the grab was released.
    pub fn target(&self, world: &World) -> Result<DVec3, Error> {
        world.position(self.anchor)
    }

    /// Where the point of the body is now [m].
    ///
    /// # Errors
    /// If the grab was released or the body removed.
    pub fn point(&self, world: &World) -> Result<DVec3, Error> {
        Ok(world.joint_frames(self.joint)?[1].0)
    }
}

impl GrabSettings {
    /// Checks every range.
    ///
    /// # Errors
    /// Names the first that is out of range.
    pub fn validate(&self) -> Result<(), Error> {
        limits::load("grab force", self.max_force)?;
        self.check_ranges()
    }
}
