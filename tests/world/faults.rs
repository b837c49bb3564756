//! A body whose motion is not finite stands where it was and is named, and the others go on without it.

use crate::common;

use crate::common::random::Random;
use backstop::glam::{DVec3, Quat, Vec3};
use backstop::limits::MAX_FORCE;
use backstop::{
    BodyDesc, BodyHandle, ContactHook, ContactHooks, ContinuousMethod, Frame, Geometry, JointDesc,
    MassProperties, Material, Settings, ShapeDesc, World,
};

const DT: f32 = 1.0 / 60.0;

fn cube(at: DVec3) -> BodyDesc {
    BodyDesc::dynamic().with_position(at).with_shape(ShapeDesc::new(Geometry::cuboid(0.5, 0.5, 0.5)))
}

/// Three stacks of three, side by side.
fn stacks(settings: Settings) -> (World, Vec<BodyHandle>) {
    let mut world = World::new(settings).unwrap();
    world.add_body(&common::Floor::Box.desc(Material::default())).unwrap();
    let at = |i: i32| DVec3::new(f64::from(i / 3) * 1.02, f64::from(i % 3) + 0.5, 0.0);
    let bodies = (0..9).map(|i| world.add_body(&cube(at(i))).unwrap()).collect();
    common::steps(&mut world, 120, DT);
    (world, bodies)
}

/// The force is at the limit of the allowed range: a ton would be out of the world within a step.
/// Expected: it stays exactly where it was, at rest; the stack on it and those beside it, which it touches,
/// do not notice.
#[test]
fn a_force_beyond_all_bounds_stops_its_body_and_no_other() {
    for (which, force) in [(0, Vec3::X), (1, Vec3::X), (4, Vec3::NEG_Y), (2, Vec3::Y)] {
        let (mut world, bodies) = stacks(Settings::default());
        let places: Vec<DVec3> = bodies.iter().map(|&body| world.position(body).unwrap()).collect();
        world.add_force(bodies[which], force * MAX_FORCE).unwrap();
        let report = *world.step(DT).unwrap();
        assert_eq!((report.faulted, world.faulted_bodies()), (1, &[bodies[which]][..]));
        assert_eq!(world.position(bodies[which]).unwrap(), places[which]);
        assert_eq!(world.linear_velocity(bodies[which]).unwrap(), Vec3::ZERO);
        for step in 0..60 {
            assert!(common::all_finite(&world));
            for (&body, place) in bodies.iter().zip(&places) {
                let moved = world.position(body).unwrap().distance(*place);
                assert!(moved < 2e-3, "force on {which}, step {step}: {moved}");
            }
            assert_eq!(world.step(DT).unwrap().faulted, 0);
            assert!(world.faulted_bodies().is_empty());
        }
    }
}

/// A torque is not in the predicted motion, only in the acceleration.
#[test]
fn a_torque_beyond_all_bounds_stops_its_body() {
    let (mut world, bodies) = stacks(Settings::default());
    world.add_torque(bodies[8], Vec3::X * MAX_FORCE).unwrap();
    let at = (world.position(bodies[8]).unwrap(), world.rotation(bodies[8]).unwrap());
    assert_eq!(world.step(DT).unwrap().faulted, 1);
    assert_eq!((world.position(bodies[8]).unwrap(), world.rotation(bodies[8]).unwrap()), at);
}

/// Bodies that a fault is joined to: the joint acts as one to a static body while it stands still, and comes
/// back with it.
#[test]
fn what_is_joined_to_a_fault_hangs_on_what_stands_still() {
    let mut world = World::new(Settings::default()).unwrap();
    let [top, low] = [1.0, -1.0].map(|y| world.add_body(&cube(DVec3::Y * y)).unwrap());
    let hook = world.add_body(&BodyDesc::fixed().with_position(DVec3::Y * 2.0)).unwrap();
    let frames = |a: f32, b: f32| [Frame::at(Vec3::Y * a), Frame::at(Vec3::Y * b)];
    world.add_joint(&JointDesc::ball([hook, top], frames(0.0, 1.0))).unwrap();
    world.add_joint(&JointDesc::ball([top, low], frames(-1.0, 1.0))).unwrap();
    common::steps(&mut world, 30, DT);
    for _ in 0..20 {
        world.add_force(top, Vec3::X * MAX_FORCE).unwrap();
        world.step(DT).unwrap();
        assert_eq!(world.faulted_bodies(), [top]);
    }
    common::steps(&mut world, 30, DT);
    assert!(world.position(low).unwrap().distance(DVec3::Y * -1.0) < 1e-2);
    assert!(world.position(top).unwrap().distance(DVec3::Y) < 1e-2);
}

/// The lightest body there may be, joined to ones of a ton by joints that can't all hold: the results are
/// finite, and a stack beside it stands.
#[test]
fn joints_that_make_no_numbers_stop_what_they_join() {
    let (mut world, bodies) = stacks(Settings::default());
    let light = MassProperties { mass: 1e-30, centre_of_mass: Vec3::ZERO, inertia: glam_diagonal(1e-36) };
    let mut joined = Vec::new();
    for i in 0..6 {
        let mut desc = cube(DVec3::new(20.0 + f64::from(i % 3), 1.0 + f64::from(i / 3), 0.0));
        if i % 2 == 0 {
            desc.mass = Some(light);
        }
        joined.push(world.add_body(&desc.with_velocity(Vec3::Z * 9e5, Vec3::ONE * 9e5)).unwrap());
    }
    for i in 0..6 {
        for k in 0..i {
            let frames = [Frame::at(Vec3::new(3.0, 0.0, i as f32)), Frame::at(Vec3::new(0.0, k as f32, 1.0))];
            world.add_joint(&JointDesc::fixed([joined[i], joined[k]], frames)).unwrap();
        }
    }
    let place = world.position(bodies[5]).unwrap();
    for _ in 0..120 {
        let stopped = world.step(DT).unwrap().faulted;
        assert_eq!(stopped as usize, world.faulted_bodies().len());
        assert!(common::all_finite(&world));
    }
    assert!(world.position(bodies[5]).unwrap().distance(place) < 1e-3);
}

fn glam_diagonal(x: f32) -> backstop::glam::Mat3 {
    backstop::glam::Mat3::from_diagonal(Vec3::splat(x))
}

/// Asks for the most that a hook may.
struct Greedy;

impl ContactHooks for Greedy {
    fn contact(&self, contact: &mut ContactHook<'_>) {
        contact.set_friction(f32::MAX, f32::MAX).unwrap();
        contact.set_restitution(1.0).unwrap();
        contact.set_surface_velocity(0, Vec3::ONE * 1e6).unwrap();
    }
}

#[test]
fn what_a_hook_asks_for_leaves_numbers() {
    let (mut world, bodies) = stacks(Settings::default());
    for &body in &bodies[..3] {
        let shape = world.shapes(body).unwrap().next().unwrap();
        world.set_events(shape, true).unwrap();
        world.set_hooks(shape, true).unwrap();
    }
    for _ in 0..120 {
        world.step_with(DT, &Greedy).unwrap();
        assert!(common::all_finite(&world));
    }
}

/// Faults in one world and none in another that lacks the body: distant bodies have the same bits, at any
/// number of threads.
#[test]
fn faults_do_not_depend_on_threads() {
    let run = |threads: usize| {
        let mut scene = backstop_scene::builtin::pile();
        scene.bodies.truncate(5 + 300);
        let (mut world, bodies) = common::world_of(&scene, Settings::default().with_threads(threads));
        (0..120)
            .map(|step: usize| {
                if step % 7 == 3 {
                    let body = bodies[10 + step];
                    world.add_force(body, Vec3::new(1.0, -1.0, 0.3) * MAX_FORCE).unwrap();
                }
                let report = *world.step(DT).unwrap();
                assert!(common::all_finite(&world));
                (world.state_hash(), report.faulted, world.faulted_bodies().to_vec())
            })
            .collect::<Vec<_>>()
    };
    let alone = run(1);
    assert!(alone.iter().filter(|(_, stopped, _)| *stopped == 1).count() >= 17);
    assert!(alone == run(2) && alone == run(3));
}

/// A panic in a hook: through the step, and from then on an error; a snapshot of a whole state mends it.
#[test]
fn a_hook_that_panics_poisons_the_world_until_it_is_restored() {
    struct Panics;
    impl ContactHooks for Panics {
        fn contact(&self, _: &mut ContactHook<'_>) {
            panic!("a hook's own");
        }
    }
    let (mut world, bodies) = stacks(Settings::default());
    let shape = world.shapes(bodies[3]).unwrap().next().unwrap();
    world.set_events(shape, true).unwrap();
    world.set_hooks(shape, true).unwrap();
    let mut saved = backstop::Snapshot::new();
    world.snapshot(&mut saved);
    let (before, bytes) = (world.state_hash(), saved.to_bytes());
    let poison = |world: &mut World| {
        let step = || world.step_with(DT, &Panics).map(drop);
        assert!(std::panic::catch_unwind(std::panic::AssertUnwindSafe(step)).is_err());
        for _ in 0..3 {
            let refused = world.step(DT).map(drop);
            assert_eq!(refused, Err(backstop::Error::Poisoned { stage: "narrow" }));
        }
        let mut half = backstop::Snapshot::new();
        world.snapshot(&mut half);
        assert!(world.restore(&half).is_err());
    };
    let expected = {
        let (mut other, _) = stacks(Settings::default());
        other.restore(&saved).unwrap();
        common::steps(&mut other, 30, DT);
        other.state_hash()
    };
    for snapshot in [saved, backstop::Snapshot::from_bytes(&bytes).unwrap()] {
        poison(&mut world);
        world.restore(&snapshot).unwrap();
        assert_eq!(world.state_hash(), before);
        common::steps(&mut world, 30, DT);
        assert_eq!(world.state_hash(), expected);
    }
    // Calls that do not step it still work.
    poison(&mut world);
    world.remove_body(bodies[3]).unwrap();
    world.add_body(&cube(DVec3::Y * 9.0)).unwrap();
    assert!(world.step(DT).is_err());
}

/// Pairs of bodies on a ball joint, run over by a half space that spins at up to 1e5 rad/s: where it meets
/// them it moves at up to 1e6 m/s, and so do they afterwards. Impacts that are met at their times left
/// velocities of 1e20 m/s and a position of NaN. Expected: finite numbers; stopped bodies are named, and
/// others are within twice the greatest speed that a caller may set.
#[test]
fn impacts_with_what_spins_beyond_reason_leave_numbers() {
    let mut stopped = 0;
    for seed in 0..if crate::common::wide() { 60 } else { 20 } {
        let mut random = Random(seed);
        let method =
            [ContinuousMethod::ConservativeAdvancement, ContinuousMethod::LinearCast][seed as usize % 2];
        let mut world = World::new(Settings::default().with_continuous_method(method)).unwrap();
        let place = |random: &mut Random| -> DVec3 {
            Vec3::from_array([0; 3].map(|_| random.range(-2.0, 2.0))).as_dvec3()
        };
        for _ in 0..3 {
            let points = [place(&mut random), place(&mut random)];
            let pair = points.map(|at| world.add_body(&cube(at)).unwrap());
            let frames = world.frames_at(pair, points[0].midpoint(points[1]), Quat::IDENTITY).unwrap();
            world.add_joint(&JointDesc::ball(pair, frames)).unwrap();
        }
        let spin = Vec3::new(random.range(1e3, 1e5), random.range(-9.0, 9.0), -6.0);
        let plane = ShapeDesc::new(Geometry::plane())
            .with_material(Material::default().with_restitution(0.5).with_friction(1.0));
        let plane = BodyDesc::kinematic()
            .with_position(place(&mut random))
            .with_velocity(Vec3::splat(-4.0), spin)
            .with_shape(plane);
        world.add_body(&plane).unwrap();
        for step in 0..120 {
            stopped += world.step(1.0 / 30.0).unwrap().faulted;
            for body in world.bodies() {
                let (at, v) = (world.position(body).unwrap(), world.linear_velocity(body).unwrap());
                let w = world.angular_velocity(body).unwrap();
                let told = format!("seed {seed}, step {step}: {at} {v} {w}");
                assert!(at.is_finite() && world.rotation(body).unwrap().is_finite(), "{told}");
                assert!(v.abs().max_element() <= 2e6 && w.abs().max_element() <= 2e6, "{told}");
            }
        }
    }
    assert!(stopped > 0, "no impact was out of range");
}
