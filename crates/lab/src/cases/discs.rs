//! Discs that spin and roll on the floor.

use super::case::{Case, Outcome, Setting};
use super::rig::{DOWN, G, Rig, dynamic, lump, shape, surface, tilted};
use super::watch::Turns;
use backstop::Error;
use backstop::Geometry;
use glam::{DVec3, Vec3};

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
