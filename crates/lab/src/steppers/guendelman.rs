//! Impacts, contacts and shock propagation, after Guendelman, Bridson and Fedkiw, *Nonconvex rigid bodies
//! with stacking* (2003).
//!
//! Impacts are swept a few times with their restitution, at the velocities of the start of the step. Bodies
//! take gravity and forces. Contacts are swept with a restitution that rises from -0.9 to 0, so that approach
//! is slowed down bit by bit and loads spread before anything stops. Remaining approach is resolved from the
//! ground up, level by level of the graph of which body stands on which; bodies below the level being solved
//! count as infinitely heavy. Lower bodies get no impulse, so momentum is not conserved: the price for stacks
//! that stand after a sweep or two.

use super::blocks::Block;
use super::moving::Moving;
use super::sequential::{approach, bounce, bounces, give, joints_of, offsets, resolution};
use super::step::{Resolution, Step};
use crate::methods::Effort;
use crate::system::System;
use glam::DVec3;

/// Sweeps over impacts.
const IMPACTS: u32 = 5;
/// Sweeps over contacts, each of which leaves a tenth less of the approach.
const CONTACTS: u32 = 10;
/// Sweeps over a level.
const LEVEL: u32 = 10;

/// Impacts, contacts with rising restitution, and shock propagation from the ground up, which does not keep
/// momentum.
pub fn guendelman(step: &Step<'_>, effort: &Effort) -> Resolution {
    let system = step.system;
    let mut impulses = vec![0.0; system.rows.len()];
    let mut moving = Moving::new(system, |body| body.start);
    let blocks = Block::all(system, step.island);
    let joints = joints_of(&blocks);
    for _ in 0..IMPACTS {
        for i in by_approach(&moving, &blocks) {
            if bounces(&moving, &blocks[i]) {
                bounce(&mut moving, &blocks[i].laws, &joints, 1.0, &mut impulses);
            }
        }
    }
    moving.pull();
    let offsets = offsets(step);
    for sweep in 1..=CONTACTS {
        let left = f64::from(CONTACTS - sweep) / f64::from(CONTACTS);
        for i in by_approach(&moving, &blocks) {
            slow(&mut moving, &blocks[i].laws, left, &offsets, &mut impulses);
        }
    }
    let levels = levels(system, step, &blocks);
    let deepest = levels.iter().copied().filter(|level| *level < usize::MAX).max().unwrap_or(0);
    let of = |block: &Block| block.bodies.iter().flatten().map(|&body| levels[body]).max().unwrap_or(0);
    for level in 1..=deepest {
        let own: Vec<&Block> = blocks.iter().filter(|block| of(block) == level).collect();
        for _ in 0..LEVEL.min(effort.iterations) {
            for block in &own {
                slow(&mut moving, &block.laws, 0.0, &offsets, &mut impulses);
            }
        }
        for (frozen, own) in moving.frozen.iter_mut().zip(&levels) {
            *frozen |= *own <= level;
        }
    }
    resolution(step, &moving, &impulses, IMPACTS + CONTACTS + deepest as u32)
}

/// Blocks by approach, the fastest first; ties are broken by their bodies.
fn by_approach(moving: &Moving<'_>, blocks: &[Block]) -> Vec<usize> {
    let mut order: Vec<(f64, usize)> =
        blocks.iter().enumerate().map(|(i, block)| (approach(moving, block), i)).collect();
    order.sort_by(|a, b| a.0.total_cmp(&b.0).then(a.1.cmp(&b.1)));
    order.into_iter().map(|(_, i)| i).collect()
}

/// Removes the approach of some laws up to the share `left`.
fn slow(moving: &mut Moving<'_>, laws: &[usize], left: f64, offsets: &[f64], impulses: &mut [f64]) {
    let system = moving.system;
    let offset = |i: usize| {
        let law = &system.laws[i];
        let lacks = (moving.speed(law.first) + offsets[i]).min(0.0);
        // Joints keep no share of their error.
        offsets[i] - if law.gap.is_some() { left * lacks } else { 0.0 }
    };
    let offsets: Vec<f64> = laws.iter().map(|&i| offset(i)).collect();
    give(moving, laws, |_| 0.0, &offsets, impulses);
}

/// Level of each body: the number of bodies between it and an immovable one, along contacts and joints; the
/// maximum for bodies without support. The higher of two touching bodies is the one that gravity presses
/// onto the other.
fn levels(system: &System, step: &Step<'_>, blocks: &[Block]) -> Vec<usize> {
    let mut levels: Vec<usize> =
        system.bodies.iter().map(|body| if body.dynamic { usize::MAX } else { 0 }).collect();
    let fall: DVec3 =
        step.island.bodies.iter().map(|&i| system.bodies[i].free[0] - system.bodies[i].start[0]).sum();
    let presses = |upper: usize, lower: Option<usize>| {
        let Some(lower) = lower.filter(|&lower| system.bodies[lower].dynamic) else { return true };
        (system.bodies[upper].centre - system.bodies[lower].centre).dot(fall) <= 0.0
    };
    // Each round completes at least one level.
    for _ in 0..=step.island.bodies.len() {
        let mut changed = false;
        for block in blocks {
            for (upper, lower) in [(0, 1), (1, 0)] {
                let Some(upper) = block.bodies[upper].filter(|&body| system.bodies[body].dynamic) else {
                    continue;
                };
                let lower = block.bodies[lower];
                let under = lower.map_or(0, |lower| levels[lower]);
                if under < usize::MAX && presses(upper, lower) && levels[upper] > under + 1 {
                    levels[upper] = under + 1;
                    changed = true;
                }
            }
        }
        if !changed {
            break;
        }
    }
    levels
}
