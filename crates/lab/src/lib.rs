//! Whether rest is stable: the linearised map of a step about a world at rest, and its eigenvalues.
//!
//! At rest a step maps the state of the world (poses, velocities, and the impulses that it starts the next
//! step with) to itself. The derivative of that map says what becomes of a small displacement from rest: a
//! mode whose eigenvalue has a modulus above 1 grows in every step until something falls, however slowly.
//! `docs/stability.md` says how it is computed and how exact it is.
//!
//! ```
//! use backstop_lab::{Probe, Verdict, find_rest, stability};
//! use backstop_scene::Standing;
//! use backstop::Settings;
//!
//! # fn main() -> Result<(), backstop::Error> {
//! let (mut world, _) = Standing::Tower(2).build(Settings::default(), 1000.0)?;
//! let dt = 1.0 / 60.0;
//! find_rest(&mut world, dt, 5.0)?;
//! let found = stability(&world, &Probe::new(dt))?;
//! assert_eq!(found.verdict(), Verdict::Stable);
//! # Ok(())
//! # }
//! ```

#[cfg(doctest)]
#[doc = include_str!("../README.md")]
mod readme {}

mod arnoldi;
pub mod cases;
pub mod comparison;
pub mod envelope;
mod growth;
pub mod impacts;
mod map;
mod meter;
pub mod methods;
pub mod problem;
#[cfg(test)]
#[path = "../../../src/random.rs"]
mod random;
pub mod reduction;
mod rest;
pub mod retroactive;
pub mod simbench;
pub mod steppers;
pub mod structures;
pub mod system;
pub mod tosses;
pub mod trade;
mod world_solver;

pub use growth::growth;
pub use meter::{Accuracy, IslandAccuracy, LabWorld, Measures};
use meter::{meter_of, put_meter};
pub use rest::{Rest, find_rest};
pub use world_solver::{Guess, MethodOptions, SolverReport, WorldMethod, WorldSolver};

use arnoldi::{Ritz, arnoldi, noise, norm};
use backstop::BodyHandle;
use backstop::Error;
use backstop::World;
use backstop::limits::{positive, within};
use glam::DVec3;
use map::StepMap;

/// How the map is measured.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Probe {
    /// Length of a step [s].
    pub dt: f32,
    /// Time that the map spans [s]: the longer, the better eigenvalues near 1 are resolved. Default 2.
    pub horizon: f32,
    /// The greatest component of the displacement of the state: lengths in length units, angles in radians,
    /// velocities in length units per time in which a body falls one, impulses in those of the weight of a
    /// hundred bodies over a substep. Default 5e-5: well above the rounding of poses (1e-7), and below what
    /// lifts a contact off.
    pub displacement: f64,
    /// Dimension of the Krylov space, of which the leading modes are found: at least 1. Default 30.
    pub dimension: usize,
    /// Seed of the first direction. Default 1.
    pub seed: u64,
}

impl Probe {
    /// With the defaults.
    pub fn new(dt: f32) -> Probe {
        Probe { dt, horizon: 2.0, displacement: 5e-5, dimension: 30, seed: 1 }
    }

    /// Steps of the horizon.
    fn steps(&self) -> u32 {
        (self.horizon / self.dt).round().max(1.0) as u32
    }

    fn validate(&self) -> Result<(), Error> {
        positive("dt", self.dt)?;
        positive("horizon", self.horizon)?;
        within("steps of the horizon", self.horizon / self.dt, 0.5, 1e6, "at most a million")?;
        within("displacement", self.displacement as f32, 1e-9, 1.0, "in 1e-9..=1")?;
        within("dimension", self.dimension as f32, 1.0, 1000.0, "in 1..=1000").map(drop)
    }
}

/// Modes of the map about rest.
#[derive(Clone, Debug, PartialEq)]
pub struct Stability {
    /// Number of components of the state.
    pub unknowns: usize,
    /// Length of a step [s].
    pub dt: f32,
    /// Steps that the map spans.
    pub steps: u32,
    /// Spectral radius per step: how the leading mode grows, over ten horizons or, if it hardly does, over
    /// forty.
    pub radius: f64,
    /// Uncertainty of `radius` by rounding and nonlinearity, per step: measured from the same mode at half
    /// the displacement and from horizon to horizon.
    pub noise: f64,
    /// The same as a rate [1/s].
    pub growth: f64,
    /// The leading modes, the greatest modulus first; of a complex pair only one.
    pub modes: Vec<Mode>,
    /// The most contact points that were loaded either at rest or at the end of the map, but not at both. If
    /// there are any, points lost or gained load, and the map is not smooth there.
    pub changed: usize,
}

/// The verdict on the spectral radius, given its noise.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Verdict {
    /// No mode grows by more than 1e-5 a step plus the growth that noise could hide.
    Stable,
    /// A mode grows by more than that.
    Unstable,
    /// Neither, and the noise would hide a growth by e in 20 s.
    Unclear,
}

impl Stability {
    /// Which of the three.
    pub fn verdict(&self) -> Verdict {
        if self.radius > 1.0 + 1e-5 + 3.0 * self.noise {
            Verdict::Unstable
        } else if 3.0 * self.noise > 0.05 * f64::from(self.dt) {
            Verdict::Unclear
        } else {
            Verdict::Stable
        }
    }
}

/// A mode of the map.
#[derive(Clone, Debug, PartialEq)]
pub struct Mode {
    /// Modulus of its eigenvalue, per step.
    pub modulus: f64,
    /// Growth rate: the logarithm of the modulus per second [1/s].
    pub growth: f64,
    /// [Hz]
    pub frequency: f64,
    /// Distance of the mapped mode from a multiple of the mode, relative to the mode.
    pub residual: f64,
    /// Shares of the displacement: across gravity, along it, and turning.
    pub shares: [f64; 3],
    /// The bodies that it displaces most, the most displaced first; their greatest displacement is 1 length
    /// unit or rad.
    pub bodies: Vec<ModeBody>,
}

/// How a mode displaces a body.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ModeBody {
    /// Which.
    pub body: BodyHandle,
    /// Displacement of its centre of mass [length units].
    pub linear: DVec3,
    /// Its rotation [rad].
    pub angular: DVec3,
}

/// Number of bodies listed with a mode.
const TOLD: usize = 5;
/// Number of modes listed.
const MODES: usize = 6;
/// Horizons over which the leading mode is followed.
const ROUNDS: usize = 10;
/// Horizons over which it is followed at a time if it hardly grows.
const LONGER: u32 = 4;

/// Linearises the step about the world's state, which should be one of rest, and finds the leading modes. The
/// world stays as it is; sleeping is off in the copies that step.
///
/// # Errors
/// If a number of the probe is out of range, or the world can't be copied.
pub fn stability(world: &World, probe: &Probe) -> Result<Stability, Error> {
    probe.validate()?;
    let mut map = StepMap::new(world, probe)?;
    let steps = probe.steps();
    let (start, rounding) = start(&mut map, probe.seed, steps)?;
    let found = arnoldi(start, probe.dimension, 3.0 * rounding, |v| map.apply(v, steps, 1.0))?;
    let per_step = |modulus: f64| modulus.powf(1.0 / f64::from(steps));
    let mut modes = Vec::new();
    for ritz in found.iter().filter(|ritz| ritz.value.im >= 0.0).take(MODES) {
        let modulus = per_step(ritz.modulus());
        let growth = modulus.ln() / f64::from(probe.dt);
        let (shares, bodies) = map.lives(&ritz.re);
        let frequency = frequency(&mut map, ritz, probe)?;
        modes.push(Mode { modulus, growth, frequency, residual: ritz.residual, shares, bodies });
    }
    let Some(first) = found.first() else {
        return Ok(Stability {
            unknowns: map.unknowns(),
            dt: probe.dt,
            steps,
            radius: 0.0,
            noise: 0.0,
            growth: f64::NEG_INFINITY,
            modes,
            changed: 0,
        });
    };
    let k = f64::from(steps);
    let (short, off) = follow(&mut map, &first.re, steps)?;
    let (rate, noise) = if short * f64::from(LONGER) < 1.0 {
        // A mode that hardly grows stays small for longer, so it can be followed for longer and measured more
        // finely. The first horizon of each run is left out: where contacts were found is not part of the
        // state, so the response in the first moments is not growth.
        let (long, more) = follow(&mut map, &first.re, LONGER * steps)?;
        let later = k * f64::from(LONGER - 1);
        ((long - short) / later, (off + more) / later)
    } else {
        (short / k, off / k)
    };
    let radius = rate.exp();
    Ok(Stability {
        unknowns: map.unknowns(),
        dt: probe.dt,
        steps,
        radius,
        noise: noise * radius,
        growth: rate / f64::from(probe.dt),
        modes,
        changed: map.changed(),
    })
}

/// A random direction after two horizons, and the error of the map along it by rounding and nonlinearity. Two
/// horizons leave the lasting modes, which are what is looked for; a random direction itself displaces every
/// body on its own, which lifts contact points off.
fn start(map: &mut StepMap, seed: u64, steps: u32) -> Result<(Vec<f64>, f64), Error> {
    let mut random = noise(seed);
    let mut v: Vec<f64> = (0..map.unknowns()).map(|_| random()).collect();
    for _ in 0..2 {
        v = unit(map.apply(&v, steps, 1.0)?).0;
    }
    let (whole, half) = (map.apply(&v, steps, 1.0)?, map.apply(&v, steps, 0.5)?);
    let off: Vec<f64> = whole.iter().zip(&half).map(|(a, b)| a - b).collect();
    // Half a displacement has twice the rounding.
    Ok((v, norm(&off) / 5.0_f64.sqrt()))
}

/// Logarithm of the growth of a direction over `steps` steps, as the mean of several such spans, and its
/// uncertainty.
fn follow(map: &mut StepMap, direction: &[f64], steps: u32) -> Result<(f64, f64), Error> {
    // Remnants of other modes, which the Krylov space left in it, die out first.
    let start = unit(map.apply(direction, steps, 1.0)?).0;
    let mut rate = |part: f64| {
        let (mut v, mut logs) = (start.clone(), Vec::new());
        for _ in 0..ROUNDS {
            let (next, length) = unit(map.apply(&v, steps, part)?);
            logs.push(length.max(f64::MIN_POSITIVE).ln());
            v = next;
        }
        let mean = logs.iter().sum::<f64>() / ROUNDS as f64;
        let spread = logs.iter().map(|x| (x - mean).powi(2)).sum::<f64>() / ROUNDS as f64;
        Ok::<_, Error>((mean, (spread / ROUNDS as f64).sqrt()))
    };
    let ((whole, error), (half, _)) = (rate(1.0)?, rate(0.5)?);
    Ok((whole, error.max((whole - half).abs())))
}

fn unit(mut v: Vec<f64>) -> (Vec<f64>, f64) {
    let length = norm(&v);
    if length > 0.0 {
        v.iter_mut().for_each(|x| *x /= length);
    }
    (v, length)
}

/// Frequency of a mode [Hz]: the angle by which the horizon rotates it, plus the number of whole turns that
/// the angle of a single step implies.
fn frequency(map: &mut StepMap, ritz: &Ritz, probe: &Probe) -> Result<f64, Error> {
    let dot = |a: &[f64], b: &[f64]| a.iter().zip(b).map(|(x, y)| x * y).sum::<f64>();
    let re = map.apply(&ritz.re, 1, 1.0)?;
    let im = map.apply(&ritz.im, 1, 1.0)?;
    // The mode is re + i im; its image, projected back on it.
    let over = dot(&ritz.re, &re) + dot(&ritz.im, &im);
    let across = dot(&ritz.re, &im) - dot(&ritz.im, &re);
    let steps = f64::from(probe.steps());
    let (about, exact) = (across.atan2(over) * steps, ritz.value.arg());
    let turns = ((about - exact) / std::f64::consts::TAU).round();
    let angle = (exact + turns * std::f64::consts::TAU) / steps;
    Ok(angle.abs() / (std::f64::consts::TAU * f64::from(probe.dt)))
}
