//! Objects of `KHR_physics_rigid_bodies` and `KHR_implicit_shapes`, with their names; and properties without
//! names there, in the object `backstop` of their `extras`.

use backstop::Decomposition;
use serde::de::{DeserializeOwned, Deserializer, Error};
use serde::{Deserialize, Serialize};

pub(crate) const RIGID_BODIES: &str = "KHR_physics_rigid_bodies";
pub(crate) const SHAPES: &str = "KHR_implicit_shapes";

#[derive(Debug, Default, Deserialize)]
#[serde(default)]
pub(super) struct Shapes {
    pub(super) shapes: Vec<Shape>,
}

#[derive(Debug, Deserialize)]
pub(super) struct Shape {
    #[serde(rename = "type")]
    pub(super) kind: String,
    #[serde(default)]
    pub(super) sphere: Sphere,
    #[serde(default, rename = "box")]
    pub(super) cuboid: Cuboid,
    #[serde(default)]
    pub(super) capsule: Round,
    #[serde(default)]
    pub(super) cylinder: Round,
    #[serde(default)]
    pub(super) plane: Plane,
}

#[derive(Debug, Deserialize)]
#[serde(default)]
pub(super) struct Sphere {
    pub(super) radius: f32,
}

impl Default for Sphere {
    fn default() -> Self {
        Sphere { radius: 0.5 }
    }
}

#[derive(Debug, Deserialize)]
#[serde(default)]
pub(super) struct Cuboid {
    pub(super) size: [f32; 3],
}

impl Default for Cuboid {
    fn default() -> Self {
        Cuboid { size: [1.0; 3] }
    }
}

/// A capsule or a cylinder.
#[derive(Debug, Deserialize)]
#[serde(default, rename_all = "camelCase")]
pub(super) struct Round {
    pub(super) height: f32,
    pub(super) radius_bottom: f32,
    pub(super) radius_top: f32,
}

impl Default for Round {
    fn default() -> Self {
        Round { height: 0.5, radius_bottom: 0.25, radius_top: 0.25 }
    }
}

#[derive(Debug, Default, Deserialize)]
#[serde(default, rename_all = "camelCase")]
pub(super) struct Plane {
    pub(super) size_x: Option<f32>,
    pub(super) size_z: Option<f32>,
    pub(super) double_sided: bool,
}

/// The object `backstop` in the `extras` of an object, in which other programs may put anything.
fn own<'de, D: Deserializer<'de>, T: DeserializeOwned + Default>(from: D) -> Result<T, D::Error> {
    let extras = serde_json::Value::deserialize(from)?;
    let own = extras.get(OWN).map(T::deserialize).transpose();
    Ok(own.map_err(|e| D::Error::custom(format!("extras, {OWN}: {e}")))?.unwrap_or_default())
}

/// The name of our object in `extras`.
pub(crate) const OWN: &str = "backstop";

/// At the root of the file.
#[derive(Debug, Default, Deserialize)]
#[serde(default, rename_all = "camelCase")]
pub(super) struct Physics {
    pub(super) physics_joints: Vec<Joint>,
    pub(super) physics_materials: Vec<Material>,
    pub(super) collision_filters: Vec<Filter>,
    #[serde(deserialize_with = "own")]
    pub(super) extras: PhysicsExtras,
}

#[derive(Debug, Default, Deserialize)]
#[serde(default, deny_unknown_fields)]
pub(super) struct PhysicsExtras {
    pub(super) couplings: Vec<Coupling>,
}

/// A coupling of motions of joints, which are known by their nodes.
#[derive(Debug, Deserialize)]
#[serde(rename_all = "camelCase", deny_unknown_fields)]
pub(super) struct Coupling {
    pub(super) motions: [CoupledMotion; 2],
    /// Null is infinite.
    pub(super) range: Option<[Option<f64>; 2]>,
    #[serde(default)]
    pub(super) strength: [Option<f32>; 2],
    #[serde(default)]
    pub(super) user_data: u64,
}

#[derive(Debug, Deserialize)]
#[serde(rename_all = "camelCase", deny_unknown_fields)]
pub(super) struct CoupledMotion {
    pub(super) node: usize,
    pub(super) linear_axes: Option<Vec<usize>>,
    pub(super) angular_axes: Option<Vec<usize>>,
    pub(super) factor: f64,
}

#[derive(Debug, Deserialize)]
#[serde(default, rename_all = "camelCase")]
pub(super) struct Material {
    pub(super) static_friction: f32,
    pub(super) dynamic_friction: f32,
    pub(super) restitution: f32,
    pub(super) friction_combine: Option<Combine>,
    pub(super) restitution_combine: Option<Combine>,
    #[serde(deserialize_with = "own")]
    pub(super) extras: MaterialExtras,
}

/// As a file has it.
type Vec3 = [f32; 3];

macro_rules! extras {
    (base { $($base:tt)+ } rare { $(
        $(#[doc = $doc:literal])+
        $with:ident($field:ident: $kind:ty $(, $into:ident)?) = $default:expr
            $(, $what:literal $ends:tt $range:literal)?;
    )+ }) => {
        /// Rare properties of materials without names in the extension: the engine's own list.
        #[derive(Debug, Deserialize, Serialize)]
        #[serde(default, rename_all = "camelCase", deny_unknown_fields)]
        pub(crate) struct MaterialExtras { $($field: $kind),+ }

        impl MaterialExtras {
            pub(crate) fn of(material: &backstop::Material) -> Self {
                MaterialExtras { $($field: material.$field.into()),+ }
            }

            pub(super) fn on(&self, material: backstop::Material) -> backstop::Material {
                material$(.$with(self.$field))+
            }
        }
    };
}
backstop::material_fields!(extras);

impl Default for MaterialExtras {
    fn default() -> Self {
        MaterialExtras::of(&backstop::Material::default())
    }
}

impl Default for Material {
    fn default() -> Self {
        Material {
            static_friction: 0.6,
            dynamic_friction: 0.6,
            restitution: 0.0,
            friction_combine: None,
            restitution_combine: None,
            extras: MaterialExtras::default(),
        }
    }
}

#[derive(Clone, Copy, Debug, Deserialize)]
#[serde(rename_all = "lowercase")]
pub(super) enum Combine {
    Average,
    Minimum,
    Maximum,
    Multiply,
}

#[derive(Debug, Default, Deserialize)]
#[serde(default, rename_all = "camelCase")]
pub(super) struct Filter {
    pub(super) collision_systems: Vec<String>,
    pub(super) collide_with_systems: Option<Vec<String>>,
    pub(super) not_collide_with_systems: Option<Vec<String>>,
}

/// Limits and drives of joints.
#[derive(Debug, Default, Deserialize)]
#[serde(default)]
pub(super) struct Joint {
    pub(super) limits: Vec<Limit>,
    pub(super) drives: Vec<Motor>,
}

#[derive(Debug, Default, Deserialize)]
#[serde(default, rename_all = "camelCase")]
pub(super) struct Limit {
    pub(super) min: Option<f32>,
    pub(super) max: Option<f32>,
    pub(super) stiffness: Option<f32>,
    pub(super) damping: f32,
    pub(super) linear_axes: Option<Vec<usize>>,
    pub(super) angular_axes: Option<Vec<usize>>,
}

#[derive(Debug, Deserialize)]
#[serde(rename_all = "camelCase")]
pub(super) struct Motor {
    #[serde(rename = "type")]
    pub(super) kind: String,
    pub(super) mode: String,
    pub(super) axis: usize,
    pub(super) max_force: Option<f32>,
    #[serde(default)]
    pub(super) position_target: f32,
    #[serde(default)]
    pub(super) velocity_target: f32,
    #[serde(default)]
    pub(super) stiffness: f32,
    #[serde(default)]
    pub(super) damping: f32,
}

/// At a node.
#[derive(Debug, Default, Deserialize)]
#[serde(default)]
pub(super) struct NodePhysics {
    pub(super) motion: Option<Motion>,
    pub(super) collider: Option<Collider>,
    pub(super) trigger: Option<Trigger>,
    pub(super) joint: Option<NodeJoint>,
}

/// Which joint a node has, and with which other body.
#[derive(Debug, Deserialize)]
#[serde(rename_all = "camelCase")]
pub(super) struct NodeJoint {
    pub(super) connected_node: usize,
    pub(super) joint: usize,
    #[serde(default)]
    pub(super) enable_collision: bool,
}

#[derive(Debug, Default, Deserialize)]
#[serde(default, rename_all = "camelCase")]
pub(super) struct Motion {
    pub(super) is_kinematic: bool,
    pub(super) mass: Option<f32>,
    pub(super) center_of_mass: Option<[f32; 3]>,
    pub(super) inertia_diagonal: Option<[f32; 3]>,
    pub(super) inertia_orientation: Option<[f32; 4]>,
    pub(super) linear_velocity: [f32; 3],
    pub(super) angular_velocity: [f32; 3],
    pub(super) gravity_factor: Option<f32>,
    #[serde(deserialize_with = "own")]
    pub(super) extras: MotionExtras,
}

#[derive(Debug, Default, Deserialize)]
#[serde(default, rename_all = "camelCase", deny_unknown_fields)]
pub(super) struct MotionExtras {
    pub(super) max_linear_speed: Option<f32>,
    pub(super) max_angular_speed: Option<f32>,
    pub(super) linear_damping: f32,
    pub(super) angular_damping: f32,
}

#[derive(Debug, Deserialize)]
#[serde(rename_all = "camelCase")]
pub(super) struct Collider {
    pub(super) geometry: Geometry,
    pub(super) physics_material: Option<usize>,
    pub(super) collision_filter: Option<usize>,
}

/// One shape, or the nodes that have one each.
#[derive(Debug, Default, Deserialize)]
#[serde(default, rename_all = "camelCase")]
pub(super) struct Trigger {
    pub(super) geometry: Option<Geometry>,
    pub(super) collision_filter: Option<usize>,
}

#[derive(Debug, Default, Deserialize)]
#[serde(default, rename_all = "camelCase")]
pub(super) struct Geometry {
    pub(super) shape: Option<usize>,
    pub(super) node: Option<usize>,
    pub(super) convex_hull: bool,
    #[serde(deserialize_with = "own")]
    pub(super) extras: GeometryExtras,
}

#[derive(Debug, Default, Deserialize)]
#[serde(default, deny_unknown_fields)]
pub(super) struct GeometryExtras {
    pub(super) decomposition: Option<Pieces>,
}

/// As many hulls as a mesh needs.
#[derive(Clone, Copy, Debug, Deserialize)]
#[serde(default, rename_all = "camelCase", deny_unknown_fields)]
pub(super) struct Pieces {
    max_hulls: u32,
    concavity: f32,
    resolution: u32,
}

impl Default for Pieces {
    fn default() -> Self {
        let Decomposition { max_hulls, concavity, resolution, .. } = Decomposition::default();
        Pieces { max_hulls, concavity, resolution }
    }
}

impl Pieces {
    pub(super) fn settings(self) -> Decomposition {
        Decomposition::default()
            .with_max_hulls(self.max_hulls)
            .with_concavity(self.concavity)
            .with_resolution(self.resolution)
    }

    /// Equal for equal numbers.
    pub(super) fn key(self) -> [u32; 3] {
        [self.max_hulls, self.concavity.to_bits(), self.resolution]
    }
}
