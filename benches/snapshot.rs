//! Snapshots: `cargo bench --bench snapshot [FILTER]`, for example `snapshot/pile`. Prints bytes too.
//!
//! `save` and `restore` go to and fro between two moments eight steps apart, as a rollback does; `rollback`
//! restores the earlier one and takes the eight steps, with a snapshot after each; `steps` are those alone.
#![allow(missing_docs, reason = "criterion's macros make public functions")]

use backstop::{Settings, Snapshot, World};
use backstop_scene::{Scene, builtin};
use criterion::{Criterion, SamplingMode, criterion_group, criterion_main};

const DT: f32 = 1.0 / 60.0;
const FRAMES: usize = 8;

/// A scene and the steps before: to the densest moment of those that have one.
type Case = (&'static str, fn() -> Scene, u32);

const CASES: &[Case] = &[
    ("talk", builtin::talk, 26),
    ("pile", builtin::pile, 200),
    ("bullets", || builtin::bullets(false), 12),
    ("joint_grid", || builtin::joint_grid(100), 50),
];

fn advance(world: &mut World, steps: u32) {
    for _ in 0..steps {
        world.step(DT).expect("dt is above zero");
    }
}

fn snapshots(c: &mut Criterion) {
    for &(name, scene, warm) in CASES {
        let scene = scene();
        let mut world = World::new(Settings::default().with_gravity(scene.gravity)).expect("in range");
        scene.add_to(&mut world).expect("a builtin scene is valid");
        advance(&mut world, warm);
        let mut ring: Vec<Snapshot> = (0..=FRAMES).map(|_| Snapshot::new()).collect();
        world.snapshot(&mut ring[0]);
        advance(&mut world, FRAMES as u32);
        world.snapshot(&mut ring[FRAMES]);
        let (bytes, bodies) = (ring[0].size(), scene.dynamic_bodies());
        println!("{name}: {bytes} bytes, {:.0} a body", bytes as f64 / bodies as f64);

        let mut group = c.benchmark_group(format!("snapshot/{name}"));
        group.sample_size(20).sampling_mode(SamplingMode::Flat);
        let mut spare = Snapshot::new();
        group.bench_function("save", |b| b.iter(|| world.snapshot(&mut spare)));
        let mut earlier = false;
        group.bench_function("restore", |b| {
            b.iter(|| {
                earlier = !earlier;
                world.restore(&ring[if earlier { 0 } else { FRAMES }]).expect("it is of this world");
            });
        });
        group.bench_function("rollback", |b| {
            b.iter(|| {
                world.restore(&ring[0]).expect("it is of this world");
                for snapshot in &mut ring[1..] {
                    advance(&mut world, 1);
                    world.snapshot(snapshot);
                }
            });
        });
    }
}

criterion_group!(benches, snapshots);
criterion_main!(benches);
