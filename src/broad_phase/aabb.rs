//! Axis-aligned boxes.

use glam::Vec3;

// Guard: keeps products of two lengths far from overflow.
/// Boxes with a coordinate beyond this are taken for unbounded; motions are cut to it [m]. Products of two
/// lengths stay far from overflow.
pub(super) const LARGEST: f32 = 1e15;

/// An axis-aligned box in world coordinates, rounded outwards [m].
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Aabb {
    pub(crate) min: Vec3,
    pub(crate) max: Vec3,
}

impl Aabb {
    /// Holds nothing, touches nothing.
    pub(crate) const EMPTY: Aabb = Aabb { min: Vec3::INFINITY, max: Vec3::NEG_INFINITY };

    /// Whether two boxes have a point in common.
    #[inline]
    pub(crate) fn overlaps(&self, other: &Aabb) -> bool {
        (self.min.cmple(other.max) & self.max.cmpge(other.min)).all()
    }

    /// Whether the other box is inside.
    #[inline]
    #[cfg(test)]
    pub(crate) fn contains(&self, other: &Aabb) -> bool {
        (self.min.cmple(other.min) & self.max.cmpge(other.max)).all()
    }

    #[inline]
    pub(super) fn union(&self, other: &Aabb) -> Aabb {
        Aabb { min: self.min.min(other.min), max: self.max.max(other.max) }
    }

    /// Half the area [m²]; 0 if empty.
    #[inline]
    pub(super) fn half_area(&self) -> f32 {
        let d = (self.max - self.min).max(Vec3::ZERO);
        d.x * d.y + d.y * d.z + d.z * d.x
    }

    pub(super) fn is_bounded(&self) -> bool {
        let largest = Vec3::splat(LARGEST);
        (self.min.abs().cmple(largest) & self.max.abs().cmple(largest)).all()
    }
}
