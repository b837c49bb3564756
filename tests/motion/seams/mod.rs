//! Ground of many pieces is one surface: bodies that slide or roll over its seams go on as on a plane, and
//! steps, walls and gaps are felt.

use crate::common::G;
use crate::common::random::Random;
use backstop::glam::{DVec3, Quat, Vec2, Vec3};
use backstop::{BodyDesc, BodyHandle, ConvexHull, Geometry, Settings, World};
use floors::{Floor, hills, hilly, quads, rough};
use std::f32::consts::{FRAC_PI_2, TAU};

mod felt;
mod floors;
mod rest;

const RATES: [f32; 3] = [30.0, 60.0, 120.0];

/// A shape that rests on its bottom, how it is turned, and the height of its centre [m].
fn slider(kind: usize, size: f32, random: &mut Random) -> (&'static str, Geometry, Quat, f32) {
    let yaw = Quat::from_rotation_y(random.range(0.0, TAU));
    let lying = yaw * Quat::from_rotation_x(FRAC_PI_2);
    match kind {
        0 => ("box", Geometry::cuboid(size, 0.8 * size, 0.7 * size), yaw, 0.8 * size),
        1 => ("ball", Geometry::sphere(size), yaw, size),
        2 => ("capsule that lies", Geometry::capsule(size, 0.7 * size), lying, 0.7 * size),
        3 => ("capsule that stands", Geometry::capsule(0.6 * size, 0.7 * size), Quat::IDENTITY, 1.3 * size),
        4 => ("cylinder that stands", Geometry::cylinder(0.7 * size, size), yaw, 0.7 * size),
        5 => ("cylinder that lies", Geometry::cylinder(size, 0.8 * size), lying, 0.8 * size),
        6 => ("cone", Geometry::cone(0.5 * size, size), yaw, 0.5 * size),
        _ => {
            let n = 5 + random.below(8);
            let ring = |i: usize, y: f32| {
                let angle = TAU * i as f32 / n as f32;
                Vec3::new(size * libm::cosf(angle), y, size * libm::sinf(angle))
            };
            let points: Vec<Vec3> =
                (0..n).flat_map(|i| [ring(i, -0.6 * size), ring(i, 0.6 * size)]).collect();
            ("hull", Geometry::hull(ConvexHull::new(&points).unwrap()), yaw, 0.6 * size)
        }
    }
}

/// Result of a slide over a floor: speed that was kept, how far it went off its way [rad], and the highest
/// and the lowest that its centre was above where it lies [m].
#[derive(Clone, Copy, Debug)]
struct Slide {
    kept: f32,
    aside: f32,
    rise: f64,
    sink: f64,
}

fn slide(world: &mut World, body: BodyHandle, height: f32, speed: f32, seconds: f32, hz: f32) -> Slide {
    let (mut rise, mut sink) = (f64::MIN, f64::MAX);
    for _ in 0..(seconds * hz) as usize {
        world.step(1.0 / hz).unwrap();
        let y = world.position(body).unwrap().y - f64::from(height);
        (rise, sink) = (rise.max(y), sink.min(y));
    }
    let velocity = world.linear_velocity(body).unwrap();
    Slide { kept: velocity.x / speed, aside: velocity.z / speed, rise, sink }
}

/// So many random slides without friction; says how many did not go on as on a plane.
fn slides(seed: u64, count: usize) -> usize {
    let mut bad = 0;
    for case in 0..count {
        let mut random = Random(seed + case as u64);
        let hz = random.of(&RATES);
        let speed = libm::powf(10.0, random.range(0.0, 2.0));
        let length = (speed * 4.0).min(60.0);
        let floor = Floor::any(&mut random, length, 1e-3, 0.0);
        let kind = random.below(8);
        let size = random.range(0.1, 0.6);
        let (name, geometry, rotation, height) = slider(kind, size, &mut random);
        let mut world = World::new(Settings::default()).unwrap();
        floor.lay(&mut world, length + 2.0, &mut random);
        let at = DVec3::new(0.0, f64::from(height), f64::from(random.range(-0.2, 0.2)));
        let body = BodyDesc::dynamic()
            .with_position(at)
            .with_rotation(rotation)
            .with_velocity(Vec3::X * speed, Vec3::ZERO);
        // A body on a point falls over: a character does not.
        let stands = name == "capsule that stands";
        let body = body.with_lock_rotation([stands; 3]).with_shape(rough(geometry, 0.0));
        let body = world.add_body(&body).unwrap();
        let went = slide(&mut world, body, height, speed, length / speed, hz);
        // Steps down and up give and take energy.
        let most = 1e-3 + G as f32 * floor.step / (speed * speed);
        let even = (went.kept - 1.0).abs() < most && went.aside.abs() < most;
        if !even || went.rise > 1e-3 || went.sink < -2e-3 - f64::from(floor.step) {
            bad += 1;
            println!(
                "seed {} {name} {size:.2}, {speed:.1} m/s, {hz} Hz, {floor:?}: {went:?}",
                seed + case as u64
            );
        }
    }
    println!("{bad} of {count}");
    bad
}

/// A wheel that lies across x: how it is made, and its radius [m].
fn wheel(kind: usize, radius: f32) -> (&'static str, Geometry, Quat) {
    let across = Quat::from_rotation_x(FRAC_PI_2);
    match kind {
        0 => ("ball", Geometry::sphere(radius), Quat::IDENTITY),
        1 => ("cylinder", Geometry::cylinder(0.4 * radius, radius), across),
        2 => ("capsule", Geometry::capsule(0.3 * radius, radius), across),
        _ => {
            let ring = |i: usize, y: f32| {
                let angle = TAU * i as f32 / 48.0;
                Vec3::new(radius * libm::cosf(angle), y, radius * libm::sinf(angle))
            };
            let points: Vec<Vec3> =
                (0..48).flat_map(|i| [ring(i, -0.4 * radius), ring(i, 0.4 * radius)]).collect();
            ("hull", Geometry::hull(ConvexHull::new(&points).unwrap()), across)
        }
    }
}

/// Wheels that roll over tiled floors.
fn rolling(seed: u64, count: usize, one: Option<f32>) -> usize {
    let mut bad = 0;
    for case in 0..count {
        let mut random = Random(seed + case as u64);
        let hz = random.of(&RATES);
        let speed = libm::powf(10.0, random.range(0.0, 1.9));
        let length = (speed * 4.0).min(60.0);
        let floor = Floor::any(&mut random, length, 0.0, 0.6);
        let radius = random.range(0.15, 0.6);
        // A wheel that turns by more than this in a substep is not round to the rows of a step.
        let speed = speed.min(0.25 * radius * 4.0 * hz);
        let (name, geometry, rotation) = wheel(random.below(3), radius);
        let run = |flat: bool, random: &mut Random| {
            let mut world = World::new(Settings::default()).unwrap();
            if flat {
                world.add_body(&BodyDesc::fixed().with_shape(rough(Geometry::Plane, 0.6))).unwrap();
            } else if let Some(cell) = one {
                let half = 0.5 * length + 4.0;
                let mesh = quads(half, (2.0 * half / cell) as usize);
                let turn = Quat::from_rotation_y(floor.yaw);
                let body =
                    BodyDesc::fixed().with_position(DVec3::X * f64::from(0.5 * length)).with_rotation(turn);
                world.add_body(&body.with_shape(rough(Geometry::mesh(mesh), 0.6))).unwrap();
            } else {
                floor.lay(&mut world, length + 2.0, random);
            }
            let body = BodyDesc::dynamic()
                .with_position(DVec3::Y * f64::from(radius))
                .with_rotation(rotation)
                .with_velocity(Vec3::X * speed, Vec3::Z * (-speed / radius));
            let body = world.add_body(&body.with_shape(rough(geometry.clone(), 0.6))).unwrap();
            slide(&mut world, body, radius, speed, length / speed, hz)
        };
        let went = run(false, &mut random);
        let plane = run(true, &mut random);
        // A body on a line of a few decimetres goes straight on by nothing but that line.
        let kept = |slide: &Slide| slide.kept.hypot(slide.aside);
        let slower = (kept(&went) - kept(&plane)).abs() > 5e-3;
        if slower || went.rise > 1e-3 + 2.0 * plane.rise.max(0.0) || went.aside.abs() > 0.05 {
            bad += 1;
            println!(
                "seed {} {name} {radius:.2}, {speed:.1} m/s, {hz} Hz, {floor:?}: {went:?} plane {plane:?}",
                seed + case as u64
            );
        }
    }
    println!("{bad} of {count}");
    bad
}

/// Balls, capsules and boxes that slide over hills, of one mesh and of chunks.
fn over_hills(seed: u64, count: usize) -> usize {
    let mut bad = 0;
    for case in 0..count {
        let mut random = Random(seed + case as u64);
        let hz = random.of(&RATES);
        let speed = random.range(1.0, 15.0);
        let steep = random.range(0.02, 0.3);
        let friction = random.of(&[0.0, 0.3]);
        let size = random.range(0.15, 0.4);
        let cell = random.of(&[2.0, 4.0, 8.0]);
        let (name, geometry, rotation, height) = slider(random.below(4), size, &mut random);
        let run = |cell: f32| {
            let mut world = World::new(Settings::default()).unwrap();
            for i in 0..(48.0 / cell) as i32 {
                for k in 0..(16.0 / cell) as i32 {
                    if cell > 40.0 {
                        continue;
                    }
                    let from = Vec2::new(i as f32 * cell - 8.0, k as f32 * cell - 8.0);
                    let mesh = hilly(from, from + Vec2::splat(cell), steep);
                    let body = BodyDesc::fixed().with_shape(rough(Geometry::mesh(mesh), friction));
                    world.add_body(&body).unwrap();
                }
            }
            if cell > 40.0 {
                let mesh = hilly(Vec2::new(-8.0, -8.0), Vec2::new(40.0, 8.0), steep);
                world.add_body(&BodyDesc::fixed().with_shape(rough(Geometry::mesh(mesh), friction))).unwrap();
            }
            let at = Vec3::new(0.0, hills(0.0, 0.1, steep) + height + 0.02, 0.1);
            let stands = name == "capsule that stands";
            let body = BodyDesc::dynamic()
                .with_position(at.as_dvec3())
                .with_rotation(rotation)
                .with_velocity(Vec3::X * speed, Vec3::ZERO)
                .with_lock_rotation([stands; 3]);
            let body = world.add_body(&body.with_shape(rough(geometry.clone(), friction))).unwrap();
            let mut heights = Vec::new();
            let steps = ((30.0 / speed).min(4.0) * hz) as usize;
            for _ in 0..steps {
                world.step(1.0 / hz).unwrap();
                let at = world.position(body).unwrap().as_vec3();
                heights.push(at.y - hills(at.x, at.z, steep));
            }
            let speed = world.linear_velocity(body).unwrap().length();
            (speed, heights.iter().copied().fold(f32::MIN, f32::max), world.position(body).unwrap())
        };
        let (chunks, whole) = (run(cell), run(48.0));
        if (chunks.0 - whole.0).abs() > 0.05 * speed + 0.1 || chunks.1 > whole.1 + 0.05 {
            bad += 1;
            println!(
                "seed {} {name} {size:.2} {speed:.1} m/s {hz} Hz steep {steep} mu {friction} cell {cell}: {chunks:?} {whole:?}",
                seed + case as u64
            );
        }
    }
    println!("{bad} of {count}");
    bad
}

/// Boxes, balls, capsules, cylinders, cones and hulls without friction, at 1 to 100 m/s, over floors of
/// boxes, hulls, meshes and height fields of 0.3 to 4 m with gaps and steps of up to 1 mm. Expected: as on a
/// plane: the speed to a tenth of a percent, beside the changes by steps down and up, and no centre more than
/// a millimetre higher. Before, a box at 5 m/s stopped at the first seam, and at 20 m/s it flew 5 m high.
#[test]
fn what_slides_over_a_floor_of_pieces_goes_on_as_on_a_plane() {
    assert_eq!(slides(1, 300), 0);
}

/// The same for six thousand. Expected: no more than two in a thousand are off, by the speed that a body on
/// the border of a piece gains or loses.
#[test]
#[ignore = "takes minutes"]
fn thousands_that_slide_over_a_floor_of_pieces_go_on() {
    assert!(slides(1, 6000) <= 12);
}

/// Balls, capsules and cylinders that roll over the same floors without steps, and on one mesh of fine
/// triangles. Expected: as fast as on a plane to half a percent, and no higher than a millimetre and twice
/// their rise there; on one mesh all of them, on pieces at least nineteen of twenty.
#[test]
fn wheels_roll_over_seams_as_on_a_plane() {
    assert!(rolling(1, 100, None) <= 5);
    assert!(rolling(1, 40, Some(0.2)) == 0);
    assert!(rolling(1, 40, Some(1.0)) == 0);
}

/// Bodies that slide over hills of chunks. Expected: as over the same hills of one mesh, within a twentieth
/// of the speed, and as close to the ground to 5 cm; nineteen of twenty, because paths part where one takes
/// off.
#[test]
fn hills_of_chunks_are_those_of_one_mesh() {
    assert!(over_hills(1, 40) <= 2);
}
