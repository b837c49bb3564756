//! What the user's hand does: seize, throw, make, remove, push and look at bodies.

mod grab;
mod look;
mod make;

pub(crate) use grab::{drag, ends, release, seize};
pub(crate) use look::{Inspected, look_at};
pub(crate) use make::{Aim, SHOT, Shot, shoot, spawn};

use crate::Refusal;
use crate::command::{Place, Sight, Triple};
use backstop::glam::{DVec3, Vec3};
use backstop::{Aabb, BodyHandle, BodyKind, Explosion, Overlap, QueryFilter, Ray, RayHit, World};

/// How far the eye sees [m].
const SIGHT: f32 = 2000.0;
/// How far along a ray that hits nothing a place is, unless the user says it [m].
const DISTANCE: f32 = 10.0;
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

/// A place that is said or seen [m]; one that is seen on a surface is so far before it.
pub(crate) fn spot(world: &World, place: &Place, before: f64) -> Result<DVec3, Refusal> {
    let Place { position, sight, distance } = place;
    if let Some(position) = position {
        return Ok(point(world, *position));
    }
    let sight = sight.ok_or_else(|| Refusal::told("neither a position nor a ray says where"))?;
    let ray = ray(world, &sight)?;
    if let Some(hit) = first_hit(world, &ray)? {
        return Ok(hit.point + hit.normal.as_dvec3() * before);
    }
    let distance = within("the distance", distance.unwrap_or(DISTANCE), 0.0, SIGHT)?;
    Ok(ray.from + (ray.path.normalize_or_zero() * distance).as_dvec3())
}

/// An explosion.
pub(crate) struct Blast {
    /// Nothing further away than this is pushed [m].
    pub(crate) radius: f32,
    /// At the centre, on each square metre that is seen from there [N s/m²].
    pub(crate) impulse: Option<f32>,
    /// In place of an impulse, the speed that a body at the centre gets, whatever its size and mass [m/s].
    pub(crate) speed: Option<f32>,
}

/// Pushes dynamic bodies away from a place: with all of it there, with nothing at the radius.
pub(crate) fn explode(world: &mut World, place: &Place, blast: &Blast) -> Result<(), Refusal> {
    let radius = within("the radius of an explosion", blast.radius, 0.0, MOST)?;
    let impulse = within("the impulse of an explosion", blast.impulse.unwrap_or(0.0), -MOST, MOST)?;
    let speed = within("the speed of an explosion", blast.speed.unwrap_or(0.0), -MOST, MOST)?;
    let centre = spot(world, place, 0.0)?;
    if impulse != 0.0 {
        let pressure = Explosion::default().with_position(centre).with_impulse_per_area(impulse);
        world.apply_explosion(&pressure.with_radius(0.0).with_falloff(radius))?;
        return Ok(());
    }
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
            let push = speed * world.mass(body)? * share;
            // What would become too fast is left as it is.
            let _ = world.apply_impulse(body, away.normalize_or(Vec3::Y) * push);
        }
    }
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;
    use backstop::{BodyDesc, Geometry, Settings, ShapeDesc};

    #[test]
    fn a_place_is_said_or_seen() {
        let mut world = World::new(Settings::default()).unwrap();
        let floor = ShapeDesc::new(Geometry::cuboid(5.0, 1.0, 5.0));
        world.add_body(&BodyDesc::fixed().with_shape(floor)).unwrap();
        let sight =
            |down: f64| Sight { origin: Triple([0.0, 4.0, 0.0]), direction: Triple([0.0, down, 0.0]) };
        let nowhere = Place { position: None, sight: None, distance: None };
        let seen = |place: Place| spot(&world, &place, 0.25).unwrap().to_array();
        assert_eq!(seen(Place { position: Some(Triple([1.0, 2.0, 3.0])), ..nowhere }), [1.0, 2.0, 3.0]);
        // On the floor, whose top is at a height of 1 m, and in the air above the eye.
        assert_eq!(seen(Place { sight: Some(sight(-1.0)), ..nowhere }), [0.0, 1.25, 0.0]);
        assert_eq!(seen(Place { sight: Some(sight(1.0)), distance: Some(3.0), ..nowhere }), [0.0, 7.0, 0.0]);
        assert!(spot(&world, &nowhere, 0.0).is_err());
    }

    #[test]
    fn an_explosion_of_a_speed_throws_all_alike() {
        let mut world = World::new(Settings::default().with_gravity(Vec3::ZERO)).unwrap();
        let mut add = |x: f64, radius: f32| {
            let ball = ShapeDesc::new(Geometry::sphere(radius));
            world.add_body(&BodyDesc::dynamic().with_position(DVec3::X * x).with_shape(ball)).unwrap()
        };
        let [small, large, far] = [add(-1.0, 0.1), add(1.0, 0.4), add(3.0, 0.4)];
        let place = Place { position: Some(Triple([0.0; 3])), sight: None, distance: None };
        explode(&mut world, &place, &Blast { radius: 2.0, impulse: None, speed: Some(8.0) }).unwrap();
        let along = |body| world.linear_velocity(body).unwrap().x;
        assert!((along(small) + 4.0).abs() < 1e-4 && (along(large) - 4.0).abs() < 1e-4);
        assert_eq!(along(far), 0.0);
    }
}
