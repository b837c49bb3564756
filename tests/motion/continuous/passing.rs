//! Obstacles that the planes of the step's start don't show: a plate that turns under it, and a wall
//! behind which its end is while its centre is in front.

use crate::common::random::Random;
use backstop::glam::{Quat, Vec3};
use backstop::{BodyDesc, BodyHandle, Geometry, Settings, ShapeDesc, TriangleMesh, World};
use std::sync::Arc;

/// A plate of 4 m by 4 m that turns freely, and a ball of about its mass that slides along it.
struct Plate {
    world: World,
    plate: BodyHandle,
    ball: BodyHandle,
    /// Half the plate's thickness, the ball's radius [m]; masses [kg].
    half: f32,
    radius: f32,
    mass: [f32; 2],
}

const SIDE: f32 = 4.0;

impl Plate {
    /// The ball starts at up to 1 cm above the plate, as fast along the normal as the plate below it.
    fn new(speed: f32, random: &mut Random) -> Plate {
        let (radius, half) = (random.range(0.05, 0.2), random.range(0.01, 0.025));
        let ball_mass = 4.0 / 3.0 * std::f32::consts::PI * radius.powi(3) * 1000.0;
        let plate_mass = ball_mass * random.range(0.5, 2.0);
        let turned = Quat::from_scaled_axis(random.direction() * random.range(0.0, 3.0));
        let turn = random.range(0.0, std::f32::consts::TAU);
        let along = Vec3::new(libm::cosf(turn), 0.0, libm::sinf(turn));
        let across = Vec3::Y.cross(along);
        // Its part ahead of the ball comes up.
        let lean = random.range(-0.8, 0.8);
        let spin = (-across * libm::cosf(lean) + along * libm::sinf(lean)) * random.range(1.0, 10.0);
        let spin = if spin.cross(along).y < 0.0 { -spin } else { spin };
        let at = along * random.range(-1.5, 0.5)
            + across * random.range(-1.0, 1.0)
            + Vec3::Y * (half + radius + random.range(0.0, 0.01));
        let velocity = along * speed + Vec3::Y * spin.cross(at).y;
        let mut world = World::new(Settings::default().with_gravity(Vec3::ZERO)).unwrap();
        let shape = Geometry::cuboid(0.5 * SIDE, half, 0.5 * SIDE);
        let shape = ShapeDesc::new(shape).with_density(plate_mass / (2.0 * half * SIDE * SIDE));
        let desc = BodyDesc::dynamic().with_rotation(turned).with_velocity(Vec3::ZERO, turned * spin);
        let plate = world.add_body(&desc.with_shape(shape)).unwrap();
        let desc = BodyDesc::dynamic()
            .with_position(turned * at)
            .with_rotation(turned)
            .with_velocity(turned * velocity, Vec3::ZERO);
        let ball = desc.with_shape(ShapeDesc::new(Geometry::Sphere { radius }));
        let ball = world.add_body(&ball).unwrap();
        Plate { world, plate, ball, half, radius, mass: [plate_mass, ball_mass] }
    }

    /// The ball's centre as the plate sees it.
    fn local(&self) -> Vec3 {
        let at = |body| self.world.position(body).unwrap();
        self.world.rotation(self.plate).unwrap().conjugate() * (at(self.ball) - at(self.plate)).as_vec3()
    }

    /// Kinetic energy [J].
    fn energy(&self) -> f32 {
        let square = |v: Vec3| v.length_squared();
        let linear = |body| square(self.world.linear_velocity(body).unwrap());
        let [plate, ball] = self.mass;
        let own = self.world.rotation(self.plate).unwrap().conjugate()
            * self.world.angular_velocity(self.plate).unwrap();
        let (wide, flat) = (SIDE * SIDE, 4.0 * self.half * self.half);
        let inertia = Vec3::new(wide + flat, wide + wide, wide + flat) * (plate / 12.0);
        let rolling = 0.4 * ball * self.radius * self.radius;
        0.5 * (plate * linear(self.plate)
            + ball * linear(self.ball)
            + (inertia * own).dot(own)
            + rolling * square(self.world.angular_velocity(self.ball).unwrap()))
    }
}

/// Expected: the ball stays on its side of the plate for as long as it is over it, and nothing gains energy.
/// Before bodies were moved apart a quarter to a half of such balls got through.
#[test]
fn a_ball_that_slides_on_a_free_plate_which_turns_under_it_stays_on_its_side() {
    let mut random = Random(5);
    for (slow, fast) in [(50.0, 200.0), (200.0, 600.0)] {
        for rate in [30.0, 60.0, 144.0] {
            let (mut through, mut gained) = (0, 0.0_f32);
            for _ in 0..100 {
                let speed = random.range(slow, fast);
                let mut pair = Plate::new(speed, &mut random);
                let (mut before, start) = (pair.local(), pair.energy());
                for _ in 0..60 {
                    pair.world.step(1.0 / rate).unwrap();
                    let now = pair.local();
                    if before.y * now.y < 0.0 {
                        let cross = before.lerp(now, before.y / (before.y - now.y));
                        // Close to an edge it may have gone around.
                        through += u32::from(cross.x.abs().max(cross.z.abs()) < 0.45 * SIDE);
                    }
                    before = now;
                    gained = gained.max(pair.energy() / start - 1.0);
                }
            }
            println!("{slow} to {fast} m/s at {rate} Hz: {through} through, energy gained {gained}");
            assert_eq!(through, 0, "{slow} to {fast} m/s at {rate} Hz");
            assert!(gained < 1e-3, "{slow} to {fast} m/s at {rate} Hz: {gained}");
        }
    }
}

/// One of the two walls of a V with its edge along z; no thickness.
fn wall(side: f32) -> Geometry {
    let corner = |up: f32, z: f32| Vec3::new(up * side, up, z);
    let (mut vertices, mut triangles) = (Vec::new(), Vec::new());
    for k in 0..=100 {
        for i in 0..=20 {
            vertices.push(corner(i as f32, k as f32 - 50.0));
        }
    }
    for k in 0..100 {
        for i in 0..20 {
            let a = k * 21 + i;
            let (b, c, d) = (a + 1, a + 21, a + 22);
            triangles.extend([[a, c, b], [b, c, d]]);
        }
    }
    Geometry::Mesh(Arc::new(TriangleMesh::new(vertices, triangles).unwrap()))
}

/// Expected: with its centre between the walls, no end of a rod is left behind one of them. A second after
/// the shot none of them is further there than the 5 mm that the solver leaves to it; before ends were looked
/// at 5 % were stuck, up to half a metre deep.
#[test]
fn no_rod_is_stuck_with_an_end_behind_a_wall_of_a_v() {
    let walls = [1.0, -1.0].map(wall);
    let mut random = Random(9);
    for rate in [30.0, 60.0] {
        let (mut stuck, mut worst) = (0, 0.0_f32);
        for _ in 0..100 {
            let mut world = World::new(Settings::default()).unwrap();
            for wall in &walls {
                let shape = ShapeDesc::new(wall.clone());
                world.add_body(&BodyDesc::fixed().with_shape(shape)).unwrap();
            }
            let (tilt, turn) = (random.range(0.0, 0.6), random.range(0.0, std::f32::consts::TAU));
            let flat = libm::sinf(tilt);
            let way = Vec3::new(flat * libm::cosf(turn), -libm::cosf(tilt), flat * libm::sinf(turn));
            let target = Vec3::new(random.range(-0.5, 0.5), 0.0, random.range(-20.0, 20.0));
            let speed = 10.0 * libm::powf(10.0, random.range(0.0, 1.0));
            let turned = Quat::from_scaled_axis(random.direction() * random.range(0.0, 3.0));
            let spin = random.direction() * random.range(0.0, 50.0);
            let rod = BodyDesc::dynamic()
                .with_position(target - way * random.range(3.0, 6.0))
                .with_rotation(turned)
                .with_velocity(way * speed, spin)
                .with_shape(ShapeDesc::new(Geometry::cuboid(0.025, 0.5, 0.025)));
            let rod = world.add_body(&rod).unwrap();
            for _ in 0..(1.25 * rate) as usize {
                world.step(1.0 / rate).unwrap();
            }
            let (at, axis) = (world.position(rod).unwrap().as_vec3(), world.rotation(rod).unwrap() * Vec3::Y);
            for end in [at - axis * 0.5, at + axis * 0.5] {
                let behind = (end.x.abs() - end.y) * std::f32::consts::FRAC_1_SQRT_2;
                stuck += u32::from(behind > 0.005);
                worst = worst.max(behind);
            }
        }
        println!("{rate} Hz: {stuck} ends stuck, the deepest {worst} m");
        assert_eq!(stuck, 0, "{rate} Hz, the deepest {worst} m");
    }
}

/// Expected: a body that strikes and is stopped or moved apart keeps or loses energy in that step, at any
/// rotation at its start: a rod has a hundredth of the inertia about its length that it has across, and turns
/// by up to 100 rad/s here. A free rotation at this speed may vary by one in a hundred with no contact.
#[test]
fn rods_that_spin_into_each_other_gain_no_energy() {
    let half = Vec3::new(0.02, 0.4, 0.03);
    let mass = 8.0 * half.x * half.y * half.z * 1000.0;
    let square = half * half;
    let inertia = Vec3::new(square.y + square.z, square.x + square.z, square.x + square.y) * (mass / 3.0);
    let mut random = Random(21);
    let (mut held, mut worst) = (0, 0.0_f32);
    for rate in [30.0, 60.0] {
        for _ in 0..200 {
            let mut world = World::new(Settings::default().with_gravity(Vec3::ZERO)).unwrap();
            let rods: Vec<BodyHandle> = [-1.0, 1.0]
                .map(|side| {
                    let rod = BodyDesc::dynamic()
                        .with_position(Vec3::new(
                            side * 2.0,
                            random.range(-0.3, 0.3),
                            random.range(-0.3, 0.3),
                        ))
                        .with_rotation(Quat::from_scaled_axis(random.direction() * random.range(0.0, 3.0)))
                        .with_velocity(
                            Vec3::X * (-side * random.range(20.0, 100.0)),
                            random.direction() * random.range(0.0, 100.0),
                        )
                        .with_shape(ShapeDesc::new(Geometry::cuboid(half.x, half.y, half.z)));
                    world.add_body(&rod).unwrap()
                })
                .to_vec();
            let energy = |world: &World| -> f32 {
                let one = |&rod: &BodyHandle| {
                    let own = world.rotation(rod).unwrap().conjugate() * world.angular_velocity(rod).unwrap();
                    0.5 * (mass * world.linear_velocity(rod).unwrap().length_squared()
                        + (inertia * own).dot(own))
                };
                rods.iter().map(one).sum()
            };
            let mut last = energy(&world);
            for _ in 0..20 {
                let cut = world.step(1.0 / rate).unwrap().cut;
                let now = energy(&world);
                if cut > 0 {
                    held += cut;
                    worst = worst.max(now / last - 1.0);
                }
                last = now;
            }
        }
    }
    println!("held {held}, energy gained {worst}");
    assert!(held > 0 && worst < 0.01, "held {held}, energy gained {worst}");
}
