//! Springboards: boards of pieces on hinges with springs bend under a weight, the softer the more.

use crate::parts::{fixed, level_world, solid};
use backstop::glam::Vec3;
use backstop::{Axis, BodyHandle, Error, Geometry, JointDesc, Motion, Motor, Spring, World};

const PIECES: usize = 10;
/// Half length of a piece [m].
const HALF: f32 = 0.15;
/// Stiffness of a hinge [N m/rad], and its damping [N m s/rad].
const STIFFNESS: [f32; 3] = [30_000.0, 60_000.0, 120_000.0];
const DAMPING: f32 = 500.0;
const HEIGHT: f32 = 2.5;

/// The boards, level at the start, each with a weight at its end.
pub fn start() -> Result<World, Error> {
    Ok(build()?.0)
}

fn build() -> Result<(World, Vec<BodyHandle>), Error> {
    let (mut world, _) = level_world()?;
    let mut ends = Vec::new();
    for (i, stiffness) in STIFFNESS.into_iter().enumerate() {
        let root = Vec3::new(-1.5, HEIGHT, 1.2 * i as f32 - 1.2);
        let post = fixed(Geometry::cuboid(0.3, 0.5 * HEIGHT, 0.3));
        let mut before = world.add_body(&post.with_position(root - Vec3::new(0.3, 0.5 * HEIGHT, 0.0)))?;
        for piece in 0..PIECES {
            let place = root + Vec3::X * (HALF * (2 * piece + 1) as f32);
            let board = solid(Geometry::cuboid(0.95 * HALF, 0.02, 0.3)).with_position(place);
            let board = world.add_body(&board)?;
            let pair = [before, board];
            let frames = world.frames_about(pair, (place - Vec3::X * HALF).into(), Vec3::Z)?;
            let spring = Spring::Coefficients { stiffness, damping: DAMPING };
            let bend = Motor::position(Motion::Angular, Axis::X, 0.0, spring);
            world.add_joint(&JointDesc::hinge(pair, frames).with_motor(bend))?;
            before = board;
        }
        let end = root + Vec3::X * (2.0 * HALF * PIECES as f32);
        // A cube on the end, welded to it.
        let cube = world.add_body(&solid(Geometry::cuboid(0.12, 0.12, 0.12)).with_position(end))?;
        let frames = world.frames_about([before, cube], end.into(), Vec3::X)?;
        world.add_joint(&JointDesc::fixed([before, cube], frames))?;
        ends.push(cube);
    }
    Ok((world, ends))
}

#[test]
fn twice_as_stiff_bends_half_as_much() -> Result<(), Error> {
    let (mut world, ends) = build()?;
    crate::parts::run(&mut world, 20.0)?;
    let bent = |i: usize| world.position(ends[i]).map(|at| f64::from(HEIGHT) - at.y);
    // In proportion while the angles are small: 16 % and less.
    for i in 0..2 {
        let ratio = bent(i)? / bent(i + 1)?;
        assert!((ratio - 2.0).abs() < 0.2, "{} m, {} m", bent(i)?, bent(i + 1)?);
    }
    Ok(())
}
