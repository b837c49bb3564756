//! Shared by the tests of this folder: shapes, and a slow reference in f64.

use super::*;
use crate::math::Quat;
pub(crate) use crate::narrow_phase::fixtures::collider;
use crate::narrow_phase::fixtures::{depth, furthest, gap_along};
pub(crate) use crate::random::Random;
use crate::shape::{ConvexHull, Geometry};
use glam::{DQuat, DVec3};
use std::sync::Arc;

pub(crate) fn hull(random: &mut Random, points: usize) -> Geometry {
    let squash = random.cube().abs() * 0.6 + 0.4;
    let points: Vec<Vec3> = (0..points).map(|_| random.direction() * squash).collect();
    Geometry::Hull(Arc::new(ConvexHull::new(&points).unwrap()))
}

/// A shape of a kind, about a metre in size.
pub(crate) fn shape(random: &mut Random, kind: Kind) -> Collider {
    let mut size = || 0.3 + 0.7 * random.unit();
    let (x, y, z) = (size(), size(), size());
    let tapers = random.below(2) == 0;
    collider(match kind {
        Kind::Sphere => Geometry::Sphere { radius: x },
        Kind::Capsule if tapers => {
            Geometry::Capsule { half_height: y, radius_bottom: x * 0.5, radius_top: z * 0.5 }
        }
        Kind::Capsule => Geometry::capsule(y, x * 0.5),
        Kind::Box => Geometry::cuboid(x, y, z),
        Kind::Cylinder if tapers => {
            Geometry::Cylinder { half_height: y, radius_bottom: x, radius_top: z - 0.3 }
        }
        Kind::Cylinder => Geometry::cylinder(y, x),
        _ => {
            let n = 6 + random.below(20);
            hull(random, n)
        }
    })
}

/// Largest extent along a direction.
pub(crate) fn extent(shape: &Collider, d: DVec3) -> f64 {
    furthest(shape, d).dot(d)
}

/// Two shapes with the pose of b in a's frame.
pub(crate) struct Pair<'a> {
    pub(crate) a: &'a Collider,
    pub(crate) b: &'a Collider,
    pub(crate) rel: Relative,
}

impl Pair<'_> {
    /// Distance of the two along a unit vector from a to b.
    pub(crate) fn along(&self, n: DVec3) -> f64 {
        let rotation: DQuat = self.rel.rotation.as_dquat().normalize();
        gap_along(self.a, self.b, rotation, self.rel.position.as_dvec3(), n)
    }

    /// A lower bound of [`Self::signed_distance`] out of 400 directions.
    pub(crate) fn about(&self) -> f64 {
        spiral(400).map(|n| self.along(n)).fold(f64::MIN, f64::max)
    }

    /// The largest distance along any direction: the distance of the shapes or, negative, the depth of their
    /// overlap. A thousand directions and all normals, and from the best of them uphill.
    pub(crate) fn signed_distance(&self) -> f64 {
        let rotation: DQuat = self.rel.rotation.as_dquat().normalize();
        let mut starts: Vec<(f64, DVec3)> =
            spiral(1000).chain(self.normals(rotation)).map(|n| (self.along(n), n)).collect();
        starts.sort_by(|a, b| b.0.total_cmp(&a.0));
        let mut best = f64::MIN;
        for &(mut value, mut n) in starts.iter().take(8) {
            let mut step = 0.04;
            while step > 1e-7 {
                let (u, v) = (n.any_orthonormal_vector(), n.cross(n.any_orthonormal_vector()));
                let mut better = false;
                for k in 0..12 {
                    let angle = f64::from(k) * std::f64::consts::TAU / 12.0;
                    let next = (n + (u * libm::cos(angle) + v * libm::sin(angle)) * step).normalize();
                    let at = self.along(next);
                    if at > value {
                        (value, n, better) = (at, next, true);
                        break;
                    }
                }
                if !better {
                    step *= 0.5;
                }
            }
            best = best.max(value);
        }
        best
    }

    /// Compares a manifold with the reference of the two shapes, and checks that its points are nearer than a
    /// margin [m] and have keys of their own.
    pub(crate) fn compare(&self, manifold: &RawManifold, margin: f32) -> Compared {
        let n = manifold.normal.as_dvec3().normalize_or_zero();
        let back = self.rel.rotation.as_dquat().normalize().conjugate();
        let mut off = 0.0f64;
        for (i, point) in manifold.points().iter().enumerate() {
            assert!(point.separation <= margin, "{manifold:?}");
            assert!(manifold.points()[..i].iter().all(|p| p.key != point.key), "equal keys: {manifold:?}");
            let half = n * (0.5 * f64::from(point.separation));
            let (on_a, on_b) = (point.position.as_dvec3() - half, point.position.as_dvec3() + half);
            let in_b = back * (on_b - self.rel.position.as_dvec3());
            off = off.max(-depth(self.a, on_a)).max(-depth(self.b, in_b));
        }
        let (distance, least) = (self.signed_distance(), manifold.least().into());
        Compared { distance, along: self.along(n), least, outside: off }
    }

    /// All face normals, in a's frame.
    fn normals(&self, rotation: DQuat) -> Vec<DVec3> {
        let of = |shape: &Collider| match Solid::of(shape) {
            Some(solid) => solid.view().planes.iter().map(|p| p.0.as_dvec3()).collect(),
            None if shape.kind == Kind::Cylinder => vec![DVec3::Y, DVec3::NEG_Y],
            None => vec![],
        };
        let mut normals: Vec<DVec3> = of(self.a);
        normals.extend(of(self.b).into_iter().map(|n| rotation * -n));
        normals
    }
}

/// A manifold of two shapes, and the reference for them [m].
#[derive(Debug)]
pub(crate) struct Compared {
    /// Of the two shapes; negative in overlap.
    pub(crate) distance: f64,
    /// Distance along the manifold's normal.
    pub(crate) along: f64,
    /// Least separation of its points.
    pub(crate) least: f64,
    /// How far points are outside of the shapes.
    pub(crate) outside: f64,
}

/// The pose of `b` where it is about so far from `a` [m], brought near along a direction.
pub(crate) fn brought(a: &Collider, b: &Collider, direction: Vec3, rotation: Quat, at: f32) -> Relative {
    let mut far = a.radius + b.radius + 0.5;
    let pair = |t: f32| Pair { a, b, rel: Relative { position: direction * t, rotation } };
    for _ in 0..12 {
        far -= (pair(far).about() as f32 - at).max(-0.3) * 0.9;
    }
    pair(far).rel
}

/// Evenly spread unit vectors.
fn spiral(count: i32) -> impl Iterator<Item = DVec3> {
    (0..count).map(move |i| {
        let y = 1.0 - (2.0 * f64::from(i) + 1.0) / f64::from(count);
        let angle = f64::from(i) * 2.399_963_229_728_653;
        let r = (1.0 - y * y).sqrt();
        DVec3::new(r * libm::cos(angle), y, r * libm::sin(angle))
    })
}
