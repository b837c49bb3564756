//! A system with fewer contact points.

use super::*;
use crate::problem::Law;
use crate::reduction::{Keep, Point, reduce};
use backstop::BodyHandle;
use std::collections::BTreeMap;

/// The same system with some of the points of each two bodies, and for each of its rows what `of` has for
/// that row. Friction of a patch stays as long as one of its points does.
pub(crate) fn reduced(system: &System, of: &[Option<usize>], keep: Keep) -> (System, Vec<Option<usize>>) {
    let stays = stays(system, keep);
    let mut out = System {
        dt: system.dt,
        threshold: system.threshold,
        bodies: system.bodies.clone(),
        ..System::default()
    };
    let mut own = Vec::with_capacity(of.len());
    // New index of each row, by which patches find their normals, and of each law.
    let (mut rows, mut laws) = (vec![None; system.rows.len()], vec![None; system.laws.len()]);
    for (i, law) in system.laws.iter().enumerate() {
        let kind = match law.law {
            Law::Patch { mu, arm, first, count } => {
                let mut left = (first..first + count).filter_map(|row| rows[row]);
                let Some(first) = left.next() else { continue };
                Law::Patch { mu, arm, first, count: 1 + left.count() }
            }
            other => other,
        };
        if !stays[i] {
            continue;
        }
        let of_law = law.first..law.first + law.law.rows();
        for row in of_law.clone() {
            rows[row] = Some(out.rows.len() + row - law.first);
        }
        laws[i] = Some(out.laws.len());
        own.extend_from_slice(&of[of_law.clone()]);
        out.push(SystemLaw { law: kind, ..*law }, &system.rows[of_law]);
    }
    let left = |island: &SystemIsland| SystemIsland {
        bodies: island.bodies.clone(),
        laws: island.laws.iter().filter_map(|&i| laws[i]).collect(),
    };
    out.islands = system.islands.iter().map(left).collect();
    out.contacts = laws[..system.contacts].iter().flatten().count();
    (out, own)
}

/// Which laws are not those of points that are left out.
fn stays(system: &System, keep: Keep) -> Vec<bool> {
    let mut stays = vec![true; system.laws.len()];
    let mut pairs: BTreeMap<[u64; 2], Vec<(usize, Point)>> = BTreeMap::new();
    for (i, law) in system.laws[..system.contacts].iter().enumerate() {
        let (Owner::Contact(bodies), Some(gap)) = (law.owner, law.gap) else { continue };
        let mut bodies = bodies.map(BodyHandle::to_bits);
        // The points of a pair are seen from the same body.
        let side = usize::from(bodies[0] < bodies[1]);
        bodies.sort_unstable();
        let row = &system.rows[law.first];
        let normal = row.linear[side];
        // Where it is along the normal does not matter, and the row does not have it.
        let position = normal.cross(row.angular[side]);
        pairs.entry(bodies).or_default().push((i, Point { position, normal, depth: -gap }));
    }
    for points in pairs.values() {
        let all: Vec<Point> = points.iter().map(|one| one.1).collect();
        points.iter().for_each(|&(i, _)| stays[i] = false);
        reduce(&all, keep).into_iter().for_each(|k| stays[points[k].0] = true);
    }
    stays
}
