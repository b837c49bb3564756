//! Water wheel: balls which run down a chute fill its buckets and turn it against a brake.

use crate::parts::{Driven, fixed, lawn, solid};
use backstop::glam::{DVec3, Quat, Vec3};
use backstop::{Axis, BodyDesc, BodyHandle, Error, Geometry, JointDesc, Motion, Motor, ShapeDesc, World};
use std::f32::consts::TAU;

const BUCKETS: usize = 12;
const BALLS: usize = 60;
/// Balls that come in a second, middle and radius of the wheel [m], and torque of its brake [N m].
const RATE: f64 = 6.0;
const AXLE: DVec3 = DVec3::new(0.0, 2.0, 0.0);
const RADIUS: f32 = 1.5;
const BRAKE: f32 = 150.0;

/// The wheel, and the balls on the ground. From there they go to the head of the chute, one after another.
pub fn start() -> Result<Driven, Error> {
    let (world, _, balls) = build()?;
    Ok(Driven::new(world, move |world, tick| {
        let low = |&&ball: &&BodyHandle| world.position(ball).is_ok_and(|at| at.y < 0.3);
        let due = (tick.time * RATE).fract() < RATE * f64::from(tick.dt);
        let Some(&ball) = balls.iter().filter(|_| due).find(low) else { return Ok(()) };
        world.set_pose(ball, DVec3::new(-1.8, 4.0, 0.0), Quat::IDENTITY)?;
        world.set_linear_velocity(ball, Vec3::ZERO)
    }))
}

fn build() -> Result<(World, BodyHandle, Vec<BodyHandle>), Error> {
    let (mut world, ground) = lawn()?;
    let mut wheel = BodyDesc::dynamic().with_position(AXLE);
    for i in 0..BUCKETS {
        // A blade, and the floor of the bucket beside it.
        let turned = Quat::from_rotation_z(TAU * i as f32 / BUCKETS as f32);
        for (x, long, high) in [(RADIUS - 0.3, 0.3, 0.02), (RADIUS - 0.6, 0.02, 0.25)] {
            let part = ShapeDesc::new(Geometry::cuboid(long, high, 0.3)).with_density(200.0);
            wheel = wheel.with_shape(part.with_position(turned * Vec3::X * x).with_rotation(turned));
        }
    }
    let wheel = world.add_body(&wheel)?;
    let frames = world.frames_about([ground, wheel], AXLE, Vec3::Z)?;
    let brake = Motor::friction(Motion::Angular, Axis::X, BRAKE);
    world.add_joint(&JointDesc::hinge([ground, wheel], frames).with_motor(brake))?;
    let chute = fixed(Geometry::cuboid(1.2, 0.05, 0.3)).with_rotation(Quat::from_rotation_z(-0.2));
    world.add_body(&chute.with_position(Vec3::new(-0.9, 3.8, 0.0)))?;
    // They keep to the plane of the wheel.
    let ball = solid(Geometry::sphere(0.1)).with_lock_translation([false, false, true]);
    let place = |i: usize| Vec3::new(2.0 + 0.25 * (i % 10) as f32, 0.1, 0.25 * (i / 10) as f32 - 0.6);
    let balls: Vec<BodyDesc> = (0..BALLS).map(|i| ball.clone().with_position(place(i))).collect();
    let balls = world.add_bodies(&balls)?;
    Ok((world, wheel, balls))
}

#[test]
fn it_turns_to_where_they_fall() -> Result<(), Error> {
    let (mut wheel, handle) = (start()?, build()?.1);
    crate::parts::run(&mut wheel, 20.0)?;
    let spin = crate::Running::world(&wheel).angular_velocity(handle)?.z;
    assert!(spin < -0.3 && spin > -4.0, "{spin} rad/s");
    Ok(())
}
