//! Wheels that are bodies: joints hold them, contacts bear them, and the engine turns them.

use super::desc::{VehicleDesc, WheelDesc};
use super::drive::WheelTorque;
use super::{WheelBody, WheelContact, WheelState, turn};
use crate::body::BodyDesc;
use crate::error::Error;
use crate::handle::BodyHandle;
use crate::joint::{Axes, Axis, JointDesc, Limit, Motion, Motor, Spring};
use crate::math::Quat;
use crate::shape::{Filter, Geometry, MassProperties, Material, ShapeDesc};
use crate::world::World;
use glam::Vec3;
use std::f32::consts::FRAC_PI_2;

/// Adds all wheels, or none.
pub(super) fn add(
    world: &mut World,
    chassis: BodyHandle,
    desc: &VehicleDesc,
) -> Result<Vec<WheelBody>, Error> {
    let mut added = Vec::new();
    let mut wheels = Vec::with_capacity(desc.wheels.len());
    for wheel in &desc.wheels {
        match add_one(world, chassis, desc.filter.unwrap_or_default(), wheel, &mut added) {
            Ok(wheel) => wheels.push(wheel),
            Err(error) => {
                world.remove_bodies(&added)?;
                return Err(error);
            }
        }
    }
    Ok(wheels)
}

fn add_one(
    world: &mut World,
    chassis: BodyHandle,
    filter: Filter,
    wheel: &WheelDesc,
    added: &mut Vec<BodyHandle>,
) -> Result<WheelBody, Error> {
    let rotation = Quat::from(world.rotation(chassis)?);
    let middle = wheel.position + Vec3::Y * (0.5 * wheel.travel);
    let hub = world.position(chassis)? + (rotation * middle).as_dvec3();
    let (linear, angular) = (world.velocity_at(chassis, hub)?, world.angular_velocity(chassis)?);
    // The axle is x; the axis of a cylinder is y.
    let aside = turn(Vec3::Z, FRAC_PI_2).into();
    let tyre = Geometry::cylinder(0.5 * wheel.width, wheel.radius);
    let mass = MassProperties::of(&tyre, 1.0).scaled_to(wheel.mass).transformed(Vec3::ZERO, aside);
    let material = Material::default().with_friction(wheel.friction);
    let tyre = ShapeDesc::new(tyre).with_rotation(aside).with_filter(filter).with_material(material);
    let part = BodyDesc::dynamic().with_position(hub).with_rotation(rotation).with_velocity(linear, angular);
    let body = world.add_body(&part.with_shape(tyre).with_mass(Some(mass)))?;
    added.push(body);

    let half = 0.5 * wheel.travel;
    let spring = Spring::Coefficients { stiffness: wheel.stiffness, damping: wheel.damping };
    let pair = [chassis, body];
    let joint = JointDesc::new(pair, world.frames_at(pair, hub, rotation.into())?)
        .with_limit(Limit::lock(Motion::Linear, Axes::Perpendicular(Axis::Y)))
        .with_limit(Limit::lock(Motion::Angular, Axes::Perpendicular(Axis::X)))
        .with_limit(Limit::new(Motion::Linear, Axes::One(Axis::Y), -half, half))
        .with_motor(Motor::position(Motion::Linear, Axis::Y, -half, spring))
        .with_motor(Motor::friction(Motion::Angular, Axis::X, 0.0));
    Ok(WheelBody { body, joint: world.add_joint(&joint)? })
}

/// What the last step made of the wheels.
pub(super) fn read(
    world: &World,
    chassis: BodyHandle,
    bodies: &[WheelBody],
    desc: &VehicleDesc,
    wheels: &mut [WheelState],
    dt: f32,
) -> Result<(), Error> {
    let substep = dt / world.settings().substeps as f32;
    let turning = world.angular_velocity(chassis)?;
    for ((wheel, state), desc) in bodies.iter().zip(wheels).zip(&desc.wheels) {
        let axle = Quat::from(world.rotation(wheel.body)?) * Vec3::X;
        state.spin = (world.angular_velocity(wheel.body)? - turning).dot(axle);
        let travel = world.joint_position(wheel.joint, Motion::Linear, Axes::One(Axis::Y))?;
        state.compression = travel + 0.5 * desc.travel;
        state.contact = None;
        for contact in world.contacts_of(wheel.body)? {
            let load = contact.impulse() / substep;
            if load > state.contact.map_or(0.0, |contact| contact.load) {
                let point = contact.points()[0].position;
                let (body, shape, normal) = (contact.bodies[1], contact.shapes[1], -contact.normal);
                state.contact = Some(WheelContact { body, shape, point, normal, load });
            }
        }
        let hub = world.position(wheel.body)?;
        state.slides = match state.contact {
            Some(at) => {
                let slip = world.velocity_at(wheel.body, at.point)? - world.velocity_at(at.body, at.point)?;
                // The contact is a step old, and the wheel has moved on since.
                let arm = (at.point - hub).as_vec3();
                slip.reject_from_normalized(at.normal).length() > 0.5 + turning.length() * arm.length()
            }
            None => false,
        };
    }
    Ok(())
}

/// Torques, brakes, steering and bars for the next step.
pub(super) fn update(
    world: &mut World,
    chassis: BodyHandle,
    bodies: &[WheelBody],
    desc: &VehicleDesc,
    wheels: &[WheelState],
    torques: &[WheelTorque],
) -> Result<(), Error> {
    for ((wheel, state), (torque, desc)) in bodies.iter().zip(wheels).zip(torques.iter().zip(&desc.wheels)) {
        let axle = Quat::from(world.rotation(wheel.body)?) * Vec3::X;
        world.add_torque(wheel.body, axle * torque.drive)?;
        world.add_torque(chassis, axle * -torque.drive)?;
        let load = state.contact.map_or(0.0, |contact| contact.load);
        let brake = torque.foot + torque.other + desc.rolling_resistance * load * desc.radius;
        world.set_joint_motor(wheel.joint, Motor::friction(Motion::Angular, Axis::X, brake))?;
        if desc.steered {
            // The axle turns on the chassis: a body between the two, on a spring, would let the wheel creep.
            let mut frames = world.joint_local_frames(wheel.joint)?;
            let steered = turn(Vec3::Y, state.steer).into();
            if frames[0].rotation != steered {
                frames[0].rotation = steered;
                world.set_joint_frames(wheel.joint, frames)?;
            }
        }
    }
    let up = Quat::from(world.rotation(chassis)?) * Vec3::Y;
    for bar in &desc.anti_roll {
        let [a, b] = bar.wheels;
        let force = up * (bar.stiffness * (wheels[a].compression - wheels[b].compression));
        for (wheel, force) in [(a, force), (b, -force)] {
            let body = bodies[wheel].body;
            let hub = world.position(body)?;
            world.add_force_at(chassis, force, hub)?;
            world.add_force_at(body, -force, hub)?;
        }
    }
    Ok(())
}
