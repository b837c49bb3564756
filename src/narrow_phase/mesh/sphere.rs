//! A sphere against triangles: nearest points, eight triangles at a time.

use super::patch::{Patch, Patches, Touch};
use super::triangles::Triangles;
use crate::config::tuning::FLAT_EDGE_COSINE;
use crate::lanes::{Lanes, Mask, Vec3 as LaneVec3, ones};
use crate::narrow_phase::RawPoint;
use crate::shape::Fold;
use crate::shape::Ground;
use glam::Vec3;

/// Key of a point with the face's normal on the border of the face, until [`finish`].
const BORDER: u32 = u32::MAX;

/// The point of each triangle that is nearest to `place`, and the feature it is on: 0 the face, 1 + i the
/// edge i, 4 + i the corner i.
#[inline(always)]
pub(crate) fn nearest<L: Lanes>(triangles: &Triangles<L>, place: LaneVec3<L>) -> (LaneVec3<L>, L) {
    let (zero, one) = (L::zero(), L::one());
    let mut least = L::splat(f32::MAX);
    let mut point = LaneVec3::zero();
    let mut feature = zero;
    let mut left = L::zero().le(zero);
    let mut right = left;
    for i in 0..3 {
        let (from, to) = (triangles.corners[i], triangles.corners[(i + 1) % 3]);
        let along = to - from;
        let away = place - from;
        let t = away.dot(along) / along.length_squared();
        let clamped = t.clamp(zero, one);
        let at = from + along * clamped;
        let squared = (at - place).length_squared();
        let nearer = squared.lt(least);
        let name = Lanes::select(t.le(zero), L::splat(4.0 + i as f32), L::splat(1.0 + i as f32));
        let name = Lanes::select(t.ge(one), L::splat(4.0 + ((i + 1) % 3) as f32), name);
        least = Lanes::select(nearer, squared, least);
        point = LaneVec3::select(nearer, at, point);
        feature = Lanes::select(nearer, name, feature);
        let side = along.cross(away).dot(triangles.front);
        left = left & side.ge(zero);
        right = right & side.le(zero);
    }
    let foot = place - triangles.front * (place - triangles.corners[0]).dot(triangles.front);
    let over = left | right;
    (LaneVec3::select(over, foot, point), Lanes::select(over, zero, feature))
}

/// Adds a patch of one point for every triangle that is nearer than its margin.
#[inline(always)]
pub(crate) fn touch<L: Lanes>(
    radius: f32,
    triangles: &Triangles<L>,
    margins: L,
    ground: &Ground,
    patches: &mut Patches,
) {
    let (point, feature) = nearest(triangles, LaneVec3::zero());
    let distance = point.length();
    for lane in ones(distance.le(L::splat(radius) + margins).bits() & triangles.valid) {
        let touch = triangles.touch(lane, ground);
        let (point, distance) = (point.lane(lane), distance.lane(lane));
        let feature = feature.lane(lane) as u32;
        let normal = match feature {
            0 => Some((-touch.front, true)),
            _ => edge_normal(&touch, feature, point, distance),
        };
        let Some((normal, face)) = normal else { continue };
        let separation = distance - radius;
        let first = patches.points.len();
        // A sphere has one point, whose key stays the same as it rolls from triangle to triangle.
        let key = match (face, feature) {
            (true, 0) => 0,
            (true, _) => BORDER,
            _ => 1 + touch.index.wrapping_mul(8) + feature,
        };
        patches.points.push(RawPoint { position: point - normal * (0.5 * separation), separation, key });
        if face && feature != 0 {
            patches.add_in_gap(touch, normal, separation, first);
        } else {
            patches.add(touch, normal, face.then_some(separation), first);
        }
    }
}

/// The normal at an edge or a corner, if there is one, and whether it counts as the face's.
fn edge_normal(touch: &Touch, feature: u32, point: Vec3, distance: f32) -> Option<(Vec3, bool)> {
    let corner = feature as usize % 4;
    let folds = match feature {
        1..=3 => [touch.edges.fold(feature as usize - 1); 2],
        _ => [touch.edges.fold(corner), touch.edges.fold((corner + 2) % 3)],
    };
    // A sphere whose centre is on the edge may leave by the face.
    let normal = if distance > 1e-9 { point / distance } else { -touch.front };
    if folds.iter().any(|f| matches!(f, Fold::Ridge | Fold::Open)) {
        return Some((normal, false));
    }
    // Beyond a flat edge, yet over it: in the gap between two faces of a hardly convex edge.
    let over = -normal.dot(touch.front) >= FLAT_EDGE_COSINE && folds.contains(&Fold::Flat);
    over.then_some((normal, true))
}

/// Drops points that are not nearest points of the surface: a point on an edge is dropped if another triangle
/// with that edge has a nearer point, or the same one over its face. Two points under a ball would be a
/// lever.
pub(crate) fn finish(radius: f32, patches: &mut Patches) {
    let Patches { touches, patches, points, .. } = patches;
    let tolerance = 1e-5 * radius;
    for i in 0..patches.len() {
        let patch = patches[i];
        let point = points[patch.first as usize];
        let at = point.position + patch.normal * (0.5 * point.separation);
        let shared = |other: &Patch| is_on(at, &touches[other.touch as usize], 10.0 * tolerance);
        let hidden = if patch.reach.is_none() {
            patches.iter().any(|other| other.least < patch.least - tolerance && shared(other))
        } else {
            point.key == BORDER
                && patches.iter().enumerate().any(|(j, other)| {
                    let key = points[other.first as usize].key;
                    let before = key == 0 || (key == BORDER && j < i);
                    before && other.normal.dot(patch.normal) >= FLAT_EDGE_COSINE && shared(other)
                })
        };
        // Points are dropped only after all were examined: a hidden point hides others too.
        patches[i].count = if hidden { 0 } else { patch.count };
    }
    patches.retain(|patch| patch.count > 0);
    for point in points.iter_mut().filter(|p| p.key == BORDER) {
        point.key = 0;
    }
}

/// Whether a point is on the border of a triangle.
fn is_on(point: Vec3, touch: &Touch, tolerance: f32) -> bool {
    (0..3).any(|i| {
        let (from, to) = (touch.corners[i], touch.corners[(i + 1) % 3]);
        let along = to - from;
        let t = ((point - from).dot(along) / along.length_squared()).clamp(0.0, 1.0);
        (from + along * t - point).length_squared() <= tolerance * tolerance
    })
}
