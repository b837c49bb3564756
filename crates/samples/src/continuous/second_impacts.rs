//! Second impacts: balls bounce between walls which come close, many times within a step, and stay there.

use crate::parts::{Driven, level_world};
use backstop::glam::{DVec3, Quat, Vec3};
use backstop::{BodyDesc, BodyHandle, ContinuousMode, Error, Geometry, Material, ShapeDesc, World};

/// Speeds of the balls at the start [m/s].
const SPEEDS: [f32; 6] = [10.0, 30.0, 60.0, 120.0, 250.0, 500.0];
/// Radius of the balls, and half the thickness of the walls [m].
const RADIUS: f32 = 0.15;
const HALF: f32 = 0.02;

/// Two walls that move, and the balls between them.
pub fn start() -> Result<Driven, Error> {
    let (world, walls, _) = build()?;
    Ok(Driven::new(world, move |world, tick| {
        let to = place(tick.time + f64::from(tick.dt));
        world.move_kinematic_and_stop(walls[0], DVec3::new(-to.x, to.y, to.z), Quat::IDENTITY, tick.dt)?;
        world.move_kinematic_and_stop(walls[1], to, Quat::IDENTITY, tick.dt)
    }))
}

/// Where the wall on the right is [m]: the two are 0.5 to 3 m apart.
fn place(time: f64) -> DVec3 {
    DVec3::new(0.875 + 0.625 * time.cos(), 0.6, 0.0)
}

fn build() -> Result<(World, [BodyHandle; 2], Vec<BodyHandle>), Error> {
    let (mut world, _) = level_world()?;
    let material = Material::default().with_restitution(1.0).with_friction(0.0);
    let shape = |geometry| ShapeDesc::new(geometry).with_material(material);
    let wall = BodyDesc::kinematic().with_shape(shape(Geometry::cuboid(HALF, 0.5, 2.2)));
    let mut add = |side: DVec3| world.add_body(&wall.clone().with_position(place(0.0) * side));
    let walls = [add(DVec3::new(-1.0, 1.0, 1.0))?, add(DVec3::ONE)?];
    let ball = BodyDesc::dynamic()
        .with_continuous(ContinuousMode::Volume)
        .with_lock_translation([false, true, true])
        .with_shape(shape(Geometry::sphere(RADIUS)));
    let mut balls = Vec::new();
    for (i, speed) in SPEEDS.into_iter().enumerate() {
        let at = Vec3::new(0.0, 0.6, 0.7 * i as f32 - 1.75);
        let ball = ball.clone().with_position(at).with_linear_velocity(Vec3::X * speed);
        balls.push(world.add_body(&ball)?);
    }
    Ok((world, walls, balls))
}

#[test]
fn no_ball_leaves_its_walls() -> Result<(), Error> {
    let (mut sample, balls) = (start()?, build()?.2);
    for tick in crate::Tick::during(30.0) {
        crate::Running::step(&mut sample, &tick)?;
        for (&ball, speed) in balls.iter().zip(SPEEDS) {
            let out = crate::Running::world(&sample).position(ball)?.x.abs();
            assert!(out < place(tick.time + f64::from(tick.dt)).x, "{speed} m/s at {} s", tick.time);
        }
    }
    Ok(())
}
