//! Trebuchet: a counterweight throws a ball by an arm and a sling, which lets go at 45 degrees.

use crate::parts::{Driven, fixed, lawn, solid};
use backstop::glam::{DVec3, Quat, Vec3};
use backstop::{BodyDesc, BodyHandle, Error, Frame, Geometry, JointDesc, JointHandle, ShapeDesc, World};

/// Where the arm turns, and how long it is on both sides [m].
const AXLE: DVec3 = DVec3::new(0.0, 3.0, 0.0);
const LONG: f32 = 3.6;
const SHORT: f32 = 0.9;
/// Angle of the arm at the start [rad]: its long end is near the ground.
const ANGLE: f32 = 0.9;
/// Masses of counterweight and ball [kg], and length of the sling [m].
const HEAVY: f32 = 600.0;
const BALL: f32 = 20.0;
const SLING: f32 = 3.0;

/// The trebuchet, loaded.
pub fn start() -> Result<Driven, Error> {
    let (world, ball, sling) = build()?;
    Ok(Driven::new(world, move |world, _| {
        let way = world.linear_velocity(ball)?;
        let goes_up = way.x > 3.0 && way.y < way.x && world.position(ball)?.y > AXLE.y;
        if goes_up && world.contains_joint(sling) { world.remove_joint(sling) } else { Ok(()) }
    }))
}

fn build() -> Result<(World, BodyHandle, JointHandle), Error> {
    let (mut world, ground) = lawn()?;
    let turned = Quat::from_rotation_z(ANGLE);
    world.add_body(&fixed(Geometry::cuboid(0.1, 1.5, 0.1)).with_position(0.5 * AXLE - DVec3::Z * 0.7))?;
    let beam = ShapeDesc::new(Geometry::cuboid(0.5 * (LONG + SHORT), 0.06, 0.06)).with_density(300.0);
    let beam = beam.with_position(Vec3::X * 0.5 * (SHORT - LONG));
    let weight = ShapeDesc::new(Geometry::cuboid(0.5, 0.5, 0.4)).with_density(HEAVY / 0.8);
    let weight = weight.with_position(Vec3::X * SHORT);
    let arm = BodyDesc::dynamic().with_position(AXLE).with_rotation(turned).with_shapes([beam, weight]);
    let arm = world.add_body(&arm)?;
    let frames = world.frames_about([ground, arm], AXLE, Vec3::Z)?;
    world.add_joint(&JointDesc::hinge([ground, arm], frames))?;
    let tip = AXLE - (turned * Vec3::X * LONG).as_dvec3();
    let mut ball = solid(Geometry::sphere(0.17)).with_position(DVec3::new(tip.x + 2.9, 0.17, 0.0));
    ball.shapes[0].density = BALL / 0.0206;
    let ball = world.add_body(&ball)?;
    let frames = [Frame::at(Vec3::NEG_X * LONG), Frame::default()];
    let sling = world.add_joint(&JointDesc::distance([arm, ball], frames, 0.0, SLING))?;
    Ok((world, ball, sling))
}

#[test]
fn the_ball_gets_most_of_the_energy() -> Result<(), Error> {
    let (mut sample, ball) = (start()?, build()?.1);
    while crate::Running::world(&sample).joint_count() == 2 {
        crate::parts::run(&mut sample, 1.0 / 60.0)?;
    }
    // M g h of the counterweight, if it went from its highest place to its lowest, against m v² / 2.
    let most = HEAVY * 9.81 * SHORT * (1.0 + ANGLE.sin());
    let share = 0.5 * BALL * crate::Running::world(&sample).linear_velocity(ball)?.length_squared() / most;
    assert!(share > 0.5 && share < 1.0, "{share}");
    Ok(())
}
