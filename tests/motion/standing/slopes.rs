//! Stacks on slopes that their friction holds.

use crate::common::random::Random;
use backstop::glam::{DVec3, Quat, Vec3};
use backstop::{BodyDesc, BodyHandle, Geometry, Material, Settings, ShapeDesc, World};
use std::f32::consts::{PI, TAU};

/// One to four like bodies on each other on a slope: boxes, cylinders on their ends or prisms of 3 to 8
/// sides, of 1 mm to 10 m, at a tenth to a hundred times the earth's gravity.
#[derive(Debug)]
struct Stack {
    size: f32,
    gravity: f32,
    hz: usize,
    friction: f32,
    /// Tangent of the slope's angle, as a share of the friction.
    steepness: f32,
    count: usize,
    /// Half height of a body, in sizes.
    thick: f32,
    shape: usize,
    sides: usize,
    on_box: bool,
    /// Between the bodies at the start, in sizes.
    gap: f32,
}

impl Stack {
    /// `None` if bodies would fall by more than a hundredth of their size in a step, or nearly topple.
    fn any(seed: u64) -> Option<Stack> {
        let random = &mut Random(seed + 1);
        let mut power = |low, high| random.log_range(low, high);
        let (size, gravity) = (power(1e-3, 10.0), 9.81 * power(0.1, 100.0));
        let (hz, friction) = (random.of(&[30, 60, 120]), random.range(0.1, 1.4));
        let (steepness, count) = (random.range(0.1, 0.9), 1 + random.below(4));
        let (shape, sides) = (random.below(3), 3 + random.below(6));
        // The vertical through the centre of all stays within 0.6 of the base's inner circle.
        let inner = if shape == 2 { 0.5 * libm::cosf(PI / sides as f32) } else { 0.5 };
        let thick = (inner * random.range(0.05, 0.6) / (friction * steepness * count as f32)).min(0.5);
        let on_box = random.chance(0.5);
        let gap = if random.chance(0.5) { 0.0 } else { random.range(0.0, 0.01) };
        let is_slow = gravity <= 0.01 * size * (hz * hz) as f32;
        let stack = Stack { size, gravity, hz, friction, steepness, count, thick, shape, sides, on_box, gap };
        is_slow.then_some(stack)
    }

    fn geometry(&self) -> Geometry {
        let (half, height) = (0.5 * self.size, self.thick * self.size);
        match self.shape {
            0 => Geometry::cuboid(half, height, half),
            1 => Geometry::cylinder(height, half),
            _ => {
                let corner = |i: usize| {
                    let angle = (i % self.sides) as f32 * TAU / self.sides as f32;
                    let y = if i < self.sides { -height } else { height };
                    Vec3::new(half * libm::cosf(angle), y, half * libm::sinf(angle))
                };
                let corners: Vec<Vec3> = (0..2 * self.sides).map(corner).collect();
                Geometry::hull(backstop::ConvexHull::new(&corners).unwrap())
            }
        }
    }

    fn put_up(&self, random: &mut Random) -> (World, Vec<BodyHandle>) {
        let settings =
            Settings::default().with_gravity(Vec3::NEG_Y * self.gravity).with_length_unit(self.size);
        let mut world = World::new(settings).unwrap();
        let down = Quat::from_rotation_z(-libm::atanf(self.friction * self.steepness));
        let mut about = || Quat::from_rotation_y(random.range(0.0, TAU));
        let turn = about() * down * about();
        let material = Material::default().with_friction(self.friction);
        let of = |geometry| ShapeDesc::new(geometry).with_material(material);
        let at = |height: f32| (turn * Vec3::Y * (height * self.size)).as_dvec3();
        let half = 10.0 * self.size;
        let ground = if self.on_box {
            BodyDesc::fixed().with_shape(of(Geometry::cuboid(half, half, half))).with_position(at(-10.0))
        } else {
            BodyDesc::fixed().with_shape(of(Geometry::plane()))
        };
        world.add_body(&ground.with_rotation(turn)).unwrap();
        let bodies = (0..self.count).map(|i| {
            let height = (2 * i + 1) as f32 * self.thick + (i + 1) as f32 * self.gap;
            // Prisms stand corner on corner.
            let own = if self.shape == 2 { Quat::IDENTITY } else { about() };
            let desc = BodyDesc::dynamic().with_position(at(height)).with_rotation(turn * own);
            world.add_body(&desc.with_shape(of(self.geometry()))).unwrap()
        });
        let bodies = bodies.collect();
        (world, bodies)
    }

    /// How far a body goes from the third second to the end of a minute, in sizes.
    fn goes(&self, random: &mut Random) -> f64 {
        let (mut world, bodies) = self.put_up(random);
        let mut places = |seconds: usize| -> Vec<DVec3> {
            for _ in 0..seconds * self.hz {
                world.step(1.0 / self.hz as f32).unwrap();
            }
            bodies.iter().map(|&body| world.position(body).unwrap()).collect()
        };
        let (start, end) = (places(2), places(58));
        let moves = start.iter().zip(&end).map(|(start, end)| start.distance(*end));
        moves.fold(0.0, f64::max) / f64::from(self.size)
    }
}

/// Expected: a slope of at most 0.9 of the friction holds what stands or gently lands on it, by Coulomb's
/// law; what is put up or falls by a hundredth of its size is at rest after 2 s, and then moves by no more
/// than a hundredth of its size in a minute. (With loads estimated along normals alone, 32 of 1,700 moved
/// on. Of the 3,300 of `COUNT=12000` eight still do: seven by up to 0.022 of their size, seed 11759 slips.)
#[test]
fn what_friction_holds_on_a_slope_stays() {
    let count = std::env::var("COUNT").map_or(150, |count| count.parse().unwrap());
    let mut gone = Vec::new();
    for seed in 0..count {
        let Some(stack) = Stack::any(seed) else { continue };
        let way = stack.goes(&mut Random(!seed));
        if way > 0.01 {
            gone.push((seed, way, stack));
        }
    }
    assert!(gone.is_empty(), "{gone:#?}");
}
