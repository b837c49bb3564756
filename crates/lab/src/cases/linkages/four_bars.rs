//! A row of four-bar linkages side by side (A. Avello and others; problem A02 of the benchmark library of the
//! IFToMM Technical Committee for Multibody Dynamics): N couplers on N + 1 cranks, all rods of 1 m and 1 kg,
//! started upright with 1 m/s. It passes places in which all rods are in line and each loop could fold.
//!
//! While the loops are parallelograms it is a pendulum, whose moment is (N + 1) / 3 + N, and whose potential
//! is g ((N + 1) / 2 + N) cos th: w² = 1 + 2 K / J (1 - cos th).

use super::hinge;
use crate::cases::case::{Case, Outcome, Setting};
use crate::cases::rig::{DOWN, G, Rig, rod, tilted};
use crate::cases::watch::Turns;
use backstop::BodyDesc;
use backstop::Error;
use glam::{DVec3, Vec3};
use std::f64::consts::{FRAC_PI_2, PI};

pub(in crate::cases) const CASES: &[Case] = &[
    Case {
        name: "four-bars-fall",
        about: "five four-bar linkages side by side fall over from upright: the time until they hang",
        formula: "T = integral of dth / sqrt(1 + 2 K / J (1 - cos th))",
        unit: "s",
        bar: 0.01,
        measure: |setting| four_bars(setting, false),
    },
    Case {
        name: "four-bars-energy",
        about: "the same: what their energy is off by after 10 s, as a share of the kinetic energy below",
        formula: "0",
        unit: "of E",
        bar: 1e-3,
        measure: |setting| four_bars(setting, true),
    },
];

const LOOPS: u32 = 5;

/// Moment of inertia about the ground [kg m²], and weight times the height of its centre [N m].
fn pendulum() -> [f64; 2] {
    let n = f64::from(LOOPS);
    [(n + 1.0) / 3.0 + n, G * (0.5 * (n + 1.0) + n)]
}

fn fall_time() -> f64 {
    const PARTS: u32 = 20_000;
    let [moment, pull] = pendulum();
    let rate = |angle: f64| (1.0 + 2.0 * pull / moment * (1.0 - libm::cos(angle))).sqrt();
    let part = PI / f64::from(PARTS);
    (0..PARTS).map(|i| part / rate((f64::from(i) + 0.5) * part)).sum()
}

fn four_bars(setting: &Setting, energy: bool) -> Result<Outcome, Error> {
    let mut rig = Rig::new(setting, DOWN)?;
    let ground = rig.add(&BodyDesc::fixed())?;
    let mut cranks = Vec::new();
    for i in 0..=LOOPS {
        let foot = DVec3::X * f64::from(i);
        let crank = rod(1.0).with_position(foot + DVec3::Y * 0.5);
        let crank = rig.add(&crank.with_velocity(Vec3::X * 0.5, Vec3::NEG_Z))?;
        hinge(&mut rig, [ground, crank], foot, Vec3::Z)?;
        cranks.push(crank);
    }
    for (i, pair) in cranks.windows(2).enumerate() {
        let left = DVec3::new(i as f64, 1.0, 0.0);
        let coupler = rod(1.0).with_position(left + DVec3::X * 0.5);
        let coupler = coupler.with_rotation(tilted(DVec3::Z, FRAC_PI_2)).with_velocity(Vec3::X, Vec3::ZERO);
        let coupler = rig.add(&coupler)?;
        hinge(&mut rig, [pair[0], coupler], left, Vec3::Z)?;
        hinge(&mut rig, [pair[1], coupler], left + DVec3::X, Vec3::Z)?;
    }
    let [moment, pull] = pendulum();
    let before = rig.world.energy();
    let mut turns = Turns::default();
    turns.see(0.0);
    let (mut then, mut gone) = (0.0, 0.0);
    let hangs = rig.until(if energy { 10.0 } else { 4.0 }, |rig| {
        (then, gone) = (rig.time - f64::from(rig.dt), turns.gone);
        let axis = rig.turn(cranks[0])? * DVec3::Y;
        turns.see(libm::atan2(axis.x, axis.y));
        Ok(!energy && turns.gone >= PI)
    })?;
    if energy {
        return Ok(Outcome::zero((rig.world.energy() - before) / (0.5 * moment + 2.0 * pull)));
    }
    let share = (PI - gone) / (turns.gone - gone);
    let measured = if hangs { then + share * (rig.time - then) } else { f64::NAN };
    Ok(Outcome::of(fall_time(), measured))
}
