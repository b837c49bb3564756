//! Free rotation of tumbling bodies, and tops on their points.

use super::case::{Case, Outcome, Setting};
use super::rig::{DOWN, G, Rig, elliptic_k, lump, turned};
use super::watch::{Passages, Turns, threshold};
use backstop::BodyDesc;
use backstop::BodyHandle;
use backstop::Error;
use backstop::{Frame, JointDesc};
use glam::{DVec3, Vec3};
use std::f64::consts::{PI, TAU};

pub(super) const CASES: &[Case] = &[
    Case {
        name: "free-top-space",
        about: "a free symmetric top: the rate at which its axis goes round, over 100 turns",
        formula: "W = L / I1",
        unit: "rad/s",
        bar: 0.01,
        measure: |setting| free_top(setting, true),
    },
    Case {
        name: "free-top-body",
        about: "the same: the rate at which its spin goes round in its own frame",
        formula: "w3 (I3 - I1) / I1",
        unit: "rad/s",
        bar: 0.01,
        measure: |setting| free_top(setting, false),
    },
    Case {
        name: "heavy-top-slow",
        about: "a top on its point, 30 degrees from upright: the slow one of its steady precessions",
        formula: "W = (I3 w3 - sqrt(I3² w3² - 4 I1 m g l cos th)) / (2 I1 cos th)",
        unit: "rad/s",
        bar: 0.02,
        measure: |setting| heavy_top(setting, -1.0),
    },
    Case {
        name: "heavy-top-fast",
        about: "the same: the fast one",
        formula: "W = (I3 w3 + sqrt(I3² w3² - 4 I1 m g l cos th)) / (2 I1 cos th)",
        unit: "rad/s",
        bar: 0.02,
        measure: |setting| heavy_top(setting, 1.0),
    },
    Case {
        name: "nutation",
        about: "the same, its axis let go at rest: the period of its nutation",
        formula: "T = integral of 2 du / sqrt(f(u)), u = cos th, close to 2 pi I1 / (I3 w3)",
        unit: "s",
        bar: 0.02,
        measure: nutation,
    },
    Case {
        name: "sleeping-top",
        about: "an upright top that is nudged: the spin from which on it does not fall",
        formula: "w3 = 2 sqrt(I1 m g l) / I3",
        unit: "rad/s",
        bar: 0.02,
        measure: sleeping,
    },
    Case {
        name: "racket-period",
        about: "a box of 0.2 x 0.4 x 0.1 m turns about its middle axis and flips: the period of two flips",
        formula: "T = 4 K(k) / om = 3.86563793 s for (0.1, 10, 0) rad/s about the axes by their moments",
        unit: "s",
        bar: 0.01,
        measure: |setting| racket(setting, Racket::Period),
    },
    Case {
        name: "racket-energy",
        about: "the same: what its energy is off by, per flip",
        formula: "0",
        unit: "of E",
        bar: 1e-4,
        measure: |setting| racket(setting, Racket::Energy),
    },
    Case {
        name: "racket-momentum",
        about: "the same: what the size of its angular momentum is off by after three flips",
        formula: "0",
        unit: "of L",
        bar: 1e-6,
        measure: |setting| racket(setting, Racket::Momentum),
    },
];

/// Spin in the body's own axes [rad/s].
fn local_spin(rig: &Rig, body: BodyHandle) -> Result<DVec3, Error> {
    Ok(rig.turn(body)?.conjugate() * rig.spin(body)?)
}

fn free_top(setting: &Setting, space: bool) -> Result<Outcome, Error> {
    let inertia = DVec3::new(0.02, 0.03, 0.02);
    let mut rig = Rig::new(setting, Vec3::ZERO)?;
    let spin = DVec3::new(6.0, 20.0, 0.0);
    let top = rig.add(&lump(1.0, inertia).with_velocity(Vec3::ZERO, spin.as_vec3()))?;
    let momentum = inertia * spin;
    let (e1, e2) = momentum.normalize().any_orthonormal_pair();
    let mut turns = Turns::default();
    let mut start = 0.0;
    rig.until(100.0, |rig| {
        turns.see(if space {
            let axis = rig.turn(top)? * DVec3::Y;
            libm::atan2(axis.dot(e2), axis.dot(e1))
        } else {
            let spin = local_spin(rig, top)?;
            libm::atan2(spin.x, spin.z)
        });
        if start == 0.0 {
            start = rig.time;
        }
        Ok(turns.gone.abs() > 100.0 * TAU)
    })?;
    let want = if space { momentum.length() / inertia.x } else { spin.y * 0.5 };
    Ok(Outcome::of(want, turns.gone.abs() / (rig.time - start)))
}

/// The heavy top of 1 kg: distance from its point to its centre [m], and moments of inertia about the point
/// [kg m²].
const ARM: f64 = 0.5;
const ACROSS: f64 = 0.3;
const ALONG: f64 = 0.1;
const LEAN: f64 = PI / 6.0;
const SPIN: f64 = 60.0;

/// A top on its point, leaning by an angle towards +x, with a spin about the world's axes.
fn top(setting: &Setting, lean: f64, spin: DVec3) -> Result<(Rig, BodyHandle), Error> {
    let mut rig = Rig::new(setting, DOWN)?;
    let point = rig.add(&BodyDesc::fixed())?;
    let turn = turned(DVec3::Z, -lean);
    let own = ACROSS - ARM * ARM;
    let arm = turn * DVec3::Y * ARM;
    let body =
        lump(1.0, DVec3::new(own, ALONG, own)).with_position(arm).with_rotation(turn.as_quat().normalize());
    let body = rig.add(&body.with_velocity(spin.cross(arm).as_vec3(), spin.as_vec3()))?;
    let frames = [Frame::default(), Frame::at(Vec3::NEG_Y * ARM as f32)];
    rig.world.add_joint(&JointDesc::ball([point, body], frames))?;
    Ok((rig, body))
}

/// Axis of a top that leans by this angle.
fn axis_at(lean: f64) -> DVec3 {
    turned(DVec3::Z, -lean) * DVec3::Y
}

fn heavy_top(setting: &Setting, sign: f64) -> Result<Outcome, Error> {
    let l = ALONG * SPIN;
    let cos = libm::cos(LEAN);
    let root = (l * l - 4.0 * ACROSS * G * ARM * cos).sqrt();
    let want = (l + sign * root) / (2.0 * ACROSS * cos);
    let axis = axis_at(LEAN);
    let (mut rig, top) = top(setting, LEAN, DVec3::Y * want + axis * (SPIN - want * cos))?;
    let mut turns = Turns::default();
    let mut start = 0.0;
    rig.until(20.0, |rig| {
        let axis = rig.turn(top)? * DVec3::Y;
        turns.see(libm::atan2(-axis.z, axis.x));
        if start == 0.0 {
            start = rig.time;
        }
        Ok(turns.gone.abs() > 3.0 * TAU)
    })?;
    Ok(Outcome::of(want, turns.gone / (rig.time - start)))
}

/// f(u) = (u0 - u) (b (1 - u²) - a² (u0 - u)) for the axis released at rest at u0 = cos th, a = I3 w3 / I1, b
/// = 2 m g l / I1. Its roots are u0, u1 below it, and u2 > 1; with u = (u0 + u1) / 2 + (u0 - u1) / 2 sin x
/// the integral has no more singularity.
fn nutation_period() -> f64 {
    let (a, b, u0) = (ALONG * SPIN / ACROSS, 2.0 * G * ARM / ACROSS, libm::cos(LEAN));
    // b u² - a² u + a² u0 - b = 0.
    let half = 0.5 * a * a / b;
    let root = (half * half - (a * a * u0 / b - 1.0)).sqrt();
    let (u1, u2) = (half - root, half + root);
    const PARTS: u32 = 1000;
    let sum: f64 = (0..PARTS)
        .map(|i| {
            let x = ((f64::from(i) + 0.5) / f64::from(PARTS) - 0.5) * PI;
            let u = 0.5 * (u0 + u1) + 0.5 * (u0 - u1) * libm::sin(x);
            1.0 / (b * (u2 - u)).sqrt()
        })
        .sum();
    2.0 * sum * PI / f64::from(PARTS)
}

fn nutation(setting: &Setting) -> Result<Outcome, Error> {
    let (mut rig, top) = top(setting, LEAN, axis_at(LEAN) * SPIN)?;
    // Its lean is extreme when the rate of lean passes zero.
    let mut passages = Passages::default();
    rig.until(5.0, |rig| {
        let axis = rig.turn(top)? * DVec3::Y;
        passages.see(rig.time, rig.spin(top)?.cross(axis).y);
        Ok(passages.times.len() == 21)
    })?;
    let measured = match passages.times[..] {
        [first, .., last] if passages.times.len() == 21 => (last - first) / 10.0,
        _ => f64::NAN,
    };
    Ok(Outcome::of(nutation_period(), measured))
}

fn sleeping(setting: &Setting) -> Result<Outcome, Error> {
    let want = 2.0 * (ACROSS * G * ARM).sqrt() / ALONG;
    let found = threshold([0.5 * want, 1.5 * want], 8, |spin| {
        let (mut rig, top) = top(setting, 0.01, axis_at(0.01) * spin)?;
        let falls = rig.until(8.0, |rig| Ok((rig.turn(top)? * DVec3::Y).y < libm::cos(0.3)))?;
        Ok(!falls)
    })?;
    Ok(Outcome::of(want, found))
}

enum Racket {
    Period,
    Energy,
    Momentum,
}

fn racket(setting: &Setting, what: Racket) -> Result<Outcome, Error> {
    // Moments about x, y and z; in ascending order: y, x, z.
    let inertia = DVec3::new(17.0 / 1200.0, 1.0 / 240.0, 1.0 / 60.0);
    let spin = DVec3::new(10.0, 0.1, 0.0);
    let mut rig = Rig::new(setting, Vec3::ZERO)?;
    let body = rig.add(&lump(1.0, inertia).with_velocity(Vec3::ZERO, spin.as_vec3()))?;
    let kept = |spin: DVec3| ((inertia * spin).length(), 0.5 * spin.dot(inertia * spin));
    let before = kept(spin);
    let mut passages = Passages::default();
    rig.until(20.0, |rig| {
        passages.see(rig.time, local_spin(rig, body)?.x);
        Ok(passages.times.len() == 3)
    })?;
    let after = kept(local_spin(&rig, body)?);
    Ok(match what {
        Racket::Period => Outcome::of(racket_period(inertia, spin), passages.period()),
        Racket::Energy => Outcome::zero((after.1 / before.1 - 1.0) / 3.0),
        Racket::Momentum => Outcome::zero(after.0 / before.0 - 1.0),
    })
}

/// Period of the spin's component along the middle axis (Landau and Lifshitz, *Mechanics*, 37).
fn racket_period(inertia: DVec3, spin: DVec3) -> f64 {
    let (twice, momentum) = (spin.dot(inertia * spin), (inertia * spin).length_squared());
    let [i1, i2, i3] = [inertia.y, inertia.x, inertia.z];
    let (low, high) = (momentum - i1 * twice, i3 * twice - momentum);
    let (om, k) = if momentum > i2 * twice {
        ((i3 - i2) * low / (i1 * i2 * i3), (i2 - i1) * high / ((i3 - i2) * low))
    } else {
        ((i2 - i1) * high / (i1 * i2 * i3), (i3 - i2) * low / ((i2 - i1) * high))
    };
    4.0 * elliptic_k(k) / om.sqrt()
}

#[test]
fn the_periods_are_those_of_the_literature() {
    let inertia = DVec3::new(17.0 / 1200.0, 1.0 / 240.0, 1.0 / 60.0);
    assert!((racket_period(inertia, DVec3::new(10.0, 0.1, 0.0)) - 3.86563793).abs() < 1e-7);
    assert!((racket_period(inertia, DVec3::new(10.0, 0.01, 0.0)) - 5.40081053).abs() < 1e-7);
    // T/T0 for 90 and 170 degrees, as series and quadrature both give it.
    assert!((super::rig::stretch(0.5 * PI) - 1.18034060).abs() < 1e-8);
    assert!((super::rig::stretch(170.0 * PI / 180.0) - 2.43936272).abs() < 1e-8);
    // A fast top nutates at a = I3 w3 / I1, slower by the share b cos th / a² with b = 2 m g l / I1, to the
    // second order.
    let (a, b) = (ALONG * SPIN / ACROSS, 2.0 * G * ARM / ACROSS);
    let slower = b * libm::cos(LEAN) / (a * a);
    assert!((nutation_period() * a / TAU - 1.0 - slower).abs() < 2.0 * (b / (a * a)).powi(2));
}
