//! Convex shapes as support functions: a core with a radius around it.

use crate::lanes::{Lanes, Vec3 as LaneVec3, f32x8};
use crate::shape::ConvexHull;
use glam::{DMat3, DQuat, DVec3, Vec3};

/// A convex shape for [`gjk`](crate::narrow_phase::convex::gjk) and [`cast`](crate::narrow_phase::cast): a
/// core, and a ball of `radius` that is swept over it.
///
/// In `f64`: all of this is scalar code, where doubles cost as much as floats, and it spares the simplex the
/// cancellation that decides whether faces that lie flat on each other are apart.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Support<'a> {
    pub(in crate::shape) core: Core<'a>,
    /// Distance of the surface from the core [m].
    pub(crate) radius: f64,
}

#[derive(Clone, Copy, Debug)]
pub(in crate::shape) enum Core<'a> {
    Point,
    /// On the y axis, to both sides of the origin.
    Segment {
        half: f64,
    },
    /// The hull of two balls on the y axis, one of radius zero: a tapered capsule less its smaller radius.
    Tapered {
        half: f64,
        bottom: f64,
        top: f64,
    },
    Box(DVec3),
    /// The hull of two discs around the y axis.
    Frustum {
        half: f64,
        bottom: f64,
        top: f64,
    },
    Hull(&'a ConvexHull),
    Triangle([DVec3; 3]),
}

/// Pose of one shape in the frame of another.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Pose {
    pub(crate) rotation: DMat3,
    pub(crate) position: DVec3,
}

impl Support<'_> {
    /// Its own origin.
    pub(crate) fn point() -> Support<'static> {
        Support { core: Core::Point, radius: 0.0 }
    }

    pub(crate) fn triangle(corners: [Vec3; 3]) -> Support<'static> {
        Support { core: Core::Triangle(corners.map(Vec3::as_dvec3)), radius: 0.0 }
    }

    /// The point of the core that is furthest along `d`, which needs no length. Where a whole face is, any of
    /// it.
    #[inline]
    pub(crate) fn support(&self, d: DVec3) -> DVec3 {
        match &self.core {
            Core::Point => DVec3::ZERO,
            Core::Segment { half } => DVec3::new(0.0, half.copysign(d.y), 0.0),
            Core::Tapered { half, bottom, top } => {
                let length = d.length();
                let (low, high) = (bottom * length - d.y * half, top * length + d.y * half);
                let (y, r) = if high > low { (*half, *top) } else { (-*half, *bottom) };
                let ball = if length > 0.0 { d * (r / length) } else { DVec3::ZERO };
                DVec3::new(ball.x, ball.y + y, ball.z)
            }
            Core::Box(half) => DVec3::new(half.x.copysign(d.x), half.y.copysign(d.y), half.z.copysign(d.z)),
            Core::Frustum { half, bottom, top } => {
                let across = (d.x * d.x + d.z * d.z).sqrt();
                let (low, high) = (bottom * across - d.y * half, top * across + d.y * half);
                let (y, r) = if high > low { (*half, *top) } else { (-*half, *bottom) };
                // Straight along the axis the middle of the disc will do: it ends the search at once.
                let r = if across > 0.0 { r / across } else { 0.0 };
                DVec3::new(r * d.x, y, r * d.z)
            }
            Core::Hull(hull) => furthest_vertex(hull, d.as_vec3()).as_dvec3(),
            Core::Triangle([a, b, c]) => {
                let (da, db, dc) = (a.dot(d), b.dot(d), c.dot(d));
                if da >= db && da >= dc {
                    *a
                } else if db >= dc {
                    *b
                } else {
                    *c
                }
            }
        }
    }

    /// Whether turning it around its own y axis changes nothing.
    pub(crate) fn is_round(&self) -> bool {
        matches!(self.core, Core::Point | Core::Segment { .. } | Core::Tapered { .. } | Core::Frustum { .. })
    }

    /// An upper bound of the distance of the core's points from the line along the unit vector `axis` through
    /// the origin [m], with the shape turned by `rotation` and its frame at `lever`.
    pub(crate) fn reach(&self, axis: DVec3, rotation: DQuat, lever: DVec3) -> f64 {
        let (axis, lever) = (rotation.conjugate() * axis, rotation.conjugate() * lever);
        let of = |local: DVec3| axis.cross(local + lever).length();
        let ends =
            |half: f64, bottom: f64, top: f64| (of(DVec3::Y * half) + top).max(of(DVec3::Y * -half) + bottom);
        match &self.core {
            Core::Point => of(DVec3::ZERO),
            Core::Segment { half } => ends(*half, 0.0, 0.0),
            Core::Tapered { half, bottom, top } | Core::Frustum { half, bottom, top } => {
                ends(*half, *bottom, *top)
            }
            Core::Box(h) => {
                // Opposite corners are equally far from an axis through the middle.
                let corners =
                    [*h, DVec3::new(-h.x, h.y, h.z), DVec3::new(h.x, -h.y, h.z), DVec3::new(h.x, h.y, -h.z)];
                let across = |c: &DVec3| axis.cross(*c).length_squared();
                corners.iter().map(across).fold(0.0, f64::max).sqrt() + axis.cross(lever).length()
            }
            Core::Hull(hull) => furthest_across(hull, axis, lever),
            Core::Triangle(corners) => corners.iter().map(|&v| of(v)).fold(0.0, f64::max),
        }
    }

    /// Half extents of a box around the origin, in axes that are turned by `rotation` from the shape's, that
    /// contains the shape with its radius [m].
    pub(crate) fn half_extents(&self, rotation: DMat3) -> DVec3 {
        let (x, y, z) = (rotation.x_axis.abs(), rotation.y_axis.abs(), rotation.z_axis.abs());
        match &self.core {
            Core::Point => return DVec3::splat(self.radius),
            Core::Segment { half } => return y * *half + self.radius,
            Core::Box(half) => return x * half.x + y * half.y + z * half.z + self.radius,
            Core::Hull(hull) => return hull_half_extents(hull, rotation) + self.radius,
            _ => {}
        }
        let to_local = rotation.transpose();
        let along = |axis: DVec3| {
            let local = to_local * axis;
            self.support(local).dot(local).max(-self.support(-local).dot(local)) + self.radius
        };
        DVec3::new(along(DVec3::X), along(DVec3::Y), along(DVec3::Z))
    }
}

// Rounding: of bounds that must not be too small.
/// Rounding of `f32` in bounds that must not be too small.
const UP: f64 = 1.0 + 1e-6;

/// The most that vertices, moved by `lever`, are away from the line along `axis` through the origin [m].
fn furthest_across(hull: &ConvexHull, axis: DVec3, lever: DVec3) -> f64 {
    let axis = LaneVec3::<f32x8>::splat(axis.as_vec3());
    let lever = LaneVec3::splat(lever.as_vec3());
    let most = hull.vertex_chunks.iter().fold(f32x8::splat(0.0), |most, chunk| {
        Lanes::max(most, axis.cross(vertices(chunk) + lever).length_squared())
    });
    f64::from(most.to_array().into_iter().fold(0.0, f32::max)).sqrt() * UP
}

/// See [`Support::half_extents`].
fn hull_half_extents(hull: &ConvexHull, rotation: DMat3) -> DVec3 {
    let rows = rotation
        .transpose()
        .to_cols_array_2d()
        .map(|row| LaneVec3::<f32x8>::splat(DVec3::from(row).as_vec3()));
    let zero = f32x8::splat(0.0);
    let most = hull.vertex_chunks.iter().fold([zero; 3], |most, chunk| {
        let at = vertices(chunk);
        std::array::from_fn(|k| Lanes::max(most[k], rows[k].dot(at).abs()))
    });
    DVec3::from(most.map(|lanes| f64::from(lanes.to_array().into_iter().fold(0.0, f32::max)))) * UP
}

/// Eight vertices.
#[inline(always)]
pub(crate) fn vertices([x, y, z]: &[[f32; 8]; 3]) -> LaneVec3<f32x8> {
    LaneVec3::new(f32x8::new(*x), f32x8::new(*y), f32x8::new(*z))
}

/// The vertex furthest along `d`, eight at a time; among equals the first of the lowest lane, on every
/// target.
fn furthest_vertex(hull: &ConvexHull, d: Vec3) -> Vec3 {
    let (dx, dy, dz) = (f32x8::splat(d.x), f32x8::splat(d.y), f32x8::splat(d.z));
    let mut best = f32x8::splat(f32::NEG_INFINITY);
    let mut chunk_of = f32x8::splat(0.0);
    for (i, [x, y, z]) in hull.vertex_chunks.iter().enumerate() {
        let value = f32x8::new(*x) * dx + f32x8::new(*y) * dy + f32x8::new(*z) * dz;
        let better = Lanes::gt(value, best);
        best = <f32x8 as Lanes>::select(better, value, best);
        chunk_of = <f32x8 as Lanes>::select(better, f32x8::splat(i as f32), chunk_of);
    }
    let (values, chunks) = (best.to_array(), chunk_of.to_array());
    let mut lane = 0;
    for i in 1..8 {
        if values[i] > values[lane] {
            lane = i;
        }
    }
    match hull.vertex_chunks.get(chunks[lane] as usize) {
        Some([x, y, z]) => Vec3::new(x[lane], y[lane], z[lane]),
        None => Vec3::ZERO,
    }
}
