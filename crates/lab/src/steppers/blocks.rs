//! Laws of an island in blocks: all contacts of two bodies, and each joint; and how a single block is solved.

use super::moving::Moving;
use crate::methods::{Effort, gs_cone};
use crate::problem::{Law, Matrix, Problem};
use crate::system::{Owner, System, SystemIsland, SystemLaw};
use std::collections::BTreeMap;

/// Laws that are solved together. A box that falls flat on four points turns if these are solved one after
/// the other.
#[derive(Clone, Debug)]
pub(super) struct Block {
    /// Indices of laws in the system, in ascending order.
    pub(super) laws: Vec<usize>,
    /// Indices of its bodies, of a coupling of the first two.
    pub(super) bodies: [Option<usize>; 2],
    pub(super) contact: bool,
}

impl Block {
    /// The blocks of an island by their bodies, so that the order of contacts doesn't matter; joints come
    /// after them.
    pub(super) fn all(system: &System, island: &SystemIsland) -> Vec<Block> {
        let mut blocks: BTreeMap<(usize, [Option<usize>; 2]), Block> = BTreeMap::new();
        let mut joints = Vec::new();
        for &i in &island.laws {
            let law = &system.laws[i];
            let [a, b, ..] = system.rows[law.first].bodies;
            let bodies = [a, b];
            let key = match law.owner {
                Owner::Contact(_) => (0, bodies),
                owner @ (Owner::Joint(_) | Owner::Coupling(_)) => {
                    let known = joints.iter().position(|own| *own == owner);
                    let place = known.unwrap_or_else(|| {
                        joints.push(owner);
                        joints.len() - 1
                    });
                    (1 + place, bodies)
                }
            };
            let contact = key.0 == 0;
            blocks.entry(key).or_insert_with(|| Block { laws: Vec::new(), bodies, contact }).laws.push(i);
        }
        let mut blocks: Vec<Block> = blocks.into_values().collect();
        blocks.iter_mut().for_each(|block| block.laws.sort_unstable());
        blocks
    }

    /// Its normals: those of laws that have a gap.
    pub(super) fn normals<'a>(&'a self, system: &'a System) -> impl Iterator<Item = &'a SystemLaw> + 'a {
        self.laws.iter().map(|&i| &system.laws[i]).filter(|law| law.gap.is_some())
    }

    /// The least velocity among its points that `counts` selects: negative for the fastest approach, zero if
    /// none approaches.
    pub(super) fn approach(&self, moving: &Moving<'_>, counts: impl Fn(&SystemLaw) -> bool) -> f64 {
        let normals = self.normals(moving.system).filter(|law| counts(law));
        normals.map(|law| moving.speed(law.first)).fold(0.0, f64::min)
    }
}

pub(super) fn rows_of(system: &System, laws: &[usize]) -> Vec<usize> {
    let own = laws.iter().map(|&i| &system.laws[i]);
    own.flat_map(|law| law.first..law.first + law.law.rows()).collect()
}

/// Impulses with which some laws, in ascending order, hold at the present velocities of the bodies. `held`:
/// the impulse that a row already has, which may be taken back. `offsets`: added to the velocity of each
/// law's first row.
pub(super) fn solve_block(
    moving: &Moving<'_>,
    laws: &[usize],
    held: impl Fn(usize) -> f64,
    offsets: &[f64],
) -> Option<Vec<f64>> {
    let system = moving.system;
    let rows = rows_of(system, laws);
    let mut entries = Vec::with_capacity(rows.len() * rows.len());
    for (i, &a) in rows.iter().enumerate() {
        for (j, &b) in rows.iter().enumerate() {
            let own = if i == j { system.rows[a].compliance } else { 0.0 };
            entries.push((i, j, moving.coupling(&system.rows[a], &system.rows[b]) + own));
        }
    }
    let w = Matrix::from_entries(rows.len(), entries);
    let start: Vec<f64> = rows.iter().map(|&row| held(row)).collect();
    // Velocities include the effect of earlier impulses on bodies, but not on the yielding of springs.
    let without = |(i, &row): (usize, &usize)| {
        moving.speed(row) - w.dot(i, &start) + system.rows[row].compliance * start[i]
    };
    let mut q: Vec<f64> = rows.iter().enumerate().map(without).collect();
    let mut own = Vec::with_capacity(laws.len());
    let mut first = 0;
    for (&i, offset) in laws.iter().zip(offsets) {
        let law = &system.laws[i];
        q[first] += offset;
        own.push(match law.law {
            Law::Patch { mu, arm, first, count } => {
                let first = rows.binary_search(&first).ok()?;
                Law::Patch { mu, arm, first, count }
            }
            other => other,
        });
        first += law.law.rows();
    }
    let problem = Problem::new(own, w, q).ok()?;
    let effort = Effort { tolerance: 1e-13, iterations: 500, start: Some(start), ..Effort::default() };
    Some(gs_cone(&problem, &effort).r)
}
