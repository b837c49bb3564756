//! A mass on a massless rod.

use super::case::{Case, Outcome, Setting};
use super::rig::{DOWN, G, Rig, lump, stretch, turned};
use super::watch::Passages;
use backstop::BodyDesc;
use backstop::BodyHandle;
use backstop::Error;
use backstop::{Frame, JointDesc};
use glam::{DVec3, Vec3};
use std::f64::consts::TAU;

const FORMULA: &str = "T = 4 K(sin(th / 2)) sqrt(I / (m g l))";
const ABOUT: &str = "a pendulum let go at this angle from the lowest point: its period";

const fn period_at(name: &'static str, measure: fn(&Setting) -> Result<Outcome, Error>) -> Case {
    Case { name, about: ABOUT, formula: FORMULA, unit: "s", bar: 1e-3, measure }
}

pub(super) const CASES: &[Case] = &[
    period_at("pendulum-10", |setting| period(setting, 10.0)),
    period_at("pendulum-45", |setting| period(setting, 45.0)),
    period_at("pendulum-90", |setting| period(setting, 90.0)),
    period_at("pendulum-120", |setting| period(setting, 120.0)),
    period_at("pendulum-150", |setting| period(setting, 150.0)),
    period_at("pendulum-170", |setting| period(setting, 170.0)),
    period_at("pendulum-179", |setting| period(setting, 179.0)),
    Case {
        name: "pendulum-energy",
        about: "a pendulum let go at 90 degrees: what its energy is off by after 60 s, as a share of m g l",
        formula: "0",
        unit: "",
        bar: 0.01,
        measure: energy,
    },
];

const LENGTH: f64 = 1.0;
/// Moment of inertia of the 1 kg mass about its own centre [kg m²].
const INERTIA: f64 = 0.02;

fn pendulum(setting: &Setting, degrees: f64) -> Result<(Rig, BodyHandle), Error> {
    let mut rig = Rig::new(setting, DOWN)?;
    let pivot = rig.add(&BodyDesc::fixed())?;
    let turn = turned(DVec3::Z, degrees.to_radians());
    let mass = lump(1.0, DVec3::splat(INERTIA));
    let mass = mass.with_position(turn * DVec3::NEG_Y * LENGTH).with_rotation(turn.as_quat().normalize());
    let mass = rig.add(&mass)?;
    let frames = [Frame::default(), Frame::at(Vec3::Y * LENGTH as f32)];
    rig.world.add_joint(&JointDesc::ball([pivot, mass], frames))?;
    Ok((rig, mass))
}

fn period(setting: &Setting, degrees: f64) -> Result<Outcome, Error> {
    let (mut rig, mass) = pendulum(setting, degrees)?;
    let small = TAU * ((LENGTH * LENGTH + INERTIA) / (G * LENGTH)).sqrt();
    let want = small * stretch(degrees.to_radians());
    let mut passages = Passages::default();
    rig.until(2.5 * want, |rig| {
        passages.see(rig.time, rig.place(mass)?.x);
        Ok(passages.times.len() == 3)
    })?;
    Ok(Outcome::of(want, passages.period()))
}

fn energy(setting: &Setting) -> Result<Outcome, Error> {
    let (mut rig, _) = pendulum(setting, 90.0)?;
    let before = rig.world.energy();
    rig.run_to(60.0)?;
    Ok(Outcome::zero((rig.world.energy() - before) / (G * LENGTH)))
}
