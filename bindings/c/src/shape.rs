//! Shapes: their geometry, their materials, and their bodies.

mod change;

pub use change::*;

use crate::abi::guard::call;
use crate::abi::pointers::{Buffer, Out, borrow};
use crate::abi::sized::read;
use crate::abi::status::{BsStatus, Outcome, Refusal};
use crate::abi::twin::{codes, record};
use crate::abi::values::{BsBody, BsBool, BsQuat, BsShape, BsVec3};
use crate::asset::{BsHeightField, BsHull, BsMesh, lend, share};
use crate::mass::BsMassProperties;
use crate::world::{BsWorld, changing, reading};
use backstop::debug::triangles;
use backstop::{Combine, Filter, Geometry, MassProperties, Material, ShapeDesc};
use std::ptr::null;

/// What a geometry is, one of `BS_GEOMETRY_...`.
pub type BsGeometryKind = u32;
/// A ball around the origin, of `radius`.
pub const BS_GEOMETRY_SPHERE: BsGeometryKind = 0;
/// The convex hull of two balls on the y axis, at `-half_height` with `radius` and at `half_height` with
/// `radius_top`.
pub const BS_GEOMETRY_CAPSULE: BsGeometryKind = 1;
/// A box around the origin, by `half_extents`.
pub const BS_GEOMETRY_BOX: BsGeometryKind = 2;
/// A cylinder around the y axis, from `-half_height` with `radius` to `half_height` with `radius_top`: a
/// frustum if they differ, a cone if one is zero.
pub const BS_GEOMETRY_CYLINDER: BsGeometryKind = 3;
/// A convex `hull`.
pub const BS_GEOMETRY_HULL: BsGeometryKind = 4;
/// The half-space y <= 0; only static or kinematic.
pub const BS_GEOMETRY_PLANE: BsGeometryKind = 5;
/// Triangles, from both sides; only static or kinematic.
pub const BS_GEOMETRY_MESH: BsGeometryKind = 6;
/// A grid of heights; only static or kinematic.
pub const BS_GEOMETRY_HEIGHT_FIELD: BsGeometryKind = 7;

/// The form of a shape in its own frame. What its kind does not speak of is not looked at. `bs_sphere` and
/// others make one.
#[repr(C)]
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct BsGeometry {
    /// What it is.
    pub kind: BsGeometryKind,
    /// [m], of a capsule or cylinder.
    pub half_height: f32,
    /// [m], of a sphere, or the lower one of a capsule or cylinder.
    pub radius: f32,
    /// [m], the upper one of a capsule or cylinder.
    pub radius_top: f32,
    /// [m], of a box.
    pub half_extents: BsVec3,
    /// Zero.
    pub reserved: u32,
    /// The hull of such a shape, which keeps a reference of its own.
    pub hull: *const BsHull,
    /// The mesh of such a shape.
    pub mesh: *const BsMesh,
    /// The field of such a shape.
    pub height_field: *const BsHeightField,
}

impl BsGeometry {
    const PLAIN: BsGeometry = BsGeometry {
        kind: BS_GEOMETRY_SPHERE,
        half_height: 0.0,
        radius: 0.0,
        radius_top: 0.0,
        half_extents: BsVec3 { x: 0.0, y: 0.0, z: 0.0 },
        reserved: 0,
        hull: null(),
        mesh: null(),
        height_field: null(),
    };

    /// # Safety
    /// The pointer of its kind is null or valid.
    pub(crate) unsafe fn to_engine(self) -> Outcome<Geometry> {
        let BsGeometry { half_height, radius: radius_bottom, radius_top, .. } = self;
        Ok(match self.kind {
            BS_GEOMETRY_SPHERE => Geometry::Sphere { radius: self.radius },
            BS_GEOMETRY_CAPSULE => Geometry::Capsule { half_height, radius_bottom, radius_top },
            BS_GEOMETRY_BOX => Geometry::Box { half_extents: self.half_extents.into() },
            BS_GEOMETRY_CYLINDER => Geometry::Cylinder { half_height, radius_bottom, radius_top },
            BS_GEOMETRY_PLANE => Geometry::Plane,
            // SAFETY: as this function.
            BS_GEOMETRY_HULL => Geometry::Hull(unsafe { share(self.hull) }?),
            // SAFETY: as this function.
            BS_GEOMETRY_MESH => Geometry::Mesh(unsafe { share(self.mesh) }?),
            // SAFETY: as this function.
            BS_GEOMETRY_HEIGHT_FIELD => Geometry::HeightField(unsafe { share(self.height_field) }?),
            value => return Err(Refusal::Constant { what: "kind of geometry", value }),
        })
    }

    /// Its pointers are borrowed from the geometry.
    pub(crate) fn of_engine(geometry: &Geometry) -> BsGeometry {
        let plain = BsGeometry::PLAIN;
        match geometry {
            Geometry::Sphere { radius } => BsGeometry { radius: *radius, ..plain },
            Geometry::Capsule { half_height, radius_bottom, radius_top } => {
                bs_capsule(*half_height, *radius_bottom, *radius_top)
            }
            Geometry::Box { half_extents: h } => bs_box(h.x, h.y, h.z),
            Geometry::Cylinder { half_height, radius_bottom, radius_top } => {
                bs_cylinder(*half_height, *radius_bottom, *radius_top)
            }
            Geometry::Hull(hull) => bs_hull(lend(hull)),
            Geometry::Plane => bs_plane(),
            Geometry::Mesh(mesh) => bs_mesh(lend(mesh)),
            Geometry::HeightField(field) => bs_height_field(lend(field)),
            // A kind without a constant yet: no call takes it back.
            _ => BsGeometry { kind: u32::MAX, ..plain },
        }
    }
}

/// A ball [m].
#[unsafe(no_mangle)]
pub extern "C" fn bs_sphere(radius: f32) -> BsGeometry {
    BsGeometry { radius, ..BsGeometry::PLAIN }
}

/// A capsule along y [m]; it tapers if the radii differ.
#[unsafe(no_mangle)]
pub extern "C" fn bs_capsule(half_height: f32, radius: f32, radius_top: f32) -> BsGeometry {
    BsGeometry { kind: BS_GEOMETRY_CAPSULE, half_height, radius, radius_top, ..BsGeometry::PLAIN }
}

/// A box by its half extents [m].
#[unsafe(no_mangle)]
pub extern "C" fn bs_box(x: f32, y: f32, z: f32) -> BsGeometry {
    BsGeometry { kind: BS_GEOMETRY_BOX, half_extents: BsVec3 { x, y, z }, ..BsGeometry::PLAIN }
}

/// A cylinder along y [m]; a frustum if the radii differ, a cone if one is zero.
#[unsafe(no_mangle)]
pub extern "C" fn bs_cylinder(half_height: f32, radius: f32, radius_top: f32) -> BsGeometry {
    BsGeometry { kind: BS_GEOMETRY_CYLINDER, half_height, radius, radius_top, ..BsGeometry::PLAIN }
}

/// The half-space y <= 0.
#[unsafe(no_mangle)]
pub extern "C" fn bs_plane() -> BsGeometry {
    BsGeometry { kind: BS_GEOMETRY_PLANE, ..BsGeometry::PLAIN }
}

/// A hull. The geometry has no reference of its own.
#[unsafe(no_mangle)]
pub extern "C" fn bs_hull(hull: *const BsHull) -> BsGeometry {
    BsGeometry { kind: BS_GEOMETRY_HULL, hull, ..BsGeometry::PLAIN }
}

/// A mesh. The geometry has no reference of its own.
#[unsafe(no_mangle)]
pub extern "C" fn bs_mesh(mesh: *const BsMesh) -> BsGeometry {
    BsGeometry { kind: BS_GEOMETRY_MESH, mesh, ..BsGeometry::PLAIN }
}

/// A height field. The geometry has no reference of its own.
#[unsafe(no_mangle)]
pub extern "C" fn bs_height_field(field: *const BsHeightField) -> BsGeometry {
    BsGeometry { kind: BS_GEOMETRY_HEIGHT_FIELD, height_field: field, ..BsGeometry::PLAIN }
}

/// How two coefficients become one, one of `BS_COMBINE_...`; of two shapes the later in this list decides.
pub type BsCombine = u32;
/// (a + b) / 2
pub const BS_COMBINE_AVERAGE: BsCombine = 0;
/// The smaller.
pub const BS_COMBINE_MINIMUM: BsCombine = 1;
/// The larger.
pub const BS_COMBINE_MAXIMUM: BsCombine = 2;
/// a b
pub const BS_COMBINE_MULTIPLY: BsCombine = 3;

codes! { "way to combine coefficients", Combine {
    BS_COMBINE_AVERAGE = Combine::Average,
    BS_COMBINE_MINIMUM = Combine::Minimum,
    BS_COMBINE_MAXIMUM = Combine::Maximum,
    BS_COMBINE_MULTIPLY = Combine::Multiply,
} }

record! {
    /// Friction and restitution.
    #[repr(C)]
    #[derive(Clone, Copy, Debug, PartialEq)]
    pub struct BsMaterial of material: Material {
        pub static_friction: f32,
        pub dynamic_friction: f32,
        pub restitution: f32,
        pub friction_combine: BsCombine,
        pub restitution_combine: BsCombine,
        /// Zero.
        pub reserved: u32 = 0,
    }
}

record! {
    /// What few materials have: friction against rolling and spinning, a belt, and a spring. All zeros is
    /// none of them.
    #[repr(C)]
    #[derive(Clone, Copy, Debug, Default, PartialEq)]
    pub struct BsSurface of material: Material {
        pub rolling_friction: f32,
        pub spinning_friction: f32,
        pub surface_velocity: BsVec3,
        pub contact_hertz: f32,
        /// Damping ratio of that spring, 0..=100. Without a spring zero stands for the engine's default, 1.
        pub contact_damping: f32 = if has_no_spring(material) { 0.0 } else { material.contact_damping },
        /// Zero.
        pub reserved: u32 = 0,
    }
}

fn has_no_spring(material: &Material) -> bool {
    material.contact_hertz == 0.0 && material.contact_damping == 1.0
}

impl BsSurface {
    pub(crate) const NONE: BsSurface = BsSurface {
        rolling_friction: 0.0,
        spinning_friction: 0.0,
        surface_velocity: BsVec3 { x: 0.0, y: 0.0, z: 0.0 },
        contact_hertz: 0.0,
        contact_damping: 0.0,
        reserved: 0,
    };

    /// The material with this surface.
    pub(crate) fn over(self, material: Material) -> Outcome<Material> {
        let rigid = self.contact_hertz == 0.0 && self.contact_damping == 0.0;
        Ok(self.on(material)?.with_contact_damping(if rigid { 1.0 } else { self.contact_damping }))
    }

    /// The material of both parts.
    pub(crate) fn with(self, material: BsMaterial) -> Outcome<Material> {
        self.over(material.on(Material::default())?)
    }
}

record! {
    /// Which shapes collide. Two of the same group that is not zero do if it is positive, and don't if it is
    /// negative; all others if each has a category that the other's mask has.
    #[repr(C)]
    #[derive(Clone, Copy, Debug, PartialEq, Eq)]
    pub struct BsFilter of filter: Filter {
        /// Bits that this shape is. Default: bit 0.
        pub category: u64,
        /// Bits that this shape collides with. Default: all.
        pub mask: u64,
        /// Default 0.
        pub group: i32,
        /// Zero.
        pub reserved: u32 = 0,
    }
}

/// Friction 0.6 and no restitution.
#[unsafe(no_mangle)]
pub extern "C" fn bs_material_default() -> BsMaterial {
    BsMaterial::of_engine(&Material::default())
}

/// Collides with everything.
#[unsafe(no_mangle)]
pub extern "C" fn bs_filter_default() -> BsFilter {
    BsFilter::of_engine(&Filter::default())
}

record! {
    /// A shape to be put on a body.
    #[repr(C)]
    #[derive(Clone, Copy, Debug, PartialEq)]
    pub struct BsShapeDesc of desc: ShapeDesc {
        /// Size of this struct; `bs_shape_desc_default` fills it in.
        pub size: u32 = size_of::<BsShapeDesc>() as u32,
        /// It pushes nothing, and notices what comes into it. Convex or a plane. Default no.
        pub sensor: BsBool,
        /// Its contacts are reported as events. Default no.
        pub events: BsBool,
        /// As a sensor it also notices static shapes, and surfaces of meshes and height fields. Default no.
        pub senses_static: BsBool,
        /// Zero.
        pub reserved: [u8; 1] = [0],
        /// Its form. Default a ball without radius, which is refused.
        pub geometry: BsGeometry = BsGeometry::of_engine(&desc.geometry),
        /// Where its frame is in the body's [m].
        pub position: BsVec3,
        /// How its frame is turned in the body's.
        pub rotation: BsQuat,
        /// Density [kg/m³], 0..=1e15; zero adds no mass. Default 1000.
        pub density: f32,
        /// Friction and restitution.
        pub material: BsMaterial = BsMaterial::of_engine(&desc.material),
        /// Which shapes it collides with.
        pub filter: BsFilter = BsFilter::of_engine(&desc.filter),
        /// Free for the caller.
        pub user_data: u64,
        /// Friction against rolling and spinning, a belt, a spring. Default none.
        pub surface: BsSurface = BsSurface::of_engine(&desc.material),
    }
    default bs_shape_desc_default(bs_sphere(0.0))
}

/// A shape at the body's origin with default material, filter and density.
#[unsafe(no_mangle)]
pub extern "C" fn bs_shape_desc_default(geometry: BsGeometry) -> BsShapeDesc {
    BsShapeDesc { geometry, ..BsShapeDesc::of_engine(&ShapeDesc::new(Geometry::sphere(0.0))) }
}

impl BsShapeDesc {
    /// # Safety
    /// The pointer of its kind of geometry is null or valid.
    pub(crate) unsafe fn to_engine(self) -> Outcome<ShapeDesc> {
        // SAFETY: as this function.
        let mut desc = ShapeDesc::new(unsafe { self.geometry.to_engine() }?);
        desc.material = self.surface.with(self.material)?;
        desc.filter = self.filter.on(desc.filter)?;
        self.on(desc)
    }
}

/// Adds a shape to a body. `shape` may be null.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn bs_body_add_shape(
    world: *mut BsWorld,
    body: BsBody,
    desc: *const BsShapeDesc,
    shape: *mut BsShape,
) -> BsStatus {
    call(|| {
        // SAFETY: the caller keeps to the header.
        let (mut content, out, desc) = unsafe {
            let out = Out::optional("the place for the shape", shape)?;
            (changing(world)?, out, read(desc)?.to_engine()?)
        };
        let shape = content.add_shape(body.into(), &desc)?;
        if let Some(out) = out {
            out.set(shape.into());
        }
        Ok(())
    })
}

/// Removes a shape from its body.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn bs_shape_remove(world: *mut BsWorld, shape: BsShape) -> BsStatus {
    // SAFETY: the caller keeps to the header.
    call(|| Ok(unsafe { changing(world) }?.remove_shape(shape.into())?))
}

/// The shapes of a body. `count` becomes their number.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn bs_body_shapes(
    world: *const BsWorld,
    body: BsBody,
    shapes: *mut BsShape,
    capacity: usize,
    count: *mut usize,
) -> BsStatus {
    call(|| {
        // SAFETY: the caller keeps to the header.
        let (content, out) = unsafe { (reading(world)?, Buffer::new("shapes", shapes, capacity, count)?) };
        let shapes: Vec<_> = content.shapes(body.into())?.collect();
        out.fill(shapes.into_iter().map(Into::into))
    })
}

/// The form of a shape. Its pointer, if it has one, is valid until the shape is gone, unless it is retained.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn bs_shape_geometry(
    world: *const BsWorld,
    shape: BsShape,
    geometry: *mut BsGeometry,
) -> BsStatus {
    call(|| {
        // SAFETY: the caller keeps to the header.
        let (content, out) = unsafe { (reading(world)?, Out::new("the place for the geometry", geometry)?) };
        out.set(BsGeometry::of_engine(content.geometry(shape.into())?));
        Ok(())
    })
}

/// Friction and restitution of a shape.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn bs_shape_material(
    world: *const BsWorld,
    shape: BsShape,
    material: *mut BsMaterial,
) -> BsStatus {
    call(|| {
        // SAFETY: the caller keeps to the header.
        let (content, out) = unsafe { (reading(world)?, Out::new("the place for the material", material)?) };
        out.set(BsMaterial::of_engine(&content.material(shape.into())?));
        Ok(())
    })
}

/// Replaces friction and restitution of a shape; its surface stays.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn bs_shape_set_material(
    world: *mut BsWorld,
    shape: BsShape,
    material: BsMaterial,
) -> BsStatus {
    call(|| {
        // SAFETY: the caller keeps to the header.
        let mut content = unsafe { changing(world) }?;
        let material = material.on(content.material(shape.into())?)?;
        Ok(content.set_material(shape.into(), material)?)
    })
}

/// Replaces the filter of a shape.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn bs_shape_set_filter(
    world: *mut BsWorld,
    shape: BsShape,
    filter: BsFilter,
) -> BsStatus {
    // SAFETY: the caller keeps to the header.
    call(|| Ok(unsafe { changing(world) }?.set_filter(shape.into(), filter.on(Filter::default())?)?))
}

/// Sets whether contacts of a shape are reported as events.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn bs_shape_set_events(
    world: *mut BsWorld,
    shape: BsShape,
    events: BsBool,
) -> BsStatus {
    // SAFETY: the caller keeps to the header.
    call(|| Ok(unsafe { changing(world) }?.set_events(shape.into(), events != 0)?))
}

/// Makes a shape a sensor, or solid again.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn bs_shape_set_sensor(
    world: *mut BsWorld,
    shape: BsShape,
    sensor: BsBool,
) -> BsStatus {
    // SAFETY: the caller keeps to the header.
    call(|| Ok(unsafe { changing(world) }?.set_sensor(shape.into(), sensor != 0)?))
}

/// The caller's number of a shape.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn bs_shape_user_data(
    world: *const BsWorld,
    shape: BsShape,
    user_data: *mut u64,
) -> BsStatus {
    call(|| {
        // SAFETY: the caller keeps to the header.
        let (content, out) = unsafe { (reading(world)?, Out::new("the place for the number", user_data)?) };
        out.set(content.shape_user_data(shape.into())?);
        Ok(())
    })
}

/// Mass, centre and inertia of a solid of a form and an even density [kg/m³].
#[unsafe(no_mangle)]
pub unsafe extern "C" fn bs_geometry_mass(
    geometry: *const BsGeometry,
    density: f32,
    mass: *mut BsMassProperties,
) -> BsStatus {
    call(|| {
        // SAFETY: the caller keeps to the header.
        let (geometry, out) = unsafe {
            let geometry = borrow("the geometry", geometry)?.to_engine()?;
            (geometry, Out::new("the place for the mass", mass)?)
        };
        geometry.validate()?;
        out.set(BsMassProperties::of_engine(MassProperties::of(&geometry, density)));
        Ok(())
    })
}

/// Triangles that show a form, in its own frame [m], three corners each, counter-clockwise from outside.
/// `count` becomes the number of corners.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn bs_geometry_triangles(
    geometry: *const BsGeometry,
    corners: *mut BsVec3,
    capacity: usize,
    count: *mut usize,
) -> BsStatus {
    call(|| {
        // SAFETY: the caller keeps to the header.
        let (geometry, out) = unsafe {
            let geometry = borrow("the geometry", geometry)?.to_engine()?;
            (geometry, Buffer::new("corners", corners, capacity, count)?)
        };
        geometry.validate()?;
        let mut found = Vec::new();
        triangles(&geometry, None, &mut |triangle| found.extend(triangle.map(BsVec3::from)));
        out.fill(found.into_iter())
    })
}
