//! Judges each method's step by the same measures.

use super::entrant::Entrant;
use super::measure::{Moving, apart, joints_of, moving, opening};
use super::method::{METHODS, REFERENCE};
use super::truth::Truth;
use backstop::BodyKind;
use backstop::observe::paths::ghosts;
use backstop_scene::Scene;
use backstop_scene::builtin::continuous::DT;
use glam::Vec3;

/// A change of momentum or spin by more than this share is an impact.
const IMPACT: f64 = 0.01;

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

/// Watches all worlds of a contest.
#[derive(Debug)]
pub(super) struct Judge {
    truth: Truth,
    gravity: Vec3,
    /// Indices of dynamic bodies in the scene, and their spins at the start.
    dynamic: Vec<usize>,
    spins: Vec<Vec3>,
    joints: Vec<([usize; 2], [Vec3; 2])>,
    groups: Vec<Group>,
    watched: Vec<Watched>,
}

/// Bodies connected by joints, or a single body.
#[derive(Debug, Default)]
struct Group {
    bodies: Vec<usize>,
    /// Its motion in the reference's world before the step.
    before: Moving,
    /// The step of its first impact there, and its motion before that.
    impact: Option<(u32, Moving)>,
    /// By method: the distance to the reference at the end of that step, for groups that did not get through,
    /// and the share of energy lost one step later.
    distance: [Option<f64>; METHODS.len()],
    lost: [Option<f64>; METHODS.len()],
}

/// The record of a method.
#[derive(Debug)]
struct Watched {
    through: Vec<bool>,
    ghosts: u32,
    opening: f64,
}

impl Judge {
    pub(super) fn new(scene: &Scene, truth: Truth, entrants: &[Entrant]) -> Judge {
        let is_dynamic = |&i: &usize| scene.bodies[i].desc.kind == BodyKind::Dynamic;
        let dynamic: Vec<usize> = (0..scene.bodies.len()).filter(is_dynamic).collect();
        let spins = dynamic.iter().map(|&i| scene.bodies[i].desc.angular_velocity).collect();
        let watched =
            entrants.iter().map(|_| Watched { through: vec![false; dynamic.len()], ghosts: 0, opening: 0.0 });
        Judge {
            truth,
            gravity: scene.gravity,
            spins,
            joints: joints_of(scene),
            groups: groups(scene, &dynamic),
            watched: watched.collect(),
            dynamic,
        }
    }

    /// Before a step.
    pub(super) fn before(&mut self, entrants: &[Entrant]) {
        for group in self.groups.iter_mut().filter(|group| group.impact.is_none()) {
            group.before = moving(&entrants[REFERENCE], &group.bodies);
        }
    }

    /// After a step, counted from 1.
    pub(super) fn after(&mut self, step: u32, entrants: &[Entrant]) {
        for (watched, entrant) in self.watched.iter_mut().zip(entrants) {
            self.truth.look(step, entrant, &self.dynamic, &self.spins, &mut watched.through);
            watched.ghosts += ghosts(&entrant.world);
            watched.opening = watched.opening.max(opening(&self.joints, entrant));
        }
        for group in &mut self.groups {
            match group.impact {
                None => {
                    let now = moving(&entrants[REFERENCE], &group.bodies);
                    if is_impact(&group.before, &now, self.gravity) {
                        group.impact = Some((step, group.before));
                        for (k, entrant) in entrants.iter().enumerate() {
                            let through = |body: &usize| {
                                let place = self.dynamic.binary_search(body);
                                place.is_ok_and(|place| self.watched[k].through[place])
                            };
                            let distance = apart(&entrants[REFERENCE], entrant, &group.bodies);
                            group.distance[k] = (!group.bodies.iter().any(through)).then_some(distance);
                        }
                    }
                }
                Some((at, before)) if step == at + 1 => {
                    for (k, entrant) in entrants.iter().enumerate() {
                        let now = moving(entrant, &group.bodies);
                        group.lost[k] = Some((before.energy - now.energy) / before.kinetic);
                    }
                }
                Some(_) => {}
            }
        }
    }

    pub(super) fn verdicts(&self) -> [Verdict; METHODS.len()] {
        std::array::from_fn(|k| {
            let watched = &self.watched[k];
            let lost = |k: usize| self.groups.iter().filter_map(move |group| group.lost[k]);
            let errors = lost(k).zip(lost(REFERENCE)).map(|(own, real)| (own - real).abs());
            let distances = self.groups.iter().filter_map(|group| group.distance[k]);
            Verdict {
                tunnelled: watched.through.iter().filter(|&&through| through).count() as u32,
                ghosts: watched.ghosts,
                energy_lost: mean(lost(k)),
                energy_error: mean(errors),
                distance_lost: mean(distances.clone()),
                distance_worst: distances.fold(0.0, f64::max),
                joint_opening: watched.opening,
                impacts: self.groups.iter().filter(|group| group.impact.is_some()).count() as u32,
                ..Verdict::default()
            }
        })
    }
}

fn mean(values: impl Iterator<Item = f64>) -> f64 {
    let (sum, count) = values.fold((0.0, 0u32), |(sum, count), value| (sum + value, count + 1));
    if count == 0 { 0.0 } else { sum / f64::from(count) }
}

/// Whether a step changed a group by more than gravity does.
fn is_impact(before: &Moving, now: &Moving, gravity: Vec3) -> bool {
    let fall = gravity.as_dvec3() * (before.mass * f64::from(DT));
    let pushed = (now.momentum - before.momentum - fall).length();
    let turned = (now.spin - before.spin).length();
    // For slow groups, a share of their own momentum would be too sensitive.
    let slow = 0.1 * before.mass;
    pushed > IMPACT * (before.momentum.length() + slow) || turned > IMPACT * (before.spin.length() + slow)
}

/// The groups of dynamic bodies that joints connect.
fn groups(scene: &Scene, dynamic: &[usize]) -> Vec<Group> {
    let mut first: Vec<usize> = (0..scene.bodies.len()).collect();
    loop {
        let before = first.clone();
        for joint in &scene.joints {
            let [a, b] = joint.bodies;
            let least = first[a].min(first[b]);
            (first[a], first[b]) = (least, least);
        }
        if first == before {
            break;
        }
    }
    let of = |&root: &usize| {
        let bodies: Vec<usize> = dynamic.iter().copied().filter(|&i| first[i] == root).collect();
        (!bodies.is_empty()).then(|| Group { bodies, ..Group::default() })
    };
    (0..scene.bodies.len()).collect::<Vec<_>>().iter().filter_map(of).collect()
}
