//! The accuracy meter against physics that is known, and the system of a step as a problem.

#![allow(clippy::disallowed_methods, reason = "expected values may use the platform's functions")]

use crate::common::{self, Floor, G, shape};
use backstop::glam::{DVec3, Quat, Vec3};
use backstop::{
    Axes, Axis, BodyDesc, BodyHandle, Frame, FrictionModel, Geometry, JointDesc, Limit, Material, Motion,
    Motor, Settings, ShapeDesc, World,
};
use backstop_lab::Accuracy;
use backstop_lab::LabWorld;
use backstop_lab::problem::Law;
use backstop_lab::system::Stabilisation;
use backstop_lab::system::SystemProblems;
use backstop_scene::builtin;

const DT: f32 = 1.0 / 60.0;

fn world(settings: Settings) -> World {
    let mut world = World::new(settings).unwrap();
    world.measure_accuracy(true);
    world
}

fn boxed(half: f32, density: f32, at: DVec3, friction: f32) -> BodyDesc {
    let material = Material::default().with_friction(friction);
    let mut shape = shape(Geometry::cuboid(half, half, half), material);
    shape.density = density;
    BodyDesc::dynamic().with_position(at).with_shape(shape)
}

fn ball(at: DVec3, velocity: Vec3, restitution: f32) -> BodyDesc {
    let material = Material::default().with_friction(0.0).with_restitution(restitution);
    let mut shape = shape(Geometry::Sphere { radius: 0.5 }, material);
    // 1 kg.
    shape.density = 1.0 / (4.0 / 3.0 * std::f32::consts::PI * 0.125);
    BodyDesc::dynamic().with_position(at).with_velocity(velocity, Vec3::ZERO).with_shape(shape)
}

fn accuracy(world: &World) -> &Accuracy {
    world.accuracy().expect("it is measured")
}

/// The sum of the impulses of all rows of contacts along the normal.
fn load(world: &World) -> f64 {
    let system = world.system().unwrap();
    let normals = system.laws.iter().filter(|law| law.gap.is_some());
    normals.map(|law| system.rows[law.first].impulse).sum()
}

/// By Newton's law a box at rest gets its weight times the step, nothing moves, and no law is broken.
#[test]
fn a_box_at_rest_bears_its_weight_and_breaks_no_law() {
    for substeps in [1, 4] {
        for friction_model in [FrictionModel::Patch, FrictionModel::Point] {
            let mut world =
                world(Settings::default().with_substeps(substeps).with_friction_model(friction_model));
            world.add_body(&Floor::Box.desc(Material::default())).unwrap();
            let body = world.add_body(&boxed(0.5, 2.0, DVec3::Y * 0.5, 0.5)).unwrap();
            common::steps(&mut world, 120, DT);
            let found = accuracy(&world);
            assert_eq!(found.islands.len(), 1);
            assert_eq!(found.islands[0].bodies, [body]);
            let measures = &found.whole;
            // 2 kg.
            let weight = 2.0 * G * f64::from(DT);
            assert!((load(&world) / weight - 1.0).abs() < 1e-3, "{} {weight}", load(&world));
            assert!(measures.residual.worst < 1e-4 && measures.residual.relative < 1e-3, "{measures:?}");
            assert!(
                measures.approach < 1e-4 && measures.unexplained.max(measures.unexplained_turn) < 1e-5,
                "{measures:?}"
            );
            assert!(measures.momentum < 1e-5 * weight.max(1.0), "{measures:?}");
            assert!(measures.gained().abs() < 1e-4, "{measures:?}");
            assert!(measures.points[0] == 4 && measures.penetration < 0.006, "{measures:?}");
            // The engine's impulses solve the problem of the step.
            let problem = world.system().unwrap().problem(Stabilisation::Rest).unwrap();
            let left = problem.residual(&world.system().unwrap().impulses());
            assert!(left.worst < 1e-3, "{left:?}");
        }
    }
}

/// 1 kg at 3 m/s, 2 cm above the floor: it gets there within the step and stops, for which it takes m (v + g
/// dt) by the law of momentum; without an impulse it would be at v + g dt less the speed that the gap allows.
#[test]
fn a_ball_that_hits_a_floor_gets_its_momentum() {
    for substeps in [1, 4, 8] {
        let mut world = world(Settings::default().with_substeps(substeps));
        world.add_body(&Floor::Box.desc(Material::default().with_friction(0.0))).unwrap();
        world.add_body(&ball(DVec3::Y * 0.52, Vec3::Y * -3.0, 0.0)).unwrap();
        world.step(DT).unwrap();
        let (system, dt) = (world.system().unwrap(), f64::from(DT));
        let speed = 3.0 + G * dt;
        assert!((load(&world) - speed).abs() < 2e-3, "{substeps}: {} for {speed}", load(&world));
        let problem = system.problem(Stabilisation::Rest).unwrap();
        assert_eq!(problem.rows(), 1);
        assert!((problem.w().at(0, 0) - 1.0).abs() < 1e-5);
        assert!((problem.q()[0] - (0.02 / dt - speed)).abs() < 1e-3, "{}", problem.q()[0]);
        let measures = &accuracy(&world).whole;
        assert!(measures.residual.worst < 5e-3, "{substeps}: {measures:?}");
        assert!(
            measures.unexplained.max(measures.unexplained_turn) < 1e-5 && measures.momentum < 1e-5,
            "{measures:?}"
        );
    }
}

/// By Newton's law of impact it parts at e times its speed, whenever in the step it hits.
#[test]
fn a_ball_that_bounces_obeys_the_law_of_restitution() {
    let mut world = world(Settings::default());
    world.add_body(&Floor::Box.desc(Material::default().with_friction(0.0).with_restitution(0.5))).unwrap();
    let body = world.add_body(&ball(DVec3::Y * 0.52, Vec3::Y * -3.0, 0.5)).unwrap();
    world.step(DT).unwrap();
    let found = accuracy(&world);
    assert_eq!(found.bounced, 1);
    let up = f64::from(world.linear_velocity(body).unwrap().y);
    assert!((load(&world) - (up + 3.0 + G * f64::from(DT))).abs() < 2e-3, "{} {up}", load(&world));
    assert!(found.whole.residual.worst < 1e-3, "{:?}", found.whole);
    assert!(
        found.whole.unexplained.max(found.whole.unexplained_turn) < 1e-5 && found.whole.bouncing == 0,
        "{:?}",
        found.whole
    );
    let problem = world.system().unwrap().problem(Stabilisation::Rest).unwrap();
    // It falls 2 cm, parts with half of the speed that it has then, and is slowed down for the rest of the
    // step: q is the speed without the impact less that.
    let (gap, dt) = (0.02, f64::from(DT));
    let fast = (9.0 + 2.0 * G * gap).sqrt();
    let end = 0.5 * fast - G * (dt - (fast - 3.0) / G);
    assert!((problem.q()[0] + 3.0 + G * dt + end).abs() < 1e-3, "{}", problem.q()[0]);
}

fn on_ramp(degrees: f32, mu: f32) -> (World, BodyHandle) {
    let turn = common::turned(Vec3::Z, degrees);
    let mut world = world(Settings::default());
    let floor = shape(Geometry::cuboid(20.0, 1.0, 20.0), Material::default().with_friction(mu));
    let up = turn * Vec3::Y;
    world
        .add_body(
            &BodyDesc::fixed().with_position((up * -1.0).as_dvec3()).with_rotation(turn).with_shape(floor),
        )
        .unwrap();
    let body = boxed(0.5, 1.0, (up * 0.5).as_dvec3(), mu).with_rotation(turn);
    let body = world.add_body(&body).unwrap();
    (world, body)
}

/// Friction of all points together [N s].
fn friction(world: &World) -> f64 {
    let system = world.system().unwrap();
    let patches = system.laws.iter().filter(|law| matches!(law.law, Law::Patch { .. }));
    patches.map(|law| system.rows[law.first].impulse.hypot(system.rows[law.first + 1].impulse)).sum()
}

/// Coulomb on a ramp of 30 degrees: with mu = 0.4 a box accelerates by g (sin - mu cos), and friction is mu
/// times the load, against the slip; with mu = 0.7 it stays, and friction is m g sin.
#[test]
fn friction_on_a_ramp_is_coulombs() {
    let (sine, cosine) = 30f64.to_radians().sin_cos();
    let (mut world, body) = on_ramp(30.0, 0.4);
    common::steps(&mut world, 60, DT);
    let before = world.linear_velocity(body).unwrap().length();
    world.step(DT).unwrap();
    let gained = f64::from(world.linear_velocity(body).unwrap().length() - before);
    let weight = G * f64::from(DT);
    assert!((gained / (weight * (sine - 0.4 * cosine)) - 1.0).abs() < 1e-2, "{gained}");
    let measures = &accuracy(&world).whole;
    assert!((friction(&world) / (0.4 * load(&world)) - 1.0).abs() < 1e-3, "the cone is met");
    assert!((load(&world) / (weight * cosine) - 1.0).abs() < 1e-2);
    assert!(measures.cone < 1e-3 && measures.slip_angle < 1e-4, "{measures:?}");
    assert!(measures.residual.worst < 1e-3, "{measures:?}");

    let (mut world, _) = on_ramp(30.0, 0.7);
    common::steps(&mut world, 60, DT);
    assert!((friction(&world) / (weight * sine) - 1.0).abs() < 1e-2, "{}", friction(&world));
    let measures = &accuracy(&world).whole;
    assert!(measures.cone == 0.0 || measures.cone < 1e-3, "{measures:?}");
    assert!(measures.residual.worst < 1e-3, "{measures:?}");
}

/// Ten boxes, the topmost a thousand times heavier: the residual after some sweeps from nothing.
fn spoiled(iterations: u32) -> f64 {
    let mut world =
        world(Settings::default().with_substeps(1).with_iterations(iterations).with_warm_starting(false));
    world.add_body(&Floor::Box.desc(Material::default())).unwrap();
    for i in 0..10 {
        let density = if i == 9 { 1000.0 } else { 1.0 };
        world.add_body(&boxed(0.5, density, DVec3::Y * (0.5 + f64::from(i)), 0.5)).unwrap();
    }
    world.step(DT).unwrap();
    accuracy(&world).whole.residual.worst
}

/// A heavy box on light ones falls almost freely after one sweep, at up to g dt = 0.16 m/s. Gauss-Seidel
/// converges to a solution, of which the springs of contacts give way to a part of the load.
#[test]
fn a_step_that_is_not_solved_shows_and_iterations_mend_it() {
    let found = [1, 4, 32, 256].map(spoiled);
    assert!(found[0] > 0.02, "{found:?}");
    assert!(found[0] > found[1] && found[1] > found[2] && found[2] > found[3], "{found:?}");
    assert!(found[3] < 0.5 * found[0], "{found:?}");
}

/// Two boxes apart are two islands; a joint between them makes them one.
#[test]
fn islands_are_what_rows_connect() {
    let mut world = world(Settings::default());
    world.add_body(&Floor::Box.desc(Material::default())).unwrap();
    let a = world.add_body(&boxed(0.5, 1.0, DVec3::new(-1.0, 0.5, 0.0), 0.5)).unwrap();
    let b = world.add_body(&boxed(0.5, 1.0, DVec3::new(1.0, 0.5, 0.0), 0.5)).unwrap();
    world.step(DT).unwrap();
    let lists = |world: &World| -> Vec<Vec<BodyHandle>> {
        accuracy(world).islands.iter().map(|island| island.bodies.clone()).collect()
    };
    assert_eq!(lists(&world), [vec![a], vec![b]]);
    let frames = world.frames_at([a, b], DVec3::Y * 0.5, Quat::IDENTITY).unwrap();
    world.add_joint(&JointDesc::ball([a, b], frames)).unwrap();
    world.step(DT).unwrap();
    assert_eq!(lists(&world), [vec![a, b]]);
    let whole = &accuracy(&world).whole;
    assert!(whole.residual.worst < 1e-2 && whole.joint_length < 1e-4, "{whole:?}");
}

/// A door on a hinge with a motor: its work is what the door has afterwards, I w²/2 (I about the hinge), and
/// the joint holds.
#[test]
fn a_door_with_a_motor_gains_what_the_motor_gives() {
    let mut world = world(Settings::default().with_gravity(Vec3::ZERO));
    let post = world.add_body(&BodyDesc::fixed()).unwrap();
    let mut door = ShapeDesc::new(Geometry::cuboid(0.5, 1.0, 0.05));
    door.density = 100.0;
    let door = world.add_body(&BodyDesc::dynamic().with_position(DVec3::X * 0.5).with_shape(door)).unwrap();
    // x of the frame is the world's y.
    let turn = common::turned(Vec3::Z, 90.0);
    let frames = world.frames_at([post, door], DVec3::ZERO, turn).unwrap();
    let motor = Motor::velocity(Motion::Angular, Axis::X, 2.0, f32::INFINITY);
    world.add_joint(&JointDesc::hinge([post, door], frames).with_motor(motor)).unwrap();
    world.step(DT).unwrap();
    // 20 kg; about its middle m (a² + b²) / 3, and m d² by Steiner.
    let inertia = 20.0 * ((0.25 + 0.0025) / 3.0 + 0.25);
    let energy = 0.5 * inertia * 4.0;
    let first = accuracy(&world).whole.clone();
    assert!((first.energy_after / energy - 1.0).abs() < 1e-2, "{first:?} {energy}");
    assert!((first.work / energy - 1.0).abs() < 2e-2, "{first:?} {energy}");
    for _ in 0..60 {
        world.step(DT).unwrap();
        let found = &accuracy(&world).whole;
        assert!(found.residual.worst < 5e-3, "{found:?}");
        assert!(found.joint_length < 5e-4 && found.joint_angle < 5e-4, "{found:?}");
        assert!(found.gained() < 0.01 * energy, "{found:?}");
    }
}

/// A slider at its end stop bears the weight of its body: one row with one end, besides five that lock.
#[test]
fn an_end_stop_bears_the_weight() {
    let mut world = world(Settings::default());
    let post = world.add_body(&BodyDesc::fixed()).unwrap();
    let slid = world.add_body(&boxed(0.5, 3.0, DVec3::ZERO, 0.5)).unwrap();
    let turn = common::turned(Vec3::Z, 90.0);
    let frames = [0; 2].map(|_| Frame { position: Vec3::ZERO, rotation: turn });
    let stop = Limit::new(Motion::Linear, Axes::One(Axis::X), 0.0, 1.0);
    world.add_joint(&JointDesc::slider([post, slid], frames).with_limit(stop)).unwrap();
    common::steps(&mut world, 60, DT);
    let system = world.system().unwrap();
    assert_eq!(system.laws.len(), 7);
    assert_eq!(system.laws.iter().filter(|law| law.law == Law::LOCKED).count(), 5);
    let weight = 3.0 * G * f64::from(DT);
    assert!((load(&world) / weight - 1.0).abs() < 1e-2, "{} {weight}", load(&world));
    let found = &accuracy(&world).whole;
    assert!(found.residual.worst < 1e-3 && found.unexplained.max(found.unexplained_turn) < 1e-3, "{found:?}");
}

/// A freely falling body has no rows, and keeps its energy on the parabola of the engine.
#[test]
fn free_fall_keeps_its_energy() {
    let mut world = world(Settings::default());
    world.add_body(&ball(DVec3::Y * 100.0, Vec3::new(3.0, 4.0, 0.0), 0.0)).unwrap();
    for _ in 0..30 {
        world.step(DT).unwrap();
        let found = accuracy(&world);
        assert!(found.islands.is_empty() && found.whole.laws == 0);
        assert!(found.whole.gained().abs() < 1e-3 && found.whole.momentum < 1e-5, "{:?}", found.whole);
    }
}

/// Boxes at 100 m/s that bounce between posts, several times in a step, and stand still for the rest of one:
/// each change of velocity has its cause all the same.
#[test]
fn impacts_explain_what_they_do() {
    let (mut world, _) =
        common::world_of(&backstop_scene::builtin::build("posts").unwrap(), Settings::default());
    world.measure_accuracy(true);
    let mut bounced = 0;
    for _ in 0..10 {
        world.step(DT).unwrap();
        let found = accuracy(&world);
        bounced += found.bounced;
        assert!(found.whole.unexplained.max(found.whole.unexplained_turn) < 1e-3, "{:?}", found.whole);
    }
    assert!(bounced > 10, "{bounced}");
}

/// Coulomb: friction is no more than its coefficient times the load, in the step of a blow too: a pile falls,
/// and fast bodies hit a terrain, with either model, at several rates and efforts. Expected: 0, to the
/// rounding of single precision.
#[test]
fn friction_never_exceeds_its_cone() {
    for (hz, substeps, iterations) in [(30.0, 1, 4), (60.0, 4, 1), (120.0, 2, 1)] {
        for friction_model in [FrictionModel::Patch, FrictionModel::Point] {
            for scene in [builtin::talk(), common::small_pile()] {
                let settings = Settings::default()
                    .with_substeps(substeps)
                    .with_iterations(iterations)
                    .with_friction_model(friction_model);
                let (mut world, _) = common::world_of(&scene, settings);
                world.measure_accuracy(true);
                for step in 0..(2.0 * hz) as u32 {
                    world.step(1.0 / hz).unwrap();
                    let cone = accuracy(&world).whole.cone;
                    assert!(
                        cone < 1e-5,
                        "{hz} Hz, {substeps}x{iterations}, {friction_model:?}, step {step}: {cone}"
                    );
                }
            }
        }
    }
}

/// The hash of all poses and velocities after steps that were measured is that of steps that were not.
#[test]
fn measuring_changes_nothing() {
    let run = |on: bool| {
        let (mut world, _) = common::world_of(&common::small_pile(), Settings::default());
        common::joints_of_every_kind(&mut world, Vec3::new(60.0, 5.0, 0.0));
        world.measure_accuracy(on);
        common::steps(&mut world, 40, DT);
        if on {
            let found = accuracy(&world);
            let all = [&found.whole].into_iter().chain(found.islands.iter().map(|island| &island.measures));
            for one in all {
                let numbers =
                    [one.residual.worst, one.residual.relative, one.gained(), one.momentum, one.unexplained];
                assert!(numbers.iter().all(|x| x.is_finite()), "{one:?}");
            }
        }
        world.state_hash()
    };
    assert_eq!(run(true), run(false));
}

/// Two cubes of 1 kg welded together on a floor: with the weld eliminated, unit impulses at all eight points
/// lift 2 kg at 8 N s, which is 4 m/s at each of them; and the engine's impulses solve that problem too.
#[test]
fn a_weld_is_eliminated_from_the_contact_problem() {
    let mut world = world(Settings::default());
    world.add_body(&Floor::Box.desc(Material::default().with_friction(0.5))).unwrap();
    let at = |x: f64| boxed(0.5, 1.0, DVec3::new(x, 0.5, 0.0), 0.5);
    let bodies = [-0.5, 0.5].map(|x| world.add_body(&at(x)).unwrap());
    let frames = world.frames_at(bodies, DVec3::Y * 0.5, Quat::IDENTITY).unwrap();
    world.add_joint(&JointDesc::fixed(bodies, frames)).unwrap();
    common::steps(&mut world, 30, DT);
    let system = world.system().unwrap();
    let (problem, told) = system.contact_problem().unwrap();
    assert_eq!((told.eliminated, told.held, told.open), (6, 0, 0));
    assert_eq!(problem.rows(), 8 * 3);
    assert!(problem.laws().all(|(_, law)| law == Law::Contact { mu: 0.5 }));
    let ones: Vec<f64> = (0..24).map(|row| if row % 3 == 0 { 1.0 } else { 0.0 }).collect();
    for normal in (0..24).step_by(3) {
        assert!((problem.w().dot(normal, &ones) - 4.0).abs() < 1e-4, "{normal}");
    }
    let normals =
        system.laws.iter().filter(|law| law.gap.is_some()).map(|law| system.rows[law.first].impulse);
    let r: Vec<f64> = normals.flat_map(|r| [r, 0.0, 0.0]).collect();
    assert!(problem.residual(&r).worst < 1e-3, "{:?}", problem.residual(&r));
}
