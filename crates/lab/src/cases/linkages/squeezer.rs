//! Andrews' squeezing mechanism: seven bodies in a plane, ten hinges, three loops, driven by a constant
//! torque against a spring. Data and reference: W. Schiehlen, *Multibody Systems Handbook*, 1990; E. Hairer
//! and G. Wanner, *Solving Ordinary Differential Equations II*, 1991, VII.7. The IVP test set has the angle
//! of the crank after 0.03 s to 15 digits, which a Runge-Kutta method over the equations in seven angles
//! confirms.
//!
//! Here lengths are a hundred times and times 200 times as long, which changes no angle.

use super::hinge;
use crate::cases::case::{Case, Outcome, Setting};
use crate::cases::rig::{Rig, lump, tilted};
use crate::cases::watch::Turns;
use backstop::BodyDesc;
use backstop::BodyHandle;
use backstop::Error;
use glam::{DVec2, DVec3, Vec3};

pub(in crate::cases) const CASES: &[Case] = &[Case {
    name: "squeezer",
    about: "Andrews' squeezing mechanism, scaled to 6 s: the angle that its crank has turned by",
    formula: "15.8724850863132 rad (IVP test set)",
    unit: "rad",
    bar: 0.01,
    measure: squeezer,
}];

/// Angle at the end less that at the start [rad].
const TURNED: f64 = 15.810_771_196_299_04 + 0.061_713_890_014_276_45;
/// By how much lengths and times are scaled.
const LONGER: f64 = 100.0;
const SLOWER: f64 = 200.0;

/// Fixed points A, B and C [m].
const A: DVec2 = DVec2::new(-0.06934, -0.00227);
const B: DVec2 = DVec2::new(-0.03635, 0.03273);
const C: DVec2 = DVec2::new(0.014, 0.072);
/// Torque on the crank [N m], stiffness [N/m] and length of the spring from C [m].
const TORQUE: f64 = 0.033;
const STIFFNESS: f64 = 4530.0;
const SPRING: f64 = 0.07785;

/// The bodies: mass [kg], moment about the centre [kg m²], angle [rad], and the centre from the point that it
/// turns about, in its own axes [m].
const BODIES: [(f64, f64, f64, DVec2); 7] = [
    (0.04325, 2.194e-6, BETA, DVec2::new(0.00092, 0.0)),
    (0.00365, 4.410e-7, BETA, DVec2::new(-0.0115, 0.0)),
    (0.02373, 5.255e-6, GAMMA, DVec2::new(0.01043, -0.01874)),
    (0.00706, 5.667e-7, PHI + DELTA, DVec2::new(0.0, -0.00579)),
    (0.07050, 1.169e-5, DELTA, DVec2::new(0.02308, 0.00916)),
    (0.00706, 5.667e-7, OMEGA + EPSILON, DVec2::new(0.00579, 0.0)),
    (0.05498, 1.912e-5, EPSILON, DVec2::new(-0.00449, -0.01228)),
];
const BETA: f64 = -0.061_713_890_014_276_45;
const GAMMA: f64 = 0.455_279_819_163_070_4;
const PHI: f64 = 0.222_668_390_165_885_88;
const DELTA: f64 = 0.487_364_979_543_842_55;
const OMEGA: f64 = -0.222_668_390_165_885_88;
const EPSILON: f64 = 1.230_547_444_549_821_2;

/// A vector in the axes of a body.
fn along(angle: f64, x: f64, y: f64) -> DVec2 {
    DVec2::from_angle(angle).rotate(DVec2::new(x, y))
}

fn squeezer(setting: &Setting) -> Result<Outcome, Error> {
    let mut rig = Rig::new(setting, Vec3::ZERO)?;
    let ground = rig.add(&BodyDesc::fixed())?;
    let crank = along(BETA, 0.007, 0.0);
    // Where G and H are, and E, in which four bodies meet.
    let g = A + along(DELTA, 0.04, 0.0);
    let h = A + along(EPSILON, 0.0, -0.04);
    let meet = crank - along(BETA, 0.028, 0.0);
    let turn_about = [DVec2::ZERO, crank, B, g, A, h, A];
    let mut bodies: Vec<BodyHandle> = Vec::new();
    for ((mass, moment, angle, centre), about) in BODIES.into_iter().zip(turn_about) {
        let place = (about + along(angle, centre.x, centre.y)) * LONGER;
        let body = lump(mass, DVec3::splat(moment * LONGER * LONGER)).with_position(place.extend(0.0));
        bodies.push(rig.add(&body.with_rotation(tilted(DVec3::Z, angle)))?);
    }
    let [k1, k2, k3, k4, k5, k6, k7] = bodies[..] else { return Ok(Outcome::of(TURNED, f64::NAN)) };
    for (pair, at) in [
        ([ground, k1], DVec2::ZERO),
        ([ground, k3], B),
        ([ground, k5], A),
        ([ground, k7], A),
        ([k1, k2], crank),
        ([k5, k4], g),
        ([k7, k6], h),
        ([k2, k3], meet),
        ([k2, k4], meet),
        ([k2, k6], meet),
    ] {
        hinge(&mut rig, pair, (at * LONGER).extend(0.0), Vec3::Z)?;
    }
    // Torques scale with lengths squared over times squared.
    let scale = (LONGER / SLOWER).powi(2);
    let hook = DVec2::new(0.02, -0.018) - BODIES[2].3;
    let mut turns = Turns::default();
    let crank_angle = |rig: &Rig| -> Result<f64, Error> {
        let axis = rig.turn(k1)? * DVec3::X;
        Ok(libm::atan2(axis.y, axis.x))
    };
    turns.see(crank_angle(&rig)?);
    let end = 0.03 * SLOWER;
    let mut before = (0.0, 0.0);
    while rig.time < end {
        before = (rig.time, turns.gone);
        rig.world.add_torque(k1, Vec3::Z * (TORQUE * scale) as f32)?;
        let at = rig.place(k3)? + rig.turn(k3)? * (hook * LONGER).extend(0.0);
        let way = at - (C * LONGER).extend(0.0);
        let stretch = way.length() - SPRING * LONGER;
        let pull = -way.normalize() * (STIFFNESS / (SLOWER * SLOWER) * stretch);
        rig.world.add_force_at(k3, pull.as_vec3(), at)?;
        rig.step()?;
        turns.see(crank_angle(&rig)?);
    }
    // The crank turns fast at the end, which is between two steps.
    let share = (end - before.0) / (rig.time - before.0);
    Ok(Outcome::of(TURNED, before.1 + share * (turns.gone - before.1)))
}
