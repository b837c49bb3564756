//! Greatest speeds of bodies: no speed that a caller sees is above, and they take only energy.

use crate::common::{self, Floor, G, dynamic};
use backstop::glam::{DVec3, Quat, Vec3};
use backstop::{BodyDesc, BodyHandle, ContinuousMethod, Geometry, Material, Settings, Snapshot, World};

const DT: f32 = 1.0 / 60.0;

fn speeds(world: &World, body: BodyHandle) -> (f32, f32) {
    (world.linear_velocity(body).unwrap().length(), world.angular_velocity(body).unwrap().length())
}

/// A ball that falls without end comes to fall at its greatest speed: along the parabola up to there, and at
/// most that speed times a step in every step.
#[test]
fn a_falling_body_falls_at_its_greatest_speed() {
    for substeps in [1, 4] {
        let cap = 5.0f32;
        let mut world = World::new(Settings::default().with_substeps(substeps)).unwrap();
        let ball = dynamic(Geometry::sphere(0.5), Material::default(), Vec3::ZERO).with_max_linear_speed(cap);
        let ball = world.add_body(&ball).unwrap();
        let mut last = 0.0;
        for step in 1..=120u32 {
            world.step(DT).unwrap();
            let (speed, y) = (speeds(&world, ball).0, world.position(ball).unwrap().y);
            assert!(speed <= cap, "{substeps}, step {step}: {speed} m/s");
            assert!(last - y <= f64::from(cap * DT) * (1.0 + 1e-5), "step {step}: {} m", last - y);
            last = y;
        }
        // v t - v² / 2g, less at most half of what a substep falls in each, while it is held.
        let (time, v) = (2.0, f64::from(cap));
        let want = v * time - v * v / (2.0 * G);
        let lag = 0.5 * G * f64::from(DT) / f64::from(substeps) * time;
        assert!((-last) <= want + 1e-3 && (-last) >= want - lag - 1e-3, "{last} for {want}");
        assert!((speeds(&world, ball).0 - cap).abs() < 1e-4 * cap);
    }
}

/// All causes of speed: a velocity that is set, forces, impulses, a bat, spin that precesses.
#[test]
fn no_step_leaves_a_body_faster_than_its_greatest_speeds() {
    let methods = [ContinuousMethod::OnePass, ContinuousMethod::ConservativeAdvancement];
    for method in methods {
        let (linear, angular) = (8.0f32, 6.0f32);
        let mut world = World::new(Settings::default().with_continuous_method(method)).unwrap();
        let bouncy = Material::default().with_restitution(0.9);
        world.add_body(&Floor::Mesh.desc(bouncy)).unwrap();
        let bodies: Vec<BodyHandle> = (0..12u8)
            .map(|i| {
                let at = Vec3::new(f32::from(i % 4) - 1.5, 0.6 + f32::from(i / 4), 0.0);
                let desc = dynamic(Geometry::cuboid(0.3, 0.1, 0.2), bouncy, at)
                    .with_velocity(Vec3::new(0.0, -30.0, 5.0), Vec3::new(1.0, 40.0, 2.0))
                    .with_max_linear_speed(linear)
                    .with_max_angular_speed(angular);
                world.add_body(&desc).unwrap()
            })
            .collect();
        let bat = dynamic(Geometry::sphere(0.4), bouncy.with_friction(0.1), Vec3::new(-9.0, 0.8, 0.0))
            .with_velocity(Vec3::X * 60.0, Vec3::ZERO);
        world.add_body(&bat).unwrap();
        for step in 0..300u32 {
            let body = bodies[step as usize % bodies.len()];
            match step % 60 {
                5 => world.apply_angular_impulse(body, Vec3::new(0.0, 500.0, 20.0)).unwrap(),
                20 => world.set_velocity(body, Vec3::new(3.0, 90.0, 0.0), Vec3::Z * 70.0).unwrap(),
                40 => world.add_force(body, Vec3::X * 1e5).unwrap(),
                _ => {}
            }
            let before: Vec<DVec3> = bodies.iter().map(|&b| world.position(b).unwrap()).collect();
            world.step(DT).unwrap();
            for (&body, before) in bodies.iter().zip(before) {
                let (v, w) = speeds(&world, body);
                assert!(v <= linear && w <= angular, "{method:?} step {step}: {v} m/s, {w} rad/s");
                let moved = (world.position(body).unwrap() - before).length() as f32;
                // Overlap that is pushed apart moves a body without giving it that speed.
                assert!(moved < 1.5 * linear * DT, "{method:?} step {step}: {moved} m");
            }
        }
    }
}

/// Kinetic and potential energy of a free box that spins and is thrown up never grow, with any cap.
#[test]
fn a_cap_only_takes_energy() {
    for (linear, angular) in [(6.0f32, 30.0f32), (20.0, 4.0), (3.0, 2.0)] {
        let mut world = World::new(Settings::default()).unwrap();
        let body = dynamic(Geometry::cuboid(0.5, 0.2, 0.3), Material::default(), Vec3::ZERO)
            .with_velocity(Vec3::new(4.0, 9.0, 0.0), Vec3::new(0.3, 10.0, 0.4))
            .with_max_linear_speed(linear)
            .with_max_angular_speed(angular);
        let body = world.add_body(&body).unwrap();
        let inertia = world.mass_properties(body).unwrap();
        let energy = |world: &World| {
            let (v, w) = (world.linear_velocity(body).unwrap(), world.angular_velocity(body).unwrap());
            let local = world.rotation(body).unwrap().inverse() * w;
            0.5 * f64::from(inertia.mass * v.length_squared() + local.dot(inertia.inertia * local))
                + f64::from(inertia.mass) * G * world.position(body).unwrap().y
        };
        let mut last = energy(&world);
        for step in 0..180 {
            world.step(DT).unwrap();
            let now = energy(&world);
            assert!(now <= last + 1e-5 * last.abs().max(100.0), "{linear} step {step}: {last} to {now} J");
            last = now;
        }
    }
}

/// A cap above what a body does changes no bit of it; one that is set later holds from the next step on, and
/// can be taken away.
#[test]
fn caps_can_be_read_set_and_taken_away() {
    let run = |desc: &BodyDesc| {
        let mut world = World::new(Settings::default()).unwrap();
        world.add_body(&Floor::Box.desc(Material::default())).unwrap();
        let body = world.add_body(desc).unwrap();
        common::steps(&mut world, 120, DT);
        (world, body)
    };
    let free = dynamic(Geometry::cuboid(0.2, 0.3, 0.1), Material::default(), Vec3::Y * 2.0)
        .with_velocity(Vec3::X, Vec3::new(1.0, 2.0, 3.0));
    let ((plain, a), (mut world, b)) = (run(&free), run(&free.clone().with_max_linear_speed(100.0)));
    assert_eq!(plain.position(a).unwrap(), world.position(b).unwrap());
    assert_eq!(plain.max_speeds(a).unwrap(), [None, None]);
    assert_eq!(world.max_speeds(b).unwrap(), [Some(100.0), None]);
    world.set_velocity(b, Vec3::Y * 9.0, Vec3::X * 9.0).unwrap();
    world.set_max_speeds(b, Some(2.0), Some(1.0)).unwrap();
    world.step(DT).unwrap();
    assert!(speeds(&world, b).0 <= 2.0 && speeds(&world, b).1 <= 1.0, "{:?}", speeds(&world, b));
    world.set_max_speeds(b, None, None).unwrap();
    world.set_velocity(b, Vec3::Y * 9.0, Vec3::X * 9.0).unwrap();
    world.step(DT).unwrap();
    assert!(speeds(&world, b).0 > 8.0 && speeds(&world, b).1 > 8.0);
    for bad in [-1.0, f32::NAN, f32::INFINITY, 2e6] {
        assert!(world.set_max_speeds(b, Some(bad), None).is_err(), "{bad}");
        assert!(world.set_max_speeds(b, None, Some(bad)).is_err(), "{bad}");
        assert!(world.add_body(&free.clone().with_max_angular_speed(bad)).is_err(), "{bad}");
    }
    assert_eq!(world.max_speeds(b).unwrap(), [None, None]);
}

fn thrown(threads: usize) -> (World, Vec<BodyHandle>) {
    let mut world = World::new(Settings::default().with_threads(threads)).unwrap();
    world.add_body(&Floor::Plane.desc(Material::default())).unwrap();
    let bodies = (0..40u8)
        .map(|i| {
            let at = Vec3::new(f32::from(i % 6) * 0.7, 0.5 + f32::from(i / 6) * 0.7, f32::from(i % 5) * 0.2);
            let mut desc = dynamic(Geometry::cuboid(0.2, 0.2, 0.3), Material::default(), at)
                .with_velocity(Vec3::new(0.0, 3.0, f32::from(i)), Vec3::X * 9.0);
            if i % 3 == 0 {
                desc = desc.with_max_linear_speed(2.0 + 0.1 * f32::from(i)).with_max_angular_speed(3.0);
            }
            world.add_body(&desc).unwrap()
        })
        .collect();
    (world, bodies)
}

fn poses(world: &World, bodies: &[BodyHandle]) -> Vec<(DVec3, Quat)> {
    bodies.iter().map(|&b| (world.position(b).unwrap(), world.rotation(b).unwrap())).collect()
}

/// To the bit: on one thread and two, and after a snapshot in bytes.
#[test]
fn capped_bodies_are_the_same_on_any_threads_and_from_a_snapshot() {
    let ((mut world, bodies), (mut twin, twins)) = (thrown(1), thrown(2));
    common::steps(&mut world, 20, DT);
    common::steps(&mut twin, 20, DT);
    assert_eq!(poses(&world, &bodies), poses(&twin, &twins));
    let mut snapshot = Snapshot::new();
    world.snapshot(&mut snapshot);
    let bytes = snapshot.to_whole_bytes();
    common::steps(&mut world, 90, DT);
    twin.set_max_speeds(twins[0], None, Some(1.0)).unwrap();
    twin.restore(&Snapshot::from_bytes(&bytes).unwrap()).unwrap();
    assert_eq!(twin.max_speeds(twins[0]).unwrap(), [Some(2.0), Some(3.0)]);
    common::steps(&mut twin, 90, DT);
    assert_eq!(poses(&world, &bodies), poses(&twin, &twins));
}
