//! Soft materials of triangles and cells: they bear bodies as soft shapes do, g / (2 pi f)² deep.

#![allow(clippy::disallowed_methods, reason = "expected values may use the platform's functions")]

use super::common::{self, G, dynamic};
use super::materials::{grounds, world_of};
use backstop::glam::{DVec3, Vec3};
use backstop::{BodyHandle, Combine, Feature, Geometry, Material, Settings, ShapeHandle, Snapshot, World};

const DT: f32 = 1.0 / 60.0;

fn soft(hertz: f32, damping: f32) -> Material {
    Material::default().with_contact_hertz(hertz).with_contact_damping(damping)
}

/// How deep a body rests [m].
fn sag(hertz: f64) -> f64 {
    G / (std::f64::consts::TAU * hertz).powi(2)
}

/// Rigid where x < 0, of 8 Hz beyond it and of 5 Hz where z > 0 too.
fn patches() -> [(Geometry, DVec3); 2] {
    grounds(|x, z| if x < 0.0 { 0 } else { 1 + u8::from(z > 0.0) }, &[soft(8.0, 1.0), soft(5.0, 0.4)])
}

const HALF: f64 = 0.5;
/// Overlap with a rigid surface [m].
const RIGID: f64 = 1e-3;

/// A ball and a box on each of the three patches.
fn guests(world: &mut World) -> Vec<(BodyHandle, usize)> {
    let forms = [Geometry::sphere(0.5), Geometry::cuboid(0.6, 0.5, 0.4)];
    let places = [(-7.0, 0), (3.0, 1), (3.0, 2)];
    let mut found = Vec::new();
    for (i, form) in forms.into_iter().enumerate() {
        for (x, patch) in places {
            let z = if patch == 2 { 2.3 + 2.0 * i as f32 } else { -2.3 - 2.0 * i as f32 };
            let at = Vec3::new(x + 0.1, 0.5, z);
            found.push((world.add_body(&dynamic(form.clone(), Material::default(), at)).unwrap(), patch));
        }
    }
    found
}

fn depth(world: &World, body: BodyHandle) -> f64 {
    HALF - world.position(body).unwrap().y
}

fn check(world: &World, guests: &[(BodyHandle, usize)], expected: [f64; 3], what: &str) {
    for (i, &(body, patch)) in guests.iter().enumerate() {
        let (depth, expected) = (depth(world, body), expected[patch]);
        let within = if expected > 0.0 { 0.01 * expected } else { RIGID };
        assert!((depth - expected).abs() < within, "{what}, {i}: {depth} for {expected}");
    }
}

fn set_own(world: &mut World, shape: ShapeHandle, material: Material) {
    world.set_material(shape, material).unwrap();
}

/// Expected: g / omega² on the soft patches, nothing beside them, at any rate; so too on the shape's own
/// material once that is soft, and on rigid triangles of a soft shape.
#[test]
fn a_body_sinks_on_soft_triangles_alone() {
    for (ground, mesh) in patches().iter().zip(["mesh", "field"]) {
        for (rate, substeps) in [(60.0, 4), (30.0, 8), (120.0, 1), (240.0, 2)] {
            let (mut world, shape) = world_of(ground, Settings::default().with_substeps(substeps));
            let guests = guests(&mut world);
            let settle = |world: &mut World, expected: [f64; 3], what: &str| {
                common::steps(world, (8.0 * rate) as u32, 1.0 / rate);
                check(world, &guests, expected, &format!("{mesh} {rate}/s x{substeps}, {what}"));
            };
            let own = world.material(shape).unwrap();
            settle(&mut world, [0.0, sag(8.0), sag(5.0)], "as made");
            set_own(&mut world, shape, own.with_contact_hertz(6.0));
            settle(&mut world, [sag(6.0), sag(8.0), sag(5.0)], "its own soft too");
            set_own(&mut world, shape, own);
            settle(&mut world, [0.0, sag(8.0), sag(5.0)], "its own rigid again");
        }
    }
    for ground in &grounds(|x, _| u8::from(x < 0.0), &[Material::default()]) {
        let (mut world, shape) = world_of(ground, Settings::default());
        set_own(&mut world, shape, soft(8.0, 1.0));
        let guests = guests(&mut world);
        common::steps(&mut world, 480, DT);
        check(&world, &guests, [0.0, sag(8.0), sag(8.0)], "a rigid patch");
    }
}

/// A ball that falls by half a metre on a patch of 10 Hz without damping, and one beside it on a patch of
/// restitution 0.5. Expected: the first comes back with its energy for a minute, and with no more; the second
/// rises to a quarter of the height.
#[test]
fn a_ball_bounces_on_a_soft_patch_beside_one_of_restitution() {
    let own = Material::default().with_restitution_combine(Combine::Maximum);
    let table = [own.with_restitution(0.5), soft(10.0, 0.0).with_restitution(1.0)];
    for ground in &grounds(|x, _| 1 + u8::from(x > 0.0), &table) {
        let (mut world, _) = world_of(ground, Settings::default());
        let [plain, springs] = [-3.1, 3.1].map(|x| {
            let ball = dynamic(Geometry::sphere(0.5), own, Vec3::new(x, 1.0, 0.2));
            world.add_body(&ball).unwrap()
        });
        let start = G;
        let (mut first, mut last, mut most, mut deepest) = (0.0_f64, 0.0_f64, 0.0_f64, 0.0_f64);
        for step in 0..3600 {
            world.step(DT).unwrap();
            let (y, v) = (world.position(springs).unwrap().y, world.linear_velocity(springs).unwrap().y);
            deepest = deepest.max(HALF - y);
            if y > HALF {
                most = most.max(0.5 * f64::from(v).powi(2) + G * y);
            }
            if step > 3480 {
                last = last.max(y - HALF);
            }
            if (22..60).contains(&step) {
                first = first.max(world.position(plain).unwrap().y - HALF);
            }
        }
        let sag = sag(10.0);
        let expected = sag + (sag * sag + 2.0 * sag * 0.5).sqrt();
        println!(
            "depth {deepest} of {expected}, {most} of {start} J/kg, back at {last}, the other at {first}"
        );
        assert!((deepest / expected - 1.0).abs() < 0.05, "{deepest} for {expected}");
        assert!(most < start * (1.0 + 2e-5) && last > 0.45, "{most} {last}");
        assert!((first - 0.125).abs() < 0.01, "{first}");
    }
}

/// Expected: the same bits on one thread and two, from a snapshot and from its bytes, in the midst of a fall.
#[test]
fn soft_triangles_give_the_same_bits_everywhere() {
    for ground in &patches() {
        let run = |threads: usize, restored: bool| {
            let settings = Settings::default().with_threads(threads).with_sleeping(true);
            let (mut world, _) = world_of(ground, settings);
            let guests = guests(&mut world);
            for (i, &(body, _)) in guests.iter().enumerate() {
                world.set_linear_velocity(body, Vec3::new(0.4, 1.0 + i as f32, 0.3)).unwrap();
            }
            common::steps(&mut world, 40, DT);
            if restored {
                let mut snapshot = Snapshot::new();
                world.snapshot(&mut snapshot);
                let bytes = snapshot.to_whole_bytes();
                common::steps(&mut world, 30, DT);
                world.restore(&Snapshot::from_bytes(&bytes).unwrap()).unwrap();
            }
            common::steps(&mut world, 600, DT);
            (world.state_hash(), guests.iter().filter(|(body, _)| world.is_sleeping(*body).unwrap()).count())
        };
        let (hash, asleep) = run(1, false);
        assert_eq!((run(2, false).0, run(1, true).0, run(2, true).0), (hash, hash, hash));
        assert!(asleep > 2, "{asleep}");
    }
}

/// Grounds that are exchanged, and heights that are written. Expected: bodies come up to a rigid ground and
/// sink again; the model counts a soft shape only while there is one, and its bytes are given back.
#[test]
fn soft_triangles_come_and_go() {
    let plain = grounds(|_, _| 0, &[]);
    for (ground, plain) in patches().iter().zip(&plain) {
        let (mut world, shape) = world_of(ground, Settings::default());
        let guests = guests(&mut world);
        let part = |world: &World| world.feature_report().part(Feature::SoftContacts);
        for round in 0..3 {
            common::steps(&mut world, 480, DT);
            check(&world, &guests, [0.0, sag(8.0), sag(5.0)], "soft");
            assert!(part(&world).count == 1 && part(&world).bytes > 0, "{:?}", part(&world));
            if let Geometry::HeightField(_) = world.geometry(shape).unwrap() {
                world.set_heights(shape, [26, 4], [2, 2], &[0.0; 4]).unwrap();
                assert_eq!(part(&world).count, 1);
            }
            world.set_geometry(shape, plain.0.clone()).unwrap();
            assert_eq!(part(&world).count, 0, "round {round}");
            common::steps(&mut world, 480, DT);
            check(&world, &guests, [0.0; 3], "plain");
            assert_eq!((part(&world).count, part(&world).bytes), (0, 0), "round {round}");
            world.set_geometry(shape, ground.0.clone()).unwrap();
        }
        let body = world.body_of(shape).unwrap();
        world.remove_body(body).unwrap();
        common::steps(&mut world, 2, DT);
        assert_eq!((part(&world).count, part(&world).bytes), (0, 0));
    }
}
