//! Benchmarks of nearby pairs of shapes. An element is a pair.

use super::Kernel;
use crate::config::tuning::CONTACT_MARGIN;
use crate::lanes::{Lanes, with_best};
use crate::math::Quat;
use crate::narrow_phase::kernels::{
    ManifoldLanes, PairLanes, box_box, capsule_box, capsule_capsule, collider, sphere_box, sphere_capsule,
    sphere_sphere, tapered_capsule_box, tapered_capsule_capsule,
};
use crate::narrow_phase::{
    BodyPath, MeshScratch, Motion, RawManifold, Reach, Relative, cast_convex, collide_convex, collide_mesh,
    tolerance,
};
use crate::random::Random;
use crate::shape::{Collider, ConvexHull, Geometry, Kind, TriangleMesh};
use glam::Vec3;
use std::hint::black_box;
use std::sync::Arc;

/// Too many for the branch predictor to memorise, and few enough for L2.
const PAIRS: usize = 512;
// Guard: ends the range in which points are looked for.
/// Margin that the step adds to the motions of two bodies [m].
const MARGIN: f32 = 2.0 * CONTACT_MARGIN;

fn sphere() -> Collider {
    collider(Geometry::Sphere { radius: 0.4 })
}
fn capsule() -> Collider {
    collider(Geometry::capsule(0.3, 0.25))
}
/// A frustum with a wide and a narrow end.
fn tapered() -> Collider {
    collider(Geometry::Capsule { half_height: 0.3, radius_bottom: 0.3, radius_top: 0.2 })
}
fn cuboid() -> Collider {
    collider(Geometry::cuboid(0.4, 0.3, 0.5))
}
fn cylinder() -> Collider {
    collider(Geometry::cylinder(0.3, 0.35))
}
/// A hull of 24 points on a ball of half a metre.
fn hull() -> Collider {
    let mut random = Random(24);
    let points: Vec<Vec3> = (0..24).map(|_| random.direction() * 0.5).collect();
    collider(Geometry::Hull(Arc::new(ConvexHull::new(&points).expect("points of a ball span a volume"))))
}

/// Any rotations, at distances from where the shapes overlap by about half to where they are just out of
/// reach.
fn poses(a: &Collider, b: &Collider) -> Vec<Relative> {
    let mut random = Random(7);
    let (least, most) = (0.5 * (a.radius + b.radius), a.radius + b.radius);
    (0..PAIRS)
        .map(|_| Relative {
            position: random.direction() * random.range(least, most),
            rotation: random.turn(),
        })
        .collect()
}

/// Boxes face on face, as in a stack.
fn stacked() -> Vec<Relative> {
    let mut random = Random(14);
    (0..PAIRS)
        .map(|_| Relative {
            position: Vec3::new(random.range(-0.4, 0.4), 0.6, random.range(-0.4, 0.4)),
            rotation: Quat::from_scaled_axis(random.cube() * 1e-3),
        })
        .collect()
}

type LaneKernel<L> = fn(&PairLanes<L>) -> ManifoldLanes<L>;

/// Pairs whose kernel has eight lanes; loading them and reading the manifolds is included.
pub fn lanes() -> Vec<Kernel> {
    with_best!(Wide => lanes_of::<Wide>())
}

fn lanes_of<L: Lanes>() -> Vec<Kernel> {
    let of = |name: &str, a: Collider, b: Collider, kernel: LaneKernel<L>| {
        let poses = poses(&a, &b);
        in_lanes(name, a, b, poses, kernel)
    };
    vec![
        of("sphere sphere", sphere(), sphere(), sphere_sphere),
        of("sphere capsule", sphere(), capsule(), sphere_capsule),
        of("sphere box", sphere(), cuboid(), sphere_box),
        of("capsule capsule", capsule(), capsule(), capsule_capsule),
        of("capsule capsule, tapered", tapered(), tapered(), tapered_capsule_capsule),
        of("capsule box", capsule(), cuboid(), capsule_box),
        of("capsule box, tapered", tapered(), cuboid(), tapered_capsule_box),
        of("box box", cuboid(), cuboid(), box_box),
        in_lanes::<L>("box box, stacked", cuboid(), cuboid(), stacked(), box_box),
    ]
}

fn in_lanes<L: Lanes>(
    name: &str,
    a: Collider,
    b: Collider,
    poses: Vec<Relative>,
    kernel: LaneKernel<L>,
) -> Kernel {
    let mut out = vec![RawManifold::default(); poses.len()];
    // Through a pointer that is opaque to the optimiser, as in a bin.
    let kernel = black_box(kernel);
    Kernel::new(name, poses.len(), move || {
        for (poses, out) in poses.chunks(8).zip(out.chunks_mut(8)) {
            let found = kernel(&PairLanes::from_fn(|i| (poses[i], a.size, b.size, MARGIN)));
            for (lane, out) in out.iter_mut().enumerate() {
                *out = found.lane(lane);
            }
        }
        black_box(&mut out);
    })
}

/// Pairs that are processed one by one.
pub fn convex() -> Vec<Kernel> {
    vec![
        one_by_one("capsule hull", capsule(), hull()),
        one_by_one("box cylinder", cuboid(), cylinder()),
        one_by_one("cylinder cylinder", cylinder(), cylinder()),
        one_by_one("cylinder hull", cylinder(), hull()),
        at_poses("cylinder on box", cuboid(), cylinder(), standing(&cuboid())),
        at_poses("cylinder on cylinder", cylinder(), cylinder(), standing(&cylinder())),
        one_by_one("box hull", cuboid(), hull()),
        one_by_one("hull hull", hull(), hull()),
    ]
}

/// Cylinders that stand on this shape, with a little overlap.
fn standing(ground: &Collider) -> Vec<Relative> {
    let height = 0.3 + if ground.kind == Kind::Box { ground.size[1] } else { ground.size[0] };
    let mut random = Random(15);
    (0..PAIRS)
        .map(|_| Relative {
            position: Vec3::new(random.range(-0.2, 0.2), height - 5e-4, random.range(-0.2, 0.2)),
            rotation: Quat::from_scaled_axis(random.cube() * 1e-4),
        })
        .collect()
}

fn one_by_one(name: &str, a: Collider, b: Collider) -> Kernel {
    let poses = poses(&a, &b);
    at_poses(name, a, b, poses)
}

fn at_poses(name: &str, a: Collider, b: Collider, poses: Vec<Relative>) -> Kernel {
    Kernel::new(name, poses.len(), move || {
        for rel in &poses {
            black_box(collide_convex(&a, &b, rel, MARGIN));
        }
    })
}

/// Ground of triangles that reaches as far as `half` along x and z [m], and its height there [m].
pub struct Ground<'a> {
    /// The triangles.
    pub mesh: TriangleMesh,
    /// [m]
    pub half: f32,
    /// At x and z [m].
    pub height: &'a dyn Fn(f32, f32) -> f32,
}

/// Shapes on a terrain.
pub fn mesh(terrain: &Ground<'_>) -> Vec<Kernel> {
    let ground = terrain.mesh.clone();
    let ground = collider(Geometry::Mesh(Arc::new(ground)));
    [("sphere mesh", sphere()), ("capsule mesh", capsule()), ("box mesh", cuboid()), ("hull mesh", hull())]
        .into_iter()
        .map(|(name, shape)| on_ground(name, shape, ground.clone(), terrain))
        .collect()
}

fn on_ground(name: &str, shape: Collider, ground: Collider, terrain: &Ground<'_>) -> Kernel {
    let mut random = Random(5);
    let half = 0.8 * terrain.half;
    let poses: Vec<Relative> = (0..PAIRS)
        .map(|_| {
            let (x, z) = (random.range(-half, half), random.range(-half, half));
            // About at its height at rest.
            let above = random.range(shape.inner_radius, 0.5 * (shape.inner_radius + shape.radius));
            let at = Vec3::new(x, (terrain.height)(x, z) + above, z);
            let back = random.turn().conjugate();
            Relative { position: back * -at, rotation: back }
        })
        .collect();
    let (mut scratch, mut out) = (MeshScratch::default(), Vec::new());
    Kernel::new(name, poses.len(), move || {
        for rel in &poses {
            out.clear();
            collide_mesh(&shape, &ground, rel, Reach::new(MARGIN), &mut scratch, &mut out);
            black_box(&mut out);
        }
    })
}

fn alike() -> [(&'static str, Collider, Collider); 3] {
    [
        ("box box", cuboid(), cuboid()),
        ("cylinder cylinder", cylinder(), cylinder()),
        ("hull hull", hull(), hull()),
    ]
}

/// GJK from nothing, without a hint, for shapes that are apart or just touch.
pub fn distance() -> Vec<Kernel> {
    alike()
        .into_iter()
        .map(|(name, a, b)| {
            let mut poses = poses(&a, &b);
            poses.iter_mut().for_each(|rel| rel.position *= 1.5);
            Kernel::new(name, poses.len(), move || {
                let (Some(a), Some(b)) = (a.geometry.support(), b.geometry.support()) else { return };
                for rel in &poses {
                    black_box(crate::narrow_phase::distance(&a, &b, rel, Vec3::ZERO));
                }
            })
        })
        .collect()
}

/// A rotating shape moves 3 m towards another rotating one, and may miss it.
pub fn cast() -> Vec<Kernel> {
    alike().into_iter().map(|(name, a, b)| flight(name, a, b)).collect()
}

fn flight(name: &str, a: Collider, b: Collider) -> Kernel {
    let mut random = Random(9);
    let motions: Vec<Motion> = (0..PAIRS)
        .map(|_| {
            let mut path = |centre: Vec3, aside: f32| BodyPath {
                centre: centre.as_dvec3(),
                rotation: random.turn(),
                displacement: -centre
                    + Vec3::new(0.0, random.range(-aside, aside), random.range(-aside, aside)),
                spin: random.direction() * random.range(0.0, 2.0),
            };
            let (flying, still) = (path(Vec3::new(-3.0, 0.0, 0.0), 1.0), path(Vec3::ZERO, 0.0));
            Motion::new(&a, &flying, &b, &still)
        })
        .collect();
    let tolerance = tolerance(&a, &b, 1.0);
    Kernel::new(name, motions.len(), move || {
        for motion in &motions {
            black_box(cast_convex(&a, &b, motion, tolerance));
        }
    })
}
