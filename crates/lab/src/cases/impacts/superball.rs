//! A superball between floor and table (R. L. Garwin, *Kinematics of an ultraelastic rough ball*, 1969).
//!
//! Each bounce reverses the velocity of the point of contact, along the surface too, and keeps angular
//! momentum about that point. With the speed v of the centre, that of the surface by spin W = r w, and
//! d = 4/7 (v - W): v' = v - d, W' = W + 5/2 d on the floor; below the table W has the other sign. From v,
//! without spin, floor, table and floor make 3/7 v, -31/49 v and -333/343 v.

use crate::cases::case::{Case, Outcome, Setting};
use crate::cases::rig::{Rig, dynamic, shape, surface, tilted};
use backstop::BodyDesc;
use backstop::Error;
use backstop::Geometry;
use glam::{DVec3, Vec3};

pub(in crate::cases) const CASES: &[Case] = &[Case {
    name: "superball-table",
    about: "a ball that is elastic along surfaces too is thrown below a table: its speed along the floor after \
        floor, table and floor",
    formula: "v' = -333 v / 343: it comes back",
    unit: "m/s",
    bar: 0.05,
    measure: table,
}];

const RADIUS: f64 = 0.1;
const SPEED: f64 = 2.0;

fn table(setting: &Setting) -> Result<Outcome, Error> {
    let material = surface(2.0, 1.0);
    let mut rig = Rig::new(setting, Vec3::ZERO)?;
    rig.floor(material)?;
    let below = tilted(DVec3::Z, std::f64::consts::PI);
    rig.add(
        &BodyDesc::fixed()
            .with_position(Vec3::Y)
            .with_rotation(below)
            .with_shape(shape(Geometry::Plane, material)),
    )?;
    let ball = dynamic(Geometry::Sphere { radius: RADIUS as f32 }, material, Vec3::Y * 0.5);
    let ball = rig.add(&ball.with_velocity(Vec3::new(SPEED as f32, -4.0, 0.0), Vec3::ZERO))?;
    let (mut bounces, mut falls) = (0, true);
    let done = rig.until(3.0, |rig| {
        let now = rig.velocity(ball)?.y < 0.0;
        bounces += u32::from(now != falls);
        falls = now;
        Ok(bounces == 3)
    })?;
    let measured = if done { rig.velocity(ball)?.x } else { f64::NAN };
    Ok(Outcome::of(-SPEED * 333.0 / 343.0, measured))
}
