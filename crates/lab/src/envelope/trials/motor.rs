//! A motor that drives a rod against a stop.

use super::super::conditions::Conditions;
use super::super::measures::{Gauge, Measure, mass_of};
use super::setup::Setup;
use backstop::{Axes, Axis, Geometry, JointDesc, Limit, Motion, Motor};
use backstop_scene::builtin::{dynamic, fixed};
use backstop_scene::{Scene, join};
use glam::{DVec3, Vec3};

/// A motor presses a rod against a stop at one radian; it is strong enough for three rods, and for so many
/// times three with a ratio of masses. A spin is the motor's.
pub(super) fn motor(c: &Conditions) -> Setup {
    const STOP: f32 = 1.0;
    let mut scene = Scene::new("motor");
    let post = scene.add("post", fixed(Geometry::Sphere { radius: 0.05 * c.size }, Vec3::ZERO));
    let thick = (0.1 / c.slenderness.sqrt()).min(0.1) * c.size;
    let rod = Geometry::cuboid(thick, 0.5 * c.size, thick);
    let rod = scene.add("rod", dynamic(rod, Vec3::NEG_Y * (0.5 * c.size)));
    let weight = mass_of(&scene.bodies[rod].desc).mass * 9.81 * c.gravity;
    let torque = 3.0 * weight * 0.5 * c.size * c.mass_ratio;
    let speed = c.spin.unwrap_or(2.0);
    join(&mut scene, [post, rod], DVec3::ZERO, super::jointed::x_to_z(), |bodies, frames| {
        JointDesc::hinge(bodies, frames)
            .with_limit(Limit::new(Motion::Angular, Axes::One(Axis::X), -STOP, STOP))
            .with_motor(Motor::velocity(Motion::Angular, Axis::X, speed, torque))
    });
    let stop = Measure::Stop { joint: 0, angle: f64::from(STOP) };
    let apart = Measure::Apart { unit: f64::from(c.size) };
    let restless = Measure::Restless { unit: f64::from((9.81 * c.gravity * c.size).sqrt()) };
    let gauges = vec![
        Gauge { measure: stop, bounds: [0.01, 0.1] },
        Gauge { measure: apart, bounds: [0.01, 0.1] },
        Gauge { measure: restless, bounds: [0.02, f64::INFINITY] },
    ];
    Setup { scene, boundaries: Vec::new(), gauges }
}
