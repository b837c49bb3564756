//! Bytes of continuous collision are told apart from those that discrete physics needs too.

use backstop::glam::{DVec3, Vec3};
use backstop::{BodyDesc, Bytes, Category, ContinuousMode, Geometry, Settings, ShapeDesc, World};

const BULLETS: usize = 64;

/// Bullets that are about to hit a wall, all in the next step, but are further from it than discrete physics
/// looks.
fn volley(continuous: ContinuousMode) -> World {
    let settings = Settings::default().with_gravity(Vec3::ZERO).with_continuous(continuous);
    let mut world = World::new(settings).unwrap();
    let wall = ShapeDesc::new(Geometry::cuboid(0.1, 50.0, 50.0));
    world.add_body(&BodyDesc::fixed().with_shape(wall)).unwrap();
    for i in 0..BULLETS {
        let at = DVec3::new(-2.0, (i % 8) as f64 - 3.5, (i / 8) as f64 - 3.5);
        let ball = ShapeDesc::new(Geometry::Sphere { radius: 0.05 });
        let ball =
            BodyDesc::dynamic().with_position(at).with_velocity(Vec3::X * 300.0, Vec3::ZERO).with_shape(ball);
        world.add_body(&ball).unwrap();
    }
    world
}

fn bytes(world: &World, category: Category) -> Bytes {
    world.memory().category(category)
}

#[test]
fn what_only_continuous_collision_finds_counts_as_continuous() {
    let mut discrete = volley(ContinuousMode::Discrete);
    let report = *discrete.step(1.0 / 60.0).unwrap();
    assert_eq!((report.manifolds, bytes(&discrete, Category::Manifolds).reserved), (0, 0));

    let mut world = volley(ContinuousMode::Segment);
    let report = *world.step(1.0 / 60.0).unwrap();
    assert_eq!((report.manifolds, report.potential), (64, 64));
    // All contacts are such, and fill their batches, so that nothing of either is left for discrete physics.
    assert_eq!(bytes(&world, Category::Manifolds).live, 0);
    let more = bytes(&world, Category::Continuous).live - bytes(&discrete, Category::Continuous).live;
    // A contact has 4 points of 32 bytes or more, a lane of a batch of one point 50 numbers or more.
    assert!(more > BULLETS * (128 + 200), "{more}");
    assert!(bytes(&world, Category::Rows).live < 200, "{:?}", bytes(&world, Category::Rows));
}

#[test]
fn what_continuous_collision_no_longer_needs_is_free_for_contacts_that_touch() {
    let mut world = volley(ContinuousMode::Segment);
    world.step(1.0 / 60.0).unwrap();
    let then = bytes(&world, Category::Continuous);
    // Held at the wall by now: touching bodies need no continuous collision.
    (0..5).for_each(|_| drop(world.step(1.0 / 60.0).map(|_| ())));
    let now = bytes(&world, Category::Continuous);
    assert_eq!(world.report().real, 64);
    assert!(now.live < then.live && now.peak >= then.reserved, "{then:?} {now:?}");
    // The same buffer, of the other category by now.
    let manifolds = bytes(&world, Category::Manifolds);
    assert!(manifolds.live > BULLETS * 128 && manifolds.reserved >= manifolds.live, "{manifolds:?}");
    assert!(then.reserved > now.reserved);
}
