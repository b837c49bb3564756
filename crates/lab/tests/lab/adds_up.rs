//! The meter adds up: every change of a body's velocity has its cause, in scenes at random.
//! `COUNT=100 cargo test --package backstop-lab --test lab adds_up` runs more of them.

use crate::common;
use backstop::glam::{DVec3, Quat, Vec3};
use backstop::{
    Axes, Axis, BodyDesc, BodyHandle, CouplingDesc, Frame, Geometry, JointDesc, JointHandle, Limit, Material,
    Motion, Motor, Settings, ShapeDesc, Skeleton, Spring, World,
};
use backstop_lab::LabWorld;
use backstop_lab::system::{System, SystemBody, Velocity};
use backstop_scene::Rng;

/// Figures that fall down stairs.
fn stairs(world: &mut World, rng: &mut Rng) {
    let (height, depth) = (rng.range(0.1, 0.4), rng.range(0.2, 0.6));
    for i in 1..12 {
        let top = height * i as f32;
        let shape = ShapeDesc::new(Geometry::cuboid(3.0, 0.5 * top, 0.5 * depth));
        let at = Vec3::new(0.0, 0.5 * top, -depth * i as f32);
        world.add_body(&BodyDesc::fixed().with_position(at).with_shape(shape)).unwrap();
    }
    for i in 0..2 {
        let at = DVec3::new(1.5 * f64::from(i), f64::from(12.5 * height), f64::from(-11.0 * depth));
        let push = rng.direction() * rng.range(0.0, 4.0) + Vec3::Z * 2.0;
        let figure = Skeleton::humanoid().with_friction(rng.range(0.0, 5.0));
        figure.add_to(world, at, Quat::from_rotation_y(rng.range(0.0, 6.0)), push).unwrap();
    }
}

/// Chains of bodies of unequal masses, some of which hang; their ends swing into a heap.
fn chains(world: &mut World, rng: &mut Rng) {
    for i in 0..3 {
        let post =
            world.add_body(&BodyDesc::fixed().with_position(Vec3::new(2.0 * i as f32, 6.0, 0.0))).unwrap();
        let mut last = post;
        let mut at = Vec3::new(2.0 * i as f32, 6.0, 0.0);
        let way = rng.direction();
        for k in 0..6 {
            let half = Vec3::new(rng.range(0.05, 0.2), rng.range(0.05, 0.2), rng.range(0.05, 0.2));
            let reach = if k == 0 { 0.0 } else { 0.3 };
            at += way * (reach + 0.3);
            let density = 30.0 * libm::powf(200.0, rng.range(0.0, 1.0));
            let shape = ShapeDesc::new(Geometry::cuboid(half.x, half.y, half.z)).with_density(density);
            let spin = rng.direction() * rng.range(0.0, 10.0);
            let body =
                BodyDesc::dynamic().with_position(at).with_shape(shape).with_velocity(Vec3::ZERO, spin);
            let body = world.add_body(&body).unwrap();
            if k > 0 || i > 0 {
                join(world, [last, body], [way * reach, way * -0.3], rng);
            }
            last = body;
        }
    }
    heap(world, rng);
}

fn join(world: &mut World, bodies: [BodyHandle; 2], at: [Vec3; 2], rng: &mut Rng) {
    let frames = at.map(|position| Frame { position, rotation: Quat::IDENTITY });
    let desc = match rng.bits() % 4 {
        0 | 1 => JointDesc::ball(bodies, frames),
        2 => JointDesc::hinge(bodies, frames),
        _ => JointDesc::fixed(bodies, frames),
    };
    world.add_joint(&desc).unwrap();
}

/// Bodies of many shapes that fall on each other, fast ones among them, with restitution.
fn heap(world: &mut World, rng: &mut Rng) {
    for _ in 0..25 {
        let [a, b, c] = [0; 3].map(|_| rng.range(0.1, 0.4));
        let geometry = match rng.bits() % 4 {
            0 => Geometry::cuboid(a, b, c),
            1 => Geometry::Sphere { radius: a },
            2 => Geometry::Capsule { half_height: a, radius_bottom: b, radius_top: b },
            _ => Geometry::Cylinder { half_height: a, radius_bottom: b, radius_top: b },
        };
        let material = Material::default()
            .with_friction(rng.range(0.0, 1.5))
            .with_restitution((rng.range(-1.0, 0.9)).max(0.0));
        let at = Vec3::new(rng.range(-2.0, 6.0), rng.range(0.5, 5.0), rng.range(-1.5, 1.5));
        let fast = if rng.bits().is_multiple_of(5) { 60.0 } else { 3.0 };
        let shape = common::shape(geometry, material);
        let body = BodyDesc::dynamic().with_position(at).with_shape(shape);
        let body = body.with_velocity(rng.direction() * rng.range(0.0, fast), rng.direction() * fast * 0.3);
        world.add_body(&body).unwrap();
    }
}

/// Balls and boxes that overlap each other when they are made, and spin and fly apart.
fn crowd(world: &mut World, rng: &mut Rng) {
    for _ in 0..20 {
        let half = rng.range(0.2, 0.4);
        let geometry = match rng.bits() % 2 {
            0 => Geometry::cuboid(half, half, half),
            _ => Geometry::Sphere { radius: half },
        };
        let material = Material::default().with_restitution((rng.range(-1.0, 0.9)).max(0.0));
        let at = Vec3::Y * 2.0 + rng.direction() * rng.range(0.0, 0.8);
        let body = BodyDesc::dynamic().with_position(at).with_shape(common::shape(geometry, material));
        let (speed, spin) = (rng.range(0.0, 20.0), rng.range(0.0, 60.0));
        world.add_body(&body.with_velocity(rng.direction() * speed, rng.direction() * spin)).unwrap();
    }
}

/// Chains of joints of all kinds, some of which are closed to loops, and couplings of their motions.
fn joints(world: &mut World, rng: &mut Rng) {
    let mut ends = Vec::new();
    let mut made: Vec<(usize, JointHandle)> = Vec::new();
    for i in 0..4 {
        let post = BodyDesc::fixed().with_position(Vec3::new(2.0 * i as f32, 4.0, 0.0));
        let mut last = world.add_body(&post).unwrap();
        let mut at = Vec3::new(2.0 * i as f32, 4.0, 0.0);
        let way = rng.direction();
        for k in 0..5 {
            let half = Vec3::new(rng.range(0.05, 0.2), rng.range(0.05, 0.2), rng.range(0.05, 0.2));
            let reach = if k == 0 { 0.0 } else { 0.3 };
            at += way * (reach + 0.3);
            let density = 100.0 * libm::powf(30.0, rng.range(0.0, 1.0));
            let shape = ShapeDesc::new(Geometry::cuboid(half.x, half.y, half.z)).with_density(density);
            let spin = rng.direction() * rng.range(0.0, 10.0);
            let body =
                BodyDesc::dynamic().with_position(at).with_shape(shape).with_velocity(Vec3::ZERO, spin);
            let body = world.add_body(&body).unwrap();
            if k > 0 || i % 2 > 0 {
                let rotation = Quat::from_axis_angle(rng.direction(), rng.range(0.0, 3.0));
                let frames = [way * reach, way * -0.3].map(|position| Frame { position, rotation });
                let kind = (rng.bits() % KINDS) as usize;
                made.push((kind, world.add_joint(&joint(kind, [last, body], frames, rng)).unwrap()));
            }
            last = body;
        }
        ends.push(last);
    }
    if rng.bits().is_multiple_of(2) {
        let [a, b] = [ends[0], ends[1]];
        let apart = (world.position(b).unwrap() - world.position(a).unwrap()).as_vec3();
        let frames = [apart * 0.5, apart * -0.5].map(Frame::at);
        world.add_joint(&JointDesc::ball([a, b], frames)).unwrap();
    }
    couple(world, &made);
}

/// Couples the first hinges, sliders and distances.
fn couple(world: &mut World, made: &[(usize, JointHandle)]) {
    let of = |kinds: [usize; 2], nth: usize| {
        made.iter().filter(|(kind, _)| kinds.contains(kind)).nth(nth).map(|(_, joint)| *joint)
    };
    let (hinges, sliders, ropes) = ([1, 1], [4, 5], [6, 7]);
    let gear = of(hinges, 0).zip(of(hinges, 1)).map(|(a, b)| CouplingDesc::gear([a, b], [20.0, 31.0]));
    let rack = of(hinges, 2).zip(of(sliders, 0)).map(|(a, b)| CouplingDesc::rack(a, b, 0.1));
    let pulley = of(ropes, 0).zip(of(ropes, 1)).map(|(a, b)| CouplingDesc::pulley([a, b], 2.0, 1.0));
    let screw = of([11, 11], 0).map(|joint| CouplingDesc::screw(joint, 0.05));
    for coupling in [gear, rack, pulley, screw].into_iter().flatten() {
        world.add_coupling(&coupling).unwrap();
    }
}

/// How many kinds of joints [`joint`] has.
const KINDS: u64 = 12;

fn joint(kind: usize, bodies: [BodyHandle; 2], frames: [Frame; 2], rng: &mut Rng) -> JointDesc {
    use Axes::{All, One, Perpendicular};
    use Motion::{Angular, Linear};
    let (low, high) = (rng.range(-0.5, 0.0), rng.range(0.0, 0.5));
    let torque = libm::powf(10.0, rng.range(-1.0, 2.0));
    let spring = match rng.bits() % 2 {
        0 => Spring::Frequency { hertz: rng.range(0.5, 20.0), ratio: rng.range(0.0, 1.5) },
        _ => Spring::Coefficients {
            stiffness: libm::powf(10.0, rng.range(0.0, 4.0)),
            damping: libm::powf(10.0, rng.range(-1.0, 2.0)),
        },
    };
    let driven = |motion: Motion, axis: Axis, rng: &mut Rng| match rng.bits() % 3 {
        0 => Motor::velocity(motion, axis, rng.range(-5.0, 5.0), torque),
        1 => Motor::position(motion, axis, rng.range(-0.5, 0.5), spring),
        _ => Motor::friction(motion, axis, torque),
    };
    let slider = || JointDesc::slider(bodies, frames);
    let new = || JointDesc::new(bodies, frames);
    match kind {
        0 => JointDesc::ball(bodies, frames),
        1 => JointDesc::hinge(bodies, frames).with_motor(driven(Angular, Axis::X, rng)),
        2 => JointDesc::fixed(bodies, frames),
        3 => JointDesc::hinge(bodies, frames).with_limit(Limit::new(Angular, One(Axis::X), low, high)),
        4 => slider().with_limit(Limit::new(Linear, One(Axis::X), low, high)),
        5 => slider().with_motor(driven(Linear, Axis::X, rng)),
        6 => JointDesc::distance(bodies, frames, 0.0, high),
        7 => new().with_limit(Limit::new(Linear, All, 0.2 * high, high).with_spring(spring)),
        8 => JointDesc::wheel(bodies, frames, 0.1, spring).with_motor(driven(Angular, Axis::X, rng)),
        9 => {
            let cone = Limit::new(Angular, Perpendicular(Axis::X), 0.0, high);
            let twist = Limit::new(Angular, One(Axis::X), low, high);
            let ball = JointDesc::ball(bodies, frames).with_limit(cone).with_limit(twist);
            ball.with_motor(Motor::friction(Angular, Axis::Y, torque))
        }
        10 => {
            let turn = Limit::new(Angular, All, 0.0, high).with_spring(spring);
            let across = Limit::new(Linear, Perpendicular(Axis::Z), 0.0, high);
            new().with_limit(turn).with_limit(across).with_motor(driven(Linear, Axis::Z, rng))
        }
        _ => new()
            .with_limit(Limit::lock(Linear, Perpendicular(Axis::X)))
            .with_limit(Limit::lock(Angular, Perpendicular(Axis::X))),
    }
}

/// The greatest share of motion without a cause in a run, its measure [m/s], and the step.
type Worst = (f64, f64, u32);

/// Runs a scene for four seconds. Returns the worst of linear and of angular velocities.
fn run(build: fn(&mut World, &mut Rng), seed: u64, hz: f32) -> [Worst; 2] {
    let mut rng = Rng::new(seed);
    let mut world = World::new(Settings::default()).unwrap();
    world.measure_accuracy(true);
    world.add_body(&common::Floor::Box.desc(Material::default())).unwrap();
    build(&mut world, &mut rng);
    let mut worst = [(0.0_f64, 0.0_f64, 0); 2];
    let mut before = [0.0_f64; 2];
    for step in 0..(4.0 * hz) as u32 {
        world.step(1.0 / hz).unwrap();
        let measures = &world.accuracy().unwrap().whole;
        let found = [measures.unexplained, measures.unexplained_turn];
        let now = scales(world.system().unwrap());
        for k in 0..2 {
            // Rows start with the impulses of the step before.
            let share = found[k] / now[k].max(before[k]);
            if share > worst[k].0 {
                worst[k] = (share, found[k], step);
            }
        }
        before = now;
    }
    worst
}

/// The greatest velocities, and changes of them by rows [m/s]; of rotation at the radius of gyration.
fn scales(system: &System) -> [f64; 2] {
    let mut scales = [0.1_f64; 2];
    let mut see = |body: &SystemBody, [v, w]: Velocity| {
        let turning = body.inverse_inertia.determinant().cbrt();
        let reach = if turning > 0.0 { (body.inverse_mass.max_element() / turning).sqrt() } else { 0.0 };
        scales[0] = scales[0].max(v.length());
        scales[1] = scales[1].max(w.length() * reach);
    };
    for body in &system.bodies {
        see(body, body.start);
        see(body, body.end);
    }
    for row in &system.rows {
        for (side, body) in row.bodies.iter().enumerate() {
            if let Some(body) = body.map(|i| &system.bodies[i]) {
                let [p, l] = [row.linear[side], row.angular[side]].map(|part| part * row.impulse);
                see(body, [body.inverse_mass * p, body.inverse_inertia * l]);
            }
        }
    }
    scales
}

/// Newton's second law: what changes the momentum and the angular momentum of a body is gravity and the
/// impulses of rows. What is left is rounding: bodies and impulses are single precision, 6e-8, and a step
/// adds to a velocity some forty times: four substeps, each with rows, joints and a warm start.
#[test]
fn every_change_of_momentum_has_its_cause() {
    let count = std::env::var("COUNT").ok().and_then(|count| count.parse().ok()).unwrap_or(2_u64);
    for seed in 0..count {
        for (kind, build) in SCENES.into_iter().enumerate() {
            for hz in [30.0_f32, 60.0, 120.0] {
                let [linear, angular] = run(build, seed, hz);
                let is_rounding = linear.0 < ROUNDING && angular.0 < ROUNDING;
                assert!(is_rounding, "seed {seed}, kind {kind}, {hz} Hz: {linear:?}, {angular:?}");
            }
        }
    }
}

const SCENES: [fn(&mut World, &mut Rng); 5] = [stairs, chains, heap, crowd, joints];

/// The share of the greatest velocity that is rounding, see there: forty times 6e-8, twice over for the
/// impulse and its effect.
const ROUNDING: f64 = 5e-6;
