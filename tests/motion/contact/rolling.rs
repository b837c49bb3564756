//! Rolling and spinning friction: they slow a ball on a plane and a top on its tip.
//!
//! A torque of at most `b N` resists rolling, where N is the load and b the lever arm of the material. A ball
//! of mass m, radius r and moment c m r² rolls without slip under friction F and this torque: m a = -F and
//! c m r² (a / r) = F r - b N, so a = -g (b / r) / (1 + c): 5/7 of g b / r for a solid ball (c = 2/5).

#![allow(clippy::disallowed_methods, reason = "expected values may use the platform's functions")]

use crate::common::{self, Floor, G, dynamic};
use backstop::glam::{DVec3, Quat, Vec3};
use backstop::{BodyHandle, FrictionModel, Geometry, Material, Settings, Snapshot, World};

const DT: f32 = 1.0 / 60.0;
const R: f32 = 0.3;

fn resisting(rolling: f32, spinning: f32) -> Material {
    Material::default().with_rolling_friction(rolling).with_spinning_friction(spinning)
}

/// A body that rolls along x on a floor without friction of these kinds.
fn rolling(settings: Settings, floor: Floor, body: Geometry, turned: Quat, arm: f32) -> (World, BodyHandle) {
    let speed = 1.5;
    let mut world = World::new(settings).unwrap();
    world.add_body(&floor.desc(Material::default())).unwrap();
    let mut desc = dynamic(body, resisting(arm, 0.0), Vec3::new(-9.3, R, 0.2))
        .with_velocity(Vec3::X * speed, Vec3::Z * (-speed / R));
    desc.rotation = turned;
    let body = world.add_body(&desc).unwrap();
    (world, body)
}

/// The energy of a body against the floor [J/kg], for a moment of `inertia` m r².
fn energy(world: &World, body: BodyHandle, inertia: f64) -> f64 {
    let (v, w) = (world.linear_velocity(body).unwrap(), world.angular_velocity(body).unwrap());
    let r = f64::from(R);
    0.5 * f64::from(v.length_squared())
        + 0.5 * inertia * r * r * f64::from(w.length_squared())
        + G * world.position(body).unwrap().y
}

/// v² / 2a, in v / a, by the deceleration above; then it sleeps, and it never gains energy.
#[test]
fn a_body_that_rolls_stops_where_its_lever_arm_says_and_sleeps() {
    let long = Geometry::cylinder(0.4, R);
    let lying = common::turned(Vec3::X, 90.0);
    let capsule = Geometry::capsule(0.4, R);
    // The moment of the capsule about its axis, by that of its two parts: density cancels.
    let (r, l) = (f64::from(R), 0.8);
    let (rod, ends) = (l * r * r, 4.0 / 3.0 * r * r * r);
    let of_capsule = (0.5 * rod + 0.4 * ends) / (rod + ends);
    let shapes =
        [(Geometry::sphere(R), Quat::IDENTITY, 0.4), (long, lying, 0.5), (capsule, lying, of_capsule)];
    for (geometry, turned, inertia) in shapes {
        for floor in [Floor::Box, Floor::Plane, Floor::Mesh] {
            for model in [FrictionModel::Patch, FrictionModel::Point] {
                let arm = 0.01;
                let settings = Settings::default().with_sleeping(true).with_friction_model(model);
                let (mut world, body) = rolling(settings, floor, geometry.clone(), turned, arm);
                let start = world.position(body).unwrap();
                let slows = G * f64::from(arm / R) / (1.0 + inertia);
                let (far, time) = (1.5 * 1.5 / (2.0 * slows), 1.5 / slows);
                let (mut stopped, mut last) = (f64::NAN, energy(&world, body, inertia));
                for step in 1..=(3.0 * time / f64::from(DT)) as u32 {
                    world.step(DT).unwrap();
                    let now = energy(&world, body, inertia);
                    assert!(now < last + 1e-4, "{floor:?} {model:?} step {step}: energy {last} to {now}");
                    last = now;
                    if stopped.is_nan() && world.linear_velocity(body).unwrap().length() < 0.01 {
                        stopped = f64::from(step) * f64::from(DT);
                    }
                }
                let way = world.position(body).unwrap() - start;
                let name = geometry.kind_name();
                println!(
                    "{name} {floor:?} {model:?}: {:.3} of {far:.3} m in {stopped:.2} of {time:.2} s",
                    way.x
                );
                assert!((way.x - far).abs() < 0.02 * far, "{name} {floor:?} {model:?}: {way} for {far}");
                assert!((stopped - time).abs() < 0.03 * time, "{name} {floor:?}: {stopped} for {time} s");
                assert!(world.is_sleeping(body).unwrap(), "{name} {floor:?} {model:?}: it does not sleep");
            }
        }
    }
}

/// Slopes of half and of nine tenths of atan(b / r) are borne for a minute; on twice that slope the ball
/// rolls off, accelerated by (5/7) g (sin - (b / r) cos).
#[test]
fn a_ball_stays_on_a_slope_below_the_angle_of_rolling_friction() {
    let arm = 0.03f32;
    for (share, stays) in [(0.5, true), (0.9, true), (2.0, false)] {
        let angle = share * f64::from(arm / R).atan();
        let (sin, cos) = (angle.sin() as f32, angle.cos() as f32);
        let gravity = Vec3::new(sin, -cos, 0.0) * G as f32;
        let mut world = World::new(Settings::default().with_gravity(gravity)).unwrap();
        world.add_body(&Floor::Plane.desc(Material::default())).unwrap();
        let ball = dynamic(Geometry::sphere(R), resisting(arm, 0.0), Vec3::new(0.0, R, 0.0));
        let ball = world.add_body(&ball).unwrap();
        let seconds = if stays { 60.0 } else { 2.0 };
        common::steps(&mut world, (seconds / DT) as u32, DT);
        let way = world.position(ball).unwrap().x;
        let want = 5.0 / 14.0 * G * (angle.sin() - f64::from(arm / R) * angle.cos()) * 4.0;
        println!("{share} of the angle: {way:.5} m");
        if stays {
            assert!(way.abs() < 1e-3, "{share}: it rolled {way} m");
        } else {
            assert!((way - want).abs() < 0.02 * want, "{way} for {want}");
        }
    }
}

/// The time in which a torque of `s m g` stops a spin of `w`: w I / (s m g).
#[test]
fn a_ball_that_spins_stops_in_the_time_that_its_lever_arm_says() {
    for model in [FrictionModel::Patch, FrictionModel::Point] {
        for arm in [0.002f32, 0.01] {
            let (mut world, spin) =
                (World::new(Settings::default().with_friction_model(model)).unwrap(), 8.0f32);
            world.add_body(&Floor::Plane.desc(Material::default())).unwrap();
            let ball = dynamic(Geometry::sphere(R), resisting(0.0, arm), Vec3::new(0.0, R, 0.0));
            let ball = world.add_body(&ball.with_velocity(Vec3::ZERO, Vec3::Y * spin)).unwrap();
            let time = spin * 0.4 * R * R / (arm * G as f32);
            let mut stopped = f32::NAN;
            for step in 1..=(2.0 * time / DT) as u32 {
                world.step(DT).unwrap();
                let now = world.angular_velocity(ball).unwrap();
                if stopped.is_nan() && now.y < 1e-3 {
                    stopped = step as f32 * DT;
                }
                assert!(now.y <= spin + 1e-4);
            }
            println!("{model:?} {arm}: {stopped:.3} of {time:.3} s");
            assert!((stopped - time).abs() < 0.02 * time + DT, "{model:?} {arm}: {stopped} for {time} s");
        }
    }
}

/// A floor resists bodies that roll on it, and the larger lever arm counts: by the formula above, with the
/// arm of the floor.
#[test]
fn of_two_lever_arms_the_larger_counts() {
    let way = |of_ball: f32, of_floor: f32| {
        let mut world = World::new(Settings::default()).unwrap();
        world.add_body(&Floor::Plane.desc(resisting(of_floor, 0.0))).unwrap();
        let ball = dynamic(Geometry::sphere(R), resisting(of_ball, 0.0), Vec3::new(0.0, R, 0.0))
            .with_velocity(Vec3::X, Vec3::Z * (-1.0 / R));
        let ball = world.add_body(&ball).unwrap();
        common::steps(&mut world, 1200, DT);
        world.position(ball).unwrap().x
    };
    let want = f64::from(7.0 * R / (10.0 * G as f32 * 0.02));
    for arms in [(0.02, 0.0), (0.0, 0.02), (0.02, 0.005), (0.01, 0.02)] {
        let way = way(arms.0, arms.1);
        assert!((way - want).abs() < 0.02 * want, "{arms:?}: {way} for {want}");
    }
}

/// A few dozen balls and capsules with arms of all sizes.
fn scattered(settings: Settings) -> (World, Vec<BodyHandle>) {
    let mut world = World::new(settings).unwrap();
    world.add_body(&Floor::Mesh.desc(Material::default())).unwrap();
    let bodies = (0..40u8)
        .map(|i| {
            let geometry = if i % 3 == 0 {
                Geometry::capsule(0.2, 0.15)
            } else {
                Geometry::sphere(0.15 + 0.002 * f32::from(i))
            };
            let material =
                if i % 4 == 3 { Material::default() } else { resisting(0.002 * f32::from(i % 5), 0.003) };
            let at = Vec3::new(
                f32::from(i % 6) * 0.5 - 1.4,
                0.4 + f32::from(i / 6) * 0.45,
                f32::from(i % 7) * 0.3,
            );
            world.add_body(&dynamic(geometry, material, at).with_velocity(Vec3::X, Vec3::Y)).unwrap()
        })
        .collect();
    (world, bodies)
}

fn poses(world: &World, bodies: &[BodyHandle]) -> Vec<(DVec3, Quat)> {
    bodies.iter().map(|&b| (world.position(b).unwrap(), world.rotation(b).unwrap())).collect()
}

/// To the bit: on one thread and two, after a snapshot and after one in bytes.
#[test]
fn rolling_bodies_go_the_same_way_on_any_threads_and_from_a_snapshot() {
    let (mut world, bodies) = scattered(Settings::default().with_threads(1));
    let (mut twin, twins) = scattered(Settings::default().with_threads(2));
    common::steps(&mut world, 90, DT);
    common::steps(&mut twin, 90, DT);
    assert_eq!(poses(&world, &bodies), poses(&twin, &twins));
    let mut snapshot = Snapshot::new();
    world.snapshot(&mut snapshot);
    let bytes = snapshot.to_whole_bytes();
    common::steps(&mut world, 120, DT);
    let want = poses(&world, &bodies);
    world.restore(&snapshot).unwrap();
    common::steps(&mut world, 120, DT);
    assert_eq!(poses(&world, &bodies), want);
    let kept = twin.shapes(twins[1]).unwrap().next().unwrap();
    twin.set_material(kept, Material::default()).unwrap();
    twin.restore(&Snapshot::from_bytes(&bytes).unwrap()).unwrap();
    assert_eq!(twin.material(kept).unwrap(), resisting(0.002, 0.003));
    common::steps(&mut twin, 120, DT);
    assert_eq!(poses(&twin, &twins), want);
}

/// A scene pays for it only while a shape asks: neither bytes nor a part of the model.
#[test]
fn what_nothing_resists_costs_nothing() {
    let (mut world, bodies) = scattered(Settings::default());
    world.step(DT).unwrap();
    let part = |world: &World| world.feature_report().part(backstop::Feature::RollingFriction);
    assert!(part(&world).count == 30 && part(&world).bytes > 0, "{:?}", part(&world));
    for &body in &bodies {
        let shape = world.shapes(body).unwrap().next().unwrap();
        world.set_material(shape, Material::default()).unwrap();
    }
    common::steps(&mut world, 2, DT);
    assert_eq!((part(&world).count, part(&world).bytes), (0, 0));
}
