//! Which of eight triangles a moving shape can't touch within the step, in lanes.
//!
//! The exact search for a first touch ([`cast`](super::cast)) costs a microsecond a triangle. Most triangles near the
//! path stay behind a plane that the shape never reaches: their own. Along a fixed direction the path of every point
//! of a turning shape lies within the sagitta of its arc from the chord, so two heights over the plane, at the start
//! and at the end, bound all in between.

use super::cast::Spin;
use super::mesh::{Eight, Triangles};
use super::mesh_sphere::nearest;
use super::motion::{Motion, turn};
use super::polytope::Pose;
use crate::lanes::{Lanes, Mask, Vec3 as LaneVec3, f32x8};
use crate::shape::{Collider, Geometry};
use glam::{Mat3, Vec3};

/// How far a shape reaches from its origin along eight directions [m].
#[inline(always)]
pub(super) fn reach(shape: &Collider, d: LaneVec3<f32x8>) -> f32x8 {
    let [x, y, z, _] = shape.size.map(f32x8::splat);
    match &shape.geometry {
        Geometry::Sphere { .. } => x,
        Geometry::Capsule { .. } => Lanes::max(x * d.y + z, y - x * d.y),
        Geometry::Cylinder { .. } => {
            let across = (d.x * d.x + d.z * d.z).sqrt();
            Lanes::max(x * d.y + z * across, y * across - x * d.y)
        }
        Geometry::Box { .. } => LaneVec3::new(x, y, z).dot(d.abs()),
        Geometry::Hull(hull) => {
            let mut most = f32x8::splat(f32::MIN);
            for v in &hull.vertices {
                most = Lanes::max(LaneVec3::<f32x8>::splat(*v).dot(d), most);
            }
            most
        }
        _ => f32x8::splat(f32::MAX),
    }
}

/// A shape's motion against a mesh that doesn't turn, in the shape's frame at the start of the step.
pub(super) struct MeshSweep<'a> {
    shape: &'a Collider,
    /// Of the mesh, at the start.
    pose: Pose,
    middle: Moment,
    end: Moment,
    /// Rotation vector over the step [rad].
    spin: Vec3,
    /// Angle times extent across the axis [m]: times the share of the spin across a direction it is how much the
    /// velocity along that direction may change within the step.
    bend: f32,
    /// Allowed for rounding [m].
    slack: f32,
}

/// Where the shape is.
struct Moment {
    /// Its origin less that at the start.
    moved: Vec3,
    turned: Mat3,
}

impl<'a> MeshSweep<'a> {
    pub(super) fn new(shape: &'a Collider, motion: &Motion, spin: &Spin) -> MeshSweep<'a> {
        let rel = motion.relative(0.0);
        let to_local = motion.a.rotation.conjugate();
        let way = to_local * motion.displacement;
        let lever = to_local * motion.a.lever;
        let local = to_local * spin.vector;
        let moment = |t: f32| {
            let turned = Mat3::from_quat(turn(local.as_dvec3() * f64::from(t)).as_quat());
            Moment { moved: way * t + turned * lever - lever, turned }
        };
        MeshSweep {
            shape,
            pose: Pose::new(rel.position, rel.rotation),
            middle: moment(0.5),
            end: moment(1.0),
            spin: local,
            bend: spin.vector.length() * spin.reach,
            slack: 2e-6 * (rel.position.length() + way.length() + shape.radius + lever.length()),
        }
    }

    /// A bit for each triangle that has to be looked at, and for those the earliest fraction of the step at which it
    /// may be touched. What comes no nearer than `tolerance` [m] is left out, and so is what the shape rests on: it is
    /// within `resting` [m] of the triangle's plane, and stays so.
    #[inline(always)]
    pub(super) fn in_reach(&self, eight: &Eight, tolerance: f32, resting: f32) -> (u32, [f32; 8]) {
        let triangles = Triangles::new(eight, &self.pose, Vec3::ZERO);
        let down = -triangles.front;
        let [start, end, limit] = self.gaps(triangles.height, down, tolerance);
        let least = Lanes::min(start, end);
        let mut away = least.gt(limit);
        let resting = f32x8::splat(resting);
        let level = start.abs().le(resting);
        if (level & !away).any() {
            let lowest = Lanes::min(least, self.gap(triangles.height, down, &self.middle));
            away = away | (level & lowest.ge(-resting));
        }
        // The gap is at least the chord's less the sagitta.
        let earliest = |start: f32x8, end: f32x8, limit: f32x8| {
            let closing = Lanes::max(start - end, f32x8::splat(f32::MIN_POSITIVE));
            Lanes::max((start - limit) / closing, f32x8::zero())
        };
        let mut first = earliest(start, end, limit);
        if (!away).bits() & triangles.valid != 0 {
            // Beside the triangle its plane may well be crossed: towards what of it is nearest halfway.
            let moved = LaneVec3::splat(self.middle.moved);
            let (point, _) = nearest(&triangles, moved);
            let way = point - moved;
            let length = way.length();
            let apart = length.gt(f32x8::splat(f32::MIN_POSITIVE));
            let u = way * (f32x8::one() / Lanes::select(apart, length, f32x8::one()));
            let [a, b, c] = triangles.corners;
            let near = Lanes::min(u.dot(a), Lanes::min(u.dot(b), u.dot(c)));
            let [start, end, limit] = self.gaps(near, u, tolerance);
            away = away | (apart & Lanes::min(start, end).gt(limit));
            first = Lanes::max(first, Lanes::select(apart, earliest(start, end, limit), f32x8::zero()));
        }
        let exact = triangles.valid & !away.bits();
        // Triangles of no area have no plane.
        let flat = !triangles.valid & eight.lanes();
        (exact | flat, first.to_array())
    }

    /// The gaps along fixed directions to what is `far` from the origin along them, at the start and at the end, and
    /// how large both must be to last for all of the step [m].
    #[inline(always)]
    fn gaps(&self, far: f32x8, direction: LaneVec3<f32x8>, tolerance: f32) -> [f32x8; 3] {
        let across = LaneVec3::<f32x8>::splat(self.spin).cross(direction).length();
        let sag = across * f32x8::splat(self.bend / 8.0);
        let start = far - reach(self.shape, direction);
        [start, self.gap(far, direction, &self.end), sag + f32x8::splat(tolerance + self.slack)]
    }

    #[inline(always)]
    fn gap(&self, far: f32x8, direction: LaneVec3<f32x8>, moment: &Moment) -> f32x8 {
        let m = &moment.turned;
        // The direction as the turned shape sees it.
        let local = LaneVec3::new(
            LaneVec3::splat(m.x_axis).dot(direction),
            LaneVec3::splat(m.y_axis).dot(direction),
            LaneVec3::splat(m.z_axis).dot(direction),
        );
        far - LaneVec3::splat(moment.moved).dot(direction) - reach(self.shape, local)
    }
}
