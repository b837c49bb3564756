//! Doors: a plate that notices parcels opens each door on the belt, and closes it behind them.

use crate::parts::{Driven, level_world, solid};
use backstop::glam::Vec3;
use backstop::{
    Axis, BodyDesc, Error, Geometry, JointDesc, JointHandle, Motion, Motor, ShapeDesc, ShapeHandle, Spring,
    World,
};

/// Speed of the belt [m/s], how far a door goes up [m], and the spring that moves it.
const BELT: f32 = 1.0;
const OPEN: f32 = 1.3;
const SERVO: Spring = Spring::Frequency { hertz: 2.0, ratio: 1.0 };

/// The belt with its doors and parcels.
pub fn start() -> Result<Driven, Error> {
    let (world, doors) = build()?;
    Ok(Driven::new(world, move |world, _| {
        let mut inside = Vec::new();
        for &(plate, slider) in &doors {
            world.sensor_overlaps(plate, &mut inside)?;
            let height = if inside.is_empty() { 0.0 } else { OPEN };
            world.set_joint_target(slider, Motion::Linear, Axis::X, height, 0.0)?;
        }
        Ok(())
    }))
}

fn build() -> Result<(World, Vec<(ShapeHandle, JointHandle)>), Error> {
    let (mut world, ground) = level_world()?;
    let mut belt = ShapeDesc::new(Geometry::cuboid(9.0, 0.25, 0.6));
    belt.material.surface_velocity = Vec3::X * BELT;
    world.add_body(&BodyDesc::fixed().with_position(Vec3::Y * 0.25).with_shape(belt))?;
    let mut doors = Vec::new();
    for x in [-3.0, 0.0, 3.0] {
        let door = solid(Geometry::cuboid(0.05, 0.65, 0.6)).with_position(Vec3::new(x, 1.3, 0.0));
        let pair = [ground, world.add_body(&door)?];
        let frames = world.frames_about(pair, door.position, Vec3::Y)?;
        let servo = Motor::position(Motion::Linear, Axis::X, 0.0, SERVO);
        let slider = world.add_joint(&JointDesc::slider(pair, frames).with_motor(servo))?;
        // So flat that the door does not reach into it.
        let plate = ShapeDesc::new(Geometry::cuboid(0.9, 0.02, 0.6)).as_sensor();
        doors.push((world.add_shape(ground, &plate.with_position(Vec3::new(x, 0.53, 0.0)))?, slider));
    }
    let parcel = |x| solid(Geometry::cuboid(0.25, 0.25, 0.25)).with_position(Vec3::new(x, 0.75, 0.0));
    world.add_bodies(&[-5.5, -6.5, -7.5].map(parcel))?;
    Ok((world, doors))
}

#[test]
fn a_door_is_open_for_a_parcel() -> Result<(), Error> {
    let (mut sample, doors) = (start()?, build()?.1);
    // From x = -5.5 at 1 m/s: the first parcel is between two doors, and the second one in the first door.
    crate::parts::run(&mut sample, 4.0)?;
    let world = crate::Running::world(&sample);
    let height = |i: usize| world.joint_position(doors[i].1, Motion::Linear, backstop::Axes::One(Axis::X));
    assert!(height(0)? > 0.5 && height(2)? < 0.1, "{} {}", height(0)?, height(2)?);
    Ok(())
}
