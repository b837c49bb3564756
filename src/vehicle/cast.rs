//! Wheels that are casts: a spring and a tyre where a ray or a ball meets the ground.

use super::desc::{VehicleDesc, WheelDesc, WheelKind};
use super::drive::WheelTorque;
use super::tyre::{Tyre, brake_of};
use super::{WheelContact, WheelState, turn};
use crate::error::Error;
use crate::handle::BodyHandle;
use crate::math::Quat;
use crate::query::{QueryFilter, Ray, ShapeCast};
use crate::shape::Geometry;
use crate::world::World;
use glam::{DVec3, Vec3};

/// The chassis as wheels see it.
struct Chassis {
    body: BodyHandle,
    position: DVec3,
    rotation: Quat,
    centre: DVec3,
    mass: f32,
    /// Inverse inertia, in the axes of the chassis.
    inverse: glam::Mat3,
    gravity: Vec3,
}

/// A force at a point of a body.
struct Push(BodyHandle, Vec3, DVec3);

impl Chassis {
    fn new(world: &World, body: BodyHandle) -> Result<Chassis, Error> {
        let mass = world.mass_properties(body)?;
        Ok(Chassis {
            body,
            position: world.position(body)?,
            rotation: world.rotation(body)?.into(),
            centre: world.centre_of_mass(body)?,
            mass: mass.mass,
            inverse: mass.inertia.inverse(),
            gravity: world.settings().gravity * world.gravity_scale(body)?,
        })
    }

    fn at(&self, local: Vec3) -> DVec3 {
        self.position + (self.rotation * local).as_dvec3()
    }

    /// Mass that a push along a unit direction at a point moves there [kg].
    fn mass_at(&self, point: DVec3, along: Vec3) -> f32 {
        let arm = (point - self.centre).as_vec3().cross(along);
        let arm = self.rotation.conjugate() * arm;
        1.0 / (1.0 / self.mass + arm.dot(self.inverse * arm))
    }
}

/// Looks for the ground under a wheel: compression of the spring [m] and the contact.
fn touch(
    world: &World,
    chassis: &Chassis,
    desc: &VehicleDesc,
    wheel: &WheelDesc,
) -> Result<Option<(f32, WheelContact)>, Error> {
    let filter = QueryFilter { filter: desc.filter, ..QueryFilter::new().excluding(chassis.body) };
    let up = chassis.rotation * Vec3::Y;
    let reach = match desc.wheel_kind {
        WheelKind::Sphere => wheel.travel,
        _ => wheel.travel + 2.0 * wheel.radius,
    };
    let top =
        Vec3::Y * if desc.wheel_kind == WheelKind::Sphere { wheel.travel } else { reach - wheel.radius };
    let (from, path) = (chassis.at(wheel.position + top), up * -reach);
    let met = if desc.wheel_kind == WheelKind::Sphere {
        let ball = Geometry::sphere(wheel.radius);
        let hit = world.cast_shape(&ShapeCast::new(&ball, from, path), &filter)?;
        hit.map(|hit| (hit.fraction, hit.body, hit.shape, hit.point, hit.normal))
    } else {
        let hit = world.cast_ray(&Ray::new(from, path), &filter)?;
        hit.map(|hit| (hit.fraction, hit.body, hit.shape, hit.point, hit.normal))
    };
    // A wall beside the wheel is no ground.
    let ground = met.filter(|(.., normal)| normal.dot(up) > 0.2);
    Ok(ground.map(|(fraction, body, shape, point, normal)| {
        let contact = WheelContact { body, shape, point, normal, load: 0.0 };
        (reach * (1.0 - fraction), contact)
    }))
}

/// The force of the spring and its damper [N], at least zero.
fn spring(
    world: &World,
    chassis: &Chassis,
    wheel: &WheelDesc,
    x: f32,
    at: &WheelContact,
    dt: f32,
) -> Result<f32, Error> {
    let speed = world.velocity_at(chassis.body, at.point)? - world.velocity_at(at.body, at.point)?;
    let mass = chassis.mass_at(at.point, at.normal);
    // Forces are constant during a step: what would overshoot within it is taken back.
    let stiffness = |k: f32| k.min(0.5 * mass / (dt * dt));
    let damping = wheel.damping.min(0.5 * mass / dt);
    let beyond = (x - wheel.travel).max(0.0);
    let force = stiffness(wheel.stiffness) * x + stiffness(10.0 * wheel.stiffness) * beyond;
    Ok((force - damping * speed.dot(at.normal)).max(0.0))
}

/// Adds the forces of all wheels for the next step, and brings their states up to date.
pub(super) fn update(
    world: &mut World,
    body: BodyHandle,
    desc: &VehicleDesc,
    wheels: &mut [WheelState],
    torques: &[WheelTorque],
    dt: f32,
) -> Result<(), Error> {
    let chassis = Chassis::new(world, body)?;
    for (wheel, state) in desc.wheels.iter().zip(wheels.iter_mut()) {
        let met = touch(world, &chassis, desc, wheel)?;
        state.contact = met.map(|(_, contact)| contact);
        state.compression = met.map_or(0.0, |(x, _)| x);
        if let Some(contact) = &mut state.contact {
            contact.load = spring(world, &chassis, wheel, state.compression, contact, dt)?;
        }
    }
    for bar in &desc.anti_roll {
        let [a, b] = bar.wheels;
        let force = bar.stiffness * (wheels[a].compression - wheels[b].compression);
        for (wheel, force) in [(a, force), (b, -force)] {
            if let Some(contact) = &mut wheels[wheel].contact {
                contact.load = (contact.load + force).max(0.0);
            }
        }
    }
    let load: f32 = wheels.iter().filter_map(|wheel| wheel.contact).map(|contact| contact.load).sum();
    // What stops the vehicle is shared out by how much each wheel can hold.
    let holds = |wheel: &WheelDesc, state: &WheelState, torque: &WheelTorque| {
        let load = state.contact.map_or(0.0, |contact| contact.load);
        let brake = brake_of(wheel, load, *torque, desc.anti_lock);
        brake.min(wheel.friction * load * wheel.radius)
    };
    let each = desc.wheels.iter().zip(wheels.iter()).zip(torques);
    let holds: Vec<f32> = each.map(|((wheel, state), torque)| holds(wheel, state, torque)).collect();
    let hold: f32 = holds.iter().sum();
    let mut pushes = Vec::with_capacity(2 * wheels.len());
    for (i, (wheel, state)) in desc.wheels.iter().zip(wheels).enumerate() {
        let of = |part: f32, all: f32| if all > 0.0 { chassis.mass * part / all } else { 0.0 };
        let masses = [of(state.contact.map_or(0.0, |at| at.load), load), of(holds[i], hold)];
        let force = roll(world, &chassis, desc, wheel, state, torques[i], masses, dt)?;
        if let Some(contact) = &state.contact {
            let force = force + contact.normal * contact.load;
            pushes.push(Push(body, force, contact.point));
            pushes.push(Push(contact.body, -force, contact.point));
        }
    }
    for Push(body, force, point) in pushes {
        world.add_force_at(body, force, point)?;
    }
    Ok(())
}

/// The force of a tyre along the ground; spins the wheel.
#[allow(clippy::too_many_arguments, reason = "one wheel in its vehicle")]
fn roll(
    world: &World,
    chassis: &Chassis,
    desc: &VehicleDesc,
    wheel: &WheelDesc,
    state: &mut WheelState,
    torque: WheelTorque,
    [mass, stopped]: [f32; 2],
    dt: f32,
) -> Result<Vec3, Error> {
    state.slides = false;
    let ahead = chassis.rotation * turn(Vec3::Y, state.steer) * Vec3::Z;
    let axes = state.contact.filter(|contact| contact.load > 0.0).and_then(|contact| {
        let left = contact.normal.cross(ahead).try_normalize()?;
        Some((contact, left.cross(contact.normal), left))
    });
    let Some((contact, ahead, left)) = axes else {
        // In the air.
        let inertia = 0.5 * wheel.mass * wheel.radius * wheel.radius;
        let free = state.spin + dt * torque.drive / inertia;
        let brake = dt * (torque.foot + torque.other) / inertia;
        state.spin = if free.abs() <= brake { 0.0 } else { free - brake.copysign(free) };
        return Ok(Vec3::ZERO);
    };
    let velocity =
        world.velocity_at(chassis.body, contact.point)? - world.velocity_at(contact.body, contact.point)?;
    let tyre = Tyre {
        load: contact.load,
        mass,
        stopped,
        velocity: [velocity.dot(ahead), velocity.dot(left)],
        gravity: [chassis.gravity.dot(ahead), chassis.gravity.dot(left)],
        spin: state.spin,
        torque,
        anti_lock: desc.anti_lock,
    };
    let now = tyre.force(wheel, dt);
    (state.spin, state.slides) = (now.spin, now.slides);
    Ok(ahead * now.force[0] + left * now.force[1])
}
