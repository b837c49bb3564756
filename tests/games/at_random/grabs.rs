//! Grabs of bodies of 1 kg to 10 t: alone, through walls, in heaps and in chains.

use super::random::Random;
use super::{G, RATES, judge, require};
use backstop::glam::{DVec3, Vec3};
use backstop::{
    BodyDesc, BodyHandle, Error, Geometry, Grab, GrabSettings, JointDesc, Settings, ShapeDesc, World,
};

fn world(random: &mut Random) -> Result<World, Error> {
    let mut world = World::new(Settings::default().with_substeps(1 + random.below(8) as u32))?;
    world.add_body(&BodyDesc::fixed().with_shape(ShapeDesc::new(Geometry::Plane)))?;
    Ok(world)
}

/// A body of a mass [kg] and an extent to either side [m].
fn add(world: &mut World, random: &mut Random, mass: f32, half: f32, at: DVec3) -> Result<BodyHandle, Error> {
    let (geometry, volume) = match random.below(2) {
        0 => (Geometry::cuboid(half, half, half), 8.0 * half * half * half),
        _ => (Geometry::sphere(half), 4.0 / 3.0 * std::f32::consts::PI * half * half * half),
    };
    let shape = ShapeDesc::new(geometry).with_density(mass / volume);
    world.add_body(&BodyDesc::dynamic().with_position(at).with_shape(shape))
}

/// Expected of a spring by frequency, whatever the mass: a step to the side is answered within the decay of
/// the spring, with no more overshoot than `exp(-pi ratio / sqrt(1 - ratio²))`, and it hangs `g / omega²`
/// below the target.
#[test]
fn a_grab_follows_by_frequency_and_damping() {
    judge(12, |random| {
        let (mut world, rate) = (world(random)?, random.of(&RATES));
        let (mass, half) = (random.log_range(1.0, 1e4), random.range(0.1, 1.0));
        let start = DVec3::Y * 10.0;
        let body = add(&mut world, random, mass, half, start)?;
        let (hertz, ratio) = (random.range(1.0, 8.0), random.range(0.3, 1.5));
        let settings =
            GrabSettings::default().with_hertz(hertz).with_damping_ratio(ratio).with_max_force(1e3);
        let grab = Grab::with_settings(&mut world, body, start, &settings)?;
        let dt = 1.0 / rate as f32;
        let omega = std::f32::consts::TAU * hertz;
        let text = format!(
            "{mass} kg, {hertz:.2} Hz, ratio {ratio:.2}; {rate} Hz, {} substeps",
            world.settings().substeps
        );
        let decay = if ratio < 1.0 { ratio } else { ratio - (ratio * ratio - 1.0).sqrt() };
        let time = 8.0 / (omega * decay);
        for _ in 0..(time * rate as f32) as u32 {
            world.step(dt)?;
        }
        grab.move_to(&mut world, start + DVec3::X)?;
        let mut most = 0.0_f64;
        for _ in 0..(time * rate as f32) as u32 + 1 {
            world.step(dt)?;
            most = most.max(world.position(body)?.x - 1.0);
        }
        let overshoot = if ratio < 1.0 {
            libm::expf(-std::f32::consts::PI * ratio / (1.0 - ratio * ratio).sqrt())
        } else {
            0.0
        };
        require!(most < f64::from(overshoot) + 0.02, "overshoots by {most:.3}, not {overshoot:.3}; {text}");
        let expected = start + DVec3::new(1.0, -f64::from(G / (omega * omega)), 0.0);
        let off = world.position(body)?.distance(expected);
        require!(off < 0.01, "{off:.4} m off after {time:.2} s; {text}");
        Ok(())
    });
}

/// Expected: a body that is dragged about at random, through walls and the floor, stays in its room; its
/// speed is bounded by what the grab's force gives it on the way; let go, it does not fly off.
#[test]
fn a_grab_pulls_nothing_through_walls() {
    judge(10, |random| {
        let (mut world, rate) = (world(random)?, random.of(&RATES));
        let (room, thick) = (5.0_f32, random.range(0.1, 0.5));
        for (axis, side) in [(0, 1.0), (0, -1.0), (2, 1.0), (2, -1.0), (1, 1.0)] {
            let (mut at, mut half) = (Vec3::Y * room, Vec3::splat(room + 1.0));
            at[axis] += side * room;
            half[axis] = thick;
            let wall = ShapeDesc::new(Geometry::cuboid(half.x, half.y, half.z));
            world.add_body(&BodyDesc::fixed().with_position(at).with_shape(wall))?;
        }
        let (mass, half) = (random.log_range(1.0, 1e4), random.range(0.1, 0.8));
        let body = add(&mut world, random, mass, half, DVec3::Y * 2.0)?;
        let settings = GrabSettings::default().with_hertz(random.range(2.0, 15.0));
        let offset = random.cube64() * f64::from(0.5 * half);
        let grab = Grab::with_settings(&mut world, body, DVec3::Y * 2.0 + offset, &settings)?;
        let text = format!(
            "{mass} kg, {half} m, {:.1} Hz; {rate} Hz, {} substeps, walls of {thick}",
            settings.hertz,
            world.settings().substeps
        );
        let dt = 1.0 / rate as f32;
        let inner = f64::from(room - thick);
        let inside = |world: &World| -> Result<f64, Error> {
            let at = world.position(body)?;
            let up = (-at.y).max(at.y - f64::from(2.0 * room - thick));
            Ok((at.x.abs() - inner).max(at.z.abs() - inner).max(up))
        };
        let mut target = DVec3::Y * 2.0;
        for i in 0..6 * rate {
            if i % (rate / 2) == 0 {
                target = random.cube64() * 15.0 + DVec3::Y * 5.0;
            }
            grab.move_to(&mut world, target)?;
            world.step(dt)?;
            let out = inside(&world)?;
            require!(out < 0.0, "its middle is {out:.3} m out after {i}; {text}");
        }
        // Into a corner of the floor, and let go.
        grab.move_to(&mut world, DVec3::new(8.0, -4.0, 3.0))?;
        for _ in 0..2 * rate {
            world.step(dt)?;
        }
        grab.release(&mut world)?;
        for i in 0..rate {
            world.step(dt)?;
            let (out, speed) = (inside(&world)?, world.linear_velocity(body)?.length());
            require!(
                speed < 3.0 && out < 0.0,
                "{speed:.2} m/s, {out:.3} m out, {i} after it was let go; {text}"
            );
        }
        Ok(())
    });
}

/// Expected: one of a heap, or of a chain, is pulled out and let go. Nothing is faster than the grab could
/// make it, and nothing sinks into the floor.
#[test]
fn grabs_in_heaps_and_chains_do_not_explode() {
    judge(4, |random| {
        let (mut world, rate) = (world(random)?, random.of(&RATES));
        let (half, chain) = (random.range(0.2, 0.5), random.chance(0.5));
        let ratio = random.log_range(1.0, 30.0);
        let mass = random.log_range(1.0, 300.0);
        let mut bodies: Vec<BodyHandle> = Vec::new();
        for i in 0..16 {
            let (x, y, z) = match chain {
                true => (2.0 * i as f32, 1.0, 0.0),
                false => (2.1 * (i % 2) as f32, 1.05 + 2.1 * (i / 4) as f32, 2.1 * (i / 2 % 2) as f32),
            };
            let mass = mass * if random.chance(0.5) { ratio } else { 1.0 };
            let at = (Vec3::new(x, y, z) * half).as_dvec3();
            bodies.push(add(&mut world, random, mass, half, at)?);
            if chain && i > 0 {
                let pair = [bodies[i - 1], bodies[i]];
                let between = at - DVec3::X * f64::from(half);
                let frames = world.frames_at(pair, between, backstop::glam::Quat::IDENTITY)?;
                world.add_joint(&JointDesc::ball(pair, frames))?;
            }
        }
        let dt = 1.0 / rate as f32;
        for _ in 0..2 * rate {
            world.step(dt)?;
        }
        let held = random.of(&bodies);
        let point = world.position(held)?;
        let grab = Grab::new(&mut world, held, point)?;
        let text = format!(
            "{mass} kg by {ratio:.1}, {half} m, chain {chain}; {rate} Hz, {} substeps",
            world.settings().substeps
        );
        let way = random.cube64() * DVec3::new(3.0, 1.0, 3.0) + DVec3::Y * 3.0;
        for i in 0..5 * rate {
            let share = (f64::from(i) / f64::from(2 * rate)).min(1.0);
            if i < 3 * rate {
                grab.move_to(&mut world, point + way * share)?;
            } else if i == 3 * rate {
                grab.release(&mut world)?;
            }
            world.step(dt)?;
            for &body in &bodies {
                let (speed, at) = (world.linear_velocity(body)?.length(), world.position(body)?);
                require!(
                    speed < 15.0 && at.y > f64::from(0.5 * half),
                    "{speed:.2} m/s at {at:.2} after {i}; {text}"
                );
            }
        }
        Ok(())
    });
}
