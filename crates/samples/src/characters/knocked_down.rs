//! Knocked down: a swinging ball turns a character that it hits into a ragdoll with the ball's velocity.
//! Keys: arrows walk, space jumps, E lets the character fall; without keys it stands in the way.

use crate::parts::{Driven, fixed, level_world};
use crate::walker::{WALKER, Walker, wish};
use backstop::glam::{DVec3, Quat, Vec3};
use backstop::{BodyDesc, BodyHandle, Error, Filter, Geometry, JointDesc, ShapeDesc, Skeleton, World};

/// Where the ball hangs, and where it begins [m].
const HOOK: DVec3 = DVec3::new(0.0, 6.0, 0.0);
const BALL: DVec3 = DVec3::new(-4.5, 4.0, 0.0);
/// Torque of friction in each joint of the ragdoll [N m].
const FRICTION: f32 = 4.0;
/// A character falls if something pushes it faster than this [m/s].
const HARD: f32 = 1.5;

/// The ball, and the character before it.
pub fn start() -> Result<Driven, Error> {
    let (world, walker, ball) = build()?;
    Ok(Driven::new(world, move |world, tick| {
        if world.character(walker.character).is_err() {
            return Ok(());
        }
        let report = walker.walk(world, wish(&tick.controls, Vec3::ZERO), tick.dt)?;
        let hit = report.pushed_out.length() > HARD * tick.dt;
        if hit || tick.controls.action {
            let velocity = world.linear_velocity(if hit { ball } else { walker.body })?;
            let feet = walker.feet(world)?;
            world.remove_body(walker.body)?;
            world.remove_character(walker.character)?;
            let figure = Skeleton::humanoid().with_friction(FRICTION);
            figure.add_to(world, feet, Quat::IDENTITY, velocity)?;
        }
        Ok(())
    }))
}

fn build() -> Result<(World, Walker, BodyHandle), Error> {
    let (mut world, ground) = level_world()?;
    world.add_body(&fixed(Geometry::cuboid(0.3, 0.3, 2.0)).with_position(HOOK))?;
    // The body of a character is not moved: it would stop the ball.
    let shape = ShapeDesc::new(Geometry::sphere(0.45)).with_filter(Filter::default().with_mask(!WALKER));
    let ball = world.add_body(&BodyDesc::dynamic().with_position(BALL).with_shape(shape))?;
    let frames = world.frames_at([ground, ball], HOOK, Quat::IDENTITY)?;
    world.add_joint(&JointDesc::ball([ground, ball], frames))?;
    let walker = Walker::add_to(&mut world, Vec3::X)?;
    Ok((world, walker, ball))
}

#[test]
fn the_ball_throws_it() -> Result<(), Error> {
    let (mut sample, walker) = (start()?, build()?.1);
    crate::parts::run(&mut sample, 10.0)?;
    let world = crate::Running::world(&sample);
    assert!(world.character(walker.character).is_err());
    // The eleven bones of the ragdoll lie beyond where the character stood.
    let lies = |body| world.position(body).is_ok_and(|at| at.x > 1.5 && at.y > 0.0 && at.y < 0.5);
    assert_eq!(world.bodies().filter(|&body| lies(body)).count(), 11);
    Ok(())
}
