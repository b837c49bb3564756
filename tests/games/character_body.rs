//! A character with a body is seen by others.

use backstop::glam::{DVec3, Vec3};
use backstop::{
    BodyDesc, Character, CharacterBody, CharacterSettings, Geometry, Material, QueryFilter, Ray, Settings,
    ShapeDesc, World,
};

const DT: f32 = 1.0 / 60.0;

fn world() -> World {
    World::new(Settings::default().with_gravity(Vec3::ZERO)).unwrap()
}

fn character(world: &mut World, x: f64) -> (Character, CharacterBody) {
    let character = Character::new(CharacterSettings::default(), DVec3::X * x).unwrap();
    let body = CharacterBody::new(world, &character).unwrap();
    (character, body)
}

/// Expected: back with the speed that it came with, as off a wall, and rays hit the body.
#[test]
fn a_ball_bounces_off_a_character() {
    let mut world = world();
    let (hero, body) = character(&mut world, 0.0);
    let material = Material::default().with_restitution(1.0);
    let ball = BodyDesc::dynamic().with_position(DVec3::X * 2.0).with_velocity(Vec3::X * -5.0, Vec3::ZERO);
    let ball = ball.with_shape(ShapeDesc::new(Geometry::sphere(0.1)).with_material(material));
    let ball = world.add_body(&ball).unwrap();
    for _ in 0..60 {
        body.follow(&mut world, &hero, DT).unwrap();
        world.step(DT).unwrap();
    }
    assert!(world.linear_velocity(ball).unwrap().x > 1.0);
    assert_eq!(world.position(body.body()).unwrap(), DVec3::ZERO);
    let hit = world.cast_ray(&Ray::new(DVec3::Z * 5.0, Vec3::Z * -10.0), &QueryFilter::new()).unwrap();
    assert_eq!(hit.unwrap().body, body.body());
    body.remove(&mut world).unwrap();
    assert_eq!(world.body_count(), 1);
}

/// Expected: they stop at each other; without bodies they would have changed places.
#[test]
fn two_characters_do_not_walk_through_each_other() {
    let mut world = world();
    let mut both = [character(&mut world, -2.0), character(&mut world, 2.0)];
    for _ in 0..180 {
        for (i, (walker, body)) in both.iter_mut().enumerate() {
            let velocity = Vec3::X * if i == 0 { 2.0 } else { -2.0 };
            walker.walk(&world, &QueryFilter::new().excluding(body.body()), velocity, DT).unwrap();
            body.follow(&mut world, walker, DT).unwrap();
        }
        world.step(DT).unwrap();
    }
    let [left, right] = both.each_ref().map(|(walker, _)| walker.position());
    // Two radii of 0.3 m; skins are between.
    assert!(right.x - left.x > 0.59 && right.x - left.x < 1.0, "{left} {right}");
}

/// Expected: a crate in the way goes along; one that crouches is lower.
#[test]
fn a_character_pushes_and_crouches() {
    let mut world = world();
    let (mut hero, body) = character(&mut world, 0.0);
    let cube = ShapeDesc::new(Geometry::cuboid(0.3, 0.3, 0.3)).with_density(10.0);
    let cube = world.add_body(&BodyDesc::dynamic().with_position(DVec3::X).with_shape(cube)).unwrap();
    for _ in 0..120 {
        let filter = QueryFilter::only_static().excluding(body.body());
        hero.walk(&world, &filter, Vec3::X, DT).unwrap();
        body.follow(&mut world, &hero, DT).unwrap();
        world.step(DT).unwrap();
    }
    assert!(world.position(cube).unwrap().x > 2.5 && hero.position().x > 1.99);
    let low = CharacterSettings { half_height: 0.2, ..CharacterSettings::default() };
    hero.set_settings(low).unwrap();
    body.reshape(&mut world, &hero).unwrap();
    let bounds = world.aabb(body.body()).unwrap().unwrap();
    assert!((bounds.half_extents().y - 0.5).abs() < 1e-3);
}
