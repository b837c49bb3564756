//! Soft contacts: a spring of the material's frequency f acts where shapes overlap, up to a rigid stop.
//!
//! With omega = 2 pi f, a body rests at a depth of g / omega² whatever its mass, and one that falls on the
//! spring with speed v comes to v / omega (with gravity, by energy: the root of omega² x² / 2 = v² / 2 + g x).

#![allow(clippy::disallowed_methods, reason = "expected values may use the platform's functions")]

use crate::common::{Floor, G, dynamic};
use backstop::glam::{DVec3, Quat, Vec3};
use backstop::{BodyDesc, BodyHandle, FrictionModel, Geometry, Material, Settings, Snapshot, World};

const TAU: f64 = std::f64::consts::TAU;

fn soft(hertz: f32, damping: f32) -> Material {
    Material::default().with_contact_hertz(hertz).with_contact_damping(damping)
}

fn world(settings: Settings, floor: Floor, material: Material) -> World {
    let mut world = World::new(settings).unwrap();
    world.add_body(&floor.desc(material)).unwrap();
    world
}

fn height(world: &World, body: BodyHandle) -> f64 {
    world.position(body).unwrap().y
}

/// Of a body that does not rotate [J/kg].
fn energy(world: &World, body: BodyHandle) -> f64 {
    let v = f64::from(world.linear_velocity(body).unwrap().length());
    0.5 * v * v + G * height(world, body)
}

fn run(world: &mut World, dt: f32, seconds: f32) {
    (0..(seconds / dt).round() as u32).for_each(|_| drop(world.step(dt).unwrap()));
}

/// g / omega², at any rate, with any number of substeps, for any mass and shape.
#[test]
fn a_body_sinks_by_its_weight_on_the_spring() {
    let shapes = [
        (Geometry::sphere(0.5), 0.5),
        (Geometry::cuboid(0.5, 0.5, 0.5), 0.5),
        (Geometry::cuboid(1.2, 0.4, 0.7), 0.4),
        (Geometry::cylinder(0.5, 0.4), 0.5),
    ];
    for (geometry, half) in shapes {
        for floor in [Floor::Box, Floor::Plane, Floor::Mesh] {
            for (hertz, damping) in [(4.0, 1.0), (7.0, 0.3), (10.0, 1.0)] {
                for (rate, substeps, density) in
                    [(30.0, 4, 1.0), (60.0, 4, 1000.0), (60.0, 2, 20.0), (120.0, 1, 5e4), (60.0, 8, 1.0)]
                {
                    let settings = Settings::default().with_substeps(substeps);
                    let mut world = world(settings, floor, soft(hertz, damping));
                    let at = Vec3::new(0.3, half as f32, 0.2);
                    let mut desc = dynamic(geometry.clone(), Material::default(), at);
                    desc.shapes[0].density = density;
                    let body = world.add_body(&desc).unwrap();
                    run(&mut world, 1.0 / rate, 8.0);
                    let depth = half - height(&world, body);
                    let expected = G / (TAU * f64::from(hertz)).powi(2);
                    let name = geometry.kind_name();
                    assert!(
                        (depth - expected).abs() < 0.01 * expected,
                        "{name} {floor:?} {hertz} Hz {rate}/s x{substeps} {density}: {depth} for {expected}"
                    );
                }
            }
        }
    }
}

/// By energy: the depth of the first bounce; and nothing is ever gained. With damping 0 a bounce gives back
/// nearly all; with damping 1 the ball comes to rest where its weight holds the spring, and sleeps.
#[test]
fn a_ball_that_falls_on_a_spring_comes_back_with_its_energy() {
    for floor in [Floor::Box, Floor::Plane, Floor::Mesh] {
        for (hertz, drop) in [(10.0, 0.5), (6.0, 0.3), (10.0, 1.1), (20.0, 1.5)] {
            for (rate, substeps) in [(60.0, 4), (30.0, 8), (120.0, 4), (60.0, 16)] {
                let settings = Settings::default().with_substeps(substeps);
                let mut world = world(settings, floor, soft(hertz, 0.0));
                let at = Vec3::new(0.1, 0.5 + drop, 0.2);
                let body = world.add_body(&dynamic(Geometry::sphere(0.5), Material::default(), at)).unwrap();
                let start = energy(&world, body);
                let (mut deepest, mut highest, mut most) = (0.0_f64, 0.0_f64, 0.0_f64);
                let dt = 1.0 / rate;
                let minute = (60.0 * rate) as u32;
                let mut top = Vec::new();
                for step in 0..minute {
                    world.step(dt).unwrap();
                    let depth = 0.5 - height(&world, body);
                    deepest = deepest.max(depth);
                    if depth <= 0.0 {
                        most = most.max(energy(&world, body));
                    }
                    if step >= minute - (2.0 * rate) as u32 {
                        highest = highest.max(height(&world, body) - 0.5);
                    }
                    if step % (rate as u32 * 10) == 0 {
                        top.push(energy(&world, body));
                    }
                }
                let omega = TAU * f64::from(hertz);
                let sag = G / (omega * omega);
                let expected = sag + (sag * sag + 2.0 * sag * f64::from(drop)).sqrt();
                let name = format!("{floor:?} {hertz} Hz from {drop} m, {rate}/s x{substeps}");
                println!(
                    "{name}: depth {deepest:.5} of {expected:.5}, energy {:.6} of {start:.6}, top {highest:.4}",
                    most
                );
                assert!((deepest / expected - 1.0).abs() < 0.06, "{name}: {deepest} for {expected}");
                assert!(most < start * (1.0 + 2e-5), "{name}: energy {start} to {most}");
                assert!(highest > 0.9 * f64::from(drop), "{name}: back at {highest}");
            }
        }
    }
}
