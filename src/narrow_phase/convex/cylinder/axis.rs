//! The direction along which a cylinder and another convex shape are furthest apart or, if they overlap,
//! least deep in each other.
//!
//! Apart, it is that between the nearest points, which GJK finds on the exact shapes. An overlap is taken
//! back first: `b` is moved along the best direction known until the two are a little apart. The nearest
//! points then show a direction that beats the known one, if there is one, and the next round begins with it.
//! Let the known depth be d, the gap that was opened e, and θ the angle between the known direction and a
//! better one of depth d': the move opens (d + e) cos θ - d' along that, which is more than e unless d' > d
//! cos θ - e (1 - cos θ). So each round is less deep, and a round that finds nothing ends within a factor of
//! cos θ of any shallower one at the angle θ: nothing near, and distant ones are among the candidates that
//! the search starts from.

use super::frustum::{Disc, Frustum};
use super::sample::best_of_many;
use crate::config::tuning::{CYLINDER_DEEP, CYLINDER_GAP, CYLINDER_TOO_DEEP, THROUGH_SINE};
use crate::lanes::{Lanes, Vec3 as LaneVec3, f32x8};
use crate::narrow_phase::convex::gjk::{CoreGap, gap_from};
use crate::narrow_phase::convex::polytope::{Polytope, Pose, Solid};
use crate::narrow_phase::convex::sat::offer;
use crate::shape::support::{Pose as ExactPose, Support};
use glam::{DMat3, Vec3};

/// Rounds of taking back an overlap.
const ROUNDS: usize = 6;

/// A cylinder, or a shape with flat faces.
#[derive(Clone, Copy, Debug)]
pub(super) enum Body<'a> {
    Round(Frustum),
    Flat(Polytope<'a>),
}

impl<'a> Body<'a> {
    pub(super) fn of(round: Option<Frustum>, solid: &'a Option<Solid>) -> Option<Body<'a>> {
        match (round, solid) {
            (Some(f), _) => Some(Body::Round(f)),
            (None, Some(solid)) => Some(Body::Flat(solid.view())),
            _ => None,
        }
    }

    /// The furthest along `d` [m], for `d` of unit length.
    fn extent(&self, d: Vec3) -> f32 {
        match self {
            Body::Round(f) => f.extent(LaneVec3::splat(d)),
            Body::Flat(p) => extent(p, d),
        }
    }
    fn centre(&self) -> Vec3 {
        match self {
            Body::Round(_) => Vec3::ZERO,
            Body::Flat(p) => (p.min + p.max) * 0.5,
        }
    }
}

/// The furthest of a polytope along `d`, eight vertices at a time.
fn extent(p: &Polytope, d: Vec3) -> f32 {
    let d = LaneVec3::<f32x8>::splat(d);
    let mut most = f32x8::splat(f32::MIN);
    for [x, y, z] in p.vertex_chunks {
        let along = LaneVec3::new(f32x8::new(*x), f32x8::new(*y), f32x8::new(*z)).dot(d);
        most = Lanes::max(along, most);
    }
    most.to_array().into_iter().fold(f32::MIN, f32::max)
}

/// A flat face.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum FlatFace {
    Cap { up: bool },
    Polygon(usize),
}

/// A direction from a to b, in a's frame.
#[derive(Clone, Copy, Debug)]
pub(super) struct Axis {
    pub(super) normal: Vec3,
    /// Separation of the shapes along it, negative in overlap [m].
    pub(super) separation: f32,
    /// The face that it is the normal of, and whether it is b's.
    pub(super) face: Option<(FlatFace, bool)>,
}

const NO_AXIS: Axis = Axis { normal: Vec3::Y, separation: f32::MIN, face: None };

/// Directions that are tried at once.
pub(super) struct Candidates {
    /// The best flat face.
    pub(super) flat: Axis,
    pub(super) best: Axis,
}

impl Candidates {
    /// `None`: it separates by more than the margin.
    fn add(&mut self, both: &Both, axis: Axis, margin: f32) -> Option<()> {
        if !both.allowed(&axis) {
            return Some(());
        }
        if axis.face.is_some() && axis.separation > self.flat.separation {
            self.flat = axis;
        }
        if axis.separation > self.best.separation {
            self.best = axis;
        }
        (axis.separation <= margin).then_some(())
    }
}

/// Two shapes of which at least one is round, `b` at `pose` in the frame of `a`.
pub(super) struct Both<'a> {
    pub(super) bodies: [Body<'a>; 2],
    pub(super) pose: Pose,
    pub(super) back: Pose,
    /// Directions along it are no way out of an overlap; in a's frame, zero if all are.
    pub(super) against: Vec3,
}

impl Both<'_> {
    /// Distance of the two along `n` (unit, a's frame).
    pub(super) fn separation(&self, n: Vec3) -> f32 {
        let [a, b] = &self.bodies;
        n.dot(self.pose.position) - b.extent(self.pose.back(-n)) - a.extent(n)
    }

    pub(super) fn pose_of(&self, on_b: bool) -> &Pose {
        if on_b { &self.pose } else { &Pose::IDENTITY }
    }

    fn allowed(&self, axis: &Axis) -> bool {
        axis.separation >= 0.0 || axis.normal.dot(self.against) <= THROUGH_SINE
    }

    /// The axes that are tried at once: the best face or cap of either, for each side the way to the middle
    /// of the other shape, and perpendiculars of two axes. `None`: one separates by more than the margin.
    pub(super) fn candidates(&self, margin: f32) -> Option<Candidates> {
        let mut found = Candidates { flat: NO_AXIS, best: NO_AXIS };
        for on_b in [false, true] {
            let sign = if on_b { -1.0 } else { 1.0 };
            let pose = self.pose_of(on_b);
            // The middle of the other in the frame of this one.
            let other = &self.bodies[usize::from(!on_b)];
            let middle = if on_b { self.back.point(other.centre()) } else { self.pose.point(other.centre()) };
            let along = |local: Vec3, face: Option<FlatFace>| {
                let normal = pose.direction(local) * sign;
                Axis { normal, separation: self.separation(normal), face: face.map(|face| (face, on_b)) }
            };
            match &self.bodies[usize::from(on_b)] {
                Body::Round(f) => {
                    for up in [middle.y > 0.0, middle.y <= 0.0] {
                        let radius = if up { f.top } else { f.bottom };
                        let local = if up { Vec3::Y } else { Vec3::NEG_Y };
                        let face = (radius > 0.0).then_some(FlatFace::Cap { up });
                        found.add(self, along(local, face), margin)?;
                    }
                    found.add(self, along(f.side_normal(middle), None), margin)?;
                }
                Body::Flat(p) => {
                    let Body::Round(f) = other else { continue };
                    let (separation, face) =
                        face_axis(p, f, if on_b { &self.back } else { &self.pose }, margin);
                    let normal = pose.direction(p.planes[face].0) * sign;
                    let axis = Axis { normal, separation, face: Some((FlatFace::Polygon(face), on_b)) };
                    found.add(self, axis, margin)?;
                }
            }
        }
        if let [Body::Round(_), Body::Round(_)] = self.bodies {
            let cross = Vec3::Y.cross(self.pose.axes.y_axis);
            if cross.length_squared() > 1e-4 {
                let normal = cross.normalize() * cross.dot(self.pose.position).signum();
                let axis = Axis { normal, separation: self.separation(normal), face: None };
                found.add(self, axis, margin)?;
            }
        }
        Some(found)
    }

    /// The best way of all, from the best that is known, and points of both shapes that are that far apart
    /// along it.
    ///
    /// `size`: a length of the smaller shape [m].
    pub(super) fn best(&self, supports: (&Support, &Support), from: Axis, size: f32) -> (Axis, [Vec3; 2]) {
        // Seen from the wrong side, separate shapes may seem deep.
        if from.separation < -CYLINDER_DEEP * size {
            let gap = self.gap(supports, from.normal, 0.0, 1e-6 * size);
            if !gap.overlap && gap.upper > 0.0 {
                let normal = gap.normal.as_vec3();
                let axis = Axis { normal, separation: self.separation(normal), face: None };
                return (axis, [gap.point_a.as_vec3(), gap.point_b.as_vec3()]);
            }
        }
        let first = self.refine(supports, from, size, f32::MIN);
        // Deeper still, any way out will do.
        if !(-CYLINDER_TOO_DEEP * size..-CYLINDER_DEEP * size).contains(&first.0.separation) {
            return first;
        }
        let (normal, separation) = best_of_many(self, first.0.normal);
        let second = Axis { normal, separation, face: None };
        let second = self.refine(supports, second, size, 1.3 * first.0.separation);
        if second.0.separation > first.0.separation { second } else { first }
    }

    /// The gap of the two with `b` moved by so much along a unit vector, from which the search begins.
    fn gap(&self, supports: (&Support, &Support), along: Vec3, by: f32, accuracy: f32) -> CoreGap {
        let axes = [self.pose.axes.x_axis, self.pose.axes.y_axis, self.pose.axes.z_axis];
        let [x, y, z] = axes.map(Vec3::as_dvec3);
        let position = (self.pose.position + along * by).as_dvec3();
        let pose = ExactPose { rotation: DMat3::from_cols(x, y, z), position };
        gap_from(supports.0, supports.1, &pose, along.as_dvec3().normalize(), f64::from(accuracy))
    }

    /// `hopeless`: once one round has not led beyond this separation it ends [m].
    fn refine(
        &self,
        supports: (&Support, &Support),
        from: Axis,
        size: f32,
        hopeless: f32,
    ) -> (Axis, [Vec3; 2]) {
        let mut best = from;
        // The last that is allowed: the way to where two shapes are apart may lead through some that are not.
        let mut kept = (best, [Vec3::ZERO; 2]);
        for _ in 0..ROUNDS {
            // Nearest points that coincide have no direction.
            let open = if best.separation > CYLINDER_GAP * size {
                0.0
            } else {
                CYLINDER_GAP * size - best.separation
            };
            let shift = best.normal * open;
            let accuracy = if open == 0.0 { 1e-6 * size } else { 1e-5 * size + 4e-3 * open };
            let gap = self.gap(supports, best.normal, open, accuracy);
            if gap.overlap {
                break;
            }
            let normal = gap.normal.as_vec3();
            let found = Axis { normal, separation: self.separation(normal), face: None };
            let gain = found.separation - best.separation;
            let points = [gap.point_a.as_vec3(), gap.point_b.as_vec3() - shift];
            if gain > 0.0 {
                best = found;
            }
            if self.allowed(&best) {
                kept = (best, points);
            }
            if gain <= 0.0 {
                break;
            }
            // The gain of the next round is to this gain about as the depth is to the size.
            let depth = -best.separation;
            let settled = depth > CYLINDER_GAP * size && gain * depth <= 1e-5 * size * size;
            if open == 0.0 || gain <= 1e-5 * size || settled || best.separation < hopeless {
                break;
            }
        }
        kept
    }
}

/// The face of `p` beyond which all of `f` is furthest, in the frame of `p`. Ends at the first that separates
/// by more than the margin.
fn face_axis(p: &Polytope, f: &Frustum, f_in_p: &Pose, margin: f32) -> (f32, usize) {
    let axes = &f_in_p.axes;
    let [ax, ay, az] = [axes.x_axis, axes.y_axis, axes.z_axis].map(LaneVec3::<f32x8>::splat);
    let centre = LaneVec3::splat(f_in_p.position);
    let mut best = (f32::MIN, 0);
    for (k, [nx, ny, nz, offset]) in p.normal_chunks.iter().enumerate() {
        let n = LaneVec3::new(f32x8::new(*nx), f32x8::new(*ny), f32x8::new(*nz));
        let reach = f.extent(-LaneVec3::new(ax.dot(n), ay.dot(n), az.dot(n)));
        if offer(&mut best, n.dot(centre) - f32x8::new(*offset) - reach, 8 * k) && best.0 > margin {
            break;
        }
    }
    best
}

impl Disc {
    /// Its plane: normal and offset.
    pub(super) fn plane(&self) -> (Vec3, f32) {
        (self.axis, self.axis.dot(self.centre))
    }
}
