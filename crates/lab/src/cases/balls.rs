//! Balls in a row: which laws of impact hold between more than two bodies, and whether their impacts come to
//! an end.

use super::case::{Case, Outcome, Setting};
use super::rig::{Rig, dynamic, shape, smooth};
use crate::WorldMethod;
use backstop::BodyDesc;
use backstop::BodyHandle;
use backstop::Error;
use backstop::Geometry;
use glam::Vec3;

const CRADLE: &str = "one after another: the last leaves with v, all others stand; for methods that solve \
    all impacts at once: \
     (1 - e (n - 1)) v / n of the first, (1 + e) v / n of each other";
const GALPERIN: &str = "floor(pi 10^N) impacts for masses of 1 : 100^N";

pub(super) const CASES: &[Case] = &[
    Case {
        name: "cradle-2",
        about: "a ball meets another of its size, e = 1: the greatest difference of a speed, as a share",
        formula: CRADLE,
        unit: "",
        bar: 1e-6,
        measure: |setting| cradle(setting, 2),
    },
    Case {
        name: "cradle-3",
        about: "the same with two that touch",
        formula: CRADLE,
        unit: "",
        bar: 1e-6,
        measure: |setting| cradle(setting, 3),
    },
    Case {
        name: "cradle-4",
        about: "the same with three that touch",
        formula: CRADLE,
        unit: "",
        bar: 1e-6,
        measure: |setting| cradle(setting, 4),
    },
    Case {
        name: "cradle-5",
        about: "the same with four that touch",
        formula: CRADLE,
        unit: "",
        bar: 1e-6,
        measure: |setting| cradle(setting, 5),
    },
    Case {
        name: "galperin-0",
        about: "a ball between a wall and one as heavy that comes in, e = 1: how many impacts",
        formula: GALPERIN,
        unit: "",
        bar: 0.0,
        measure: |setting| galperin(setting, 1.0, 3.0),
    },
    Case {
        name: "galperin-1",
        about: "the same with one 100 times as heavy",
        formula: GALPERIN,
        unit: "",
        bar: 0.0,
        measure: |setting| galperin(setting, 100.0, 31.0),
    },
    Case {
        name: "galperin-2",
        about: "the same with one 10 000 times as heavy",
        formula: GALPERIN,
        unit: "",
        bar: 0.0,
        measure: |setting| galperin(setting, 1e4, 314.0),
    },
    Case {
        name: "collapse-wall",
        about: "two balls run into a wall one behind the other, e = 0.15: what speed is left between them, \
            as a share",
        formula: "0: for e < 3 - 2 sqrt 2 = 0.1716 their endless impacts take all of it",
        unit: "",
        bar: 0.01,
        measure: |setting| collapse(setting, true, 0.15),
    },
    Case {
        name: "collapse-free",
        about: "a ball runs into two at rest, e = 0.06: the same",
        formula: "0: for e < 7 - 4 sqrt 3 = 0.0718 their endless impacts take all of it",
        unit: "",
        bar: 0.01,
        measure: |setting| collapse(setting, false, 0.06),
    },
];

const RADIUS: f64 = 0.2;

fn ball(density: f64, e: f64, x: f64, speed: f64) -> BodyDesc {
    let geometry = Geometry::Sphere { radius: RADIUS as f32 };
    let mut body = dynamic(geometry, smooth(e), Vec3::X * x as f32);
    body.shapes[0].density = density as f32;
    body.with_velocity(Vec3::X * speed as f32, Vec3::ZERO)
}

/// A world without gravity, in which the slightest approach bounces.
fn empty(setting: &Setting) -> Result<Rig, Error> {
    let settings = Setting::settings(Vec3::ZERO).with_restitution_threshold(0.0);
    Rig::with(setting, settings)
}

fn wall(rig: &mut Rig, e: f64) -> Result<BodyHandle, Error> {
    let wall = shape(Geometry::cuboid(0.5, 2.0, 2.0), smooth(e));
    rig.add(&BodyDesc::fixed().with_position(Vec3::X * -0.5).with_shape(wall))
}

fn cradle(setting: &Setting, count: u32) -> Result<Outcome, Error> {
    const SPEED: f64 = 2.0;
    let mut rig = empty(setting)?;
    let mut row = Vec::new();
    for i in 0..count {
        let (x, v) = if i == 0 { (-0.7, SPEED) } else { (2.0 * RADIUS * f64::from(i), 0.0) };
        row.push(rig.add(&ball(1000.0, 1.0, x, v))?);
    }
    rig.run_to(0.5)?;
    let at_once = matches!(setting.method, Some(WorldMethod::Problem(_)));
    let n = f64::from(count);
    let mut worst = 0.0_f64;
    for (i, &ball) in row.iter().enumerate() {
        let want = match (at_once, i) {
            (true, 0) => (2.0 - n) * SPEED / n,
            (true, _) => 2.0 * SPEED / n,
            (false, _) if i + 1 == row.len() => SPEED,
            (false, _) => 0.0,
        };
        worst = worst.max((rig.velocity(ball)?.x - want).abs() / SPEED);
    }
    Ok(Outcome::zero(worst))
}

fn galperin(setting: &Setting, ratio: f64, want: f64) -> Result<Outcome, Error> {
    let mut rig = empty(setting)?;
    wall(&mut rig, 1.0)?;
    let light = rig.add(&ball(1000.0, 1.0, 2.0, 0.0))?;
    rig.add(&ball(1000.0 * ratio, 1.0, 4.0, -1.0))?;
    let (mut count, mut before) = (0, 0.0);
    rig.until(30.0, |rig| {
        // For methods without impacts within a step, the steps in which its speed changes are counted.
        let now = rig.velocity(light)?.x;
        let changed = u32::from(now != before);
        count += if setting.method.is_none() { rig.world.report().impacts } else { changed };
        before = now;
        Ok(false)
    })?;
    Ok(Outcome::of(want, f64::from(count)))
}

fn collapse(setting: &Setting, with_wall: bool, e: f64) -> Result<Outcome, Error> {
    const SPEED: f64 = 2.0;
    let mut rig = empty(setting)?;
    let mut balls = Vec::new();
    if with_wall {
        wall(&mut rig, e)?;
        balls.push(rig.add(&ball(1000.0, e, 0.5, -SPEED))?);
        balls.push(rig.add(&ball(1000.0, e, 1.0, -SPEED))?);
    } else {
        balls.push(rig.add(&ball(1000.0, e, 0.0, SPEED))?);
        balls.push(rig.add(&ball(1000.0, e, 0.7, 0.0))?);
        balls.push(rig.add(&ball(1000.0, e, 1.2, 0.0))?);
    }
    rig.run_to(3.0)?;
    let mut speeds = if with_wall { vec![0.0] } else { Vec::new() };
    for &ball in &balls {
        speeds.push(rig.velocity(ball)?.x);
    }
    let apart = speeds.windows(2).map(|pair| (pair[1] - pair[0]).abs()).fold(0.0, f64::max);
    Ok(Outcome::zero(apart / SPEED))
}
