//! Ground of many pieces is one surface: what slides or rolls over its seams goes on as on a plane, and what
//! is no seam (a step, a wall, a gap) is felt.

use crate::common::G;
use crate::common::random::Random;
use backstop::glam::{DVec3, Quat, Vec2, Vec3};
use backstop::{
    BodyDesc, BodyHandle, ConvexHull, Geometry, HeightField, Settings, ShapeDesc, TriangleMesh, World,
};
use std::f32::consts::{FRAC_PI_2, TAU};

/// What a floor is laid with.
#[derive(Clone, Copy, Debug, PartialEq)]
enum Tile {
    /// Boxes, each a body.
    Boxes,
    /// Boxes on one body.
    Compound,
    /// Hulls of boxes.
    Hulls,
    /// Meshes of flat quads, some to a side.
    Chunks,
    /// Closed meshes of boxes.
    Slabs,
    Fields,
    /// Each of these at random.
    Mixed,
}

const TILES: [Tile; 7] =
    [Tile::Boxes, Tile::Compound, Tile::Hulls, Tile::Chunks, Tile::Slabs, Tile::Fields, Tile::Mixed];

/// A floor of tiles with its top at y = 0.
#[derive(Clone, Copy, Debug)]
struct Floor {
    tile: Tile,
    /// Edge of a tile, and its thickness [m].
    cell: f32,
    depth: f32,
    /// Turn of the grid against the way [rad].
    yaw: f32,
    /// Between tiles [m].
    gap: f32,
    /// Tiles lie lower by up to this [m].
    step: f32,
    /// Whether every other row is shifted by half a tile.
    staggered: bool,
    friction: f32,
}

fn rough(geometry: Geometry, friction: f32) -> ShapeDesc {
    let mut shape = ShapeDesc::new(geometry);
    (shape.material.static_friction, shape.material.dynamic_friction) = (friction, friction);
    shape
}

fn corners(half: Vec3) -> Vec<Vec3> {
    (0..8).map(|i| half * Vec3::new(sign(i), sign(i >> 1), sign(i >> 2))).collect()
}

fn sign(bit: usize) -> f32 {
    if bit & 1 == 0 { -1.0 } else { 1.0 }
}

/// The faces of a box, each two triangles that wind counter-clockwise, as seen from outside.
fn box_mesh(half: Vec3) -> TriangleMesh {
    let quads = [[0, 4, 6, 2], [1, 3, 7, 5], [0, 1, 5, 4], [2, 6, 7, 3], [0, 2, 3, 1], [4, 5, 7, 6]];
    let triangles = quads.iter().flat_map(|&[a, b, c, d]| [[a, b, c], [a, c, d]]).collect();
    TriangleMesh::new(corners(half), triangles).unwrap()
}

/// A flat mesh of so many quads to a side.
fn quads(half: f32, count: usize) -> TriangleMesh {
    let at = |i: usize| (2.0 * i as f32 / count as f32 - 1.0) * half;
    let vertices = (0..=count).flat_map(|k| (0..=count).map(move |i| Vec3::new(at(i), 0.0, at(k)))).collect();
    let mut triangles = Vec::new();
    for k in 0..count {
        for i in 0..count {
            let a = (k * (count + 1) + i) as u32;
            let (b, c) = (a + 1, a + count as u32 + 1);
            triangles.extend([[a, c, b], [b, c, c + 1]]);
        }
    }
    TriangleMesh::new(vertices, triangles).unwrap()
}

impl Floor {
    /// The shape of a tile with the middle of its top at the origin.
    fn shape(&self, random: &mut Random) -> ShapeDesc {
        let half = Vec3::new(0.5 * (self.cell - self.gap), 0.5 * self.depth, 0.5 * (self.cell - self.gap));
        let below = Vec3::NEG_Y * half.y;
        let kind = match self.tile {
            Tile::Mixed => random.of(&TILES[..6]),
            tile => tile,
        };
        let tile_of = |geometry| rough(geometry, self.friction);
        let count = 1 + random.below(5);
        match kind {
            Tile::Chunks => tile_of(Geometry::mesh(quads(half.x, count))),
            Tile::Slabs => tile_of(Geometry::mesh(box_mesh(half))).with_position(below),
            Tile::Hulls => {
                tile_of(Geometry::hull(ConvexHull::new(&corners(half)).unwrap())).with_position(below)
            }
            Tile::Fields => {
                let cells = Vec2::splat(2.0 * half.x / count as f32);
                let field =
                    HeightField::new(count + 1, count + 1, cells, vec![0.0; (count + 1) * (count + 1)]);
                tile_of(Geometry::height_field(field.unwrap()))
                    .with_position(Vec3::new(-half.x, 0.0, -half.x))
            }
            _ => tile_of(Geometry::cuboid(half.x, half.y, half.z)).with_position(below),
        }
    }

    /// Lays the floor along x, from -3 m to `length`, 3 m to each side.
    fn lay(&self, world: &mut World, length: f32, random: &mut Random) {
        let turn = Quat::from_rotation_y(self.yaw);
        let reach = (length + 8.0) / self.cell;
        let most = reach as i32 + 2;
        let mut parts = Vec::new();
        for row in -most..=most {
            for column in -most..=most {
                let shift = if self.staggered && row % 2 != 0 { 0.5 } else { 0.0 };
                let local = Vec3::new((column as f32 + shift) * self.cell, 0.0, row as f32 * self.cell);
                let at = turn * local;
                let side = 0.71 * self.cell + 1.5;
                if at.x < -1.5 - side || at.x > length + side || at.z.abs() > side {
                    continue;
                }
                let at = at - Vec3::Y * random.range(0.0, self.step);
                let shape = self.shape(random);
                if self.tile == Tile::Compound {
                    let place = shape.position;
                    parts.push(shape.with_position(at + turn * place).with_rotation(turn));
                } else {
                    let body = BodyDesc::fixed().at(at.as_dvec3()).rotated(turn).with_shape(shape);
                    world.add_body(&body).unwrap();
                }
            }
        }
        if !parts.is_empty() {
            world.add_body(&BodyDesc::fixed().with_shapes(parts)).unwrap();
        }
    }
}

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

/// What a slide over a floor came to: speed that was kept, how far it went off its way [rad], and the highest
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
        if std::env::var("SEAMS").is_ok() {
            eprintln!(
                "at {:?} v {:?} w {:?}",
                world.position(body).unwrap(),
                world.linear_velocity(body).unwrap(),
                world.angular_velocity(body).unwrap()
            );
        }
    }
    let velocity = world.linear_velocity(body).unwrap();
    Slide { kept: velocity.x / speed, aside: velocity.z / speed, rise, sink }
}

/// So many random slides without friction; says how many did not go on as on a plane.
fn slides(seed: u64, count: usize) -> usize {
    let mut bad = 0;
    for case in 0..count {
        let mut random = Random(seed + case as u64);
        let hz = random.of(&[30.0, 60.0, 120.0]);
        let speed = libm::powf(10.0, random.range(0.0, 2.0));
        let length = (speed * 4.0).min(60.0);
        let floor = Floor {
            tile: random.of(&TILES),
            cell: random.range(0.3, 4.0).max(length / 80.0),
            depth: random.range(0.1, 1.0),
            yaw: if random.chance(0.4) { 0.0 } else { random.range(0.0, TAU) },
            gap: if random.chance(0.5) { 0.0 } else { random.range(0.0, 1e-3) },
            step: if random.chance(0.5) { 0.0 } else { random.range(0.0, 1e-3) },
            staggered: random.chance(0.3),
            friction: 0.0,
        };
        let kind = random.below(8);
        let size = random.range(0.1, 0.6);
        let (name, geometry, rotation, height) = slider(kind, size, &mut random);
        let mut world = World::new(Settings::default()).unwrap();
        floor.lay(&mut world, length + 2.0, &mut random);
        let at = DVec3::new(0.0, f64::from(height), f64::from(random.range(-0.2, 0.2)));
        let body = BodyDesc::dynamic().at(at).rotated(rotation).moving(Vec3::X * speed, Vec3::ZERO);
        // What stands on a point falls over: a character does not.
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
        let hz = random.of(&[30.0, 60.0, 120.0]);
        let speed = libm::powf(10.0, random.range(0.0, 1.9));
        let length = (speed * 4.0).min(60.0);
        let floor = Floor {
            tile: random.of(&TILES),
            cell: random.range(0.3, 4.0).max(length / 80.0),
            depth: random.range(0.1, 1.0),
            yaw: if random.chance(0.4) { 0.0 } else { random.range(0.0, TAU) },
            gap: if random.chance(0.5) { 0.0 } else { random.range(0.0, 1e-3) },
            step: 0.0,
            staggered: random.chance(0.3),
            friction: 0.6,
        };
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
                let body = BodyDesc::fixed().at(DVec3::X * f64::from(0.5 * length)).rotated(turn);
                world.add_body(&body.with_shape(rough(Geometry::mesh(mesh), 0.6))).unwrap();
            } else {
                floor.lay(&mut world, length + 2.0, random);
            }
            let body = BodyDesc::dynamic()
                .at(DVec3::Y * f64::from(radius))
                .rotated(rotation)
                .moving(Vec3::X * speed, Vec3::Z * (-speed / radius));
            let body = world.add_body(&body.with_shape(rough(geometry.clone(), 0.6))).unwrap();
            slide(&mut world, body, radius, speed, length / speed, hz)
        };
        let went = run(false, &mut random);
        let plane = run(true, &mut random);
        // What lies on a line of a few decimetres goes straight on by nothing but that line.
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

/// Height of rolling ground [m], and the way from which it is measured.
fn hills(x: f32, z: f32, steep: f32) -> f32 {
    steep * (libm::sinf(0.5 * x) + 0.4 * libm::sinf(0.9 * z + 0.3 * x))
}

/// A mesh of the hills between two corners, of squares of a quarter metre.
fn hilly(from: Vec2, to: Vec2, steep: f32) -> TriangleMesh {
    let cells = [(to.x - from.x) * 4.0, (to.y - from.y) * 4.0].map(|n| libm::roundf(n) as usize);
    let mut vertices = Vec::new();
    for k in 0..=cells[1] {
        for i in 0..=cells[0] {
            let at = from + Vec2::new(i as f32, k as f32) * 0.25;
            vertices.push(Vec3::new(at.x, hills(at.x, at.y, steep), at.y));
        }
    }
    let mut triangles = Vec::new();
    let row = cells[0] as u32 + 1;
    for k in 0..cells[1] as u32 {
        for i in 0..cells[0] as u32 {
            let a = k * row + i;
            triangles.extend([[a, a + row, a + 1], [a + 1, a + row, a + row + 1]]);
        }
    }
    TriangleMesh::new(vertices, triangles).unwrap()
}

/// Balls, capsules and boxes that slide over hills, of one mesh and of chunks.
fn over_hills(seed: u64, count: usize) -> usize {
    let mut bad = 0;
    for case in 0..count {
        let mut random = Random(seed + case as u64);
        let hz = random.of(&[30.0, 60.0, 120.0]);
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
                .at(at.as_dvec3())
                .rotated(rotation)
                .moving(Vec3::X * speed, Vec3::ZERO)
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

/// A row of boxes of `edge` metres from -2 m on along x, with its top at `top`, and their number.
fn row(world: &mut World, edge: f32, from: f32, to: f32, top: f32) {
    let mut x = from;
    while x < to {
        for k in -2..=2 {
            let at = Vec3::new(x + 0.5 * edge, top - 0.5 * edge, k as f32 * edge);
            let half = 0.5 * edge;
            let shape = rough(Geometry::cuboid(half, half, half), 0.0);
            world.add_body(&BodyDesc::fixed().at(at.as_dvec3()).with_shape(shape)).unwrap();
        }
        x += edge;
    }
}

fn push(world: &mut World, geometry: Geometry, height: f32, speed: f32) -> BodyHandle {
    let body = BodyDesc::dynamic().at(DVec3::Y * f64::from(height)).moving(Vec3::X * speed, Vec3::ZERO);
    world.add_body(&body.with_shape(rough(geometry, 0.0))).unwrap()
}

/// Steps a world for so many seconds, and says how far along x the body got at most [m].
fn furthest(world: &mut World, body: BodyHandle, seconds: f32, hz: f32) -> f64 {
    let mut most = f64::MIN;
    for _ in 0..(seconds * hz) as usize {
        world.step(1.0 / hz).unwrap();
        most = most.max(world.position(body).unwrap().x);
    }
    most
}

const RATES: [f32; 3] = [30.0, 60.0, 120.0];

/// Boxes, balls, capsules, cylinders, cones and hulls without friction, at 1 to 100 m/s, over floors of
/// boxes, hulls, meshes and height fields of 0.3 to 4 m with gaps and steps of up to 1 mm. Expected: as on a
/// plane: the speed to a tenth of a percent, beside what steps down and up give and take, and no centre more
/// than a millimetre higher. Before, a box at 5 m/s stopped at the first seam, and at 20 m/s it flew 5 m
/// high.
#[test]
fn what_slides_over_a_floor_of_pieces_goes_on_as_on_a_plane() {
    assert_eq!(slides(1, 300), 0);
}

/// The same for six thousand. Expected: no more than two in a thousand are off, by what a body that leans on
/// the border of a piece gains or loses.
#[test]
#[ignore = "takes minutes"]
fn thousands_that_slide_over_a_floor_of_pieces_go_on() {
    assert!(slides(1, 6000) <= 12);
}

/// Balls, capsules and cylinders that roll over the same floors without steps, and on one mesh of fine
/// triangles. Expected: as fast as on a plane to half a percent, and no higher than a millimetre and twice
/// what they rise there; on one mesh all of them, on pieces at least nineteen of twenty.
#[test]
fn wheels_roll_over_seams_as_on_a_plane() {
    assert!(rolling(1, 100, None) <= 5);
    assert!(rolling(1, 40, Some(0.2)) == 0);
    assert!(rolling(1, 40, Some(1.0)) == 0);
}

/// What slides over hills of chunks. Expected: as over the same hills of one mesh, within a twentieth of the
/// speed, and as close to the ground to 5 cm; nineteen of twenty, because paths part where one takes off.
#[test]
fn hills_of_chunks_are_those_of_one_mesh() {
    assert!(over_hills(1, 40) <= 2);
}

/// A step of 5 mm is none of the gaps that are passed over. Expected: a ball of 25 cm at 2 m/s loses to its
/// edge what leads into that, 1 - cos(0.2), and climbs: 1.93 m/s are left, less for what a step is long; a
/// box that strikes it with its side is thrown back, and comes no further than it tips.
#[test]
fn a_step_is_felt() {
    for hz in RATES {
        for ball in [true, false] {
            let mut world = World::new(Settings::default()).unwrap();
            row(&mut world, 0.5, -2.0, 2.0, 0.0);
            row(&mut world, 0.5, 2.0, 6.0, 0.005);
            let shape = if ball { Geometry::sphere(0.25) } else { Geometry::cuboid(0.25, 0.25, 0.25) };
            let body = push(&mut world, shape, 0.25, 2.0);
            let most = furthest(&mut world, body, 2.0, hz);
            let (speed, at) = (world.linear_velocity(body).unwrap().x, world.position(body).unwrap());
            if ball {
                assert!(
                    (1.82..1.95).contains(&speed) && (at.y - 0.255).abs() < 1e-3,
                    "{hz} Hz: {speed} {at}"
                );
            } else {
                assert!(most < 1.9 && speed < 0.1, "{hz} Hz: {most} {speed}");
            }
        }
    }
}

/// A wall of boxes on a floor of boxes, at 1 to 100 m/s. Expected: nothing gets into it by more than a tenth
/// of a millimetre, or off the floor before it.
#[test]
fn a_wall_of_boxes_stops() {
    for hz in RATES {
        for speed in [1.0, 5.0, 20.0, 100.0] {
            for shape in
                [Geometry::sphere(0.25), Geometry::cuboid(0.25, 0.25, 0.25), Geometry::cylinder(0.25, 0.25)]
            {
                let mut world = World::new(Settings::default()).unwrap();
                row(&mut world, 0.5, -2.0, 6.0, 0.0);
                for k in 1..=4 {
                    row(&mut world, 0.5, 4.0, 4.5, 0.5 * k as f32);
                }
                let name = format!("{hz} Hz, {speed} m/s, {shape:?}");
                let body = push(&mut world, shape, 0.25, speed);
                let most = furthest(&mut world, body, 4.0 / speed + 0.2, hz);
                assert!((3.7..3.7501).contains(&most), "{name}: {most}");
            }
        }
    }
}

/// A gap of 40 cm takes a ball of 30. Expected: at 1 m/s it falls in.
#[test]
fn a_gap_that_is_wide_enough_takes_a_ball() {
    for hz in RATES {
        let mut world = World::new(Settings::default()).unwrap();
        row(&mut world, 0.5, -2.0, 2.0, 0.0);
        row(&mut world, 0.5, 2.4, 6.0, 0.0);
        let body = push(&mut world, Geometry::sphere(0.15), 0.15, 1.0);
        furthest(&mut world, body, 4.0, hz);
        let at = world.position(body).unwrap();
        assert!(at.y < -1.0 && (2.1..2.3).contains(&at.x), "{hz} Hz: {at}");
    }
}

/// An inner corner of a wall of boxes and a long box. Expected: a ball that slides into it stays in both.
#[test]
fn an_inner_corner_holds() {
    for hz in RATES {
        let mut world = World::new(Settings::default()).unwrap();
        row(&mut world, 0.5, -2.0, 6.0, 0.0);
        for k in 1..=4 {
            row(&mut world, 0.5, 4.0, 4.5, 0.5 * k as f32);
        }
        let side = BodyDesc::fixed().at(DVec3::new(0.0, 0.5, 1.5));
        world.add_body(&side.with_shape(rough(Geometry::cuboid(6.0, 1.0, 0.5), 0.0))).unwrap();
        let body = push(&mut world, Geometry::sphere(0.25), 0.25, 5.0);
        world.set_linear_velocity(body, Vec3::new(5.0, 0.0, 3.0)).unwrap();
        furthest(&mut world, body, 3.0, hz);
        let off = (world.position(body).unwrap() - DVec3::new(3.75, 0.25, 0.75)).length();
        assert!(off < 1e-3, "{hz} Hz: {off}");
    }
}

/// A lift of boxes that goes along and up. Expected: what slides on it without friction keeps its speed, and
/// goes up with it.
#[test]
fn a_lift_of_boxes_is_one_surface() {
    for hz in RATES {
        let mut world = World::new(Settings::default()).unwrap();
        let places =
            (-8..24).flat_map(|i| (-2..3).map(move |k| Vec3::new(0.5 * i as f32, -0.25, 0.5 * k as f32)));
        let shapes = places.map(|at| rough(Geometry::cuboid(0.25, 0.25, 0.25), 0.0).with_position(at));
        let lift = BodyDesc::kinematic().moving(Vec3::new(3.0, 1.0, 0.0), Vec3::ZERO);
        world.add_body(&lift.with_shapes(shapes.collect::<Vec<_>>())).unwrap();
        let body = push(&mut world, Geometry::cuboid(0.2, 0.2, 0.2), 0.2, 8.0);
        world.set_linear_velocity(body, Vec3::new(8.0, 1.0, 0.0)).unwrap();
        furthest(&mut world, body, 1.5, hz);
        let (velocity, at) = (world.linear_velocity(body).unwrap(), world.position(body).unwrap());
        assert!((velocity - Vec3::new(8.0, 1.0, 0.0)).length() < 1e-3, "{hz} Hz: {velocity}");
        assert!((at.y - 1.7).abs() < 2e-3, "{hz} Hz: {at}");
    }
}
