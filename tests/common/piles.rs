//! Piles within a budget: bytes that they need, and how deep bodies lie in each other when they get less.

use super::random::Random;
use backstop::glam::{EulerRot, Quat, Vec3};
use backstop::{
    BodyDesc, BodyKind, Budget, Category, Geometry, QueryFilter, Settings, ShapeCast, ShapeDesc, Snapshot,
    World,
};

/// Bodies that are dropped into a container, in layers.
#[derive(Clone, Copy, Debug)]
pub(crate) enum Of {
    Boxes,
    Spheres,
    /// Boxes, spheres and capsules.
    Mixed,
}

#[derive(Clone, Copy, Debug)]
pub(crate) struct Pile {
    pub(crate) of: Of,
    pub(crate) bodies: usize,
    pub(crate) seed: u64,
    /// [s]
    pub(crate) dt: f32,
}

/// Width of the bodies of all piles, within a fifth [m].
pub(crate) const SIZE: f32 = 1.0;
/// After so long nothing falls any more [s].
const SETTLED: f32 = 5.0;
/// A run [s], and how often overlaps are looked at [1/s].
const SECONDS: f32 = 10.0;
const LOOKS: f32 = 6.0;

/// Results of a run.
#[derive(Clone, Debug, Default)]
pub(crate) struct Run {
    /// Bytes once all bodies are there, and the most after any step: of all, and by category.
    pub(crate) own: usize,
    pub(crate) most: usize,
    pub(crate) by_category: Vec<usize>,
    /// Points and pairs that were shed: in all, and in the last second.
    pub(crate) shed: u32,
    pub(crate) shed_at_rest: u32,
    /// Deepest overlap at any look, and once all has settled [m].
    pub(crate) worst: f32,
    pub(crate) deepest: f32,
    /// Speed of the fastest body in the end [m/s].
    pub(crate) fastest: f32,
    pub(crate) hash: u64,
}

impl Pile {
    /// A world with the pile in it, before its first step.
    pub(crate) fn world(&self, settings: Settings) -> World {
        let mut world = World::new(settings).unwrap();
        let across = (1.05 * (self.bodies as f32).cbrt()).round() as usize;
        let half = 0.6 * across as f32 * SIZE;
        let wall = |x: f32, z: f32, half: Vec3, y: f32| {
            BodyDesc::fixed()
                .with_position(Vec3::new(x, y, z).as_dvec3())
                .with_shape(ShapeDesc::new(Geometry::cuboid(half.x, half.y, half.z)))
        };
        let mut bodies = vec![wall(0.0, 0.0, Vec3::new(half + 1.0, 0.5, half + 1.0), -0.5)];
        for side in [-1.0, 1.0] {
            let out = side * (half + 0.5);
            bodies.push(wall(out, 0.0, Vec3::new(0.5, 20.0, half + 1.0), 20.0));
            bodies.push(wall(0.0, out, Vec3::new(half, 20.0, 0.5), 20.0));
        }
        let mut random = Random(self.seed);
        let mut random = || random.signed();
        for i in 0..self.bodies {
            let (x, z, layer) = (i % across, i / across % across, i / across / across);
            let h = 0.5 * SIZE;
            let geometry = match (self.of, (x + z + layer) % 3) {
                (Of::Boxes, _) => Geometry::cuboid(h, h, h),
                (Of::Spheres, _) | (Of::Mixed, 1) => Geometry::Sphere { radius: h },
                (Of::Mixed, 0) => Geometry::cuboid(h, 0.8 * h, 1.2 * h),
                (Of::Mixed, _) => Geometry::capsule(0.8 * h, 0.4 * h),
            };
            let middle = 0.5 * (across as f32 - 1.0);
            let at = Vec3::new(
                (x as f32 - middle) * 1.15 + 0.05 * random(),
                1.0 + layer as f32 * 1.5,
                (z as f32 - middle) * 1.15 + 0.05 * random(),
            );
            let turn = Quat::from_euler(EulerRot::YXZ, 0.2 * random(), 0.2 * random(), 0.2 * random());
            bodies.push(
                BodyDesc::dynamic()
                    .with_position(at.as_dvec3())
                    .with_rotation(turn)
                    .with_shape(ShapeDesc::new(geometry)),
            );
        }
        world.add_bodies(&bodies).unwrap();
        world
    }

    pub(crate) fn run(&self, budget: Budget, threads: usize) -> Run {
        let mut world = self.world(Settings::default().with_budget(budget).with_threads(threads));
        let mut run = Run { own: world.memory().total(), ..Run::default() };
        run.by_category = vec![0; Category::ALL.len()];
        let mut overlaps = Overlaps::new();
        let steps = (SECONDS / self.dt).round() as u32;
        let every = (1.0 / (self.dt * LOOKS)).round() as u32;
        for step in 0..steps {
            let shed = world.step(self.dt).unwrap().shed;
            let time = (step + 1) as f32 * self.dt;
            run.shed += shed;
            run.shed_at_rest += if time > SECONDS - 1.0 { shed } else { 0 };
            let memory = world.memory();
            if memory.total() > run.most {
                run.most = memory.total();
                run.by_category = memory.iter().map(|(_, bytes)| bytes.reserved).collect();
            }
            assert!(budget.limit().is_none_or(|limit| memory.total() <= limit), "{}", memory.total());
            if step % every == every - 1 {
                let deepest = overlaps.deepest(&world);
                run.worst = run.worst.max(deepest);
                run.deepest = if time > SETTLED { run.deepest.max(deepest) } else { 0.0 };
            }
        }
        run.fastest = world
            .bodies()
            .filter(|&body| world.kind(body).unwrap() == BodyKind::Dynamic)
            .map(|body| world.linear_velocity(body).unwrap().length())
            .fold(0.0, f32::max);
        run.hash = world.state_hash();
        run
    }
}

/// Asks for overlaps in another world, that has no budget: queries take memory too.
pub(crate) struct Overlaps {
    world: World,
    snapshot: Snapshot,
    /// Sum over all looks [m].
    pub(crate) sum: f64,
}

impl Overlaps {
    pub(crate) fn new() -> Overlaps {
        Overlaps { world: World::new(Settings::default()).unwrap(), snapshot: Snapshot::new(), sum: 0.0 }
    }

    /// The deepest of all overlaps of a world [m].
    pub(crate) fn deepest(&mut self, of: &World) -> f32 {
        of.snapshot(&mut self.snapshot);
        self.world.restore(&self.snapshot).unwrap();
        let (world, mut hits, mut deepest) = (&self.world, Vec::new(), 0.0f32);
        for body in world.bodies().filter(|&b| world.kind(b).unwrap() == BodyKind::Dynamic) {
            let shape = world.shapes(body).unwrap().next().unwrap();
            let geometry = world.geometry(shape).unwrap();
            let mut cast = ShapeCast::new(geometry, world.position(body).unwrap(), Vec3::ZERO);
            cast.rotation = world.rotation(body).unwrap();
            world.cast_shape_all(&cast, &QueryFilter::new().excluding(body), &mut hits).unwrap();
            for hit in &hits {
                self.sum += f64::from(hit.depth);
                deepest = deepest.max(hit.depth);
            }
        }
        deepest
    }
}
