//! Heaps of all kinds of bodies on all kinds of ground come to rest.

use crate::common::random::Random;
use backstop::glam::{DVec3, Quat, Vec3};
use backstop::{
    BodyDesc, BodyHandle, ConvexHull, Geometry, Material, Settings, ShapeDesc, TriangleMesh, World,
};
use std::f32::consts::TAU;
use std::sync::Arc;

#[derive(Clone, Copy, Debug, PartialEq)]
enum Ground {
    Tray,
    /// A tray that leans by 15 degrees.
    Slope,
    /// An uneven mesh with walls.
    Mesh,
    /// A plane without walls: round bodies would roll away.
    Plane,
}

#[derive(Clone, Copy, Debug, PartialEq)]
enum Thing {
    Plank,
    Plate,
    Brick,
    Box,
    Hull,
    Cone,
    Chair,
    Ell,
    Cross,
    /// Boxes of sizes 1 : 10 and masses 1 : 100, which have nothing to do with their sizes.
    Mixed,
    Ball,
    Cylinder,
    Rod,
}

use Thing::{Ball, Box, Brick, Chair, Cone, Cross, Cylinder, Ell, Hull, Mixed, Plank, Plate, Rod};

const THINGS: [Thing; 13] =
    [Plank, Plate, Brick, Box, Hull, Cone, Chair, Ell, Cross, Mixed, Ball, Cylinder, Rod];
const GROUNDS: [Ground; 4] = [Ground::Tray, Ground::Slope, Ground::Mesh, Ground::Plane];

impl Thing {
    fn rolls(self) -> bool {
        matches!(self, Cone | Ball | Cylinder | Rod)
    }

    /// Its parts, and their density [kg/m³].
    fn parts(self, random: &mut Random) -> (Vec<(Geometry, Vec3)>, f32) {
        let cuboid = |half: [f32; 3]| Geometry::cuboid(half[0], half[1], half[2]);
        let one = |half: [f32; 3]| vec![(cuboid(half), Vec3::ZERO)];
        let parts = match self {
            Plank => one([0.5, 0.01, 0.08]),
            Plate => one([0.4, 0.01, 0.3]),
            Brick => one([0.25, 0.06, 0.12]),
            Box => one([0.15, 0.12, 0.18]),
            Hull => {
                let corner = |_| random.direction() * Vec3::new(0.22, 0.14, 0.18);
                let corners: Vec<Vec3> = (0..14).map(corner).collect();
                vec![(Geometry::Hull(Arc::new(ConvexHull::new(&corners).unwrap())), Vec3::ZERO)]
            }
            Cone => vec![(Geometry::cone(0.15, 0.15), Vec3::ZERO)],
            Chair => {
                let legs = [(-1.0, -1.0), (-1.0, 1.0), (1.0, -1.0), (1.0, 1.0)];
                let leg =
                    |(x, z): (f32, f32)| (cuboid([0.02, 0.15, 0.02]), Vec3::new(0.18 * x, -0.17, 0.18 * z));
                let back = (cuboid([0.2, 0.2, 0.02]), Vec3::new(0.0, 0.22, -0.18));
                legs.map(leg).into_iter().chain([back]).chain(one([0.2, 0.02, 0.2])).collect()
            }
            Ell => {
                let side = (cuboid([0.03, 0.2, 0.1]), Vec3::new(0.27, 0.17, 0.0));
                one([0.3, 0.03, 0.1]).into_iter().chain([side]).collect()
            }
            Cross => {
                [[0.3, 0.04, 0.04], [0.04, 0.3, 0.04], [0.04, 0.04, 0.3]].into_iter().flat_map(one).collect()
            }
            Mixed => {
                let size = libm::powf(10.0, random.range(-0.9, 0.1));
                let half = [random.range(0.1, 0.3), random.range(0.03, 0.2), random.range(0.1, 0.3)];
                let half = half.map(|half| half * size);
                let mass = libm::powf(10.0, random.range(0.0, 2.0));
                return (one(half), mass / (8.0 * half[0] * half[1] * half[2]));
            }
            Ball => vec![(Geometry::sphere(0.12), Vec3::ZERO)],
            Cylinder => vec![(Geometry::cylinder(0.15, 0.12), Vec3::ZERO)],
            Rod => vec![(Geometry::capsule(0.45, 0.03), Vec3::ZERO)],
        };
        (parts, 600.0)
    }
}

/// A tray of 3 m, or its replacement, with friction 0.6.
fn lay(world: &mut World, ground: Ground, random: &mut Random) {
    let turn = Quat::from_rotation_z(if ground == Ground::Slope { 0.26 } else { 0.0 });
    let mut fixed = |geometry: Geometry, at: Vec3| {
        let shape = ShapeDesc::new(geometry).with_material(Material::default().with_friction(0.6));
        let body =
            BodyDesc::fixed().with_position((turn * at).as_dvec3()).with_rotation(turn).with_shape(shape);
        world.add_body(&body).unwrap();
    };
    if ground == Ground::Mesh {
        let corner = |i: usize| {
            let (x, z) = (0.25 * (i / 25) as f32 - 3.0, 0.25 * (i % 25) as f32 - 3.0);
            let y = 0.06 * libm::sinf(2.1 * x) * libm::cosf(1.7 * z) + random.range(-0.01, 0.01);
            Vec3::new(x, y, z)
        };
        let corners = (0..25 * 25).map(corner).collect();
        let square = |i: u32| {
            let k = 25 * (i / 24) + i % 24;
            [[k, k + 1, k + 25], [k + 1, k + 26, k + 25]]
        };
        fixed(
            Geometry::mesh(TriangleMesh::new(corners, (0..24 * 24).flat_map(square).collect()).unwrap()),
            Vec3::ZERO,
        );
    } else {
        fixed(Geometry::cuboid(100.0, 1.0, 100.0), -Vec3::Y);
    }
    if ground != Ground::Plane {
        for side in [-2.0, 2.0] {
            fixed(Geometry::cuboid(0.5, 3.0, 2.5), Vec3::new(side, 3.0, 0.0));
            fixed(Geometry::cuboid(2.5, 3.0, 0.5), Vec3::new(0.0, 3.0, side));
        }
    }
}

/// The thrown bodies, and their motion from ten seconds after their fall.
struct Heap {
    thing: Thing,
    ground: Ground,
    count: usize,
    hz: f32,
    seed: u64,
    /// Lever arm against rolling and spinning [m].
    arm: f32,
}

impl Heap {
    fn throw(&self, settings: Settings) -> (World, Vec<BodyHandle>) {
        let mut random = Random(self.seed);
        let mut world = World::new(settings).unwrap();
        lay(&mut world, self.ground, &mut random);
        let material = Material::default()
            .with_friction(0.6)
            .with_rolling_friction(self.arm)
            .with_spinning_friction(self.arm);
        let bodies = (0..self.count).map(|i| {
            let (x, z) = (random.range64(-0.9, 0.9), random.range64(-0.9, 0.9));
            let turn = Quat::from_scaled_axis(random.direction() * random.range(0.0, 0.5 * TAU));
            let mut body = BodyDesc::dynamic()
                .with_position(DVec3::new(x, 0.4 + 0.12 * i as f64, z))
                .with_rotation(turn);
            let (parts, density) = self.thing.parts(&mut random);
            for (geometry, at) in parts {
                let mut shape = ShapeDesc::new(geometry).with_material(material);
                (shape.position, shape.density) = (at, density);
                body = body.with_shape(shape);
            }
            world.add_body(&body).unwrap()
        });
        let bodies = bodies.collect();
        (world, bodies)
    }

    /// The time in which it falls [s].
    fn fall(&self) -> f32 {
        (2.0 * 0.12 * self.count as f32 / 9.81).sqrt() + 1.0
    }

    /// How it fares in the second that begins so long after the fall; `step`: how many it has done.
    fn look(&self, world: &mut World, bodies: &[BodyHandle], step: &mut f32, after: f32) -> Look {
        let from = ((self.fall() + after) * self.hz).floor();
        let (mut sum, mut most, mut cuts) = (0.0, 0.0f32, 0);
        while *step < from + self.hz {
            world.step(1.0 / self.hz).unwrap();
            *step += 1.0;
            if *step > from {
                cuts += world.report().cut;
                // Some bodies that fall from above the walls land beyond them, and roll away.
                let near = |body: &&BodyHandle| world.position(**body).unwrap().length() < 5.0;
                for &body in bodies.iter().filter(near) {
                    let speed = world.linear_velocity(body).unwrap().length();
                    (sum, most) = (sum + speed * speed, most.max(speed));
                }
            }
        }
        Look { rms: (sum / (bodies.len() as f32 * self.hz)).sqrt(), most, cuts }
    }

    /// Heaps with a lever arm of a few percent of their radius, if they roll.
    fn any(thing: Thing, ground: Ground, count: usize, hz: f32, seed: u64) -> Heap {
        Heap { thing, ground, count, hz, seed, arm: if thing.rolls() { 0.003 } else { 0.0 } }
    }
}

/// Speeds of a second [m/s], and the paths that the guard cut in it.
#[derive(Debug)]
struct Look {
    rms: f32,
    most: f32,
    cuts: u32,
}

impl Look {
    fn rests(&self) -> bool {
        self.rms < 1e-3 && self.cuts == 0
    }
}

/// Heaps of 60 of each kind on two kinds of ground and at two rates each. Expected: ten seconds after the
/// fall (thirty if they roll) they are at rest (below 1 mm/s, and no path is cut) in all but one of eight,
/// and no body is faster than 10 cm/s. That bound is not for chairs, which may fall into each other: where
/// two are wedged, with surfaces that push them to opposite sides, they wander on (7 of 48 heaps of chairs,
/// at up to 2 m/s).
#[test]
fn heaps_of_every_kind_come_to_rest() {
    let (mut awake, mut all) = (0, 0);
    for (i, thing) in THINGS.into_iter().enumerate() {
        for k in 0..2 {
            let ground = GROUNDS[(i + k) % if thing.rolls() { 2 } else { 4 }];
            let heap = Heap::any(thing, ground, 60, [30.0, 60.0, 120.0][(i + 2 * k) % 3], 1 + k as u64);
            let (mut world, bodies) = heap.throw(Settings::default());
            let after = if thing.rolls() { 29.0 } else { 9.0 };
            let look = heap.look(&mut world, &bodies, &mut 0.0, after);
            println!("{thing:?} {ground:?} {} Hz: {look:?}", heap.hz);
            awake += usize::from(!look.rests());
            all += 1;
            let slow = look.most < 0.1 || thing == Thing::Chair;
            assert!(slow, "{thing:?} {ground:?} {} Hz: {look:?}", heap.hz);
        }
    }
    println!("{awake} of {all} move");
    assert!(8 * awake <= all, "{awake} of {all} heaps move");
}

/// Heaps of mixed boxes in which a heavy one, pushed out of its overlap, carried a small one: the paths of
/// both were cut in each step, at up to 9 m/s, for ever. Expected: ten seconds after the fall none is cut.
#[test]
fn what_is_pushed_out_of_others_is_not_held_in_the_air() {
    for (ground, seed) in [(Ground::Plane, 9), (Ground::Tray, 13), (Ground::Slope, 2)] {
        let heap = Heap::any(Mixed, ground, 100, 30.0, seed);
        let (mut world, bodies) = heap.throw(Settings::default());
        let look = heap.look(&mut world, &bodies, &mut 0.0, 9.0);
        assert!(look.cuts == 0 && look.most < 0.1, "{ground:?}: {look:?}");
    }
}

/// Heaps of 100 of every kind on every ground, for two minutes. Expected: ten seconds after the fall nine of
/// ten are at rest, and after two minutes no fewer. Round bodies are left out on a plane: they roll away.
#[test]
#[ignore = "takes a quarter of an hour: `scripts/reliability rest`"]
fn large_heaps_of_every_kind_rest_for_two_minutes() {
    let (mut early, mut late, mut all) = (0, 0, 0);
    for (i, thing) in THINGS.into_iter().enumerate() {
        for (k, ground) in GROUNDS.into_iter().enumerate() {
            if thing.rolls() && ground == Ground::Plane {
                continue;
            }
            let heap = Heap::any(thing, ground, 100, [30.0, 60.0, 120.0][(i + k) % 3], 7);
            let (mut world, bodies) = heap.throw(Settings::default());
            let mut step = 0.0;
            let looks = [9.0, 119.0].map(|after| heap.look(&mut world, &bodies, &mut step, after));
            println!("{thing:?} {ground:?} {} Hz: {looks:?}", heap.hz);
            early += usize::from(!looks[0].rests());
            late += usize::from(!looks[1].rests());
            all += 1;
        }
    }
    println!("{early} and {late} of {all} move");
    assert!(10 * early <= all && late <= early, "{early} and {late} of {all} heaps move");
}

/// A hundred balls of 12 cm in a tray, with friction 0.6 and lever arms of 3 mm. Expected: asleep within six
/// seconds of the fall. Without spinning friction they spin about the vertical for ever, without rolling
/// friction they roll (in Rapier as well, which has neither).
#[test]
fn balls_with_friction_of_rolling_and_spinning_fall_asleep() {
    for hz in [30.0, 60.0, 120.0] {
        let heap = Heap::any(Ball, Ground::Tray, 100, hz, 1);
        let (mut world, bodies) = heap.throw(Settings::default().with_sleeping(true));
        heap.look(&mut world, &bodies, &mut 0.0, 5.0);
        let awake = bodies.iter().filter(|&&body| !world.is_sleeping(body).unwrap()).count();
        assert_eq!(awake, 0, "{hz} Hz");
    }
}
