//! Features that the content of the world requires of a step: counted when content is added, changed or
//! removed, never searched for.

use crate::constraint::Beside;
use crate::shape::{BELT, Collider, EVENTS, HOOKS, Kind, Material, RARE, ROLLS, SENSOR, SOFT, STATICS};

/// Numbers of shapes that need a feature; a feature that nothing needs costs nothing.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct Needs {
    /// Shapes with friction of any kind, or with hooks, which may add it.
    pub(crate) friction: u32,
    /// Shapes that resist rolling or spinning, and those whose surface moves.
    pub(crate) rolling: u32,
    pub(crate) belts: u32,
    /// Shapes whose contacts are soft.
    pub(crate) soft: u32,
    /// Shapes, sensors included, with a material of which a part is in the column of rare ones.
    pub(crate) rare_materials: u32,
    /// Shapes with restitution, or with hooks, which may add it.
    pub(crate) restitution: u32,
    /// Shapes that ask for events, are sensors, or have hooks.
    pub(crate) events: u32,
    pub(crate) sensors: u32,
    /// Sensors that notice static shapes.
    pub(crate) senses_static: u32,
    pub(crate) hooks: u32,
    /// Shapes by the kind of geometry that they share.
    pub(crate) hulls: u32,
    pub(crate) meshes: u32,
    pub(crate) height_fields: u32,
}

impl Needs {
    /// Additional data beside rows of contacts.
    pub(in crate::world) fn beside(&self) -> Beside {
        Beside { surfaces: self.belts > 0, rolling: self.rolling > 0, soft: self.soft > 0 }
    }

    /// Counts a collider that is added (1) or removed (-1).
    pub(in crate::world) fn count(&mut self, collider: &Collider, change: i32) {
        let has = |flag: u8| collider.flags & flag != 0;
        let add = |count: &mut u32, set: bool| {
            if set {
                *count = count.wrapping_add_signed(change);
            }
        };
        let (material, parts) = (&collider.material, collider.geometry.materials());
        // A sensor pushes nothing.
        let solid = !has(SENSOR);
        let rubs = |m: &Material| m.static_friction > 0.0 || m.dynamic_friction > 0.0;
        let has_friction = material.static_friction > 0.0
            || material.dynamic_friction > 0.0
            || has(ROLLS)
            || parts.iter().any(rubs);
        add(&mut self.friction, solid && (has_friction || has(HOOKS)));
        add(&mut self.rolling, solid && has(ROLLS));
        add(&mut self.belts, solid && has(BELT));
        let yields = has(SOFT) || parts.iter().any(Material::is_soft);
        add(&mut self.soft, solid && yields);
        add(&mut self.rare_materials, has(RARE));
        let bounces = material.restitution > 0.0 || parts.iter().any(|part| part.restitution > 0.0);
        add(&mut self.restitution, solid && (bounces || has(HOOKS)));
        add(&mut self.events, has(EVENTS));
        add(&mut self.sensors, has(SENSOR));
        add(&mut self.senses_static, has(SENSOR) && has(STATICS));
        add(&mut self.hooks, has(HOOKS));
        add(&mut self.hulls, collider.kind == Kind::Hull);
        add(&mut self.meshes, collider.kind == Kind::Mesh);
        add(&mut self.height_fields, collider.kind == Kind::HeightField);
    }
}

/// Features whose buffers are released once nothing needs them: a bit each.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub(crate) struct Demand(pub(super) u16);

impl Demand {
    pub(super) const FRICTION: u16 = 1;
    pub(super) const RESTITUTION: u16 = 2;
    pub(super) const LISTENING: u16 = 4;
    pub(super) const HOOKS: u16 = 8;
    pub(super) const JOINTS: u16 = 16;
    pub(super) const CONTINUOUS: u16 = 32;
    pub(super) const SOLVED_AFTER: u16 = 64;
    pub(super) const ACCELERATION: u16 = 128;
    pub(super) const ROLLING: u16 = 256;
    pub(super) const RARE_MATERIALS: u16 = 512;
    pub(super) const SOFT: u16 = 1024;
}
