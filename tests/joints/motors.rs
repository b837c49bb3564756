//! Motors move all bodies behind their joint from the first step: as the torque allows until they have their
//! speed, then at that.

#![allow(clippy::disallowed_methods, reason = "expected values may use the platform's functions")]

use crate::common::G;
use crate::common::random::Random;
use backstop::glam::{DVec3, Quat, Vec3};
use backstop::{
    Axes, Axis, BodyDesc, BodyHandle, Geometry, JointDesc, JointHandle, Limit, Motion, Motor, Settings,
    ShapeDesc, World,
};
use std::f32::consts::FRAC_PI_2;

fn world(substeps: u32) -> World {
    World::new(Settings::default().with_substeps(substeps).with_sleeping(false)).unwrap()
}

fn body(world: &mut World, geometry: Geometry, mass: f32, at: DVec3) -> BodyHandle {
    let desc = BodyDesc::dynamic().with_position(at).with_shape(ShapeDesc::new(geometry).with_density(1.0));
    let body = world.add_body(&desc).unwrap();
    let unit = world.mass(body).unwrap();
    world.remove_body(body).unwrap();
    let mut desc = desc;
    desc.shapes[0].density = mass / unit;
    // Nothing here touches.
    desc.shapes[0].filter.mask = 0;
    world.add_body(&desc).unwrap()
}

/// A hinge at a point, about the world's z, with or without a motor.
fn hinge(world: &mut World, bodies: [BodyHandle; 2], at: DVec3, motor: Option<(f32, f32)>) -> JointHandle {
    let axes = Quat::from_rotation_y(-FRAC_PI_2);
    let frames = world.frames_at(bodies, at, axes).unwrap();
    let mut desc = JointDesc::hinge(bodies, frames);
    if let Some((speed, torque)) = motor {
        desc = desc.with_motor(Motor::velocity(Motion::Angular, Axis::X, speed, torque));
    }
    world.add_joint(&desc).unwrap()
}

const CASES: [(u32, u32); 6] = [(60, 4), (30, 4), (120, 4), (60, 1), (60, 2), (60, 8)];

/// A ball at the end of a massless lever that starts level, and a motor with twice the torque that holds it
/// there. The ball is never slower than what the torque less the weight gives, I w' = M - m g l cos(angle),
/// and never faster than asked for; and it is never off the speed asked for once it had it.
#[test]
fn a_motor_lifts_a_ball_on_a_lever() {
    let mut wrong = Vec::new();
    for (hertz, substeps) in CASES {
        for (mass, length, radius) in [(10.0_f64, 1.0_f64, 0.1_f64), (0.1, 0.1, 0.005), (500.0, 4.0, 1.0)] {
            for speed in [0.5_f64, 2.0, -0.5] {
                let mut world = world(substeps);
                let ground = world.add_body(&BodyDesc::fixed()).unwrap();
                let sphere = Geometry::Sphere { radius: radius as f32 };
                let ball = body(&mut world, sphere, mass as f32, DVec3::X * length);
                let torque = 2.0 * mass * G * length;
                hinge(&mut world, [ground, ball], DVec3::ZERO, Some((speed as f32, torque as f32)));
                let inertia = mass * (length * length + 0.4 * radius * radius);
                let (mut expected, mut angle, mut worst) = (0.0_f64, 0.0_f64, 0.0_f64);
                let dt = 1.0 / f64::from(hertz);
                for _ in 0..10 * hertz {
                    world.step(dt as f32).unwrap();
                    for _ in 0..100 {
                        let give = dt / 100.0 / inertia;
                        let weight = mass * G * length * angle.cos();
                        let free = expected - weight * give;
                        expected = free + (speed - free).clamp(-torque * give, torque * give);
                        angle += expected * dt / 100.0;
                    }
                    let found = f64::from(world.angular_velocity(ball).unwrap().z);
                    worst = worst.max((found - expected).abs() / speed.abs());
                }
                println!("{hertz} Hz x {substeps}, {mass} kg at {length} m to {speed} rad/s: {worst:.4}");
                if worst > 0.01 {
                    wrong.push((hertz, substeps, mass, speed, worst));
                }
            }
        }
    }
    assert!(wrong.is_empty(), "{wrong:?}");
}

/// An arm of several links, each held straight by a motor at speed zero, lifted by the one at the shoulder
/// with twice the torque that holds the level arm. The others have ten times what holds their part: twice is
/// not enough while the arm gets faster, as a rod that is lifted at its end bends back. It turns as one: the
/// links have the speed of the shoulder.
#[test]
fn motors_lift_an_arm_of_several_links() {
    let mut wrong = Vec::new();
    for (hertz, substeps) in CASES {
        for (links, load) in [(2, 1.0_f64), (3, 1.0), (3, 10.0), (5, 1.0)] {
            let mut world = world(substeps);
            let ground = world.add_body(&BodyDesc::fixed()).unwrap();
            let mut last = ground;
            let (length, speed) = (0.5, 0.5);
            let mut all = Vec::new();
            for i in 0..links {
                let end = i + 1 == links;
                let mass = if end { load } else { 1.0 };
                let at = DVec3::X * (length * (f64::from(i) + 0.5));
                let link =
                    body(&mut world, Geometry::cuboid(0.5 * length as f32, 0.05, 0.05), mass as f32, at);
                // Bodies beyond the hinge: weights times their arms.
                let moment: f64 = (i..links)
                    .map(|k| {
                        (if k + 1 == links { load } else { 1.0 }) * G * length * (f64::from(k - i) + 0.5)
                    })
                    .sum();
                let motor = if i == 0 { (speed, 2.0 * moment as f32) } else { (0.0, 10.0 * moment as f32) };
                hinge(&mut world, [last, link], DVec3::X * (length * f64::from(i)), Some(motor));
                all.push(link);
                last = link;
            }
            let dt = 1.0 / hertz as f32;
            let mut worst = 0.0_f32;
            for step in 0..3 * hertz {
                world.step(dt).unwrap();
                // Twice the torque: as much again as the weight accelerates it, by at least 3 g / (2 L) of a
                // rod; it has its speed after.
                let started = 3.0 * G as f32 / (2.0 * (links as f32 * length as f32)) * 0.5;
                for &link in &all {
                    let w = world.angular_velocity(link).unwrap().z;
                    let least = (started * dt * (step + 1) as f32).min(speed);
                    worst = worst.max((least - w).max(w - speed) / speed);
                }
            }
            println!("{hertz} Hz x {substeps}, {links} links, load {load}: {worst:.4}");
            if worst > 0.02 {
                wrong.push((hertz, substeps, links, load, worst));
            }
        }
    }
    assert!(wrong.is_empty(), "{wrong:?}");
}

/// A crank and a rocker: crank 0.2 m, coupler 0.6 m, rocker 0.4 m, ground 0.6 m (Grashof: the crank goes
/// round). A motor with plenty of torque turns the crank at its speed in every step, and the loop stays
/// closed.
#[test]
fn a_motor_turns_a_four_bar_linkage() {
    let mut wrong = Vec::new();
    for (hertz, substeps) in CASES {
        for (speed, scale) in [(2.0_f32, 1.0_f64), (6.0, 1.0), (2.0, 0.1)] {
            let mut world = world(substeps);
            let ground = world.add_body(&BodyDesc::fixed()).unwrap();
            // The crank points up; where coupler and rocker meet follows from two circles.
            let (a, b, c, d) = (0.2_f64, 0.6_f64, 0.4_f64, 0.6_f64);
            let (o, p, q) = (DVec3::ZERO, DVec3::new(0.0, a, 0.0), DVec3::new(d, 0.0, 0.0));
            let (between, along) = ((q - p).length(), (q - p).normalize());
            let x = (b * b - c * c + between * between) / (2.0 * between);
            let r = p + along * x + DVec3::new(-along.y, along.x, 0.0) * (b * b - x * x).sqrt();
            let bar = |world: &mut World, from: DVec3, to: DVec3| {
                let (way, middle) = ((to - from) * scale, (from + to) * (0.5 * scale));
                let half = 0.5 * way.length() as f32;
                let geometry = Geometry::cuboid(half, 0.1 * half, 0.1 * half);
                let mass = (4.0 * half / scale as f32) * (scale * scale * scale) as f32;
                let desc = BodyDesc::dynamic()
                    .with_position(middle)
                    .with_rotation(Quat::from_rotation_z(way.y.atan2(way.x) as f32))
                    .with_shape(ShapeDesc::new(geometry));
                let body = world.add_body(&desc).unwrap();
                let unit = world.mass(body).unwrap();
                world.remove_body(body).unwrap();
                let mut desc = desc;
                desc.shapes[0].density *= mass / unit;
                desc.shapes[0].filter.mask = 0;
                world.add_body(&desc).unwrap()
            };
            let bars = [bar(&mut world, o, p), bar(&mut world, p, r), bar(&mut world, r, q)];
            let joints = [
                hinge(&mut world, [ground, bars[0]], o * scale, Some((speed, 1000.0))),
                hinge(&mut world, [bars[0], bars[1]], p * scale, None),
                hinge(&mut world, [bars[1], bars[2]], r * scale, None),
                hinge(&mut world, [bars[2], ground], q * scale, None),
            ];
            let (mut worst, mut open, mut mean) = (0.0_f32, 0.0_f64, 0.0_f32);
            for _ in 0..10 * hertz {
                world.step(1.0 / hertz as f32).unwrap();
                let w = world.angular_velocity(bars[0]).unwrap().z;
                worst = worst.max((w - speed).abs() / speed);
                mean += w / (10 * hertz) as f32;
                for joint in joints {
                    let [(a, _), (b, _)] = world.joint_frames(joint).unwrap();
                    open = open.max((a - b).length() / scale);
                }
            }
            println!(
                "{hertz} Hz x {substeps}, {speed} rad/s, x {scale}: off by {worst:.4}, mean {mean:.4}, open {open:.2e}"
            );
            if !(worst < 0.02 && open < 1e-3) {
                wrong.push((hertz, substeps, speed, scale, worst, open));
            }
        }
    }
    assert!(wrong.is_empty(), "{wrong:?}");
}

/// A motor acts on both bodies: two that nothing else holds keep their momentum of zero.
#[test]
fn a_motor_between_two_free_bodies_makes_no_momentum() {
    let mut world = World::new(Settings::default().with_gravity(Vec3::ZERO).with_sleeping(false)).unwrap();
    let one = body(&mut world, Geometry::Sphere { radius: 0.3 }, 10.0, DVec3::ZERO);
    let other = body(&mut world, Geometry::Sphere { radius: 0.2 }, 1.0, DVec3::X);
    hinge(&mut world, [one, other], DVec3::X * 0.2, Some((3.0, 5.0)));
    for _ in 0..600 {
        world.step(1.0 / 60.0).unwrap();
        let momentum = world.linear_velocity(one).unwrap() * 10.0 + world.linear_velocity(other).unwrap();
        assert!(momentum.length() < 1e-3, "{momentum}");
    }
    let turn = world.angular_velocity(other).unwrap().z - world.angular_velocity(one).unwrap().z;
    assert!((turn - 3.0).abs() < 0.01, "{turn}");
}

/// A motor drives its joint to the end of its range and holds it there, however strong it is: expected is the
/// range, to a millimetre and a fifth of a degree. A motor without a bound was 30 m beyond a stop at 1 m.
#[test]
fn a_motor_stops_where_its_range_ends() {
    const SEEDS: u64 = 300;
    let mut wrong = Vec::new();
    for seed in 0..SEEDS {
        let mut random = Random(seed);
        let hertz = random.of(&[30.0_f32, 60.0, 120.0, 240.0]);
        let (substeps, trees) = (random.of(&[1, 2, 4, 8]), random.chance(0.75));
        let settings = Settings::default().with_gravity(Vec3::ZERO).with_substeps(substeps);
        let mut world = World::new(settings.with_joint_trees(trees)).unwrap();
        let (motion, within) = if random.chance(0.5) {
            (Motion::Linear, 0.001)
        } else {
            (Motion::Angular, 0.2_f32.to_radians())
        };
        let (masses, range) = (
            [random.log_range(0.1, 100.0), random.log_range(0.1, 100.0)],
            [-random.log_range(0.1, 2.5), random.log_range(0.1, 2.5)],
        );
        let (speed, force) = (random.log_range(0.5, 20.0), random.log_range(1e4, 1e12));
        let force = if force > 1e9 { f32::INFINITY } else { force };
        let speed = if random.chance(0.5) { speed } else { -speed };
        let part =
            |world: &mut World, mass: f32| body(world, Geometry::cuboid(0.2, 0.3, 0.25), mass, DVec3::ZERO);
        let other = if random.chance(0.5) {
            world.add_body(&BodyDesc::fixed()).unwrap()
        } else {
            part(&mut world, masses[0])
        };
        let pair = [other, part(&mut world, masses[1])];
        let frames = world.frames_at(pair, DVec3::ZERO, Quat::IDENTITY).unwrap();
        let joint = match motion {
            Motion::Linear => JointDesc::slider(pair, frames),
            Motion::Angular => JointDesc::hinge(pair, frames),
        };
        let axes = Axes::One(Axis::X);
        let joint = joint
            .with_limit(Limit::new(motion, axes, range[0], range[1]))
            .with_motor(Motor::velocity(motion, Axis::X, speed, force));
        let joint = world.add_joint(&joint).unwrap();
        let (mut low, mut high, mut at) = (0.0_f32, 0.0_f32, 0.0);
        for _ in 0..(8.0 * hertz) as u32 {
            world.step(1.0 / hertz).unwrap();
            at = world.joint_position(joint, motion, axes).unwrap();
            (low, high) = (low.min(at), high.max(at));
        }
        let stop = if speed > 0.0 { range[1] } else { range[0] };
        let over = (high - range[1]).max(range[0] - low);
        if over > within || (at - stop).abs() > within {
            wrong.push(format!(
                "{seed}: {motion:?} {range:?} at {speed} with {force:e}, {hertz} Hz x {substeps}, trees {trees}: \
                 {over} beyond, at {at} for {stop}"
            ));
        }
    }
    assert!(wrong.is_empty(), "{} of {SEEDS}: {wrong:#?}", wrong.len());
}
