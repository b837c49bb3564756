//! A step that has reached its capacities allocates nothing.

#![allow(clippy::disallowed_methods, reason = "expected values may use the platform's functions")]
mod common;
#[path = "allocation/everything.rs"]
mod everything;

use backstop::glam::{DVec3, Quat, Vec3};
use backstop::{
    Axes, Axis, BodyDesc, BodyHandle, Budget, Character, CharacterReport, CharacterSettings,
    ContinuousMethod, ConvexHull, CouplingDesc, Frame, Geometry, JointDesc, Limit, Material, Motion, Motor,
    QueryFilter, Ray, Settings, ShapeCast, Snapshot, Spring, World,
};
use backstop_scene::{Scene, builtin};
use common::piles::{Of, Pile};
use std::alloc::{GlobalAlloc, Layout, System};
use std::cell::Cell;
use std::sync::atomic::{AtomicUsize, Ordering};
use std::sync::{Arc, Mutex, MutexGuard, PoisonError};

/// Counts the allocations of threads that asked for it.
struct Counting;

static ALLOCATIONS: AtomicUsize = AtomicUsize::new(0);
/// Tests of one process share the count, so they run one at a time.
static ONE_AT_A_TIME: Mutex<()> = Mutex::new(());

thread_local! {
    /// Not the thread that runs the tests: it allocates when it prints, and it prints that a test takes more
    /// than a minute.
    static COUNTED: Cell<bool> = const { Cell::new(false) };
}

fn count_this_thread() {
    COUNTED.set(true);
}

fn add_one() {
    ALLOCATIONS.fetch_add(usize::from(COUNTED.get()), Ordering::Relaxed);
}

/// A test that counts, on its own thread and those of its pools, while no other does.
struct Alone {
    _lock: MutexGuard<'static, ()>,
}

fn one_at_a_time() -> Alone {
    let lock = ONE_AT_A_TIME.lock().unwrap_or_else(PoisonError::into_inner);
    count_this_thread();
    Alone { _lock: lock }
}

impl Drop for Alone {
    fn drop(&mut self) {
        COUNTED.set(false);
    }
}

// SAFETY: every call goes to the system's allocator unchanged.
unsafe impl GlobalAlloc for Counting {
    unsafe fn alloc(&self, layout: Layout) -> *mut u8 {
        add_one();
        // SAFETY: by the caller's contract.
        unsafe { System.alloc(layout) }
    }
    unsafe fn dealloc(&self, ptr: *mut u8, layout: Layout) {
        // SAFETY: by the caller's contract.
        unsafe { System.dealloc(ptr, layout) }
    }
    unsafe fn realloc(&self, ptr: *mut u8, layout: Layout, size: usize) -> *mut u8 {
        add_one();
        // SAFETY: by the caller's contract.
        unsafe { System.realloc(ptr, layout, size) }
    }
}

#[global_allocator]
static COUNTING: Counting = Counting;

/// Allocations in 100 steps after `warm_up` steps; `act` is what the game does before each.
fn count(world: &mut World, warm_up: u32, mut act: impl FnMut(&mut World, u32)) -> usize {
    let mut step = 0;
    let mut run = |world: &mut World, steps: u32| {
        for _ in 0..steps {
            act(world, step);
            world.step(1.0 / 60.0).unwrap();
            step += 1;
        }
    };
    run(world, warm_up);
    let before = ALLOCATIONS.load(Ordering::Relaxed);
    run(world, 100);
    ALLOCATIONS.load(Ordering::Relaxed) - before
}

fn settings(threads: usize) -> Settings {
    Settings::default().with_threads(threads)
}

fn resting(threads: usize) -> usize {
    let (mut world, _) = common::world_of(&common::small_pile(), settings(threads));
    count(&mut world, 400, |_, _| {})
}

/// Bodies on a table that tilts to and fro without end, beside elastic balls that never rest.
fn moving(threads: usize) -> usize {
    let mut world = World::new(settings(threads)).unwrap();
    world.add_body(&common::Floor::Mesh.desc(Material::default())).unwrap();
    let material = Material::default();
    let table = common::shape(Geometry::cuboid(4.0, 0.2, 4.0), material);
    let table = world.add_body(&BodyDesc::kinematic().with_position(DVec3::Y).with_shape(table)).unwrap();
    let mut add = |geometry: Geometry, at: Vec3, material: Material| -> BodyHandle {
        world.add_body(&common::dynamic(geometry, material, at)).unwrap()
    };
    for i in 0..100 {
        let at = Vec3::new((i % 10) as f32 * 0.6 - 2.7, 1.4, (i / 10) as f32 * 0.6 - 2.7);
        match i % 3 {
            0 => add(Geometry::cuboid(0.2, 0.1, 0.2), at, material),
            1 => add(Geometry::Sphere { radius: 0.2 }, at, material),
            _ => add(Geometry::capsule(0.1, 0.15), at, material),
        };
        add(
            Geometry::Sphere { radius: 0.2 },
            Vec3::new(at.x, 4.0 + 0.01 * i as f32, at.z + 6.5),
            material.with_restitution(1.0),
        );
    }
    // Long enough for the rarest crowd to have been there once.
    count(&mut world, 4000, |world, step| {
        let angle = 0.05 * (step as f32 * 0.05).sin();
        world.move_kinematic(table, DVec3::Y, Quat::from_rotation_z(angle), 1.0 / 60.0).unwrap();
    })
}

#[test]
fn a_resting_pile_allocates_nothing() {
    let _alone = one_at_a_time();
    assert_eq!(resting(1), 0);
}

/// Steps of a scene that allocate, as far as `steps`.
fn steps_that_allocate(scene: &Scene, steps: u32) -> Vec<u32> {
    let (mut world, _) = common::world_of(scene, settings(1));
    let allocates = |_: &u32| {
        let before = ALLOCATIONS.load(Ordering::Relaxed);
        world.step(1.0 / 60.0).unwrap();
        ALLOCATIONS.load(Ordering::Relaxed) > before
    };
    (0..steps).filter(allocates).collect()
}

/// A pile that has 70 % of what it wants beyond its bodies' own bytes: which contacts stay is settled anew in
/// each step, and takes no memory.
#[test]
fn a_pile_that_sheds_contacts_allocates_nothing() {
    let _alone = one_at_a_time();
    let pile = Pile { of: Of::Boxes, bodies: 300, seed: 1, dt: 1.0 / 60.0 };
    let mut free = pile.world(settings(1));
    count(&mut free, 200, |_, _| {});
    let wanted = free.memory().iter().map(|(_, bytes)| bytes.peak).sum::<usize>();
    let wide = pile.world(settings(1).with_budget(Budget::total(1 << 30)));
    let own = wide.memory().total();
    let budget = Budget::total(own + (wanted - own) * 7 / 10);
    let mut world = pile.world(settings(1).with_budget(budget));
    assert_eq!(count(&mut world, 600, |_, _| {}), 0);
    assert!(world.report().shed > 0);
}

/// Bodies that fall, fly and come to rest have their most contacts once; after that nothing grows.
#[test]
fn a_scene_past_its_densest_moment_allocates_nothing() {
    let _alone = one_at_a_time();
    for (scene, densest) in [
        // The bodies hit the ground up to frame 33, jump on from hill to hill, and lie in the valleys in the
        // end: there each touches the most triangles, the last of them at about 880.
        (builtin::talk(), 900),
        // They skid, and gather where they stop: the most lie on the mesh at about 260.
        (builtin::bullets(false), 300),
        (builtin::bullets(true), 100),
        // It settles layer by layer: the last contacts come late.
        (common::small_pile(), 250),
    ] {
        let steps = steps_that_allocate(&scene, densest + 300);
        println!("{}: {steps:?}", scene.name);
        assert!(steps.iter().all(|&step| step < densest), "{}: {steps:?}", scene.name);
        // On the way there, too, few steps need more than all before.
        assert!(steps.len() < 40, "{}: {steps:?}", scene.name);
    }
}

#[test]
fn a_moving_scene_allocates_nothing() {
    let _alone = one_at_a_time();
    assert_eq!(moving(1), 0);
}

/// Chains of all kinds of joints that hang from a platform which turns to and fro, clear of each other.
fn joined(threads: usize) -> usize {
    let mut world = World::new(settings(threads)).unwrap();
    let platform = world.add_body(&BodyDesc::kinematic()).unwrap();
    let spring = Spring::Frequency { hertz: 3.0, ratio: 0.5 };
    for chain in 0..40 {
        let mut last = platform;
        for link in 0..5 {
            let at = DVec3::new(f64::from(chain) * 2.0 - 39.0, -0.5 * f64::from(link) - 0.5, 0.0);
            let geometry = Geometry::Sphere { radius: 0.1 };
            let body = common::dynamic(geometry, Material::default(), at.as_vec3());
            let body = world.add_body(&body).unwrap();
            let bodies = [last, body];
            let frames = world.frames_at(bodies, at + DVec3::Y * 0.25, Quat::IDENTITY).unwrap();
            let cone = Limit::new(Motion::Angular, Axes::Perpendicular(Axis::Y), 0.0, 0.5);
            let twist = Limit::new(Motion::Angular, Axes::One(Axis::X), -0.5, 0.5);
            let desc = match (chain + link) % 6 {
                0 => JointDesc::ball(bodies, frames).with_limit(cone),
                1 => JointDesc::hinge(bodies, frames).with_limit(twist),
                2 => JointDesc::fixed(bodies, frames).with_break_force(1e9, 1e9),
                3 => JointDesc::distance(bodies, frames, 0.0, 0.1),
                4 => JointDesc::wheel(bodies, frames, 0.1, spring),
                _ => {
                    JointDesc::ball(bodies, frames).with_motor(Motor::friction(Motion::Angular, Axis::Z, 0.1))
                }
            };
            world.add_joint(&desc).unwrap();
            last = body;
        }
    }
    count(&mut world, 300, |world, step| {
        let angle = 0.05 * (step as f32 * 0.05).sin();
        world.move_kinematic(platform, DVec3::ZERO, Quat::from_rotation_x(angle), 1.0 / 60.0).unwrap();
    })
}

#[test]
fn joints_allocate_nothing() {
    let _alone = one_at_a_time();
    assert_eq!(joined(1), 0);
}

/// A train of gears with a motor, and weights on ropes.
#[test]
fn couplings_allocate_nothing() {
    let _alone = one_at_a_time();
    let mut world = World::new(settings(1)).unwrap();
    let ground = world.add_body(&BodyDesc::fixed()).unwrap();
    let mut last = None;
    for i in 0..20u8 {
        let at = Vec3::X * f32::from(i);
        let geometry = Geometry::Sphere { radius: 0.1 };
        let body = world.add_body(&common::dynamic(geometry, Material::default(), at)).unwrap();
        let frames = world.frames_at([ground, body], at.as_dvec3(), Quat::IDENTITY).unwrap();
        let joint = world.add_joint(&JointDesc::hinge([ground, body], frames)).unwrap();
        match last {
            None => {
                let motor = Motor::velocity(Motion::Angular, Axis::X, 3.0, 5.0);
                world.set_joint_motor(joint, motor).unwrap();
            }
            Some(last) => {
                world.add_coupling(&CouplingDesc::gear([last, joint], [10.0, 11.0])).unwrap();
            }
        }
        last = Some(joint);
    }
    let ropes = [0.0_f32, 1.0].map(|x| {
        let at = Vec3::new(x, -2.0, 5.0);
        let body = common::dynamic(Geometry::Sphere { radius: 0.1 }, Material::default(), at);
        let body = world.add_body(&body).unwrap();
        let frames = [Frame::at(at + Vec3::Y), Frame::default()];
        world.add_joint(&JointDesc::new([ground, body], frames)).unwrap()
    });
    world.add_coupling(&CouplingDesc::pulley(ropes, 1.0, 2.0)).unwrap();
    assert_eq!(count(&mut world, 300, |_, _| {}), 0);
}

/// Twenty doors whose targets, limits and motors change in every step, and joints that are reported.
#[test]
fn changes_of_joints_in_place_allocate_nothing() {
    let _alone = one_at_a_time();
    let mut world = World::new(settings(1)).unwrap();
    let ground = world.add_body(&BodyDesc::fixed()).unwrap();
    let servo = Spring::Coefficients { stiffness: 2000.0, damping: 100.0 };
    let drive = Motor::position(Motion::Angular, Axis::X, 0.0, servo);
    let limit = Limit::new(Motion::Angular, Axes::One(Axis::X), -1.0, 1.0);
    let joints: Vec<_> = (0..20)
        .map(|i| {
            let at = Vec3::X * (3.0 * i as f32);
            let body = common::dynamic(Geometry::cuboid(0.5, 0.1, 0.1), Material::default(), at);
            let bodies = [ground, world.add_body(&body).unwrap()];
            let frames = world.frames_at(bodies, at.as_dvec3() - DVec3::X * 0.5, Quat::IDENTITY).unwrap();
            let desc = JointDesc::hinge(bodies, frames).with_limit(limit).with_motor(drive);
            world.add_joint(&desc.with_thresholds(1.0, 1.0)).unwrap()
        })
        .collect();
    let mut snapshots = [Snapshot::new(), Snapshot::new()];
    let with_snapshots = count(&mut world, 300, |world, step| {
        let target = (step as f32 * 0.05).sin();
        for &joint in &joints {
            world.set_joint_target(joint, Motion::Angular, Axis::X, target, 0.0).unwrap();
            world.set_joint_limit(joint, limit.with_range(-1.0 - target.abs(), 1.0)).unwrap();
        }
        // Targets and ends of ranges are part of the state: the list of joints is not written again.
        world.snapshot(&mut snapshots[step as usize % 2]);
        assert!(step == 0 || world.strained_joints().len() == joints.len());
    });
    assert_eq!(with_snapshots, 0);
    let drives = count(&mut world, 10, |world, step| {
        for &joint in &joints {
            world.set_joint_motor(joint, drive.with_max_force(100.0 + step as f32)).unwrap();
            world.set_joint_frames(joint, world.joint_local_frames(joint).unwrap()).unwrap();
        }
    });
    assert_eq!(drives, 0);
}

/// Elastic balls at 60 m/s in a closed box of thin walls: every step has impacts, with any method.
#[test]
fn every_method_of_continuous_collision_allocates_nothing() {
    let _alone = one_at_a_time();
    use ContinuousMethod::{ConservativeAdvancement, LinearCast, Speculative, Talk};
    for method in [Speculative, LinearCast, ConservativeAdvancement, Talk] {
        let settings = settings(1).with_continuous_method(method).with_gravity(Vec3::ZERO);
        let mut world = World::new(settings).unwrap();
        let material = Material::default().with_restitution(1.0).with_friction(0.0);
        for axis in [Vec3::X, Vec3::Y, Vec3::Z] {
            for side in [-3.0, 3.0] {
                let half = Vec3::splat(3.0) - axis * 2.99;
                let wall = common::shape(Geometry::cuboid(half.x, half.y, half.z), material);
                let at = (axis * side).as_dvec3();
                world.add_body(&BodyDesc::fixed().with_position(at).with_shape(wall)).unwrap();
            }
        }
        let ground = common::shape(common::flat_mesh(4, 1.0), material);
        world.add_body(&BodyDesc::fixed().with_position(DVec3::Y * -2.5).with_shape(ground)).unwrap();
        for i in 0..48 {
            let place = |i: i32| (i % 4) as f32 - 1.5;
            let at = Vec3::new(place(i), place(i / 4), place(i / 16));
            let turn = i as f32 * 2.4;
            let velocity = Vec3::new(turn.cos(), (3.0 * turn).sin(), turn.sin()) * 60.0;
            let ball = common::dynamic(Geometry::Sphere { radius: 0.1 }, material, at);
            world.add_body(&ball.with_velocity(velocity, Vec3::ONE)).unwrap();
        }
        let mut struck = 0;
        let allocations = count(&mut world, 1500, |world, _| struck += world.report().struck);
        assert_eq!(
            struck > 10_000,
            matches!(method, LinearCast | ConservativeAdvancement),
            "{method:?}: {struck}"
        );
        assert_eq!(allocations, 0, "{method:?}");
    }
}

/// Rays, moving shapes, overlaps and nearest points after each step of a scene that moves.
#[test]
fn queries_allocate_nothing() {
    let _alone = one_at_a_time();
    let (mut world, bodies) = common::world_of(&common::small_pile(), settings(1));
    let filter = QueryFilter::new();
    let (mut rays, mut casts) = (Vec::with_capacity(999), Vec::with_capacity(999));
    let (mut overlaps, mut points) = (Vec::with_capacity(999), Vec::with_capacity(999));
    let (shape, mut found) = (Geometry::cuboid(0.5, 0.5, 0.5), 0);
    let ask = |world: &mut World, step: u32| {
        let at = DVec3::new(0.1, 3.0, 0.01 * f64::from(step % 100));
        let ray = Ray::new(at, Vec3::new(0.5, -9.0, 0.1));
        world.cast_ray_all(&ray, &filter, &mut rays).unwrap();
        world.cast_rays(&[ray; 99], &filter, &mut [None; 99]).unwrap();
        let cast = ShapeCast::new(&shape, at, ray.path);
        world.cast_shape_all(&cast, &filter, &mut casts).unwrap();
        world.overlap(&shape, at, Quat::IDENTITY, &filter, &mut overlaps).unwrap();
        world.closest_point_all(at, 1.0, &filter, &mut points).unwrap();
        found += rays.len() + casts.len() + overlaps.len() + points.len();
        // By hand, too: one body there and back.
        let (body, lift) = (bodies[bodies.len() - 1], if step.is_multiple_of(2) { 0.1 } else { -0.1 });
        let to = world.position(body).unwrap() + DVec3::Y * lift;
        world.set_pose(body, to, world.rotation(body).unwrap()).unwrap();
    };
    assert_eq!(count(&mut world, 500, ask), 0);
    assert!(found > 1000, "{found}");
}

/// Characters that run into a pile, over its rubble and into each other's way.
#[test]
fn characters_allocate_nothing() {
    let _alone = one_at_a_time();
    let (mut world, _) = common::world_of(&common::small_pile(), settings(1));
    let mut characters = [0.0, 2.0, 4.0].map(|x| {
        (
            Character::new(CharacterSettings::default(), DVec3::new(x, 6.0, 8.0)).unwrap(),
            CharacterReport::default(),
        )
    });
    let mut ran_into = 0;
    let ask = |world: &mut World, step: u32| {
        for (character, last) in &mut characters {
            let turn = 0.05 * step as f32;
            let wish = Vec3::new(3.0 * turn.cos(), last.velocity.y - 0.2, 3.0 * turn.sin() - 0.5);
            *last = character.walk(world, &QueryFilter::new(), wish, 1.0 / 60.0).unwrap();
            ran_into += last.hits().count();
            last.push(world).unwrap();
        }
    };
    assert_eq!(count(&mut world, 1500, ask), 0);
    assert!(ran_into > 20, "{ran_into}");
}

/// Characters of the world, one of them a hull: walks, and snapshots with rollback.
#[test]
fn characters_of_a_world_allocate_nothing() {
    let _alone = one_at_a_time();
    let (mut world, _) = common::world_of(&common::small_pile(), settings(1));
    let corners = [[0.3, -0.9, 0.0], [-0.3, -0.9, 0.2], [0.0, -0.9, -0.3], [0.0, 0.9, 0.0]];
    let hull = Geometry::Hull(Arc::new(ConvexHull::new(&corners.map(Vec3::from)).unwrap()));
    let walkers = [None, Some(Geometry::cuboid(0.3, 0.9, 0.3)), Some(hull)].map(|shape| {
        let mut made = Character::new(CharacterSettings::default(), DVec3::new(0.0, 6.0, 8.0)).unwrap();
        made.set_shape(shape).unwrap();
        world.add_character(&made).unwrap()
    });
    let mut saved = Snapshot::new();
    let ask = |world: &mut World, step: u32| {
        for walker in walkers {
            let turn = 0.05 * step as f32;
            let wish = Vec3::new(3.0 * turn.cos(), -3.0, 3.0 * turn.sin() - 0.5);
            let report = world.walk_character(walker, &QueryFilter::new(), wish, 1.0 / 60.0).unwrap();
            report.push(world).unwrap();
        }
        if step.is_multiple_of(4) {
            world.snapshot(&mut saved);
        } else if step % 4 == 3 {
            world.restore(&saved).unwrap();
        }
    };
    // Each fourth step goes back by three: after 300 steps in all the pile is at rest, and gains no contacts.
    assert_eq!(count(&mut world, 1200, ask), 0);
}

/// Eight frames are rolled back and done again, with a snapshot after each, over and over.
#[test]
fn a_rollback_allocates_nothing() {
    let _alone = one_at_a_time();
    for sleeping in [false, true] {
        let (mut world, bodies) =
            common::world_of(&common::small_pile(), settings(1).with_sleeping(sleeping));
        common::steps(&mut world, 400, 1.0 / 60.0);
        let mut ring: Vec<Snapshot> = (0..9).map(|_| Snapshot::new()).collect();
        let mut rounds = |count: usize| {
            for _ in 0..count {
                world.snapshot(&mut ring[0]);
                for _ in 0..2 {
                    for snapshot in &mut ring[1..] {
                        // Awake and pushed, so that there is something to go back from.
                        world.set_velocity(bodies[100], Vec3::Y, Vec3::ONE).unwrap();
                        world.step(1.0 / 60.0).unwrap();
                        world.snapshot(snapshot);
                    }
                    world.restore(&ring[0]).unwrap();
                }
                common::steps(&mut world, 1, 1.0 / 60.0);
            }
        };
        rounds(40);
        let before = ALLOCATIONS.load(Ordering::Relaxed);
        rounds(20);
        assert_eq!(ALLOCATIONS.load(Ordering::Relaxed) - before, 0, "sleeping: {sleeping}");
    }
}

/// A pool whose threads are counted.
fn pool(threads: usize) -> rayon::ThreadPoolBuilder {
    rayon::ThreadPoolBuilder::new().num_threads(threads).start_handler(|_| count_this_thread())
}

#[test]
fn two_threads_allocate_nothing() {
    let _alone = one_at_a_time();
    let pool = pool(2).build().unwrap();
    assert_eq!(pool.install(|| joined(2)), 0);
    assert_eq!(pool.install(|| resting(2)), 0);
}

/// Rayon allocates for jobs from outside of a pool (docs/memory.md): a box for each helper, and a block for
/// each 63 jobs. Nothing else is allocated, and nothing by the engine.
#[test]
fn outside_of_the_pool_a_step_allocates_a_box_for_each_helper() {
    let _alone = one_at_a_time();
    const HELPERS: usize = 3;
    pool(1 + HELPERS).build_global().unwrap();
    // All threads of the pool but one are taken. The one takes jobs from outside in their order, so that all
    // helpers of a step have left when a `join` after it returns, and the next step calls them anew.
    let taken: Vec<_> = (0..HELPERS)
        .map(|_| {
            let (arrived, is_there) = std::sync::mpsc::channel();
            let (go, told) = std::sync::mpsc::channel::<()>();
            rayon::spawn(move || {
                arrived.send(()).unwrap();
                let _ = told.recv();
            });
            is_there.recv().unwrap();
            go
        })
        .collect();
    let (mut world, _) = common::world_of(&common::small_pile(), settings(1 + HELPERS));
    let mut steps = |count: usize| {
        for _ in 0..count {
            world.step(1.0 / 60.0).unwrap();
            rayon::join(|| (), || ());
        }
    };
    steps(400);
    let before = ALLOCATIONS.load(Ordering::Relaxed);
    steps(63);
    let allocations = ALLOCATIONS.load(Ordering::Relaxed) - before;
    drop(taken);
    // 63 steps hand in 63 times three helpers and a `join`, which needs no box: four blocks.
    assert_eq!(allocations, 63 * HELPERS + (HELPERS + 1));
}

/// Stacks that fall asleep and are woken in turn, listened to, in a sensor and with hooks.
#[test]
fn sleep_events_and_hooks_allocate_nothing() {
    let _alone = one_at_a_time();
    let settings = settings(1).with_sleeping(true).with_sleep_time(0.1);
    let mut world = World::new(settings).unwrap();
    let shape = |geometry: Geometry| common::shape(geometry, Material::default());
    world.add_body(&BodyDesc::fixed().with_shape(shape(Geometry::Plane))).unwrap();
    let sensor = shape(Geometry::cuboid(50.0, 1.2, 50.0)).as_sensor();
    world.add_body(&BodyDesc::fixed().with_shape(sensor)).unwrap();
    let stacks: Vec<BodyHandle> = (0..20)
        .map(|i| {
            let add = |world: &mut World, y: f64| {
                let cube = shape(Geometry::cuboid(0.5, 0.5, 0.5)).with_events().with_hooks();
                let at = DVec3::new(f64::from(i % 5) * 3.0, y, f64::from(i / 5) * 3.0);
                world.add_body(&BodyDesc::dynamic().with_position(at).with_shape(cube)).unwrap()
            };
            add(&mut world, 0.5);
            add(&mut world, 1.5)
        })
        .collect();
    let mut slept = 0;
    let allocations = count(&mut world, 400, |world, step| {
        slept = slept.max(world.sleeping_body_count());
        if step % 3 == 0 {
            // Up, and out of the sensor for a while.
            let body = stacks[(step / 3) as usize % stacks.len()];
            world.apply_impulse_at(body, Vec3::Y * 4000.0, world.centre_of_mass(body).unwrap()).unwrap();
        }
    });
    assert!(slept >= 10, "{slept}");
    assert_eq!(allocations, 0);
}
