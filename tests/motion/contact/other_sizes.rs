//! Rolling friction, belts and speed caps at other sizes, masses, rates and substeps than those that they
//! were made at.

#![allow(clippy::disallowed_methods, reason = "expected values may use the platform's functions")]

use crate::common::{Floor, G, dynamic};
use backstop::glam::{DVec3, Vec3};
use backstop::{BodyHandle, Geometry, Material, Settings, World};

/// A ball of radius r rolls at v = sqrt(2 g r) / 2 with an arm of r / 40. Expected: v² / (2 a) with
/// a = (5/7) g b / r, in v / a, within 2 %, whatever its mass, the length of the step and the substeps; and
/// it stands where it stopped.
#[test]
fn a_ball_of_any_size_rolls_as_far_as_its_arm_says() {
    let mut worst = (0.0, String::new());
    for radius in [0.05f32, 0.5, 5.0] {
        for density in [10.0, 8000.0] {
            for hertz in [30.0f32, 60.0, 120.0, 240.0] {
                for substeps in [1, 2, 4, 8] {
                    let settings = Settings::default().with_substeps(substeps);
                    let mut world = World::new(settings.with_length_unit(radius.clamp(0.1, 1.0))).unwrap();
                    let arm = radius / 40.0;
                    world.add_body(&Floor::Plane.desc(Material::default())).unwrap();
                    let v = 0.5 * (2.0 * G * f64::from(radius)).sqrt() as f32;
                    let rough = Material::default().with_rolling_friction(arm);
                    let mut ball = dynamic(Geometry::sphere(radius), rough, Vec3::Y * radius)
                        .with_velocity(Vec3::X * v, Vec3::Z * (-v / radius));
                    ball.shapes[0].density = density;
                    let ball = world.add_body(&ball).unwrap();
                    let slows = 5.0 / 7.0 * G * f64::from(arm / radius);
                    let (far, time) = (f64::from(v).powi(2) / (2.0 * slows), f64::from(v) / slows);
                    let steps = (1.3 * time * f64::from(hertz)) as u32;
                    (0..steps).for_each(|_| _ = world.step(1.0 / hertz).unwrap());
                    let way = world.position(ball).unwrap();
                    let (off, speed) = (way.x / far - 1.0, world.linear_velocity(ball).unwrap().length());
                    let name = format!("{radius} m, {density} kg/m³, {hertz} Hz, {substeps} substeps");
                    if off.abs() > f64::abs(worst.0) {
                        worst = (off, name.clone());
                    }
                    assert!(off.abs() < 0.02, "{name}: {} of {far} m", way.x);
                    assert!(speed < 1e-3 * v, "{name}: {speed} m/s");
                    assert!(way.z.abs() < 1e-3 * far, "{name}: {way}");
                }
            }
        }
    }
    println!("off by {:.2} % at most, with {}", 100.0 * worst.0, worst.1);
}

/// A box of 0.02 to 5 m on a belt of speed v that climbs at 15 degrees, with mu = 0.6. Expected, by Coulomb's
/// law: it is pulled up at g (mu cos - sin) until it moves along with the belt, and stays with it: after
/// three times v / a it has gone v (t - v / 2a); where the belt leads down from there, with tan of more than
/// mu, it slides on at g (sin - mu cos) all the same.
#[test]
fn a_belt_carries_boxes_of_any_size_up_a_slope() {
    for half in [0.02f32, 0.3, 5.0] {
        for hertz in [30.0f32, 60.0, 240.0] {
            for substeps in [1, 4, 8] {
                for (degrees, carried) in [(15.0_f64, true), (40.0, false)] {
                    let (sin, cos) = degrees.to_radians().sin_cos();
                    // The slope rises along x.
                    let gravity = DVec3::new(-sin, -cos, 0.0).as_vec3() * G as f32;
                    let settings = Settings::default().with_gravity(gravity).with_substeps(substeps);
                    let mut world = World::new(settings.with_length_unit(half.clamp(0.05, 1.0))).unwrap();
                    let rubber = Material::default().with_friction(0.6);
                    let speed = (G * f64::from(half)).sqrt() as f32;
                    let belt = rubber.with_surface_velocity(Vec3::X * speed);
                    world.add_body(&Floor::Plane.desc(belt)).unwrap();
                    // Low, so that friction does not tip it.
                    let geometry = Geometry::cuboid(half, 0.25 * half, half);
                    let body = world.add_body(&dynamic(geometry, rubber, Vec3::Y * 0.25 * half)).unwrap();
                    let pull = G * (0.6 * cos - sin);
                    let v = f64::from(speed);
                    let time = 3.0 * v / pull.abs();
                    let steps = (time * f64::from(hertz)).round();
                    (0..steps as u32).for_each(|_| _ = world.step(1.0 / hertz).unwrap());
                    let time = steps / f64::from(hertz);
                    let expected =
                        if carried { v * (time - 0.5 * v / pull) } else { 0.5 * pull * time * time };
                    let way = world.position(body).unwrap();
                    let name = format!("{half} m, {hertz} Hz, {substeps} substeps, {degrees} degrees");
                    // The start is within a step.
                    let step = (v + pull.abs() * time) / f64::from(hertz);
                    assert!(
                        (way.x - expected).abs() < 0.02 * expected.abs() + step,
                        "{name}: {way} {expected}"
                    );
                    assert!(way.z.abs() < 0.01 * expected.abs(), "{name}: {way}");
                }
            }
        }
    }
}

/// Caps over four orders of magnitude on bodies that gravity pulls and a torque turns. Expected: they come to
/// go at their caps, never above.
#[test]
fn caps_of_any_size_hold_at_any_rate() {
    for cap in [0.05f32, 2.0, 300.0] {
        for hertz in [30.0f32, 60.0, 240.0] {
            for substeps in [1, 4, 8] {
                let mut world = World::new(Settings::default().with_substeps(substeps)).unwrap();
                let ball = dynamic(Geometry::sphere(0.5), Material::default(), Vec3::ZERO);
                let ball = ball.with_max_linear_speed(cap).with_max_angular_speed(cap);
                let ball: BodyHandle = world.add_body(&ball).unwrap();
                let inertia = 0.4 * 0.25 * world.mass(ball).unwrap();
                let steps = (2.0 * cap / G as f32 * hertz) as u32 + 10;
                for step in 0..steps {
                    world.add_torque(ball, Vec3::X * (inertia * G as f32)).unwrap();
                    world.step(1.0 / hertz).unwrap();
                    let v = world.linear_velocity(ball).unwrap().length();
                    let w = world.angular_velocity(ball).unwrap().length();
                    assert!(v <= cap && w <= cap, "{cap} {hertz} Hz {substeps}, step {step}: {v} {w}");
                }
                let v = world.linear_velocity(ball).unwrap().length();
                let w = world.angular_velocity(ball).unwrap().length();
                assert!(v > 0.999 * cap && w > 0.999 * cap, "{cap} {hertz} Hz {substeps}: {v} {w}");
            }
        }
    }
}
