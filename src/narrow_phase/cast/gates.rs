//! Which planes may stop a fast pair that is apart, decided without a search for its first touch: the gates
//! of Vincent Robert's talk (GDC 2012), for [`ContinuousMethod::Talk`](crate::ContinuousMethod::Talk).
//!
//! The manifold of the start of the step stops everything that crosses its plane, also beside the face that
//! the plane belongs to. Two gates prevent that. Both use the relative motion of the start: straight, with
//! the rotations of the start.
//!
//! 1. *Which axis.* Along each candidate axis the intervals of the two shapes meet at one fraction of the
//!    step and part at another. The axis that is entered last is the axis of impact. If one is left before
//!    another is entered, the shapes miss each other, and there is no manifold (separating axes for moving
//!    shapes: Ericson, *Real-Time Collision Detection*, 5.5.8).
//! 2. *Where it is crossed.* A point has to lie over the face it was found on when its path crosses the
//!    plane. If the shapes slide along the plane by more than the margin until then, the same kernel finds
//!    the footprint at the pose where they cross it, and its separations are carried back to the start by
//!    adding the approach by the motion until then.
//!
//! All of it is in closed form. Rotation enters only by the points' velocities at the start, as straight
//! motion.

use super::ahead::{MeshPair, carry_back, closing, margin_at_touch, motion_of};
use super::mesh_cast::MeshCast;
use super::motion::{Motion, Turn};
use super::path::ShapePath;
use super::{Touch, tolerance};
use crate::broad_phase::Pair;
use crate::config::tuning::SAME_AXIS_COSINE;
use crate::lanes::{Lanes, Mask, Vec3 as LaneVec3, kernel, ones, with_best};
use crate::narrow_phase::convex::collide_convex;
use crate::narrow_phase::convex::gjk::distance;
use crate::narrow_phase::convex::polytope::Pose;
use crate::narrow_phase::input::Input;
use crate::narrow_phase::mesh::nearby::Eight;
use crate::narrow_phase::mesh::reach::side_of;
use crate::narrow_phase::mesh::triangles::Triangles;
use crate::narrow_phase::{RawManifold, Relative};
use crate::shape::support::{Pose as Placed, Support};
use crate::shape::{Collider, Geometry, Kind, Symmetry};
use glam::{DVec3, Vec3};

// Rounding: of a speed along an axis.
/// Speed along a unit axis, as a share of the path's length, that counts as zero.
const STILL: f32 = 1e-6;
// Rounding: of a cross product.
/// Squared sine under which a cross product has no direction.
const PARALLEL: f64 = 1e-7;

/// The same motion without rotation.
pub(crate) fn straight(motion: &Motion) -> Motion {
    let still = |turn: &Turn| Turn { spin: Vec3::ZERO, ..*turn };
    Motion { a: still(&motion.a), b: still(&motion.b), ..*motion }
}

/// Filters the manifold `raw` of two convex shapes, or of one and a plane, that are apart at the start.
/// Returns the rest of it with the fraction of the step at which its footprint was taken; `None` if the two
/// miss each other.
pub(crate) fn gate(input: &Input<'_>, pair: &Pair, raw: &RawManifold) -> Option<(RawManifold, f32)> {
    let (a, b) = input.shapes(pair);
    let approach = input.approach(pair);
    let turning = motion_of(input, pair);
    let motion = straight(&turning);
    let path = motion.a.rotation.conjugate() * motion.displacement;
    if b.kind == Kind::Plane {
        return Some((*raw, 0.0));
    }
    let slack = input.margin + approach.swing;
    let Entry { fraction, axis, surely } = enter(a, b, &motion.relative(0.0), path, slack, raw.normal)?;
    let (until, aside) = (fraction.min(1.0), path - axis * axis.dot(path));
    let same = axis.dot(raw.normal) > SAME_AXIS_COSINE && aside.length() * until <= input.margin;
    // If only rotation brings them together, the motion gives no other moment.
    if same || fraction > 1.0 {
        let mut kept = *raw;
        if !surely && approach.swing > input.margin {
            keep_over(&mut kept, a, b, &turning, input.margin);
        }
        return (kept.count > 0).then_some((kept, 0.0));
    }
    let touch = Touch { fraction, normal: motion.a.rotation * axis };
    let found = collide_convex(a, b, &motion.relative(fraction), margin_at_touch(input, pair, &touch));
    (found.count > 0).then(|| (carry_back(&found, &motion, fraction, 0.0), fraction))
}

/// Drops the points of a manifold that cross its plane over neither shape. Their paths are straight, with the
/// velocities that rotation gives them at the start.
fn keep_over(raw: &mut RawManifold, a: &Collider, b: &Collider, motion: &Motion, margin: f32) {
    let (Some(shape_a), Some(shape_b)) = (a.geometry.support(), b.geometry.support()) else { return };
    let to_a = motion.a.rotation.conjugate();
    let on_b = motion.relative(0.0).inverse();
    let (own_normal, normal) = (raw.normal, motion.a.rotation * raw.normal);
    raw.retain(|point| {
        let arm = motion.a.lever + motion.a.rotation * point.position;
        let closed = closing(motion, normal, arm, Vec3::ZERO);
        closed <= point.separation || {
            let arm_b = arm + motion.start.as_vec3();
            let moved = motion.displacement + motion.a.spin.cross(arm) - motion.b.spin.cross(arm_b);
            let aside = to_a * (moved - normal * closed) * (point.separation / closed);
            let half = own_normal * (0.5 * point.separation);
            let onto = Support::triangle([point.position + half + aside; 3]);
            let back = Support::triangle([point.position - half - aside; 3]);
            distance(&shape_b, &onto, &on_b, Vec3::ZERO).distance <= margin
                || distance(&shape_a, &back, &Relative::IDENTITY, Vec3::ZERO).distance <= margin
        }
    });
}

/// Intermediate result of sweeping two convex shapes against each other: when the last of the tried axes was
/// entered, and when the first was left.
struct Swept<'a> {
    own: Support<'a>,
    other: Support<'a>,
    /// Pose of `other` in the frame of `own`, at the start.
    placed: Placed,
    /// Displacement of `own` in its frame [m].
    path: DVec3,
    /// Distance up to which passing by does not count as a miss [m].
    slack: f64,
    entered: f64,
    /// The axis entered last: unit, from `own` to `other`.
    axis: DVec3,
    left: f64,
    /// The same two fractions with the slack: last entered, first left.
    near: f64,
    passed: f64,
}

/// How two shapes enter each other.
struct Entry {
    /// Fraction of the step: at least 0, beyond 1 by no more than the slack closes.
    fraction: f32,
    /// The axis entered last: unit, from a to b, in the frame of a.
    axis: Vec3,
    /// They also meet without the slack, along all axes that were tried.
    surely: bool,
}

/// At which fraction of the step two convex shapes have entered each other along all axes. `None` if they
/// miss each other.
///
/// `path`: displacement of a relative to b, in a's frame [m]. `now`: the normal of the start. `slack`: see
/// [`Swept`].
fn enter(a: &Collider, b: &Collider, rel: &Relative, path: Vec3, slack: f32, now: Vec3) -> Option<Entry> {
    let placed = rel.exact();
    let mut swept = Swept {
        own: a.geometry.support()?,
        other: b.geometry.support()?,
        placed,
        path: path.as_dvec3(),
        slack: f64::from(slack),
        entered: f64::MIN,
        axis: now.as_dvec3(),
        left: f64::MAX,
        near: f64::MIN,
        passed: f64::MAX,
    };
    let (Placed { rotation, position }, path) = (placed, swept.path);
    // Balls pass each other along the line on which their centres come nearest.
    let across = position * path.length_squared() - path * position.dot(path);
    let mut meets = swept.meets_along(now.as_dvec3()) && swept.meets_along(across);
    meets = meets && faces(a).all(|face| swept.meets_along(face));
    meets = meets && faces(b).all(|face| swept.meets_along(rotation * face));
    for edge in edges(a) {
        let crosses = edges(b).iter().map(|other| edge.cross(rotation * *other));
        meets = meets
            && crosses.filter(|cross| cross.length_squared() > PARALLEL).all(|axis| swept.meets_along(axis));
    }
    // A shape that is round about an edge has normals in all directions across it.
    let round = |shape: &Collider| shape.kind.symmetry() == Symmetry::Axis;
    meets = meets && (!round(a) || swept.meets_along(DVec3::Y.cross(path)));
    meets = meets && (!round(b) || swept.meets_along((rotation * DVec3::Y).cross(path)));
    // Boxes have no other axes. Other shapes have the direction between their nearest points at the time of
    // entry.
    if meets && (a.kind, b.kind) != (Kind::Box, Kind::Box) {
        let there =
            Relative { position: (position - path * swept.entered.clamp(0.0, 1.0)).as_vec3(), ..*rel };
        let nearest = distance(&swept.own, &swept.other, &there, swept.axis.as_vec3());
        meets = nearest.overlap || nearest.distance <= 0.0 || swept.meets_along(nearest.normal.as_dvec3());
    }
    meets.then(|| Entry {
        fraction: swept.entered.max(0.0) as f32,
        axis: swept.axis.as_vec3(),
        surely: swept.entered <= swept.left.min(1.0),
    })
}

impl Swept<'_> {
    /// Adds an axis of any length; a zero axis is ignored. Returns whether the two may still meet.
    fn meets_along(&mut self, axis: DVec3) -> bool {
        let length = axis.length();
        if length > 0.0 {
            self.along(axis / length);
        }
        self.near <= self.passed.min(1.0) && self.passed >= 0.0
    }

    fn along(&mut self, axis: DVec3) {
        let seen = self.placed.rotation.transpose() * axis;
        let high = |shape: &Support, axis: DVec3| shape.support(axis).dot(axis) + shape.radius;
        let middle = self.placed.position.dot(axis);
        // Gap with `other` above `own`, and with `own` above `other`.
        let above = middle - high(&self.other, -seen) - high(&self.own, axis);
        let below = -middle - high(&self.other, seen) - high(&self.own, -axis);
        let along = self.path.dot(axis);
        let speed = along.abs();
        if speed <= f64::from(STILL) * self.path.length() {
            if above.max(below) > self.slack {
                self.near = f64::MAX;
            } else if above.max(below) > 0.0 {
                self.left = f64::MIN;
            }
            return;
        }
        let (gap, other, normal) = if along > 0.0 { (above, below, axis) } else { (below, above, -axis) };
        if gap / speed > self.entered {
            (self.entered, self.axis) = (gap / speed, normal);
        }
        self.near = self.near.max((gap - self.slack) / speed);
        self.left = self.left.min(-other / speed);
        self.passed = self.passed.min((self.slack - other) / speed);
    }
}

const AXES: [DVec3; 3] = [DVec3::X, DVec3::Y, DVec3::Z];

/// Normals of the faces of a shape; one of each opposite pair.
fn faces(shape: &Collider) -> impl Iterator<Item = DVec3> + '_ {
    let own = &AXES[shape.kind.face_axes()];
    let planes = match &shape.geometry {
        Geometry::Hull(hull) => &hull.planes[..],
        _ => &[],
    };
    own.iter().copied().chain(planes.iter().map(|(normal, _)| normal.as_dvec3()))
}

/// Directions of the edges of a shape. Those of a hull are too many; the normals of nearest points stand in
/// for them.
fn edges(shape: &Collider) -> &'static [DVec3] {
    &AXES[shape.kind.edge_axes()]
}

/// The triangle of a mesh or height field that a convex shape enters first. Triangles within `resting` [m] at
/// the start, or whose planes are and stay so, are left to the manifolds of the start.
pub(crate) fn enter_mesh(input: &Input<'_>, moving: &MeshPair<'_>, resting: f32) -> Option<Touch> {
    let &MeshPair { shape: a, mesh: b, rel, motion } = moving;
    let (ground, shape) = (b.geometry.ground()?, a.geometry.support()?);
    let motion = straight(motion);
    let path = motion.a.rotation.conjugate() * motion.displacement;
    if path == Vec3::ZERO {
        return None;
    }
    let cast = MeshCast::first(tolerance(a, b, input.unit), resting);
    let swept = ShapePath::new(a, rel, &motion, &cast).in_box();
    let mut first = Search {
        shape: a,
        support: shape,
        pose: Pose::new(rel.position, rel.rotation),
        side: side_of(a),
        path,
        resting,
        fraction: 1.0,
        normal: None,
    };
    let mut seen = Eight::default();
    let mut visit = |index: u32, corners: [Vec3; 3], _: f32| {
        seen.push(index, corners);
        if seen.is_full() {
            first.look(&seen);
            seen.clear();
        }
        first.fraction
    };
    ground.visit_segment(swept.from, swept.to, swept.inflate, &mut visit);
    first.look(&seen);
    let normal = motion.a.rotation * first.normal?.normalize();
    Some(Touch { fraction: first.fraction, normal })
}

/// The search for the triangle that is entered first.
struct Search<'a> {
    shape: &'a Collider,
    support: Support<'a>,
    /// Pose of the mesh in the shape's frame.
    pose: Pose,
    side: Vec3,
    path: Vec3,
    resting: f32,
    fraction: f32,
    normal: Option<Vec3>,
}

/// [`Swept`] for eight triangles, with the widest gap at the start [m].
struct SweptEight<L> {
    entered: L,
    axis: LaneVec3<L>,
    left: L,
    apart: L,
}

impl<L: Lanes> SweptEight<L> {
    /// Whether a triangle is entered before it is left, and before the limit.
    #[inline(always)]
    fn meets(&self, limit: L) -> L::Mask {
        self.entered.le(self.left) & self.left.ge(L::zero()) & self.entered.lt(limit)
    }
}

kernel! {
    /// See [`Search::look`].
    fn look<'a, 'b, L: Lanes>(search: &'a mut Search<'b>, eight: &'a Eight) {
        search.look_in::<L>(eight);
    }
}

impl Search<'_> {
    /// Examines up to eight triangles.
    fn look(&mut self, eight: &Eight) {
        if eight.lanes() != 0 {
            with_best!(Wide => look::<Wide>(self, eight));
        }
    }

    #[inline(always)]
    fn look_in<L: Lanes>(&mut self, eight: &Eight) {
        let triangles = Triangles::<L>::new(eight, eight.lanes(), &self.pose, self.side);
        let mut swept = SweptEight {
            entered: L::splat(f32::MIN),
            axis: triangles.front,
            left: L::splat(f32::MAX),
            apart: L::splat(f32::MIN),
        };
        let down = -triangles.front;
        self.along(&triangles, down, &mut swept);
        // Triangles that it slides along or rests on.
        let gap = triangles.height - self.shape.geometry.lane_reach(down);
        let end = gap - LaneVec3::splat(self.path).dot(down);
        let resting = L::splat(self.resting);
        let level = gap.abs().le(resting) & end.ge(-resting);
        let limit = L::splat(self.fraction);
        // For most triangles the plane alone decides.
        if (swept.meets(limit) & !level).bits() & triangles.valid == 0 {
            return;
        }
        let [p, q, r] = triangles.corners;
        let own = [LaneVec3::<L>::splat(Vec3::X), LaneVec3::splat(Vec3::Y), LaneVec3::splat(Vec3::Z)];
        for axis in own {
            self.along(&triangles, axis, &mut swept);
        }
        let crossed = &own[self.shape.kind.edge_axes()];
        let path = LaneVec3::splat(self.path);
        for edge in [q - p, r - q, p - r] {
            for axis in crossed.iter().chain([&path]) {
                self.along(&triangles, unit(edge.cross(*axis)), &mut swept);
            }
        }
        let hit = (swept.meets(limit) & !level & swept.apart.gt(resting)).bits() & triangles.valid;
        let SweptEight { entered, axis, .. } = swept;
        for lane in ones(hit) {
            let corners = triangles.corners.map(|corner| corner.lane(lane));
            self.take(corners, entered.lane(lane).max(0.0), axis.lane(lane));
        }
    }

    /// Adds one axis for eight triangles: unit length, or zero, which is ignored.
    #[inline(always)]
    fn along<L: Lanes>(&self, triangles: &Triangles<L>, axis: LaneVec3<L>, swept: &mut SweptEight<L>) {
        let [p, q, r] = triangles.corners;
        let (p, q, r) = (p.dot(axis), q.dot(axis), r.dot(axis));
        let above = Lanes::min(p, Lanes::min(q, r)) - self.shape.geometry.lane_reach(axis);
        let below = -Lanes::max(p, Lanes::max(q, r)) - self.shape.geometry.lane_reach(-axis);
        let along = LaneVec3::splat(self.path).dot(axis);
        let (zero, most) = (L::zero(), L::splat(f32::MAX));
        let still = along.abs().le(L::splat(STILL * self.path.length()));
        let speed = Lanes::select(still, L::one(), along.abs());
        let on = along.gt(zero);
        let gap = Lanes::select(on, above, below);
        let other = Lanes::select(on, below, above);
        let apart = Lanes::max(above, below);
        let never = still & apart.gt(zero);
        let entered = Lanes::select(never, most, Lanes::select(still, -most, gap / speed));
        let later = entered.gt(swept.entered);
        swept.axis = LaneVec3::select(later, LaneVec3::select(on, axis, -axis), swept.axis);
        swept.entered = Lanes::select(later, entered, swept.entered);
        swept.left = Lanes::min(swept.left, Lanes::select(still, most, -other / speed));
        swept.apart = Lanes::max(swept.apart, apart);
    }

    /// Adds a triangle that is entered along all axes tried so far; shapes other than boxes may have more
    /// axes.
    fn take(&mut self, corners: [Vec3; 3], entered: f32, axis: Vec3) {
        let (mut entered, mut axis) = (entered, axis);
        if self.shape.kind != Kind::Box {
            let there = Support::triangle(corners.map(|corner| corner - self.path * entered));
            let nearest = distance(&self.support, &there, &Relative::IDENTITY, axis);
            if !nearest.overlap && nearest.distance > 0.0 {
                let speed = nearest.normal.dot(self.path);
                // The distance along a straight path is convex: from here on it only grows.
                if speed <= 0.0 && nearest.distance > self.resting {
                    return;
                }
                if speed > 0.0 {
                    (entered, axis) = (entered + nearest.distance / speed, nearest.normal);
                }
            }
        }
        if entered < self.fraction {
            (self.fraction, self.normal) = (entered, Some(axis));
        }
    }
}

/// The vector at unit length; zero if it is too short to have a direction.
#[inline(always)]
fn unit<L: Lanes>(v: LaneVec3<L>) -> LaneVec3<L> {
    let squared = v.length_squared();
    let some = squared.gt(L::splat(1e-20));
    v * Lanes::select(some, L::one() / Lanes::select(some, squared, L::one()).sqrt(), L::zero())
}
