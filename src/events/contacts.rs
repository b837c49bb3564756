//! Begins, ends and hits, after the rows are solved and before bodies move.

use super::{ContactEnd, ContactEvent, Events, push};
use crate::broad_phase::Pair;
use crate::config::tuning::TOUCH_DISTANCE;
use crate::narrow_phase::{Contact, NONE, Point};
use crate::world::World;
use glam::Vec3;

impl World {
    /// Makes place for the impulses of contacts, if anyone listens.
    pub(crate) fn listen(&mut self) {
        let wanted = if self.needs.events > 0 { self.contacts.all.len() } else { 0 };
        self.events.impulses.clear();
        if wanted > 0 {
            self.grant_events();
        }
        let Events { impulses, room, lost, .. } = &mut self.events;
        let granted = room.fit(impulses, wanted);
        impulses.resize(granted, 0.0);
        *lost += (wanted - granted) as u32;
    }

    /// Compares who touches with who did, and measures impacts.
    pub(crate) fn hear_contacts(&mut self) {
        if self.needs.events == 0 {
            return;
        }
        self.grant_events();
        let mut events = std::mem::take(&mut self.events);
        let mut pairs = std::mem::take(&mut self.broad.pairs);
        let dynamic = self.bodies.dynamic();
        for pair in &mut pairs {
            let [a, b] = [pair.a, pair.b].map(|c| &self.colliders.hot[c as usize]);
            let heard = a.has_events() || b.has_events();
            if !heard || a.is_sensor() || b.is_sensor() || pair.is_idle(&self.colliders.hot, dynamic) {
                continue;
            }
            self.hear(pair, &mut events);
        }
        self.broad.pairs = pairs;
        self.events = events;
    }

    fn hear(&self, pair: &mut Pair, events: &mut Events) {
        let real = TOUCH_DISTANCE * self.settings.length_unit;
        let most = self.settings.event_capacity as usize;
        let (mut touches, mut impulse, mut worst) = (false, 0.0, None::<(f32, &Contact, &Point)>);
        let mut slot = pair.contact;
        while slot != NONE {
            let contact = &self.contacts.all[slot as usize];
            let pushed = events.impulses.get(slot as usize).copied().unwrap_or(0.0);
            impulse += pushed;
            for point in contact.points() {
                if pushed > 0.0 || point.separation <= real {
                    touches = true;
                    // Where it bears most; of what bears nothing, where it is deepest.
                    let weight = point.impulse.max(pushed * 1e-6) - 1e-6 * point.separation;
                    if worst.is_none_or(|(most, ..)| weight > most) {
                        worst = Some((weight, contact, point));
                    }
                }
            }
            slot = contact.next;
        }
        let began = touches && !pair.touching;
        let shapes = [pair.a, pair.b].map(|c| self.shape_handle(c));
        if pair.touching && !touches {
            let end = ContactEnd { shapes: [shapes[0].min(shapes[1]), shapes[0].max(shapes[1])] };
            push(&mut events.ends, end, most, (&mut events.room, &mut events.lost));
        }
        pair.touching = touches;
        let Some((_, contact, point)) = worst else { return };
        let (normal, at, approach_speed) = self.impact(contact, point);
        let hit = impulse > 0.0 && approach_speed >= self.settings.hit_speed * self.settings.length_unit;
        if !(began || hit) {
            return;
        }
        let bodies = [pair.a, pair.b].map(|c| self.handle_of(self.colliders.hot[c as usize].body as usize));
        let mut event = ContactEvent { shapes, bodies, point: at, normal, approach_speed, impulse };
        if shapes[0] > shapes[1] {
            event.shapes.reverse();
            event.bodies.reverse();
            event.normal = -normal;
        }
        if began {
            push(&mut events.begins, event, most, (&mut events.room, &mut events.lost));
        }
        if hit {
            push(&mut events.hits, event, most, (&mut events.room, &mut events.lost));
        }
    }

    /// Normal in the world, from a to b, place, and speed of approach at a point before anything was solved. Bodies are
    /// where they were at the start of the step.
    pub(super) fn impact(&self, contact: &Contact, point: &Point) -> (Vec3, glam::DVec3, f32) {
        let shape = &self.colliders.poses[contact.a as usize];
        let normal = shape.rotation * contact.normal;
        let at = shape.position + (shape.rotation * point.position).as_dvec3();
        let [a, b] = [contact.a, contact.b].map(|c| self.speed_before(c, at, contact.fraction));
        (normal, at, -normal.dot(b - a))
    }

    /// Velocity of a point of a collider's body at the start of the step, with what acceleration adds until a fraction of
    /// it.
    fn speed_before(&self, collider: u32, at: glam::DVec3, fraction: f32) -> Vec3 {
        let i = self.colliders.hot[collider as usize].body as usize;
        let forces = &self.buffers.forces;
        let Some(v) = forces.start.get(i) else { return Vec3::ZERO };
        let pull = forces.acceleration.get(i).map_or(Vec3::ZERO, |a| a.linear) * (self.buffers.dt * fraction);
        let arm = (at - self.bodies.pose[i].position).as_vec3();
        v.linear + pull + v.angular.cross(arm)
    }
}
