//! Belts: surfaces that move past their shape, by the material.
//!
//! A box on a belt of speed v is pulled by friction mu m g until it moves along: for v / (mu g) seconds, over
//! v² / (2 mu g).

#![allow(clippy::disallowed_methods, reason = "expected values may use the platform's functions")]

use crate::common::{self, Floor, G, dynamic, shape};
use backstop::glam::{DVec3, Quat, Vec3};
use backstop::{BodyDesc, BodyHandle, FrictionModel, Geometry, Material, Settings, Snapshot, World};

const DT: f32 = 1.0 / 60.0;
const MU: f32 = 0.5;

fn material() -> Material {
    Material::default().with_friction(MU)
}

fn crate_at(at: Vec3) -> BodyDesc {
    dynamic(Geometry::cuboid(0.3, 0.2, 0.3), material(), at)
}

/// On every kind of floor, with both friction models.
#[test]
fn a_box_reaches_the_speed_of_a_belt_in_the_time_of_coulomb() {
    let speed = 2.0f32;
    for floor in Floor::ALL {
        for model in [FrictionModel::Patch, FrictionModel::Point] {
            let mut world = World::new(Settings::default().with_friction_model(model)).unwrap();
            world.add_body(&floor.desc(material().with_surface_velocity(Vec3::X * speed))).unwrap();
            let body = world.add_body(&crate_at(Vec3::new(-3.0, 0.2, 0.1))).unwrap();
            let time = speed / (MU * G as f32);
            let mut reached = f32::NAN;
            for step in 1..=120 {
                world.step(DT).unwrap();
                if reached.is_nan() && world.linear_velocity(body).unwrap().x > 0.999 * speed {
                    reached = step as f32 * DT;
                }
            }
            let (v, at) = (world.linear_velocity(body).unwrap(), world.position(body).unwrap());
            let far = f64::from(speed * (2.0 - 0.5 * time));
            println!(
                "{floor:?} {model:?}: {reached:.3} of {time:.3} s, {:.4} of {far:.4} m, {v}",
                at.x + 3.0
            );
            assert!((reached - time).abs() < 1.5 * DT, "{floor:?} {model:?}: {reached} for {time} s");
            assert!((v - Vec3::X * speed).length() < 1e-3 * speed, "{floor:?} {model:?}: {v}");
            assert!((at.x + 3.0 - far).abs() < 0.01 * far && (at.z - 0.1).abs() < 1e-3, "{floor:?}: {at}");
        }
    }
}

/// The velocity is that of the shape's frame: a belt that is turned by a quarter pulls along -z, whether its
/// shape or its body is turned.
#[test]
fn a_belt_turns_with_its_shape() {
    for by_body in [false, true] {
        let quarter = common::turned(Vec3::Y, 90.0);
        let mut belt = shape(Geometry::cuboid(9.0, 1.0, 9.0), material().with_surface_velocity(Vec3::X));
        let mut desc = BodyDesc::fixed().with_position(Vec3::new(0.0, -1.0, 0.0));
        if by_body {
            desc.rotation = quarter;
        } else {
            belt.rotation = quarter;
        }
        let mut world = World::new(Settings::default()).unwrap();
        world.add_body(&desc.with_shape(belt)).unwrap();
        let body = world.add_body(&crate_at(Vec3::new(0.0, 0.2, 0.0))).unwrap();
        common::steps(&mut world, 120, DT);
        let v = world.linear_velocity(body).unwrap();
        assert!((v + Vec3::Z).length() < 1e-3, "{by_body}: {v}");
    }
}

/// A conveyor on a truck: a body on it moves by the sum of both velocities over a kinematic truck. A free
/// truck of mass M on ice is pushed back: with the crate of mass m on the belt, m v + M V = 0 and v - V = 1.
#[test]
fn belts_move_on_kinematic_and_dynamic_bodies() {
    let belt = shape(Geometry::cuboid(4.0, 0.25, 1.0), material().with_surface_velocity(Vec3::X));
    let mut world = World::new(Settings::default()).unwrap();
    let mut truck = BodyDesc::kinematic().with_position(Vec3::new(0.0, -0.25, 0.0)).with_shape(belt.clone());
    truck.linear_velocity = Vec3::Z * 0.7;
    world.add_body(&truck).unwrap();
    let body = world.add_body(&crate_at(Vec3::new(0.0, 0.2, 0.0))).unwrap();
    common::steps(&mut world, 120, DT);
    let v = world.linear_velocity(body).unwrap();
    assert!((v - Vec3::new(1.0, 0.0, 0.7)).length() < 2e-3, "on a kinematic truck: {v}");

    let mut world = World::new(Settings::default()).unwrap();
    world
        .add_body(
            &Floor::Plane.desc(
                Material::default().with_friction(0.0).with_friction_combine(backstop::Combine::Multiply),
            ),
        )
        .unwrap();
    let mut icy = belt.clone();
    icy.position = Vec3::new(0.0, 0.0, 0.0);
    let mut skates = shape(
        Geometry::cuboid(4.0, 0.05, 1.0),
        Material::default().with_friction(0.0).with_friction_combine(backstop::Combine::Minimum),
    );
    skates.position = Vec3::new(0.0, -0.3, 0.0);
    let truck = BodyDesc::dynamic().with_position(Vec3::new(0.0, 0.35, 0.0)).with_shapes([icy, skates]);
    let truck = world.add_body(&truck).unwrap();
    let body = world.add_body(&crate_at(Vec3::new(0.0, 0.8, 0.0))).unwrap();
    common::steps(&mut world, 120, DT);
    let (m, mass) = (world.mass(body).unwrap(), world.mass(truck).unwrap());
    let (v, of_truck) = (world.linear_velocity(body).unwrap(), world.linear_velocity(truck).unwrap());
    println!("crate {v}, truck {of_truck}, {m} and {mass} kg");
    assert!((m * v.x + mass * of_truck.x).abs() < 1e-3 * m, "momentum: {v} {of_truck}");
    assert!((v.x - of_truck.x - 1.0).abs() < 2e-3, "{v} against {of_truck}");
}

/// Where two belts meet, their velocities add up: a crate whose own underside runs with 1 m/s against a belt
/// of 1 m/s in the same direction stands still; against one that runs the other way it moves at twice that.
#[test]
fn two_belts_that_meet_add_up() {
    for (own, want) in [(1.0, 0.0), (-1.0, 2.0), (0.25, 0.75)] {
        let mut world = World::new(Settings::default()).unwrap();
        world.add_body(&Floor::Box.desc(material().with_surface_velocity(Vec3::X))).unwrap();
        let mut desc = crate_at(Vec3::new(0.0, 0.2, 0.0));
        desc.shapes[0].material = material().with_surface_velocity(Vec3::X * own);
        let body = world.add_body(&desc).unwrap();
        common::steps(&mut world, 150, DT);
        let v = world.linear_velocity(body).unwrap();
        assert!((v - Vec3::X * want).length() < 2e-3, "{own}: {v} for {want}");
    }
}

/// A belt that starts wakes the bodies on it, and one that stops lets them sleep again.
#[test]
fn a_belt_that_starts_wakes_what_lies_on_it() {
    let mut world = World::new(Settings::default().with_sleeping(true)).unwrap();
    let floor = world.add_body(&Floor::Box.desc(material())).unwrap();
    let belt = world.shapes(floor).unwrap().next().unwrap();
    let body = world.add_body(&crate_at(Vec3::new(-4.0, 0.2, 0.0))).unwrap();
    common::steps(&mut world, 120, DT);
    assert!(world.is_sleeping(body).unwrap());
    world.set_material(belt, material().with_surface_velocity(Vec3::X)).unwrap();
    common::steps(&mut world, 300, DT);
    assert!(!world.is_sleeping(body).unwrap());
    assert!((world.linear_velocity(body).unwrap().x - 1.0).abs() < 1e-3);
    world.set_material(belt, material()).unwrap();
    common::steps(&mut world, 120, DT);
    assert!(world.is_sleeping(body).unwrap());
    let part = world.feature_report().part(backstop::Feature::SurfaceVelocities);
    assert_eq!((part.count, part.bytes), (0, 0));
}

fn loaded(threads: usize) -> (World, Vec<BodyHandle>) {
    let mut world = World::new(Settings::default().with_threads(threads)).unwrap();
    world.add_body(&Floor::Mesh.desc(material().with_surface_velocity(Vec3::new(0.8, 0.0, 0.3)))).unwrap();
    let at =
        |i: u8| Vec3::new(f32::from(i % 5) * 0.8 - 2.0, 0.3 + f32::from(i / 5) * 0.5, f32::from(i % 3) * 0.4);
    let bodies = (0..25).map(|i| world.add_body(&crate_at(at(i))).unwrap()).collect();
    (world, bodies)
}

fn poses(world: &World, bodies: &[BodyHandle]) -> Vec<(DVec3, Quat)> {
    bodies.iter().map(|&b| (world.position(b).unwrap(), world.rotation(b).unwrap())).collect()
}

/// To the bit: on one thread and two, and after a snapshot in bytes.
#[test]
fn belts_are_the_same_on_any_threads_and_from_a_snapshot() {
    let ((mut world, bodies), (mut twin, twins)) = (loaded(1), loaded(2));
    common::steps(&mut world, 60, DT);
    common::steps(&mut twin, 60, DT);
    assert_eq!(poses(&world, &bodies), poses(&twin, &twins));
    let mut snapshot = Snapshot::new();
    world.snapshot(&mut snapshot);
    let bytes = snapshot.to_whole_bytes();
    common::steps(&mut world, 90, DT);
    let want = poses(&world, &bodies);
    twin.restore(&Snapshot::from_bytes(&bytes).unwrap()).unwrap();
    common::steps(&mut twin, 90, DT);
    assert_eq!(poses(&twin, &twins), want);
}
