//! A system in the form that collections of contact problems have: points with Coulomb's cone, three rows
//! each, and nothing else.

use super::problem::{Stabilisation, problem};
use super::*;
use crate::problem::{Law, Matrix, Problem};
use backstop::Error;
use nalgebra::{DMatrix, DVector, SymmetricEigen};

/// How rows that are not contacts were treated.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Reduction {
    /// Eliminated: locks, springs without a bound on their force, and ends of ranges that bear load.
    pub eliminated: usize,
    /// Drives with a bounded force: they keep the impulse that the engine's solver gave them.
    pub held: usize,
    /// Ends of ranges that bear nothing: left out.
    pub open: usize,
    /// Points of contacts that resist rolling or spinning: without that, which Coulomb's law does not know.
    pub rolling: usize,
}

/// Eigenvalues below this share of the greatest one belong to redundant directions of joints.
const GONE: f64 = 1e-10;

/// See [`SystemProblems::contact_problem`].
pub(crate) fn contact_problem(system: &System) -> Result<(Problem, Reduction), Error> {
    let mut points = System {
        dt: system.dt,
        threshold: system.threshold,
        bodies: system.bodies.clone(),
        ..System::default()
    };
    for (i, law) in system.laws[..system.contacts].iter().enumerate() {
        if law.gap.is_some() {
            give_point(system, i, &mut points);
        }
    }
    points.contacts = points.laws.len();
    let rolling =
        system.laws[..system.contacts].iter().filter(|law| law.resists && law.gap.is_some()).count();
    let mut told = Reduction { rolling, ..Reduction::default() };
    for law in &system.laws[system.contacts..] {
        let row = &system.rows[law.first];
        let is_bounded = |min: f64, max: f64| min.is_finite() || max.is_finite();
        let bounded = law.drives && matches!(law.law, Law::Bounds { min, max } if is_bounded(min, max));
        if bounded {
            told.held += 1;
            push_velocities(&mut points, row, row.impulse);
        } else if law.law == Law::AT_LEAST_ZERO && row.impulse <= 0.0 {
            told.open += 1;
        } else {
            told.eliminated += 1;
            let gap = law.gap.map(|gap| gap.min(0.0));
            points.push(SystemLaw { law: Law::LOCKED, gap, ..*law }, &[*row]);
        }
    }
    Ok((without_joints(&points)?, told))
}

/// The contacts of an island with Coulomb's cone at each point, and for each point the rows of its normal
/// and of the first of its friction in this system. Joints are left out.
pub(crate) fn with_points(system: &System, island: &SystemIsland) -> (System, Vec<(usize, Option<usize>)>) {
    let mut points = System {
        dt: system.dt,
        threshold: system.threshold,
        bodies: system.bodies.clone(),
        ..System::default()
    };
    let mut of = Vec::new();
    for &i in island.laws.iter().filter(|&&i| i < system.contacts && system.laws[i].gap.is_some()) {
        let law = &system.laws[i];
        let friction = match law.law {
            Law::Contact { .. } => Some(law.first + 1),
            _ => patch_of(system, i).map(|(_, first)| first),
        };
        give_point(system, i, &mut points);
        of.push((law.first, friction));
    }
    points.contacts = points.laws.len();
    (points, of)
}

/// The coefficient and the first row of the patch that a normal belongs to, if it has one.
fn patch_of(system: &System, i: usize) -> Option<(f64, usize)> {
    let normal = system.laws[i].first;
    system.laws[i..system.contacts].iter().find_map(|patch| match patch.law {
        Law::Patch { mu, first, count, .. }
            if (first..first + count).contains(&normal) && !system.is_rolling(patch) =>
        {
            Some((mu, patch.first))
        }
        _ => None,
    })
}

/// Adds a point with its normal and tangents to `out`.
fn give_point(system: &System, i: usize, out: &mut System) {
    let law = &system.laws[i];
    let normal = system.rows[law.first];
    if let Law::Contact { .. } = law.law {
        out.push(*law, &system.rows[law.first..law.first + 3]);
        return;
    }
    let patch = patch_of(system, i);
    let n = normal.linear[1];
    let (mu, t, along) = match patch {
        Some((mu, first)) => {
            let row = &system.rows[first];
            let t = row.linear[1];
            // The arm along the normal, which all points share: (r x t) . (n x t) = r . n.
            let along = [0, 1].map(|side| {
                let moment = if side == 0 { -row.angular[0] } else { row.angular[1] };
                moment.dot(n.cross(t))
            });
            (mu, t, along)
        }
        None => (0.0, n.any_orthonormal_vector(), [0.0; 2]),
    };
    // r without its part along n is n x (r x n).
    let arm = [0, 1].map(|side| {
        let moment = if side == 0 { -normal.angular[0] } else { normal.angular[1] };
        n.cross(moment) + n * along[side]
    });
    let bias = patch.map_or([0.0; 2], |(_, first)| [system.rows[first].bias, system.rows[first + 1].bias]);
    let tangent = |t: DVec3| {
        let mut row = normal;
        row.linear = of_two([-t, t]);
        row.angular = of_two([-arm[0].cross(t), arm[1].cross(t)]);
        row.impulse = 0.0;
        row
    };
    let tangents = [tangent(t), tangent(n.cross(t))];
    let [t, s] = tangents;
    let rows = [normal, SystemRow { bias: bias[0], ..t }, SystemRow { bias: bias[1], ..s }];
    out.push(SystemLaw { law: Law::Contact { mu }, ..*law }, &rows);
}

/// Adds the effect of a known impulse to the free velocities.
fn push_velocities(system: &mut System, row: &SystemRow, impulse: f64) {
    for (side, body) in row.bodies.iter().enumerate() {
        if let Some(body) = *body {
            let body = &mut system.bodies[body];
            body.free[0] += body.inverse_mass * row.linear[side] * impulse;
            body.free[1] += body.inverse_inertia * row.angular[side] * impulse;
        }
    }
}

/// The problem of the rows before those of joints, with the latter eliminated.
fn without_joints(system: &System) -> Result<Problem, Error> {
    let whole = problem(system, Stabilisation::Rest)?;
    let kept = system.laws.get(system.contacts).map_or(system.rows.len(), |law| law.first);
    let laws = system.laws[..system.contacts].iter().map(|law| law.law).collect();
    if kept == system.rows.len() {
        return Problem::new(laws, whole.w().clone(), whole.q().to_vec());
    }
    let dense = whole.w().dense();
    let count = system.rows.len() - kept;
    let own = SymmetricEigen::new(dense.view((kept, kept), (count, count)).into_owned());
    let least = GONE * own.eigenvalues.amax();
    // The pseudo-inverse: for redundant directions, the least impulses.
    let inverse = own.eigenvalues.map(|x| if x > least { 1.0 / x } else { 0.0 });
    let across: DMatrix<f64> = dense.view((kept, 0), (count, kept)).into_owned();
    let seen = own.eigenvectors.transpose() * across;
    let q = DVector::from_column_slice(&whole.q()[kept..]);
    let asked = own.eigenvectors.transpose() * q;
    let scaled = DMatrix::from_diagonal(&inverse) * &seen;
    let w = dense.view((0, 0), (kept, kept)) - seen.transpose() * &scaled;
    let q = DVector::from_column_slice(&whole.q()[..kept]) - scaled.transpose() * asked;
    Problem::new(laws, Matrix::from_dense(&w), q.as_slice().to_vec())
}
