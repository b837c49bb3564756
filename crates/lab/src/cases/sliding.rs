//! Bodies that slide on a floor or a slope.

use super::case::{Case, Outcome, Setting};
use super::rig::{DOWN, G, Rig, dynamic, rod, shape, surface, tilted};
use super::watch::threshold;
use backstop::BodyDesc;
use backstop::BodyHandle;
use backstop::Error;
use backstop::{Geometry, Material};
use glam::{DVec3, Quat, Vec3};

const FORMULA: &str = "d = v² / (2 mu g), whatever the direction";

pub(super) const CASES: &[Case] = &[
    Case {
        name: "slide-0",
        about: "a box slides along x until it stops: the distance",
        formula: FORMULA,
        unit: "m",
        bar: 0.01,
        measure: |setting| slide(setting, 0.0),
    },
    Case {
        name: "slide-22",
        about: "the same at 22.5 degrees from x",
        formula: FORMULA,
        unit: "m",
        bar: 0.01,
        measure: |setting| slide(setting, 22.5),
    },
    Case {
        name: "slide-45",
        about: "the same at 45 degrees",
        formula: FORMULA,
        unit: "m",
        bar: 0.01,
        measure: |setting| slide(setting, 45.0),
    },
    Case {
        name: "slide-60",
        about: "the same at 60 degrees",
        formula: FORMULA,
        unit: "m",
        bar: 0.01,
        measure: |setting| slide(setting, 60.0),
    },
    Case {
        name: "slide-time",
        about: "a box slides until it stops: the time, from its speeds at a quarter and three quarters of it",
        formula: "t = v / (mu g)",
        unit: "s",
        bar: 0.01,
        measure: slide_time,
    },
    Case {
        name: "incline-holds",
        about: "a box on a slope of 20 degrees with mu = tan 20 + 0.01: its creep over 60 s",
        formula: "0, since tan th <= mu",
        unit: "m/s",
        bar: 1e-4,
        measure: incline_holds,
    },
    Case {
        name: "incline-slides",
        about: "the same with mu = tan 20 - 0.01: its acceleration",
        formula: "a = g (sin th - mu cos th)",
        unit: "m/s²",
        bar: 0.02,
        measure: incline_slides,
    },
    Case {
        name: "incline-tips",
        about: "a box 0.4 m wide and 1 m high on a rough slope: the slope at which it tips, as its tangent",
        formula: "tan th = w / h",
        unit: "",
        bar: 0.02,
        measure: incline_tips,
    },
    Case {
        name: "painleve-rod",
        about: "a rod slides with its end ahead at 60 degrees and mu = 2, where rigid sliding has no \
            solution: energy that it gains",
        formula: "0: none may be gained; 1 + 3 cos² th - 3 mu sin th cos th < 0",
        unit: "of E",
        bar: 1e-3,
        measure: |setting| painleve(setting, false),
    },
    Case {
        name: "painleve-jam",
        about: "the same: its spin after a sixtieth of a second",
        formula: "w = m v y / (I + m r²), y the height of the centre: an impulse stops the end at once",
        unit: "rad/s",
        bar: 0.05,
        measure: |setting| painleve(setting, true),
    },
];

const SPEED: f64 = 5.0;
const MU: f64 = 0.5;

/// A box of 1 x 0.4 x 1 m.
const BOX: Vec3 = Vec3::new(0.5, 0.2, 0.5);

fn slider(setting: &Setting, way: DVec3) -> Result<(Rig, BodyHandle), Error> {
    let mut rig = Rig::new(setting, DOWN)?;
    let material = surface(MU, 0.0);
    rig.floor(material)?;
    let body = dynamic(Geometry::Box { half_extents: BOX }, material, Vec3::Y * BOX.y);
    let body = rig.add(&body.with_velocity((way * SPEED).as_vec3(), Vec3::ZERO))?;
    Ok((rig, body))
}

fn slide(setting: &Setting, degrees: f64) -> Result<Outcome, Error> {
    let (sin, cos) = libm::sincos(degrees.to_radians());
    let way = DVec3::new(cos, 0.0, sin);
    let (mut rig, body) = slider(setting, way)?;
    rig.run_to(2.0)?;
    Ok(Outcome::of(SPEED * SPEED / (2.0 * MU * G), rig.place(body)?.dot(way)))
}

fn slide_time(setting: &Setting) -> Result<Outcome, Error> {
    let (mut rig, body) = slider(setting, DVec3::X)?;
    let want = SPEED / (MU * G);
    rig.run_to(0.25 * want)?;
    let (then, fast) = (rig.time, rig.velocity(body)?.x);
    rig.run_to(0.75 * want)?;
    let (now, slow) = (rig.time, rig.velocity(body)?.x);
    Ok(Outcome::of(want, now + slow * (now - then) / (fast - slow)))
}

/// A box at rest on a slope, and the direction down.
fn on_slope(
    setting: &Setting,
    angle: f64,
    half: Vec3,
    material: Material,
) -> Result<(Rig, BodyHandle, DVec3), Error> {
    let tilt: Quat = tilted(DVec3::Z, -angle);
    let mut rig = Rig::new(setting, DOWN)?;
    rig.add(&BodyDesc::fixed().with_rotation(tilt).with_shape(shape(Geometry::Plane, material)))?;
    let body = dynamic(Geometry::Box { half_extents: half }, material, tilt * (Vec3::Y * half.y));
    let body = rig.add(&body.with_rotation(tilt))?;
    Ok((rig, body, (tilt * Vec3::X).as_dvec3()))
}

const SLOPE: f64 = 20.0;

fn incline_holds(setting: &Setting) -> Result<Outcome, Error> {
    let angle = SLOPE.to_radians();
    let (mut rig, body, down) = on_slope(setting, angle, BOX, surface(libm::tan(angle) + 0.01, 0.0))?;
    rig.run_to(1.0)?;
    let start = rig.place(body)?;
    rig.run_to(61.0)?;
    Ok(Outcome::zero((rig.place(body)? - start).dot(down) / 60.0))
}

fn incline_slides(setting: &Setting) -> Result<Outcome, Error> {
    let angle = SLOPE.to_radians();
    let mu = libm::tan(angle) - 0.01;
    let (mut rig, body, down) = on_slope(setting, angle, BOX, surface(mu, 0.0))?;
    rig.run_to(1.0)?;
    let (then, before) = (rig.time, rig.velocity(body)?.dot(down));
    rig.run_to(6.0)?;
    let measured = (rig.velocity(body)?.dot(down) - before) / (rig.time - then);
    Ok(Outcome::of(G * (libm::sin(angle) - mu * libm::cos(angle)), measured))
}

fn incline_tips(setting: &Setting) -> Result<Outcome, Error> {
    let want = 0.4;
    let found = threshold([0.5 * want, 1.5 * want], 8, |slope| {
        let half = Vec3::new(0.2, 0.5, 0.4);
        let (mut rig, body, _) = on_slope(setting, libm::atan(slope), half, surface(2.0, 0.0))?;
        let start = rig.turn(body)?;
        rig.until(3.0, |rig| Ok(rig.turn(body)?.angle_between(start) > 0.3))
    })?;
    Ok(Outcome::of(want, found))
}

/// The greatest energy during the motion, relative to that at the start; or the spin soon after the start:
/// about the end, which stops, angular momentum is kept.
fn painleve(setting: &Setting, jam: bool) -> Result<Outcome, Error> {
    const LENGTH: f64 = 1.0;
    const END: f32 = 0.01;
    let mut rig = Rig::new(setting, DOWN)?;
    let material = surface(2.0, 0.0);
    rig.floor(material)?;
    // The lower end leads: the rod leans back by 30 degrees from upright.
    let lean = tilted(DVec3::Z, 30f64.to_radians());
    let ends = [-0.5 * LENGTH, 0.5 * LENGTH].map(|y| {
        let mut end = shape(Geometry::Sphere { radius: END }, material);
        end.position = Vec3::Y * y as f32;
        end
    });
    let height = f64::from(END) + 0.5 * LENGTH * libm::cos(30f64.to_radians());
    let mut body = rod(LENGTH);
    body.shapes = ends.to_vec();
    let body = body.with_position(DVec3::Y * height).with_rotation(lean);
    let body = rig.add(&body.with_velocity(Vec3::X * 5.0, Vec3::ZERO))?;
    if jam {
        let arm = DVec3::new(-0.5 * LENGTH * libm::sin(30f64.to_radians()), height, 0.0);
        rig.run_to(1.0 / 60.0)?;
        let want = -5.0 * height / (LENGTH * LENGTH / 12.0 + arm.length_squared());
        return Ok(Outcome::of(want, rig.spin(body)?.z));
    }
    let before = rig.world.energy();
    let mut most = before;
    rig.until(2.0, |rig| {
        let now = rig.world.energy();
        most = if now.is_finite() { most.max(now) } else { f64::NAN };
        Ok(most.is_nan())
    })?;
    Ok(Outcome::zero(most / before - 1.0))
}
