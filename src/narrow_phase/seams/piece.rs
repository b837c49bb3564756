//! Properties of the shapes on either side of a seam: how far they reach, and whether they go on.

use crate::config::tuning::FLAT_EDGE_COSINE;
use crate::math::Quat;
use crate::narrow_phase::convex::gjk::distance;
use crate::narrow_phase::convex::polytope::Pose;
use crate::narrow_phase::convex::simplex::from_triangle;
use crate::narrow_phase::{MAX_POINTS, Relative};
use crate::shape::support::Support;
use crate::shape::{Collider, Geometry, Kind};
use glam::Vec3;

// Rounding: of a normal.
/// Sine up to which a normal is that of a face.
const LEAN: f32 = 3e-4;

/// Points of a manifold on the surface of a piece.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Places {
    at: [Vec3; MAX_POINTS],
    count: usize,
}

impl Places {
    pub(super) fn one(at: Vec3) -> Places {
        Places { at: [at; MAX_POINTS], count: 1 }
    }

    /// Adds a place; there are no more than a manifold has points.
    pub(super) fn push(&mut self, at: Vec3) {
        self.at[self.count] = at;
        self.count += 1;
    }

    /// The furthest of them along a direction [m].
    pub(super) fn furthest(&self, along: Vec3) -> f32 {
        self.each().iter().map(|at| at.dot(along)).fold(f32::MIN, f32::max)
    }

    pub(super) fn each(&self) -> &[Vec3] {
        &self.at[..self.count]
    }
}

/// A collider of the ground, in a frame with the axes of the world and its origin at the shape that lies on
/// it.
#[derive(Clone, Copy, Debug)]
pub(super) struct Piece<'a> {
    pub(super) collider: &'a Collider,
    pub(super) pose: Pose,
}

impl Piece<'_> {
    /// The face that has an outward normal at these places, or nearly so, by its own normal; `None` where the
    /// surface is curved, or is an edge whose faces have quite other normals. `within`: how exact places are
    /// [m].
    pub(super) fn face(&self, normal: Vec3, places: &Places, within: f32) -> Option<Vec3> {
        let local = self.pose.back(normal);
        let mut best = (FLAT_EDGE_COSINE, None::<Vec3>);
        let mut consider = |front: Vec3| {
            let cosine = front.dot(local);
            if cosine > best.0 {
                best = (cosine, Some(front));
            }
        };
        match &self.collider.geometry {
            _ if self.collider.kind.is_smooth() => {}
            Geometry::Plane => consider(Vec3::Y),
            Geometry::Box { .. } => {
                let axis = local.abs().max_position();
                consider(Vec3::AXES[axis] * local[axis].signum());
            }
            Geometry::Hull(hull) => hull.planes.iter().for_each(|(front, _)| consider(*front)),
            Geometry::Mesh(_) | Geometry::HeightField(_) => {
                self.each_triangle(places, within, &mut |corners| {
                    let front = (corners[1] - corners[0]).cross(corners[2] - corners[0]).normalize_or_zero();
                    consider(front * front.dot(local).signum());
                });
            }
            // A frustum has two ends.
            _ => consider(Vec3::Y * local.y.signum()),
        }
        best.1.map(|front| self.pose.direction(front))
    }

    /// Whether the surface has this outward normal nowhere but on edges and corners.
    pub(super) fn is_edge(&self, normal: Vec3, face: Option<Vec3>) -> bool {
        if face.is_some_and(|face| face.distance_squared(normal) < LEAN * LEAN) {
            return false;
        }
        match self.collider.kind {
            kind if kind.is_smooth() => false,
            Kind::Cylinder => !self.is_side(self.pose.back(normal)),
            _ => true,
        }
    }

    /// Whether a normal is one of the side of a frustum.
    fn is_side(&self, local: Vec3) -> bool {
        let [half, bottom, top, _] = self.collider.size;
        let slope = (bottom - top) / (2.0 * half);
        let expected = slope / (1.0 + slope * slope).sqrt();
        (local.y - expected).abs() < LEAN
    }

    /// The furthest that it reaches along a unit direction [m]; of a mesh, the triangles at these places.
    /// `None` if it has none there.
    pub(super) fn reach(&self, along: Vec3, places: &Places, within: f32) -> Option<f32> {
        let (local, offset) = (self.pose.back(along), along.dot(self.pose.position));
        if let Some(support) = self.collider.geometry.support() {
            let local = local.as_dvec3();
            return Some((support.support(local).dot(local) + support.radius) as f32 + offset);
        }
        if matches!(self.collider.geometry, Geometry::Plane) {
            return Some(if local.with_y(0.0).length() < LEAN && local.y > 0.0 { offset } else { f32::MAX });
        }
        let mut most = None::<f32>;
        self.each_triangle(places, within, &mut |corners| {
            let reach = corners.iter().map(|corner| corner.dot(local)).fold(f32::MIN, f32::max);
            most = Some(most.map_or(reach, |most| most.max(reach)));
        });
        most.map(|most| most + offset)
    }

    /// Whether the piece has the point, and goes on from there beyond the plane through the point with this
    /// unit normal: so it is no normal of the surface that the piece is a part of.
    pub(super) fn goes_on(&self, at: Vec3, normal: Vec3, within: f32) -> bool {
        let (point, local) = (self.pose.back(at - self.pose.position), self.pose.back(normal));
        let beyond = |reach: f32, size: f32| reach > LEAN * size + 1e-6 * point.abs().max_element();
        if let Some(support) = self.collider.geometry.support() {
            let far = local.as_dvec3();
            let reach = (support.support(far) - point.as_dvec3()).dot(far) + support.radius;
            return beyond(reach as f32, self.collider.radius) && self.has(at, within);
        }
        if matches!(self.collider.geometry, Geometry::Plane) {
            return point.y <= within && local.with_y(0.0).length() > LEAN;
        }
        let mut found = false;
        self.each_triangle(&Places::one(at), within, &mut |corners| {
            let reach = corners.iter().map(|corner| (*corner - point).dot(local)).fold(f32::MIN, f32::max);
            let size = (corners[1] - corners[0]).length().max((corners[2] - corners[0]).length());
            let near = || from_triangle(point, corners).length_squared() <= f64::from(within * within);
            found |= beyond(reach, size) && near();
        });
        found
    }

    /// Whether a convex piece has a point, or is this near to it [m].
    pub(super) fn has(&self, at: Vec3, within: f32) -> bool {
        let here = Relative { position: self.pose.back(at - self.pose.position), rotation: Quat::IDENTITY };
        self.collider.geometry.support().is_some_and(|support| {
            distance(&support, &Support::point(), &here, Vec3::ZERO).distance <= within
        })
    }

    /// Calls `f` with the triangles whose boxes are within so far of a place, some of them more than once.
    fn each_triangle(&self, places: &Places, within: f32, f: &mut dyn FnMut([Vec3; 3])) {
        let Some(ground) = self.collider.geometry.ground() else { return };
        for &at in places.each() {
            let point = self.pose.back(at - self.pose.position);
            ground.visit_box(point - within, point + within, &mut |_, corners| f(corners));
        }
    }
}
