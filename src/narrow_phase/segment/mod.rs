//! Where a segment enters a shape: the guard against tunnelling, and what ray queries build on.
//!
//! All in `f64`, from `f32` ends: a few roots a query, and cancellation is not a topic.

#[cfg(test)]
mod tests;

use super::Triangles;
use crate::shape::{Collider, ConvexHull, Geometry, Kind};
use glam::{DVec3, Vec3};

// Rounding: grazing segments hit.
/// Shapes are enlarged by this share of their size for segments from outside, so that grazing ones hit.
const GENEROSITY: f64 = 1e-6;

/// Where a segment enters a shape.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct SegmentHit {
    /// Fraction of the segment, 0..=1.
    pub(crate) fraction: f32,
    /// Unit, out of the shape (of a mesh: against the segment), in the shape's frame.
    pub(crate) normal: Vec3,
}

/// A fraction, and the direction that the surface faces.
pub(crate) type Entry = (f64, DVec3);

/// First entry of the segment into a shape, in the shape's frame. A segment that starts inside a solid shape,
/// or in the half-space of a plane, doesn't enter it: None. Triangles are met from both sides.
pub(crate) fn segment_hits(shape: &Collider, from: Vec3, to: Vec3) -> Option<SegmentHit> {
    let (start, path) = (from.as_dvec3(), to.as_dvec3() - from.as_dvec3());
    let [x, y, z, _] = shape.size.map(f64::from);
    let extra = GENEROSITY * f64::from(shape.radius);
    // Once with the larger shape; and once as it is, for a start between the two surfaces.
    let entry = |enter: &dyn Fn(f64) -> Option<Entry>| enter(extra).or_else(|| enter(0.0));
    let found = match shape.kind {
        Kind::Sphere => entry(&|e| ball(start, path, x + e)),
        Kind::Capsule => entry(&|e| capsule(start, path, x, y + e, z + e)),
        Kind::Box => entry(&|e| cuboid(start, path, DVec3::new(x + e, y + e, z + e))),
        Kind::Cylinder => entry(&|e| frustum(start, path, x + e, y + e, z + e)),
        Kind::Hull => match &shape.geometry {
            Geometry::Hull(hull) => entry(&|e| polyhedron(start, path, hull, e)),
            _ => None,
        },
        Kind::Plane => plane(start, path),
        Kind::Mesh | Kind::HeightField => {
            return match &shape.geometry {
                Geometry::Mesh(mesh) => segment_hits_triangles(&**mesh, from, to),
                Geometry::HeightField(field) => segment_hits_triangles(&**field, from, to),
                _ => None,
            };
        }
    };
    found.map(|(fraction, normal)| SegmentHit {
        fraction: fraction as f32,
        normal: normal.normalize_or(DVec3::Y).as_vec3(),
    })
}

/// The same over any triangles.
pub(crate) fn segment_hits_triangles<T: Triangles + ?Sized>(
    mesh: &T,
    from: Vec3,
    to: Vec3,
) -> Option<SegmentHit> {
    let (fraction, index) = mesh.segment_hit(from, to)?;
    let [a, b, c] = mesh.triangle(index).map(Vec3::as_dvec3);
    let path = to.as_dvec3() - from.as_dvec3();
    let normal = (b - a).cross(c - a).normalize_or(-path.normalize_or(-DVec3::Y));
    let normal = if normal.dot(path) > 0.0 { -normal } else { normal };
    Some(SegmentHit { fraction, normal: normal.as_vec3() })
}

pub(crate) fn plane(start: DVec3, path: DVec3) -> Option<Entry> {
    let end = start.y + path.y;
    (start.y >= 0.0 && path.y < 0.0 && end <= 0.0).then(|| ((start.y / -path.y).min(1.0), DVec3::Y))
}

pub(crate) fn ball(start: DVec3, path: DVec3, radius: f64) -> Option<Entry> {
    let c = start.length_squared() - radius * radius;
    let b = start.dot(path);
    if c < 0.0 || b >= 0.0 {
        return None;
    }
    let (first, _) = roots(path.length_squared(), b, c)?;
    (first <= 1.0).then(|| (first.max(0.0), start + path * first))
}

pub(crate) fn cuboid(start: DVec3, path: DVec3, half: DVec3) -> Option<Entry> {
    let faces = [DVec3::X, DVec3::Y, DVec3::Z].into_iter().zip(half.to_array());
    clip(start, path, faces.flat_map(|(axis, half)| [(axis, half), (-axis, half)]))
}

pub(crate) fn polyhedron(start: DVec3, path: DVec3, hull: &ConvexHull, extra: f64) -> Option<Entry> {
    clip(start, path, hull.planes.iter().map(|(n, offset)| (n.as_dvec3(), f64::from(*offset) + extra)))
}

/// Entry into the intersection of half-spaces n · x <= offset (Cyrus and Beck, 1978).
fn clip(start: DVec3, path: DVec3, planes: impl Iterator<Item = (DVec3, f64)>) -> Option<Entry> {
    let (mut enter, mut leave) = (f64::NEG_INFINITY, 1.0_f64);
    let mut normal = DVec3::ZERO;
    for (n, offset) in planes {
        let (above, slope) = (n.dot(start) - offset, n.dot(path));
        if slope == 0.0 {
            if above > 0.0 {
                return None;
            }
        } else if slope < 0.0 {
            let at = above / -slope;
            if at > enter {
                (enter, normal) = (at, n);
            }
        } else {
            leave = leave.min(-above / slope);
        }
    }
    (enter >= 0.0 && enter <= leave).then_some((enter, normal))
}

/// Two balls and, where neither contains the other, the cone that touches both.
pub(crate) fn capsule(start: DVec3, path: DVec3, half: f64, bottom: f64, top: f64) -> Option<Entry> {
    let centre = DVec3::Y * half;
    // Sine of the angle by which the side leans: its normals point up by it.
    let lean = if half > 0.0 { (bottom - top) / (2.0 * half) } else { 2.0 };
    if lean.abs() >= 1.0 {
        let (at, radius) = if bottom > top { (-centre, bottom) } else { (centre, top) };
        return ball(start - at, path, radius);
    }
    let flat = (1.0 - lean * lean).sqrt();
    let mean = 0.5 * (bottom + top);
    // Above the surface of the cone, and along it from the middle.
    let side = |p: DVec3| {
        let across = (p.x * p.x + p.z * p.z).sqrt();
        (across * flat + p.y * lean - mean, p.y * flat - across * lean)
    };
    let (above, along) = side(start);
    let inside = if along.abs() <= half * flat {
        above < 0.0
    } else {
        let (at, radius) = if along < 0.0 { (-centre, bottom) } else { (centre, top) };
        (start - at).length_squared() < radius * radius
    };
    if inside {
        return None;
    }
    let mut first: Option<Entry> = None;
    let mut take = |entry: Option<Entry>| {
        if let Some(entry) = entry
            && first.is_none_or(|f| entry.0 < f.0)
        {
            first = Some(entry);
        }
    };
    take(ball(start + centre, path, bottom));
    take(ball(start - centre, path, top));
    // (x² + z²) flat² = (mean - y lean)²
    let squared = |p: DVec3, q: DVec3| (p.x * q.x + p.z * q.z) * flat * flat;
    let rest = mean - start.y * lean;
    let a = squared(path, path) - path.y * lean * path.y * lean;
    let b = squared(start, path) + rest * path.y * lean;
    let c = squared(start, start) - rest * rest;
    if let Some((t0, t1)) = roots(a, b, c) {
        for t in [t0, t1] {
            let p = start + path * t;
            let across = DVec3::new(p.x, 0.0, p.z);
            let normal = across.normalize_or_zero() * flat + DVec3::Y * lean;
            let on_side = side(p).1.abs() <= half * flat && mean - p.y * lean >= 0.0;
            if (0.0..=1.0).contains(&t) && on_side && normal.dot(path) < 0.0 {
                take(Some((t, normal)));
            }
        }
    }
    first
}

/// The part of a cone between two heights.
pub(crate) fn frustum(start: DVec3, path: DVec3, half: f64, bottom: f64, top: f64) -> Option<Entry> {
    // Radius at a height: mean - lean y.
    let (mean, lean) = (0.5 * (bottom + top), 0.5 * (bottom - top) / half);
    let caps = [(DVec3::Y, half), (-DVec3::Y, half)];
    // What the caps leave of the whole line.
    let (mut enter, mut leave) = (f64::NEG_INFINITY, f64::INFINITY);
    let mut normal = DVec3::Y;
    for (n, offset) in caps {
        let (above, slope) = (n.dot(start) - offset, n.dot(path));
        if slope == 0.0 {
            if above > 0.0 {
                return None;
            }
        } else if slope < 0.0 {
            if above / -slope > enter {
                (enter, normal) = (above / -slope, n);
            }
        } else {
            leave = leave.min(-above / slope);
        }
    }
    // x² + z² - (mean - lean y)² <= 0; between the caps only the cone's own half is left.
    let rest = mean - lean * start.y;
    let a = path.x * path.x + path.z * path.z - lean * path.y * lean * path.y;
    let b = start.x * path.x + start.z * path.z + lean * path.y * rest;
    let c = start.x * start.x + start.z * start.z - rest * rest;
    let mut round_enter = f64::NEG_INFINITY;
    match roots(a, b, c) {
        None if a > 0.0 || c > 0.0 => return None,
        None => {}
        Some((t0, t1)) if a > 0.0 => {
            round_enter = t0;
            leave = leave.min(t1);
        }
        // Along the side: one root.
        Some((t0, _)) if a == 0.0 && b < 0.0 => round_enter = t0,
        // Steeper than the side: inside up to the first root, or from the second.
        Some((t0, _)) if a == 0.0 || enter <= t0 => leave = leave.min(t0),
        Some((_, t1)) => round_enter = t1,
    }
    if round_enter > enter {
        enter = round_enter;
        let p = start + path * enter;
        normal = DVec3::new(p.x, 0.0, p.z).normalize_or_zero() + DVec3::Y * lean;
    }
    (enter >= 0.0 && enter <= leave.min(1.0)).then_some((enter, normal))
}

/// The roots of a t² + 2 b t + c in order, none if complex; a linear equation has its root twice.
fn roots(a: f64, b: f64, c: f64) -> Option<(f64, f64)> {
    let root = b * b - a * c;
    if root < 0.0 {
        return None;
    }
    // The sum that doesn't cancel.
    let q = -(b + root.sqrt().copysign(b));
    if q == 0.0 {
        return (a != 0.0).then_some((0.0, 0.0));
    }
    let (s, t) = (if a == 0.0 { c / q } else { q / a }, c / q);
    Some((s.min(t), s.max(t)))
}
