//! One law after another by its own velocity: the inner loop of mass splitting and of temporal Gauss-Seidel.

use crate::problem::{Law, nearest_within, project_disc};
use crate::steppers::moving::Moving;
use crate::system::SystemLaw;

/// Laws with the mobilities of their rows.
pub(super) struct Relaxed {
    /// Whether it is the turn of a contact's friction: after all normals, as points that share a body would
    /// else slip aside by their order.
    laws: Vec<(SystemLaw, [f64; 2], bool)>,
}

impl Relaxed {
    /// Mobilities are those of the bodies of `moving`.
    pub(super) fn new(moving: &Moving<'_>, laws: impl Iterator<Item = SystemLaw>) -> Relaxed {
        let rows = &moving.system.rows;
        let of = |i: usize| moving.coupling(&rows[i], &rows[i]) + rows[i].compliance;
        let both = |i: usize| {
            // The greatest eigenvalue of the block of both tangents.
            let ([a, b], c) = ([of(i), of(i + 1)], moving.coupling(&rows[i], &rows[i + 1]));
            0.5 * (a + b) + (0.5 * (a - b)).hypot(c)
        };
        let scales = |law: SystemLaw| {
            let scales = match law.law {
                Law::Bounds { .. } => [of(law.first); 2],
                Law::Contact { .. } => [of(law.first), both(law.first + 1)],
                Law::Patch { .. } => [both(law.first), of(law.first + 2)],
            };
            (law, scales, false)
        };
        let mut laws: Vec<_> = laws.map(scales).collect();
        let contacts = laws.iter().filter(|(law, ..)| matches!(law.law, Law::Contact { .. }));
        let friction: Vec<_> = contacts.map(|&(law, scales, _)| (law, scales, true)).collect();
        laws.extend(friction);
        Relaxed { laws }
    }

    /// All laws in their order. `offsets` are added to the velocities of rows; `r` are the impulses so far,
    /// with which the bodies of `moving` move. Returns the greatest change of a row's velocity by its own
    /// impulse.
    pub(super) fn sweep(&self, moving: &mut Moving<'_>, offsets: &[f64], r: &mut [f64]) -> f64 {
        let mut most = 0.0_f64;
        for (law, scales, friction) in &self.laws {
            let step = scales.map(|scale| if scale > 0.0 { 1.0 / scale } else { 0.0 });
            let asked = |row: usize, step: f64, moving: &Moving<'_>, r: &[f64]| {
                let yields = moving.system.rows[row].compliance * r[row];
                r[row] - step * (moving.speed(row) + offsets[row] + yields)
            };
            let first = law.first;
            let mut give = |row: usize, scale: f64, to: f64, moving: &mut Moving<'_>, r: &mut [f64]| {
                moving.push(row, to - r[row]);
                most = most.max((to - r[row]).abs() * scale);
                r[row] = to;
            };
            match law.law {
                Law::Bounds { min, max } => {
                    let to = nearest_within(asked(first, step[0], moving, r), min, max);
                    give(first, scales[0], to, moving, r);
                }
                Law::Contact { mu } if *friction => {
                    let own = [1, 2].map(|k| asked(first + k, step[1], moving, r));
                    let own = project_disc(own, mu * r[first]);
                    (0..2).for_each(|k| give(first + 1 + k, scales[1], own[k], moving, r));
                }
                Law::Contact { .. } => {
                    let to = asked(first, step[0], moving, r).max(0.0);
                    give(first, scales[0], to, moving, r);
                }
                Law::Patch { mu, arm, first: normals, count } => {
                    let load = mu * r[normals..normals + count].iter().map(|r| r.max(0.0)).sum::<f64>();
                    let own = [0, 1].map(|k| asked(first + k, step[0], moving, r));
                    let own = project_disc(own, load);
                    (0..2).for_each(|k| give(first + k, scales[0], own[k], moving, r));
                    let twist = nearest_within(asked(first + 2, step[1], moving, r), -arm * load, arm * load);
                    give(first + 2, scales[1], twist, moving, r);
                }
            }
        }
        most
    }
}
