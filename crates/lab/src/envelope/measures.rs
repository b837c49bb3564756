//! How a run is judged: by figures computed from the states of its bodies alone, so that any engine can be
//! judged by them.

use super::insides::Insides;
use super::reach::reach;
use backstop::MassProperties;
use backstop::{BodyDesc, BodyKind};
use backstop_scene::{Scene, SceneJoint};
use glam::{DVec3, Quat, Vec3};

/// The state of a body.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct State {
    /// Position of its origin [m].
    pub position: DVec3,
    /// Its rotation.
    pub rotation: Quat,
    /// Velocity of its centre of mass [m/s].
    pub linear: Vec3,
    /// Angular velocity about the world's axes [rad/s].
    pub angular: Vec3,
}

impl State {
    /// The initial state by a description.
    pub(super) fn of(desc: &BodyDesc) -> State {
        State {
            position: desc.position,
            rotation: desc.rotation,
            linear: desc.linear_velocity,
            angular: desc.angular_velocity,
        }
    }

    fn is_finite(&self) -> bool {
        self.position.is_finite()
            && self.rotation.is_finite()
            && self.linear.is_finite()
            && self.angular.is_finite()
    }
}

/// How a run went.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash, serde::Serialize, serde::Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum Verdict {
    /// As it should.
    Stable,
    /// Worse, but in one piece.
    Degraded,
    /// Fallen, thrown apart, through a wall, or not finite.
    Lost,
}

impl Verdict {
    /// In a word.
    pub fn name(self) -> &'static str {
        match self {
            Verdict::Stable => "stable",
            Verdict::Degraded => "degraded",
            Verdict::Lost => "lost",
        }
    }
}

/// The boundary of a half-space that bodies must stay out of: a plane through a point, whose normal points to
/// the allowed side.
#[derive(Clone, Copy, Debug)]
pub(super) struct Boundary {
    pub(super) point: DVec3,
    pub(super) normal: Vec3,
}

/// A figure, without unit.
#[derive(Clone, Debug)]
pub(super) enum Measure {
    /// The greatest distance of a body from its start, at the end.
    Moved { unit: f64 },
    /// The deepest point of a body beyond a boundary, in the second half of the run.
    Depth { unit: f64 },
    /// Bodies whose centre of mass was beyond a boundary at any time.
    Through,
    /// The greatest distance between a joint's two anchors.
    Apart { unit: f64 },
    /// The greatest energy in excess of that at the start [J].
    Gain { unit: f64 },
    /// Energy lost at the end [J].
    Loss { unit: f64 },
    /// Difference of a body's speed at the end from that at the start.
    Speed { body: usize },
    /// Difference of its spin.
    Spin { body: usize },
    /// The greatest distance of a body from the straight line of its motion at the start.
    Aside { unit: f64 },
    /// The greatest distance of the first body of a pair from its place on the second, at the end.
    Carried { unit: f64, pairs: Vec<[usize; 2]> },
    /// Difference of the angle of a joint about its axis x from a stop on either side [rad], in the second
    /// half of the run.
    Stop { joint: usize, angle: f64 },
    /// The greatest speed of a body.
    Fastest { unit: f64 },
    /// The greatest speed of a body in the second half of the run.
    Restless { unit: f64 },
    /// The deepest overlap of a body with another, or with a static box, in the second half of the run: that
    /// of balls which are inside of them, so a lower bound. Joined bodies count against static boxes alone.
    Overlap { unit: f64 },
    /// Bodies whose centre of mass was in a static box at any time.
    Inside,
}

impl Measure {
    fn name(&self) -> &'static str {
        match self {
            Measure::Moved { .. } => "moved",
            Measure::Depth { .. } => "depth",
            Measure::Through => "through",
            Measure::Apart { .. } => "apart",
            Measure::Gain { .. } => "gain",
            Measure::Loss { .. } => "loss",
            Measure::Speed { .. } => "speed",
            Measure::Spin { .. } => "spin",
            Measure::Aside { .. } => "aside",
            Measure::Carried { .. } => "carried",
            Measure::Stop { .. } => "stop",
            Measure::Fastest { .. } => "fastest",
            Measure::Restless { .. } => "restless",
            Measure::Overlap { .. } => "overlap",
            Measure::Inside => "inside",
        }
    }
}

/// A measure with two bounds: up to the first the run is stable, up to the second degraded.
#[derive(Clone, Debug)]
pub(super) struct Gauge {
    pub(super) measure: Measure,
    pub(super) bounds: [f64; 2],
}

/// A figure and what it means.
#[derive(Clone, Copy, Debug, PartialEq, serde::Serialize)]
pub struct Figure {
    /// The measure: `moved`, `depth`, `through`, `apart`, `gain`, `loss`, `speed`, `spin`, `aside`,
    /// `carried`, `stop`, `fastest`, `restless`, `overlap`, `inside`, or `finite`.
    pub measure: &'static str,
    /// Value without unit; for `finite`, 1 means that a state was not finite.
    pub value: f64,
    /// Verdict by the measure's bounds.
    pub verdict: Verdict,
}

/// Watches a run by the states of its bodies.
#[derive(Clone, Debug)]
pub struct Watch {
    bodies: Vec<BodyDesc>,
    masses: Vec<MassProperties>,
    joints: Vec<SceneJoint>,
    insides: Insides,
    gravity: Vec3,
    boundaries: Vec<Boundary>,
    gauges: Vec<Gauge>,
    /// The value of each gauge.
    values: Vec<f64>,
    energy: f64,
    /// Time after which depth counts [s].
    settled: f64,
    finite: bool,
}

impl Watch {
    pub(super) fn new(scene: &Scene, boundaries: Vec<Boundary>, gauges: Vec<Gauge>, seconds: f64) -> Watch {
        let bodies = scene.descs();
        let masses = bodies.iter().map(mass_of).collect();
        let mut watch = Watch {
            masses,
            joints: scene.joints.clone(),
            insides: Insides::of(&bodies),
            gravity: scene.gravity,
            boundaries,
            values: vec![0.0; gauges.len()],
            gauges,
            energy: 0.0,
            settled: 0.5 * seconds,
            finite: true,
            bodies,
        };
        watch.energy = watch.energy_of(&watch.bodies.iter().map(State::of).collect::<Vec<_>>());
        watch
    }

    /// Observes the bodies, in the order of the scene, at a time since the start [s]. The last observation
    /// counts as the end.
    pub fn see(&mut self, time: f64, states: &[State]) {
        self.finite &= states.iter().all(State::is_finite);
        if !self.finite {
            return;
        }
        for i in 0..self.gauges.len() {
            self.values[i] = self.value(i, time, states);
        }
    }

    /// Whether all states were finite so far; if not, there is no point in going on.
    pub fn is_finite(&self) -> bool {
        self.finite
    }

    /// All figures: the worst first.
    pub fn figures(&self) -> Vec<Figure> {
        if !self.finite {
            return vec![Figure { measure: "finite", value: 1.0, verdict: Verdict::Lost }];
        }
        let mut figures: Vec<_> = self.gauges.iter().zip(&self.values).map(figure).collect();
        // Among equal verdicts, the figure closest to the end of its range is the worst.
        figures.sort_by(|a, b| b.1.total_cmp(&a.1));
        figures.into_iter().map(|(figure, _)| figure).collect()
    }

    fn value(&self, gauge: usize, time: f64, states: &[State]) -> f64 {
        let before = self.values[gauge];
        let moving = || self.bodies.iter().zip(states).filter(|(desc, _)| desc.kind == BodyKind::Dynamic);
        let gained = || self.energy_of(states) - self.energy;
        let kept = |now: Vec3, start: Vec3| f64::from((now.length() / start.length() - 1.0).abs());
        match &self.gauges[gauge].measure {
            Measure::Moved { unit } => {
                let ways = moving().map(|(desc, state)| (state.position - desc.position).length());
                ways.fold(0.0, f64::max) / unit
            }
            Measure::Depth { unit } if time >= self.settled => {
                let depths = moving().map(|(desc, state)| self.depth(desc, state));
                depths.fold(before, |most, depth| most.max(depth / unit))
            }
            Measure::Depth { .. } => before,
            Measure::Through => {
                let beyond =
                    |&i: &usize| self.boundaries.iter().any(|b| above(b, self.centre(i, states)) < 0.0);
                let dynamic = |&i: &usize| self.bodies[i].kind == BodyKind::Dynamic;
                before.max((0..states.len()).filter(dynamic).filter(beyond).count() as f64)
            }
            Measure::Apart { unit } => {
                let gaps = self.joints.iter().map(|joint| {
                    let [a, b] = [0, 1].map(|side| {
                        let state = &states[joint.bodies[side]];
                        state.position + (state.rotation * joint.frames[side].position).as_dvec3()
                    });
                    (a - b).length()
                });
                gaps.fold(before, |most, gap| most.max(gap / unit))
            }
            Measure::Gain { unit } => before.max(gained() / unit),
            Measure::Loss { unit } => (-gained() / unit).max(0.0),
            &Measure::Speed { body } => kept(states[body].linear, self.bodies[body].linear_velocity),
            &Measure::Spin { body } => kept(states[body].angular, self.bodies[body].angular_velocity),
            Measure::Aside { unit } => {
                let ways = moving().map(|(desc, state)| {
                    let line = desc.linear_velocity.as_dvec3().normalize_or_zero();
                    (state.position - desc.position).reject_from_normalized(line).length()
                });
                ways.fold(before, |most, way| most.max(way / unit))
            }
            Measure::Carried { unit, pairs } => {
                let place = |[body, on]: [usize; 2], at: &dyn Fn(usize) -> State| {
                    (at(on).rotation.as_dquat().inverse()) * (at(body).position - at(on).position)
                };
                let way = |&pair: &[usize; 2]| {
                    let start = place(pair, &|i| State::of(&self.bodies[i]));
                    (place(pair, &|i| states[i]) - start).length()
                };
                pairs.iter().map(way).fold(0.0, f64::max) / unit
            }
            Measure::Fastest { unit } => before.max(self.fastest(states) / unit),
            Measure::Inside => {
                let inside = |&i: &usize| {
                    self.bodies[i].kind == BodyKind::Dynamic
                        && self.insides.holds(self.centre(i, states), states)
                };
                before.max((0..states.len()).filter(inside).count() as f64)
            }
            _ if time < self.settled => before,
            Measure::Stop { joint, angle } => before.max((self.angle(*joint, states).abs() - angle).abs()),
            Measure::Restless { unit } => before.max(self.fastest(states) / unit),
            Measure::Overlap { unit } => {
                before.max(self.insides.deepest(states, self.joints.is_empty()) / unit)
            }
        }
    }

    fn centre(&self, body: usize, states: &[State]) -> DVec3 {
        states[body].position + (states[body].rotation * self.masses[body].centre_of_mass).as_dvec3()
    }

    fn fastest(&self, states: &[State]) -> f64 {
        let moving = self.bodies.iter().zip(states).filter(|(desc, _)| desc.kind == BodyKind::Dynamic);
        moving.map(|(_, state)| f64::from(state.linear.length())).fold(0.0, f64::max)
    }

    /// How far the second body of a joint is turned in the first, about the axis x of its frames [rad].
    fn angle(&self, joint: usize, states: &[State]) -> f64 {
        let joint = &self.joints[joint];
        let [a, b] = [0, 1].map(|side| {
            (states[joint.bodies[side]].rotation * joint.frames[side].rotation).as_dquat().normalize()
        });
        let turn = a.inverse() * b;
        let angle = 2.0 * libm::atan2(turn.x, turn.w);
        libm::remainder(angle, std::f64::consts::TAU)
    }

    /// How deep a body is beyond the boundaries [m].
    fn depth(&self, desc: &BodyDesc, state: &State) -> f64 {
        let beyond = |b: &Boundary| reach(desc, state.rotation, -b.normal) - above(b, state.position);
        self.boundaries.iter().map(beyond).fold(0.0, f64::max)
    }

    /// Kinetic and potential energy [J].
    fn energy_of(&self, states: &[State]) -> f64 {
        let one = |(i, mass): (usize, &MassProperties)| {
            let state = &states[i];
            // Heights are relative to the start: far from the origin nothing else would be exact.
            let way = state.position - self.bodies[i].position
                + (state.rotation * mass.centre_of_mass - self.bodies[i].rotation * mass.centre_of_mass)
                    .as_dvec3();
            let spin = (state.rotation.inverse() * state.angular).as_dvec3();
            let moments = mass.inertia.as_dmat3() * spin;
            let m = f64::from(mass.mass);
            0.5 * (m * state.linear.as_dvec3().length_squared() + moments.dot(spin))
                - m * self.gravity.as_dvec3().dot(way)
        };
        let dynamic = |&(i, _): &(usize, &MassProperties)| self.bodies[i].kind == BodyKind::Dynamic;
        self.masses.iter().enumerate().filter(dynamic).map(one).sum()
    }
}

fn above(boundary: &Boundary, position: DVec3) -> f64 {
    (position - boundary.point).dot(boundary.normal.as_dvec3())
}

/// A figure and its rank: stable below 1, degraded below 2, else lost.
fn figure((gauge, &value): (&Gauge, &f64)) -> (Figure, f64) {
    let [stable, degraded] = gauge.bounds;
    let (verdict, badness) = match value {
        value if value <= stable => (Verdict::Stable, value / stable.max(1e-30)),
        value if value <= degraded => (Verdict::Degraded, 1.0 + value / degraded),
        _ => (Verdict::Lost, 2.0 + value),
    };
    (Figure { measure: gauge.measure.name(), value, verdict }, badness)
}

pub(super) fn mass_of(desc: &BodyDesc) -> MassProperties {
    let of = |shape: &backstop::ShapeDesc| {
        MassProperties::of(&shape.geometry, shape.density).transformed(shape.position, shape.rotation)
    };
    match desc.kind {
        BodyKind::Dynamic => desc
            .mass
            .unwrap_or_else(|| MassProperties::combine(&desc.shapes.iter().map(of).collect::<Vec<_>>())),
        _ => MassProperties::ZERO,
    }
}
