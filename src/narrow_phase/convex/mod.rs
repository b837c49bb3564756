//! Any two convex shapes, one pair at a time: the general path, and the reference for the lane kernels.
//!
//! Shapes that are apart along a face normal by more than the margin have no contact. Otherwise the best axis
//! of [`sat`] makes the manifold. If two shapes are apart and nearest at an edge or vertex of both, the
//! normal is the direction between the nearest points: a reference plane there would stop a shape that passes
//! beside the face.

pub(crate) mod clip;
pub(crate) mod cylinder;
pub(crate) mod gjk;
pub(crate) mod polytope;
mod polytopes;
pub(crate) mod reduce;
pub(crate) mod round_polytope;
pub(crate) mod sat;
pub(crate) mod simplex;

use super::Relative;
use crate::narrow_phase::contacts::manifold::{RawManifold, RawPoint};
use crate::shape::{Collider, Kind};
use clip::Cloud;
use glam::Vec3;
use polytope::{Pose, Solid};
use polytopes::polytopes;
use reduce::reduce;
use round_polytope::{Core, round_polytope, round_round};

/// All points nearer than the margin of two convex shapes, or of a convex shape and a half-space; in a's
/// frame.
pub(crate) fn collide_convex(a: &Collider, b: &Collider, rel: &Relative, margin: f32) -> RawManifold {
    if a.kind > b.kind {
        let back = rel.inverse();
        return collide_convex(b, a, &back, margin).flipped(&back);
    }
    let pose = Pose::new(rel.position, rel.rotation);
    if !a.kind.is_convex() {
        return RawManifold::default();
    }
    if b.kind == Kind::Plane {
        return half_space(a, &pose, margin);
    }
    if !b.kind.is_convex() {
        return RawManifold::default();
    }
    match (Core::of(a), Core::of(b)) {
        (Some(a), Some(b)) => round_round(&a, &b.moved(&pose), margin),
        (Some(core), None) => {
            let back = pose.inverse();
            let size = a.radius.min(b.radius);
            let in_b = if b.kind == Kind::Cylinder {
                cylinder::round_cylinder(&core.moved(&back), b, margin)
            } else {
                let Some(solid) = Solid::of(b) else { return RawManifold::default() };
                round_polytope(&core.moved(&back), &solid.view(), margin, size)
            };
            in_frame(in_b, &pose)
        }
        _ if a.kind == Kind::Cylinder || b.kind == Kind::Cylinder => cylinder::cylinder(a, b, &pose, margin),
        _ => {
            let (Some(of_a), Some(of_b)) = (Solid::of(a), Solid::of(b)) else {
                return RawManifold::default();
            };
            polytopes(&of_a.view(), &of_b.view(), &pose, margin, a.radius.min(b.radius))
        }
    }
}

/// A manifold in b's frame whose normal points from a to b, in a's frame.
fn in_frame(mut manifold: RawManifold, b_in_a: &Pose) -> RawManifold {
    manifold.normal = b_in_a.direction(manifold.normal);
    for point in &mut manifold.points[..manifold.count as usize] {
        point.position = b_in_a.point(point.position);
    }
    manifold
}

/// The points of a cloud, at most four of them.
pub(super) fn manifold_of(cloud: &Cloud, normal: Vec3) -> RawManifold {
    let (points, count) = reduce(cloud.points(), normal);
    RawManifold { normal, count: count as u16, material: 0, points }
}

/// A convex shape and the half-space y <= 0 of the frame at `pose`.
fn half_space(a: &Collider, pose: &Pose, margin: f32) -> RawManifold {
    let normal = -pose.axes.y_axis;
    let height = |p: Vec3| normal.dot(pose.position - p);
    let mut cloud = Cloud::new();
    let mut emit = |at: Vec3, separation: f32, key: u32| {
        if separation <= margin {
            cloud.push(RawPoint { position: at + normal * (0.5 * separation), separation, key });
        }
    };
    if let Some(core) = Core::of(a) {
        let ends = if core.is_ball() { 1 } else { 2 };
        for k in 0..ends {
            let (c, r) = (core.at(k as f32), core.radius_at(k as f32));
            emit(c + normal * r, height(c) - r, k);
        }
        return manifold_of(&cloud, normal);
    }
    if let Some(f) = cylinder::Frustum::of(a) {
        let plane = (normal, normal.dot(pose.position));
        cylinder::on_half_space(&f, plane, margin, a.radius, &mut cloud);
        return manifold_of(&cloud, normal);
    }
    let Some(solid) = Solid::of(a) else { return RawManifold::default() };
    for (i, v) in solid.view().vertices.iter().enumerate() {
        emit(*v, height(*v), i as u32);
    }
    manifold_of(&cloud, normal)
}

#[cfg(test)]
pub(crate) mod testing;

#[cfg(test)]
mod tests;
