//! A system as a problem: W and q.

use super::*;
use crate::error::Error;
use crate::lab::problem::{Matrix, Problem};

/// What is done about overlap, beyond not letting it grow.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub enum Stabilisation {
    /// Nothing: no row demands a separating velocity.
    #[default]
    Rest,
    /// Overlap beyond `slop` is pushed apart by this share per second, no faster than `most`.
    Push {
        /// [1/s]
        rate: f64,
        /// [m]
        slop: f64,
        /// [m/s]
        most: f64,
        /// Share of the errors of joint locks that is corrected per second, with no limit [1/s].
        joint_rate: f64,
    },
}

impl System {
    /// The problem of the whole step, with q for a method to solve: velocities with gravity and forces
    /// applied, plus for open gaps the speed that would close them within the step, for approaches above the
    /// threshold the speed after the bounce, and the pull of springs.
    ///
    /// # Errors
    /// If a number is not finite.
    pub fn problem(&self, stabilisation: Stabilisation) -> Result<Problem, Error> {
        let all: Vec<usize> = (0..self.laws.len()).collect();
        self.problem_of(&all, stabilisation)
    }

    /// The problem of some laws, in ascending order: those of an island for instance. Other rows are left
    /// out.
    ///
    /// # Errors
    /// If a number is not finite, or a patch is among the laws without its normals.
    pub fn problem_of(&self, laws: &[usize], stabilisation: Stabilisation) -> Result<Problem, Error> {
        let mut place = vec![usize::MAX; self.rows.len()];
        let (mut rows, mut kept) = (Vec::new(), Vec::new());
        for &i in laws {
            let SystemLaw { law, first, .. } = self.laws[i];
            let own = first..first + law.rows();
            place[own.clone()].iter_mut().zip(rows.len()..).for_each(|(place, row)| *place = row);
            rows.extend(own);
            kept.push(match law {
                Law::Patch { mu, arm, first, count } => Law::Patch { mu, arm, first: place[first], count },
                other => other,
            });
        }
        let mut q = vec![0.0; rows.len()];
        for &i in laws {
            let law = &self.laws[i];
            for row in law.first..law.first + law.law.rows() {
                q[place[row]] = self.speed(&self.rows[row], |body| body.free) + self.rows[row].bias;
            }
            q[place[law.first]] += self.offset(law, stabilisation);
        }
        Problem::new(kept, self.matrix(&rows), q)
    }

    /// Whether a stabilisation changes the problem of an island.
    pub(in crate::lab) fn needs_push(&self, island: &SystemIsland, stabilisation: Stabilisation) -> bool {
        let mut laws = island.laws.iter().map(|&i| &self.laws[i]);
        laws.any(|law| self.offset(law, stabilisation) != self.offset(law, Stabilisation::Rest))
    }

    /// What is added to the velocity of a law's first row.
    fn offset(&self, law: &SystemLaw, stabilisation: Stabilisation) -> f64 {
        match (self.bounce(law), stabilisation) {
            (Some([end, _]), Stabilisation::Rest) => -end,
            (Some([_, mean]), Stabilisation::Push { .. }) => -mean,
            (None, _) => self.target(law, stabilisation),
        }
    }

    /// For a point that bounces within the step, its velocity at the end of the step and the mean over the
    /// step. It closes with its initial velocity, gravity and forces, separates at `e` times its closing
    /// speed, and is accelerated for the rest of the step.
    pub(in crate::lab) fn bounce(&self, law: &SystemLaw) -> Option<[f64; 2]> {
        let gap = law.gap?;
        let row = &self.rows[law.first];
        let start = self.speed(row, |body| body.start) + row.bias;
        if law.restitution <= 0.0 || -start <= self.threshold || gap + start * self.dt > 0.0 {
            return None;
        }
        let pull = (self.speed(row, |body| body.free) + row.bias - start) / self.dt;
        let gap = gap.max(0.0);
        // The first root of gap + start t + pull t² / 2; there is none if an acceleration away reverses it
        // before it closes.
        let root = (start * start - 2.0 * pull * gap).max(0.0).sqrt();
        let time = (2.0 * gap / (root - start)).min(self.dt);
        let left = self.dt - time;
        let part = -law.restitution * (start + pull * time);
        // A point that would come down again within the step is at rest.
        let end = (part + pull * left).max(0.0);
        let way = (part * left + 0.5 * pull * left * left).max(0.0) - gap;
        Some([end, way / self.dt])
    }

    /// The same without restitution.
    pub(in crate::lab) fn target(&self, law: &SystemLaw, stabilisation: Stabilisation) -> f64 {
        match (law.gap, stabilisation) {
            (Some(gap), _) if gap > 0.0 => gap / self.dt,
            (Some(gap), Stabilisation::Push { rate, slop, most, .. }) if gap < -slop => {
                ((gap + slop) * rate).max(-most)
            }
            (None, Stabilisation::Push { joint_rate, .. }) => law.off * joint_rate,
            _ => 0.0,
        }
    }

    /// W of some rows.
    fn matrix(&self, rows: &[usize]) -> Matrix {
        let mut of_body: Vec<Vec<(usize, usize)>> = vec![Vec::new(); self.bodies.len()];
        for (at, &row) in rows.iter().enumerate() {
            for (side, body) in self.rows[row].bodies.iter().enumerate() {
                if let Some(body) = body.filter(|&body| self.bodies[body].dynamic) {
                    of_body[body].push((at, side));
                }
            }
        }
        let mut entries = Vec::new();
        for (at, &row) in rows.iter().enumerate() {
            let compliance = self.rows[row].compliance;
            if compliance > 0.0 {
                entries.push((at, at, compliance));
            }
        }
        for (body, touching) in self.bodies.iter().zip(&of_body) {
            for &(i, side) in touching {
                let row = &self.rows[rows[i]];
                let (p, l) = (body.inverse_mass * row.linear[side], body.inverse_inertia * row.angular[side]);
                entries.extend(touching.iter().map(|&(j, side)| {
                    let other = &self.rows[rows[j]];
                    (i, j, p.dot(other.linear[side]) + l.dot(other.angular[side]))
                }));
            }
        }
        Matrix::from_entries(rows.len(), entries)
    }

    /// The entry of a row on the diagonal of W, without compliance [1/kg] or [1/(kg m²)].
    pub(in crate::lab) fn mobility(&self, row: &SystemRow) -> f64 {
        let side = |i: usize| {
            row.bodies[i].map_or(0.0, |body| {
                let body = &self.bodies[body];
                row.linear[i].dot(body.inverse_mass * row.linear[i])
                    + row.angular[i].dot(body.inverse_inertia * row.angular[i])
            })
        };
        (0..SIDES).map(side).sum()
    }
}
