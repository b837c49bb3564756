//! A body held by a spring to a place.

use backstop::glam::{DVec3, Vec3};
use backstop::{BodyDesc, BodyHandle, Error, Geometry, Grab, GrabSettings, Settings, ShapeDesc, World};

/// A ball of a mass [kg], in free fall unless it is held.
fn ball(mass: f32) -> (World, BodyHandle) {
    let mut world = World::new(Settings::default()).unwrap();
    let radius = 0.1;
    let density = mass / (4.0 / 3.0 * std::f32::consts::PI * radius * radius * radius);
    let shape = ShapeDesc::new(Geometry::sphere(radius)).with_density(density);
    let ball = world.add_body(&BodyDesc::dynamic().with_shape(shape)).unwrap();
    (world, ball)
}

/// A gram and a ton, slow steps and fast ones: each hangs where the spring's force is its weight, which is
/// `g / omega^2` below the target for a spring by frequency, and is at rest.
#[test]
fn light_and_heavy_bodies_hang_at_rest() {
    let sag = 9.81 / (std::f64::consts::TAU * 5.0).powi(2);
    for mass in [1e-3, 1.0, 1e3] {
        for rate in [30, 60, 120] {
            let (mut world, body) = ball(mass);
            let grab = Grab::new(&mut world, body, DVec3::ZERO).unwrap();
            for i in 0..4 * rate {
                // A jerk of a metre after a second.
                if i == rate {
                    grab.move_to(&mut world, DVec3::X).unwrap();
                }
                world.step(1.0 / rate as f32).unwrap();
                let at = world.position(body).unwrap();
                assert!((-0.01..1.01).contains(&at.x) && at.y.abs() < 0.1, "{mass} kg at {rate} Hz: {at}");
            }
            let at = world.position(body).unwrap();
            assert!(at.distance(DVec3::new(1.0, -sag, 0.0)) < 2e-3, "{mass} kg at {rate} Hz: {at}, {sag}");
            assert!(world.linear_velocity(body).unwrap().length() < 1e-3);
            assert!(grab.point(&world).unwrap().distance(at) < 1e-6);
        }
    }
}

/// Expected: the speed of the hand, held and let go, less a little: within a step the spring pulls towards a
/// place that stands still. After that nothing is left of the grab.
#[test]
fn a_body_that_is_let_go_flies_on() {
    for rate in [30, 120] {
        let (mut world, body) = ball(2.0);
        world.set_gravity_scale(body, 0.0).unwrap();
        let grab = Grab::new(&mut world, body, DVec3::ZERO).unwrap();
        for i in 0..rate {
            grab.move_to(&mut world, DVec3::X * (4.0 * f64::from(i) / f64::from(rate))).unwrap();
            world.step(1.0 / rate as f32).unwrap();
        }
        let held = world.linear_velocity(body).unwrap();
        grab.release(&mut world).unwrap();
        assert_eq!((world.body_count(), world.joint_count()), (1, 0));
        world.step(1.0 / rate as f32).unwrap();
        let thrown = world.linear_velocity(body).unwrap();
        assert!((held - thrown).length() < 1e-5 && (thrown - Vec3::X * 4.0).length() < 0.4, "{thrown}");
        assert_eq!(grab.move_to(&mut world, DVec3::ZERO), Err(Error::StaleBody));
        assert_eq!(grab.release(&mut world), Err(Error::StaleBody));
    }
}

/// Expected: half the weight does not lift, twice the weight does.
#[test]
fn the_force_is_bounded_in_multiples_of_the_weight() {
    for (most, lifts) in [(0.5, false), (2.0, true)] {
        let (mut world, body) = ball(50.0);
        let floor = ShapeDesc::new(Geometry::Plane).with_position(Vec3::Y * -0.1);
        world.add_body(&BodyDesc::fixed().with_shape(floor)).unwrap();
        let settings = GrabSettings::default().with_max_force(most);
        let grab = Grab::with_settings(&mut world, body, DVec3::ZERO, &settings).unwrap();
        grab.move_to(&mut world, DVec3::Y * 2.0).unwrap();
        for _ in 0..180 {
            world.step(1.0 / 60.0).unwrap();
        }
        let height = world.position(body).unwrap().y;
        assert_eq!(height > 1.5, lifts, "{height}");
        assert!(lifts || height.abs() < 0.01, "{height}");
    }
}

/// A sleeping body wakes when its grab is moved, and sleeps when that rests.
#[test]
fn a_grab_wakes_its_body() {
    let (mut world, body) = ball(1.0);
    let settings = world.settings().clone().with_sleeping(true);
    world.set_settings(settings).unwrap();
    let grab = Grab::new(&mut world, body, DVec3::ZERO).unwrap();
    for _ in 0..240 {
        world.step(1.0 / 60.0).unwrap();
    }
    assert!(world.is_sleeping(body).unwrap());
    grab.move_to(&mut world, DVec3::ZERO).unwrap();
    assert!(world.is_sleeping(body).unwrap(), "the same place");
    grab.move_to(&mut world, DVec3::Y).unwrap();
    assert!(!world.is_sleeping(body).unwrap());
}

#[test]
fn what_cannot_be_grabbed_is_refused_and_leaves_nothing() {
    let (mut world, body) = ball(1.0);
    let wall = world.add_body(&BodyDesc::fixed()).unwrap();
    assert_eq!(Grab::new(&mut world, wall, DVec3::ZERO), Err(Error::JointOfStill));
    assert!(Grab::new(&mut world, body, DVec3::X * 1e8).is_err());
    assert!(Grab::new(&mut world, body, DVec3::NAN).is_err());
    let settings = GrabSettings::default();
    for bad in [settings.with_hertz(-1.0), settings.with_max_force(f32::NAN)] {
        assert!(Grab::with_settings(&mut world, body, DVec3::ZERO, &bad).is_err());
    }
    assert_eq!((world.body_count(), world.joint_count()), (2, 0));
    world.remove_body(wall).unwrap();
    assert_eq!(Grab::new(&mut world, wall, DVec3::ZERO), Err(Error::StaleBody));
}
