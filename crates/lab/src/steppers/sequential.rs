//! Impulses one after the other.
//!
//! First impacts, at the velocities of the start of the step: the two bodies with the fastest approach
//! bounce, by Newton's law at all points between them at once, until no bodies approach. Ties are broken by
//! the order of bodies, so that the order of contacts changes nothing. With low restitution the sequence may
//! have no end (McNamara and Young 1992): each pair is counted, loses half of its restitution each
//! [`Effort::calm`] impacts and all of it after four times as many, and when a pair has had [`MAX_IMPACTS`]
//! impacts, those that still approach are brought to rest together. [`Effort::order`] may be another, or
//! none: then all bounce together.
//!
//! Then bodies take gravity and forces, and sequential impulses without restitution go on until the greatest
//! change of a velocity by an impulse is below the tolerance, or the sweeps run out (Catto 2005): the fastest
//! approach first in each sweep.

use super::blocks::{Block, rows_of, solve_block};
use super::moving::Moving;
use super::step::{Resolution, Step};
use crate::methods::{Effort, Order, Solution, Status};
use crate::system::target;
use crate::system::{System, SystemLaw};

/// Impacts of a pair after which all that approach are brought to rest together.
const MAX_IMPACTS: u32 = 256;
/// Share of the fastest initial approach below which an approach counts as none.
const NOTHING: f64 = 1e-12;

/// Impacts one pair after the other, the fastest first and counted, at the velocities of the start; then
/// sequential impulses.
pub fn sequential(step: &Step<'_>, effort: &Effort) -> Resolution {
    let system = step.system;
    let mut impulses = vec![0.0; system.rows.len()];
    let mut moving = Moving::new(system, |body| body.start);
    let blocks = Block::all(system, step.island);
    let impacts = collide(&mut moving, &blocks, effort, &mut impulses);
    moving.pull();
    let held = impulses.clone();
    let sweeps = settle(step, &mut moving, &blocks, effort, &mut impulses, &held);
    resolution(step, &moving, &impulses, impacts + sweeps)
}

/// Whether a point takes part in impacts: it closes within the step.
pub(super) fn strikes(system: &System, law: &SystemLaw, speed: f64) -> bool {
    law.gap.is_some_and(|gap| gap.max(0.0) + speed * system.dt <= 0.0)
}

/// Lets pairs bounce, the fastest first, until none approaches; returns the number of impacts.
fn collide(moving: &mut Moving<'_>, blocks: &[Block], effort: &Effort, impulses: &mut [f64]) -> u32 {
    let (most, calm) = (effort.iterations, effort.calm.max(1));
    let contacts: Vec<&Block> = blocks.iter().filter(|block| block.contact).collect();
    let joints = joints_of(blocks);
    let fastest = contacts.iter().map(|block| approach(moving, block)).fold(0.0, f64::min);
    // If nothing bounces, contacts handle the rest.
    if !contacts.iter().any(|block| bounces(moving, block)) {
        return 0;
    }
    let mut counts = vec![0_u32; contacts.len()];
    for impact in 0..most {
        // Among equals, that of the first bodies.
        let speeds = contacts.iter().map(|block| approach(moving, block)).enumerate();
        let next = match effort.order {
            Order::Fastest => speeds.fold((0, 0.0), |best, one| if one.1 < best.1 { one } else { best }),
            Order::Given | Order::Together => {
                speeds.into_iter().find(|one| one.1 < fastest * NOTHING).unwrap_or((0, 0.0))
            }
        };
        let (i, speed) = next;
        if speed >= fastest * NOTHING {
            return impact;
        }
        counts[i] += 1;
        if counts[i] >= MAX_IMPACTS {
            let all: Vec<usize> = contacts.iter().flat_map(|block| block.laws.clone()).collect();
            bounce(moving, &all, &joints, 0.0, impulses);
            return impact + 1;
        }
        let share =
            if counts[i] >= calm.saturating_mul(4) { 0.0 } else { 0.5_f64.powi((counts[i] / calm) as i32) };
        if effort.order == Order::Together {
            let all: Vec<usize> = contacts.iter().flat_map(|block| block.laws.clone()).collect();
            bounce(moving, &all, &joints, share, impulses);
        } else {
            bounce(moving, &contacts[i].laws, &joints, share, impulses);
        }
    }
    most
}

/// Laws of joints, which hold while contacts bounce.
pub(super) fn joints_of(blocks: &[Block]) -> Vec<usize> {
    blocks.iter().filter(|block| !block.contact).flat_map(|block| block.laws.clone()).collect()
}

/// How fast points approach that take part in impacts.
pub(super) fn approach(moving: &Moving<'_>, block: &Block) -> f64 {
    block.approach(moving, |law| strikes(moving.system, law, moving.speed(law.first)))
}

/// Whether some point bounces rather than stops.
pub(super) fn bounces(moving: &Moving<'_>, block: &Block) -> bool {
    let system = moving.system;
    block.normals(system).any(|law| {
        let speed = moving.speed(law.first);
        law.restitution > 0.0 && -speed > system.threshold && strikes(system, law, speed)
    })
}

/// Points of some contacts bounce together, and joints hold meanwhile. `share`: of their restitution.
pub(super) fn bounce(
    moving: &mut Moving<'_>,
    contacts: &[usize],
    joints: &[usize],
    share: f64,
    impulses: &mut [f64],
) {
    let system = moving.system;
    let mut laws: Vec<usize> = contacts.iter().chain(joints).copied().collect();
    laws.sort_unstable();
    let offset = |i: usize| {
        let law = &system.laws[i];
        let speed = moving.speed(law.first);
        let gap = law.gap.unwrap_or(0.0).max(0.0);
        match law.gap {
            Some(_) if strikes(system, law, speed) && -speed > system.threshold => {
                share * law.restitution * speed
            }
            // The point is further away than it may move in this step.
            Some(_) if gap > 0.0 => gap / system.dt,
            _ => 0.0,
        }
    };
    let offsets: Vec<f64> = laws.iter().map(|&i| offset(i)).collect();
    give(moving, &laws, |_| 0.0, &offsets, impulses);
}

/// Solves some laws together and applies the impulses; returns the greatest change of a row's velocity by its
/// own impulse [m/s]. `held` and `offsets`: as for [`solve_block`].
pub(super) fn give(
    moving: &mut Moving<'_>,
    laws: &[usize],
    held: impl Fn(usize) -> f64,
    offsets: &[f64],
    impulses: &mut [f64],
) -> f64 {
    let system = moving.system;
    let Some(r) = solve_block(moving, laws, &held, offsets) else { return 0.0 };
    let mut most = 0.0_f64;
    for (row, r) in rows_of(system, laws).into_iter().zip(r) {
        let change = r - held(row);
        moving.push(row, change);
        impulses[row] += change;
        most = most.max(change.abs() * system.mobility(&system.rows[row]));
    }
    most
}

/// Sequential impulses without restitution; returns the number of sweeps. `before`: impulses that are not to
/// be taken back.
pub(super) fn settle(
    step: &Step<'_>,
    moving: &mut Moving<'_>,
    blocks: &[Block],
    effort: &Effort,
    impulses: &mut [f64],
    before: &[f64],
) -> u32 {
    let system = step.system;
    let offsets = offsets(step);
    let size = moving.velocity.iter().flatten().map(|v| v.length()).fold(system.dt, f64::max);
    for sweep in 1..=effort.iterations {
        let mut order: Vec<(f64, usize)> = blocks
            .iter()
            .enumerate()
            .map(|(i, block)| {
                let reach =
                    |law: &SystemLaw| law.gap.unwrap_or(0.0).max(0.0) + moving.speed(law.first) * system.dt;
                (block.approach(moving, |law| reach(law) < 0.0), i)
            })
            .collect();
        if effort.order != Order::Fastest {
            order.iter_mut().for_each(|one| one.0 = 0.0);
        }
        order.sort_by(|a, b| a.0.total_cmp(&b.0).then(a.1.cmp(&b.1)));
        let mut most = 0.0_f64;
        for (_, i) in order {
            let laws = &blocks[i].laws;
            let own: Vec<f64> = laws.iter().map(|&law| offsets[law]).collect();
            let held: Vec<f64> = impulses.iter().zip(before).map(|(all, before)| all - before).collect();
            let change = give(moving, laws, |row| held[row], &own, impulses);
            most = most.max(change);
        }
        if most <= effort.tolerance * size || !moving.is_finite() {
            return sweep;
        }
    }
    effort.iterations
}

/// The offset of each law's first row beside its free velocity, without restitution, by laws of the system.
pub(super) fn offsets(step: &Step<'_>) -> Vec<f64> {
    step.system.laws.iter().map(|law| target(step.system, law, step.stabilisation)).collect()
}

/// The solution of a method, by the rows of the problem.
pub(super) fn resolution(
    step: &Step<'_>,
    moving: &Moving<'_>,
    impulses: &[f64],
    iterations: u32,
) -> Resolution {
    let r: Vec<f64> = rows_of(step.system, &step.island.laws).iter().map(|&row| impulses[row]).collect();
    let residual = step.problem.residual(&r).relative.min(f64::MAX);
    let status = if moving.is_finite() { Status::Solved } else { Status::Limit };
    let solution = Solution { status, r, iterations, pivots: 0, residual };
    Resolution { solution, end: moving.of(&step.island.bodies), moving: None }
}
