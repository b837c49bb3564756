//! Penalty methods: how stiff they may be, and the way out of an overlapped body.

use backstop::glam::{DVec3, Vec3};
use backstop::{BodyDesc, ContinuousMode, Geometry, Material, Settings, ShapeDesc, World};
use backstop_lab::LabWorld;
use backstop_lab::WorldSolver;
use backstop_lab::steppers::Stepper;
use backstop_lab::steppers::limit::{is_stable, limit};

/// The explicit form is stable up to ω dt = 2 (sqrt(1 + ζ²) - ζ), from the eigenvalues of one step, and the
/// implicit one for any stiffness. Five per cent to either side of the limit.
#[test]
fn a_penalty_is_stable_up_to_its_limit() {
    let [explicit, implicit] = ["penalty", "penalty-implicit"].map(|name| Stepper::by_name(name).unwrap());
    for damping in [0.05, 0.3, 0.7] {
        for dt in [1.0 / 30.0, 1.0 / 60.0, 1.0 / 240.0] {
            let most = limit(damping, dt);
            for (share, stable) in [(0.3, true), (0.95, true), (1.05, false), (3.0, false)] {
                let found = is_stable(explicit, share * most, damping, dt as f32).unwrap();
                assert_eq!(found, stable, "damping {damping}, dt {dt}, {share} of the limit");
            }
            for share in [1.0, 3.0, 10.0] {
                // Stiffer ones bear the ball at a depth of micrometres, which contacts in single precision
                // don't tell.
                let frequency = (share * most).min(100.0);
                assert!(
                    is_stable(implicit, frequency, damping, dt as f32).unwrap(),
                    "{damping}, {dt}, {share}"
                );
            }
        }
    }
    assert!(is_stable(explicit, 0.1, 0.0, 1.0 / 60.0).is_err(), "a spring that bears the ball 25 m deep");
}

/// A box of 0.2 m that falls at 5 m/s into a slab of 0.2 m on a spring of 3 Hz: it goes in by 5 / (6 pi) =
/// 0.27 m, beyond the middle, where the shortest way out is down.
#[test]
fn what_went_in_comes_out_where_it_went_in() {
    let end = |direction_memory| {
        let settings = Settings::default().with_gravity(Vec3::ZERO).with_continuous(ContinuousMode::Discrete);
        let mut world = World::new(settings).unwrap();
        let material = Material::default().with_friction(0.0).with_restitution(0.0);
        let shape = |geometry| ShapeDesc::new(geometry).with_material(material);
        world.add_body(&BodyDesc::fixed().with_shape(shape(Geometry::cuboid(2.0, 0.1, 2.0)))).unwrap();
        let cube =
            BodyDesc::dynamic().with_position(DVec3::Y * 0.21).with_velocity(Vec3::NEG_Y * 5.0, Vec3::ZERO);
        let cube = world.add_body(&cube.with_shape(shape(Geometry::cuboid(0.1, 0.1, 0.1)))).unwrap();
        let mut solver = WorldSolver { direction_memory, ..WorldSolver::by_name("penalty").unwrap() };
        // Four points share the mass.
        (solver.effort.frequency, solver.effort.damping) = (3.0, 0.0);
        world.solve_with(Some(solver));
        for _ in 0..120 {
            world.step(1.0 / 240.0).unwrap();
        }
        (world.position(cube).unwrap().y, world.linear_velocity(cube).unwrap().y)
    };
    let (through, speed) = end(false);
    assert!(through < -0.1 && speed < 0.0, "without memory it is pushed through: {through} m, {speed} m/s");
    let (out, speed) = end(true);
    assert!(out > 0.1 && speed > 3.0, "with it, it comes back: {out} m, {speed} m/s");
}
