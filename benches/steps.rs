//! Whole scenes by thread count: `cargo bench --bench steps [FILTER]`, for example `steps/pile/2`.
//!
//! A scene that stays as it is runs on and is timed step by step. One whose point is soon over (bullets) is
//! built anew for each sample, and a sample is a window of its steps: criterion prints steps as elements.
#![allow(missing_docs, reason = "criterion's macros make public functions")]

use backstop::{Settings, World};
use backstop_scene::{Scene, builtin};
use criterion::{
    BatchSize, BenchmarkId, Criterion, SamplingMode, Throughput, criterion_group, criterion_main,
};
use rayon::ThreadPoolBuilder;

const DT: f32 = 1.0 / 60.0;
const THREADS: [usize; 2] = [1, 2];

/// The timed part of a scene.
struct Case {
    name: &'static str,
    scene: fn() -> Scene,
    /// Steps before.
    warm: u32,
    /// Steps that a sample takes, from a new world each time; `None` for a scene that runs on.
    window: Option<u32>,
    /// All that can is sent to sleep.
    asleep: bool,
}

const CASES: &[Case] = &[
    Case {
        name: "large_pyramid_30",
        scene: || builtin::large_pyramid(30),
        warm: 60,
        window: None,
        asleep: false,
    },
    Case {
        name: "large_pyramid_60",
        scene: || builtin::large_pyramid(60),
        warm: 60,
        window: None,
        asleep: false,
    },
    Case { name: "tall_stack", scene: builtin::tall_stack, warm: 60, window: None, asleep: false },
    Case { name: "pile", scene: builtin::pile, warm: 200, window: None, asleep: false },
    Case { name: "pile_asleep", scene: builtin::pile, warm: 200, window: None, asleep: true },
    // All eleven hit the terrain between the steps 20 and 33.
    Case { name: "talk", scene: builtin::talk, warm: 10, window: Some(40), asleep: false },
    Case {
        name: "joint_grid",
        scene: || builtin::joint_grid(100),
        warm: 0,
        window: Some(100),
        asleep: false,
    },
    // The fastest cross the floor's height in the first steps, the slowest in the twelfth.
    Case { name: "bullets", scene: || builtin::bullets(false), warm: 1, window: Some(20), asleep: false },
];

fn warm(scene: &Scene, case: &Case, threads: usize) -> World {
    let settings =
        Settings::default().with_gravity(scene.gravity).with_threads(threads).with_sleeping(case.asleep);
    let mut world = World::new(settings).expect("the default settings are in range");
    scene.add_to(&mut world).expect("a builtin scene is valid");
    advance(&mut world, case.warm);
    if case.asleep {
        for body in world.bodies().collect::<Vec<_>>() {
            world.sleep(body).expect("the body is there");
        }
    }
    world
}

fn advance(world: &mut World, steps: u32) {
    for _ in 0..steps {
        world.step(DT).expect("dt is above zero");
    }
}

fn steps(c: &mut Criterion) {
    for case in CASES {
        let mut group = c.benchmark_group(format!("steps/{}", case.name));
        group.sample_size(20).sampling_mode(SamplingMode::Flat);
        group.throughput(Throughput::Elements(case.window.unwrap_or(1).into()));
        let scene = (case.scene)();
        for threads in THREADS {
            let pool = ThreadPoolBuilder::new().num_threads(threads).build().expect("a pool of threads");
            // Criterion calls the closure once a sample: the world is to go on from one to the next.
            let mut running = None;
            group.bench_function(BenchmarkId::from_parameter(threads), |b| {
                pool.install(|| match case.window {
                    None => {
                        let world = running.get_or_insert_with(|| warm(&scene, case, threads));
                        b.iter(|| advance(world, 1));
                    }
                    Some(window) => b.iter_batched_ref(
                        || warm(&scene, case, threads),
                        |world| advance(world, window),
                        BatchSize::PerIteration,
                    ),
                });
            });
        }
    }
}

criterion_group!(benches, steps);
criterion_main!(benches);
