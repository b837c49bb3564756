//! Benchmarks of box tests.

use super::Kernel;
use crate::broad_phase::kernels::{Node, Path, Tree};
use crate::broad_phase::{Aabb, Mover};
use crate::config::ContinuousMode;
use crate::lanes::{Lanes, Mask, Vec3, f32x4, f32x8};
use glam::vec3;
use std::cell::Cell;
use std::hint::black_box;

/// Boxes of a metre at the crossings of a loose grid that is one box high.
fn boxes(count: u32) -> Vec<Aabb> {
    let side = f64::from(count).sqrt() as u32;
    (0..count)
        .map(|i| {
            let at = vec3((i % side) as f32, 0.3 * (i % 5) as f32, (i / side) as f32) * 1.5;
            Aabb { min: at - 0.5, max: at + 0.5 }
        })
        .collect()
}

/// The path of a small body over half of a grid of `side` boxes, a little oblique, so that no axis decides
/// alone.
fn path(side: f32) -> Path {
    let (at, half) = (vec3(0.2 * side, 0.5, 0.3 * side), glam::Vec3::splat(0.05));
    Path::new(
        &Mover {
            collider: 0,
            aabb: Aabb { min: at - half, max: at + half },
            motion: vec3(0.7, 0.01, 0.4) * side,
            spin: 0.0,
            mode: ContinuousMode::Segment,
        },
        0.01,
    )
}

/// The segment test over an array in L1 at each width, and tree traversals; an element is a tested box.
pub fn kernels() -> Vec<Kernel> {
    vec![
        array::<f32>("segment test, 1 lane"),
        array::<f32x4>("segment test, 4 lanes"),
        array::<f32x8>("segment test, 8 lanes"),
        segment_walk("segment walk, 256 leaves", 256),
        segment_walk("segment walk, 16384 leaves", 16_384),
        box_walk("box walk, 256 leaves", 256),
        box_walk("box walk, 16384 leaves", 16_384),
    ]
}

/// 256 boxes, 6 kB.
fn array<L: Lanes + 'static>(name: &str) -> Kernel {
    let all = boxes(256);
    let lanes: Vec<(Vec3<L>, Vec3<L>)> = all
        .chunks(L::N)
        .map(|some| (Vec3::from_fn(|i| some[i].min), Vec3::from_fn(|i| some[i].max)))
        .collect();
    let path = path(16.0);
    Kernel::new(name, all.len(), move || {
        let path = black_box(&path).lanes::<L>();
        black_box(lanes.iter().fold(0u32, |sum, (min, max)| sum.wrapping_add(path.hits(*min, *max).bits())));
    })
}

fn tree(boxes: &[Aabb]) -> Tree {
    let mut tree = Tree::default();
    let all: Vec<u32> = (0..boxes.len() as u32).collect();
    tree.add(&all, |i| boxes[i as usize], |_, _| {});
    tree
}

/// Each visited node is a test of four boxes, including empty lanes.
fn segment_walk(name: &str, leaves: u32) -> Kernel {
    let tree = tree(&boxes(leaves));
    let path = path(f64::from(leaves).sqrt() as f32 * 1.5);
    let mut stack = Vec::new();
    let tested = Cell::new(0usize);
    let lanes = path.lanes::<f32x4>();
    let count = |node: &Node| {
        tested.set(tested.get() + 4);
        lanes.hits(node.min, node.max).bits()
    };
    tree.visit(&mut stack, count, |_| {});
    Kernel::new(name, tested.get(), move || {
        let lanes = black_box(&path).lanes::<f32x4>();
        let mut sum = 0u32;
        tree.visit(&mut stack, |node| lanes.hits(node.min, node.max).bits(), |c| sum = sum.wrapping_add(c));
        black_box(sum);
    })
}

/// Look-ups of 64 bodies' fat boxes one after another, as each step does for those that left theirs.
fn box_walk(name: &str, leaves: u32) -> Kernel {
    let boxes = boxes(leaves);
    let tree = tree(&boxes);
    let mut stack = Vec::new();
    let fat = |b: &Aabb| Aabb { min: b.min - 0.6, max: b.max + 0.6 };
    let asked: Vec<Aabb> = boxes.iter().step_by(leaves as usize / 64).map(fat).collect();
    let tested = Cell::new(0usize);
    for b in &asked {
        let (min, max) = (Vec3::splat(b.min), Vec3::splat(b.max));
        let count = |node: &Node| {
            tested.set(tested.get() + 4);
            node.overlaps(&min, &max)
        };
        tree.visit(&mut stack, count, |_| {});
    }
    Kernel::new(name, tested.get(), move || {
        let mut sum = 0u32;
        for b in black_box(&asked) {
            tree.visit_box(&mut stack, b, |c| sum = sum.wrapping_add(c));
        }
        black_box(sum);
    })
}
