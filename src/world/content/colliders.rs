//! Adds colliders to the world and removes them, and keeps queries and the broad phase up to date.

use crate::body::{BodyKind, Odometer, Pose};
use crate::broad_phase::{Aabb, aabb_of};
use crate::config::ContinuousMode;
use crate::math::Quat;
use crate::shape::{Collider, Geometry, RareMaterial, ShapeDesc};
use crate::statics::Remains;
use crate::world::{Needs, World};
use glam::DVec3;

impl World {
    pub(in crate::world) fn new_collider(&mut self, body: usize, shape: &ShapeDesc) -> u32 {
        let details = &self.bodies.details[body];
        let to_axes = details.axes.conjugate();
        let geometry = &shape.geometry;
        let own = Collider::of(shape);
        let collider = Collider {
            body: body as u32,
            place: self.bodies.colliders[body].as_slice().len() as u32,
            position: to_axes * (shape.position - details.centre),
            rotation: (to_axes * own.rotation).normalize(),
            ..own
        };
        let mode = self.bodies.mode(body);
        self.assets.add(geometry);
        self.needs.count(&collider, 1);
        let next = self.colliders.all.len() as u32;
        let (slot, _) = self.colliders.slots.insert(next);
        if slot == next {
            self.colliders.reserve(1);
            self.colliders.summaries.push(collider.summaries(mode));
            self.colliders.all.push(collider);
            self.colliders.poses.push(self.bodies.pose[body]);
            self.colliders.swings.push(0.0);
            self.colliders.odometers.push(Odometer::default());
        } else {
            self.colliders.slots.moved(slot, slot);
            self.colliders.summaries[slot as usize] = collider.summaries(mode);
            self.colliders.all[slot as usize] = collider;
        }
        self.colliders.set_rare(slot, shape.material.rare());
        self.bodies.attach(body, slot);
        self.colliders.place(slot, &self.bodies.pose[body]);
        self.enter_broad(slot);
        slot
    }

    pub(in crate::world) fn drop_collider(&mut self, collider: u32) {
        self.leave_broad(collider);
        let old = &mut self.colliders.all[collider as usize];
        self.needs.count(old, -1);
        self.assets.remove(&old.geometry);
        old.body = u32::MAX;
        old.geometry = Geometry::Plane;
        self.colliders.set_rare(collider, RareMaterial::default());
        self.colliders.slots.remove(collider);
    }

    /// Removes all shapes, and prepares so many slots.
    pub(crate) fn clear_colliders(&mut self, slots: usize) {
        let nothing = Collider::new(Geometry::Plane);
        let nowhere = Pose { position: DVec3::ZERO, rotation: Quat::IDENTITY };
        let shapes = &mut self.colliders;
        self.assets.list.clear();
        self.needs = Needs::default();
        shapes.summaries.clear();
        shapes.summaries.resize(slots, nothing.summaries(ContinuousMode::Discrete));
        shapes.all.clear();
        shapes.all.resize(slots, nothing);
        shapes.poses.clear();
        shapes.poses.resize(slots, nowhere);
        shapes.swings.clear();
        shapes.swings.resize(slots, 0.0);
        shapes.odometers.clear();
        shapes.odometers.resize(slots, Odometer::default());
        shapes.rare.clear();
        self.broad.reset(slots);
    }

    /// Puts a shape into its former slot.
    pub(crate) fn put_collider(&mut self, slot: u32, collider: &Collider, rare: RareMaterial, pose: Pose) {
        let mode = self.bodies.mode(collider.body as usize);
        self.assets.add(&collider.geometry);
        self.needs.count(collider, 1);
        self.colliders.summaries[slot as usize] = collider.summaries(mode);
        self.colliders.all[slot as usize].clone_from(collider);
        self.colliders.poses[slot as usize] = pose;
        self.colliders.set_rare(slot, rare);
    }

    pub(in crate::world) fn enter_broad(&mut self, collider: u32) {
        self.note_change(collider);
        let c = &self.colliders.all[collider as usize];
        let body = c.body as usize;
        if self.bodies.traits[body].disabled {
            self.broad.leave_place(collider);
            return;
        }
        if self.bodies.kind[body] == BodyKind::Static {
            let pose = &self.bodies.pose[body];
            let bounds = aabb_of(c, pose.position, pose.rotation);
            self.broad.insert_static(collider, bounds);
            self.buffers.finish.statics_changed();
            self.disturb_box(&bounds);
        } else {
            self.broad.insert_mover(collider);
        }
    }

    pub(in crate::world) fn leave_broad(&mut self, collider: u32) {
        self.note_change(collider);
        self.removed.clear();
        self.broad.remove(collider, &mut self.removed);
        if !self.removed.is_empty() {
            self.refresh_event_allowance();
            let World { bodies, colliders, broad, contacts, .. } = self;
            let gravity = self.settings.gravity;
            let mut remains = Remains { bodies, colliders, broad, contacts, gravity };
            self.buffers.statics.weigh_again(&mut remains, collider, &self.removed);
        }
        for place in 0..self.removed.len() {
            let pair = self.removed[place];
            self.part_pair(&pair);
            self.contacts.remove_chain(pair.contact);
        }
        if !self.settings.budget.is_none() {
            // Lists as long as those of any body would be held for all time.
            self.removed = Vec::new();
            self.broad.release_look_ups();
        }
    }

    /// Tells the query index that a collider changed.
    pub(in crate::world) fn note_change(&mut self, collider: u32) {
        if let Some(now) = self.now.change() {
            now.touch(collider);
        }
    }

    /// The same for all colliders of a body.
    pub(in crate::world) fn note_move(&mut self, index: usize) {
        if let Some(now) = self.now.change() {
            self.bodies.colliders[index].as_slice().iter().for_each(|&c| now.touch(c));
        }
    }

    /// Bounds of a collider at its body's pose.
    pub(crate) fn bounds(&self, collider: u32) -> Aabb {
        let collider = &self.colliders.all[collider as usize];
        let pose = &self.bodies.pose[collider.body as usize];
        aabb_of(collider, pose.position, pose.rotation)
    }

    /// The present pose of a collider: the poses that stages read are those of the start of the last step.
    pub(crate) fn collider_pose(&self, collider: u32) -> Pose {
        let collider = &self.colliders.all[collider as usize];
        self.bodies.pose[collider.body as usize].of_part(collider.position, collider.rotation)
    }

    pub(in crate::world) fn place_colliders(&mut self, body: usize) {
        for &collider in self.bodies.colliders[body].as_slice() {
            self.colliders.place(collider, &self.bodies.pose[body]);
        }
    }
}
