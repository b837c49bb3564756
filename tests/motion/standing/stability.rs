//! Rest is a fixed point of the step, and a stable one: nothing about it grows.
//!
//! Everything that stood used to sway itself over: towers of 10 to 50 boxes leaned e times as far every 2 s
//! and fell within a minute, pyramids too. `docs/stability.md` says how the linearised step is measured. The
//! bound, 1e-5 a step, is e in half an hour at 60 Hz.

use crate::common;

use backstop::glam::Vec3;
use backstop::{BodyDesc, FrictionModel, Geometry, JointDesc, Material, Settings, World};
use backstop_lab::{Probe, Verdict, find_rest, growth, stability};
use backstop_scene::Standing;

/// A world with a body on a ball joint to the world's origin, its centre so far above [m].
fn pendulum(height: f32, shape: Geometry) -> World {
    let mut world = World::new(Settings::default()).unwrap();
    let post = world.add_body(&BodyDesc::fixed()).unwrap();
    let at = Vec3::new(0.0, height, 0.0);
    let body = world.add_body(&common::dynamic(shape, Material::default(), at)).unwrap();
    let frames = world.frames_at([post, body], backstop::glam::DVec3::ZERO, Default::default()).unwrap();
    world.add_joint(&JointDesc::ball([post, body], frames)).unwrap();
    world
}

/// Square of a pendulum's rate: m g l / (I + m l²) of a sphere, where I = 2/5 m r² [1/s²].
fn rate_squared(length: f64, radius: f64) -> f64 {
    common::G * length / (0.4 * radius * radius + length * length)
}

/// The instrument itself, on a known case: a pendulum upside down grows with the root of m g l / I.
#[test]
fn a_pendulum_upside_down_grows_as_theory_has_it() {
    let world = pendulum(1.0, Geometry::Sphere { radius: 0.2 });
    let expected = rate_squared(1.0, 0.2).sqrt();
    for hz in [60.0, 120.0] {
        // Short enough that it is still upside down in the end.
        let probe = Probe { horizon: 1.0, ..Probe::new(1.0 / hz) };
        let found = stability(&world, &probe).unwrap();
        let parting = growth(&world, &probe, 2.0).unwrap();
        println!("{hz} Hz: {:.4}/s, parting {parting:.4}/s, theory {expected:.4}/s", found.growth);
        assert!((found.growth / expected - 1.0).abs() < 0.01, "{} /s", found.growth);
        assert!((parting / expected - 1.0).abs() < 0.05, "{parting} /s");
        let [across, along, turning] = found.modes[0].shares;
        // One metre sideways with each radian.
        assert!((across - 0.5).abs() < 0.05 && along < 1e-3 && (turning - 0.5).abs() < 0.05);
        assert_eq!(found.verdict(), Verdict::Unstable);
    }
}

/// The same hanging: it swings at that rate, and gains nothing.
#[test]
fn a_pendulum_that_hangs_swings_as_theory_has_it() {
    let world = pendulum(-1.0, Geometry::Sphere { radius: 0.2 });
    let expected = rate_squared(1.0, 0.2).sqrt() / std::f64::consts::TAU;
    for hz in [60.0, 120.0] {
        let found = stability(&world, &Probe::new(1.0 / hz)).unwrap();
        let mode = found.modes.iter().find(|mode| mode.frequency > 0.1).expect("it swings");
        println!(
            "{hz} Hz: {:.4} Hz, {:.4}/s, radius 1 {:+.1e} (noise {:.1e}); theory {expected:.4} Hz",
            mode.frequency,
            mode.growth,
            found.radius - 1.0,
            found.noise
        );
        assert!((mode.frequency / expected - 1.0).abs() < 0.001, "{} Hz", mode.frequency);
        assert!(found.verdict() != Verdict::Unstable, "it gains: 1 {:+.1e} a step", found.radius - 1.0);
    }
}

/// Asserts that a structure comes to rest where it was put, and that nothing about that rest grows.
fn stand(structure: Standing, settings: Settings, hz: f32) {
    let (mut world, _) = structure.build(settings.clone(), 1000.0).unwrap();
    let dt = 1.0 / hz;
    let rest = find_rest(&mut world, dt, 15.0).unwrap();
    let found = stability(&world, &Probe::new(dt)).unwrap();
    let (name, unit) = (structure.name(), f64::from(settings.length_unit));
    println!(
        "{name} at {hz} Hz: radius 1 {:+.1e} (noise {:.1e}), {:.4}/s, at rest {:.1e} m/s",
        found.radius - 1.0,
        found.noise,
        found.growth,
        rest.speed
    );
    assert!(rest.moved < 0.1 * unit, "{name} at {hz} Hz: {} m off where it was put", rest.moved);
    assert!(rest.speed < 1e-4 * unit, "{name} at {hz} Hz: {} m/s", rest.speed);
    assert_eq!(found.verdict(), Verdict::Stable, "{name} at {hz} Hz grows by {:.3}/s", found.growth);
}

/// Friction at every point.
fn points() -> Settings {
    Settings::default().with_friction_model(FrictionModel::Point)
}

fn passes(substeps: u32, iterations: u32) -> Settings {
    Settings::default().with_substeps(substeps).with_iterations(iterations)
}

/// For a world whose bodies measure centimetres.
fn centimetres() -> Settings {
    Settings::default().with_length_unit(0.01)
}

/// A test of its own for each structure, with the settings and the rate [Hz] it stands at.
macro_rules! nothing_grows {
    ($($(#[$about:meta])* $name:ident: $structure:expr, $settings:expr, $hz:expr;)*) => {
        mod nothing_grows {
            use super::*;
            $(
                $(#[$about])*
                #[test]
                fn $name() {
                    stand($structure, $settings, $hz);
                }
            )*
        }
    };
}

nothing_grows! {
    in_a_tower_of_2: Standing::Tower(2), Settings::default(), 60.0;
    in_a_tower_of_5: Standing::Tower(5), Settings::default(), 60.0;
    /// Seen before: 0.6/s from 10 boxes on, leaning.
    in_a_tower_of_10: Standing::Tower(10), Settings::default(), 60.0;
    in_a_tower_of_20: Standing::Tower(20), Settings::default(), 60.0;
    /// Seen before: 0.45/s.
    in_a_tower_at_30_hz: Standing::Tower(15), Settings::default(), 30.0;
    in_a_tower_at_120_hz: Standing::Tower(15), Settings::default(), 120.0;
    with_friction_at_points_in_a_tower_of_3: Standing::Tower(3), points(), 60.0;
    /// Seen before: 0.58/s, and it never came to rest.
    with_friction_at_points_in_a_tower_of_10: Standing::Tower(10), points(), 60.0;
    /// Sequential impulses. Seen before: 0.62/s.
    with_1_substep_of_8_iterations: Standing::Tower(10), passes(1, 8), 60.0;
    with_8_substeps: Standing::Tower(10), passes(8, 1), 60.0;
    /// The load that a box bears may come in many ways here. Seen before: points let go and took hold.
    in_a_pyramid_of_5_rows: Standing::Pyramid(5), Settings::default(), 60.0;
    /// Seen before: 0.37/s.
    in_a_pyramid_of_8_rows: Standing::Pyramid(8), Settings::default(), 60.0;
    /// Seen before: it never came to rest.
    in_a_wall: Standing::Wall { width: 6, height: 4 }, Settings::default(), 60.0;
    /// Seen before: 0.28/s.
    on_a_light_box: Standing::Light(1000.0), Settings::default(), 60.0;
    /// At a hundredth of the size, in a world whose length unit is as small. Seen before: it fell within 15
    /// s.
    in_a_tower_of_centimetres: Standing::Tower(10), centimetres(), 60.0;
}
