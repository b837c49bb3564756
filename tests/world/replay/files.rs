//! Recordings as files: failed writes, and files that are cut off or changed.

use super::*;
use crate::common::Floor;

/// One at a time, and only of a world that has a state.
#[test]
fn what_can_t_be_recorded_is_refused() {
    let mut world = World::new(Settings::default()).unwrap();
    assert!(matches!(world.stop_recording(), Err(ReplayError::NotRecording)));
    let buffer = RecordingBuffer::default();
    world.start_recording(buffer.clone()).unwrap();
    assert!(world.is_recording());
    assert!(matches!(world.start_recording(buffer.clone()), Err(ReplayError::Recording)));
    world.stop_recording().unwrap();
    let mut floor = Floor::Box.desc(Material::default());
    floor.shapes[0].hooks = true;
    world.add_body(&floor).unwrap();
    world.add_body(&common::dynamic(Geometry::sphere(0.5), Material::default(), Vec3::Y * 0.5)).unwrap();
    let step = std::panic::AssertUnwindSafe(|| world.step_with(DT, &Panics).map(drop));
    assert!(std::panic::catch_unwind(step).is_err());
    assert!(matches!(world.start_recording(buffer), Err(ReplayError::Poisoned)));
}

/// Hooks that panic.
struct Panics;

impl ContactHooks for Panics {
    fn contact(&self, _: &mut ContactHook<'_>) {
        panic!("as it should");
    }
}

/// A disk that is full.
struct Full(usize);

impl std::io::Write for Full {
    fn write(&mut self, bytes: &[u8]) -> std::io::Result<usize> {
        self.0 = self.0.checked_sub(bytes.len()).ok_or(std::io::ErrorKind::StorageFull)?;
        Ok(bytes.len())
    }
    fn flush(&mut self) -> std::io::Result<()> {
        Ok(())
    }
}

#[test]
fn a_full_disk_stops_no_world() {
    let mut world = World::new(Settings::default()).unwrap();
    world.start_recording(Full(100_000)).unwrap();
    builtin::talk().add_to(&mut world).unwrap();
    common::steps(&mut world, 10, DT);
    assert!(matches!(world.stop_recording(), Err(ReplayError::Io(_))));
    assert!(matches!(
        World::new(Settings::default()).unwrap().start_recording(Full(3)),
        Err(ReplayError::Io(_))
    ));
}

/// The world may go, in a panic even: the recording is whole.
#[test]
fn a_world_that_goes_leaves_a_recording() {
    let (mut world, buffer) = recorded(Settings::default());
    builtin::talk().add_to(&mut world).unwrap();
    common::steps(&mut world, 5, DT);
    drop(world);
    assert_eq!(play(&buffer.bytes(), 1).0.steps, 5);
}

fn outcome(bytes: &[u8]) -> Result<Played, ReplayError> {
    Replay::open(bytes)?.run()
}

#[test]
fn a_file_that_is_cut_off_plays_as_far_as_it_goes() {
    let (bytes, ..) = record_scene(&common::small_pile(), Settings::default(), 300);
    // Blocks are of 64 KiB.
    let half = &bytes[..bytes.len() / 2];
    let mut replay = Replay::open(half).unwrap();
    let mut steps = 0;
    let error = loop {
        match replay.step() {
            Ok(Progress::Same) => steps += 1,
            Ok(other) => panic!("{other:?}"),
            Err(error) => break error,
        }
    };
    // Calls behind the last whole block of the half are gone.
    assert!(steps > 10, "{steps}");
    assert!(matches!(error, ReplayError::CutOff { steps: n } if n == steps), "{error}");
    for length in 0..200 {
        let error = outcome(&bytes[..length]).unwrap_err();
        assert!(matches!(error, ReplayError::Foreign | ReplayError::CutOff { .. }), "{length}: {error}");
    }
    assert!(matches!(outcome(b"glTF is something else altogether"), Err(ReplayError::Foreign)));
    let mut later = bytes.clone();
    later[16] = 200;
    assert!(matches!(outcome(&later), Err(ReplayError::Version { found: 200, known: 7 })));
}

#[test]
fn a_flipped_bit_is_noticed() {
    let (bytes, ..) = record_scene(&builtin::talk(), Settings::default(), 4);
    let mut random = Random(5);
    for _ in 0..300 {
        let mut broken = bytes.clone();
        let bit = random.below(8 * bytes.len());
        broken[bit / 8] ^= 1 << (bit % 8);
        let error = outcome(&broken).expect_err("a checksum");
        assert!(!error.to_string().is_empty());
    }
}
