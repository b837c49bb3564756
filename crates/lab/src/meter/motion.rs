//! Energy and momentum of a step.

use super::Measures;
use crate::system::{System, SystemBody, SystemRow, Velocity};
use glam::DVec3;

/// The balance of a step's energy and momentum.
pub(super) struct Balance<'a> {
    system: &'a System,
    /// Energy of each body before and after the step [J].
    energies: [&'a [f64]; 2],
    /// Work of the caller's forces on each body, and of each driving law [J].
    forces: Vec<f64>,
    drives: Vec<f64>,
    /// Changes of velocity that nothing explains.
    rest: Vec<Velocity>,
}

fn mean([v, w]: Velocity, [x, y]: Velocity) -> Velocity {
    [(v + x) * 0.5, (w + y) * 0.5]
}

impl<'a> Balance<'a> {
    pub(super) fn new(system: &'a System, energies: [&'a [f64]; 2]) -> Balance<'a> {
        let bodies = system.bodies.iter().enumerate();
        let work = |(_, body): (usize, &SystemBody)| {
            let [force, torque] = body.force;
            let [v, w] = mean(body.start, body.end);
            (force.dot(v) + torque.dot(w)) * system.dt
        };
        let forces = bodies.clone().map(work).collect();
        let changes = system.velocity_changes(&system.impulses());
        let unexplained = |(body, by_rows): (&SystemBody, Velocity)| {
            [0, 1].map(|k| body.end[k] - body.free[k] - by_rows[k] - body.turned[k] - body.given[k])
        };
        let rest = system.bodies.iter().zip(changes).map(unexplained).collect();
        let drives = system.laws.iter().map(|law| {
            let rows = &system.rows[law.first..law.first + law.law.rows()];
            rows.iter().map(|row| row.impulse * driven(system, law.drives || law.yields, row)).sum()
        });
        Balance { system, energies, forces, drives: drives.collect(), rest }
    }

    /// Writes the measures of some bodies and the laws between them.
    pub(super) fn measure(&self, laws: &[usize], bodies: &[usize], out: &mut Measures) {
        let sum = |of: &[f64], which: &[usize]| which.iter().filter_map(|&i| of.get(i)).sum::<f64>();
        let [before, after] = self.energies.map(|of| sum(of, bodies));
        (out.energy_before, out.energy_after) = (before, after);
        out.work = sum(&self.drives, laws) + sum(&self.forces, bodies);
        let centre = centre_of(self.system, bodies);
        let (mut momentum, mut spin) = (DVec3::ZERO, DVec3::ZERO);
        for &i in bodies {
            let (body, [v, w]) = (&self.system.bodies[i], self.rest[i]);
            if !body.dynamic {
                continue;
            }
            // Radius of gyration: rotation counts by the velocity of a body's points.
            let turning = body.inverse_inertia.determinant();
            let inverse_mass = body.inverse_mass.max_element();
            let reach = (inverse(turning.cbrt()) * inverse_mass).sqrt();
            if body.unconserved {
                out.unconserved = out.unconserved.max(v.length()).max(w.length() * reach);
                continue;
            }
            out.unexplained = out.unexplained.max(v.length());
            let p = v * inverse(inverse_mass);
            momentum += p;
            spin += (body.centre - centre).cross(p);
            if body.stiffened {
                out.unconserved = out.unconserved.max(w.length() * reach);
                continue;
            }
            out.unexplained_turn = out.unexplained_turn.max(w.length() * reach);
            if turning > 0.0 {
                spin += body.inverse_inertia.inverse() * w;
            }
        }
        (out.momentum, out.angular_momentum) = (momentum.length(), spin.length());
    }
}

/// The speed at which a row does work: that of the row if it is a motor, else that of bodies that the caller
/// moves, against the impulse.
fn driven(system: &System, drives: bool, row: &SystemRow) -> f64 {
    if drives {
        return system.speed(row, |body| mean(body.start, body.end));
    }
    -system.speed(row, |body| if body.dynamic { Velocity::default() } else { body.end }) - row.bias
}

fn inverse(x: f64) -> f64 {
    if x > 0.0 { 1.0 / x } else { 0.0 }
}

/// The centre of mass of some bodies.
fn centre_of(system: &System, bodies: &[usize]) -> DVec3 {
    let (mut sum, mut mass) = (DVec3::ZERO, 0.0);
    for &i in bodies {
        let own = inverse(system.bodies[i].inverse_mass.max_element());
        sum += system.bodies[i].centre * own;
        mass += own;
    }
    if mass > 0.0 { sum / mass } else { sum }
}
