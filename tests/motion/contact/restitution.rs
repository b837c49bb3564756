//! A body that bounces gives back the share of its approach speed of its material, at any length of step.

#![allow(clippy::disallowed_methods, reason = "expected values may use the platform's functions")]

use crate::common::{self, Floor, dynamic, shape};
use backstop::glam::{DVec3, Vec3};
use backstop::{BodyDesc, BodyHandle, Geometry, Material, Settings, World};

const STEPS: [f32; 4] = [1.0 / 30.0, 1.0 / 60.0, 1.0 / 120.0, 1.0 / 240.0];
/// Height of the fall, from surface to surface [m].
const DROP: f64 = 2.0;

fn drop_onto(floor: Floor, geometry: Geometry, e: f32) -> (World, BodyHandle) {
    let material = Material::default().with_restitution(e);
    let mut world = World::new(Settings::default()).unwrap();
    world.add_body(&floor.desc(material)).unwrap();
    let body = world.add_body(&dynamic(geometry, material, Vec3::new(0.3, 0.5 + DROP as f32, 0.2))).unwrap();
    (world, body)
}

/// Highest gap between floor and body from the first bounce to the next fall [m].
fn rebound(world: &mut World, body: BodyHandle, dt: f32) -> f64 {
    let speed = |world: &World| world.linear_velocity(body).unwrap().y;
    let mut time = 0.0;
    while speed(world) <= 0.0 {
        world.step(dt).unwrap();
        time += dt;
        assert!(time < 2.0, "it never bounced");
    }
    let mut top: f64 = 0.0;
    while speed(world) > 0.0 {
        top = top.max(world.position(body).unwrap().y);
        world.step(dt).unwrap();
    }
    top.max(world.position(body).unwrap().y) - 0.5
}

/// By Newton's law of impact the speed after is e times the speed before, so the height is e² times the
/// height.
#[test]
fn a_ball_rebounds_to_e_squared_of_its_height() {
    for floor in Floor::ALL {
        for e in [0.3, 0.5, 0.8, 1.0] {
            for dt in STEPS {
                let (mut world, ball) = drop_onto(floor, Geometry::Sphere { radius: 0.5 }, e);
                let height = rebound(&mut world, ball, dt);
                let want = f64::from(e * e) * DROP;
                println!(
                    "{floor:?} e {e} dt {dt:.4}: {height:.4} m, {:+.2} %",
                    100.0 * (height / want - 1.0)
                );
                assert!((height - want).abs() < 0.02 * want, "{floor:?} e {e} dt {dt}: {height} for {want}");
            }
        }
    }
}

#[test]
fn a_box_dropped_flat_rebounds_as_a_ball_does_and_stays_flat() {
    for floor in Floor::ALL {
        for e in [0.3, 0.5, 0.8, 1.0] {
            for dt in STEPS {
                let (mut world, body) = drop_onto(floor, Geometry::cuboid(0.5, 0.5, 0.5), e);
                let height = rebound(&mut world, body, dt);
                let want = f64::from(e * e) * DROP;
                assert!((height - want).abs() < 0.02 * want, "{floor:?} e {e} dt {dt}: {height} for {want}");
                // A body that turned would have to stop turning: none of the four points may get more than
                // its share.
                let spin = world.angular_velocity(body).unwrap().length();
                assert!(spin < 1e-3, "{floor:?} e {e} dt {dt}: {spin} rad/s");
            }
        }
    }
}

/// Energy is measured from the floor, where the ball has none when it touches.
#[test]
fn an_elastic_ball_keeps_its_energy_over_twenty_bounces() {
    for floor in Floor::ALL {
        for dt in STEPS {
            let (mut world, ball) = drop_onto(floor, Geometry::Sphere { radius: 0.5 }, 1.0);
            let rest = f64::from(world.mass(ball).unwrap()) * common::G * 0.5;
            let before = world.energy() - rest;
            let (mut bounces, mut falling) = (0, true);
            let mut steps = 0;
            while bounces < 20 || world.linear_velocity(ball).unwrap().y.abs() < 1.0 {
                world.step(dt).unwrap();
                let v = world.linear_velocity(ball).unwrap().y;
                bounces += u32::from(falling && v > 0.0);
                falling = if v == 0.0 { falling } else { v < 0.0 };
                steps += 1;
                assert!(steps as f32 * dt < 60.0, "{bounces} bounces in a minute");
            }
            let kept = (world.energy() - rest) / before;
            println!("{floor:?} dt {dt:.4}: {:+.3} %", 100.0 * (kept - 1.0));
            assert!((kept - 1.0).abs() < 0.01, "{floor:?} dt {dt}: {kept}");
        }
    }
}

/// Head-on: momentum m1 u1 + m2 u2 is kept, and v2 - v1 = e (u1 - u2) by Newton's law.
#[test]
fn two_balls_that_meet_head_on_keep_their_momentum() {
    for e in [0.0, 0.5, 1.0] {
        for dt in STEPS {
            for (density, speeds) in [(1000.0, [3.0, -3.0]), (3000.0, [4.0, -1.0]), (1000.0, [5.0, 0.0])] {
                let mut world = World::new(Settings::default().with_gravity(Vec3::ZERO)).unwrap();
                let material = Material::default().with_restitution(e);
                let mut add = |x: f64, u: f32, density: f32| {
                    let mut ball = shape(Geometry::Sphere { radius: 0.5 }, material);
                    ball.density = density;
                    let desc = BodyDesc::dynamic().with_position(DVec3::new(x, 0.0, 0.0)).with_shape(ball);
                    world.add_body(&desc.with_velocity(Vec3::X * u, Vec3::ZERO)).unwrap()
                };
                let (a, b) = (add(-1.2, speeds[0], density), add(1.3, speeds[1], 1000.0));
                common::steps(&mut world, (2.0 / dt) as u32, dt);
                let (m1, m2) = (world.mass(a).unwrap(), world.mass(b).unwrap());
                let (v1, v2) = (world.linear_velocity(a).unwrap(), world.linear_velocity(b).unwrap());
                let before = m1 * speeds[0] + m2 * speeds[1];
                let scale = m1 * speeds[0].abs() + m2 * speeds[1].abs();
                let case = format!("e {e} dt {dt:.4} {density} {speeds:?}: {} and {}", v1.x, v2.x);
                assert!((m1 * v1.x + m2 * v2.x - before).abs() < 1e-5 * scale, "{case}");
                let apart = e * (speeds[0] - speeds[1]);
                assert!((v2.x - v1.x - apart).abs() < 1e-3 * (speeds[0] - speeds[1]), "{case}");
                assert!(v1.y.hypot(v1.z) + v2.y.hypot(v2.z) < 1e-5, "{case}");
            }
        }
    }
}
