//! The same input gives the same bits: at any number of threads, in debug and release, with SSE2 and with
//! AVX2.
//!
//! The pinned hashes are of poses and velocities. A change of the engine that changes results changes them,
//! and says so in its commit; a build that differs from another is a bug.

#![allow(clippy::disallowed_methods, reason = "expected values may use the platform's functions")]
use crate::common;

use backstop::glam::{DVec3, Quat, Vec3};
use backstop::{
    BodyDesc, FrictionModel, Geometry, Material, Settings, ShapeDesc, Skeleton, TriangleMesh, World,
};
use backstop_scene::{Scene, Terrain, builtin};
use std::sync::Arc;

fn pyramid() -> Scene {
    builtin::large_pyramid(20)
}

/// Fast bodies that meet each other and the ground, and bounce.
fn crossfire() -> Scene {
    let mut scene = builtin::bullets(true);
    scene.name = "crossfire".into();
    for body in &mut scene.bodies {
        body.desc.shapes.iter_mut().for_each(|s| s.material.restitution = 0.5);
    }
    scene
}

fn hash_after(scene: &Scene, steps: u32, threads: usize) -> u64 {
    let (mut world, _) = common::world_of(scene, Settings::default().with_threads(threads));
    common::steps(&mut world, steps, 1.0 / 60.0);
    assert!(common::all_finite(&world));
    world.state_hash()
}

/// Scene, steps, hash after them.
fn cases() -> [(Scene, u32, u64); 5] {
    [
        (builtin::talk(), 120, PINNED[0]),
        (common::small_pile(), 120, PINNED[1]),
        (pyramid(), 90, PINNED[2]),
        (builtin::bullets(false), 60, PINNED[3]),
        (crossfire(), 60, PINNED[4]),
    ]
}

/// talk, pile, pyramid, bullets, crossfire.
const PINNED: [u64; 5] = [
    0x5BE3_1C72_E67D_1FC3,
    0xFD4C_C4E4_69CD_B029,
    0x0FF1_5AFE_60D0_AC42,
    0x8D8A_3995_A1D2_720B,
    0x385B_8BCB_B634_952F,
];

#[test]
fn every_build_gives_the_pinned_hashes() {
    let mut wrong = Vec::new();
    for (scene, steps, want) in cases() {
        let hash = hash_after(&scene, steps, 1);
        println!("{}: 0x{hash:016X}", scene.name);
        if hash != want {
            wrong.push(format!("{}: 0x{hash:016X} for 0x{want:016X}", scene.name));
        }
    }
    assert!(wrong.is_empty(), "{wrong:#?}");
}

/// Pairs are passed over while their shapes are known to be apart. Settings that change, whichever, have all
/// looked at again: the same bits, at any rate, whether that is in each step or never.
#[test]
fn pairs_that_are_passed_over_change_nothing() {
    let scenes = [
        (common::small_pile(), 600),
        (builtin::talk(), 600),
        (builtin::bullets(true), 240),
        (crossfire(), 240),
        (builtin::build("ragdolls").unwrap(), 400),
    ];
    let cases = scenes.iter().flat_map(|case| [30.0, 60.0, 120.0].map(|rate| (case, rate)));
    for ((scene, steps), rate) in cases {
        let settings = || Settings::default().with_sleeping(true);
        let [(mut one, _), (mut other, _)] = [(); 2].map(|()| common::world_of(scene, settings()));
        for step in 0..*steps {
            // It has no effect without listeners.
            other.set_settings(settings().with_hit_speed(1.0 + (step % 2) as f32)).unwrap();
            common::steps(&mut one, 1, 1.0 / rate);
            common::steps(&mut other, 1, 1.0 / rate);
            assert_eq!(one.state_hash(), other.state_hash(), "{} at {rate} Hz after step {step}", scene.name);
        }
    }
}

#[test]
fn any_number_of_threads_gives_the_same_bits() {
    for (scene, steps, _) in cases() {
        let alone = hash_after(&scene, steps, 1);
        for threads in [2, 3, 8] {
            let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
            let hash = pool.install(|| hash_after(&scene, steps, threads));
            assert_eq!(hash, alone, "{} with {threads} threads", scene.name);
        }
    }
}

/// With friction at every point a slab on sixteen boxes has more points than there are colours. Several of
/// one contact are then among those that go one by one, and once two threads wrote their impulses back to it
/// at the same time.
#[test]
fn points_without_a_colour_give_the_same_bits() {
    let mut bodies = vec![common::Floor::Plane.desc(Material::default())];
    for slab in 0..16 {
        let at = Vec3::X * (10.0 * slab as f32);
        for i in 0..16 {
            let under = Vec3::new(1.2 * (i % 4) as f32 - 1.8, 0.499, 1.2 * (i / 4) as f32 - 1.8);
            bodies.push(common::dynamic(Geometry::cuboid(0.5, 0.5, 0.5), Material::default(), at + under));
        }
        let slab =
            common::dynamic(Geometry::cuboid(2.5, 0.1, 2.5), Material::default(), at + Vec3::Y * 1.097);
        bodies.push(slab.with_velocity(Vec3::Z, Vec3::Y));
    }
    let run = |threads: usize| {
        let friction_model = FrictionModel::Point;
        let mut world =
            World::new(Settings::default().with_threads(threads).with_friction_model(friction_model))
                .unwrap();
        world.add_bodies(&bodies).unwrap();
        common::steps(&mut world, 30, 1.0 / 60.0);
        assert!(world.report().uncoloured > 0);
        world.state_hash()
    };
    let pool = rayon::ThreadPoolBuilder::new().num_threads(3).build().unwrap();
    assert_eq!(pool.install(|| run(3)), run(1));
}

/// A unit quaternion, rounded the same on every target: glam's is normalised in another order on each.
fn unit(q: [f32; 4]) -> Quat {
    let scale = 1.0 / q.iter().map(|part| part * part).sum::<f32>().sqrt();
    Quat::from_array(q.map(|part| part * scale))
}

/// Ragdolls fall on a mesh and on each other, beside a chain with a heavy ball, and joints of every kind
/// swing above it.
fn joints_after(steps: u32, threads: usize) -> u64 {
    let mut world = World::new(Settings::default().with_threads(threads)).unwrap();
    let (vertices, triangles) = Terrain::bumpy(32, 0.5).mesh();
    let ground = Geometry::Mesh(Arc::new(TriangleMesh::new(vertices, triangles).unwrap()));
    world.add_body(&BodyDesc::fixed().with_shape(ShapeDesc::new(ground))).unwrap();
    let figure = Skeleton::humanoid().with_friction(1.0);
    for i in 0..20 {
        let at = DVec3::new(f64::from(i % 4) * 1.2 - 2.0, 3.0 + f64::from(i), f64::from(i % 5) - 2.0);
        // Not by a sine, which platforms compute differently.
        let turn = unit([0.1 * i as f32, 0.7, 0.3, 1.0]);
        figure.add_to(&mut world, at, turn, Vec3::NEG_Y * 10.0).unwrap();
    }
    builtin::chain(true).add_to(&mut world).unwrap();
    for i in 0..10 {
        common::joints_of_every_kind(&mut world, Vec3::new(0.0, 6.0, i as f32 - 5.0));
    }
    common::joints_without_colour(&mut world, Vec3::new(0.0, 8.0, 0.0));
    common::steps(&mut world, steps, 1.0 / 60.0);
    assert!(common::all_finite(&world));
    world.state_hash()
}

const JOINTS: u64 = 0xEA8E_E138_EB0A_22DA;

#[test]
fn every_build_and_any_number_of_threads_give_the_pinned_hash_of_joints() {
    let hash = joints_after(120, 1);
    println!("joints: 0x{hash:016X}");
    for threads in [2, 3, 8] {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
        assert_eq!(pool.install(|| joints_after(120, threads)), hash, "{threads} threads");
    }
    assert_eq!(hash, JOINTS, "0x{hash:016X}");
}

/// The order of additions and removals must not show: the same calls give the same bits.
#[test]
fn the_same_calls_give_the_same_bits() {
    let run = || {
        let (mut world, bodies) = common::world_of(&common::small_pile(), Settings::default());
        for (i, &body) in bodies.iter().enumerate().skip(5) {
            if i % 7 == 0 {
                world.remove_body(body).unwrap();
            }
            if i % 11 == 0 {
                let ball = Geometry::Sphere { radius: 0.3 };
                let at = DVec3::new(0.0, 20.0 + i as f64, 0.0);
                let desc = BodyDesc::dynamic().with_position(at).with_shape(backstop::ShapeDesc::new(ball));
                world.add_body(&desc.with_velocity(Vec3::NEG_Y * 30.0, Vec3::ZERO)).unwrap();
            }
            if i % 5 == 0 {
                world.step(1.0 / 60.0).unwrap();
            }
        }
        world.state_hash()
    };
    assert_eq!(run(), run());
}
