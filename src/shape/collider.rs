//! A collider: the flat record of a shape that the stages read, beside the caller's description.

use super::flags::{EVENTS, HOOKS, RARE, SENSOR, SOFT, STATICS};
use super::{BaseMaterial, Filter, Geometry, Kind, Material, RareMaterial, ShapeDesc};
use crate::config::ContinuousMode;
use crate::config::tuning::SOFT_DEPTH;
use crate::math::Quat;
use glam::Vec3;

/// The part of a collider that loops over pairs read: half a cache line, where the whole takes three.
#[derive(Clone, Copy, Debug)]
pub(crate) struct ColliderSummary {
    /// See [`Collider::size`].
    pub(crate) size: [f32; 4],
    /// See [`Collider::radius`].
    pub(crate) radius: f32,
    /// Distance of the shape's origin from the body's centre of mass [m].
    pub(crate) lever: f32,
    /// Index of its body.
    pub(crate) body: u32,
    pub(crate) kind: Kind,
    /// Mode of its body; `Discrete` if the body is static, which never moves into anything.
    pub(crate) mode: ContinuousMode,
    pub(crate) flags: u8,
}

impl ColliderSummary {
    #[inline]
    pub(crate) fn is_sensor(&self) -> bool {
        self.flags & SENSOR != 0
    }
    #[inline]
    pub(crate) fn has_events(&self) -> bool {
        self.flags & EVENTS != 0
    }
    #[inline]
    pub(crate) fn has_hooks(&self) -> bool {
        self.flags & HOOKS != 0
    }
}

impl Collider {
    /// From its middle to the nearest point of its surface [m]; infinite for shapes without an inside.
    #[inline]
    pub(crate) fn thickness(&self) -> f32 {
        if self.inner_radius > 0.0 { self.inner_radius } else { f32::INFINITY }
    }
    /// How far a small turn about its own origin moves any of its points, at most [m]. `turn`: in its own
    /// frame [rad].
    pub(crate) fn swing(&self, turn: Vec3) -> f32 {
        if !self.kind.is_polytope() {
            return turn.length() * self.radius;
        }
        let (min, max) = self.geometry.aabb();
        let reach = min.abs().max(max.abs());
        let turn = turn.abs();
        let along = |i: usize, k: usize| turn[i] * reach[k] + turn[k] * reach[i];
        Vec3::new(along(1, 2), along(2, 0), along(0, 1)).length()
    }
    /// A form on no body, by itself.
    pub(crate) fn new(geometry: Geometry) -> Collider {
        Collider {
            kind: Kind::of(&geometry),
            body: u32::MAX,
            place: 0,
            size: geometry.size(),
            position: Vec3::ZERO,
            rotation: Quat::IDENTITY,
            radius: geometry.radius(),
            inner_radius: geometry.inner_radius(),
            material: BaseMaterial::default(),
            filter: Filter::default(),
            density: ShapeDesc::default_density(),
            flags: geometry.rare_flags(),
            user_data: 0,
            geometry,
        }
    }

    /// A shape on a body of its own, whose frame is that of the body.
    pub(crate) fn of(shape: &ShapeDesc) -> Collider {
        Collider {
            position: shape.position,
            rotation: Quat::from(shape.rotation).normalize(),
            material: shape.material.base(),
            filter: shape.filter,
            density: shape.density,
            flags: shape.flags(),
            user_data: shape.user_data,
            ..Collider::new(shape.geometry.clone())
        }
    }

    /// Replaces its form, and the fields that follow from it. `own`: the rare part of its material.
    pub(crate) fn set_geometry(&mut self, geometry: Geometry, own: RareMaterial) {
        let form = Collider::new(geometry);
        let flags = self.flags & !RARE | own.flags() | form.flags;
        let Collider { body, place, position, rotation, material, filter, density, user_data, .. } = *self;
        *self =
            Collider { body, place, position, rotation, material, filter, density, flags, user_data, ..form };
    }

    /// Replaces its material, and the fields that follow from it but for the column of rare ones.
    pub(crate) fn set_material(&mut self, material: &Material) {
        self.material = material.base();
        self.flags = self.flags & !RARE | material.rare().flags() | self.geometry.rare_flags();
    }

    pub(crate) fn is_sensor(&self) -> bool {
        self.flags & SENSOR != 0
    }
    /// Whether it is a sensor that notices static shapes, and surfaces.
    pub(crate) fn senses_static(&self) -> bool {
        self.flags & (SENSOR | STATICS) == SENSOR | STATICS
    }

    /// The material of a part of it, by the number that a contact has; none if it is the shape's own.
    #[inline]
    pub(crate) fn part_material(&self, part: u8) -> Option<&Material> {
        if part == 0 { None } else { self.geometry.materials().get(usize::from(part) - 1) }
    }
    /// Whether contacts with a part of it are soft, with any other shape.
    #[inline]
    pub(crate) fn is_soft(&self, part: u8) -> bool {
        self.part_material(part).map_or(self.flags & SOFT != 0, Material::is_soft)
    }

    /// Friction and restitution of a part of it.
    #[inline]
    pub(crate) fn surface(&self, part: u8) -> BaseMaterial {
        self.part_material(part).map_or(self.material, Material::base)
    }

    /// How deep the spring of a soft contact with a part of another shape lets the two into each other [m]:
    /// half of the way to the middle of the thinner one. `None` if neither is soft.
    #[inline(always)]
    pub(crate) fn soft_depth(&self, other: &Collider, part: u8) -> Option<f32> {
        if !self.is_soft(0) && !other.is_soft(part) {
            return None;
        }
        let thinnest = self.thickness().min(other.thickness());
        Some(if thinnest.is_finite() { SOFT_DEPTH * thinnest } else { 0.0 })
    }

    pub(crate) fn summaries(&self, mode: ContinuousMode) -> ColliderSummary {
        ColliderSummary {
            size: self.size,
            radius: self.radius,
            lever: self.position.length(),
            body: self.body,
            kind: self.kind,
            mode,
            flags: self.flags,
        }
    }
}

/// A shape on a body, as the stages read it.
#[derive(Clone, Debug)]
pub(crate) struct Collider {
    pub(crate) kind: Kind,
    /// Index of its body.
    pub(crate) body: u32,
    /// By kind: sphere (radius); capsule and cylinder (half height, bottom, top radius); box (half extents).
    pub(crate) size: [f32; 4],
    /// Its place in its body's list.
    pub(crate) place: u32,
    /// Its frame in the body's, relative to the body's centre of mass.
    pub(crate) position: Vec3,
    pub(crate) rotation: Quat,
    /// Largest distance of a point of the shape from its own origin [m]; infinite for a plane.
    pub(crate) radius: f32,
    /// Radius of a ball around the shape's own origin that it surely contains [m]: a body that moves less
    /// within a step can't have passed anything with its origin.
    pub(crate) inner_radius: f32,
    pub(crate) geometry: Geometry,
    /// The rest of it is in [`Colliders::rare`](crate::body::Colliders::rare) if the flags say so.
    pub(crate) material: BaseMaterial,
    pub(crate) filter: Filter,
    pub(crate) density: f32,
    /// See [`ColliderSummary::flags`].
    pub(crate) flags: u8,
    pub(crate) user_data: u64,
}
