//! Limits hold at both ends, at half a turn, narrow and wide.

use super::*;

#[test]
fn a_limit_along_an_axis_holds_at_both_ends() {
    for (pull, end) in [(-1.0, -0.5), (1.0, 0.7)] {
        for flip in [false, true] {
            let gravity = Vec3::X * (pull * G as f32);
            // Seen from the mass it is the ground that slides, the other way.
            let (min, max) = if flip { (-0.7, 0.5) } else { (-0.5, 0.7) };
            let build = |world: &mut World| {
                let ground = ground(world);
                let mass = world.add_body(&lump(2.0, Vec3::splat(0.2))).unwrap();
                let bodies = if flip { [mass, ground] } else { [ground, mass] };
                let limit = Limit::new(Motion::Linear, Axes::One(Axis::X), min, max);
                world.add_joint(&JointDesc::slider(bodies, [Frame::default(); 2]).with_limit(limit)).unwrap()
            };
            let expected = if flip { -end } else { end };
            let x = |world: &World, joint| seen(world, joint).0.x;
            rests(&format!("slider {end} {flip}"), gravity, MILLIMETRE, expected, &build, &x);
        }
    }
}

#[test]
fn a_limit_around_an_axis_holds_at_both_ends() {
    for (from, end) in [(-0.4, 0.5), (0.4, 0.3)] {
        let build = |world: &mut World| {
            let ground = ground(world);
            let mass = world.add_body(&lump(2.0, Vec3::splat(0.2)).with_position(DVec3::Y * from)).unwrap();
            let desc = JointDesc::new([ground, mass], [Frame::default(); 2])
                .with_limit(Limit::new(Motion::Linear, Axes::Perpendicular(Axis::X), 0.3, 0.5))
                // It stands on the inner cylinder like on a knife's edge.
                .with_limit(Limit::lock(Motion::Linear, Axes::One(Axis::Z)));
            world.add_joint(&desc).unwrap()
        };
        let away = |world: &World, joint| seen(world, joint).0.y.hypot(seen(world, joint).0.z);
        rests(&format!("around {end}"), Vec3::Y * -G as f32, MILLIMETRE, end, &build, &away);
    }
}

#[test]
fn a_distance_limit_holds_at_both_ends() {
    for (from, end) in [(-0.4, 0.5), (0.4, 0.3)] {
        let build = |world: &mut World| {
            let ground = ground(world);
            let mass = world.add_body(&lump(2.0, Vec3::splat(0.2)).with_position(DVec3::Y * from)).unwrap();
            let desc = JointDesc::distance([ground, mass], [Frame::default(); 2], 0.3, 0.5)
                .with_limit(Limit::lock(Motion::Linear, Axes::Perpendicular(Axis::Y)));
            world.add_joint(&desc).unwrap()
        };
        let apart = |world: &World, joint| seen(world, joint).0.length();
        rests(&format!("distance {end}"), Vec3::Y * -G as f32, MILLIMETRE, end, &build, &apart);
    }
}

#[test]
fn a_twist_limit_holds_at_both_ends() {
    for (pull, end) in [(-1.0, 0.9), (1.0, -0.4)] {
        let build = |world: &mut World| {
            let (bodies, frames) = armed(world, Vec3::Z, Quat::IDENTITY);
            let limit = Limit::new(Motion::Angular, Axes::One(Axis::X), -0.4, 0.9);
            world.add_joint(&JointDesc::hinge(bodies, frames).with_limit(limit)).unwrap()
        };
        let gravity = Vec3::Y * (pull * G as f32);
        let angle = |world: &World, joint| twist(seen(world, joint).1);
        rests(&format!("twist {end}"), gravity, MILLIRADIANS, end, &build, &angle);
    }
}

#[test]
fn a_cone_limit_holds_at_both_ends() {
    // Up along x the mass falls off the axis, down along it it falls back.
    for (up, end) in [(1.0, 0.6), (-1.0, 0.3)] {
        let build = |world: &mut World| {
            let (bodies, frames) = armed(world, Vec3::X, common::turned(Vec3::Z, 25.0));
            let cone = Limit::new(Motion::Angular, Axes::Perpendicular(Axis::X), 0.3, 0.6);
            world.add_joint(&JointDesc::ball(bodies, frames).with_limit(cone)).unwrap()
        };
        let gravity = Vec3::X * (-up * G as f32);
        let angle = |world: &World, joint| tilt(seen(world, joint).1);
        rests(&format!("cone {end}"), gravity, MILLIRADIANS, end, &build, &angle);
    }
}

#[test]
fn a_limit_of_the_whole_angle_holds_at_both_ends() {
    for (up, end) in [(1.0, 0.6), (-1.0, 0.3)] {
        let build = |world: &mut World| {
            let (bodies, frames) = armed(world, Vec3::X, common::turned(Vec3::Z, 25.0));
            let limit = Limit::new(Motion::Angular, Axes::All, 0.3, 0.6);
            world.add_joint(&JointDesc::ball(bodies, frames).with_limit(limit)).unwrap()
        };
        let gravity = Vec3::X * (-up * G as f32);
        let angle = |world: &World, joint| whole(seen(world, joint).1);
        rests(&format!("whole {end}"), gravity, MILLIRADIANS, end, &build, &angle);
    }
}

/// A range without width, but not at zero: a lock somewhere else.
#[test]
fn locks_away_from_zero_hold() {
    let build = |world: &mut World| {
        let ground = ground(world);
        let mass = world.add_body(&lump(2.0, Vec3::splat(0.2)).with_position(DVec3::X * 0.3)).unwrap();
        let limit = Limit::new(Motion::Linear, Axes::One(Axis::X), 0.3, 0.3);
        world.add_joint(&JointDesc::slider([ground, mass], [Frame::default(); 2]).with_limit(limit)).unwrap()
    };
    let x = |world: &World, joint| seen(world, joint).0.x;
    rests("lock at 0.3 m", Vec3::X * G as f32, MILLIMETRE, 0.3, &build, &x);
    let build = |world: &mut World| {
        let (bodies, frames) = armed(world, Vec3::Z, Quat::from_rotation_x(0.5));
        let limit = Limit::new(Motion::Angular, Axes::One(Axis::X), 0.5, 0.5);
        world.add_joint(&JointDesc::hinge(bodies, frames).with_limit(limit)).unwrap()
    };
    let angle = |world: &World, joint| twist(seen(world, joint).1);
    rests("lock at 0.5 rad", Vec3::Y * -G as f32, MILLIRADIANS, 0.5, &build, &angle);
}

/// Close to half a turn the twist must not come out on the other side.
#[test]
fn a_twist_limit_near_half_a_turn_does_not_flip() {
    for end in [3.0_f32, -3.0, 3.1, -3.1] {
        for solver in SOLVERS {
            let mut world = world_with(Vec3::ZERO, solver);
            let ground = ground(&mut world);
            let wheel = world.add_body(&lump(2.0, Vec3::splat(0.2))).unwrap();
            let desc = JointDesc::hinge([ground, wheel], [Frame::default(); 2])
                .with_limit(Limit::new(Motion::Angular, Axes::One(Axis::X), -end.abs(), end.abs()))
                .with_motor(Motor::velocity(Motion::Angular, Axis::X, 8.0 * end.signum(), 2.0));
            let joint = world.add_joint(&desc).unwrap();
            let mut furthest = 0.0_f64;
            for _ in 0..240 {
                world.step(1.0 / 60.0).unwrap();
                let angle = twist(seen(&world, joint).1) * f64::from(end.signum());
                assert!(angle > -1e-3, "{end} {solver:?}: it flipped to {angle}");
                furthest = furthest.max(angle);
            }
            let angle = twist(seen(&world, joint).1);
            println!("{end} {solver:?}: {:.2e}, at most {furthest:.4}", angle - f64::from(end));
            assert!((angle - f64::from(end)).abs() < MILLIRADIANS, "{end} {solver:?}: {angle}");
        }
    }
}

/// How far from half a turn a mass on an arm rests that is to be held there.
fn off_half_a_turn(load: f32, hold: &dyn Fn(JointDesc, f32) -> JointDesc) -> f64 {
    let half = std::f32::consts::PI;
    let mut world = world(Vec3::Y * (load * G as f32));
    let (bodies, frames) = armed(&mut world, Vec3::Z, Quat::from_rotation_x(half));
    let joint = world.add_joint(&hold(JointDesc::hinge(bodies, frames), half)).unwrap();
    run(&mut world, 2.0, 1.0 / 60.0);
    f64::from(half) - twist(seen(&world, joint).1).abs()
}

/// Half a turn is half a turn either way: a body held there is not thrown round.
#[test]
fn a_lock_at_half_a_turn_holds() {
    for load in [-1.0, 1.0] {
        let off = off_half_a_turn(load, &|desc, half| {
            desc.with_limit(Limit::new(Motion::Angular, Axes::One(Axis::X), half, half))
        });
        assert!(off.abs() < MILLIRADIANS, "{load}: {off}");
    }
}

#[test]
fn a_servo_at_half_a_turn_holds() {
    for load in [-1.0, 1.0] {
        let off = off_half_a_turn(load, &|desc, half| {
            let spring = Spring::Frequency { hertz: 20.0, ratio: 1.0 };
            desc.with_motor(Motor::position(Motion::Angular, Axis::X, half, spring))
        });
        // It gives by m g l / k = 9.81 N m over 0.7 kg m² (40 pi / s)², or what is left of 0.7 at a hinge.
        assert!(off.abs() < 4.0 * MILLIRADIANS, "{load}: {off}");
    }
}

#[test]
fn narrow_and_wide_cones_hold() {
    for cone in [0.1_f32, 2.5] {
        for solver in SOLVERS {
            for spin in [0.0, 3.0] {
                let mut world = world_with(Vec3::X * -G as f32, solver);
                let (bodies, frames) = armed(&mut world, Vec3::X, common::turned(Vec3::Z, 3.0));
                let limit = Limit::new(Motion::Angular, Axes::Perpendicular(Axis::X), 0.0, cone);
                let joint = JointDesc::ball(bodies, frames).with_limit(limit);
                let joint = world.add_joint(&joint).unwrap();
                let axis = world.rotation(bodies[1]).unwrap() * Vec3::X;
                world.set_velocity(bodies[1], Vec3::ZERO, axis * spin).unwrap();
                let mut widest = 0.0_f64;
                for step in 0..600 {
                    world.step(1.0 / 60.0).unwrap();
                    assert!(common::all_finite(&world), "{cone} {solver:?} {spin} {step}");
                    widest = widest.max(tilt(seen(&world, joint).1));
                }
                let angle = tilt(seen(&world, joint).1);
                println!("{cone} {solver:?} {spin}: {:.2e}, widest {widest:.4}", angle - f64::from(cone));
                // Stopped from a fall it may give by a little, once.
                assert!(widest < f64::from(cone) + 0.02, "{cone} {solver:?} {spin}: {widest}");
                // A body that spins about its axis goes round, and rests nowhere.
                if spin == 0.0 {
                    assert!((angle - f64::from(cone)).abs() < MILLIRADIANS, "{cone} {solver:?}: {angle}");
                }
            }
        }
    }
}

/// On a line that turns, without friction: r = r0 cosh(w t).
#[test]
fn a_slider_stays_on_its_line_when_the_first_body_turns() {
    let mut wrong = Vec::new();
    for speed in [1.0_f32, 4.0] {
        let mut world = world(Vec3::ZERO);
        let spin = Vec3::new(0.0, speed, 0.0);
        let table = world.add_body(&BodyDesc::kinematic().with_velocity(Vec3::ZERO, spin)).unwrap();
        let mass =
            lump(2.0, Vec3::splat(0.05)).with_position(DVec3::X).with_velocity(spin.cross(Vec3::X), spin);
        let mass = world.add_body(&mass).unwrap();
        let joint = world.add_joint(&JointDesc::slider([table, mass], [Frame::default(); 2])).unwrap();
        let (mut widest, mut turned) = (0.0_f64, 0.0_f64);
        let steps = (90.0 / speed) as u32;
        for _ in 0..steps {
            world.step(1.0 / 60.0).unwrap();
            let (at, q) = seen(&world, joint);
            widest = widest.max(at.y.hypot(at.z));
            turned = turned.max(whole(q));
        }
        let expected = (f64::from(speed) * f64::from(steps) / 60.0).cosh();
        let r = seen(&world, joint).0.x;
        let text = format!("{speed}: off by {widest:.2e} m, {turned:.2e} rad, r {r:.4} for {expected:.4}");
        println!("{text}");
        if widest > MILLIMETRE || turned > MILLIRADIANS || (r / expected - 1.0).abs() > 0.01 {
            wrong.push(text);
        }
    }
    none(&wrong);
}
