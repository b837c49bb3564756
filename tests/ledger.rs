//! The report has every byte that a world holds: the sum of its categories is the count of the allocator.
//!
//! The `World` itself (`size_of::<World>()`) belongs to the caller, on the stack or elsewhere, and is neither
//! in the report nor on the heap.

#![allow(clippy::disallowed_methods, reason = "expected values may use the platform's functions")]
mod common;
#[path = "common/counting.rs"]
mod counting;

use backstop::glam::{DVec3, Quat, Vec3};
use backstop::{
    BodyDesc, BodyHandle, BodyKind, Category, ConvexHull, Geometry, HeightField, Material, QueryFilter, Ray,
    RowGroup, Settings, ShapeDesc, Skeleton, Snapshot, World,
};
use backstop_scene::{Scene, Terrain, builtin};
use counting::live;
use std::sync::Arc;

const DT: f32 = 1.0 / 60.0;

/// A world whose bytes are counted from before it was made.
struct Ledger {
    start: isize,
    world: World,
}

impl Ledger {
    fn new(settings: Settings) -> Ledger {
        let start = live();
        Ledger { start, world: World::new(settings).unwrap() }
    }

    /// With a scene in it, of which nothing else is left: its hulls and meshes are the world's alone.
    fn of(scene: impl FnOnce() -> Scene, settings: Settings) -> (Ledger, Vec<BodyHandle>) {
        let mut ledger = Ledger::new(settings);
        // From here on the handles are the test's.
        let bodies = scene().add_to(&mut ledger.world).unwrap().bodies;
        ledger.start += (bodies.capacity() * size_of::<BodyHandle>()) as isize;
        ledger.check("just made");
        (ledger, bodies)
    }

    #[track_caller]
    fn check(&self, when: impl std::fmt::Display) {
        let held = live() - self.start;
        let report = self.world.memory();
        assert_eq!(report.total() as isize, held, "{when}: {report:?}");
        for (category, bytes) in report.iter() {
            assert!(bytes.live <= bytes.reserved, "{when}: {category} {bytes:?}");
            assert!(bytes.reserved <= bytes.peak, "{when}: {category} {bytes:?}");
        }
    }

    /// Steps, and compares after each.
    fn steps(&mut self, count: u32) {
        for step in 0..count {
            self.world.step(DT).unwrap();
            self.check(format_args!("step {step}"));
        }
    }

    /// Nothing is left behind.
    fn end(self) {
        self.check("at the end");
        let Ledger { start, world } = self;
        drop(world);
        assert_eq!(live(), start, "the world is gone");
    }
}

fn ball(at: DVec3) -> BodyDesc {
    BodyDesc::dynamic().with_position(at).with_shape(ShapeDesc::new(Geometry::Sphere { radius: 0.3 }))
}

#[test]
fn an_empty_world_holds_nothing() {
    let mut ledger = Ledger::new(Settings::default());
    assert_eq!(ledger.world.memory().total(), 0);
    ledger.steps(3);
    ledger.end();
}

#[test]
fn of_a_pile_that_falls_grows_and_is_cleared_away() {
    let (mut ledger, bodies) = Ledger::of(common::small_pile, Settings::default());
    ledger.steps(90);
    for &body in &bodies[5..100] {
        ledger.world.remove_body(body).unwrap();
    }
    ledger.check("a third is gone");
    ledger.steps(20);
    for i in 0..150 {
        let at = DVec3::new(f64::from(i % 10) - 5.0, 8.0 + f64::from(i / 10), 0.5);
        ledger.world.add_body(&ball(at)).unwrap();
        ledger.check("one more");
    }
    ledger.steps(30);
    for body in ledger.world.bodies().collect::<Vec<_>>() {
        ledger.world.remove_body(body).unwrap();
    }
    ledger.check("all are gone");
    ledger.steps(3);
    ledger.end();
}

/// Rare properties of bodies are counted, and go with them; other bodies are no larger for them.
#[test]
fn of_damping_targets_and_given_masses() {
    let mut ledger = Ledger::new(Settings::default());
    let world = &mut ledger.world;
    let bodies = world.add_bodies(&[ball(DVec3::ZERO), ball(DVec3::X * 3.0), ball(DVec3::X * 6.0)]).unwrap();
    ledger.start += (bodies.capacity() * size_of::<BodyHandle>()) as isize;
    ledger.check("just made");
    let before = ledger.world.memory().category(Category::Bodies).live;
    let bytes = |ledger: &Ledger| ledger.world.memory().category(Category::Bodies).live - before;
    ledger.world.set_damping(bodies[0], 0.5, 0.5).unwrap();
    // A slot and two numbers.
    assert_eq!(bytes(&ledger), 12);
    let mass = ledger.world.mass_properties(bodies[1]).unwrap();
    ledger.world.set_mass(bodies[1], mass).unwrap();
    assert_eq!(bytes(&ledger), 12);
    ledger.world.set_kind(bodies[1], BodyKind::Static).unwrap();
    // A slot, a mass and three moments.
    assert_eq!(bytes(&ledger), 12 + 20);
    ledger.world.set_kind(bodies[2], BodyKind::Kinematic).unwrap();
    ledger.world.move_kinematic(bodies[2], DVec3::Y, Quat::IDENTITY, DT).unwrap();
    assert!(bytes(&ledger) > 32);
    ledger.check("changed");
    ledger.steps(3);
    assert_eq!(bytes(&ledger), 32, "a target is for one step");
    for &body in &bodies {
        ledger.world.remove_body(body).unwrap();
    }
    ledger.steps(1);
    ledger.end();
}

#[test]
fn of_builtin_scenes() {
    for name in ["talk", "bullets", "bullets_box", "tall_stack", "chain"] {
        let (mut ledger, _bodies) = Ledger::of(|| builtin::build(name).unwrap(), Settings::default());
        ledger.steps(60);
        ledger.end();
    }
    let (mut ledger, _bodies) = Ledger::of(|| builtin::joint_grid(20), Settings::default());
    ledger.steps(30);
    ledger.end();
}

#[test]
fn of_hulls_compounds_and_a_height_field() {
    let mut ledger = Ledger::new(Settings::default());
    let world = &mut ledger.world;
    let heights = (0..33 * 33).map(|i| ((i * 7) % 11) as f32 * 0.02).collect();
    let field = HeightField::new(33, 33, backstop::glam::Vec2::ONE, heights).unwrap();
    let ground = BodyDesc::fixed().with_shape(ShapeDesc::new(Geometry::HeightField(Arc::new(field))));
    world.add_body(&ground).unwrap();
    drop(ground);
    let corners: Vec<Vec3> = (0..20)
        .map(|i| Quat::from_rotation_y(i as f32) * Quat::from_rotation_x(i as f32 * 0.7) * Vec3::Y * 0.4)
        .collect();
    let hull = Geometry::Hull(Arc::new(ConvexHull::new(&corners).unwrap()));
    drop(corners);
    for i in 0..40 {
        let mut body =
            BodyDesc::dynamic().with_position(DVec3::new(f64::from(i % 7), 2.0 + f64::from(i / 7), 0.3));
        for part in 0..1 + i % 5 {
            let mut shape =
                ShapeDesc::new(if part == 0 { hull.clone() } else { Geometry::cuboid(0.2, 0.1, 0.2) });
            shape.position = Vec3::X * part as f32 * 0.3;
            body = body.with_shape(shape);
        }
        world.add_body(&body).unwrap();
    }
    drop(hull);
    ledger.check("just made");
    ledger.steps(60);
    // Shapes come and go.
    let bodies: Vec<BodyHandle> = ledger.world.bodies().collect();
    ledger.start += (bodies.capacity() * size_of::<BodyHandle>()) as isize;
    for &body in &bodies[..20] {
        let more = ShapeDesc::new(Geometry::capsule(0.2, 0.1));
        let first = ledger.world.shapes(body).unwrap().next().unwrap();
        ledger.world.add_shape(body, &more).unwrap();
        ledger.check("a shape more");
        ledger.world.remove_shape(first).unwrap();
        ledger.check("a shape less");
    }
    ledger.steps(20);
    for &body in &bodies {
        ledger.world.remove_body(body).unwrap();
        ledger.check("a body less");
    }
    assert_eq!(ledger.world.memory().category(Category::Meshes).reserved, 0);
    ledger.end();
}

#[test]
fn of_ragdolls_that_lose_limbs() {
    let mut ledger = Ledger::new(Settings::default());
    let world = &mut ledger.world;
    world.add_body(&BodyDesc::fixed().with_shape(ShapeDesc::new(Geometry::Plane))).unwrap();
    let mut joints = Vec::new();
    for i in 0..12 {
        let at = DVec3::new(f64::from(i % 4) * 1.5, 2.0, f64::from(i / 4) * 1.5);
        let figure = Skeleton::humanoid().add_to(world, at, Quat::IDENTITY, Vec3::Y * -10.0).unwrap();
        joints.extend(figure.joints);
    }
    let mut kept = Vec::with_capacity(joints.len());
    kept.append(&mut joints);
    drop(joints);
    ledger.start += (kept.capacity() * size_of::<backstop::JointHandle>()) as isize;
    ledger.check("just made");
    ledger.steps(40);
    for joint in kept.iter().step_by(3) {
        ledger.world.remove_joint(*joint).unwrap();
        ledger.check("a joint less");
        ledger.world.step(DT).unwrap();
        ledger.check("after it");
    }
    ledger.end();
}

/// Elastic shapes with forces on them, solved after a group, listened to, in sensors, with hooks, asked
/// about, asleep and awake.
#[test]
fn of_all_that_a_world_can_do() {
    let settings = Settings::default().with_sleeping(true).with_sleep_time(0.1);
    let mut ledger = Ledger::new(settings);
    let world = &mut ledger.world;
    let shape = |geometry: Geometry| common::shape(geometry, Material::default().with_restitution(0.3));
    let (vertices, triangles) = Terrain::bumpy(20, 0.5).mesh();
    let mesh = backstop::TriangleMesh::new(vertices, triangles).unwrap();
    world.add_body(&BodyDesc::fixed().with_shape(shape(Geometry::Mesh(Arc::new(mesh))))).unwrap();
    let sensor = shape(Geometry::cuboid(3.0, 1.0, 3.0)).as_sensor();
    world.add_body(&BodyDesc::fixed().with_shape(sensor)).unwrap();
    let mut bodies = Vec::with_capacity(40);
    ledger.start += (bodies.capacity() * size_of::<BodyHandle>()) as isize;
    for i in 0..40 {
        let cube = shape(Geometry::cuboid(0.3, 0.3, 0.3)).with_events().with_hooks();
        let at = DVec3::new(f64::from(i % 6) - 2.5, 2.0 + f64::from(i / 6), 0.0);
        let mut body = BodyDesc::dynamic().with_position(at).with_shape(cube);
        if i % 9 == 0 {
            body.solved_after = Some(RowGroup::StaticContacts);
        }
        bodies.push(ledger.world.add_body(&body).unwrap());
        drop(body);
        ledger.check("one more");
    }
    let mut slept = 0;
    for step in 0..240u32 {
        let world = &mut ledger.world;
        let body = bodies[step as usize % bodies.len()];
        if step % 40 == 3 {
            world.add_force(body, Vec3::Y * 500.0).unwrap();
            world.set_body_solved_after(body, Some(RowGroup::Contacts)).unwrap();
        }
        if step > 100 && step % 10 == 0 {
            let ray = Ray::new(DVec3::new(0.1, 9.0, 0.0), Vec3::Y * -20.0);
            world.cast_ray(&ray, &QueryFilter::new()).unwrap();
            ledger.check("after a query");
        }
        let world = &mut ledger.world;
        world.step(DT).unwrap();
        slept = slept.max(world.sleeping_body_count());
        ledger.check(format_args!("step {step}"));
    }
    assert!(slept > 0, "nothing ever slept");
    for &body in &bodies {
        ledger.world.remove_body(body).unwrap();
        ledger.check("one less");
    }
    ledger.world.set_settings(Settings::default()).unwrap();
    ledger.steps(5);
    drop(bodies);
    ledger.start -= (40 * size_of::<BodyHandle>()) as isize;
    ledger.end();
}

/// A snapshot is the caller's while there is one. Restored state is counted like any other.
#[test]
fn of_a_world_that_goes_back() {
    let (mut ledger, bodies) = Ledger::of(common::small_pile, Settings::default());
    ledger.steps(20);
    let before = live();
    let mut snapshot = Snapshot::new();
    ledger.world.snapshot(&mut snapshot);
    ledger.start += live() - before;
    ledger.check("a snapshot");
    for &body in &bodies[50..200] {
        ledger.world.remove_body(body).unwrap();
    }
    ledger.steps(10);
    ledger.world.restore(&snapshot).unwrap();
    ledger.check("back");
    ledger.steps(40);
}

/// What threads of a pool ask for is on their own counters: a world is counted when it goes, which one thread
/// does.
#[test]
fn at_two_threads() {
    let pool = rayon::ThreadPoolBuilder::new().num_threads(2).build().unwrap();
    for steps in [0, 1, 10, 60] {
        for name in ["pile", "bullets", "talk"] {
            let scene = || if name == "pile" { common::small_pile() } else { builtin::build(name).unwrap() };
            let run = |threads: usize| {
                let (mut world, _) = common::world_of(&scene(), Settings::default().with_threads(threads));
                common::steps(&mut world, steps, DT);
                world
            };
            let world = pool.install(|| run(2));
            let report = world.memory();
            let before = live();
            drop(world);
            assert_eq!(before - live(), report.total() as isize, "{name} after {steps} steps: {report:?}");
            assert_eq!(report, run(1).memory(), "{name} after {steps} steps");
        }
    }
}
