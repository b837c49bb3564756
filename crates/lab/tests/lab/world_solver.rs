//! Methods of the lab as solvers of worlds: their exact cases, both laws of impacts, and islands that they
//! can't solve.

use backstop::glam::{DVec3, Quat, Vec3};
use backstop::{
    Axis, BodyDesc, BodyHandle, Frame, Geometry, JointDesc, Material, Motion, Motor, Settings, ShapeDesc,
    World,
};
use backstop_lab::LabWorld;
use backstop_lab::{Guess, SolverReport, WorldMethod, WorldSolver};

const DT: f32 = 1.0 / 60.0;

/// Boxes of 1 m on a plane, each `ratio` times as heavy as the one below but no heavier than `most` kg, and
/// the lowest of 1 kg.
fn stack(count: usize, ratio: f64, most: f64) -> (World, Vec<BodyHandle>) {
    let mut world = World::new(Settings::default()).unwrap();
    world.add_body(&BodyDesc::fixed().with_shape(ShapeDesc::new(Geometry::Plane))).unwrap();
    let boxes = (0..count).map(|i| {
        let density = ratio.powi(i as i32).min(most) as f32;
        let cube = ShapeDesc::new(Geometry::cuboid(0.5, 0.5, 0.5)).with_density(density);
        world
            .add_body(&BodyDesc::dynamic().with_position(DVec3::Y * (i as f64 + 0.5)).with_shape(cube))
            .unwrap()
    });
    let boxes = boxes.collect();
    (world, boxes)
}

/// How far boxes are from where they were put [m].
fn off(world: &World, boxes: &[BodyHandle]) -> f64 {
    let place =
        |(i, &b): (usize, &BodyHandle)| (world.position(b).unwrap() - DVec3::Y * (i as f64 + 0.5)).length();
    boxes.iter().enumerate().map(place).fold(0.0, f64::max)
}

/// Steps for some seconds, and returns the sum of the reports.
fn run(world: &mut World, seconds: f32) -> SolverReport {
    let mut sum = SolverReport::default();
    for _ in 0..(seconds / DT).round() as u32 {
        world.step(DT).unwrap();
        let one = world.solver_report().unwrap();
        sum.islands += one.islands;
        sum.solved += one.solved;
        sum.refused += one.refused;
        sum.too_large += one.too_large;
        sum.iterations += one.iterations + one.pivots;
        sum.residual = sum.residual.max(one.residual);
    }
    sum
}

/// Ten boxes, each ten times as heavy as the one below, up to 1e5 kg on 1 kg: rest is the solution, and
/// pivoting finds it. They may be off by the slop, 0.5 mm, and not more.
#[test]
fn ten_boxes_each_ten_times_as_heavy_stand_exactly() {
    for name in ["lemke", "block-pivoting"] {
        let (mut world, boxes) = stack(10, 10.0, 1e5);
        world.solve_with(WorldSolver::by_name(name));
        let report = run(&mut world, 5.0);
        assert_eq!((report.solved, report.refused), (300, 0), "{name}");
        assert!(off(&world, &boxes) < 5e-4, "{name}: {}", off(&world, &boxes));
    }
}

/// The same with the ratio from box to box all the way, up to 1e9.
#[test]
#[ignore = "prints a table of all methods, in two minutes"]
fn how_all_methods_stand() {
    for name in WorldMethod::names() {
        let (mut world, boxes) = stack(10, 10.0, 1e5);
        world.solve_with(WorldSolver::by_name(name));
        let report = run(&mut world, 5.0);
        println!(
            "{name:16} off {:9.2e} m, refused {:3}, iterations {:8}, residual {:9.2e}",
            off(&world, &boxes),
            report.refused,
            report.iterations,
            report.residual
        );
    }
}

/// Balls of 1 m in a row that touch, the first of which arrives at 2 m/s; their velocities after one step.
fn cradle(count: usize, restitution: f32, method: &str) -> Vec<f64> {
    let settings = Settings::default().with_gravity(Vec3::ZERO);
    let mut world = World::new(settings).unwrap();
    let material = Material::default().with_friction(0.0).with_restitution(restitution);
    let ball = ShapeDesc::new(Geometry::Sphere { radius: 0.5 }).with_material(material);
    let balls: Vec<BodyHandle> = (0..count)
        .map(|i| {
            let speed = if i == 0 { Vec3::X * 2.0 } else { Vec3::ZERO };
            let desc =
                BodyDesc::dynamic().with_position(DVec3::X * i as f64).with_velocity(speed, Vec3::ZERO);
            world.add_body(&desc.with_shape(ball.clone())).unwrap()
        })
        .collect();
    world.solve_with(WorldSolver::by_name(method));
    world.step(DT).unwrap();
    assert_eq!(world.solver_report().unwrap().solved, 1);
    balls.iter().map(|&b| f64::from(world.linear_velocity(b).unwrap().x)).collect()
}

/// Both laws of a row of balls: all impacts at once (Newton's law at every contact: the first goes back where
/// restitution is high), and one after the other, which is what nature does. To 1e-6, as velocities are kept
/// in single precision.
#[test]
fn a_cradle_follows_either_law() {
    for restitution in [1.0_f32, 0.8, 0.5, 0.0] {
        let e = f64::from(restitution);
        for n in 2..=5_usize {
            let many = n as f64;
            for method in ["lemke", "dantzig", "block-pivoting", "gs-cone", "admm"] {
                let found = cradle(n, restitution, method);
                for (i, &v) in found.iter().enumerate() {
                    let expected = 2.0 / many * if i == 0 { 1.0 - e * (many - 1.0) } else { 1.0 + e };
                    assert!((v - expected).abs() < 1e-6, "{method}, {n}, {e}: {found:?}");
                }
            }
            let found = cradle(n, restitution, "sequential");
            let last = 2.0 * ((1.0 + e) / 2.0).powi(n as i32 - 1);
            // Without restitution they go on together, and the sequence ends there only.
            let last = if e == 0.0 { 2.0 / many } else { last };
            assert!((found[n - 1] - last).abs() < 1e-6, "{n}, {e}: {found:?}");
            assert!((found.iter().sum::<f64>() - 2.0).abs() < 1e-6, "{found:?}");
            assert!(found.windows(2).all(|pair| pair[0] <= pair[1] + 1e-6), "{found:?}");
        }
    }
}

/// Below 7 - 4 sqrt 3 = 0.0718 three balls collide without end (McNamara and Young 1992): the counter ends
/// it, and they go on as the conservation of momentum says, each no faster than the next.
#[test]
fn an_inelastic_collapse_ends() {
    for restitution in [0.07, 0.05, 0.01] {
        let settings = Settings::default().with_gravity(Vec3::ZERO);
        let mut world = World::new(settings).unwrap();
        let material = Material::default().with_friction(0.0).with_restitution(restitution);
        let ball = ShapeDesc::new(Geometry::Sphere { radius: 0.5 }).with_material(material);
        let balls: Vec<BodyHandle> = (0..3)
            .map(|i| {
                let speed = Vec3::X * [100.0, 0.0, -100.0][i];
                let desc =
                    BodyDesc::dynamic().with_position(DVec3::X * i as f64).with_velocity(speed, Vec3::ZERO);
                world.add_body(&desc.with_shape(ball.clone())).unwrap()
            })
            .collect();
        world.solve_with(WorldSolver::by_name("sequential"));
        world.step(DT).unwrap();
        let report = world.solver_report().unwrap();
        assert!(report.solved == 1 && report.iterations < 2000, "{report:?}");
        let found: Vec<f32> = balls.iter().map(|&b| world.linear_velocity(b).unwrap().x).collect();
        assert!(found.iter().sum::<f32>().abs() < 1e-4, "{found:?}");
        // Balls that still approach are slower than the threshold of restitution.
        assert!(found.windows(2).all(|pair| pair[0] <= pair[1] + 1e-4), "{found:?}");
        assert!(found.iter().all(|v| v.abs() < 10.0), "{found:?}");
    }
}

/// The lecture's loop: two balls on a plane, one on its way to the other. It ends, and no ball is below the
/// plane.
#[test]
fn two_balls_on_a_plane_end() {
    for restitution in [1.0, 0.5, 0.1] {
        for method in ["sequential", "guendelman", "impulse-based", "lemke", "gs-cone"] {
            let mut world = World::new(Settings::default()).unwrap();
            let material = Material::default().with_friction(0.0).with_restitution(restitution);
            let shape = |geometry| ShapeDesc::new(geometry).with_material(material);
            world.add_body(&BodyDesc::fixed().with_shape(shape(Geometry::Plane))).unwrap();
            let ball = shape(Geometry::Sphere { radius: 0.5 });
            let fast = BodyDesc::dynamic()
                .with_position(DVec3::new(-1.5, 0.5, 0.0))
                .with_velocity(Vec3::X * 3.0, Vec3::ZERO);
            let a = world.add_body(&fast.with_shape(ball.clone())).unwrap();
            let b = world
                .add_body(&BodyDesc::dynamic().with_position(DVec3::Y * 0.5).with_shape(ball.clone()))
                .unwrap();
            world.solve_with(WorldSolver::by_name(method));
            for _ in 0..120 {
                world.step(DT).unwrap();
                for ball in [a, b] {
                    let high = world.position(ball).unwrap().y;
                    assert!((0.495..0.6).contains(&high), "{method}, {restitution}: {high}");
                }
            }
            let [a, b] = [a, b].map(|ball| world.linear_velocity(ball).unwrap().x);
            // Newton's law for the two of them, and momentum.
            assert!(
                (a + b - 3.0).abs() < 1e-4 && (b - a - 3.0 * restitution).abs() < 0.02,
                "{method}: {a}, {b}"
            );
        }
    }
}

/// A box that falls flat onto four points does not turn, whatever the order in which they are solved: by
/// symmetry.
#[test]
fn a_box_that_falls_flat_does_not_turn() {
    for method in [
        "sequential",
        "guendelman",
        "lemke",
        "gs-cone",
        "pgs",
        "nncg",
        "apgd",
        "admm",
        "penalty",
        "penalty-implicit",
    ] {
        for quarter in 0..4 {
            let mut world = World::new(Settings::default()).unwrap();
            let material = Material::default().with_restitution(0.5);
            let shape = |geometry| ShapeDesc::new(geometry).with_material(material);
            world.add_body(&BodyDesc::fixed().with_shape(shape(Geometry::Plane))).unwrap();
            // Turned by a quarter its points come in another order.
            let turn = Quat::from_rotation_y(quarter as f32 * std::f32::consts::FRAC_PI_2);
            let desc = BodyDesc::dynamic()
                .with_position(DVec3::Y * 0.8)
                .with_rotation(turn)
                .with_velocity(Vec3::NEG_Y, Vec3::ZERO);
            let cube = world.add_body(&desc.with_shape(shape(Geometry::cuboid(0.5, 0.5, 0.5)))).unwrap();
            world.solve_with(WorldSolver::by_name(method));
            for _ in 0..60 {
                world.step(DT).unwrap();
                let spin = world.angular_velocity(cube).unwrap().length();
                assert!(spin < 1e-4, "{method}: {spin} rad/s");
            }
        }
    }
}

/// Impulses of the step before are the solution of the next one where nothing moves.
#[test]
fn warm_starting_saves_iterations() {
    let iterations = |guess| {
        let (mut world, _) = stack(5, 1.0, 1.0);
        let solver = WorldSolver { guess, ..WorldSolver::by_name("gs-cone").unwrap() };
        world.solve_with(Some(solver));
        run(&mut world, 1.0).iterations
    };
    let [zero, last] = [Guess::Zero, Guess::LastStep].map(iterations);
    assert!(last * 3 < zero, "{last} with, {zero} without");
}

/// So are those of joints: a bar on a hinge that friction holds level, with five locked rows and one of
/// friction.
#[test]
fn warm_starting_knows_all_rows_of_a_joint() {
    let iterations = |guess| {
        let mut world = World::new(Settings::default()).unwrap();
        let wall = world.add_body(&BodyDesc::fixed()).unwrap();
        let bar = ShapeDesc::new(Geometry::cuboid(0.1, 0.1, 0.5));
        let bar = world.add_body(&BodyDesc::dynamic().with_position(DVec3::Z * 0.5).with_shape(bar)).unwrap();
        let frames = [Frame::at(Vec3::ZERO), Frame::at(Vec3::NEG_Z * 0.5)];
        // Its axis is x; far more than the 200 N m that hold it.
        let friction = Motor::friction(Motion::Angular, Axis::X, 1e6);
        world.add_joint(&JointDesc::hinge([wall, bar], frames).with_motor(friction)).unwrap();
        world.solve_with(Some(WorldSolver { guess, ..WorldSolver::by_name("gs-cone").unwrap() }));
        let report = run(&mut world, 1.0);
        assert_eq!(report.solved, 60, "{report:?}");
        assert!((world.position(bar).unwrap() - DVec3::Z * 0.5).length() < 1e-3);
        report.iterations
    };
    let [zero, last] = [Guess::Zero, Guess::LastStep].map(iterations);
    assert!(last * 3 < zero, "{last} with, {zero} without");
}

/// An island with too many rows, or not asked for, moves as by the fast path alone: to the bit.
#[test]
fn what_is_not_solved_is_the_fast_paths() {
    let mut finals = Vec::new();
    let away = |world: &mut World| {
        let cube = ShapeDesc::new(Geometry::cuboid(0.5, 0.5, 0.5));
        world
            .add_body(&BodyDesc::dynamic().with_position(DVec3::new(5.0, 0.5, 0.0)).with_shape(cube))
            .unwrap()
    };
    for case in 0..3 {
        let (mut world, boxes) = stack(5, 3.0, 100.0);
        let other = away(&mut world);
        let solver = WorldSolver::by_name("lemke").unwrap();
        match case {
            0 => {}
            1 => world.solve_with(Some(WorldSolver { most_rows: 10, ..solver })),
            _ => world.solve_with(Some(WorldSolver { only: vec![other], ..solver })),
        }
        for _ in 0..60 {
            world.step(DT).unwrap();
        }
        if let Some(report) = world.solver_report() {
            assert_eq!((report.islands, report.solved), (2, 1), "{report:?}");
            assert_eq!(report.too_large, usize::from(case == 1));
        }
        finals.push(boxes.iter().map(|&b| world.position(b).unwrap()).collect::<Vec<_>>());
    }
    assert_eq!(finals[0], finals[1]);
    assert_eq!(finals[0], finals[2]);
}

/// The switch turns off as it turns on.
#[test]
fn a_world_without_a_method_is_as_before() {
    let (mut world, _) = stack(2, 1.0, 1.0);
    world.solve_with(WorldSolver::by_name("pgs"));
    world.step(DT).unwrap();
    assert!(world.solver_report().is_some() && world.accuracy().is_none());
    world.measure_accuracy(true);
    world.step(DT).unwrap();
    assert!(world.solver_report().is_some() && world.accuracy().is_some());
    world.solve_with(None);
    world.step(DT).unwrap();
    assert!(world.solver_report().is_none() && world.accuracy().is_some());
    world.measure_accuracy(false);
    world.step(DT).unwrap();
    assert!(world.accuracy().is_none());
    assert!(WorldSolver::by_name("nothing").is_none());
}

/// A ball that bounces for 20 s without loss keeps its energy within 1e-2, which engines without times of
/// impact reach at this step (SimBenchmark's bouncing test), as each bounce is at its time in the step.
#[test]
fn a_ball_keeps_bouncing() {
    for method in ["gs-cone", "lemke"] {
        let mut world = World::new(Settings::default()).unwrap();
        let material = Material::default().with_friction(0.0).with_restitution(1.0);
        let shape = |geometry| ShapeDesc::new(geometry).with_material(material);
        world.add_body(&BodyDesc::fixed().with_shape(shape(Geometry::Plane))).unwrap();
        let ball = BodyDesc::dynamic()
            .with_position(DVec3::Y * 2.5)
            .with_shape(shape(Geometry::Sphere { radius: 0.5 }));
        let ball = world.add_body(&ball).unwrap();
        world.solve_with(WorldSolver::by_name(method));
        let energy = |world: &World| {
            let speed = f64::from(world.linear_velocity(ball).unwrap().y);
            9.81 * (world.position(ball).unwrap().y - 0.5) + 0.5 * speed * speed
        };
        let before = energy(&world);
        let mut worst = 0.0_f64;
        for _ in 0..1200 {
            world.step(DT).unwrap();
            worst = worst.max((energy(&world) / before - 1.0).abs());
        }
        println!("{method}: off by {worst:.1e}");
        assert!(worst < 1e-2, "{method}: {worst}");
    }
}
