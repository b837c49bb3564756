//! Bullets: at 1 km/s they hit hanging plates and a wall of 2 mm, and none gets through.

use crate::parts::{Driven, fixed, level_world, spread};
use backstop::glam::{DVec3, Vec3};
use backstop::{BodyDesc, Error, Geometry, JointDesc, ShapeDesc, World};

/// Speed of a bullet [m/s], 17 m in a step, and density of steel [kg/m³].
const SPEED: f32 = 1000.0;
const STEEL: f32 = 7800.0;
/// Half the thickness of a plate and of the wall, and where the wall is [m].
const HALF: f32 = 0.001;
const WALL: f32 = 3.0;

/// The plates and the wall, before which a gun moves to and fro.
pub fn start() -> Result<Driven, Error> {
    Ok(Driven::new(range()?, |world, tick| {
        for i in tick.due(0.1).filter(|&i| i < 120) {
            let side = 3.0 * (0.7 * tick.time as f32).sin();
            let bullet = BodyDesc::dynamic()
                .with_position(Vec3::new(-6.0, 0.6 + 1.8 * spread(i), side))
                .with_linear_velocity(Vec3::X * SPEED)
                .with_shape(ShapeDesc::new(Geometry::sphere(0.02)).with_density(STEEL));
            world.add_body(&bullet)?;
        }
        Ok(())
    }))
}

fn range() -> Result<World, Error> {
    let (mut world, ground) = level_world()?;
    // The wall, and a roof and sides that keep bullets which glance off a plate.
    let middle = Vec3::new(WALL - 6.0, 2.0, 0.0);
    for (half, at) in [
        (Vec3::new(HALF, 2.0, 5.0), Vec3::X * 6.0),
        (Vec3::new(6.0, HALF, 5.0), Vec3::Y * 2.0),
        (Vec3::new(6.0, 2.0, HALF), Vec3::Z * 5.0),
        (Vec3::new(6.0, 2.0, HALF), Vec3::Z * -5.0),
    ] {
        world.add_body(&fixed(Geometry::cuboid(half.x, half.y, half.z)).with_position(middle + at))?;
    }
    let plate = ShapeDesc::new(Geometry::cuboid(HALF, 0.9, 0.6)).with_density(STEEL);
    for i in 0..4 {
        let at = DVec3::new(0.0, 1.6, 1.5 * i as f64 - 2.25);
        let plate = world.add_body(&BodyDesc::dynamic().with_position(at).with_shape(plate.clone()))?;
        let frames = world.frames_about([ground, plate], at + DVec3::Y * 0.9, Vec3::Z)?;
        world.add_joint(&JointDesc::hinge([ground, plate], frames))?;
    }
    Ok(world)
}

#[test]
fn none_is_behind_the_wall() -> Result<(), Error> {
    let mut sample = start()?;
    crate::parts::run(&mut sample, 15.0)?;
    let world = crate::Running::world(&sample);
    let inside = |at: DVec3| at.x < WALL.into() && at.y > 0.0 && at.y < 4.0 && at.z.abs() < 5.0;
    let moves = |body: &backstop::BodyHandle| world.kind(*body) == Ok(backstop::BodyKind::Dynamic);
    assert!(world.bodies().filter(moves).all(|body| world.position(body).is_ok_and(inside)));
    Ok(())
}
