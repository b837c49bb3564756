//! Screw: nuts turn down a thread by their own weight, the slower the finer the thread.

use crate::parts::level_world;
use backstop::glam::{DVec3, Vec3};
use backstop::{
    Axes, Axis, BodyDesc, BodyHandle, CouplingDesc, Error, Geometry, JointDesc, Limit, Motion, ShapeDesc,
    World,
};

/// How far a nut travels in a turn [m].
const LEADS: [f32; 4] = [0.1, 0.2, 0.4, 0.8];
const TOP: f64 = 4.0;

/// The nuts at the upper ends of their threads.
pub fn start() -> Result<World, Error> {
    Ok(build()?.0)
}

fn nut() -> Geometry {
    Geometry::cuboid(0.4, 0.1, 0.4)
}

fn build() -> Result<(World, Vec<BodyHandle>), Error> {
    let (mut world, ground) = level_world()?;
    let mut nuts = Vec::new();
    for (i, lead) in LEADS.into_iter().enumerate() {
        let at = DVec3::new(1.2 * i as f64 - 1.8, TOP, 0.0);
        let nut = BodyDesc::dynamic().with_position(at).with_shape(ShapeDesc::new(nut()));
        let nut = world.add_body(&nut)?;
        let frames = world.frames_about([ground, nut], at, Vec3::Y)?;
        // Free to turn about the upright axis and to travel along it.
        let mut thread = JointDesc::new([ground, nut], frames)
            .with_limit(Limit::lock(Motion::Linear, Axes::Perpendicular(Axis::X)))
            .with_limit(Limit::lock(Motion::Angular, Axes::Perpendicular(Axis::X)));
        thread.collide = true;
        let thread = world.add_joint(&thread)?;
        world.add_coupling(&CouplingDesc::screw(thread, lead.into()))?;
        nuts.push(nut);
    }
    Ok((world, nuts))
}

#[test]
fn they_fall_as_heavy_as_their_thread_makes_them() -> Result<(), Error> {
    let (mut world, nuts) = build()?;
    crate::parts::run(&mut world, 2.0)?;
    let own = backstop::MassProperties::of(&nut(), 1000.0);
    for (nut, lead) in nuts.into_iter().zip(LEADS) {
        // To turn by 2 pi a lead adds I (2 pi / lead)² to its mass.
        let acceleration =
            9.81 / (1.0 + own.inertia.y_axis.y * (std::f32::consts::TAU / lead).powi(2) / own.mass);
        let fallen = (TOP - world.position(nut)?.y) as f32;
        let expected = 0.5 * acceleration * 2.0 * 2.0;
        assert!((fallen / expected - 1.0).abs() < 0.02, "{fallen} of {expected} m");
    }
    Ok(())
}
