//! Bodies that roll, or begin to.

use super::case::{Case, Outcome, Setting};
use super::rig::{DOWN, G, Rig, dynamic, shape, smooth, stretch, surface, tilted};
use super::watch::{Passages, Turns, threshold};
use backstop::BodyDesc;
use backstop::BodyHandle;
use backstop::Error;
use backstop::{Geometry, MassProperties, Material, TriangleMesh};
use glam::{DVec3, Mat3, Vec3};
use std::f64::consts::{FRAC_PI_2, TAU};
use std::sync::Arc;

pub(super) const CASES: &[Case] = &[
    Case {
        name: "slip-to-roll",
        about: "a ball thrown along the floor without spin: its speed once it rolls",
        formula: "v = 5 v0 / 7",
        unit: "m/s",
        bar: 1e-3,
        measure: slip_speed,
    },
    Case {
        name: "slip-time",
        about: "the same: the time until it rolls, from its slip at a quarter and three quarters of it",
        formula: "t = 2 v0 / (7 mu g)",
        unit: "s",
        bar: 0.01,
        measure: slip_time,
    },
    Case {
        name: "slip-distance",
        about: "the same: the distance until it rolls",
        formula: "d = 12 v0² / (49 mu g)",
        unit: "m",
        bar: 0.01,
        measure: slip_distance,
    },
    Case {
        name: "backspin",
        about: "a ball with backspin of 4 v0 / r comes back: its speed once it rolls",
        formula: "v = (5 v0 + 2 r w0) / 7 < 0, since -r w0 > 5 v0 / 2",
        unit: "m/s",
        bar: 1e-3,
        measure: backspin,
    },
    Case {
        name: "roll-sphere",
        about: "a sphere rolls down 20 degrees: its acceleration",
        formula: "a = g sin th / (1 + 2/5)",
        unit: "m/s²",
        bar: 1e-3,
        measure: |setting| roll_down(setting, Roller::Sphere),
    },
    Case {
        name: "roll-cylinder",
        about: "the same with a solid cylinder",
        formula: "a = g sin th / (1 + 1/2)",
        unit: "m/s²",
        bar: 1e-3,
        measure: |setting| roll_down(setting, Roller::Cylinder),
    },
    Case {
        name: "roll-hoop",
        about: "the same with a hoop",
        formula: "a = g sin th / (1 + 1)",
        unit: "m/s²",
        bar: 1e-3,
        measure: |setting| roll_down(setting, Roller::Hoop),
    },
    Case {
        name: "roll-grip",
        about: "a sphere on a slope of 20 degrees: the friction from which on it rolls without slipping",
        formula: "mu = 2/7 tan th",
        unit: "",
        bar: 0.01,
        measure: roll_grip,
    },
    Case {
        name: "turntable",
        about: "a ball rolls on a turntable: the rate at which its path goes round",
        formula: "2/7 of the table's",
        unit: "rad/s",
        bar: 0.005,
        measure: turntable,
    },
    Case {
        name: "bowl-rolling",
        about: "a ball rolls to and fro in a round valley of half degrees, 20 degrees to each side: the \
            period",
        formula: "T = 2 pi sqrt(7 (R - r) / (5 g)) K",
        unit: "s",
        bar: 0.01,
        measure: |setting| valley(setting, surface(1.0, 0.0), 1.4),
    },
    Case {
        name: "bowl-smooth",
        about: "the same without friction",
        formula: "T = 2 pi sqrt((R - r) / g) K",
        unit: "s",
        bar: 0.01,
        measure: |setting| valley(setting, smooth(0.0), 1.0),
    },
    Case {
        name: "cue-parabola",
        about: "a ball with a spin about the direction of its path slips obliquely: how far aside it is \
            halfway to rolling",
        formula: "z = mu g t² / 2 u_z / |u|, u the slip at the start (Coriolis 1835)",
        unit: "m",
        bar: 0.02,
        measure: |setting| cue(setting, false),
    },
    Case {
        name: "cue-direction",
        about: "the same: the angle of its path once it rolls",
        formula: "v' = v - 2/7 u",
        unit: "rad",
        bar: 1e-3,
        measure: |setting| cue(setting, true),
    },
    Case {
        name: "cylinder-ball",
        about: "a ball rolls round inside an upright cylinder of 360 flat sides: how often, while it goes down \
            and up once",
        formula: "sqrt(7/2) = 1.871 (Gualtieri and others 2006)",
        unit: "",
        bar: 0.02,
        measure: upright_cylinder,
    },
];

const RADIUS: f64 = 0.5;
const BALL: Geometry = Geometry::Sphere { radius: RADIUS as f32 };
const MU: f64 = 0.3;

/// A ball on a floor, thrown along x with a spin about z.
fn thrown(setting: &Setting, speed: f64, spin: f64) -> Result<(Rig, BodyHandle), Error> {
    let mut rig = Rig::new(setting, DOWN)?;
    rig.floor(surface(MU, 0.0))?;
    let ball = dynamic(BALL, surface(MU, 0.0), Vec3::Y * RADIUS as f32);
    let ball = rig.add(&ball.with_velocity(Vec3::X * speed as f32, Vec3::Z * spin as f32))?;
    Ok((rig, ball))
}

const SPEED: f64 = 4.0;

fn slip_speed(setting: &Setting) -> Result<Outcome, Error> {
    let (mut rig, ball) = thrown(setting, SPEED, 0.0)?;
    rig.run_to(2.0)?;
    Ok(Outcome::of(SPEED * 5.0 / 7.0, rig.velocity(ball)?.x))
}

/// Time until it rolls [s].
const SLIPS: f64 = 2.0 * SPEED / (7.0 * MU * G);

fn slip_time(setting: &Setting) -> Result<Outcome, Error> {
    let (mut rig, ball) = thrown(setting, SPEED, 0.0)?;
    let slip = |rig: &Rig| Ok(rig.velocity(ball)?.x + RADIUS * rig.spin(ball)?.z);
    rig.run_to(0.25 * SLIPS)?;
    let (then, fast): (f64, f64) = (rig.time, slip(&rig)?);
    rig.run_to(0.75 * SLIPS)?;
    let slow = slip(&rig)?;
    Ok(Outcome::of(SLIPS, rig.time + slow * (rig.time - then) / (fast - slow)))
}

fn slip_distance(setting: &Setting) -> Result<Outcome, Error> {
    let (mut rig, ball) = thrown(setting, SPEED, 0.0)?;
    rig.run_to(2.0)?;
    let rolled = (rig.time - SLIPS) * SPEED * 5.0 / 7.0;
    Ok(Outcome::of(12.0 * SPEED * SPEED / (49.0 * MU * G), rig.place(ball)?.x - rolled))
}

fn backspin(setting: &Setting) -> Result<Outcome, Error> {
    let speed = 2.0;
    // A ball that rolls along x rotates about -z.
    let (mut rig, ball) = thrown(setting, speed, 4.0 * speed / RADIUS)?;
    rig.run_to(3.0)?;
    Ok(Outcome::of((5.0 - 2.0 * 4.0) * speed / 7.0, rig.velocity(ball)?.x))
}

#[derive(Clone, Copy)]
enum Roller {
    Sphere,
    Cylinder,
    Hoop,
}

const SLOPE: f64 = 20.0;

/// A body at rest on a slope that descends along x.
fn on_slope(
    setting: &Setting,
    roller: Roller,
    material: Material,
) -> Result<(Rig, BodyHandle, DVec3), Error> {
    let tilt = tilted(DVec3::Z, -SLOPE.to_radians());
    let mut rig = Rig::new(setting, DOWN)?;
    rig.add(&BodyDesc::fixed().with_rotation(tilt).with_shape(shape(Geometry::Plane, material)))?;
    let at = tilt * (Vec3::Y * RADIUS as f32);
    let mut body = match roller {
        Roller::Sphere => dynamic(BALL, material, at),
        Roller::Cylinder | Roller::Hoop => {
            let across = tilted(DVec3::X, FRAC_PI_2);
            dynamic(Geometry::cylinder(0.3, RADIUS as f32), material, at).with_rotation(across)
        }
    };
    if let Roller::Hoop = roller {
        // All mass is at the radius, over the width of the cylinder.
        let inertia = Mat3::from_diagonal(Vec3::new(0.16, 0.25, 0.16));
        body.mass = Some(MassProperties { mass: 1.0, centre_of_mass: Vec3::ZERO, inertia });
    }
    let body = rig.add(&body)?;
    Ok((rig, body, (tilt * Vec3::X).as_dvec3()))
}

fn roll_down(setting: &Setting, roller: Roller) -> Result<Outcome, Error> {
    let (mut rig, body, down) = on_slope(setting, roller, surface(1.0, 0.0))?;
    rig.run_to(0.5)?;
    let (then, before) = (rig.time, rig.velocity(body)?.dot(down));
    rig.run_to(2.5)?;
    let measured = (rig.velocity(body)?.dot(down) - before) / (rig.time - then);
    let k = match roller {
        Roller::Sphere => 0.4,
        Roller::Cylinder => 0.5,
        Roller::Hoop => 1.0,
    };
    Ok(Outcome::of(G * libm::sin(SLOPE.to_radians()) / (1.0 + k), measured))
}

fn roll_grip(setting: &Setting) -> Result<Outcome, Error> {
    let want = libm::tan(SLOPE.to_radians()) * 2.0 / 7.0;
    let found = threshold([0.5 * want, 1.5 * want], 10, |friction| {
        let (mut rig, body, down) = on_slope(setting, Roller::Sphere, surface(friction, 0.0))?;
        rig.run_to(2.0)?;
        let speed = rig.velocity(body)?.dot(down);
        Ok((speed + RADIUS * rig.spin(body)?.z).abs() < 1e-3 * speed)
    })?;
    Ok(Outcome::of(want, found))
}

fn turntable(setting: &Setting) -> Result<Outcome, Error> {
    const RATE: f64 = 7.0;
    let mut rig = Rig::new(setting, DOWN)?;
    let table = BodyDesc::kinematic().with_shape(shape(Geometry::Plane, surface(1.0, 0.0)));
    rig.add(&table.with_velocity(Vec3::ZERO, Vec3::Y * RATE as f32))?;
    // It starts on its circle about the axis with the spin of rolling: v - w x r = the table's velocity
    // there.
    let speed = 1.0;
    let at = DVec3::new(speed / (RATE * 2.0 / 7.0), 0.1, 0.0);
    let velocity = DVec3::NEG_Z * speed;
    let slip = DVec3::NEG_Z * (RATE * at.x) - velocity;
    let spin = slip.cross(DVec3::Y) / 0.1;
    let ball = dynamic(Geometry::Sphere { radius: 0.1 }, surface(1.0, 0.0), at.as_vec3());
    let ball = rig.add(&ball.with_velocity(velocity.as_vec3(), spin.as_vec3()))?;
    let mut turns = Turns::default();
    rig.until(10.0, |rig| {
        let v = rig.velocity(ball)?;
        turns.see(libm::atan2(-v.z, v.x));
        Ok(false)
    })?;
    Ok(Outcome::of(RATE * 2.0 / 7.0, turns.gone / (rig.time - f64::from(rig.dt))))
}

/// A ball in a valley along z, whose round floor consists of strips of half a degree.
fn valley(setting: &Setting, material: Material, heavier: f64) -> Result<Outcome, Error> {
    const SMALL: f64 = 0.2;
    // The centre of the ball is 1 m from the valley's axis.
    const LARGE: f64 = 1.0 + SMALL;
    const STRIPS: u32 = 160;
    let mut vertices = Vec::new();
    for i in 0..=STRIPS {
        let (sin, cos) = libm::sincos((0.5 * f64::from(i) - 40.0).to_radians());
        for z in [-1.0, 1.0] {
            vertices.push(DVec3::new(LARGE * sin, -LARGE * cos, z).as_vec3());
        }
    }
    let triangles =
        (0..STRIPS).flat_map(|i| [[2 * i, 2 * i + 1, 2 * i + 2], [2 * i + 2, 2 * i + 1, 2 * i + 3]]);
    let mesh = TriangleMesh::new(vertices, triangles.collect::<Vec<_>>())?;
    let mut rig = Rig::new(setting, DOWN)?;
    rig.add(&BodyDesc::fixed().with_shape(shape(Geometry::Mesh(Arc::new(mesh)), material)))?;
    let start = 20f64.to_radians();
    let at = DVec3::new(libm::sin(start), -libm::cos(start), 0.0).as_vec3();
    let ball = rig.add(&dynamic(Geometry::Sphere { radius: SMALL as f32 }, material, at))?;
    let mut passages = Passages::default();
    rig.until(8.0, |rig| {
        passages.see(rig.time, rig.place(ball)?.x);
        Ok(passages.times.len() == 3)
    })?;
    Ok(Outcome::of(TAU * (heavier * (LARGE - SMALL) / G).sqrt() * stretch(start), passages.period()))
}

/// The slip and its direction stay the same until the ball rolls: the path is a parabola.
fn cue(setting: &Setting, direction: bool) -> Result<Outcome, Error> {
    let (speed, spin) = (3.0, 8.0);
    let slip = DVec3::new(speed, 0.0, -RADIUS * spin);
    let mut rig = Rig::new(setting, DOWN)?;
    rig.floor(surface(MU, 0.0))?;
    let ball = dynamic(BALL, surface(MU, 0.0), Vec3::Y * RADIUS as f32);
    let ball = rig.add(&ball.with_velocity(Vec3::X * speed as f32, Vec3::X * spin as f32))?;
    let rolls = 2.0 * slip.length() / (7.0 * MU * G);
    if direction {
        rig.run_to(2.0 * rolls)?;
        let (want, v) = (DVec3::X * speed - slip * (2.0 / 7.0), rig.velocity(ball)?);
        return Ok(Outcome::of(libm::atan2(want.z, want.x), libm::atan2(v.z, v.x)));
    }
    rig.run_to(0.5 * rolls)?;
    let want = -0.5 * MU * G * rig.time * rig.time * slip.z / slip.length();
    Ok(Outcome::of(want, rig.place(ball)?.z))
}

/// With the spin about the radial direction, which grows with the height, friction is a spring: of the ball
/// at distance a from the axis, `(m r² + I) z" = -I W² z - m g r²`, with I = 2/5 m r².
fn upright_cylinder(setting: &Setting) -> Result<Outcome, Error> {
    const SMALL: f64 = 0.2;
    const RATE: f64 = 4.0;
    const SIDES: u32 = 360;
    let vertices = (0..=SIDES).flat_map(|i| {
        let (sin, cos) = libm::sincos(f64::from(i) * TAU / f64::from(SIDES));
        // The middles of the sides touch a circle of radius 1 m and the ball's own.
        let radius = (1.0 + SMALL) / libm::cos(0.5 * TAU / f64::from(SIDES));
        [-5.0, 2.0].map(|y| DVec3::new(radius * cos, y, -radius * sin).as_vec3())
    });
    // Seen from the axis.
    let triangles =
        (0..SIDES).flat_map(|i| [[2 * i, 2 * i + 2, 2 * i + 1], [2 * i + 2, 2 * i + 3, 2 * i + 1]]);
    let mesh = TriangleMesh::new(vertices.collect::<Vec<_>>(), triangles.collect::<Vec<_>>())?;
    let mut rig = Rig::new(setting, DOWN)?;
    let material = surface(2.0, 0.0);
    rig.add(&BodyDesc::fixed().with_shape(shape(Geometry::Mesh(Arc::new(mesh)), material)))?;
    let middle = 0.5 * TAU / f64::from(SIDES);
    let (sin, cos) = libm::sincos(middle);
    let ball = dynamic(Geometry::Sphere { radius: SMALL as f32 }, material, Vec3::ZERO);
    let ball = ball.with_position(DVec3::new(cos, 0.0, -sin));
    let velocity = DVec3::new(-sin, 0.0, -cos) * RATE;
    let ball = rig.add(&ball.with_velocity(velocity.as_vec3(), Vec3::NEG_Y * (RATE / SMALL) as f32))?;
    // The rate at which it goes round falls on flat sides; the ratio does not depend on it.
    let mut turns = Turns::default();
    // Height and angle where it was lowest, and then highest.
    let (mut low, mut high) = ((0.0, 0.0), (f64::NEG_INFINITY, 0.0));
    let turned = rig.until(10.0, |rig| {
        let place = rig.place(ball)?;
        turns.see(libm::atan2(-place.z, place.x));
        let now = (place.y, turns.gone);
        if now.0 < low.0 {
            (low, high) = (now, (f64::NEG_INFINITY, 0.0));
        } else if now.0 > high.0 {
            high = now;
        }
        Ok(high.0 > low.0 + 0.5 && now.0 < high.0 - 0.1)
    })?;
    let measured = if turned { high.1 / TAU } else { f64::NAN };
    Ok(Outcome::of(3.5f64.sqrt(), measured))
}
