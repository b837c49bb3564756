//! What the user's hand does: seize, throw, make, remove, push and look at bodies.

mod grab;
mod look;
mod make;

pub(crate) use grab::Grab;
pub(crate) use look::{Inspected, look_at};
pub(crate) use make::{Aim, SHOT, Shot, shoot, spawn};

use crate::Refusal;
use crate::command::{Sight, Triple};
use backstop::glam::{DVec3, Vec3};
use backstop::{Aabb, BodyHandle, BodyKind, Overlap, QueryFilter, Ray, RayHit, World};

/// How far the eye sees [m].
const SIGHT: f32 = 2000.0;
/// The most that a user may say of lengths [m] and of impulses [N s].
const MOST: f32 = 1e6;

/// A point of the page in the world [m].
pub(crate) fn point(world: &World, at: Triple) -> DVec3 {
    world.origin() + DVec3::from_array(at.0)
}

/// A direction of the page, as a unit vector.
pub(crate) fn direction(of: Triple) -> Result<Vec3, Refusal> {
    let direction = DVec3::from_array(of.0).try_normalize();
    direction.map(|unit| unit.as_vec3()).ok_or_else(|| Refusal::told("a direction has no length"))
}

/// A ray from the eye, as far as it sees.
pub(crate) fn ray(world: &World, sight: &Sight) -> Result<Ray, Refusal> {
    Ok(Ray::new(point(world, sight.origin), direction(sight.direction)? * SIGHT))
}

/// A number that must be in a range.
fn within(what: &str, value: f32, least: f32, most: f32) -> Result<f32, Refusal> {
    let wrong = || Refusal::told(format!("{what} must be in {least}..={most}, not {value}"));
    (least..=most).contains(&value).then_some(value).ok_or_else(wrong)
}

/// The first shape that a ray meets.
fn first_hit(world: &World, ray: &Ray) -> Result<Option<RayHit>, Refusal> {
    Ok(world.cast_ray(ray, &QueryFilter::new())?)
}

/// Removes the body that is seen, unless it is static.
pub(crate) fn remove(world: &mut World, sight: &Sight) -> Result<(), Refusal> {
    if let Some(hit) = first_hit(world, &ray(world, sight)?)?
        && world.kind(hit.body)? != BodyKind::Static
    {
        world.remove_body(hit.body)?;
    }
    Ok(())
}

/// Pushes dynamic bodies away from a point: with the whole impulse [N s] there, with none at the radius [m].
pub(crate) fn explode(world: &mut World, at: Triple, radius: f32, impulse: f32) -> Result<(), Refusal> {
    let radius = within("the radius of an explosion", radius, 0.0, MOST)?;
    let impulse = within("the impulse of an explosion", impulse, -MOST, MOST)?;
    let centre = point(world, at);
    let area = Aabb { min: centre - f64::from(radius), max: centre + f64::from(radius) };
    let mut found: Vec<Overlap> = Vec::new();
    world.overlap_aabb(&area, &QueryFilter::only_dynamic(), &mut found)?;
    let mut bodies: Vec<BodyHandle> = found.iter().map(|overlap| overlap.body).collect();
    bodies.sort_unstable();
    bodies.dedup();
    for body in bodies {
        let away = (world.centre_of_mass(body)? - centre).as_vec3();
        let share = 1.0 - away.length() / radius;
        if share > 0.0 {
            // What would become too fast is left as it is.
            let _ = world.apply_impulse(body, away.normalize_or(Vec3::Y) * impulse * share);
        }
    }
    Ok(())
}
