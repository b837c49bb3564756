//! Shape casts: a ghost shows where each ball will touch first, and the ball touches there.

use crate::parts::{Driven, fixed, solid};
use backstop::glam::{DVec3, Quat, Vec3};
use backstop::{BodyDesc, BodyHandle, Error, Geometry, QueryFilter, Settings, ShapeCast, ShapeDesc, World};

/// Radius of the ball, where it starts [m], how fast it goes [m/s], and when it starts again [s].
const RADIUS: f32 = 0.3;
const FROM: DVec3 = DVec3::new(-5.0, 1.5, 0.0);
const SPEED: f32 = 6.0;
const PERIOD: f64 = 3.0;

/// Obstacles, the ball, and its ghost.
pub fn start() -> Result<Driven, Error> {
    let (world, ball, ghost) = build()?;
    Ok(Driven::new(world, move |world, tick| {
        let angle = 0.07 * ((tick.time / PERIOD).round() as f32 % 9.0 - 4.0);
        let way = Quat::from_rotation_y(angle) * Vec3::X;
        let due = tick.time % PERIOD < f64::from(tick.dt);
        if due { shoot(world, [ball, ghost], way) } else { Ok(()) }
    }))
}

fn shoot(world: &mut World, [ball, ghost]: [BodyHandle; 2], way: Vec3) -> Result<(), Error> {
    let shape = Geometry::sphere(RADIUS);
    let cast = ShapeCast::new(&shape, FROM, way * 12.0);
    let hit = world.cast_shape(&cast, &QueryFilter::only_static())?;
    let end = cast.position_at(hit.map_or(1.0, |hit| hit.fraction));
    world.set_pose(ghost, end, Quat::IDENTITY)?;
    world.set_pose(ball, FROM, Quat::IDENTITY)?;
    world.set_velocity(ball, way * SPEED, Vec3::ZERO)
}

fn build() -> Result<(World, BodyHandle, BodyHandle), Error> {
    let mut world = World::new(Settings::default().with_gravity(Vec3::ZERO))?;
    let shapes = [Geometry::sphere(0.6), Geometry::cylinder(0.5, 0.5), Geometry::cuboid(0.4, 0.4, 0.4)];
    for (i, shape) in shapes.into_iter().enumerate() {
        let place = DVec3::new(i as f64 % 2.0, 1.5, 1.8 * i as f64 - 1.8);
        world.add_body(&fixed(shape).with_position(place))?;
    }
    let ghost = ShapeDesc::new(Geometry::sphere(RADIUS)).as_sensor();
    let ghost = world.add_body(&BodyDesc::kinematic().with_shape(ghost))?;
    let ball = world.add_body(&solid(Geometry::sphere(RADIUS)).with_position(FROM))?;
    Ok((world, ball, ghost))
}

#[test]
fn the_ball_touches_where_the_ghost_is() -> Result<(), Error> {
    for angle in [-0.25_f32, -0.1, 0.0, 0.1, 0.25] {
        let (mut world, ball, ghost) = build()?;
        shoot(&mut world, [ball, ghost], Quat::from_rotation_y(angle) * Vec3::X)?;
        let mut nearest = f64::INFINITY;
        for _ in 0..60 * 3 {
            world.step(1.0 / 60.0)?;
            nearest = nearest.min(world.position(ball)?.distance(world.position(ghost)?));
        }
        assert!(nearest < 0.06, "{angle}: {nearest} m");
    }
    Ok(())
}
