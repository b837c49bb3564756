//! The force of a tyre on the ground, for one step.

use super::desc::WheelDesc;
use super::drive::WheelTorque;

/// What a tyre does during a step. Forward and left are along the ground.
#[derive(Clone, Copy, Debug)]
pub(super) struct Tyre {
    /// Load [N].
    pub(super) load: f32,
    /// The part of the vehicle's mass that it moves [kg]: by its load, and where brakes stop the vehicle.
    pub(super) mass: f32,
    pub(super) stopped: f32,
    /// Velocity of the vehicle over the ground where it touches [m/s]: forward, left.
    pub(super) velocity: [f32; 2],
    /// Gravity along the same [m/s²].
    pub(super) gravity: [f32; 2],
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

/// Share of a velocity that a step takes away where a tyre sticks: the ground is below the centre of mass, so
/// a push there moves the point of contact about twice as much as its share of the mass would.
fn sticking(velocity: f32, gravity: f32, mass: f32, dt: f32) -> f32 {
    -mass * (0.5 * velocity / dt + gravity)
}

/// The most torque that resists the turning of a wheel under a load [N m].
pub(super) fn brake_of(wheel: &WheelDesc, load: f32, torque: WheelTorque, anti_lock: bool) -> f32 {
    let grip = wheel.friction * load * wheel.radius;
    let foot = if anti_lock { torque.foot.min(grip) } else { torque.foot };
    foot + torque.other + wheel.rolling_resistance * load * wheel.radius
}

fn length([x, y]: [f32; 2]) -> f32 {
    (x * x + y * y).sqrt()
}

impl Tyre {
    /// Sideways force that the angle of slip allows [N].
    fn side_limit(&self, wheel: &WheelDesc) -> f32 {
        let [ahead, aside] = self.velocity.map(f32::abs);
        let angle = libm::atan2f(aside, ahead) / wheel.slip_angle;
        let share = match angle {
            x if x <= 1.0 => x,
            x => 1.0 - (1.0 - wheel.sliding) * (0.5 * (x - 1.0)).min(1.0),
        };
        // An angle of slip means something above a walking pace; below, a tyre sticks.
        let pace = (length(self.velocity) / 2.0).min(1.0);
        wheel.friction * self.load * (1.0 + (share - 1.0) * pace * pace)
    }

    /// The force and the spin after `dt` [s].
    ///
    /// The tyre rolls if its grip allows: force and spin are those with which the wheel goes as fast as the
    /// ground after the step. Else it slides, with a force against its motion over the ground.
    pub(super) fn force(&self, wheel: &WheelDesc, dt: f32) -> TyreForce {
        let (radius, inertia) = (wheel.radius, 0.5 * wheel.mass * wheel.radius * wheel.radius);
        let most = wheel.friction * self.load;
        let brake = brake_of(wheel, self.load, self.torque, self.anti_lock);
        let ([v, side], [g, g_side]) = (self.velocity, self.gravity);

        // The brake that would stop vehicle and wheel, as far as it reaches.
        let stop = sticking(v, g, self.stopped, dt);
        let needed = stop * radius - self.torque.drive - inertia * self.spin / dt;
        let held = needed.abs() <= brake;
        let along = if held {
            stop
        } else {
            let torque = self.torque.drive + brake.copysign(needed);
            let turned = inertia * ((v + dt * g) / radius - self.spin) / dt;
            (torque - turned) / (radius + inertia / (radius * self.mass))
        };
        let limit = self.side_limit(wheel);
        let across = sticking(side, g_side, self.mass, dt).clamp(-limit, limit);

        // Rounding: anti-lock brakes are at the limit.
        if along.abs() <= most * (1.0 + 1e-3) {
            // The ellipse: what is left beside the force along the wheel.
            let left = (most * most - along * along).max(0.0).sqrt();
            let across = across.clamp(-left, left);
            let after = v + dt * (along / self.mass + g);
            let spin = if held { 0.0 } else { after / radius };
            return TyreForce { force: [along, across], spin, slides: false };
        }
        let most = most * wheel.sliding;
        let slip = [self.spin * radius - v, -side];
        let speed = length(slip);
        // At rest the direction is where it would be pulled.
        let force = match speed > 0.1 {
            true => slip.map(|part| part * most / speed),
            false => [most.copysign(along), across.clamp(-most, most)],
        };
        let free = self.spin + dt * (self.torque.drive - force[0] * radius) / inertia;
        let braked = dt * brake / inertia;
        let mut spin = if free.abs() <= braked { 0.0 } else { free - braked.copysign(free) };
        // Grip takes the wheel to the speed of the ground, not beyond it.
        let rolling = (v + dt * (force[0] / self.mass + g)) / radius;
        if (self.spin - rolling) * (spin - rolling) < 0.0 && brake < most * radius {
            spin = rolling;
        }
        TyreForce { force, spin, slides: true }
    }
}
