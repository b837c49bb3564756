//! Torques act on bodies that turn freely, whatever their moments.

use backstop::glam::Vec3;
use backstop::{BodyDesc, Geometry, Settings, ShapeDesc, World};

/// Expected: `torque / moment * time` about a principal axis, as fast as it may turn already. The moments of
/// the body are all different, so it would go on by itself with the angular velocity that it has.
#[test]
fn a_torque_speeds_up_a_body_that_turns_already() {
    for axis in 0..3 {
        let mut world = World::new(Settings::default().with_gravity(Vec3::ZERO)).unwrap();
        let shape = ShapeDesc::new(Geometry::cuboid(0.8, 0.3, 2.0)).with_density(100.0);
        let body = world.add_body(&BodyDesc::dynamic().with_shape(shape)).unwrap();
        let moment = world.mass_properties(body).unwrap().inertia.col(axis)[axis];
        let mut along = Vec3::ZERO;
        along[axis] = 1.0;
        for _ in 0..60 {
            world.add_torque(body, along * moment).unwrap();
            world.step(1.0 / 60.0).unwrap();
        }
        let spin = world.angular_velocity(body).unwrap();
        assert!((spin - along).length() < 1e-3, "{axis}: {spin}");
    }
}
