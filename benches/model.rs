//! What parts of the engine cost a scene that needs them, and save one that doesn't: `cargo bench --bench
//! model [FILTER]`.
//!
//! The same pyramid of 1,830 boxes with a part and without it, step by step in turn, so that whatever else
//! the machine does falls on both: it stands without friction too, so both have the same contacts. Printed
//! are medians of the step and of its rows, the median of what a turn saved, and the difference of reserved
//! bytes.
#![allow(missing_docs, reason = "not an interface")]

use backstop::{Category, ContinuousMode, Material, Settings, ShapeDesc, World};
use backstop_scene::{Scene, builtin};
use std::time::Instant;

const DT: f32 = 1.0 / 60.0;
/// Steps until all touch, and steps that are timed.
const WARM: u32 = 20;
const TIMED: usize = 60;

type Change = fn(&mut Scene, &mut Settings);

/// With the part, and without it.
const CASES: &[(&str, Change, Change)] = &[
    // Sliding pairs are tested more often than resting ones, so all are.
    (
        "friction",
        |_, settings| settings.recycling = false,
        |scene, settings| {
            each(scene, |shape| shape.material = shape.material.with_friction(0.0));
            settings.recycling = false;
        },
    ),
    // One shape that touches nothing is enough for previous velocities to be kept and contacts to be asked.
    (
        "restitution",
        |scene, _| far(scene, |shape| shape.material = shape.material.with_restitution(0.5)),
        |scene, _| far(scene, |_| {}),
    ),
    ("sleeping", |_, settings| (settings.sleeping, settings.sleep_time) = (true, f32::MAX), |_, _| {}),
    ("listening", |scene, _| each(scene, |shape| shape.events = true), |_, _| {}),
    ("continuous", |_, _| {}, |_, settings| settings.continuous = ContinuousMode::Discrete),
    ("hooks", |scene, _| far(scene, |shape| shape.hooks = true), |scene, _| far(scene, |_| {})),
    ("sensors", |scene, _| far(scene, |shape| shape.sensor = true), |scene, _| far(scene, |_| {})),
];

fn each(scene: &mut Scene, change: fn(&mut ShapeDesc)) {
    scene.bodies.iter_mut().flat_map(|body| &mut body.desc.shapes).for_each(change);
}

/// A shape that nothing comes near to.
fn far(scene: &mut Scene, change: fn(&mut ShapeDesc)) {
    let mut body = backstop::BodyDesc::fixed().with_position(backstop::glam::DVec3::Y * -500.0);
    let mut shape = ShapeDesc::new(backstop::Geometry::cuboid(1.0, 1.0, 1.0));
    shape.material = Material::default();
    change(&mut shape);
    body.shapes.push(shape);
    scene.add("far", body);
}

fn world(change: Change) -> World {
    let mut scene = builtin::large_pyramid(60);
    let mut settings = Settings::default().with_gravity(scene.gravity);
    change(&mut scene, &mut settings);
    let mut world = World::new(settings).expect("the settings are in range");
    scene.add_to(&mut world).expect("a builtin scene is valid");
    for _ in 0..WARM {
        step(&mut world);
    }
    world
}

/// Times of a step, and of its stages `prepare` and `solve` together [us].
fn step(world: &mut World) -> [f64; 2] {
    let start = Instant::now();
    let times = world.step(DT).expect("dt is above zero").times;
    [start.elapsed().as_secs_f64() * 1e6, f64::from(times.prepare + times.solve)]
}

fn median(mut times: Vec<f64>) -> f64 {
    times.sort_unstable_by(f64::total_cmp);
    times[times.len() / 2]
}

fn main() {
    // Cargo says `--bench`.
    let filter = std::env::args().skip(1).find(|word| !word.starts_with('-'));
    let wanted = |name: &str| filter.as_deref().is_none_or(|filter| name.contains(filter));
    println!("{:<14}{:>10}{:>10}{:>8}{:>14}", "", "with", "without", "saved", "bytes saved");
    for (name, with, without) in CASES.iter().filter(|case| wanted(case.0)) {
        let mut worlds = [world(*with), world(*without)];
        let mut times: [[Vec<f64>; 2]; 2] = Default::default();
        for turn in 0..TIMED {
            for which in [turn % 2, 1 - turn % 2] {
                let [whole, rows] = step(&mut worlds[which]);
                times[which][0].push(whole);
                times[which][1].push(rows);
            }
        }
        let bytes = |what: fn(&World) -> usize| {
            let [with, without] = worlds.each_ref().map(what);
            with as i64 - without as i64
        };
        let more = [
            bytes(|world| world.memory().total()),
            bytes(|world| world.memory().category(Category::Rows).reserved),
        ];
        for (i, (name, more)) in [*name, "  its rows"].into_iter().zip(more).enumerate() {
            let saved = (0..TIMED).map(|turn| 100.0 * (1.0 - times[1][i][turn] / times[0][i][turn]));
            let saved = median(saved.collect());
            let [a, b] = times.each_ref().map(|times| median(times[i].clone()));
            println!("{name:<14}{a:>7.0} us{b:>7.0} us{saved:>7.1}%{more:>14}");
        }
        let [a, b] = worlds.each_ref().map(|world| world.report());
        if (a.real, a.potential) != (b.real, b.potential) {
            println!(
                "  contacts differ: {} and {} real points, {} and {} recycled",
                a.real, b.real, a.recycled, b.recycled
            );
        }
    }
}
