//! Heights that change while the world runs.

use super::common;
use backstop::glam::{DVec3, Vec2, Vec3};
use backstop::{
    BodyDesc, BodyHandle, Geometry, HeightField, Material, Settings, ShapeDesc, ShapeHandle, Snapshot, World,
};
use std::sync::Arc;

fn flat() -> Arc<HeightField> {
    Arc::new(HeightField::new(41, 41, Vec2::splat(0.5), vec![0.0; 41 * 41]).unwrap())
}

fn world_of(threads: usize, field: &Arc<HeightField>) -> (World, ShapeHandle) {
    let mut world = World::new(Settings::default().with_threads(threads).with_sleeping(true)).unwrap();
    let ground = BodyDesc::fixed().with_shape(ShapeDesc::new(Geometry::height_field(field.clone())));
    let ground = world.add_body(&ground).unwrap();
    let shape = world.shapes(ground).unwrap().next().unwrap();
    (world, shape)
}

fn boxes(world: &mut World, half: f32, layers: usize) -> Vec<BodyHandle> {
    let place = |i: usize| {
        let [x, y, z] = [i % 5, i / 25, i / 5 % 5].map(|k| k as f32);
        Vec3::new(8.0 + 2.2 * half * x, half * (1.0 + 2.0 * y), 8.0 + 2.2 * half * z)
    };
    let cube = |i| common::dynamic(Geometry::cuboid(half, half, half), Material::default(), place(i));
    (0..25 * layers).map(|i| world.add_body(&cube(i)).unwrap()).collect()
}

/// A crater of 1 m under a sleeping pile of 100: all wake and go down by 1 m, to rest at heights that the
/// same pile has on a flat ground; the same bits on two threads and from a snapshot; the field of the caller
/// stays.
#[test]
fn a_crater_under_a_sleeping_pile_takes_it_down() {
    let run = |threads: usize, restored: bool| {
        let field = flat();
        let (mut world, shape) = world_of(threads, &field);
        let pile = boxes(&mut world, 0.2, 4);
        common::steps(&mut world, 200, 1.0 / 60.0);
        assert_eq!(world.sleeping_body_count(), 100);
        world.set_heights(shape, [12, 12], [14, 14], &[-1.0; 14 * 14]).unwrap();
        assert_eq!(world.sleeping_body_count(), 0);
        assert_eq!(field.aabb().0.y, 0.0);
        common::steps(&mut world, 20, 1.0 / 60.0);
        if restored {
            let mut snapshot = Snapshot::new();
            world.snapshot(&mut snapshot);
            common::steps(&mut world, 9, 1.0 / 60.0);
            world.set_heights(shape, [12, 12], [14, 14], &[0.5; 14 * 14]).unwrap();
            world.restore(&snapshot).unwrap();
        }
        common::steps(&mut world, 300, 1.0 / 60.0);
        let heights: Vec<f64> = pile.iter().map(|&body| world.position(body).unwrap().y).collect();
        (world.state_hash(), heights)
    };
    let (hash, heights) = run(1, false);
    assert!(heights.iter().all(|&y| y > -0.81 && y < 0.45), "{heights:?}");
    assert_eq!((run(2, false).0, run(1, true).0), (hash, hash));
}

/// A plateau of 0.5 m, and one of 3 m, raised at once under stacks, and under balls of 5 cm that are then
/// wholly below it. Expected: each stands as high above it as before.
#[test]
fn what_stands_on_a_raised_surface_is_lifted() {
    for (half, raise) in [(0.2, 0.5), (0.2, 3.0), (0.05, 0.5)] {
        let (mut world, shape) = world_of(1, &flat());
        let pile = boxes(&mut world, half, 2);
        let ball = common::dynamic(Geometry::sphere(0.05), Material::default(), Vec3::new(7.0, 0.05, 7.0));
        let ball = world.add_body(&ball).unwrap();
        common::steps(&mut world, 120, 1.0 / 60.0);
        world.set_heights(shape, [12, 12], [14, 14], &[raise; 14 * 14]).unwrap();
        for _ in 0..120 {
            common::steps(&mut world, 1, 1.0 / 60.0);
            for (i, &body) in pile.iter().enumerate() {
                let y = world.position(body).unwrap().y;
                let expected = f64::from(raise + half * (1.0 + 2.0 * (i / 25) as f32));
                assert!((y - expected).abs() < 0.02, "{i}: {y}, not {expected}");
            }
        }
        assert!((world.position(ball).unwrap().y - f64::from(raise) - 0.05).abs() < 5e-3);
    }
}

/// A trench that is dug a column a step under a row of balls: none is left above or below its floor.
#[test]
fn digging_along_a_trench_plays_again() {
    let buffer = backstop::replay::RecordingBuffer::default();
    let mut world = World::new(Settings::default()).unwrap();
    world.start_recording(buffer.clone()).unwrap();
    let ground = BodyDesc::fixed().with_shape(ShapeDesc::new(Geometry::height_field(flat())));
    let ground = world.add_body(&ground).unwrap();
    let shape = world.shapes(ground).unwrap().next().unwrap();
    let ball = |i: usize| {
        let at = Vec3::new(4.0 + 0.5 * i as f32, 0.1, 10.0);
        common::dynamic(Geometry::sphere(0.1), Material::default(), at)
    };
    let balls: Vec<BodyHandle> = (0..20).map(|i| world.add_body(&ball(i)).unwrap()).collect();
    for column in 2..38 {
        world.set_heights(shape, [column, 18], [1, 5], &[-0.5; 5]).unwrap();
        common::steps(&mut world, 5, 1.0 / 60.0);
    }
    common::steps(&mut world, 120, 1.0 / 60.0);
    for body in balls {
        let DVec3 { y, .. } = world.position(body).unwrap();
        assert!((y + 0.4).abs() < 0.02, "{y}");
    }
    assert!(world.set_heights(shape, [40, 0], [2, 1], &[0.0; 2]).is_err());
    world.stop_recording().unwrap();
    let bytes = buffer.bytes();
    let mut replay = backstop::replay::Replay::open(&bytes[..]).unwrap();
    assert_eq!(replay.run().unwrap().divergence, None);
    assert_eq!(replay.world().state_hash(), world.state_hash());
}

/// Two boxes that sleep, and an edit far from them that lowers or raises the field's bounds: it wakes them,
/// and their contacts with the field are in the list before the tree of statics has the field again.
/// Expected: each box is asked for its contact and has it; once one is removed only the other's is left.
#[test]
fn contacts_are_found_right_after_an_edit_that_changes_the_bounds() {
    for height in [-0.4, 0.4] {
        let (mut world, shape) = world_of(1, &flat());
        let cube = Geometry::cuboid(0.3, 0.3, 0.3);
        let cube = |x: f32| common::dynamic(cube.clone(), Material::default(), Vec3::new(x, 0.3, 5.0));
        let pair = [3.0, 6.0].map(|x| world.add_body(&cube(x)).unwrap());
        common::steps(&mut world, 120, 1.0 / 60.0);
        assert!(pair.iter().all(|&body| world.is_sleeping(body).unwrap()));
        world.set_heights(shape, [35, 35], [3, 3], &[height; 9]).unwrap();
        let counts = pair.map(|body| world.contacts_of(body).unwrap().count());
        assert_eq!((counts, world.contacts().count()), ([1, 1], 2));
        world.remove_body(pair[0]).unwrap();
        assert_eq!(world.contacts().count(), 1);
        common::steps(&mut world, 120, 1.0 / 60.0);
        assert!((world.position(pair[1]).unwrap().y - 0.3).abs() < 1e-3 && world.contacts().count() == 1);
    }
}
