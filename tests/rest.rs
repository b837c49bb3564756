//! What stands stays standing: two minutes of it, at several rates.
//!
//! Stacks used to sway themselves over within a minute, from a lean of a micrometre (docs/decisions/frozen-contacts.md). Rigid
//! blocks on top of each other have no way to move, so what is expected is zero; the bounds are what single precision and
//! contacts that give way by tenths of a millimetre leave of it.
#![allow(clippy::disallowed_methods, reason = "expected values may use the platform's functions")]
mod common;

use backstop::scene::Standing;
use backstop::{BodyHandle, FrictionModel, Settings, World};

/// Speed at rest, of all bodies in the root of the mean square [m/s].
const REST: f64 = 1e-4;

fn rms(world: &World, bodies: &[BodyHandle]) -> f64 {
    let square = |&b: &BodyHandle| world.linear_velocity(b).unwrap().as_dvec3().length_squared();
    (bodies.iter().map(square).sum::<f64>() / bodies.len() as f64).sqrt()
}

/// How a structure stands for 120 s: at rest from the 20th second on, its top never further aside and, from then on, down
/// than so much [m].
fn stands_with(settings: Settings, structure: Standing, hz: u32, aside: f64, down: f64) {
    let (mut world, bodies) = structure.build(settings, 1000.0).unwrap();
    let top = *bodies.last().unwrap();
    let start = world.position(top).unwrap();
    for second in 1..=120 {
        common::steps(&mut world, hz, 1.0 / hz as f32);
        let moved = world.position(top).unwrap() - start;
        let (name, off) = (structure.name(), common::sideways(moved));
        assert!(off < aside, "{name} at {hz} Hz, {second} s: {off} m aside");
        if second >= 20 {
            let speed = rms(&world, &bodies);
            assert!(-moved.y < down, "{name} at {hz} Hz, {second} s: {} m down", -moved.y);
            assert!(speed < REST, "{name} at {hz} Hz, {second} s: {speed} m/s");
        }
    }
}

fn stands(structure: Standing, hz: u32, aside: f64, down: f64) {
    stands_with(Settings::default(), structure, hz, aside, down);
}

#[test]
fn towers_stand_for_two_minutes() {
    for (n, down) in [(2, 0.002), (5, 0.005), (10, 0.01), (15, 0.015), (20, 0.02), (30, 0.03), (50, 0.06)] {
        stands(Standing::Tower(n), 60, 0.005, down);
    }
}

/// Springs of contacts are the stiffer the shorter the substep: a tower sinks by its square.
#[test]
fn a_tower_stands_at_other_rates_and_substeps() {
    stands(Standing::Tower(30), 30, 0.005, 0.08);
    stands(Standing::Tower(30), 120, 0.005, 0.03);
    stands_with(Settings { substeps: 8, ..Settings::default() }, Standing::Tower(30), 60, 0.005, 0.03);
}

#[test]
fn barrels_and_coins_stand_for_two_minutes() {
    stands(Standing::Barrels(20), 60, 0.005, 0.02);
    stands(Standing::Coins(20), 60, 0.005, 0.02);
}

#[test]
fn a_box_stands_on_one_a_thousand_times_lighter() {
    stands(Standing::Light(300.0), 60, 0.005, 0.02);
    stands(Standing::Light(1000.0), 60, 0.005, 0.05);
}

#[test]
fn a_wall_and_a_pyramid_stand_for_two_minutes() {
    stands(Standing::Wall { width: 20, height: 10 }, 60, 0.01, 0.01);
    stands(Standing::Pyramid(20), 60, 0.01, 0.02);
}

/// Where several manifolds bear one body, the statics don't say how much each does. These fell within seconds, or never
/// came to rest.
#[test]
fn cribs_layers_and_planks_on_edge_stand_for_two_minutes() {
    stands(Standing::Crib(20), 60, 0.01, 0.02);
    stands(Standing::Edge(20), 60, 0.01, 0.02);
    stands(Standing::Layers(20), 60, 0.01, 0.02);
}

#[test]
#[ignore = "measured: thrown within 5 s; stands with 8 substeps"]
fn a_crib_of_forty_levels_stands() {
    stands(Standing::Crib(40), 60, 0.02, 0.1);
}

#[test]
#[ignore = "measured: stands, 12 mm aside at most, but its sway is below 1e-4 m/s only after 90 s"]
fn forty_layers_stand() {
    stands(Standing::Layers(40), 60, 0.02, 0.02);
}

/// Friction at every point used to tip them within 5 s.
#[test]
fn towers_stand_with_friction_at_points() {
    let settings = || Settings { friction_model: FrictionModel::Point, ..Settings::default() };
    stands_with(settings(), Standing::Tower(10), 60, 0.005, 0.01);
}

/// Two minutes of a tower of ten at steps that vary; its top never further aside than so much [m].
fn stands_at(steps: impl Fn(u32) -> f32, aside: f64) {
    let (mut world, bodies) = Standing::Tower(10).build(Settings::default(), 1000.0).unwrap();
    let top = *bodies.last().unwrap();
    let start = world.position(top).unwrap();
    let (mut time, mut step) = (0.0, 0);
    while time < 120.0 {
        world.step(steps(step)).unwrap();
        (time, step) = (time + f64::from(steps(step)), step + 1);
        let off = common::sideways(world.position(top).unwrap() - start);
        assert!(off < aside, "{time} s: {off} m aside");
    }
}

#[test]
#[ignore = "measured: 5.1 cm aside after 87 s, where the test ends; not watched further"]
fn a_tower_stands_through_hitches() {
    stands_at(|step| if step % 46 == 45 { 0.25 } else { 1.0 / 60.0 }, 0.05);
}

#[test]
#[ignore = "measured: 0.1 m aside after 20 s, falls after 80 s: the stiffest spring changes with every step, and its rest with it"]
fn a_tower_stands_at_steps_that_alternate() {
    stands_at(|step| if step % 2 == 0 { 1.0 / 30.0 } else { 1.0 / 144.0 }, 0.05);
}

/// Minutes in release: `cargo test --release --test rest -- --ignored`. Peers: 62 mm aside and 245 mm down (60 rows, 60 s), 0.17
/// m aside and 0.68 m down (100 rows, 20 s).
#[test]
#[ignore = "takes minutes in release"]
fn large_pyramids_stand_for_two_minutes() {
    for (rows, aside, down) in [(60, 0.1, 0.25), (100, 0.2, 0.7)] {
        let (mut world, bodies) = Standing::Pyramid(rows).build(Settings::default(), 1000.0).unwrap();
        let top = *bodies.last().unwrap();
        let start = world.position(top).unwrap();
        for second in 1..=120 {
            common::steps(&mut world, 60, 1.0 / 60.0);
            let moved = world.position(top).unwrap() - start;
            let off = common::sideways(moved);
            println!(
                "{rows} rows, {second} s: {off} m aside, {} m down, {} m/s",
                -moved.y,
                rms(&world, &bodies)
            );
            assert!(off < aside && -moved.y < down, "{rows} rows, {second} s: {moved}");
        }
    }
}
