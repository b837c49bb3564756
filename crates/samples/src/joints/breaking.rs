//! Breaking joints: shelves bear 20 to 70 kg, until they get weak and those with more than 45 kg break off.

use crate::parts::{Driven, fixed, level_world};
use backstop::glam::{DVec3, Vec3};
use backstop::{BodyDesc, Error, Geometry, JointDesc, JointHandle, ShapeDesc, World};

/// Weights on the shelves [kg].
const LOADS: [f32; 6] = [20.0, 30.0, 40.0, 50.0, 60.0, 70.0];
/// Half length of a shelf [m], and its mass [kg].
const HALF: f32 = 0.5;
const SHELF: f32 = 10.0;
/// The torque at the wall that a weak shelf bears: its own, and 45 kg in its middle [N m].
const STRENGTH: f32 = (SHELF + 45.0) * 9.81 * HALF;
/// When they get weak [s].
const WEAK: f64 = 1.0;
/// Half the edge of a weight [m].
const EDGE: f32 = 0.12;

/// The shelves with their weights.
pub fn start() -> Result<Driven, Error> {
    let (world, joints) = build()?;
    Ok(Driven::new(world, move |world, tick| {
        for &joint in joints.iter().filter(|_| tick.time > WEAK) {
            if world.contains_joint(joint) {
                world.set_joint_break_force(joint, f32::INFINITY, STRENGTH)?;
            }
        }
        Ok(())
    }))
}

fn build() -> Result<(World, Vec<JointHandle>), Error> {
    let (mut world, _) = level_world()?;
    let wall = fixed(Geometry::cuboid(0.1, 1.5, 3.0)).with_position(Vec3::new(-0.1, 1.5, 0.0));
    let wall = world.add_body(&wall)?;
    // A block by its half extents and its mass.
    let block = |half: Vec3, mass: f32, at: DVec3| {
        let density = mass / (8.0 * half.element_product());
        let shape = ShapeDesc::new(Geometry::cuboid(half.x, half.y, half.z)).with_density(density);
        BodyDesc::dynamic().with_position(at).with_shape(shape)
    };
    let mut joints = Vec::new();
    for (i, load) in LOADS.into_iter().enumerate() {
        let at = DVec3::new(HALF.into(), 1.8, 0.9 * i as f64 - 2.25);
        let shelf = world.add_body(&block(Vec3::new(HALF, 0.04, 0.3), SHELF, at))?;
        let frames = world.frames_about([wall, shelf], at - DVec3::X * f64::from(HALF), Vec3::X)?;
        joints.push(world.add_joint(&JointDesc::fixed([wall, shelf], frames))?);
        world.add_body(&block(Vec3::splat(EDGE), load, at + DVec3::Y * f64::from(0.04 + EDGE)))?;
    }
    Ok((world, joints))
}

#[test]
fn half_of_them_break() -> Result<(), Error> {
    let mut sample = start()?;
    crate::parts::run(&mut sample, 5.0)?;
    // 20, 30 and 40 kg are held.
    assert_eq!(crate::Running::world(&sample).joint_count(), 3);
    Ok(())
}
