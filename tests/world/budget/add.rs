//! Additions beyond the budget are refused by the category that is short, and nothing has changed.

use crate::common;

use backstop::glam::{DVec3, Quat, Vec3};
use backstop::{
    BodyDesc, BodyHandle, Budget, Category, ConvexHull, Error, Geometry, JointDesc, Material, QueryFilter,
    Ray, RowGroup, Settings, ShapeDesc, Snapshot, World,
};
use std::sync::Arc;

const DT: f32 = 1.0 / 60.0;

fn ball(at: DVec3) -> BodyDesc {
    BodyDesc::dynamic().with_position(at).with_shape(ShapeDesc::new(Geometry::Sphere { radius: 0.3 }))
}

/// A few balls on the ground, in the middle of things.
fn world() -> (World, Vec<BodyHandle>) {
    let mut world = World::new(Settings::default()).unwrap();
    limit(&mut world, Budget::total(1 << 30));
    world.add_body(&common::Floor::Box.desc(Material::default())).unwrap();
    let bodies = (0..20).map(|i| ball(DVec3::new(f64::from(i % 5) * 0.5, 0.3 + f64::from(i / 5) * 0.6, 0.0)));
    let bodies = world.add_bodies(&bodies.collect::<Vec<_>>()).unwrap();
    common::steps(&mut world, 10, DT);
    (world, bodies)
}

fn limit(world: &mut World, budget: Budget) {
    world.set_settings(world.settings().clone().with_budget(budget)).unwrap();
}

/// All that a snapshot has, and the bytes.
fn state(world: &World) -> (Vec<u8>, backstop::MemoryReport, u64) {
    let mut snapshot = Snapshot::new();
    world.snapshot(&mut snapshot);
    (snapshot.to_whole_bytes(), world.memory(), world.state_hash())
}

/// Gives a category no more than it has, and checks the result and the effects of a call.
#[track_caller]
fn refuses<T: std::fmt::Debug>(
    world: &mut World,
    category: Category,
    call: impl FnOnce(&mut World) -> Result<T, Error>,
) {
    // Room enough by one byte less than could ever do.
    let held = world.memory().category(category).reserved;
    limit(world, Budget::NONE.with(category, held));
    let before = state(world);
    match call(world) {
        Err(Error::Budget { category: short, asked, left }) => {
            assert_eq!((short, left), (category, 0));
            assert!(asked > 0);
        }
        other => panic!("{category}: {other:?}"),
    }
    assert!(before == state(world), "{category}: something changed");
    limit(world, Budget::NONE);
}

fn hull() -> Geometry {
    let corners: Vec<Vec3> = (0..20)
        .map(|i| Quat::from_rotation_y(i as f32) * Quat::from_rotation_x(i as f32 * 0.7) * Vec3::Y * 0.4)
        .collect();
    Geometry::Hull(Arc::new(ConvexHull::new(&corners).unwrap()))
}

#[test]
fn each_category_refuses_what_it_has_no_place_for() {
    let (mut world, bodies) = world();
    let many: Vec<BodyDesc> = (0..50).map(|i| ball(DVec3::Y * (10.0 + f64::from(i)))).collect();
    for category in
        [Category::Bodies, Category::Shapes, Category::BroadPhase, Category::Scratch, Category::Continuous]
    {
        refuses(&mut world, category, |world| world.add_bodies(&many));
        refuses(&mut world, category, |world| many.iter().map(|d| world.add_body(d)).next().unwrap());
    }
    for category in [Category::Shapes, Category::BroadPhase] {
        let shape = ShapeDesc::new(Geometry::Sphere { radius: 0.1 });
        refuses(&mut world, category, |world| world.add_shape(bodies[3], &shape));
    }
    // A second shape makes a list.
    let shape = ShapeDesc::new(Geometry::Sphere { radius: 0.1 });
    refuses(&mut world, Category::Bodies, |world| world.add_shape(bodies[3], &shape));
    let pebble = BodyDesc::dynamic().with_shape(ShapeDesc::new(hull()));
    refuses(&mut world, Category::Shapes, |world| world.add_body(&pebble));
    let terrain = BodyDesc::fixed().with_shape(ShapeDesc::new(common::flat_mesh(20, 1.0)));
    refuses(&mut world, Category::Meshes, |world| world.add_body(&terrain));
    refuses(&mut world, Category::Bodies, |world| world.add_force(bodies[0], Vec3::Y));
    refuses(&mut world, Category::Scratch, |world| {
        world.set_body_solved_after(bodies[0], Some(RowGroup::StaticContacts))
    });
    let frames = world.frames_at([bodies[0], bodies[1]], DVec3::Y, Quat::IDENTITY).unwrap();
    let joint = JointDesc::ball([bodies[0], bodies[1]], frames);
    for category in [Category::Joints, Category::Scratch] {
        refuses(&mut world, category, |world| world.add_joint(&joint));
        refuses(&mut world, category, |world| world.add_joints(&[joint.clone(), joint.clone()]));
    }
    let elastic = Material::default().with_restitution(0.5);
    let first = world.shapes(bodies[2]).unwrap().next().unwrap();
    // Nothing is kept of bodies that bounce, or whose contacts hooks see, but in a step.
    world.set_material(first, elastic).unwrap();
    world.set_hooks(first, true).unwrap();
    // After all of that it is as good as ever.
    common::steps(&mut world, 10, DT);
    assert!(common::all_finite(&world));
}

#[test]
fn the_whole_names_who_asks_for_most() {
    let (mut world, _) = world();
    let used = world.memory().total();
    limit(&mut world, Budget::total(used + 10_000));
    let before = state(&world);
    let terrain = BodyDesc::fixed().with_shape(ShapeDesc::new(common::flat_mesh(30, 1.0)));
    match world.add_body(&terrain) {
        Err(Error::Budget { category: Category::Meshes, asked, left: 10_000 }) => assert!(asked > 10_000),
        other => panic!("{other:?}"),
    }
    assert!(before == state(&world));
    // Bodies that fit in the total may still be too many for one category.
    limit(&mut world, Budget::total(used + (1 << 24)).with(Category::Meshes, 5000));
    match world.add_body(&terrain) {
        Err(Error::Budget { category: Category::Meshes, asked, left: 5000 }) => assert!(asked > 5000),
        other => panic!("{other:?}"),
    }
    limit(&mut world, Budget::total(used + (1 << 24)));
    world.add_body(&terrain).unwrap();
}

/// The reserved bytes are all that is taken: nothing else of a body grows in a step.
#[test]
fn what_is_asked_for_is_taken_and_no_more() {
    let (mut world, _) = world();
    let many: Vec<BodyDesc> = (0..50).map(|i| ball(DVec3::Y * (10.0 + f64::from(i)))).collect();
    let used = world.memory();
    limit(&mut world, Budget::total(used.total()));
    let Err(Error::Budget { asked, left: 0, .. }) = world.add_bodies(&many) else { panic!("not refused") };
    limit(&mut world, Budget::total(used.total() + asked - 1));
    assert!(world.add_bodies(&many).is_err());
    limit(&mut world, Budget::total(used.total() + asked));
    world.add_bodies(&many).unwrap();
    assert_eq!(world.memory().total(), used.total() + asked);
    // Rows that are short of place take that of others which is not needed; what is left over may go to
    // pairs.
    for _ in 0..60 {
        world.step(DT).unwrap();
        assert!(world.memory().total() <= used.total() + asked);
    }
}

/// Once a query asked, bodies bring the place that its tree needs.
#[test]
fn a_query_takes_nothing_that_bodies_did_not_bring() {
    let (mut world, _) = world();
    let ask = |world: &World| {
        let ray = Ray::new(DVec3::new(0.1, 50.0, 0.0), Vec3::Y * -100.0);
        world.cast_ray(&ray, &QueryFilter::new()).unwrap()
    };
    assert!(ask(&world).is_some());
    let many: Vec<BodyDesc> = (0..200).map(|i| ball(DVec3::Y * (10.0 + f64::from(i)))).collect();
    let bodies = world.add_bodies(&many).unwrap();
    common::steps(&mut world, 2, DT);
    let used = world.memory().total();
    limit(&mut world, Budget::total(used));
    for round in 0..300 {
        let body = bodies[round % bodies.len()];
        let at = world.position(body).unwrap();
        world.set_pose(body, at + DVec3::X, Quat::IDENTITY).unwrap();
        if round % 7 == 0 {
            assert!(ask(&world).is_some());
        }
        if round % 50 == 0 {
            world.step(DT).unwrap();
        }
        assert!(world.memory().total() <= used, "round {round}");
    }
}
