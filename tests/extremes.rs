//! Whatever the masses, a step leaves numbers, and what is joined stays joined.

mod common;

use backstop::glam::{DVec3, Quat};
use backstop::{BodyDesc, BodyHandle, Geometry, JointDesc, JointHandle, Settings, ShapeDesc, World};
use common::all_finite;
use std::f32::consts::FRAC_PI_2;

fn world(substeps: u32) -> World {
    World::new(Settings { substeps, sleeping: false, ..Settings::default() }).unwrap()
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
        let mut world = world(substeps);
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

#[test]
#[ignore]
fn print_chains() {
    for links in [1, 2, 5, 20] {
        for (hertz, substeps) in [(60, 4), (120, 4), (30, 4), (60, 1), (60, 8)] {
            let mut line = format!("{links:2} links {hertz:3} Hz x {substeps}:");
            for ratio in [1.0, 1e2, 1e3, 3e3, 1e4, 1e5, 1e6] {
                let mut chain = Chain::new(links, ratio, substeps, 1.0);
                let (mut worst, mut fast, mut end) = (0.0_f64, 0.0_f32, None);
                for step in 0..10 * hertz {
                    chain.world.step(1.0 / hertz as f32).unwrap();
                    if !all_finite(&chain.world) {
                        end = Some(step);
                        break;
                    }
                    worst = worst.max(chain.open());
                    for &b in &chain.bodies {
                        fast = fast.max(chain.world.angular_velocity(b).unwrap().length());
                    }
                }
                line += &match end {
                    Some(step) => format!(" NaN@{step}"),
                    None => format!(" {worst:.0e}/{fast:.0e}"),
                };
            }
            println!("{line}");
        }
    }
}
#[test]
#[ignore]
fn debug_chain() {
    let get = |name: &str| std::env::var(name).unwrap().parse::<f32>().unwrap();
    let mut chain = Chain::new(get("LINKS") as u32, get("RATIO"), get("SUB") as u32, 1.0);
    for step in 0..get("STEPS") as u32 {
        eprintln!("step {step} open {:.2e}", chain.open());
        chain.world.step(1.0 / get("HZ")).unwrap();
    }
}
