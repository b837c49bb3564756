//! Bodies at rest sleep, in islands, which wake when touched, moved or deprived of their support.

use crate::common::{self, random::Random};
use backstop::glam::{DVec3, Quat, Vec3};
use backstop::{
    BodyDesc, BodyHandle, Budget, Filter, Frame, Geometry, JointDesc, Material, Settings, ShapeDesc, World,
};
use backstop_scene::builtin;

const DT: f32 = 1.0 / 60.0;

fn settings() -> Settings {
    Settings::default().with_sleeping(true)
}

/// A world with a floor at y = 0.
fn floor() -> World {
    let mut world = World::new(settings()).unwrap();
    world.add_body(&BodyDesc::fixed().with_shape(ShapeDesc::new(Geometry::Plane))).unwrap();
    world
}

fn cube() -> ShapeDesc {
    ShapeDesc::new(Geometry::cuboid(0.5, 0.5, 0.5))
}

fn add(world: &mut World, at: DVec3) -> BodyHandle {
    world.add_body(&BodyDesc::dynamic().with_position(at).with_shape(cube())).unwrap()
}

/// Three cubes on top of each other.
fn stack(world: &mut World, x: f64) -> [BodyHandle; 3] {
    [0.5, 1.5, 2.5].map(|y| add(world, DVec3::new(x, y, 0.0)))
}

fn run(world: &mut World, seconds: f32) {
    for _ in 0..(seconds / DT) as u32 {
        world.step(DT).unwrap();
    }
}

fn asleep(world: &World, bodies: &[BodyHandle]) -> bool {
    let sleeping = bodies.iter().filter(|&&body| world.is_sleeping(body).unwrap()).count();
    assert!(sleeping == 0 || sleeping == bodies.len(), "an island sleeps as a whole: {sleeping}");
    sleeping > 0
}

/// A stack that sleeps on a floor, ten metres from another.
fn sleepers() -> (World, [BodyHandle; 3], [BodyHandle; 3]) {
    let mut world = floor();
    let (one, other) = (stack(&mut world, 0.0), stack(&mut world, 10.0));
    run(&mut world, 2.0);
    assert!(asleep(&world, &one) && asleep(&world, &other));
    assert_eq!((world.sleeping_body_count(), world.sleeping_island_count()), (6, 2));
    (world, one, other)
}

#[test]
#[ignore = "measured: 394 of 395 asleep after 30 s"]
fn a_pile_falls_asleep_and_stays_where_it_is() {
    let mut scene = builtin::pile();
    scene.bodies.truncate(400);
    let (mut world, _) = common::world_of(&scene, settings());
    run(&mut world, 30.0);
    let dynamic = world.bodies().filter(|&b| world.kind(b).unwrap() == backstop::BodyKind::Dynamic).count();
    println!(
        "{} of {dynamic} asleep in {} islands",
        world.sleeping_body_count(),
        world.sleeping_island_count()
    );
    assert_eq!(world.sleeping_body_count(), dynamic);
    let hash = world.state_hash();
    run(&mut world, 5.0);
    assert_eq!(world.state_hash(), hash);
    let report = world.report();
    assert_eq!((report.asleep as usize, report.pairs, report.manifolds), (dynamic, 0, 0));
}

#[test]
fn nothing_sleeps_unless_it_is_asked_for() {
    let mut world = World::new(Settings::default()).unwrap();
    let body = add(&mut world, DVec3::ZERO);
    world.set_gravity_scale(body, 0.0).unwrap();
    run(&mut world, 2.0);
    world.sleep(body).unwrap();
    assert!(!world.is_sleeping(body).unwrap());
}

#[test]
fn a_ball_wakes_the_stack_that_it_hits_and_no_other() {
    let (mut world, one, other) = sleepers();
    let ball = ShapeDesc::new(Geometry::Sphere { radius: 0.2 });
    let ball = BodyDesc::dynamic().with_position(DVec3::new(-3.0, 1.5, 0.0)).with_shape(ball);
    world.add_body(&ball.with_velocity(Vec3::X * 20.0, Vec3::ZERO)).unwrap();
    run(&mut world, 0.5);
    assert!(!asleep(&world, &one) && asleep(&world, &other));
    run(&mut world, 10.0);
    assert!(asleep(&world, &one));
}

/// An impact with a cube that sleeps is solved with both awake, as with one that does not sleep.
#[test]
fn an_impact_is_that_of_bodies_that_are_awake() {
    let hit = |sleeping: bool, speed: f32| {
        let mut world =
            World::new(Settings::default().with_gravity(Vec3::ZERO).with_sleeping(sleeping)).unwrap();
        let body = add(&mut world, DVec3::ZERO);
        run(&mut world, 2.0);
        assert_eq!(world.is_sleeping(body).unwrap(), sleeping);
        let ball = BodyDesc::dynamic().with_position(DVec3::NEG_X * 3.0).with_shape(cube());
        let ball = world.add_body(&ball.with_velocity(Vec3::X * speed, Vec3::ZERO)).unwrap();
        run(&mut world, 5.0 / speed);
        [body, ball].map(|b| (world.position(b).unwrap(), world.linear_velocity(b).unwrap()))
    };
    for speed in [0.5, 5.0, 100.0, 500.0] {
        assert_eq!(hit(true, speed), hit(false, speed), "{speed} m/s");
    }
}

/// Each in its own world: a caller's change, and the stack that it has to wake.
#[test]
fn whatever_changes_about_a_stack_wakes_it() {
    type Change = fn(&mut World, [BodyHandle; 3]);
    let changes: [(&str, Change); 20] = [
        ("wake", |w, s| w.wake(s[1]).unwrap()),
        ("impulse", |w, s| w.apply_impulse_at(s[2], Vec3::X * 1e-3, DVec3::new(0.0, 2.5, 0.0)).unwrap()),
        ("force", |w, s| w.add_force(s[2], Vec3::X).unwrap()),
        ("velocity", |w, s| w.set_velocity(s[0], Vec3::Y * 1e-3, Vec3::ZERO).unwrap()),
        ("pose", |w, s| w.set_pose(s[1], DVec3::new(0.0, 1.5, 4.0), Quat::IDENTITY).unwrap()),
        ("gravity scale", |w, s| w.set_gravity_scale(s[1], 0.5).unwrap()),
        ("gravity", |w, _| {
            let gravity = Vec3::Y * -3.0;
            w.set_settings(w.settings().clone().with_gravity(gravity)).unwrap();
        }),
        ("no sleep", |w, _| w.set_settings(w.settings().clone().with_sleeping(false)).unwrap()),
        ("sleepless", |w, s| w.set_can_sleep(s[1], false).unwrap()),
        ("material", |w, s| {
            let shape = w.shapes(s[1]).unwrap().next().unwrap();
            w.set_material(shape, Material::default().with_friction(0.3)).unwrap();
        }),
        ("filter", |w, s| {
            let shape = w.shapes(s[1]).unwrap().next().unwrap();
            w.set_filter(shape, Filter::default().with_category(3)).unwrap();
        }),
        ("shape", |w, s| {
            w.add_shape(s[1], &cube()).unwrap();
        }),
        ("mass", |w, s| {
            w.set_mass(s[1], backstop::MassProperties::of(&Geometry::cuboid(0.5, 0.5, 0.5), 10.0)).unwrap();
        }),
        ("a body goes", |w, s| w.remove_body(s[0]).unwrap()),
        ("the floor goes", |w, _| {
            let floor = w.bodies().find(|&b| w.kind(b).unwrap() == backstop::BodyKind::Static).unwrap();
            w.remove_body(floor).unwrap();
        }),
        ("the floor moves", |w, _| {
            let floor = w.bodies().find(|&b| w.kind(b).unwrap() == backstop::BodyKind::Static).unwrap();
            w.set_pose(floor, DVec3::NEG_Y, Quat::IDENTITY).unwrap();
        }),
        ("the floor is slippery", |w, _| {
            let floor = w.bodies().find(|&b| w.kind(b).unwrap() == backstop::BodyKind::Static).unwrap();
            let shape = w.shapes(floor).unwrap().next().unwrap();
            w.set_material(shape, Material::default().with_friction(0.3)).unwrap();
        }),
        ("something static comes", |w, _| {
            w.add_body(&BodyDesc::fixed().with_position(DVec3::new(0.9, 1.5, 0.0)).with_shape(cube()))
                .unwrap();
        }),
        ("something is put on it", |w, _| {
            add(w, DVec3::new(0.0, 3.5, 0.0));
        }),
        ("a joint", |w, s| {
            let other = w.add_body(&BodyDesc::fixed()).unwrap();
            let frames = [Frame::at(Vec3::new(0.0, 2.5, 0.0)), Frame::default()];
            w.add_joint(&JointDesc::ball([other, s[2]], frames)).unwrap();
        }),
    ];
    for (name, change) in changes {
        let (mut world, one, _) = sleepers();
        change(&mut world, one);
        world.step(DT).unwrap();
        let there: Vec<BodyHandle> = one.into_iter().filter(|&body| world.contains(body)).collect();
        assert!(!asleep(&world, &there), "{name}");
        // Awake or asleep, all goes on as it should.
        run(&mut world, 5.0);
        let awake = matches!(name, "no sleep" | "sleepless" | "the floor goes");
        assert!(
            awake || world.sleeping_body_count() == world.bodies().count() - world_static(&world),
            "{name}"
        );
    }
}

fn world_static(world: &World) -> usize {
    world.bodies().filter(|&b| world.kind(b).unwrap() != backstop::BodyKind::Dynamic).count()
}

#[test]
fn whoever_hangs_on_a_joint_wakes_when_it_goes() {
    let mut world = floor();
    let hook = world.add_body(&BodyDesc::fixed().with_position(DVec3::Y * 5.0)).unwrap();
    let body = add(&mut world, DVec3::Y * 4.0);
    let joint = JointDesc::ball([hook, body], [Frame::default(), Frame::at(Vec3::Y)]);
    let joint = world.add_joint(&joint).unwrap();
    run(&mut world, 2.0);
    assert!(world.is_sleeping(body).unwrap());
    world.remove_joint(joint).unwrap();
    run(&mut world, 1.0);
    assert!(world.position(body).unwrap().y < 1.0);
}

/// A lift: a kinematic plate under a stack.
#[test]
fn a_lift_that_starts_wakes_those_in_it_and_keeps_them_awake() {
    let mut world = World::new(settings()).unwrap();
    let plate = ShapeDesc::new(Geometry::cuboid(2.0, 0.5, 2.0));
    let lift =
        world.add_body(&BodyDesc::kinematic().with_position(DVec3::Y * -0.5).with_shape(plate)).unwrap();
    let riders = stack(&mut world, 0.0);
    run(&mut world, 2.0);
    assert!(asleep(&world, &riders));
    // So slow that riders alone would count as at rest.
    for (speed, seconds) in [(0.01, 4.0), (2.0, 2.0)] {
        world.set_velocity(lift, Vec3::Y * speed, Vec3::ZERO).unwrap();
        for _ in 0..(seconds / DT) as u32 {
            world.step(DT).unwrap();
            assert!(!asleep(&world, &riders));
        }
        let above = world.position(riders[0]).unwrap() - world.position(lift).unwrap();
        assert!((above.y - 1.0).abs() < 0.01, "{above}");
        world.set_velocity(lift, Vec3::ZERO, Vec3::ZERO).unwrap();
        run(&mut world, 2.0);
        assert!(asleep(&world, &riders));
    }
    // Taken away at once.
    world.set_pose(lift, DVec3::X * 50.0, Quat::IDENTITY).unwrap();
    run(&mut world, 1.0);
    assert!(world.position(riders[0]).unwrap().y < 0.0);
}

#[test]
fn who_never_sleeps_keeps_its_island_awake() {
    let mut world = floor();
    let (one, other) = (stack(&mut world, 0.0), stack(&mut world, 10.0));
    world.set_can_sleep(one[1], false).unwrap();
    run(&mut world, 5.0);
    assert!(!asleep(&world, &one) && asleep(&world, &other));
    world.sleep(one[0]).unwrap();
    assert!(!asleep(&world, &one));
    world.set_can_sleep(one[1], true).unwrap();
    run(&mut world, 1.0);
    assert!(asleep(&world, &one));
}

#[test]
fn who_is_sent_to_sleep_sleeps_with_its_island_in_mid_air() {
    let mut world = floor();
    let (one, other) = (add(&mut world, DVec3::Y * 50.0), add(&mut world, DVec3::new(3.0, 50.0, 0.0)));
    run(&mut world, 0.5);
    world.sleep(one).unwrap();
    let at = world.position(one).unwrap();
    run(&mut world, 1.0);
    assert_eq!(world.position(one).unwrap(), at);
    assert_eq!(world.linear_velocity(one).unwrap(), Vec3::ZERO);
    assert!(!world.is_sleeping(other).unwrap() && world.position(other).unwrap().y < at.y - 5.0);
}

/// Two that sleep side by side without touching: one wakes and is pushed into the other, slowly and fast.
#[test]
fn neighbours_that_slept_apart_meet() {
    for speed in [0.02, 0.06, 1.0, 50.0] {
        let mut world = floor();
        let (one, other) = (add(&mut world, DVec3::Y * 0.5), add(&mut world, DVec3::new(1.02, 0.5, 0.0)));
        // Without friction, so that slow bodies get anywhere.
        for body in world.bodies().collect::<Vec<_>>() {
            let shape = world.shapes(body).unwrap().next().unwrap();
            world.set_material(shape, Material::default().with_friction(0.0)).unwrap();
        }
        run(&mut world, 2.0);
        assert_eq!((world.sleeping_body_count(), world.sleeping_island_count()), (2, 2));
        for _ in 0..120 {
            if world.position(one).unwrap().x < 0.5 {
                world.set_velocity(one, Vec3::X * speed, Vec3::ZERO).unwrap();
            }
            world.step(DT).unwrap();
            let apart = world.position(other).unwrap().x - world.position(one).unwrap().x;
            assert!(apart > 0.995, "{speed} m/s: {apart}");
        }
        let moved = world.position(other).unwrap().x - 1.02;
        assert!(moved > 0.01, "{speed} m/s: {moved}");
    }
}

#[test]
fn a_bullet_does_not_pass_a_wall_that_sleeps() {
    let mut world = floor();
    let slab = ShapeDesc::new(Geometry::cuboid(0.02, 1.0, 1.0));
    let slab = world.add_body(&BodyDesc::dynamic().with_position(DVec3::Y).with_shape(slab)).unwrap();
    world.sleep(slab).unwrap();
    run(&mut world, 2.0);
    assert!(world.is_sleeping(slab).unwrap());
    let bullet = ShapeDesc::new(Geometry::Sphere { radius: 0.05 });
    let bullet = BodyDesc::dynamic().with_position(DVec3::new(-20.0, 1.0, 0.0)).with_shape(bullet);
    let bullet = world.add_body(&bullet.with_velocity(Vec3::X * 800.0, Vec3::ZERO)).unwrap();
    run(&mut world, 0.5);
    let [a, b] = [bullet, slab].map(|body| world.position(body).unwrap().x);
    assert!(a < b, "{a} {b}");
}

/// The same calls give the same bits at any number of threads, with much that sleeps and wakes.
#[test]
fn sleep_does_not_depend_on_threads() {
    let play = |threads: usize| {
        let mut scene = builtin::pile();
        scene.bodies.truncate(300);
        let (mut world, handles) = common::world_of(&scene, settings().with_threads(threads));
        let (mut hashes, mut most) = (Vec::new(), 0);
        for step in 0..900 {
            if step > 600 && step % 50 == 0 {
                let body = handles[handles.len() - 1 - step as usize / 50];
                world
                    .apply_impulse_at(body, Vec3::new(30.0, 80.0, 10.0), world.position(body).unwrap())
                    .unwrap();
            }
            world.step(DT).unwrap();
            most = most.max(world.sleeping_body_count());
            hashes.push(world.state_hash());
        }
        println!("{threads} threads: at most {most} asleep, {} at the end", world.sleeping_body_count());
        (hashes, most)
    };
    let one = play(1);
    assert!(one.1 > 100);
    assert!(play(2) == one && play(3) == one);
}

/// Random changes: invariants after each step, and that memory comes back.
#[test]
fn bodies_come_and_go_while_others_sleep() {
    let mut world = floor();
    let mut random = Random(7);
    let mut below = |n: usize| random.below(n);
    let mut bodies: Vec<BodyHandle> = Vec::new();
    let (mut most, mut slept, mut woke) = (0, 0, 0);
    for round in 0..3000 {
        match below(24) {
            0..4 if bodies.len() < 60 => {
                let at = DVec3::new(below(8) as f64, 1.0 + below(4) as f64, below(8) as f64);
                bodies.push(add(&mut world, at));
            }
            4 if !bodies.is_empty() => world.remove_body(bodies.swap_remove(below(bodies.len()))).unwrap(),
            5 if bodies.len() > 1 => {
                let (i, k) = (below(bodies.len()), below(bodies.len()));
                if i != k {
                    let frames = world.frames_at([bodies[i], bodies[k]], DVec3::Y, Quat::IDENTITY).unwrap();
                    world.add_joint(&JointDesc::distance([bodies[i], bodies[k]], frames, 0.0, 3.0)).unwrap();
                }
            }
            6 if !bodies.is_empty() => {
                let body = bodies[below(bodies.len())];
                world.apply_impulse_at(body, Vec3::Y * 5000.0, world.position(body).unwrap()).unwrap();
            }
            7 if !bodies.is_empty() => world.sleep(bodies[below(bodies.len())]).unwrap(),
            8 if !bodies.is_empty() => world.wake(bodies[below(bodies.len())]).unwrap(),
            9 if round % 20 == 0 => {
                let sleeping = !world.settings().sleeping;
                world.set_settings(world.settings().clone().with_sleeping(sleeping)).unwrap();
            }
            _ => {}
        }
        let report = *world.step(DT).unwrap();
        (slept, woke) = (slept + report.slept, woke + report.woke);
        most = most.max(world.sleeping_body_count());
        for &body in &bodies {
            let (at, v) = (world.position(body).unwrap(), world.linear_velocity(body).unwrap());
            assert!(at.y > 0.2, "{round}: {at}");
            assert!(!world.is_sleeping(body).unwrap() || v == Vec3::ZERO, "{round}");
        }
        let listed: Vec<BodyHandle> = world.bodies().collect();
        assert_eq!(listed.len(), bodies.len() + 1);
    }
    println!("{most} asleep at most, {slept} fell asleep, {woke} woke");
    assert!(most > 20 && slept > 200 && woke > 200);
    for body in bodies {
        world.remove_body(body).unwrap();
    }
    world.step(DT).unwrap();
    assert_eq!((world.sleeping_body_count(), world.sleeping_island_count(), world.report().pairs), (0, 0, 0));
}

#[test]
fn sleepers_keep_to_the_budget() {
    let mut world = World::new(settings().with_budget(Budget::total(1 << 30))).unwrap();
    world.add_body(&BodyDesc::fixed().with_shape(ShapeDesc::new(Geometry::Plane))).unwrap();
    let all: Vec<[BodyHandle; 3]> = (0..20).map(|i| stack(&mut world, f64::from(i) * 2.0)).collect();
    world.step(DT).unwrap();
    let budget = world.memory().total() + 40_000;
    world.set_settings(world.settings().clone().with_budget(Budget::total(budget))).unwrap();
    for round in 0..20 {
        run(&mut world, 2.0);
        assert!(world.memory().total() <= budget, "{round}");
        for stack in all.iter().skip(round % 3).step_by(3) {
            world.wake(stack[0]).unwrap();
        }
    }
    run(&mut world, 2.0);
    assert_eq!(world.sleeping_body_count(), 60);
}

/// Sleep that was switched off between two steps is off at once: nobody may be sent to sleep with the columns
/// of the last step. The step after it once went out of bounds.
#[test]
fn nobody_is_sent_to_sleep_once_it_is_switched_off() {
    let mut world = World::new(Settings::default().with_sleeping(true)).unwrap();
    let ball = common::dynamic(Geometry::Sphere { radius: 0.5 }, Material::default(), Vec3::ZERO);
    let [ball, other] =
        [ball.clone(), ball.with_position(Vec3::X * 0.9)].map(|desc| world.add_body(&desc).unwrap());
    world.step(1.0 / 60.0).unwrap();
    world.set_settings(world.settings().clone().with_sleeping(false)).unwrap();
    world.sleep(ball).unwrap();
    assert!(!world.is_sleeping(ball).unwrap() && !world.is_sleeping(other).unwrap());
    world.step(1.0 / 60.0).unwrap();
    world.step(1.0 / 60.0).unwrap();
}

/// An island that sleeps on a kinematic body at rest keeps its pairs with it in the list, and these have
/// nothing that can be pushed: no rows. They were made all the same, with the index of a sleeper for that of
/// a body that moves; a step panicked unless the sleeper was the first of all. Expected: the island sleeps
/// on, as it was, and wakes when its support goes.
#[test]
fn an_island_sleeps_on_what_is_kinematic_and_at_rest() {
    let round = ShapeDesc::new(Geometry::Sphere { radius: 2.0 });
    let mut world = World::new(settings().with_gravity(Vec3::ZERO)).unwrap();
    let support = world.add_body(&BodyDesc::kinematic().with_shape(round)).unwrap();
    let boxes = [0.5, 0.4].map(|half| {
        let shape = ShapeDesc::new(Geometry::cuboid(half, 0.5, 0.5));
        world.add_body(&BodyDesc::dynamic().with_position(DVec3::Y).with_shape(shape)).unwrap()
    });
    world.step(DT).unwrap();
    world.sleep(boxes[1]).unwrap();
    let places = boxes.map(|body| world.position(body).unwrap());
    for _ in 0..20 {
        world.step(DT).unwrap();
        assert!(asleep(&world, &boxes));
    }
    assert_eq!(boxes.map(|body| world.position(body).unwrap()), places);
    world.set_velocity(support, Vec3::NEG_Y, Vec3::ZERO).unwrap();
    world.step(DT).unwrap();
    assert!(!asleep(&world, &boxes));
}

/// Four cubes side by side on a plate, which they all touch: they fell asleep by themselves, and the next
/// step panicked.
#[test]
fn many_sleep_on_one_plate_and_bear_what_they_bore_when_it_starts() {
    let mut world = World::new(settings()).unwrap();
    let plate = ShapeDesc::new(Geometry::cuboid(5.0, 0.5, 5.0));
    let plate =
        world.add_body(&BodyDesc::kinematic().with_position(DVec3::Y * -0.5).with_shape(plate)).unwrap();
    let riders: Vec<BodyHandle> =
        (0..4).map(|i| add(&mut world, DVec3::new(f64::from(i) * 1.5 - 2.25, 0.5, 0.0))).collect();
    run(&mut world, 2.0);
    assert_eq!(world.sleeping_body_count(), 4);
    let heights: Vec<f64> = riders.iter().map(|&body| world.position(body).unwrap().y).collect();
    run(&mut world, 1.0);
    world.set_velocity(plate, Vec3::X * 0.02, Vec3::ZERO).unwrap();
    for _ in 0..60 {
        world.step(DT).unwrap();
        for (&body, height) in riders.iter().zip(&heights) {
            // By less than the fall of a contact that begins without impulses: g dt^2 = 2.7 mm.
            assert!((world.position(body).unwrap().y - height).abs() < 3e-4);
        }
    }
}
