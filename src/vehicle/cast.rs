//! Wheels that are casts: a spring and a tyre where a ray or a ball meets the ground.
//!
//! Springs and tyres of a step are solved together, as the velocity that the chassis has after it: each in
//! turn, by projected Gauss-Seidel, from the forces of the step before.

use super::desc::{VehicleDesc, WheelDesc, WheelKind};
use super::drive::WheelTorque;
use super::tyre::Tyre;
use super::{WheelContact, WheelState, turn};
use crate::config::tuning::WHEEL_SWEEPS;
use crate::error::Error;
use crate::handle::BodyHandle;
use crate::math::Quat;
use crate::query::{QueryFilter, Ray, ShapeCast};
use crate::shape::Geometry;
use crate::world::World;
use glam::{DVec3, Mat3, Vec3};

/// Linear and angular acceleration of the chassis by neither gravity nor its wheels: of a load, a trailer, a
/// floor that it lies on.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub(super) struct Outside {
    /// Velocities after the last step without it.
    expected: Option<[Vec3; 2]>,
    last: [Vec3; 2],
}

impl Outside {
    /// What lasts: the smaller part of those of the last two steps, so that a blow is none.
    fn steady(&mut self, velocities: [Vec3; 2], dt: f32) -> [Vec3; 2] {
        let Some(expected) = self.expected else { return [Vec3::ZERO; 2] };
        let smaller = |a: f32, b: f32| {
            let size = a.abs().min(b.abs());
            if a * b > 0.0 { size.copysign(a) } else { 0.0 }
        };
        std::array::from_fn(|i| {
            let (now, last) = ((velocities[i] - expected[i]) / dt, self.last[i]);
            self.last[i] = now;
            Vec3::new(smaller(now.x, last.x), smaller(now.y, last.y), smaller(now.z, last.z))
        })
    }
}

/// The chassis as wheels see it.
struct Chassis {
    body: BodyHandle,
    position: DVec3,
    rotation: Quat,
    centre: DVec3,
    inverse_mass: f32,
    /// Inverse inertia, in the axes of the chassis.
    inverse_inertia: Mat3,
    /// Linear and angular, after the step, with the forces so far [m/s, rad/s].
    velocities: [Vec3; 2],
}

impl Chassis {
    fn new(world: &World, body: BodyHandle) -> Result<Chassis, Error> {
        let mass = world.mass_properties(body)?;
        Ok(Chassis {
            body,
            position: world.position(body)?,
            rotation: world.rotation(body)?.into(),
            centre: world.centre_of_mass(body)?,
            inverse_mass: 1.0 / mass.mass,
            inverse_inertia: mass.inertia.inverse(),
            velocities: [world.linear_velocity(body)?, world.angular_velocity(body)?],
        })
    }

    fn at(&self, local: Vec3) -> DVec3 {
        self.position + (self.rotation * local).as_dvec3()
    }

    fn turned_by(&self, angular_impulse: Vec3) -> Vec3 {
        self.rotation * (self.inverse_inertia * (self.rotation.conjugate() * angular_impulse))
    }

    /// Velocity at an arm from the centre of mass, along an axis [m/s].
    fn along(&self, arm: Vec3, axis: Vec3) -> f32 {
        (self.velocities[0] + self.velocities[1].cross(arm)).dot(axis)
    }

    /// What an impulse along an axis at an arm changes there [1/kg].
    fn inverse_mass_at(&self, arm: Vec3, axis: Vec3) -> f32 {
        let about = arm.cross(axis);
        self.inverse_mass + about.dot(self.turned_by(about))
    }

    fn push(&mut self, arm: Vec3, impulse: Vec3) {
        self.velocities[0] += impulse * self.inverse_mass;
        self.velocities[1] += self.turned_by(arm.cross(impulse));
    }
}

/// A wheel on the ground.
struct Touch {
    wheel: usize,
    contact: WheelContact,
    /// From the centre of mass of the chassis to the contact [m].
    arm: Vec3,
    /// Normal of the ground; along it forward and left.
    axes: [Vec3; 3],
    /// Inverse mass, and velocity of the ground, along each.
    inverse_mass: [f32; 3],
    ground: [f32; 3],
    /// Over the ground before the step [m/s]: forward and left.
    slip: [f32; 2],
    compression: f32,
    /// Along the axes [N].
    force: [f32; 3],
}

impl Touch {
    fn new(
        world: &World,
        chassis: &Chassis,
        (wheel, state): (usize, &WheelState),
        compression: f32,
        contact: WheelContact,
    ) -> Result<Option<Touch>, Error> {
        let ahead = chassis.rotation * turn(Vec3::Y, state.steer) * Vec3::Z;
        let Some(left) = contact.normal.cross(ahead).try_normalize() else { return Ok(None) };
        let axes = [contact.normal, left.cross(contact.normal), left];
        let arm = (contact.point - chassis.centre).as_vec3();
        let ground = world.velocity_at(contact.body, contact.point)?;
        let [_, ahead, left] = axes.map(|axis| chassis.along(arm, axis) - ground.dot(axis));
        let before = state.contact.map_or(0.0, |contact| contact.load);
        Ok(Some(Touch {
            wheel,
            contact,
            arm,
            axes,
            inverse_mass: axes.map(|axis| chassis.inverse_mass_at(arm, axis)),
            ground: axes.map(|axis| ground.dot(axis)),
            slip: [ahead, left],
            compression,
            force: [before, state.force[0], state.force[1]],
        }))
    }

    /// Velocity over the ground after the step along each axis, without its own force along it.
    fn velocity(&self, chassis: &Chassis, axis: usize, dt: f32) -> f32 {
        let own = self.force[axis] * dt * self.inverse_mass[axis];
        chassis.along(self.arm, self.axes[axis]) - self.ground[axis] - own
    }

    /// Puts another force in place of its own.
    fn set(&mut self, chassis: &mut Chassis, force: [f32; 3], dt: f32) {
        let change = (0..3).fold(Vec3::ZERO, |sum, i| sum + self.axes[i] * (force[i] - self.force[i]));
        self.force = force;
        chassis.push(self.arm, change * dt);
    }

    /// The force of the spring, its damper and its bars as they are after the step [N], at least zero.
    ///
    /// `others`: sum of the stiffness of bars, and of their force by the wheels at their other ends.
    fn load(&self, chassis: &Chassis, wheel: &WheelDesc, others: [f32; 2], dt: f32) -> f32 {
        let x = self.compression;
        let beyond = (x - wheel.travel).max(0.0);
        let bump = if beyond > 0.0 { 10.0 * wheel.stiffness } else { 0.0 };
        let stiffness = wheel.stiffness + bump + others[0];
        let still = (wheel.stiffness + others[0]) * x + bump * beyond - others[1];
        let by_speed = wheel.damping + stiffness * dt;
        let force = still - by_speed * self.velocity(chassis, 0, dt);
        (force / (1.0 + by_speed * dt * self.inverse_mass[0])).max(0.0)
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

/// Adds the forces of all wheels for the next step, and brings their states up to date.
pub(super) fn update(
    world: &mut World,
    body: BodyHandle,
    desc: &VehicleDesc,
    wheels: &mut [WheelState],
    torques: &[WheelTorque],
    outside: &mut Outside,
    dt: f32,
) -> Result<(), Error> {
    let mut chassis = Chassis::new(world, body)?;
    let mut touches = Vec::with_capacity(wheels.len());
    for (i, (wheel, state)) in desc.wheels.iter().zip(wheels.iter_mut()).enumerate() {
        let met = touch(world, &chassis, desc, wheel)?;
        let met = met.map(|(x, contact)| Touch::new(world, &chassis, (i, &*state), x, contact));
        let inertia = wheel.inertia();
        *state = WheelState { contact: None, compression: 0.0, slides: false, force: [0.0; 2], ..*state };
        match met.transpose()?.flatten() {
            Some(touch) => touches.push(touch),
            None => state.spin = torques[i].free(state.spin, inertia, dt),
        }
    }
    let steady = outside.steady(chassis.velocities, dt);
    let gravity = world.settings().gravity * world.gravity_scale(body)?;
    chassis.velocities[0] += (gravity + steady[0]) * dt;
    chassis.velocities[1] += steady[1] * dt;
    solve(&mut chassis, desc, wheels, torques, &mut touches, dt);
    outside.expected = Some(std::array::from_fn(|i| chassis.velocities[i] - steady[i] * dt));
    for touch in touches {
        let (at, ground) = (touch.contact.point, touch.contact.body);
        let force = (0..3).fold(Vec3::ZERO, |sum, i| sum + touch.axes[i] * touch.force[i]);
        world.add_force_at(body, force, at)?;
        world.add_force_at(ground, -force, at)?;
    }
    Ok(())
}

/// Forces of all springs and tyres, by each other.
fn solve(
    chassis: &mut Chassis,
    desc: &VehicleDesc,
    wheels: &mut [WheelState],
    torques: &[WheelTorque],
    touches: &mut [Touch],
    dt: f32,
) {
    for touch in touches.iter() {
        let force = (0..3).fold(Vec3::ZERO, |sum, i| sum + touch.axes[i] * touch.force[i]);
        chassis.push(touch.arm, force * dt);
    }
    let starts: Vec<f32> = wheels.iter().map(|wheel| wheel.spin).collect();
    for sweep in 0..WHEEL_SWEEPS {
        for i in 0..touches.len() {
            // To and fro: no wheel is always the last.
            let i = if sweep % 2 == 0 { i } else { touches.len() - 1 - i };
            let bars = bars(chassis, desc, touches, i, dt);
            let touch = &mut touches[i];
            let (wheel, state) = (&desc.wheels[touch.wheel], &mut wheels[touch.wheel]);
            let load = touch.load(chassis, wheel, bars, dt);
            touch.set(chassis, [load, touch.force[1], touch.force[2]], dt);
            let tyre = Tyre {
                load,
                inverse_mass: [touch.inverse_mass[1], touch.inverse_mass[2]],
                velocity: [1, 2].map(|axis| touch.velocity(chassis, axis, dt)),
                slip: touch.slip,
                spin: starts[touch.wheel],
                torque: torques[touch.wheel],
                anti_lock: desc.anti_lock,
            };
            let now = if load > 0.0 { tyre.force(wheel, dt) } else { tyre.lifted(wheel, dt) };
            touch.set(chassis, [load, now.force[0], now.force[1]], dt);
            (state.spin, state.slides, state.force) = (now.spin, now.slides, now.force);
            state.contact = Some(WheelContact { load, ..touch.contact });
            state.compression = touch.compression;
        }
    }
}

/// Stiffness of the bars of a wheel [N/m], and their force by the wheels at their other ends after the step
/// [N]: those in the air are extended.
fn bars(chassis: &Chassis, desc: &VehicleDesc, touches: &[Touch], i: usize, dt: f32) -> [f32; 2] {
    let wheel = touches[i].wheel;
    let mut sum = [0.0; 2];
    for bar in &desc.anti_roll {
        let [a, b] = bar.wheels;
        if a != b && (a == wheel || b == wheel) {
            let other = touches.iter().find(|touch| touch.wheel == a + b - wheel);
            let x = other.map_or(0.0, |other| {
                let velocity = chassis.along(other.arm, other.axes[0]) - other.ground[0];
                other.compression - velocity * dt
            });
            sum = [sum[0] + bar.stiffness, sum[1] + bar.stiffness * x];
        }
    }
    sum
}
