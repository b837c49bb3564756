//! Friction of impacts: a body that lands at an angle is slowed and set spinning in the step in which it
//! lands, by Coulomb's law for impulses, although potential points have no friction while rows are solved.

#![allow(clippy::disallowed_methods, reason = "expected values may use the platform's functions")]

use crate::common::{self, Floor, dynamic};
use backstop::glam::{DVec3, Vec3};
use backstop::{BodyHandle, Geometry, Material, Settings, World};

const RADIUS: f32 = 0.1;

fn world() -> World {
    World::new(Settings::default().with_gravity(Vec3::ZERO)).unwrap()
}

/// Something that is thrown at a floor, without spin, and its velocities after it landed.
fn land(floor: Floor, geometry: Geometry, material: Material, throw: Vec3, dt: f32) -> (Vec3, Vec3) {
    let mut world = world();
    world.add_body(&floor.desc(material)).unwrap();
    let body = dynamic(geometry, material, Vec3::new(-3.1, 1.13, 0.2)).with_velocity(throw, Vec3::ZERO);
    let body = world.add_body(&body).unwrap();
    let steps = (1.13 / -throw.y / dt) as u32 + 3;
    common::steps(&mut world, steps, dt);
    (world.linear_velocity(body).unwrap(), world.angular_velocity(body).unwrap())
}

/// The normal impulse is m v (1 + e). Friction takes mu times that, or what it needs to make the ball roll:
/// 2/7 of its speed along the floor. The spin has 5/2 of the impulse that it took, over m r.
#[test]
fn a_ball_that_lands_at_an_angle_is_slowed_as_coulomb_says() {
    for floor in Floor::ALL {
        for dt in [1.0 / 30.0, 1.0 / 60.0, 1.0 / 240.0] {
            for (mu, e, throw) in [
                (0.6, 0.0, Vec3::new(20.0, -40.0, 0.0)),
                (0.1, 0.0, Vec3::new(20.0, -40.0, 0.0)),
                (0.6, 0.0, Vec3::new(0.0, -5.0, 20.0)),
                (0.1, 0.5, Vec3::new(20.0, -40.0, 0.0)),
                (0.6, 0.8, Vec3::new(-8.0, -30.0, 6.0)),
            ] {
                let material = Material::default().with_friction(mu).with_restitution(e);
                let (v, w) = land(floor, Geometry::Sphere { radius: RADIUS }, material, throw, dt);
                let along = Vec3::new(throw.x, 0.0, throw.z);
                let lost = (mu * (1.0 + e) * -throw.y).min(along.length() * 2.0 / 7.0);
                let way = along.normalize();
                let (slower, spin) = (along - way * lost, Vec3::Y.cross(way) * (2.5 * lost / RADIUS));
                let case = format!("{floor:?} dt {dt} mu {mu} e {e} {throw}");
                let off = (Vec3::new(v.x, 0.0, v.z) - slower).length();
                assert!(off < 0.01 * lost, "{case}: {v} for {slower}");
                assert!((w - spin).length() < 0.01 * spin.length(), "{case}: {w} for {spin}");
                assert!((v.y + e * throw.y).abs() < 0.01 * -throw.y, "{case}: {v}");
            }
        }
    }
}

/// Nothing is added from outside: momentum, and angular momentum about any point, stay; energy does not grow.
#[test]
fn balls_that_graze_each_other_spin_and_keep_their_momentum() {
    for dt in [1.0 / 30.0, 1.0 / 60.0, 1.0 / 240.0] {
        let mut world = world();
        let material = Material::default().with_friction(0.4);
        let ball = |at: Vec3, v: Vec3, r: f32| {
            dynamic(Geometry::Sphere { radius: r }, material, at).with_velocity(v, Vec3::ZERO)
        };
        let a = world.add_body(&ball(Vec3::new(-4.0, 0.08, 0.0), Vec3::X * 50.0, 0.1)).unwrap();
        let b = world.add_body(&ball(Vec3::new(4.0, 0.0, 0.03), Vec3::X * -30.0, 0.15)).unwrap();
        let before = sums(&world, &[a, b]);
        common::steps(&mut world, (0.2 / dt) as u32, dt);
        let after = sums(&world, &[a, b]);
        assert!((after.0 - before.0).length() < 1e-5 * before.2, "{dt}: {before:?} {after:?}");
        // A step moves the bodies with the velocities of its end: that much their paths are off.
        assert!((after.1 - before.1).length() < 0.02 * before.1.length(), "{dt}: {before:?} {after:?}");
        assert!(after.2 < before.2, "{dt}: {before:?} {after:?}");
        for body in [a, b] {
            assert!(world.angular_velocity(body).unwrap().length() > 10.0, "{dt}: it does not spin");
        }
    }
}

/// Momentum, angular momentum about the origin, and energy.
fn sums(world: &World, bodies: &[BodyHandle]) -> (DVec3, DVec3, f64) {
    bodies.iter().fold((DVec3::ZERO, DVec3::ZERO, 0.0), |(p, l, energy), &body| {
        let mass = f64::from(world.mass(body).unwrap());
        let radius = if mass > 10.0 { 0.15 } else { 0.1 };
        let inertia = 0.4 * mass * radius * radius;
        let v = world.linear_velocity(body).unwrap().as_dvec3();
        let w = world.angular_velocity(body).unwrap().as_dvec3();
        let at = world.centre_of_mass(body).unwrap();
        let own = 0.5 * (mass * v.length_squared() + inertia * w.length_squared());
        (p + v * mass, l + at.cross(v) * mass + w * inertia, energy + own)
    })
}

/// A box that lands flat slides on slower by mu times the speed at which it came down, and stays flat.
#[test]
fn a_box_that_lands_flat_slides_on() {
    for floor in Floor::ALL {
        for dt in [1.0 / 30.0, 1.0 / 60.0, 1.0 / 240.0] {
            let material = Material::default().with_friction(0.2);
            let throw = Vec3::new(20.0, -10.0, 0.0);
            let (v, w) = land(floor, Geometry::cuboid(0.5, 0.1, 0.5), material, throw, dt);
            println!("{floor:?} {dt}: {v} {w}");
            assert!((v.x - 18.0).abs() < 0.01 * 20.0, "{floor:?} dt {dt}: {v}");
            assert!(w.length() < 0.1, "{floor:?} dt {dt}: {w}");
        }
    }
}
