//! Loops of joints: a body that is held twice moves as if held once, and stays together.

use crate::common;

use backstop::glam::{DVec3, Quat, Vec3};
use backstop::{BodyDesc, BodyHandle, Geometry, JointDesc, JointHandle, Settings, ShapeDesc, World};
use std::f32::consts::FRAC_PI_2;

fn world(substeps: u32) -> World {
    World::new(Settings::default().with_substeps(substeps).with_sleeping(false)).unwrap()
}

fn widest(world: &World, joints: &[JointHandle]) -> f64 {
    let gap = |&joint: &JointHandle| {
        let [(a, _), (b, _)] = world.joint_frames(joint).unwrap();
        (b - a).length()
    };
    joints.iter().map(gap).fold(0.0, f64::max)
}

/// A flap of 1 m by 2 m that hangs level on hinges along one edge and falls. By the conservation of energy it
/// comes to the other side as high as it started, however many hinges hold it: most rows of the others are
/// held by the first.
#[test]
fn a_flap_swings_on_one_hinge_as_on_two_or_three() {
    for (hertz, substeps) in [(60, 4), (30, 4), (120, 4), (60, 1), (60, 8)] {
        for hinges in 1..=3_u32 {
            let mut world = world(substeps);
            let wall = world.add_body(&BodyDesc::fixed()).unwrap();
            let flap = ShapeDesc::new(Geometry::cuboid(0.5, 0.02, 1.0));
            let flap =
                world.add_body(&BodyDesc::dynamic().with_position(DVec3::X * 0.5).with_shape(flap)).unwrap();
            // The hinge's own axis is its frame's x.
            let axes = Quat::from_rotation_y(-FRAC_PI_2);
            let joints: Vec<_> = (0..hinges)
                .map(|i| {
                    let at = DVec3::Z * (f64::from(i) - 0.5 * f64::from(hinges - 1)) * 0.8;
                    let frames = world.frames_at([wall, flap], at, axes).unwrap();
                    world.add_joint(&JointDesc::hinge([wall, flap], frames)).unwrap()
                })
                .collect();
            let start = world.energy();
            let (mut open, mut most, mut least) = (0.0_f64, f64::NEG_INFINITY, f64::INFINITY);
            let (mut fastest, mut highest) = (0.0_f64, f64::NEG_INFINITY);
            for step in 0..60 * hertz {
                world.step(1.0 / hertz as f32).unwrap();
                open = open.max(widest(&world, &joints));
                let energy = world.energy();
                (most, least) = (most.max(energy), least.min(energy));
                fastest = fastest.max(f64::from(world.angular_velocity(flap).unwrap().length()));
                if step > 50 * hertz {
                    highest = highest.max(world.position(flap).unwrap().y);
                }
            }
            // At its lowest: m g l / 2 = I w^2 / 2 with I = m l^2 / 3 (and its thickness), so w^2 = 3 g / l.
            let scale = f64::from(world.mass(flap).unwrap()) * common::G * 0.5;
            let text = format!(
                "{hertz} Hz x {substeps}, {hinges} hinges: energy {:.2e} to {:.2e} of its swing, open {open:.1e} m, {fastest:.3} rad/s, up to {highest:.4} m",
                (least - start) / scale,
                (most - start) / scale
            );
            println!("{text}");
            assert!(open < 1e-4, "{text}");
            assert!((least - start) / scale > -0.01 && (most - start) / scale < 0.005, "{text}");
            assert!((fastest / (3.0 * common::G).sqrt() - 1.0).abs() < 0.01, "{text}");
            assert!(highest > -0.01 - 0.5 * (fastest / f64::from(hertz)).powi(2), "{text}");
        }
    }
}

/// Four beams welded to a frame, dropped flat and on a corner: it lies still and is whole.
#[test]
fn a_frame_of_welds_falls_and_lies_still() {
    for (substeps, tilt) in [(4, 0.0), (4, 0.4), (1, 0.0), (8, 0.4)] {
        let mut world = world(substeps);
        let floor = BodyDesc::fixed().with_shape(ShapeDesc::new(Geometry::Plane));
        world.add_body(&floor).unwrap();
        let turn = Quat::from_rotation_x(tilt) * Quat::from_rotation_z(0.7 * tilt);
        let beams: Vec<BodyHandle> = (0..4)
            .map(|i| {
                let side = Quat::from_rotation_y(i as f32 * FRAC_PI_2);
                let at = (turn * side * Vec3::Z * 0.9).as_dvec3() + DVec3::Y;
                let beam = ShapeDesc::new(Geometry::cuboid(0.8, 0.1, 0.1));
                world
                    .add_body(
                        &BodyDesc::dynamic().with_position(at).with_rotation(turn * side).with_shape(beam),
                    )
                    .unwrap()
            })
            .collect();
        let joints: Vec<_> = (0..4)
            .map(|i| {
                let pair = [beams[i], beams[(i + 1) % 4]];
                let at = 0.5 * (world.position(pair[0]).unwrap() + world.position(pair[1]).unwrap());
                let frames = world.frames_at(pair, at, Quat::IDENTITY).unwrap();
                world.add_joint(&JointDesc::fixed(pair, frames)).unwrap()
            })
            .collect();
        let mut open = 0.0_f64;
        for _ in 0..600 {
            world.step(1.0 / 60.0).unwrap();
            open = open.max(widest(&world, &joints));
        }
        let speed = beams.iter().map(|&b| world.linear_velocity(b).unwrap().length()).fold(0.0, f32::max);
        let low = beams.iter().map(|&b| world.position(b).unwrap().y).fold(f64::INFINITY, f64::min);
        println!("{substeps}, {tilt}: open {open:.2e} m, {speed:.1e} m/s, {low:.4} m");
        assert!(open < 0.005 && widest(&world, &joints) < 1e-3, "{substeps}, {tilt}: {open}");
        assert!(speed < 1e-3 && (low - 0.1).abs() < 0.005, "{substeps}, {tilt}: {speed} m/s, {low} m");
    }
}

/// A rope between two hooks of one height hangs in a catenary: of 40 links of 0.1 m over a span of 3 m its
/// lowest point is where a sinh(s / 2a) = l / 2 puts it, with the sag a (cosh(s / 2a) - 1).
#[test]
fn a_rope_between_two_hooks_hangs_in_a_catenary() {
    let (links, length, span) = (40_u32, 4.0_f64, 3.0_f64);
    let (mut low, mut high) = (0.1_f64, 10.0_f64);
    for _ in 0..100 {
        let a = 0.5 * (low + high);
        if 2.0 * a * (span / (2.0 * a)).sinh() > length { low = a } else { high = a }
    }
    let sag = low * ((span / (2.0 * low)).cosh() - 1.0);
    let mut world = world(4);
    let wall = world.add_body(&BodyDesc::fixed()).unwrap();
    let half = 0.5 * length / f64::from(links);
    // Put up as a V, which has the same length, so that it is closed.
    let depth = (0.25 * (length * length - span * span)).sqrt();
    let ends: Vec<DVec3> = (0..=links)
        .map(|i| {
            let at = f64::from(i) / f64::from(links);
            DVec3::new(span * (at - 0.5), -depth * (1.0 - (2.0 * at - 1.0).abs()), 0.0)
        })
        .collect();
    let mut last = wall;
    let mut bodies = Vec::new();
    let mut joints = Vec::new();
    for pair in ends.windows(2) {
        let way = (pair[1] - pair[0]).as_vec3();
        let shape = ShapeDesc::new(Geometry::cuboid(half as f32, 0.01, 0.01));
        let mut desc = BodyDesc::dynamic()
            .with_position(0.5 * (pair[0] + pair[1]))
            .with_rotation(Quat::from_rotation_arc(Vec3::X, way.normalize()))
            .with_shape(shape);
        desc.shapes[0].filter.mask = 0;
        let link = world.add_body(&desc).unwrap();
        let frames = world.frames_at([last, link], pair[0], Quat::IDENTITY).unwrap();
        joints.push(world.add_joint(&JointDesc::ball([last, link], frames)).unwrap());
        bodies.push(link);
        last = link;
    }
    let frames = world.frames_at([last, wall], ends[links as usize], Quat::IDENTITY).unwrap();
    joints.push(world.add_joint(&JointDesc::ball([last, wall], frames)).unwrap());
    for _ in 0..60 * 40 {
        world.step(1.0 / 60.0).unwrap();
        // Nothing in the scene takes energy.
        for &link in &bodies {
            let (v, w) = (world.linear_velocity(link).unwrap(), world.angular_velocity(link).unwrap());
            world.set_velocity(link, v * 0.98, w * 0.98).unwrap();
        }
    }
    // The lowest joint is between the two links in the middle.
    let [(lowest, _), _] = world.joint_frames(joints[links as usize / 2]).unwrap();
    println!("{:.4} m, a catenary {sag:.4}; open {:.1e}", -lowest.y, widest(&world, &joints));
    // Links of a tenth of a metre instead of a curve: within a thousandth of the length.
    assert!((-lowest.y - sag).abs() < 0.001 * length, "{} {sag}", -lowest.y);
    assert!(widest(&world, &joints) < 1e-4);
}
