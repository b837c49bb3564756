//! Geometry: the caller's description of a shape's form, and its kinds.

use super::flags::{BELT, ROLLS};
use super::forms::outline::{Line, Solid, Triangle, Window};
use super::forms::support::Support;
use super::forms::{Ball, Capsule, Cuboid, Entry, Form, Frustum, HalfSpace, Kind, NearPoint};
use super::ground::Ground;
use super::height_field::HeightField;
use super::hull::ConvexHull;
use super::mass::Moments;
use super::material::Material;
use super::mesh::TriangleMesh;
#[cfg(feature = "serde")]
use super::stored;
use crate::error::Error;
use crate::lanes::{Lanes, Vec3 as LaneVec3};
#[cfg(doc)]
use crate::limits;
use crate::math::Quat;
use glam::{DVec3, Vec3};
use std::sync::Arc;

/// Evaluates an expression with the form of a geometry: the only place that lists all forms. The expression
/// is compiled for each.
macro_rules! with_form {
    ($geometry:expr, $form:ident => $do:expr) => {
        match $geometry {
            &Geometry::Sphere { radius } => {
                let $form = Ball { radius };
                $do
            }
            &Geometry::Capsule { half_height, radius_bottom: bottom, radius_top: top } => {
                let $form = Capsule { half_height, bottom, top };
                $do
            }
            &Geometry::Box { half_extents: half } => {
                let $form = Cuboid { half };
                $do
            }
            &Geometry::Cylinder { half_height, radius_bottom: bottom, radius_top: top } => {
                let $form = Frustum { half_height, bottom, top };
                $do
            }
            Geometry::Hull(hull) => {
                let $form = &**hull;
                $do
            }
            Geometry::Plane => {
                let $form = HalfSpace;
                $do
            }
            Geometry::Mesh(mesh) => {
                let $form = &**mesh;
                $do
            }
            Geometry::HeightField(field) => {
                let $form = &**field;
                $do
            }
        }
    };
}

/// The form of a shape, in its own frame [m]. Lengths that are not zero lie in 1e-6..=1e6 ([`limits`]).
#[derive(Clone, Debug)]
#[cfg_attr(
    feature = "serde",
    derive(serde::Serialize, serde::Deserialize),
    serde(rename_all = "snake_case", deny_unknown_fields)
)]
#[non_exhaustive]
pub enum Geometry {
    /// A ball around the origin.
    Sphere {
        /// Radius, above zero.
        radius: f32,
    },
    /// The convex hull of two spheres on the y axis.
    Capsule {
        /// Half the distance between the two centres, at least zero.
        half_height: f32,
        /// Radius of the sphere at `-half_height`, above zero.
        radius_bottom: f32,
        /// Radius of the sphere at `+half_height`, above zero.
        radius_top: f32,
    },
    /// A box around the origin.
    Box {
        /// Half of each side, above zero.
        half_extents: Vec3,
    },
    /// A cylinder around the y axis, or a frustum if the radii differ.
    Cylinder {
        /// Half the height, above zero.
        half_height: f32,
        /// Radius at `-half_height`, at least zero (zero: a cone).
        radius_bottom: f32,
        /// Radius at `+half_height`, at least zero.
        radius_top: f32,
    },
    /// A convex hull.
    Hull(#[cfg_attr(feature = "serde", serde(with = "stored::shared"))] Arc<ConvexHull>),
    /// The half-space y <= 0; only static or kinematic.
    Plane,
    /// Triangles, from both sides; only static or kinematic.
    Mesh(#[cfg_attr(feature = "serde", serde(with = "stored::shared"))] Arc<TriangleMesh>),
    /// A grid of heights; only static or kinematic.
    HeightField(#[cfg_attr(feature = "serde", serde(with = "stored::shared"))] Arc<HeightField>),
}

impl Geometry {
    /// A ball around the origin.
    pub fn sphere(radius: f32) -> Self {
        Geometry::Sphere { radius }
    }
    /// A capsule whose ends differ.
    pub fn tapered_capsule(half_height: f32, radius_bottom: f32, radius_top: f32) -> Self {
        Geometry::Capsule { half_height, radius_bottom, radius_top }
    }
    /// A frustum around the y axis.
    pub fn tapered_cylinder(half_height: f32, radius_bottom: f32, radius_top: f32) -> Self {
        Geometry::Cylinder { half_height, radius_bottom, radius_top }
    }
    /// A cone around the y axis, with its tip up.
    pub fn cone(half_height: f32, radius: f32) -> Self {
        Geometry::tapered_cylinder(half_height, radius, 0.0)
    }
    /// A convex hull; an [`Arc`] of one can be shared by many shapes.
    pub fn hull(hull: impl Into<Arc<ConvexHull>>) -> Self {
        Geometry::Hull(hull.into())
    }
    /// The half-space y <= 0; only static or kinematic.
    pub fn plane() -> Self {
        Geometry::Plane
    }
    /// A triangle mesh; only static or kinematic.
    pub fn mesh(mesh: impl Into<Arc<TriangleMesh>>) -> Self {
        Geometry::Mesh(mesh.into())
    }
    /// A grid of heights; only static or kinematic.
    pub fn height_field(field: impl Into<Arc<HeightField>>) -> Self {
        Geometry::HeightField(field.into())
    }
    /// A capsule of one radius.
    ///
    /// ```
    /// # use backstop::{*, glam::{DVec3, Quat, Vec3}};
    /// // A person of 1.8 m.
    /// let person = Geometry::capsule(0.6, 0.3);
    /// assert!((person.radius() - 0.9).abs() < 1e-6);
    /// ```
    pub fn capsule(half_height: f32, radius: f32) -> Self {
        Geometry::Capsule { half_height, radius_bottom: radius, radius_top: radius }
    }
    /// A cylinder of one radius.
    pub fn cylinder(half_height: f32, radius: f32) -> Self {
        Geometry::Cylinder { half_height, radius_bottom: radius, radius_top: radius }
    }
    /// A box by its half extents.
    ///
    /// ```
    /// # use backstop::{*, glam::{DVec3, Quat, Vec3}};
    /// // Two metres wide, one high, four deep.
    /// let slab = Geometry::cuboid(1.0, 0.5, 2.0);
    /// ```
    pub fn cuboid(x: f32, y: f32, z: f32) -> Self {
        Geometry::Box { half_extents: Vec3::new(x, y, z) }
    }

    /// Those of a few numbers by their [`Form::CODE`](super::forms::Form).
    pub(crate) fn of_numbers(code: u32, [a, b, c, _]: [f32; 4]) -> Option<Geometry> {
        Some(match code {
            Ball::CODE => Geometry::sphere(a),
            Capsule::CODE => Geometry::tapered_capsule(a, b, c),
            Cuboid::CODE => Geometry::cuboid(a, b, c),
            Frustum::CODE => Geometry::tapered_cylinder(a, b, c),
            HalfSpace::CODE => Geometry::Plane,
            _ => return None,
        })
    }

    /// The kind in words, for names and messages.
    pub fn kind_name(&self) -> &'static str {
        with_form!(self, form => form.name())
    }

    /// Whether it is convex and bounded, so that a dynamic body may have it: all but planes, meshes and
    /// height fields.
    pub fn is_convex(&self) -> bool {
        Kind::of(self).is_convex()
    }

    pub(crate) fn require_convex(&self) -> Result<(), Error> {
        let shape = match self {
            Geometry::Mesh(_) => "triangle mesh",
            _ => self.kind_name(),
        };
        if self.is_convex() { Ok(()) } else { Err(Error::StaticOnly { shape }) }
    }

    /// Whether it is the same form, of the same numbers or sharing the same hull, mesh or field.
    pub(crate) fn is_same(&self, other: &Geometry) -> bool {
        let key = |geometry: &Geometry| (Kind::of(geometry), geometry.size(), geometry.address());
        key(self) == key(other)
    }

    /// Checks every range.
    ///
    /// # Errors
    /// Names the first number that is out of range.
    pub fn validate(&self) -> Result<(), Error> {
        with_form!(self, form => form.validate())
    }

    /// Its mesh or height field.
    #[inline]
    pub(crate) fn ground(&self) -> Option<Ground<'_>> {
        match self {
            Geometry::Mesh(mesh) => Some(Ground::Mesh(mesh)),
            Geometry::HeightField(field) => Some(Ground::Field(field)),
            _ => None,
        }
    }

    /// Largest distance of a point of the shape from its own origin [m]; infinite for a plane.
    pub fn radius(&self) -> f32 {
        with_form!(self, form => form.radius())
    }

    /// Radius of the largest ball around the shape's own origin that it contains [m]; zero if it doesn't
    /// contain its origin, and for planes, meshes and height fields.
    pub fn inner_radius(&self) -> f32 {
        with_form!(self, form => form.inner_radius())
    }

    /// The point of a convex, bounded shape that is furthest along a direction, which needs no length, in its
    /// own frame [m]. Where a whole face is, any of it. `None` for a plane, a mesh or a height field.
    pub fn furthest(&self, direction: DVec3) -> Option<DVec3> {
        let support = self.support()?;
        Some(support.support(direction) + direction.normalize_or_zero() * support.radius)
    }

    /// Whether any of its materials resists rolling or moves; see
    /// [`RareMaterial::flags`](super::RareMaterial::flags). A part is asked itself whether it is soft.
    pub(crate) fn rare_flags(&self) -> u8 {
        self.materials().iter().fold(0, |flags, part| flags | part.rare().flags()) & (ROLLS | BELT)
    }

    /// Equal for geometries that are the same: by their numbers, or because they share a hull, a mesh or a
    /// height field. A renderer can find its data of a geometry by the key, as long as the geometry is alive.
    pub fn key(&self) -> GeometryKey {
        let address = self.address().unwrap_or(0);
        GeometryKey { code: self.code(), numbers: self.size().map(f32::to_bits), address }
    }
}

/// The methods of `Form`, for a geometry.
macro_rules! by_form {
    ($($name:ident($($argument:ident: $type:ty),*) $(-> $answer:ty)?,)*) => {
        impl Geometry { $(
            /// See the method of `Form`.
            #[inline]
            pub(crate) fn $name(&self, $($argument: $type),*) $(-> $answer)? {
                with_form!(self, form => form.$name($($argument),*))
            }
        )* }
    };
}

by_form! {
    size() -> [f32; 4],
    code() -> u32,
    holds(point: Vec3) -> bool,
    aabb() -> (Vec3, Vec3),
    turned_bounds(rotation: Quat) -> (Vec3, Vec3),
    core_end() -> Vec3,
    moments() -> Moments,
    support() -> Option<Support<'_>>,
    enter(start: DVec3, path: DVec3, extra: f64) -> Option<Entry>,
    contains(at: DVec3) -> bool,
    nearest(at: DVec3) -> Option<NearPoint>,
    solid() -> Solid,
    triangles(window: Window, triangle: &mut Triangle<'_>),
    lines(window: Window, line: &mut Line<'_>),
    materials() -> &[Material],
    address() -> Option<usize>,
    bytes() -> (usize, usize),
    words(out: &mut Vec<u32>),
}

impl Geometry {
    /// See the method of `Form`.
    #[inline(always)]
    pub(crate) fn lane_support<L: Lanes>(&self, d: LaneVec3<L>) -> LaneVec3<L> {
        with_form!(self, form => form.lane_support(d))
    }

    /// See the method of `Form`.
    #[inline(always)]
    pub(crate) fn lane_reach<L: Lanes>(&self, d: LaneVec3<L>) -> L {
        with_form!(self, form => form.lane_reach(d))
    }
}

/// See [`Geometry::key`].
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub struct GeometryKey {
    code: u32,
    numbers: [u32; 4],
    address: usize,
}

impl Kind {
    #[inline]
    pub(crate) fn of(geometry: &Geometry) -> Kind {
        with_form!(geometry, form => form.kind())
    }
}
