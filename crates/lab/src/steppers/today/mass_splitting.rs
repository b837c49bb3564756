//! Mass splitting (Tonge, Benevolenski and Voroshilov, *Mass splitting for jitter-free parallel rigid body
//! simulation*, 2012).
//!
//! A body that has a part in `n` blocks, each of them all contacts with another body or a joint, is split
//! into `n` bodies with an `n`th of its mass. Each block is solved alone with its own parts of bodies; then
//! the parts of a body are joined again at the mean of their velocities, which equals its velocity with the
//! whole mass under all impulses. So blocks may be solved in any order, or all at once, with the same result:
//! the method is a block Jacobi method whose steps are as long as the number of neighbours allows. Its fixed
//! point is the solution for any symmetric, positive semidefinite W.

use super::relax::Relaxed;
use crate::methods::{Effort, Solution, Status};
use crate::steppers::blocks::{Block, rows_of};
use crate::steppers::moving::Moving;
use crate::steppers::step::{Resolution, Step};
use crate::system::System;

/// Sweeps over a block before its bodies are joined: a box on four points needs about as many for these to
/// share the load.
const INNER: u32 = 4;

/// Blocks of contacts solved at once, each with its share of the mass of its bodies.
pub fn mass_splitting(step: &Step<'_>, effort: &Effort) -> Resolution {
    let system = step.system;
    let rows = rows_of(system, &step.island.laws);
    let mut impulses = vec![0.0; system.rows.len()];
    let mut moving = Moving::new(system, |body| body.free);
    let mut offsets = impulses.clone();
    for (&row, q) in rows.iter().zip(step.problem.q()) {
        offsets[row] = q - moving.speed(row);
    }
    for (&row, &r) in rows.iter().zip(effort.start.iter().flatten()) {
        impulses[row] = r;
        moving.push(row, r);
    }
    let blocks = Block::all(system, step.island);
    let split = split(system, &blocks);
    let mut part = Moving::new(&split, |body| body.free);
    let relaxed = |block: &Block| Relaxed::new(&part, block.laws.iter().map(|&i| system.laws[i]));
    let relaxed: Vec<Relaxed> = blocks.iter().map(relaxed).collect();
    let size = moving.velocity.iter().flatten().map(|v| v.length()).fold(system.dt, f64::max);
    let (mut status, mut sweeps) = (Status::Limit, 0);
    while sweeps < effort.iterations && status == Status::Limit && moving.is_finite() {
        let (before, mut most) = (impulses.clone(), 0.0_f64);
        for (block, relaxed) in blocks.iter().zip(&relaxed) {
            for body in block_bodies(system, block) {
                part.velocity[body] = moving.velocity[body];
            }
            for _ in 0..INNER {
                most = most.max(relaxed.sweep(&mut part, &offsets, &mut impulses));
            }
        }
        for &row in &rows {
            moving.push(row, impulses[row] - before[row]);
        }
        sweeps += 1;
        if most <= effort.tolerance * size {
            status = Status::Solved;
        }
    }
    let r: Vec<f64> = rows.iter().map(|&row| impulses[row]).collect();
    let residual = step.problem.residual(&r).relative.min(f64::MAX);
    let solution = Solution { status, r, iterations: sweeps, pivots: 0, residual };
    Resolution { solution, end: moving.of(&step.island.bodies), moving: None }
}

/// The system with bodies as light as their parts.
fn split(system: &System, blocks: &[Block]) -> System {
    let mut split = system.clone();
    let mut parts = vec![0.0_f64; system.bodies.len()];
    for block in blocks {
        block_bodies(system, block).into_iter().for_each(|body| parts[body] += 1.0);
    }
    for (body, parts) in split.bodies.iter_mut().zip(parts) {
        body.inverse_mass *= parts.max(1.0);
        body.inverse_inertia *= parts.max(1.0);
    }
    split
}

/// The bodies of a block, each once: up to four of a coupling.
fn block_bodies(system: &System, block: &Block) -> Vec<usize> {
    let of_law = |&i: &usize| system.rows[system.laws[i].first].bodies;
    let mut bodies: Vec<usize> = block.laws.iter().flat_map(of_law).flatten().collect();
    bodies.sort_unstable();
    bodies.dedup();
    bodies
}
