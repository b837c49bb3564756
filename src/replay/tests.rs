//! Recordings that were tampered with are detected, and the format is the one of its version.

use super::call::Call;
use super::compare::Divergence;
use super::file::{Block, VERSION, read_block, read_header, write_block, write_header};
use super::probe::Stage;
use super::{RecordingBuffer, Replay, ReplayError};
use crate::body::{BodyDesc, BodyKind};
use crate::character::{Character, CharacterSettings};
use crate::config::RowGroup;
use crate::config::{ContinuousMode, Settings};
use crate::handle::BodyHandle;
use crate::joint::{Axes, Axis, CouplingDesc, Frame, JointDesc, Limit, Motion, Motor, Spring};
use crate::load_limits::{LoadLimits, Tally};
use crate::memory::Budget;
use crate::shape::{
    ConvexHull, Filter, Geometry, HeightField, MassProperties, Material, ShapeDesc, TriangleMesh,
};
use crate::snapshot::Snapshot;
use crate::world::World;
use glam::{DVec3, Mat3, Vec2, Vec3};
use std::sync::Arc;

const STEPS: u64 = 40;
const PUSHED: u64 = 25;

/// Sixteen boxes fall on the floor; one is pushed before a step. Its handle, and the recording.
fn run() -> (BodyHandle, Vec<u8>) {
    let buffer = RecordingBuffer::default();
    let mut world = World::new(Settings::default()).unwrap();
    world.start_recording(buffer.clone()).unwrap();
    let shape = |geometry| ShapeDesc::new(geometry);
    world.add_body(&BodyDesc::fixed().with_shape(shape(Geometry::Plane))).unwrap();
    let mut bodies = Vec::new();
    for i in 0..16 {
        let at = DVec3::new(0.1 * f64::from(i % 3), 0.6 + 1.05 * f64::from(i), 0.0);
        let mut desc =
            BodyDesc::dynamic().with_position(at).with_shape(shape(Geometry::cuboid(0.5, 0.5, 0.5)));
        desc.user_data = 100 + i as u64;
        bodies.push(world.add_body(&desc).unwrap());
    }
    world.name_recorded(bodies[9], "the pushed one");
    for step in 1..=STEPS {
        if step == PUSHED {
            world.add_force(bodies[9], Vec3::X * 1e4).unwrap();
        }
        world.step(1.0 / 60.0).unwrap();
    }
    world.stop_recording().unwrap();
    (bodies[9], buffer.bytes())
}

/// The recording with its blocks changed, or others before them, and right checksums.
fn rewritten(bytes: &[u8], mut change: impl FnMut(Block, &mut Vec<u8>, &mut Vec<u8>)) -> Vec<u8> {
    let (mut from, mut to) = (bytes, Vec::new());
    read_header(&mut from).unwrap();
    write_header(&mut to).unwrap();
    loop {
        let (kind, mut payload) = read_block(&mut from, 0, &Tally::new(&LoadLimits::NONE).bytes).unwrap();
        change(kind, &mut payload, &mut to);
        write_block(&mut to, kind, &payload).unwrap();
        if kind == Block::End {
            return to;
        }
    }
}

/// The recording with its calls changed.
fn tampered(bytes: &[u8], mut change: impl FnMut(u64, &mut Call)) -> Vec<u8> {
    let mut step = 1;
    rewritten(bytes, |kind, payload, _| {
        if kind != Block::Calls {
            return;
        }
        let (mut rest, mut changed) = (&payload[..], Vec::new());
        while !rest.is_empty() {
            let (mut call, next) = postcard::take_from_bytes::<Call>(rest).unwrap();
            change(step, &mut call);
            step += u64::from(matches!(call, Call::Step(_)));
            changed = postcard::to_extend(&call, changed).unwrap();
            rest = next;
        }
        *payload = changed;
    })
}

fn divergence(bytes: &[u8]) -> Option<Divergence> {
    Replay::open(bytes).unwrap().run().unwrap().divergence
}

#[test]
fn a_changed_force_is_found_where_it_acts() {
    let (body, bytes) = run();
    assert_eq!(divergence(&tampered(&bytes, |_, _| {})), None);
    let forged = tampered(&bytes, |_, call| {
        if let Call::AddForce(_, force, _) = call {
            force.x += 0.001;
        }
    });
    let found = divergence(&forged).unwrap();
    assert_eq!((found.step, found.stage), (PUSHED, Stage::Forces));
    let named = found.body.as_ref().unwrap();
    assert_eq!((named.handle, named.user_data), (body, 109));
    assert_eq!(
        found.to_string().split(", ").take(2).collect::<Vec<_>>(),
        ["step 25 goes another way in stage forces", "first body 10.1 \"the pushed one\" (user data 109)"]
    );
}

#[test]
fn a_flipped_bit_of_a_hash_is_found_in_its_step_stage_and_body() {
    let (_, bytes) = run();
    for (at, stage) in Stage::HASHED.into_iter().enumerate() {
        let forged = tampered(&bytes, |step, call| {
            if let (7, Call::Step(record)) = (step, call) {
                record.stages[at][2] ^= 8;
            }
        });
        let found = divergence(&forged).unwrap();
        assert_eq!((found.step, found.stage, found.body, found.bodies), (7, stage, None, 0));
    }
    let forged = tampered(&bytes, |step, call| {
        if let (30, Call::Step(record)) = (step, call) {
            record.hash[0] ^= 1;
        }
    });
    let found = divergence(&forged).unwrap();
    assert_eq!((found.step, found.stage, found.hashes[0] ^ found.hashes[1]), (30, Stage::Finish, 1));
    // Bodies count by their slots; the floor, which can't move, is the first.
    let forged = tampered(&bytes, |step, call| {
        if let (31, Call::Step(record)) = (step, call) {
            record.bodies[4][1] ^= 128;
        }
    });
    let found = divergence(&forged).unwrap();
    assert_eq!((found.step, found.stage, found.bodies), (31, Stage::Finish, 1));
    assert_eq!(found.body.unwrap().user_data, 104);
}

#[test]
fn a_call_that_is_refused_is_named() {
    let (_, bytes) = run();
    let forged = tampered(&bytes, |_, call| {
        if let Call::AddForce(body, ..) = call {
            body.generation += 1;
        }
    });
    let found = divergence(&forged).unwrap();
    assert_eq!(
        (found.step, found.stage, found.refused.clone().unwrap().0),
        (PUSHED, Stage::Calls, "add_force_and_torque")
    );
    assert!(
        found.to_string().contains("add_force_and_torque is refused: the body handle is stale"),
        "{found}"
    );
}

/// Shared geometry and a mesh's tree, too.
fn run_with_shapes() -> Vec<u8> {
    let buffer = RecordingBuffer::default();
    let mut world = World::new(Settings::default()).unwrap();
    world.start_recording(buffer.clone()).unwrap();
    let (vertices, triangles) = crate::random::bumps(8, 1.0);
    let mesh = Geometry::Mesh(Arc::new(TriangleMesh::new(vertices, triangles).unwrap()));
    let field = HeightField::new(3, 3, Vec2::ONE, vec![0.0, 0.5, 0.0, 0.5, 0.0, 0.5, 0.0, 0.5, 0.0]).unwrap();
    for geometry in [mesh, Geometry::HeightField(Arc::new(field))] {
        world.add_body(&BodyDesc::fixed().with_shape(ShapeDesc::new(geometry))).unwrap();
    }
    let corners = [Vec3::ZERO, Vec3::X, Vec3::Y, Vec3::Z, Vec3::ONE];
    let hull = Geometry::Hull(Arc::new(ConvexHull::new(&corners).unwrap()));
    let falling =
        BodyDesc::dynamic().with_position(DVec3::new(0.0, 3.0, 0.0)).with_shape(ShapeDesc::new(hull));
    let falling = [world.add_body(&falling).unwrap(), world.add_body(&falling).unwrap()];
    every_type(&mut world, falling);
    for _ in 0..8 {
        world.step(1.0 / 60.0).unwrap();
    }
    world.stop_recording().unwrap();
    buffer.bytes()
}

/// Calls with each type that there is in calls.
fn every_type(world: &mut World, bodies: [BodyHandle; 2]) {
    let shape = world.shapes(bodies[0]).unwrap().next().unwrap();
    let frames = [Frame::at(Vec3::X), Frame::default()];
    let spring = Spring::Frequency { hertz: 2.0, ratio: 1.0 };
    let drive = Motor::position(Motion::Angular, Axis::Y, 0.1, spring);
    let limit = Limit::new(Motion::Linear, Axes::All, 0.0, 2.0).with_spring(spring);
    let joint = world.add_joint(&JointDesc::new(bodies, frames).with_limit(limit).with_motor(drive)).unwrap();
    world.set_joint_limits(joint, &[limit]).unwrap();
    world.set_joint_motors(joint, &[drive]).unwrap();
    world.set_joint_limit(joint, limit.with_range(0.0, 3.0)).unwrap();
    world.set_joint_motor(joint, drive.with_max_force(7.0)).unwrap();
    world.set_joint_target(joint, Motion::Angular, Axis::Y, 0.2, 0.1).unwrap();
    world.set_joint_frames(joint, frames).unwrap();
    world.set_joint_collide(joint, true).unwrap();
    world.set_joint_break_force(joint, 1e9, f32::INFINITY).unwrap();
    world.set_joint_thresholds(joint, 1e9, f32::INFINITY).unwrap();
    world.set_joint_user_data(joint, 5).unwrap();
    assert!(world.remove_joint_motor(joint, Motion::Angular, Axis::Y).unwrap());
    assert!(world.remove_joint_limit(joint, Motion::Linear, Axes::All).unwrap());
    world.set_joint_solved_after(joint, Some(RowGroup::Contacts)).unwrap();
    let rope = world.add_joint(&JointDesc::new(bodies, frames)).unwrap();
    let coupling = world.add_coupling(&CouplingDesc::pulley([joint, rope], 2.0, 9.0)).unwrap();
    world.set_coupling_factors(coupling, [1.0, 1.5]).unwrap();
    world.set_coupling_range(coupling, Some([-1.0, 9.0])).unwrap();
    world.set_coupling_break_force(coupling, [1e9, 1e8]).unwrap();
    world.set_coupling_user_data(coupling, 6).unwrap();
    let second = world.add_coupling(&CouplingDesc::screw(joint, 0.1)).unwrap();
    world.remove_coupling(second).unwrap();
    world.set_body_solved_after(bodies[1], Some(RowGroup::StaticContacts)).unwrap();
    world.set_settings(Settings { budget: Budget::total(1 << 24), ..Settings::default() }).unwrap();
    world.set_origin(DVec3::X).unwrap();
    world.set_material(shape, Material::default().with_restitution(0.25)).unwrap();
    world.set_filter(shape, Filter::default().with_category(3)).unwrap();
    world.set_continuous(bodies[0], ContinuousMode::Volume).unwrap();
    let mass = MassProperties { mass: 2.0, centre_of_mass: Vec3::ZERO, inertia: Mat3::IDENTITY };
    world.set_mass(bodies[0], mass).unwrap();
    world.set_pose(bodies[0], DVec3::Y * 4.0, glam::Quat::IDENTITY).unwrap();
    world.apply_impulse_at(bodies[0], Vec3::X, DVec3::ZERO).unwrap();
    world.set_damping(bodies[0], 0.5, 0.25).unwrap();
    world.set_max_speeds(bodies[0], Some(50.0), None).unwrap();
    world.set_locked_axes(bodies[0], [false; 3], [true, false, false]).unwrap();
    world.move_kinematic(bodies[1], DVec3::Y * 3.0, glam::Quat::IDENTITY, 0.02).unwrap();
    world.set_kind(bodies[1], BodyKind::Kinematic).unwrap();
    world.move_kinematic_and_stop(bodies[1], DVec3::Y * 2.0, glam::Quat::IDENTITY, 0.02).unwrap();
    world.set_geometry(shape, Geometry::Sphere { radius: 0.25 }).unwrap();
    world.set_shape_pose(shape, Vec3::X * 0.1, glam::Quat::IDENTITY).unwrap();
    world.set_density(shape, 500.0).unwrap();
    world.set_shape_user_data(shape, 3).unwrap();
    let walker = Character::new(CharacterSettings::default(), DVec3::Y * 3.0).unwrap();
    let character = world.add_character(&walker).unwrap();
    let walker = walker.with_shape(Geometry::cuboid(0.3, 0.9, 0.3)).unwrap();
    world.set_character(character, &walker).unwrap();
    world.remove_character(character).unwrap();
    let mut now = Snapshot::new();
    world.snapshot(&mut now);
    world.restore(&now).unwrap();
}

/// Checksums do not protect against an attacker, who can compute them.
#[test]
fn nonsense_with_a_right_checksum_does_not_panic() {
    let bytes = run_with_shapes();
    let mut random = crate::random::Random(1);
    let (mut refused, mut diverged, mut same) = (0, 0, 0);
    for _ in 0..1500 {
        let nonsense = rewritten(&bytes, |kind, payload, _| {
            if kind != Block::End {
                for _ in 0..random.below(3) {
                    let bit = random.below(8 * payload.len());
                    payload[bit / 8] ^= 1 << (bit % 8);
                }
                if random.below(20) == 0 {
                    payload.truncate(random.below(payload.len()));
                }
            }
        });
        match Replay::open(&nonsense[..]).and_then(|mut replay| replay.run()) {
            Ok(played) if played.divergence.is_some() => diverged += 1,
            Ok(_) => same += 1,
            Err(ReplayError::Io(error)) => panic!("{error}"),
            Err(_) => refused += 1,
        }
    }
    println!("{refused} refused, {diverged} went another way, {same} the same");
    assert!(refused > 100 && diverged > 100);
}

/// Without steps, whose hashes are of the engine, and without the bytes of snapshots, which have a version.
#[test]
fn the_format_is_that_of_its_version() {
    let bytes = tampered(&run_with_shapes(), |_, call| {
        if let Call::Step(record) = call {
            (record.stages, record.hash, record.dt) = Default::default();
            record.touched.iter_mut().for_each(|touched| touched.1 = [0; 2]);
            record.bodies.iter_mut().for_each(|body| *body = [0; 2]);
        }
        if let Call::Part(bytes, ..) | Call::Restore(bytes, ..) = call {
            bytes.clear();
        }
    });
    let (mut from, mut payloads) = (&bytes[..], Vec::new());
    read_header(&mut from).unwrap();
    while let Ok((kind, payload)) = read_block(&mut from, 0, &Tally::new(&LoadLimits::NONE).bytes) {
        // The start begins with the version of backstop.
        let skipped = if kind == Block::Start { 1 + env!("CARGO_PKG_VERSION").len() } else { 0 };
        payloads.extend_from_slice(&payload[skipped..]);
    }
    let sum = crc32fast::hash(&payloads);
    assert_eq!(
        (VERSION, sum),
        (7, 0xFF70_4798),
        "0x{sum:08X}: what is written has changed, so VERSION has to"
    );
}

/// A few bytes say that another geometry has the content of an earlier one: 482 KB of such calls took over
/// 8.6 GB. Expected: as many copies as the limit has place for, and an error by its name.
#[test]
fn copies_of_geometry_are_bounded_by_their_bytes() {
    let bytes = run_with_shapes();
    let (vertices, triangles) = crate::random::bumps(8, 1.0);
    let mesh = TriangleMesh::new(vertices, triangles).unwrap().bytes().1;
    let again = postcard::to_stdvec(&Call::Again(0)).unwrap();
    let copied = rewritten(&bytes, |kind, _, to| {
        if kind == Block::End {
            write_block(to, Block::Calls, &again.repeat(100_000)).unwrap();
        }
    });
    let limits = LoadLimits { memory: 64 << 20, ..LoadLimits::default() };
    let mut replay = Replay::open_limited(&copied[..], &limits, |_| {}).unwrap();
    match replay.run() {
        Err(ReplayError::Limit { steps: 8, source }) => {
            assert_eq!((source.limit, source.most), ("memory", 64 << 20));
        }
        other => panic!("{other:?}"),
    }
    let copies = replay.geometries.count();
    // Beside the three that are not copies.
    assert!(copies <= (64 << 20) / mesh + 3 && copies > (32 << 20) / mesh, "{copies} of {mesh} bytes");
}

/// Expected: each limit is refused by its name, and with exactly the bytes of the recording it plays, to the
/// same hashes: a budget that suffices changes nothing.
#[test]
fn limits_of_a_recording_have_their_names() {
    let bytes = run_with_shapes();
    let run =
        |limits: &LoadLimits| Replay::open_limited(&bytes[..], limits, |_| {}).and_then(|mut r| r.run());
    let most = |name: &str| match name {
        // As in `run_with_shapes`.
        "bodies" => 4,
        // Two, with two couplings.
        "joints" => 4,
        // Those of the terrain, two for each of 64 squares, and those of a field of nine heights.
        "triangles" => 2 * 64 + 2 * 9,
        "vertices" => 81 + 9 + 5,
        _ => unreachable!(),
    };
    for name in ["bodies", "joints", "triangles", "vertices"] {
        let limits = |most: u64| {
            let mut limits = LoadLimits::default();
            *match name {
                "bodies" => &mut limits.bodies,
                "joints" => &mut limits.joints,
                "triangles" => &mut limits.triangles,
                _ => &mut limits.vertices,
            } = most;
            limits
        };
        assert_eq!(run(&limits(most(name))).unwrap().divergence, None, "{name}");
        match run(&limits(most(name) - 1)) {
            Err(ReplayError::Limit { source, .. }) => {
                assert_eq!((source.limit, source.most), (name, most(name) - 1));
            }
            other => panic!("{name}: {other:?}"),
        }
    }
    let limits = LoadLimits { bytes: 100, ..LoadLimits::default() };
    assert!(matches!(run(&limits), Err(ReplayError::Limit { source, .. }) if source.limit == "bytes"));
}

/// Two hundred boxes at one point are 20,000 pairs. Expected: within a memory that holds them the recording
/// plays as it was, in less it is refused in the step that needs more, and not one byte beyond is reserved.
#[test]
fn the_world_of_a_recording_keeps_to_its_memory() {
    let buffer = RecordingBuffer::default();
    let mut world = World::new(Settings::default()).unwrap();
    world.start_recording(buffer.clone()).unwrap();
    let cube = BodyDesc::dynamic().with_shape(ShapeDesc::new(Geometry::cuboid(0.5, 0.5, 0.5)));
    world.add_bodies(&vec![cube; 200]).unwrap();
    for _ in 0..3 {
        world.step(1.0 / 60.0).unwrap();
    }
    world.stop_recording().unwrap();
    let bytes = buffer.bytes();
    let mut limits = LoadLimits::default();
    assert_eq!(Replay::open_limited(&bytes[..], &limits, |_| {}).unwrap().run().unwrap().divergence, None);
    for memory in [1 << 20, 10_000] {
        limits.memory = memory;
        let mut replay = Replay::open_limited(&bytes[..], &limits, |_| {}).unwrap();
        match replay.run() {
            Err(ReplayError::Limit { steps: 0, source }) => {
                assert_eq!((source.limit, source.most), ("memory", memory));
            }
            other => panic!("{memory}: {other:?}"),
        }
        assert!(replay.world().memory().total() as u64 <= memory);
    }
}
