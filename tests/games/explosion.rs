//! Explosions push what is near, once.

use backstop::glam::{DVec3, Vec3};
use backstop::{BodyDesc, BodyHandle, Error, Explosion, Filter, Geometry, Settings, ShapeDesc, World};

fn world() -> World {
    World::new(Settings::default().with_gravity(Vec3::ZERO)).unwrap()
}

/// A cube of side 1 m and 1000 kg.
fn cube(world: &mut World, at: DVec3) -> BodyHandle {
    let shape = ShapeDesc::new(Geometry::cuboid(0.5, 0.5, 0.5)).with_density(1000.0);
    world.add_body(&BodyDesc::dynamic().with_position(at).with_shape(shape)).unwrap()
}

/// 2000 N s/m² up to 2 m, nothing from 6 m on.
fn blast() -> Explosion {
    Explosion::default().with_radius(2.0).with_falloff(4.0).with_impulse_per_area(2000.0)
}

/// Expected: 2 m/s within the radius, half of it in the middle of the falloff, none beyond; away from the
/// centre, without a turn.
#[test]
fn the_impulse_falls_with_the_distance() {
    let mut world = world();
    let near = cube(&mut world, DVec3::X * 2.0);
    let middle = cube(&mut world, DVec3::Y * -4.5);
    let far = cube(&mut world, DVec3::Z * 7.0);
    assert_eq!(world.apply_explosion(&blast()).unwrap(), 2);
    let expected = [(near, Vec3::X * 2.0), (middle, -Vec3::Y), (far, Vec3::ZERO)];
    for (body, velocity) in expected {
        assert!((world.linear_velocity(body).unwrap() - velocity).length() < 1e-5);
        assert!(world.angular_velocity(body).unwrap().length() < 1e-5);
    }
    // The centre within a body pushes it as a whole.
    let inside = blast().with_position(DVec3::X * 1.9);
    assert_eq!(world.apply_explosion(&inside).unwrap(), 2);
    assert!((world.linear_velocity(near).unwrap() - Vec3::X * 4.0).length() < 1e-4);
}

/// A blast at the foot of a column turns it over: the push is at the nearest point.
#[test]
fn a_push_off_the_centre_turns() {
    let mut world = world();
    let shape = ShapeDesc::new(Geometry::cuboid(0.2, 2.0, 0.2));
    let column =
        world.add_body(&BodyDesc::dynamic().with_position(DVec3::Y * 2.0).with_shape(shape)).unwrap();
    world.apply_explosion(&blast().with_position(DVec3::new(-1.0, 0.5, 0.0))).unwrap();
    // Below the middle and along +x: about +z.
    assert!(world.angular_velocity(column).unwrap().z > 0.1);
}

/// Expected: behind a wall nothing moves; above a low wall the rest is seen.
#[test]
fn walls_give_shelter_if_asked() {
    for (height, occluded, pushed) in [(3.0, true, 0), (3.0, false, 1), (0.25, true, 1)] {
        let mut world = world();
        let wall = ShapeDesc::new(Geometry::cuboid(0.05, height, 3.0));
        world.add_body(&BodyDesc::fixed().with_position(DVec3::X).with_shape(wall)).unwrap();
        cube(&mut world, DVec3::new(2.0, 0.5, 0.0));
        let blast = blast().with_position(DVec3::Y * 1.0).with_occluded(occluded);
        assert_eq!(world.apply_explosion(&blast).unwrap(), pushed, "{height} {occluded}");
    }
}

#[test]
fn a_filter_a_body_and_what_does_not_move_are_spared() {
    let mut world = world();
    let bomb = cube(&mut world, DVec3::ZERO);
    cube(&mut world, DVec3::X * 2.0);
    let fixed = ShapeDesc::new(Geometry::sphere(0.5));
    world.add_body(&BodyDesc::fixed().with_position(DVec3::Y * 2.0).with_shape(fixed.clone())).unwrap();
    world.add_body(&BodyDesc::kinematic().with_position(DVec3::Y * -2.0).with_shape(fixed)).unwrap();
    assert_eq!(world.apply_explosion(&blast().with_exclude_body(bomb)).unwrap(), 1);
    let none = Filter::default().with_mask(0);
    assert_eq!(world.apply_explosion(&blast().with_filter(none)).unwrap(), 0);
}

/// One body that can't take it: none is pushed.
#[test]
fn a_refused_explosion_pushes_nobody() {
    let mut world = world();
    let heavy = cube(&mut world, DVec3::X * 2.0);
    let light = ShapeDesc::new(Geometry::sphere(0.5)).with_density(1e-9);
    world.add_body(&BodyDesc::dynamic().with_position(DVec3::X * -2.0).with_shape(light)).unwrap();
    let before = world.state_hash();
    assert!(matches!(world.apply_explosion(&blast()), Err(Error::OutOfRange { .. })));
    let bad = [
        blast().with_radius(-1.0),
        blast().with_falloff(f32::NAN),
        blast().with_impulse_per_area(f32::INFINITY),
        blast().with_position(DVec3::NAN),
    ];
    for bad in bad {
        assert!(world.apply_explosion(&bad).is_err());
    }
    assert_eq!(world.state_hash(), before);
    assert_eq!(world.linear_velocity(heavy).unwrap(), Vec3::ZERO);
}

/// Expected: the order in which bodies were added is none of the result's business.
#[test]
fn the_order_of_bodies_does_not_count() {
    let places = [DVec3::X * 2.0, DVec3::Y * 3.0, DVec3::new(1.0, 1.0, 2.0)];
    let run = |order: [usize; 3]| {
        let mut world = world();
        let mut bodies = [None; 3];
        for i in order {
            bodies[i] = Some(cube(&mut world, places[i]));
        }
        assert_eq!(world.apply_explosion(&blast()).unwrap(), 3);
        bodies.map(|body| world.linear_velocity(body.unwrap()).unwrap())
    };
    assert_eq!(run([0, 1, 2]), run([2, 0, 1]));
}
