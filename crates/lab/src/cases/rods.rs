//! Free rods that are struck. The shape is a small sphere at the point of impact, so that the impulse passes
//! through that very point.

use super::case::{Case, Outcome, Setting};
use super::rig::{Rig, dynamic, rod, shape, smooth, tilted};
use backstop::BodyHandle;
use backstop::Error;
use backstop::Geometry;
use glam::{DVec3, Vec3};

pub(super) const CASES: &[Case] = &[
    Case {
        name: "rod-end",
        about: "a level rod falls on its end, e = 0.5: the impulse",
        formula: "J = m v (1 + e) / 4",
        unit: "N s",
        bar: 1e-5,
        measure: |setting| rod_end(setting, 0.0, false),
    },
    Case {
        name: "rod-end-45",
        about: "the same at 45 degrees",
        formula: "J = m v (1 + e) / (1 + 3 cos² th)",
        unit: "N s",
        bar: 1e-5,
        measure: |setting| rod_end(setting, 45.0, false),
    },
    Case {
        name: "rod-end-70",
        about: "the same at 70 degrees",
        formula: "J = m v (1 + e) / (1 + 3 cos² th)",
        unit: "N s",
        bar: 1e-5,
        measure: |setting| rod_end(setting, 70.0, false),
    },
    Case {
        name: "rod-end-spin",
        about: "a level rod falls on its end, e = 0.5: its spin",
        formula: "w = 3 (1 + e) v / (2 L)",
        unit: "rad/s",
        bar: 1e-5,
        measure: |setting| rod_end(setting, 0.0, true),
    },
    Case {
        name: "percussion",
        about: "a rod is hit at two thirds of its length from one end: the speed of that end, as a share of \
            the ball's",
        formula: "0",
        unit: "",
        bar: 1e-5,
        measure: percussion,
    },
];

const LENGTH: f64 = 1.0;
const SPEED: f64 = 4.0;
const E: f64 = 0.5;
const POINT: f64 = 0.05;

/// A rod along y of 1 kg that is touched only at `at` from its centre.
fn touched_at(at: f64, e: f64) -> backstop::BodyDesc {
    let mut point = shape(Geometry::Sphere { radius: POINT as f32 }, smooth(e));
    point.position = Vec3::Y * at as f32;
    rod(LENGTH).with_shape(point)
}

fn rod_end(setting: &Setting, degrees: f64, spin: bool) -> Result<Outcome, Error> {
    let mut rig = Rig::new(setting, Vec3::ZERO)?;
    rig.floor(smooth(E))?;
    // The end that is up in its own frame is lowered to `degrees` below the horizontal.
    let turn = tilted(DVec3::Z, -(90.0 + degrees).to_radians());
    let (sin, cos) = libm::sincos(degrees.to_radians());
    let at = DVec3::Y * (0.5 * LENGTH * sin + POINT + 0.31);
    let body = touched_at(0.5 * LENGTH, E).with_position(at).with_rotation(turn);
    let body = rig.add(&body.with_velocity(Vec3::NEG_Y * SPEED as f32, Vec3::ZERO))?;
    struck(&mut rig, body, -SPEED)?;
    let impulse = SPEED * (1.0 + E) / (1.0 + 3.0 * cos * cos);
    Ok(if spin {
        Outcome::of(impulse * 6.0 * cos / LENGTH, rig.spin(body)?.z)
    } else {
        Outcome::of(impulse, rig.velocity(body)?.y + SPEED)
    })
}

/// Steps to the end of the step with the impact.
fn struck(rig: &mut Rig, body: BodyHandle, speed: f64) -> Result<(), Error> {
    rig.until(2.0, |rig| Ok(rig.velocity(body)?.y != speed)).map(drop)
}

fn percussion(setting: &Setting) -> Result<Outcome, Error> {
    let mut rig = Rig::new(setting, Vec3::ZERO)?;
    // The rod lies along x: its own y is x, and the ball comes from below.
    let level = tilted(DVec3::Z, -std::f64::consts::FRAC_PI_2);
    let at = LENGTH / 6.0;
    let body = rig.add(&touched_at(at, E).with_rotation(level))?;
    let ball = dynamic(Geometry::Sphere { radius: 0.1 }, smooth(E), Vec3::new(at as f32, -0.7, 0.0));
    rig.add(&ball.with_velocity(Vec3::Y * SPEED as f32, Vec3::ZERO))?;
    struck(&mut rig, body, 0.0)?;
    let end = rig.velocity(body)?.y - 0.5 * LENGTH * rig.spin(body)?.z;
    // A body that was never struck proves nothing by standing still.
    let measured = if rig.velocity(body)?.y > 0.0 { end / SPEED } else { f64::NAN };
    Ok(Outcome::zero(measured))
}
