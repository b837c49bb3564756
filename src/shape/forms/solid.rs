//! Functions that forms share: where paths enter, nearest points, rotated bounds.

use crate::math::Quat;
use glam::{DVec3, Vec3};

/// A fraction, and the direction that the surface faces.
pub(crate) type Entry = (f64, DVec3);

/// The point of a surface that is nearest to a point outside.
#[derive(Clone, Copy, Debug)]
pub(crate) struct NearPoint {
    pub(crate) point: DVec3,
    /// Unit, from there to where it was asked from.
    pub(crate) normal: DVec3,
    /// [m]
    pub(crate) distance: f64,
}

impl NearPoint {
    /// A point of the surface; `facing` is its normal, for a point that lies on it.
    pub(crate) fn outside(at: DVec3, point: DVec3, facing: DVec3) -> NearPoint {
        let off = at - point;
        let distance = off.length();
        let normal = if distance > 0.0 { off / distance } else { facing };
        NearPoint { point, normal, distance }
    }
}

/// Bounds of a turned box.
pub(in crate::shape) fn turned_box((min, max): (Vec3, Vec3), rotation: Quat) -> (Vec3, Vec3) {
    let m = rotation.matrix();
    let (middle, half) = (m * (min * 0.5 + max * 0.5), max * 0.5 - min * 0.5);
    let half = m.x_axis.abs() * half.x + m.y_axis.abs() * half.y + m.z_axis.abs() * half.z;
    (middle - half, middle + half)
}

/// Whether a point is between two discs on the y axis and the cone from one to the other.
pub(super) fn within(point: Vec3, half_height: f32, bottom: f32, top: f32) -> bool {
    let radius = bottom + (top - bottom) * (0.5 + 0.5 * point.y / half_height);
    point.y.abs() < half_height && point.x.hypot(point.z) < radius
}

/// Distance from the y axis.
pub(super) fn across(at: DVec3) -> f64 {
    (at.x * at.x + at.z * at.z).sqrt()
}

/// Away from the y axis.
pub(super) fn outwards(at: DVec3) -> DVec3 {
    DVec3::new(at.x, 0.0, at.z).normalize_or(DVec3::X)
}

/// Where a path enters a ball around the origin.
pub(super) fn ball(start: DVec3, path: DVec3, radius: f64) -> Option<Entry> {
    let c = start.length_squared() - radius * radius;
    let b = start.dot(path);
    if c < 0.0 || b >= 0.0 {
        return None;
    }
    let (first, _) = roots(path.length_squared(), b, c)?;
    (first <= 1.0).then(|| (first.max(0.0), start + path * first))
}

/// Entry into the intersection of half-spaces n · x <= offset (Cyrus and Beck, 1978).
pub(in crate::shape) fn clip(
    start: DVec3,
    path: DVec3,
    planes: impl Iterator<Item = (DVec3, f64)>,
) -> Option<Entry> {
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

/// The roots of a t² + 2 b t + c in order, none if complex; a linear equation has its root twice.
pub(super) fn roots(a: f64, b: f64, c: f64) -> Option<(f64, f64)> {
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
