//! Ropes: a ball of 60 kg hangs on links of ball joints, and its twin on a single distance joint.

use crate::parts::{fixed, level_world};
use backstop::glam::{DVec3, Vec3};
use backstop::{BodyDesc, BodyHandle, Error, Frame, Geometry, JointDesc, ShapeDesc, World};

const LINKS: usize = 16;
/// Length of a link, and of a rope [m].
const LINK: f32 = 0.25;
const LENGTH: f32 = LINK * LINKS as f32;
/// Mass of a link, and of the ball at the end [kg].
const LIGHT: f32 = 2.0;
const HEAVY: f32 = 60.0;
const HOOK: DVec3 = DVec3::new(0.0, 5.0, 0.0);

/// Both ropes, stretched out to the side.
pub fn start() -> Result<World, Error> {
    Ok(build()?.0)
}

fn build() -> Result<(World, [BodyHandle; 2]), Error> {
    let (mut world, _) = level_world()?;
    let beam = world.add_body(&fixed(Geometry::cuboid(0.1, 0.1, 1.2)).with_position(HOOK))?;
    let rod = Geometry::cuboid(0.45 * LINK, 0.03, 0.03);
    let rod = ShapeDesc::new(rod).with_density(LIGHT / (3.6 * LINK * 0.03 * 0.03));
    let ball = ShapeDesc::new(Geometry::sphere(0.25)).with_density(HEAVY / 0.0654);
    // Links along x; the ball is at the outer end of the last.
    let mut before = (beam, Frame::at(Vec3::NEG_Z));
    for i in 0..=LINKS {
        let shape = if i < LINKS { rod.clone() } else { ball.clone() };
        let half = if i < LINKS { 0.5 * LINK } else { 0.0 };
        let place = HOOK + DVec3::new((LINK * i as f32 + half).into(), 0.0, -1.0);
        let link = world.add_body(&BodyDesc::dynamic().with_position(place).with_shape(shape))?;
        let frames = [before.1, Frame::at(Vec3::X * -half)];
        world.add_joint(&JointDesc::ball([before.0, link], frames))?;
        before = (link, Frame::at(Vec3::X * half));
    }
    let place = HOOK + DVec3::new(LENGTH.into(), 0.0, 1.0);
    let twin = world.add_body(&BodyDesc::dynamic().with_position(place).with_shape(ball))?;
    let frames = [Frame::at(Vec3::Z), Frame::default()];
    world.add_joint(&JointDesc::distance([beam, twin], frames, 0.0, LENGTH))?;
    Ok((world, [before.0, twin]))
}

#[test]
fn both_keep_their_length() -> Result<(), Error> {
    let (mut world, balls) = build()?;
    for _ in 0..60 * 10 {
        world.step(1.0 / 60.0)?;
        for (ball, z) in balls.into_iter().zip([-1.0, 1.0]) {
            let length = (world.position(ball)? - HOOK - DVec3::Z * z).length();
            assert!(length < f64::from(LENGTH) + 0.002, "{length} m");
        }
    }
    Ok(())
}
