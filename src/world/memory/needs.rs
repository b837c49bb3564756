//! Features that the content of the world requires of a step: counted when content is added, changed or
//! removed, never searched for.

use crate::config::Continuous;
use crate::shape::{BELT, Collider, EVENTS, HOOKS, Kind, Material, RARE, ROLLS, SENSOR, SOFT, STATICS};
use crate::world::World;
use glam::Vec3;

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
    /// Sensors that notice what is static.
    pub(crate) senses_static: u32,
    pub(crate) hooks: u32,
    /// Shapes by the kind of geometry that they share.
    pub(crate) hulls: u32,
    pub(crate) meshes: u32,
    pub(crate) height_fields: u32,
}

impl Needs {
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
pub(crate) struct Demand(u16);

impl Demand {
    const FRICTION: u16 = 1;
    const RESTITUTION: u16 = 2;
    const LISTENING: u16 = 4;
    const HOOKS: u16 = 8;
    const JOINTS: u16 = 16;
    const CONTINUOUS: u16 = 32;
    const SOLVED_AFTER: u16 = 64;
    const ACCELERATION: u16 = 128;
    const ROLLING: u16 = 256;
    const RARE_MATERIALS: u16 = 512;
    const SOFT: u16 = 1024;
}

impl World {
    /// Whether any body is continuous.
    #[inline]
    pub(crate) fn is_continuous(&self) -> bool {
        self.settings.continuous != Continuous::Discrete && self.bodies.continuous > 0
    }

    /// Whether gravity or forces accelerate bodies.
    #[inline]
    pub(crate) fn is_accelerated(&self) -> bool {
        self.settings.gravity != Vec3::ZERO || !self.bodies.force.is_empty()
    }

    /// The features that the starting step needs.
    pub(crate) fn demand(&self) -> Demand {
        let listening = self.needs.events > 0 || self.needs.sensors > 0 || self.events.has_any();
        let needed = [
            (self.needs.friction > 0, Demand::FRICTION),
            (self.needs.restitution > 0, Demand::RESTITUTION),
            (listening, Demand::LISTENING),
            (self.needs.hooks > 0, Demand::HOOKS),
            (self.joints.count > 0 || self.joints.has_events(), Demand::JOINTS),
            (self.is_continuous(), Demand::CONTINUOUS),
            (self.bodies.any_solved_after(), Demand::SOLVED_AFTER),
            (self.is_accelerated(), Demand::ACCELERATION),
            (self.needs.rolling > 0, Demand::ROLLING),
            (self.needs.rare_materials > 0, Demand::RARE_MATERIALS),
            (self.needs.soft > 0, Demand::SOFT),
        ];
        Demand(needed.iter().fold(0, |all, (is, part)| all | (u16::from(*is) * part)))
    }

    /// At the end of a step that needed `now`: releases the buffers that only earlier ones needed. With a
    /// budget reserved memory stays, so that content that needs it again is never refused.
    pub(crate) fn release(&mut self, now: Demand) {
        if self.needs.rolling == 0 {
            // They are state, which must not depend on a budget.
            self.contacts.clear_rolling();
        }
        if !self.settings.budget.is_none() {
            self.last_demand.0 |= now.0;
            return;
        }
        let gone = self.last_demand.0 & !now.0;
        self.last_demand = now;
        if gone != 0 {
            self.release_all(gone);
        }
    }

    #[cold]
    fn release_all(&mut self, gone: u16) {
        let buffers = &mut self.buffers;
        if gone & Demand::RESTITUTION != 0 {
            buffers.restitution = Default::default();
        }
        if gone & Demand::LISTENING != 0 {
            self.events.release();
        }
        if gone & Demand::HOOKS != 0 {
            (self.events.tweaks, self.events.vetoed) = Default::default();
            buffers.rows.surfaces = Vec::new();
        }
        if gone & Demand::JOINTS != 0 {
            self.joints.release();
            buffers.joints.release();
            buffers.rows.tree_contacts = Vec::new();
            buffers.finish.part_trees();
            self.revisions.moving += 1;
        }
        if gone & Demand::CONTINUOUS != 0 {
            buffers.finish.release();
            buffers.prepare.forget_ahead();
            self.broad.release_paths();
        }
        if gone & Demand::SOLVED_AFTER != 0 {
            buffers.prepare.lower();
        }
        if gone & Demand::ACCELERATION != 0 {
            buffers.forces.acceleration = Vec::new();
        }
        if gone & Demand::ROLLING != 0 {
            buffers.rows.rolling = Vec::new();
            self.contacts.forget_rolling();
        }
        if gone & Demand::SOFT != 0 {
            buffers.rows.soft = Default::default();
        }
        if gone & Demand::RARE_MATERIALS != 0 {
            (self.colliders.rare, buffers.rows.surfaces) = Default::default();
        }
        // Friction is released when rows are prepared, sleep when a step begins.
    }
}
