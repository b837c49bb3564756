//! The force of a tyre on the ground, for one step.

use super::desc::WheelDesc;
use super::drive::WheelTorque;

/// What a tyre does during a step. Forward and left are along the ground.
#[derive(Clone, Copy, Debug)]
pub(super) struct Tyre {
    /// Load [N].
    pub(super) load: f32,
    /// What an impulse on the vehicle changes where it touches [1/kg]: forward, left.
    pub(super) inverse_mass: [f32; 2],
    /// Velocity over the ground after the step, without the tyre's own force [m/s]: forward, left.
    pub(super) velocity: [f32; 2],
    /// The same before the step.
    pub(super) slip: [f32; 2],
    /// How fast the wheel turns [rad/s].
    pub(super) spin: f32,
    pub(super) torque: WheelTorque,
    pub(super) anti_lock: bool,
}

/// What it comes to.
#[derive(Clone, Copy, Debug)]
pub(super) struct TyreForce {
    /// On the vehicle [N]: forward, left.
    pub(super) force: [f32; 2],
    /// Spin after the step [rad/s].
    pub(super) spin: f32,
    pub(super) slides: bool,
}

fn length([x, y]: [f32; 2]) -> f32 {
    (x * x + y * y).sqrt()
}

impl Tyre {
    /// Sideways force that the angle of slip allows [N].
    fn side_limit(&self, wheel: &WheelDesc) -> f32 {
        let [ahead, aside] = self.slip.map(f32::abs);
        let angle = libm::atan2f(aside, ahead) / wheel.slip_angle;
        let share = match angle {
            x if x <= 1.0 => x,
            x => 1.0 - (1.0 - wheel.sliding) * (0.5 * (x - 1.0)).min(1.0),
        };
        // An angle of slip means something above a walking pace; below, a tyre sticks.
        let pace = (length(self.slip) / 2.0).min(1.0);
        wheel.friction * self.load * (1.0 + (share - 1.0) * pace * pace)
    }

    /// The force forward with which the wheel goes as fast as the ground after the step, against a torque
    /// that resists [N], and whether that torque holds the wheel.
    fn rolling(&self, wheel: &WheelDesc, brake: f32, dt: f32) -> (f32, bool) {
        let (radius, inertia, [inverse, _]) = (wheel.radius, wheel.inertia(), self.inverse_mass);
        // The brake that would stop vehicle and wheel, as far as it reaches.
        let stop = -self.velocity[0] / (dt * inverse);
        let needed = stop * radius - self.torque.drive - inertia * self.spin / dt;
        if needed.abs() <= brake {
            return (stop, true);
        }
        let torque = self.torque.drive + brake.copysign(needed);
        let turned = inertia * (self.velocity[0] / radius - self.spin) / dt;
        ((torque - turned) / (radius + inertia * inverse / radius), false)
    }

    /// What comes of it without a load.
    pub(super) fn lifted(&self, wheel: &WheelDesc, dt: f32) -> TyreForce {
        let spin = self.torque.free(self.spin, wheel.inertia(), dt);
        TyreForce { force: [0.0; 2], spin, slides: false }
    }

    /// The force and the spin after `dt` [s].
    ///
    /// The tyre rolls if its grip allows: force and spin are those with which the wheel goes as fast as the
    /// ground after the step. Else it slides, with a force against its motion over the ground.
    pub(super) fn force(&self, wheel: &WheelDesc, dt: f32) -> TyreForce {
        let (radius, inertia) = (wheel.radius, wheel.inertia());
        let most = wheel.friction * self.load;
        let other = self.torque.other + wheel.rolling_resistance * self.load * radius;
        let brake = self.torque.foot + other;
        let limit = self.side_limit(wheel);
        let across = (-self.velocity[1] / (dt * self.inverse_mass[1])).clamp(-limit, limit);
        let rolls = |along: f32, across: f32| {
            let after = self.velocity[0] + dt * along * self.inverse_mass[0];
            TyreForce { force: [along, across], spin: after / radius, slides: false }
        };

        let (along, held) = self.rolling(wheel, brake, dt);
        if held && along.abs() <= most {
            // Both shrink to the circle: if the force along the wheel came first, wheels would hold against
            // each other and let the vehicle slide aside.
            let share = (most / length([along, across]).max(f32::MIN_POSITIVE)).min(1.0);
            return TyreForce { force: [along * share, across * share], spin: 0.0, slides: false };
        }
        if along.abs() <= most {
            // What is left of the circle beside the force along the wheel.
            let left = (most * most - along * along).max(0.0).sqrt();
            return rolls(along, across.clamp(-left, left));
        }
        if self.anti_lock && self.rolling(wheel, other, dt).0.abs() <= most {
            // The foot brake reaches the circle and yields.
            let along = most.copysign(along);
            let share = most / length([along, across]).max(f32::MIN_POSITIVE);
            return rolls(along * share, across * share);
        }
        let mut slip = [self.spin * radius - self.slip[0], -self.slip[1]];
        let mut sliding = most * wheel.sliding;
        if length(slip) < 0.1 {
            // At rest it has all of its grip, and the direction is where it would be pulled.
            (slip, sliding) = ([along, across], most);
        }
        let share = sliding / length(slip).max(f32::MIN_POSITIVE);
        let force = slip.map(|part| part * share);
        let drive = self.torque.drive - force[0] * radius;
        let mut spin = WheelTorque { drive, foot: brake, other: 0.0 }.free(self.spin, inertia, dt);
        // Grip takes the wheel to the speed of the ground, not beyond it.
        let rolling = rolls(force[0], force[1]).spin;
        if (self.spin - rolling) * (spin - rolling) < 0.0 && brake < sliding * radius {
            spin = rolling;
        }
        TyreForce { force, spin, slides: true }
    }
}
