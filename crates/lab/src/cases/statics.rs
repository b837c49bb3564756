//! Structures that hold up to a certain friction or height.

use super::case::{Case, Outcome, Setting};
use super::rig::{DOWN, G, Rig, dynamic, lump, shape, smooth, surface, tilted};
use super::watch::threshold;
use backstop::BodyDesc;
use backstop::Error;
use backstop::{ConvexHull, Geometry};
use glam::{DVec3, Vec3};
use std::sync::Arc;

pub(super) const CASES: &[Case] = &[
    Case {
        name: "boxcar",
        about: "a box 0.6 m wide on mu = 0.5 is pushed by a force that grows: the height of the push from \
            which on it tips",
        formula: "y = w / (2 mu)",
        unit: "m",
        bar: 0.02,
        measure: boxcar,
    },
    Case {
        name: "cards",
        about: "two cards lean against each other, 20 degrees from upright: the friction of the floor that \
            they need",
        formula: "mu = tan(th) / 2, for cards with round ends of radius r (L / 2) sin th / (L cos th + r)",
        unit: "",
        bar: 0.05,
        measure: cards,
    },
    Case {
        name: "ladder",
        about: "a ladder at 60 degrees on a smooth wall: the friction of the floor that it needs",
        formula: "mu = cot(el) / 2, for a ladder with round ends of radius r (L / 2) cos el / (L sin el + r)",
        unit: "",
        bar: 0.03,
        measure: ladder,
    },
    Case {
        name: "wedge",
        about: "a wedge of half angle 15 degrees between jaws that press: the friction from which on it \
            stays",
        formula: "mu = tan al",
        unit: "",
        bar: 0.05,
        measure: wedge,
    },
    Case {
        name: "stool",
        about: "a stool on six feet in a regular hexagon: the slope on which it tips over two of them, of six \
            directions the least",
        formula: "tan b = R cos(30) / h",
        unit: "",
        bar: 0.02,
        measure: stool,
    },
];

fn boxcar(setting: &Setting) -> Result<Outcome, Error> {
    const MU: f64 = 0.5;
    let half = Vec3::new(0.3, 0.6, 0.4);
    let want = f64::from(half.x) / MU;
    let found = threshold([0.5 * want, 1.5 * want], 8, |height| {
        let mut rig = Rig::new(setting, DOWN)?;
        rig.floor(surface(MU, 0.0))?;
        let body =
            rig.add(&dynamic(Geometry::Box { half_extents: half }, surface(MU, 0.0), Vec3::Y * half.y))?;
        let grip = MU * f64::from(rig.world.mass(body)?) * G;
        while rig.time < 10.0 {
            // The force rises from 0 to twice the limit of friction.
            let force = grip * rig.time / 5.0;
            let torque = -force * (height - f64::from(half.y));
            rig.world.add_force_and_torque(body, Vec3::X * force as f32, Vec3::Z * torque as f32)?;
            rig.step()?;
            if rig.turn(body)?.z.abs() > 0.025 {
                return Ok(true);
            }
            if rig.place(body)?.x > 0.05 {
                break;
            }
        }
        Ok(false)
    })?;
    Ok(Outcome::of(want, found))
}

/// Length of a card and of the ladder, between the centres of their round ends [m].
const LENGTH: f64 = 1.0;
const RADIUS: f64 = 0.02;

/// A rod whose lower end stands on the floor at `foot`, leaning by an angle from upright towards +x.
fn leaning(foot: f64, lean: f64, friction: f64) -> BodyDesc {
    let (sin, cos) = libm::sincos(lean);
    let at = Vec3::new((foot + 0.5 * LENGTH * sin) as f32, (RADIUS + 0.5 * LENGTH * cos) as f32, 0.0);
    let capsule = Geometry::capsule(0.5 * LENGTH as f32, RADIUS as f32);
    let body = dynamic(capsule, surface(friction, 0.0), at).with_rotation(tilted(DVec3::Z, -lean));
    // The problem is planar.
    body.with_lock_translation([false, false, true]).with_lock_rotation([true, true, false])
}

fn cards(setting: &Setting) -> Result<Outcome, Error> {
    let lean = 20f64.to_radians();
    let (sin, cos) = libm::sincos(lean);
    let want = 0.5 * LENGTH * sin / (LENGTH * cos + RADIUS);
    let found = threshold([0.5 * want, 1.5 * want], 8, |friction| {
        let mut rig = Rig::new(setting, DOWN)?;
        rig.floor(surface(friction, 0.0))?;
        let apart = LENGTH * sin + RADIUS;
        let left = rig.add(&leaning(-apart, lean, friction))?;
        rig.add(&leaning(apart, -lean, friction))?;
        let start = rig.place(left)?.y;
        Ok(!rig.until(4.0, |rig| Ok(rig.place(left)?.y < start - 0.05))?)
    })?;
    Ok(Outcome::of(want, found))
}

fn ladder(setting: &Setting) -> Result<Outcome, Error> {
    let lean = 30f64.to_radians();
    let (sin, cos) = libm::sincos(lean);
    let want = 0.5 * LENGTH * sin / (LENGTH * cos + RADIUS);
    let found = threshold([0.5 * want, 1.5 * want], 8, |friction| {
        let mut rig = Rig::new(setting, DOWN)?;
        rig.floor(surface(friction, 0.0))?;
        let wall = shape(Geometry::Plane, smooth(0.0));
        let to_left = tilted(DVec3::Z, std::f64::consts::FRAC_PI_2);
        rig.add(&BodyDesc::fixed().with_position(DVec3::X * RADIUS).with_rotation(to_left).with_shape(wall))?;
        let body = rig.add(&leaning(-LENGTH * sin, lean, friction))?;
        let start = rig.place(body)?.y;
        Ok(!rig.until(4.0, |rig| Ok(rig.place(body)?.y < start - 0.05))?)
    })?;
    Ok(Outcome::of(want, found))
}

/// A wedge between two jaws that slide along x and are pressed together by 100 kN, without gravity; the jaws
/// have the density of stone.
fn wedge(setting: &Setting) -> Result<Outcome, Error> {
    let angle = 15f64.to_radians();
    let want = libm::tan(angle);
    // Half width at mid-height, and half height.
    let (middle, high) = (0.3, 0.3);
    let corners: Vec<Vec3> = (0..8)
        .map(|i| {
            let sign = |bit: u32| if i >> bit & 1 == 0 { -1.0 } else { 1.0 };
            let x = middle + sign(1) * high * want;
            DVec3::new(sign(0) * x, sign(1) * high, sign(2) * 0.3).as_vec3()
        })
        .collect();
    let hull = Arc::new(ConvexHull::new(&corners)?);
    let found = threshold([0.5 * want, 1.5 * want], 8, |friction| {
        let mut rig = Rig::new(setting, Vec3::ZERO)?;
        let material = surface(friction, 0.0);
        let wedge = rig.add(&dynamic(Geometry::Hull(hull.clone()), material, Vec3::ZERO))?;
        let jaws = [-1.0, 1.0].map(|side| {
            // The inner face touches the wedge's, so its normal is rotated by the angle.
            let turn = tilted(DVec3::Z, -side * angle);
            let at = Vec3::X * (side * middle) as f32 + turn * (Vec3::X * (0.1 * side) as f32);
            let jaw = dynamic(Geometry::cuboid(0.1, 0.2, 0.3), material, at).with_rotation(turn);
            let jaw = jaw.with_lock_translation([false, true, true]).with_lock_rotation([true; 3]);
            (side, jaw)
        });
        let mut pressed = Vec::new();
        for (side, jaw) in &jaws {
            pressed.push((*side, rig.add(jaw)?));
        }
        while rig.time < 3.0 {
            for &(side, jaw) in &pressed {
                rig.world.add_force(jaw, Vec3::X * (-100_000.0 * side) as f32)?;
            }
            rig.step()?;
            if rig.place(wedge)?.length() > 0.05 {
                return Ok(false);
            }
        }
        Ok(true)
    })?;
    Ok(Outcome::of(want, found))
}

/// Radius of the feet, and of the circle on which they are [m].
const FOOT: f64 = 0.05;
const CIRCLE: f64 = 0.4;

fn stool(setting: &Setting) -> Result<Outcome, Error> {
    // Height of the centre of mass above the floor [m].
    const HEIGHT: f64 = 0.6;
    let side = |k: i32| f64::from(60 * k + 30).to_radians();
    let want = CIRCLE * libm::cos(side(0)) / HEIGHT;
    let mut least = f64::INFINITY;
    for k in 0..6 {
        let found = threshold([0.5 * want, 1.5 * want], 8, |slope| {
            let (sin, cos) = libm::sincos(libm::atan(slope));
            let (z, x) = libm::sincos(side(k));
            let gravity = DVec3::new(sin * x, -cos, sin * z) * G;
            let mut rig = Rig::new(setting, gravity.as_vec3())?;
            rig.floor(surface(2.0, 0.0))?;
            let mut body = lump(10.0, DVec3::splat(0.5)).with_position(DVec3::Y * HEIGHT);
            for foot in 0..6 {
                let (z, x) = libm::sincos(f64::from(60 * foot).to_radians());
                let place = DVec3::new(CIRCLE * x, FOOT - HEIGHT, CIRCLE * z).as_vec3();
                let ball = shape(Geometry::Sphere { radius: FOOT as f32 }, surface(2.0, 0.0));
                body = body.with_shape(ball.with_position(place));
            }
            let body = rig.add(&body)?;
            rig.until(3.0, |rig| Ok((rig.turn(body)? * DVec3::Y).y < 0.99))
        })?;
        // The first NaN stays.
        least = if least.is_nan() || found.is_nan() { f64::NAN } else { least.min(found) };
    }
    Ok(Outcome::of(want, least))
}
