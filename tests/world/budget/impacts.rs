//! Impacts that are met at their times need memory of their own: omissions for want of it are reported.

use crate::common;

use backstop::glam::{DVec3, Vec3};
use backstop::{BodyDesc, Budget, Category, ContinuousMethod, Geometry, Settings, ShapeDesc, World};

/// Hash, what was shed, and the bytes of continuous collision before and after: a box is shot at the ground.
fn run(ground: &Geometry, budget: Budget) -> (u64, u32, [usize; 2]) {
    let mut settings = Settings::default().with_budget(budget);
    settings.continuous_method = ContinuousMethod::ConservativeAdvancement;
    let mut world = World::new(settings).unwrap();
    world
        .add_body(&BodyDesc::fixed().with_position(DVec3::NEG_Y).with_shape(ShapeDesc::new(ground.clone())))
        .unwrap();
    let cuboid = ShapeDesc::new(Geometry::cuboid(0.2, 0.1, 0.15));
    let body = BodyDesc::dynamic().with_position(DVec3::new(0.1, 0.4, 0.3)).with_shape(cuboid);
    world.add_body(&body.with_velocity(Vec3::new(7.0, -100.0, 2.0), Vec3::new(0.5, 1.0, -0.3))).unwrap();
    let bytes = |world: &World| world.memory().category(Category::Continuous).reserved;
    let first = bytes(&world);
    let shed = (0..4).map(|_| world.step(1.0 / 60.0).unwrap().shed).sum();
    (world.state_hash(), shed, [first, bytes(&world)])
}

/// Expected: where nothing is told to be shed, nothing was left out: the bits are those of a world without a
/// budget.
#[track_caller]
fn tells_what_it_leaves_out(ground: &Geometry) {
    let (free, _, _) = run(ground, Budget::NONE);
    let (wide, shed, [first, last]) = run(ground, Budget::NONE.with(Category::Continuous, 1 << 30));
    assert_eq!((wide, shed), (free, 0));
    assert!(last > first);
    let (mut all, mut some) = (0, 0);
    let budgets = (0..100).map(|i| first + (last + 1024 - first) * i / 100);
    for bytes in budgets.chain((0..100).map(|i| first + 8 * i)) {
        let (hash, shed, [_, now]) = run(ground, Budget::NONE.with(Category::Continuous, bytes));
        assert!(now <= bytes, "{now} of {bytes}");
        assert!(shed > 0 || hash == free, "{bytes} of {last} bytes: left out, and nothing shed");
        *if shed > 0 { &mut some } else { &mut all } += 1;
    }
    assert!(all > 5 && some > 5, "{all} without a loss, {some} with one");
}

#[test]
fn points_of_an_impact_with_a_mesh_that_find_no_place_are_told() {
    tells_what_it_leaves_out(&common::flat_mesh(2, 2.0));
}

#[test]
fn an_impact_of_convex_shapes_that_finds_no_place_is_told() {
    tells_what_it_leaves_out(&Geometry::cuboid(4.0, 0.2, 4.0));
}
