//! Later memory is within the budget too: restoring, the tree of queries, parts that settings switch on,
//! bodies that are enabled again. These once took it without a check.

use crate::common;

use backstop::glam::{DVec3, Vec3};
use backstop::{
    BodyDesc, BodyHandle, Budget, Category, ContinuousMethod, Error, Geometry, Material, QueryFilter, Ray,
    Settings, ShapeDesc, Snapshot, World,
};

const DT: f32 = 1.0 / 60.0;

fn ball(at: DVec3) -> BodyDesc {
    BodyDesc::dynamic().with_position(at).with_shape(ShapeDesc::new(Geometry::Sphere { radius: 0.3 }))
}

/// Sixty balls in a heap on the ground.
fn heap(settings: Settings) -> (World, Vec<BodyHandle>) {
    let mut world = World::new(settings).unwrap();
    world.add_body(&common::Floor::Box.desc(Material::default())).unwrap();
    let at = |i: u32| {
        DVec3::new(f64::from(i % 4) * 0.5, 0.3 + f64::from(i / 16) * 0.55, f64::from(i / 4 % 4) * 0.5)
    };
    let bodies = world.add_bodies(&(0..60).map(|i| ball(at(i))).collect::<Vec<_>>()).unwrap();
    common::steps(&mut world, 20, DT);
    (world, bodies)
}

fn wide() -> Settings {
    Settings::default().with_budget(Budget::total(1 << 30))
}

/// A budget alone is never refused.
fn limit(world: &mut World, bytes: usize) {
    world.set_settings(world.settings().clone().with_budget(Budget::total(bytes))).unwrap();
}

fn held(world: &World) -> usize {
    world.memory().total()
}

/// All that a snapshot has, and the bytes.
fn state(world: &World) -> (Vec<u8>, backstop::MemoryReport, u64) {
    let mut snapshot = Snapshot::new();
    world.snapshot(&mut snapshot);
    (snapshot.to_whole_bytes(), world.memory(), world.state_hash())
}

/// Leaves a call no byte and looks that it is refused and changes nothing; then a byte less than it asks for;
/// then what it asks for, of which it takes no more. Says how much that is.
#[track_caller]
fn asks<T: std::fmt::Debug>(
    world: &mut World,
    mut call: impl FnMut(&mut World) -> Result<T, Error>,
) -> usize {
    let used = held(world);
    let mut refused = |world: &mut World, bytes: usize| {
        limit(world, bytes);
        let before = state(world);
        let Err(Error::Budget { asked, left, .. }) = call(world) else { panic!("not refused at {bytes}") };
        assert_eq!(left, bytes - used);
        assert!(before == state(world), "something changed");
        asked
    };
    let asked = refused(world, used);
    assert!(asked > 0);
    assert_eq!(refused(world, used + asked - 1), asked);
    limit(world, used + asked);
    call(world).unwrap();
    assert!(held(world) <= used + asked, "{} of {}", held(world), used + asked);
    asked
}

/// Expected: the world's own budget holds, before and after; its bodies, contacts and pairs are asked for,
/// and steps keep to it.
#[test]
fn another_world_restores_what_its_own_budget_allows() {
    let (from, _) = heap(Settings::default().with_budget(Budget::total(1 << 22)));
    let mut snapshot = Snapshot::new();
    from.snapshot(&mut snapshot);
    let mut world = World::new(Settings::default()).unwrap();
    let asked = asks(&mut world, |world| world.restore(&snapshot));
    assert_eq!(world.settings().budget, Budget::total(asked));
    assert_eq!(world.state_hash(), from.state_hash());
    for _ in 0..60 {
        world.step(DT).unwrap();
        assert!(held(&world) <= asked);
    }
    // Present buffers need no bytes: a further ball is a part of them.
    let (mut larger, _) = heap(wide());
    larger.add_body(&ball(DVec3::Y * 9.0)).unwrap();
    let used = held(&larger);
    limit(&mut larger, used);
    larger.restore(&snapshot).unwrap();
    assert!(held(&larger) <= used);
    assert_eq!(larger.state_hash(), from.state_hash());
}

/// The category whose own limit is short is named.
#[test]
fn a_limit_of_contacts_refuses_a_snapshot_that_has_more() {
    let (from, _) = heap(Settings::default());
    let mut snapshot = Snapshot::new();
    from.snapshot(&mut snapshot);
    for category in [Category::Bodies, Category::Manifolds, Category::BroadPhase, Category::Scratch] {
        let budget = Budget::NONE.with(category, 100);
        let mut world = World::new(Settings::default().with_budget(budget)).unwrap();
        match world.restore(&snapshot) {
            Err(Error::Budget { category: short, asked, left: 100 }) => {
                assert_eq!(short, category);
                assert!(asked > 100);
            }
            other => panic!("{category}: {other:?}"),
        }
        assert_eq!((world.body_count(), held(&world)), (0, 0));
    }
}

/// Restoring each frame in a world that may not take a byte: there is place for all that it had.
#[test]
fn a_rollback_is_never_refused_in_the_world_that_took_the_snapshot() {
    for sleeping in [false, true] {
        let (mut world, bodies) = heap(wide().with_sleeping(sleeping));
        let mut used = held(&world);
        limit(&mut world, used);
        let mut ring = [Snapshot::new(), Snapshot::new(), Snapshot::new()];
        for frame in 0..90 {
            world.snapshot(&mut ring[frame % 3]);
            if frame % 20 == 19 {
                world.remove_body(bodies[frame / 2]).unwrap();
                // To take a body out lists its pairs, which nothing refuses.
                used = used.max(held(&world));
                limit(&mut world, used);
                world.step(DT).unwrap();
                world.restore(&ring[frame % 3]).unwrap();
            }
            world.step(DT).unwrap();
            // The oldest that there is.
            world.restore(&ring[if frame < 2 { 0 } else { (frame + 1) % 3 }]).unwrap();
            world.step(DT).unwrap();
            assert!(held(&world) <= used, "frame {frame}: {} of {used}", held(&world));
        }
        // A budget below the present bytes changes nothing about that.
        limit(&mut world, used / 2);
        world.restore(&ring[0]).unwrap();
        assert!(held(&world) <= used);
    }
}

/// The settings that come back are in force. What they switch on has kept its memory since, with a budget: a
/// rollback is not refused where not a byte is left.
#[test]
fn a_snapshot_that_switches_sleeping_on_comes_back_without_a_byte() {
    let (mut world, _) = heap(wide().with_sleeping(true));
    let mut snapshot = Snapshot::new();
    world.snapshot(&mut snapshot);
    world.set_settings(wide().with_sleeping(false)).unwrap();
    world.step(DT).unwrap();
    let most = held(&world);
    limit(&mut world, most);
    world.restore(&snapshot).unwrap();
    assert!(world.settings().sleeping && held(&world) <= most);
    common::steps(&mut world, 30, DT);
    assert!(held(&world) <= most);
}

/// Expected: the first query of a world, and one that meets new static bodies, are refused without place;
/// later ones take nothing.
#[test]
fn queries_ask_for_their_tree() {
    let (mut world, bodies) = heap(wide());
    let ray = Ray::new(DVec3::new(0.1, 50.0, 0.1), Vec3::Y * -100.0);
    let first = |world: &World| world.cast_ray(&ray, &QueryFilter::new()).map(|hit| hit.map(|hit| hit.body));
    let (unbounded, _) = heap(Settings::default());
    let expected = first(&unbounded).unwrap();
    assert!(expected.is_some());
    asks(&mut world, |world| first(world));
    assert_eq!(first(&world).unwrap(), expected);
    let (used, mut hits, mut found) = (held(&world), Vec::new(), Vec::new());
    limit(&mut world, used);
    for (round, &body) in bodies.iter().enumerate() {
        let at = world.position(body).unwrap();
        world.set_pose(body, at + DVec3::Y, backstop::glam::Quat::IDENTITY).unwrap();
        world.cast_ray_all(&ray, &QueryFilter::new(), &mut hits).unwrap();
        if round % 9 == 0 {
            world.step(DT).unwrap();
        }
        world.closest_point_all(at, 1.0, &QueryFilter::new(), &mut found).unwrap();
        assert!(held(&world) <= used, "round {round}");
    }
    limit(&mut world, 1 << 30);
    let walls: Vec<BodyDesc> = (0..40)
        .map(|i| BodyDesc::fixed().with_position(DVec3::new(9.0, f64::from(i), 0.0)))
        .map(|body| body.with_shape(ShapeDesc::new(Geometry::cuboid(1.0, 0.4, 1.0))))
        .collect();
    world.add_bodies(&walls).unwrap();
    asks(&mut world, |world| first(world));
}

/// Expected: refused, with the settings as they were; granted, the next steps take no more.
#[test]
fn what_settings_switch_on_later_is_asked_for() {
    let switches: [fn(&mut Settings); 2] = [
        |settings| settings.sleeping = true,
        |settings| settings.continuous_method = ContinuousMethod::ConservativeAdvancement,
    ];
    for switch in switches {
        let (mut world, _) = heap(wide());
        asks(&mut world, |world| {
            let mut settings = world.settings().clone();
            switch(&mut settings);
            let result = world.set_settings(settings);
            if result.is_err() {
                assert!(!world.settings().sleeping);
                assert_eq!(world.settings().continuous_method, Settings::default().continuous_method);
            }
            result
        });
        let most = held(&world);
        common::steps(&mut world, 60, DT);
        assert!(held(&world) <= most);
    }
}

/// Expected: bodies that are added to a world that sleeps bring the bytes that its first step needs, and
/// waking takes nothing.
#[test]
fn a_world_that_sleeps_keeps_to_its_budget_from_the_first_step_on() {
    let mut world = World::new(wide().with_sleeping(true)).unwrap();
    world.add_body(&common::Floor::Box.desc(Material::default())).unwrap();
    let many: Vec<BodyDesc> =
        (0..36).map(|i| ball(DVec3::new(f64::from(i % 6) * 0.8, 0.3, f64::from(i / 6) * 0.8))).collect();
    world.add_bodies(&many).unwrap();
    let bodies = world.memory().category(Category::Bodies).reserved;
    common::steps(&mut world, 120, DT);
    assert_eq!(world.sleeping_body_count(), 36);
    assert_eq!(world.memory().category(Category::Bodies).reserved, bodies);
    let used = held(&world);
    limit(&mut world, used);
    // It wakes all.
    world.set_settings(world.settings().clone().with_gravity(Vec3::Y * -9.0)).unwrap();
    assert_eq!(world.sleeping_body_count(), 0);
    assert!(held(&world) <= used);
    common::steps(&mut world, 10, DT);
    assert!(held(&world) <= used);
}

/// Other bodies meanwhile took the place of the disabled one.
#[test]
fn a_body_that_is_enabled_again_asks_for_its_place() {
    let (mut world, bodies) = heap(wide());
    bodies.iter().for_each(|&body| world.set_enabled(body, false).unwrap());
    let many: Vec<BodyDesc> = (0..80).map(|i| ball(DVec3::new(20.0 + f64::from(i), 5.0, 0.0))).collect();
    world.add_bodies(&many).unwrap();
    let used = held(&world);
    limit(&mut world, used);
    let refused = bodies.iter().find(|&&body| world.set_enabled(body, true).is_err());
    let &body = refused.expect("there is place for all");
    assert!(!world.is_enabled(body).unwrap());
    world.step(DT).unwrap();
    assert!(held(&world) <= used);
    limit(&mut world, 1 << 30);
    world.set_enabled(body, true).unwrap();
    common::steps(&mut world, 10, DT);
}
