//! The bytes of a scene are known before it runs: exactly those of its bodies, about those of the rest.

use backstop::{Budget, Category, Settings, World};
use backstop_scene::builtin;

#[test]
fn plans_of_builtin_scenes_are_about_what_they_take() {
    // Steps until a scene has taken its most.
    for (name, steps) in [
        ("talk", 300),
        ("bullets", 120),
        ("bullets_box", 120),
        ("large_pyramid", 20),
        ("joint_grid", 10),
        ("tall_stack", 20),
        ("chain", 20),
        ("pile", 200),
    ] {
        let scene = builtin::build(name).unwrap();
        let budget = Budget::total(usize::MAX);
        let settings = Settings::default().with_budget(budget).with_gravity(scene.gravity);
        let plan = scene.plan(&settings);
        let mut world = World::new(settings).unwrap();
        scene.add_to(&mut world).unwrap();
        for _ in 0..steps {
            world.step(1.0 / 60.0).unwrap();
        }
        let report = world.memory();
        for category in [Category::Bodies, Category::Shapes, Category::Meshes] {
            assert_eq!(plan.category(category), report.category(category).peak, "{name}: {category}");
        }
        let share = plan.total() as f64 / report.total() as f64;
        println!("{name}: {} of {} planned, {share:.3}", plan.total(), report.total());
        assert!((0.8..1.25).contains(&share), "{name}: {share}");
        assert_eq!(plan.iter().map(|(_, bytes)| bytes).sum::<usize>(), plan.total());
    }
}
