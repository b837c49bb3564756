//! Convex hulls.

/// A convex hull, shared by the shapes that use it.
#[derive(Clone, Debug)]
pub struct ConvexHull {}
