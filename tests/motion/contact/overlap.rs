//! How fast bodies part that start within each other. 500 boxes at one point left it at 114 m/s, because each
//! pair was pushed apart at up to 3 m/s, and along a chain of pairs these speeds add up.

use crate::common::random::Random;
use backstop::glam::{DVec3, Vec3};
use backstop::{BodyDesc, Budget, Geometry, Settings, ShapeDesc, World};

const DT: f32 = 1.0 / 60.0;

/// `Settings::push_speed` says: overlaps give a body at most five times that.
const BOUND: f32 = 5.0 * 3.0;

fn crowd(count: usize, spread: f64, geometry: &Geometry, settings: Settings) -> World {
    let mut world = World::new(settings.with_gravity(Vec3::ZERO)).unwrap();
    let mut random = Random(7);
    let body = |at| BodyDesc::dynamic().with_position(at).with_shape(ShapeDesc::new(geometry.clone()));
    let bodies: Vec<BodyDesc> = (0..count).map(|_| body(random.cube64() * 0.5 * spread)).collect();
    world.add_bodies(&bodies).unwrap();
    world
}

/// The greatest speed of any body.
fn fastest(world: &World) -> f32 {
    world.bodies().map(|b| world.linear_velocity(b).unwrap().length()).fold(0.0, f32::max)
}

/// Expected: the bound, at one point or spread over one, of any shape and size, whatever their number; and
/// they do part.
#[test]
fn overlap_parts_bodies_no_faster_than_its_bound_however_many_there_are() {
    let cube = |half: f32| Geometry::cuboid(half, half, half);
    let ball = Geometry::Sphere { radius: 0.5 };
    for (count, spread, geometry) in [
        (2, 0.0, cube(0.5)),
        (10, 0.0, cube(0.5)),
        (60, 0.0, cube(0.5)),
        (500, 0.0, cube(0.5)),
        (150, 0.0, cube(0.05)),
        (150, 0.02, ball),
    ] {
        let mut world = crowd(count, spread, &geometry, Settings::default());
        let mut most = 0.0f32;
        for _ in 0..60 {
            world.step(DT).unwrap();
            most = most.max(fastest(&world));
        }
        println!("{count} within {spread} m: {most} m/s");
        assert!(most <= BOUND, "{count} within {spread} m: {most} m/s");
        let far = world.bodies().map(|b| world.position(b).unwrap().length()).fold(0.0, f64::max);
        assert!(far > 0.3 * f64::from(geometry_size(&geometry)), "{count} within {spread} m: {far} m");
    }
}

fn geometry_size(geometry: &Geometry) -> f32 {
    match geometry {
        Geometry::Box { half_extents } => half_extents.x,
        Geometry::Sphere { radius } => *radius,
        _ => 0.0,
    }
}

/// Six hundred boxes at one point are 180,000 pairs, 160 MB. Expected: within a budget of 16 MB no more is
/// reserved in any step, and omitted contacts are counted.
#[test]
fn a_budget_bounds_what_a_crowd_takes() {
    let limit = 16 << 20;
    let settings = Settings::default().with_budget(Budget::total(limit));
    let mut world = crowd(600, 0.0, &Geometry::cuboid(0.5, 0.5, 0.5), settings);
    let mut shed = 0;
    for _ in 0..20 {
        shed += world.step(DT).unwrap().shed;
        assert!(world.memory().total() <= limit);
        assert!(fastest(&world) <= BOUND);
    }
    assert!(shed > 0);
}

/// A heavy body that comes fast pushes a crowd as fast as that: the bound is for speeds by overlap. Expected:
/// by the law of impulse, without restitution, light bodies end as fast as the heavy one; and those before
/// the ram are out of it in the end, half of each apart.
#[test]
fn a_crowd_is_pushed_as_fast_as_what_hits_it() {
    let mut world = crowd(30, 0.3, &Geometry::cuboid(0.5, 0.5, 0.5), Settings::default());
    let mut ram = ShapeDesc::new(Geometry::cuboid(1.0, 3.0, 3.0));
    ram.density = 1e6;
    let ram = BodyDesc::dynamic()
        .with_position(DVec3::new(-4.0, 0.0, 0.0))
        .with_velocity(Vec3::X * 40.0, Vec3::ZERO)
        .with_shape(ram);
    let ram = world.add_body(&ram).unwrap();
    // Places from the ram's, of those in its way.
    let before = |world: &World| {
        let at = world.position(ram).unwrap();
        let places = world.bodies().filter(|&b| b != ram).map(|b| world.position(b).unwrap() - at);
        let in_the_way = |place: &DVec3| place.y.abs() < 3.0 && place.z.abs() < 3.0;
        places.filter(in_the_way).map(|place| place.x).fold(f64::MAX, f64::min)
    };
    for step in 0..300 {
        world.step(DT).unwrap();
        assert!(before(&world) > 0.0, "the ram has passed one in step {step}");
        if step == 30 {
            let speeds = world.bodies().map(|b| world.linear_velocity(b).unwrap().x);
            let slowest = speeds.fold(f32::MAX, f32::min);
            assert!(slowest > 0.9 * 40.0, "one goes at {slowest} m/s");
        }
    }
    let last = before(&world);
    assert!(last > 1.49, "one is at {last} m before the ram, where 1.5 m is apart");
}
