//! Kinematic bodies end exactly where they were told to.

use backstop::glam::{DVec3, Quat, Vec3};
use backstop::{BodyDesc, Geometry, Settings, ShapeDesc, World};

fn table(centre: Vec3) -> BodyDesc {
    let mut shape = ShapeDesc::new(Geometry::cuboid(1.0, 0.2, 0.5));
    shape.position = centre;
    shape.rotation = if centre == Vec3::ZERO { Quat::IDENTITY } else { Quat::from_rotation_z(0.4) };
    BodyDesc::kinematic().at(DVec3::new(1e5, 3.0, -7.0)).with_shape(shape)
}

/// To the bit where another body of the kind is that was put there; around half a turn in a step, far from
/// the origin, at steps of any length and any number of substeps.
#[test]
fn a_kinematic_body_is_where_it_was_told_to_be() {
    for dt in [1.0 / 30.0, 1.0 / 60.0, 1.0 / 144.0, 0.001, 0.25] {
        for (substeps, centre) in [(1, Vec3::ZERO), (4, Vec3::ZERO), (3, Vec3::new(0.3, -0.2, 0.7))] {
            let mut world = World::new(Settings::default().with_substeps(substeps)).unwrap();
            let [moved, put] = [(); 2].map(|()| world.add_body(&table(centre)).unwrap());
            for step in 0..50 {
                let s = f64::from(step);
                let at = DVec3::new(1e5 + (0.1 * s).sin(), 3.0 + 0.03 * s, 0.01 * s * s);
                let turn = Quat::from_axis_angle(Vec3::new(0.6, 0.0, 0.8), 0.061 * step as f32 * step as f32);
                world.move_kinematic(moved, at, turn, dt).unwrap();
                world.step(dt).unwrap();
                world.set_pose(put, at, turn).unwrap();
                assert_eq!(world.position(moved), world.position(put), "dt {dt}, step {step}");
                assert_eq!(world.rotation(moved), world.rotation(put), "dt {dt}, step {step}");
                // Within one rounding of what was asked for.
                let (p, q) = (world.position(moved).unwrap(), world.rotation(moved).unwrap());
                let ulp = if centre == Vec3::ZERO { 0.0 } else { 1e-6 };
                assert!((p - at).abs().max_element() <= ulp, "{p} for {at}");
                assert!(q.dot(turn).abs() > 1.0 - 1e-6, "{q} for {turn}");
            }
        }
    }
}

/// Whoever steps otherwise than was said gets the velocity.
#[test]
fn a_step_of_another_length_goes_on_with_the_velocity() {
    let mut world = World::new(Settings::default()).unwrap();
    let body = world.add_body(&BodyDesc::kinematic()).unwrap();
    world.move_kinematic(body, DVec3::X, Quat::IDENTITY, 0.02).unwrap();
    world.step(0.01).unwrap();
    assert!((world.position(body).unwrap().x - 0.5).abs() < 1e-6);
    // The call was for that step.
    world.step(0.02).unwrap();
    assert!((world.position(body).unwrap().x - 1.5).abs() < 1e-6);
}

#[test]
fn what_is_called_later_counts() {
    let mut world = World::new(Settings::default()).unwrap();
    let body = world.add_body(&BodyDesc::kinematic()).unwrap();
    let go =
        |world: &mut World, x: f64| world.move_kinematic(body, DVec3::X * x, Quat::IDENTITY, 0.02).unwrap();
    go(&mut world, 1.0);
    go(&mut world, 2.0);
    world.step(0.02).unwrap();
    assert_eq!(world.position(body), Ok(DVec3::X * 2.0));
    go(&mut world, 3.0);
    world.set_velocity(body, Vec3::Z, Vec3::ZERO).unwrap();
    world.step(0.02).unwrap();
    assert!((world.position(body).unwrap() - DVec3::new(2.0, 0.0, 0.02)).length() < 1e-6);
    go(&mut world, 5.0);
    world.set_pose(body, DVec3::ZERO, Quat::IDENTITY).unwrap();
    world.set_velocity(body, Vec3::ZERO, Vec3::ZERO).unwrap();
    world.step(0.02).unwrap();
    assert_eq!(world.position(body), Ok(DVec3::ZERO));
}
