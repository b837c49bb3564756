//! The kinds of shape, and the properties by which stages distinguish them.

use std::ops::Range;

/// The kinds of shape, in the order that fixes which of a pair is `a`: the lower kind, then the lower index.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
#[repr(u8)]
pub(crate) enum Kind {
    Sphere,
    Capsule,
    Box,
    Cylinder,
    Hull,
    Plane,
    Mesh,
    HeightField,
}

/// Symmetry of a shape under rotation.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Symmetry {
    /// It is the same however it turns.
    Ball,
    /// It is the same however it turns about its y axis.
    Axis,
    None,
}

impl Kind {
    /// How many there are.
    pub(crate) const COUNT: u8 = Kind::HeightField as u8 + 1;

    /// Convex and bounded: may be on a dynamic body.
    #[inline]
    pub(crate) fn is_convex(self) -> bool {
        self <= Kind::Hull
    }

    /// Made of triangles.
    #[inline]
    pub(crate) fn is_ground(self) -> bool {
        self >= Kind::Mesh
    }

    #[inline]
    pub(crate) fn symmetry(self) -> Symmetry {
        match self {
            Kind::Sphere => Symmetry::Ball,
            Kind::Capsule | Kind::Cylinder => Symmetry::Axis,
            _ => Symmetry::None,
        }
    }

    /// Round somewhere: it may roll.
    #[inline]
    pub(crate) fn is_round(self) -> bool {
        self.symmetry() != Symmetry::None
    }

    /// Without edges and corners, wherever it is touched.
    #[inline]
    pub(crate) fn is_smooth(self) -> bool {
        matches!(self, Kind::Sphere | Kind::Capsule)
    }

    /// All flat faces and straight edges.
    pub(crate) fn is_polytope(self) -> bool {
        matches!(self, Kind::Box | Kind::Hull)
    }

    /// The axes of its own frame along which faces look, as a range of x, y and z; those of a hull are its
    /// own.
    pub(crate) fn face_axes(self) -> Range<usize> {
        match self {
            Kind::Box => 0..3,
            Kind::Cylinder => 1..2,
            _ => 0..0,
        }
    }

    /// The axes along which straight edges or sides run. Those of a hull are too many.
    pub(crate) fn edge_axes(self) -> Range<usize> {
        match self {
            Kind::Box => 0..3,
            Kind::Capsule | Kind::Cylinder => 1..2,
            _ => 0..0,
        }
    }

    /// The most points that one such shape leaves of a manifold; zero for those whose manifolds are never
    /// renewed but exchanged.
    pub(crate) fn most_points(self) -> usize {
        match self {
            Kind::Sphere => 1,
            Kind::Capsule => 2,
            Kind::Mesh | Kind::HeightField => 0,
            _ => usize::MAX,
        }
    }
}
