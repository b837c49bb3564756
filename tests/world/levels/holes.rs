//! Holes in height fields: bodies above them fall through, all others stay on the remaining cells.

use super::common;
use backstop::glam::{DVec3, Quat, Vec2, Vec3};
use backstop::{
    BodyDesc, BodyHandle, Geometry, HeightField, Material, QueryFilter, Ray, Settings, ShapeDesc, Snapshot,
    World,
};

/// Flat, 20 m by 20 m of cells of half a metre, without those from 8 m to 12 m along both axes.
fn field() -> HeightField {
    let flat = HeightField::new(41, 41, Vec2::splat(0.5), vec![0.0; 41 * 41]).unwrap();
    let holes = (16..24).flat_map(|row| (16..24).map(move |column| [column, row]));
    flat.with_holes(holes).unwrap()
}

fn world_of(threads: usize, field: HeightField) -> (World, BodyHandle) {
    let mut world = World::new(Settings::default().with_threads(threads).with_sleeping(true)).unwrap();
    let ground = BodyDesc::fixed().with_shape(ShapeDesc::new(Geometry::height_field(field)));
    let ground = world.add_body(&ground).unwrap();
    (world, ground)
}

/// Expected: over the hole free fall, y = h - g t² / 2, to the bit of a world without ground; beside it rest
/// at the radius or half the height. At the rim a box whose centre of mass is 0.1 m inside stays (it tips
/// where the centre is beyond), and one 0.1 m outside goes.
#[test]
fn what_falls_over_a_hole_falls_through_and_what_stands_at_its_rim_stands() {
    for mode in [backstop::ContinuousMode::Segment, backstop::ContinuousMode::Volume] {
        let (mut world, _) = world_of(1, field());
        let mut empty = World::new(Settings::default()).unwrap();
        let ball = |x: f32, z: f32| {
            let at = Vec3::new(x, 3.0, z);
            common::dynamic(Geometry::sphere(0.3), Material::default(), at).with_continuous(mode)
        };
        let plank = |x: f32, z: f32| {
            let at = Vec3::new(x, 0.2, z);
            common::dynamic(Geometry::cuboid(0.5, 0.2, 0.5), Material::default(), at).with_continuous(mode)
        };
        let through = [ball(10.0, 10.0), ball(10.5, 11.2)]
            .map(|desc| (world.add_body(&desc).unwrap(), empty.add_body(&desc).unwrap()));
        let above = [ball(4.0, 4.0), ball(7.6, 9.0)].map(|desc| world.add_body(&desc).unwrap());
        let [stays, goes] = [plank(7.9, 10.0), plank(8.1, 11.2)].map(|desc| world.add_body(&desc).unwrap());
        for step in 0..300 {
            world.step(1.0 / 60.0).unwrap();
            empty.step(1.0 / 60.0).unwrap();
            for (one, other) in through {
                assert_eq!(world.position(one).unwrap(), empty.position(other).unwrap(), "step {step}");
            }
        }
        for body in above {
            let y = world.position(body).unwrap().y;
            assert!((y - 0.3).abs() < 5e-3, "{y}");
        }
        assert!((world.position(stays).unwrap() - DVec3::new(7.9, 0.2, 10.0)).length() < 5e-3);
        assert!(world.position(goes).unwrap().y < -10.0);
    }
}

/// A fast ball flies through the hole and is stopped beside it: 300 m/s, 5 m a step.
#[test]
fn a_fast_ball_passes_the_hole_alone() {
    for (x, passes) in [(10.0, true), (11.3, true), (14.0, false), (7.0, false)] {
        let (mut world, _) = world_of(1, field());
        let desc = common::dynamic(Geometry::sphere(0.3), Material::default(), Vec3::new(x, 20.0, 10.0));
        let body = world.add_body(&desc.with_velocity(Vec3::NEG_Y * 300.0, Vec3::ZERO)).unwrap();
        common::steps(&mut world, 30, 1.0 / 60.0);
        assert_eq!(world.position(body).unwrap().y < 0.0, passes, "{x}");
    }
}

/// Expected: none of the queries sees a triangle that is not there; the nearest point from the middle is on
/// the rim, 2 m away.
#[test]
fn queries_see_no_holes() {
    let (world, _) = world_of(1, field());
    let all = QueryFilter::default();
    let down = |x: f64| Ray::new(DVec3::new(x, 5.0, 10.2), Vec3::NEG_Y * 10.0);
    assert!(world.cast_ray(&down(10.1), &all).unwrap().is_none());
    assert_eq!(world.cast_ray(&down(7.9), &all).unwrap().unwrap().fraction, 0.5);
    let rays = [7.9, 10.1, 11.9, 12.1].map(down);
    let mut hits = [None; 4];
    world.cast_rays(&rays, &all, &mut hits).unwrap();
    assert_eq!(hits.map(|hit| hit.is_some()), [true, false, false, true]);
    let ball = Geometry::sphere(0.5);
    let mut overlaps = Vec::new();
    for (x, count) in [(10.0, 0), (8.4, 1), (5.0, 1)] {
        overlaps.clear();
        world.overlap(&ball, DVec3::new(x, 0.1, 10.0), Quat::IDENTITY, &all, &mut overlaps).unwrap();
        assert_eq!(overlaps.len(), count, "{x}");
    }
    let nearest = world.closest_point(DVec3::new(10.0, 0.0, 10.0), 5.0, &all).unwrap().unwrap();
    assert!((nearest.distance - 2.0).abs() < 1e-6);
}

/// A field that is exchanged for one with a hole lets go of the bodies that lay there; snapshots tell the two
/// apart, and the run goes on to the same bits on two threads and from a snapshot.
#[test]
fn a_hole_that_opens_lets_go_and_snapshots_know_of_it() {
    let whole = HeightField::new(41, 41, Vec2::splat(0.5), vec![0.0; 41 * 41]).unwrap();
    let run = |threads: usize, restored: bool| {
        let (mut world, ground) = world_of(threads, whole.clone());
        for i in 0..150 {
            let at = Vec3::new(
                7.0 + 0.6 * (i % 10) as f32,
                0.5 + 0.5 * (i / 50) as f32,
                8.0 + 0.9 * (i / 10 % 5) as f32,
            );
            world
                .add_body(&common::dynamic(Geometry::cuboid(0.2, 0.2, 0.2), Material::default(), at))
                .unwrap();
        }
        common::steps(&mut world, 300, 1.0 / 60.0);
        assert!(world.bodies().filter(|body| world.is_sleeping(*body).unwrap()).count() > 100);
        let mut before = Snapshot::new();
        world.snapshot(&mut before);
        let shape = world.shapes(ground).unwrap().next().unwrap();
        world.set_geometry(shape, Geometry::height_field(field())).unwrap();
        common::steps(&mut world, 60, 1.0 / 60.0);
        // The bytes of a world with the other field are not taken.
        assert!(world.restore(&Snapshot::from_bytes(&before.to_whole_bytes()).unwrap()).is_err());
        if restored {
            let mut snapshot = Snapshot::new();
            world.snapshot(&mut snapshot);
            let bytes = snapshot.to_whole_bytes();
            common::steps(&mut world, 30, 1.0 / 60.0);
            world.restore(&Snapshot::from_bytes(&bytes).unwrap()).unwrap();
        }
        common::steps(&mut world, 120, 1.0 / 60.0);
        world
    };
    let world = run(1, false);
    let hash = world.state_hash();
    assert_eq!((run(2, false).state_hash(), run(1, true).state_hash()), (hash, hash));
    let fallen = world.bodies().filter(|body| world.position(*body).unwrap().y < -1.0).count();
    println!("{fallen} of 150 fell");
    assert!(fallen > 60 && fallen < 150);
}

/// A trapdoor of 4 m opens under a sleeping pile of three layers and closes 24 steps later, after a fall of
/// 0.78 m. Expected: all wake; two layers are below by then and fall on, the third rests on it, and nothing
/// beside it falls; the same bits on two threads and from a snapshot; the caller's field stays as it was.
#[test]
fn a_trapdoor_opens_and_closes() {
    let flat = HeightField::new(41, 41, Vec2::splat(0.5), vec![0.0; 41 * 41]).unwrap();
    let run = |threads: usize, restored: bool| {
        let (mut world, ground) = world_of(threads, flat.clone());
        let shape = world.shapes(ground).unwrap().next().unwrap();
        let Geometry::HeightField(before) = world.geometry(shape).unwrap().clone() else { panic!() };
        let place = |i: usize| {
            let [x, y, z] = [i % 6, i / 36, i / 6 % 6].map(|k| k as f32);
            Vec3::new(6.5 + 1.3 * x, 0.2 + 0.4 * y, 6.5 + 1.3 * z)
        };
        let cube = |i| common::dynamic(Geometry::cuboid(0.2, 0.2, 0.2), Material::default(), place(i));
        let pile: Vec<BodyHandle> = (0..108).map(|i| world.add_body(&cube(i)).unwrap()).collect();
        common::steps(&mut world, 200, 1.0 / 60.0);
        assert_eq!(world.sleeping_body_count(), 108);
        world.set_holes(shape, [16, 16], [8, 8], &[true; 64]).unwrap();
        assert!(!before.is_hole_at(16, 16));
        common::steps(&mut world, 10, 1.0 / 60.0);
        if restored {
            let mut snapshot = Snapshot::new();
            world.snapshot(&mut snapshot);
            common::steps(&mut world, 9, 1.0 / 60.0);
            world.set_holes(shape, [16, 16], [1, 2], &[false; 2]).unwrap();
            world.restore(&snapshot).unwrap();
        }
        common::steps(&mut world, 14, 1.0 / 60.0);
        world.set_holes(shape, [16, 16], [8, 8], &[false; 64]).unwrap();
        common::steps(&mut world, 240, 1.0 / 60.0);
        let heights: Vec<(Vec3, f64)> =
            pile.iter().enumerate().map(|(i, &body)| (place(i), world.position(body).unwrap().y)).collect();
        (world.state_hash(), heights)
    };
    let (hash, heights) = run(1, false);
    assert_eq!((run(2, false).0, run(1, true).0), (hash, hash));
    let within = |at: Vec3| (8.0..12.0).contains(&at.x) && (8.0..12.0).contains(&at.z);
    let mut counts = [0; 2];
    for (at, y) in heights {
        let stands = (y / 0.2 - 1.0) % 2.0;
        let stands = stands.abs() < 0.05 || (stands - 2.0).abs() < 0.05;
        assert!(if within(at) { (stands && y > 0.19) || y < -1.0 } else { stands }, "{at}: {y}");
        counts[usize::from(y < -1.0)] += 1;
    }
    // Nine columns stand wholly over it.
    assert_eq!(counts, [90, 18]);
}

/// Balls in a hole that is filled: one with its middle 5 cm above the surface, one 5 cm below. Expected: the
/// first comes to rest on it, the second falls; and so it does if the hole was made by a setter.
#[test]
fn a_filled_hole_pushes_out_what_is_in_it() {
    let flat = HeightField::new(41, 41, Vec2::splat(0.5), vec![0.0; 41 * 41]).unwrap();
    let (mut world, ground) = world_of(1, flat);
    let shape = world.shapes(ground).unwrap().next().unwrap();
    world.set_holes(shape, [16, 16], [8, 8], &[true; 64]).unwrap();
    let ball =
        |x: f32, y: f32| common::dynamic(Geometry::sphere(0.3), Material::default(), Vec3::new(x, y, 10.1));
    let [above, below] = [(9.1, 0.05), (11.1, -0.05)].map(|(x, y)| world.add_body(&ball(x, y)).unwrap());
    let fast = ball(10.1, 6.0).with_velocity(Vec3::NEG_Y * 200.0, Vec3::ZERO);
    world.set_holes(shape, [16, 16], [8, 8], &[false; 64]).unwrap();
    let stopped = world.add_body(&fast).unwrap();
    common::steps(&mut world, 240, 1.0 / 60.0);
    for body in [above, stopped] {
        let y = world.position(body).unwrap().y;
        assert!((y - 0.3).abs() < 5e-3, "{y}");
    }
    assert!(world.position(below).unwrap().y < -10.0);
    for (first, size, count) in [([39, 0], [2, 1], 2), ([0, 0], [0, 1], 0), ([0, 0], [1, 1], 2)] {
        assert!(world.set_holes(shape, first, size, &vec![true; count]).is_err());
    }
    let body_shape = world.shapes(above).unwrap().next().unwrap();
    assert!(world.set_holes(body_shape, [0, 0], [1, 1], &[true]).is_err());
}

/// A hole that moves along under a row of balls, a column every fifteen steps. Expected: a replay without
/// divergence, at the hash of the run.
#[test]
fn holes_that_come_and_go_play_again() {
    let buffer = backstop::replay::RecordingBuffer::default();
    let mut world = World::new(Settings::default()).unwrap();
    world.start_recording(buffer.clone()).unwrap();
    let flat = HeightField::new(41, 41, Vec2::splat(0.5), vec![0.0; 41 * 41]).unwrap();
    let ground = BodyDesc::fixed().with_shape(ShapeDesc::new(Geometry::height_field(flat)));
    let ground = world.add_body(&ground).unwrap();
    let shape = world.shapes(ground).unwrap().next().unwrap();
    for i in 0..20 {
        let at = Vec3::new(4.1 + 0.5 * i as f32, 0.1, 10.1);
        world.add_body(&common::dynamic(Geometry::sphere(0.1), Material::default(), at)).unwrap();
    }
    for column in 6..30 {
        let holes: Vec<bool> = (0..10).map(|i| i % 2 == 1).collect();
        world.set_holes(shape, [column, 18], [2, 5], &holes).unwrap();
        common::steps(&mut world, 15, 1.0 / 60.0);
    }
    common::steps(&mut world, 60, 1.0 / 60.0);
    world.stop_recording().unwrap();
    assert!(world.bodies().any(|body| world.position(body).unwrap().y < -1.0));
    let bytes = buffer.bytes();
    let mut replay = backstop::replay::Replay::open(&bytes[..]).unwrap();
    assert_eq!(replay.run().unwrap().divergence, None);
    assert_eq!(replay.world().state_hash(), world.state_hash());
}

#[test]
fn holes_beyond_the_last_cell_are_refused() {
    let flat = || HeightField::new(3, 2, Vec2::ONE, vec![0.0; 6]).unwrap();
    assert!(flat().with_holes([[2, 0]]).is_err() && flat().with_holes([[0, 1]]).is_err());
    let holed = flat().with_holes([[1, 0]]).unwrap();
    assert!(holed.is_hole_at(1, 0) && !holed.is_hole_at(0, 0) && holed.is_hole_at(2, 0));
    assert_eq!(holed.bytes(), flat().bytes());
    let scaled = holed.scaled(Vec3::new(2.0, 1.0, 3.0)).unwrap();
    assert!(scaled.is_hole_at(1, 0) && !scaled.is_hole_at(0, 0));
}

/// Expected: a replay without divergence, at the hash of the run, with the hole in the field that the
/// recording holds.
#[test]
fn a_recording_holds_the_holes() {
    let buffer = backstop::replay::RecordingBuffer::default();
    let mut world = World::new(Settings::default()).unwrap();
    world.start_recording(buffer.clone()).unwrap();
    world.add_body(&BodyDesc::fixed().with_shape(ShapeDesc::new(Geometry::height_field(field())))).unwrap();
    for x in [7.8, 8.2, 10.0] {
        let at = Vec3::new(x, 1.0, 10.0);
        world.add_body(&common::dynamic(Geometry::sphere(0.3), Material::default(), at)).unwrap();
    }
    common::steps(&mut world, 180, 1.0 / 60.0);
    world.stop_recording().unwrap();
    let bytes = buffer.bytes();
    let mut replay = backstop::replay::Replay::open(&bytes[..]).unwrap();
    assert_eq!(replay.run().unwrap().divergence, None);
    assert_eq!(replay.world().state_hash(), world.state_hash());
}
