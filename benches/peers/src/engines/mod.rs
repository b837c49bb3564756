//! An adapter for each engine: one file that takes a scene, one line in [`ALL`].

mod backstop;
#[cfg(feature = "box3d")]
mod box3d;
pub(crate) mod content;
#[cfg(feature = "jolt")]
mod jolt;
#[cfg(feature = "physx")]
mod physx;
#[cfg(feature = "rapier")]
mod rapier;

use ::backstop::glam::Vec3;
use backstop_lab::envelope::State;
use backstop_scene::Scene;
use content::Meshes;

/// An engine with a scene in it.
pub(crate) trait Engine {
    /// Advances by `dt` [s].
    fn step(&mut self, dt: f32) -> anyhow::Result<()>;

    /// Sets the velocities of a kinematic body, by its index in the scene.
    fn drive(&mut self, body: usize, linear: Vec3, angular: Vec3) -> anyhow::Result<()> {
        anyhow::bail!("this adapter drives no body: {body} at {linear}, {angular}")
    }

    /// State of a body, by its index in the scene: that of its origin, with the velocity of its centre of
    /// mass.
    fn state(&self, body: usize) -> State;

    /// How many dynamic bodies are asleep.
    fn asleep(&self) -> usize;
}

/// Which bodies are kept from passing through others.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) enum Continuous {
    /// None.
    Off,
    /// Dynamic bodies, as far as the engine does it by default: in most against static bodies.
    On,
    /// Against moving bodies too, where an engine has a switch for that.
    All,
}

/// Settings of an engine; all others stay at their defaults, except that nothing damps motion.
#[derive(Clone, Copy, Debug)]
#[cfg_attr(
    not(any(feature = "box3d", feature = "rapier", feature = "jolt", feature = "physx")),
    allow(dead_code, reason = "backstop alone has no limit of speeds, and keeps to all ranges")
)]
pub(crate) struct Config {
    pub(crate) threads: usize,
    /// How many times the engine's default number of substeps, or its other count of effort.
    pub(crate) effort: u32,
    pub(crate) continuous: Continuous,
    pub(crate) sleeping: bool,
    /// Length of a typical body [m].
    pub(crate) length_unit: f32,
    /// The limit of speeds, if it is not the engine's default [m/s].
    pub(crate) max_speed: Option<f32>,
    /// The limit of spins [rad/s].
    #[cfg_attr(not(feature = "jolt"), allow(dead_code, reason = "the adapter of Jolt alone sets it"))]
    pub(crate) max_spin: f32,
    /// Whether hinges keep to their ranges.
    pub(crate) hinge_ranges: bool,
}

pub(crate) type Build = fn(&Scene, &Meshes, &Config) -> anyhow::Result<Box<dyn Engine>>;

/// An engine that is compiled into this program.
pub(crate) struct Entry {
    /// As it is called on the command line and in records.
    pub(crate) name: &'static str,
    pub(crate) build: Build,
    /// Its version and how it was built, as far as that isn't the program's own.
    pub(crate) version: &'static str,
}

/// The engines in this program.
pub(crate) const ALL: &[Entry] = &[
    Entry { name: "backstop", build: backstop::build, version: "0.1.0" },
    #[cfg(feature = "box3d")]
    Entry { name: "box3d", build: box3d::build, version: "0.1.0 (box3d-sys 0.1.16)" },
    #[cfg(feature = "rapier")]
    Entry { name: rapier::NAME, build: rapier::build, version: "0.36.1" },
    #[cfg(feature = "jolt")]
    Entry { name: "jolt", build: jolt::build, version: jolt::VERSION },
    #[cfg(feature = "physx")]
    Entry { name: "physx-tgs", build: physx::tgs, version: "5.1.3 (physx-sys 0.11.5)" },
    #[cfg(feature = "physx")]
    Entry { name: "physx-pgs", build: physx::pgs, version: "5.1.3 (physx-sys 0.11.5)" },
];

/// Names of all engines, in the order of reports, with the feature that each needs.
pub(crate) const FEATURES: &[(&str, &str)] = &[
    ("backstop", ""),
    ("box3d", "box3d"),
    ("rapier", "rapier"),
    ("rapier-simd8", "rapier-simd8"),
    ("rapier-parallel", "rapier-parallel"),
    ("jolt", "jolt"),
    ("physx-tgs", "physx"),
    ("physx-pgs", "physx"),
];

/// An engine of this program by its name.
pub(crate) fn find(name: &str) -> Option<&'static Entry> {
    ALL.iter().find(|entry| entry.name == name)
}
