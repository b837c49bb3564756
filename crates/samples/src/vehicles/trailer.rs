//! Trailer: on a ball joint behind a car it follows round bends, and carries a load of barrels.
//! Keys: arrows drive and steer, space brakes; without keys the car winds round a circle at 5 m/s.

use crate::car::{Car, HUB, add_wheel, part};
use crate::parts::{Driven, level_world, solid};
use backstop::glam::{DVec3, Quat, Vec3};
use backstop::{BodyDesc, BodyHandle, Error, Geometry, JointDesc, JointHandle, World};

/// Where the hitch and the middle of the trailer are behind that of the car [m].
const HITCH: f64 = 2.4;
const TRAILER: f64 = 4.4;

/// The car with the trailer.
pub fn start() -> Result<Driven, Error> {
    let (world, car, ..) = build()?;
    Ok(Driven::new(world, move |world, tick| {
        car.follow(world, &tick.controls, (5.0, 0.2 + 0.1 * (tick.time as f32).sin()))
    }))
}

fn build() -> Result<(World, Car, BodyHandle, JointHandle), Error> {
    let (mut world, _) = level_world()?;
    let car = Car::add_to(&mut world, DVec3::X * -10.0, Quat::IDENTITY)?;
    let at = world.position(car.chassis)? + DVec3::Z * TRAILER;
    // A bed with walls around it.
    let wall = |x: f32, z: f32, at: Vec3| {
        part(Geometry::cuboid(x, 0.3, z), 200.0).with_position(at + Vec3::Y * 0.4)
    };
    let bed = BodyDesc::dynamic().with_position(at).with_shapes([
        part(Geometry::cuboid(0.9, 0.1, 1.4), 400.0),
        wall(0.05, 1.4, Vec3::X * 0.85),
        wall(0.05, 1.4, Vec3::X * -0.85),
        wall(0.9, 0.05, Vec3::Z * 1.35),
        wall(0.9, 0.05, Vec3::Z * -1.35),
    ]);
    let bed = world.add_body(&bed)?;
    add_wheel(&mut world, bed, Vec3::new(-1.1, HUB.y, 0.2))?;
    add_wheel(&mut world, bed, Vec3::new(1.1, HUB.y, 0.2))?;
    let frames = world.frames_at([car.chassis, bed], at + DVec3::Z * (HITCH - TRAILER), Quat::IDENTITY)?;
    let hitch = world.add_joint(&JointDesc::ball([car.chassis, bed], frames))?;
    for i in 0..6 {
        let place = DVec3::new(0.5 * (i % 3) as f64 - 0.5, 0.4, 0.7 * (i / 3) as f64 - 0.3);
        world.add_body(&solid(Geometry::cylinder(0.25, 0.24)).with_position(at + place))?;
    }
    Ok((world, car, bed, hitch))
}

#[test]
fn it_follows_with_its_load() -> Result<(), Error> {
    let (mut sample, (_, _, bed, hitch)) = (start()?, build()?);
    crate::parts::run(&mut sample, 20.0)?;
    let world = crate::Running::world(&sample);
    let [car, trailer] = world.joint_frames(hitch)?;
    assert!(car.0.distance(trailer.0) < 0.001, "the hitch holds");
    let on_it = |body: &BodyHandle| world.position(*body).is_ok_and(|at| at.y > 0.7);
    assert_eq!(world.bodies().filter(on_it).count(), 6, "barrels are on the bed");
    assert!((world.rotation(bed)? * Vec3::Y).y > 0.99);
    Ok(())
}
