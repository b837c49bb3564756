//! A session: what is open, and answers to requests.

use crate::Refusal;
use crate::catalogue::{self, FileScene};
use crate::command::{Command, MOST_STEPS, Request, Want};
use crate::frame::Frame;
use crate::layers::Layers;
use crate::run::Run;
use crate::{ledger, settings};
use serde_json::{Value, json};

/// A testbed: at most one scene is open.
///
/// ```
/// let mut session = backstop_testbed::Session::new();
/// let mut frame = Vec::new();
/// session.request(r#"{"commands": [{"do": "open", "name": "dominoes"}], "steps": 2}"#, &mut frame);
/// let length = u32::from_le_bytes(frame[..4].try_into().unwrap()) as usize;
/// let header = std::str::from_utf8(&frame[4..4 + length]).unwrap();
/// assert!(header.contains(r#""step":2"#));
/// ```
#[derive(Default)]
pub struct Session {
    run: Option<Run>,
    file: Option<FileScene>,
    threads: Option<usize>,
    clock: Option<fn() -> f64>,
    /// Scenes that were opened so far.
    opened: u64,
    /// Changes of what is drawn so far.
    revision: u64,
}

impl Session {
    /// With nothing open.
    pub fn new() -> Session {
        Session::default()
    }

    /// With a scene under the name `file`.
    #[must_use]
    pub fn with_file(self, file: FileScene) -> Session {
        Session { file: Some(file), ..self }
    }

    /// With steps of all scenes on so many threads, unless the user changes that.
    #[must_use]
    pub fn with_threads(self, threads: usize) -> Session {
        Session { threads: Some(threads), ..self }
    }

    /// With a clock [ms], so that steps are timed.
    #[must_use]
    pub fn with_clock(self, clock: fn() -> f64) -> Session {
        Session { clock: Some(clock), ..self }
    }

    /// Does what a request asks for, and writes a frame in place of what is in `out`.
    ///
    /// A request that can't be read changes nothing. Commands are done in order, then the steps; the first
    /// that is refused ends the request, and the header of the frame says why in `error`.
    pub fn request(&mut self, json: &str, out: &mut Vec<u8>) {
        let mut frame = Frame::default();
        let (request, mut result) = match read(json) {
            Ok(request) => (request, Ok(())),
            Err(why) => (Request::default(), Err(Refusal::told(format!("can't read the request: {why}")))),
        };
        let Request { commands, steps, layers, want, meshes } = request;
        let mut step_ms = 0.0;
        if result.is_ok() {
            result = self.obey(commands, steps, &mut step_ms);
        }
        frame.set("step_ms", step_ms);
        let told = self.tell(&mut frame, &want, meshes, step_ms);
        if let Some(run) = &self.run
            && !layers.is_empty()
        {
            let drawn = Layers::of(run.world(), &run.drawing, &layers);
            frame.set(
                "tones",
                drawn.tones.iter().map(|c| json!([c.red, c.green, c.blue])).collect::<Vec<_>>(),
            );
            for (name, numbers) in [("points", drawn.points), ("lines", drawn.lines), ("tints", drawn.tints)]
            {
                frame.section(name, |into| into.extend(numbers));
            }
        }
        if let Err(why) = result.and(told) {
            frame.set("error", why.to_string());
        }
        frame.write(out);
    }

    fn obey(&mut self, commands: Vec<Command>, steps: u32, step_ms: &mut f64) -> Result<(), Refusal> {
        if steps > MOST_STEPS {
            return Err(Refusal::told(format!("steps must be in 0..={MOST_STEPS}")));
        }
        for command in commands {
            match command {
                Command::Open { name, size } => {
                    self.put(Run::open(&name, size, self.file.as_ref(), self.threads)?);
                }
                Command::Restart => {
                    if let Some(run) = &self.run {
                        self.put(run.again(self.file.as_ref(), self.threads)?);
                    }
                }
                command => {
                    let run = self.run.as_mut().ok_or_else(|| Refusal::told("no scene is open"))?;
                    run.obey(command)?;
                }
            }
        }
        let Some(run) = &mut self.run else { return Ok(()) };
        for _ in 0..steps {
            let start = self.clock.map(|clock| clock());
            run.step()?;
            if let (Some(start), Some(clock)) = (start, self.clock) {
                *step_ms += clock() - start;
            } else {
                *step_ms += f64::from(run.world().report().times.step) / 1000.0;
            }
        }
        Ok(())
    }

    /// Puts a scene in place of the one that was open.
    fn put(&mut self, run: Run) {
        self.run = Some(run);
        self.opened += 1;
    }

    /// What the page wants to know, but for the layers.
    fn tell(&mut self, frame: &mut Frame, want: &[Want], meshes: [u64; 2], ms: f64) -> Result<(), Refusal> {
        let wants = |what: Want| want.contains(&what);
        if wants(Want::Catalogue) {
            frame.set("catalogue", catalogue::list(self.file.as_ref()));
        }
        if wants(Want::Fields) {
            frame.set("fields", settings::fields());
        }
        if let Some(run) = &mut self.run
            && run.renew_drawing()
        {
            self.revision += 1;
        }
        frame.set("revision", self.revision);
        frame.set("opened", self.opened);
        let Some(run) = &self.run else { return Ok(()) };
        tell_state(run, frame)?;
        let world = run.world();
        if wants(Want::Ledger) {
            frame.set("ledger", ledger::of(world, ms)?);
        }
        frame.section("poses", |into| run.drawing.poses(world, into));
        frame.section("anchors", |into| run.drawing.anchors(world, into));
        if wants(Want::Scene) {
            let [opened, count] = meshes;
            tell_scene(run, frame, if opened == self.opened { count as usize } else { 0 });
        }
        Ok(())
    }
}

/// Where a scene is in time, and what the user does to it.
fn tell_state(run: &Run, frame: &mut Frame) -> Result<(), Refusal> {
    let world = run.world();
    let origin = world.origin();
    let [past, future] = run.history.around(run.step);
    frame.set("name", run.name.as_str());
    frame.set("title", run.title.as_str());
    frame.set("step", run.step);
    frame.set("time", run.time);
    frame.set("dt", run.dt);
    frame.set("past", past);
    frame.set("future", future);
    frame.set("past_bytes", run.history.bytes());
    frame.set("hash", format!("{:016x}", world.state_hash()));
    frame.set("origin", origin.to_array().to_vec());
    frame.set("settings", settings::told(world.settings())?);
    if let Some(ends) = run.grabbed() {
        let numbers: Vec<f64> = ends.iter().flat_map(|end| (*end - origin).to_array()).collect();
        frame.set("grabbed", numbers);
    }
    if let Some(inspected) = run.inspected() {
        frame.set("inspected", inspected);
    }
    Ok(())
}

/// Meshes from the first that the page has not, and which shapes there are.
fn tell_scene(run: &Run, frame: &mut Frame, first: usize) {
    let drawing = &run.drawing;
    let first = first.min(drawing.meshes.len());
    frame.set("meshes", json!({ "first": first, "count": drawing.meshes.len() }));
    let pairs = |pairs: &[[u32; 2]], into: &mut Vec<f32>| {
        into.extend(pairs.iter().flatten().map(|&number| number as f32));
    };
    frame.section("instances", |into| pairs(&drawing.instances, into));
    frame.section("links", |into| pairs(&drawing.links, into));
    for (index, mesh) in drawing.meshes.iter().enumerate().skip(first) {
        frame.section(format!("mesh{index}"), |into| into.extend(mesh));
    }
}

/// A request: an object, for a list would be taken for one too.
fn read(json: &str) -> serde_json::Result<Request> {
    serde_json::from_value(Value::Object(serde_json::from_str(json)?))
}
