//! A block that rocks on its lower edges (G. W. Housner, *The behavior of inverted pendulum structures
//! during earthquakes*, 1963).
//!
//! About an edge `I w' = -m g R sin(al - th)`, with `I = 4/3 m R²`, half diagonal R and `tan al = b / h`.
//! When the other edge strikes, angular momentum about it is kept, and the first edge lifts off.

use crate::cases::case::{Case, Outcome, Setting};
use crate::cases::rig::{DOWN, G, Rig, dynamic, surface, tilted};
use backstop::Error;
use backstop::Geometry;
use glam::{DVec3, Vec3};

pub(in crate::cases) const CASES: &[Case] = &[
    Case {
        name: "rocking-time",
        about: "a block is let go on its edge, halfway to where it would fall over: the time until the other \
            edge strikes",
        formula: "t = integral of dth / sqrt(3 g / (2 R) (cos(al - th0) - cos(al - th)))",
        unit: "s",
        bar: 0.02,
        measure: |setting| rocking(setting, false),
    },
    Case {
        name: "rocking-loss",
        about: "the same: the spin after the strike over that before it, from the next angle of rest",
        formula: "w' / w = 1 - 3/2 sin² al",
        unit: "",
        bar: 0.02,
        measure: |setting| rocking(setting, true),
    },
];

/// Half width and half height [m].
const B: f64 = 0.1;
const H: f64 = 0.4;

/// Time from rest at an angle until the block is upright [s]; th = th0 (1 - s²) removes the singularity.
fn fall_time(start: f64) -> f64 {
    const PARTS: u32 = 10_000;
    let (lean, radius) = (libm::atan(B / H), B.hypot(H));
    let sum: f64 = (0..PARTS)
        .map(|i| {
            let s = (f64::from(i) + 0.5) / f64::from(PARTS);
            let angle = start * (1.0 - s * s);
            let fallen = libm::cos(lean - start) - libm::cos(lean - angle);
            2.0 * start * s / (1.5 * G / radius * fallen).sqrt()
        })
        .sum();
    sum / f64::from(PARTS)
}

fn rocking(setting: &Setting, loss: bool) -> Result<Outcome, Error> {
    let lean = libm::atan(B / H);
    let start = 0.5 * lean;
    let mut rig = Rig::new(setting, DOWN)?;
    let material = surface(1.0, 0.0);
    rig.floor(material)?;
    let half = DVec3::new(B, H, 0.2);
    let turn = tilted(DVec3::Z, start);
    // It stands on the edge at x = -b, and leans to that side.
    let place = DVec3::new(-B, 0.0, 0.0) + turn.as_dquat() * DVec3::new(B, H, 0.0);
    let block = dynamic(Geometry::Box { half_extents: half.as_vec3() }, material, Vec3::ZERO);
    let block = rig.add(&block.with_position(place).with_rotation(turn))?;
    let angle = |rig: &Rig| -> Result<f64, Error> {
        let side = rig.turn(block)? * DVec3::X;
        Ok(libm::atan2(side.y, side.x))
    };
    let mut before = (0.0, start);
    rig.until(2.0, |rig| {
        let now = angle(rig)?;
        let passed = now <= 0.0;
        if !passed {
            before = (rig.time, now);
        }
        Ok(passed)
    })?;
    if !loss {
        // From the last step before, with the spin of the strike.
        let fast = (1.5 * G / B.hypot(H) * (libm::cos(lean - start) - libm::cos(lean))).sqrt();
        return Ok(Outcome::of(fall_time(start), before.0 + before.1 / fast));
    }
    let mut most = 0.0_f64;
    rig.until(2.0, |rig| {
        let now = -angle(rig)?;
        most = most.max(now);
        Ok(now < most - 1e-3)
    })?;
    let fallen = |angle: f64| libm::cos(lean - angle) - libm::cos(lean);
    let sin = libm::sin(lean);
    Ok(Outcome::of(1.0 - 1.5 * sin * sin, (fallen(most) / fallen(start)).sqrt()))
}
