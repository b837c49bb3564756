//! Labyrinth: the board tilts, and the marble rolls through the gaps.
//! Keys: forwards, back, left and right tilt the board.

use crate::parts::{Driven, solid};
use backstop::glam::{DVec3, Quat, Vec3};
use backstop::{BodyDesc, BodyHandle, Error, Geometry, Settings, ShapeDesc, World};

/// Half the edge of the board [m], how far it tilts [rad], and how fast [1/s].
const HALF: f32 = 1.5;
const TILT: f32 = 0.12;
const RATE: f32 = 4.0;
/// Walls: middle along x and z, half length, and whether they are along x [m].
const WALLS: [(f32, f32, f32, bool); 8] = [
    (0.0, -HALF, HALF, true),
    (0.0, HALF, HALF, true),
    (-HALF, 0.0, HALF, false),
    (HALF, 0.0, HALF, false),
    (-0.9, -0.3, 1.2, false),
    (-0.3, 0.3, 1.2, false),
    (0.3, -0.3, 1.2, false),
    (0.9, 0.3, 1.2, false),
];

/// The board, with the marble in a corner.
pub fn start() -> Result<Driven, Error> {
    let (world, board, _) = build()?;
    Ok(Driven::new(world, move |world, tick| {
        let target = Vec3::new(-tick.controls.forward, 0.0, -tick.controls.right) * TILT;
        let turned = world.rotation(board)?.slerp(Quat::from_scaled_axis(target), RATE * tick.dt);
        world.move_kinematic_and_stop(board, DVec3::Y, turned.normalize(), tick.dt)
    }))
}

fn build() -> Result<(World, BodyHandle, BodyHandle), Error> {
    let mut world = World::new(Settings::default())?;
    let floor = ShapeDesc::new(Geometry::cuboid(HALF, 0.05, HALF));
    let mut board = BodyDesc::kinematic().with_position(DVec3::Y).with_shape(floor);
    for (x, z, half, along) in WALLS {
        let (long, wide) = if along { (half, 0.03) } else { (0.03, half) };
        let wall = ShapeDesc::new(Geometry::cuboid(long, 0.12, wide));
        board = board.with_shape(wall.with_position(Vec3::new(x, 0.17, z)));
    }
    let board = world.add_body(&board)?;
    let marble = solid(Geometry::sphere(0.1));
    let marble = world.add_body(&marble.with_position(DVec3::new(-1.2, 1.15, -1.2)))?;
    Ok((world, board, marble))
}

#[test]
fn the_marble_rolls_down_the_lane() -> Result<(), Error> {
    let (mut sample, marble) = (start()?, build()?.2);
    for mut tick in crate::Tick::during(10.0) {
        tick.controls.forward = -1.0;
        crate::Running::step(&mut sample, &tick)?;
    }
    // Towards the user, to the wall: at rest in the near corner of its lane.
    let place = crate::Running::world(&sample).position(marble)?;
    assert!(place.z > 1.2 && place.x < -0.9, "{place}");
    Ok(())
}
