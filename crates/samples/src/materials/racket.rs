//! Tennis racket: a body that turns about its middle axis in weightlessness turns over again and again.

use backstop::glam::{DVec3, Quat, Vec3};
use backstop::{BodyDesc, BodyHandle, Error, Geometry, Settings, ShapeDesc, World};

/// Spin [rad/s], and the small turn that begins it.
const SPIN: f32 = 6.0;
const NUDGE: f32 = 0.01;
/// Axes of the least, the middle and the greatest moment of inertia.
const AXES: [Vec3; 3] = [Vec3::X, Vec3::Z, Vec3::Y];

/// Three of them, each about another of its axes.
pub fn start() -> Result<World, Error> {
    Ok(build()?.0)
}

fn build() -> Result<(World, Vec<BodyHandle>), Error> {
    let mut world = World::new(Settings::default().with_gravity(Vec3::ZERO))?;
    let mut handles = Vec::new();
    for (i, axis) in AXES.into_iter().enumerate() {
        // A handle along x, and a head which is wide along z and thin along y.
        let handle = ShapeDesc::new(Geometry::cuboid(0.5, 0.05, 0.05)).with_position(Vec3::X * -0.5);
        let head = ShapeDesc::new(Geometry::cuboid(0.35, 0.05, 0.3)).with_position(Vec3::X * 0.35);
        let racket = BodyDesc::dynamic()
            .with_position(DVec3::new(2.0 * i as f64 - 2.0, 1.5, 0.0))
            .with_rotation(Quat::from_rotation_arc(axis, Vec3::Y))
            .with_angular_velocity(Vec3::new(NUDGE, SPIN, NUDGE))
            .with_shapes([handle, head]);
        handles.push(world.add_body(&racket)?);
    }
    Ok((world, handles))
}

#[test]
fn only_the_middle_axis_turns_over() -> Result<(), Error> {
    let (mut world, rackets) = build()?;
    let energy = world.energy();
    let mut lowest = [1.0_f32; 3];
    for _ in 0..60 * 20 {
        world.step(1.0 / 60.0)?;
        for i in 0..3 {
            lowest[i] = lowest[i].min((world.rotation(rackets[i])? * AXES[i]).y);
        }
    }
    // The axis itself: upright all the time, and upside down at times.
    assert!(lowest[0] > 0.99 && lowest[2] > 0.99 && lowest[1] < -0.9, "{lowest:?}");
    assert!((world.energy() / energy - 1.0).abs() < 1e-3);
    Ok(())
}
