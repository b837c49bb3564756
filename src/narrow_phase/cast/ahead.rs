//! Manifolds at other poses than those of the start of the step, above all at the first touch of a fast pair.
//!
//! The same kernels run at the pose of the first touch, and the separations that they find are carried back
//! along the relative motion to the start of the step. A pair that does not touch gets no point at all, so
//! that nothing is pushed by an obstacle that it never reaches; of a mesh only the first obstacle on the path
//! counts.

use super::gates::enter_mesh;
use super::mesh::{CastResult, cast_mesh};
use super::mesh_cast::MeshCast;
use super::motion::{BodyPath, Motion};
use super::{Touch, cast_convex, tolerance};
use crate::body::exp_map;
use crate::broad_phase::Pair;
use crate::config::tuning::{NO_GAP, PLANE_TURN};
use crate::math::Quat;
use crate::narrow_phase::contacts::of_meshes::MeshBlock;
use crate::narrow_phase::convex::collide_convex;
use crate::narrow_phase::convex::gjk::distance;
use crate::narrow_phase::input::Input;
use crate::narrow_phase::mesh::reach::{Reach, extent_of};
use crate::narrow_phase::mesh::{MeshScratch, collide_mesh};
use crate::narrow_phase::{RawManifold, Relative};
use crate::shape::support::Support;
use crate::shape::{Collider, Geometry, Kind};
use glam::Vec3;

/// The manifold of two convex shapes, or of one and a plane, at their first touch within the step, and the
/// fraction of the step at which that is.
pub(crate) fn manifold_at_first_touch(input: &Input<'_>, pair: &Pair) -> Option<(RawManifold, f32)> {
    let (a, b) = input.shapes(pair);
    let motion = motion_of(input, pair);
    let tolerance = tolerance(a, b, input.unit);
    let touch = cast_convex(a, b, &motion, tolerance)?;
    let raw = collide_convex(a, b, &motion.relative(touch.fraction), margin_at_touch(input, pair, &touch));
    Some((carry_back(&raw, &motion, touch.fraction, 0.0), touch.fraction))
}

/// The manifold of two convex shapes, or of one and a plane, as it will be in the middle of the step.
pub(crate) fn manifold_at_half_step(input: &Input<'_>, pair: &Pair, margin: f32) -> RawManifold {
    let (a, b) = input.shapes(pair);
    let motion = motion_of(input, pair);
    let raw = collide_convex(a, b, &motion.relative(0.5), margin);
    carry_back(&raw, &motion, 0.5, f32::MIN)
}

/// The manifold of two bodies that both move far, at a later pose than that of the manifold `raw`, which was
/// found at `fraction`; with its own fraction of the step. `None` if they overlap there by no more than the
/// planes of `raw` foresee. A shape that slides along a plate for metres meets it where the plate has turned
/// to by then.
pub(crate) fn manifold_later_on_path(
    input: &Input<'_>,
    pair: &Pair,
    raw: &RawManifold,
    fraction: f32,
) -> Option<(RawManifold, f32)> {
    let (a, b) = input.shapes(pair);
    let motion = motion_of(input, pair);
    let turns = |shape: &Collider, spin: Vec3| {
        shape.kind != Kind::Sphere && (1.0 - fraction) * spin.length() > PLANE_TURN
    };
    if turns(a, motion.a.spin) || turns(b, motion.b.spin) {
        return None;
    }
    let (mut found, mut most) = (None, input.touch_distance);
    for later in [fraction + 0.5 * (1.0 - fraction), 1.0] {
        // Rows remove the overlap that their planes foresee.
        let seen =
            closings(&motion, raw, fraction).fold(0.0_f32, |s, (gap, closed)| s.min(gap - later * closed));
        let then = collide_convex(a, b, &motion.relative(later), input.margin);
        let deepest = then.points().iter().fold(0.0_f32, |s, p| s.min(p.separation));
        if seen - deepest > most {
            most = seen - deepest;
            found = Some((carry_back(&then, &motion, later, f32::MIN), later));
        }
    }
    found
}

/// For mode `Volume`: the manifold of two convex shapes that miss each other, where their centres pass. The
/// path runs along such a plane, not through it, so the plane pushes only a body that another impact throws
/// off its path.
pub(crate) fn manifold_at_closest_pass(input: &Input<'_>, pair: &Pair) -> Option<(RawManifold, f32)> {
    let (a, b) = input.shapes(pair);
    let motion = motion_of(input, pair);
    let (from, path) = (motion.start.as_vec3() + motion.a.lever - motion.b.lever, motion.displacement);
    let fraction = if b.kind == Kind::Plane { 0.0 } else { -from.dot(path) / path.length_squared() };
    // A path without length has no fraction: NaN compares as false.
    let fraction = if fraction > 0.0 { fraction.min(1.0) } else { 0.0 };
    let raw =
        collide_convex(a, b, &motion.relative(fraction), input.margin + (1.0 - fraction) * path.length());
    let raw = carry_back(&raw, &motion, fraction, 0.0);
    (raw.count > 0 && !pushes(input, &motion, &raw, fraction)).then_some((raw, fraction))
}

/// Where a shape in flight first touches a mesh or height field; [`CastResult::Near`] if it begins close to
/// it.
pub(crate) fn first_touch_in_flight(
    input: &Input<'_>,
    moving: &MeshPair<'_>,
    scratch: &mut MeshScratch,
) -> CastResult {
    let first = MeshCast::first(moving.tolerance(input.unit), input.touch_distance);
    moving.cast(MeshCast { alone: input.margin, ..first }, scratch)
}

/// First touch of a shape with a mesh or height field, other than the triangles it rests on: those within
/// `resting` [m] at the start are left to the kernel there, whose results `scratch` still holds.
pub(crate) fn first_touch_with_mesh(
    input: &Input<'_>,
    moving: &MeshPair<'_>,
    resting: f32,
    scratch: &mut MeshScratch,
) -> Option<Touch> {
    let motion = moving.motion;
    let path = motion.a.rotation.conjugate() * motion.displacement;
    let known = scratch.touched(moving.shape, resting, path, input.margin);
    let first = MeshCast::first(moving.tolerance(input.unit), resting);
    match moving.cast(MeshCast { known, lip: NO_GAP * input.touch_distance, ..first }, scratch) {
        CastResult::First(touch) => Some(touch),
        _ => None,
    }
}

/// Whether a convex shape touches a mesh or height field at all within the step.
pub(crate) fn touches_mesh(unit: f32, moving: &MeshPair<'_>, scratch: &mut MeshScratch) -> bool {
    let cast = MeshCast { any: true, ..MeshCast::first(moving.tolerance(unit), 0.0) };
    matches!(moving.cast(cast, scratch), CastResult::First(_))
}

/// Adds the manifolds of a convex shape at its first touch with a mesh or height field, and at the second, to
/// which it would slide along the surface that it touched first: a body that hits the ground close to a wall
/// meets both in one step.
pub(crate) fn add_manifolds_at_touch(
    input: &Input<'_>,
    pair: &Pair,
    (a, b): (&Collider, &Collider),
    motion: &Motion,
    touch: Touch,
    out: &mut MeshBlock,
) {
    let Touch { fraction, normal } = touch;
    out.raw.clear();
    let margin = margin_at_touch(input, pair, &touch);
    let rel = motion.relative(fraction);
    // The second cast below follows the rest of the path.
    out.mesh.nearby.expect(extent_of(a, &rel, input.margin, path_left(motion, fraction)));
    collide_mesh(a, b, &rel, Reach::new(margin).within(input.margin), &mut out.mesh, &mut out.raw);
    // Planes that the shape is not close to when it touches are guesses.
    out.raw.retain(|m| m.points().iter().any(|p| p.separation <= input.margin));
    (0..out.raw.len()).for_each(|i| out.add(carry_back(&out.raw[i], motion, fraction, 0.0), fraction));

    let then = motion.after(fraction, normal);
    let left = then.displacement.length() + (1.0 - fraction) * input.approach(pair).swing;
    if left <= 0.5 * a.inner_radius {
        return;
    }
    let moving = MeshPair { shape: a, mesh: b, rel: &rel, motion: &then };
    let second = if input.start.is_gated() {
        enter_mesh(input, &moving, input.touch_distance)
    } else {
        first_touch_with_mesh(input, &moving, input.touch_distance, &mut out.mesh)
    };
    let Some(Touch { fraction: further, .. }) = second else {
        return;
    };
    out.raw.clear();
    collide_mesh(a, b, &then.relative(further), Reach::new(input.margin), &mut out.mesh, &mut out.raw);
    let whole = fraction + further * (1.0 - fraction);
    for i in 0..out.raw.len() {
        let first = carry_back(&out.raw[i], &then, further, 0.0);
        // A shape that touches on the way there touches at the first place too.
        out.add(carry_back(&first, motion, fraction, 0.0), whole);
    }
}

/// A convex shape, and a mesh or height field that it moves against.
#[derive(Clone, Copy)]
pub(crate) struct MeshPair<'a> {
    pub(crate) shape: &'a Collider,
    pub(crate) mesh: &'a Collider,
    /// Pose of the mesh in the shape's frame at the start of the motion.
    pub(crate) rel: &'a Relative,
    pub(crate) motion: &'a Motion,
}

impl MeshPair<'_> {
    pub(crate) fn tolerance(&self, unit: f32) -> f32 {
        tolerance(self.shape, self.mesh, unit)
    }

    fn cast(&self, cast: MeshCast, scratch: &mut MeshScratch) -> CastResult {
        cast_mesh(self.shape, self.mesh, self.rel, self.motion, cast, scratch.nearby())
    }
}

/// How the shapes of a pair move within the step.
pub(crate) fn motion_of(input: &Input<'_>, pair: &Pair) -> Motion {
    let (a, b) = input.shapes(pair);
    Motion::new(a, &body_path(input, pair.a), b, &body_path(input, pair.b))
}

/// The rest of the path at a fraction of the step, in the frame that shape a has then [m].
fn path_left(motion: &Motion, fraction: f32) -> Vec3 {
    let turned = exp_map(motion.a.spin * fraction) * motion.a.rotation;
    turned.conjugate() * motion.displacement * (1.0 - fraction)
}

/// The margin at a first touch [m]: the rest of the motion may bring down a body that touched with a tip. It
/// did touch the plane, so points far from that are no guess. Motion along the plane brings nothing down.
pub(crate) fn margin_at_touch(input: &Input<'_>, pair: &Pair, touch: &Touch) -> f32 {
    let radius = |c: u32| input.colliders[c as usize].radius;
    let size = 2.0 * radius(pair.a).min(radius(pair.b));
    let approach = input.approach(pair);
    let closing = (-approach.displacement.dot(touch.normal)).max(0.0) + approach.swing;
    input.margin + ((1.0 - touch.fraction) * closing).min(size)
}

/// Whether the predicted motion takes any point of a manifold, found at the start of the step, through its
/// plane.
pub(crate) fn would_push(input: &Input<'_>, motion: &Motion, raw: &RawManifold) -> bool {
    pushes(input, motion, raw, 0.0)
}

fn pushes(input: &Input<'_>, motion: &Motion, raw: &RawManifold, fraction: f32) -> bool {
    let nearly = NEARLY * input.unit;
    // A little early: the solver's path is not quite the predicted one.
    closings(motion, raw, fraction).any(|(separation, closed)| separation < 1.05 * closed + nearly)
}

/// For each point its separation, and how much of that the motion takes away [m].
fn closings(motion: &Motion, raw: &RawManifold, fraction: f32) -> impl Iterator<Item = (f32, f32)> {
    let (normal, moved) = (motion.a.rotation * raw.normal, motion.displacement * fraction);
    raw.points().iter().map(move |point| {
        let arm = motion.a.lever + motion.a.rotation * point.position;
        (point.separation, closing(motion, normal, arm, moved))
    })
}

/// Drops the manifolds that a slow shape is near neither at the start nor after its predicted motion.
pub(crate) fn keep_reached(motion: &Motion, margin: f32, found: &mut Vec<RawManifold>) {
    found.retain(|m| closings(motion, m, 0.0).any(|(gap, closed)| gap - closed.max(0.0) <= margin));
}

/// Whether the predicted motion leads into anything by more than a margin.
pub(crate) fn strikes(motion: &Motion, margin: f32, found: &[RawManifold]) -> bool {
    found.iter().any(|m| closings(motion, m, 0.0).any(|(gap, closed)| closed - gap > margin))
}

// Rounding: of a predicted path.
/// Rounding of a predicted path [length units].
const NEARLY: f32 = 1e-5;

/// How much of the gap along `normal` the whole motion takes away at a point that is `arm` from a's centre,
/// with the centres moved apart by `moved` since the start [m].
pub(crate) fn closing(motion: &Motion, normal: Vec3, arm: Vec3, moved: Vec3) -> f32 {
    let arm_b = arm + motion.start.as_vec3() + moved;
    normal.dot(motion.displacement + motion.a.spin.cross(arm) - motion.b.spin.cross(arm_b))
}

/// The manifold that leads out of a still shape on the side where the moving one's centre is, if the overlap
/// is so deep that `raw` leads out through the still shape: because the longer part of the moving one is on
/// the wrong side.
pub(crate) fn right_way_out(
    input: &Input<'_>,
    pair: &Pair,
    rel: &Relative,
    raw: &RawManifold,
) -> Option<RawManifold> {
    let (a, b) = input.shapes(pair);
    let moves = input.is_pushed(pair.a);
    if moves == input.is_pushed(pair.b) {
        return None;
    }
    if moves {
        return out_by_the_centre(a, b, rel, raw, input.margin);
    }
    // As seen from the one that moves.
    let from_b = rel.inverse();
    let raw = RawManifold { normal: -(from_b.rotation * raw.normal), ..*raw };
    Some(out_by_the_centre(b, a, &from_b, &raw, input.margin)?.flipped(&from_b))
}

/// [`right_way_out`] of a moving and a still shape, in the frame of the first; only the depth and the normal
/// of `raw` count.
pub(crate) fn out_by_the_centre(
    mover: &Collider,
    still: &Collider,
    rel: &Relative,
    raw: &RawManifold,
    margin: f32,
) -> Option<RawManifold> {
    let deepest = raw.points().iter().fold(0.0_f32, |s, p| s.min(p.separation));
    if deepest > -0.5 * mover.inner_radius {
        return None;
    }
    let (own, other) = (mover.geometry.support()?, still.geometry.support()?);
    let centre = -(mover.rotation.conjugate() * mover.position);
    let point = Support::triangle([centre; 3]);
    // The body's centre may be outside of this shape of it, and says nothing then.
    if distance(&own, &point, &Relative::IDENTITY, Vec3::ZERO).distance > 0.0 {
        return None;
    }
    let out = distance(&point, &other, rel, Vec3::ZERO);
    // The normal leads into the other shape, as that of `out` does.
    if out.overlap || out.distance <= 0.0 || raw.normal.dot(out.normal) >= 0.0 {
        return None;
    }
    // Against the half-space behind the nearest point of the other.
    let plane = Collider { kind: Kind::Plane, geometry: Geometry::Plane, ..still.clone() };
    let half = Relative { position: out.point_b, rotation: Quat::from_rotation_arc(Vec3::Y, -out.normal) };
    Some(collide_convex(mover, &plane, &half, margin))
}

/// How the body of a collider moves within the step.
fn body_path(input: &Input<'_>, collider: u32) -> BodyPath {
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

/// Carries a manifold that was found at a fraction of the step back to the start, into the frame that shape a
/// has there. Its arms stay those of the touch. Its separations are increased by the approach of the
/// predicted motion until then, `least` or more.
pub(crate) fn carry_back(raw: &RawManifold, motion: &Motion, fraction: f32, least: f32) -> RawManifold {
    let turned = exp_map(motion.a.spin * fraction);
    let at_touch = turned * motion.a.rotation;
    let lever = turned * motion.a.lever;
    let back: Quat = motion.a.rotation.conjugate();
    let normal = at_touch * raw.normal;
    let moved = motion.displacement * fraction;
    let mut carried = *raw;
    carried.normal = back * normal;
    for point in &mut carried.points[..raw.count as usize] {
        let arm_a = lever + at_touch * point.position;
        // With 0 as the least, a point that moves away until the touch does not count as overlap at the
        // start.
        point.separation += (fraction * closing(motion, normal, arm_a, moved)).max(least);
        point.position = back * (arm_a - motion.a.lever);
    }
    carried
}
