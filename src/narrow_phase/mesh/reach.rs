//! How far around a shape the triangles of a mesh matter.
//!
//! A box in the mesh's frame, around where the shape is and where it goes, selects the triangles to gather.
//! If only near contacts count, few triangles do: the near ones, and those further away that are level with a
//! near one, because their points belong to the same manifold.

use super::nearby::Extent;
use super::triangles::Triangles;
use crate::config::tuning::{ONE_MANIFOLD_COSINE, ONE_MANIFOLD_SINE};
use crate::lanes::{Lanes, Mask, Vec3 as LaneVec3, ones};
use crate::narrow_phase::Relative;
use crate::narrow_phase::convex::polytope::Pose;
use crate::shape::{Collider, Geometry};
use glam::Vec3;

/// Which triangles of a mesh count as close to a shape.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Reach {
    /// Distance up to which points count [m].
    pub(crate) margin: f32,
    /// The caller has no use for manifolds without a point nearer than this [m]; below zero: without one as
    /// deep. Triangles further away are examined only if they are level with a nearer one.
    pub(crate) within: f32,
    /// Displacement of the shape, in its own frame [m]: triangles may be further away by as much as it takes
    /// off their distance.
    pub(crate) path: Vec3,
}

impl Reach {
    pub(crate) fn new(margin: f32) -> Reach {
        Reach { margin, within: margin, path: Vec3::ZERO }
    }
    pub(crate) fn within(self, within: f32) -> Reach {
        Reach { within, ..self }
    }
}

/// Normals of near triangles, if they are few.
#[derive(Default)]
pub(crate) struct Near {
    fronts: [Vec3; 8],
    pub(crate) count: usize,
}

impl Near {
    /// Adds those of eight triangles that may be nearer than `within` [m]: neither their planes nor those of
    /// the box around the shape exclude it. Below zero: those whose planes the shape is beyond by as much,
    /// and which it may touch.
    #[inline(always)]
    pub(crate) fn add<L: Lanes>(
        &mut self,
        triangles: &Triangles<L>,
        a: &Collider,
        bounds: Bounds,
        within: f32,
    ) {
        let limit = L::splat(within);
        let (_, axis, _) = triangles.separate(bounds.middle, bounds.half);
        let down = -triangles.front;
        let face = triangles.height - a.geometry.lane_reach(down);
        let beside = Lanes::max(limit, L::zero());
        for lane in ones((axis.le(beside) & face.le(limit)).bits() & triangles.valid) {
            let front = triangles.front.lane(lane);
            if self.fronts[..self.count.min(8)].iter().all(|other| other.dot(front) < ONE_MANIFOLD_COSINE) {
                if let Some(place) = self.fronts.get_mut(self.count) {
                    *place = front;
                }
                self.count += 1;
            }
        }
    }

    /// The box, in the mesh's frame, around all that is level with a near triangle and below the shape by no
    /// more than a margin; `None` if the near triangles have too many normals. `close`: the box around the
    /// shape.
    pub(crate) fn extent(&self, pose: &Pose, close: Extent, margin: f32) -> Option<Extent> {
        let fronts = self.fronts.get(..self.count)?;
        let (mut min, mut max) = close;
        for front in fronts {
            let down = pose.inverse().direction(*front * -margin);
            (min, max) = (min.min(close.0 + down), max.max(close.1 + down));
        }
        // Level is not quite parallel.
        let aside = Vec3::splat(ONE_MANIFOLD_SINE * margin);
        Some((min - aside, max + aside))
    }

    /// How near each of eight triangles has to be to count [m].
    #[inline(always)]
    pub(crate) fn margins<L: Lanes>(
        &self,
        triangles: &Triangles<L>,
        Reach { margin, within, path }: Reach,
    ) -> L {
        let (all, near) = (L::splat(margin), L::splat(within));
        if self.count == 0 || self.count > self.fronts.len() {
            return all + Lanes::max(-triangles.front.dot(LaneVec3::splat(path)), L::zero());
        }
        let level = L::splat(ONE_MANIFOLD_COSINE);
        let mut margins = near;
        for front in &self.fronts[..self.count] {
            margins = Lanes::select(triangles.front.dot(LaneVec3::splat(*front)).ge(level), all, margins);
        }
        margins
    }
}

/// The box, in the mesh's frame, around a shape that moves by `path` in its own [m]. `None` if that is far:
/// the box would contain much that is nowhere near the path.
pub(crate) fn extent_of(a: &Collider, rel: &Relative, margin: f32, path: Vec3) -> Option<Extent> {
    let bounds = bounds(a)?;
    if path.length() > 2.0 * a.radius {
        return None;
    }
    let pose = Pose::new(rel.position, rel.rotation);
    Some(along(&pose, around(&pose, bounds.grown(margin)), path))
}

/// A box of the mesh's frame, extended by a displacement in the shape's frame.
pub(crate) fn along(pose: &Pose, (min, max): Extent, path: Vec3) -> Extent {
    let path = pose.inverse().direction(path);
    (min + path.min(Vec3::ZERO), max + path.max(Vec3::ZERO))
}

/// The box of the mesh's frame around a box of the shape's frame.
pub(crate) fn around(pose: &Pose, Bounds { middle, half }: Bounds) -> Extent {
    let middle = pose.inverse().point(middle);
    let m = pose.axes;
    let half = Vec3::new(m.x_axis.abs().dot(half), m.y_axis.abs().dot(half), m.z_axis.abs().dot(half));
    // A millionth of the coordinates covers their rounding.
    let half = half + Vec3::splat(1e-6 * middle.abs().max_element());
    (middle - half, middle + half)
}

/// The point of a shape that tells on which side of a surface it belongs: the body's centre of mass, which
/// never crosses static geometry ([`guard`](crate::finish)), if this shape contains it; otherwise the shape's
/// own centre.
pub(crate) fn side_of(a: &Collider) -> Vec3 {
    let of_mass = -(a.rotation.conjugate() * a.position);
    if a.geometry.holds(of_mass) {
        return of_mass;
    }
    match &a.geometry {
        Geometry::Hull(hull) => hull.centre,
        _ => Vec3::ZERO,
    }
}

/// The box around a shape, in its own frame [m].
#[derive(Clone, Copy, Debug)]
pub(crate) struct Bounds {
    pub(crate) middle: Vec3,
    /// Half extents.
    pub(crate) half: Vec3,
}

impl Bounds {
    /// The box around a ball at the origin.
    pub(crate) fn of_ball(radius: f32) -> Bounds {
        Bounds { middle: Vec3::ZERO, half: Vec3::splat(radius) }
    }
    #[inline(always)]
    pub(crate) fn grown(self, margin: f32) -> Bounds {
        Bounds { half: self.half + Vec3::splat(margin), ..self }
    }
}

/// The box around a convex shape.
pub(crate) fn bounds(a: &Collider) -> Option<Bounds> {
    let (min, max) = a.kind.is_convex().then(|| a.geometry.aabb())?;
    Some(Bounds { middle: (min + max) * 0.5, half: (max - min) * 0.5 })
}
