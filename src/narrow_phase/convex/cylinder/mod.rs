//! Cylinders, frusta and cones against half-spaces, polytopes, capsules and each other, by their exact caps,
//! rims and sides.
//!
//! First the direction of contact ([`axis`]), judged by the exact extents of both shapes. Where it is the
//! normal of a flat face the points are the corners of the common area of that face and the one that lies on
//! it ([`disc`]); elsewhere two lines meet, or the nearest points are all there is.

mod axis;
mod core;
mod disc;
mod frustum;
mod sample;
#[cfg(test)]
mod tests;

use super::clip::{Cloud, EDGES, Loop, Segment, clip_edges, clip_face, key};
use super::manifold_of;
use super::polytope::{Pose, Solid, Triangle};
use crate::config::tuning::{CYLINDER_AXIS_TOLERANCE, LINE_TOUCH_ASIDE};
use crate::narrow_phase::contacts::manifold::{RawManifold, RawPoint};
use crate::shape::Collider;
use crate::shape::support::Support;
use axis::{Axis, Body, Both, FlatFace};
use disc::Face;
use glam::Vec3;

pub(crate) use core::round_cylinder;
pub(crate) use frustum::Frustum;

/// A cylinder or a polytope and another shape of which at least one is a cylinder; see `collide_convex`.
pub(crate) fn cylinder(a: &Collider, b: &Collider, pose: &Pose, margin: f32) -> RawManifold {
    let size = a.radius.min(b.radius);
    contact(a, (Frustum::of(b), Solid::of(b)), || b.geometry.support(), Vec3::ZERO, pose, margin, size)
}

/// All points nearer than the margin of a cylinder and a triangle in the cylinder's frame. The side of the
/// triangle on which the frame's origin is counts as its outside: the normal, from the cylinder to the
/// triangle, never pushes the cylinder through.
pub(crate) fn cylinder_triangle(a: &Collider, triangle: [Vec3; 3], margin: f32) -> RawManifold {
    let Some(triangle) = Triangle::facing(triangle, Vec3::ZERO) else { return RawManifold::default() };
    let (front, corners) = (triangle.normal(), triangle.corners());
    let support = || Some(Support::triangle(corners));
    contact(a, (None, Some(Solid::Triangle(triangle))), support, front, &Pose::IDENTITY, margin, a.radius)
}

/// `against`: normals along it don't count as ways out of an overlap; zero if all do. `size`: a length of the
/// smaller of the two [m].
#[inline(always)]
fn contact<'b>(
    a: &Collider,
    (other, solid_b): (Option<Frustum>, Option<Solid>),
    support_b: impl Fn() -> Option<Support<'b>>,
    against: Vec3,
    pose: &Pose,
    margin: f32,
    size: f32,
) -> RawManifold {
    let (own, solid_a) = (Frustum::of(a), Solid::of(a));
    let (Some(body_a), Some(body_b)) = (Body::of(own, &solid_a), Body::of(other, &solid_b)) else {
        return RawManifold::default();
    };
    let both = Both { bodies: [body_a, body_b], pose: *pose, back: pose.inverse(), against };
    let tolerance = CYLINDER_AXIS_TOLERANCE * size;
    Contact { both, margin, size, tolerance }.manifold(|| a.geometry.support().zip(support_b()))
}

struct Contact<'a> {
    both: Both<'a>,
    margin: f32,
    /// A length of the smaller shape [m].
    size: f32,
    /// [m].
    tolerance: f32,
}

impl<'a> Contact<'a> {
    fn manifold<'s>(&self, supports: impl Fn() -> Option<(Support<'s>, Support<'s>)>) -> RawManifold {
        let none = RawManifold::default();
        let Some(found) = self.both.candidates(self.margin) else { return none };
        let flat = found.flat;
        let mut cloud = Cloud::new();
        if flat.separation >= found.best.separation - self.tolerance {
            self.on_face(&flat, &mut cloud);
            if self.proves(&flat, &cloud) {
                return manifold_of(&cloud, flat.normal);
            }
        }
        let Some((a, b)) = supports() else { return none };
        let (best, points) = self.both.best((&a, &b), found.best, self.size);
        if best.separation > self.margin {
            return none;
        }
        let middle = (points[0] + points[1]) * 0.5;
        let mut point = RawPoint { position: middle, separation: best.separation, key: key(EDGES, 0, 0) };
        let is_flat = flat.separation >= best.separation - self.tolerance;
        if is_flat && cloud.points().is_empty() {
            self.on_face(&flat, &mut cloud);
        }
        // The side of a cylinder that is not over the face touches its border, and rolls on it: a point of
        // the side that moves towards the face is none that the face meets.
        let rolls = matches!(flat.face, Some((FlatFace::Polygon(_), _))) && cloud.points().is_empty();
        if is_flat && !rolls {
            if cloud.least() > flat.separation + self.tolerance {
                point.separation = flat.separation;
                cloud.push(point);
            }
            return manifold_of(&cloud, flat.normal);
        }
        cloud = Cloud::new();
        self.on_lines(best.normal, &mut cloud);
        if cloud.points().len() < 2 || cloud.least() > best.separation + self.tolerance {
            if cloud.points().len() < 2 {
                cloud = Cloud::new();
            }
            cloud.push(point);
        }
        manifold_of(&cloud, best.normal)
    }

    /// Whether the points on a face show that no direction is better than its normal.
    ///
    /// Apart, a point at the distance of the two shapes along the normal does. In overlap let points on both
    /// sides of any line through the patch be as deep as the deepest, d, and the patch be w wide at least:
    /// tilted by θ, the two shapes are w sin θ + d cos θ in each other, which is no less than d up to a right
    /// angle if w is no less than d.
    fn proves(&self, face: &Axis, cloud: &Cloud) -> bool {
        if cloud.least() > face.separation + self.tolerance {
            return false;
        }
        if face.separation > 0.0 {
            return true;
        }
        let deep = |p: &&RawPoint| p.separation <= face.separation + self.tolerance;
        // The width of a triangle is its least height. That of the first corner, the furthest from it, and
        // the furthest from the line through both.
        let Some(first) = cloud.points().iter().find(deep) else { return false };
        let furthest = |away: &dyn Fn(Vec3) -> f32| {
            cloud
                .points()
                .iter()
                .filter(deep)
                .map(|p| (away(p.position), p.position))
                .fold((-1.0, first.position), |best, next| if next.0 > best.0 { next } else { best })
        };
        let (reach, second) = furthest(&|p| (p - first.position).length());
        let line = second - first.position;
        let (area, third) = furthest(&|p| (p - first.position).cross(line).length());
        let longest = reach.max((third - first.position).length()).max((third - second).length());
        area > longest * -face.separation
    }

    /// The points of a flat face and the part of the other shape that faces it.
    fn on_face(&self, axis: &Axis, cloud: &mut Cloud) {
        let Some((face, on_b)) = axis.face else { return };
        let n = axis.normal;
        let (own, other) = (self.both.pose_of(on_b), self.both.pose_of(!on_b));
        let [own_body, other_body] = [on_b, !on_b].map(|k| &self.both.bodies[usize::from(k)]);
        // Out of the other shape, in its own frame.
        let out = if on_b { n } else { self.both.pose.back(-n) };
        let margin = self.margin;
        match (face, own_body, other_body) {
            (FlatFace::Cap { up }, Body::Round(f), Body::Round(g)) => {
                let disc = f.cap(up, own);
                if g.shows_cap(out) {
                    let cap = g.cap(out.y > 0.0, other);
                    let face = Face::new(&disc, on_b, cap.plane(), n, margin);
                    let facing = Face::new(&cap, !on_b, disc.plane(), n, margin);
                    if let Some((face, facing)) = face.zip(facing) {
                        face.disc(&facing, self.tolerance, cloud);
                    }
                } else {
                    let ends = g.line(out, other);
                    let side = other.direction(g.side_normal(out));
                    if let Some(face) = Face::new(&disc, on_b, (side, side.dot(ends[0])), n, margin) {
                        face.line(ends, cloud);
                    }
                }
            }
            (FlatFace::Cap { up }, Body::Round(f), Body::Flat(p)) => {
                let disc = f.cap(up, own);
                let facing = p.face_towards(out);
                let (normal, offset) = p.planes[facing];
                let normal = other.direction(normal);
                let plane = (normal, offset + normal.dot(other.position));
                if let Some(face) = Face::new(&disc, on_b, plane, n, margin) {
                    face.polygon(&Loop::new(p.vertices, p.face(facing), other), self.tolerance, cloud);
                }
            }
            (FlatFace::Polygon(index), Body::Flat(p), Body::Round(f)) => {
                let (normal, offset) = p.planes[index];
                let normal = own.direction(normal);
                let plane = (normal, offset + normal.dot(own.position));
                let polygon = Loop::new(p.vertices, p.face(index), own);
                let tolerance = self.tolerance;
                FacingPolygon { polygon: &polygon, plane, on_b: !on_b, margin, tolerance }
                    .add_points(f, other, out, cloud);
            }
            _ => {}
        }
    }

    /// The points of two edges, lines of sides, rims or corners that face each other along `n`.
    fn on_lines(&self, n: Vec3, cloud: &mut Cloud) {
        // How far from level a line may be: on a wide face far less than the angle at which lines are
        // parallel.
        let short = 0.01 * self.size;
        let furthest = |on_b: bool| {
            let (d, pose) = (if on_b { self.both.pose.back(-n) } else { n }, self.both.pose_of(on_b));
            match &self.both.bodies[usize::from(on_b)] {
                Body::Round(f) => f.furthest(d, short, pose),
                Body::Flat(p) => Segment::support(p, d, short, pose),
            }
        };
        let (one, other) = (furthest(false), furthest(true));
        let [d, e] = [&one, &other].map(|s| s.ends[1] - s.ends[0]);
        let longer = d.length().max(e.length());
        if longer > 0.0 && d.cross(e).length() <= LINE_TOUCH_ASIDE * self.size * longer && d.dot(e) != 0.0 {
            clip_edges(&one, &other, n, self.margin, cloud);
        }
    }
}

/// A polygon of the other shape that a frustum faces.
struct FacingPolygon<'a> {
    polygon: &'a Loop,
    /// Its normal, and its offset along that [m].
    plane: (Vec3, f32),
    /// Whether the frustum is `b`.
    on_b: bool,
    /// Points nearer than this are added [m].
    margin: f32,
    /// Points this far outside of the polygon count as over it [m].
    tolerance: f32,
}

impl FacingPolygon<'_> {
    /// Adds the points of a frustum at `pose` that are over the polygon: of the cap or of the line of the
    /// side, whichever faces along `out`, in the frustum's own frame.
    fn add_points(&self, f: &Frustum, pose: &Pose, out: Vec3, cloud: &mut Cloud) {
        let &FacingPolygon { polygon, plane, on_b, margin, tolerance } = self;
        if f.shows_cap(out) {
            let disc = f.cap(out.y > 0.0, pose);
            let n = if on_b { plane.0 } else { -plane.0 };
            if let Some(face) = Face::new(&disc, on_b, plane, n, margin) {
                face.polygon(polygon, tolerance, cloud);
            }
        } else {
            let line = Loop::new(&f.line(out, pose), &[0, 1], &Pose::IDENTITY);
            clip_face(polygon, plane, &line, plane, margin, tolerance, cloud);
        }
    }
}

/// The points of a cylinder, in its own frame, that are over a triangle, and the unit normal of the
/// triangle's front.
pub(crate) fn over_triangle(a: &Collider, triangle: &Loop, front: Vec3, margin: f32, cloud: &mut Cloud) {
    let (Some(f), (corners, _)) = (Frustum::of(a), triangle.corners()) else { return };
    let Some(corner) = corners.first() else { return };
    let plane = (front, front.dot(*corner));
    let tolerance = 1e-4 * a.radius;
    FacingPolygon { polygon: triangle, plane, on_b: false, margin, tolerance }.add_points(
        &f,
        &Pose::IDENTITY,
        -front,
        cloud,
    );
}

/// A cylinder and the half-space whose outward normal is `-normal` and whose border is at `offset` along
/// `normal`; in the cylinder's frame.
pub(crate) fn on_half_space(
    f: &Frustum,
    (normal, offset): (Vec3, f32),
    margin: f32,
    size: f32,
    cloud: &mut Cloud,
) {
    if f.shows_cap(normal) {
        let disc = f.cap(normal.y > 0.0, &Pose::IDENTITY);
        if let Some(face) = Face::new(&disc, false, (-normal, -offset), normal, margin) {
            face.rim(CYLINDER_AXIS_TOLERANCE * size, |_| true, cloud);
        }
        return;
    }
    for (i, end) in f.line(normal, &Pose::IDENTITY).into_iter().enumerate() {
        let separation = offset - normal.dot(end);
        if separation <= margin {
            let position = end + normal * (0.5 * separation);
            cloud.push(RawPoint { position, separation, key: i as u32 });
        }
    }
}
