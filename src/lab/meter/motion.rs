//! Energy and momentum of a step.

use super::Measures;
use crate::lab::system::{System, Velocity};
use crate::world::World;
use glam::DVec3;

/// Kinetic and potential energy of each dynamic body that is awake [J].
pub(super) fn energies(world: &World) -> Vec<f64> {
    let bodies = &world.bodies;
    let gravity = world.settings.gravity.as_dvec3();
    let of = |i: usize| {
        let (mass, pose, v) = (f64::from(bodies.cold[i].mass), &bodies.pose[i], &bodies.velocity[i]);
        let spin = pose.rotation.as_dquat().normalize().conjugate() * v.angular.as_dvec3();
        let turning = spin.dot(bodies.mass[i].inertia.as_dvec3() * spin);
        let pull = gravity * f64::from(bodies.traits[i].gravity_scale);
        0.5 * (mass * v.linear.as_dvec3().length_squared() + turning) - mass * pull.dot(pose.position)
    };
    (0..bodies.dynamic()).map(of).collect()
}

/// Of some bodies and the laws between them.
pub(super) fn measure(
    system: &System,
    laws: &[usize],
    bodies: &[usize],
    (before, after): (&[f64], &[f64]),
    forces: &[Velocity],
    out: &mut Measures,
) {
    let sum = |of: &[f64]| bodies.iter().filter_map(|&i| of.get(i)).sum();
    (out.energy_before, out.energy_after) = (sum(before), sum(after));
    let mean = |[v, w]: Velocity, [x, y]: Velocity| [(v + x) * 0.5, (w + y) * 0.5];
    for &i in laws {
        let law = &system.laws[i];
        for row in &system.rows[law.first..law.first + law.law.rows()] {
            let moved = if law.drives || law.yields {
                system.speed(row, |body| mean(body.start, body.end))
            } else {
                // What is driven by the caller, and not what it drives.
                let driven =
                    system.speed(row, |body| if body.dynamic { [DVec3::ZERO; 2] } else { body.end });
                -driven - row.bias
            };
            out.work += row.impulse * moved;
        }
    }
    let changes = system.velocity_changes(&system.impulses());
    let centre = centre_of(system, bodies);
    let (mut momentum, mut spin) = (DVec3::ZERO, DVec3::ZERO);
    for &i in bodies {
        let body = &system.bodies[i];
        if !body.dynamic {
            continue;
        }
        if let Some(&[force, torque]) = forces.get(i) {
            let [v, w] = mean(body.start, body.end);
            out.work += (force.dot(v) + torque.dot(w)) * system.dt;
        }
        let [v, w] = [0, 1].map(|k| body.end[k] - body.free[k] - changes[i][k] - body.given[k]);
        let reach = (inverse(body.inverse_inertia.determinant().cbrt())
            * body.inverse_mass.max_element())
        .sqrt();
        out.unexplained = out.unexplained.max(v.length()).max(w.length() * reach);
        let p = DVec3::from_array(v.to_array().map(|x| x * inverse(body.inverse_mass.max_element())));
        momentum += p;
        if body.inverse_inertia.determinant() > 0.0 {
            spin += body.inverse_inertia.inverse() * w;
        }
        spin += (body.centre - centre).cross(p);
    }
    (out.momentum, out.angular_momentum) = (momentum.length(), spin.length());
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
