//! A character climbs stairs, rides a platform over a gap, and jumps against a ceiling.
//!
//!     cargo run --example character

use backstop::glam::{DVec3, Quat, Vec3};
use backstop::{
    BodyDesc, BodyHandle, Character, CharacterReport, CharacterSettings, Error, Geometry, QueryFilter,
    Settings, ShapeDesc, World,
};
use std::time::Instant;

const DT: f32 = 1.0 / 60.0;

fn cuboid(world: &mut World, kind: BodyDesc, at: [f64; 3], half: [f32; 3]) -> Result<BodyHandle, Error> {
    let shape = ShapeDesc::new(Geometry::cuboid(half[0], half[1], half[2]));
    world.add_body(&kind.with_position(DVec3::from(at)).with_shape(shape))
}

/// One frame: what the player wants, and what gravity has made of the fall so far.
fn frame(
    world: &World,
    character: &mut Character,
    wish: Vec3,
    velocity: Vec3,
) -> Result<CharacterReport, Error> {
    let fall = velocity.y + world.settings().gravity.y * DT;
    character.walk(world, &QueryFilter::new(), Vec3::new(wish.x, fall + wish.y, wish.z), DT)
}

fn main() -> Result<(), Error> {
    let mut world = World::new(Settings::default())?;
    cuboid(&mut world, BodyDesc::fixed(), [0.0, -0.5, 0.0], [3.0, 0.5, 2.0])?;
    // Ten stairs of 0.2 m up to a ledge that ends at x = 8.
    for i in 0..10 {
        let (x, top) = (1.0 + 0.3 * f64::from(i), 0.2 * f64::from(i + 1));
        cuboid(&mut world, BodyDesc::fixed(), [x + 0.15, 0.5 * top, 0.0], [0.15, 0.5 * top as f32, 2.0])?;
    }
    cuboid(&mut world, BodyDesc::fixed(), [6.0, 1.0, 0.0], [2.0, 1.0, 2.0])?;
    // A platform that goes 4 m to and fro, and a ledge beyond with a low ceiling.
    let platform = cuboid(&mut world, BodyDesc::kinematic(), [9.0, 1.9, 0.0], [1.0, 0.1, 1.0])?;
    cuboid(&mut world, BodyDesc::fixed(), [17.0, 1.0, 0.0], [3.0, 1.0, 2.0])?;
    cuboid(&mut world, BodyDesc::fixed(), [17.0, 4.5, 0.0], [3.0, 0.1, 2.0])?;

    let mut character = Character::new(CharacterSettings::default(), DVec3::new(-2.0, 1.0, 0.0))?;
    let mut last = CharacterReport::default();
    let (mut carried, mut highest, mut took) = (0.0, 0.0_f64, 0.0);
    for step in 0..540 {
        let time = step as f32 * DT;
        // Starts at 4 s, arrives at 6 s.
        let x = 9.0 + 2.0 * f64::from((time - 4.0).clamp(0.0, 2.0));
        world.move_kinematic(platform, DVec3::new(x, 1.9, 0.0), Quat::IDENTITY, DT)?;
        // Onto the platform, wait, off it, and a jump at 8 s.
        let speed = if time < 3.6 || (6.1..7.5).contains(&time) { 3.0 } else { 0.0 };
        let jump = if step == 480 && last.ground.is_some() { 6.0 } else { 0.0 };
        world.step(DT)?;
        let start = Instant::now();
        last = frame(&world, &mut character, Vec3::new(speed, jump, 0.0), last.velocity)?;
        took += start.elapsed().as_secs_f64();
        carried += last.carried.x;
        highest = highest.max(character.feet().y);
        if step % 60 == 59 {
            let feet = character.feet();
            let on = if last.ground.is_some() { "on the ground" } else { "in the air" };
            println!("{:.0} s: ({:.2}, {:.2}) m, {on}", time + DT, feet.x, feet.y);
        }
    }
    println!("{:.1} us a walk", 1e6 * took / 540.0);
    assert!((carried - 4.0).abs() < 0.01, "the platform carried it over the gap: {carried}");
    // 4.4 m less its height of 1.84 m.
    assert!((highest - 2.56).abs() < 0.001, "its head touched the ceiling: {highest}");
    assert!(last.ground.is_some() && (character.feet().y - 2.0).abs() < 0.001);
    Ok(())
}
