//! Bridge: planks on hinges hang between two banks and carry boxes which fall on them.

use crate::parts::{fixed, level_world, solid};
use backstop::glam::{Quat, Vec3};
use backstop::{Error, Geometry, JointDesc, JointHandle, World};

const PLANKS: usize = 20;
/// Height of the banks, radius of the arc on which the planks hang [m], and the angle of one [rad].
const HEIGHT: f32 = 2.5;
const RADIUS: f32 = 8.0;
const STEP: f32 = 0.055;

/// The bridge, and the boxes above it.
pub fn start() -> Result<World, Error> {
    Ok(build()?.0)
}

/// A place on the arc, counted in planks from the left bank, and the slope there.
fn arc(planks: f32) -> (Vec3, Quat) {
    let (end, angle) = (0.5 * STEP * PLANKS as f32, STEP * (planks - 0.5 * PLANKS as f32));
    let place = Vec3::new(RADIUS * angle.sin(), HEIGHT + RADIUS * (end.cos() - angle.cos()), 0.0);
    (place, Quat::from_rotation_z(angle))
}

fn build() -> Result<(World, Vec<JointHandle>), Error> {
    let (mut world, _) = level_world()?;
    let bank = fixed(Geometry::cuboid(1.0, 0.5 * HEIGHT, 1.2));
    let half_way = Vec3::new(arc(PLANKS as f32).0.x + 1.0, 0.5 * HEIGHT, 0.0);
    let mut bodies = vec![world.add_body(&bank.clone().with_position(half_way * Vec3::new(-1.0, 1.0, 1.0)))?];
    for i in 0..PLANKS {
        let (place, slope) = arc(i as f32 + 0.5);
        let plank = solid(Geometry::cuboid(0.46 * STEP * RADIUS, 0.05, 0.9));
        bodies.push(world.add_body(&plank.with_position(place).with_rotation(slope))?);
    }
    bodies.push(world.add_body(&bank.with_position(half_way))?);
    let mut hinges = Vec::new();
    for (i, pair) in bodies.windows(2).enumerate() {
        let pair = [pair[0], pair[1]];
        let frames = world.frames_about(pair, arc(i as f32).0.into(), Vec3::Z)?;
        hinges.push(world.add_joint(&JointDesc::hinge(pair, frames))?);
    }
    let cube = solid(Geometry::cuboid(0.25, 0.25, 0.25));
    for i in 0..8 {
        world.add_body(&cube.clone().with_position(Vec3::new(0.8 * i as f32 - 2.8, 4.0, 0.0)))?;
    }
    Ok((world, hinges))
}

#[test]
fn it_holds() -> Result<(), Error> {
    let (mut world, hinges) = build()?;
    crate::parts::run(&mut world, 15.0)?;
    for hinge in hinges {
        let [(a, _), (b, _)] = world.joint_frames(hinge)?;
        assert!((b - a).length() < 0.001, "{} m", (b - a).length());
    }
    let low = |&body: &_| world.position(body).is_ok_and(|at| at.y < 0.5);
    assert_eq!(world.bodies().filter(low).count(), 1, "nothing but the ground is low");
    Ok(())
}
