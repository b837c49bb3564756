//! Benchmarks of whole broad-phase updates. An element is a mover, unless said otherwise.

use super::Kernel;
use crate::broad_phase::kernels::Tree;
use crate::broad_phase::{Aabb, BroadPhase, Mover, Pair, PairMemory, Rules};
use crate::config::ContinuousMode;
use crate::config::tuning::FAT_MARGIN;
use crate::memory::Allowances;
use crate::threads::Workers;
use glam::{Vec3, vec3};
use std::hint::black_box;

/// Cubes of a metre, 16 along each axis, over a floor and a plane; bullets among them.
struct Crowd {
    broad: BroadPhase,
    movers: Vec<Mover>,
    removed: Vec<Pair>,
}

const CUBES: u32 = 16 * 16 * 16;

/// At rest, falling, with bullets; and building a tree of all.
pub fn kernels() -> Vec<Kernel> {
    let mut some_fast = Crowd::new(0.0, Vec3::ZERO);
    some_fast.movers.iter_mut().step_by(41).for_each(|m| m.motion = vec3(0.2, 0.0, 0.0));
    let mut bullets = Crowd::new(1.0, Vec3::ZERO);
    bullets.add_bullets(1000);
    vec![
        at_rest("update, at rest", Crowd::new(0.0, Vec3::ZERO)),
        at_rest("update, one in forty fast", some_fast),
        at_rest("update, a thousand bullets among those at rest", bullets),
        falling("update, falling slowly, apart", 0.8, 0.05),
        falling("update, falling fast, apart", 0.8, 0.2),
        falling("update, falling slowly, touching", 0.0, 0.05),
        falling("update, falling fast, touching", 0.0, 0.2),
        building(),
    ]
}

impl Crowd {
    /// Cubes at a distance of `gap` that all move as far within a step [m].
    fn new(gap: f32, motion: Vec3) -> Crowd {
        let mut crowd = Crowd { broad: BroadPhase::default(), movers: Vec::new(), removed: Vec::new() };
        for i in 0..CUBES {
            let at = vec3((i % 16) as f32, (i / 16 % 16) as f32 + 0.5, (i / 256) as f32) * (1.0 + gap);
            crowd.add(i, at, 0.5, motion);
        }
        let floor = Aabb { min: vec3(-100.0, -1.0, -100.0), max: vec3(100.0, 0.0, 100.0) };
        let plane = Aabb { min: Vec3::NEG_INFINITY, max: vec3(f32::INFINITY, -0.5, f32::INFINITY) };
        crowd.broad.insert_static(5000, floor);
        crowd.broad.insert_static(5001, plane);
        crowd
    }

    fn add(&mut self, collider: u32, at: Vec3, half: f32, motion: Vec3) {
        let aabb = Aabb { min: at - half, max: at + half };
        self.movers.push(Mover { collider, aabb, motion, spin: 0.0, mode: ContinuousMode::Segment });
        self.broad.insert_mover(collider);
    }

    /// Bullets of a centimetre, at up to 10 m a step along each axis.
    fn add_bullets(&mut self, count: u32) {
        let mut random = crate::random::Random(1);
        let mut cube = || vec3(random.range(-1.0, 1.0), random.range(-1.0, 1.0), random.range(-1.0, 1.0));
        for collider in 6000..6000 + count {
            self.add(collider, cube() * 16.0 + 16.0, 0.01, cube() * 10.0);
        }
    }

    fn update(&mut self) {
        self.removed.clear();
        let order = |i: u32, j: u32| (i.min(j), i.max(j));
        let rules = Rules { may_collide: &|_, _| true, order: &order, missing: &|_| 0, still: false };
        self.broad.start_movers();
        self.broad.place_movers(&self.movers, FAT_MARGIN);
        let allowances = &mut Allowances::ENDLESS.clone();
        let mut memory = PairMemory { allowances, give_up: &mut |_| 0 };
        self.broad.update_within(&Workers::alone(), &rules, &mut self.removed, &mut memory);
    }
}

fn at_rest(name: &str, mut crowd: Crowd) -> Kernel {
    crowd.update();
    Kernel::new(name, crowd.movers.len(), move || {
        crowd.update();
        black_box(&crowd.broad);
    })
}

/// All move down by this much in each run [m], and up again before they are far.
fn falling(name: &str, gap: f32, by: f32) -> Kernel {
    let mut crowd = Crowd::new(gap, vec3(0.0, -by, 0.0));
    crowd.update();
    let mut run = 0;
    Kernel::new(name, crowd.movers.len(), move || {
        run += 1;
        for mover in &mut crowd.movers {
            mover.aabb.min += mover.motion;
            mover.aabb.max += mover.motion;
            if run % 100 == 0 {
                mover.motion = -mover.motion;
            }
        }
        crowd.update();
        black_box(&crowd.broad);
    })
}

fn building() -> Kernel {
    let crowd = Crowd::new(0.0, Vec3::ZERO);
    let boxes: Vec<Aabb> = crowd.movers.iter().map(|m| m.aabb).collect();
    let all: Vec<u32> = (0..CUBES).collect();
    Kernel::new("building a tree", boxes.len(), move || {
        let mut tree = Tree::default();
        tree.add(&all, |i| boxes[i as usize], |_, _| {});
        black_box(&tree);
    })
}
