//! Windmill: a motor turns four sails which throw up the balls that fall among them.

use backstop::glam::{DVec3, Quat, Vec3};
use backstop::{
    Axis, BodyDesc, BodyHandle, Error, Geometry, JointDesc, Material, Motion, Motor, Settings, ShapeDesc,
    World,
};
use std::f32::consts::FRAC_PI_2;

/// Speed of the sails [rad/s].
const SPEED: f32 = 1.5;

/// The mill on its post, and twenty balls above.
pub fn start() -> Result<World, Error> {
    Ok(build()?.0)
}

fn build() -> Result<(World, BodyHandle), Error> {
    let mut world = World::new(Settings::default())?;
    let ground = world.add_body(&BodyDesc::fixed().with_shape(ShapeDesc::new(Geometry::plane())))?;
    let sail = ShapeDesc::new(Geometry::cuboid(2.0, 0.1, 0.3)).with_density(100.0);
    let hub = BodyDesc::dynamic()
        .with_position(Vec3::Y * 3.0)
        .with_shape(sail.clone())
        .with_shape(sail.with_rotation(Quat::from_rotation_z(FRAC_PI_2)));
    let hub = world.add_body(&hub)?;
    // A hinge turns about the x of its frames: here the z of the world.
    let frames = world.frames_at([ground, hub], DVec3::Y * 3.0, Quat::from_rotation_y(-FRAC_PI_2))?;
    let motor = Motor::velocity(Motion::Angular, Axis::X, SPEED, 5_000.0);
    world.add_joint(&JointDesc::hinge([ground, hub], frames).with_motor(motor))?;
    // Balls come to rest where they fall.
    let felt = Material::default().with_rolling_friction(0.03);
    for i in 0..20 {
        let place = Vec3::new(0.3 * (i % 10) as f32 - 1.5, 6.0 + 0.6 * (i / 10) as f32, 0.0);
        let ball = ShapeDesc::new(Geometry::sphere(0.2)).with_density(50.0).with_material(felt);
        world.add_body(&BodyDesc::dynamic().with_position(place).with_shape(ball))?;
    }
    Ok((world, hub))
}

#[test]
fn the_sails_keep_their_speed() -> Result<(), Error> {
    let (mut world, hub) = build()?;
    for _ in 0..60 * 10 {
        world.step(1.0 / 60.0)?;
    }
    let spin = world.angular_velocity(hub)?.z;
    assert!((spin - SPEED).abs() < 0.05 * SPEED, "{spin} rad/s");
    Ok(())
}
