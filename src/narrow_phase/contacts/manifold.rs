//! Contact manifolds: output of the kernels.

use crate::narrow_phase::relative::Relative;
use crate::shape::Kind;
use bytemuck::{Pod, Zeroable};
use glam::Vec3;

/// Most points of a manifold.
pub(crate) const MAX_POINTS: usize = 4;

/// The most points that a manifold of two shapes has, but for rare ones of capsules; zero for meshes and
/// height fields, whose contacts are never renewed but exchanged.
pub(crate) fn most_points(a: Kind, b: Kind) -> usize {
    a.most_points().min(b.most_points()).min(MAX_POINTS)
}

/// A point of a manifold, in the frame of shape `a`.
#[derive(Clone, Copy, Debug, Default, PartialEq, Pod, Zeroable)]
#[repr(C)]
pub(crate) struct RawPoint {
    /// Midway between the two surfaces [m].
    pub(crate) position: Vec3,
    /// Distance along the normal, negative in overlap [m]. Positive: the point is potential.
    pub(crate) separation: f32,
    /// Says which features meet; equal between steps while the same features meet.
    pub(crate) key: u32,
}

/// Result of a kernel for a pair: all points nearer than the margin, at most four.
#[derive(Clone, Copy, Debug, Default, PartialEq, Pod, Zeroable)]
#[repr(C)]
pub(crate) struct RawManifold {
    /// Unit, from `a` to `b`, in the frame of shape `a`.
    pub(crate) normal: Vec3,
    pub(crate) count: u16,
    /// Number of the material of `b` there; zero: the shape's own.
    pub(crate) material: u16,
    pub(crate) points: [RawPoint; MAX_POINTS],
}

impl RawManifold {
    pub(crate) fn points(&self) -> &[RawPoint] {
        &self.points[..self.count as usize]
    }

    /// Of two shapes that are further apart than the margin, and at least so far [m].
    pub(crate) fn apart(gap: f32) -> RawManifold {
        let mut none = RawManifold::default();
        none.points[0].separation = gap;
        none
    }

    /// The least distance of two shapes for which a kernel found no points [m]; zero if it does not know.
    pub(crate) fn gap(&self) -> f32 {
        if self.count == 0 { self.points[0].separation } else { 0.0 }
    }

    /// How many points it has.
    pub(crate) fn size(&self) -> u32 {
        self.count.into()
    }

    /// Leaves out the points that are furthest apart until there are so many; returns how many it left out.
    pub(crate) fn keep(&mut self, most: usize) -> u32 {
        let before = self.count;
        while self.count as usize > most {
            let furthest = (0..self.count as usize)
                .max_by(|&i, &k| self.points[i].separation.total_cmp(&self.points[k].separation));
            let from = furthest.unwrap_or(0);
            self.points[from..self.count as usize].rotate_left(1);
            self.count -= 1;
        }
        u32::from(before - self.count)
    }

    /// The least separation of its points [m]; `f32::MAX` without any.
    #[inline]
    pub(crate) fn least(&self) -> f32 {
        self.points().iter().map(|p| p.separation).fold(f32::MAX, f32::min)
    }

    /// Adds a point if there is room and it is nearer than the margin.
    #[inline]
    pub(crate) fn add(&mut self, margin: f32, position: Vec3, separation: f32, key: u32) {
        let count = self.count as usize;
        if separation <= margin && count < MAX_POINTS {
            self.points[count] = RawPoint { position, separation, key };
            self.count += 1;
        }
    }

    /// Keeps the points that `wanted` says, in their order.
    pub(crate) fn retain(&mut self, mut wanted: impl FnMut(&RawPoint) -> bool) {
        let mut kept = 0;
        for i in 0..self.count as usize {
            let point = self.points[i];
            if wanted(&point) {
                self.points[kept] = point;
                kept += 1;
            }
        }
        self.count = kept as u16;
    }

    /// The same contact seen from the other shape, whose pose in this one's frame is given.
    pub(crate) fn flipped(&self, Relative { position, rotation }: &Relative) -> RawManifold {
        let back = rotation.conjugate();
        let mut flipped = *self;
        flipped.normal = -(back * self.normal);
        for point in &mut flipped.points[..self.count as usize] {
            point.position = back * (point.position - *position);
        }
        flipped
    }
}
