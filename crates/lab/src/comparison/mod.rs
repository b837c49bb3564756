//! Methods of continuous collision side by side: six scenes, each run under every method in the same process,
//! frame by frame in turn, and judged by the same measures.
//!
//! [`Contest`] runs one scene; `docs/continuous.md` says what the measures mean and what came out.

mod judge;
mod measure;
mod truth;

use backstop::BodyHandle;
use backstop::Category;
use backstop::Error;
use backstop::World;
use backstop::{Continuous, ContinuousMethod, Settings};
pub use backstop_scene::builtin::continuous::DT;
use backstop_scene::{Scene, builtin};
use judge::Judge;
use truth::Truth;

/// A method as a world's settings choose it.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Method {
    /// Its name in tables.
    pub name: &'static str,
    /// [`Settings::continuous`].
    pub continuous: Continuous,
    /// [`Settings::method`].
    pub method: ContinuousMethod,
}

/// What is compared, in the order of every result; the last is the reference of the others.
pub const METHODS: [Method; 7] = {
    use ContinuousMethod::{ConservativeAdvancement, LinearCast, OnePass, Speculative, Talk};
    const fn method(name: &'static str, continuous: Continuous, method: ContinuousMethod) -> Method {
        Method { name, continuous, method }
    }
    [
        method("discrete", Continuous::Discrete, OnePass),
        method("linear-cast", Continuous::Segment, LinearCast),
        method("speculative", Continuous::Segment, Speculative),
        method("talk-method", Continuous::Segment, Talk),
        method("segment", Continuous::Segment, OnePass),
        method("volume", Continuous::Volume, OnePass),
        method("conservative-advancement", Continuous::Segment, ConservativeAdvancement),
    ]
};

/// Index of the reference in [`METHODS`].
pub const REFERENCE: usize = METHODS.len() - 1;

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

/// A world under one method.
#[derive(Debug)]
pub(crate) struct Entrant {
    pub(crate) world: World,
    pub(crate) bodies: Vec<BodyHandle>,
}

/// The results of a method on a scene.
#[derive(Clone, Copy, Debug, Default, PartialEq, serde::Serialize, serde::Deserialize)]
pub struct Verdict {
    /// Bodies that got through something, or that nothing stopped where something was.
    pub tunnelled: u32,
    /// Contacts that pushed in a step although the two bodies were never within 5 mm of each other, neither
    /// on their free paths nor on those that they took.
    pub ghosts: u32,
    /// Share of its kinetic energy that a body, or joined bodies together, had lost one step after their
    /// first impact; the mean.
    pub energy_lost: f64,
    /// The mean absolute difference of that from the reference's.
    pub energy_error: f64,
    /// For bodies that did not get through, the mean distance of the furthest point from the reference's, at
    /// the end of the step of the first impact [m]; 0 if all got through.
    pub distance_lost: f64,
    /// The worst of those [m].
    pub distance_worst: f64,
    /// The greatest opening of a joint at the end of a step [m].
    pub joint_opening: f64,
    /// First impacts that energy and distance are the means of.
    pub impacts: u32,
    /// The most bytes reserved at any time; `continuous_bytes` is the part of continuous collision.
    pub bytes: usize,
    /// See `bytes`.
    pub continuous_bytes: usize,
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

impl Entrant {
    fn new(scene: &Scene, method: &Method, threads: usize) -> Result<Entrant, Error> {
        let mut world = World::new(
            Settings::default()
                .with_gravity(scene.gravity)
                .with_continuous(method.continuous)
                .with_method(method.method)
                .with_threads(threads),
        )?;
        let bodies = scene.add_to(&mut world)?.bodies;
        Ok(Entrant { world, bodies })
    }
}
