//! Time of impact with retroactive detection.

use backstop::glam::{DVec3, Vec3};
use backstop::{BodyDesc, BodyHandle, ContinuousMode, Geometry, Material, Settings, ShapeDesc, World};
use backstop_lab::retroactive::Retroactive;

const DT: f32 = 1.0 / 60.0;

/// A ball of 0.2 m that flies at a wall of half a metre without continuous collision: 0.67 m a step.
fn shot(restitution: f32) -> (World, BodyHandle) {
    let settings = Settings::default().with_gravity(Vec3::ZERO).with_continuous(ContinuousMode::Discrete);
    let mut world = World::new(settings).unwrap();
    let material = Material::default().with_restitution(restitution);
    let shape = |geometry| ShapeDesc::new(geometry).with_material(material);
    let wall =
        BodyDesc::fixed().with_position(DVec3::X * 5.25).with_shape(shape(Geometry::cuboid(0.25, 2.0, 2.0)));
    world.add_body(&wall).unwrap();
    let ball = BodyDesc::dynamic().with_velocity(Vec3::X * 40.0, Vec3::ZERO);
    let ball = world.add_body(&ball.with_shape(shape(Geometry::Sphere { radius: 0.2 }))).unwrap();
    (world, ball)
}

/// By itself it ends up in the wall or behind it. With returns it meets the wall within the tolerance, and
/// the step in which it is stopped may add as much again.
#[test]
fn a_ball_that_goes_too_far_is_taken_back() {
    let deepest = |retroactive: Option<Retroactive>| {
        let (mut world, ball) = shot(0.0);
        let (mut most, mut undone) = (f64::MIN, 0);
        for _ in 0..30 {
            match retroactive {
                Some(way) => undone += way.step(&mut world, DT).unwrap().undone,
                None => drop(world.step(DT).unwrap()),
            }
            most = most.max(world.position(ball).unwrap().x + 0.2 - 5.0);
        }
        (most, undone)
    };
    let (most, undone) = deepest(None);
    assert!(most > 0.1 && undone == 0, "{most}");
    let tolerance = 1e-3;
    let (most, undone) = deepest(Some(Retroactive { tolerance, rounds: 8 }));
    assert!(most < 2.0 * tolerance && most > -0.01 && undone > 0, "{most}, {undone}");
}

/// A bounce happens at the wall and keeps the speed, by e = 1. A body that bounces where it stands in overlap
/// waits for the end of its step, so that it may be late by one: 0.67 m.
#[test]
fn a_bounce_happens_when_they_meet() {
    let (mut world, ball) = shot(1.0);
    let way = Retroactive { tolerance: 1e-3, rounds: 8 };
    for _ in 0..12 {
        way.step(&mut world, DT).unwrap();
    }
    // 4.8 m to the wall, and back for the rest of 8 m.
    let expected = 4.8 - (40.0 * 12.0 / 60.0 - 4.8);
    let found = world.position(ball).unwrap().x;
    assert!((found - expected).abs() < 0.67, "{found}, expected {expected}");
    let speed = world.linear_velocity(ball).unwrap().x;
    assert!((speed + 40.0).abs() < 0.01, "{speed}");
}

#[test]
fn what_is_no_step_is_refused() {
    let (mut world, _) = shot(0.0);
    let way = Retroactive { tolerance: 1e-3, rounds: 8 };
    assert!(way.step(&mut world, 0.0).is_err());
    assert!(Retroactive { tolerance: 0.0, ..way }.step(&mut world, DT).is_err());
}
