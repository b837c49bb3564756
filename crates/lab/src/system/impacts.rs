//! A system for methods that solve a step as one: potential points have friction.

use super::*;
use crate::problem::Law;

/// The same system with Coulomb's cone at each point that does not touch yet, and for each of its rows
/// the row in this system, if there is one.
///
/// The fast path solves these points without friction and applies the friction of those that touched
/// afterwards. A method that solves a step as one has no afterwards: points that it stops at the end of
/// the step touch, and impacts without friction would slide as on ice.
pub(crate) fn with_impacts(system: &System) -> (System, Vec<Option<usize>>) {
    let mut out = System {
        dt: system.dt,
        threshold: system.threshold,
        bodies: system.bodies.clone(),
        rows: Vec::with_capacity(system.rows.len()),
        laws: Vec::with_capacity(system.laws.len()),
        islands: system.islands.clone(),
        contacts: system.contacts,
    };
    let mut of = Vec::with_capacity(system.rows.len());
    // New index of each row, by which patches find their normals.
    let mut place = vec![0; system.rows.len()];
    for law in &system.laws {
        let own = law.first..law.first + law.law.rows();
        for row in own.clone() {
            place[row] = out.rows.len() + row - law.first;
        }
        let rows = &system.rows[own.clone()];
        of.extend(own.map(Some));
        match (law.law, law.impact) {
            (Law::Bounds { .. }, Some((mu, arms))) => {
                let [t, s] = tangents(&rows[0], arms);
                out.push(SystemLaw { law: Law::Contact { mu }, ..*law }, &[rows[0], t, s]);
                of.extend([None, None]);
            }
            (Law::Patch { mu, arm, first, count }, _) => {
                let law = SystemLaw { law: Law::Patch { mu, arm, first: place[first], count }, ..*law };
                out.push(law, rows);
            }
            _ => out.push(*law, rows),
        }
    }
    (out, of)
}

/// Both tangents of a point.
fn tangents(normal: &SystemRow, arms: [DVec3; 2]) -> [SystemRow; 2] {
    let n = normal.linear[1];
    let t = n.any_orthonormal_vector();
    [t, n.cross(t)].map(|t| SystemRow {
        linear: of_two([-t, t]),
        angular: of_two([-arms[0].cross(t), arms[1].cross(t)]),
        impulse: 0.0,
        ..*normal
    })
}
