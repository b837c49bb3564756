//! The physics of an app as a recording (feature `replay`).

use crate::common::*;
use backstop_bevy::backstop::replay::{RecordingBuffer, Replay};
use backstop_bevy::prelude::*;
use bevy_math::Vec3;
use bevy_transform::components::Transform;

/// Bodies, a joint, a character that pushes, a transform that is written, an entity that goes: five seconds,
/// recorded from before the first step. Expected: the replay of the bytes has the hashes of every stage of
/// all steps, which the recording holds, and ends in a world of the same hash.
#[test]
fn an_app_is_recorded_and_played_again() {
    let mut app = app();
    let buffer = RecordingBuffer::default();
    app.world_mut().resource_mut::<PhysicsWorld>().start_recording(buffer.clone()).unwrap();
    floor(&mut app);
    let (a, b) = (ball(&mut app, 3.0), ball(&mut app, 5.0));
    app.world_mut().spawn(Joint::distance([a, b], 0.0, 3.0));
    let walks = CharacterInput::walk(Vec3::new(2.0, 0.0, 0.0));
    app.world_mut().spawn((Character::default(), walks, Transform::from_xyz(-6.0, 1.0, 0.0)));
    run(&mut app, 200);
    app.world_mut().get_mut::<Transform>(b).unwrap().translation = Vec3::new(0.0, 9.0, 1.0);
    run(&mut app, 50);
    app.world_mut().despawn(a);
    run(&mut app, 50);
    let hash = physics(&app).state_hash();
    let recorded = app.world_mut().resource_mut::<PhysicsWorld>().stop_recording().unwrap();
    assert_eq!(recorded.steps, 300);

    let bytes = buffer.bytes();
    let mut replay = Replay::open(&bytes[..]).unwrap();
    let played = replay.run().unwrap();
    assert_eq!((played.steps, played.divergence), (300, None));
    assert_eq!(replay.world().state_hash(), hash);
}

/// A recording that begins after a second. Expected: as above, from there on.
#[test]
fn a_recording_may_begin_later() {
    let mut app = app();
    floor(&mut app);
    ball(&mut app, 3.0);
    run(&mut app, 60);
    let buffer = RecordingBuffer::default();
    app.world_mut().resource_mut::<PhysicsWorld>().start_recording(buffer.clone()).unwrap();
    ball(&mut app, 5.0);
    run(&mut app, 90);
    let hash = physics(&app).state_hash();
    app.world_mut().resource_mut::<PhysicsWorld>().stop_recording().unwrap();
    let bytes = buffer.bytes();
    let mut replay = Replay::open(&bytes[..]).unwrap();
    let played = replay.run().unwrap();
    assert_eq!((played.steps, played.divergence), (90, None));
    assert_eq!(replay.world().state_hash(), hash);
}
