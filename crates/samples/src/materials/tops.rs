//! Tops: gyroscopes lean on their points and precess, the faster the slower they spin.

use crate::parts::level_world;
use backstop::glam::{DVec3, Quat, Vec3};
use backstop::{BodyDesc, BodyHandle, Error, Geometry, JointDesc, MassProperties, ShapeDesc, World};

/// Spins [rad/s], and the angle of the axis from upright [rad].
const SPINS: [f32; 4] = [60.0, 90.0, 135.0, 200.0];
const LEAN: f32 = 0.5;
/// Radius and half height of the disc, and its distance from the point [m].
const RADIUS: f32 = 0.4;
const THIN: f32 = 0.06;
const ARM: f32 = 0.5;

/// The tops on their posts.
pub fn start() -> Result<World, Error> {
    Ok(build()?.0)
}

/// How fast a top precesses: m g l / (I w), while that is slow against its spin [rad/s].
fn precession(spin: f32) -> f32 {
    let disc = MassProperties::of(&Geometry::cylinder(THIN, RADIUS), 1000.0);
    disc.mass * 9.81 * ARM / (disc.inertia.y_axis.y * spin)
}

fn build() -> Result<(World, Vec<BodyHandle>), Error> {
    let (mut world, ground) = level_world()?;
    let disc = ShapeDesc::new(Geometry::cylinder(THIN, RADIUS)).with_position(Vec3::Y * ARM);
    let axle = ShapeDesc::new(Geometry::tapered_cylinder(0.25, 0.0, 0.03)).with_density(0.0);
    let axle = axle.with_position(Vec3::Y * 0.25);
    let mut tops = Vec::new();
    for (i, spin) in SPINS.into_iter().enumerate() {
        let point = DVec3::new(1.3 * i as f64 - 1.95, 0.6, 0.0);
        let turned = Quat::from_rotation_z(-LEAN);
        // It begins with its precession, so that it does not nod.
        let spin = turned * Vec3::Y * spin + Vec3::Y * precession(spin);
        let top = BodyDesc::dynamic().with_position(point).with_rotation(turned).with_angular_velocity(spin);
        let top = world.add_body(&top.with_shapes([disc.clone(), axle.clone()]))?;
        let frames = world.frames_about([ground, top], point, Vec3::X)?;
        world.add_joint(&JointDesc::ball([ground, top], frames))?;
        tops.push(top);
    }
    Ok((world, tops))
}

#[test]
fn they_precess_as_the_theory_has_it() -> Result<(), Error> {
    let (mut world, tops) = build()?;
    crate::parts::run(&mut world, 5.0)?;
    let axis = |world: &World, top| world.rotation(top).map(|turned| turned * Vec3::Y);
    let before: Vec<_> = tops.iter().flat_map(|&top| axis(&world, top)).collect();
    crate::parts::run(&mut world, 0.5)?;
    for ((top, before), spin) in tops.into_iter().zip(before).zip(SPINS) {
        let after = axis(&world, top)?;
        assert!((after.y.acos() - LEAN).abs() < 0.1, "it leans by {} rad", after.y.acos());
        let turned = before.with_y(0.0).angle_between(after.with_y(0.0)) / 0.5;
        assert!((turned / precession(spin) - 1.0).abs() < 0.1, "{turned} of {} rad/s", precession(spin));
    }
    Ok(())
}
