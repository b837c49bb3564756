//! Hovercraft: springs along rays below its corners carry it over hills, a fan drives it, a rudder turns it.
//! Keys: arrows drive and steer; without keys it goes round.

use crate::parts::{Driven, solid};
use crate::terrain::terrain;
use backstop::glam::Vec3;
use backstop::{BodyHandle, Error, Geometry, QueryFilter, Ray, Settings, World};

/// Half extents of the hull, and how high its corners float at rest [m]: there springs bear the weight.
const HULL: Vec3 = Vec3::new(0.8, 0.15, 1.4);
const HEIGHT: f32 = 0.8;
/// Damping of the springs and of rotation, and of motion aside and ahead [1/s].
const DAMPING: f32 = 4.0;
const DRAG: Vec3 = Vec3::new(3.0, 0.0, 1.0);
/// Acceleration by the fan [m/s²], and by the rudder [rad/s²].
const FAN: f32 = 5.0;
const RUDDER: f32 = 4.0;

/// The craft on the hills.
pub fn start() -> Result<Driven, Error> {
    let (world, craft) = build()?;
    Ok(Driven::new(world, move |world, tick| {
        let keys = (tick.controls.forward, tick.controls.right);
        hover(world, craft, if keys == (0.0, 0.0) { (1.0, 0.5) } else { keys })
    }))
}

fn build() -> Result<(World, BodyHandle), Error> {
    let mut world = World::new(Settings::default())?;
    let hills = |x: f32, z: f32| 0.8 * (0.3 * x).sin() * (0.25 * z).cos() + ((x * x + z * z) / 900.0).powi(4);
    world.add_body(&terrain(36, hills)?)?;
    let hull = solid(Geometry::cuboid(HULL.x, HULL.y, HULL.z)).with_angular_damping(DAMPING);
    world.add_body(&hull.with_position(Vec3::new(-9.0, 1.5, 0.0))).map(|craft| (world, craft))
}

fn hover(world: &mut World, craft: BodyHandle, (fan, rudder): (f32, f32)) -> Result<(), Error> {
    let (mass, turned, at) = (world.mass(craft)?, world.rotation(craft)?, world.position(craft)?);
    for (x, z) in [(-1.0, -1.0), (1.0, -1.0), (-1.0, 1.0), (1.0, 1.0)] {
        let corner = at + (turned * (HULL * Vec3::new(x, 0.0, z))).as_dvec3();
        let down = Ray::new(corner, Vec3::NEG_Y * (2.0 * HEIGHT));
        if let Some(hit) = world.cast_ray(&down, &QueryFilter::only_static())? {
            let lift = 9.81 * 2.0 * (1.0 - hit.fraction) - DAMPING * world.velocity_at(craft, corner)?.y;
            world.add_force_at(craft, Vec3::Y * (0.25 * mass * lift.max(0.0)), corner)?;
        }
    }
    let velocity = turned.inverse() * world.linear_velocity(craft)?;
    world.add_force(craft, turned * (Vec3::NEG_Z * FAN * fan - DRAG * velocity) * mass)?;
    let inertia = mass * (HULL.x * HULL.x + HULL.z * HULL.z) / 3.0;
    world.add_torque(craft, turned * Vec3::Y * (-RUDDER * rudder * inertia))
}

#[test]
fn it_goes_round_over_the_hills() -> Result<(), Error> {
    let (mut sample, craft) = (start()?, build()?.1);
    crate::parts::run(&mut sample, 30.0)?;
    // Half of the rudder against the damping.
    let turn = -crate::Running::world(&sample).angular_velocity(craft)?.y;
    assert!((turn / (0.5 * RUDDER / DAMPING) - 1.0).abs() < 0.1, "{turn} rad/s");
    Ok(())
}
