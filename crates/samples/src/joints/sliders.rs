//! Sliders: beads which start together on chords of a circle arrive at it together (Galileo, 1638).
//! Keys: the action puts the beads back to the top.

use crate::parts::{Driven, fixed, solid};
use backstop::glam::{DVec3, Quat, Vec3};
use backstop::{Axes, Axis, BodyHandle, Error, Geometry, JointDesc, Limit, Motion, Settings, World};

/// Radius of the circle [m], and gravity of the moon, for the eye to follow [m/s²].
const RADIUS: f32 = 2.0;
const GRAVITY: f32 = 1.62;
/// Angles of the chords from the vertical [rad].
const ANGLES: [f32; 7] = [-1.2, -0.8, -0.4, 0.0, 0.4, 0.8, 1.2];
const TOP: DVec3 = DVec3::new(0.0, 4.5, 0.0);

/// The beads at the top.
pub fn start() -> Result<Driven, Error> {
    let (world, beads) = build()?;
    Ok(Driven::new(world, move |world, tick| {
        for &bead in beads.iter().filter(|_| tick.controls.action) {
            world.set_pose(bead, TOP, Quat::IDENTITY)?;
            world.set_velocity(bead, Vec3::ZERO, Vec3::ZERO)?;
        }
        Ok(())
    }))
}

fn build() -> Result<(World, Vec<BodyHandle>), Error> {
    let mut world = World::new(Settings::default().with_gravity(Vec3::NEG_Y * GRAVITY))?;
    let frame =
        world.add_body(&fixed(Geometry::cuboid(0.3, 0.1, 0.1)).with_position(TOP + DVec3::Y * 0.3))?;
    let mut beads = Vec::new();
    for angle in ANGLES {
        let chord = Vec3::new(angle.sin(), -angle.cos(), 0.0);
        // Beads slide through each other at the top.
        let mut bead = solid(Geometry::sphere(0.12)).with_position(TOP);
        bead.shapes[0].filter.group = -1;
        let bead = world.add_body(&bead)?;
        let frames = world.frames_about([frame, bead], TOP, chord)?;
        let way = Limit::new(Motion::Linear, Axes::One(Axis::X), 0.0, 2.0 * RADIUS * angle.cos());
        world.add_joint(&JointDesc::slider([frame, bead], frames).with_limit(way))?;
        beads.push(bead);
    }
    Ok((world, beads))
}

#[test]
fn they_are_on_a_circle_at_all_times() -> Result<(), Error> {
    let (mut world, beads) = build()?;
    for second in 1..=6 {
        crate::parts::run(&mut world, 1.0)?;
        // All have come s = g cos(a) t² / 2 along their chords: a circle of radius g t² / 4 through the top.
        let radius = f64::from((0.25 * GRAVITY * (second * second) as f32).min(RADIUS));
        for &bead in &beads {
            let off = (world.position(bead)? - TOP + DVec3::Y * radius).length() - radius;
            assert!(off.abs() < 0.01 * radius, "{off} m after {second} s");
        }
    }
    Ok(())
}
