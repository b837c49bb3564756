//! The methods of continuous collision side by side, on cases whose answers are known.

#![allow(clippy::disallowed_methods, reason = "expected values may use the platform's functions")]
use crate::common;

use ContinuousMethod::{ConservativeAdvancement, LinearCast, OnePass, Speculative, Talk};
use backstop::glam::{DVec3, Quat, Vec3};
use backstop::{
    BodyDesc, BodyHandle, Budget, ContinuousMethod, ContinuousMode, ConvexHull, Geometry, Material, Settings,
    ShapeDesc, Snapshot, World,
};
use backstop_scene::builtin;

const DT: f32 = 1.0 / 60.0;
const METHODS: [ContinuousMethod; 5] = [OnePass, Speculative, LinearCast, ConservativeAdvancement, Talk];

fn without_gravity(method: ContinuousMethod) -> World {
    World::new(Settings::default().with_continuous_method(method).with_gravity(Vec3::ZERO)).unwrap()
}

fn ball(radius: f32, at: DVec3, velocity: Vec3, restitution: f32) -> BodyDesc {
    let mut shape = ShapeDesc::new(Geometry::Sphere { radius });
    shape.material = Material::default().with_restitution(restitution).with_friction(0.0);
    BodyDesc::dynamic().with_position(at).with_velocity(velocity, Vec3::ZERO).with_shape(shape)
}

fn wall(half: Vec3, at: DVec3, restitution: f32) -> BodyDesc {
    let mut shape = ShapeDesc::new(Geometry::cuboid(half.x, half.y, half.z));
    shape.material = Material::default().with_restitution(restitution).with_friction(0.0);
    BodyDesc::fixed().with_position(at).with_shape(shape)
}

/// A bullet of 5 cm at 300 m/s, 5 m a step, and a wall of 1 cm: discrete physics misses it, all others stop
/// it.
#[test]
fn only_discrete_physics_lets_a_bullet_through_a_thin_wall() {
    let run = |continuous, method, start: f64| {
        let settings = Settings::default()
            .with_continuous(continuous)
            .with_continuous_method(method)
            .with_gravity(Vec3::ZERO);
        let mut world = World::new(settings).unwrap();
        world.add_body(&wall(Vec3::new(0.005, 5.0, 5.0), DVec3::ZERO, 0.0)).unwrap();
        let bullet = ball(0.05, DVec3::new(start, 0.1, 0.2), Vec3::X * 300.0, 0.0);
        let bullet = world.add_body(&bullet).unwrap();
        common::steps(&mut world, 20, DT);
        world.position(bullet).unwrap().x
    };
    for start in [-12.0, -11.3, -10.1, -7.77] {
        assert!(run(ContinuousMode::Discrete, OnePass, start) > 5.0);
        for method in METHODS {
            for continuous in [ContinuousMode::Segment, ContinuousMode::Volume] {
                let x = run(continuous, method, start);
                assert!(x < -0.054 && x > -0.07, "{method:?} {continuous:?} {start}: {x}");
            }
            // Switched off for the whole world, no method does anything.
            assert!(run(ContinuousMode::Discrete, method, start) > 5.0, "{method:?}");
        }
    }
}

/// A ball flies past the corner of a box, 0.3 m beside it, in zero gravity: it must keep its velocity to the
/// bit. Planes of the start of the step stop it: the ghost that speculative contacts are known for.
#[test]
fn only_speculative_contacts_push_what_passes_a_corner() {
    for method in METHODS {
        let mut world = without_gravity(method);
        world.add_body(&wall(Vec3::new(1.0, 0.1, 1.0), DVec3::ZERO, 0.0)).unwrap();
        // The box ends at x = 1; the ball passes at 1.3 with a radius of 0.1, going down.
        let velocity = Vec3::new(60.0, -60.0, 0.0);
        let passing = world.add_body(&ball(0.1, DVec3::new(0.65, 0.95, 0.0), velocity, 0.0)).unwrap();
        common::steps(&mut world, 3, DT);
        let now = world.linear_velocity(passing).unwrap();
        if method == Speculative {
            assert!((now - velocity).length() > 10.0, "{now}");
        } else {
            assert_eq!(now, velocity, "{method:?}");
        }
    }
}

/// A body of 5 cm, in one of four shapes.
fn bullet(shape: usize, at: DVec3, velocity: Vec3) -> BodyDesc {
    let corners = [-1.0f32, 1.0].map(|x| [-1.0f32, 1.0].map(|y| [-1.0f32, 1.0].map(|z| Vec3::new(x, y, z))));
    let corners: Vec<Vec3> = corners.into_iter().flatten().flatten().map(|corner| corner * 0.03).collect();
    let shape = ShapeDesc::new(match shape {
        0 => Geometry::Sphere { radius: 0.05 },
        1 => Geometry::capsule(0.03, 0.02),
        2 => Geometry::cuboid(0.05, 0.03, 0.02),
        _ => Geometry::Hull(std::sync::Arc::new(ConvexHull::new(&corners).unwrap())),
    });
    BodyDesc::dynamic().with_position(at).with_velocity(velocity, Vec3::ZERO).with_shape(shape)
}

/// A wall of 1 m by 1 m by 1 cm, and bullets that reach it straight on and aslant, from places that are not
/// over its face.
#[test]
fn the_talk_s_method_stops_what_meets_a_wall_that_has_an_end() {
    for shape in 0..4 {
        for (from, velocity) in [
            (Vec3::new(-4.0, 0.3, 0.2), Vec3::X * 300.0),
            (Vec3::new(-3.0, -3.2, 0.1), Vec3::new(300.0, 300.0, 0.0)),
            (Vec3::new(-1.5, 2.2, -1.3), Vec3::new(200.0, -300.0, 200.0)),
        ] {
            let mut world = without_gravity(Talk);
            world.add_body(&wall(Vec3::new(0.005, 0.5, 0.5), DVec3::ZERO, 0.0)).unwrap();
            let body = world.add_body(&bullet(shape, from.as_dvec3(), velocity)).unwrap();
            world.step(DT).unwrap();
            assert_eq!(world.report().casts, 0);
            let (x, v) = (world.position(body).unwrap().x, world.linear_velocity(body).unwrap());
            // Its extent across the wall is between 2 and 6 cm. An end that it met with pushes the rest of it
            // away or on.
            assert!((-0.3..=-0.02).contains(&x) && v.x < 30.0, "{shape} {from}: {x} {v}");
        }
    }
}

/// The ghost of speculative contacts: a bullet flies past the end of a wall, 10 to 20 cm beside it, through
/// the plane of the face. Nothing is there, so its path is the straight line.
#[test]
fn the_talk_s_method_lets_past_what_misses_the_end_of_a_wall() {
    let fly = |method, shape, from: Vec3, velocity: Vec3| {
        let mut world = without_gravity(method);
        world.add_body(&wall(Vec3::new(0.005, 0.5, 0.5), DVec3::ZERO, 0.0)).unwrap();
        let body = world.add_body(&bullet(shape, from.as_dvec3(), velocity)).unwrap();
        common::steps(&mut world, 3, DT);
        let straight = from.as_dvec3() + velocity.as_dvec3() * f64::from(3.0 * DT);
        (world.position(body).unwrap() - straight).length()
    };
    for shape in 0..4 {
        for (from, velocity) in [
            (Vec3::new(-1.0, 0.9, 0.2), Vec3::new(300.0, -72.0, 0.0)),
            (Vec3::new(-3.0, -2.3, 0.1), Vec3::new(300.0, 300.0, 0.0)),
            (Vec3::new(-1.5, 1.6, -1.3), Vec3::new(200.0, -300.0, 200.0)),
        ] {
            let off = fly(Talk, shape, from, velocity);
            assert!(off < 1e-4, "{shape} {from}: {off}");
            assert!(fly(Speculative, shape, from, velocity) > 0.5, "{shape} {from}");
        }
    }
}

/// Bodies fly between the posts: those that they pass must not turn them. A ghost is a body that is turned in
/// an earlier step than where impacts are met at their times.
#[test]
fn the_gates_of_the_talk_s_method_keep_ghosts_out_of_the_field_of_posts() {
    let scene = builtin::build("posts").unwrap();
    let turned_at = |method| {
        let (mut world, bodies) =
            common::world_of(&scene, Settings::default().with_continuous_method(method));
        let velocity = |world: &World| -> Vec<Vec3> {
            bodies.iter().map(|&body| world.linear_velocity(body).unwrap()).collect()
        };
        let start = velocity(&world);
        let mut first = vec![scene.steps; bodies.len()];
        for step in 0..scene.steps {
            world.step(DT).unwrap();
            for ((first, before), now) in first.iter_mut().zip(&start).zip(velocity(&world)) {
                // More than gravity gives in all steps to a body at 60 m/s.
                if (now - *before).length() > 0.1 * before.length() {
                    *first = step.min(*first);
                }
            }
        }
        first
    };
    let real = turned_at(ConservativeAdvancement);
    let ghosts = |method| turned_at(method).iter().zip(&real).filter(|(own, real)| own < real).count();
    let (talk, speculative) = (ghosts(Talk), ghosts(Speculative));
    println!("ghosts: talk {talk}, speculative {speculative}, one pass {}", ghosts(OnePass));
    assert!(speculative > 10 && talk * 4 < speculative, "{talk} {speculative}");
}

/// A blade of 2 m by 2 cm turns 0.6 of a turn in each step; a post stands in its way. Straight ahead nothing
/// is met, so a linear cast sees nothing, wherever the blade comes to stand at the end of each step.
#[test]
fn a_linear_cast_does_not_see_what_a_spinning_blade_strikes() {
    let struck = |method| {
        let mut world = without_gravity(method);
        let post = wall(Vec3::new(0.02, 0.5, 0.02), DVec3::new(0.0, 0.0, 0.8), 0.0);
        world.add_body(&post).unwrap();
        let spin = Vec3::Y * (0.6 * std::f32::consts::TAU / DT);
        let blade = BodyDesc::dynamic().with_velocity(Vec3::ZERO, spin);
        let blade = blade.with_shape(ShapeDesc::new(Geometry::cuboid(1.0, 0.05, 0.01)));
        let blade = world.add_body(&blade).unwrap();
        world.step(DT).unwrap();
        world.angular_velocity(blade).unwrap() != spin
    };
    assert!(struck(ConservativeAdvancement) && struck(OnePass));
    assert!(!struck(LinearCast));
}

/// A ball that falls on a plane elastically keeps its energy where impacts are met at their time.
#[test]
fn an_elastic_bounce_keeps_its_energy_under_both_methods_with_sub_steps() {
    for method in [LinearCast, ConservativeAdvancement] {
        let mut world = World::new(Settings::default().with_continuous_method(method)).unwrap();
        let mut floor = ShapeDesc::new(Geometry::Plane);
        floor.material = Material::default().with_restitution(1.0).with_friction(0.0);
        world.add_body(&BodyDesc::fixed().with_shape(floor)).unwrap();
        let body = world.add_body(&ball(0.2, DVec3::new(0.0, 5.2, 0.0), Vec3::ZERO, 1.0)).unwrap();
        let before = world.energy();
        let (mut worst, mut struck) = (0.0_f64, 0);
        for _ in 0..60 * 10 {
            world.step(DT).unwrap();
            struck += world.report().struck;
            // Within 2 cm of the plane it has a contact, which stops it first and sends it back in the next
            // step.
            if world.position(body).unwrap().y > 1.0 {
                worst = worst.max((world.energy() / before - 1.0).abs());
            }
        }
        // Falling 5 m and rising again takes 2.02 s: five bounces in 10 s.
        assert!((4..=5).contains(&struck), "{method:?}: {struck}");
        assert!(worst < 2e-3, "{method:?}: {worst}");
    }
}

/// Sphere against plane: the time of impact is (distance - radius) / speed, and the rest of the step is spent
/// going back.
#[test]
fn a_sphere_meets_a_plane_at_the_analytic_time() {
    for method in [LinearCast, ConservativeAdvancement] {
        for (height, speed) in [(1.0_f64, 90.0_f32), (0.35, 40.0), (2.0, 200.0), (0.3, 13.0)] {
            let mut world = without_gravity(method);
            let mut floor = ShapeDesc::new(Geometry::Plane);
            floor.material = Material::default().with_restitution(1.0).with_friction(0.0);
            world.add_body(&BodyDesc::fixed().with_shape(floor)).unwrap();
            let at = DVec3::new(0.0, height, 0.0);
            let body = world.add_body(&ball(0.1, at, Vec3::NEG_Y * speed, 1.0)).unwrap();
            world.step(DT).unwrap();
            let time = (height - 0.1) / f64::from(speed);
            assert!(time < f64::from(DT));
            let expected = 0.1 + (f64::from(DT) - time) * f64::from(speed);
            // Where it is tells when it turned: y = 0.1 + speed (dt - t).
            let y = world.position(body).unwrap().y;
            let error = (y - expected).abs() / (2.0 * f64::from(speed * DT));
            assert!(error < 1e-4, "{method:?} {height} {speed}: {y} for {expected}");
            assert!((world.linear_velocity(body).unwrap().y - speed).abs() < 1e-3);
        }
    }
}

/// Two like balls that meet head on swap their velocities, and each goes on with the other's for what is left
/// of the step.
#[test]
fn two_balls_that_meet_swap_their_velocities_at_the_time_they_meet() {
    for method in [LinearCast, ConservativeAdvancement] {
        let mut world = without_gravity(method);
        let add = |world: &mut World, x: f64, speed: f32| {
            world.add_body(&ball(0.1, DVec3::X * x, Vec3::X * speed, 1.0)).unwrap()
        };
        let (a, b) = (add(&mut world, -0.6, 60.0), add(&mut world, 0.8, -30.0));
        world.step(DT).unwrap();
        // They close 1.2 m at 90 m/s: after 1/75 s, at -0.6 + 0.8 = 0.2 less the radius.
        let (p, q) = (world.position(a).unwrap().x, world.position(b).unwrap().x);
        let left = f64::from(DT) - 1.2 / 90.0;
        assert!((p - (0.2 - 30.0 * left)).abs() < 1e-3, "{method:?} {p}");
        assert!((q - (0.4 + 60.0 * left)).abs() < 1e-3, "{method:?} {q}");
        assert!((world.linear_velocity(a).unwrap().x + 30.0).abs() < 1e-3);
    }
}

/// A ball between two walls 0.5 m apart at 300 m/s crosses the gap of 0.4 m 12 times in a step: 8 sub-steps
/// don't suffice, 64 do.
#[test]
fn who_is_struck_too_often_loses_the_rest_of_the_step() {
    let run = |method| {
        let mut world = without_gravity(method);
        for x in [-0.26, 0.26] {
            world.add_body(&wall(Vec3::new(0.01, 1.0, 1.0), DVec3::X * x, 1.0)).unwrap();
        }
        let body = world.add_body(&ball(0.05, DVec3::ZERO, Vec3::X * 300.0, 1.0)).unwrap();
        let mut stood = 0;
        for _ in 0..10 {
            world.step(DT).unwrap();
            stood += world.report().stood;
            assert!(world.position(body).unwrap().x.abs() < 0.2001);
        }
        (stood, world.linear_velocity(body).unwrap().x.abs())
    };
    let (stood, speed) = run(LinearCast);
    assert!(stood == 10 && (speed - 300.0).abs() < 0.1, "{stood} {speed}");
    let (stood, speed) = run(ConservativeAdvancement);
    assert!(stood == 0 && (speed - 300.0).abs() < 0.1, "{stood} {speed}");
}

fn hash_after(method: ContinuousMethod, threads: usize) -> (u64, u32) {
    let mut scene = builtin::bullets(true);
    for body in &mut scene.bodies {
        body.desc.shapes.iter_mut().for_each(|s| s.material.restitution = 0.5);
    }
    let (mut world, _) =
        common::world_of(&scene, Settings::default().with_threads(threads).with_continuous_method(method));
    let mut struck = 0;
    for _ in 0..30 {
        world.step(DT).unwrap();
        struck += world.report().struck;
    }
    assert!(common::all_finite(&world));
    (world.state_hash(), struck)
}

#[test]
fn any_number_of_threads_gives_the_same_bits() {
    for method in [Speculative, LinearCast, ConservativeAdvancement, Talk] {
        let (alone, struck) = hash_after(method, 1);
        assert_eq!(
            struck > 500,
            matches!(method, LinearCast | ConservativeAdvancement),
            "{method:?} {struck}"
        );
        for threads in [2, 3] {
            let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
            assert_eq!(pool.install(|| hash_after(method, threads).0), alone, "{method:?} {threads}");
        }
    }
}

/// The method is part of a snapshot, and nothing else of it lasts from step to step.
#[test]
fn a_snapshot_keeps_the_method_and_its_future() {
    for method in METHODS {
        let scene = builtin::talk();
        let (mut world, _) = common::world_of(&scene, Settings::default().with_continuous_method(method));
        common::steps(&mut world, 20, DT);
        let mut snapshot = Snapshot::new();
        world.snapshot(&mut snapshot);
        common::steps(&mut world, 20, DT);
        let hash = world.state_hash();
        let (mut other, _) = common::world_of(&scene, Settings::default());
        other.restore(&snapshot).unwrap();
        assert_eq!(other.settings().continuous_method, method);
        common::steps(&mut other, 20, DT);
        assert_eq!(other.state_hash(), hash, "{method:?}");
    }
}

/// Nothing of the method stays: a world that used another one for a while goes on under the default.
#[test]
fn the_method_may_be_changed_between_steps() {
    let (mut world, bodies) = common::world_of(&builtin::talk(), Settings::default());
    for step in 0..120_usize {
        let method = METHODS[step % METHODS.len()];
        world.set_settings(world.settings().clone().with_continuous_method(method)).unwrap();
        world.step(DT).unwrap();
    }
    assert!(common::all_finite(&world));
    let ground = builtin::talk_terrain();
    let under = |&body: &BodyHandle| {
        let at = world.position(body).unwrap().as_vec3();
        ground.contains(at.x, at.z) && at.y < ground.height(at.x, at.z)
    };
    assert!(!bodies.iter().skip(1).any(under));
}

/// Within a budget that is far too small for all touches of a step, some are left out and nothing else goes
/// wrong.
#[test]
fn within_a_budget_touches_are_left_out() {
    for method in [LinearCast, ConservativeAdvancement] {
        let scene = builtin::bullets(true);
        // Half of the bytes that the steps would take, on top of those of the bodies.
        let mut half = None;
        for _ in 0..2 {
            let settings =
                Settings::default().with_continuous_method(method).with_budget(Budget::total(1 << 30));
            let (mut world, _) = common::world_of(&scene, settings);
            let empty = world.memory().total();
            let budget = half.unwrap_or(1 << 30);
            world.set_settings(world.settings().clone().with_budget(Budget::total(budget))).unwrap();
            let mut shed = 0;
            for _ in 0..20 {
                world.step(DT).unwrap();
                assert!(world.memory().total() <= budget, "{method:?}");
                shed += world.report().shed;
            }
            assert!(common::all_finite(&world));
            assert_eq!(shed > 0, half.is_some(), "{method:?}: {shed}");
            half = Some(empty + (world.memory().total() - empty) / 2);
        }
    }
}

/// A shape off its body's centre, and a turned one: the arms are those of the body.
#[test]
fn a_dumbbell_that_is_struck_at_one_end_turns() {
    for method in METHODS {
        let mut world = without_gravity(method);
        let end = |x: f32| {
            let mut shape = ShapeDesc::new(Geometry::Sphere { radius: 0.1 });
            shape.position = Vec3::X * x;
            shape
        };
        let dumbbell = BodyDesc::dynamic().with_shape(end(-0.5)).with_shape(end(0.5));
        let dumbbell = world.add_body(&dumbbell.with_rotation(Quat::from_rotation_z(0.3))).unwrap();
        let at = DVec3::new(0.5 * 0.3_f64.cos(), 0.5 * 0.3_f64.sin() + 1.0, 0.0);
        world.add_body(&ball(0.1, at, Vec3::NEG_Y * 100.0, 0.0)).unwrap();
        common::steps(&mut world, 2, DT);
        let (v, w) = (world.linear_velocity(dumbbell).unwrap(), world.angular_velocity(dumbbell).unwrap());
        assert!(v.y < -5.0 && w.z < -10.0, "{method:?} {v} {w}");
    }
}
