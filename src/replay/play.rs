//! Playing a recording again.

use super::call::{Call, Shape};
use super::compare::{Divergence, Names, compare};
use super::error::ReplayError;
use super::file::{Block, End, Start, read_block, read_header};
use super::geometry::{self, Form};
use super::hooks::Told;
use super::probe::{Stage, StepRecord};
use super::tape::{Tape, tape, tape_mut};
use crate::character::{Character, checked_character};
use crate::config::Settings;
use crate::error::Error;
use crate::load_limits::{LimitExceeded, LoadLimits, Tally};
use crate::shape::{Geometry, ShapeDesc};
use crate::snapshot::{RecordedPart, Snapshot};
use crate::world::World;
use std::collections::BTreeMap;
use std::io::Read;

/// A recording that is played again, step after step.
pub struct Replay<R> {
    from: R,
    world: World,
    /// Version of backstop that recorded.
    engine: String,
    /// Applied to all settings before they are set.
    change: Box<dyn Fn(&mut Settings) + Send>,
    /// Calls that were read, and how far they were played.
    block: Vec<u8>,
    at: usize,
    ended: bool,
    pub(super) geometries: geometry::Read,
    parts: geometry::Parts,
    names: Names,
    /// Slots of the bodies that the recorded step looked at.
    awake: Vec<u32>,
    steps: u64,
    calls: BTreeMap<&'static str, u64>,
    tally: Tally,
    /// Whether the world has a budget that the recorded one did not have.
    bounded: bool,
}

/// The outcome of a step.
#[derive(Clone, Debug, PartialEq)]
pub enum Progress {
    /// The same as in the recording.
    Same,
    /// It diverged.
    Diverged(Box<Divergence>),
    /// There is no further step.
    End,
}

/// The outcome of a replay.
#[derive(Clone, Debug, PartialEq)]
#[non_exhaustive]
pub struct Played {
    /// Steps that were played.
    pub steps: u64,
    /// Calls that were played, steps among them, by the names of the methods.
    pub calls: BTreeMap<&'static str, u64>,
    /// Where it first diverged; the replay ended there.
    pub divergence: Option<Divergence>,
}

/// Why a call could not be made.
enum Failed {
    /// The world refuses it.
    Refused(Error),
    /// The data is damaged.
    Damaged(&'static str),
    /// A limit is exceeded.
    Limit(LimitExceeded),
}

impl From<LimitExceeded> for Failed {
    fn from(error: LimitExceeded) -> Failed {
        Failed::Limit(error)
    }
}

impl From<Error> for Failed {
    fn from(error: Error) -> Failed {
        Failed::Refused(error)
    }
}

impl<R: Read> Replay<R> {
    /// Starts to play a recording.
    ///
    /// # Errors
    /// If it is not a recording, of another version of the format, or damaged.
    pub fn open(from: R) -> Result<Replay<R>, ReplayError> {
        Self::open_with(from, |_| {})
    }

    /// The same with other settings: another number of threads, to see that it does not matter, or of
    /// substeps, to see their effect. `change` is called with the settings at the start and each time that
    /// they are set.
    ///
    /// # Errors
    /// As for [`Replay::open`], and if the settings are refused.
    pub fn open_with(
        from: R,
        change: impl Fn(&mut Settings) + Send + 'static,
    ) -> Result<Replay<R>, ReplayError> {
        Self::open_limited(from, &LoadLimits::default(), change)
    }

    /// The same within other limits.
    ///
    /// # Errors
    /// As for [`Replay::open_with`].
    pub fn open_limited(
        mut from: R,
        limits: &LoadLimits,
        change: impl Fn(&mut Settings) + Send + 'static,
    ) -> Result<Replay<R>, ReplayError> {
        let tally = Tally::new(limits);
        read_header(&mut from)?;
        let damaged = |_| ReplayError::Damaged { steps: 0, what: "the start makes no sense" };
        let Start { engine, mut settings, origin } = match read_block(&mut from, 0, &tally.bytes)? {
            (Block::Start, payload) => postcard::from_bytes(&payload).map_err(damaged)?,
            _ => return Err(ReplayError::Damaged { steps: 0, what: "there is no start" }),
        };
        change(&mut settings);
        let bounded = bound(&mut settings, limits.memory);
        let mut world = World::new(settings)?;
        world.set_origin(origin)?;
        world.recorder = Some(Tape::played());
        Ok(Replay {
            from,
            world,
            engine,
            change: Box::new(change),
            block: Vec::new(),
            at: 0,
            ended: false,
            geometries: geometry::Read::default(),
            parts: geometry::Parts::default(),
            names: Names::new(),
            awake: Vec::new(),
            steps: 0,
            calls: BTreeMap::new(),
            tally,
            bounded,
        })
    }

    /// The world as it is now.
    pub fn world(&self) -> &World {
        &self.world
    }

    /// The version of backstop that recorded. Another version may diverge.
    pub fn engine(&self) -> &str {
        &self.engine
    }

    /// Steps that were played.
    pub fn steps(&self) -> u64 {
        self.steps
    }

    /// Plays all calls up to the next step, and that.
    ///
    /// # Errors
    /// If the file is cut off or damaged there.
    pub fn step(&mut self) -> Result<Progress, ReplayError> {
        while let Some(call) = self.next()? {
            let name = call.name();
            *self.calls.entry(name).or_default() += 1;
            if let Call::Step(record) = call {
                return self.play_step(&record);
            }
            match self.play(call) {
                Ok(()) => {}
                Err(Failed::Damaged(what)) => return Err(ReplayError::Damaged { steps: self.steps, what }),
                Err(Failed::Limit(source)) => {
                    return Err(ReplayError::Limit { steps: self.steps, source });
                }
                // The recorded world had no such budget: it is the reader's.
                Err(Failed::Refused(Error::Budget { .. })) if self.bounded => {
                    return Err(self.out_of_memory());
                }
                Err(Failed::Refused(error)) => {
                    return Ok(Progress::Diverged(Box::new(Divergence {
                        step: self.steps + 1,
                        stage: Stage::Calls,
                        body: None,
                        bodies: 0,
                        refused: Some((name, error)),
                        hashes: [self.world.state_hash(); 2],
                    })));
                }
            }
        }
        Ok(Progress::End)
    }

    /// Plays on to the end, or to the first divergence.
    ///
    /// # Errors
    /// If the file is cut off or damaged before that.
    pub fn run(&mut self) -> Result<Played, ReplayError> {
        let divergence = loop {
            match self.step()? {
                Progress::Same => {}
                Progress::Diverged(divergence) => break Some(*divergence),
                Progress::End => break None,
            }
        };
        Ok(Played { steps: self.steps, calls: self.calls.clone(), divergence })
    }

    /// The next call, if there is one.
    fn next(&mut self) -> Result<Option<Call>, ReplayError> {
        let damaged = |what| ReplayError::Damaged { steps: self.steps, what };
        while self.at == self.block.len() {
            if self.ended {
                return Ok(None);
            }
            match read_block(&mut self.from, self.steps, &self.tally.bytes)? {
                (Block::Calls, payload) => (self.block, self.at) = (payload, 0),
                (Block::End, payload) => {
                    let end: End =
                        postcard::from_bytes(&payload).map_err(|_| damaged("its end makes no sense"))?;
                    if end.steps != self.steps {
                        return Err(damaged("steps are missing"));
                    }
                    self.ended = true;
                }
                (Block::Start, _) => return Err(damaged("it starts twice")),
            }
        }
        let (call, rest) = postcard::take_from_bytes(&self.block[self.at..])
            .map_err(|_| damaged("a call makes no sense"))?;
        self.at = self.block.len() - rest.len();
        Ok(Some(call))
    }

    fn play_step(&mut self, record: &StepRecord) -> Result<Progress, ReplayError> {
        let damaged = |what| ReplayError::Damaged { steps: self.steps, what };
        if let Some(differences) = &record.awake {
            self.awake.clear();
            let mut slot = 0u32;
            for difference in differences {
                slot = slot.checked_add(*difference).ok_or(damaged("slots make no sense"))?;
                self.awake.push(slot);
            }
        }
        if self.awake.len() != record.bodies.len() {
            return Err(damaged("hashes of bodies are missing"));
        }
        match self.world.step_with(record.dt, &Told::new(&record.decisions)) {
            Err(_) => return Err(damaged("the length of a step makes no sense")),
            Ok(report) if report.shed > 0 && self.bounded => return Err(self.out_of_memory()),
            Ok(_) => {}
        }
        self.steps += 1;
        let Some(tape) = tape(&self.world) else { return Ok(Progress::Same) };
        Ok(match compare(self.steps, record, &self.awake, &tape.seen, &self.world, &self.names) {
            Some(divergence) => Progress::Diverged(Box::new(divergence)),
            None => Progress::Same,
        })
    }

    fn out_of_memory(&self) -> ReplayError {
        ReplayError::Limit { steps: self.steps, source: self.tally.memory.exceeded() }
    }

    /// Checks that so many more bodies and joints are within the limits. Couplings count as joints.
    fn allow(&self, bodies: usize, joints: usize) -> Result<(), LimitExceeded> {
        self.tally.bodies.allow(self.world.bodies.len() + bodies)?;
        let coupled = self.world.joints.couplings.count;
        self.tally.joints.allow(self.world.joints.count + coupled + joints)
    }

    fn shape(&self, shape: &Shape) -> Result<ShapeDesc, Failed> {
        let geometry = self.geometries.geometry(shape.form);
        Ok(shape.desc(geometry.map_err(|_| Failed::Damaged("a geometry is missing"))?))
    }

    fn body(&self, body: &super::call::Body) -> Result<crate::body::BodyDesc, Failed> {
        let shapes = body.shapes.iter().map(|shape| self.shape(shape)).collect::<Result<_, _>>()?;
        Ok(body.desc(shapes))
    }

    /// Keeps geometry that calls refer to.
    fn define(&mut self, call: Call) -> Result<(), Failed> {
        let again = matches!(call, Call::Again(_));
        self.geometries.charge(&call, &mut self.tally)?;
        if let Some(Err(_)) = self.geometries.define(call) {
            return Err(Failed::Damaged("a geometry makes no sense"));
        }
        if !again {
            self.tally.memory.take(self.geometries.last_bytes())?;
        }
        Ok(())
    }

    fn play(&mut self, call: Call) -> Result<(), Failed> {
        if let Some(tape) = tape_mut(&mut self.world) {
            tape.touch(call.body());
        }
        let Some(call) = call.make(&mut self.world)? else { return Ok(()) };
        match call {
            Call::Step(_) => {}
            Call::Hull(_) | Call::Mesh(_) | Call::Field(_) | Call::Again(_) => self.define(call)?,
            Call::SetSettings(mut settings) => {
                (self.change)(&mut settings);
                self.bounded = bound(&mut settings, self.tally.memory.most());
                self.world.set_settings(settings)?;
            }
            Call::AddBody(body) => {
                self.allow(1, 0)?;
                let desc = self.body(&body)?;
                self.world.add_body(&desc)?;
            }
            Call::AddBodies(bodies) => {
                self.allow(bodies.len(), 0)?;
                let descs = bodies.iter().map(|body| self.body(body)).collect::<Result<Vec<_>, _>>()?;
                self.world.add_bodies(&descs)?;
            }
            Call::AddJoint(desc) => {
                self.allow(0, 1)?;
                self.world.add_joint(&desc)?;
            }
            Call::AddJoints(descs) => {
                self.allow(0, descs.len())?;
                self.world.add_joints(&descs)?;
            }
            Call::AddCoupling(desc) => {
                self.allow(0, 1)?;
                self.world.add_coupling(&desc)?;
            }
            Call::NameRecorded(body, name) => {
                self.names.insert(body.slot, (body.generation, name));
            }
            Call::Asked() => {
                self.world.current()?;
            }
            Call::Part(bytes, forms) => {
                let part = RecordedPart::new(&bytes, self.all_geometry(&forms)?);
                self.parts.define(part.map_err(|_| Failed::Damaged("a part makes no sense"))?);
            }
            Call::Restore(state, hulls, parts) => self.restore(&state, &hulls, parts)?,
            of_shape => self.play_on_shape(of_shape)?,
        }
        Ok(())
    }

    /// Geometry by number, of which none is missing.
    fn all_geometry(&self, forms: &[Form]) -> Result<Vec<Geometry>, Failed> {
        let all = forms.iter().map(|&form| self.geometries.geometry(form)).collect::<Result<_, _>>();
        all.map_err(|_| Failed::Damaged("a geometry is missing"))
    }

    fn restore(&mut self, state: &[u8], hulls: &[Form], parts: Option<[u32; 2]>) -> Result<(), Failed> {
        let parts = match parts.map(|parts| parts.map(|number| self.parts.get(number))) {
            None => None,
            Some([Some(fixed), Some(moving)]) => Some([fixed, moving]),
            Some(_) => return Err(Failed::Damaged("a part is missing")),
        };
        let snapshot = Snapshot::of_recording(state, self.all_geometry(hulls)?, parts);
        let snapshot = snapshot.map_err(|_| Failed::Damaged("a snapshot makes no sense"))?;
        // A tape that is played writes nothing.
        let tape = self.world.recorder.take();
        let restored = self.world.restore(&snapshot);
        self.world.recorder = tape;
        restored?;
        // Its size is bounded by that of the bytes.
        self.allow(0, 0)?;
        let mut settings = self.world.settings().clone();
        (self.change)(&mut settings);
        self.world.set_settings(settings)?;
        self.awake.clear();
        if let Some(tape) = tape_mut(&mut self.world) {
            tape.seen.restart();
        }
        Ok(())
    }

    /// A character of a recording.
    fn character(&self, form: Option<Form>, words: &[u32]) -> Result<Character, Failed> {
        let geometry = form.map(|form| self.geometries.geometry(form)).transpose();
        let geometry = geometry.map_err(|_| Failed::Damaged("a geometry is missing"))?;
        checked_character(geometry, words).map_err(|_| Failed::Damaged("a character"))
    }

    /// Plays a call that changes a character.
    fn play_on_character(&mut self, call: Call) -> Result<(), Failed> {
        match call {
            Call::AddCharacter(form, words) => {
                let character = self.character(form, &words)?;
                self.world.add_character(&character)?;
            }
            Call::SetCharacter(character, form, words) => {
                let to = self.character(form, &words)?;
                self.world.set_character(character, &to)?;
            }
            Call::WalkCharacter(character, words) => {
                let geometry = self.world.characters.get(character)?.geometry.clone();
                let walked = checked_character(geometry, &words);
                let walked = walked.map_err(|_| Failed::Damaged("a character"))?;
                self.world.write_resident(character, &walked.resident().words);
            }
            // One that was forgotten above must not pass for the same.
            _ => return Err(Failed::Damaged("a call is unknown")),
        }
        Ok(())
    }

    /// Plays a call that changes one shape, or adds one, or that changes all limits or motors of a joint.
    fn play_on_shape(&mut self, call: Call) -> Result<(), Failed> {
        let usual = |two: [u32; 2]| two.map(|n| n as usize);
        match call {
            Call::AddShape(body, shape) => {
                let desc = self.shape(&shape)?;
                self.world.add_shape(body, &desc)?;
            }
            Call::SetGeometry(shape, form) => {
                let geometry = self.geometries.geometry(form);
                let geometry = geometry.map_err(|_| Failed::Damaged("a geometry is missing"))?;
                self.world.set_geometry(shape, geometry)?;
            }
            Call::SetHeights(shape, first, size, heights) => {
                self.world.set_heights(shape, usual(first), usual(size), &heights)?;
            }
            Call::SetHoles(shape, first, size, holes) => {
                self.world.set_holes(shape, usual(first), usual(size), &holes)?;
            }
            Call::SetJointLimits(joint, limits) => self.world.set_joint_limits(joint, &limits)?,
            Call::SetJointMotors(joint, drives) => self.world.set_joint_motors(joint, &drives)?,
            of_character => self.play_on_character(of_character)?,
        }
        Ok(())
    }
}

/// Sets a budget of `bytes` unless there is a lower one; returns whether it did.
fn bound(settings: &mut Settings, bytes: u64) -> bool {
    let bytes = usize::try_from(bytes).unwrap_or(usize::MAX);
    let bound = bytes < settings.budget.limit().unwrap_or(usize::MAX);
    if bound {
        settings.budget = settings.budget.at_most(bytes);
    }
    bound
}

impl<R> std::fmt::Debug for Replay<R> {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.debug_struct("Replay")
            .field("engine", &self.engine)
            .field("steps", &self.steps)
            .finish_non_exhaustive()
    }
}
