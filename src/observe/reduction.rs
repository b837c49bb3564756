//! The engine's reduction of contact points, to compare it with others.

use crate::narrow_phase::{RawPoint, reduce};
use glam::Vec3;

/// Which of some points of one plane of contact the engine keeps, at most four, in the order in which it
/// has them. `points`: positions [m] and separations, negative in overlap [m]; it considers the first 64.
/// `normal`: of the plane, a unit vector.
pub fn kept_points(points: &[(Vec3, f32)], normal: Vec3) -> Vec<usize> {
    let raw = |(&(position, separation), key)| RawPoint { position, separation, key };
    let raw: Vec<RawPoint> = points.iter().zip(0..).map(raw).collect();
    let (kept, count) = reduce(&raw, normal);
    kept[..count as usize].iter().map(|point| point.key as usize).collect()
}
