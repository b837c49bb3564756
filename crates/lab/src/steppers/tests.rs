//! The laws of impact hold, and the order of contacts does not matter.

use super::*;
use crate::LabWorld;
use crate::WorldSolver;
use crate::methods::{Effort, Order};
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

/// A cube of 1 m that falls flat by half a metre, by `impulse-based`: its fastest rotation within a second,
/// and the most collisions in a step.
fn falls_flat(order: Order, restitution: f32, boxes: u32) -> (f32, u64) {
    let mut world = World::new(Settings::default()).unwrap();
    let material = Material::default().with_friction(0.5).with_restitution(restitution);
    let shape = |geometry| ShapeDesc::new(geometry).with_material(material);
    world.add_body(&BodyDesc::fixed().with_shape(shape(Geometry::Plane))).unwrap();
    let cube = |k: u32| {
        let at = DVec3::Y * (1.0 + f64::from(k));
        BodyDesc::dynamic().with_position(at).with_shape(shape(Geometry::cuboid(0.5, 0.5, 0.5)))
    };
    let cubes: Vec<_> = (0..boxes).map(|k| world.add_body(&cube(k)).unwrap()).collect();
    let mut solver = WorldSolver::by_name("impulse-based").unwrap();
    solver.effort.order = order;
    world.solve_with(Some(solver));
    let (mut spin, mut events) = (0.0_f32, 0);
    for _ in 0..60 {
        world.step(1.0 / 60.0).unwrap();
        let spins = cubes.iter().map(|&cube| world.angular_velocity(cube).unwrap().length());
        spin = spins.fold(spin, f32::max);
        events = events.max(world.solver_report().unwrap().iterations);
    }
    (spin, events)
}

/// Corners of a cube that falls flat collide one after the other, so it turns by some of its speed (3.1 m/s
/// at 0.7 m) although it falls straight. Together they stop or bounce it without a turn, and with fewer
/// collisions.
#[test]
fn a_box_that_falls_flat_turns_unless_its_corners_collide_together() {
    for restitution in [0.0, 0.05, 0.3, 1.0] {
        let (one, together) =
            (falls_flat(Order::Fastest, restitution, 1), falls_flat(Order::Together, restitution, 1));
        println!(
            "e = {restitution}: {:.2} rad/s and {} collisions a step, together {:.2e} rad/s and {}",
            one.0, one.1, together.0, together.1
        );
        assert!(one.0 > 0.3, "{one:?}");
        assert!(together.0 < 1e-3 && together.1 < one.1, "{together:?}");
    }
}

/// Each point hops up to four times a step, and each hop may be answered by all others: a stack of two takes
/// some hundred collisions a step, and never the 10,000 that are allowed.
#[test]
fn collisions_of_a_stack_come_to_an_end() {
    for restitution in [0.0, 0.05, 1.0] {
        for order in [Order::Fastest, Order::Together] {
            let (_, events) = falls_flat(order, restitution, 2);
            println!("e = {restitution}, {order:?}: {events}");
            assert!(events < 400, "e = {restitution}, {order:?}: {events}");
        }
    }
}
