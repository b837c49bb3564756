//! Bodies on their way through a step, and how far each row has come: for methods with substeps and for those
//! that solve for positions.
//!
//! A system has the directions of the start of the step. Here the arms of locks turn with their bodies, and
//! directions of joints with the first of them, so that a swinging body is held at its length. Contacts stay
//! as they are, to first order: a point of a ball that rolls does not roll with it.

use crate::problem::Law;
use crate::system::{Owner, SIDES, System, SystemRow, Velocity};
use glam::{DQuat, DVec3};

/// What a row measures.
#[derive(Clone, Copy, Debug)]
enum Measure {
    /// The displacement of two points along a direction that turns with the first body; their arms.
    Joint([DVec3; 2]),
    /// A rotation about an axis that turns with the first body.
    Angle,
    /// To first order only.
    Linear,
}

/// Displacement of a centre of mass [m], and rotation, since the start of the step.
pub(super) type Place = (DVec3, DQuat);

/// Displacements of bodies since the start of the step.
#[derive(Clone, Debug)]
pub(super) struct Posed<'a> {
    pub(super) system: &'a System,
    measures: Vec<Measure>,
    places: Vec<Place>,
    /// Sums of all rotation vectors [rad].
    turns: Vec<DVec3>,
}

impl<'a> Posed<'a> {
    pub(super) fn new(system: &'a System) -> Posed<'a> {
        let places = vec![(DVec3::ZERO, DQuat::IDENTITY); system.bodies.len()];
        let turns = vec![DVec3::ZERO; places.len()];
        Posed { system, measures: measures(system), places, turns }
    }

    /// Displacement [m] and rotation vector [rad].
    pub(super) fn moved(&self, body: usize) -> Velocity {
        self.since(&(DVec3::ZERO, DQuat::IDENTITY), body)
    }

    /// The same with the sum of all rotation vectors: the velocities that led there times their time.
    pub(super) fn travelled(&self, body: usize) -> Velocity {
        [self.places[body].0, self.turns[body]]
    }

    /// The same as the first since the body was at a place.
    pub(super) fn since(&self, before: &Place, body: usize) -> Velocity {
        let now = &self.places[body];
        [now.0 - before.0, rotation(now.1 * before.1.conjugate())]
    }

    /// Where bodies are.
    pub(super) fn places(&self) -> &[Place] {
        &self.places
    }

    /// Moves a body on.
    pub(super) fn displace(&mut self, body: usize, [way, turn]: Velocity) {
        self.turns[body] += turn;
        let place = &mut self.places[body];
        place.0 += way;
        place.1 = (DQuat::from_scaled_axis(turn) * place.1).normalize();
    }

    /// Displaces the bodies of a row with its present directions by an impulse times a time.
    pub(super) fn push(&mut self, now: &SystemRow, r: f64) {
        for side in 0..SIDES {
            let Some(i) = now.bodies[side].filter(|&i| self.system.bodies[i].dynamic) else { continue };
            let body = &self.system.bodies[i];
            let by = [body.inverse_mass * now.linear[side], body.inverse_inertia * now.angular[side]];
            self.displace(i, by.map(|by| by * r));
        }
    }

    /// By how much a row's displacement has grown since the start of the step [m] or [rad].
    pub(super) fn along(&self, row: usize) -> f64 {
        let start = &self.system.rows[row];
        match self.measures[row] {
            Measure::Joint(arms) => (self.first(start) * start.linear[1]).dot(self.apart(start, arms)),
            Measure::Angle => {
                let turned = self.first(start).conjugate() * self.turn_of(start.bodies[1]);
                start.angular[1].dot(rotation(turned))
            }
            Measure::Linear => {
                let side = |i: usize| {
                    start.bodies[i].map_or(0.0, |body| {
                        let [way, turn] = self.travelled(body);
                        start.linear[i].dot(way) + start.angular[i].dot(turn)
                    })
                };
                (0..SIDES).map(side).sum()
            }
        }
    }

    /// A row with its present directions.
    pub(super) fn row(&self, row: usize) -> SystemRow {
        let start = &self.system.rows[row];
        let mut now = *start;
        match self.measures[row] {
            Measure::Joint(arms) => {
                let d = self.first(start) * start.linear[1];
                let turned = [0, 1].map(|side| self.turn_of(start.bodies[side]) * arms[side]);
                (now.linear[0], now.linear[1]) = (-d, d);
                now.angular[0] = -(turned[0] + self.apart(start, arms)).cross(d);
                now.angular[1] = turned[1].cross(d);
            }
            Measure::Angle => {
                let turn = self.first(start);
                (0..2).for_each(|side| now.angular[side] = turn * start.angular[side]);
            }
            Measure::Linear => {}
        }
        now
    }

    /// The arm of a row that turns with its bodies on a side [m].
    pub(super) fn arm(&self, row: usize, side: usize) -> f64 {
        match self.measures[row] {
            Measure::Joint(arms) => arms.get(side).map_or(0.0, |arm| arm.length()),
            Measure::Angle | Measure::Linear => 0.0,
        }
    }

    fn turn_of(&self, body: Option<usize>) -> DQuat {
        body.map_or(DQuat::IDENTITY, |body| self.places[body].1)
    }

    fn first(&self, row: &SystemRow) -> DQuat {
        self.turn_of(row.bodies[0])
    }

    /// How far the second point of a row has moved from the first one since the start of the step.
    fn apart(&self, row: &SystemRow, arms: [DVec3; 2]) -> DVec3 {
        let moved = |side: usize| {
            row.bodies[side].map_or(DVec3::ZERO, |body| {
                self.places[body].0 + self.places[body].1 * arms[side] - arms[side]
            })
        };
        moved(1) - moved(0)
    }
}

/// The shorter rotation vector of a rotation [rad].
fn rotation(turn: DQuat) -> DVec3 {
    let turn = if turn.w < 0.0 { -turn } else { turn };
    let sine = turn.xyz().length();
    turn.xyz() * if sine < 1e-9 { 2.0 } else { 2.0 * libm::atan2(sine, turn.w) / sine }
}

/// What each row measures. The arms of a row are known across its direction only; rows of the same points
/// with other directions know the rest.
fn measures(system: &System) -> Vec<Measure> {
    let mut measures = vec![Measure::Linear; system.rows.len()];
    let mut i = 0;
    while let Some(law) = system.laws.get(i) {
        let first = law.first;
        let row = &system.rows[first];
        let is_lock = |j: usize| {
            system.laws.get(j).is_some_and(|other| {
                let lock = other.law == Law::LOCKED && other.gap.is_none() && !other.drives;
                lock && other.owner == law.owner && system.rows[other.first].linear[1] != DVec3::ZERO
            })
        };
        i += 1;
        if row.bodies[2..].iter().any(Option::is_some) {
            continue;
        }
        match (law.law, law.owner) {
            (Law::Bounds { .. }, Owner::Joint(_)) if row.linear[1] == DVec3::ZERO => {
                measures[first] = Measure::Angle;
            }
            (Law::Bounds { .. }, Owner::Joint(_)) if is_lock(i - 1) && is_lock(i) => {
                let arms = arms(row, &system.rows[first + 1]);
                measures[first..first + 2].fill(Measure::Joint(arms));
                i += 1;
                if is_lock(i) {
                    measures[first + 2] = Measure::Joint(arms);
                    i += 1;
                }
            }
            _ => {}
        }
    }
    measures
}

/// The arms of a row, of which another one with a direction across knows the part along its own.
fn arms(row: &SystemRow, other: &SystemRow) -> [DVec3; 2] {
    // J of an angular velocity is the arm times the direction; this is the arm's part across it.
    let across = |row: &SystemRow, side: usize| row.linear[side].cross(row.angular[side]);
    [0, 1].map(|side| {
        let direction = row.linear[side];
        across(row, side) + direction * across(other, side).dot(direction)
    })
}
