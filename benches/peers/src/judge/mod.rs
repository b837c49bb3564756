//! How a run went, by the states of its bodies alone and so in the same way for every engine.

mod energy;
mod overlap;

use crate::engines::Engine;
use crate::scenes::{Error, Subject};
use backstop::BodyKind;
use backstop::glam::DVec3;
use backstop_lab::envelope::State;
use backstop_scene::Scene;
use serde::{Deserialize, Serialize};

/// Figures of a run; what the scene or the length of the run has no answer to is none. Lengths in m.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub(crate) struct Figures {
    /// How far the last body, the top, has moved after 3 and 60 s.
    pub(crate) top_3: Option<f64>,
    pub(crate) top_60: Option<f64>,
    /// How far the body that moved most has, after 3 and 60 s.
    pub(crate) drift_3: Option<f64>,
    pub(crate) drift_60: Option<f64>,
    /// The deepest overlap of two bodies at the end, meshes left out, and the mean of all overlaps.
    pub(crate) depth: Option<f64>,
    pub(crate) depth_mean: Option<f64>,
    /// The widest gap between the two anchors of a joint, at any time and at the end.
    pub(crate) joint_worst: Option<f64>,
    pub(crate) joint: Option<f64>,
    /// Kinetic and potential energy at the start and at the end [J], and the most at any time less that at
    /// the start.
    pub(crate) energy_start: Option<f64>,
    pub(crate) energy: Option<f64>,
    pub(crate) energy_gain: Option<f64>,
    /// The weight of all dynamic bodies [N]: energy over it is the height to which it lifts them all [m].
    pub(crate) weight: Option<f64>,
    /// Bodies that passed through something, or have no finite state.
    pub(crate) lost: Option<usize>,
    /// A hash of all poses at the end.
    pub(crate) hash: String,
}

impl Figures {
    /// The one that counts as the error.
    pub(crate) fn error(&self, error: Error) -> Option<f64> {
        match error {
            Error::Drift => self.drift_3,
            Error::Depth => self.depth,
            Error::Joint => self.joint_worst,
            Error::Lost => self.lost.map(|lost| lost as f64),
        }
    }
}

/// How many steps go by from one look to the next.
const EVERY: u32 = 6;
/// When standing things are looked at [steps].
const MOMENTS: [u32; 2] = [180, 3600];
/// How far a centre must be beyond a border to count as lost for good [m].
const GONE: f32 = 0.5;

/// Follows a run.
pub(crate) struct Judge<'a> {
    subject: &'a Subject,
    masses: energy::Masses,
    figures: Figures,
    gone: Vec<bool>,
}

impl<'a> Judge<'a> {
    pub(crate) fn new(subject: &'a Subject) -> Self {
        let masses = energy::Masses::of(&subject.scene);
        let states: Vec<State> = subject.scene.bodies.iter().map(|body| initial(&body.desc)).collect();
        let weight = Some(masses.mass() * f64::from(subject.scene.gravity.length()));
        let start = masses.energy(&subject.scene, &states);
        let figures =
            Figures { energy_start: Some(start), energy_gain: Some(0.0), weight, ..Figures::default() };
        Judge { subject, masses, figures, gone: vec![false; states.len()] }
    }

    /// To be called after each step.
    pub(crate) fn after_step(&mut self, step: u32, engine: &dyn Engine) {
        if step.is_multiple_of(EVERY) || MOMENTS.contains(&step) {
            let states = states(&self.subject.scene, engine);
            self.look(&states);
            if self.subject.stands && MOMENTS.contains(&step) {
                self.measure_drift(step, &states);
            }
        }
    }

    fn look(&mut self, states: &[State]) {
        let scene = &self.subject.scene;
        let energy = self.masses.energy(scene, states);
        let gain = energy - self.figures.energy_start.unwrap_or_default();
        self.figures.energy_gain = self.figures.energy_gain.map(|most| most.max(gain));
        self.figures.energy = Some(energy);
        if !scene.joints.is_empty() {
            let gap = widest_gap(scene, states);
            self.figures.joint_worst = Some(self.figures.joint_worst.unwrap_or_default().max(gap));
            self.figures.joint = Some(gap);
        }
        for (gone, state) in self.gone.iter_mut().zip(states) {
            *gone |= (self.subject.beyond)(state.position.as_vec3()) > GONE;
        }
    }

    fn measure_drift(&mut self, step: u32, states: &[State]) {
        let bodies = self.subject.scene.bodies.iter();
        let moved: Vec<f64> =
            bodies.zip(states).map(|(body, state)| (state.position - body.desc.position).length()).collect();
        let most = moved.iter().copied().fold(0.0, f64::max);
        let top = moved.last().copied();
        let figures = &mut self.figures;
        if step == MOMENTS[0] {
            (figures.top_3, figures.drift_3) = (top, Some(most));
        } else {
            (figures.top_60, figures.drift_60) = (top, Some(most));
        }
    }

    /// The figures, after the last step.
    pub(crate) fn finish(mut self, engine: &dyn Engine) -> Figures {
        let scene = &self.subject.scene;
        let states = states(scene, engine);
        self.look(&states);
        let lost = (0..states.len()).filter(|&i| {
            let is_dynamic = scene.bodies[i].desc.kind == BodyKind::Dynamic;
            let at = states[i].position.as_vec3();
            is_dynamic && (self.gone[i] || !is_finite(&states[i]) || (self.subject.beyond)(at) > 0.0)
        });
        self.figures.lost = Some(lost.count());
        if let Some((deepest, mean)) = overlap::of(scene, &states) {
            (self.figures.depth, self.figures.depth_mean) = (Some(deepest), Some(mean));
        }
        self.figures.hash = format!("{:016x}", hash(&states));
        self.figures
    }
}

fn initial(desc: &backstop::BodyDesc) -> State {
    State {
        position: desc.position,
        rotation: desc.rotation,
        linear: desc.linear_velocity,
        angular: desc.angular_velocity,
    }
}

fn states(scene: &Scene, engine: &dyn Engine) -> Vec<State> {
    (0..scene.bodies.len()).map(|body| engine.state(body)).collect()
}

fn is_finite(state: &State) -> bool {
    state.position.is_finite() && state.rotation.is_finite() && state.linear.is_finite()
}

/// The widest gap between the two anchors of a joint [m].
fn widest_gap(scene: &Scene, states: &[State]) -> f64 {
    let gaps = scene.joints.iter().map(|joint| {
        let [a, b] = [0, 1].map(|side| {
            let state = &states[joint.bodies[side]];
            state.position + (state.rotation * joint.frames[side].position).as_dvec3()
        });
        DVec3::distance(a, b)
    });
    // NaN is wider than anything.
    gaps.fold(0.0, |most, gap| if gap.is_nan() { f64::INFINITY } else { most.max(gap) })
}

/// FNV-1a of all poses, bit by bit: runs with the same hash are the same.
fn hash(states: &[State]) -> u64 {
    let numbers = states.iter().flat_map(|state| {
        let rotation = state.rotation.to_array().map(f64::from);
        state.position.to_array().into_iter().chain(rotation)
    });
    numbers
        .fold(0xcbf2_9ce4_8422_2325, |hash, number| (hash ^ number.to_bits()).wrapping_mul(0x0100_0000_01b3))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::scenes;

    #[test]
    fn scenes_start_inside_and_without_overlap() {
        for (name, ..) in scenes::ALL {
            let subject = scenes::build(name).unwrap();
            let bodies = &subject.scene.bodies;
            let states: Vec<State> = bodies.iter().map(|body| initial(&body.desc)).collect();
            for (body, state) in bodies.iter().zip(&states) {
                body.desc.validate().unwrap();
                let beyond = (subject.beyond)(state.position.as_vec3());
                assert!(body.desc.kind != BodyKind::Dynamic || beyond <= 0.0, "{name}: {beyond}");
            }
            // Bullets and ragdolls of chance may touch.
            let deepest = overlap::of(&subject.scene, &states).map_or(0.0, |depth| depth.0);
            assert!(deepest < 2e-3, "{name}: {deepest}");
        }
    }

    #[test]
    fn a_ball_in_free_fall_keeps_its_energy_and_is_lost_below_the_floor() {
        use crate::engines::content::Meshes;
        let mut subject = scenes::build("pile").unwrap();
        subject.scene.bodies.truncate(6);
        // The floor and the walls go, one body stays.
        subject.scene.bodies.drain(..5);
        let build = crate::engines::ALL[0].build;
        let config = subject.config(1, 1, false);
        let mut engine = build(&subject.scene, &Meshes::of(&subject.scene), &config).unwrap();
        let mut judge = Judge::new(&subject);
        for step in 1..=60 {
            engine.step(scenes::DT).unwrap();
            judge.after_step(step, engine.as_ref());
        }
        let figures = judge.finish(engine.as_ref());
        assert_eq!(figures.lost, Some(1));
        let (start, weight) = (figures.energy_start.unwrap(), figures.weight.unwrap());
        // To 5 cm of the height of five metres that it fell: half a substep of motion is 2 cm.
        assert!((figures.energy.unwrap() - start).abs() < 0.05 * weight, "{figures:?}");
    }
}
