//! Who collides with whom, and who sees whom: categories and groups, a query's own predicate, and a hook's
//! veto.
//!
//!     cargo run --example filter

use backstop::glam::{DVec3, Vec3};
use backstop::{
    BodyDesc, BodyHandle, ContactHook, ContactHooks, Error, Filter, Geometry, QueryFilter, Ray, Settings,
    ShapeDesc, ShapeHandle, World,
};

const WALL: u64 = 1;
const GHOST: u64 = 2;
const GAZE: u64 = 4;

/// Where a rule is more than bits: balls pass through each other if their numbers are of the same team.
struct Teams;

impl ContactHooks for Teams {
    fn contact(&self, contact: &mut ContactHook<'_>) {
        let [a, b] = contact.user_data();
        if a == b && a != 0 {
            contact.veto();
        }
    }
}

/// A ball in free flight along x, of a team.
fn ball(world: &mut World, x: f64, row: f64, filter: Filter, team: u64) -> Result<BodyHandle, Error> {
    let shape = ShapeDesc::new(Geometry::Sphere { radius: 0.5 }).with_hooks();
    let shape = shape.clone().with_filter(filter).with_user_data(team);
    let towards = Vec3::X * if x < 0.0 { 4.0 } else { -4.0 };
    world.add_body(
        &BodyDesc::dynamic()
            .with_position(DVec3::new(x, 0.0, row))
            .with_velocity(towards, Vec3::ZERO)
            .with_shape(shape),
    )
}

fn main() -> Result<(), Error> {
    let mut world = World::new(Settings::default().with_gravity(Vec3::ZERO))?;
    let plain = Filter::default();
    // A wall at x = 0 across the first two rows. A ghost is of its own category and has walls not in its
    // mask.
    let wall = ShapeDesc::new(Geometry::cuboid(0.1, 2.0, 3.0)).with_filter(plain.with_category(WALL));
    let wall = world.add_body(&BodyDesc::fixed().with_shape(wall))?;
    let solid = ball(&mut world, -4.0, -1.5, plain, 0)?;
    let ghost = ball(&mut world, -4.0, 1.5, plain.with_category(GHOST).with_mask(!WALL), 0)?;
    // Pairs that fly at each other: of one negative group, of one team, of two.
    let apart = plain.with_group(-7);
    let group = [ball(&mut world, -4.0, 10.0, apart, 0)?, ball(&mut world, 4.0, 10.0, apart, 0)?];
    let mates = [ball(&mut world, -4.0, 20.0, plain, 1)?, ball(&mut world, 4.0, 20.0, plain, 1)?];
    let foes = [ball(&mut world, -4.0, 30.0, plain, 1)?, ball(&mut world, 4.0, 30.0, plain, 2)?];

    // A gaze along the second row: all, what a ghost would collide with, and what one's own word lets it see.
    let ray = Ray::new(DVec3::new(-8.0, 0.0, 1.5), Vec3::X * 20.0);
    let seen = |filter: QueryFilter<'_>| Ok(world.cast_ray(&ray, &filter)?.map(|hit| hit.body));
    let ghosts = plain.with_category(GAZE).with_mask(GHOST);
    let alive = |body: BodyHandle, _: ShapeHandle| body != ghost;
    assert_eq!(seen(QueryFilter::new())?, Some(ghost));
    assert_eq!(seen(QueryFilter::new().with_predicate(&alive))?, Some(wall));
    assert_eq!(seen(QueryFilter::new().with_filter(ghosts))?, Some(ghost));
    assert_eq!(seen(QueryFilter::only_static().with_filter(ghosts))?, None::<BodyHandle>);

    for _ in 0..120 {
        world.step_with(1.0 / 60.0, &Teams)?;
    }
    let crossed = |body: BodyHandle| Ok::<bool, Error>(world.position(body)?.x > 0.0);
    println!(
        "solid {}, ghost {}, group {}, mates {}, foes {}",
        crossed(solid)?,
        crossed(ghost)?,
        crossed(group[0])?,
        crossed(mates[0])?,
        crossed(foes[0])?
    );
    assert!(!crossed(solid)? && crossed(ghost)?, "a wall is none for a ghost");
    assert!(crossed(group[0])? && crossed(mates[0])? && !crossed(foes[0])?);
    Ok(())
}
