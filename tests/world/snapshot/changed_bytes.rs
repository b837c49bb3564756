//! Bytes of snapshots that somebody changed, with the checksum put right: each is refused and leaves the
//! world as it was, or the world can be stepped on, without a panic and with numbers only.

use crate::common::{self, random::Random};
use backstop::glam::{DVec3, Quat, Vec2, Vec3};
use backstop::{
    Axis, BodyDesc, BodyHandle, ConvexHull, Geometry, HeightField, JointDesc, Motion, Motor, Settings,
    ShapeDesc, Snapshot, TriangleMesh, World,
};
use std::sync::Arc;

const DT: f32 = 1.0 / 60.0;
/// Words of the head, of which the last two are the checksum.
const HEAD: usize = 14;

/// Geometry of the worlds, built once.
struct Shared {
    hull: Arc<ConvexHull>,
    mesh: Arc<TriangleMesh>,
    field: Arc<HeightField>,
}

impl Shared {
    fn new() -> Shared {
        let corners = (0..8).map(|i| Vec3::new((i & 1) as f32, (i >> 1 & 1) as f32, (i >> 2) as f32) - 0.5);
        let corners: Vec<Vec3> = corners.map(|v| v.normalize() * 0.4).collect();
        let Geometry::Mesh(mesh) = common::flat_mesh(3, 1.0) else { unreachable!() };
        let heights = (0..20).map(|i| (i % 3) as f32 * 0.1).collect();
        Shared {
            hull: ConvexHull::new(&corners).unwrap().into(),
            mesh,
            field: HeightField::new(5, 4, Vec2::ONE, heights).unwrap().into(),
        }
    }
}

/// A little of everything, some of which sleeps, in different worlds by their number.
fn world(which: usize, shared: &Shared) -> World {
    let settings = Settings::default()
        .with_sleeping(which != 1)
        .with_sleep_time(0.1)
        .with_gravity(if which == 2 { Vec3::ZERO } else { Vec3::Y * -9.81 });
    let mut world = World::new(settings).unwrap();
    let fixed = |at: DVec3, geometry: Geometry| {
        BodyDesc::fixed().with_position(at).with_shape(ShapeDesc::new(geometry))
    };
    world.add_body(&fixed(DVec3::Y * -0.5, Geometry::cuboid(6.0, 0.5, 6.0))).unwrap();
    world.add_body(&fixed(DVec3::Y * 0.02, Geometry::Mesh(shared.mesh.clone()))).unwrap();
    world.add_body(&fixed(DVec3::X * 8.0, Geometry::HeightField(shared.field.clone()))).unwrap();
    if which == 1 {
        world.add_body(&fixed(DVec3::Y * -0.3, Geometry::Plane)).unwrap();
    }
    let sensor = ShapeDesc::new(Geometry::Sphere { radius: 2.0 }).as_sensor().with_events();
    world.add_body(&BodyDesc::fixed().with_shape(sensor)).unwrap();
    let bodies: Vec<BodyHandle> = (0..12)
        .map(|i| {
            let geometry = match i % 5 {
                0 => Geometry::Sphere { radius: 0.3 },
                1 => Geometry::capsule(0.3, 0.2),
                2 => Geometry::cuboid(0.3, 0.2, 0.4),
                3 => Geometry::cylinder(0.3, 0.3),
                _ => Geometry::Hull(shared.hull.clone()),
            };
            let mut shape = ShapeDesc::new(geometry).with_events();
            shape.material.restitution = if which == 1 { 0.5 } else { 0.0 };
            shape.material.rolling_friction = if which == 1 { 0.02 } else { 0.0 };
            shape.material.contact_hertz = if which == 1 && i % 3 == 0 { 10.0 } else { 0.0 };
            let at = DVec3::new(f64::from(i % 4) - 2.0, 0.4 + f64::from(i / 4) * 0.7, f64::from(i % 3));
            world.add_body(&BodyDesc::dynamic().with_position(at).with_shape(shape)).unwrap()
        })
        .collect();
    let mut lift = ShapeDesc::new(Geometry::cuboid(0.5, 0.1, 0.5));
    lift.material.surface_velocity = if which == 1 { Vec3::Z } else { Vec3::ZERO };
    let lift = BodyDesc::kinematic().with_position(DVec3::new(3.0, 1.0, 3.0)).with_shape(lift);
    world.add_body(&lift.clone().with_velocity(Vec3::X, Vec3::Y)).unwrap();
    world.add_body(&lift.with_position(DVec3::new(-3.0, 1.0, -3.0))).unwrap();
    let rider = ShapeDesc::new(Geometry::cuboid(0.2, 0.2, 0.2));
    for x in [-3.3, -2.7] {
        let rider = BodyDesc::dynamic().with_position(DVec3::new(x, 1.3, -3.0)).with_shape(rider.clone());
        world.add_body(&rider).unwrap();
    }
    for i in 0..if which == 2 { 6 } else { 3 } {
        let pair = [bodies[i], bodies[i + 1]];
        let frames = world.frames_at(pair, world.position(pair[0]).unwrap(), Quat::IDENTITY).unwrap();
        let joint = match i % 5 {
            0 => JointDesc::ball(pair, frames),
            1 => JointDesc::hinge(pair, frames).with_motor(Motor::velocity(
                Motion::Angular,
                Axis::X,
                3.0,
                10.0,
            )),
            2 => JointDesc::slider(pair, frames),
            3 => JointDesc::distance(pair, frames, 0.1, 2.0).with_break_force(1e5, 1e5),
            _ => JointDesc::fixed(pair, frames),
        };
        world.add_joint(&joint).unwrap();
    }
    world.remove_body(bodies[11]).unwrap();
    world.set_enabled(bodies[6], false).unwrap();
    for _ in 0..40 {
        world.step(DT).unwrap();
    }
    world.add_force_and_torque(bodies[8], Vec3::Y, Vec3::X).unwrap();
    world
}

fn words_of(bytes: &[u8]) -> Vec<u32> {
    bytes.chunks_exact(4).map(|four| u32::from_le_bytes(four.try_into().unwrap())).collect()
}

/// Flips a bit, puts in a number, moves or copies a word, scales a float.
fn change(rng: &mut Random, words: &mut [u32]) {
    const SPECIAL: [u32; 18] = [
        0,
        1,
        2,
        3,
        7,
        0xff,
        0xffff,
        0x1_0000,
        u32::MAX,
        0x7f80_0000,
        0xff80_0000,
        0x7fc0_0000,
        0x7f7f_ffff,
        0x3f80_0000,
        0xbf80_0000,
        0x8000_0000,
        0x0000_0001,
        0x5a00_0000,
    ];
    for _ in 0..1 + rng.below(4) {
        // Counts and settings come first, and break most; a few in all.
        let end = if rng.below(4) == 0 { words.len().min(90) } else { words.len() };
        let (at, other) = (HEAD + rng.below(end - HEAD), HEAD + rng.below(words.len() - HEAD));
        match rng.below(10) {
            0 | 1 => words[at] ^= 1 << rng.below(32),
            2 => words[at] = rng.bits() as u32,
            3 | 4 => words[at] = SPECIAL[rng.below(SPECIAL.len())],
            5 => words[at] = words[at].wrapping_add(1),
            6 => words[at] = words[at].wrapping_sub(1),
            7 => words.swap(at, other),
            8 => words[at] = words[other],
            _ => {
                let by = [-1.0, 1e-20, 1e20, 1e6, 0.0, 3.0][rng.below(6)];
                words[at] = (f32::from_bits(words[at]) * by).to_bits();
            }
        }
    }
}

/// Refused and unchanged, or taken and stepped on.
fn is_taken(world: &mut World, bytes: &[u8], good: &Snapshot) -> bool {
    let before = world.state_hash();
    let restored = Snapshot::from_bytes(bytes).and_then(|snapshot| world.restore(&snapshot));
    if restored.is_ok() {
        for _ in 0..3 {
            world.step(DT).unwrap();
            assert!(common::all_finite(world), "a step left what is no number");
        }
        let bodies: Vec<BodyHandle> = world.bodies().collect();
        bodies.into_iter().step_by(3).for_each(|body| world.remove_body(body).unwrap());
        world.step(DT).unwrap();
        world.restore(good).unwrap();
    }
    assert_eq!(world.state_hash(), before, "a refusal changed the world");
    restored.is_ok()
}

/// As many as `count` of changed snapshots; how many were taken.
fn try_all(seed: u64, count: usize) -> usize {
    let shared = Shared::new();
    let mut worlds: Vec<(World, Snapshot, [Vec<u32>; 2])> = (0..3)
        .map(|which| {
            let (world, mut good) = (world(which, &shared), Snapshot::new());
            world.snapshot(&mut good);
            let words = [words_of(&good.to_bytes()), words_of(&good.to_whole_bytes())];
            (world, good, words)
        })
        .collect();
    let mut taken = 0;
    for round in 0..count {
        let mut rng = Random(seed.wrapping_add(round as u64));
        let (which, whole) = (rng.below(3), usize::from(rng.below(3) > 0));
        let (world, good, words) = &mut worlds[which];
        let mut words = words[whole].clone();
        change(&mut rng, &mut words);
        let mut bytes: Vec<u8> = words.iter().flat_map(|word| word.to_le_bytes()).collect();
        common::snapshots::fix_checksum(&mut bytes);
        let tried = std::panic::catch_unwind(std::panic::AssertUnwindSafe(|| is_taken(world, &bytes, good)));
        match tried {
            Ok(was_taken) => taken += usize::from(was_taken),
            Err(_) => {
                println!("FOUND world {which}, whole {whole}, round {}", seed + round as u64);
                assert!(std::env::var("KEEP_GOING").is_ok());
                world_again(&mut worlds[which], which, &shared);
            }
        }
    }
    taken
}

fn world_again(place: &mut (World, Snapshot, [Vec<u32>; 2]), which: usize, shared: &Shared) {
    place.0 = world(which, shared);
    place.0.snapshot(&mut place.1);
}

#[test]
fn changed_bytes_are_refused_or_can_be_stepped_on() {
    let taken = try_all(0, 12_000);
    println!("{taken} taken");
    assert!((1_000..11_000).contains(&taken), "the changes find their mark, and miss it: {taken}");
}

/// As many as one has time for: `CHANGES=200000 cargo test --release --test world -- changed_bytes::
/// --ignored --nocapture`.
#[test]
#[ignore = "runs as long as it is told to"]
fn many_changed_bytes_are_refused_or_can_be_stepped_on() {
    let [count, seed] = [("CHANGES", 20_000), ("SEED", 1_000_000)]
        .map(|(name, usual)| std::env::var(name).map_or(usual, |count| count.parse().unwrap()));
    println!("{} of {count} taken", try_all(seed as u64, count));
}
