//! Boat: driven by its screw through waves, among three hundred floats which show where the water is.
//! Keys: arrows drive and steer; without keys it goes round.

use crate::parts::Driven;
use crate::terrain::add_pool;
use backstop::fields::Fluid;
use backstop::glam::{DVec3, Vec2, Vec3};
use backstop::{BodyDesc, BodyHandle, ConvexHull, Error, Geometry, Settings, ShapeDesc, World};

/// Density of the boat and of the floats [kg/m³]: 0.35 of them are under water of 1000 kg/m³.
const DENSITY: f32 = 350.0;
/// Acceleration by the screw [m/s²]; it is turned by up to 0.3 rad to steer.
const SCREW: f32 = 4.0;

/// Height of the water [m].
fn surface(x: f64, z: f64, time: f64) -> f64 {
    0.25 * (0.5 * x + 0.3 * z + 1.5 * time).sin()
}

/// The pool with boat and floats.
pub fn start() -> Result<Driven, Error> {
    let (world, boat) = build()?;
    let water = Fluid::default().with_max([1e4, 1.0, 1e4]);
    Ok(Driven::new(world, move |world, tick| {
        water.apply_with_waves(world, tick.dt, |x, z| surface(x, z, tick.time))?;
        let keys = (tick.controls.forward, tick.controls.right);
        let (ahead, right) = if keys == (0.0, 0.0) { (1.0, 0.5) } else { keys };
        let (turned, force) = (world.rotation(boat)?, world.mass(boat)? * SCREW * ahead);
        let push = Vec2::from_angle(-0.3 * right) * force;
        let stern = world.position(boat)? + (turned * Vec3::new(0.0, -0.2, 2.0)).as_dvec3();
        world.add_force_at(boat, turned * Vec3::new(push.y, 0.0, -push.x), stern)
    }))
}

fn build() -> Result<(World, BodyHandle), Error> {
    let mut world = World::new(Settings::default())?;
    add_pool(&mut world, 15.0)?;
    let body = |geometry| BodyDesc::dynamic().with_shape(ShapeDesc::new(geometry).with_density(DENSITY));
    let outline = [(-0.8, 2.0), (0.8, 2.0), (0.8, -0.8), (0.0, -2.2), (-0.8, -0.8)];
    let deck = |y: f32| outline.map(|(x, z)| Vec3::new(x, y, z));
    let hull = ConvexHull::new(&[deck(-0.35), deck(0.35)].concat())?;
    let boat = world.add_body(&body(Geometry::hull(hull)).with_position(Vec3::X * -8.0))?;
    for i in 0..300 {
        let at = Vec3::new(1.6 * (i % 17) as f32 - 12.8, 0.1, 1.6 * (i / 17) as f32 - 13.6);
        world.add_body(&body(Geometry::cylinder(0.1, 0.2)).with_position(at))?;
    }
    Ok((world, boat))
}

#[test]
fn it_floats_and_so_do_the_floats() -> Result<(), Error> {
    let (mut sample, boat) = (start()?, build()?.1);
    crate::parts::run(&mut sample, 20.0)?;
    let world = crate::Running::world(&sample);
    assert!((world.rotation(boat)? * Vec3::Y).y > 0.9 && world.position(boat)?.y > -0.6);
    // By Archimedes a float of 0.2 m has its middle 0.03 m above the water.
    let floats = |at: DVec3| (at.y - surface(at.x, at.z, 20.0)).abs() < 0.15;
    assert!(world.bodies().filter(|&body| world.position(body).is_ok_and(floats)).count() > 290);
    Ok(())
}
