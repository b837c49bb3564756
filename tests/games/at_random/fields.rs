//! Water, wind, attractors and explosions against their formulas.

use super::random::Random;
use super::{G, RATES, judge, require};
use backstop::fields::{Attractor, Fluid, Wind};
use backstop::glam::{DVec3, Vec3};
use backstop::{BodyDesc, BodyHandle, Error, Explosion, Geometry, QueryFilter, Settings, ShapeDesc, World};
use std::f32::consts::PI;

fn world(random: &mut Random, gravity: f32) -> Result<World, Error> {
    let substeps = 1 + random.below(8) as u32;
    World::new(Settings::default().with_gravity(Vec3::Y * -gravity).with_substeps(substeps))
}

fn add(world: &mut World, desc: BodyDesc, geometry: Geometry, density: f32) -> Result<BodyHandle, Error> {
    world.add_body(&desc.with_shape(ShapeDesc::new(geometry).with_density(density)))
}

/// A convex shape of about a size [m].
fn any_shape(random: &mut Random, size: f32) -> Geometry {
    let mut part = || size * random.range(0.3, 1.0);
    let (a, b, c) = (part(), part(), part());
    match random.below(5) {
        0 => Geometry::sphere(a),
        1 => Geometry::cuboid(a, b, c),
        2 => Geometry::capsule(a, b),
        3 => Geometry::cylinder(a, b),
        _ => Geometry::cone(a, b),
    }
}

/// Share of the volume of a body that is below y = 0, and the mean of how deep that is, zero above [m]: by
/// counting points at random that are within it, with an error of some thousandths.
fn below(world: &World, body: BodyHandle, random: &mut Random) -> Result<(f32, f64), Error> {
    let bounds = world.aabb(body)?.ok_or(Error::StaleBody)?;
    let (middle, half) = (bounds.centre(), 0.5 * (bounds.max - bounds.min));
    let (mut all, mut under, mut depth, mut met) = (0, 0, 0.0, Vec::new());
    while all < 20_000 {
        let at = middle + half * random.cube64();
        world.closest_point_all(at, 0.0, &QueryFilter::new(), &mut met)?;
        if met.iter().any(|near| near.inside) {
            all += 1;
            under += i32::from(at.y < 0.0);
            depth -= at.y.min(0.0);
        }
    }
    Ok((under as f32 / all as f32, depth / f64::from(all)))
}

/// Expected: at rest it displaces its mass (Archimedes).
#[test]
fn floating_bodies_displace_their_mass() {
    judge(6, |random| {
        let (mut world, rate) = (world(random, G)?, random.of(&RATES));
        let size = random.log_range(0.1, 5.0);
        let (geometry, density) = (any_shape(random, size), random.range(100.0, 950.0));
        let desc =
            BodyDesc::dynamic().with_position(DVec3::Y * f64::from(size)).with_rotation(random.rotation());
        let text = format!("{geometry:?} of {density}, {rate} Hz");
        let body = add(&mut world, desc, geometry, density)?;
        let water = Fluid::default()
            .with_linear_drag(random.range(1.0, 5.0))
            .with_angular_drag(random.range(1.0, 5.0));
        let dt = 1.0 / rate as f32;
        for _ in 0..40 * rate {
            water.apply_to(&mut world, dt)?;
            world.step(dt)?;
        }
        let speed = world.linear_velocity(body)?.length() + world.angular_velocity(body)?.length() * size;
        require!(speed < 0.01 * (G * size).sqrt(), "not at rest: {speed} m/s; {text}");
        let (share, _) = below(&world, body, random)?;
        require!((share - density / 1000.0).abs() < 0.015, "{share:.3} is below; {text}");
        Ok(())
    });
}

/// Expected: without drag it bobs and rolls on with the energy that it has, that of the water which it lifts
/// to the surface included. Leapfrog swings by about the square of an oscillation's angle in a step.
#[test]
fn water_without_drag_feeds_no_motion() {
    judge(4, |random| {
        let (mut world, rate) = (world(random, G)?, random.of(&RATES));
        let size = random.log_range(0.15, 5.0);
        let (geometry, density) = (any_shape(random, size), random.range(100.0, 900.0));
        let desc = BodyDesc::dynamic().with_position(DVec3::Y * f64::from(0.5 * size));
        let desc = desc.with_rotation(random.rotation());
        let text = format!("{geometry:?} of {density}, {rate} Hz, {} substeps", world.settings().substeps);
        let body = add(&mut world, desc, geometry, density)?;
        let water = Fluid::default().with_linear_drag(0.0).with_angular_drag(0.0);
        let weight = f64::from(world.mass(body)? * G);
        let mut energy = |world: &World| -> Result<f64, Error> {
            let lifted = below(world, body, random)?.1 * f64::from(1000.0 / density);
            Ok(world.energy() / weight + lifted)
        };
        let before = energy(&world)?;
        let dt = 1.0 / rate as f32;
        let swings = f64::from(G * 1000.0 / (size * density) * dt * dt);
        for i in 1..=40 * rate {
            water.apply_to(&mut world, dt)?;
            world.step(dt)?;
            if i % (8 * rate) == 0 {
                let gain = (energy(&world)? - before) / f64::from(size);
                require!(gain < 0.1 + swings, "gains {gain:.3} of its weight and size; {text}");
            }
        }
        Ok(())
    });
}

/// Expected: a body that sinks or rises reaches the speed at which drag is its weight in water:
/// `g (density - 1000) / (1000 drag)`, whatever the step.
#[test]
fn sinking_bodies_reach_their_terminal_speed() {
    judge(8, |random| {
        let (mut world, rate) = (world(random, G)?, random.of(&RATES));
        let (density, drag) = (random.log_range(30.0, 8000.0), random.log_range(0.5, 10.0));
        let desc = BodyDesc::dynamic().with_position(DVec3::Y * -2000.0);
        let body = add(&mut world, desc, any_shape(random, 1.0), density)?;
        let water = Fluid::default().with_linear_drag(drag);
        let dt = 1.0 / rate as f32;
        let time = 8.0 * density / (1000.0 * drag) + 1.0;
        for _ in 0..(time * rate as f32) as u32 {
            water.apply_to(&mut world, dt)?;
            world.step(dt)?;
        }
        let (speed, expected) = (world.linear_velocity(body)?.y, G * (1.0 - density / 1000.0) / drag);
        let off = speed / expected - 1.0;
        require!(
            off.abs() < 0.02,
            "{speed}, not {expected} m/s ({off:.3}): {density}, drag {drag}; {rate} Hz"
        );
        Ok(())
    });
}

/// Expected: `sqrt(2 m g / (density drag area))`, and never faster on the way.
#[test]
fn falling_bodies_reach_their_terminal_speed() {
    judge(12, |random| {
        let (mut world, rate) = (world(random, G)?, random.of(&RATES));
        let (size, density) = (random.log_range(0.01, 2.0), random.log_range(1.0, 3000.0));
        let (geometry, area) = match random.below(2) {
            0 => (Geometry::sphere(size), PI * size * size),
            _ => (Geometry::cuboid(size, 0.1 * size, 0.7 * size), 4.0 * 0.7 * size * size),
        };
        let body = add(&mut world, BodyDesc::dynamic(), geometry, density)?;
        let wind = random.cube() * Vec3::new(5.0, 0.0, 5.0);
        let air = Wind::default().with_drag(random.range(0.3, 1.5)).with_velocity(Vec3::ZERO);
        let expected = (2.0 * world.mass(body)? * G / (1.2 * air.drag * area)).sqrt();
        let dt = 1.0 / rate as f32;
        for _ in 0..((8.0 * expected / G + 1.0) * rate as f32) as u32 {
            air.apply_to(&mut world, dt)?;
            world.step(dt)?;
            let speed = -world.linear_velocity(body)?.y;
            require!(
                speed < 1.02 * expected,
                "{speed}, beyond {expected} m/s; {density}, {size} m; {rate} Hz"
            );
        }
        let speed = -world.linear_velocity(body)?.y;
        require!(speed > 0.98 * expected, "{speed}, not {expected} m/s; {density}, {size} m; {rate} Hz");
        // Without gravity it takes the velocity of the wind, and is not faster on the way.
        world.set_gravity_scale(body, 0.0)?;
        for _ in 0..5 * rate {
            air.with_velocity(wind).apply_to(&mut world, dt)?;
            world.step(dt)?;
            let speed = world.linear_velocity(body)?.length();
            require!(speed < 1.02 * expected.max(wind.length()), "{speed} m/s in {wind}; {rate} Hz");
        }
        Ok(())
    });
}

/// Expected: orbits keep their energy, by a step that is a share of a period; close passes do not fling.
#[test]
fn orbits_keep_their_energy() {
    judge(5, |random| {
        let (mut world, rate) = (world(random, 0.0)?, random.of(&RATES));
        let dt = 1.0 / rate as f32;
        let (radius, eccentricity) = (random.log_range(2.0, 200.0), random.range(0.0, 0.8));
        // Of a circle: `tau sqrt(radius³ / strength)`.
        let steps = random.log_range(150.0, 1500.0);
        let period = steps * dt;
        let strength = radius * radius * radius * (2.0 * PI / period) * (2.0 * PI / period);
        let speed = (strength * (1.0 + eccentricity) / (radius * (1.0 - eccentricity))).sqrt();
        let nearest = radius * (1.0 - eccentricity);
        let sun = Attractor::default().with_strength(strength).with_softening(0.0).with_max_acceleration(1e6);
        let desc = BodyDesc::dynamic().with_position(DVec3::X * f64::from(nearest));
        let planet =
            add(&mut world, desc.with_linear_velocity(Vec3::Z * speed), Geometry::sphere(0.1), 1000.0)?;
        let energy = |world: &World| -> Result<f64, Error> {
            let (at, speed) = (world.position(planet)?.length(), world.linear_velocity(planet)?.as_dvec3());
            Ok(0.5 * speed.length_squared() - f64::from(strength) / at)
        };
        let before = energy(&world)?;
        let mut worst = 0.0_f64;
        for i in 0..(20.0 * steps) as u32 {
            sun.apply_to(&mut world, dt)?;
            world.step(dt)?;
            if i as f32 % steps < 1.0 {
                worst = worst.max((energy(&world)? / before - 1.0).abs());
            }
        }
        require!(
            worst < 0.1,
            "energy by {worst:.4}, {steps:.0} steps, e {eccentricity:.2}; {} substeps",
            world.settings().substeps
        );
        Ok(())
    });
}

/// Expected: an impulse of the area times the share that is left at the distance, away from the centre;
/// nothing beyond the radius and the falloff, nothing behind a wall.
#[test]
fn explosions_push_by_area_and_distance() {
    judge(40, |random| {
        let mut world = world(random, 0.0)?;
        let size = random.log_range(0.05, 3.0);
        let (geometry, area, near) = match random.below(2) {
            0 => (Geometry::sphere(size), PI * size * size, size),
            _ => (Geometry::cuboid(size, 0.5 * size, 2.0 * size), 4.0 * size * size, size),
        };
        let distance = size * 1.1 + random.range(0.0, 8.0);
        let desc = BodyDesc::dynamic().with_position(DVec3::X * f64::from(distance));
        let body = add(&mut world, desc, geometry, random.log_range(10.0, 5000.0))?;
        let blast = Explosion::default()
            .with_radius(random.range(0.0, 4.0))
            .with_falloff(random.range(0.1, 4.0))
            .with_impulse_per_area(random.log_range(10.0, 1e4))
            .with_occluded(random.chance(0.5));
        let wall = random.chance(0.3);
        if wall {
            let wall = ShapeDesc::new(Geometry::cuboid(0.01, 20.0, 20.0));
            let at = DVec3::X * f64::from(0.5 * (distance - near));
            world.add_body(&BodyDesc::fixed().with_position(at).with_shape(wall))?;
        }
        let gap = distance - near - blast.radius;
        let share = if wall && blast.occluded { 0.0 } else { (1.0 - gap.max(0.0) / blast.falloff).max(0.0) };
        let count = world.apply_explosion(&blast)?;
        let found = world.linear_velocity(body)? * world.mass(body)?;
        let expected = Vec3::X * (blast.impulse_per_area * area * share);
        let off = (found - expected).length() / (blast.impulse_per_area * area);
        require!(
            off < 1e-3 && count == usize::from(share > 0.0),
            "{found}, not {expected} N s: {blast:?}, {distance}"
        );
        Ok(())
    });
}
