//! Hovercraft: springs along rays below its corners carry it over hills, a fan drives it, a rudder turns it.
//! Keys: arrows drive and steer; without keys it goes round.

use crate::parts::{Driven, solid};
use crate::terrain::terrain;
use backstop::glam::{DVec3, Vec3};
use backstop::{BodyHandle, Error, Geometry, QueryFilter, Ray, Settings, World};

/// Half extents of the hull [m].
const HULL: Vec3 = Vec3::new(0.8, 0.15, 1.4);
/// How high it floats at rest [m]; rays go twice as far.
const HEIGHT: f32 = 0.8;
/// Damping of the springs [1/s], of motion ahead and aside [1/s], and of rotation [1/s].
const DAMPING: f32 = 5.0;
const DRAG: [f32; 2] = [1.0, 3.0];
const SPIN_DRAG: f32 = 2.0;
/// Acceleration by the fan [m/s²], and by the rudder [rad/s²].
const FAN: f32 = 5.0;
const RUDDER: f32 = 2.0;

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
    world.add_body(&terrain(30, |x, z| 0.8 * (0.3 * x).sin() * (0.25 * z).cos() + ((x * x + z * z) / 700.0).powi(4))?)?;
    let hull = solid(Geometry::cuboid(HULL.x, HULL.y, HULL.z)).with_position(Vec3::new(-8.0, 2.0, 0.0));
    let craft = world.add_body(&hull.with_angular_damping(SPIN_DRAG))?;
    Ok((world, craft))
}

/// Adds the forces of a step.
fn hover(world: &mut World, craft: BodyHandle, (fan, rudder): (f32, f32)) -> Result<(), Error> {
    let (mass, turned, at) = (world.mass(craft)?, world.rotation(craft)?, world.position(craft)?);
    for (x, z) in [(-1.0, -1.0), (1.0, -1.0), (-1.0, 1.0), (1.0, 1.0)] {
        let corner: DVec3 = at + (turned * (HULL * Vec3::new(x, 0.0, z))).as_dvec3();
        let ray = Ray::new(corner, Vec3::NEG_Y * (2.0 * HEIGHT));
        if let Some(hit) = world.cast_ray(&ray, &QueryFilter::only_static())? {
            // A quarter of the weight at HEIGHT, twice that on the ground.
            let lift = 9.81 * 2.0 * (1.0 - hit.fraction) - DAMPING * world.velocity_at(craft, corner)?.y;
            world.add_force_at(craft, Vec3::Y * (0.25 * mass * lift.max(0.0)), corner)?;
        }
    }
    let local = turned.inverse() * world.linear_velocity(craft)?;
    let push = turned * Vec3::new(-DRAG[1] * local.x, 0.0, -FAN * fan - DRAG[0] * local.z);
    world.add_force(craft, push * mass)?;
    let inertia = mass * (HULL.x * HULL.x + HULL.z * HULL.z) / 3.0;
    world.add_torque(craft, turned * Vec3::Y * (-RUDDER * rudder * inertia))
}

#[test]
fn it_floats_over_the_hills() -> Result<(), Error> {
    let (mut sample, craft) = (start()?, build()?.1);
    for tick in crate::Tick::during(30.0) {
        crate::Running::step(&mut sample, &tick)?; if (tick.time * 60.0).round() as u32 % 60 == 0 { let world = crate::Running::world(&sample); println!("{} {} {} {}", world.position(craft)?, world.linear_velocity(craft)?, world.angular_velocity(craft)?, world.rotation(craft)? * Vec3::Y); }
    }
    let world = crate::Running::world(&sample);
    // The fan against the drag.
    let speed = world.linear_velocity(craft)?.length();
    assert!((speed - FAN / DRAG[0]).abs() < 3.0, "{speed} m/s");
    Ok(())
}
