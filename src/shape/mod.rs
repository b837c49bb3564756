//! Shapes: the form and material of a body for contacts.
//!
//! Every shape answers for its mass, bounds and features, in a file of its own (`forms/`): see `Form`. A
//! convex one is, to the narrow phase, a few points with a radius (sphere, capsule) or a polytope (box,
//! cylinder, hull); see `narrow_phase`.

#[cfg(feature = "bake")]
mod baked;
mod collider;
mod corners;
mod decomposition;
mod flags;
mod forms;
mod four_tree;
mod geometry;
mod ground;
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

pub(crate) use collider::{Collider, ColliderSummary};
pub(crate) use corners::Corners;
pub use decomposition::{Decomposition, Pieces};
pub(crate) use flags::{BELT, EVENTS, HOOKS, IDLE_DAMPING, RARE, ROLLS, SENSOR, SOFT, STATICS};
pub(crate) use forms::{Frustum, Kind, NearPoint, Symmetry, outline, support};
pub(crate) use four_tree::{FourTree, LEAF, NONE};
pub use geometry::{Geometry, GeometryKey};
pub(crate) use ground::Ground;
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
pub(crate) use slabs::{Near, Slabs, boxes_meet, path_hits_boxes, path_in_box};
#[cfg(feature = "replay")]
pub(crate) use stored::{StoredField, StoredHull, StoredMesh};
pub(crate) use stream::{RAYS, Stream, Walk};
pub(crate) use surfaces::Surfaces;

use crate::config::fields;
use crate::error::Error;
use crate::limits::{self, unit_quat};
use glam::Vec3;

fields! {
    /// Which pairs collide. Two shapes do when each one's mask has the other's category and, if both are of a
    /// group other than 0, the groups differ or are positive (equal negative groups never collide, equal
    /// positive ones always).
    #[derive(Clone, Copy, Debug, PartialEq, Eq)]
    #[cfg_attr(
        feature = "serde",
        derive(serde::Serialize, serde::Deserialize),
        serde(default, deny_unknown_fields)
    )]
    #[non_exhaustive]
    pub struct Filter {
        /// Bits that this shape is.
        with_category(category: u64) = 1;
        /// Bits that this shape collides with.
        with_mask(mask: u64) = u64::MAX;
        /// See the type.
        with_group(group: i32) = 0;
    }
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
///
/// ```
/// use backstop::{Geometry, Material, ShapeDesc};
///
/// // A rubber ball of a tenth of a metre.
/// let rubber = Material::default().with_friction(0.9).with_restitution(0.8);
/// let ball = ShapeDesc::new(Geometry::Sphere { radius: 0.1 }).with_material(rubber).with_density(1100.0);
/// assert_eq!(ball.material.restitution, 0.8);
/// ```
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
    /// It pushes nothing, and notices shapes that enter it:
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

fields! {
    ShapeDesc {
        with_geometry(geometry: Geometry),
        with_position(position: Vec3, into),
        with_rotation(rotation: glam::Quat, into),
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

    /// Pushes nothing, and notices shapes that enter it.
    pub fn as_sensor(self) -> Self {
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
