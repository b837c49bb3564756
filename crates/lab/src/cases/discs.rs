//! Discs that spin and roll on the floor.

use super::case::{Case, Outcome, Setting};
use super::rig::{DOWN, G, Rig, dynamic, lump, shape, surface, tilted, turned};
use super::watch::{Turns, threshold};
use backstop::Error;
use backstop::Geometry;
use glam::{DVec3, Vec3};
use std::f64::consts::FRAC_PI_2;

pub(super) const CASES: &[Case] = &[
    Case {
        name: "spinning-disc",
        about: "a disc that spins flat on the floor: the time until it stops, from its spin at a quarter \
            and three quarters of it",
        formula: "t = w R / (2 mu g), borne by points of its rim",
        unit: "s",
        bar: 0.02,
        measure: spinning,
    },
    Case {
        name: "euler-disc",
        about: "a coin rolls on its rim at 20 degrees, its centre at rest: the rate at which it goes round",
        formula: "W² = 4 g / (a sin al)",
        unit: "rad/s",
        bar: 0.05,
        measure: euler,
    },
    Case {
        name: "slide-spin",
        about: "a cylinder slides and spins flat on the floor: R w / v at the end",
        formula: "1 / 0.653 for uniform pressure (Farkas and others 2003), whatever the start",
        unit: "",
        bar: 0.05,
        measure: slide_spin,
    },
    Case {
        name: "upright-hoop",
        about: "a hoop rolls upright and is tilted a little: the speed from which on it does not fall",
        formula: "v² = g R / 4",
        unit: "m/s",
        bar: 0.03,
        measure: |setting| upright(setting, 1.0),
    },
    Case {
        name: "upright-disc",
        about: "the same with a solid disc",
        formula: "v² = g R / 3",
        unit: "m/s",
        bar: 0.03,
        measure: |setting| upright(setting, 0.5),
    },
];

const RADIUS: f64 = 0.5;

fn spinning(setting: &Setting) -> Result<Outcome, Error> {
    const MU: f64 = 0.5;
    const SPIN: f64 = 20.0;
    let mut rig = Rig::new(setting, DOWN)?;
    rig.floor(surface(MU, 0.0))?;
    let disc = dynamic(Geometry::cylinder(0.05, RADIUS as f32), surface(MU, 0.0), Vec3::Y * 0.05);
    let disc = rig.add(&disc.with_velocity(Vec3::ZERO, Vec3::Y * SPIN as f32))?;
    let want = SPIN * RADIUS / (2.0 * MU * G);
    rig.run_to(0.25 * want)?;
    let (then, fast) = (rig.time, rig.spin(disc)?.y);
    rig.run_to(0.75 * want)?;
    let slow = rig.spin(disc)?.y;
    Ok(Outcome::of(want, rig.time + slow * (rig.time - then) / (fast - slow)))
}

fn euler(setting: &Setting) -> Result<Outcome, Error> {
    const THICK: f64 = 0.002;
    let tilt = 20f64.to_radians();
    let (sin, cos) = libm::sincos(tilt);
    let want = (4.0 * G / (RADIUS * sin)).sqrt();
    let mut rig = Rig::new(setting, DOWN)?;
    rig.floor(surface(2.0, 0.0))?;
    // The axis leans towards +x, where the rim touches; it turns about the line to there.
    let (axis, to_rim) = (DVec3::new(sin, cos, 0.0), DVec3::new(cos, -sin, 0.0));
    let spin = to_rim * (-want * sin);
    let velocity = -spin.cross(to_rim * RADIUS - axis * THICK);
    let across = RADIUS * RADIUS / 4.0;
    let disc = lump(1.0, DVec3::new(across, 2.0 * across, across))
        .with_shape(shape(Geometry::cylinder(THICK as f32, RADIUS as f32), surface(2.0, 0.0)))
        .with_position(DVec3::Y * (RADIUS * sin + THICK * cos))
        .with_rotation(tilted(DVec3::Z, -tilt))
        .with_velocity(velocity.as_vec3(), spin.as_vec3());
    let disc = rig.add(&disc)?;
    let mut turns = Turns::default();
    let mut start = 0.0;
    rig.until(2.0, |rig| {
        let axis = rig.turn(disc)? * DVec3::Y;
        turns.see(libm::atan2(-axis.z, axis.x));
        if start == 0.0 {
            start = rig.time;
        }
        Ok(turns.gone.abs() > 18.0)
    })?;
    Ok(Outcome::of(want, turns.gone.abs() / (rig.time - start)))
}

/// The ratio tends to where sliding and spinning slow down by the same share (Z. Farkas, G. Bartels, T. Unger
/// and D. E. Wolf, *Frictional coupling between sliding and spinning motion*, 2003).
fn slide_spin(setting: &Setting) -> Result<Outcome, Error> {
    const THICK: f64 = 0.01;
    let material = surface(0.3, 0.0);
    let mut rig = Rig::new(setting, DOWN)?;
    rig.floor(material)?;
    let across = RADIUS * RADIUS / 4.0;
    let disc = lump(1.0, DVec3::new(across, 2.0 * across, across))
        .with_shape(shape(Geometry::cylinder(THICK as f32, RADIUS as f32), material))
        .with_position(DVec3::Y * THICK);
    // R w is 10 m/s.
    let disc = rig.add(&disc.with_velocity(Vec3::X * 6.0, Vec3::Y * 20.0))?;
    let mut measured = f64::NAN;
    rig.until(10.0, |rig| {
        let (along, spin) = (rig.velocity(disc)?.length(), rig.spin(disc)?.y * RADIUS);
        let slow = along.hypot(spin) < 0.5;
        if !slow {
            measured = spin / along;
        }
        Ok(slow)
    })?;
    Ok(Outcome::of(1.0 / 0.653, measured))
}

/// Rolling along a line with the moment k m R² about its axis and half of that across is stable if the
/// square of its speed is above g R / (2 (1 + k)) (E. J. Routh, *Advanced Dynamics*, 1905, 244).
fn upright(setting: &Setting, k: f64) -> Result<Outcome, Error> {
    const THICK: f64 = 0.001;
    let want = (G * RADIUS / (2.0 * (1.0 + k))).sqrt();
    let found = threshold([0.5 * want, 1.5 * want], 7, |speed| {
        let mut rig = Rig::new(setting, DOWN)?;
        rig.floor(surface(2.0, 0.0))?;
        let turn = turned(DVec3::X, FRAC_PI_2 + 0.02);
        let axis = turn * DVec3::Y;
        let up = axis.cross(DVec3::X);
        let moment = k * RADIUS * RADIUS;
        let spin = -axis * (speed / RADIUS);
        let disc = lump(1.0, DVec3::new(0.5 * moment, moment, 0.5 * moment))
            .with_shape(shape(Geometry::cylinder(THICK as f32, RADIUS as f32), surface(2.0, 0.0)))
            .with_position(DVec3::Y * (RADIUS * up.y + THICK * axis.y.abs()))
            .with_rotation(turn.as_quat().normalize())
            .with_velocity(spin.cross(up * RADIUS).as_vec3(), spin.as_vec3());
        let disc = rig.add(&disc)?;
        let falls = rig.until(5.0, |rig| Ok((rig.turn(disc)? * DVec3::Y).y.abs() > 0.3))?;
        Ok(!falls)
    })?;
    Ok(Outcome::of(want, found))
}
