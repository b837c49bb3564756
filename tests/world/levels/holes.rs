//! Holes in height fields: what falls there falls through, all else stays on what is left.

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
    for mode in [backstop::Continuous::Segment, backstop::Continuous::Volume] {
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
        let body = world.add_body(&desc.moving(Vec3::NEG_Y * 300.0, Vec3::ZERO)).unwrap();
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

/// A field that is exchanged for one with a hole lets go of what lay there; snapshots tell the two apart, and
/// the run goes on to the same bits on two threads and from a snapshot.
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
        assert!(world.bodies().filter(|body| world.is_asleep(*body).unwrap()).count() > 100);
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
    let hash = world.hash();
    assert_eq!((run(2, false).hash(), run(1, true).hash()), (hash, hash));
    let fallen = world.bodies().filter(|body| world.position(*body).unwrap().y < -1.0).count();
    println!("{fallen} of 150 fell");
    assert!(fallen > 60 && fallen < 150);
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
#[cfg(feature = "replay")]
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
    assert_eq!(replay.world().hash(), world.hash());
}
