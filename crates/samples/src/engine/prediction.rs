//! Prediction: a ghost shows where the ball will be in a second, since the world goes ahead and is put back.

use crate::parts::{Driven, fixed};
use backstop::glam::{Quat, Vec3};
use backstop::{BodyDesc, BodyHandle, Error, Geometry, Material, Settings, ShapeDesc, Snapshot, World};

/// How many steps it goes ahead.
const AHEAD: usize = 60;
const RADIUS: f32 = 0.3;

/// A ball that bounces between walls, and its ghost.
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
    for _ in 0..AHEAD {
        world.step(dt)?;
    }
    let place = world.position(body)?;
    world.restore(&now)?;
    Ok(place)
}

fn build() -> Result<(World, BodyHandle, BodyHandle), Error> {
    let mut world = World::new(Settings::default())?;
    let rubber = Material::default().with_restitution(1.0).with_friction(0.0);
    let ground = ShapeDesc::new(Geometry::plane()).with_material(rubber);
    world.add_body(&BodyDesc::fixed().with_shape(ground))?;
    for (x, z) in [(-4.0, 0.0), (4.0, 0.0), (0.0, -4.0), (0.0, 4.0)] {
        let half: Vec3 = if z == 0.0 { Vec3::new(0.1, 0.7, 4.0) } else { Vec3::new(4.0, 0.7, 0.1) };
        world
            .add_body(&fixed(Geometry::cuboid(half.x, half.y, half.z)).with_position(Vec3::new(x, 0.7, z)))?;
    }
    let ball = ShapeDesc::new(Geometry::sphere(RADIUS)).with_material(rubber);
    let ball = BodyDesc::dynamic().with_position(Vec3::Y).with_shape(ball);
    let ball = world.add_body(&ball.with_linear_velocity(Vec3::new(4.0, 0.0, 2.3)))?;
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
