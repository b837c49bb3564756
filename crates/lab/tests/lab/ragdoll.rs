//! A ragdoll in the air, with spins at random, without gravity and contacts. Expected: joints act by pairs of
//! opposite impulses at one point, so linear and angular momentum stay.

use backstop::glam::{DVec3, Mat3, Quat, Vec3};
use backstop::{BodyHandle, Filter, Settings, Skeleton, World};

/// A number in -1..1.
fn random(state: &mut u64) -> f64 {
    *state ^= *state << 13;
    *state ^= *state >> 7;
    *state ^= *state << 17;
    (*state >> 11) as f64 / (1u64 << 52) as f64 - 1.0
}

fn vector(state: &mut u64) -> DVec3 {
    DVec3::new(random(state), random(state), random(state))
}

/// Angular momentum about the common centre of mass [kg m²/s].
fn angular_momentum(world: &World, bodies: &[(BodyHandle, f64, Mat3)]) -> DVec3 {
    let mut sums = (0.0, DVec3::ZERO, DVec3::ZERO);
    for &(body, mass, _) in bodies {
        sums.0 += mass;
        sums.1 += world.centre_of_mass(body).unwrap() * mass;
        sums.2 += world.linear_velocity(body).unwrap().as_dvec3() * mass;
    }
    let (centre, drift) = (sums.1 / sums.0, sums.2 / sums.0);
    bodies.iter().fold(DVec3::ZERO, |sum, &(body, mass, inertia)| {
        let arm = world.centre_of_mass(body).unwrap() - centre;
        let velocity = world.linear_velocity(body).unwrap().as_dvec3() - drift;
        let turn = world.rotation(body).unwrap().as_dquat().normalize();
        let spin = turn.conjugate() * world.angular_velocity(body).unwrap().as_dvec3();
        sum + mass * arm.cross(velocity) + turn * (inertia.as_dmat3() * spin)
    })
}

/// How a ragdoll starts to turn: all of it about its centre, each bone by itself too.
#[derive(Clone, Copy, Debug)]
struct Spins {
    whole: f64,
    each: f64,
}

/// The greatest change of angular momentum within ten seconds as a share of it, and the change at the end.
fn change(seed: u64, spins: Spins, dt: f32) -> (f64, f64) {
    let mut state = seed.wrapping_mul(0x9e37_79b9_7f4a_7c15) | 1;
    let mut world = World::new(Settings::default().with_gravity(Vec3::ZERO).with_sleeping(false)).unwrap();
    // No bone collides with another.
    let skeleton = Skeleton::humanoid().with_filter(Filter::default().with_group(-1));
    let ragdoll = skeleton.add_to(&mut world, DVec3::ZERO, Quat::IDENTITY, Vec3::ZERO).unwrap();
    let bodies: Vec<_> = ragdoll
        .bodies
        .iter()
        .map(|&body| {
            let of = world.mass_properties(body).unwrap();
            (body, f64::from(of.mass), of.inertia)
        })
        .collect();
    let whole = vector(&mut state) * spins.whole;
    let centre = DVec3::Y;
    for &(body, ..) in &bodies {
        let arm = world.centre_of_mass(body).unwrap() - centre;
        let spin = whole + vector(&mut state) * spins.each;
        world.set_linear_velocity(body, whole.cross(arm).as_vec3()).unwrap();
        world.set_angular_velocity(body, spin.as_vec3()).unwrap();
    }
    let before = angular_momentum(&world, &bodies);
    let (mut most, mut last) = (0.0_f64, 0.0);
    for _ in 0..(10.0 / dt).round() as u32 {
        world.step(dt).unwrap();
        let now = angular_momentum(&world, &bodies);
        most = most.max((now - before).length() / before.length());
        last = now.length() / before.length() - 1.0;
    }
    (most, last)
}

/// Number of ragdolls for each rate: `BACKSTOP_RAGDOLLS`, or few.
fn count() -> u64 {
    std::env::var("BACKSTOP_RAGDOLLS").ok().and_then(|n| n.parse().ok()).unwrap_or(3)
}

#[test]
fn a_ragdoll_in_the_air_keeps_its_angular_momentum() {
    for hz in [30.0, 60.0, 120.0] {
        for spins in [Spins { whole: 3.0, each: 0.0 }, Spins { whole: 3.0, each: 5.0 }] {
            let mut all: Vec<_> = (1..=count()).map(|seed| change(seed, spins, 1.0 / hz)).collect();
            all.sort_by(|a, b| a.0.total_cmp(&b.0));
            let mean = all.iter().map(|one| one.1).sum::<f64>() / all.len() as f64;
            let (median, most) = (all[all.len() / 2].0, all[all.len() - 1].0);
            println!("{hz} Hz, {spins:?}: off by {median:.1e}, at most {most:.1e}; at the end {mean:+.1e}");
        }
    }
}
