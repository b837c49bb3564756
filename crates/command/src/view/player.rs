//! A run that is watched: it plays, stops, and goes to any step that it had been at.

use super::history::History;
use super::overlay::{self, Overlay};
use super::{Viewer, framing};
use crate::report::output::{count, plural};
use backstop::World;

/// The most steps to catch up at once: a run slower than real time is shown slower.
const CATCH_UP: f32 = 4.0;
/// The camera goes half of its way in this time [s].
const HALF_WAY: f32 = 0.4;

pub(crate) struct Player {
    pub(crate) viewer: Viewer,
    pub(crate) playing: bool,
    /// Whether the camera follows what moves.
    pub(crate) follows: bool,
    world: World,
    history: History,
    dt: f32,
    step: u64,
    /// The furthest step so far.
    furthest: u64,
    /// Time that has passed and is not stepped yet [s].
    due: f32,
}

impl Player {
    /// `follows`: unless the user has said where the eye is.
    pub(crate) fn new(mut viewer: Viewer, world: World, dt: f32, follows: bool) -> Player {
        viewer.frame(&world);
        let mut history = History::new();
        history.keep(&world, 0);
        Player { viewer, playing: true, follows, world, history, dt, step: 0, furthest: 0, due: 0.0 }
    }

    /// Plays on for so long [s].
    pub(crate) fn pass(&mut self, seconds: f32) -> anyhow::Result<()> {
        if self.playing {
            self.due = (self.due + seconds).min(CATCH_UP * self.dt);
            while self.due >= self.dt {
                self.due -= self.dt;
                self.one()?;
            }
        }
        if self.follows
            && let Some(goal) = framing(&self.world, self.viewer.camera, self.viewer.aspect())
        {
            let share = 1.0 - libm::exp2f(-seconds / HALF_WAY);
            self.viewer.camera = self.viewer.camera.towards(goal, share.into());
        }
        Ok(())
    }

    fn one(&mut self) -> anyhow::Result<()> {
        self.world.step(self.dt)?;
        self.step += 1;
        self.furthest = self.furthest.max(self.step);
        self.history.keep(&self.world, self.step);
        Ok(())
    }

    /// Stops, and goes so many steps on or back.
    pub(crate) fn skip(&mut self, steps: i64) -> anyhow::Result<()> {
        self.go_to(self.step.saturating_add_signed(steps))
    }

    /// Stops, and goes to a step.
    pub(crate) fn go_to(&mut self, step: u64) -> anyhow::Result<()> {
        (self.playing, self.due) = (false, 0.0);
        // From the step before, if there is one: contacts and the report are those of a step.
        let before = self.history.before(step.saturating_sub(1));
        if let Some((at, snapshot)) = before.filter(|(at, _)| step <= self.step || *at > self.step) {
            self.world.restore(snapshot)?;
            self.step = at;
        }
        while self.step < step {
            self.one()?;
        }
        Ok(())
    }

    /// Goes to where the scrubber is clicked, if it is, or is dragged.
    pub(crate) fn scrub(&mut self, x: f32, y: f32, dragged: bool) -> anyhow::Result<bool> {
        let (width, height) = self.viewer.canvas.size();
        let on = dragged || overlay::is_scrubber(y, height);
        if on {
            let to = (overlay::share_at(x, width) * self.furthest as f32).round() as u64;
            // Dragging sends many places for one step.
            if to != self.step {
                self.go_to(to)?;
            }
            self.playing = false;
        }
        Ok(on)
    }

    /// The picture, row by row from the top, each pixel as 0x00RRGGBB.
    pub(crate) fn picture(&mut self) -> Vec<u32> {
        let mut pixels = self.viewer.picture(&self.world);
        let (width, height) = self.viewer.canvas.size();
        let mut overlay = Overlay { pixels: &mut pixels, width, height };
        let share = self.step as f32 / self.furthest.max(1) as f32;
        let Ok(()) = overlay.lines(&self.figures()).and_then(|()| overlay.scrubber(share));
        pixels
    }

    /// Where the run is, and what the last step reports.
    pub(super) fn figures(&self) -> Vec<String> {
        let report = self.world.report();
        let points = u64::from(report.real) + u64::from(report.potential);
        vec![
            format!(
                "step {} of {}, {:.2} s{}",
                count(self.step),
                count(self.furthest),
                self.step as f32 * self.dt,
                if self.playing { "" } else { ", paused" }
            ),
            format!(
                "{}, {} asleep",
                plural(self.world.body_count() as u64, "body", "bodies"),
                count(report.asleep.into())
            ),
            format!(
                "{}, {} potential",
                plural(points, "contact point", "contact points"),
                count(report.potential.into())
            ),
            format!("{:.2} ms", report.times.step / 1000.0),
        ]
    }
}
