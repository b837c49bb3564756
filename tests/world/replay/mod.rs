//! Recordings play again to the bit, at any number of threads, and other files are refused.

mod calls;
mod files;
mod rollback;

use crate::common::{self, random::Random};
use backstop::glam::{DVec3, Mat3, Quat, Vec2, Vec3};
use backstop::replay::{Played, Progress, Recorded, RecordingBuffer, Replay, ReplayError, Stage};
use backstop::{
    Axes, Axis, BodyDesc, BodyHandle, BodyKind, Budget, Category, Character, CharacterSettings, ContactHook,
    ContactHooks, ContinuousMode, ConvexHull, Error, Filter, Frame, Geometry, HeightField, JointDesc,
    JointHandle, Limit, MassProperties, Material, Motion, Motor, Order, QueryFilter, Ray, RowGroup, Settings,
    ShapeDesc, ShapeHandle, Skeleton, Snapshot, TriangleMesh, World,
};
use backstop_scene::{Scene, Terrain, builtin};
use std::collections::BTreeSet;
use std::sync::Arc;
use std::sync::atomic::{AtomicU32, Ordering};

const DT: f32 = 1.0 / 60.0;

/// Hooks that can't be predicted: their answers depend on how often they were called.
#[derive(Default)]
struct Moody(AtomicU32);

impl ContactHooks for Moody {
    fn contact(&self, contact: &mut ContactHook<'_>) {
        match self.0.fetch_add(7, Ordering::Relaxed) % 11 {
            0 => contact.veto(),
            1 => contact.set_friction(0.1, 0.05).unwrap(),
            2 => contact.set_restitution(0.7).unwrap(),
            3 => contact.set_surface_velocity(0, Vec3::X).unwrap(),
            4 => contact.set_surface_velocity(1, Vec3::new(0.0, 0.3, -1.0)).unwrap(),
            _ => {}
        }
    }
}

/// A world that is being recorded, and where.
fn recorded(settings: Settings) -> (World, RecordingBuffer) {
    let buffer = RecordingBuffer::default();
    let mut world = World::new(settings).unwrap();
    world.start_recording(buffer.clone()).unwrap();
    (world, buffer)
}

fn record_scene(scene: &Scene, settings: Settings, steps: u32) -> (Vec<u8>, Recorded, u64) {
    let (mut world, buffer) = recorded(settings.with_gravity(scene.gravity));
    scene.add_to(&mut world).unwrap();
    common::steps(&mut world, steps, DT);
    let recorded = world.stop_recording().unwrap();
    (buffer.bytes(), recorded, world.state_hash())
}

fn play(bytes: &[u8], threads: usize) -> (Played, u64) {
    let run = || {
        let mut replay = Replay::open_with(bytes, move |settings| settings.threads = threads).unwrap();
        let played = replay.run().unwrap();
        (played, replay.world().state_hash())
    };
    rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap().install(run)
}

/// At one, two and three threads; returns the summary of the replay.
fn plays_again(bytes: &[u8], hash: u64) -> Played {
    let mut all = None;
    for threads in 1..=3 {
        let (played, end) = play(bytes, threads);
        assert_eq!(played.divergence, None, "{threads} threads");
        assert_eq!(end, hash, "{threads} threads");
        all = Some(played);
    }
    all.unwrap()
}

#[test]
fn scenes_play_again() {
    for (scene, sleeping, steps) in [
        (builtin::talk(), false, 180),
        (common::small_pile(), false, 120),
        (builtin::large_pyramid(12), true, 180),
    ] {
        let settings = Settings::default().with_sleeping(sleeping);
        // Written before the first step: bodies and meshes.
        let (_, start, _) = record_scene(&scene, settings.clone(), 0);
        let (bytes, recorded, hash) = record_scene(&scene, settings, steps);
        assert_eq!((recorded.steps, recorded.bytes), (steps.into(), bytes.len() as u64));
        println!(
            "{}: {} moving bodies, {} bytes at the start, {} bytes a step",
            scene.name,
            scene.dynamic_bodies(),
            start.bytes,
            (recorded.bytes - start.bytes) / u64::from(steps)
        );
        let played = plays_again(&bytes, hash);
        assert_eq!(played.steps, u64::from(steps));
    }
}

#[test]
fn recording_changes_nothing() {
    let scene = common::small_pile();
    let (_, _, hash) = record_scene(&scene, Settings::default(), 60);
    let (mut world, _) = common::world_of(&scene, Settings::default());
    common::steps(&mut world, 60, DT);
    assert_eq!(world.state_hash(), hash);
}

#[test]
fn hooks_are_not_needed_again() {
    let (mut world, buffer) = recorded(Settings::default());
    let shape = |geometry| ShapeDesc::new(geometry).with_hooks();
    world.add_body(&BodyDesc::fixed().with_shape(shape(Geometry::Plane))).unwrap();
    let bodies: Vec<BodyDesc> = (0..12)
        .map(|i| {
            let at = DVec3::new(f64::from(i % 4) * 1.5, 1.0 + f64::from(i / 4) * 1.3, 0.0);
            BodyDesc::dynamic().with_position(at).with_shape(shape(Geometry::cuboid(0.5, 0.5, 0.5)))
        })
        .collect();
    world.add_bodies(&bodies).unwrap();
    let hooks = Moody::default();
    for _ in 0..120 {
        world.step_with(DT, &hooks).unwrap();
    }
    assert!(hooks.0.load(Ordering::Relaxed) > 7000, "they were asked");
    let hash = world.state_hash();
    world.stop_recording().unwrap();
    plays_again(&buffer.bytes(), hash);
}

#[test]
fn shared_geometry_is_written_once_by_content() {
    let mesh = || {
        let (vertices, triangles) = Terrain::bumpy(32, 0.5).mesh();
        Geometry::Mesh(Arc::new(TriangleMesh::new(vertices, triangles).unwrap()))
    };
    let bytes = |meshes: &[Geometry]| {
        let (mut world, _) = recorded(Settings::default());
        for mesh in meshes {
            world.add_body(&BodyDesc::fixed().with_shape(ShapeDesc::new(mesh.clone()))).unwrap();
        }
        world.stop_recording().unwrap().bytes
    };
    let one = mesh();
    let (single, shared, equal) =
        (bytes(std::slice::from_ref(&one)), bytes(&[one.clone(), one.clone()]), bytes(&[one, mesh()]));
    println!("a mesh of 2048 triangles: {single} bytes");
    assert!(shared < single + 250 && equal < single + 250, "{single} {shared} {equal}");
}

#[test]
fn other_settings_are_found_out() {
    let scene = common::small_pile();
    let (bytes, ..) = record_scene(&scene, Settings::default(), 60);
    let diverges = |change: fn(&mut Settings)| {
        let mut replay = Replay::open_with(&bytes[..], change).unwrap();
        replay.run().unwrap().divergence.expect("it goes another way")
    };
    // Gravity is in all accelerations of the first step.
    let divergence = diverges(|settings| settings.gravity.y -= 1e-3);
    assert_eq!((divergence.step, divergence.stage), (1, Stage::Forces));
    assert_eq!(divergence.bodies, 300);
    // Iterations show in the first step in which something touches.
    let divergence = diverges(|settings| settings.iterations = 2);
    assert!(divergence.step > 1 && divergence.stage == Stage::Solve, "{divergence}");
    let body = divergence.body.as_ref().expect("a body");
    assert!(divergence.to_string().contains("in stage solve, first body"), "{divergence} {body}");
}
