//! Seesaws: each goes down on the side where weight times distance is greater; the middle one stays level.

use crate::parts::{level_world, solid};
use backstop::glam::{DVec3, Vec3};
use backstop::{Axes, Axis, Error, Geometry, JointDesc, JointHandle, Limit, Motion, Motor, World};

/// Distances of a cube of 125 kg on the left, and of one of 250 kg on the right [m].
const DISTANCES: [[f32; 2]; 3] = [[1.6, 0.4], [1.6, 0.8], [1.2, 1.2]];
/// How far a seesaw tilts [rad], and the friction of its hinge [N m].
const TILT: f32 = 0.2;
const FRICTION: f32 = 100.0;
const HEIGHT: f32 = 0.6;

/// The seesaws, level.
pub fn start() -> Result<World, Error> {
    Ok(build()?.0)
}

fn build() -> Result<(World, Vec<JointHandle>), Error> {
    let (mut world, ground) = level_world()?;
    let mut hinges = Vec::new();
    for (i, distances) in DISTANCES.into_iter().enumerate() {
        let middle = Vec3::new(0.0, HEIGHT, 1.5 * i as f32 - 1.5);
        let board = solid(Geometry::cuboid(2.2, 0.05, 0.4)).with_position(middle);
        let board = world.add_body(&board)?;
        let pivot: DVec3 = middle.into();
        let frames = world.frames_about([ground, board], pivot, Vec3::Z)?;
        let hinge = JointDesc::hinge([ground, board], frames)
            .with_limit(Limit::new(Motion::Angular, Axes::One(Axis::X), -TILT, TILT))
            .with_motor(Motor::friction(Motion::Angular, Axis::X, FRICTION));
        hinges.push(world.add_joint(&hinge)?);
        let [left, right] = distances;
        for (x, half) in [(-left, 0.25), (right, 0.315)] {
            let cube = solid(Geometry::cuboid(half, half, half));
            world.add_body(&cube.with_position(middle + Vec3::new(x, 0.05 + half, 0.0)))?;
        }
    }
    Ok((world, hinges))
}

#[test]
fn the_greater_torque_wins() -> Result<(), Error> {
    let (mut world, hinges) = build()?;
    crate::parts::run(&mut world, 10.0)?;
    // Left: 125 * 1.6 against 250 * 0.4; level: against 250 * 0.8; right: 125 * 1.2 against 250 * 1.2.
    for (hinge, expected) in hinges.into_iter().zip([TILT, 0.0, -TILT]) {
        let angle = world.joint_position(hinge, Motion::Angular, Axes::One(Axis::X))?;
        assert!((angle - expected).abs() < 0.02, "{angle} of {expected} rad");
    }
    Ok(())
}
