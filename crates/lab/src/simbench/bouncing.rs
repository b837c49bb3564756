//! The bouncing test: 7 x 7 balls, far from each other, fall by 4.9 m without friction and bounce with
//! restitution 1. Their energy, kinetic and potential, should stay the same: 49 m g H = 24 035 J.

use super::run::{Outcome, Run, Setting, sphere_density};
use backstop::BodyDesc;
use backstop::Error;
use backstop::{Geometry, Material, ShapeDesc};
use glam::DVec3;

/// [kg]
const MASS: f32 = 10.0;
/// [m]
const RADIUS: f32 = 0.1;
/// Height of the centres [m].
const HEIGHT: f64 = 5.0;
/// Balls along a side.
const SIDE: u32 = 7;

pub(super) fn run(setting: &Setting, seconds: f32) -> Result<Outcome, Error> {
    let mut run = Run::new(setting, seconds, 2.0 * RADIUS)?;
    let material = Material::default().with_friction(0.0).with_restitution(1.0);
    run.ground(material)?;
    let density = sphere_density(MASS, RADIUS);
    let ball =
        ShapeDesc::new(Geometry::Sphere { radius: RADIUS }).with_material(material).with_density(density);
    for i in 0..SIDE * SIDE {
        let at = DVec3::new(2.0 * f64::from(i / SIDE), HEIGHT, 2.0 * f64::from(i % SIDE));
        run.world.add_body(&BodyDesc::dynamic().with_position(at).with_shape(ball.clone()))?;
    }
    run.energy(setting)
}
