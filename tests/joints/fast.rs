//! Joints of bodies that are hit hard or spin fast: nothing goes to infinity, and joints give no energy.
//!
//! Two balls on arms of a metre, one of them hit: a wheel's joint went to NaN from 200 m/s, a slider's from
//! 300 m/s, and a distance threw them at a hundred times their speed from 150 m/s. Two bodies on a ball joint
//! that whirl at 15 to 24 rad/s gained up to 35 times their energy in two seconds. A step without a motor
//! can't add energy, at any length: that is the expected value of all tests here, with 1 % for rounding and
//! for velocities that are half a substep late under gravity.

#![allow(clippy::disallowed_methods, reason = "expected values may use the platform's functions")]
use crate::common::{self, random::Random};
use backstop::glam::{DVec3, Mat3, Quat, Vec3};
use backstop::{
    Axes, Axis, BodyDesc, BodyHandle, Frame, Geometry, JointDesc, Limit, MassProperties, Motion, Motor,
    Settings, ShapeDesc, Spring, World,
};

const DT: f32 = 1.0 / 60.0;

type Make = fn([BodyHandle; 2], [Frame; 2]) -> JointDesc;

fn wheel(pair: [BodyHandle; 2], frames: [Frame; 2]) -> JointDesc {
    JointDesc::wheel(pair, frames, 0.2, Spring::Frequency { hertz: 5.0, ratio: 0.7 })
}

fn distance(pair: [BodyHandle; 2], frames: [Frame; 2]) -> JointDesc {
    JointDesc::distance(pair, frames, 0.2, 0.5)
}

const KINDS: [(&str, Make); 6] = [
    ("wheel", wheel),
    ("slider", JointDesc::slider),
    ("distance", distance),
    ("ball", JointDesc::ball),
    ("hinge", JointDesc::hinge),
    ("fixed", JointDesc::fixed),
];

/// Two balls of 0.3 m, on arms of 1 m that are joined in the middle.
fn two_balls(make: Make, turn: Quat) -> (World, [BodyHandle; 2]) {
    let mut world = World::new(Settings::default().with_gravity(Vec3::ZERO)).unwrap();
    let pair = [0.0, 2.0].map(|x| {
        let ball = ShapeDesc::new(Geometry::Sphere { radius: 0.3 });
        world.add_body(&BodyDesc::dynamic().with_position(DVec3::X * x).with_shape(ball)).unwrap()
    });
    let frames = world.frames_at(pair, DVec3::X, turn).unwrap();
    world.add_joint(&make(pair, frames)).unwrap();
    (world, pair)
}

/// Steps for two seconds and returns the most energy, as a share of that at the start.
fn most_energy(world: &mut World, what: &str) -> f64 {
    let start = world.energy();
    (0..120).fold(0.0, |most: f64, step| {
        let stopped = world.step(DT).unwrap().faulted;
        let energy = world.energy();
        assert!(stopped == 0 && energy.is_finite(), "{what}: step {step}, {stopped} stopped, {energy} J");
        most.max(energy / start)
    })
}

#[test]
fn what_is_hit_gets_no_faster_by_its_joint() {
    for (name, make) in KINDS {
        for speed in [50.0, 150.0, 200.0, 300.0, 400.0] {
            for turn in 0..24 {
                let q = Quat::from_rotation_y(turn as f32 * 0.5) * Quat::from_rotation_x(turn as f32 * 0.3);
                let (mut world, [a, _]) = two_balls(make, q);
                world.set_velocity(a, q * Vec3::Y * speed, Vec3::ZERO).unwrap();
                let what = format!("{name} at {speed} m/s, turn {turn}");
                let most = most_energy(&mut world, &what);
                assert!(most < 1.01, "{what}: {most} times the energy");
            }
        }
    }
}

#[test]
fn what_whirls_gets_no_faster_by_its_joint() {
    for (name, make) in KINDS {
        for spin in [15.0, 20.0, 24.0, 50.0, 100.0, 200.0] {
            for turn in 0..6 {
                let q = Quat::from_rotation_y(turn as f32 * 0.5) * Quat::from_rotation_x(turn as f32 * 0.3);
                let (mut world, [a, b]) = two_balls(make, q);
                let axis = q * Vec3::Z;
                world.set_velocity(a, axis.cross(Vec3::NEG_X) * spin, axis * spin).unwrap();
                // About the joint in the middle, the other way round.
                world.set_velocity(b, axis.cross(Vec3::NEG_X) * spin, -axis * spin).unwrap();
                let what = format!("{name} at {spin} rad/s, turn {turn}");
                let most = most_energy(&mut world, &what);
                // Trees are followed in parts of a quarter of a radian; their energy sways by its square.
                let sway = if ["ball", "hinge", "fixed"].contains(&name) { 0.25 * 0.25 } else { 0.01 };
                assert!(most < 1.0 + sway, "{what}: {most} times the energy");
            }
        }
    }
}

/// A body of which some axes are locked, on a joint whose motions they may forbid.
#[test]
fn locked_axes_and_joints_throw_nothing() {
    for (name, make) in KINDS {
        for case in 0..256_u32 {
            let bit = |i: u32| case >> i & 1 != 0;
            let mut world = World::new(Settings::default()).unwrap();
            let shape = || ShapeDesc::new(Geometry::cuboid(0.2, 0.3, 0.4));
            let mut desc = BodyDesc::dynamic().with_position(DVec3::Y * 2.0).with_shape(shape());
            (desc.lock_translation, desc.lock_rotation) = ([0, 1, 2].map(bit), [3, 4, 5].map(bit));
            desc.angular_velocity = Vec3::new(1.0, 2.0, 3.0);
            let a = world.add_body(&desc).unwrap();
            let other = BodyDesc::dynamic().with_position(DVec3::new(1.0, 2.0, 0.0)).with_shape(shape());
            let ground = BodyDesc::fixed();
            let b = world.add_body(if bit(6) { &other } else { &ground }).unwrap();
            let turned = Quat::from_rotation_y(0.5) * Quat::from_rotation_x(0.4);
            let q = if bit(7) { turned } else { Quat::IDENTITY };
            let frames = world.frames_at([a, b], DVec3::new(0.5, 2.0, 0.0), q).unwrap();
            world.add_joint(&make([a, b], frames)).unwrap();
            common::steps(&mut world, 120, DT);
            // In two seconds a free body falls to 20 m/s.
            for body in [a, b] {
                let (v, w) = (world.linear_velocity(body).unwrap(), world.angular_velocity(body).unwrap());
                assert!(v.length() < 25.0 && w.length() < 50.0, "{name}, case {case}: {v} {w}");
            }
        }
    }
}

const NAMES: [&str; 10] =
    ["fixed", "ball", "hinge", "slider", "distance", "wheel", "cone", "door", "spring", "axes"];

/// Two to five bodies in a tree or with loops, whirled as one, hit, or each on its way.
struct Case {
    world: World,
    bodies: Vec<BodyHandle>,
    dt: f32,
    name: String,
    /// Kinetic energy at the start, and that of a fall of two metres.
    scale: f64,
}

impl Case {
    /// `only`: the kind of all joints.
    fn random(seed: u64, only: Option<usize>) -> Case {
        let rng = &mut Random(seed.wrapping_mul(0x9E37_79B9_7F4A_7C15));
        let dt = [1.0 / 30.0, DT, 1.0 / 120.0, 1.0 / 240.0][rng.below(4)];
        let (substeps, iterations) = ([1, 2, 4, 8][rng.below(4)], if rng.chance(0.2) { 4 } else { 1 });
        let gravity = if rng.chance(0.3) { Vec3::Y * -9.81 } else { Vec3::ZERO };
        let settings =
            Settings::default().with_gravity(gravity).with_substeps(substeps).with_iterations(iterations);
        let mut case = Case {
            world: World::new(settings).unwrap(),
            bodies: Vec::new(),
            dt,
            name: format!("seed {seed}: {dt} s, {substeps} x {iterations}, gravity {}", gravity.y),
            scale: 0.0,
        };
        let ratio = if rng.chance(0.5) { 1.0 } else { log_range(rng, 1.0, 1e4) };
        let mut at = Vec::new();
        if rng.chance(0.35) {
            case.bodies.push(case.world.add_body(&BodyDesc::fixed()).unwrap());
            at.push(Vec3::ZERO);
        }
        let first = at.len();
        let mut mass = 0.0;
        for _ in 0..2 + rng.below(4) {
            let place = if at.is_empty() { Vec3::ZERO } else { at[rng.below(at.len())] };
            let (own, place) =
                (log_range(rng, 1.0, ratio + 1e-3), place + direction(rng) * rng.range(0.3, 2.0));
            let desc = lump(rng, own).with_position(place).with_rotation(rotation(rng));
            case.bodies.push(case.world.add_body(&desc).unwrap());
            at.push(place);
            mass += own;
        }
        for i in 1..at.len() {
            let other = rng.below(i);
            case.join(rng, [other, i], &at, only);
        }
        while only.is_none() && rng.chance(0.2) {
            let pair = [rng.below(at.len()), rng.below(at.len())];
            if pair[0] != pair[1] {
                case.join(rng, pair, &at, only);
            }
        }
        let (speed, spin, how) = (log_range(rng, 1.0, 1000.0), log_range(rng, 1.0, 1000.0), rng.below(3));
        let axis = direction(rng) * spin;
        for i in first..at.len() {
            let (v, w) = match how {
                0 => (axis.cross(at[i] - at[first]), axis),
                1 if i > first => (Vec3::ZERO, Vec3::ZERO),
                1 => (direction(rng) * speed, Vec3::ZERO),
                _ => (direction(rng) * speed, direction(rng) * spin),
            };
            case.scale -= case.world.energy();
            case.world.set_velocity(case.bodies[i], v, w).unwrap();
            case.scale += case.world.energy();
        }
        case.name +=
            &format!(", {} m/s, {} rad/s, way {how}, 1 : {}", speed as i32, spin as i32, ratio as i32);
        case.scale += f64::from(mass * 2.0 * -gravity.y);
        case
    }

    fn join(&mut self, rng: &mut Random, [i, j]: [usize; 2], at: &[Vec3], only: Option<usize>) {
        let pair = if rng.chance(0.5) { [i, j] } else { [j, i] }.map(|i| self.bodies[i]);
        let point = at[i].lerp(at[j], rng.range(-0.2, 1.2)) + rng.cube() * 0.3;
        let mut frames = self.world.frames_at(pair, point.as_dvec3(), rotation(rng)).unwrap();
        let damping = if rng.chance(0.5) { 0.0 } else { log_range(rng, 0.1, 1e4) };
        let spring = Spring::Coefficients { stiffness: log_range(rng, 1.0, 1e5), damping };
        let (one, round) = (Axes::One(Axis::X), Axes::Perpendicular(Axis::X));
        let range = Limit::new(Motion::Angular, one, -rng.range(0.0, 2.0), rng.range(0.0, 2.0));
        let cone = Limit::new(Motion::Angular, round, 0.0, rng.range(0.1, 2.0));
        let kind = only.unwrap_or_else(|| rng.below(NAMES.len()));
        self.name += &format!(", {}", NAMES[kind]);
        let desc = match kind {
            0 => JointDesc::fixed(pair, frames),
            1 => JointDesc::ball(pair, frames),
            2 => JointDesc::hinge(pair, frames),
            3 => JointDesc::slider(pair, frames),
            4 => {
                let (min, max) = [(0.0, 0.5), (0.2, 0.5), (0.5, 0.5), (0.5, 3.0)][rng.below(4)];
                frames[1].position += frames[1].rotation * (direction(rng) * rng.range(min, max));
                JointDesc::distance(pair, frames, min, max)
            }
            5 => JointDesc::wheel(pair, frames, 0.2, spring),
            6 => JointDesc::ball(pair, frames).with_limit(cone).with_limit(range),
            7 => JointDesc::hinge(pair, frames).with_limit(range),
            8 => JointDesc::hinge(pair, frames).with_motor(Motor::position(
                Motion::Angular,
                Axis::X,
                0.0,
                spring,
            )),
            _ => some_axes(rng, JointDesc::new(pair, frames)),
        };
        self.world.add_joint(&desc).unwrap();
    }

    /// The most that was gained in two seconds, as a share of the start. All numbers stay finite.
    fn gained(&mut self) -> f64 {
        let start = self.world.energy();
        (0..(2.0 / self.dt) as u32).fold(0.0, |most: f64, step| {
            self.world.step(self.dt).unwrap();
            let energy = self.world.energy();
            assert!(energy.is_finite(), "{}: step {step}", self.name);
            most.max((energy - start) / self.scale)
        })
    }
}

/// The counts above belong to these nets, so they are drawn as before, and not by the common methods.
fn rotation(rng: &mut Random) -> Quat {
    Quat::from_vec4(rng.cube().extend(rng.signed())).normalize()
}

fn direction(rng: &mut Random) -> Vec3 {
    rotation(rng) * Vec3::X
}

/// As often in each power of ten.
fn log_range(rng: &mut Random, low: f32, high: f32) -> f32 {
    low * (high / low).powf(rng.unit())
}

/// A box without a shape: nothing collides.
fn lump(rng: &mut Random, mass: f32) -> BodyDesc {
    let half = Vec3::new(rng.range(0.1, 0.5), rng.range(0.1, 0.5), rng.range(0.1, 0.5));
    let half = if rng.chance(0.3) { Vec3::splat(half.x) } else { half };
    let square = half * half * (mass / 3.0);
    let moments = Vec3::new(square.y + square.z, square.z + square.x, square.x + square.y);
    let mass = MassProperties { mass, centre_of_mass: Vec3::ZERO, inertia: Mat3::from_diagonal(moments) };
    BodyDesc::dynamic().with_mass(Some(mass))
}

/// Each axis locked, within a range, held by friction, or free.
fn some_axes(rng: &mut Random, mut desc: JointDesc) -> JointDesc {
    for motion in [Motion::Linear, Motion::Angular] {
        for axis in Axis::ALL {
            let range = Limit::new(motion, Axes::One(axis), -rng.range(0.0, 1.0), rng.range(0.0, 1.0));
            match rng.below(5) {
                0 | 1 => desc = desc.with_limit(Limit::lock(motion, Axes::One(axis))),
                2 => desc = desc.with_limit(range),
                3 => desc = desc.with_motor(Motor::friction(motion, axis, log_range(rng, 0.1, 1e4))),
                _ => {}
            }
        }
    }
    desc
}

/// Joints of one kind, in trees.
#[test]
fn trees_of_one_kind_gain_nothing() {
    for (kind, name) in NAMES.iter().enumerate().take(9) {
        for seed in 0..8 {
            let mut case = Case::random(1000 * kind as u64 + seed, Some(kind));
            let gained = case.gained();
            assert!(gained < 0.01, "{name}: {gained:.2e} gained, {}", case.name);
        }
    }
}

/// Nets of all kinds that gained more than 1 %.
fn sweep(seeds: std::ops::Range<u64>) -> usize {
    let gained = seeds.map(|seed| Case::random(seed, None)).filter_map(|mut case| {
        let gained = case.gained();
        (gained > 0.01).then(|| println!("{gained:.2e} gained, {}", case.name))
    });
    gained.count()
}

/// One in fifty nets of any joints still gains energy, by stiff springs and by axes that are locked one by
/// one (docs/joints.md); before energy was looked at it was one in five. All stay finite.
#[test]
fn nets_of_all_kinds_stay_finite_and_few_gain() {
    let gained = sweep(0..60);
    assert!(gained <= 1, "{gained} of 60");
}

#[test]
#[ignore = "minutes"]
fn thousands_of_nets_stay_finite_and_few_gain() {
    let gained = sweep(0..3000);
    println!("{gained} of 3000 gained more than 1 %");
    assert!(gained <= 60, "{gained} of 3000");
}
