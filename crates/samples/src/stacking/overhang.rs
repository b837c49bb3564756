//! Overhang: bricks of one metre reach out by more than a metre over the edge of a table.

use crate::parts::{fixed, level_world, solid};
use backstop::glam::Vec3;
use backstop::{BodyHandle, Error, Geometry, World};

const BRICKS: usize = 10;
/// Half extents of a brick [m].
const BRICK: Vec3 = Vec3::new(0.5, 0.1, 0.25);
/// Height of the table [m], whose edge is at x = 0.
const TABLE: f32 = 1.0;
/// Share of the greatest overhang that a pile can have.
const SAFE: f32 = 0.97;
const TOO_FAR: f32 = 1.03;

/// Two piles: the one in front reaches too far to stand.
pub fn start() -> Result<World, Error> {
    Ok(build()?.0)
}

fn build() -> Result<(World, [BodyHandle; 2]), Error> {
    let (mut world, _) = level_world()?;
    let table = fixed(Geometry::cuboid(1.5, 0.5 * TABLE, 1.5));
    world.add_body(&table.with_position(Vec3::new(-1.5, 0.5 * TABLE, 0.0)))?;
    let highest = [add_pile(&mut world, SAFE, -0.8)?, add_pile(&mut world, TOO_FAR, 0.8)?];
    Ok((world, highest))
}

/// From the top down, the k-th brick may reach 1 / (2 k) of its length beyond the one below: then the centre
/// of mass of all above is over the edge. Returns the highest brick.
fn add_pile(world: &mut World, share: f32, z: f32) -> Result<BodyHandle, Error> {
    let mut middle = -BRICK.x;
    let mut highest = None;
    for below in (1..=BRICKS).rev() {
        middle += share * BRICK.x / below as f32;
        let y = TABLE + BRICK.y * (2 * (BRICKS - below) + 1) as f32;
        let brick = solid(Geometry::cuboid(BRICK.x, BRICK.y, BRICK.z));
        highest = Some(world.add_body(&brick.with_position(Vec3::new(middle, y, z)))?);
    }
    Ok(highest.expect("there are bricks"))
}

#[test]
fn one_pile_stands_and_one_falls() -> Result<(), Error> {
    let (mut world, [stands, falls]) = build()?;
    crate::parts::run(&mut world, 20.0)?;
    // 0.97 (1 + 1/2 + ... + 1/10) / 2 m from the edge to the end of the highest brick: 1.42 m.
    let end = world.position(stands)?.x as f32 + BRICK.x;
    assert!((end - 1.4205).abs() < 0.03, "{end} m");
    assert!((world.position(stands)?.y - 2.9).abs() < 0.02);
    assert!(world.position(falls)?.y < 1.0);
    Ok(())
}
