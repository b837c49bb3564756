//! A scene that is open: its world, where it is in time, and what the user does to it.

use crate::catalogue::{FileScene, Opened, open};
use crate::command::{Command, Form, Place};
use crate::drawing::Drawing;
use crate::history::{History, Moment};
use crate::tools::{self, Blast, Shot};
use crate::{Refusal, settings};
use backstop::{BodyHandle, Grab, World};
use backstop_samples::{Controls, Running, Tick};
use serde_json::{Map, Value};
use std::collections::HashMap;

/// Length of a step, unless the scene or the user says another one [s].
const DT: f32 = 1.0 / 60.0;

/// A scene that is open.
pub(crate) struct Run {
    pub(crate) name: String,
    pub(crate) title: String,
    size: Option<u32>,
    running: Box<dyn Running>,
    names: HashMap<BodyHandle, String>,
    pub(crate) step: u64,
    pub(crate) time: f64,
    pub(crate) dt: f32,
    controls: Controls,
    pub(crate) history: History,
    grab: Option<Grab>,
    /// The grab is of the time that was gone back to: the user holds nothing, and it ends with the next
    /// change.
    grab_is_past: bool,
    inspected: Option<tools::Inspected>,
    /// Settings that the user has changed.
    changed: Map<String, Value>,
    /// Hulls that were made, so that each looks another way.
    hulls: u64,
    pub(crate) drawing: Drawing,
}

impl Run {
    /// From the start of what has this name, on so many threads.
    pub(crate) fn open(
        name: &str,
        size: Option<u32>,
        file: Option<&FileScene>,
        threads: Option<usize>,
    ) -> Result<Run, Refusal> {
        let Opened { name, title, size, mut running, names, dt } = open(name, size, file)?;
        if let Some(threads) = threads {
            let world = running.world_mut();
            world.set_settings(world.settings().clone().with_threads(threads))?;
        }
        Ok(Run {
            name,
            title,
            size,
            running,
            names: names.into_iter().collect(),
            step: 0,
            time: 0.0,
            dt: dt.unwrap_or(DT),
            controls: Controls::default(),
            history: History::default(),
            grab: None,
            grab_is_past: false,
            inspected: None,
            changed: Map::new(),
            hulls: 0,
            drawing: Drawing::default(),
        })
    }

    /// The same from its start, with the settings that were changed since.
    pub(crate) fn again(&self, file: Option<&FileScene>, threads: Option<usize>) -> Result<Run, Refusal> {
        let mut run = Run::open(&self.name, self.size, file, threads)?;
        run.set(&self.changed)?;
        Ok(run)
    }

    pub(crate) fn world(&self) -> &World {
        self.running.world()
    }

    /// Does what is neither about which scene is open nor about time.
    pub(crate) fn obey(&mut self, command: Command) -> Result<(), Refusal> {
        match command {
            Command::Settings(fields) => self.set(&fields),
            Command::Grab(sight) => {
                self.release()?;
                let ray = tools::ray(self.world(), &sight)?;
                if let Some(grab) = tools::seize(self.running.world_mut(), &ray)? {
                    self.changed_world()?;
                    self.grab = Some(grab);
                }
                Ok(())
            }
            Command::Drag { to } => {
                if self.grab_is_past || self.grab.is_none() {
                    return Ok(());
                }
                let world = self.changed_world()?;
                let to = tools::point(world, to);
                self.grab.map_or(Ok(()), |grab| tools::drag(self.running.world_mut(), &grab, to))
            }
            Command::Release => self.release(),
            Command::Shoot { origin, direction, speed, shape, size } => {
                let (shape, size) = (shape.unwrap_or(Form::Sphere), Some(size.unwrap_or(tools::SHOT)));
                let shot = Shot { shape, size, hull: self.next_hull() };
                tools::shoot(self.changed_world()?, &tools::Aim { origin, direction, speed }, &shot)
            }
            Command::Spawn { shape, position, sight, distance, size } => {
                let shot = Shot { shape, size, hull: self.next_hull() };
                tools::spawn(self.changed_world()?, &Place { position, sight, distance }, &shot)
            }
            Command::Remove(sight) => tools::remove(self.changed_world()?, &sight),
            Command::Explode { position, sight, distance, radius, impulse, speed } => {
                let blast = Blast { radius, impulse, speed };
                tools::explode(self.changed_world()?, &Place { position, sight, distance }, &blast)
            }
            Command::Inspect(sight) => {
                let world = self.world();
                self.inspected = tools::look_at(world, &tools::ray(world, &sight)?)?;
                Ok(())
            }
            Command::Controls { forward, right, jump, action } => {
                let [forward, right] = [forward, right].map(|share| share.clamp(-1.0, 1.0));
                self.controls = Controls { forward, right, jump, action };
                Ok(())
            }
            Command::Back { steps } => self.back(steps),
            Command::Seek { step } => self.seek(step),
            Command::Open { .. } | Command::Restart => Ok(()),
        }
    }

    /// The world, which will be changed: what was ahead of it is not its future any more.
    fn changed_world(&mut self) -> Result<&mut World, Refusal> {
        self.history.forget_from(self.step);
        self.drop_past_grab()?;
        Ok(self.running.world_mut())
    }

    fn drop_past_grab(&mut self) -> Result<(), Refusal> {
        if std::mem::take(&mut self.grab_is_past)
            && let Some(grab) = self.grab.take()
        {
            tools::release(self.running.world_mut(), grab)?;
        }
        Ok(())
    }

    fn next_hull(&mut self) -> u64 {
        self.hulls += 1;
        self.hulls
    }

    fn set(&mut self, fields: &Map<String, Value>) -> Result<(), Refusal> {
        let new = settings::changed(self.world().settings(), self.dt, fields)?;
        let world = self.changed_world()?;
        world.set_settings(new.world)?;
        self.dt = new.dt;
        self.changed.extend(fields.clone());
        Ok(())
    }

    fn release(&mut self) -> Result<(), Refusal> {
        if self.grab.is_none() {
            return Ok(());
        }
        self.changed_world()?;
        self.grab.take().map_or(Ok(()), |grab| tools::release(self.running.world_mut(), grab))
    }

    /// What is held and where to: two points of the world [m].
    pub(crate) fn grabbed(&self) -> Option<[backstop::glam::DVec3; 2]> {
        tools::ends(self.world(), self.grab.as_ref().filter(|_| !self.grab_is_past)?)
    }

    /// What is known of the body that is inspected, if it is still there.
    pub(crate) fn inspected(&self) -> Option<Value> {
        let inspected = self.inspected.as_ref()?;
        inspected.told(self.world(), &self.drawing, self.names.get(&inspected.body).map(String::as_str))
    }

    /// A step.
    pub(crate) fn step(&mut self) -> Result<(), Refusal> {
        self.drop_past_grab()?;
        self.keep();
        let tick = Tick { dt: self.dt, time: self.time, controls: self.controls };
        self.running.step(&tick)?;
        self.step += 1;
        self.time += f64::from(self.dt);
        Ok(())
    }

    fn keep(&mut self) {
        let state = self.running.state();
        let moment = Moment { step: self.step, time: self.time, dt: self.dt, grab: self.grab, state };
        self.history.keep(self.running.world(), moment);
    }

    /// Back by so many steps, or as far as it goes.
    fn back(&mut self, steps: u64) -> Result<(), Refusal> {
        let Some(first) = self.history.first() else { return Ok(()) };
        self.seek(self.step.saturating_sub(steps).max(first.min(self.step)))
    }

    fn seek(&mut self, step: u64) -> Result<(), Refusal> {
        if step == self.step {
            return Ok(());
        }
        let gone = || Refusal::told(format!("step {step} is not kept"));
        if !self.history.has(step) {
            return Err(gone());
        }
        if !self.history.has(self.step) {
            // The way forward again.
            self.keep();
        }
        let moment = self.history.restore(self.running.world_mut(), step)?.ok_or_else(gone)?;
        let state;
        Moment { step: self.step, time: self.time, dt: self.dt, grab: self.grab, state } = moment;
        if let Some(state) = state {
            self.running.set_state(&*state);
        }
        self.grab_is_past = self.grab.is_some();
        Ok(())
    }

    /// Renews what is drawn where shapes have come or gone; whether they have.
    pub(crate) fn renew_drawing(&mut self) -> bool {
        self.drawing.renew(self.running.world())
    }
}
