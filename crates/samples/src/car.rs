//! A car of bodies and joints, which several samples drive.

use crate::Controls;
use backstop::glam::{DVec3, Quat, Vec3};
use backstop::{
    Axis, BodyDesc, BodyHandle, Error, Filter, Geometry, JointDesc, JointHandle, Material, Motion, Motor,
    ShapeDesc, Spring, World,
};
use std::f32::consts::FRAC_PI_2;

/// Radius of a wheel, and where the hubs are on the chassis [m]: aside, up and along.
pub const RADIUS: f32 = 0.4;
/// See [`RADIUS`].
pub const HUB: Vec3 = Vec3::new(0.9, -0.3, 1.3);
/// The spring of a wheel, and how far the wheel moves to either side on it [m].
const SPRING: Spring = Spring::Coefficients { stiffness: 20_000.0, damping: 2_500.0 };
const TRAVEL: f32 = 0.25;
/// The engine's torque at each wheel [N m].
const TORQUE: f32 = 500.0;
/// What the keys ask for: speed [m/s] and steering angle [rad].
const KEYS: (f32, f32) = (12.0, 0.35);

/// A car which looks along -z. Its parts, and parts of other cars, do not collide with each other.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Car {
    /// With its origin at the middle of the car.
    pub chassis: BodyHandle,
    /// In front left and right, then at the back.
    pub wheels: [BodyHandle; 4],
    joints: [JointHandle; 4],
}

impl Car {
    /// With its wheels on level ground at a point [m], turned to the left by an angle [rad].
    ///
    /// # Errors
    ///
    /// Those of [`World::add_body`] and [`World::add_joint`].
    pub fn add_to(world: &mut World, ground: DVec3, turned: Quat) -> Result<Car, Error> {
        let part = |geometry| ShapeDesc::new(geometry).with_filter(Filter::default().with_group(-1));
        let at = ground + (turned * Vec3::Y).as_dvec3() * f64::from(RADIUS - HUB.y);
        let body = BodyDesc::dynamic().with_position(at).with_rotation(turned);
        let hull = part(Geometry::cuboid(0.7, 0.3, 1.9)).with_density(350.0);
        let chassis = world.add_body(&body.clone().with_shape(hull))?;
        // A cylinder has its axis along y, a wheel along x.
        let tyre = part(Geometry::cylinder(0.12, RADIUS))
            .with_rotation(Quat::from_rotation_z(FRAC_PI_2))
            .with_material(Material::default().with_friction(1.2))
            .with_density(250.0);
        let mut wheel = |side: f32, end: f32| {
            let hub = at + (turned * (HUB * Vec3::new(side, 1.0, end))).as_dvec3();
            let wheel = world.add_body(&body.clone().with_position(hub).with_shape(tyre.clone()))?;
            let frames = world.frames_at([chassis, wheel], hub, turned)?;
            let joint = JointDesc::wheel([chassis, wheel], frames, TRAVEL, SPRING);
            Ok((wheel, world.add_joint(&joint)?))
        };
        let all = [wheel(-1.0, -1.0)?, wheel(1.0, -1.0)?, wheel(-1.0, 1.0)?, wheel(1.0, 1.0)?];
        Ok(Car { chassis, wheels: all.map(|(wheel, _)| wheel), joints: all.map(|(_, joint)| joint) })
    }

    /// Sets the speed that the engine drives at, or brakes to [m/s], and steers by an angle to the right
    /// [rad]: the axes of the front joints are turned on the chassis.
    ///
    /// # Errors
    ///
    /// If a part of it was removed.
    pub fn drive(&self, world: &mut World, speed: f32, angle: f32) -> Result<(), Error> {
        for (i, joint) in self.joints.into_iter().enumerate() {
            let motor = Motor::velocity(Motion::Angular, Axis::X, -speed / RADIUS, TORQUE);
            world.set_joint_motor(joint, motor)?;
            let mut frames = world.joint_local_frames(joint)?;
            frames[0].rotation = Quat::from_rotation_y(if i < 2 { -angle } else { 0.0 });
            world.set_joint_frames(joint, frames)?;
        }
        Ok(())
    }

    /// Drives as the keys ask: forwards and to the right, and a jump brakes. Without keys with a speed and an
    /// angle `alone`.
    ///
    /// # Errors
    ///
    /// As there.
    pub fn follow(&self, world: &mut World, keys: &Controls, alone: (f32, f32)) -> Result<(), Error> {
        let (speed, angle) = match *keys == Controls::default() {
            true => alone,
            false => (KEYS.0 * keys.forward, KEYS.1 * keys.right),
        };
        self.drive(world, if keys.jump { 0.0 } else { speed }, angle)
    }
}
