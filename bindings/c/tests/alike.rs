//! Characters, driven ragdolls, turning casts, changing heights and recordings do through the interface what
//! they do in Rust: expected values are those of the crate `backstop`, bit by bit.

mod common;

use backstop::glam::{DVec3, Quat, Vec2, Vec3};
use backstop::{
    BodyDesc, BodyHandle, Character, CharacterSettings, Geometry, HeightField, JointHandle, QueryFilter,
    Settings, ShapeCast, ShapeDesc, Skeleton, Spring,
};
use backstop_c::*;
use common::*;
use std::ffi::CStr;
use std::ptr::{null, null_mut};
use std::sync::Arc;

const DT: f32 = 1.0 / 60.0;
const NOBODY: BsWorldCharacter = BsWorldCharacter { slot: 0, generation: 0 };

/// A floor with a step and a crate, in both.
fn rooms() -> (World, backstop::World) {
    let (c, mut rust) = (world(), backstop::World::new(Settings::default()).unwrap());
    let mut both = |kind, desc: BodyDesc, geometry: Geometry, own, at: DVec3| {
        rust.add_body(&desc.with_position(at).with_shape(ShapeDesc::new(geometry))).unwrap();
        add(&c, kind, own, at.into());
    };
    both(BS_BODY_STATIC, BodyDesc::fixed(), Geometry::Plane, bs_plane(), DVec3::ZERO);
    let (step, own) = (Geometry::cuboid(0.5, 0.1, 2.0), bs_box(0.5, 0.1, 2.0));
    both(BS_BODY_STATIC, BodyDesc::fixed(), step, own, DVec3::new(2.0, 0.1, 0.0));
    let (chest, own) = (Geometry::cuboid(0.3, 0.3, 0.3), bs_box(0.3, 0.3, 0.3));
    both(BS_BODY_DYNAMIC, BodyDesc::dynamic(), chest, own, DVec3::new(4.0, 0.3, 0.0));
    (c, rust)
}

fn character(at: BsDVec3) -> *mut BsCharacter {
    let mut character = null_mut();
    // SAFETY: the place is one.
    ok(unsafe { bs_character_create(null(), at, &mut character) });
    character
}

/// A capsule and a box walk two seconds over a step and into a chest, which they push. Expected: the hash of
/// the world in Rust after every step, and a snapshot has the characters.
#[test]
fn characters_of_a_world_walk_alike() {
    let (c, mut rust) = rooms();
    let (capsule, boxed) = (character(dvec3(0.0, 1.0, 0.0)), character(dvec3(0.0, 1.0, 1.0)));
    let shape = bs_box(0.3, 0.6, 0.3);
    let turn = Quat::from_xyzw(0.0, 0.6, 0.0, 0.8);
    let mut handles = [NOBODY; 2];
    // SAFETY: all objects are alive, and all places are.
    unsafe {
        ok(bs_character_set_shape(boxed, &shape));
        ok(bs_character_set_rotation(boxed, turn.into()));
        ok(bs_world_add_character(c.0, capsule, &mut handles[0]));
        ok(bs_world_add_character(c.0, boxed, &mut handles[1]));
    }
    let made = |z: f64| Character::new(CharacterSettings::default(), DVec3::new(0.0, 1.0, z)).unwrap();
    let mut box_in_rust = made(1.0).with_shape(Geometry::cuboid(0.3, 0.6, 0.3)).unwrap();
    box_in_rust.set_rotation(turn).unwrap();
    let twins = [made(0.0), box_in_rust].map(|made| rust.add_character(&made).unwrap());
    let mut report = BsCharacterReport::default();
    let mut velocities = [Vec3::ZERO; 2];
    let mut pushes = 0;
    for step in 0..120 {
        steps(&c, 1);
        rust.step(DT).unwrap();
        for i in 0..2 {
            let velocity = Vec3::new(2.5, velocities[i].y - 9.81 * DT, 0.0);
            let told = rust.walk_character(twins[i], &QueryFilter::new(), velocity, DT).unwrap();
            told.push(&mut rust).unwrap();
            velocities[i] = told.velocity;
            pushes += told.hits().filter(|hit| hit.impulse != Vec3::ZERO).count();
            // SAFETY: all objects are alive, and all places are.
            unsafe {
                let (to, copy) = (velocity.into(), capsule);
                ok(bs_world_walk_character(c.0, handles[i], null(), to, DT, &mut report, copy));
                ok(bs_character_push(copy, c.0));
            }
            assert_eq!((report.moved, report.velocity), (told.moved.into(), told.velocity.into()));
            assert_eq!(report.on_ground != 0, told.ground.is_some());
        }
        assert_eq!(hash(&c), rust.state_hash(), "step {step}");
    }
    assert!(pushes > 0, "nobody reached the chest");
    let (mut found, mut count, mut own, mut turned) = ([NOBODY; 2], 0, bs_plane(), UPRIGHT);
    let (mut ground, mut stands, mut snapshot) = (no_ground(), 0, null_mut());
    // SAFETY: all objects are alive, and all places are.
    unsafe {
        ok(bs_world_characters(c.0, found.as_mut_ptr(), 2, &mut count));
        assert_eq!((count, found), (2, handles));
        ok(bs_world_character(c.0, handles[1], boxed));
        ok(bs_character_shape(boxed, &mut own, null_mut()));
        ok(bs_character_rotation(boxed, &mut turned));
        ok(bs_character_ground(boxed, &mut ground, &mut stands));
        assert_eq!((own.kind, own.half_extents, turned), (BS_GEOMETRY_BOX, shape.half_extents, turn.into()));
        assert_eq!(stands != 0, rust.character(twins[1]).unwrap().ground().is_some());
        ok(bs_snapshot_create(&mut snapshot));
        ok(bs_world_snapshot(c.0, snapshot));
        let before = hash(&c);
        ok(bs_character_set_position(boxed, dvec3(0.0, 3.0, 0.0)));
        ok(bs_world_set_character(c.0, handles[0], boxed));
        ok(bs_world_remove_character(c.0, handles[1]));
        assert_ne!(hash(&c), before);
        assert_eq!(bs_world_character(c.0, handles[1], boxed), BS_ERROR_STALE_CHARACTER);
        assert_eq!(bs_world_set_character(c.0, handles[1], boxed), BS_ERROR_STALE_CHARACTER);
        assert_eq!(bs_world_remove_character(c.0, NOBODY), BS_ERROR_STALE_CHARACTER);
        ok(bs_world_restore(c.0, snapshot));
        assert_eq!(hash(&c), before);
        refused_walks(&c, handles[0], capsule);
        bs_snapshot_destroy(snapshot);
        bs_character_destroy(capsule);
        bs_character_destroy(boxed);
    }
}

fn refused_walks(c: &World, walker: BsWorldCharacter, capsule: *mut BsCharacter) {
    let (before, mut report) = (hash(c), BsCharacterReport::default());
    // SAFETY: all objects are alive, and all places are.
    unsafe {
        let (nan, none) = (vec3(f32::NAN, 0.0, 0.0), vec3(0.0, 0.0, 0.0));
        let walk = |to, dt| bs_world_walk_character(c.0, walker, null(), to, dt, null_mut(), null_mut());
        assert_eq!(walk(nan, DT), BS_ERROR_NOT_FINITE);
        assert!(walk(none, 0.0) != BS_OK);
        let told = report;
        let refused = bs_world_walk_character(c.0, walker, null(), nan, DT, &mut report, null_mut());
        assert_eq!((refused, report), (BS_ERROR_NOT_FINITE, told));
        report.size = 3;
        let short = bs_world_walk_character(c.0, walker, null(), none, DT, &mut report, null_mut());
        assert_eq!(short, BS_ERROR_SIZE);
        assert_eq!(bs_character_set_shape(capsule, &bs_plane()), BS_ERROR_NOT_CONVEX);
        assert!(bs_character_set_rotation(capsule, BsQuat { w: 2.0, ..UPRIGHT }) != BS_OK);
    }
    assert_eq!(hash(c), before);
}

fn no_ground() -> BsGround {
    let (point, none) = (dvec3(0.0, 0.0, 0.0), vec3(0.0, 0.0, 0.0));
    BsGround { body: NO_BODY, shape: BsShape::NONE, point, normal: none, velocity: none }
}

/// A humanoid without gravity is driven to a bow for two seconds, and falls limp for one. Expected: the hash
/// of the world in Rust after every step.
#[test]
fn ragdolls_are_driven_alike() {
    let (c, mut rust) = (world(), backstop::World::new(Settings::default()).unwrap());
    let at = DVec3::new(0.0, 3.0, 0.0);
    let skeleton = Skeleton::humanoid().with_friction(2.0);
    let twin = skeleton.add_to(&mut rust, at, Quat::IDENTITY, Vec3::ZERO).unwrap();
    let (mut bones, mut count) = ([bs_bone_desc_default(); 16], 0);
    let mut desc = bs_skeleton_desc_default();
    desc.friction = 2.0;
    let mut ragdoll = null_mut();
    let pose = BsPose { position: at.into(), rotation: UPRIGHT };
    let (mut bodies, mut joints) = ([NO_BODY; 16], [BsJoint::NONE; 16]);
    let mut joint_count = 0;
    // SAFETY: all objects are alive, and all places are.
    unsafe {
        ok(bs_humanoid_bones(bones.as_mut_ptr(), 16, &mut count));
        (desc.bones, desc.bone_count) = (bones.as_ptr(), count);
        ok(bs_ragdoll_create(c.0, &desc, pose, vec3(0.0, 0.0, 0.0), &mut ragdoll));
        ok(bs_ragdoll_joints(ragdoll, joints.as_mut_ptr(), 16, &mut joint_count));
        ok(bs_ragdoll_bodies(ragdoll, bodies.as_mut_ptr(), 16, &mut count));
    }
    assert!(bodies[..count].iter().map(|&body| BodyHandle::from(body)).eq(twin.bodies.iter().copied()));
    assert!(
        joints[..joint_count].iter().map(|&joint| JointHandle::from(joint)).eq(twin.joints.iter().copied())
    );
    let mut turns = vec![Quat::IDENTITY; count];
    turns[1] = Quat::from_xyzw(0.28, 0.0, 0.0, 0.96);
    let own: Vec<BsQuat> = turns.iter().map(|&turn| turn.into()).collect();
    let spring = BsSpring { kind: BS_SPRING_FREQUENCY, stiffness: 3.0, damping: 1.0 };
    let in_rust = Spring::Frequency { hertz: 3.0, ratio: 1.0 };
    for step in 0..180 {
        // SAFETY: all objects are alive.
        unsafe {
            if step < 120 {
                ok(bs_ragdoll_drive_to(ragdoll, c.0, own.as_ptr(), count, spring, 50.0));
                twin.drive_to(&mut rust, &turns, in_rust, 50.0).unwrap();
            } else if step == 120 {
                ok(bs_ragdoll_relax(ragdoll, c.0));
                twin.relax(&mut rust).unwrap();
            }
        }
        steps(&c, 1);
        rust.step(DT).unwrap();
        assert_eq!(hash(&c), rust.state_hash(), "step {step}");
    }
    let before = hash(&c);
    // SAFETY: all objects are alive.
    unsafe {
        let motor = |count, spring| bs_ragdoll_drive_to(ragdoll, c.0, own.as_ptr(), count, spring, 50.0);
        assert_eq!(motor(count - 1, spring), BS_ERROR_INCOMPLETE);
        assert_eq!(motor(count, BsSpring { kind: BS_SPRING_NONE, ..spring }), BS_ERROR_CONSTANT);
        assert_eq!(motor(count, BsSpring { stiffness: f32::NAN, ..spring }), BS_ERROR_NOT_FINITE);
        assert_eq!(hash(&c), before);
        bs_ragdoll_destroy(ragdoll);
    }
}

/// A long box that turns by a right angle about its end, which goes into the chest. Expected: what the crate
/// says.
#[test]
fn casts_turn_alike() {
    let (c, rust) = rooms();
    let (shape, own) = (Geometry::cuboid(1.0, 0.05, 0.05), bs_box(1.0, 0.05, 0.05));
    let from = (DVec3::new(4.0, 1.0, 3.0), Quat::IDENTITY);
    let half = std::f32::consts::FRAC_1_SQRT_2;
    let to = (DVec3::new(3.0, 0.4, 0.0), Quat::from_xyzw(0.0, half, 0.0, half));
    let cast = ShapeCast::between(&shape, from, to).with_pivot(Vec3::X);
    let mut turning = bs_shape_cast_between(&own, from.into(), to.into());
    turning.pivot = vec3(1.0, 0.0, 0.0);
    let (mut hit, mut all, mut any, mut count) = (BsHit::default(), [BsHit::default(); 4], 9, 0);
    let mut pose = BsPose::from(from);
    // SAFETY: all objects are alive, and all places are.
    unsafe {
        ok(bs_world_cast_turning(c.0, &turning, null(), &mut hit));
        ok(bs_world_cast_turning_any(c.0, &turning, null(), &mut any));
        ok(bs_world_cast_turning_all(c.0, &turning, null(), all.as_mut_ptr(), 4, &mut count));
        ok(bs_shape_cast_pose(&turning, 0.5, &mut pose));
    }
    let engine = rust.cast_shape(&cast, &QueryFilter::new()).unwrap().expect("the chest");
    assert_eq!((hit.body, hit.fraction), (engine.body.into(), engine.fraction));
    assert_eq!((hit.point, hit.normal), (engine.point.into(), engine.normal.into()));
    assert_eq!((any, all[0]), (1, hit));
    let mut found = Vec::new();
    rust.cast_shape_all(&cast, &QueryFilter::new(), &mut found).unwrap();
    assert_eq!(count, found.len());
    assert_eq!(pose, (cast.position_at(0.5), cast.rotation_at(0.5)).into());
    // SAFETY: all objects are alive, and all places are.
    unsafe {
        let wrong = |cast: BsShapeCast| bs_world_cast_turning(c.0, &cast, null(), &mut hit.clone());
        assert_eq!(wrong(BsShapeCast { shape: null(), ..turning }), BS_ERROR_NULL);
        assert_eq!(wrong(BsShapeCast { size: 5, ..turning }), BS_ERROR_SIZE);
        assert_eq!(wrong(BsShapeCast { spin: vec3(0.0, f32::NAN, 0.0), ..turning }), BS_ERROR_NOT_FINITE);
    }
}

/// The ground sinks under a ball, in place. Expected: the hash of the world in Rust for a second after.
#[test]
fn heights_change_alike() {
    let (c, mut rust) = (world(), backstop::World::new(Settings::default()).unwrap());
    let flat = vec![0.0; 36];
    let field = HeightField::new(6, 6, Vec2::ONE, flat.clone()).unwrap();
    let ground = BodyDesc::fixed().with_shape(ShapeDesc::new(Geometry::HeightField(Arc::new(field))));
    let ground = rust.add_body(&ground).unwrap();
    let at = DVec3::new(2.5, 0.5, 2.5);
    let ball =
        BodyDesc::dynamic().with_position(at).with_shape(ShapeDesc::new(Geometry::Sphere { radius: 0.5 }));
    rust.add_body(&ball).unwrap();
    let twin = rust.shapes(ground).unwrap().next().unwrap();
    let (mut own, mut lower, mut shape, mut count) = (null(), null(), BsShape::NONE, 0);
    let sunk = [-1.0_f32; 4];
    // SAFETY: all objects are alive, and all places are.
    unsafe {
        ok(bs_height_field_create(6, 6, 1.0, 1.0, flat.as_ptr(), &mut own));
        let ground = add(&c, BS_BODY_STATIC, bs_height_field(own), dvec3(0.0, 0.0, 0.0));
        add(&c, BS_BODY_DYNAMIC, bs_sphere(0.5), at.into());
        ok(bs_body_shapes(c.0, ground, &mut shape, 1, &mut count));
        steps(&c, 10);
        let before = hash(&c);
        let change = |shape, first, heights| bs_shape_set_heights(c.0, shape, first, 2, 2, 2, heights);
        assert_eq!(change(BsShape::NONE, 2, sunk.as_ptr()), BS_ERROR_STALE_SHAPE);
        assert_eq!(change(shape, 2, null()), BS_ERROR_NULL);
        assert!(change(shape, 5, sunk.as_ptr()) != BS_OK);
        assert!(change(shape, 2, [f32::NAN; 4].as_ptr()) != BS_OK);
        assert_eq!(hash(&c), before);
        ok(change(shape, 2, sunk.as_ptr()));
        let (mut low, mut high) = (vec3(0.0, 0.0, 0.0), vec3(0.0, 0.0, 0.0));
        ok(bs_height_field_with_heights(own, 2, 2, 2, 2, sunk.as_ptr(), &mut lower));
        ok(bs_height_field_bounds(lower, &mut low, &mut high));
        // The field that was given is the shape's no longer, and as it was.
        assert_eq!((low.y, high.y), (-1.0, 0.0));
        ok(bs_height_field_bounds(own, &mut low, &mut high));
        assert_eq!((low.y, high.y), (0.0, 0.0));
        bs_height_field_release(own);
        bs_height_field_release(lower);
    }
    for _ in 0..10 {
        rust.step(DT).unwrap();
    }
    rust.set_heights(twin, [2, 2], [2, 2], &sunk).unwrap();
    for step in 0..60 {
        steps(&c, 1);
        rust.step(DT).unwrap();
        assert_eq!(hash(&c), rust.state_hash(), "step {step}");
    }
}

/// A run that is recorded plays again to the same hash with another number of threads, and its world goes on
/// from there; bytes that are cut off or foreign are refused.
#[test]
fn a_recording_plays_again() {
    let c = world();
    let (mut counts, mut is, mut count) = ([0_u64; 3], 9, 9);
    // SAFETY: all objects are alive, and all places are.
    unsafe {
        let [steps_in, calls, bytes] = &mut counts;
        assert_eq!(bs_world_stop_recording(c.0, steps_in, calls, bytes), BS_ERROR_RECORDING);
        ok(bs_world_recording(c.0, null_mut(), 0, &mut count));
        assert_eq!(count, 0);
        ok(bs_world_start_recording(c.0));
        assert_eq!(bs_world_start_recording(c.0), BS_ERROR_RECORDING);
        ok(bs_world_is_recording(c.0, &mut is));
        assert_eq!(is, 1);
    }
    add(&c, BS_BODY_STATIC, bs_plane(), dvec3(0.0, 0.0, 0.0));
    let ball = add(&c, BS_BODY_DYNAMIC, bs_sphere(0.5), dvec3(0.0, 2.0, 0.0));
    // SAFETY: all objects are alive, and all places are.
    unsafe {
        ok(bs_world_name_recorded(c.0, ball, c"ball".as_ptr()));
        assert_eq!(bs_world_name_recorded(c.0, NO_BODY, c"ball".as_ptr()), BS_ERROR_STALE_BODY);
        assert_eq!(bs_world_name_recorded(c.0, ball, null()), BS_ERROR_NULL);
    }
    steps(&c, 120);
    let mut bytes = Vec::new();
    // SAFETY: all objects are alive, and all places are.
    unsafe {
        let [steps_in, calls, size] = &mut counts;
        ok(bs_world_stop_recording(c.0, steps_in, calls, size));
        assert_eq!(bs_world_recording(c.0, null_mut(), 0, &mut count), BS_ERROR_BUFFER);
        bytes.resize(count, 0);
        ok(bs_world_recording(c.0, bytes.as_mut_ptr(), count, &mut count));
    }
    assert_eq!((counts[0], counts[2]), (120, bytes.len() as u64));
    let mut options = bs_replay_options_default();
    options.threads = 2;
    let (mut replay, mut progress, mut played, mut same) = (null_mut(), 9, 0, 0);
    let (mut found, mut text, mut engine) = (BsDivergence::default(), null(), null());
    // SAFETY: all objects are alive, and all places are.
    unsafe {
        ok(bs_replay_create(bytes.as_ptr(), count, &options, &mut replay));
        ok(bs_replay_step(replay, &mut progress));
        assert_eq!(progress, BS_REPLAY_SAME);
        ok(bs_replay_run(replay, &mut progress));
        ok(bs_replay_state(replay, &mut played, &mut same, &mut engine));
        assert_eq!((progress, played, same), (BS_REPLAY_END, 120, hash(&c)));
        assert_eq!(CStr::from_ptr(engine), CStr::from_ptr(bs_version()));
        ok(bs_replay_divergence(replay, &mut found, &mut text));
        assert_eq!((found, CStr::from_ptr(text)), (BsDivergence::default(), c""));
        let (mut snapshot, other) = (null_mut(), world());
        ok(bs_snapshot_create(&mut snapshot));
        ok(bs_replay_snapshot(replay, snapshot));
        ok(bs_world_restore(other.0, snapshot));
        steps(&other, 30);
        steps(&c, 30);
        assert_eq!(hash(&other), hash(&c));
        bs_snapshot_destroy(snapshot);
        bs_replay_destroy(replay);
    }
    diverging_and_refused_replays(&bytes, ball);
}

/// The bytes of a world's recording.
fn recording(c: &World) -> Vec<u8> {
    let mut count = 0;
    // SAFETY: all objects are alive, and all places are.
    unsafe {
        assert_eq!(bs_world_recording(c.0, null_mut(), 0, &mut count), BS_ERROR_BUFFER);
        let mut bytes = vec![0; count];
        ok(bs_world_recording(c.0, bytes.as_mut_ptr(), count, &mut count));
        bytes
    }
}

/// A recording that begins in the middle of a run, and in which the world goes back twice. Expected: it plays
/// to the same hash, over all the steps that there were.
#[test]
fn a_run_that_rolls_back_plays_again() {
    let c = world();
    add(&c, BS_BODY_STATIC, bs_plane(), dvec3(0.0, 0.0, 0.0));
    add(&c, BS_BODY_DYNAMIC, bs_sphere(0.5), dvec3(0.0, 2.0, 0.0));
    steps(&c, 20);
    let mut snapshot = null_mut();
    // SAFETY: all objects are alive.
    unsafe {
        ok(bs_world_start_recording(c.0));
        ok(bs_snapshot_create(&mut snapshot));
        ok(bs_world_snapshot(c.0, snapshot));
    }
    for _ in 0..2 {
        let guess = add(&c, BS_BODY_DYNAMIC, bs_sphere(0.3), dvec3(0.1, 4.0, 0.0));
        steps(&c, 15);
        // SAFETY: all objects are alive.
        unsafe {
            ok(bs_world_restore(c.0, snapshot));
            assert_eq!(bs_world_remove_body(c.0, guess), BS_ERROR_STALE_BODY);
        }
    }
    steps(&c, 30);
    // SAFETY: all objects are alive, and null is allowed.
    unsafe {
        ok(bs_world_stop_recording(c.0, null_mut(), null_mut(), null_mut()));
        bs_snapshot_destroy(snapshot);
    }
    let bytes = recording(&c);
    let (mut replay, mut progress, mut played, mut same) = (null_mut(), 9, 0, 0);
    // SAFETY: all objects are alive, and null is allowed.
    unsafe {
        ok(bs_replay_create(bytes.as_ptr(), bytes.len(), null(), &mut replay));
        ok(bs_replay_run(replay, &mut progress));
        ok(bs_replay_state(replay, &mut played, &mut same, null_mut()));
        bs_replay_destroy(replay);
    }
    assert_eq!((progress, played, same), (BS_REPLAY_END, 60, hash(&c)));
}

/// `bytes`: of a recording with a named ball.
fn diverging_and_refused_replays(bytes: &[u8], ball: BsBody) {
    let (mut replay, mut progress, count) = (null_mut(), 9, bytes.len());
    let (mut found, mut text) = (BsDivergence::default(), null());
    // SAFETY: all objects are alive, and all places are.
    unsafe {
        // Other substeps, from the first step on.
        let mut options = BsReplayOptions { substeps: 7, ..bs_replay_options_default() };
        ok(bs_replay_create(bytes.as_ptr(), count, &options, &mut replay));
        for _ in 0..2 {
            ok(bs_replay_run(replay, &mut progress));
            ok(bs_replay_divergence(replay, &mut found, &mut text));
            assert_eq!((progress, found.step, found.body), (BS_REPLAY_DIVERGED, 1, ball));
            assert_ne!(found.recorded_hash, found.replayed_hash);
            let text = CStr::from_ptr(text).to_str().unwrap();
            assert!(text.contains("step 1 ") && text.contains("\"ball\""), "{text}");
        }
        bs_replay_destroy(replay);
        let open = |count, options: &BsReplayOptions| {
            bs_replay_create(bytes.as_ptr(), count, options, &mut null_mut())
        };
        assert_eq!(open(3, &options), BS_ERROR_BROKEN_RECORDING);
        options.size = 2;
        assert_eq!(open(count, &options), BS_ERROR_SIZE);
        options = BsReplayOptions { bodies: 1, ..bs_replay_options_default() };
        ok(bs_replay_create(bytes.as_ptr(), count, &options, &mut replay));
        assert_eq!(bs_replay_run(replay, &mut progress), BS_ERROR_LIMIT);
        bs_replay_destroy(replay);
    }
}

/// Expected: one flipped bit is noticed, by the checksum of its block.
#[test]
fn a_damaged_recording_does_not_pass() {
    let c = world();
    let (mut count, mut progress) = (0, 9);
    // SAFETY: the world is alive.
    ok(unsafe { bs_world_start_recording(c.0) });
    add(&c, BS_BODY_DYNAMIC, bs_sphere(0.5), dvec3(0.0, 2.0, 0.0));
    steps(&c, 10);
    // SAFETY: all objects are alive, and all places are.
    unsafe {
        ok(bs_world_stop_recording(c.0, null_mut(), null_mut(), null_mut()));
        assert_eq!(bs_world_recording(c.0, null_mut(), 0, &mut count), BS_ERROR_BUFFER);
        let mut bytes = vec![0; count];
        ok(bs_world_recording(c.0, bytes.as_mut_ptr(), count, &mut count));
        bytes[count / 2] ^= 1;
        let mut replay = null_mut();
        let status = bs_replay_create(bytes.as_ptr(), count, null(), &mut replay);
        let status = if status == BS_OK { bs_replay_run(replay, &mut progress) } else { status };
        assert_eq!(status, BS_ERROR_BROKEN_RECORDING);
        bs_replay_destroy(replay);
    }
}
