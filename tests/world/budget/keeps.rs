//! A step keeps to the budget: contacts that don't fit are left out, in an order that only the world decides.

use crate::common;

use backstop::glam::{DVec3, Quat, Vec3};
use backstop::{BodyDesc, Budget, Category, Geometry, Settings, ShapeDesc, Skeleton, World};
use backstop_scene::Scene;

const DT: f32 = 1.0 / 60.0;
const STEPS: u32 = 150;

fn settings(budget: Option<usize>, threads: usize) -> Settings {
    let budget = budget.map_or(Budget::NONE, Budget::total);
    Settings::default().with_budget(budget).with_threads(threads)
}

/// Results of a run: hash, what was shed step by step, the most memory after a step and before the first one.
#[derive(Debug, PartialEq)]
struct Run {
    hash: u64,
    shed: Vec<u32>,
    most: usize,
    first: usize,
}

fn run(scene: &Scene, budget: Option<usize>, threads: usize, mut each: impl FnMut(&World)) -> Run {
    let (mut world, _) = common::world_of(scene, settings(budget, threads));
    let (first, mut most, mut shed) = (world.memory().total(), 0, Vec::new());
    for _ in 0..STEPS {
        shed.push(world.step(DT).unwrap().shed);
        most = most.max(world.memory().total());
        each(&world);
    }
    Run { hash: world.state_hash(), shed, most, first }
}

fn total(run: &Run) -> u32 {
    run.shed.iter().sum()
}

#[test]
fn with_enough_budget_nothing_is_shed_and_nothing_changes() {
    let free = run(&common::small_pile(), None, 1, |_| {});
    assert_eq!(total(&free), 0);
    // Twice as much: buffers that are doubled may be doubled once more.
    let limited = run(&common::small_pile(), Some(4 * free.most), 1, |_| {});
    assert_eq!((total(&limited), limited.hash), (0, free.hash));
}

#[test]
fn a_falling_pile_keeps_to_any_budget_that_its_bodies_fit_in() {
    let scene = common::small_pile();
    let wide = run(&scene, Some(1 << 30), 1, |_| {});
    assert_eq!(total(&wide), 0);
    let mut before = u32::MAX;
    for share in [0.02, 0.1, 0.3, 0.5, 0.8] {
        let budget = wide.first + ((wide.most - wide.first) as f64 * share) as usize;
        let tight = run(&scene, Some(budget), 1, |world| {
            let used = world.memory().total();
            assert!(used <= budget, "{used} of {budget} at {share}");
        });
        let shed = total(&tight);
        println!("{share}: {budget} of {} bytes, {shed} shed", wide.most);
        assert!(share > 0.5 || shed > 0, "{share}");
        // More memory is never worse, once it is points that go: before that whole pairs do, which count as
        // one.
        if share >= 0.3 {
            assert!(shed <= before, "{shed} after {before} at {share}");
            before = shed;
        }
    }
}

#[test]
fn bullets_on_a_mesh_keep_to_the_budget_and_to_their_side() {
    let scene = common::crossfire();
    let wide = run(&scene, Some(1 << 30), 1, |_| {});
    assert_eq!(total(&wide), 0);
    for share in [0.0, 0.05, 0.2] {
        let budget = wide.first + ((wide.most - wide.first) as f64 * share) as usize;
        let tight = run(&scene, Some(budget), 1, |world| {
            let used = world.memory().total();
            assert!(used <= budget, "{used} of {budget} at {share}");
            for body in world.bodies() {
                let at = world.centre_of_mass(body).unwrap();
                // The floor ends 200 m from the middle; a body that flew off it may fall.
                assert!(at.y > -0.001 || at.x.abs().max(at.z.abs()) > 199.0, "{at} at {share}");
            }
        });
        println!("{share}: {budget} of {} bytes, {} shed", wide.most, total(&tight));
        assert!(total(&tight) > 0, "{share}");
    }
}

#[test]
fn ragdolls_keep_to_the_budget_and_above_the_ground() {
    let run = |more: Option<usize>| {
        let mut world = World::new(settings(Some(1 << 30), 1)).unwrap();
        let ground = BodyDesc::fixed().with_shape(ShapeDesc::new(Geometry::Plane));
        world.add_body(&ground).unwrap();
        for i in 0..30 {
            let at = DVec3::new(f64::from(i % 6) * 1.5, 2.0, f64::from(i / 6) * 1.5);
            let figure = Skeleton::humanoid();
            figure.add_to(&mut world, at, Quat::from_rotation_x(i as f32), Vec3::Y * -20.0).unwrap();
        }
        // In its first step the batches of joints get the bytes that adding them reserved.
        world.step(DT).unwrap();
        let first = world.memory().total();
        let budget = more.map_or(1 << 30, |more| first + more);
        world.set_settings(settings(Some(budget), 1)).unwrap();
        let mut shed = 0;
        for _ in 0..STEPS {
            shed += world.step(DT).unwrap().shed;
            let used = world.memory().total();
            assert!(used <= budget, "{used} of {budget}: {more:?}");
            for body in world.bodies() {
                let at = world.centre_of_mass(body).unwrap();
                assert!(at.y > -0.001, "{at}: {more:?}");
            }
        }
        // The least important rows may have given up less than they had.
        (world.memory().total().saturating_sub(first), shed)
    };
    let (wanted, shed) = run(None);
    assert_eq!(shed, 0);
    for share in [0.0, 0.1, 0.4, 0.7] {
        let (_, shed) = run(Some((wanted as f64 * share) as usize));
        println!("{share} of {wanted} bytes: {shed} shed");
        assert!(shed > 0, "{share}");
    }
}

/// Bodies on the floor bear those above: support is the last that goes.
#[test]
fn a_pile_that_lacks_memory_still_lies_on_its_floor() {
    let scene = common::small_pile();
    let wide = run(&scene, Some(1 << 30), 1, |_| {});
    let budget = wide.first + (wide.most - wide.first) / 2;
    let tight = run(&scene, Some(budget), 1, |world| {
        for body in world.bodies() {
            let y = world.centre_of_mass(body).unwrap().y;
            assert!(y > -1.1, "{y}");
        }
    });
    assert!(total(&tight) > 0);
}

#[test]
fn a_budget_below_what_is_there_stops_all_growth_but_no_step() {
    let (mut world, _) = common::world_of(&common::small_pile(), settings(None, 1));
    common::steps(&mut world, 30, DT);
    let used = world.memory().total();
    world.set_settings(settings(Some(used / 2), 1)).unwrap();
    // Columns that each body needs may still grow, once.
    world.step(DT).unwrap();
    let used = world.memory().total();
    let mut shed = 0;
    for _ in 0..60 {
        shed += world.step(DT).unwrap().shed;
        assert!(world.memory().total() <= used);
        assert!(common::all_finite(&world));
    }
    assert!(shed > 0);
    assert!(world.memory().category(Category::Manifolds).reserved > 0);
}

/// Expected: bodies that take the places of removed ones need nothing more. Added at once, they had made
/// place beside the free ones, without asking.
#[test]
fn bodies_in_the_places_of_removed_ones_take_no_more_memory() {
    let ball = ShapeDesc::new(Geometry::Sphere { radius: 0.1 });
    let body = |i: u32| BodyDesc::dynamic().with_position(DVec3::Y * f64::from(i)).with_shape(ball.clone());
    let mut world = World::new(settings(Some(1 << 20), 1)).unwrap();
    let bodies: Vec<_> = (0..16).map(|i| world.add_body(&body(i)).unwrap()).collect();
    for &body in &bodies[4..] {
        world.remove_body(body).unwrap();
    }
    world.step(DT).unwrap();
    let held = world.memory().total();
    world.set_settings(settings(Some(held), 1)).unwrap();
    let again: Vec<BodyDesc> = (4..16).map(body).collect();
    world.add_bodies(&again).unwrap();
    assert_eq!(world.memory().total(), held);
}
