//! Ragdolls and trees of bodies in the air, with spins at random, without gravity and contacts. Expected:
//! joints act by pairs of opposite impulses at one point, so angular momentum stays.
//!
//! Ball joints keep it to 1e-4 in ten seconds, at any step. Angular limits do not: a share of some 1e-3 at 60
//! Hz is lost or gained, of first order in the step and the same with 16 substeps.

use backstop::glam::{DVec3, Mat3, Quat, Vec3};
use backstop::{BodyDesc, BodyHandle, Filter, Frame, JointDesc, MassProperties, Settings, Skeleton, World};

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

/// How bodies start to turn: all of them about their centre, each by itself too [rad/s].
#[derive(Clone, Copy, Debug)]
struct Spins {
    whole: f64,
    each: f64,
}

/// The greatest change of angular momentum within ten seconds as a share of it, and the change of its size
/// at the end.
fn change(mut world: World, bodies: &[BodyHandle], seed: u64, spins: Spins, dt: f32) -> (f64, f64) {
    let mut state = seed.wrapping_mul(0x9e37_79b9_7f4a_7c15) | 1;
    let mass = |&body: &BodyHandle| {
        let of = world.mass_properties(body).unwrap();
        (body, f64::from(of.mass), of.inertia)
    };
    let bodies: Vec<_> = bodies.iter().map(mass).collect();
    let whole = vector(&mut state) * spins.whole;
    for &(body, ..) in &bodies {
        let arm = world.centre_of_mass(body).unwrap() - DVec3::Y;
        let spin = whole + vector(&mut state) * spins.each;
        world.set_velocity(body, whole.cross(arm).as_vec3(), spin.as_vec3()).unwrap();
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

fn space() -> World {
    World::new(Settings::default().with_gravity(Vec3::ZERO)).unwrap()
}

fn ragdoll() -> (World, Vec<BodyHandle>) {
    let mut world = space();
    // No bone collides with another.
    let skeleton = Skeleton::humanoid().with_filter(Filter::default().with_group(-1));
    let ragdoll = skeleton.add_to(&mut world, DVec3::ZERO, Quat::IDENTITY, Vec3::ZERO).unwrap();
    (world, ragdoll.bodies)
}

/// Three to ten bodies of unequal masses and moments, each on one before it by a ball joint.
fn tree(seed: u64) -> (World, Vec<BodyHandle>) {
    let mut state = seed.wrapping_mul(0x2545_f491_4f6c_dd1d) | 1;
    let mut world = space();
    let mut bodies: Vec<(BodyHandle, DVec3)> = Vec::new();
    let count = 3 + (seed % 8) as usize;
    for i in 0..count {
        let mass = libm::exp(random(&mut state)) as f32;
        let moments = (vector(&mut state) * 0.005 + DVec3::splat(0.02)).as_vec3() * mass;
        let parent = (i > 0).then(|| bodies[((random(&mut state) + 1.0) * 0.5 * i as f64) as usize]);
        let arm = vector(&mut state) * 0.3;
        let place = parent.map_or(DVec3::Y, |(_, place)| place + 2.0 * arm);
        let properties =
            MassProperties { mass, centre_of_mass: Vec3::ZERO, inertia: Mat3::from_diagonal(moments) };
        let body = BodyDesc::dynamic().with_mass(Some(properties)).with_position(place);
        let body = world.add_body(&body).unwrap();
        if let Some((parent, _)) = parent {
            let frames = [Frame::at(arm.as_vec3()), Frame::at(-arm.as_vec3())];
            world.add_joint(&JointDesc::ball([parent, body], frames)).unwrap();
        }
        bodies.push((body, place));
    }
    (world, bodies.into_iter().map(|(body, _)| body).collect())
}

/// Number of ragdolls and trees for each rate: `BACKSTOP_RAGDOLLS`, or few.
fn count() -> u64 {
    std::env::var("BACKSTOP_RAGDOLLS").ok().and_then(|n| n.parse().ok()).unwrap_or(3)
}

/// The greatest change of all that are made, at three rates.
fn greatest(name: &str, make: impl Fn(u64) -> (World, Vec<BodyHandle>)) -> [f64; 3] {
    [30.0, 60.0, 120.0].map(|hz| {
        let mut all = Vec::new();
        for spins in [Spins { whole: 3.0, each: 0.0 }, Spins { whole: 3.0, each: 5.0 }] {
            for seed in 1..=count() {
                let (world, bodies) = make(seed);
                all.push(change(world, &bodies, seed, spins, 1.0 / hz));
            }
        }
        all.sort_by(|a, b| a.0.total_cmp(&b.0));
        let mean = all.iter().map(|one| one.1).sum::<f64>() / all.len() as f64;
        let (median, most) = (all[all.len() / 2].0, all[all.len() - 1].0);
        println!("{name} at {hz} Hz: off by {median:.1e}, at most {most:.1e}; at the end {mean:+.1e}");
        most
    })
}

#[test]
fn a_ragdoll_in_the_air_keeps_its_angular_momentum() {
    let [slow, usual, fast] = greatest("ragdoll", |_| ragdoll());
    assert!(slow < 0.02 && usual < 0.01 && fast < 0.005, "{slow} {usual} {fast}");
}

#[test]
fn trees_of_ball_joints_in_the_air_keep_their_angular_momentum() {
    let most = greatest("tree", tree);
    assert!(most.iter().all(|&most| most < 1e-3), "{most:?}");
}
