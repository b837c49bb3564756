//! The Kapla test: six storeys of bricks of 10 kg, each of eight beams across and nine bricks along that lie
//! on the ends of the beams. Statics lets it stand: the bricks of a storey bear on halves of the beams' heads
//! only, and the outermost beams are held by the bricks on them. It counts as fallen when the last brick is
//! below where the storey under it began.

use super::run::{Outcome, Run, Setting};
use backstop::BodyDesc;
use backstop::BodyHandle;
use backstop::Error;
use backstop::{Geometry, Material, ShapeDesc};
use glam::DVec3;
use std::ops::ControlFlow;

/// Storeys, and beams of one.
const STOREYS: u32 = 6;
const BEAMS: u32 = 8;
/// [kg]
const MASS: f32 = 10.0;
/// Metres: thickness, length and height of a brick; beams are a thickness longer.
const THIN: f32 = 0.05;
const LONG: f32 = 0.2;
const HIGH: f32 = 0.1;
/// Not specified by SimBenchmark: each engine had its default.
const FRICTION: f32 = 0.8;

pub(super) fn run(setting: &Setting, seconds: f32) -> Result<Outcome, Error> {
    let mut run = Run::new(setting, seconds, LONG)?;
    let material = Material::default().with_friction(FRICTION);
    run.ground(material)?;
    let bricks = build(&mut run, material)?;
    let fallen = f64::from(HIGH) * f64::from(2 * (STOREYS - 1));
    let last = bricks.last().map(|&(body, _)| body);
    let mut fell = None;
    run.go(setting, |world, step| {
        if let Some(last) = last
            && world.position(last)?.y < fallen
        {
            fell = Some(step);
            return Ok(ControlFlow::Break(()));
        }
        Ok(ControlFlow::Continue(()))
    })?;
    let mut furthest = 0.0_f64;
    for &(body, place) in &bricks {
        furthest = furthest.max((run.world.position(body)? - place).length());
    }
    let stood = f64::from(fell.unwrap_or(run.steps)) * f64::from(setting.dt);
    Ok(run.outcome(stood, furthest / f64::from(HIGH), fell.is_some()))
}

/// The bricks and their places, in SimBenchmark's order.
fn build(run: &mut Run, material: Material) -> Result<Vec<(BodyHandle, DVec3)>, Error> {
    let brick = |x: f32, z: f32| {
        ShapeDesc::new(Geometry::cuboid(0.5 * x, 0.5 * HIGH, 0.5 * z))
            .with_material(material)
            .with_density(MASS / (x * HIGH * z))
    };
    let (beam, wall) = (brick(THIN, LONG + THIN), brick(LONG, THIN));
    let (long, high) = (0.2_f64, 0.1_f64);
    let mut all = Vec::new();
    for storey in 0..STOREYS {
        let ground = 2.0 * high * f64::from(storey);
        let mut add = |shape: &ShapeDesc, x: f64, y: f64, z: f64| {
            let at = DVec3::new(x, ground + y, z);
            let body =
                run.world.add_body(&BodyDesc::dynamic().with_position(at).with_shape(shape.clone()))?;
            all.push((body, at));
            Ok::<_, Error>(())
        };
        for i in 0..BEAMS {
            add(&beam, f64::from(i) * long, 0.5 * high, 0.0)?;
        }
        let pairs = BEAMS / 2;
        for i in 0..pairs {
            add(&wall, (2.0 * f64::from(i) + 0.5) * long, 1.5 * high, -0.5 * long)?;
        }
        // The other side is shifted by half a period, and closed at both ends.
        for i in 0..pairs - 1 {
            add(&wall, (2.0 * f64::from(i) + 1.5) * long, 1.5 * high, 0.5 * long)?;
        }
        for i in [0, pairs - 1] {
            add(&wall, (2.0 * f64::from(i) + 0.5) * long, 1.5 * high, 0.5 * long)?;
        }
    }
    Ok(all)
}
