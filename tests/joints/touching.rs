//! Two bodies that are joined and let collide: their joint and their contact hold the same pair.
//!
//! Solved exactly along with a tree of joints that knew nothing of the contact, a pair of masses 47 : 1 at
//! 1 m/s went from 666 J to 4.8 MJ in a step. Nothing here drives the bodies, so that the expected value is
//! the energy that they start with.

use crate::common::random::Random;
use backstop::glam::{DVec3, Vec3};
use backstop::{BodyDesc, BodyHandle, Frame, Geometry, JointDesc, Settings, ShapeDesc, World};

type Make = fn([BodyHandle; 2], [Frame; 2]) -> JointDesc;

/// A shape whose half size is 15 to 40 cm, and the radius of a ball around it [m].
fn shape(random: &mut Random) -> (Geometry, f32) {
    let half = random.range(0.15, 0.4);
    match random.below(4) {
        0 => (Geometry::Sphere { radius: half }, half),
        1 => (Geometry::capsule(half, 0.5 * half), 1.5 * half),
        2 => (Geometry::cuboid(half, 0.5 * half, 0.7 * half), 1.4 * half),
        _ => (Geometry::cylinder(0.5 * half, half), 1.2 * half),
    }
}

/// Two bodies above a floor, apart from each other, joined halfway, with densities of 50 to 7,500 kg/m³.
fn pair(seed: u64, speed: f32, make: Make) -> World {
    let (mut random, mut world) = (Random(seed), World::new(Settings::default()).unwrap());
    let floor = ShapeDesc::new(Geometry::cuboid(50.0, 1.0, 50.0));
    world.add_body(&BodyDesc::fixed().with_position(DVec3::NEG_Y).with_shape(floor)).unwrap();
    let shapes = [0; 2].map(|_| shape(&mut random));
    let way = random.direction() * (shapes[0].1 + shapes[1].1 + 0.02);
    let mut at = DVec3::Y * 2.0;
    let pair = shapes.map(|(geometry, _)| {
        let mut form = ShapeDesc::new(geometry);
        form.density = random.log_range(50.0, 7500.0);
        let (v, w): (Vec3, Vec3) = (random.cube() * speed, random.cube() * speed);
        let desc = BodyDesc::dynamic()
            .with_position(at)
            .with_rotation(random.rotation())
            .with_velocity(v, w)
            .with_shape(form);
        at += way.as_dvec3();
        world.add_body(&desc).unwrap()
    });
    let frames = world.frames_at(pair, DVec3::Y * 2.0 + 0.5 * way.as_dvec3(), random.rotation()).unwrap();
    world.add_joint(&make(pair, frames).with_collide(true)).unwrap();
    world
}

#[test]
fn a_pair_that_is_joined_and_touches_gains_nothing() {
    let kinds = [("ball", JointDesc::ball as Make), ("hinge", JointDesc::hinge), ("fixed", JointDesc::fixed)];
    let mut wrong = Vec::new();
    for ((kind, make), hertz) in kinds.into_iter().flat_map(|kind| [30, 60, 120].map(|hertz| (kind, hertz))) {
        for (speed, seed) in [1.0, 10.0, 60.0].into_iter().flat_map(|speed| (0..100).map(move |k| (speed, k)))
        {
            let mut world = pair(seed, speed, make);
            world.step(1.0 / hertz as f32).unwrap();
            let start = world.energy();
            let mut most = 0.0_f64;
            for _ in 0..4 * hertz {
                world.step(1.0 / hertz as f32).unwrap();
                most = most.max(world.energy() / start - 1.0);
            }
            if most > 0.01 {
                wrong.push(format!("{kind}, {hertz} Hz, {speed} m/s, seed {seed}: {most}"));
            }
        }
    }
    assert!(wrong.is_empty(), "{wrong:#?}");
}
