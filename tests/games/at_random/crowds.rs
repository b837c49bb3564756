//! Crowds of characters with bodies, and levels that come and go.

use super::ground::Ground;
use super::random::Random;
use super::{RATES, judge, require};
use backstop::glam::{DVec3, Vec3};
use backstop::{
    BodyDesc, BodyHandle, Character, CharacterBody, CharacterSettings, Error, Geometry, LevelOfDetail,
    QueryFilter, Settings, ShapeDesc, World,
};

/// A ground with obstacles, and crates in heaps.
fn level(random: &mut Random, crates: usize) -> Result<(World, Ground, Vec<BodyHandle>), Error> {
    let settings = Settings::default().with_substeps(1 + random.below(8) as u32);
    let mut world = World::new(settings.with_sleeping(random.chance(0.5)))?;
    let ground = random.of(&[
        Ground::Plane,
        Ground::Tilted(0.1),
        Ground::Hills(1.0),
        Ground::Tiles,
        Ground::Steps(0.2),
    ]);
    ground.add_to(&mut world, 0.6)?;
    for _ in 0..30 {
        let (at, half) = (random.cube64() * DVec3::new(30.0, 0.0, 30.0), random.range(0.2, 1.5));
        let at = at + DVec3::Y * ground.height(at.x, at.z);
        let block = ShapeDesc::new(Geometry::cuboid(half, half, random.range(0.2, 3.0)));
        world.add_body(
            &BodyDesc::fixed().with_position(at).with_rotation(random.rotation()).with_shape(block),
        )?;
    }
    let mut bodies = Vec::new();
    for i in 0..crates {
        let at = random.cube64() * DVec3::new(25.0, 0.0, 25.0);
        let at = at + DVec3::Y * (ground.height(at.x, at.z) + 3.0 + 0.5 * (i % 8) as f64);
        let half = random.range(0.2, 0.4);
        let shape = match random.below(3) {
            0 => Geometry::sphere(half),
            1 => Geometry::capsule(half, 0.6 * half),
            _ => Geometry::cuboid(half, half, half),
        };
        bodies
            .push(world.add_body(&BodyDesc::dynamic().with_position(at).with_shape(ShapeDesc::new(shape)))?);
    }
    Ok((world, ground, bodies))
}

/// Expected: nobody of 200 falls through the ground or is flung, and crates that they push are not either;
/// bodies are where their characters are.
#[test]
fn a_crowd_walks_about() {
    judge(1, |random| {
        let ((mut world, ground, crates), rate) = (level(random, 40)?, random.of(&RATES));
        let dt = 1.0 / rate as f32;
        let mut crowd = Vec::new();
        for i in 0..200 {
            let (x, z) = (4.0 * f64::from(i % 14) - 28.0, 4.0 * f64::from(i / 14) - 28.0);
            let at = DVec3::new(x, ground.height(x, z) + 4.0, z);
            let character = Character::new(CharacterSettings::default(), at)?;
            let body = CharacterBody::new(&mut world, &character)?;
            let wish = random.direction() * Vec3::new(3.0, 0.0, 3.0);
            crowd.push((character, body, wish, 0.0_f32));
        }
        for i in 0..4 * rate {
            for (character, body, wish, fall) in &mut crowd {
                *fall = if character.ground().is_some() { 0.0 } else { *fall - 9.81 * dt };
                let velocity = *wish + Vec3::Y * *fall;
                let from = character.position();
                character.walk(&world, &QueryFilter::new().excluding(body.body()), velocity, dt)?;
                let way = (character.position() - from).length() / f64::from(dt);
                // Those who start in an obstacle are pushed out of it first.
                require!(
                    way < 40.0 || i < rate / 2,
                    "character at {way:.1} m/s after {i} on {ground:?}; {rate} Hz"
                );
                body.follow(&mut world, character, dt)?;
                if random.chance(0.01) {
                    *wish = random.direction() * Vec3::new(3.0, 0.0, 3.0);
                }
            }
            world.step(dt)?;
            for (character, body, ..) in &crowd {
                let (at, off) =
                    (character.position(), world.position(body.body())?.distance(character.position()));
                require!(
                    off < 1e-4 && ground.above(at) > 0.0,
                    "{at:.2} after {i}, body {off:.5} m off on {ground:?}; {rate} Hz"
                );
            }
            for &body in &crates {
                let (at, speed) = (world.position(body)?, world.linear_velocity(body)?.length());
                require!(
                    speed < 25.0 && ground.above(at) > 0.0,
                    "crate at {speed:.1} m/s at {at:.2} after {i} on {ground:?}; {rate} Hz"
                );
            }
        }
        Ok(())
    });
}

/// Expected: a viewer comes and goes. Bodies that come back are where they were, do not sink, and are no
/// faster than those that never went.
#[test]
fn what_comes_back_is_as_it_was() {
    judge(4, |random| {
        let ((mut world, ground, crates), rate) = (level(random, 150)?, random.of(&RATES));
        let dt = 1.0 / rate as f32;
        for _ in 0..6 * rate {
            world.step(dt)?;
        }
        let fastest = |world: &World| -> Result<f32, Error> {
            crates.iter().try_fold(0.0_f32, |most, &body| Ok(most.max(world.linear_velocity(body)?.length())))
        };
        let settled = fastest(&world)?;
        let mut detail = LevelOfDetail::new(10.0, 15.0)?;
        let mut kept: Vec<Option<(DVec3, Vec3)>> = vec![None; crates.len()];
        for i in 0..6 * rate {
            let angle = 0.5 * f64::from(i) / f64::from(rate);
            let viewer = DVec3::new(25.0 * libm::cos(angle), 2.0, 25.0 * libm::sin(angle));
            if i % 7 == 0 {
                detail.update(&mut world, &[viewer])?;
            }
            for (kept, &body) in kept.iter_mut().zip(&crates) {
                let now = (world.position(body)?, world.linear_velocity(body)?);
                if let Some(before) = *kept {
                    require!(before == now, "it moved while it was off: {before:?}, {now:?}");
                }
                *kept = (!world.is_enabled(body)?).then_some(now);
            }
            world.step(dt)?;
            let speed = fastest(&world)?;
            require!(
                speed < settled.max(0.5) + 1.0,
                "{speed:.2} m/s, {settled:.2} before, after {i} on {ground:?}; {rate} Hz"
            );
            for &body in &crates {
                let deep = -ground.above(world.position(body)?);
                require!(deep < 0.0, "{deep:.3} m below after {i} on {ground:?}; {rate} Hz");
            }
        }
        Ok(())
    });
}
