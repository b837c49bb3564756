//! Contacts are of use only with rows. Within a total budget contacts took all the room, and none was left for a single row: boxes
//! that lay in each other stayed so for good.

use backstop::glam::{DVec3, Vec3};
use backstop::{BodyDesc, BodyHandle, Budget, Geometry, Settings, ShapeDesc, World};

const DT: f32 = 1.0 / 60.0;
const LIMIT: usize = 16 << 20;

/// Unit boxes at one point, their lower faces on a floor.
fn crowd(count: usize, gravity: f32) -> (World, Vec<BodyHandle>) {
    let gravity = Vec3::Y * gravity;
    let settings = Settings { budget: Budget::total(LIMIT), gravity, ..Settings::default() };
    let mut world = World::new(settings).unwrap();
    let floor =
        BodyDesc::fixed().at(DVec3::Y * -1.0).with_shape(ShapeDesc::new(Geometry::cuboid(100.0, 1.0, 100.0)));
    world.add_body(&floor).unwrap();
    let cube =
        BodyDesc::dynamic().at(DVec3::Y * 0.5).with_shape(ShapeDesc::new(Geometry::cuboid(0.5, 0.5, 0.5)));
    let bodies = world.add_bodies(&vec![cube; count]).unwrap();
    (world, bodies)
}

/// 180,300 pairs want ten times the budget. Expected: within it, with gravity and without, all boxes leave the point where they were
/// made, most by more than their size, and none sinks into the floor by a tenth of it.
#[test]
fn a_crowd_parts_within_a_budget_and_stays_on_its_floor() {
    for gravity in [0.0, -9.81] {
        let (mut world, bodies) = crowd(600, gravity);
        let mut shed = 0;
        for step in 0..90 {
            shed += u64::from(world.step(DT).unwrap().shed);
            assert!(world.memory().total() <= LIMIT);
            let at = bodies.iter().map(|&b| world.position(b).unwrap());
            let low = at.clone().map(|at| at.y).fold(f64::MAX, f64::min);
            if step % 10 == 9 {
                let beyond = |far: f64| at.clone().filter(|at| at.distance(DVec3::Y * 0.5) > far).count();
                let report = world.report();
                println!(
                    "{gravity} {step}: {} pairs {} manifolds low {low:.3} moved {} by 1 m {}",
                    report.pairs,
                    report.manifolds,
                    beyond(0.1),
                    beyond(1.0)
                );
            }
            assert!(low > 0.4, "step {step}: {low}");
        }
        let beyond = |far: f64| {
            bodies.iter().filter(|&&b| world.position(b).unwrap().distance(DVec3::Y * 0.5) > far).count()
        };
        assert!(shed > 0);
        assert_eq!(beyond(0.1), 600);
        assert!(beyond(1.0) > 300, "{}", beyond(1.0));
    }
}
