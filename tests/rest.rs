//! What stands stays standing: two minutes of it, at several rates.
//!
//! Stacks used to sway themselves over within a minute, from a lean of a micrometre (docs/decisions/frozen-contacts.md). Rigid
//! blocks on top of each other have no way to move, so what is expected is zero; the bounds are what single precision and
//! contacts that give way by tenths of a millimetre leave of it.
#![allow(clippy::disallowed_methods, reason = "expected values may use the platform's functions")]
mod common;

use backstop::glam::{Quat, Vec3};
use backstop::scene::Standing;
use backstop::{BodyDesc, BodyHandle, Geometry, Settings, ShapeDesc, World};

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

/// Two minutes of a tower at steps that vary; from the 20th second on at rest, but for so much [m/s].
fn stands_at(boxes: usize, steps: impl Fn(u32) -> f32, speed: f64) {
    let (mut world, bodies) = Standing::Tower(boxes).build(Settings::default(), 1000.0).unwrap();
    let top = *bodies.last().unwrap();
    let start = world.position(top).unwrap();
    let (mut time, mut step) = (0.0, 0);
    while time < 120.0 {
        world.step(steps(step)).unwrap();
        (time, step) = (time + f64::from(steps(step)), step + 1);
        let off = common::sideways(world.position(top).unwrap() - start);
        assert!(off < 0.005, "{time} s: {off} m aside");
        let now = rms(&world, &bodies);
        assert!(time < 20.0 || now < speed, "{time} s: {now} m/s");
    }
}

/// Once a spring was as stiff as each substep allows, held loads were compared in units of two substeps, and what stopped the
/// last of a velocity was warm-started as if it were a load: the towers of 10 and 8 fell after 87 and 80 s.
#[test]
fn a_tower_stands_through_hitches() {
    for boxes in [2, 5, 10] {
        stands_at(boxes, |step| if step % 46 == 45 { 0.25 } else { 1.0 / 60.0 }, REST);
    }
}

#[test]
fn a_tower_stands_at_steps_that_alternate() {
    for boxes in [2, 3, 5, 8] {
        stands_at(boxes, |step| if step % 2 == 0 { 1.0 / 30.0 } else { 1.0 / 144.0 }, REST);
    }
}

/// Between two lengths [s], the same in every run.
fn random_step(step: u32, least: f32, most: f32) -> f32 {
    let mut bits = (step + 1).wrapping_mul(0x9E37_79B9);
    bits = (bits ^ bits >> 16).wrapping_mul(0x85EB_CA6B);
    bits = (bits ^ bits >> 13).wrapping_mul(0xC2B2_AE35);
    least + (most - least) * ((bits ^ bits >> 16) >> 8) as f32 / (1 << 24) as f32
}

/// Springs follow the usual substep by up to a hundredth in a step, and the sag of 6 and 21 mm by its square. On average a
/// thousandth a step is taken back: 2 * 6 mm * 0.001 in 20 ms are 0.6 mm/s, and 1.2 mm/s are those of 21 mm in 35 ms.
#[test]
fn a_tower_stands_at_random_steps() {
    stands_at(10, |step| random_step(step, 1.0 / 144.0, 1.0 / 30.0), 0.6e-3);
    stands_at(10, |step| random_step(step, 1.0 / 240.0, 1.0 / 15.0), 1.2e-3);
}

/// Friction holds it as long as the slope is less than the coefficient, tan 20° = 0.36 of 0.6, whatever the steps.
#[test]
fn a_box_stays_on_a_slope_at_steps_that_vary() {
    let steps: [fn(u32) -> f32; 3] = [
        |step| if step % 2 == 0 { 1.0 / 30.0 } else { 1.0 / 144.0 },
        |step| if step % 46 == 45 { 0.25 } else { 1.0 / 60.0 },
        |step| random_step(step, 1.0 / 240.0, 1.0 / 15.0),
    ];
    for (way, length) in steps.into_iter().enumerate() {
        let mut world = World::new(Settings::default()).unwrap();
        let turn = Quat::from_rotation_z(20.0_f32.to_radians());
        let cube = ShapeDesc::new(Geometry::cuboid(0.5, 0.5, 0.5));
        world.add_body(&BodyDesc::fixed().rotated(turn).with_shape(ShapeDesc::new(Geometry::Plane))).unwrap();
        let start = (turn * Vec3::new(0.0, 0.5, 0.0)).as_dvec3();
        let body = BodyDesc::dynamic().at(start).rotated(turn).with_shape(cube);
        let body = world.add_body(&body).unwrap();
        let (mut time, mut step) = (0.0, 0);
        while time < 120.0 {
            world.step(length(step)).unwrap();
            (time, step) = (time + length(step), step + 1);
        }
        let way_down = world.position(body).unwrap().distance(start);
        assert!(way_down < 0.002, "steps {way}: {way_down} m");
    }
}

/// Minutes in release: `cargo test --release --test rest -- --ignored`. Peers: 62 mm aside and 245 mm down (60 rows, 60 s), 0.17
/// m aside and 0.68 m down (100 rows, 20 s).
#[test]
#[ignore = "takes minutes in release; measured: 60 rows hold, 26 mm aside and 48 mm down, 100 rows fall within 20 s"]
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
