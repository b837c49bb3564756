//! Pulleys: of two weights on a rope the heavier one goes down, by g (m1 - m2) / (m1 + m2).

use crate::parts::{fixed, level_world};
use backstop::glam::{DVec3, Quat, Vec3};
use backstop::{BodyDesc, BodyHandle, CouplingDesc, Error, Geometry, JointDesc, ShapeDesc, World};
use std::f32::consts::FRAC_PI_2;

/// Masses at the two ends of each rope [kg].
const PAIRS: [[f32; 2]; 3] = [[10.0, 11.0], [10.0, 15.0], [10.0, 30.0]];
/// Height of the pulleys, and of the weights at the start [m].
const TOP: f64 = 5.0;
const START: f64 = 3.0;
/// Half the distance of the ends of a rope [m].
const APART: f64 = 0.5;

/// Three ropes with their weights.
pub fn start() -> Result<World, Error> {
    Ok(build()?.0)
}

fn build() -> Result<(World, Vec<BodyHandle>), Error> {
    let (mut world, _) = level_world()?;
    let mut heavy = Vec::new();
    for (i, masses) in PAIRS.into_iter().enumerate() {
        let middle = DVec3::new(2.0 * i as f64 - 2.0, TOP, 0.0);
        let wheel = fixed(Geometry::cylinder(0.1, APART as f32)).with_position(middle);
        let wheel = world.add_body(&wheel.with_rotation(Quat::from_rotation_x(FRAC_PI_2)))?;
        let mut ropes = Vec::new();
        for (side, mass) in [-1.0, 1.0].into_iter().zip(masses) {
            // As large as its mass, with the density of water.
            let half = 0.5 * (mass / 1000.0).cbrt();
            let place = DVec3::new(middle.x + side * APART, START, 0.0);
            let cube = ShapeDesc::new(Geometry::cuboid(half, half, half));
            let cube = BodyDesc::dynamic().with_position(place).with_shape(cube);
            let cube = world.add_body(&cube)?;
            let mut frames = world.frames_about([wheel, cube], place, Vec3::X)?;
            // From the edge of the wheel down to the cube.
            frames[0].position = Vec3::X * (side * APART) as f32;
            ropes.push(world.add_joint(&JointDesc::new([wheel, cube], frames))?);
            heavy.push(cube);
        }
        let length = 2.0 * (TOP - START);
        world.add_coupling(&CouplingDesc::pulley([ropes[0], ropes[1]], 1.0, length))?;
    }
    Ok((world, heavy.into_iter().skip(1).step_by(2).collect()))
}

#[test]
fn they_are_as_fast_as_atwood_says() -> Result<(), Error> {
    let (mut world, heavy) = build()?;
    crate::parts::run(&mut world, 0.8)?;
    for (cube, [light, load]) in heavy.into_iter().zip(PAIRS) {
        let expected = 0.8 * 9.81 * (load - light) / (load + light);
        let speed = -world.linear_velocity(cube)?.y;
        assert!((speed - expected).abs() < 0.02 * expected, "{speed} of {expected} m/s");
    }
    Ok(())
}
