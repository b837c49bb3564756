//! Methods of continuous collision side by side: six scenes, each run under every method in the same process,
//! frame by frame in turn, and judged by the same measures.
//!
//! [`Contest`] runs one scene; `docs/continuous.md` says what the measures mean and what came out.

mod entrant;
mod judge;
mod measure;
mod method;
mod truth;

pub use backstop_scene::builtin::continuous::DT;
pub use judge::Verdict;
pub use method::{METHODS, Method, REFERENCE};

use backstop::Category;
use backstop::Error;
use backstop_scene::builtin;
use entrant::Entrant;
use judge::Judge;
use truth::Truth;

/// The scenes, by their names in [`builtin`].
pub const SCENES: [&str; 6] = ["talk", "posts", "blades", "deflector", "head_on", "ragdoll_wall"];

/// Steps of the talk's scene: the last body strikes the ground at the 33rd.
const TALK_STEPS: u32 = 45;

/// A scene under every method at once.
#[derive(Debug)]
pub struct Contest {
    entrants: Vec<Entrant>,
    judge: Judge,
    step: u32,
    steps: u32,
}

impl Contest {
    /// One of [`SCENES`] at its start; `None` for another name. `threads`: as [`Settings::threads`].
    ///
    /// # Errors
    /// If the number of threads is out of range.
    pub fn new(name: &str, threads: usize) -> Result<Option<Contest>, Error> {
        let Some(mut scene) = SCENES.contains(&name).then(|| builtin::build(name)).flatten() else {
            return Ok(None);
        };
        if name == "talk" {
            scene.steps = TALK_STEPS;
        }
        let entrants = METHODS.iter().map(|method| Entrant::new(&scene, method, threads));
        let entrants: Vec<Entrant> = entrants.collect::<Result<_, _>>()?;
        let judge = Judge::new(&scene, Truth::of(&scene), &entrants);
        Ok(Some(Contest { entrants, judge, step: 0, steps: scene.steps }))
    }

    /// Steps that the scene is made for.
    pub fn steps(&self) -> u32 {
        self.steps
    }

    /// Steps every world in turn, a different one first each time, and judges what they did. Returns how long
    /// each took [us].
    ///
    /// # Errors
    /// None that these scenes should give.
    pub fn step(&mut self) -> Result<[f32; METHODS.len()], Error> {
        let mut times = [0.0; METHODS.len()];
        self.judge.before(&self.entrants);
        for k in 0..METHODS.len() {
            let i = (self.step as usize + k) % METHODS.len();
            times[i] = self.entrants[i].world.step(DT)?.times.step;
        }
        self.step += 1;
        self.judge.after(self.step, &self.entrants);
        Ok(times)
    }

    /// The results of the methods so far.
    pub fn verdicts(&self) -> [Verdict; METHODS.len()] {
        let mut verdicts = self.judge.verdicts();
        for (verdict, entrant) in verdicts.iter_mut().zip(&self.entrants) {
            let memory = entrant.world.memory();
            verdict.bytes = memory.iter().map(|(_, bytes)| bytes.peak).sum();
            verdict.continuous_bytes = memory.category(Category::Continuous).peak;
        }
        verdicts
    }
}
