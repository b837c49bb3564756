//! Recordings of the calls that change a world, and replays of them.

use super::{BsSnapshot, writing};
use crate::abi::guard::{call, value_or};
use crate::abi::lock::{Changing, Reading, Shared};
use crate::abi::pointers::{Buffer, Out, borrow, slice};
use crate::abi::sized::{read_or_default, write};
use crate::abi::status::{BsStatus, Outcome, Refusal};
use crate::abi::twin::record;
use crate::abi::values::{BsBody, BsBool};
use crate::world::{BsWorld, changing, get, reading};
use backstop::LoadLimits;
use backstop::replay::{Divergence, Progress, RecordingBuffer, Replay, Stage};
use std::ffi::{CStr, CString, c_char};
use std::io::Cursor;

/// Records every call that changes a world from here on, until `bs_world_stop_recording`; of a world that is
/// not new with what it is now, and each `bs_world_restore` as it was. Queries change nothing and are not
/// recorded.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn bs_world_start_recording(world: *mut BsWorld) -> BsStatus {
    call(|| {
        // SAFETY: the caller keeps to the header.
        let mut content = unsafe { changing(world) }?;
        let buffer = RecordingBuffer::default();
        content.world.start_recording(buffer.clone())?;
        content.recording = buffer;
        Ok(())
    })
}

/// Ends the recording of a world. `steps`, `calls` and `bytes` become the numbers of what is in it; each may
/// be null. `bs_world_recording` has the bytes.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn bs_world_stop_recording(
    world: *mut BsWorld,
    steps: *mut u64,
    calls: *mut u64,
    bytes: *mut u64,
) -> BsStatus {
    call(|| {
        // SAFETY: the caller keeps to the header.
        let (mut content, [steps, calls, bytes]) = unsafe {
            let out = [steps, calls, bytes].map(|at| Out::optional("a count", at));
            let [steps, calls, bytes] = out;
            (changing(world)?, [steps?, calls?, bytes?])
        };
        let recorded = content.world.stop_recording()?;
        for (out, count) in [(steps, recorded.steps), (calls, recorded.calls), (bytes, recorded.bytes)] {
            if let Some(out) = out {
                out.set(count);
            }
        }
        Ok(())
    })
}

/// Whether a world is being recorded.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn bs_world_is_recording(world: *const BsWorld, recording: *mut BsBool) -> BsStatus {
    // SAFETY: the caller keeps to the header.
    unsafe { get(world, "the place for the answer", recording, |w| Ok(w.is_recording().into())) }
}

/// The bytes of a world's last recording, complete once it was stopped: `bs_replay_create` plays them, and a
/// file of them is one that the command `backstop replay` plays. `count` becomes their number, zero if there
/// never was a recording.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn bs_world_recording(
    world: *const BsWorld,
    bytes: *mut u8,
    capacity: usize,
    count: *mut usize,
) -> BsStatus {
    call(|| {
        // SAFETY: the caller keeps to the header.
        let (content, out) = unsafe { (reading(world)?, Buffer::new("bytes", bytes, capacity, count)?) };
        out.fill(content.recording.bytes().into_iter())
    })
}

/// Gives a body a name in the recording, if there is one: which `bs_replay_divergence` tells. UTF-8, ends
/// with a zero.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn bs_world_name_recorded(
    world: *mut BsWorld,
    body: BsBody,
    name: *const c_char,
) -> BsStatus {
    call(|| {
        // SAFETY: the caller keeps to the header.
        let mut content = unsafe { changing(world) }?;
        if name.is_null() {
            return Err(Refusal::Null("the name"));
        }
        // A handle that is stale is refused as everywhere else.
        content.world.kind(body.into())?;
        // SAFETY: it is not null, and the caller keeps to the header.
        let name = unsafe { CStr::from_ptr(name) }.to_string_lossy();
        content.world.name_recorded(body.into(), &name);
        Ok(())
    })
}

/// Where in a step, one of `BS_STAGE_...`.
pub type BsStage = u32;
/// Before the step: a call was refused that was not refused when it was recorded.
pub const BS_STAGE_CALLS: BsStage = 0;
/// What the step starts with: poses, velocities, masses, accelerations.
pub const BS_STAGE_FORCES: BsStage = 1;
/// Pairs.
pub const BS_STAGE_BROAD: BsStage = 2;
/// Contacts.
pub const BS_STAGE_NARROW: BsStage = 3;
/// Decisions of hooks, restitution, and the number of rows of each type.
pub const BS_STAGE_PREPARE: BsStage = 4;
/// Velocities and displacements.
pub const BS_STAGE_SOLVE: BsStage = 5;
/// Poses and velocities at the end, and which bodies fell asleep.
pub const BS_STAGE_FINISH: BsStage = 6;

fn stage_code(stage: Stage) -> BsStage {
    match stage {
        Stage::Calls => BS_STAGE_CALLS,
        Stage::Forces => BS_STAGE_FORCES,
        Stage::Broad => BS_STAGE_BROAD,
        Stage::Narrow => BS_STAGE_NARROW,
        Stage::Prepare => BS_STAGE_PREPARE,
        Stage::Solve => BS_STAGE_SOLVE,
        Stage::Finish => BS_STAGE_FINISH,
    }
}

record! {
    /// How a replay is played, and what a recording may ask for at most.
    #[repr(C)]
    #[derive(Clone, Copy, Debug, PartialEq, Eq)]
    pub struct BsReplayOptions of limits: LoadLimits {
        /// Size of this struct; `bs_replay_options_default` fills it in.
        pub size: u32 = size_of::<BsReplayOptions>() as u32,
        /// Threads to step with, 0 for as many as were recorded: their number does not matter to the bits.
        /// Default 0.
        pub threads: u32 = 0,
        /// Substeps, 0 for as many as were recorded: others diverge. Default 0.
        pub substeps: u32 = 0,
        /// Iterations, 0 for as many as were recorded: others diverge. Default 0.
        pub iterations: u32 = 0,
        /// Bytes of one block. Default 1 GiB.
        pub bytes: u64,
        /// Vertices. Default 10 million.
        pub vertices: u64,
        /// Triangles, two for a cell of a height field. Default 10 million.
        pub triangles: u64,
        /// Bodies at a time. Default 1 million.
        pub bodies: u64,
        /// Joints and couplings at a time. Default 1 million.
        pub joints: u64,
        /// Bytes of the geometry, and of the world. Default 1 GiB.
        pub memory: u64,
    }
    default bs_replay_options_default()
}

/// As it was recorded, within generous limits.
#[unsafe(no_mangle)]
pub extern "C" fn bs_replay_options_default() -> BsReplayOptions {
    BsReplayOptions::of_engine(&LoadLimits::default())
}

/// What came of a step of a replay, one of `BS_REPLAY_...`.
pub type BsReplayProgress = u32;
/// The same as in the recording.
pub const BS_REPLAY_SAME: BsReplayProgress = 0;
/// It diverged.
pub const BS_REPLAY_DIVERGED: BsReplayProgress = 1;
/// There is no further step: all of them were the same.
pub const BS_REPLAY_END: BsReplayProgress = 2;

record! {
    /// The first difference between a replay and its recording.
    #[repr(C)]
    #[derive(Clone, Copy, Debug, PartialEq)]
    pub struct BsDivergence {
        /// Size of this struct, set by the caller.
        pub size: u32,
        /// The first stage with a different result.
        pub stage: BsStage,
        /// Which step, from 1; for a refused call, the step after it. Zero: no divergence, and all else is
        /// zero.
        pub step: u64,
        /// The first body that differs; all zeros if none shows it.
        pub body: BsBody,
        /// The caller's number of that body.
        pub user_data: u64,
        /// How many bodies differ after the step.
        pub bodies: u64,
        /// `bs_world_state_hash` after the step as recorded.
        pub recorded_hash: u64,
        /// The same as replayed.
        pub replayed_hash: u64,
    }
    default BsDivergence::default()
}

impl Default for BsDivergence {
    fn default() -> BsDivergence {
        BsDivergence {
            size: size_of::<BsDivergence>() as u32,
            stage: BS_STAGE_CALLS,
            step: 0,
            body: BsBody::NONE,
            user_data: 0,
            bodies: 0,
            recorded_hash: 0,
            replayed_hash: 0,
        }
    }
}

impl BsDivergence {
    fn of_engine(divergence: &Divergence) -> BsDivergence {
        let body = divergence.body.as_ref();
        let [recorded_hash, replayed_hash] = divergence.hashes;
        BsDivergence {
            stage: stage_code(divergence.stage),
            step: divergence.step,
            body: body.map_or(BsBody::NONE, |body| body.handle.into()),
            user_data: body.map_or(0, |body| body.user_data),
            bodies: divergence.bodies as u64,
            recorded_hash,
            replayed_hash,
            ..BsDivergence::default()
        }
    }
}

/// A recording that is played again, step after step, in a world of its own.
pub struct BsReplay {
    player: Shared<Player>,
}

struct Player {
    replay: Replay<Cursor<Vec<u8>>>,
    diverged: Option<Divergence>,
    /// The same in words.
    words: CString,
    engine: CString,
}

impl Player {
    fn step(&mut self) -> Outcome<BsReplayProgress> {
        if self.diverged.is_some() {
            return Ok(BS_REPLAY_DIVERGED);
        }
        Ok(match self.replay.step()? {
            Progress::Same => BS_REPLAY_SAME,
            Progress::End => BS_REPLAY_END,
            Progress::Diverged(divergence) => {
                self.words = words(&divergence.to_string());
                self.diverged = Some(*divergence);
                BS_REPLAY_DIVERGED
            }
        })
    }
}

fn words(text: &str) -> CString {
    CString::new(text.replace('\0', " ")).unwrap_or_default()
}

/// # Safety
/// The pointer is null or that of a replay that nobody destroys meanwhile.
unsafe fn looking<'a>(replay: *const BsReplay) -> Outcome<Reading<'a, Player>> {
    // SAFETY: as this function.
    unsafe { borrow("the replay", replay) }?.player.read()
}

/// # Safety
/// As `looking`.
unsafe fn playing<'a>(replay: *mut BsReplay) -> Outcome<Changing<'a, Player>> {
    // SAFETY: as this function.
    unsafe { borrow("the replay", replay) }?.player.change()
}

/// A replay of `count` bytes of a recording, which are copied, before its first step. `options` may be null:
/// the defaults.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn bs_replay_create(
    bytes: *const u8,
    count: usize,
    options: *const BsReplayOptions,
    replay: *mut *mut BsReplay,
) -> BsStatus {
    call(|| {
        // SAFETY: the caller keeps to the header.
        let (out, bytes, options) = unsafe {
            let out = Out::new("the place for the replay", replay)?;
            (out, slice("the bytes", bytes, count)?, read_or_default(options)?)
        };
        let change = move |settings: &mut backstop::Settings| {
            if options.threads > 0 {
                settings.threads = options.threads as usize;
            }
            if options.substeps > 0 {
                settings.substeps = options.substeps;
            }
            if options.iterations > 0 {
                settings.iterations = options.iterations;
            }
        };
        let replay =
            Replay::open_limited(Cursor::new(bytes.to_vec()), &options.on(LoadLimits::default())?, change)?;
        let engine = words(replay.engine());
        let player = Player { replay, diverged: None, words: CString::default(), engine };
        out.set(Box::into_raw(Box::new(BsReplay { player: Shared::new(player) })));
        Ok(())
    })
}

/// Destroys a replay. Null is none, and fine.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn bs_replay_destroy(replay: *mut BsReplay) {
    value_or((), || {
        if !replay.is_null() {
            // SAFETY: it came from `bs_replay_create`, and nobody else has it.
            drop(unsafe { Box::from_raw(replay) });
        }
    });
}

/// Plays all calls up to the next step, and that. A replay that diverged stays where it is.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn bs_replay_step(replay: *mut BsReplay, progress: *mut BsReplayProgress) -> BsStatus {
    call(|| {
        // SAFETY: the caller keeps to the header.
        let (mut player, out) =
            unsafe { (playing(replay)?, Out::new("the place for the progress", progress)?) };
        out.set(player.step()?);
        Ok(())
    })
}

/// Plays on to the end, or to the first divergence: `progress` becomes which of them.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn bs_replay_run(replay: *mut BsReplay, progress: *mut BsReplayProgress) -> BsStatus {
    call(|| {
        // SAFETY: the caller keeps to the header.
        let (mut player, out) =
            unsafe { (playing(replay)?, Out::new("the place for the progress", progress)?) };
        out.set(loop {
            match player.step()? {
                BS_REPLAY_SAME => {}
                end => break end,
            }
        });
        Ok(())
    })
}

/// Where a replay diverged, and in words if `text` is not null: valid until the replay is played on or
/// destroyed, and empty if it did not diverge.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn bs_replay_divergence(
    replay: *const BsReplay,
    divergence: *mut BsDivergence,
    text: *mut *const c_char,
) -> BsStatus {
    call(|| {
        // SAFETY: the caller keeps to the header.
        let (player, text) = unsafe { (looking(replay)?, Out::optional("the place for the text", text)?) };
        let found = player.diverged.as_ref().map(BsDivergence::of_engine);
        // SAFETY: the caller keeps to the header.
        unsafe { write(divergence, found.unwrap_or_default()) }?;
        if let Some(out) = text {
            out.set(player.words.as_ptr());
        }
        Ok(())
    })
}

/// Number of steps that a replay has played, the hash of its world, and the version of backstop that
/// recorded, valid until the replay is destroyed; each pointer may be null.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn bs_replay_state(
    replay: *const BsReplay,
    steps: *mut u64,
    hash: *mut u64,
    engine: *mut *const c_char,
) -> BsStatus {
    call(|| {
        // SAFETY: the caller keeps to the header.
        let (player, steps, hash, engine) = unsafe {
            let steps = Out::optional("the place for the steps", steps)?;
            let hash = Out::optional("the place for the hash", hash)?;
            (looking(replay)?, steps, hash, Out::optional("the place for the version", engine)?)
        };
        if let Some(out) = steps {
            out.set(player.replay.steps());
        }
        if let Some(out) = hash {
            out.set(player.replay.world().state_hash());
        }
        if let Some(out) = engine {
            out.set(player.engine.as_ptr());
        }
        Ok(())
    })
}

/// Writes the state of a replay's world into a snapshot: a world that restores it goes on from there.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn bs_replay_snapshot(replay: *const BsReplay, snapshot: *mut BsSnapshot) -> BsStatus {
    call(|| {
        // SAFETY: the caller keeps to the header.
        let (player, mut into) = unsafe { (looking(replay)?, writing(snapshot)?) };
        player.replay.world().snapshot(&mut into);
        Ok(())
    })
}
