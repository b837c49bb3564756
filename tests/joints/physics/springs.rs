//! Springs, motors and friction in joints.

use super::*;

/// alpha = m g l / (I + m l²).
#[test]
fn a_door_falls_as_its_inertia_says() {
    let inertia = 0.7;
    for (solver, dt) in [(SOLVERS[0], 1.0 / 60.0), (SOLVERS[0], 1.0 / 240.0), (SOLVERS[1], 1.0 / 240.0)] {
        let mut world = world_with(Vec3::Y * -G as f32, solver);
        let ground = ground(&mut world);
        let door =
            world.add_body(&lump(3.0, Vec3::new(inertia, 0.3, 0.4)).with_position(DVec3::Z * 0.5)).unwrap();
        let frames = [Frame::default(), Frame::at(Vec3::Z * -0.5)];
        world.add_joint(&JointDesc::hinge([ground, door], frames)).unwrap();
        run(&mut world, 0.1, dt);
        let alpha = 3.0 * G * 0.5 / (f64::from(inertia) + 3.0 * 0.25);
        let spin = f64::from(world.angular_velocity(door).unwrap().x);
        println!("{solver:?} {dt:.4}: {:.4}", spin / (alpha * 0.1));
        // By then it is 0.05 rad down, which takes half a thousandth off.
        assert!((spin / (alpha * 0.1) - 1.0).abs() < 0.01, "{solver:?} {dt}: {spin} for {}", alpha * 0.1);
    }
}

#[test]
fn a_soft_limit_yields_by_force_over_stiffness() {
    let (mass, k) = (2.0_f32, 400.0_f32);
    let yields = f64::from(mass) * G / f64::from(k);
    let spring = Spring::Coefficients { stiffness: k, damping: 30.0 };
    for (pull, end) in [(-1.0, -0.5), (1.0, 0.7)] {
        let build = |world: &mut World| {
            let ground = ground(world);
            let mass = world.add_body(&lump(mass, Vec3::splat(0.2))).unwrap();
            let limit = Limit::new(Motion::Linear, Axes::One(Axis::X), -0.5, 0.7).with_spring(spring);
            world
                .add_joint(&JointDesc::slider([ground, mass], [Frame::default(); 2]).with_limit(limit))
                .unwrap()
        };
        let x = |world: &World, joint| seen(world, joint).0.x;
        let gravity = Vec3::X * (pull * G as f32);
        rests("soft", gravity, 1e-4, end + f64::from(pull) * yields, &build, &x);
    }
    // A bungee.
    let build = |world: &mut World| {
        let ground = ground(world);
        let mass = world.add_body(&lump(mass, Vec3::splat(0.2)).with_position(DVec3::NEG_Y * 0.5)).unwrap();
        let limit = Limit::new(Motion::Linear, Axes::All, 0.0, 0.5).with_spring(spring);
        world.add_joint(&JointDesc::new([ground, mass], [Frame::default(); 2]).with_limit(limit)).unwrap()
    };
    let apart = |world: &World, joint| seen(world, joint).0.length();
    rests("bungee", Vec3::Y * -G as f32, 1e-4, 0.5 + yields, &build, &apart);
    // A torsion spring at a hinge: k (angle - max) = m g l cos(angle).
    let mut angle = 0.2_f64;
    for _ in 0..100 {
        angle = 0.2 + f64::from(mass) * G * 0.5 * angle.cos() / 100.0;
    }
    let build = |world: &mut World| {
        let (bodies, frames) = armed(world, Vec3::Z, Quat::IDENTITY);
        let spring = Spring::Coefficients { stiffness: 100.0, damping: 10.0 };
        let limit = Limit::new(Motion::Angular, Axes::One(Axis::X), -0.1, 0.2).with_spring(spring);
        world.add_joint(&JointDesc::hinge(bodies, frames).with_limit(limit)).unwrap()
    };
    let measure = |world: &World, joint| twist(seen(world, joint).1);
    rests("torsion", Vec3::Y * -G as f32, 1e-3, angle, &build, &measure);
}

/// A mass on a slider, driven to x = 0 by a spring; from x = 0.1. Positions step by step.
fn sprung(mass: f32, spring: Spring, steps: u32, dt: f64) -> Vec<f64> {
    let mut world = world(Vec3::ZERO);
    let ground = ground(&mut world);
    let body = world.add_body(&lump(mass, Vec3::splat(0.1 * mass)).with_position(DVec3::X * 0.1)).unwrap();
    let desc = JointDesc::slider([ground, body], [Frame::default(); 2]).with_motor(Motor::position(
        Motion::Linear,
        Axis::X,
        0.0,
        spring,
    ));
    world.add_joint(&desc).unwrap();
    (0..steps)
        .map(|_| {
            world.step(dt as f32).unwrap();
            world.position(body).unwrap().x
        })
        .collect()
}

#[test]
fn a_spring_by_frequency_has_it_whatever_the_mass() {
    let dt = 1.0 / 240.0;
    for mass in [0.01, 1.0, 5000.0] {
        for hertz in [0.5_f32, 2.0, 5.0] {
            let path = sprung(mass, Spring::Frequency { hertz, ratio: 0.0 }, 1200, dt);
            let passed: Vec<f64> = path
                .windows(2)
                .enumerate()
                .filter(|(_, w)| w[0] > 0.0 && w[1] <= 0.0)
                .map(|(i, w)| (i as f64 + w[0] / (w[0] - w[1])) * dt)
                .collect();
            let found = (passed.len() - 1) as f64 / (passed[passed.len() - 1] - passed[0]);
            assert!((found / f64::from(hertz) - 1.0).abs() < 0.01, "{mass} kg, {hertz} Hz: {found}");
        }
    }
}

/// x = x0 (1 + w t) exp(-w t).
#[test]
fn a_critically_damped_spring_does_not_overshoot() {
    let (dt, hertz) = (1.0 / 240.0, 2.0_f32);
    let path = sprung(3.0, Spring::Frequency { hertz, ratio: 1.0 }, 480, dt);
    let lowest = path.iter().copied().fold(f64::INFINITY, f64::min);
    assert!(lowest > -1e-6, "{lowest}");
    for (i, x) in path.iter().enumerate() {
        let t = f64::from(TAU * hertz) * (i + 1) as f64 * dt;
        let expected = 0.1 * (1.0 + t) * (-t).exp();
        assert!((x - expected).abs() < 1e-3, "{i}: {x} for {expected}");
    }
    // In steps as long as the spring's own time it is still calm.
    let path = sprung(3.0, Spring::Frequency { hertz: 30.0, ratio: 1.0 }, 60, 1.0 / 30.0);
    assert!(path.iter().all(|x| *x > -1e-4 && *x < 0.1), "{path:?}");
}

#[test]
fn drives_by_acceleration_do_not_depend_on_the_mass() {
    let spring = Spring::Acceleration { stiffness: 90.0, damping: 4.0 };
    let light = sprung(0.5, spring, 240, 1.0 / 60.0);
    let heavy = sprung(5000.0, spring, 240, 1.0 / 60.0);
    let worst = light.iter().zip(&heavy).map(|(a, b)| (a - b).abs()).fold(0.0, f64::max);
    assert!(worst < 1e-5, "{worst}");
    // By coefficients they do.
    let spring = Spring::Coefficients { stiffness: 90.0, damping: 4.0 };
    assert!(sprung(50.0, spring, 30, 1.0 / 60.0)[29] > sprung(1.0, spring, 30, 1.0 / 60.0)[29] + 0.01);
}

/// v = F t / m up to the speed asked for, then that speed.
#[test]
fn a_motor_pushes_with_its_force_until_it_has_its_speed() {
    for solver in SOLVERS {
        for dt in STEPS {
            for angular in [false, true] {
                let mut world = world_with(Vec3::ZERO, solver);
                let ground = ground(&mut world);
                let body = world.add_body(&lump(4.0, Vec3::new(4.0, 3.0, 2.0))).unwrap();
                let (bodies, frames) = ([ground, body], [Frame::default(); 2]);
                let desc = if angular {
                    JointDesc::hinge(bodies, frames).with_motor(Motor::velocity(
                        Motion::Angular,
                        Axis::X,
                        3.0,
                        10.0,
                    ))
                } else {
                    JointDesc::slider(bodies, frames).with_motor(Motor::velocity(
                        Motion::Linear,
                        Axis::X,
                        3.0,
                        10.0,
                    ))
                };
                world.add_joint(&desc).unwrap();
                for step in 1..=(2.0 / dt) as u32 {
                    world.step(dt as f32).unwrap();
                    let v = if angular { world.angular_velocity(body) } else { world.linear_velocity(body) };
                    let expected = (2.5 * f64::from(step) * dt).min(3.0);
                    let v = f64::from(v.unwrap().x);
                    assert!((v - expected).abs() < 1e-4, "{solver:?} {dt} {angular} {step}: {v} {expected}");
                }
            }
        }
    }
}

/// The way to a stop is v² / (2 F / m).
#[test]
fn friction_in_a_joint_stops_what_slides() {
    for solver in SOLVERS {
        for dt in STEPS {
            let mut world = world_with(Vec3::ZERO, solver);
            let ground = ground(&mut world);
            let body = lump(2.0, Vec3::splat(0.2)).with_velocity(Vec3::X * 3.0, Vec3::ZERO);
            let body = world.add_body(&body).unwrap();
            let desc = JointDesc::slider([ground, body], [Frame::default(); 2]).with_motor(Motor::friction(
                Motion::Linear,
                Axis::X,
                10.0,
            ));
            world.add_joint(&desc).unwrap();
            run(&mut world, 2.0, dt);
            let x = world.position(body).unwrap().x;
            // Semi-implicit steps stop up to half a substep early.
            let early = 3.0 * dt / f64::from(solver.0) / 2.0;
            println!("{solver:?} {dt:.4}: {x:.4}");
            assert!((x - 0.9).abs() < early + 1e-3, "{solver:?} {dt}: {x}");
            let now = world.position(body).unwrap();
            run(&mut world, 2.0, dt);
            assert!((world.position(body).unwrap() - now).length() < 1e-5, "it stays");
        }
    }
}

/// Friction bears a load up to its force, and takes its force off a greater one.
#[test]
fn friction_in_a_joint_holds_a_load() {
    let fall = |force: f32| {
        let mut world = world(Vec3::Y * -G as f32);
        let ground = ground(&mut world);
        let body = world.add_body(&lump(2.0, Vec3::splat(0.2))).unwrap();
        let turn = Quat::from_rotation_z(FRAC_PI_2);
        let frames = [Frame { rotation: turn, ..Frame::default() }; 2];
        let desc = JointDesc::slider([ground, body], frames).with_motor(Motor::friction(
            Motion::Linear,
            Axis::X,
            force,
        ));
        world.add_joint(&desc).unwrap();
        run(&mut world, 1.0, 1.0 / 60.0);
        (world.position(body).unwrap().y, f64::from(world.linear_velocity(body).unwrap().y))
    };
    let weight = 2.0 * G as f32;
    let (y, v) = fall(weight * 1.01);
    assert!(y.abs() < MILLIMETRE && v.abs() < 1e-4, "{y} {v}");
    let (_, v) = fall(weight * 0.75);
    assert!((v + 0.25 * G).abs() < 1e-3 * G, "{v}");
}

#[test]
fn a_wheel_sinks_into_its_spring() {
    let (mass, k) = (12.0_f32, 4000.0);
    for (spring, sinks) in [
        (Spring::Coefficients { stiffness: k, damping: 300.0 }, f64::from(mass) * G / f64::from(k)),
        (Spring::Frequency { hertz: 2.0, ratio: 0.7 }, G / f64::from(TAU * 2.0).powi(2)),
        // Beyond the travel it stands on the end of it.
        (Spring::Coefficients { stiffness: 100.0, damping: 100.0 }, 0.2),
    ] {
        let build = |world: &mut World| {
            let car = ground(world);
            let wheel = lump(mass, Vec3::new(0.5, 0.3, 0.3)).with_velocity(Vec3::ZERO, Vec3::X * 10.0);
            let wheel = world.add_body(&wheel).unwrap();
            world.add_joint(&JointDesc::wheel([car, wheel], [Frame::default(); 2], 0.2, spring)).unwrap()
        };
        let y = |world: &World, joint| {
            let at = seen(world, joint).0;
            assert!(at.x.hypot(at.z) < 1e-4, "off its axis by {at}");
            // It turns on, freely.
            let [_, wheel] = world.joint_bodies(joint).unwrap();
            let spin = world.angular_velocity(wheel).unwrap();
            assert!((spin - Vec3::X * 10.0).length() < 1e-2, "{spin}");
            at.y
        };
        rests("wheel", Vec3::Y * -G as f32, MILLIMETRE, -sinks, &build, &y);
    }
}
