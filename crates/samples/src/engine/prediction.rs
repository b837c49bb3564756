//! Prediction: a ghost shows where the ball will be in a second, since the world goes ahead and is put back.

use crate::parts::{Driven, fixed};
use backstop::glam::{Quat, Vec3};
use backstop::{BodyDesc, BodyHandle, Error, Geometry, Material, Settings, ShapeDesc, Snapshot, World};

/// How many steps it goes ahead.
const AHEAD: usize = 60;
const RADIUS: f32 = 0.3;

/// A ball that bounces among others between walls, and its ghost.
pub fn start() -> Result<Driven, Error> {
    let (world, ball, ghost) = build()?;
    Ok(Driven::new(world, move |world, tick| {
        let place = look_ahead(world, ball, tick.dt)?;
        world.set_pose(ghost, place, Quat::IDENTITY)
    }))
}

/// Where a body will be.
fn look_ahead(world: &mut World, body: BodyHandle, dt: f32) -> Result<backstop::glam::DVec3, Error> {
    let mut now = Snapshot::new();
    world.snapshot(&mut now);
    (0..AHEAD).try_for_each(|_| world.step(dt).map(drop))?;
    let place = world.position(body)?;
    world.restore(&now)?;
    Ok(place)
}

fn build() -> Result<(World, BodyHandle, BodyHandle), Error> {
    let mut world = World::new(Settings::default())?;
    let rubber = Material::default().with_restitution(1.0).with_friction(0.0);
    world.add_body(&BodyDesc::fixed().with_shape(ShapeDesc::new(Geometry::plane()).with_material(rubber)))?;
    for out in [Vec3::X, Vec3::NEG_X, Vec3::Z, Vec3::NEG_Z] {
        let wall = fixed(Geometry::cuboid(4.0 * out.z.abs() + 0.1, 0.7, 4.0 * out.x.abs() + 0.1));
        world.add_body(&wall.with_position(4.0 * out + Vec3::Y * 0.7))?;
    }
    let ball = ShapeDesc::new(Geometry::sphere(RADIUS)).with_material(rubber);
    let ball = BodyDesc::dynamic().with_shape(ball);
    for i in 0..12 {
        let place = Vec3::new(2.0 * (i % 4) as f32 - 3.0, RADIUS, 2.0 * (i / 4) as f32 - 2.0);
        world.add_body(&ball.clone().with_position(place))?;
    }
    let ball = world.add_body(&ball.with_position(Vec3::Y).with_linear_velocity(Vec3::new(4.0, 0.0, 2.3)))?;
    let ghost = ShapeDesc::new(Geometry::sphere(RADIUS)).as_sensor();
    let ghost = world.add_body(&BodyDesc::kinematic().with_shape(ghost))?;
    Ok((world, ball, ghost))
}

#[test]
fn the_ball_comes_to_where_its_ghost_was() -> Result<(), Error> {
    let (mut sample, (_, ball, ghost)) = (start()?, build()?);
    for _ in 0..10 {
        crate::parts::run(&mut sample, 1.0 / 60.0)?;
        let predicted = crate::Running::world(&sample).position(ghost)?;
        crate::parts::run(&mut sample, (AHEAD - 1) as f64 / 60.0)?;
        assert_eq!(crate::Running::world(&sample).position(ball)?, predicted, "to the bit");
    }
    Ok(())
}
