//! Whatever the masses, a step leaves numbers, and what is joined stays joined.

mod common;

use backstop::glam::{DVec3, Quat, Vec3};
use backstop::{
    BodyDesc, BodyHandle, Geometry, JointDesc, JointHandle, Material, Settings, ShapeDesc, Skeleton, World,
};
use common::all_finite;
use std::f32::consts::FRAC_PI_2;

fn world(substeps: u32, length_unit: f32) -> World {
    World::new(Settings { substeps, length_unit, sleeping: false, ..Settings::default() }).unwrap()
}

/// Distance of a joint's two frames [m].
fn gap(world: &World, joint: JointHandle) -> f64 {
    let [(a, _), (b, _)] = world.joint_frames(joint).unwrap();
    (b - a).length()
}

/// A row of level links on ball joints, from a hook to a ball of so many times a link's mass.
struct Chain {
    world: World,
    joints: Vec<JointHandle>,
    bodies: Vec<BodyHandle>,
}

/// Of a link, between its joints [m].
const LINK: f64 = 0.4;

impl Chain {
    fn new(links: u32, ratio: f32, substeps: u32, scale: f64) -> Chain {
        let mut world = world(substeps, scale as f32);
        let hook = world.add_body(&BodyDesc::fixed()).unwrap();
        let (mut last, mut joints, mut bodies) = (hook, Vec::new(), Vec::new());
        let mut join = |world: &mut World, pair: [BodyHandle; 2], x: f64| {
            let frames = world.frames_at(pair, DVec3::X * x, Quat::IDENTITY).unwrap();
            joints.push(world.add_joint(&JointDesc::ball(pair, frames)).unwrap());
        };
        let mut mass = 0.0;
        for i in 0..links {
            let (radius, half) = (0.05 * scale as f32, 0.15 * scale as f32);
            let capsule = ShapeDesc::new(Geometry::capsule(half, radius));
            let at = DVec3::X * (LINK * scale * (f64::from(i) + 0.5));
            let desc =
                BodyDesc::dynamic().at(at).rotated(Quat::from_rotation_z(FRAC_PI_2)).with_shape(capsule);
            let link = world.add_body(&desc).unwrap();
            join(&mut world, [last, link], LINK * scale * f64::from(i));
            mass = world.mass(link).unwrap();
            bodies.push(link);
            last = link;
        }
        let radius = 0.25 * scale as f32;
        let at = LINK * scale * f64::from(links);
        let mut ball = ShapeDesc::new(Geometry::Sphere { radius });
        ball.density = mass * ratio / (4.0 / 3.0 * std::f32::consts::PI * radius.powi(3));
        let desc = BodyDesc::dynamic().at(DVec3::X * (at + f64::from(radius))).with_shape(ball);
        let ball = world.add_body(&desc).unwrap();
        join(&mut world, [last, ball], at);
        bodies.push(ball);
        Chain { world, joints, bodies }
    }
    fn open(&self) -> f64 {
        self.joints.iter().map(|&joint| gap(&self.world, joint)).fold(0.0, f64::max)
    }
}

/// The joints of a chain stay together within a hundredth of a link, whatever hangs on it, and the report says where a link
/// counts as heavier than it is.
fn check_chain(
    wrong: &mut Vec<String>,
    links: u32,
    ratio: f32,
    (hertz, substeps): (u32, u32),
    scale: f64,
    seconds: u32,
) {
    let mut chain = Chain::new(links, ratio, substeps, scale);
    let mut worst = 0.0_f64;
    let case = format!("{links} links, 1 : {ratio:e}, {hertz} Hz x {substeps}, x {scale}");
    for step in 0..seconds * hertz {
        let report = chain.world.step(1.0 / hertz as f32).unwrap();
        let (stopped, weighted) = (report.stopped, report.weighted_trees);
        assert_eq!(weighted, u32::from(ratio > 2.1e4), "{case}");
        worst = worst.max(chain.open() / (LINK * scale));
        if stopped > 0 || !all_finite(&chain.world) || worst > 0.01 {
            wrong.push(format!("{case}: {stopped} stopped in step {step}, open {worst:.1e}"));
            return;
        }
    }
    if ratio < 1e3 {
        return;
    }
    // The load swings: it has not got faster than by falling from level.
    let depth = 2.0 * (LINK * f64::from(links) + 0.25) * scale * 9.81;
    let heavy = *chain.bodies.last().unwrap();
    let speed = chain.world.linear_velocity(heavy).unwrap().length();
    if f64::from(speed) > 1.05 * depth.sqrt() {
        wrong.push(format!("{case}: {speed} m/s"));
    }
}

const CASES: [(u32, u32); 6] = [(60, 4), (30, 4), (120, 4), (60, 1), (60, 2), (60, 8)];

#[test]
fn chains_bear_any_load() {
    let mut wrong = Vec::new();
    for links in [1, 2, 5, 20] {
        for ratio in [1.0, 1e2, 1e3, 3e3, 5e3, 1e4, 1e5, 1e6] {
            for solver in CASES {
                let seconds = if solver == CASES[0] { 60 } else { 10 };
                check_chain(&mut wrong, links, ratio, solver, 1.0, seconds);
            }
        }
    }
    assert!(wrong.is_empty(), "{wrong:#?}");
}

#[test]
#[ignore = "measured: twenty links come apart after 31 s at 1 : 1e5 and 57 s at 1 : 1e6, both warm-started and reported as weighted"]
fn chains_bear_any_load_for_a_minute_at_120_hz() {
    let mut wrong = Vec::new();
    for (links, ratio) in
        [5, 20].into_iter().flat_map(|n| [1.0, 1e2, 1e3, 1e4, 1e5, 1e6].map(|ratio| (n, ratio)))
    {
        check_chain(&mut wrong, links, ratio, (120, 4), 1.0, 60);
    }
    assert!(wrong.is_empty(), "{wrong:#?}");
}

#[test]
fn chains_of_other_sizes_bear_any_load() {
    let mut wrong = Vec::new();
    for scale in [0.1, 10.0] {
        for (links, ratio) in [(2, 1e4), (2, 1e6), (10, 1e3), (10, 1e6)] {
            check_chain(&mut wrong, links, ratio, (60, 4), scale, 30);
        }
    }
    assert!(wrong.is_empty(), "{wrong:#?}");
}
/// A figure that hangs by a hand, with a ball at its foot: no bone is lost, and its joints stay together within 5 mm.
#[test]
fn a_figure_bears_a_load_at_its_foot() {
    figures(&[1.0, 1e3], 0.005);
}

/// The same with any load, where all that is asked for is that what a step leaves is finite.
#[test]
fn a_figure_with_any_load_at_its_foot_stays_finite() {
    figures(&[3e4, 1e6], f64::INFINITY);
}

#[test]
#[ignore = "limits and friction of its joints are rows that know only two bodies: finite, but it flies apart in most settings"]
fn a_figure_bears_any_load_at_its_foot() {
    figures(&[3e4, 1e6], 0.005);
}

/// `most`: by which a joint may open [m].
fn figures(loads: &[f32], most: f64) {
    let mut wrong = Vec::new();
    for (hertz, substeps) in CASES {
        for &load in loads {
            let mut world = world(substeps, 1.0);
            let hook = world.add_body(&BodyDesc::fixed()).unwrap();
            let figure =
                Skeleton::humanoid().add_to(&mut world, DVec3::ZERO, Quat::IDENTITY, Vec3::ZERO).unwrap();
            let ends = |i: usize| world.position(figure.bodies[i]).unwrap();
            let by = |way: DVec3| {
                (0..figure.bodies.len()).max_by(|&i, &k| ends(i).dot(way).total_cmp(&ends(k).dot(way)))
            };
            let (hand, foot) = (by(DVec3::Y).unwrap(), by(DVec3::NEG_Y).unwrap());
            let (top, low) = (ends(hand), ends(foot));
            let mut joints = figure.joints.clone();
            let hang = world.frames_at([hook, figure.bodies[hand]], top, Quat::IDENTITY).unwrap();
            joints.push(world.add_joint(&JointDesc::ball([hook, figure.bodies[hand]], hang)).unwrap());
            let mut ball = ShapeDesc::new(Geometry::Sphere { radius: 0.3 });
            ball.density = load / (4.0 / 3.0 * std::f32::consts::PI * 0.027);
            let at = low + DVec3::new(0.0, -0.5, 0.0);
            let ball = world.add_body(&BodyDesc::dynamic().at(at).with_shape(ball)).unwrap();
            let frames = world.frames_at([figure.bodies[foot], ball], low, Quat::IDENTITY).unwrap();
            joints.push(world.add_joint(&JointDesc::ball([figure.bodies[foot], ball], frames)).unwrap());
            let mut worst = 0.0_f64;
            for step in 0..20 * hertz {
                let stopped = world.step(1.0 / hertz as f32).unwrap().stopped;
                worst = joints.iter().map(|&joint| gap(&world, joint)).fold(worst, f64::max);
                if !all_finite(&world) || worst > most {
                    wrong.push(format!("{load} kg, {hertz} Hz x {substeps}: {stopped} stopped in step {step}, open {worst:.1e}"));
                    break;
                }
            }
            println!("{load} kg, {hertz} Hz x {substeps}: {worst:.1e}");
        }
    }
    assert!(wrong.is_empty(), "{wrong:#?}");
}

/// What no solver can do: forces at the end of what a number holds, on bodies alone, in contact and joined. Every step leaves
/// numbers, the report says how many bodies lost their motion, and what is sound goes on.
#[test]
fn no_step_leaves_what_is_no_number() {
    for joined in [false, true] {
        for scale in [1e12_f32, 1e20, 1e30, f32::MAX] {
            let mut world = world(4, 1.0);
            world.add_body(&common::Floor::Plane.desc(Material::default())).unwrap();
            let cube = |at: Vec3| common::dynamic(Geometry::cuboid(0.5, 0.5, 0.5), Material::default(), at);
            let pushed = [0.5, 1.5, 2.5].map(|y| world.add_body(&cube(Vec3::Y * y)).unwrap());
            let alone = world.add_body(&cube(Vec3::new(10.0, 0.5, 0.0))).unwrap();
            if joined {
                for pair in [[pushed[0], pushed[1]], [pushed[1], pushed[2]], [pushed[2], pushed[0]]] {
                    let frames = world.frames_at(pair, DVec3::X, Quat::IDENTITY).unwrap();
                    world.add_joint(&JointDesc::ball(pair, frames)).unwrap();
                }
            }
            let mut stopped = 0;
            for step in 0..240 {
                if step % 20 == 10 {
                    let (force, torque) = (Vec3::new(1.0, -1.0, 0.5), Vec3::new(1.0, 1.0, -1.0));
                    let force = if step % 40 == 10 { force } else { Vec3::ZERO };
                    world.add_force(pushed[step / 20 % 3], force * scale, torque * scale).unwrap();
                }
                stopped += world.step(1.0 / 60.0).unwrap().stopped;
                assert!(all_finite(&world), "{joined} {scale} {step}");
            }
            assert!(scale < 1e25 || stopped > 0, "{joined} {scale}: {stopped}");
            let at = world.position(alone).unwrap();
            assert!((at - DVec3::new(10.0, 0.5, 0.0)).length() < 0.01, "{joined} {scale}: {at}");
        }
    }
}
