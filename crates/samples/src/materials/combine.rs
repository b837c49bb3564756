//! Combining: friction of 0.9 and 0.3 becomes 0.6, 0.3, 0.9 or 0.27, and a slope of 0.5 tells which hold.

use crate::parts::{fixed, level_world};
use backstop::glam::{Quat, Vec3};
use backstop::{BodyDesc, BodyHandle, Combine, Error, Geometry, Material, ShapeDesc, World};

/// The rules, and whether a block holds by them.
const RULES: [(Combine, bool); 4] = [
    (Combine::Average, true),
    (Combine::Minimum, false),
    (Combine::Maximum, true),
    (Combine::Multiply, false),
];
/// Coefficients of blocks and slopes.
const BLOCK: f32 = 0.9;
const SLOPE: f32 = 0.3;
/// The tangent of the slopes' angle.
const TANGENT: f32 = 0.5;

/// A slope with a block for each rule.
pub fn start() -> Result<World, Error> {
    Ok(build()?.0)
}

fn build() -> Result<(World, Vec<BodyHandle>), Error> {
    let (mut world, _) = level_world()?;
    let turned = Quat::from_rotation_z(-TANGENT.atan());
    let mut blocks = Vec::new();
    for (i, (rule, _)) in RULES.into_iter().enumerate() {
        let rough = |mu: f32| Material::default().with_friction(mu).with_friction_combine(rule);
        let middle = Vec3::new(0.0, 1.6, 1.2 * i as f32 - 1.8);
        let mut slope = fixed(Geometry::cuboid(3.0, 0.1, 0.5));
        slope.shapes[0].material = rough(SLOPE);
        world.add_body(&slope.with_position(middle).with_rotation(turned))?;
        let block = ShapeDesc::new(Geometry::cuboid(0.3, 0.2, 0.3)).with_material(rough(BLOCK));
        let place = middle + turned * Vec3::new(-2.2, 0.3, 0.0);
        let block = BodyDesc::dynamic().with_position(place).with_rotation(turned).with_shape(block);
        blocks.push(world.add_body(&block)?);
    }
    Ok((world, blocks))
}

#[test]
fn two_hold() -> Result<(), Error> {
    let (mut world, blocks) = build()?;
    let before: Vec<_> = blocks.iter().flat_map(|&block| world.position(block)).collect();
    crate::parts::run(&mut world, 5.0)?;
    for ((block, before), (rule, holds)) in blocks.into_iter().zip(before).zip(RULES) {
        let way = (world.position(block)? - before).length();
        assert!((way < 0.01) == holds, "{rule:?}: {way} m");
    }
    Ok(())
}
