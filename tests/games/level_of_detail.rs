//! What is far from all viewers costs nothing, and comes back as it was.

use backstop::glam::{DVec3, Vec3};
use backstop::{BodyDesc, BodyHandle, Geometry, JointDesc, LevelOfDetail, Settings, ShapeDesc, World};

/// A floor, and a column of boxes that leans out as far from the origin as is said.
fn pile(sleeping: bool) -> (World, Vec<BodyHandle>) {
    let mut world = World::new(Settings::default().with_sleeping(sleeping)).unwrap();
    world.add_body(&BodyDesc::fixed().with_shape(ShapeDesc::new(Geometry::Plane))).unwrap();
    let cube = ShapeDesc::new(Geometry::cuboid(0.5, 0.5, 0.5));
    let mut boxes = Vec::new();
    for i in 0..40 {
        // Ten columns of four that touch each other.
        let at = DVec3::new(95.0 + f64::from(i / 4) * 1.0, 0.5 + f64::from(i % 4), 0.0);
        boxes.push(world.add_body(&BodyDesc::dynamic().with_position(at).with_shape(cube.clone())).unwrap());
    }
    for _ in 0..120 {
        world.step(1.0 / 60.0).unwrap();
    }
    (world, boxes)
}

fn poses(world: &World, bodies: &[BodyHandle]) -> Vec<(DVec3, Vec3)> {
    bodies.iter().map(|&b| (world.position(b).unwrap(), world.linear_velocity(b).unwrap())).collect()
}

/// Expected: all of an island go together, though some are nearer than the distance and some are not; all
/// come back where they were, and the work of a step falls to none in between.
#[test]
fn a_pile_goes_and_comes_back_as_a_whole() {
    for sleeping in [false, true] {
        let (mut world, boxes) = pile(sleeping);
        let mut detail = LevelOfDetail::new(60.0, 98.5).unwrap();
        // The nearest boxes are within the distance, the farthest are not.
        assert_eq!(detail.update(&mut world, &[DVec3::ZERO]).unwrap(), 0);
        let before = poses(&world, &boxes);
        assert_eq!(detail.update(&mut world, &[DVec3::X * -50.0]).unwrap(), 40);
        assert!(boxes.iter().all(|&body| !world.is_enabled(body).unwrap()));
        for _ in 0..60 {
            world.step(1.0 / 60.0).unwrap();
        }
        assert_eq!((world.report().pairs, world.contacts().count()), (0, 0));
        assert_eq!(poses(&world, &boxes), before);
        // Between the two distances nothing changes.
        assert_eq!(detail.update(&mut world, &[DVec3::X * 20.0]).unwrap(), 40);
        assert_eq!(detail.update(&mut world, &[DVec3::X * 40.0]).unwrap(), 0);
        assert_eq!(poses(&world, &boxes), before);
        for _ in 0..60 {
            world.step(1.0 / 60.0).unwrap();
        }
        for (now, before) in poses(&world, &boxes).iter().zip(&before) {
            assert!(now.0.distance(before.0) < 5e-3, "{now:?}, {before:?}");
        }
    }
}

/// Joined bodies go together, what the caller disabled stays so, and removed bodies are forgotten.
#[test]
fn joints_tie_and_the_callers_word_holds() {
    let mut world = World::new(Settings::default().with_gravity(Vec3::ZERO)).unwrap();
    let ball = ShapeDesc::new(Geometry::sphere(0.5));
    let mut add = |x: f64| {
        world.add_body(&BodyDesc::dynamic().with_position(DVec3::X * x).with_shape(ball.clone())).unwrap()
    };
    let [near, end, alone, off] = [5.0, 300.0, 301.0, 302.0].map(&mut add);
    let pair = [near, end];
    let rope = JointDesc::distance(pair, Default::default(), 0.0, 400.0);
    world.add_joint(&rope).unwrap();
    world.set_enabled(off, false).unwrap();
    let mut detail = LevelOfDetail::new(10.0, 20.0).unwrap();
    assert_eq!(detail.update(&mut world, &[DVec3::ZERO]).unwrap(), 1);
    assert!(world.is_enabled(end).unwrap() && !world.is_enabled(alone).unwrap());
    world.remove_body(alone).unwrap();
    assert_eq!(detail.update(&mut world, &[]).unwrap(), 2);
    detail.clear(&mut world).unwrap();
    assert!(world.is_enabled(near).unwrap() && !world.is_enabled(off).unwrap());
    assert!(detail.update(&mut world, &[DVec3::NAN]).is_err());
    for [near, far] in [[2.0, 1.0], [-1.0, 1.0], [f32::NAN, 1.0]] {
        assert!(LevelOfDetail::new(near, far).is_err());
    }
}
