//! The way of a shape along a mesh that doesn't turn, as the way of the box and of the ball around it.
//!
//! Most casts find nothing: the body is in flight, or rolls on what it touches anyway. A ball needs no rotation, and its
//! height over a plane changes evenly, so eight triangles are passed over with two heights each, in the mesh's own
//! frame. Only where that doesn't settle it is a search begun.

use super::Relative;
use super::cast_mesh::Asked;
use super::mesh_reach::bounds;
use super::motion::Motion;
use super::nearby::{Eight, Extent};
use super::polytope::Pose;
use super::touched::Touched;
use crate::lanes::{Lanes, Mask, Vec3 as LaneVec3, f32x8};
use crate::shape::{Collider, Kind};
use glam::{Mat3, Vec3};

/// The way of a box in the mesh's frame.
pub(super) struct BoxPath {
    pub(super) from: Vec3,
    pub(super) to: Vec3,
    /// Half extents.
    pub(super) inflate: Vec3,
}

impl BoxPath {
    /// The box around all of it, if that holds hardly more than the path itself.
    pub(super) fn as_box(&self) -> Option<Extent> {
        let half = (self.to - self.from).abs() * 0.5;
        let reach = half + self.inflate;
        let middle = (self.from + self.to) * 0.5;
        half.cmple(self.inflate).all().then(|| (middle - reach, middle + reach))
    }
}

/// See the module.
pub(super) struct ShapePath {
    /// Of the shape's origin, and how far it goes from there, as if nothing turned [m].
    from: Vec3,
    way: Vec3,
    /// Half extents of the box that holds the shape at all times [m].
    half: Vec3,
    /// Radius of the ball that does [m].
    radius: f32,
    /// Allowed for, and by how much rounding may move anything [m].
    clearance: f32,
    /// What is touched at the start, as the mesh sees it.
    known: Touched,
    lip: f32,
}

impl ShapePath {
    /// `rel`: of the mesh in the shape's frame at the start.
    pub(super) fn new(a: &Collider, rel: &Relative, motion: &Motion, asked: &Asked) -> ShapePath {
        let to_mesh = rel.rotation.conjugate();
        let from = -(to_mesh * rel.position);
        let way = motion.b.rotation.conjugate() * motion.displacement;
        // No chord is longer than the arc, or than twice the radius. What is round about an axis does not change by a turn
        // about that.
        let angle = motion.a.spin.length().min(2.0);
        let tilt = match a.kind {
            Kind::Sphere => 0.0,
            Kind::Capsule | Kind::Cylinder => {
                motion.a.spin.cross(motion.a.rotation * Vec3::Y).length().min(2.0)
            }
            _ => angle,
        };
        let swing = angle * motion.a.lever.length();
        let (middle, half) = bounds(a).unwrap_or((Vec3::ZERO, Vec3::splat(a.radius)));
        let (m, half) = (Mat3::from_quat(to_mesh), half + middle.abs());
        let half = m.x_axis.abs() * half.x + m.y_axis.abs() * half.y + m.z_axis.abs() * half.z;
        let half = (half + Vec3::splat(tilt * a.radius)).min(Vec3::splat(a.radius)) + Vec3::splat(swing);
        let radius = a.radius + swing;
        // The tolerance alone may be less than what `f32` resolves in a large mesh.
        let rounding = 2e-6 * (from.length() + way.length() + radius);
        let clearance = asked.tolerance.max(asked.alone) + rounding;
        let known = asked.known.seen_from(&Pose::new(rel.position, rel.rotation));
        ShapePath { from, way, half, radius, clearance, known, lip: asked.lip }
    }

    pub(super) fn in_box(&self) -> BoxPath {
        let inflate = self.half + Vec3::splat(self.clearance);
        BoxPath { from: self.from, to: self.from + self.way, inflate }
    }

    /// Whether the shape surely touches none of some of eight triangles, but for those that it touches at the start.
    #[inline(always)]
    pub(super) fn passes(&self, eight: &Eight, lanes: u32) -> bool {
        let corners = [eight.corners.corner(0), eight.corners.corner(1), eight.corners.corner(2)];
        let [a, b, c] = corners;
        let across = (b - a).cross(c - a);
        let start = across.dot(LaneVec3::splat(self.from) - a);
        let end = start + across.dot(LaneVec3::splat(self.way));
        let least = Lanes::min(start.abs(), end * start.sign());
        // A triangle of no area has no plane: zero is not more than zero.
        let away = least.gt(across.length() * f32x8::splat(self.radius + self.clearance));
        let mut left = lanes & !away.bits();
        if left != 0 && !self.known.is_empty() {
            left &= !self.known.hides(&corners, self.lip).bits();
            left = self.known.without(left, &eight.index);
        }
        left == 0
    }
}
