//! Random shapes and poses for the tests of this folder and of the queries.

use crate::math::Quat;
use crate::narrow_phase::cast::motion::BodyPath;
use crate::random::Random;
use crate::shape::{Collider, ConvexHull, Geometry, Kind};
use glam::{DQuat, DVec3, Vec3};
use std::sync::Arc;

impl Random {
    /// Any rotation, not evenly.
    pub(crate) fn turn(&mut self) -> Quat {
        self.rotation().into()
    }
    /// The way of a body that begins so far from the origin and goes as far [m], and turns by up to so much
    /// about each axis [rad].
    pub(crate) fn body(&mut self, far: f32, turns: f32) -> BodyPath {
        BodyPath {
            centre: (self.direction() * far).as_dvec3(),
            rotation: self.turn(),
            displacement: self.direction() * far,
            spin: self.cube() * turns,
        }
    }
    /// A triangle of about a metre, about so far from the origin [m].
    pub(crate) fn triangle(&mut self, far: f32) -> [Vec3; 3] {
        let at = self.cube() * far;
        [at + self.cube(), at + self.cube(), at + self.cube()]
    }
    /// Turned at random, or by quarter turns, so that faces and edges lie parallel.
    pub(crate) fn rotation_or_aligned(&mut self) -> Quat {
        match self.below(3) {
            0 => Quat::IDENTITY,
            1 => {
                let h = std::f32::consts::FRAC_1_SQRT_2;
                [Quat::from_xyzw(h, 0.0, 0.0, h), Quat::from_xyzw(0.0, 0.0, h, h)][self.below(2)]
            }
            _ => self.turn(),
        }
    }
    /// A convex shape of about this size.
    pub(crate) fn shape(&mut self, kind: Kind, size: f32) -> Collider {
        let mut length = || size * self.range(0.05, 1.0);
        let (x, y, z) = (length(), length(), length());
        collider(match kind {
            Kind::Sphere => Geometry::Sphere { radius: x },
            Kind::Capsule if self.below(2) == 0 => Geometry::capsule(x, y),
            Kind::Capsule => Geometry::Capsule { half_height: x, radius_bottom: y, radius_top: z },
            Kind::Box => Geometry::cuboid(x, y, z),
            Kind::Cylinder if self.below(2) == 0 => Geometry::cylinder(x, y),
            Kind::Cylinder if self.below(4) == 0 => {
                Geometry::Cylinder { half_height: x, radius_bottom: y, radius_top: 0.0 }
            }
            Kind::Cylinder => Geometry::Cylinder { half_height: x, radius_bottom: y, radius_top: z },
            _ => {
                let points: Vec<Vec3> = (0..4 + self.below(40)).map(|_| self.cube() * size).collect();
                match ConvexHull::new(&points) {
                    Ok(hull) => Geometry::Hull(Arc::new(hull)),
                    Err(_) => Geometry::cuboid(x, y, z),
                }
            }
        })
    }
}

pub(crate) const CONVEX: [Kind; 5] = [Kind::Sphere, Kind::Capsule, Kind::Box, Kind::Cylinder, Kind::Hull];

/// A shape in the middle of its body.
pub(crate) fn collider(geometry: Geometry) -> Collider {
    Collider { body: 0, ..Collider::new(geometry) }
}

/// How far a point is inside a convex shape's surface along the direction in which it is least so, by
/// definition, not by the code under test; about, for a tapered capsule. Positive inside [m].
pub(crate) fn depth(shape: &Collider, p: DVec3) -> f64 {
    let across = (p.x * p.x + p.z * p.z).sqrt();
    let [x, y, z, _] = shape.size.map(f64::from);
    match shape.kind {
        Kind::Sphere => x - p.length(),
        // The balls along the axis whose radii go from one to the other, finely.
        Kind::Capsule => (0..=1000)
            .map(|i| f64::from(i) / 1000.0)
            .map(|s| (y + (z - y) * s) - (p - DVec3::Y * (x * (2.0 * s - 1.0))).length())
            .fold(f64::MIN, f64::max),
        Kind::Box => (DVec3::new(x, y, z) - p.abs()).min_element(),
        Kind::Cylinder => {
            let slope = (y - z) / (2.0 * x);
            let side = (0.5 * (y + z) - slope * p.y - across) / (1.0 + slope * slope).sqrt();
            side.min(x - p.y.abs())
        }
        Kind::Hull => match &shape.geometry {
            Geometry::Hull(hull) => hull
                .planes
                .iter()
                .map(|(n, offset)| f64::from(*offset) - n.as_dvec3().dot(p))
                .fold(f64::MAX, f64::min),
            _ => f64::MIN,
        },
        Kind::Plane => -p.y,
        _ => f64::MIN,
    }
}

/// The furthest point along `d` by definition, in f64 [m].
pub(crate) fn furthest(shape: &Collider, d: DVec3) -> DVec3 {
    let [x, y, z, _] = shape.size.map(f64::from);
    let best = |points: &mut dyn Iterator<Item = DVec3>| {
        points.fold(None, |best: Option<DVec3>, p| match best {
            Some(b) if b.dot(d) >= p.dot(d) => Some(b),
            _ => Some(p),
        })
    };
    let across = DVec3::new(d.x, 0.0, d.z).normalize_or_zero();
    let found = match shape.kind {
        Kind::Sphere => Some(d.normalize() * x),
        Kind::Capsule => {
            best(&mut [DVec3::Y * x + d.normalize() * z, DVec3::Y * -x + d.normalize() * y].into_iter())
        }
        Kind::Box => best(&mut (0..8).map(|i| {
            let s = |b: u32, v: f64| if i >> b & 1 == 0 { v } else { -v };
            DVec3::new(s(0, x), s(1, y), s(2, z))
        })),
        Kind::Cylinder => best(&mut [DVec3::Y * x + across * z, DVec3::Y * -x + across * y].into_iter()),
        _ => match &shape.geometry {
            Geometry::Hull(hull) => best(&mut hull.vertices.iter().map(|v| v.as_dvec3())),
            _ => None,
        },
    };
    found.unwrap_or_default()
}

/// The gap of two shapes along a unit direction from a to b, in a's frame [m].
pub(crate) fn gap_along(a: &Collider, b: &Collider, rotation: DQuat, position: DVec3, n: DVec3) -> f64 {
    let on_b = rotation * furthest(b, rotation.conjugate() * -n) + position;
    (on_b - furthest(a, n)).dot(n)
}
