//! Shapes: what a body looks like to a contact.
//!
//! Every shape answers for its mass, bounds and features. A convex one is, to the narrow phase, a few points
//! with a radius (sphere, capsule) or a polytope (box, cylinder, hull); see `narrow_phase`.

#[cfg(feature = "bake")]
mod baked;
mod collider;
mod corners;
mod extent;
mod flags;
mod four_tree;
mod height_field;
mod hull;
mod mass;
mod material;
pub(crate) mod mesh;
mod scaled;
mod slabs;
#[cfg(feature = "serde")]
mod stored;
mod stream;
mod surfaces;

pub(crate) use collider::{Collider, ColliderSummary, Kind};
pub(crate) use corners::Corners;
pub(crate) use flags::{BELT, EVENTS, HOOKS, IDLE_DAMPING, RARE, ROLLS, SENSOR, SOFT, STATICS};
pub(crate) use four_tree::{FourTree, LEAF, NONE};
pub use height_field::HeightField;
pub(crate) use height_field::edit::{HolePatch, Patch};
pub use hull::ConvexHull;
pub(crate) use hull::HullEdge;
pub use mass::MassProperties;
pub(crate) use material::{BaseMaterial, RareMaterial};
pub use material::{Combine, Material};
pub use mesh::TriangleMesh;
pub(crate) use mesh::edges::{Edges, Fold};
pub(crate) use mesh::rays::TriangleRays;
pub(crate) use slabs::{Near, Slabs, boxes_meet, path_hits_boxes};
#[cfg(feature = "replay")]
pub(crate) use stored::{StoredField, StoredHull, StoredMesh};
pub(crate) use stream::{RAYS, Stream, Walk};
pub(crate) use surfaces::Surfaces;

use crate::config::with_fields;
use crate::error::Error;
use crate::limits::{self, length, length_or_zero, unit_quat};
use glam::Vec3;
use mesh::segment_triangle::SegmentTest;
use std::sync::Arc;

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
    pub fn capsule(half_height: f32, radius: f32) -> Self {
        Geometry::Capsule { half_height, radius_bottom: radius, radius_top: radius }
    }
    /// A cylinder of one radius.
    pub fn cylinder(half_height: f32, radius: f32) -> Self {
        Geometry::Cylinder { half_height, radius_bottom: radius, radius_top: radius }
    }
    /// A box by its half extents.
    pub fn cuboid(x: f32, y: f32, z: f32) -> Self {
        Geometry::Box { half_extents: Vec3::new(x, y, z) }
    }

    /// The kind in words, for names and messages.
    pub fn kind_name(&self) -> &'static str {
        match self {
            Geometry::Sphere { .. } => "sphere",
            Geometry::Capsule { .. } => "capsule",
            Geometry::Box { .. } => "box",
            Geometry::Cylinder { .. } => "cylinder",
            Geometry::Hull(_) => "hull",
            Geometry::Plane => "plane",
            Geometry::Mesh(_) => "mesh",
            Geometry::HeightField(_) => "height field",
        }
    }

    /// What [`Collider::size`] holds.
    pub(crate) fn size(&self) -> [f32; 4] {
        match *self {
            Geometry::Sphere { radius } => [radius, 0.0, 0.0, 0.0],
            Geometry::Capsule { half_height, radius_bottom, radius_top }
            | Geometry::Cylinder { half_height, radius_bottom, radius_top } => {
                [half_height, radius_bottom, radius_top, 0.0]
            }
            Geometry::Box { half_extents } => [half_extents.x, half_extents.y, half_extents.z, 0.0],
            _ => [0.0; 4],
        }
    }

    /// Whether it is convex and bounded, so that a dynamic body may have it: all but planes, meshes and
    /// height fields.
    pub fn is_convex(&self) -> bool {
        self.require_convex().is_ok()
    }

    pub(crate) fn require_convex(&self) -> Result<(), Error> {
        let shape = match self {
            Geometry::Plane => "plane",
            Geometry::Mesh(_) => "triangle mesh",
            Geometry::HeightField(_) => "height field",
            _ => return Ok(()),
        };
        Err(Error::StaticOnly { shape })
    }

    /// Whether it is the same form, of the same numbers or sharing the same hull, mesh or field.
    pub(crate) fn is_same(&self, other: &Geometry) -> bool {
        let key = |geometry: &Geometry| match *geometry {
            Geometry::Sphere { radius } => (0, [radius, 0.0, 0.0], std::ptr::null()),
            Geometry::Capsule { half_height, radius_bottom, radius_top } => {
                (1, [half_height, radius_bottom, radius_top], std::ptr::null())
            }
            Geometry::Box { half_extents } => (2, half_extents.to_array(), std::ptr::null()),
            Geometry::Cylinder { half_height, radius_bottom, radius_top } => {
                (3, [half_height, radius_bottom, radius_top], std::ptr::null())
            }
            Geometry::Hull(ref hull) => (4, [0.0; 3], Arc::as_ptr(hull).cast::<()>()),
            Geometry::Plane => (5, [0.0; 3], std::ptr::null()),
            Geometry::Mesh(ref mesh) => (6, [0.0; 3], Arc::as_ptr(mesh).cast()),
            Geometry::HeightField(ref field) => (7, [0.0; 3], Arc::as_ptr(field).cast()),
        };
        key(self) == key(other)
    }

    /// Checks every range.
    ///
    /// # Errors
    /// Names the first number that is out of range.
    pub fn validate(&self) -> Result<(), Error> {
        match self {
            Geometry::Sphere { radius } => length("sphere radius", *radius),
            Geometry::Capsule { half_height, radius_bottom, radius_top } => {
                length_or_zero("capsule half height", *half_height)?;
                length("capsule radius", *radius_bottom)?;
                length("capsule radius", *radius_top)
            }
            Geometry::Box { half_extents } => {
                half_extents.to_array().iter().try_for_each(|&x| length("box half extents", x))
            }
            Geometry::Cylinder { half_height, radius_bottom, radius_top } => {
                length("cylinder half height", *half_height)?;
                length_or_zero("cylinder radius", *radius_bottom)?;
                length_or_zero("cylinder radius", *radius_top)?;
                length("cylinder radius", radius_bottom.max(*radius_top))
            }
            Geometry::Hull(_) | Geometry::Plane | Geometry::Mesh(_) | Geometry::HeightField(_) => Ok(()),
        }
    }

    /// The materials of its parts, beside that of the shape.
    pub(crate) fn materials(&self) -> &[Material] {
        match self {
            Geometry::Mesh(mesh) => mesh.materials(),
            Geometry::HeightField(field) => field.materials(),
            _ => &[],
        }
    }

    /// Whether any of them resists rolling or moves; see [`RareMaterial::flags`].
    /// A part is asked itself whether it is soft.
    pub(crate) fn rare_flags(&self) -> u8 {
        self.materials().iter().fold(0, |flags, part| flags | part.rare().flags()) & (ROLLS | BELT)
    }

    /// Adds a ray by start and displacement [m], to be followed up to the fraction `most`.
    pub(crate) fn put_ray(&self, rays: &mut TriangleRays, ray: usize, from: Vec3, path: Vec3, most: f32) {
        // Without a length it meets no triangle.
        let Some(test) = SegmentTest::along(from, path) else { return };
        match self {
            Geometry::Mesh(mesh) => rays.stream.put(ray, mesh.slabs(from, path), most),
            Geometry::HeightField(field) => rays.paths[ray] = field.path(from, from + path, Vec3::ZERO),
            _ => return,
        }
        (rays.tests[ray], rays.nearest[ray]) = (test, (most, u32::MAX));
        rays.rays |= 1 << ray;
    }

    /// Looks for what they meet.
    pub(crate) fn cast_rays(&self, rays: &mut TriangleRays) {
        match self {
            Geometry::Mesh(mesh) => mesh.rays(rays),
            Geometry::HeightField(field) => field.rays(rays),
            _ => {}
        }
    }
}

/// Which pairs collide. Two shapes do when each one's mask has the other's category and, if both are of a
/// group other than 0, the groups differ or are positive (equal negative groups never collide, equal positive
/// ones always).
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[cfg_attr(
    feature = "serde",
    derive(serde::Serialize, serde::Deserialize),
    serde(default, deny_unknown_fields)
)]
#[non_exhaustive]
pub struct Filter {
    /// Bits that this shape is. Default: bit 0.
    pub category: u64,
    /// Bits that this shape collides with. Default: all.
    pub mask: u64,
    /// See the type. Default 0.
    pub group: i32,
}

impl Default for Filter {
    fn default() -> Self {
        Filter { category: 1, mask: u64::MAX, group: 0 }
    }
}

with_fields! {
    Filter { with_category(category: u64), with_mask(mask: u64), with_group(group: i32) }
}

impl Filter {
    /// Whether two shapes collide.
    pub fn allows(&self, other: &Filter) -> bool {
        if self.group != 0 && self.group == other.group {
            return self.group > 0;
        }
        self.mask & other.category != 0 && other.mask & self.category != 0
    }
}

/// A shape to be put on a body.
///
/// With the feature `serde` all but the geometry may be left out where it is the default. Geometry that
/// shapes share is written with each of them.
#[derive(Clone, Debug)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize), serde(deny_unknown_fields))]
#[non_exhaustive]
pub struct ShapeDesc {
    /// Its form.
    pub geometry: Geometry,
    /// Where its frame is in the body's [m], within 1e6 along each axis.
    #[cfg_attr(feature = "serde", serde(default))]
    pub position: Vec3,
    /// How its frame is turned in the body's.
    #[cfg_attr(feature = "serde", serde(default))]
    pub rotation: glam::Quat,
    /// Density [kg/m³], 0..=1e15; zero adds no mass. Default 1000.
    #[cfg_attr(feature = "serde", serde(default = "ShapeDesc::default_density"))]
    pub density: f32,
    /// Friction, restitution, and whether the surface moves.
    #[cfg_attr(feature = "serde", serde(default))]
    pub material: Material,
    /// Which shapes it collides with.
    #[cfg_attr(feature = "serde", serde(default))]
    pub filter: Filter,
    /// It pushes nothing, and notices what comes into it:
    /// [`World::sensor_begins`](crate::World::sensor_begins). Convex or a plane; it notices convex shapes of
    /// bodies that move, of other bodies than its own, that its filter allows and that are no sensors.
    /// Default no.
    #[cfg_attr(feature = "serde", serde(default))]
    pub sensor: bool,
    /// As a sensor it also notices shapes of static bodies, and the surfaces of meshes and height fields,
    /// which are not convex; a plane notices none of the latter. Without effect while it is no sensor.
    /// Default no.
    #[cfg_attr(feature = "serde", serde(default))]
    pub senses_static: bool,
    /// Contacts of it are heard of: [`World::contact_begins`](crate::World::contact_begins). Default no.
    #[cfg_attr(feature = "serde", serde(default))]
    pub events: bool,
    /// Contacts of it are shown to [`ContactHooks`](crate::ContactHooks). Default no.
    #[cfg_attr(feature = "serde", serde(default))]
    pub hooks: bool,
    /// Free for the caller.
    #[cfg_attr(feature = "serde", serde(default))]
    pub user_data: u64,
}

with_fields! {
    ShapeDesc {
        with_geometry(geometry: Geometry),
        with_position(position: into Vec3),
        with_rotation(rotation: into glam::Quat),
        with_density(density: f32),
        with_material(material: Material),
        with_filter(filter: Filter),
        with_sensor(sensor: bool),
        with_senses_static(senses_static: bool),
        with_user_data(user_data: u64),
    }
}

impl ShapeDesc {
    /// A shape at the body's origin with default material, filter and density.
    pub fn new(geometry: Geometry) -> Self {
        ShapeDesc {
            geometry,
            position: Vec3::ZERO,
            rotation: glam::Quat::IDENTITY,
            density: Self::default_density(),
            material: Material::default(),
            filter: Filter::default(),
            sensor: false,
            senses_static: false,
            events: false,
            hooks: false,
            user_data: 0,
        }
    }

    /// That of water.
    pub(crate) fn default_density() -> f32 {
        1000.0
    }

    /// Pushes nothing, and notices what comes into it.
    pub fn sensing(self) -> Self {
        ShapeDesc { sensor: true, ..self }
    }
    /// Contacts of it are heard of.
    pub fn with_events(self) -> Self {
        ShapeDesc { events: true, ..self }
    }
    /// Contacts of it are shown to hooks.
    pub fn with_hooks(self) -> Self {
        ShapeDesc { hooks: true, ..self }
    }

    pub(crate) fn flags(&self) -> u8 {
        let asks = [
            (self.sensor, SENSOR),
            (self.events, EVENTS),
            (self.hooks, HOOKS),
            (self.senses_static, STATICS),
        ];
        asks.into_iter().map(|(set, bit)| if set { bit } else { 0 }).sum::<u8>()
            | self.material.rare().flags()
            | self.geometry.rare_flags()
    }

    /// Checks every range.
    ///
    /// # Errors
    /// Names the first number that is out of range, or a sensor that is not convex.
    pub fn validate(&self) -> Result<(), Error> {
        self.geometry.validate()?;
        self.material.validate()?;
        if self.sensor && !matches!(self.geometry, Geometry::Plane) {
            self.geometry.require_convex()?;
        }
        limits::offset("shape position", self.position)?;
        unit_quat("shape rotation", self.rotation)?;
        limits::density(self.density)
    }
}
