//! Errors of the laws after a step.

use super::Measures;
use crate::problem::{Law, Residual, project_cone, project_disc};
use crate::system::{System, SystemLaw};
use backstop::observe::JointRow;

/// Points that are slower than this do not count as sliding [m/s].
const STICK: f64 = 1e-3;
/// Lower bound of the velocities that errors are relative to [m/s], so that rounding is not taken for an
/// error.
const FLOOR: f64 = 1e-4;

/// A step after it is done: velocities of rows at the final poses, and gaps of one-sided laws.
pub(super) struct Found<'a> {
    system: &'a System,
    /// Velocities of rows at the end.
    u: Vec<f64>,
    /// Velocities of rows with gravity and forces applied, before any impulse.
    free: Vec<f64>,
    /// Gaps at the end, by laws; for rigid directions of joints, their errors, and the energies stored.
    gap: Vec<f64>,
    off: Vec<f64>,
    stored: Vec<f64>,
    /// Diagonal of W, by rows.
    scale: Vec<f64>,
}

impl<'a> Found<'a> {
    /// `joints`: the rows of joints at the end of the step.
    pub(super) fn new(system: &'a System, joints: &[JointRow]) -> Found<'a> {
        let mut found = Found {
            system,
            u: system.rows.iter().map(|row| system.speed(row, |body| body.end) + row.bias).collect(),
            free: system.rows.iter().map(|row| system.speed(row, |body| body.free) + row.bias).collect(),
            gap: vec![f64::INFINITY; system.laws.len()],
            off: vec![0.0; system.laws.len()],
            stored: vec![0.0; system.laws.len()],
            scale: system.rows.iter().map(|row| system.mobility(row)).collect(),
        };
        let contacts = system.contacts;
        for (i, law) in system.laws.iter().enumerate() {
            if let Some(gap) = law.gap {
                found.gap[i] = gap + system.speed(&system.rows[law.first], |body| body.moved);
            }
            // Directions of joints rotate with the bodies: they are taken at the final poses.
            if let Some(joint) = i.checked_sub(contacts).and_then(|i| joints.get(i)) {
                found.u[law.first] = system.speed(&joint.row, |body| body.end) + system.rows[law.first].bias;
                found.off[i] = joint.error.abs();
                found.gap[i] = joint.gap.unwrap_or(f64::INFINITY);
                // A stop's error is opposite to its displacement.
                let displacement = if joint.gap.is_some() { -joint.error } else { joint.error };
                let force = system.rows[law.first].impulse / system.dt;
                found.stored[i] = (-0.5 * force * displacement).max(0.0);
            }
        }
        found
    }

    pub(super) fn measure(&self, laws: &[usize]) -> Measures {
        let mut out = Measures::default();
        let (mut errors, mut all) = (0.0, 0.0);
        for &i in laws {
            let law = &self.system.laws[i];
            self.overlap(i, law, &mut out);
            if law.yields || law.bouncing {
                *if law.yields { &mut out.soft } else { &mut out.bouncing } += 1;
                continue;
            }
            out.laws += 1;
            let (error, free) = self.error(i, law);
            errors += error * error;
            all += free * free;
            if error > out.residual.worst {
                (out.residual.worst, out.worst) = (error, Some(law.owner));
            }
            self.friction(law, &mut out);
        }
        out.residual = Residual { relative: errors.sqrt() / all.sqrt().max(FLOOR), ..out.residual };
        out
    }

    /// Overlap, joint errors and the law of Signorini.
    fn overlap(&self, i: usize, law: &SystemLaw, out: &mut Measures) {
        let contact = i < self.system.contacts;
        if !contact {
            out.stored += self.stored[i];
            let angle = self.system.rows[law.first].angle;
            let most = if angle { &mut out.joint_angle } else { &mut out.joint_length };
            // The rows of a lock are in sequence.
            *most = most.max(self.off_of_lock(i, law));
            return;
        }
        let Some(start) = law.gap else { return };
        let (speed, load) = (self.u[law.first], self.system.rows[law.first].impulse);
        let deep = (-start).max(0.0);
        out.points[usize::from(law.potential)] += 1;
        out.penetration = out.penetration.max(deep);
        out.penetration_squares += deep * deep;
        out.penetration_share = out.penetration_share.max(deep / law.size);
        if law.bouncing {
            return;
        }
        let speed = speed - self.bounce(law, start);
        if start <= 0.0 || load > 0.0 {
            out.approach = out.approach.max(-speed);
        }
        out.parting = out.parting.max(load * speed);
    }

    /// Error of the lock that a law belongs to, over all of its directions.
    fn off_of_lock(&self, i: usize, law: &SystemLaw) -> f64 {
        let angle = self.system.rows[law.first].angle;
        let same = |j: usize| {
            let other = &self.system.laws[j];
            other.owner == law.owner && other.law == law.law && self.system.rows[other.first].angle == angle
        };
        let first = (self.system.contacts..i).rev().take_while(|&j| same(j)).last().unwrap_or(i);
        let last = (i..self.system.laws.len()).take_while(|&j| same(j)).last().unwrap_or(i);
        (first..=last).map(|j| self.off[j] * self.off[j]).sum::<f64>().sqrt()
    }

    /// The speed at which a point has to separate after a bounce. It is known only up to what gravity adds
    /// within the step, since the time of the impact is not known.
    fn bounce(&self, law: &SystemLaw, start: f64) -> f64 {
        let system = self.system;
        let row = &system.rows[law.first];
        let before = system.speed(row, |body| body.start);
        let closes = start + before * system.dt <= 0.0;
        if law.restitution <= 0.0 || -before <= system.threshold || !closes || row.impulse <= 0.0 {
            return 0.0;
        }
        let pull = (self.free[law.first] - before).abs() * (1.0 + law.restitution);
        let wanted = -law.restitution * before;
        self.u[law.first].clamp(wanted - pull, wanted + pull)
    }

    /// The quantity of a one-sided row that must not be negative: its velocity if it touches or bears load,
    /// else its velocity relative to that at which the gap would have closed.
    fn target(&self, i: usize, law: &SystemLaw, start: f64) -> f64 {
        let (gap, speed) = (self.gap[i], self.u[law.first]);
        let bounce = self.bounce(law, start);
        if bounce != 0.0 {
            return speed - bounce;
        }
        let loaded = self.system.rows[law.first].impulse > 0.0;
        match law.potential {
            // Its mean velocity, at most as far as to the touch.
            true => gap / self.system.dt,
            false if loaded || gap <= 0.0 => speed,
            false => speed.max(0.0) + gap / self.system.dt,
        }
    }

    /// The error of a law, and the velocity that impulses had to stop [m/s].
    fn error(&self, i: usize, law: &SystemLaw) -> (f64, f64) {
        let (first, rows) = (law.first, &self.system.rows);
        let r = |k: usize| rows[first + k].impulse;
        let (s, u) = (self.scale[first], |k: usize| self.u[first + k]);
        if s <= 0.0 {
            return (0.0, 0.0);
        }
        // A point that nothing had to stop needs no impulse.
        let asked = |start: f64, load: f64| {
            let free = self.free[first] + start.max(0.0) / self.system.dt;
            if free > 0.0 && load == 0.0 { 0.0 } else { free }
        };
        match law.law {
            Law::Bounds { min, max } => {
                let start = law.gap;
                let u = start.map_or(u(0), |start| self.target(i, law, start));
                let error = s * (r(0) - (r(0) - u / s).clamp(min, max)).abs();
                let reach = if rows[first].angle { self.gyration(first) } else { 1.0 };
                let free = start.map_or(self.free[first], |start| asked(start, r(0)));
                (error * reach, free * reach)
            }
            Law::Contact { mu } => {
                let start = law.gap.unwrap_or(0.0);
                let slip = u(1).hypot(u(2));
                let own = [r(0), r(1), r(2)];
                let to = [
                    own[0] - (self.target(i, law, start) + mu * slip) / s,
                    own[1] - u(1) / s,
                    own[2] - u(2) / s,
                ];
                let to = project_cone(to, mu);
                let error = s * (own[0] - to[0]).hypot(own[1] - to[1]).hypot(own[2] - to[2]);
                let free = asked(start, own[0]);
                let free = if free == 0.0 {
                    0.0
                } else {
                    free.hypot(self.free[first + 1]).hypot(self.free[first + 2])
                };
                (error, free)
            }
            Law::Patch { mu, arm, first: normals, count } => {
                let normal: f64 = rows[normals..normals + count].iter().map(|row| row.impulse.max(0.0)).sum();
                let own = [r(0), r(1)];
                let to = project_disc([own[0] - u(0) / s, own[1] - u(1) / s], mu * normal);
                let twist = self.scale[first + 2];
                let most = mu * arm * normal;
                let turned = if twist > 0.0 { r(2) - (r(2) - u(2) / twist).clamp(-most, most) } else { 0.0 };
                let error = s * (own[0] - to[0]).hypot(own[1] - to[1]);
                let free = if normal > 0.0 { self.free[first].hypot(self.free[first + 1]) } else { 0.0 };
                // A twist is the velocity of the points about their middle; rows against rolling are
                // velocities as they are.
                let reach = if self.system.is_rolling(law) { 1.0 } else { arm };
                (error.hypot(twist * turned * reach), free)
            }
        }
    }

    /// Length that turns an angular velocity of a row into a velocity [m]: the radius of gyration of the
    /// lighter body about the row's direction, from the body's inverse mass and inertia.
    fn gyration(&self, row: usize) -> f64 {
        let one = &self.system.rows[row];
        let lightest = one
            .bodies
            .iter()
            .flatten()
            .map(|&b| self.system.bodies[b].inverse_mass.max_element())
            .fold(0.0, f64::max);
        if lightest > 0.0 { (lightest / self.scale[row]).sqrt() } else { 1.0 }
    }

    /// Cone and direction of friction.
    fn friction(&self, law: &SystemLaw, out: &mut Measures) {
        if self.system.is_rolling(law) {
            return;
        }
        let (first, rows) = (law.first, &self.system.rows);
        let (at, most) = match law.law {
            Law::Contact { mu } => (first + 1, mu * rows[first].impulse.max(0.0)),
            Law::Patch { mu, first: normals, count, .. } => {
                let normal: f64 = rows[normals..normals + count].iter().map(|row| row.impulse.max(0.0)).sum();
                (first, mu * normal)
            }
            Law::Bounds { .. } => return,
        };
        let (r, u) = ([rows[at].impulse, rows[at + 1].impulse], [self.u[at], self.u[at + 1]]);
        let (push, slip) = (r[0].hypot(r[1]), u[0].hypot(u[1]));
        // Impulses too small to change a velocity noticeably are not checked.
        if push * self.scale[at] > STICK {
            out.cone = out.cone.max(if most > 0.0 { push / most - 1.0 } else { 1.0 });
            if slip > STICK {
                out.slip_angle = out.slip_angle.max(1.0 + (r[0] * u[0] + r[1] * u[1]) / (push * slip));
            }
        }
    }
}
