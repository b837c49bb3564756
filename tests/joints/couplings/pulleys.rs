//! Ropes over pulleys.

use super::*;
use crate::common::G;
use backstop::{Geometry, ShapeDesc};

fn falling() -> World {
    World::new(Settings::default().with_gravity(Vec3::Y * -G as f32)).unwrap()
}

/// Two bodies hang 2 m below pulleys on a body at the origin; a rope that is just taut.
fn hung(
    world: &mut World,
    on: BodyHandle,
    masses: [f32; 2],
    ratio: f64,
) -> ([BodyHandle; 2], [JointHandle; 2], CouplingHandle) {
    let at = [Vec3::X * -1.0, Vec3::X];
    let bodies =
        [0, 1].map(|i| world.add_body(&lump(masses[i], 0.1).with_position(at[i] - Vec3::Y * 2.0)).unwrap());
    let ropes = [0, 1].map(|i| {
        let rope = JointDesc::new([on, bodies[i]], [Frame::at(at[i]), Frame::default()]);
        world.add_joint(&rope).unwrap()
    });
    let rope = world.add_coupling(&CouplingDesc::pulley(ropes, ratio, 2.0 + 2.0 * ratio)).unwrap();
    (bodies, ropes, rope)
}

/// Atwood's machine, and the same with a block and tackle of ratio r. Expected, by Newton's law: the first
/// sinks by g r (r m - M) / (r² m + M), the other rises by 1/r of that, and the rope bears
/// m M g (1 + r) / (r² m + M).
#[test]
fn atwoods_machine_accelerates_by_newtons_law() {
    for (masses, ratio) in [([3.0_f32, 2.0], 1.0), ([1.0, 5.0], 1.0), ([2.0, 3.0], 2.0), ([4.0, 1.0], 0.5)] {
        let mut world = falling();
        let ground = world.add_body(&BodyDesc::fixed()).unwrap();
        let (bodies, _, rope) = hung(&mut world, ground, masses, ratio);
        let [m, n] = masses.map(f64::from);
        let a = G * ratio * (ratio * m - n) / (ratio * ratio * m + n);
        let tension = m * n * G * (1.0 + ratio) / (ratio * ratio * m + n);
        for _ in 0..30 {
            world.step(DT).unwrap();
        }
        let v = bodies.map(|body| f64::from(-world.linear_velocity(body).unwrap().y));
        let [on_first, on_second] = world.coupling_force(rope).unwrap().map(f64::from);
        let sum = world.coupling_sum(rope).unwrap() - 2.0 - 2.0 * ratio;
        println!(
            "{masses:?} {ratio}: {} m/s², by theory {a}; {on_first} N of {tension}; off {sum:e}",
            v[0] / 0.5
        );
        assert!((v[0] - 0.5 * a).abs() < 1e-4 * G, "{v:?} {a}");
        assert!((v[1] + 0.5 * a / ratio).abs() < 1e-4 * G, "{v:?} {a}");
        assert!((on_first / -tension - 1.0).abs() < 1e-3, "{on_first} {tension}");
        assert!((on_second / (-tension * ratio) - 1.0).abs() < 1e-3, "{on_second} {tension}");
        // It becomes taut within the first substep, of 1/240 s, in which it gives.
        assert!(sum.abs() < (1.0 + ratio) * G / (240.0 * 240.0), "{sum:e}");
    }
}

/// Equal weights at rest, one nudged sideways so that it swings for four seconds. Expected: a rope gains no
/// energy, and its length stays.
#[test]
fn a_swinging_weight_gains_nothing() {
    let mut world = falling();
    let ground = world.add_body(&BodyDesc::fixed()).unwrap();
    let (bodies, _, rope) = hung(&mut world, ground, [2.0, 2.0], 1.0);
    world.set_velocity(bodies[0], Vec3::new(0.5, 0.0, 0.0), Vec3::ZERO).unwrap();
    let (start, mut low, mut high, mut long) = (world.energy(), 0.0_f64, 0.0_f64, 0.0_f64);
    for _ in 0..240 {
        world.step(DT).unwrap();
        let change = world.energy() - start;
        (low, high) = (low.min(change), high.max(change));
        long = long.max(world.coupling_sum(rope).unwrap() - 4.0);
    }
    println!("{low} to {high} J of {start}, rope longer by {long:e} m");
    assert!(high < 0.01 && low > -0.05 && long < 1e-3, "{low} {high} {long}");
}

/// Equal weights; one is thrown up, so that its rope is slack. Expected: both fall freely until the rope is
/// taut again, and the rope bears nothing until then.
#[test]
fn a_slack_rope_bears_nothing() {
    let mut world = falling();
    let ground = world.add_body(&BodyDesc::fixed()).unwrap();
    let (bodies, _, rope) = hung(&mut world, ground, [2.0, 2.0], 1.0);
    world.set_velocity(bodies[0], Vec3::Y * 3.0, Vec3::ZERO).unwrap();
    let mut fell = 0.0;
    for _ in 0..15 {
        world.step(DT).unwrap();
        fell += f64::from(DT);
        let v = bodies.map(|body| f64::from(world.linear_velocity(body).unwrap().y));
        assert!((v[0] - (3.0 - G * fell)).abs() < 1e-4 && (v[1] + G * fell).abs() < 1e-4, "{v:?}");
        assert_eq!(world.coupling_force(rope).unwrap(), [0.0; 2]);
    }
    for _ in 0..30 {
        world.step(DT).unwrap();
        let long = world.coupling_sum(rope).unwrap() - 4.0;
        assert!(long < 1e-3, "{long}");
    }
    // Taut again, the two balance each other.
    let tension = f64::from(world.coupling_force(rope).unwrap()[0]);
    assert!((tension / (-2.0 * G) - 1.0).abs() < 1e-3, "{tension}");
}

/// The pulleys hang on a body that is free: a tackle that is dropped. Expected: momentum is that which
/// gravity gives to all three.
#[test]
fn the_reaction_goes_to_what_bears_the_pulleys() {
    let mut world = falling();
    let beam = world.add_body(&lump(5.0, 2.0)).unwrap();
    let (bodies, ..) = hung(&mut world, beam, [4.0, 1.0], 2.0);
    world.set_velocity(bodies[1], Vec3::Y * -2.0, Vec3::ZERO).unwrap();
    let momentum = |world: &World| {
        let parts = [(beam, 5.0), (bodies[0], 4.0), (bodies[1], 1.0)];
        parts.iter().map(|&(b, m)| m * world.linear_velocity(b).unwrap().as_dvec3()).sum::<DVec3>()
    };
    let start = momentum(&world);
    for _ in 0..60 {
        world.step(DT).unwrap();
    }
    let expected = start + DVec3::Y * (-G * 10.0);
    assert!((momentum(&world) - expected).length() < 1e-3, "{} {expected}", momentum(&world));
    assert!(world.angular_velocity(beam).unwrap().length() > 0.01);
}

/// Equal weights sleep as one island, and wake together.
#[test]
fn what_hangs_on_one_rope_sleeps_as_one() {
    let mut world =
        World::new(Settings::default().with_gravity(Vec3::Y * -G as f32).with_sleeping(true)).unwrap();
    let ground = world.add_body(&BodyDesc::fixed()).unwrap();
    let (bodies, ..) = hung(&mut world, ground, [2.0, 2.0], 1.0);
    for _ in 0..300 {
        world.step(DT).unwrap();
    }
    assert_eq!(bodies.map(|body| world.is_sleeping(body).unwrap()), [true; 2]);
    // A ball falls on one of them: neither may sleep on.
    let ball = ShapeDesc::new(Geometry::Sphere { radius: 0.1 });
    world.add_shape(bodies[0], &ball).unwrap();
    world.apply_impulse_at(bodies[0], Vec3::Y * -0.5, world.position(bodies[0]).unwrap()).unwrap();
    assert_eq!(bodies.map(|body| world.is_sleeping(body).unwrap()), [false; 2]);
    world.step(DT).unwrap();
    assert!(world.linear_velocity(bodies[1]).unwrap().y > 0.05);
}
