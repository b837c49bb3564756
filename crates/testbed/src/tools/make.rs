//! Bodies that the user makes.

use super::{direction, point, spot, within};
use crate::Refusal;
use crate::command::{Form, Place, Triple};
use backstop::glam::{DVec3, Quat, Vec3};
use backstop::{BodyDesc, Geometry, ShapeDesc, Skeleton, World};
use backstop_scene::{Rng, builtin};

/// Size of what is shot, unless the user says another one [m].
pub(crate) const SHOT: f32 = 0.3;
/// Size of what is made [m].
const MADE: f32 = 0.5;
/// Limits of both [m], and of the speed of shots [m/s].
const SIZES: [f32; 2] = [0.02, 20.0];
const MOST_SPEED: f32 = 1000.0;
/// Height of the middle of a figure [m].
const WAIST: f64 = 1.0;
/// Corners of a hull.
const CORNERS: usize = 16;

/// What is made.
pub(crate) struct Shot {
    pub(crate) shape: Form,
    /// Its height or diameter, if it is not the usual one [m].
    pub(crate) size: Option<f32>,
    /// Says which hull it is.
    pub(crate) hull: u64,
}

/// Where a shot comes from, and where it goes.
pub(crate) struct Aim {
    pub(crate) origin: Triple,
    pub(crate) direction: Triple,
    /// [m/s]
    pub(crate) speed: f32,
}

/// Makes a body that flies.
pub(crate) fn shoot(world: &mut World, aim: &Aim, shot: &Shot) -> Result<(), Refusal> {
    let speed = within("speed", aim.speed, 0.0, MOST_SPEED)?;
    let velocity = direction(aim.direction)? * speed;
    make(world, point(world, aim.origin), velocity, shot)
}

/// Makes a body at rest, on the surface that is seen.
pub(crate) fn spawn(world: &mut World, place: &Place, shot: &Shot) -> Result<(), Refusal> {
    let half = if shot.shape == Form::Ragdoll { WAIST } else { 0.5 * f64::from(shot.size.unwrap_or(MADE)) };
    make(world, spot(world, place, half)?, Vec3::ZERO, shot)
}

fn make(world: &mut World, at: DVec3, velocity: Vec3, shot: &Shot) -> Result<(), Refusal> {
    let [least, most] = SIZES;
    let size = within("size", shot.size.unwrap_or(MADE), least, most)?;
    let Some(geometry) = geometry(shot.shape, size, shot.hull) else {
        Skeleton::humanoid().add_to(world, at - DVec3::Y * WAIST, Quat::IDENTITY, velocity)?;
        return Ok(());
    };
    let body = BodyDesc::dynamic()
        .with_position(at)
        .with_velocity(velocity, Vec3::ZERO)
        .with_shape(ShapeDesc::new(geometry));
    world.add_body(&body)?;
    Ok(())
}

/// A form of this size; none for a figure.
fn geometry(form: Form, size: f32, hull: u64) -> Option<Geometry> {
    let half = 0.5 * size;
    Some(match form {
        Form::Box => Geometry::cuboid(half, half, half),
        Form::Sphere => Geometry::sphere(half),
        Form::Capsule => Geometry::capsule(0.5 * half, 0.5 * half),
        Form::TaperedCapsule => Geometry::tapered_capsule(0.4 * half, 0.6 * half, 0.35 * half),
        Form::Cylinder => Geometry::cylinder(half, 0.7 * half),
        Form::TaperedCylinder => Geometry::tapered_cylinder(half, 0.8 * half, 0.4 * half),
        Form::Cone => Geometry::cone(half, 0.7 * half),
        Form::Hull => builtin::pebble(CORNERS, Vec3::new(1.0, 0.8, 1.1) * half, &mut Rng::new(hull)),
        Form::Ragdoll => return None,
    })
}
