//! Recordings that begin in the middle of a run, and those of games that roll back or load what was saved.

use super::*;

/// A world of everything that is shared: meshes, fields and hulls, of bodies and of characters; with joints,
/// and bodies that sleep.
fn running(sleeping: bool) -> World {
    let mut world = World::new(Settings::default().with_sleeping(sleeping)).unwrap();
    common::small_pile().add_to(&mut world).unwrap();
    let (vertices, triangles) = Terrain::bumpy(8, 1.0).mesh();
    let mesh = ShapeDesc::new(Geometry::mesh(TriangleMesh::new(vertices, triangles).unwrap()));
    world.add_body(&BodyDesc::fixed().with_position(DVec3::Y * -30.0).with_shape(mesh)).unwrap();
    let corners = [Vec3::ZERO, Vec3::X, Vec3::Y, Vec3::Z];
    let hull = Arc::new(ConvexHull::new(&corners).unwrap());
    let tetrahedron = BodyDesc::dynamic().with_position(DVec3::new(0.0, 12.0, 0.0));
    world.add_body(&tetrahedron.with_shape(ShapeDesc::new(Geometry::Hull(hull)))).unwrap();
    Skeleton::humanoid().add_to(&mut world, DVec3::new(0.0, 9.0, 0.0), Quat::IDENTITY, Vec3::X).unwrap();
    let walker = Character::new(CharacterSettings::default(), DVec3::new(3.0, 3.0, 0.0)).unwrap();
    let own = ConvexHull::new(&corners.map(|corner| corner * 0.5)).unwrap();
    world.add_character(&walker.with_shape(Geometry::hull(own)).unwrap()).unwrap();
    common::steps(&mut world, 40, DT);
    world
}

fn walk(world: &mut World) {
    let character = world.characters().next().unwrap();
    world.walk_character(character, &QueryFilter::new(), Vec3::new(0.5, -2.0, 0.0), DT).unwrap();
}

/// Expected: the hashes of the run, at any number of threads, of which none was recorded before.
#[test]
fn a_recording_may_begin_in_the_middle_of_a_run() {
    for sleeping in [false, true] {
        let (mut world, buffer) = (running(sleeping), RecordingBuffer::default());
        world.start_recording(buffer.clone()).unwrap();
        for step in 0..60 {
            if step == 20 {
                let ball = BodyDesc::dynamic().with_position(DVec3::Y * 14.0);
                let ball = ball.with_shape(ShapeDesc::new(Geometry::sphere(0.4)));
                world.add_body(&ball).unwrap();
            }
            walk(&mut world);
            world.step(DT).unwrap();
        }
        let recorded = world.stop_recording().unwrap();
        assert_eq!(recorded.bytes, buffer.bytes().len() as u64);
        let played = plays_again(&buffer.bytes(), world.state_hash());
        assert_eq!((played.steps, played.calls["restore"]), (60, 1));
    }
}

/// Predicts eight steps, and goes back: every time with other inputs, which now and then add a body.
/// Expected: as above; and that what snapshots share, static bodies and all others, is written once. Once
/// more for a start of which nobody kept the snapshot, or for static bodies that were not in their tree yet.
#[test]
fn a_run_that_rolls_back_plays_again() {
    for begins_new in [false, true] {
        let buffer = RecordingBuffer::default();
        let mut world = if begins_new { World::new(Settings::default()).unwrap() } else { running(true) };
        world.start_recording(buffer.clone()).unwrap();
        if begins_new {
            common::small_pile().add_to(&mut world).unwrap();
        }
        let (mut saved, mut random) = (Snapshot::new(), Random(3));
        for round in 0..12 {
            world.snapshot(&mut saved);
            for guess in [true, false] {
                for _ in 0..8 {
                    let bodies: Vec<BodyHandle> = world.bodies().collect();
                    let body = random.of(&bodies);
                    world.apply_impulse_at(body, random.cube() * 500.0, DVec3::ZERO).unwrap();
                    if guess && round % 3 == 2 {
                        let ball = BodyDesc::dynamic()
                            .with_position((random.cube() * 3.0 + Vec3::Y * 9.0).as_dvec3());
                        let ball = ball.with_shape(ShapeDesc::new(Geometry::sphere(0.3)));
                        world.add_body(&ball).unwrap();
                    }
                    world.step(DT).unwrap();
                }
                if guess {
                    world.restore(&saved).unwrap();
                }
            }
        }
        world.stop_recording().unwrap();
        let played = plays_again(&buffer.bytes(), world.state_hash());
        let start = u64::from(!begins_new);
        assert_eq!((played.steps, played.calls["restore"]), (12 * 16, 12 + start));
        assert_eq!(played.calls["part"], 3 + start);
    }
}

/// A saved game, of the same level and from bytes, and a snapshot of another world whose mesh this one lacks.
#[test]
fn what_was_saved_elsewhere_is_restored_in_the_replay_too() {
    let (mut world, other) = (running(false), running(true));
    let (mut saved, mut foreign) = (Snapshot::new(), Snapshot::new());
    world.snapshot(&mut saved);
    other.snapshot(&mut foreign);
    let bytes = [saved.to_whole_bytes(), saved.to_bytes()];
    let buffer = RecordingBuffer::default();
    common::steps(&mut world, 5, DT);
    world.start_recording(buffer.clone()).unwrap();
    for bytes in bytes {
        world.restore(&Snapshot::from_bytes(&bytes).unwrap()).unwrap();
        common::steps(&mut world, 5, DT);
    }
    world.restore(&foreign).unwrap();
    common::steps(&mut world, 20, DT);
    // A restore that is refused is not in it.
    assert!(world.restore(&Snapshot::new()).is_err());
    world.step(DT).unwrap();
    world.stop_recording().unwrap();
    let played = plays_again(&buffer.bytes(), world.state_hash());
    assert_eq!(played.calls["restore"], 4);
}

/// Expected: the replay counts what the run did. A field that was edited while somebody else held it is a
/// copy; the snapshot holds that copy, and the recording writes its content.
#[test]
fn what_was_edited_and_restored_takes_the_same_memory_in_the_replay() {
    let (mut world, buffer) = recorded(Settings::default().with_budget(Budget::total(10_000_000)));
    let shared = Arc::new(HeightField::new(9, 9, Vec2::ONE, vec![0.0; 81]).unwrap());
    let ground = BodyDesc::fixed().with_shape(ShapeDesc::new(Geometry::HeightField(shared.clone())));
    let ground = world.add_body(&ground).unwrap();
    let shape = world.shapes(ground).unwrap().next().unwrap();
    world.set_heights(shape, [3, 3], [1, 1], &[0.5]).unwrap();
    world.step(DT).unwrap();
    let mut saved = Snapshot::new();
    world.snapshot(&mut saved);
    world.remove_body(ground).unwrap();
    world.restore(&saved).unwrap();
    world.step(DT).unwrap();
    let reserved = |world: &World| world.memory().category(Category::Meshes).reserved;
    world.stop_recording().unwrap();
    plays_again(&buffer.bytes(), world.state_hash());
    let bytes = buffer.bytes();
    let mut replay = Replay::open(&bytes[..]).unwrap();
    replay.run().unwrap();
    assert_eq!(reserved(replay.world()), reserved(&world));
}

/// Hooks that panic at their hundredth contact.
struct Panics(AtomicU32);

impl ContactHooks for Panics {
    fn contact(&self, _: &mut ContactHook<'_>) {
        assert!(self.0.fetch_add(1, Ordering::Relaxed) != 100, "as it should");
    }
}

/// Expected: the recording goes on after a step that panicked once the world is restored, without that step.
#[test]
fn a_recording_outlives_a_step_that_panics() {
    let mut world = World::new(Settings::default()).unwrap();
    common::small_pile().add_to(&mut world).unwrap();
    let shapes: Vec<ShapeHandle> = world.bodies().flat_map(|body| world.shapes(body).unwrap()).collect();
    shapes.into_iter().for_each(|shape| world.set_hooks(shape, true).unwrap());
    let buffer = RecordingBuffer::default();
    world.start_recording(buffer.clone()).unwrap();
    common::steps(&mut world, 60, DT);
    let mut saved = Snapshot::new();
    world.snapshot(&mut saved);
    let hooks = Panics(AtomicU32::new(0));
    let step =
        std::panic::AssertUnwindSafe(|| (0..9).for_each(|_| assert!(world.step_with(DT, &hooks).is_ok())));
    assert!(std::panic::catch_unwind(step).is_err());
    let mut nowhere = World::new(Settings::default()).unwrap();
    assert!(matches!(world.start_recording(buffer.clone()), Err(ReplayError::Recording)));
    nowhere.restore(&saved).unwrap();
    world.restore(&saved).unwrap();
    assert!(world.is_recording());
    common::steps(&mut world, 10, DT);
    common::steps(&mut nowhere, 10, DT);
    assert_eq!(world.state_hash(), nowhere.state_hash());
    world.stop_recording().unwrap();
    plays_again(&buffer.bytes(), world.state_hash());
}

/// Expected: a limit on bodies holds for those of a snapshot, and settings are changed after it as well.
#[test]
fn limits_and_other_settings_hold_for_what_is_restored() {
    let (mut world, buffer) = (running(false), RecordingBuffer::default());
    world.start_recording(buffer.clone()).unwrap();
    common::steps(&mut world, 5, DT);
    world.stop_recording().unwrap();
    let bytes = buffer.bytes();
    let mut limits = backstop::LoadLimits::default();
    limits.bodies = 20;
    let mut replay = Replay::open_limited(&bytes[..], &limits, |_| {}).unwrap();
    assert!(matches!(replay.run(), Err(ReplayError::Limit { steps: 0, source }) if source.limit == "bodies"));
    let mut replay = Replay::open_with(&bytes[..], |settings| settings.iterations = 3).unwrap();
    assert!(replay.run().unwrap().divergence.is_some());
    assert_eq!(replay.world().settings().iterations, 3);
}
