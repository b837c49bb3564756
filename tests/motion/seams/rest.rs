//! Rest across seams, shapes that are near many pieces, and the same bits.

use super::RATES;
use super::floors::{Floor, Tile, rough};
use crate::common::random::Random;
use backstop::glam::{DVec3, Quat, Vec3};
use backstop::{BodyDesc, BodyHandle, Geometry, Settings, Snapshot, World};
use std::f32::consts::TAU;

/// A floor of tiles with friction, or a plane, and boxes that are dropped on it: nothing that rolls.
fn strewn(random: &mut Random, settings: Settings, count: usize, plane: bool) -> (World, Vec<BodyHandle>) {
    let mut world = World::new(settings).unwrap();
    let floor = Floor { cell: random.range(0.3, 1.0), ..Floor::any(random, 6.0, 1e-3, 0.6) };
    if plane {
        world.add_body(&BodyDesc::fixed().with_shape(rough(Geometry::Plane, 0.6))).unwrap();
    } else {
        floor.lay(&mut world, 6.0, random);
    }
    let bodies = (0..count).map(|i| {
        let half = Vec3::new(random.range(0.1, 0.4), random.range(0.05, 0.2), random.range(0.1, 0.4));
        let geometry = Geometry::cuboid(half.x, half.y, half.z);
        let at =
            DVec3::new(random.range(0.0, 5.0).into(), 0.5 + 0.3 * i as f64, random.range(-1.0, 1.0).into());
        let turn = Quat::from_rotation_y(random.range(0.0, TAU));
        let body = BodyDesc::dynamic().with_position(at).with_rotation(turn).with_shape(rough(geometry, 0.6));
        world.add_body(&body).unwrap()
    });
    let bodies = bodies.collect();
    (world, bodies)
}

fn step(world: &mut World, hz: f32) {
    world.step(1.0 / hz).unwrap();
}

/// Boxes that are dropped on floors of tiles, or on a plane instead, and left alone for so many seconds after
/// ten of rest. Says in how many cases they are not at rest by then (1 mm/s), or not where they were (1 mm).
fn restless(cases: u64, count: usize, seconds: f32, plane: bool) -> usize {
    let mut restless = 0;
    for case in 0..cases {
        let mut random = Random(300 + case);
        let hz = RATES[case as usize % 3];
        let (mut world, bodies) = strewn(&mut random, Settings::default(), count, plane);
        let run = |world: &mut World, seconds: f32| {
            (0..(seconds * hz) as usize).for_each(|_| step(world, hz));
        };
        run(&mut world, 14.0);
        // Some fall off the floor.
        let lies = |body: &&BodyHandle| world.position(**body).unwrap().y > -0.5;
        let bodies: Vec<BodyHandle> = bodies.iter().filter(lies).copied().collect();
        assert!(2 * bodies.len() >= count, "{case}: {} lie", bodies.len());
        let place = |world: &World| bodies.iter().map(|&b| world.position(b).unwrap()).collect::<Vec<_>>();
        let speeds = bodies.iter().map(|&b| world.linear_velocity(b).unwrap().length());
        let (before, speed) = (place(&world), speeds.fold(0.0, f32::max));
        run(&mut world, seconds);
        let moved = before.iter().zip(place(&world)).map(|(p, q)| (*p - q).length()).fold(0.0, f64::max);
        if speed >= 1e-3 || moved >= 1e-3 {
            println!("{case}, {hz} Hz: {speed:.1e} m/s, then moved by {moved:.1e} m");
            restless += 1;
        }
    }
    println!("{restless} of {cases}");
    restless
}

/// Six boxes on each of 24 floors of tiles. Expected: ten seconds later they are at rest, as on a plane, and
/// two minutes later where they were then. Where a border that one piece covers in part bears nothing any
/// more, they move on; where a contact that is kept is judged by where its normal is by now, they rock on
/// borders for minutes.
#[test]
fn what_lies_across_seams_stays_where_it_is() {
    assert_eq!(restless(24, 6, 120.0, false), 0);
}

/// Twelve boxes on each of 90 floors, which lean on each other. Expected: no more than one of thirty moves on
/// (on a plane one of ninety does).
#[test]
#[ignore = "takes minutes"]
fn heaps_across_seams_stay_where_they_are() {
    assert!(restless(90, 12, 60.0, true) <= 1);
    assert!(restless(90, 12, 60.0, false) <= 3);
}

/// A slab of 3 m that slides over voxels of 25 cm, of which it is near some two hundred at a time. Expected:
/// it keeps its speed to a tenth of a percent and stays level.
#[test]
fn a_slab_slides_over_hundreds_of_voxels() {
    for hz in RATES {
        let mut random = Random(7);
        let floor = Floor {
            tile: Tile::Boxes,
            cell: 0.25,
            depth: 0.25,
            yaw: 0.3,
            gap: 0.0,
            step: 0.0,
            staggered: false,
            friction: 0.0,
        };
        let mut world = World::new(Settings::default()).unwrap();
        floor.lay(&mut world, 12.0, &mut random);
        let slab = BodyDesc::dynamic()
            .with_position(DVec3::new(2.0, 0.2, 0.0))
            .with_velocity(Vec3::X * 8.0, Vec3::ZERO);
        let slab = world.add_body(&slab.with_shape(rough(Geometry::cuboid(1.5, 0.2, 1.0), 0.0))).unwrap();
        let mut rise = f64::MIN;
        for _ in 0..hz as usize {
            world.step(1.0 / hz).unwrap();
            rise = rise.max(world.position(slab).unwrap().y - 0.2);
        }
        let velocity = world.linear_velocity(slab).unwrap();
        assert!((velocity.x - 8.0).abs() < 8e-3 && rise < 1e-3, "{hz} Hz: {velocity}, up {rise}");
    }
}

/// Bodies strewn over tiles. Expected: the same bits with one thread and more, and after going back.
#[test]
fn seams_give_the_same_bits() {
    let run = |threads: usize, back: bool| {
        let settings = Settings::default().with_threads(threads);
        let (mut world, _) = strewn(&mut Random(5), settings, 60, false);
        (0..60).for_each(|_| step(&mut world, 60.0));
        if back {
            let mut snapshot = Snapshot::default();
            world.snapshot(&mut snapshot);
            (0..30).for_each(|_| step(&mut world, 60.0));
            world.restore(&snapshot).unwrap();
        }
        (0..60).for_each(|_| step(&mut world, 60.0));
        world.state_hash()
    };
    let want = run(1, false);
    for (threads, back) in [(2, false), (3, false), (1, true), (2, true)] {
        assert_eq!(run(threads, back), want, "{threads} threads, restored: {back}");
    }
}
