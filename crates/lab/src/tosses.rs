//! Measured tosses of a cube against the same tosses simulated.
//!
//! The measurements are those of Pfrommer, Halm and Posa, *ContactNets* (CoRL 2020): an acrylic cube thrown
//! onto a plate, its pose taken 148 times a second. A run starts at the first sample; its deviation at each
//! later sample is averaged over the toss, and that over all tosses.

use crate::LabWorld;
use crate::WorldSolver;
use backstop::BodyDesc;
use backstop::Error;
use backstop::Settings;
use backstop::World;
use backstop::limits::{positive, within};
use backstop::{Geometry, MassProperties, Material, ShapeDesc};
use glam::{DQuat, DVec3, Mat3, Quat, Vec3};

/// A cube as it was measured at one time. The plate is the plane z = 0, and gravity points down z.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Sample {
    /// Time since the first sample [s].
    pub time: f64,
    /// Position of the centre [m].
    pub position: DVec3,
    /// From the cube's frame to the world's.
    pub rotation: DQuat,
    /// Velocity of the centre [m/s].
    pub velocity: DVec3,
    /// Angular velocity in the cube's own frame [rad/s].
    pub body_spin: DVec3,
}

/// The thrown cube and the plate.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Cube {
    /// Half of its width [m]. Default 0.0524.
    pub half_width: f32,
    /// Mass [kg]. Default 0.37.
    pub mass: f32,
    /// Moment of inertia about each axis [kg m²]. Default 0.00081.
    pub inertia: f32,
    /// Default 0.18.
    pub friction: f32,
    /// Default 0.125.
    pub restitution: f32,
    /// How far the plate is lowered [m]: the lowest measured corner lies up to 6 mm below it. Default 0.
    pub lowered: f64,
}

impl Default for Cube {
    fn default() -> Cube {
        Cube {
            half_width: 0.0524,
            mass: 0.37,
            inertia: 0.00081,
            friction: 0.18,
            restitution: 0.125,
            lowered: 0.0,
        }
    }
}

/// How far a simulated toss is from the measured one, in the mean over its samples and at the last.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Deviation {
    /// Deviation of the centre [widths of the cube].
    pub position: f64,
    /// Deviation of the rotation [rad].
    pub rotation: f64,
    /// Deviation of the centre at the end [widths of the cube].
    pub last_position: f64,
    /// Deviation of the rotation at the end [rad].
    pub last_rotation: f64,
}

impl Deviation {
    /// The mean of several deviations; zero if there are none.
    pub fn mean(of: &[Deviation]) -> Deviation {
        let share = 1.0 / of.len().max(1) as f64;
        of.iter().fold(Deviation::default(), |sum, one| Deviation {
            position: sum.position + share * one.position,
            rotation: sum.rotation + share * one.rotation,
            last_position: sum.last_position + share * one.last_position,
            last_rotation: sum.last_rotation + share * one.last_rotation,
        })
    }
}

/// Simulates a toss from its first sample and compares it with the others. Each interval between samples is
/// cut into `parts` steps; gravity of the settings is replaced. `solver`: what solves the steps, if not the
/// fast path.
///
/// # Errors
/// If there are less than two samples, a number is not finite or out of range, or times do not rise.
pub fn deviation(
    samples: &[Sample],
    cube: &Cube,
    settings: &Settings,
    solver: Option<&WorldSolver>,
    parts: u32,
) -> Result<Deviation, Error> {
    let [first, later @ ..] = samples else {
        return Err(Error::Incomplete { what: "a toss", expected: "two samples" });
    };
    if later.is_empty() {
        return Err(Error::Incomplete { what: "a toss", expected: "two samples" });
    }
    within("parts of an interval", parts as f32, 1.0, 1e4, "in 1..=10000")?;
    positive("half width", cube.half_width)?;
    let (mut world, body) = start(first, cube, settings)?;
    world.solve_with(solver.cloned());
    let mut sum = Deviation::default();
    let mut time = first.time;
    for sample in later {
        let dt = (sample.time - time) / f64::from(parts);
        for _ in 0..parts {
            world.step(dt as f32)?;
        }
        time = sample.time;
        let width = 2.0 * f64::from(cube.half_width);
        let position = (world.position(body)? - sample.position).length() / width;
        let turned = world.rotation(body)?.as_dquat().conjugate() * sample.rotation.normalize();
        let rotation = 2.0 * libm::atan2(turned.xyz().length(), turned.w.abs());
        sum.position += position;
        sum.rotation += rotation;
        (sum.last_position, sum.last_rotation) = (position, rotation);
    }
    let count = later.len() as f64;
    Ok(Deviation { position: sum.position / count, rotation: sum.rotation / count, ..sum })
}

fn start(first: &Sample, cube: &Cube, settings: &Settings) -> Result<(World, backstop::BodyHandle), Error> {
    let settings = settings.clone().with_gravity(Vec3::NEG_Z * 9.81).with_length_unit(2.0 * cube.half_width);
    let mut world = World::new(settings)?;
    let material = Material::default().with_friction(cube.friction).with_restitution(cube.restitution);
    let shape = |geometry| ShapeDesc::new(geometry).with_material(material);
    // A plane's normal is the y axis of its body.
    let up = Quat::from_rotation_arc(Vec3::Y, Vec3::Z);
    let plate = BodyDesc::fixed().with_position(DVec3::NEG_Z * cube.lowered).with_rotation(up);
    world.add_body(&plate.with_shape(shape(Geometry::Plane)))?;
    let rotation = first.rotation.normalize();
    let inertia = Mat3::from_diagonal(Vec3::splat(cube.inertia));
    let desc = BodyDesc::dynamic()
        .with_mass(Some(MassProperties { mass: cube.mass, centre_of_mass: Vec3::ZERO, inertia }))
        .with_position(first.position)
        .with_rotation(rotation.as_quat())
        .with_velocity(first.velocity.as_vec3(), (rotation * first.body_spin).as_vec3())
        .with_shape(shape(Geometry::cuboid(cube.half_width, cube.half_width, cube.half_width)));
    let body = world.add_body(&desc)?;
    Ok((world, body))
}
