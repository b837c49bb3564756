//! Water, wind and attractors against their formulas.

use backstop::fields::{Attractor, Fluid, Wind};
use backstop::glam::{DVec3, Vec3};
use backstop::{BodyDesc, BodyHandle, Filter, Geometry, Settings, ShapeDesc, World};

const G: f32 = 9.81;

fn body(world: &mut World, at: DVec3, geometry: Geometry, density: f32) -> BodyHandle {
    let shape = ShapeDesc::new(geometry).with_density(density);
    world.add_body(&BodyDesc::dynamic().with_position(at).with_shape(shape)).unwrap()
}

fn run(world: &mut World, seconds: f32, rate: u32, mut act: impl FnMut(&mut World, f32)) {
    let dt = 1.0 / rate as f32;
    for _ in 0..(seconds * rate as f32) as u32 {
        act(world, dt);
        world.step(dt).unwrap();
    }
}

/// Expected, of half the density of water: half of it is under water, whatever the shape; a quarter of the
/// density: a quarter of a box. All are at rest.
#[test]
fn half_as_dense_floats_half_under_water() {
    for rate in [30, 60, 120] {
        let mut world = World::new(Settings::default()).unwrap();
        let shapes = [Geometry::cuboid(0.5, 0.5, 0.5), Geometry::sphere(0.5), Geometry::capsule(0.3, 0.4)];
        let mut all = Vec::new();
        for (i, shape) in shapes.into_iter().enumerate() {
            all.push((body(&mut world, DVec3::new(3.0 * i as f64, 0.4, 0.0), shape, 500.0), 0.0));
        }
        let box_ = Geometry::cuboid(0.5, 0.2, 0.5);
        all.push((body(&mut world, DVec3::new(-3.0, 0.0, 0.0), box_, 250.0), 0.1));
        let water = Fluid::default();
        run(&mut world, 40.0, rate, |world, dt| assert!(water.apply_to(world, dt).unwrap() <= 4));
        for (body, height) in all {
            let at = world.position(body).unwrap();
            assert!((at.y - height).abs() < 5e-3, "{rate} Hz: {at}, not {height}");
            let (linear, angular) = (world.linear_velocity(body), world.angular_velocity(body));
            let speeds = (linear.unwrap().length(), angular.unwrap().length());
            assert!(speeds.0 < 1e-2 && speeds.1 < 1e-2, "{rate} Hz: {height}, {speeds:?}");
        }
    }
}

/// Expected: what is denser sinks, a filter and a box leave things alone, a light ball drifts with the flow,
/// and waves lift.
#[test]
fn water_has_a_place_a_flow_and_waves() {
    let mut world = World::new(Settings::default()).unwrap();
    let ball = |world: &mut World, x: f64, density| body(world, DVec3::X * x, Geometry::sphere(0.5), density);
    let (stone, cork) = (ball(&mut world, 0.0, 3000.0), ball(&mut world, 4.0, 200.0));
    let outside = ball(&mut world, 20.0, 200.0);
    let pool = Fluid::default().with_min([-10.0, -50.0, -10.0]).with_max([10.0, 0.0, 10.0]);
    let pool = pool.with_flow(Vec3::Z * 0.5);
    assert_eq!(pool.with_filter(Filter::default().with_mask(0)).apply_to(&mut world, 0.01).unwrap(), 0);
    run(&mut world, 6.0, 60, |world, dt| assert!(pool.apply_to(world, dt).unwrap() <= 2));
    assert!(world.position(stone).unwrap().y < -5.0 && world.position(outside).unwrap().y < -40.0);
    let drift = world.linear_velocity(cork).unwrap();
    assert!((drift.z - 0.5).abs() < 0.1, "{drift}");
    let high = pool.with_max([10.0, 3.0, 10.0]);
    run(&mut world, 6.0, 60, |world, dt| {
        high.apply_with_waves(world, dt, |_, _| 2.0).unwrap();
    });
    assert!(world.position(cork).unwrap().y > 1.8);
    assert!(high.apply_with_waves(&mut world, 0.01, |_, _| f64::NAN).is_err());
    assert!(pool.with_density(-1.0).apply_to(&mut world, 0.01).is_err());
}

/// Expected: `sqrt(2 m g / (density drag area))` of a ball that falls in still air, and the speed of the wind
/// itself without gravity.
#[test]
fn a_ball_reaches_its_terminal_speed() {
    for rate in [30, 120] {
        let mut world = World::new(Settings::default()).unwrap();
        let ball = body(&mut world, DVec3::ZERO, Geometry::sphere(0.5), 20.0);
        let air = Wind::default().with_drag(0.47);
        run(&mut world, 30.0, rate, |world, dt| assert!(air.apply_to(world, dt).unwrap() <= 1));
        let area = std::f32::consts::PI * 0.25;
        let expected = (2.0 * world.mass(ball).unwrap() * G / (1.2 * 0.47 * area)).sqrt();
        let speed = -world.linear_velocity(ball).unwrap().y;
        assert!((speed - expected).abs() < 0.02 * expected, "{rate} Hz: {speed}, not {expected}");
    }
    assert!(Wind::default().with_density(f32::NAN).validate().is_err());
}

/// Expected: none in the middle between two, `strength / (distance^2 + softening^2)` beside one.
#[test]
fn two_attractors_share() {
    let [left, right] = [-4.0, 4.0].map(|x| Attractor::default().with_position([x, 0.0, 0.0]));
    let both = |at: DVec3| left.acceleration_at(at) + right.acceleration_at(at);
    assert!(both(DVec3::ZERO).length() < 1e-6 && both(DVec3::X).x > 0.0 && both(-DVec3::X).x < 0.0);
    let one = right.acceleration_at(DVec3::X).x;
    assert!((one - 100.0 / (9.0 + 0.25) * 3.0 / 9.25_f32.sqrt()).abs() < 1e-4, "{one}");
    let strong = right.with_strength(1e9).with_softening(0.0).with_max_acceleration(50.0);
    assert!((strong.acceleration_at(DVec3::X).length() - 50.0).abs() < 1e-3);
    assert_eq!(strong.acceleration_at(strong.position), Vec3::ZERO);
    assert_eq!(strong.with_reach(1.0).acceleration_at(DVec3::X), Vec3::ZERO);

    let mut world = World::new(Settings::default().with_gravity(Vec3::ZERO)).unwrap();
    let middle = body(&mut world, DVec3::ZERO, Geometry::sphere(0.2), 1000.0);
    let near = body(&mut world, DVec3::new(1.0, 3.0, 0.0), Geometry::sphere(0.2), 10.0);
    run(&mut world, 0.25, 60, |world, dt| {
        assert_eq!(left.apply_to(world, dt).unwrap() + right.apply_to(world, dt).unwrap(), 4);
    });
    assert!(world.linear_velocity(middle).unwrap().length() < 1e-4);
    let velocity = world.linear_velocity(near).unwrap();
    assert!(velocity.x > 0.2 && velocity.y < -0.5, "{velocity}");
}
