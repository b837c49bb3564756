//! A budget includes rows against rolling and of belts: a contact has them or is shed.

use crate::common::random::Random;
use backstop::glam::{DVec3, Vec3};
use backstop::{BodyDesc, Budget, Geometry, Material, Settings, ShapeDesc, World};
use backstop_scene::Scene;

const DT: f32 = 1.0 / 60.0;
const STEPS: u32 = 150;

/// Balls that fall into each other and roll, on a belt.
fn balls() -> Scene {
    let mut scene = Scene::new("balls");
    let belt = Material::default().with_surface_velocity(Vec3::X * 0.2);
    let floor = ShapeDesc::new(Geometry::cuboid(40.0, 1.0, 40.0)).with_material(belt);
    scene.add("floor", BodyDesc::fixed().with_position(DVec3::NEG_Y).with_shape(floor));
    let mut random = Random(5);
    let rough = Material::default().with_rolling_friction(0.02).with_spinning_friction(0.01);
    let ball = ShapeDesc::new(Geometry::Sphere { radius: 0.25 }).with_material(rough);
    for i in 0..300_u16 {
        let at = DVec3::new(f64::from(i % 8), 0.7 * f64::from(i / 64), f64::from(i / 8 % 8)) * 0.6;
        let way = Vec3::new(random.signed(), 0.0, random.signed());
        let body = BodyDesc::dynamic().with_position(at + DVec3::Y * 0.3).with_velocity(way, Vec3::ZERO);
        scene.add("ball", body.with_shape(ball.clone()));
    }
    scene
}

/// Hash, number of points that were shed, and the most memory after a step.
fn run(scene: &Scene, budget: Option<usize>, threads: usize) -> (u64, u32, usize) {
    let budget = budget.map_or(Budget::NONE, Budget::total);
    let mut world = World::new(Settings::default().with_budget(budget).with_threads(threads)).unwrap();
    scene.add_to(&mut world).unwrap();
    let (mut shed, mut most) = (0, 0);
    for _ in 0..STEPS {
        shed += world.step(DT).unwrap().shed;
        most = most.max(world.memory().total());
    }
    (world.state_hash(), shed, most)
}

/// Expected: no step takes more than the budget, at any number of threads alike; and where nothing was shed,
/// nothing was left out: the bits are those of a world without a budget.
#[test]
fn what_rolls_within_a_budget_is_braked_or_shed() {
    let scene = balls();
    let (free, _, _) = run(&scene, None, 1);
    let (_, shed, wide) = run(&scene, Some(1 << 30), 1);
    assert_eq!(shed, 0);
    let first = {
        let mut world = World::new(Settings::default().with_budget(Budget::total(1 << 30))).unwrap();
        scene.add_to(&mut world).unwrap();
        world.memory().total()
    };
    let (mut all, mut some) = (0, 0);
    for percent in [5, 40, 75, 85, 88, 90, 91, 92, 93, 94, 95, 96, 98, 100, 120] {
        let budget = first + (wide - first) * percent / 100;
        let (hash, shed, most) = run(&scene, Some(budget), 1);
        println!("{percent} %: {budget} bytes, {shed} shed, at most {most}");
        assert!(most <= budget, "{most} of {budget} at {percent} %");
        assert!(shed > 0 || hash == free, "at {percent} %: something was left out, and nothing shed");
        *if shed > 0 { &mut some } else { &mut all } += 1;
        if percent % 20 == 0 {
            assert_eq!(run(&scene, Some(budget), 2).0, hash, "{percent} %, two threads");
        }
    }
    assert!(all >= 2 && some >= 3, "{all} without a loss, {some} with one");
    let planned = scene.plan(&Settings::default()).total();
    println!("planned {planned}, taken {wide}");
    assert!((0.5..2.0).contains(&(planned as f64 / wide as f64)), "{planned} for {wide}");
}
