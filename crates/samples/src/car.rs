//! A car of bodies and joints, which several samples drive.

use crate::Controls;
use backstop::glam::{DVec3, Quat, Vec3};
use backstop::vehicle::{Vehicle, WheelDesc};
use backstop::{
    Axis, BodyDesc, BodyHandle, Error, Filter, Geometry, JointDesc, JointHandle, Material, Motion, Motor,
    ShapeDesc, ShapeHandle, Spring, World,
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
    /// With its wheels on the ground at a point [m], turned from where it looks along -z and stands upright.
    ///
    /// # Errors
    ///
    /// Those of [`World::add_body`] and [`World::add_joint`].
    pub fn add_to(world: &mut World, ground: DVec3, turned: Quat) -> Result<Car, Error> {
        let at = ground + (turned * Vec3::Y).as_dvec3() * f64::from(RADIUS - HUB.y);
        let hull = part(Geometry::cuboid(0.7, 0.3, 1.9), 350.0);
        let chassis = BodyDesc::dynamic().with_position(at).with_rotation(turned).with_shape(hull);
        let chassis = world.add_body(&chassis)?;
        let mut wheel = |x: f32, z: f32| add_wheel(world, chassis, HUB * Vec3::new(x, 1.0, z));
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

/// A part of a car, of a density [kg/m³], which does not collide with other parts.
pub fn part(geometry: Geometry, density: f32) -> ShapeDesc {
    ShapeDesc::new(geometry).with_filter(Filter::default().with_group(-1)).with_density(density)
}

/// A wheel on a spring, at a place of a chassis [m].
///
/// # Errors
///
/// Those of [`World::add_body`] and [`World::add_joint`].
pub fn add_wheel(
    world: &mut World,
    chassis: BodyHandle,
    place: Vec3,
) -> Result<(BodyHandle, JointHandle), Error> {
    let turned = world.rotation(chassis)?;
    let hub = world.position(chassis)? + (turned * place).as_dvec3();
    // A cylinder has its axis along y, a wheel along x.
    let tyre = part(Geometry::cylinder(0.12, RADIUS), 250.0)
        .with_rotation(Quat::from_rotation_z(FRAC_PI_2))
        .with_material(Material::default().with_friction(1.2));
    let wheel = BodyDesc::dynamic().with_position(hub).with_rotation(turned).with_shape(tyre);
    let wheel = world.add_body(&wheel)?;
    let frames = world.frames_at([chassis, wheel], hub, turned)?;
    let joint = JointDesc::wheel([chassis, wheel], frames, TRAVEL, SPRING);
    Ok((wheel, world.add_joint(&joint)?))
}

/// Shapes that show where the wheels of a vehicle without bodies for them are: sensors, which push nothing.
///
/// # Errors
///
/// Those of [`World::add_shape`].
pub fn add_tyres(world: &mut World, car: &Vehicle) -> Result<Vec<ShapeHandle>, Error> {
    let tyre = |wheel: &WheelDesc| {
        let tyre = ShapeDesc::new(Geometry::cylinder(0.5 * wheel.width, wheel.radius));
        world.add_shape(car.chassis(), &tyre.with_density(0.0).as_sensor())
    };
    car.desc().wheels.iter().map(tyre).collect()
}

/// Puts them where the wheels are.
///
/// # Errors
///
/// Those of [`Vehicle::wheel_pose`].
pub fn move_tyres(world: &mut World, car: &Vehicle, tyres: &[ShapeHandle]) -> Result<(), Error> {
    let (at, turned) = (world.position(car.chassis())?, world.rotation(car.chassis())?);
    for (i, &tyre) in tyres.iter().enumerate() {
        let (hub, wheel) = car.wheel_pose(world, i)?;
        let place = turned.inverse() * (hub - at).as_vec3();
        let wheel = turned.inverse() * wheel * Quat::from_rotation_z(FRAC_PI_2);
        world.set_shape_pose(tyre, place, wheel.normalize())?;
    }
    Ok(())
}
