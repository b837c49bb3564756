//! What a sample is, and how it is run.

use backstop::{Error, World};
use std::{any::Any, rc::Rc};

/// A world to look at, and the file that makes it.
#[derive(Clone, Copy, Debug)]
pub struct Sample {
    /// Name of its file, without the ending.
    pub name: &'static str,
    /// Name of its folder.
    pub group: &'static str,
    /// Its file. The first line is `//! Title: what it shows.`, and a line `//! Keys: ...` says what
    /// [`Controls`] do.
    pub source: &'static str,
    /// Makes it.
    pub start: fn() -> Result<Box<dyn Running>, Error>,
}

impl Sample {
    /// The sample of a name.
    pub fn named(name: &str) -> Option<&'static Sample> {
        crate::SAMPLES.iter().find(|sample| sample.name == name)
    }

    /// Its title.
    pub fn title(&self) -> &'static str {
        self.heading().0
    }

    /// What it shows, in a sentence.
    pub fn about(&self) -> &'static str {
        self.heading().1
    }

    /// What its keys do; empty where it has none.
    pub fn keys(&self) -> &'static str {
        self.source.lines().find_map(|line| line.strip_prefix("//! Keys: ")).unwrap_or_default()
    }

    /// Its file in the repository.
    pub fn path(&self) -> String {
        format!("crates/samples/src/{}/{}.rs", self.group, self.name)
    }

    fn heading(&self) -> (&'static str, &'static str) {
        let first = self.source.lines().next().unwrap_or_default();
        first.trim_start_matches("//! ").split_once(": ").unwrap_or((first, ""))
    }
}

/// What the keys, or the fingers, ask for.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Controls {
    /// Forwards, -1 to 1.
    pub forward: f32,
    /// To the right, -1 to 1.
    pub right: f32,
    /// Jumps, or brakes.
    pub jump: bool,
    /// What else the sample has to do.
    pub action: bool,
}

/// A step to be taken.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Tick {
    /// Its length [s].
    pub dt: f32,
    /// Time at its beginning, since the start [s].
    pub time: f64,
    /// What the user asks for.
    pub controls: Controls,
}

impl Tick {
    /// Steps of 1/60 s that make up a time [s], without a user: for tests.
    pub fn during(seconds: f64) -> impl Iterator<Item = Tick> {
        let dt = 1.0 / 60.0;
        let tick =
            move |i: u32| Tick { dt, time: f64::from(i) * f64::from(dt), controls: Controls::default() };
        (0..(seconds / f64::from(dt)).round() as u32).map(tick)
    }
}

impl Tick {
    /// The numbers of the events in this step, of events every so often [s] that are counted from 0 at the
    /// start.
    pub fn due(&self, every: f64) -> std::ops::Range<usize> {
        (self.time / every).ceil() as usize..((self.time + f64::from(self.dt)) / every).ceil() as usize
    }
}

/// A sample while it runs.
///
/// What changes in it is in the world or in its [`state`](Running::state), so that a snapshot of the world
/// and that state are one of the sample: other fields are handles and constants.
pub trait Running {
    /// Its world.
    fn world(&self) -> &World;

    /// Its world, to be changed.
    fn world_mut(&mut self) -> &mut World;

    /// A step. A sample that has something to do before it does it here.
    ///
    /// # Errors
    ///
    /// Those of [`World::step`].
    fn step(&mut self, tick: &Tick) -> Result<(), Error> {
        self.world_mut().step(tick.dt)?;
        Ok(())
    }

    /// A copy of what changes outside the world, such as the gears of a car, if there is such a thing.
    fn state(&self) -> Option<Rc<dyn Any>> {
        None
    }

    /// Brings a copy back that [`state`](Running::state) gave; anything else changes nothing.
    fn set_state(&mut self, _: &dyn Any) {}
}

impl Running for World {
    fn world(&self) -> &World {
        self
    }

    fn world_mut(&mut self) -> &mut World {
        self
    }
}

#[cfg(test)]
mod tests {
    use crate::SAMPLES;
    use std::collections::HashSet;

    /// A sample is read in a minute: what each file must be, as the documentation of the package says.
    #[test]
    fn each_is_a_short_file_with_a_heading_and_a_test() {
        assert!(SAMPLES.len() >= 60, "{} samples", SAMPLES.len());
        let mut names = HashSet::new();
        for sample in SAMPLES {
            let lines = sample.source.lines().count();
            assert!(lines <= 60, "{} has {lines} lines", sample.path());
            let (title, about) = (sample.title(), sample.about());
            assert!(!title.is_empty() && about.ends_with('.'), "{}: {title}: {about}", sample.path());
            assert!(sample.source.contains("#[test]"), "{} has no test", sample.path());
            assert!(sample.source.contains(".controls") != sample.keys().is_empty(), "{}", sample.path());
            assert!(names.insert(sample.name), "two are named {}", sample.name);
        }
    }

    /// Whoever opens one sees it move or rest, and no number that is none: five seconds of each.
    #[test]
    fn each_runs_and_stays_finite() -> Result<(), backstop::Error> {
        for sample in SAMPLES {
            let mut running = (sample.start)()?;
            for tick in crate::Tick::during(5.0) {
                running.step(&tick)?;
            }
            let world = running.world();
            assert!(world.bodies().count() > 0, "{} is empty", sample.path());
            for body in world.bodies() {
                assert!(world.position(body)?.is_finite(), "{}", sample.path());
            }
        }
        Ok(())
    }
}
