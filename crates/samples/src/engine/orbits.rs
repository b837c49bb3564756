//! Orbits: moons which a force towards the planet holds go around it, by Kepler's third law.

use crate::parts::{Driven, fixed, solid};
use backstop::glam::{DVec3, Vec3};
use backstop::{BodyHandle, Error, Geometry, Settings, World};

/// Gravitational parameter of the planet [m³/s²].
const PLANET: f64 = 40.0;
/// Its middle, and the radii of the orbits [m].
const CENTRE: DVec3 = DVec3::new(0.0, 1.5, 0.0);
const ORBITS: [f64; 5] = [2.0, 2.8, 3.6, 4.4, 5.2];

/// The planet with its moons.
pub fn start() -> Result<Driven, Error> {
    let (world, moons) = build()?;
    Ok(Driven::new(world, move |world, tick| {
        for &moon in &moons {
            // A force is the same throughout a step: where the moon is in the middle of it. That of the
            // beginning would make the moons spiral outwards.
            let half_way = world.linear_velocity(moon)? * (0.5 * tick.dt);
            let away = world.position(moon)? + half_way.as_dvec3() - CENTRE;
            let pull = -away * PLANET / away.length().powi(3);
            world.add_force(moon, pull.as_vec3() * world.mass(moon)?)?;
        }
        Ok(())
    }))
}

fn build() -> Result<(World, Vec<BodyHandle>), Error> {
    let mut world = World::new(Settings::default().with_gravity(Vec3::ZERO))?;
    world.add_body(&fixed(Geometry::sphere(1.0)).with_position(CENTRE))?;
    let mut moons = Vec::new();
    for (i, radius) in ORBITS.into_iter().enumerate() {
        // Fast enough for a circle: v² = mu / r.
        let speed = (PLANET / radius).sqrt();
        let out = DVec3::new((2.4 * i as f64).cos(), 0.0, (2.4 * i as f64).sin());
        let moon = solid(Geometry::sphere(0.12 + 0.03 * i as f32))
            .with_position(CENTRE + out * radius)
            .with_linear_velocity((DVec3::Y.cross(out) * speed).as_vec3());
        moons.push(world.add_body(&moon)?);
    }
    Ok((world, moons))
}

#[test]
fn each_is_back_after_its_period() -> Result<(), Error> {
    for (i, radius) in ORBITS.into_iter().enumerate() {
        let (mut sample, (world, moons)) = (start()?, build()?);
        // T = 2 pi sqrt(r³ / mu).
        let period = std::f64::consts::TAU * (radius.powi(3) / PLANET).sqrt();
        crate::parts::run(&mut sample, period)?;
        let off = (crate::Running::world(&sample).position(moons[i])? - world.position(moons[i])?).length();
        assert!(off < 0.05 * radius, "{radius}: {off} m");
    }
    Ok(())
}
