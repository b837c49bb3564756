//! Time that continuous collision adds for one body: in flight, at a strike, and rolling or sliding.
//!
//! A percentage of a step depends on the rest of the step. So here, worlds of [`SIDE`]² equal bodies over one
//! ground all do the same thing at once; a step is taken both ways from the same snapshot, and the difference
//! is divided by the number of bodies.

use crate::report::trace::median;
use anyhow::Context;
use backstop::glam::{DVec3, Quat, Vec3};
use backstop::{
    BodyDesc, BodyHandle, ContinuousMode, ConvexHull, Geometry, Settings, ShapeDesc, Snapshot, TriangleMesh,
    World,
};
use indicatif::ProgressBar;
use serde::Serialize;
use std::f32::consts::{FRAC_PI_2, FRAC_PI_3};
use std::sync::Arc;
use std::time::Instant;

/// Bodies per side of the square. Below 128 bodies a step stays on one thread.
const SIDE: usize = 8;
const COUNT: usize = SIDE * SIDE;
/// Distance of neighbours, which must not reach each other within a step [m].
const APART: f32 = 4.0;
/// Speed of flights and of strikes [m/s].
const FLIGHT: f32 = 50.0;
/// Speed along the ground [m/s].
const ROLL: f32 = 20.0;
/// Height out of reach of the ground [m].
const HIGH: f32 = 100.0;
/// Start above the margin of 2 cm within which discrete steps find contacts [m].
const MARGIN: f32 = 0.025;
const GROUNDS: [&str; 2] = ["mesh", "box"];
const SHAPES: [&str; 4] = ["sphere", "capsule", "box", "hull"];
/// Pairs that are measured.
pub(crate) const PAIRS: u64 = (GROUNDS.len() * SHAPES.len()) as u64;
/// Steps of 1/60 s until all rest.
const SETTLE: u32 = 60;

/// Time that continuous collision adds for a body of one shape over one ground [us]: medians over rounds.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub(crate) struct Each {
    pub(crate) shape: &'static str,
    pub(crate) ground: &'static str,
    pub(crate) bodies: usize,
    /// How many of them struck the ground in the step of strikes.
    pub(crate) strikes: u32,
    /// Additional time for a body in free flight.
    pub(crate) flight_us: f64,
    /// For a body that reaches the ground within the step, which a discrete step does not see.
    pub(crate) strike_us: f64,
    /// For a body that rolls or slides along the ground.
    pub(crate) rolling_us: f64,
    /// Additional time of a body that rests on the ground compared with a floating one, in discrete steps.
    pub(crate) resting_us: f64,
    /// `strike_us` as a multiple of that.
    pub(crate) strike_ratio: f64,
}

/// Measures all pairs of a shape and a ground.
pub(crate) fn measure(
    base: &Settings,
    dt: f32,
    repeats: usize,
    bar: &ProgressBar,
) -> anyhow::Result<Vec<Each>> {
    let mut all = Vec::new();
    for ground in GROUNDS {
        for shape in SHAPES {
            let each = Pairing::new(shape, ground, base, dt, repeats).and_then(Pairing::measure);
            all.push(each.with_context(|| format!("{shape} on {ground}"))?);
            bar.inc(1);
        }
    }
    Ok(all)
}

/// Bodies of one shape over one ground.
struct Pairing {
    shape: &'static str,
    ground: &'static str,
    /// Discrete and continuous. Nothing sleeps and no contact is recycled, so that each is processed in each
    /// step.
    modes: [Settings; 2],
    dt: f32,
    repeats: usize,
    world: World,
    bodies: Vec<BodyHandle>,
    /// Height of the origin [m] and rotation of a body that lies on the ground.
    height: f32,
    lies: Quat,
}

impl Pairing {
    fn new(
        shape: &'static str,
        ground: &'static str,
        base: &Settings,
        dt: f32,
        repeats: usize,
    ) -> anyhow::Result<Pairing> {
        let continuous = base
            .clone()
            .with_threads(1)
            .with_gravity(Vec3::NEG_Y * 9.81)
            .with_sleeping(false)
            .with_recycling(false);
        let discrete = continuous.clone().with_continuous(ContinuousMode::Discrete);
        let mut world = World::new(continuous.clone())?;
        world.add_body(&BodyDesc::fixed().with_shape(ground_of(ground)?))?;
        let (geometry, height, lies) = shape_of(shape)?;
        let bodies = (0..COUNT).map(|i| {
            let body = BodyDesc::dynamic().with_position(place(i, height)).with_rotation(lies);
            Ok(world.add_body(&body.with_shape(ShapeDesc::new(geometry.clone())))?)
        });
        let bodies = bodies.collect::<anyhow::Result<_>>()?;
        Ok(Pairing { shape, ground, modes: [discrete, continuous], dt, repeats, world, bodies, height, lies })
    }

    fn measure(mut self) -> anyhow::Result<Each> {
        let [discrete, continuous] = self.modes.clone();
        self.world.set_settings(discrete.clone())?;
        for _ in 0..SETTLE {
            self.world.step(1.0 / 60.0)?;
        }
        let resting = self.save();
        let roll = if self.shape == "sphere" || self.shape == "capsule" { ROLL / self.height } else { 0.0 };
        for &body in &self.bodies {
            self.world.set_velocity(body, Vec3::X * ROLL, Vec3::NEG_Z * roll)?;
        }
        let rolling = self.save();
        self.put(|_| (HIGH, Vec3::ZERO, Vec3::ZERO))?;
        let floating = self.save();
        let velocity = Vec3::new(0.2, -1.0, 0.1).normalize() * FLIGHT;
        self.put(|i| (HIGH, velocity, spin(i)))?;
        let flight = self.save();
        // From a tenth to nine tenths of the step, and beyond the margin of discrete contacts.
        let fall = -velocity.y * self.dt;
        self.put(|i| {
            let share = 0.1 + 0.8 * i as f32 / (COUNT - 1) as f32;
            (MARGIN + share * (fall - MARGIN).max(0.0), velocity, spin(i))
        })?;
        let strike = self.save();

        let modes = [&discrete, &continuous];
        let (flight_us, _) = self.more([&flight; 2], modes)?;
        let (strike_us, strikes) = self.more([&strike; 2], modes)?;
        let (rolling_us, _) = self.more([&rolling; 2], modes)?;
        let (resting_us, _) = self.more([&floating, &resting], [&discrete; 2])?;
        Ok(Each {
            shape: self.shape,
            ground: self.ground,
            bodies: COUNT,
            strikes,
            flight_us,
            strike_us,
            rolling_us,
            resting_us,
            strike_ratio: strike_us / resting_us,
        })
    }

    /// Places every body at a height above its resting position, with velocities.
    fn put(&mut self, at: impl Fn(usize) -> (f32, Vec3, Vec3)) -> anyhow::Result<()> {
        for (i, &body) in self.bodies.iter().enumerate() {
            let (above, linear, angular) = at(i);
            self.world.set_pose(body, place(i, self.height + above), self.lies)?;
            self.world.set_velocity(body, linear, angular)?;
        }
        Ok(())
    }

    fn save(&self) -> Snapshot {
        let mut snapshot = Snapshot::new();
        self.world.snapshot(&mut snapshot);
        snapshot
    }

    /// Time per body by which the second step is longer than the first, and the number of manifolds that
    /// pushed in it.
    fn more(&mut self, from: [&Snapshot; 2], settings: [&Settings; 2]) -> anyhow::Result<(f64, u32)> {
        let mut differences = Vec::with_capacity(self.repeats);
        let mut pushed = 0;
        for round in 0..=self.repeats {
            let mut us = [0.0; 2];
            for side in if round % 2 == 0 { [0, 1] } else { [1, 0] } {
                self.world.restore(from[side])?;
                self.world.set_settings(settings[side].clone())?;
                let start = Instant::now();
                let report = self.world.step(self.dt)?;
                us[side] = start.elapsed().as_secs_f64() * 1e6;
                if side == 1 {
                    pushed = report.pushed;
                }
            }
            // The first round does not count: buffers grow in it.
            if round > 0 {
                differences.push((us[1] - us[0]) / COUNT as f64);
            }
        }
        Ok((median(&mut differences), pushed))
    }
}

/// Where a body is, with its origin at a height.
fn place(i: usize, height: f32) -> DVec3 {
    let along = |k: usize| (k as f32 - 0.5 * (SIDE - 1) as f32) * APART;
    Vec3::new(along(i % SIDE), height, along(i / SIDE)).as_dvec3()
}

/// 5 rad/s, about an axis for each body.
fn spin(i: usize) -> Vec3 {
    Vec3::new((i % 3) as f32 - 1.0, (i % 5) as f32 - 2.0, (i % 7) as f32 - 3.0).normalize_or_zero() * 5.0
}

/// A shape of about 0.6 m, the height of its origin as it lies, and how it lies: capsules on their side.
fn shape_of(name: &str) -> anyhow::Result<(Geometry, f32, Quat)> {
    Ok(match name {
        "sphere" => (Geometry::Sphere { radius: 0.3 }, 0.3, Quat::IDENTITY),
        "capsule" => (Geometry::capsule(0.3, 0.2), 0.2, Quat::from_rotation_x(FRAC_PI_2)),
        "box" => (Geometry::cuboid(0.3, 0.2, 0.4), 0.2, Quat::IDENTITY),
        _ => {
            // A prism of six sides.
            let corner = |i: usize, y: f32| {
                let turn = Quat::from_rotation_y(i as f32 * FRAC_PI_3);
                turn * Vec3::X * 0.35 + Vec3::Y * y
            };
            let corners: Vec<Vec3> = (0..12).map(|i| corner(i % 6, if i < 6 { -0.2 } else { 0.2 })).collect();
            (Geometry::Hull(Arc::new(ConvexHull::new(&corners)?)), 0.2, Quat::IDENTITY)
        }
    })
}

/// Flat ground, so that all that lies on it rests: squares of 1 m, or a box.
fn ground_of(name: &str) -> anyhow::Result<ShapeDesc> {
    let half = SIDE as f32 * APART;
    if name == "box" {
        let mut shape = ShapeDesc::new(Geometry::cuboid(half, 1.0, half));
        shape.position = Vec3::NEG_Y;
        return Ok(shape);
    }
    let n = 2 * half as u32 + 1;
    let vertex = |i: u32| Vec3::new((i % n) as f32 - half, 0.0, (i / n) as f32 - half);
    let cell = |i: u32| {
        let corner = i / (n - 1) * n + i % (n - 1);
        [[corner, corner + n, corner + 1], [corner + 1, corner + n, corner + n + 1]]
    };
    let triangles = (0..(n - 1) * (n - 1)).flat_map(cell).collect();
    let mesh = TriangleMesh::new((0..n * n).map(vertex).collect(), triangles)?;
    Ok(ShapeDesc::new(Geometry::Mesh(Arc::new(mesh))))
}
