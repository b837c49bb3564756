//! Falling bodies: free, about an end, or as a chain.

use super::case::{Case, Outcome, Setting};
use super::rig::{DOWN, G, Rig, lump, rod, shape, smooth, tilted};
use super::watch::threshold;
use backstop::BodyDesc;
use backstop::BodyHandle;
use backstop::Error;
use backstop::Geometry;
use backstop::{Frame, JointDesc};
use glam::{DVec3, Vec3};

pub(super) const CASES: &[Case] = &[
    Case {
        name: "free-fall",
        about: "a body falls for a second: the distance",
        formula: "d = g t² / 2",
        unit: "m",
        bar: 0.01,
        measure: free_fall,
    },
    Case {
        name: "falling-rod",
        about: "a rod falls over on a smooth floor: its spin at 60 degrees from upright",
        formula: "w² = 12 g (cos th0 - cos th) / (L (1 + 3 sin² th))",
        unit: "rad/s",
        bar: 0.01,
        measure: |setting| falling_rod(setting, false),
    },
    Case {
        name: "falling-rod-straight",
        about: "the same: how far its centre is aside there, as a share of its length",
        formula: "0: nothing pushes it aside",
        unit: "",
        bar: 0.01,
        measure: |setting| falling_rod(setting, true),
    },
    Case {
        name: "chimney-tip",
        about: "a rod hinged at its foot is let go at 30 degrees from level: how fast its tip comes down",
        formula: "a = 3/2 g cos² el",
        unit: "m/s²",
        bar: 0.02,
        measure: |setting| Ok(Outcome::of(1.5 * G * 0.75, tip(setting, 30.0)?)),
    },
    Case {
        name: "chimney-race",
        about: "the same: below which elevation the tip is ahead of a ball that falls",
        formula: "cos² el = 2/3, el = 35.26 degrees",
        unit: "degrees",
        bar: 0.02,
        measure: race,
    },
    Case {
        name: "folded-chain",
        about: "a chain of 101 links hangs folded by both ends, and one is let go: the time to its lowest \
            point over that of free fall",
        formula: "0.847213085 for a fine chain that keeps its energy",
        unit: "",
        bar: 0.02,
        measure: chain,
    },
];

fn free_fall(setting: &Setting) -> Result<Outcome, Error> {
    let mut rig = Rig::new(setting, DOWN)?;
    let body = rig.add(&lump(1.0, DVec3::splat(0.1)))?;
    rig.run_to(1.0)?;
    Ok(Outcome::of(0.5 * G * rig.time * rig.time, -rig.place(body)?.y))
}

/// The only shape is a small sphere at its lower end, so that the supporting force passes through that end.
fn falling_rod(setting: &Setting, aside: bool) -> Result<Outcome, Error> {
    const LENGTH: f64 = 1.0;
    const END: f64 = 0.02;
    let start: f64 = 0.1;
    let mut rig = Rig::new(setting, DOWN)?;
    rig.floor(smooth(0.0))?;
    let mut end = shape(Geometry::Sphere { radius: END as f32 }, smooth(0.0));
    end.position = Vec3::NEG_Y * (0.5 * LENGTH) as f32;
    let at = DVec3::Y * (END + 0.5 * LENGTH * libm::cos(start));
    let body = rod(LENGTH).with_shape(end).with_position(at).with_rotation(tilted(DVec3::Z, start));
    let body = rig.add(&body)?;
    let lean = |rig: &Rig| -> Result<f64, Error> { Ok(libm::acos((rig.turn(body)? * DVec3::Y).y)) };
    let (mut before, mut now) = ([start, 0.0], [start, 0.0]);
    let goal = 60f64.to_radians();
    rig.until(5.0, |rig| {
        before = now;
        now = [lean(rig)?, rig.spin(body)?.z];
        Ok(now[0] >= goal)
    })?;
    if aside {
        return Ok(Outcome::zero(rig.place(body)?.x.abs() / LENGTH));
    }
    let share = (goal - before[0]) / (now[0] - before[0]);
    let (sin, cos) = libm::sincos(goal);
    let want = (12.0 * G * (libm::cos(start) - cos) / (LENGTH * (1.0 + 3.0 * sin * sin))).sqrt();
    Ok(Outcome::of(want, before[1] + share * (now[1] - before[1])))
}

/// Downward acceleration of the tip of a hinged rod, over one step.
fn tip(setting: &Setting, elevation: f64) -> Result<f64, Error> {
    const LENGTH: f64 = 1.0;
    let mut rig = Rig::new(setting, DOWN)?;
    let hinge = rig.add(&BodyDesc::fixed())?;
    let (sin, cos) = libm::sincos(elevation.to_radians());
    let turn = tilted(DVec3::Z, -(90.0 - elevation).to_radians());
    let middle = DVec3::new(cos, sin, 0.0) * (0.5 * LENGTH);
    let body = rig.add(&rod(LENGTH).with_position(middle).with_rotation(turn))?;
    let frames = [Frame::default(), Frame::at(Vec3::NEG_Y * (0.5 * LENGTH) as f32)];
    rig.world.add_joint(&JointDesc::ball([hinge, body], frames))?;
    rig.step()?;
    let arm = rig.turn(body)? * DVec3::Y * (0.5 * LENGTH);
    Ok(-(rig.velocity(body)? + rig.spin(body)?.cross(arm)).y / rig.time)
}

fn race(setting: &Setting) -> Result<Outcome, Error> {
    let found = threshold([20.0, 50.0], 12, |elevation| Ok(tip(setting, elevation)? < G))?;
    Ok(Outcome::of(libm::acos((2.0 / 3.0f64).sqrt()).to_degrees(), found))
}

/// Links of 1 m: fifty down from the hook, one across, fifty up to the end that is let go.
fn chain(setting: &Setting) -> Result<Outcome, Error> {
    const SIDE: u32 = 50;
    let mut rig = Rig::new(setting, DOWN)?;
    let mut last = rig.add(&BodyDesc::fixed())?;
    let mut joint = Vec3::ZERO;
    let half = Vec3::Y * 0.5;
    let mut place = DVec3::ZERO;
    for i in 0..=2 * SIDE {
        let way = match i.cmp(&SIDE) {
            std::cmp::Ordering::Less => DVec3::NEG_Y,
            std::cmp::Ordering::Equal => DVec3::X,
            std::cmp::Ordering::Greater => DVec3::Y,
        };
        // A link's own y axis points forward along the chain.
        let turn = if way.x > 0.0 {
            tilted(DVec3::Z, -std::f64::consts::FRAC_PI_2)
        } else if way.y < 0.0 {
            tilted(DVec3::Z, std::f64::consts::PI)
        } else {
            glam::Quat::IDENTITY
        };
        let link = rig.add(&rod(1.0).with_position(place + way * 0.5).with_rotation(turn))?;
        rig.world.add_joint(&JointDesc::ball([last, link], [Frame::at(joint), Frame::at(-half)]))?;
        (last, joint, place) = (link, half, place + way);
    }
    let tip = |rig: &Rig, body: BodyHandle| -> Result<f64, Error> {
        Ok((rig.place(body)? + rig.turn(body)? * DVec3::Y * 0.5).y)
    };
    // The lowest point, by a parabola through the three steps about it.
    let mut heights = vec![0.0];
    rig.until(8.0, |rig| {
        heights.push(tip(rig, last)?);
        let low = -f64::from(SIDE);
        Ok(matches!(heights[..], [.., b, c] if c > b && b < low))
    })?;
    let [.., a, b, c] = heights[..] else { return Ok(Outcome::of(1.0, f64::NAN)) };
    let dt = f64::from(rig.dt);
    let lowest = rig.time - dt + 0.5 * dt * (a - c) / (a - 2.0 * b + c);
    let free = (2.0 * f64::from(2 * SIDE + 1) / G).sqrt();
    Ok(Outcome::of(0.847213085, lowest / free))
}
