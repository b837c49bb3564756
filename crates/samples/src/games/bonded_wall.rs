//! Destruction: blocks joined by welds that break stand as a wall, until a ball goes through.

use crate::parts::{lawn, solid};
use backstop::glam::{DVec3, Vec3};
use backstop::{BodyDesc, BodyHandle, Error, Geometry, JointDesc, ShapeDesc, World};

const ROWS: usize = 9;
const COLUMNS: usize = 14;
/// Half the edge of a block [m].
const HALF: f32 = 0.2;
/// Force [N] and torque [N m] above which a weld breaks.
const FORCE: f32 = 40_000.0;
const TORQUE: f32 = 8_000.0;

/// The wall, and the ball on its way.
pub fn start() -> Result<World, Error> {
    build(15.0)
}

fn build(speed: f32) -> Result<World, Error> {
    let (mut world, _) = lawn()?;
    let mut blocks: Vec<BodyHandle> = Vec::new();
    for i in 0..ROWS * COLUMNS {
        let (row, column) = (i / COLUMNS, i % COLUMNS);
        let middle = 0.5 * (COLUMNS - 1) as f32;
        let at = HALF * Vec3::new(2.0 * (column as f32 - middle), (2 * row + 1) as f32, 0.0);
        let block = world.add_body(&solid(Geometry::cuboid(HALF, HALF, HALF)).with_position(at))?;
        // To the neighbours on the left and below, in the middle of the common face.
        let left = (column > 0).then(|| (blocks[i - 1], Vec3::X));
        let below = (row > 0).then(|| (blocks[i - COLUMNS], Vec3::Y));
        for (neighbour, way) in left.into_iter().chain(below) {
            let face: DVec3 = (at - HALF * way).into();
            let frames = world.frames_about([neighbour, block], face, way)?;
            let weld = JointDesc::fixed([neighbour, block], frames);
            world.add_joint(&weld.with_break_force(FORCE, TORQUE))?;
        }
        blocks.push(block);
    }
    let iron = ShapeDesc::new(Geometry::sphere(0.25)).with_density(7_900.0);
    let ball = BodyDesc::dynamic()
        .with_position(Vec3::new(0.3, 1.6, 5.0))
        .with_linear_velocity(Vec3::new(0.0, 1.5, -speed))
        .with_shape(iron);
    world.add_body(&ball)?;
    Ok(world)
}

#[test]
fn it_stands_until_it_is_hit() -> Result<(), Error> {
    let all = ROWS * (COLUMNS - 1) + COLUMNS * (ROWS - 1);
    let mut quiet = build(0.0)?;
    crate::parts::run(&mut quiet, 5.0)?;
    assert_eq!(quiet.joint_count(), all);
    let mut hit = start()?;
    crate::parts::run(&mut hit, 5.0)?;
    // A hole: at least the twelve welds of the four blocks that the ball covers, and not most of the wall.
    let broken = all - hit.joint_count();
    assert!(broken >= 12 && broken < all * 2 / 3, "{broken} of {all}");
    Ok(())
}
