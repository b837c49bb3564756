//! What the broad phase costs. Not checks: `cargo test --release broad_phase::timing -- --ignored
//! --nocapture`.

use super::*;
use crate::lanes::{Mask, f32x4};
use crate::memory::Room;
use glam::vec3;
use std::hint::black_box;
use std::time::Instant;

fn drop_stats(_: BroadStats) {}

/// Median time of `f` [µs].
fn median(runs: usize, mut f: impl FnMut(usize)) -> f64 {
    let mut times: Vec<f64> = (0..runs)
        .map(|i| {
            let start = Instant::now();
            f(i);
            start.elapsed().as_secs_f64() * 1e6
        })
        .collect();
    times.sort_by(f64::total_cmp);
    times[runs / 2]
}

fn cube(collider: u32, at: Vec3, motion: Vec3) -> Mover {
    let half = Vec3::splat(0.5);
    Mover {
        collider,
        aabb: Aabb { min: at - half, max: at + half },
        motion,
        spin: 0.0,
        mode: Continuous::Segment,
    }
}

struct Bench {
    broad: BroadPhase,
    movers: Vec<Mover>,
    removed: Vec<Pair>,
}

impl Bench {
    /// 16x16x16 cubes, `gap` apart, over a floor and a plane.
    fn new(gap: f32, motion: Vec3) -> Bench {
        let mut broad = BroadPhase::default();
        let movers: Vec<Mover> = (0..4096u32)
            .map(|c| {
                let at = vec3((c % 16) as f32, (c / 16 % 16) as f32 + 0.5, (c / 256) as f32);
                cube(c, at * (1.0 + gap), motion)
            })
            .collect();
        movers.iter().for_each(|m| broad.insert_mover(m.collider));
        broad.insert_static(5000, Aabb { min: vec3(-100.0, -1.0, -100.0), max: vec3(100.0, 0.0, 100.0) });
        broad.insert_static(
            5001,
            Aabb { min: Vec3::NEG_INFINITY, max: vec3(f32::INFINITY, -0.5, f32::INFINITY) },
        );
        Bench { broad, movers, removed: Vec::new() }
    }

    fn update(&mut self) -> BroadStats {
        self.removed.clear();
        let order = |i: u32, j: u32| (i.min(j), i.max(j));
        self.broad.update(&Crew::alone(), &self.movers, 0.1, &|_, _| true, &order, &mut self.removed)
    }

    /// One update, stage by stage.
    fn stages(&mut self) {
        self.advance();
        let (crew, broad) = (Crew::alone(), &mut self.broad);
        let order = |i: u32, j: u32| (i.min(j), i.max(j));
        let start = Instant::now();
        let mut last = 0.0;
        let mut lap = |name: &str| {
            let now = start.elapsed().as_secs_f64() * 1e6;
            print!("  {name} {:.0}", now - last);
            last = now;
        };
        broad.place_movers(&self.movers, 0.1);
        lap("place");
        broad.fit_movers();
        lap("fit");
        let (mut room, mut rooms) = (Room::default(), Rooms::ENDLESS);
        let rules = Rules { may_collide: &|_, _| true, order: &order, missing: &|_| 0 };
        broad.keep_pairs(&crew, rules.may_collide, &mut self.removed, &mut room);
        lap("keep");
        broad.find_pairs(&crew, &rules, (&mut rooms, &mut |_| 0));
        lap("find");
        for c in broad.changed.drain(..) {
            broad.marks[c as usize] = 0;
        }
        lap("clear");
        println!(" us");
    }

    fn advance(&mut self) {
        for m in &mut self.movers {
            m.aabb.min += m.motion;
            m.aabb.max += m.motion;
        }
    }

    /// Times updates only, with all moved in between.
    fn moving(&mut self, name: &str, runs: usize) {
        let mut times = Vec::new();
        let mut stats = BroadStats::default();
        for _ in 0..runs {
            self.advance();
            let start = Instant::now();
            stats = self.update();
            times.push(start.elapsed().as_secs_f64() * 1e6);
        }
        times.sort_by(f64::total_cmp);
        println!(
            "{name}: median {:.1} worst {:.1} us, {} pairs, {stats:?}",
            times[runs / 2],
            times[runs - 1],
            self.broad.pairs.len()
        );
        (0..6).for_each(|_| self.stages());
    }
}

#[test]
#[ignore = "a measurement"]
fn whole_updates() {
    let mut rest = Bench::new(0.0, Vec3::ZERO);
    let start = Instant::now();
    let first = rest.update();
    println!("first, 4096 touching: {:.1} us, {first:?}", start.elapsed().as_secs_f64() * 1e6);
    println!(
        "resting 4096: {:.1} us, {} pairs",
        median(101, |_| drop_stats(rest.update())),
        rest.broad.pairs.len()
    );
    for m in rest.movers.iter_mut().step_by(41) {
        m.motion = vec3(0.2, 0.0, 0.0);
    }
    println!("resting 4096, 100 of them fast: {:.1} us", median(101, |_| drop_stats(rest.update())));
    let ids: Vec<u32> = (0..4096).collect();
    let mut tree = Tree::default();
    let boxes: Vec<Aabb> = rest.movers.iter().map(|m| m.aabb).collect();
    let build = median(51, |_| {
        tree = Tree::default();
        tree.add(&ids, |c| boxes[c as usize], |_, _| {});
    });
    println!("building 4096: {build:.1} us");
    let mut stack = Vec::new();
    let mut hits = 0;
    let walk = median(51, |_| boxes.iter().for_each(|b| tree.visit_box(&mut stack, b, |_| hits += 1)));
    println!("4096 walks: {walk:.1} us, {} hits", hits / 51);

    let mut apart = Bench::new(0.8, vec3(0.0, -0.05, 0.0));
    apart.update();
    apart.moving("falling 4096, slow, apart", 101);
    let mut apart = Bench::new(0.8, vec3(0.0, -0.2, 0.0));
    apart.update();
    apart.moving("falling 4096, fast, apart", 101);
    let mut pile = Bench::new(0.0, vec3(0.0, -0.05, 0.0));
    pile.update();
    pile.moving("falling 4096, slow, touching", 101);
    let mut pile = Bench::new(0.0, vec3(0.0, -0.2, 0.0));
    pile.update();
    pile.moving("falling 4096, fast, touching", 101);
}

#[test]
#[ignore = "a measurement"]
fn bullets() {
    let mut bench = Bench::new(1.0, Vec3::ZERO);
    let mut seed = 1u32;
    let mut next = || {
        seed = seed.wrapping_mul(1_664_525).wrapping_add(1_013_904_223);
        (seed >> 8) as f32 / (1 << 23) as f32 - 1.0
    };
    for c in 6000..7000 {
        let motion = vec3(next(), next(), next()) * 10.0;
        let at = vec3(next(), next(), next()) * 16.0 + 16.0;
        let mut bullet = cube(c, at, motion);
        bullet.aabb = Aabb { min: at - 0.01, max: at + 0.01 };
        bench.movers.push(bullet);
        bench.broad.insert_mover(c);
    }
    bench.update();
    println!("{:?} {}", bench.update(), bench.broad.pairs.len());
    println!(
        "1000 bullets of 10 m/step among 4096 at rest: {:.1} us",
        median(51, |_| drop_stats(bench.update()))
    );
    let few: Vec<Mover> = bench.movers.drain(..4096).collect();
    few.iter().for_each(|m| bench.broad.remove(m.collider, &mut bench.removed));
    bench.update();
    println!("1000 bullets alone: {:.1} us", median(51, |_| drop_stats(bench.update())));
}

#[test]
#[ignore = "a measurement"]
fn segment_tests() {
    let boxes: Vec<(crate::lanes::Vec3<f32x4>, crate::lanes::Vec3<f32x4>)> = (0..64)
        .map(|i| {
            let at = |k: usize| vec3((i * 4 + k) as f32, ((i + k) % 5) as f32, k as f32);
            (crate::lanes::Vec3::from_fn(|k| at(k) - 0.5), crate::lanes::Vec3::from_fn(|k| at(k) + 0.5))
        })
        .collect();
    let path = Path::new(&cube(0, Vec3::ZERO, vec3(100.0, 3.0, 1.0)), 0.1);
    let time = median(101, |_| {
        for _ in 0..100 {
            let lanes = black_box(&path).lanes::<f32x4>();
            let bits = boxes.iter().fold(0, |sum, b| sum + lanes.hits(b.0, b.1).bits());
            black_box(bits);
        }
    });
    println!("segment test: {:.2} ns a box", time * 1e3 / (100.0 * 256.0));
    let with_build = median(5, |_| {
        let mut broad = BroadPhase::default();
        for c in 0..100_000u32 {
            let at = vec3((c % 300) as f32, (c % 7) as f32, (c / 300) as f32) * 2.0;
            broad.insert_static(c, Aabb { min: at - 0.5, max: at + 0.5 });
        }
        broad.update(&Crew::alone(), &[], 0.1, &|_, _| true, &|i, j| (i, j), &mut Vec::new());
        black_box(&broad);
    });
    println!("100 000 statics: {:.0} us", with_build);
}
