//! The state of a world that is recorded or replayed, and the methods of `World` for it.

use super::call::{Body, Call, Shape};
use super::error::ReplayError;
use super::file::{Block, End, Start, write_block, write_header};
use super::geometry::{Form, Written};
use super::hooks::Heard;
use super::probe::{Seen, Stage, StepRecord};
use crate::body::BodyDesc;
use crate::constraint::Tweak;
use crate::handle::BodyHandle;
use crate::shape::ShapeDesc;
use crate::snapshot::Snapshot;
use crate::world::{self, Change, Recorder, Resident, World};
use std::any::Any;
use std::io::Write;

/// Bytes of calls that are buffered before they are written, which a crash may lose.
const BLOCK: usize = 1 << 16;

/// A recording in progress, or the hashes that a replay compares.
pub(crate) struct Tape {
    pub(super) seen: Seen,
    /// Answers of hooks in the step.
    heard: Heard,
    /// Whether queries were asked before the step.
    asked: bool,
    /// Where to; none in a replay.
    sink: Option<Sink>,
}

/// The totals of a recording.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Recorded {
    /// Steps in it.
    pub steps: u64,
    /// Calls in it, steps among them.
    pub calls: u64,
    /// Bytes that were written.
    pub bytes: u64,
}

/// Writes calls.
pub(crate) struct Sink {
    to: Box<dyn Write + Send + Sync>,
    /// Calls that are not written yet.
    pub(super) block: Vec<u8>,
    pub(super) written: Written,
    count: Recorded,
    /// The error after which nothing more is written.
    failed: Option<std::io::Error>,
}

impl Sink {
    /// Appends a call.
    pub(super) fn write(&mut self, call: &Call) {
        let block = std::mem::take(&mut self.block);
        match postcard::to_extend(call, block) {
            Ok(block) => self.block = block,
            // Serialising a call never fails; and a world must not fail because of its recording in any case.
            Err(error) => self.failed = Some(std::io::Error::other(error)),
        }
    }

    pub(crate) fn body(&mut self, desc: &BodyDesc) -> Body {
        Body::new(desc, desc.shapes.iter().map(|shape| self.shape(shape)).collect())
    }
    pub(crate) fn shape(&mut self, desc: &ShapeDesc) -> Shape {
        let form = self.form(&desc.geometry);
        Shape::new(desc, form)
    }

    /// The call for a character, with its geometry by number.
    pub(super) fn resident(
        &mut self,
        resident: &Resident,
        call: impl Fn(Option<Form>, Vec<u32>) -> Call,
    ) -> Call {
        call(resident.geometry.as_ref().map(|form| self.form(form)), resident.words.to_vec())
    }

    /// The call for a snapshot, after those for parts of it that are not in the recording yet.
    pub(super) fn restore(&mut self, snapshot: Option<&Snapshot>) -> Call {
        let Some(snapshot) = snapshot else { return Call::Asked() };
        let keys = snapshot.part_keys().map(|keys| {
            [0, 1].map(|which| match self.written.part(&keys[which]) {
                Ok(number) => number,
                Err(number) => {
                    let (bytes, geometry) = snapshot.part(which);
                    let forms = geometry.into_iter().map(|geometry| self.form(geometry)).collect();
                    self.write(&Call::Part(bytes, forms));
                    number
                }
            })
        });
        let hulls = snapshot.hulls().into_iter().map(|hull| self.form(hull)).collect();
        Call::Restore(snapshot.to_bytes(), hulls, keys)
    }

    fn count(&mut self, call: &Call) {
        self.count.calls += 1;
        self.count.steps += u64::from(matches!(call, Call::Step(_)));
        if self.block.len() >= BLOCK {
            self.flush(Block::Calls);
        }
    }

    fn flush(&mut self, kind: Block) {
        if self.failed.is_none() {
            match write_block(&mut self.to, kind, &self.block) {
                Ok(bytes) => self.count.bytes += bytes,
                Err(error) => self.failed = Some(error),
            }
        }
        self.block.clear();
    }

    fn end(&mut self) {
        self.flush(Block::Calls);
        let end = End { steps: self.count.steps, calls: self.count.calls };
        self.block = postcard::to_stdvec(&end).unwrap_or_default();
        self.flush(Block::End);
        if self.failed.is_none() {
            self.failed = self.to.flush().err();
        }
    }
}

impl Drop for Tape {
    /// A world that is dropped, perhaps by a panic, leaves a complete recording.
    fn drop(&mut self) {
        if let Some(sink) = &mut self.sink {
            sink.end();
        }
    }
}

impl std::fmt::Debug for Tape {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.debug_struct("Tape").field("recorded", &self.sink.as_ref().map(|s| s.count)).finish_non_exhaustive()
    }
}

impl Tape {
    fn new(sink: Option<Sink>) -> Tape {
        Tape { seen: Seen::default(), heard: Heard::default(), asked: false, sink }
    }

    /// That of a replay.
    pub(super) fn played() -> Box<Tape> {
        Box::new(Tape::new(None))
    }

    /// Writes a call, if this is a recording.
    fn write(&mut self, asked: bool, call: impl FnOnce(&mut Sink) -> Call) {
        let Some(sink) = &mut self.sink else { return };
        if asked {
            sink.write(&Call::Asked());
        }
        let call = call(sink);
        if let Call::Restore(..) = call {
            self.seen.restart();
        }
        sink.write(&call);
        sink.count(&call);
        self.touch(call.body());
    }

    /// A call is about to change a body.
    pub(super) fn touch(&mut self, body: Option<BodyHandle>) {
        self.seen.changed.extend(body.map(|body| body.slot));
    }
}

/// # Recordings
impl World {
    /// Records every call that changes the world, until [`World::stop_recording`] or until the world is
    /// dropped; the world at the beginning, unless it is new, and each [`World::restore`] are recorded as
    /// snapshots: into a file that was [buffered](std::io::BufWriter), or a
    /// [`RecordingBuffer`](crate::replay::RecordingBuffer). If writing fails, because a disk is full, no
    /// other call fails: `stop_recording` returns the error.
    ///
    /// # Errors
    /// If a step of the world panicked, it is being recorded already, or nothing can be written.
    pub fn start_recording(&mut self, to: impl Write + Send + Sync + 'static) -> Result<(), ReplayError> {
        if self.recorder.is_some() {
            return Err(ReplayError::Recording);
        }
        if self.stage.is_some() {
            return Err(ReplayError::Poisoned);
        }
        let mut to: Box<dyn Write + Send + Sync> = Box::new(to);
        let start = Start {
            engine: env!("CARGO_PKG_VERSION").into(),
            settings: self.settings().clone(),
            origin: self.origin(),
        };
        let start = postcard::to_stdvec(&start).map_err(std::io::Error::other)?;
        let bytes = write_header(&mut to)? + write_block(&mut to, Block::Start, &start)?;
        let count = Recorded { bytes, ..Recorded::default() };
        let sink =
            Sink { to, block: Vec::with_capacity(BLOCK), written: Written::default(), count, failed: None };
        let mut tape = Tape::new(Some(sink));
        if !self.is_new() {
            let mut now = Snapshot::new();
            self.snapshot(&mut now);
            tape.note(Change::Restore(&now), false);
        }
        self.recorder = Some(Box::new(tape));
        Ok(())
    }

    /// Ends the recording.
    ///
    /// # Errors
    /// If the world is not being recorded, or not all could be written.
    pub fn stop_recording(&mut self) -> Result<Recorded, ReplayError> {
        let sink = tape_mut(self).and_then(|tape| tape.sink.take());
        let mut sink = sink.ok_or(ReplayError::NotRecording)?;
        self.recorder = None;
        sink.end();
        match sink.failed {
            None => Ok(sink.count),
            Some(error) => Err(error.into()),
        }
    }

    /// Whether the world is being recorded.
    pub fn is_recording(&self) -> bool {
        tape(self).is_some_and(|tape| tape.sink.is_some())
    }

    /// Gives a body a name in the recording, if there is one: which a divergence reports.
    pub fn name_recorded(&mut self, body: BodyHandle, name: &str) {
        if self.contains(body) {
            let asked = self.was_asked();
            if let Some(tape) = tape_mut(self) {
                tape.write(asked, |_| Call::NameRecorded(body, name.into()));
            }
        }
    }
}

impl Recorder for Tape {
    fn note(&mut self, change: Change<'_>, asked: bool) {
        self.write(asked, |sink| Call::of(change, sink));
    }

    fn begin_step(&mut self, asked: bool) {
        (self.heard, self.asked) = (Heard::default(), asked);
    }

    fn look(&mut self, world: &World, stage: world::Stage) {
        match stage {
            world::Stage::Broad => {
                self.seen.look(world, Stage::Forces);
                self.seen.look(world, Stage::Broad);
            }
            world::Stage::Narrow => self.seen.look(world, Stage::Narrow),
            world::Stage::Prepare => self.seen.look(world, Stage::Prepare),
            world::Stage::Solve => self.seen.look(world, Stage::Solve),
            // Answers of hooks are hashed with the rows, the end of the step once it is over.
            world::Stage::Hooks | world::Stage::Finish => {}
        }
    }

    fn record(&mut self, tweak: Tweak, vetoed: bool) {
        self.heard.record(tweak, vetoed);
    }

    fn end_step(&mut self, world: &World, dt: f32) {
        self.seen.look(world, Stage::Finish);
        let decisions = std::mem::take(&mut self.heard.decisions);
        let Some(sink) = &mut self.sink else { return };
        if self.asked {
            sink.write(&Call::Asked());
        }
        let step: StepRecord = self.seen.record(dt, decisions);
        let call = Call::Step(step);
        sink.write(&call);
        sink.count(&call);
    }
}

/// The tape of a world that is recorded or replayed.
pub(super) fn tape(world: &World) -> Option<&Tape> {
    let recorder: &dyn Any = world.recorder.as_deref()?;
    recorder.downcast_ref()
}

pub(super) fn tape_mut(world: &mut World) -> Option<&mut Tape> {
    let recorder: &mut dyn Any = world.recorder.as_deref_mut()?;
    recorder.downcast_mut()
}
