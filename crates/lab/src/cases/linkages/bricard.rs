//! Bricard's linkage (R. Bricard, *Mémoire sur la théorie de l'octaèdre articulé*, 1897; problem A04 of the
//! benchmark library of the IFToMM Technical Committee for Multibody Dynamics): six edges of a cube are rods
//! of 1 m and 1 kg, one of them fixed, with six hinges across both rods of each corner. By counting, it has
//! no freedom; for its lengths and axes it moves. It starts at rest and falls.
//!
//! The reference is an integration in f64 (Runge-Kutta with projection on hinges and their rates, 2.5 ms
//! steps), which keeps energy to 1e-9.

use super::hinge;
use crate::cases::case::{Case, Outcome, Setting};
use crate::cases::rig::{DOWN, Rig, rod};
use backstop::BodyDesc;
use backstop::BodyHandle;
use backstop::Error;
use glam::{Quat, Vec3};

pub(in crate::cases) const CASES: &[Case] = &[
    Case {
        name: "bricard-fall",
        about: "Bricard's linkage falls: the time until it is lowest",
        formula: "1.246612 s, by an integration in f64",
        unit: "s",
        bar: 0.01,
        measure: |setting| bricard(setting, false),
    },
    Case {
        name: "bricard-energy",
        about: "the same: what its energy is off by after 10 s, as a share of the energy of the fall",
        formula: "0",
        unit: "of E",
        bar: 0.01,
        measure: |setting| bricard(setting, true),
    },
];

/// Time from rest until it is lowest [s], and the depth of that [m], of the mean of five rods.
const FALL: f64 = 1.246_612;
const DEPTH: f64 = 0.092_820;

/// Corners of the cube along the rods; the first rod is fixed.
const CORNERS: [Vec3; 7] = [
    Vec3::ZERO,
    Vec3::X,
    Vec3::new(1.0, -1.0, 0.0),
    Vec3::new(1.0, -1.0, 1.0),
    Vec3::new(0.0, -1.0, 1.0),
    Vec3::Z,
    Vec3::ZERO,
];

fn bricard(setting: &Setting, energy: bool) -> Result<Outcome, Error> {
    let mut rig = Rig::new(setting, DOWN)?;
    let mut rods: Vec<BodyHandle> = vec![rig.add(&BodyDesc::fixed())?];
    let ways: Vec<Vec3> = CORNERS.windows(2).map(|pair| pair[1] - pair[0]).collect();
    for (i, &way) in ways.iter().enumerate().skip(1) {
        let turn = Quat::from_rotation_arc(Vec3::Y, way);
        let middle = CORNERS[i] + 0.5 * way;
        rods.push(rig.add(&rod(1.0).with_position(middle).with_rotation(turn))?);
    }
    for i in 0..rods.len() {
        let next = (i + 1) % rods.len();
        let axis = ways[i].cross(ways[next]);
        hinge(&mut rig, [rods[i], rods[next]], CORNERS[i + 1].as_dvec3(), axis)?;
    }
    let height = |rig: &Rig| -> Result<f64, Error> {
        rods[1..].iter().try_fold(0.0, |sum, &body| Ok(sum + 0.2 * rig.place(body)?.y))
    };
    let before = rig.world.energy();
    if energy {
        rig.run_to(10.0)?;
        return Ok(Outcome::zero((rig.world.energy() - before) / (5.0 * 9.81 * DEPTH)));
    }
    let mut heights = vec![height(&rig)?];
    let found = rig.until(3.0, |rig| {
        heights.push(height(rig)?);
        Ok(matches!(heights[..], [.., b, c] if c > b))
    })?;
    let [.., a, b, c] = heights[..] else { return Ok(Outcome::of(FALL, f64::NAN)) };
    let dt = f64::from(rig.dt);
    let lowest = rig.time - dt + 0.5 * dt * (a - c) / (a - 2.0 * b + c);
    Ok(Outcome::of(FALL, if found { lowest } else { f64::NAN }))
}
