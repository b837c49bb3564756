//! Balls that bounce on a floor.

use super::case::{Case, Outcome, Setting};
use super::rig::{DOWN, G, Rig, dynamic, surface};
use backstop::BodyHandle;
use backstop::Error;
use backstop::Geometry;
use glam::Vec3;

pub(super) const CASES: &[Case] = &[
    Case {
        name: "bounce-height",
        about: "a ball falls 1 m, e = 0.8: its height after the third bounce",
        formula: "h = e^(2 k) h0",
        unit: "m",
        bar: 0.01,
        measure: height,
    },
    Case {
        name: "bounce-time",
        about: "the same: the time of the fourth impact",
        formula: "t = sqrt(2 h0 / g) (1 + 2 e (1 - e^(k-1)) / (1 - e))",
        unit: "s",
        bar: 0.01,
        measure: time,
    },
    Case {
        name: "bounce-rest",
        about: "the same, e = 0.5: the time after which it does not leave the floor any more",
        formula: "t = sqrt(2 h0 / g) (1 + e) / (1 - e)",
        unit: "s",
        bar: 0.01,
        measure: rest,
    },
    Case {
        name: "bounce-energy",
        about: "a ball falls 1 m, e = 1: what its energy is off by after 20 s",
        formula: "0",
        unit: "of E",
        bar: 6e-4,
        measure: energy,
    },
    Case {
        name: "oblique-grip",
        about: "a ball without spin lands at an angle, e = 1, and grips: its speed along the floor",
        formula: "v' = 5 v / 7: no restitution along the floor (Garwin's 3 v / 7 has)",
        unit: "m/s",
        bar: 1e-4,
        measure: |setting| oblique(setting, 2.0),
    },
    Case {
        name: "oblique-slip",
        about: "the same, so fast along the floor that it slips throughout",
        formula: "v' = v - 2 mu u, for u the speed with which it lands",
        unit: "m/s",
        bar: 1e-4,
        measure: |setting| oblique(setting, 12.0),
    },
];

const RADIUS: f64 = 0.1;

/// A ball with restitution `e`, 1 m above the floor.
fn dropped(setting: &Setting, e: f64) -> Result<(Rig, BodyHandle), Error> {
    // It bounces until gravity over a substep stops it.
    let settings = Setting::settings(DOWN).with_restitution_threshold(0.02);
    let mut rig = Rig::with(setting, settings)?;
    rig.floor(surface(0.0, e))?;
    let ball = Geometry::Sphere { radius: RADIUS as f32 };
    let ball = rig.add(&dynamic(ball, surface(0.0, e), Vec3::Y * (1.0 + RADIUS) as f32))?;
    Ok((rig, ball))
}

/// Steps to the end of the step with the next impact. Returns the time of the impact, extrapolated back from
/// there, and the speed just after it.
fn impact(rig: &mut Rig, ball: BodyHandle) -> Result<(f64, f64), Error> {
    let mut falls = rig.velocity(ball)?.y <= 0.0;
    rig.until(rig.time + 3.0, |rig| {
        let v = rig.velocity(ball)?.y;
        let bounced = falls && v > 0.0;
        falls = v <= 0.0;
        Ok(bounced)
    })?;
    let (height, v) = (rig.place(ball)?.y - RADIUS, rig.velocity(ball)?.y);
    // It left the floor with w, w² = v² + 2 g h, and took (w - v) / g to get here.
    let w = (v * v + 2.0 * G * height).max(0.0).sqrt();
    Ok((rig.time - (w - v) / G, w))
}

fn height(setting: &Setting) -> Result<Outcome, Error> {
    let (mut rig, ball) = dropped(setting, 0.8)?;
    let mut speed = 0.0;
    for _ in 0..3 {
        (_, speed) = impact(&mut rig, ball)?;
    }
    Ok(Outcome::of(libm::pow(0.8, 6.0), speed * speed / (2.0 * G)))
}

fn time(setting: &Setting) -> Result<Outcome, Error> {
    let (e, k) = (0.8, 4);
    let (mut rig, ball) = dropped(setting, e)?;
    let mut time = 0.0;
    for _ in 0..k {
        (time, _) = impact(&mut rig, ball)?;
    }
    let series = 2.0 * e * (1.0 - libm::pow(e, f64::from(k - 1))) / (1.0 - e);
    Ok(Outcome::of((2.0 / G).sqrt() * (1.0 + series), time))
}

fn rest(setting: &Setting) -> Result<Outcome, Error> {
    let e = 0.5;
    let (mut rig, ball) = dropped(setting, e)?;
    let mut last = 0.0;
    rig.until(4.0, |rig| {
        if rig.place(ball)?.y - RADIUS > 1e-3 || rig.velocity(ball)?.y.abs() > 0.02 {
            last = rig.time;
        }
        Ok(false)
    })?;
    Ok(Outcome::of((2.0 / G).sqrt() * (1.0 + e) / (1.0 - e), last))
}

fn energy(setting: &Setting) -> Result<Outcome, Error> {
    let (mut rig, ball) = dropped(setting, 1.0)?;
    let energy = |rig: &Rig| -> Result<f64, Error> {
        Ok(0.5 * rig.velocity(ball)?.length_squared() + G * (rig.place(ball)?.y - RADIUS))
    };
    let before = energy(&rig)?;
    rig.run_to(20.0)?;
    Ok(Outcome::zero(energy(&rig)? / before - 1.0))
}

fn oblique(setting: &Setting, along: f64) -> Result<Outcome, Error> {
    let (fall, mu) = (4.0, 0.3);
    let mut rig = Rig::new(setting, Vec3::ZERO)?;
    rig.floor(surface(mu, 1.0))?;
    let ball = Geometry::Sphere { radius: RADIUS as f32 };
    let ball = dynamic(ball, surface(mu, 1.0), Vec3::Y * (RADIUS + 0.5) as f32);
    let ball = rig.add(&ball.with_velocity(Vec3::new(along as f32, -fall as f32, 0.0), Vec3::ZERO))?;
    rig.run_to(0.3)?;
    let grips = along < 7.0 * mu * fall;
    let want = if grips { along * 5.0 / 7.0 } else { along - 2.0 * mu * fall };
    Ok(Outcome::of(want, rig.velocity(ball)?.x))
}
