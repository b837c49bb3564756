//! The path of a shape along a mesh that doesn't turn, as that of its bounding box and ball.
//!
//! Most casts find nothing: the body is in flight, or rolls on triangles that it touches anyway. A ball needs
//! no rotation, and its height over a plane changes linearly, so two heights each exclude eight triangles, in
//! the mesh's own frame. Only where that is not enough a search begins.

use super::mesh_cast::MeshCast;
use super::motion::Motion;
use crate::lanes::{Lanes, Mask, Vec3 as LaneVec3, f32x8};
use crate::narrow_phase::Relative;
use crate::narrow_phase::convex::polytope::Pose;
use crate::narrow_phase::mesh::nearby::{Eight, Extent};
use crate::narrow_phase::mesh::reach::{Bounds, bounds};
use crate::narrow_phase::mesh::touched::Touched;
use crate::shape::{Collider, Symmetry};
use glam::Vec3;

/// The path of a box in the mesh's frame.
pub(crate) struct BoxPath {
    pub(crate) from: Vec3,
    pub(crate) to: Vec3,
    /// Half extents.
    pub(crate) inflate: Vec3,
}

impl BoxPath {
    /// The box around the whole path, if it is hardly larger than the path itself.
    pub(crate) fn as_box(&self) -> Option<Extent> {
        let half = (self.to - self.from).abs() * 0.5;
        let reach = half + self.inflate;
        let middle = (self.from + self.to) * 0.5;
        half.cmple(self.inflate).all().then(|| (middle - reach, middle + reach))
    }
}

/// See the module.
pub(crate) struct ShapePath {
    /// Start of the shape's origin and its displacement, as if nothing turned [m].
    from: Vec3,
    way: Vec3,
    /// Half extents of the box that contains the shape at all times [m].
    half: Vec3,
    /// Radius of the ball that does so [m].
    radius: f32,
    /// Distance that counts as a touch, with the allowance for rounding [m].
    clearance: f32,
    /// Triangles touched at the start, in the frame of the mesh.
    known: Touched,
    lip: f32,
}

impl ShapePath {
    /// `rel`: pose of the mesh in the shape's frame at the start.
    pub(crate) fn new(a: &Collider, rel: &Relative, motion: &Motion, cast: &MeshCast) -> ShapePath {
        let to_mesh = rel.rotation.conjugate();
        let from = -(to_mesh * rel.position);
        let way = motion.b.rotation.conjugate() * motion.displacement;
        // A chord is no longer than the arc, or than twice the radius. Turning a round shape about its axis
        // does not change it.
        let angle = motion.a.spin.length().min(2.0);
        let tilt = match a.kind.symmetry() {
            Symmetry::Ball => 0.0,
            Symmetry::Axis => motion.a.spin.cross(motion.a.rotation * Vec3::Y).length().min(2.0),
            Symmetry::None => angle,
        };
        let swing = angle * motion.a.lever.length();
        let Bounds { middle, half } = bounds(a).unwrap_or(Bounds::of_ball(a.radius));
        let (m, half) = (to_mesh.matrix(), half + middle.abs());
        let half = m.x_axis.abs() * half.x + m.y_axis.abs() * half.y + m.z_axis.abs() * half.z;
        let half = (half + Vec3::splat(tilt * a.radius)).min(Vec3::splat(a.radius)) + Vec3::splat(swing);
        let radius = a.radius + swing;
        // The tolerance alone may be less than the resolution of `f32` in a large mesh.
        let rounding = 2e-6 * (from.length() + way.length() + radius);
        let clearance = cast.tolerance.max(cast.alone) + rounding;
        let known = cast.known.seen_from(&Pose::new(rel.position, rel.rotation));
        ShapePath { from, way, half, radius, clearance, known, lip: cast.lip }
    }

    pub(crate) fn in_box(&self) -> BoxPath {
        let inflate = self.half + Vec3::splat(self.clearance);
        BoxPath { from: self.from, to: self.from + self.way, inflate }
    }

    /// Whether the shape surely touches none of up to eight triangles, except those that it touches at the
    /// start.
    #[inline(always)]
    pub(crate) fn passes(&self, eight: &Eight, lanes: u32) -> bool {
        let corners = [eight.corners.corner::<f32x8>(0), eight.corners.corner(1), eight.corners.corner(2)];
        let [a, b, c] = corners;
        let across = (b - a).cross(c - a);
        let start = across.dot(LaneVec3::splat(self.from) - a);
        let end = start + across.dot(LaneVec3::splat(self.way));
        let least = Lanes::min(start.abs(), end * start.sign());
        // A degenerate triangle has no plane: zero is not more than zero.
        let away = least.gt(across.length() * f32x8::splat(self.radius + self.clearance));
        let mut left = lanes & !away.bits();
        if left != 0 && !self.known.is_empty() {
            left &= !self.known.hides(&corners, self.lip).bits();
            left = self.known.without(left, &eight.index);
        }
        left == 0
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::narrow_phase::cast::motion::BodyPath;
    use crate::narrow_phase::cast::{Other, Sweep, tolerance};
    use crate::narrow_phase::fixtures::{CONVEX, collider};
    use crate::random::Random;
    use crate::shape::Geometry;
    use crate::shape::support::Support;

    /// No touch of the exact search is passed over, and a shape never leaves its box.
    #[test]
    fn what_is_touched_is_not_passed_and_the_box_holds_the_shape() {
        let mut random = Random(78);
        let (mut touched, mut passed, mut all) = (0, 0, 0);
        for i in 0..if cfg!(miri) { 5 } else { 2000 } {
            let mut a = random.shape(CONVEX[i % 5], 1.0);
            if i % 2 == 0 {
                (a.position, a.rotation) = (random.cube(), random.turn());
            }
            let b = collider(Geometry::Plane);
            let (mut pa, pb) = (random.body(4.0, [0.0, 0.5, 3.0][i % 3]), random.body(1.0, 0.0));
            pa.displacement = pa.centre.as_vec3() * -0.7 + pb.displacement;
            let motion = Motion::new(&a, &pa, &b, &pb);
            let cast = MeshCast::first(tolerance(&a, &b, 1.0), 0.0);
            let path = ShapePath::new(&a, &motion.relative(0.0), &motion, &cast);
            let shape = a.geometry.support().unwrap();
            let BoxPath { from, to, inflate } = path.in_box();
            for k in 0..=8 {
                let t = k as f32 / 8.0;
                let rel = motion.relative(t);
                let (middle, back) = (from.lerp(to, t), rel.rotation.conjugate());
                for axis in [Vec3::X, Vec3::Y, Vec3::Z, Vec3::NEG_X, Vec3::NEG_Y, Vec3::NEG_Z] {
                    let seen = (rel.rotation * axis).as_dvec3();
                    let furthest = (shape.support(seen) + seen * shape.radius).as_vec3();
                    let out = axis.dot(back * (furthest - rel.position) - middle);
                    assert!(out <= axis.abs().dot(inflate) + 1e-5, "{i} {t} {axis} {out} {inflate}");
                }
            }
            for k in 0..8 {
                let triangle = random.triangle(2.0);
                let mut eight = Eight::default();
                eight.push(k, triangle);
                let other = Other::Convex(Support::triangle(triangle));
                let touch = Sweep::new(shape, other, &motion, cast.tolerance).first_touch(1.0);
                let passes = path.passes(&eight, 1);
                assert!(!(passes && touch.is_some()), "{i} {k} {touch:?} {a:?} {motion:?}");
                (all, touched, passed) =
                    (all + 1, touched + u32::from(touch.is_some()), passed + u32::from(passes));
            }
        }
        assert!(cfg!(miri) || touched > 500 && passed > (all - touched) / 3, "{touched} {passed} {all}");
    }

    /// A box that rests on a floor of two triangles slides past both; a step that stands out in front of it
    /// is not passed.
    #[test]
    fn what_is_touched_at_the_start_is_passed() {
        let a = collider(Geometry::cuboid(0.5, 0.5, 0.5));
        let floor = collider(Geometry::Plane);
        let path = |displacement: Vec3| BodyPath {
            centre: (Vec3::Y * 0.501).as_dvec3(),
            rotation: crate::math::Quat::IDENTITY,
            displacement,
            spin: Vec3::ZERO,
        };
        let still = BodyPath { centre: glam::DVec3::ZERO, ..path(Vec3::ZERO) };
        let motion = Motion::new(&a, &path(Vec3::X * 0.3), &floor, &still);
        let mut known = Touched::default();
        known.add_plane(Vec3::Y, -0.501, Vec3::X, 0.01);
        let cast = MeshCast { known, lip: 5e-4, ..MeshCast::first(1e-4, 0.01) };
        let path = ShapePath::new(&a, &motion.relative(0.0), &motion, &cast);
        let mut eight = Eight::default();
        let at = |x: f32, y: f32, z: f32| Vec3::new(x, y, z);
        eight.push(0, [at(-2.0, 0.0, -2.0), at(-2.0, 0.0, 2.0), at(2.0, 0.0, -2.0)]);
        eight.push(1, [at(2.0, 0.0, -2.0), at(-2.0, 0.0, 2.0), at(2.0, 0.0, 2.0)]);
        assert!(path.passes(&eight, 0b11));
        eight.push(2, [at(0.7, 0.0, -2.0), at(0.7, 0.0, 2.0), at(0.7, 0.2, 0.0)]);
        assert!(!path.passes(&eight, 0b111));
    }
}
