//! Fast pairs that are apart: where do they really touch within the step?
//!
//! The same kernels run at the pose of first touch, and the separations they find are carried back along the relative
//! motion to the start of the step. A pair that does not touch gets no point at all, so nothing is pushed by what it
//! never reaches; and of a mesh only the first obstacle on the path counts.

use super::cast::{Touch, cast_convex, cast_plane, tolerance};
use super::cast_mesh::cast_mesh;
use super::collide::{Found, Input};
use super::convex::collide_convex;
use super::mesh::collide_mesh;
use super::motion::{BodyPath, Motion};
use super::{RawManifold, Relative};
use crate::body::exp_map;
use crate::broad_phase::Pair;
use crate::shape::{Collider, Kind};
use glam::{DVec3, Quat, Vec3};

/// The manifold of two convex shapes, or of one and a plane, at their first touch within the step, and the fraction
/// of the step at which that is.
pub(crate) fn look_ahead(input: &Input<'_>, pair: &Pair) -> Option<(RawManifold, f32)> {
    let (a, b) = (&input.colliders[pair.a as usize], &input.colliders[pair.b as usize]);
    let motion = Motion::new(a, &path(input, pair.a), b, &path(input, pair.b));
    let tolerance = tolerance(a, b);
    let touch = if b.kind == Kind::Plane {
        cast_plane(a, b, &motion, tolerance)
    } else {
        cast_convex(a, b, &motion, tolerance)
    }?;
    let raw = collide_convex(a, b, &motion.relative(touch.fraction), input.margin);
    Some((carry_back(&raw, &motion, touch.fraction, 0.0), touch.fraction))
}

/// The manifold of two convex shapes, or of one and a plane, as it will be in the middle of the step.
pub(crate) fn halfway(input: &Input<'_>, pair: &Pair, margin: f32) -> RawManifold {
    let (a, b) = (&input.colliders[pair.a as usize], &input.colliders[pair.b as usize]);
    let motion = Motion::new(a, &path(input, pair.a), b, &path(input, pair.b));
    let raw = collide_convex(a, b, &motion.relative(0.5), margin);
    carry_back(&raw, &motion, 0.5, f32::MIN)
}

/// Adds the manifolds of a convex shape at its first touch with a mesh or height field.
pub(crate) fn look_ahead_mesh(input: &Input<'_>, pair: &Pair, out: &mut Found) {
    let (a, b) = (&input.colliders[pair.a as usize], &input.colliders[pair.b as usize]);
    let motion = Motion::new(a, &path(input, pair.a), b, &path(input, pair.b));
    let Some(Touch { fraction, .. }) = cast_mesh(a, b, &motion, tolerance(a, b), input.margin) else {
        return;
    };
    out.raw.clear();
    collide_mesh(a, b, &motion.relative(fraction), input.margin, &mut out.mesh, &mut out.raw);
    out.many.extend(out.raw.iter().map(|raw| (carry_back(raw, &motion, fraction, 0.0), fraction)));
}

/// How the body of a collider moves within the step.
fn path(input: &Input<'_>, collider: u32) -> BodyPath {
    let c = &input.colliders[collider as usize];
    let pose = &input.poses[collider as usize];
    let rotation = pose.rotation * c.rotation.conjugate();
    let motion = input.motion_of(collider);
    BodyPath {
        centre: pose.position - (rotation * c.position).as_dvec3(),
        rotation,
        displacement: motion.linear,
        spin: motion.angular,
    }
}

/// A manifold found at a fraction of the step, in the frame of shape a as it is at the start: its arms are those of the
/// touch, its separations what the predicted motion takes away until then, which is at least `least`.
fn carry_back(raw: &RawManifold, motion: &Motion, fraction: f32, least: f32) -> RawManifold {
    let turned = exp_map(motion.a.spin * fraction);
    let at_touch = turned * motion.a.rotation;
    let lever = turned * motion.a.lever;
    let back: Quat = motion.a.rotation.conjugate();
    let normal = at_touch * raw.normal;
    let apart = (motion.start + (motion.displacement * fraction).as_dvec3()).as_vec3();
    let mut carried = *raw;
    carried.normal = back * normal;
    for point in &mut carried.points[..raw.count as usize] {
        let arm_a = lever + at_touch * point.position;
        let arm_b = arm_a + apart;
        let closed = motion.displacement + motion.a.spin.cross(arm_a) - motion.b.spin.cross(arm_b);
        // With 0 as the least, a point that moves away until the touch does not count as overlap at the start.
        point.separation += (fraction * normal.dot(closed)).max(least);
        point.position = back * (arm_a - motion.a.lever);
    }
    carried
}
