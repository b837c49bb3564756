//! Small worlds that each show one thing that backstop does. A sample is one file of at most sixty lines
//! against the public interface, with a test of what it shows: copy it into your own program and go on from
//! there. `cargo backstop testbed` shows them all.

#![allow(
    clippy::disallowed_methods,
    reason = "samples read as a game would write them; no bit of theirs is compared between machines"
)]

pub mod car;
pub mod parts;
mod sample;
pub mod terrain;
pub mod walker;

pub use sample::{Controls, Running, Sample, Tick};

/// Declares the modules of all samples, and [`SAMPLES`] from them.
macro_rules! samples {
    ($($(#[$doc:meta])* $group:ident: $($name:ident),+;)*) => {
        $($(#[$doc])* pub mod $group { $(pub mod $name;)+ })*

        /// All samples, by group.
        pub const SAMPLES: &[Sample] = &[$($(
            Sample {
                name: stringify!($name),
                group: stringify!($group),
                source: include_str!(concat!(stringify!($group), "/", stringify!($name), ".rs")),
                start: || Ok(Box::new($group::$name::start()?)),
            },
        )+)*];
    };
}

samples! {
    /// Bodies on top of each other.
    stacking:
        arch, coins, dominoes, heap, house_of_cards, jenga, overhang, planks, pyramid, rocks, tower, wall;
    /// Each kind of joint by itself.
    joints:
        breaking, bridge, cones, gears, hinges, motors, net, pendulums, pulley, rack, rope, screw, sliders,
        springboard, springs;
    /// Bodies which joints and motors move.
    machines:
        conveyor, crane, crank, drawbridge, lift, marble_run, newtons_cradle, seesaw, trebuchet, water_wheel,
        windmill, wrecking_ball;
    /// Parts of games.
    games:
        billiards, bonded_wall, bowling, chain_links, digging, doors, explosion, galton, grab, gravity_gun,
        labyrinth, one_way, seams, voxels;
    /// Characters that walk, and figures that fall.
    characters:
        stairs, slopes, platforms, crates, crowd, ragdoll, hundred_ragdolls, ragdoll_stairs, crouch, pose,
        knocked_down;
    /// Vehicles.
    vehicles:
        car, car_on_hills, trailer, train, tank, hovercraft, loop_the_loop, boat, ray_car;
    /// Fast bodies.
    continuous:
        steel_bullets, blades, fast_room, second_impacts, bullet_time, modes, hills;
    /// Surfaces and masses, against formulas.
    materials:
        belts, bounce, combine, friction, racket, rolling, soft_ground, tops;
    /// Calls of a world beside its step.
    engine:
        budget, far_away, filters, hits, kinds, level_of_detail, orbits, prediction, radar, shape_cast,
        sleeping;
}
