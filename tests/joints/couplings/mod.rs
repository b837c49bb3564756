//! Gears, racks, screws and pulleys: ratios that hold over a thousand turns, forces and accelerations by
//! mechanics, and what is conserved.

#![allow(clippy::disallowed_methods, reason = "expected values may use the platform's functions")]

mod api;
mod pulleys;
mod scenes;
mod trains;

use backstop::glam::{DVec3, Mat3, Quat, Vec3};
use backstop::{
    Axis, BodyDesc, BodyHandle, CouplingDesc, CouplingHandle, Frame, JointDesc, JointHandle, MassProperties,
    Motion, Motor, Settings, World,
};
use std::f64::consts::{PI, TAU};

const DT: f32 = 1.0 / 60.0;

fn weightless() -> World {
    World::new(Settings::default().with_gravity(Vec3::ZERO)).unwrap()
}

/// A body without a shape, alike about all axes.
fn lump(mass: f32, inertia: f32) -> BodyDesc {
    let inertia = Mat3::from_diagonal(Vec3::splat(inertia));
    BodyDesc::dynamic().with_mass(Some(MassProperties { mass, centre_of_mass: Vec3::ZERO, inertia }))
}

/// A shaft: a wheel at a point on a hinge about x, on another body whose origin is where the world's is.
fn shaft(world: &mut World, on: BodyHandle, at: Vec3, inertia: f32) -> (BodyHandle, JointHandle) {
    let wheel = world.add_body(&lump(1.0, inertia).with_position(at)).unwrap();
    let hinge = JointDesc::hinge([on, wheel], [Frame::at(at), Frame::default()]);
    (wheel, world.add_joint(&hinge).unwrap())
}

/// Two wheels on the ground, one metre apart.
fn pair(world: &mut World, inertia: [f32; 2], teeth: [f64; 2]) -> ([BodyHandle; 2], CouplingHandle) {
    let ground = world.add_body(&BodyDesc::fixed()).unwrap();
    let (a, on_a) = shaft(world, ground, Vec3::ZERO, inertia[0]);
    let (b, on_b) = shaft(world, ground, Vec3::Y, inertia[1]);
    ([a, b], world.add_coupling(&CouplingDesc::gear([on_a, on_b], teeth)).unwrap())
}

fn run(world: &mut World, steps: u32) {
    for _ in 0..steps {
        world.step(DT).unwrap();
    }
}

fn motor(speed: f32) -> Motor {
    Motor::velocity(Motion::Angular, Axis::X, speed, f32::INFINITY)
}

fn spin(world: &World, body: BodyHandle) -> f64 {
    f64::from(world.angular_velocity(body).unwrap().x)
}

/// The angle of a body that turns about x, with whole turns, followed from step to step.
struct Turns {
    body: BodyHandle,
    total: f64,
    last: f64,
}

impl Turns {
    fn new(body: BodyHandle) -> Turns {
        Turns { body, total: 0.0, last: 0.0 }
    }
    fn follow(&mut self, world: &World) {
        let q = world.rotation(self.body).unwrap();
        let now = 2.0 * f64::from(q.x).atan2(f64::from(q.w));
        self.total += (now - self.last + 3.0 * PI).rem_euclid(TAU) - PI;
        self.last = now;
    }
}

/// A motor turns a gear of 20 teeth by 1000 turns; the other has 31. Expected: 20/31 of that, backwards, by
/// the ratio; the same by the bodies' rotations, counted apart from the engine; and never off by more than
/// the rounding of two rotations, each a quaternion of four numbers of 2^-24, that is 2 x 4 x 2^-23 rad,
/// once the wheels go at an even speed.
#[test]
fn a_thousand_turns_slip_no_tooth() {
    let mut world = weightless();
    let ([a, b], gear) = pair(&mut world, [0.1, 0.2], [20.0, 31.0]);
    let hinge = world.joints_of(a).unwrap().next().unwrap();
    world.set_joint_motor(hinge, motor(60.0)).unwrap();
    let (mut first, mut second, mut worst, mut at_start) = (Turns::new(a), Turns::new(b), 0.0_f64, 0.0_f64);
    let mut steps = 0;
    while first.total < 1000.0 * TAU {
        world.step(DT).unwrap();
        first.follow(&world);
        second.follow(&world);
        let off = (world.coupling_sum(gear).unwrap() / 31.0).abs();
        at_start = at_start.max(off);
        steps += 1;
        if steps > 60 {
            worst = worst.max(off);
        }
    }
    let [x, y] = world.coupling_positions(gear).unwrap();
    println!("{steps} steps: off by {worst:e} rad, {at_start:e} at the start; turns {} {}", x / TAU, y / TAU);
    assert!((x - first.total).abs() < 1e-3 && (y - second.total).abs() < 1e-3, "{x} {}", first.total);
    assert!((first.total * 20.0 / 31.0 + second.total).abs() < 1e-5);
    assert!(worst < 8.0 * f64::from(f32::EPSILON), "{worst:e}");
    assert!(at_start < 1e-5, "{at_start:e}");
}

/// A torque T on a wheel that turns another one k times as fast. Expected, by Newton's law: it accelerates by
/// T / (I + k² J), the other one by k times that, and the teeth transmit k J and J times the other's.
#[test]
fn torque_goes_by_the_ratio() {
    let mut world = weightless();
    let ([a, b], gear) = pair(&mut world, [0.3, 0.05], [30.0, 10.0]);
    for _ in 0..120 {
        world.add_torque(a, Vec3::X * 1.5).unwrap();
        world.step(DT).unwrap();
    }
    let acceleration = 1.5 / (0.3 + 9.0 * 0.05);
    let (w, v) = (spin(&world, a), spin(&world, b));
    assert!((w / (2.0 * acceleration) - 1.0).abs() < 1e-4, "{w} {acceleration}");
    assert!((v / (-6.0 * acceleration) - 1.0).abs() < 1e-4, "{v}");
    let [on_a, on_b] = world.coupling_force(gear).unwrap().map(f64::from);
    assert!((on_b / (-0.05 * 3.0 * acceleration) - 1.0).abs() < 1e-3, "{on_b}");
    assert!((on_a / (3.0 * on_b) - 1.0).abs() < 1e-5, "{on_a} {on_b}");
}

/// Torques that balance by the ratio turn nothing.
#[test]
fn balanced_torques_hold_gears() {
    let mut world = weightless();
    let ([a, b], gear) = pair(&mut world, [0.3, 0.05], [30.0, 10.0]);
    for _ in 0..600 {
        world.add_torque(a, Vec3::X * 3.0).unwrap();
        world.add_torque(b, Vec3::X).unwrap();
        world.step(DT).unwrap();
    }
    let [x, y] = world.coupling_positions(gear).unwrap();
    assert!(x.abs() < 1e-4 && y.abs() < 1e-4, "{x} {y}");
    let [on_a, on_b] = world.coupling_force(gear).unwrap();
    assert!((on_a + 3.0).abs() < 1e-3 && (on_b + 1.0).abs() < 1e-3, "{on_a} {on_b}");
}

/// Two gears that nothing drives, for three minutes. Expected: they keep their energy, and their ratio.
#[test]
fn free_gears_keep_their_energy() {
    let mut world = weightless();
    let ([a, b], gear) = pair(&mut world, [0.4, 0.1], [40.0, 25.0]);
    world.set_velocity(a, Vec3::ZERO, Vec3::X * 20.0).unwrap();
    world.set_velocity(b, Vec3::ZERO, Vec3::X * -32.0).unwrap();
    let start = world.energy();
    let mut worst = 0.0_f64;
    for _ in 0..180 * 60 {
        world.step(DT).unwrap();
        worst = worst.max((world.coupling_sum(gear).unwrap() / 40.0).abs());
    }
    let change = world.energy() / start - 1.0;
    println!("energy changed by {change:e}, teeth off by {worst:e} rad");
    assert!(change.abs() < 1e-4 && worst < 1e-5);
}

/// A pinion of 5 cm drives a rack through a hundred turns; the rack hangs on a slider by its end and is not
/// balanced. Expected: 2 pi r a turn.
#[test]
fn a_rack_travels_the_girth_of_its_pinion_in_a_turn() {
    let mut world = World::new(Settings::default()).unwrap();
    let ground = world.add_body(&BodyDesc::fixed()).unwrap();
    let (_, hinge) = shaft(&mut world, ground, Vec3::Y, 0.01);
    let rack = world.add_body(&lump(2.0, 0.1).with_position(Vec3::new(0.3, 0.2, 0.0))).unwrap();
    let frames = world.frames_at([ground, rack], DVec3::ZERO, Quat::IDENTITY).unwrap();
    let slider = world.add_joint(&JointDesc::slider([ground, rack], frames)).unwrap();
    let teeth = world.add_coupling(&CouplingDesc::rack(hinge, slider, 0.05)).unwrap();
    world.set_joint_motor(hinge, motor(10.0)).unwrap();
    let mut worst = 0.0_f64;
    for _ in 0..3770 {
        world.step(DT).unwrap();
        worst = worst.max(world.coupling_sum(teeth).unwrap().abs());
    }
    let [angle, travel] = world.coupling_positions(teeth).unwrap();
    println!("{} turns, {travel} m, off by {worst:e} m", angle / TAU);
    assert!(angle > 99.9 * TAU);
    // Positions of the frames are `f32` beside the ground's origin: 2^-24 of 31 m.
    assert!((travel - 0.05 * angle).abs() < 4e-6, "{}", travel - 0.05 * angle);
    assert!((travel / (angle / TAU) - TAU * 0.05).abs() < 1e-6);
    assert!(worst < 1e-4, "{worst:e}");
}

/// A nut is pushed along a screw of 0.2 m a turn by a force F. Expected: with m and I its mass and inertia
/// and k = lead / 2 pi, it accelerates by F / (m + I / k²), and turns by one turn in 0.2 m.
#[test]
fn a_screw_turns_what_slides() {
    let mut world = weightless();
    let ground = world.add_body(&BodyDesc::fixed()).unwrap();
    let nut = world.add_body(&lump(3.0, 0.02)).unwrap();
    let free = JointDesc::new([ground, nut], [Frame::default(); 2])
        .with_limit(backstop::Limit::lock(Motion::Linear, backstop::Axes::Perpendicular(Axis::X)))
        .with_limit(backstop::Limit::lock(Motion::Angular, backstop::Axes::Perpendicular(Axis::X)));
    let joint = world.add_joint(&free).unwrap();
    let screw = world.add_coupling(&CouplingDesc::screw(joint, 0.2)).unwrap();
    let mut worst = 0.0_f64;
    for _ in 0..300 {
        world.add_force(nut, Vec3::X * 7.0).unwrap();
        world.step(DT).unwrap();
        worst = worst.max(world.coupling_sum(screw).unwrap().abs());
    }
    let k = 0.2 / TAU;
    let speed = 5.0 * 7.0 / (3.0 + 0.02 / (k * k));
    let v = f64::from(world.linear_velocity(nut).unwrap().x);
    let [angle, travel] = world.coupling_positions(screw).unwrap();
    println!("{v} m/s, by theory {speed}; off by {worst:e} m in {} turns", angle / TAU);
    assert!((v / speed - 1.0).abs() < 1e-4 && worst < 1e-5);
    assert!((travel / angle - k).abs() < 1e-6 && angle > TAU);
}

/// The train of a clock: five arbors, of which each turns the next one four times as fast, driven at the
/// slow end. Expected: the last turns 256 times as fast, exactly, after 20 turns of the first.
#[test]
fn a_train_of_gears_multiplies() {
    let mut world = weightless();
    let ground = world.add_body(&BodyDesc::fixed()).unwrap();
    let arbors: Vec<_> = (0..5u8)
        .map(|i| shaft(&mut world, ground, Vec3::Y * f32::from(i), 0.1 / f32::from(1 + 3 * i)))
        .collect();
    let gears: Vec<_> = arbors
        .windows(2)
        .map(|two| {
            let gear = CouplingDesc::gear([two[0].1, two[1].1], [64.0, 16.0]);
            world.add_coupling(&gear).unwrap()
        })
        .collect();
    world.set_joint_motor(arbors[0].1, motor(0.5)).unwrap();
    let mut worst = 0.0_f64;
    for step in 0..15080 {
        world.step(DT).unwrap();
        if step > 120 {
            let off = |gear| (world.coupling_sum(gear).unwrap() / 64.0).abs();
            worst = gears.iter().map(|&gear| off(gear)).fold(worst, f64::max);
        }
    }
    let [first, _] = world.coupling_positions(gears[0]).unwrap();
    let [_, last] = world.coupling_positions(gears[3]).unwrap();
    println!("{} turns and {}; a mesh off by {worst:e} rad", first / TAU, last / TAU);
    assert!(first > 19.9 * TAU && (last - 256.0 * first).abs() < 1e-3, "{}", last - 256.0 * first);
    assert!(worst < 1e-5, "{worst:e}");
    assert!((spin(&world, arbors[4].0) / 128.0 - 1.0).abs() < 1e-4);
}

/// A planetary gear: sun of 20 teeth, planet of 20, ring of 60, which stands; a torque turns the sun.
/// Expected, by Willis: the carrier turns once in 1 + 60/20 turns of the sun.
#[test]
fn a_planet_rolls_in_its_ring() {
    let mut world = weightless();
    let ground = world.add_body(&BodyDesc::fixed()).unwrap();
    let (carrier, ring) = shaft(&mut world, ground, Vec3::ZERO, 0.5);
    let (sun, on_sun) = shaft(&mut world, carrier, Vec3::ZERO, 0.1);
    let (_, on_planet) = shaft(&mut world, carrier, Vec3::Y * 0.4, 0.1);
    world.add_coupling(&CouplingDesc::gear([on_sun, on_planet], [20.0, 20.0])).unwrap();
    // The angle of the ring as seen from the carrier is that of the carrier as seen from the ring, negated;
    // its teeth are inside.
    let inner = world.add_coupling(&CouplingDesc::gear([ring, on_planet], [60.0, 20.0])).unwrap();
    let mut worst = 0.0_f64;
    for _ in 0..1200 {
        world.add_torque(sun, Vec3::X * 0.5).unwrap();
        world.step(DT).unwrap();
        worst = worst.max((world.coupling_sum(inner).unwrap() / 60.0).abs());
    }
    let (fast, slow) = (spin(&world, sun), spin(&world, carrier));
    println!("sun {fast} rad/s, carrier {slow}; off by {worst:e} rad");
    assert!(slow > 1.0 && (fast / slow - 4.0).abs() < 1e-3, "{fast} {slow}");
    assert!(worst < 1e-4, "{worst:e}");
}

/// A gearbox that floats in space, with two gears of different size on it and a motor between it and the
/// first. Expected: momentum and angular momentum stay zero, though everything turns, and the box with it;
/// the ratio is that of the shafts as seen from the box.
#[test]
fn a_floating_gearbox_bears_the_reaction() {
    let mut world = weightless();
    let gearbox = world.add_body(&lump(4.0, 1.0)).unwrap();
    let (a, on_a) = shaft(&mut world, gearbox, Vec3::Y * -0.5, 0.1);
    let (b, on_b) = shaft(&mut world, gearbox, Vec3::Y * 0.5, 0.3);
    let gear = world.add_coupling(&CouplingDesc::gear([on_a, on_b], [10.0, 25.0])).unwrap();
    world.set_joint_motor(on_a, Motor::velocity(Motion::Angular, Axis::X, 40.0, 2.0)).unwrap();
    let momenta = |world: &World| {
        let parts = [(gearbox, 4.0, 1.0), (a, 1.0, 0.1), (b, 1.0, 0.3)];
        parts.iter().fold([DVec3::ZERO; 2], |[p, l], &(body, mass, inertia)| {
            let [v, w] = [world.linear_velocity(body).unwrap(), world.angular_velocity(body).unwrap()];
            let momentum = v.as_dvec3() * mass;
            let about = world.position(body).unwrap().cross(momentum) + w.as_dvec3() * inertia;
            [p + momentum, l + about]
        })
    };
    let (mut worst, mut off, mut of_a) = ([0.0_f64; 2], 0.0_f64, 0.0_f64);
    for step in 0..1800 {
        world.step(DT).unwrap();
        let [p, l] = momenta(&world);
        worst = [worst[0].max(p.length()), worst[1].max(l.length())];
        of_a = of_a.max((0.1 * spin(&world, a)).abs());
        if step > 120 {
            off = off.max((world.coupling_sum(gear).unwrap() / 25.0).abs());
        }
    }
    println!("momentum {:e}, angular {:e} of {of_a}; teeth off by {off:e} rad", worst[0], worst[1]);
    assert!(worst[0] < 1e-4 && worst[1] < 1e-4 * of_a, "{worst:?}");
    assert!(spin(&world, gearbox).abs() > 0.1, "{}", spin(&world, gearbox));
    assert!(off < 1e-4, "{off:e}");
    let [w, u, v] = [a, b, gearbox].map(|body| spin(&world, body));
    assert!(((w - v) / (u - v) + 2.5).abs() < 1e-3, "{w} {u} {v}");
}

/// A wheel at 300 rad/s turns by 5 rad in a step of a sixtieth: more than half a turn. Expected: no turn is
/// lost.
#[test]
fn turns_count_beyond_half_of_one_in_a_step() {
    let mut world = weightless();
    let ([a, b], gear) = pair(&mut world, [0.1, 0.1], [10.0, 10.0]);
    world.set_velocity(a, Vec3::ZERO, Vec3::X * 300.0).unwrap();
    world.set_velocity(b, Vec3::ZERO, Vec3::X * -300.0).unwrap();
    for _ in 0..600 {
        world.step(DT).unwrap();
    }
    let [x, y] = world.coupling_positions(gear).unwrap();
    println!("{x} {y}");
    assert!((x / 3000.0 - 1.0).abs() < 1e-3 && (x + y).abs() < 1e-3, "{x} {y}");
}
