//! Small swings of a double pendulum: two bodies of mass m and moment I on massless rods of length l.
//!
//! The kinetic energy has the matrix ((2 m l² + I, m l²), (m l², m l² + I)) in the rates of both angles, the
//! potential one diag(2, 1) m g l. For I = 0 the frequencies are w² = (2 -+ sqrt 2) g / l.

use crate::cases::case::{Case, Outcome, Setting};
use crate::cases::rig::{DOWN, G, Rig, lump, turned};
use crate::cases::watch::Passages;
use backstop::BodyDesc;
use backstop::Error;
use backstop::{Frame, JointDesc};
use glam::{DVec3, Vec3};
use std::f64::consts::TAU;

const FORMULA: &str = "det(K - w² M) = 0; w² = (2 -+ sqrt 2) g / l for point masses";

pub(in crate::cases) const CASES: &[Case] = &[
    Case {
        name: "double-pendulum-slow",
        about: "a double pendulum swings with both rods to the same side: its period",
        formula: FORMULA,
        unit: "s",
        bar: 1e-3,
        measure: |setting| mode(setting, -1.0),
    },
    Case {
        name: "double-pendulum-fast",
        about: "the same with the rods to opposite sides",
        formula: FORMULA,
        unit: "s",
        bar: 2e-3,
        measure: |setting| mode(setting, 1.0),
    },
];

const LENGTH: f64 = 1.0;
/// Moment of inertia of each mass of 1 kg about its own centre [kg m²].
const INERTIA: f64 = 0.02;
/// Of the upper rod [rad].
const SWING: f64 = 0.02;

fn mode(setting: &Setting, sign: f64) -> Result<Outcome, Error> {
    let square = LENGTH * LENGTH;
    let [a, b, c] = [2.0 * square + INERTIA, square, square + INERTIA];
    let pull = G * LENGTH;
    // (2 k - w² a)(k - w² c) - w⁴ b² = 0.
    let (lead, middle, last) = (a * c - b * b, pull * (a + 2.0 * c), 2.0 * pull * pull);
    let squared = (middle + sign * (middle * middle - 4.0 * lead * last).sqrt()) / (2.0 * lead);
    let lower = (2.0 * pull - squared * a) / (squared * b) * SWING;
    let want = TAU / squared.sqrt();
    let mut rig = Rig::new(setting, DOWN)?;
    let mut last = (rig.add(&BodyDesc::fixed())?, DVec3::ZERO);
    let mut masses = Vec::new();
    for angle in [SWING, lower] {
        let turn = turned(DVec3::Z, angle);
        let place = last.1 + turn * DVec3::NEG_Y * LENGTH;
        let mass = lump(1.0, DVec3::splat(INERTIA)).with_position(place);
        let mass = rig.add(&mass.with_rotation(turn.as_quat().normalize()))?;
        let frames = [Frame::default(), Frame::at(Vec3::Y * LENGTH as f32)];
        rig.world.add_joint(&JointDesc::ball([last.0, mass], frames))?;
        masses.push(mass);
        last = (mass, place);
    }
    let mut passages = Passages::default();
    rig.until(2.5 * want, |rig| {
        passages.see(rig.time, rig.place(masses[0])?.x);
        Ok(passages.times.len() == 3)
    })?;
    Ok(Outcome::of(want, passages.period()))
}
