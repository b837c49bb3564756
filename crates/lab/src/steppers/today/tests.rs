//! Methods of today on small systems made at random, whose answers are known.

use super::*;
use crate::LabWorld;
use crate::methods::{Effort, Status, dantzig};
use crate::problem::{Law, project_cone, project_disc};
use crate::random::Random;
use crate::steppers::step::{Resolution, Resolve, Step};
use crate::steppers::today::convex::{Convex, Soft};
use crate::steppers::today::points::Points;
use crate::system::{Stabilisation, System, SystemProblems, with_impacts};
use crate::{WorldMethod, WorldSolver};
use backstop::{
    Axis, BodyDesc, BodyHandle, Frame, Geometry, JointDesc, Material, Motion, Motor, Settings, ShapeDesc,
    Spring, World,
};
use glam::{Quat, Vec3};
use nalgebra::DVector;

/// How many systems: more by an environment variable.
fn cases() -> u64 {
    std::env::var("COUNT").ok().and_then(|text| text.parse().ok()).unwrap_or(30)
}

/// Balls and boxes of different masses that touch a floor and each other, with random velocities, some of
/// them on joints: the rows of a step.
fn heap(seed: u64, friction: f32) -> System {
    let mut random = Random(seed);
    let mut world = World::new(Settings::default()).unwrap();
    let material = Material::default().with_friction(friction);
    let shape = |geometry, density| ShapeDesc::new(geometry).with_material(material).with_density(density);
    world.add_body(&BodyDesc::fixed().with_shape(shape(Geometry::Plane, 1.0))).unwrap();
    let (mut last, mut high) = (None, 0.499);
    for _ in 0..2 + random.below(4) {
        let ball = random.chance(0.5);
        let form = if ball {
            Geometry::Sphere { radius: 0.5 }
        } else {
            Geometry::cuboid(0.5, 0.5, random.range(0.3, 0.6))
        };
        let turn = if ball { 0.0 } else { random.range(-0.002, 0.002) };
        let place = Vec3::new(random.range(-0.2, 0.2), high, random.range(-0.2, 0.2));
        let mut any = |size: f32| Vec3::new(random.signed(), random.signed(), random.signed()) * size;
        let desc = BodyDesc::dynamic()
            .with_position(place.as_dvec3())
            .with_rotation(Quat::from_rotation_x(turn))
            .with_velocity(any(1.0), any(0.5));
        let body = world.add_body(&desc.with_shape(shape(form, random.range(100.0, 3000.0)))).unwrap();
        if let Some((other, at)) = last.take() {
            let middle = 0.5 * (place + at);
            let frames = [Frame::at(middle - at), Frame::at(Quat::from_rotation_x(-turn) * (middle - place))];
            world.add_joint(&JointDesc::ball([other, body], frames)).unwrap();
        }
        // A body on a joint does not touch the one below.
        let joined = random.chance(0.3);
        last = joined.then_some((body, place));
        high += if joined { 1.3 } else { 0.998 };
    }
    world.measure_accuracy(true);
    world.step(1.0 / 60.0).unwrap();
    with_impacts(world.system().unwrap()).0
}

/// A method on each island of a system.
fn resolve(system: &System, method: Resolve, effort: &Effort, mut check: impl FnMut(&Step<'_>, Resolution)) {
    for island in &system.islands {
        let problem = system.problem_of(&island.laws, Stabilisation::Rest).unwrap();
        let step = Step { system, island, problem: &problem, stabilisation: Stabilisation::Rest };
        check(&step, method(&step, effort));
    }
}

/// Velocities of bodies are unique where nothing rubs: those by pivoting. With friction the laws hold. A face
/// on four points whose gaps differ by rounding approaches its solution ever so slowly, hence the tolerance.
#[test]
fn split_masses_solve_the_problem() {
    for seed in 0..cases() {
        let effort = Effort { tolerance: 1e-8, iterations: 100_000, ..Effort::default() };
        resolve(&heap(seed, 0.0), mass_splitting, &effort, |step, found| {
            let exact = dantzig(step.problem, &Effort::default());
            assert_eq!((found.solution.status, exact.status), (Status::Solved, Status::Solved), "{seed}");
            let exact = step.system.velocities_with(step.island, &exact.r);
            for (a, b) in found.end.iter().flatten().zip(exact.iter().flatten()) {
                assert!((*a - *b).length() < 1e-5, "{seed}: {a} and {b}");
            }
        });
        resolve(&heap(seed, 0.5), mass_splitting, &effort, |_, found| {
            assert_eq!(found.solution.status, Status::Solved, "{seed}");
            assert!(found.solution.residual < 1e-6, "{seed}: {}", found.solution.residual);
        });
    }
}

/// The projection of an impulse onto a cone in the norm of R, found by trying slopes of the cone's side.
fn nearest(y: [f64; 3], mu: f64, soft: &[Soft]) -> [f64; 3] {
    let far = |x: [f64; 3]| (0..3).map(|k| soft[k].r * (x[k] - y[k]).powi(2)).sum::<f64>();
    let at = |n: f64| {
        let t = project_disc([y[1], y[2]], mu * n);
        [n, t[0], t[1]]
    };
    // The distance is convex in the normal part.
    let (mut low, mut high) = (0.0, y[0].max(0.0) + y[1].hypot(y[2]) * (1.0 + mu) * soft[1].r / soft[0].r);
    for _ in 0..200 {
        let (a, b) = (low + (high - low) / 3.0, high - (high - low) / 3.0);
        if far(at(a)) < far(at(b)) { high = b } else { low = a }
    }
    at(0.5 * (low + high))
}

/// The dual of the convex problem by projected gradients: slow and simple.
fn slowly(convex: &Convex, system: &System, soft: &[Soft]) -> DVector<f64> {
    let (w, q) = convex.dual();
    let step = 1.0 / (0..w.nrows()).map(|i| w.row(i).abs().sum()).fold(0.0, f64::max);
    let mut r = DVector::zeros(q.len());
    let (mut ahead, mut theta) = (DVector::<f64>::zeros(q.len()), 1.0_f64);
    for _ in 0..20_000 {
        let mut next = &ahead - step * (&w * &ahead + &q);
        for law in system.laws.iter() {
            let first = law.first;
            match law.law {
                _ if !soft[first].acts => (0..law.law.rows()).for_each(|k| next[first + k] = 0.0),
                Law::Bounds { min, max } => next[first] = next[first].max(min).min(max),
                Law::Contact { mu } => {
                    let own = project_cone([next[first], next[first + 1], next[first + 2]], mu);
                    (0..3).for_each(|k| next[first + k] = own[k]);
                }
                Law::Patch { .. } => unreachable!("points have none"),
            }
        }
        let uphill = (&ahead - &next).dot(&(&next - &r)) > 0.0;
        let after = if uphill { 1.0 } else { 0.5 * (1.0 + (1.0 + 4.0 * theta * theta).sqrt()) };
        ahead = &next + (&next - &r) * if uphill { 0.0 } else { (theta - 1.0) / after };
        (r, theta) = (next, after);
    }
    r
}

/// Both convex formulations: the gradient vanishes, so that momentum is balanced, and another method on the
/// dual problem finds the same.
#[test]
fn convex_problems_are_at_their_minimum() {
    for seed in 0..cases() {
        let friction = [0.0, 0.5, 1.5][seed as usize % 3];
        for (k, method) in [sap as Resolve, mujoco].into_iter().enumerate() {
            let effort = Effort { tolerance: 1e-12, ..Effort::default() };
            resolve(&heap(seed, friction), method, &effort, |step, found| {
                assert_eq!(found.solution.status, Status::Solved, "{seed}");
                let explained = step.system.velocities_with(step.island, &found.solution.r);
                for (a, b) in found.end.iter().flatten().zip(explained.iter().flatten()) {
                    // The middle of a patch and its directions are in single precision.
                    assert!((*a - *b).length() < 1e-5, "{seed}: {a} and {b}");
                }
                let points = Points::new(step);
                let soft = [super::sap::soft, super::mujoco::soft][k](&points.system);
                let convex = Convex::new(&points.system, &step.island.bodies, soft.clone());
                let r = slowly(&convex, &points.system, &soft);
                let changes = points.system.velocity_changes(r.as_slice());
                for (&i, end) in step.island.bodies.iter().zip(&found.end) {
                    for k in 0..2 {
                        let other = points.system.bodies[i].free[k] + changes[i][k];
                        assert!((other - end[k]).length() < 1e-6, "{seed}: {other} and {}", end[k]);
                    }
                }
            });
        }
    }
}

/// The projection in the norm of R, which has a closed form, against a search.
#[test]
fn the_projection_is_the_nearest_point() {
    let mut random = Random(5);
    for _ in 0..1000 {
        let mu = random.range64(0.0, 2.0);
        let [normal, tangent] = [0; 2].map(|_| random.range64(0.1, 3.0));
        let soft = [normal, tangent, tangent].map(|r| Soft { r, target: 0.0, acts: true });
        let y = [0; 3].map(|_| random.range64(-2.0, 2.0));
        let own = super::convex::project(y, mu, tangent / normal).0;
        let other = nearest(y, mu, &soft);
        assert!((0..3).all(|k| (own[k] - other[k]).abs() < 1e-6), "{y:?} {mu}: {own:?} and {other:?}");
    }
}

/// A chain of points on locks only, which is linear: four substeps are four steps of a quarter.
#[test]
fn substeps_are_small_steps_where_all_is_linear() {
    for seed in 0..cases() {
        let mut system = heap(seed, 0.0);
        let joints: Vec<_> = system.laws.split_off(system.contacts);
        let rows = system.rows.clone();
        system.laws.clear();
        system.rows.clear();
        system.contacts = 0;
        // Nothing turns, as directions would turn with it.
        for body in &mut system.bodies {
            (body.start[1], body.free[1]) = Default::default();
            body.inverse_inertia = glam::DMat3::ZERO;
        }
        let mut random = Random(seed);
        for law in joints {
            let row = crate::system::SystemRow { angular: [glam::DVec3::ZERO; 4], ..rows[law.first] };
            system.push(crate::system::SystemLaw { off: random.range64(-0.01, 0.01), ..law }, &[row]);
        }
        let mut whole = super::tgs::Flow::new(&system, 4);
        (0..4).for_each(|_| whole.substep());
        let pull = |i: usize, k: usize| system.bodies[i].free[k] - system.bodies[i].start[k];
        let mut small = System { dt: system.dt / 4.0, ..system.clone() };
        for _ in 0..4 {
            for (i, body) in small.bodies.iter_mut().enumerate() {
                body.free = [0, 1].map(|k| body.start[k] + pull(i, k) / 4.0);
            }
            let before = small.clone();
            let mut flow = super::tgs::Flow::new(&before, 1);
            flow.substep();
            for law in &mut small.laws {
                law.off += flow.along(law.first);
            }
            small.bodies.iter_mut().zip(&flow.velocity).for_each(|(body, velocity)| body.start = *velocity);
        }
        for (body, velocity) in small.bodies.iter().zip(&whole.velocity) {
            assert!((body.start[0] - velocity[0]).length() < 1e-10, "{seed}: {body:?} and {velocity:?}");
        }
    }
}

const NAMES: [&str; 6] = ["mass-splitting", "tgs", "mujoco", "sap", "xpbd", "avbd"];

/// An empty world that a method solves, whatever its residual.
fn solved_by(name: &str) -> World {
    let mut world = World::new(Settings::default()).unwrap();
    let mut solver = WorldSolver::new(WorldMethod::by_name(name).unwrap());
    solver.effort.iterations = 500;
    world.solve_with(Some(solver));
    world
}

/// Steps for some seconds; nothing is left to the fast path.
fn run(world: &mut World, seconds: f32) {
    for _ in 0..(60.0 * seconds) as u32 {
        world.step(1.0 / 60.0).unwrap();
        let report = world.solver_report().unwrap();
        assert_eq!((report.refused, report.too_large), (0, 0));
    }
}

/// A mass on a spring with stiffness k hangs `m g / k` below its rest, and a stiff one as much.
#[test]
fn a_mass_on_a_spring_hangs_as_low_as_its_weight_says() {
    let mut random = Random(3);
    for name in NAMES {
        for _ in 0..3 {
            let mut world = solved_by(name);
            let mass = f64::from(random.range(1.0, 50.0));
            // One metre to a tenth of a millimetre.
            let stiffness = mass * 9.81 * 10.0_f64.powf(random.range64(0.0, 4.0));
            let damping = 2.0 * (mass * stiffness).sqrt();
            let wall = world.add_body(&BodyDesc::fixed()).unwrap();
            let cube = Geometry::cuboid(0.5, 0.5, 0.5);
            let desc = BodyDesc::dynamic().with_shape(ShapeDesc::new(cube).with_density(mass as f32));
            let body = world.add_body(&desc).unwrap();
            let spring = Spring::Coefficients { stiffness: stiffness as f32, damping: damping as f32 };
            let up = Frame {
                rotation: Quat::from_rotation_z(std::f32::consts::FRAC_PI_2),
                ..Frame::at(Vec3::ZERO)
            };
            let slider = JointDesc::slider([wall, body], [up, up]);
            let motor = Motor::position(Motion::Linear, Axis::X, 0.0, spring);
            world.add_joint(&slider.with_motor(motor)).unwrap();
            run(&mut world, 4.0);
            let (low, expected) = (-world.position(body).unwrap().y, mass * 9.81 / stiffness);
            assert!((low / expected - 1.0).abs() < 1e-2, "{name}: {low} for {expected}");
        }
    }
}

/// Boxes of random masses stand: by how much they sink is what a method's softness says.
#[test]
fn a_stack_stands() {
    let allowed = [1e-3, 2e-2, 2e-2, 5e-3, 2e-2, 5e-3];
    for (name, allowed) in NAMES.into_iter().zip(allowed) {
        let mut random = Random(8);
        let mut world = solved_by(name);
        world.add_body(&BodyDesc::fixed().with_shape(ShapeDesc::new(Geometry::Plane))).unwrap();
        let mut place = |i: usize| {
            let cube =
                ShapeDesc::new(Geometry::cuboid(0.5, 0.5, 0.5)).with_density(random.range(300.0, 1000.0));
            let at = BodyDesc::dynamic().with_position(Vec3::Y * (i as f32 + 0.5)).with_shape(cube);
            world.add_body(&at).unwrap()
        };
        let boxes: Vec<BodyHandle> = (0..4).map(&mut place).collect();
        run(&mut world, 3.0);
        for (i, &body) in boxes.iter().enumerate() {
            let off = (world.position(body).unwrap() - glam::DVec3::Y * (i as f64 + 0.5)).length();
            println!("{name} {i}: {off:.1e}");
            assert!(off < allowed, "{name} {i}: {off}");
        }
    }
}

/// A pendulum on a ball joint, let go level: its length stays, and so does its energy where rows follow the
/// swing. The others lose it, as directions are those of the start of a step.
#[test]
fn a_pendulum_keeps_its_length() {
    for (name, length, energy) in
        [("tgs", 5e-3, 0.05), ("xpbd", 2e-3, 0.1), ("avbd", 1e-2, 1.0), ("sap", 1e-2, 1.0)]
    {
        let mut world = solved_by(name);
        let wall = world.add_body(&BodyDesc::fixed()).unwrap();
        let ball = ShapeDesc::new(Geometry::Sphere { radius: 0.1 });
        let desc = BodyDesc::dynamic().with_position(Vec3::X).with_shape(ball);
        let body = world.add_body(&desc).unwrap();
        let frames = [Frame::at(Vec3::ZERO), Frame::at(Vec3::NEG_X)];
        world.add_joint(&JointDesc::ball([wall, body], frames)).unwrap();
        let (mut worst, mut lost) = (0.0_f64, 0.0_f64);
        for _ in 0..5 * 60 {
            run(&mut world, 1.0 / 59.0);
            let (at, speed) =
                (world.position(body).unwrap(), world.linear_velocity(body).unwrap().as_dvec3());
            worst = worst.max((at.length() - 1.0).abs());
            // Its own rotation has 0.4 % of the energy.
            lost = lost.max((9.81 * at.y + 0.5 * 1.004 * speed.length_squared()).abs() / 9.81);
        }
        println!("{name}: {worst:.1e} m, {lost:.1e}");
        assert!(worst < length && lost < energy, "{name}: {worst} m, {lost}");
    }
}
