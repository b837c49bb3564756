//! From the throttle to torque at the wheels: engine, gears, automatic shift.

use super::desc::{Controls, VehicleDesc};
use std::f32::consts::TAU;

/// The state of engine and gears.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub(super) struct Drive {
    /// 1 and above: forward; -1: reverse.
    pub(super) gear: i32,
    pub(super) rpm: f32,
    /// Time until the clutch is closed again [s].
    shifting: f32,
}

/// Torques at one wheel.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct WheelTorque {
    /// About the axle [N m].
    pub(super) drive: f32,
    /// The most that resists turning [N m]: of the foot brake, and of all else.
    pub(super) foot: f32,
    pub(super) other: f32,
}

impl WheelTorque {
    /// Spin of a wheel with no other torque after `dt` [s].
    pub(super) fn free(self, spin: f32, inertia: f32, dt: f32) -> f32 {
        let (free, brake) = (spin + dt * self.drive / inertia, dt * (self.foot + self.other) / inertia);
        if free.abs() <= brake { 0.0 } else { free - brake.copysign(free) }
    }
}

impl Drive {
    pub(super) fn new(desc: &VehicleDesc) -> Drive {
        Drive { gear: 1, rpm: desc.engine.idle, shifting: 0.0 }
    }

    /// Turns of the engine per turn of a wheel, below zero in reverse.
    fn ratio(&self, desc: &VehicleDesc) -> f32 {
        let gears = &desc.gearbox;
        let gear = match self.gear {
            -1 => -gears.reverse,
            gear => gears.ratios.get(gear as usize - 1).copied().unwrap_or(0.0),
        };
        gear * gears.final_drive
    }

    /// Goes on by a step: `speed` along the front [m/s], spins of the wheels [rad/s]. Returns the torques of
    /// each wheel.
    pub(super) fn update(
        &mut self,
        desc: &VehicleDesc,
        controls: &Controls,
        speed: f32,
        spins: &[f32],
        dt: f32,
    ) -> Vec<WheelTorque> {
        let sum: f32 = desc.wheels.iter().map(|wheel| wheel.drive).sum();
        let share = |drive: f32| if sum > 0.0 { drive / sum } else { 0.0 };
        let spin: f32 = desc.wheels.iter().zip(spins).map(|(wheel, spin)| share(wheel.drive) * spin).sum();
        let per_spin = 60.0 / TAU;
        // Slower than this a vehicle may change between forward and reverse.
        let turns_back = 0.5;
        match controls.throttle {
            t if t < 0.0 && self.gear > 0 && speed < turns_back => self.gear = -1,
            t if t > 0.0 && self.gear < 0 && speed > -turns_back => self.gear = 1,
            _ => {}
        }
        let against = controls.throttle != 0.0 && (controls.throttle < 0.0) != (self.gear < 0);
        let throttle = if against { 0.0 } else { controls.throttle.abs() };
        let brake = if against { controls.brake.max(controls.throttle.abs()) } else { controls.brake };

        self.shifting = (self.shifting - dt).max(0.0);
        let mut rpm = (spin * self.ratio(desc) * per_spin).max(0.0);
        if self.shifting == 0.0 && self.gear > 0 {
            let (gear, most) = (self.gear, desc.gearbox.ratios.len() as i32);
            if rpm > desc.gearbox.shift_up && gear < most {
                self.gear += 1;
            } else if rpm < desc.gearbox.shift_down && gear > 1 {
                self.gear -= 1;
            }
            if self.gear != gear {
                self.shifting = desc.gearbox.shift_time;
                rpm = (spin * self.ratio(desc) * per_spin).max(0.0);
            }
        }
        self.rpm = rpm.max(desc.engine.idle);
        let ratio = if self.shifting > 0.0 { 0.0 } else { self.ratio(desc) };
        let engine = throttle * desc.engine.torque_at(self.rpm) * ratio;
        // At its idle speed an engine runs by itself.
        let above_idle = ((self.rpm - desc.engine.idle) / desc.engine.idle.max(1.0)).min(1.0);
        let drag = (1.0 - throttle) * desc.engine.braking * above_idle * ratio.abs();
        let torque = |wheel: &super::WheelDesc| WheelTorque {
            drive: engine * share(wheel.drive),
            foot: brake * wheel.brake,
            other: controls.hand_brake * wheel.hand_brake + drag * share(wheel.drive),
        };
        desc.wheels.iter().map(torque).collect()
    }
}

/// Angles of the wheels about y [rad], so that all go around one centre.
pub(super) fn steering(desc: &VehicleDesc, steer: f32) -> Vec<f32> {
    let angle = steer * desc.max_steer;
    let fixed = desc.wheels.iter().filter(|wheel| !wheel.steered);
    let (count, sum) = fixed.fold((0.0, 0.0), |(n, sum), wheel| (n + 1.0, sum + wheel.position.z));
    // Without a fixed axle the centre is beside the origin.
    let axle = if count > 0.0 { sum / count } else { 0.0 };
    let steered = desc.wheels.iter().filter(|wheel| wheel.steered);
    let base = steered
        .map(|wheel| wheel.position.z - axle)
        .fold(0.0, |a: f32, b| if b.abs() > a.abs() { b } else { a });
    let tangent = libm::tanf(angle);
    let of = |wheel: &super::WheelDesc| match wheel.steered {
        // The centre is to the left by `base / tan(angle)`.
        true if tangent != 0.0 && base != 0.0 => {
            let ahead = wheel.position.z - axle;
            let centre = base.abs() / tangent;
            libm::atanf(ahead / (centre - wheel.position.x))
        }
        true => angle,
        false => 0.0,
    };
    desc.wheels.iter().map(of).collect()
}
