//! The broad phase as a whole: against all pairs, against exact arithmetic, in any order of blocks.

use super::segment::tests::slabs;
use super::*;
use crate::random::Random;
use crate::threads::{Helpers, with_workers};
use glam::{DVec3, vec3};
use std::collections::{BTreeMap, BTreeSet};

/// A body of a test scene: a box that moves and bounces off the scene's edge.
#[derive(Clone, Copy)]
struct Body {
    mover: Mover,
    moves: bool,
    asleep: bool,
    group: u32,
}

/// Up to 300 colliders in a cube of 2 * `size`, of all kinds, that come, go, move and fall asleep.
struct Scene {
    random: Random,
    centre: Vec3,
    size: f32,
    bodies: BTreeMap<u32, Body>,
    broad: BroadPhase,
    removed: Vec<Pair>,
}

const MARGIN: f32 = 0.1;

fn ordered(i: u32, j: u32) -> (u32, u32) {
    // Not simply by index, as in the engine.
    if (i % 3, i) < (j % 3, j) { (i, j) } else { (j, i) }
}

impl Scene {
    fn new(seed: u64, centre: Vec3, size: f32) -> Scene {
        Scene {
            random: Random(seed),
            centre,
            size,
            bodies: BTreeMap::new(),
            broad: BroadPhase::default(),
            removed: Vec::new(),
        }
    }

    fn add(&mut self, c: u32) {
        let r = &mut self.random;
        let at = self.centre + r.cube() * self.size;
        let half = (r.cube() * 0.5).abs() + 0.05;
        let moves = r.unit() < 0.7;
        let speed = [0.0, 0.02, 0.1, 2.0, 30.0][r.below(5)];
        let aabb = match (moves, r.below(30)) {
            (false, 0) => Aabb { min: Vec3::NEG_INFINITY, max: vec3(f32::INFINITY, at.y, f32::INFINITY) },
            (false, 1) => Aabb { min: Vec3::NEG_INFINITY, max: Vec3::INFINITY },
            (false, 2) => Aabb { min: at - 5.0, max: at + 5.0 },
            _ => Aabb { min: at - half, max: at + half },
        };
        let mover = Mover {
            collider: c,
            aabb,
            motion: r.cube() * speed,
            spin: [0.0, 0.01, 0.3][r.below(3)],
            mode: [
                ContinuousMode::Discrete,
                ContinuousMode::Segment,
                ContinuousMode::Segment,
                ContinuousMode::Volume,
            ][r.below(4)],
        };
        if moves {
            self.broad.insert_mover(c);
        } else {
            self.broad.insert_static(c, aabb);
        }
        self.bodies.insert(c, Body { mover, moves, asleep: false, group: r.below(4) as u32 });
    }

    fn step(&mut self, workers: &Workers) -> BroadStats {
        for body in self.bodies.values_mut().filter(|b| b.moves && !b.asleep) {
            let m = &mut body.mover;
            m.aabb = Aabb { min: m.aabb.min + m.motion, max: m.aabb.max + m.motion };
            for k in 0..3 {
                let at = (m.aabb.min[k] - self.centre[k]).abs();
                if at > self.size && (m.aabb.min[k] - self.centre[k]) * m.motion[k] > 0.0 {
                    m.motion[k] = -m.motion[k];
                }
            }
        }
        let movers: Vec<Mover> =
            self.bodies.values().filter(|b| b.moves && !b.asleep).map(|b| b.mover).collect();
        let bodies = &self.bodies;
        let may = |i: u32, j: u32| allowed(&bodies[&i], &bodies[&j]);
        self.broad.update(workers, &movers, MARGIN, &may, &ordered, &mut self.removed)
    }

    /// Adds, removes, wakes, puts to sleep and changes filters at random.
    fn disturb(&mut self) {
        for _ in 0..self.random.below(6) {
            let c = self.random.below(400) as u32;
            let what = self.random.below(4);
            let Some(body) = self.bodies.get_mut(&c) else {
                if self.bodies.len() < 300 {
                    self.add(c);
                }
                continue;
            };
            match what {
                0 => {
                    self.broad.remove(c, &mut self.removed);
                    self.bodies.remove(&c);
                    assert!(self.broad.pairs.iter().all(|p| p.a != c && p.b != c));
                }
                1 => body.asleep = !body.asleep,
                _ => {
                    body.group = (body.group + 1) % 4;
                    self.broad.touch(c);
                }
            }
        }
    }

    fn pairs(&self) -> BTreeSet<(u32, u32)> {
        let set: BTreeSet<_> = self.broad.pairs.iter().map(|p| (p.a, p.b)).collect();
        assert_eq!(set.len(), self.broad.pairs.len(), "no pair twice");
        set
    }
}

/// Groups 0 and 1 don't collide with each other; nor do statics.
fn allowed(p: &Body, q: &Body) -> bool {
    (p.moves || q.moves) && !matches!((p.group, q.group), (0, 1) | (1, 0))
}

/// Whether two boxes touch within the step, by exact relative motion (in f64, slabs); grown by `slack` [m].
fn touch_exactly(p: &Mover, q: &Mover, slack: f64) -> bool {
    let motion =
        |m: &Mover| if m.mode == ContinuousMode::Discrete { DVec3::ZERO } else { m.motion.as_dvec3() };
    let spin = |m: &Mover| if m.mode == ContinuousMode::Discrete { 0.0 } else { f64::from(m.spin) };
    let relative = motion(p) - motion(q);
    let grow = spin(p) + spin(q) + slack;
    let low = q.aabb.min.as_dvec3() - p.aabb.max.as_dvec3();
    let high = q.aabb.max.as_dvec3() - p.aabb.min.as_dvec3();
    slabs(DVec3::ZERO, relative, DVec3::splat(grow), low, high, 0.0)
}

fn still(body: &Body) -> Mover {
    let rests = !body.moves || body.asleep;
    if rests { Mover { motion: Vec3::ZERO, spin: 0.0, ..body.mover } } else { body.mover }
}

fn run_against_brute_force(centre: Vec3, size: f32) {
    let mut scene = Scene::new(5, centre, size);
    for c in 0..280 {
        scene.add(c);
    }
    let (mut pairs_seen, mut fast_seen, mut needed) = (0, 0, 0);
    for step in 0..200 {
        let before = scene.pairs();
        let removed_before = scene.removed.len();
        if step > 0 {
            scene.disturb();
        }
        scene.step(&Workers::alone());
        let pairs = scene.pairs();
        let expected: BTreeSet<(u32, u32)> = scene
            .bodies
            .iter()
            .flat_map(|(i, p)| scene.bodies.range(i + 1..).map(move |(j, q)| ((*i, *j), p, q)))
            .filter(|((i, j), p, q)| allowed(p, q) && scene.broad.may_touch(*i, *j))
            .map(|((i, j), ..)| ordered(i, j))
            .collect();
        assert_eq!(pairs, expected, "step {step}");
        let gone: BTreeSet<(u32, u32)> = scene.removed[removed_before..].iter().map(|p| (p.a, p.b)).collect();
        assert!(before.difference(&pairs).all(|pair| gone.contains(pair)), "every end is reported");

        for (i, p) in &scene.bodies {
            for (j, q) in scene.bodies.range(i + 1..).filter(|(_, q)| allowed(p, q)) {
                let pair = ordered(*i, *j);
                let (m, n) = (still(p), still(q));
                if touch_exactly(&m, &n, 0.0) {
                    needed += 1;
                    assert!(pairs.contains(&pair), "step {step}: {pair:?} missed: {m:?} {n:?}");
                } else if pairs.contains(&pair) {
                    // Both margins, both reaches ahead, and a slow one's own motion, may be had for nothing;
                    // a volume is a volume, and a body that fell asleep or slowed down keeps its box.
                    let segments = [&m, &n].iter().all(|m| m.mode == ContinuousMode::Segment);
                    let awake = [p, q].iter().all(|b| !b.asleep);
                    let rounding = f64::from(centre.length()) * 2e-6;
                    assert!(
                        !segments || !awake || touch_exactly(&m, &n, 8.0 * f64::from(MARGIN) + rounding),
                        "step {step}: {pair:?} made up: {m:?} {n:?}"
                    );
                }
            }
        }
        pairs_seen += pairs.len();
        fast_seen += scene.broad.pairs.iter().filter(|p| p.fast).count();
    }
    assert!(pairs_seen > 20_000 && fast_seen > 2_000 && needed > 10_000, "{pairs_seen} {fast_seen} {needed}");
}

#[test]
fn pairs_are_those_of_all_with_all() {
    run_against_brute_force(Vec3::ZERO, 6.0);
}

#[test]
fn nothing_is_missed_far_from_the_origin() {
    run_against_brute_force(vec3(1e6, -1e6, 5e5), 6.0);
}

#[test]
fn a_bullet_meets_a_bullet_head_on_and_only_that_one() {
    let mut broad = BroadPhase::default();
    let bullet = |collider, x: f32, y: f32, motion: f32| Mover {
        collider,
        aabb: Aabb { min: vec3(x, y, 0.0), max: vec3(x + 0.01, y + 0.01, 0.01) },
        motion: vec3(motion, 0.0, 0.0),
        spin: 0.0,
        mode: ContinuousMode::Segment,
    };
    // 1 and 2 fly at each other; 3 flies behind 1, their swept boxes cross, at the same speed; 4 is beside.
    let mut movers = vec![
        bullet(1, 0.0, 0.0, 20.0),
        bullet(2, 30.0, 0.0, -20.0),
        bullet(3, -15.0, 0.0, 20.0),
        bullet(4, 0.0, 1.0, 20.0),
    ];
    (1..5).for_each(|c| broad.insert_mover(c));
    let mut removed = Vec::new();
    let mut update = |broad: &mut BroadPhase, movers: &[Mover]| {
        broad.update(&Workers::alone(), movers, MARGIN, &|_, _| true, &ordered, &mut removed)
    };
    update(&mut broad, &movers);
    assert_eq!(
        broad.pairs,
        [Pair {
            a: ordered(1, 2).0,
            b: ordered(1, 2).1,
            contact: NONE,
            fast: true,
            touching: false,
            apart: 0
        }]
    );
    // At 1e5 m/s and more, across a wall of a millimetre, and with numbers that make no sense.
    broad.insert_static(9, Aabb { min: vec3(500.0, -1.0, -1.0), max: vec3(500.001, 1.0, 1.0) });
    movers[0].motion.x = 1e5 / 60.0;
    movers[3].motion = vec3(f32::NAN, f32::INFINITY, 0.0);
    update(&mut broad, &movers);
    assert!(broad.pairs.iter().any(|p| p.a.min(p.b) == 1 && p.a.max(p.b) == 9 && p.fast));
    movers[3].aabb.min.x = f32::NAN;
    update(&mut broad, &movers);
    assert!(broad.pairs.iter().all(|p| p.a != 4 && p.b != 4));
}

#[test]
fn pairs_and_their_order_do_not_depend_on_which_block_runs_when() {
    let run = |threads: usize, orders: Option<fn(usize) -> Vec<usize>>| {
        let mut scene = Scene::new(8, Vec3::ZERO, 6.0);
        for c in 0..280 {
            scene.add(c);
        }
        scene.broad.shuffle = orders;
        let mut all = Vec::new();
        with_workers(threads, &mut Helpers::default(), |workers| {
            for _ in 0..50 {
                scene.disturb();
                scene.step(&workers);
                all.push(scene.broad.pairs.clone());
            }
        });
        (all, scene.removed)
    };
    let alone = run(1, None);
    assert!(alone == run(1, Some(|n| (0..n).rev().collect())));
    assert!(alone == run(1, Some(|n| (0..n).filter(|b| b % 2 == 1).chain((0..n).step_by(2)).collect())));
    assert!(alone == run(2, None) && alone == run(5, None));
}

#[test]
fn a_steady_scene_changes_nothing_and_allocates_nothing() {
    let mut scene = Scene::new(3, Vec3::ZERO, 6.0);
    (0..280).for_each(|c| scene.add(c));
    let rest = |scene: &mut Scene, motion: fn(f32) -> f32| {
        for body in scene.bodies.values_mut() {
            body.mover.motion = body.mover.motion.map(motion);
            body.mover.spin = 0.0;
        }
    };
    rest(&mut scene, |v| v * 0.1);
    for _ in 0..300 {
        scene.step(&Workers::alone());
    }
    let (_, reserved) = scene.broad.bytes();
    for _ in 0..50 {
        scene.step(&Workers::alone());
    }
    assert!(scene.broad.bytes().1 <= reserved + reserved / 50, "buffers have found their size");
    rest(&mut scene, |_| 0.0);
    scene.step(&Workers::alone());
    scene.step(&Workers::alone());
    let (_, reserved) = scene.broad.bytes();
    for _ in 0..10 {
        assert_eq!(scene.step(&Workers::alone()), BroadStats::default());
    }
    assert_eq!(scene.broad.bytes().1, reserved);
}
