//! Trailer: on a ball joint behind a car it follows round bends, and carries a load of barrels.
//! Keys: arrows drive and steer, space brakes; without keys the car winds along.

use crate::car::{Car, HUB, RADIUS};
use crate::parts::{Driven, level_world, solid};
use backstop::glam::{DVec3, Quat, Vec3};
use backstop::{
    BodyDesc, BodyHandle, Error, Filter, Geometry, JointDesc, JointHandle, ShapeDesc, Spring, World,
};
use std::f32::consts::FRAC_PI_2;

/// Speed [m/s] and the most steering [rad] without keys.
const SPEED: f32 = 5.0;
const ANGLE: f32 = 0.25;
/// Where the hitch and the trailer are behind the car [m].
const HITCH: f64 = 2.4;
const TRAILER: f64 = 4.4;
const SPRING: Spring = Spring::Coefficients { stiffness: 25_000.0, damping: 2_500.0 };

/// The car with the trailer.
pub fn start() -> Result<Driven, Error> {
    let (world, car, _, _) = build()?;
    Ok(Driven::new(world, move |world, tick| {
        let angle = ANGLE + 0.15 * (tick.time as f32).sin();
        car.follow(world, &tick.controls, (SPEED, angle))
    }))
}

fn build() -> Result<(World, Car, BodyHandle, JointHandle), Error> {
    let (mut world, _) = level_world()?;
    let car = Car::add_to(&mut world, DVec3::Z * 10.0, Quat::IDENTITY)?;
    let at = world.position(car.chassis)? + DVec3::Z * TRAILER;
    let part = |geometry| ShapeDesc::new(geometry).with_filter(Filter::default().with_group(-1));
    let mut bed = BodyDesc::dynamic().with_position(at).with_shape(part(Geometry::cuboid(0.9, 0.1, 1.4)));
    for (half, place) in [(Vec3::new(0.05, 0.3, 1.4), Vec3::X), (Vec3::new(0.9, 0.3, 0.05), 1.5 * Vec3::Z)] {
        for side in [-0.9, 0.9] {
            let wall = part(Geometry::cuboid(half.x, half.y, half.z)).with_density(200.0);
            bed = bed.with_shape(wall.with_position(place * side + Vec3::Y * 0.4));
        }
    }
    let bed = world.add_body(&bed)?;
    let hitch = world.frames_at([car.chassis, bed], at + DVec3::Z * (HITCH - TRAILER), Quat::IDENTITY)?;
    let hitch = world.add_joint(&JointDesc::ball([car.chassis, bed], hitch))?;
    for side in [-1.05, 1.05] {
        let hub = at + DVec3::new(side, HUB.y.into(), 0.2);
        let tyre = part(Geometry::cylinder(0.1, RADIUS)).with_rotation(Quat::from_rotation_z(FRAC_PI_2));
        let tyre = world.add_body(&BodyDesc::dynamic().with_position(hub).with_shape(tyre))?;
        let frames = world.frames_at([bed, tyre], hub, Quat::IDENTITY)?;
        world.add_joint(&JointDesc::wheel([bed, tyre], frames, 0.2, SPRING))?;
    }
    for i in 0..6 {
        let place = DVec3::new(0.5 * (i % 3) as f64 - 0.5, 0.5, 0.7 * (i / 3) as f64 - 0.3);
        world.add_body(&solid(Geometry::cylinder(0.35, 0.22)).with_position(at + place))?;
    }
    Ok((world, car, bed, hitch))
}

#[test]
fn it_follows_with_its_load() -> Result<(), Error> {
    let (mut sample, bed, hitch) = (start()?, build()?.2, build()?.3);
    crate::parts::run(&mut sample, 20.0)?;
    let world = crate::Running::world(&sample);
    let [a, b] = world.joint_frames(hitch)?;
    println!("{} {}", a.0.distance(b.0), world.position(bed)?);
    for body in world.bodies() { println!("{}", world.position(body)?); }
    assert!(false);
    Ok(())
}
