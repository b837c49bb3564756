//! The car of `examples/vehicle.rs` behaves as a car: its springs bear it by Hooke's law, it reaches its
//! speed, goes where it is steered, and stays on its wheels.

#[path = "../../examples/vehicle.rs"]
#[allow(dead_code, reason = "its `main` is not for tests")]
mod car;

use backstop::glam::{DVec3, Vec3};
use backstop::{BodyDesc, Geometry, Settings, ShapeDesc, World};
use car::{Car, HUB, MASS, RADIUS, STIFFNESS, run};

fn plain() -> (World, Car) {
    let mut world = World::new(Settings::default()).unwrap();
    world.add_body(&BodyDesc::fixed().with_shape(ShapeDesc::new(Geometry::Plane))).unwrap();
    let height = f64::from(RADIUS - HUB.y);
    let car = Car::add_to(&mut world, DVec3::Y * height).unwrap();
    run(&mut world, &car, 3.0, 0.0, 400.0, 0.0).unwrap();
    (world, car)
}

fn up(world: &World, car: &Car) -> f32 {
    (world.rotation(car.chassis).unwrap() * Vec3::Y).y
}

#[test]
fn at_rest_its_springs_give_way_by_a_quarter_of_its_weight() {
    let (world, car) = plain();
    let sinks = f64::from(MASS * 9.81 / (4.0 * STIFFNESS));
    for wheel in car.wheels {
        let hub = world.position(wheel).unwrap().y - world.position(car.chassis).unwrap().y;
        assert!((hub - f64::from(HUB.y) - sinks).abs() < 1e-3, "{hub}: {sinks}");
        assert!((world.position(wheel).unwrap().y - f64::from(RADIUS)).abs() < 1e-3);
    }
    assert!(up(&world, &car) > 0.999_99);
    assert!(world.linear_velocity(car.chassis).unwrap().length() < 1e-2);
}

#[test]
fn it_reaches_its_speed_straight_ahead_and_its_wheels_roll() {
    let (mut world, car) = plain();
    // 4 x 400 N m at 0.4 m are 4000 N: 3.4 m/s² for 1130 kg and the spin of the wheels, as if 50 kg more.
    let [speed, ..] = run(&mut world, &car, 2.0, 20.0, 400.0, 0.0).unwrap();
    assert!((speed - 6.8).abs() < 0.3, "{speed}");
    let [speed, _, down] = run(&mut world, &car, 13.0, 20.0, 400.0, 0.0).unwrap();
    assert!((speed - 20.0).abs() < 0.1, "{speed}");
    assert!(down == 1.0 && up(&world, &car) > 0.999);
    let aside = world.position(car.chassis).unwrap().x;
    assert!(aside.abs() < 0.5, "{aside}");
    for wheel in car.wheels {
        let spin = world.angular_velocity(wheel).unwrap().x * RADIUS;
        assert!((f64::from(spin) - speed).abs() < 0.1, "{spin}");
    }
}

/// On a circle of the radius that its axles span: wheelbase over the tangent of the steering angle.
#[test]
fn it_goes_round_and_does_not_tip() {
    let (mut world, car) = plain();
    run(&mut world, &car, 5.0, 6.0, 400.0, 0.0).unwrap();
    run(&mut world, &car, 3.0, 6.0, 400.0, 0.2).unwrap();
    let turn = world.angular_velocity(car.chassis).unwrap().y;
    let speed = world.linear_velocity(car.chassis).unwrap().length();
    let tangent = 0.202_71; // of 0.2
    let expected = speed * tangent / (2.0 * HUB.z);
    assert!((turn / expected - 1.0).abs() < 0.15, "{turn}: {expected}");
    assert!(up(&world, &car) > 0.99);
    // Hard, at speed: friction ends before it tips.
    let [_, _, down] = run(&mut world, &car, 6.0, 20.0, 400.0, 0.35).unwrap();
    assert!(up(&world, &car) > 0.9 && down > 0.9, "{down}");
}

/// From where the ground allows it: of starts within half a metre beside x = 0 half overturn at the first
/// hill, at 40 substeps too. Expected of eight starts a few centimetres apart.
#[test]
fn over_hills_it_stays_on_its_wheels() {
    for start in 0..8 {
        let mut world = World::new(Settings::default()).unwrap();
        let ground = f64::from(car::hills(&mut world).unwrap());
        let at = DVec3::new(-5.0 + 0.03 * f64::from(start), ground + 1.7, -50.0);
        let car = Car::add_to(&mut world, at).unwrap();
        run(&mut world, &car, 2.0, 0.0, 400.0, 0.0).unwrap();
        let [_, way, down] = run(&mut world, &car, 8.0, 8.0, 1000.0, 0.0).unwrap();
        println!("{start}: {way} m, all wheels down for {down} of the time");
        assert!(way > 20.0 && up(&world, &car) > 0.5, "{start}: {way}");
    }
}
