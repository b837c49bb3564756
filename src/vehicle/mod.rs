//! Vehicles on wheels: springs, tyres, an engine with gears, brakes and steering, under [`Controls`].
//!
//! A [`Vehicle`] is a dynamic body, the chassis, with wheels that are casts (`cast.rs`) or bodies on joints
//! (`bodies.rs`). It is plain data beside the world: [`Vehicle::update`] before each step reads where the
//! chassis is and adds forces. For rollback keep a copy of it with each snapshot of the world.

mod bodies;
mod cast;
mod desc;
mod drive;
mod tyre;

pub use desc::{AntiRollBar, Controls, EngineDesc, GearboxDesc, VehicleDesc, WheelDesc, WheelKind};

use crate::body::BodyKind;
use crate::error::Error;
use crate::handle::{BodyHandle, JointHandle, ShapeHandle};
use crate::limits;
use crate::math::Quat;
use crate::world::World;
use drive::Drive;
use glam::{DVec3, Vec3};
use std::f32::consts::TAU;

/// What a wheel stands on.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct WheelContact {
    /// Whose shape it is.
    pub body: BodyHandle,
    /// Which shape.
    pub shape: ShapeHandle,
    /// Where, in the world [m].
    pub point: DVec3,
    /// Unit, out of the ground.
    pub normal: Vec3,
    /// How hard the wheel presses on it [N].
    pub load: f32,
}

/// A wheel as it was at the last [`Vehicle::update`].
#[derive(Clone, Copy, Debug, Default, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[non_exhaustive]
pub struct WheelState {
    /// How fast it turns about its axle; above zero rolls forward [rad/s].
    pub spin: f32,
    /// By how much it has turned [rad], in 0..2π.
    pub angle: f32,
    /// Where it is steered to, to the left [rad].
    pub steer: f32,
    /// How far its hub is above where it is while the spring is extended [m].
    pub compression: f32,
    /// The ground; none in the air.
    pub contact: Option<WheelContact>,
    /// Whether it slides on the ground instead of rolling.
    pub slides: bool,
    /// Force of the tyre on the vehicle, along the ground [N]: forward, left. Zero of wheels that are bodies.
    pub force: [f32; 2],
}

/// A wheel that is a body.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
struct WheelBody {
    body: BodyHandle,
    /// Spring, axle and brake.
    joint: JointHandle,
}

/// A vehicle: a chassis of the caller's with wheels.
///
/// ```
/// use backstop::glam::{DVec3, Vec3};
/// use backstop::vehicle::{Controls, Vehicle, VehicleDesc};
/// use backstop::{BodyDesc, Geometry, MassProperties, Settings, ShapeDesc, World};
///
/// # fn main() -> Result<(), backstop::Error> {
/// let mut world = World::new(Settings::default())?;
/// world.add_body(&BodyDesc::fixed().with_shape(ShapeDesc::new(Geometry::Plane)))?;
/// let hull = Geometry::cuboid(0.9, 0.4, 2.1);
/// let mass = MassProperties::of(&hull, 1.0).scaled_to(1200.0);
/// // The box is above the centre of mass, which is the origin.
/// let chassis = BodyDesc::dynamic()
///     .with_position(DVec3::Y * 0.7)
///     .with_shape(ShapeDesc::new(hull).with_position(Vec3::Y * 0.3))
///     .with_mass(mass);
/// let chassis = world.add_body(&chassis)?;
/// let desc = VehicleDesc::car(Vec3::Y * -0.3, [0.8, 1.3], 1200.0);
/// let mut car = Vehicle::new(&mut world, chassis, &desc)?;
/// let (dt, controls) = (1.0 / 60.0, Controls { throttle: 1.0, ..Controls::default() });
/// for _ in 0..300 {
///     car.update(&mut world, dt, &controls)?;
///     world.step(dt)?;
/// }
/// assert!(car.speed(&world)? > 10.0 && car.gear() > 1);
/// # Ok(())
/// # }
/// ```
#[derive(Clone, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct Vehicle {
    chassis: BodyHandle,
    desc: VehicleDesc,
    drive: Drive,
    wheels: Vec<WheelState>,
    /// Empty, unless wheels are bodies.
    bodies: Vec<WheelBody>,
    outside: cast::Outside,
}

/// A rotation about a unit axis.
fn turn(axis: Vec3, angle: f32) -> Quat {
    let (sine, cosine) = libm::sincosf(0.5 * angle);
    Quat::from_xyzw(axis.x * sine, axis.y * sine, axis.z * sine, cosine)
}

impl Vehicle {
    /// Puts wheels on a dynamic body. Those that are casts add nothing to the world; those that are bodies
    /// are added with their joints.
    ///
    /// # Errors
    /// If the handle is stale, the body is not dynamic, a number is out of range, or the budget does not
    /// allow the bodies of wheels.
    pub fn new(world: &mut World, chassis: BodyHandle, desc: &VehicleDesc) -> Result<Vehicle, Error> {
        desc.validate()?;
        if world.kind(chassis)? != BodyKind::Dynamic {
            return Err(Error::JointOfStill);
        }
        let bodies = match desc.wheel_kind {
            WheelKind::Body => bodies::add(world, chassis, desc)?,
            _ => Vec::new(),
        };
        let wheels = vec![WheelState::default(); desc.wheels.len()];
        Ok(Vehicle {
            chassis,
            desc: desc.clone(),
            drive: Drive::new(desc),
            wheels,
            bodies,
            outside: cast::Outside::default(),
        })
    }

    /// Adds the forces of wheels and air for the next step, of `dt` [s]: call it before each step.
    ///
    /// A vehicle whose chassis sleeps is left alone, unless the throttle is used or the steering moved.
    ///
    /// # Errors
    /// If the chassis, a wheel or a joint of a wheel was removed, a control is out of range, or `dt` is not
    /// the length of a step.
    pub fn update(&mut self, world: &mut World, dt: f32, controls: &Controls) -> Result<(), Error> {
        controls.validate()?;
        limits::step(dt)?;
        let steer = drive::steering(&self.desc, controls.steer);
        let steady = controls.throttle == 0.0 && self.wheels.iter().zip(&steer).all(|(w, &to)| w.steer == to);
        if steady && world.is_sleeping(self.chassis)? {
            return Ok(());
        }
        if !self.bodies.is_empty() {
            bodies::read(world, self.chassis, &self.bodies, &self.desc, &mut self.wheels, dt)?;
        }
        let spins: Vec<f32> = self.wheels.iter().map(|wheel| wheel.spin).collect();
        let speed = self.speed(world)?;
        let torques = self.drive.update(&self.desc, controls, speed, &spins, dt);
        for (wheel, steer) in self.wheels.iter_mut().zip(steer) {
            wheel.steer = steer;
        }
        let (body, desc) = (self.chassis, &self.desc);
        match self.bodies.is_empty() {
            true => cast::update(world, body, desc, &mut self.wheels, &torques, &mut self.outside, dt)?,
            false => bodies::update(world, body, &self.bodies, desc, &self.wheels, &torques)?,
        }
        for wheel in &mut self.wheels {
            let angle = wheel.angle + wheel.spin * dt;
            wheel.angle = angle - TAU * (angle / TAU).floor();
        }
        let velocity = world.linear_velocity(self.chassis)?;
        world.add_force(self.chassis, -velocity * (velocity.length() * self.desc.drag))
    }

    /// Removes wheels that are bodies; the chassis stays.
    ///
    /// # Errors
    /// If one of them was removed already.
    pub fn remove(self, world: &mut World) -> Result<(), Error> {
        for wheel in &self.bodies {
            world.remove_body(wheel.body)?;
        }
        Ok(())
    }

    /// The body that the wheels are on.
    pub fn chassis(&self) -> BodyHandle {
        self.chassis
    }

    /// Its description.
    pub fn desc(&self) -> &VehicleDesc {
        &self.desc
    }

    /// Speed along its front [m/s], below zero backward.
    ///
    /// # Errors
    /// If the chassis was removed.
    pub fn speed(&self, world: &World) -> Result<f32, Error> {
        let ahead = Quat::from(world.rotation(self.chassis)?) * Vec3::Z;
        Ok(world.linear_velocity(self.chassis)?.dot(ahead))
    }

    /// Speed of the engine [rpm].
    pub fn rpm(&self) -> f32 {
        self.drive.rpm
    }

    /// The gear: 1 and above forward, -1 reverse.
    pub fn gear(&self) -> i32 {
        self.drive.gear
    }

    /// Its wheels, in the order of [`VehicleDesc::wheels`].
    pub fn wheels(&self) -> &[WheelState] {
        &self.wheels
    }

    /// The bodies of its wheels, if [`WheelKind::Body`] made them.
    pub fn wheel_bodies(&self) -> impl Iterator<Item = BodyHandle> + '_ {
        self.bodies.iter().map(|wheel| wheel.body)
    }

    /// Where a wheel is, to draw it: its hub [m] and its rotation, with the axle along x.
    ///
    /// # Errors
    /// If there is no such wheel, or the chassis or the wheel was removed.
    pub fn wheel_pose(&self, world: &World, wheel: usize) -> Result<(DVec3, glam::Quat), Error> {
        crate::error::index("index of a wheel", wheel, self.wheels.len())?;
        if let Some(body) = self.bodies.get(wheel) {
            return Ok((world.position(body.body)?, world.rotation(body.body)?));
        }
        let (state, desc) = (&self.wheels[wheel], &self.desc.wheels[wheel]);
        let rotation = Quat::from(world.rotation(self.chassis)?);
        let hub = rotation * (desc.position + Vec3::Y * state.compression.min(desc.travel));
        let turned = rotation * turn(Vec3::Y, state.steer) * turn(Vec3::X, state.angle);
        Ok((world.position(self.chassis)? + hub.as_dvec3(), turned.normalize().into()))
    }
}
