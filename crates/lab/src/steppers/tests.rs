//! The laws of impact hold, and the order of contacts does not matter.

use super::*;
use crate::LabWorld;
use crate::methods::Effort;
use crate::system::SystemLaw;
use crate::system::SystemProblems;
use crate::system::{Stabilisation, System, Velocity};
use backstop::BodyDesc;
use backstop::Settings;
use backstop::World;
use backstop::{Geometry, Material, ShapeDesc};
use glam::{DVec3, Vec3};

/// Balls of 1 m that touch, the outer ones on their way to the others: frictionless, in the plane, without
/// gravity.
fn huddle(restitution: f32) -> System {
    // Every impact bounces, however slow.
    let settings = Settings::default().with_gravity(Vec3::ZERO).with_restitution_threshold(0.0);
    let mut world = World::new(settings).unwrap();
    let material = Material::default().with_friction(0.0).with_restitution(restitution);
    let ball = ShapeDesc::new(Geometry::Sphere { radius: 0.5 }).with_material(material);
    let high = 0.75_f64.sqrt();
    let places = [(0.0, 0.0), (1.0, 0.0), (0.5, high), (-0.5, high), (2.0, 0.0), (-1.0, 0.0)];
    for (i, (x, y)) in places.into_iter().enumerate() {
        let place = DVec3::new(x, y, 0.0);
        let speed = if i < 3 { Vec3::ZERO } else { (DVec3::new(0.5, 0.3, 0.0) - place).as_vec3() };
        world
            .add_body(
                &BodyDesc::dynamic()
                    .with_position(place)
                    .with_velocity(speed, Vec3::ZERO)
                    .with_shape(ball.clone()),
            )
            .unwrap();
    }
    world.measure_accuracy(true);
    world.step(1.0 / 60.0).unwrap();
    world.system().unwrap().clone()
}

/// The same contacts in another order.
fn reversed(system: &System) -> System {
    let mut other = system.clone();
    other.laws.reverse();
    other.rows.reverse();
    let rows = other.rows.len();
    other.laws.iter_mut().for_each(|law: &mut SystemLaw| law.first = rows - 1 - law.first);
    other
}

fn end(system: &System, resolve: Resolve) -> Vec<Velocity> {
    let [island] = system.islands.as_slice() else { panic!("{} islands", system.islands.len()) };
    let problem = system.problem_of(&island.laws, Stabilisation::Rest).unwrap();
    let step = Step { system, island, problem: &problem, stabilisation: Stabilisation::Rest };
    resolve(&step, &Effort::default()).end
}

/// Ties between impacts are broken by their bodies, so the result is the same to rounding: 1e-12 at speeds of
/// a few m/s.
#[test]
fn the_order_of_contacts_does_not_matter() {
    for restitution in [0.0, 0.5, 1.0] {
        let system = huddle(restitution);
        assert!(system.laws.len() >= 5 && system.laws.iter().all(|law| law.law.rows() == 1));
        for resolve in [sequential as Resolve, guendelman] {
            let (one, other) = (end(&system, resolve), end(&reversed(&system), resolve));
            for (a, b) in one.iter().flatten().zip(other.iter().flatten()) {
                assert!((*a - *b).length() < 1e-12, "{restitution}: {a} and {b}");
            }
        }
    }
}

/// Momentum is kept, and bodies that bounce fully keep their energy, by the sequence of impacts (no two at
/// once share a body that a third one needs, so each is a bounce of two bodies).
#[test]
fn a_sequence_of_impacts_keeps_momentum_and_energy() {
    let system = huddle(1.0);
    let sums = |of: &[Velocity]| {
        let momentum: DVec3 = of.iter().map(|v| v[0]).sum();
        (momentum, of.iter().map(|v| v[0].length_squared()).sum::<f64>())
    };
    let start: Vec<Velocity> = system.bodies.iter().map(|body| body.start).collect();
    let (before, after) = (sums(&start), sums(&end(&system, sequential)));
    assert!((before.0 - after.0).length() < 1e-12);
    assert!((before.1 / after.1 - 1.0).abs() < 1e-12, "{} and {}", before.1, after.1);
}
