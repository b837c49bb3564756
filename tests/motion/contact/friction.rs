//! Coulomb's law: sliding distances, the angle of friction, rolling, and the settings of friction.

#![allow(clippy::disallowed_methods, reason = "expected values may use the platform's functions")]

use crate::common::{self, Floor, G, dynamic};
use backstop::glam::{DVec3, Quat, Vec3};
use backstop::{BodyHandle, FrictionCone, FrictionModel, Geometry, Material, Settings, World};

const DT: f32 = 1.0 / 60.0;

/// A flat box of 1 x 0.4 x 1 m on a floor, pushed along it at `degrees` from x.
fn slide(settings: Settings, floor: Floor, material: Material, speed: f32, degrees: f32) -> DVec3 {
    let mut world = World::new(settings).unwrap();
    world.add_body(&floor.desc(material)).unwrap();
    let (sin, cos) = degrees.to_radians().sin_cos();
    let push = Vec3::new(cos, 0.0, sin) * speed;
    let start = Vec3::new(-3.1, 0.2, -2.7);
    let body = dynamic(Geometry::cuboid(0.5, 0.2, 0.5), material, start).with_velocity(push, Vec3::ZERO);
    let body = world.add_body(&body).unwrap();
    common::steps(&mut world, 240, DT);
    assert!(world.linear_velocity(body).unwrap().length() < 1e-3, "{floor:?}: it still slides");
    world.position(body).unwrap() - start.as_dvec3()
}

/// v² / (2 mu g), in the direction of the push.
#[test]
fn a_box_slides_as_far_as_coulomb_says_in_every_direction() {
    let (speed, mu) = (5.0f32, 0.5f32);
    let want = f64::from(speed * speed) / (2.0 * f64::from(mu) * G);
    for model in [FrictionModel::Patch, FrictionModel::Point] {
        for floor in Floor::ALL {
            for degrees in [0.0, 22.5, 45.0, 60.0] {
                let settings = Settings::default().with_friction_model(model);
                let way = slide(settings, floor, Material::default().with_friction(mu), speed, degrees);
                let along = f64::from(degrees).to_radians();
                let (far, aside) =
                    (way.x * along.cos() + way.z * along.sin(), way.z * along.cos() - way.x * along.sin());
                println!("{model:?} {floor:?} {degrees}: {far:.4} of {want:.4} m, aside {aside:.5}");
                assert!((far - want).abs() < 0.01 * want, "{model:?} {floor:?} {degrees}: {far} for {want}");
                assert!(aside.abs() < 0.001 * want, "{model:?} {floor:?} {degrees}: {aside} aside");
            }
        }
    }
}

/// A long box has another inertia about each axis, but friction is against the motion all the same.
#[test]
fn a_long_box_slides_straight() {
    for model in [FrictionModel::Patch, FrictionModel::Point] {
        let mut world = World::new(Settings::default().with_friction_model(model)).unwrap();
        let material = Material::default().with_friction(0.5);
        world.add_body(&Floor::Box.desc(material)).unwrap();
        let push = Vec3::new(1.0, 0.0, 1.0).normalize() * 5.0;
        let body = dynamic(Geometry::cuboid(0.9, 0.2, 0.3), material, Vec3::new(0.0, 0.2, 0.0));
        let body = world.add_body(&body.with_velocity(push, Vec3::ZERO)).unwrap();
        common::steps(&mut world, 120, DT);
        let way = world.position(body).unwrap();
        let (far, want) = (common::sideways(way), 25.0 / (2.0 * 0.5 * G));
        assert!((far - want).abs() < 0.01 * want, "{model:?}: {far} for {want}");
        println!("{model:?}: aside {:.5}", way.x - way.z);
        assert!((way.x - way.z).abs() < 0.001 * want, "{model:?}: {way}");
    }
}

/// Each axis has its own Coulomb law: along an axis as the cone, along the diagonal sqrt 2 as strong.
#[test]
fn the_friction_box_is_too_strong_along_its_diagonal_by_root_two() {
    let (speed, mu) = (5.0f32, 0.5f32);
    let cone = f64::from(speed * speed) / (2.0 * f64::from(mu) * G);
    for (degrees, want) in [(0.0, cone), (90.0, cone), (45.0, cone / 2f64.sqrt())] {
        let settings = Settings::default().with_friction_cone(FrictionCone::Box);
        let way = slide(settings, Floor::Box, Material::default().with_friction(mu), speed, degrees);
        let far = common::sideways(way);
        assert!((far - want).abs() < 0.01 * want, "{degrees}: {far} for {want}");
    }
}

/// Four corners at the distance r from the middle: torque mu m g r, moment of inertia m a² / 6 for the side
/// a.
#[test]
fn a_spinning_box_stops_after_the_time_that_its_corners_need() {
    let (mu, spin, side) = (0.5f64, 10.0f64, 1.0f64);
    let want = spin * side * side / 6.0 / (mu * G * side / 2f64.sqrt());
    for model in [FrictionModel::Patch, FrictionModel::Point] {
        let mut world = World::new(Settings::default().with_friction_model(model)).unwrap();
        let material = Material::default().with_friction(mu as f32);
        world.add_body(&Floor::Box.desc(material)).unwrap();
        let body = dynamic(Geometry::cuboid(0.5, 0.2, 0.5), material, Vec3::new(0.0, 0.2, 0.0));
        let body = world.add_body(&body.with_velocity(Vec3::ZERO, Vec3::Y * spin as f32)).unwrap();
        let dt = 1.0 / 240.0;
        let mut steps = 0;
        while world.angular_velocity(body).unwrap().y > 0.01 {
            world.step(dt).unwrap();
            steps += 1;
            assert!(steps < 2400, "{model:?}: it still spins");
        }
        let time = f64::from(steps) * f64::from(dt);
        println!("{model:?}: {time:.4} of {want:.4} s");
        assert!((time - want).abs() < 0.02 * want, "{model:?}: {time} for {want}");
    }
}

/// A box at rest on a slope of `degrees`, and the direction down the slope.
fn on_slope(floor: Floor, degrees: f32, material: Material) -> (World, BodyHandle, Vec3) {
    let tilt: Quat = common::turned(Vec3::Z, -degrees);
    let mut world = World::new(Settings::default()).unwrap();
    world.add_body(&floor.desc(material).with_rotation(tilt)).unwrap();
    let at = tilt * Vec3::new(-8.0, 0.2, 0.0);
    let body = dynamic(Geometry::cuboid(0.5, 0.2, 0.5), material, at).with_rotation(tilt);
    let body = world.add_body(&body).unwrap();
    (world, body, tilt * Vec3::X)
}

/// The angle of friction: a box holds if and only if tan(slope) <= mu.
#[test]
fn a_box_holds_on_a_slope_just_below_the_angle_of_friction() {
    for floor in Floor::ALL {
        for degrees in [10.0f32, 20.0, 35.0] {
            let mu = degrees.to_radians().tan() + 0.01;
            let (mut world, body, _) = on_slope(floor, degrees, Material::default().with_friction(mu));
            // A second to settle into the surface.
            common::steps(&mut world, 60, DT);
            let start = world.position(body).unwrap();
            common::steps(&mut world, 3600, DT);
            let creep = (world.position(body).unwrap() - start).length() / 60.0;
            println!("{floor:?} {degrees}: {creep:.2e} m/s");
            assert!(creep < 1e-4, "{floor:?} {degrees} degrees: creeps at {creep} m/s");
        }
    }
}

/// Just above the angle it slides with a = g (sin - mu cos).
#[test]
fn a_box_slides_on_a_slope_just_above_the_angle_of_friction() {
    for floor in Floor::ALL {
        for degrees in [10.0f32, 20.0, 35.0] {
            let angle = f64::from(degrees).to_radians();
            let mu = angle.tan() - 0.01;
            let (mut world, body, down) =
                on_slope(floor, degrees, Material::default().with_friction(mu as f32));
            common::steps(&mut world, 60, DT);
            let speed = |w: &World| f64::from(w.linear_velocity(body).unwrap().dot(down));
            let before = speed(&world);
            common::steps(&mut world, 300, DT);
            let a = (speed(&world) - before) / 5.0;
            let want = G * (angle.sin() - mu * angle.cos());
            println!("{floor:?} {degrees}: {a:.5} of {want:.5} m/s²");
            assert!((a - want).abs() < 0.02 * want, "{floor:?} {degrees}: {a} for {want}");
        }
    }
}

/// A ball that starts without spin rolls at 5/7 of its speed (moment of inertia 2/5 m r²), and goes on so.
#[test]
fn a_sliding_ball_ends_up_rolling_at_five_sevenths_of_its_speed() {
    for floor in Floor::ALL {
        let material = Material::default().with_friction(0.3);
        let mut world = World::new(Settings::default()).unwrap();
        world.add_body(&floor.desc(material)).unwrap();
        let body = dynamic(Geometry::Sphere { radius: 0.5 }, material, Vec3::new(-8.3, 0.5, 0.1));
        let ball = world.add_body(&body.with_velocity(Vec3::X * 4.0, Vec3::ZERO)).unwrap();
        common::steps(&mut world, 180, DT);
        let (v, w) = (world.linear_velocity(ball).unwrap(), world.angular_velocity(ball).unwrap());
        let want = 4.0 * 5.0 / 7.0;
        println!("{floor:?}: {} of {want} m/s, {} rad/s", v.x, w.z);
        assert!((v.x - want).abs() < 1e-3 * want, "{floor:?}: {} for {want}", v.x);
        assert!((v.x + 0.5 * w.z).abs() < 1e-3 * want, "{floor:?}: rolls without slipping");
    }
}

/// On a slope between the two angles a box at rest stays, and one that slides goes on sliding, by the dynamic
/// law.
#[test]
fn static_friction_holds_what_dynamic_friction_would_not() {
    let material = Material::default().with_static_friction(0.6).with_dynamic_friction(0.3);
    let degrees = 0.45f32.atan().to_degrees();
    let (mut world, body, down) = on_slope(Floor::Box, degrees, material);
    common::steps(&mut world, 60, DT);
    let start = world.position(body).unwrap();
    common::steps(&mut world, 600, DT);
    let creep = (world.position(body).unwrap() - start).length() / 10.0;
    assert!(creep < 1e-4, "creeps at {creep} m/s");

    world.set_velocity(body, down * 1.0, Vec3::ZERO).unwrap();
    common::steps(&mut world, 60, DT);
    let speed = f64::from(world.linear_velocity(body).unwrap().dot(down));
    let angle = f64::from(degrees).to_radians();
    let want = 1.0 + G * (angle.sin() - 0.3 * angle.cos());
    assert!((speed - want).abs() < 0.02 * want, "{speed} for {want} m/s");

    let far = slide(Settings::default(), Floor::Box, material, 4.0, 30.0);
    let want = 16.0 / (2.0 * 0.3 * G);
    assert!((common::sideways(far) - want).abs() < 0.01 * want, "slides {far} for {want} m");
}
