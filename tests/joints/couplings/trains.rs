//! Trains of gears: motors at their bounds, more gears than one system has, gears that contradict each other.

use super::*;

/// Wheels in a row on the ground, each meshing with the next.
fn row(world: &mut World, count: u8, inertia: f32, teeth: [f64; 2]) -> Vec<(BodyHandle, JointHandle)> {
    let ground = world.add_body(&BodyDesc::fixed()).unwrap();
    let wheels: Vec<_> = (0..count).map(|i| shaft(world, ground, Vec3::Y * f32::from(i), inertia)).collect();
    for two in wheels.windows(2) {
        world.add_coupling(&CouplingDesc::gear([two[0].1, two[1].1], teeth)).unwrap();
    }
    wheels
}

/// A motor of at most 3 N m at the slow end of 1 : 9. Expected, by Newton's law: it accelerates its wheel by
/// 3 / (I + 9 I + 81 I) until it has its speed, and then holds that.
#[test]
fn a_motor_at_its_bound_turns_the_whole_train() {
    let mut world = weightless();
    let wheels = row(&mut world, 3, 0.05, [30.0, 10.0]);
    let drive = Motor::velocity(Motion::Angular, Axis::X, 2.0, 3.0);
    world.set_joint_motor(wheels[0].1, drive).unwrap();
    let acceleration = 3.0 / (91.0 * 0.05);
    run(&mut world, 120);
    let w = spin(&world, wheels[0].0);
    assert!((w / (2.0 * acceleration) - 1.0).abs() < 1e-4, "{w} {acceleration}");
    let (_, torque) = world.joint_force(wheels[0].1).unwrap();
    assert!((torque.x - 3.0).abs() < 1e-3, "{torque}");
    run(&mut world, 240);
    let [first, .., last] = [0, 1, 2].map(|i| spin(&world, wheels[i].0));
    assert!((first - 2.0).abs() < 1e-4 && (last - 18.0).abs() < 1e-3, "{first} {last}");
}

/// A spring holds the first wheel, and the last is turned out of rest. Expected: they swing as one, with
/// the inertia of all three, k = 20 N m/rad and no damping: 10 swings in 10 T, the period T of an oscillator.
#[test]
fn a_spring_swings_the_whole_train() {
    let mut world = weightless();
    let wheels = row(&mut world, 3, 0.05, [10.0, 10.0]);
    let spring = backstop::Spring::Coefficients { stiffness: 20.0, damping: 0.0 };
    let drive = Motor::position(Motion::Angular, Axis::X, 0.0, spring);
    world.set_joint_motor(wheels[0].1, drive).unwrap();
    for (i, &(wheel, _)) in wheels.iter().enumerate() {
        let sign = if i % 2 == 0 { 1.0 } else { -1.0 };
        world.set_velocity(wheel, Vec3::ZERO, Vec3::X * sign).unwrap();
    }
    let (mut swings, mut last, mut time) = (0, 1.0, 0.0);
    while swings < 10 {
        world.step(DT).unwrap();
        time += f64::from(DT);
        let now = spin(&world, wheels[2].0);
        // Speeds change their sign twice in a period.
        swings += u32::from((now > 0.0) != (last > 0.0));
        last = now;
        assert!(time < 10.0, "{swings} half swings");
    }
    let period = TAU * (3.0_f64 * 0.05 / 20.0).sqrt();
    println!("{time} s, by theory {}", 4.75 * period);
    assert!((time - 4.75 * period).abs() < 0.05 * period);
}

/// Forty gears are more than a system has rows. Expected: a motor turns the first, and the last goes along,
/// the other way round; ten seconds after, as two pieces of the train know each other by passes, a mesh is
/// open by a tenth of a milliradian at most.
#[test]
fn forty_gears_turn_as_one() {
    let mut world = weightless();
    let wheels = row(&mut world, 40, 0.05, [10.0, 10.0]);
    let drive = Motor::velocity(Motion::Angular, Axis::X, 5.0, 20.0);
    world.set_joint_motor(wheels[0].1, drive).unwrap();
    run(&mut world, 600);
    let gears: Vec<_> = wheels.iter().flat_map(|w| world.couplings_of(w.1).unwrap()).collect();
    let off = gears.iter().map(|&gear| world.coupling_sum(gear).unwrap().abs() / 10.0).fold(0.0, f64::max);
    let (first, last) = (spin(&world, wheels[0].0), spin(&world, wheels[39].0));
    println!("{first} and {last} rad/s, a mesh off by {off:e} rad");
    assert!((first - 5.0).abs() < 1e-2 && (last + 5.0).abs() < 1e-2 && off < 1e-4, "{first} {last} {off}");
}

/// Three gears in a ring, of which each would turn the next the other way round, and two ratios for one
/// pair. Expected: they stand under any torque, and nothing goes to infinity.
#[test]
fn gears_that_contradict_each_other_lock() {
    let mut world = weightless();
    let wheels = row(&mut world, 3, 0.05, [10.0, 10.0]);
    world.add_coupling(&CouplingDesc::gear([wheels[0].1, wheels[2].1], [10.0, 10.0])).unwrap();
    let ([a, b], gear) = pair(&mut world, [0.1, 0.2], [1.0, 1.0]);
    let desc = world.coupling(gear).unwrap();
    let [x, y] = desc.motions;
    world.add_coupling(&desc.with_motions([x, y.with_factor(2.0)]).with_range(None)).unwrap();
    for _ in 0..600 {
        world.add_torque(wheels[1].0, Vec3::X * 5.0).unwrap();
        world.add_torque(a, Vec3::X * 5.0).unwrap();
        world.step(DT).unwrap();
    }
    for body in [a, b, wheels[0].0, wheels[1].0, wheels[2].0] {
        let q = world.rotation(body).unwrap();
        assert!(spin(&world, body).abs() < 1e-2 && q.x.abs() < 1e-2, "{} {q}", spin(&world, body));
    }
}

/// Wheels on hinges beside their centres, on a plate that is free: every impulse pulls at every bearing.
/// Expected: the ratio holds, and angular momentum is conserved.
#[test]
fn eccentric_wheels_keep_their_ratio() {
    let mut world = weightless();
    let plate = world.add_body(&lump(3.0, 0.8)).unwrap();
    let [(a, on_a), (b, on_b)] = [-0.4_f32, 0.4].map(|y| {
        let at = Vec3::new(0.0, y, 0.0);
        let wheel = world.add_body(&lump(1.0, 0.05).with_position(at + Vec3::Z * 0.2)).unwrap();
        let frames = [Frame::at(at), Frame::at(Vec3::Z * -0.2)];
        (wheel, world.add_joint(&JointDesc::hinge([plate, wheel], frames)).unwrap())
    });
    let gear = world.add_coupling(&CouplingDesc::gear([on_a, on_b], [12.0, 18.0])).unwrap();
    world.set_joint_motor(on_a, Motor::velocity(Motion::Angular, Axis::X, 6.0, 1.0)).unwrap();
    let momentum = |world: &World| {
        let parts = [(plate, 3.0, 0.8), (a, 1.0, 0.05), (b, 1.0, 0.05)];
        parts.iter().fold(DVec3::ZERO, |sum, &(body, mass, inertia)| {
            let momentum = world.linear_velocity(body).unwrap().as_dvec3() * mass;
            let spin = world.angular_velocity(body).unwrap().as_dvec3() * inertia;
            sum + world.position(body).unwrap().cross(momentum) + spin
        })
    };
    let (mut off, mut worst) = (0.0_f64, 0.0_f64);
    for _ in 0..600 {
        world.step(DT).unwrap();
        off = off.max((world.coupling_sum(gear).unwrap() / 18.0).abs());
        worst = worst.max(momentum(&world).length());
    }
    println!("teeth off by {off:e} rad, angular momentum {worst:e}");
    assert!(off < 1e-3 && worst < 1e-3, "{off} {worst}");
}

/// Eight gears in a row, of three ratios, at three rates, one and four substeps and other sizes of wheels,
/// with a motor at one end, for ten minutes. Expected: the last wheel turns by the product of ratios, counted
/// apart from the engine, and no mesh is ever open by more than 2 mrad once they go evenly.
#[test]
fn eight_gears_keep_their_teeth_for_ten_minutes() {
    for (hertz, substeps, inertia, teeth) in
        [(30.0f32, 1, 5.0, [20.0, 31.0]), (60.0, 4, 0.05, [10.0, 10.0]), (120.0, 1, 1e-4, [31.0, 20.0])]
    {
        let settings = Settings::default().with_gravity(Vec3::ZERO).with_substeps(substeps);
        let mut world = World::new(settings).unwrap();
        let wheels = row(&mut world, 8, inertia, teeth);
        let ratio = teeth[0] / teeth[1];
        // The fast end turns by less than a tenth of a turn a step.
        let speed = 2.0 / f64::max(1.0, ratio.powi(7));
        world.set_joint_motor(wheels[0].1, motor(speed as f32)).unwrap();
        let gears: Vec<_> = wheels[..7].iter().map(|w| world.couplings_of(w.1).unwrap().last()).collect();
        let mut last = Turns::new(wheels[7].0);
        let mut worst = 0.0_f64;
        let steps = (600.0 * hertz) as u32;
        for step in 0..steps {
            world.step(1.0 / hertz).unwrap();
            last.follow(&world);
            for gear in gears.iter().flatten().filter(|_| step > 60 && step % 16 == 0) {
                worst = worst.max(world.coupling_sum(*gear).unwrap().abs() / teeth[0].max(teeth[1]));
            }
        }
        let expected = -speed * f64::from(steps) / f64::from(hertz) * ratio.powi(7);
        let name = format!("{hertz} Hz, {substeps} substeps, {inertia} kg m², {teeth:?}");
        println!("{name}: {} of {expected} rad, teeth off by {worst:e} rad", last.total);
        assert!((last.total / expected - 1.0).abs() < 5e-3, "{name}: {} for {expected}", last.total);
        assert!(worst < 2e-3, "{name}: {worst:e}");
    }
}

/// One pair of each ratio from 1:1 to 1:100, either way round, with equal wheels and with wheels as gears are
/// made (the inertia by the fourth power of the radius). Expected, by Newton's law: a torque T on the first
/// accelerates it by T / (I + k² J).
#[test]
fn torque_goes_by_any_ratio_at_any_rate() {
    for ratio in [1.0_f64, 3.0, 10.0, 100.0, 0.1, 0.01] {
        for (hertz, substeps) in [(30.0f32, 1), (60.0, 4), (240.0, 8)] {
            for alike in [true, false] {
                let second = if alike { 0.1 } else { 0.1 / ratio.powi(4) };
                let settings = Settings::default().with_gravity(Vec3::ZERO).with_substeps(substeps);
                let mut world = World::new(settings).unwrap();
                let ([a, b], _) = pair(&mut world, [0.1, second as f32], [ratio, 1.0]);
                let whole = 0.1 + ratio * ratio * f64::from(second as f32);
                // To 0.5 rad/s of the faster wheel within a second.
                let torque = 0.5 * whole / ratio.max(1.0);
                for _ in 0..hertz as u32 {
                    world.add_torque(a, Vec3::X * torque as f32).unwrap();
                    world.step(1.0 / hertz).unwrap();
                }
                let (w, v) = (spin(&world, a), spin(&world, b));
                let name = format!("1:{ratio} {hertz} Hz, {substeps} substeps, {second} kg m²");
                assert!((w * whole / torque - 1.0).abs() < 2e-3, "{name}: {w} for {}", torque / whole);
                assert!((v + ratio * w).abs() < 1e-3 * v.abs(), "{name}: {v} for {}", -ratio * w);
            }
        }
    }
}
