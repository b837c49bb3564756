//! Bodies of a system with velocities that impulses change.

use crate::system::{SIDES, System, SystemBody, SystemRow, Velocity};
use glam::DVec3;

/// Velocities of all bodies, and which of them are held for now.
pub(super) struct Moving<'a> {
    pub(super) system: &'a System,
    pub(super) velocity: Vec<Velocity>,
    pub(super) frozen: Vec<bool>,
    /// Displacements by [`Moving::fly`] [m], [rad].
    pub(super) way: Vec<Velocity>,
}

impl<'a> Moving<'a> {
    pub(super) fn new(system: &'a System, of: impl Fn(&SystemBody) -> Velocity) -> Moving<'a> {
        let velocity = system.bodies.iter().map(of).collect();
        let count = system.bodies.len();
        Moving { system, velocity, frozen: vec![false; count], way: vec![[DVec3::ZERO; 2]; count] }
    }

    /// Velocity of a row, with its bias [m/s].
    pub(super) fn speed(&self, row: usize) -> f64 {
        let row = &self.system.rows[row];
        let side = |i: usize| {
            row.bodies[i].map_or(0.0, |body| {
                let [v, w] = self.velocity[body];
                row.linear[i].dot(v) + row.angular[i].dot(w)
            })
        };
        side(0) + side(1) + row.bias
    }

    fn moves(&self, body: usize) -> bool {
        self.system.bodies[body].dynamic && !self.frozen[body]
    }

    /// Gives a row an impulse.
    pub(super) fn push(&mut self, row: usize, r: f64) {
        self.push_along(&self.system.rows[row], r);
    }

    /// The same for a row that may have other directions than those of the system.
    pub(super) fn push_along(&mut self, row: &SystemRow, r: f64) {
        for side in 0..SIDES {
            if let Some(i) = row.bodies[side].filter(|&i| self.moves(i)) {
                let body = &self.system.bodies[i];
                self.velocity[i][0] += body.inverse_mass * row.linear[side] * r;
                self.velocity[i][1] += body.inverse_inertia * row.angular[side] * r;
            }
        }
    }

    /// By how much an impulse of one row changes the velocity of another [1/kg].
    pub(super) fn coupling(&self, a: &SystemRow, b: &SystemRow) -> f64 {
        let mut sum = 0.0;
        for side in 0..SIDES {
            let Some(i) = a.bodies[side].filter(|&i| self.moves(i)) else { continue };
            for other in (0..SIDES).filter(|&other| b.bodies[other] == Some(i)) {
                let body = &self.system.bodies[i];
                let (p, l) = (body.inverse_mass * b.linear[other], body.inverse_inertia * b.angular[other]);
                sum += a.linear[side].dot(p) + a.angular[side].dot(l);
            }
        }
        sum
    }

    /// Applies gravity and forces of the whole step to all velocities.
    pub(super) fn pull(&mut self) {
        for (velocity, body) in self.velocity.iter_mut().zip(&self.system.bodies) {
            for (k, velocity) in velocity.iter_mut().enumerate() {
                *velocity += body.free[k] - body.start[k];
            }
        }
    }

    /// All bodies fly for part of the step [s].
    pub(super) fn fly(&mut self, time: f64) {
        let share = time / self.system.dt;
        for ((velocity, way), body) in self.velocity.iter_mut().zip(&mut self.way).zip(&self.system.bodies) {
            for k in 0..2 {
                let gain = (body.free[k] - body.start[k]) * share;
                way[k] += (velocity[k] + 0.5 * gain) * time;
                velocity[k] += gain;
            }
        }
    }

    /// Velocities of some bodies.
    pub(super) fn of(&self, bodies: &[usize]) -> Vec<Velocity> {
        bodies.iter().map(|&i| self.velocity[i]).collect()
    }

    /// Whether all velocities are numbers.
    pub(super) fn is_finite(&self) -> bool {
        self.velocity.iter().flatten().all(|v: &DVec3| v.is_finite())
    }
}
