//! Rolling and spinning friction and couplings as rows of the lab: the meter's residuals are those of worlds
//! with them, impulses are those of mechanics, and methods that solve a step as one find the same.

#![allow(clippy::disallowed_methods, reason = "expected values may use the platform's functions")]

use crate::common::{self, Floor, G, shape};
use backstop::glam::{DVec3, Mat3, Vec3};
use backstop::{
    BodyDesc, BodyHandle, CouplingDesc, CouplingHandle, Frame, Geometry, JointDesc, JointHandle,
    MassProperties, Material, Settings, World,
};
use backstop_lab::LabWorld;
use backstop_lab::WorldSolver;
use backstop_lab::problem::Law;
use backstop_lab::system::SystemProblems;
use backstop_lab::system::{Owner, Stabilisation, System, SystemLaw};

const DT: f32 = 1.0 / 60.0;

fn world(settings: Settings) -> World {
    let mut world = World::new(settings).unwrap();
    world.measure_accuracy(true);
    world
}

fn rolling_material(roll: f32, spin: f32) -> Material {
    Material::default().with_friction(1.0).with_rolling_friction(roll).with_spinning_friction(spin)
}

/// A ball of 0.5 m and 2 kg on a floor that lies level while gravity leans by an angle.
fn slope(world: &mut World, material: Material) -> BodyHandle {
    world.add_body(&Floor::Plane.desc(Material::default().with_friction(1.0))).unwrap();
    let mut ball = shape(Geometry::Sphere { radius: 0.5 }, material);
    ball.density = 2.0 / (4.0 / 3.0 * std::f32::consts::PI * 0.125);
    world.add_body(&BodyDesc::dynamic().with_position(DVec3::Y * 0.5).with_shape(ball)).unwrap()
}

fn leaning(angle: f64) -> Settings {
    let (sine, cosine) = angle.sin_cos();
    Settings::default().with_gravity(DVec3::new(sine * G, -cosine * G, 0.0).as_vec3())
}

/// The patch of rolling friction: the last law of a contact.
fn rolling(system: &System) -> &SystemLaw {
    let patch = |law: &&SystemLaw| matches!(law.law, Law::Patch { .. });
    system.laws[..system.contacts].iter().rfind(patch).expect("a patch")
}

/// A ball on a slope of half of atan(b / r). Expected, by statics: it stays; the row against rolling bears
/// the torque m g sin(a) r for the step, so as a velocity of its surface m g sin(a) dt; that is half of its
/// bound; no law is broken, and the impulses solve the problem of the step. On twice the angle the row is at
/// its bound b N / r, which is the law too.
#[test]
fn a_ball_on_a_slope_breaks_no_law() {
    let arm = 0.02;
    for substeps in [1, 4] {
        for share in [0.5_f64, 2.0] {
            let angle = share * (f64::from(arm) / 0.5).atan();
            let mut world = world(leaning(angle).with_substeps(substeps));
            let ball = slope(&mut world, rolling_material(arm, 0.0));
            common::steps(&mut world, 120, DT);
            let system = world.system().unwrap();
            let (weight, law) = (2.0 * G * f64::from(DT), rolling(system));
            let rows: Vec<f64> = (0..3).map(|i| system.rows[law.first + i].impulse).collect();
            let borne = rows[0].hypot(rows[1]);
            let most = weight * angle.cos() * f64::from(arm) / 0.5;
            let expected = (weight * angle.sin()).min(most);
            println!("{substeps} substeps, {share} of the angle: {borne} for {expected}");
            assert!((borne / expected - 1.0).abs() < 0.02, "{borne} for {expected}");
            let speed = world.linear_velocity(ball).unwrap().length();
            assert!((speed < 1e-4) == (share < 1.0), "{speed} m/s");
            let measures = &world.accuracy().unwrap().whole;
            assert!(measures.residual.worst < 1e-3, "{measures:?}");
            assert!(measures.unexplained.max(measures.unexplained_turn) < 1e-4, "{measures:?}");
            let problem = system.problem(Stabilisation::Rest).unwrap();
            let left = problem.residual(&system.impulses());
            assert!(left.worst < 2e-3, "{left:?}");
            // Without the load of the row the laws are broken by the speed that the step would give.
            let mut without = system.impulses();
            without[law.first..law.first + 2].fill(0.0);
            assert!(
                problem.residual(&without).worst > 0.3 * expected / 2.0,
                "{:?}",
                problem.residual(&without)
            );
        }
    }
}

/// A ball that spins about the normal on one point. Expected, by Coulomb's law: the row of spinning friction
/// has s N for the step, whether its material also resists rolling or not, and no law is broken.
#[test]
fn spinning_friction_is_at_its_bound() {
    for roll in [0.0, 0.02] {
        let mut world = world(Settings::default());
        let ball = slope(&mut world, rolling_material(roll, 0.005));
        common::steps(&mut world, 30, DT);
        world.set_angular_velocity(ball, Vec3::Y * 30.0).unwrap();
        common::steps(&mut world, 10, DT);
        let system = world.system().unwrap();
        // As a velocity of the surface, half a metre from the centre, where it also resists rolling.
        let reach = if roll > 0.0 { 0.5 } else { 1.0 };
        let most = 2.0 * G * f64::from(DT) * 0.005 / reach;
        let borne = system.rows[rolling(system).first + 2].impulse;
        assert!((borne.abs() / most - 1.0).abs() < 0.01, "{borne} for {most}");
        let measures = &world.accuracy().unwrap().whole;
        assert!(
            measures.residual.worst < 1e-3 && measures.unexplained.max(measures.unexplained_turn) < 1e-4,
            "{measures:?}"
        );
    }
}

/// Two wheels on the ground on hinges, of 0.3 and 0.05 kg m², geared by teeth.
fn gears(settings: Settings, teeth: [f64; 2]) -> (World, [BodyHandle; 2], CouplingHandle) {
    let mut world = world(settings.with_gravity(Vec3::ZERO));
    let ground = world.add_body(&BodyDesc::fixed()).unwrap();
    let mut wheels = Vec::new();
    let hinges: Vec<JointHandle> = [0.3, 0.05]
        .into_iter()
        .zip([Vec3::ZERO, Vec3::Y])
        .map(|(inertia, at)| {
            let inertia = Mat3::from_diagonal(Vec3::splat(inertia));
            let mass = MassProperties { mass: 1.0, centre_of_mass: Vec3::ZERO, inertia };
            wheels
                .push(world.add_body(&BodyDesc::dynamic().with_mass(Some(mass)).with_position(at)).unwrap());
            let frames = [Frame::at(at), Frame::default()];
            world.add_joint(&JointDesc::hinge([ground, wheels[wheels.len() - 1]], frames)).unwrap()
        })
        .collect();
    let gear = world.add_coupling(&CouplingDesc::gear([hinges[0], hinges[1]], teeth)).unwrap();
    (world, [wheels[0], wheels[1]], gear)
}

/// A torque T on the first of two wheels. Expected, by Newton's law: with the ratio k the teeth give the
/// second wheel J k T / (I + k² J) and the first k times that; the row has it for the step, and no law is
/// broken. A gearing to 1 : 100 too.
#[test]
fn the_row_of_a_gear_bears_what_newton_says() {
    for substeps in [1, 4] {
        for teeth in [[30.0, 10.0], [20.0, 31.0], [100.0, 1.0]] {
            let (mut world, [a, _], gear) = gears(Settings::default().with_substeps(substeps), teeth);
            for _ in 0..60 {
                world.add_torque(a, Vec3::X * 1.5).unwrap();
                world.step(DT).unwrap();
            }
            let k = teeth[0] / teeth[1];
            let on_second = 0.05 * k * 1.5 / (0.3 + k * k * 0.05);
            let system = world.system().unwrap();
            let law = system.laws.iter().find(|law| law.owner == Owner::Coupling(gear)).unwrap();
            assert_eq!(law.law, Law::LOCKED);
            // Factors are over the greater number of teeth.
            let expected = on_second * f64::from(DT) * teeth[0].max(teeth[1]) / teeth[1];
            let borne = system.rows[law.first].impulse.abs();
            println!("{substeps} substeps, {teeth:?}: {borne} for {expected}");
            assert!((borne / expected - 1.0).abs() < 2e-3, "{borne} for {expected}");
            let measures = &world.accuracy().unwrap().whole;
            assert!(measures.residual.worst < 1e-3, "{measures:?}");
            assert!(
                measures.unexplained.max(measures.unexplained_turn) < 1e-4 && measures.joint_angle < 1e-4,
                "{measures:?}"
            );
            let problem = system.problem(Stabilisation::Rest).unwrap();
            assert!(problem.residual(&system.impulses()).worst < 1e-3);
            assert_eq!(world.accuracy().unwrap().islands.len(), 1, "a coupling connects");
        }
    }
}

/// The same wheels with a slack range, then at its end. Expected: nothing, then the same as a gear.
#[test]
fn the_ends_of_a_range_are_rows_of_one_direction() {
    let (mut world, [a, _], gear) = gears(Settings::default(), [30.0, 10.0]);
    world.set_coupling_range(gear, Some([f64::NEG_INFINITY, 15.0])).unwrap();
    let (mut slack, mut taut) = (0.0, 0.0);
    for step in 0..120 {
        world.add_torque(a, Vec3::X * 1.5).unwrap();
        world.step(DT).unwrap();
        let system = world.system().unwrap();
        let law = system.laws.iter().find(|law| law.owner == Owner::Coupling(gear)).unwrap();
        assert_eq!(law.law, Law::AT_LEAST_ZERO);
        let end = law.gap.unwrap();
        let borne = system.rows[law.first].impulse;
        assert!(borne >= 0.0);
        if end > 0.2 {
            assert_eq!(borne, 0.0, "step {step}, {end} from the end");
            slack = f64::max(slack, end);
        } else {
            taut = borne;
        }
        assert!(world.accuracy().unwrap().whole.unexplained < 1e-3, "step {step}");
    }
    // J k T / (I + k² J) on the second, whose factor is a third of the greater.
    let expected = 3.0 * 0.05 * 3.0 * 1.5 / (0.3 + 9.0 * 0.05) * f64::from(DT);
    assert!(slack > 0.4, "{slack}");
    assert!((taut / expected - 1.0).abs() < 0.02, "{taut} for {expected}");
}

/// A method that solves the step as one in place of the engine's solver. Expected: balls and gears do as they
/// do by the engine's.
#[test]
fn methods_of_the_lab_solve_rolling_friction_and_gears() {
    for method in ["gs-cone", "nncg", "admm"] {
        let solved = |world: &World| {
            let report = world.solver_report().unwrap();
            assert_eq!((report.solved, report.refused), (1, 0), "{method}");
        };
        let mut world = world(leaning(0.5 * 0.04_f64.atan()));
        let ball = slope(&mut world, rolling_material(0.02, 0.0));
        world.solve_with(WorldSolver::by_name(method));
        common::steps(&mut world, 120, DT);
        solved(&world);
        let speed = world.linear_velocity(ball).unwrap().length();
        assert!(speed < 1e-3, "{method}: {speed} m/s");
        let (mut world, [a, b], _) = gears(Settings::default(), [30.0, 10.0]);
        world.solve_with(WorldSolver::by_name(method));
        for _ in 0..60 {
            world.add_torque(a, Vec3::X * 1.5).unwrap();
            world.step(DT).unwrap();
        }
        solved(&world);
        let [w, v] = [a, b].map(|wheel| f64::from(world.angular_velocity(wheel).unwrap().x));
        let expected = 1.5 / (0.3 + 9.0 * 0.05);
        assert!((w / expected - 1.0).abs() < 1e-3, "{method}: {w} for {expected}");
        assert!((v + 3.0 * w).abs() < 1e-3 * v.abs(), "{method}: {v}");
    }
}

/// A form refuses a law that it can't express.
#[test]
fn contact_problems_tell_of_rolling_friction_that_they_leave_out() {
    let mut world = world(leaning(0.01));
    slope(&mut world, rolling_material(0.02, 0.0));
    common::steps(&mut world, 10, DT);
    let (_, told) = world.system().unwrap().contact_problem().unwrap();
    assert_eq!(told.rolling, 1);
}
