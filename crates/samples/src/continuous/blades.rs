//! Blades: at 10 to 180 turns a second they rattle between the two sides of a post and never jump over it.

use crate::parts::{fixed, level_world};
use backstop::glam::{DVec3, Quat, Vec3};
use backstop::{
    BodyDesc, BodyHandle, ContinuousMode, Error, Geometry, JointDesc, Material, ShapeDesc, World,
};
use std::f32::consts::TAU;

/// Turns a second: in steps of 1/60 s the blades come by the same angles again and again, none of them at a
/// post.
const TURNS: [f32; 6] = [10.0, 20.0, 30.0, 60.0, 120.0, 180.0];
/// Half the length of a blade, and where on it the post is [m].
const HALF: f32 = 0.9;
const POST: f32 = 0.7;
/// Share of the speed that comes back from a post.
const RESTITUTION: f32 = 0.7;

/// The blades, each on a hinge and with a post in its circle.
pub fn start() -> Result<World, Error> {
    Ok(build(ContinuousMode::Volume)?.0)
}

fn build(mode: ContinuousMode) -> Result<(World, Vec<BodyHandle>), Error> {
    let (mut world, ground) = level_world()?;
    let bouncy = Material::default().with_restitution(RESTITUTION).with_friction(0.0);
    let mut blades = Vec::new();
    for (i, turns) in TURNS.into_iter().enumerate() {
        let at = DVec3::new(2.1 * (i % 3) as f64 - 2.1, 1.0, 2.1 * (i / 3) as f64 - 1.0);
        let mut post = fixed(Geometry::cylinder(0.5, 0.03));
        post.shapes[0].material = bouncy;
        world.add_body(&post.with_position(at + DVec3::X * f64::from(POST) - DVec3::Y * 0.4))?;
        let shape = ShapeDesc::new(Geometry::cuboid(HALF, 0.04, 0.01)).with_material(bouncy);
        let blade = BodyDesc::dynamic()
            .with_position(at)
            .with_rotation(Quat::from_rotation_y(0.5))
            .with_angular_velocity(Vec3::Y * TAU * turns)
            .with_continuous(mode)
            .with_shape(shape);
        let blade = world.add_body(&blade)?;
        let frames = world.frames_about([ground, blade], at, Vec3::Y)?;
        world.add_joint(&JointDesc::hinge([ground, blade], frames))?;
        blades.push(blade);
    }
    Ok((world, blades))
}

#[test]
fn all_meet_their_posts_and_discrete_ones_none() -> Result<(), Error> {
    for (mode, meets) in [(ContinuousMode::Volume, true), (ContinuousMode::Discrete, false)] {
        let (mut world, blades) = build(mode)?;
        crate::parts::run(&mut world, 10.0)?;
        for (blade, turns) in blades.into_iter().zip(TURNS) {
            // Ten impacts leave less than a thirtieth of the speed.
            let left = world.angular_velocity(blade)?.y / (TAU * turns);
            assert_eq!(left.abs() < 0.03, meets, "{turns} turns a second: {left} is left, {mode:?}");
        }
    }
    Ok(())
}
