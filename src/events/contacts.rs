//! Begins, ends and hits, after the rows are solved and before bodies move.

use super::{Approach, ContactEnd, ContactEvent, Events, StartOfStep, push};
use crate::broad_phase::Pair;
use crate::config::Settings;
use crate::narrow_phase::{ContactRef, Contacts, Point};

/// Input of contact events.
pub(crate) struct Touching<'a> {
    pub(crate) start: StartOfStep<'a>,
    pub(crate) contacts: &'a Contacts,
    pub(crate) settings: &'a Settings,
}

impl Touching<'_> {
    /// Compares the pairs that touch with those that did, and measures impacts.
    pub(crate) fn record(&self, pairs: &mut [Pair], events: &mut Events) {
        let summaries = &self.start.colliders.summaries;
        let dynamic = self.start.bodies.dynamic();
        for pair in pairs {
            let [a, b] = [pair.a, pair.b].map(|c| &summaries[c as usize]);
            let heard = a.has_events() || b.has_events();
            if !heard || a.is_sensor() || b.is_sensor() || pair.is_idle(summaries, dynamic) {
                continue;
            }
            self.record_pair(pair, events);
        }
    }

    fn record_pair(&self, pair: &mut Pair, events: &mut Events) {
        let real = self.settings.measures().touch;
        let most = self.settings.event_capacity as usize;
        let (mut touches, mut impulse, mut worst) = (false, 0.0, None::<(f32, ContactRef<'_>, &Point)>);
        for (slot, contact) in self.contacts.chain(pair.contact) {
            let pushed = events.impulses.get(slot as usize).copied().unwrap_or(0.0);
            impulse += pushed;
            for point in contact.points() {
                if pushed > 0.0 || point.separation <= real {
                    touches = true;
                    // The point with the greatest impulse; if none has any, the deepest one.
                    let weight = point.impulse.max(pushed * 1e-6) - 1e-6 * point.separation;
                    if worst.is_none_or(|(most, ..)| weight > most) {
                        worst = Some((weight, contact, point));
                    }
                }
            }
        }
        let began = touches && !pair.touching;
        let shapes = [pair.a, pair.b].map(|c| self.start.colliders.handle(c));
        if pair.touching && !touches {
            let end = ContactEnd { shapes: [shapes[0].min(shapes[1]), shapes[0].max(shapes[1])] };
            push(&mut events.ends, end, most, &mut events.allowance, &mut events.lost);
        }
        pair.touching = touches;
        let Some((_, contact, point)) = worst else { return };
        let Approach { normal, position, speed: approach_speed } = self.start.approach(contact, point);
        let hit = impulse > 0.0 && approach_speed >= self.settings.hit_speed * self.settings.length_unit;
        if !(began || hit) {
            return;
        }
        let bodies = [pair.a, pair.b].map(|c| self.start.body_of(c));
        let mut event = ContactEvent { shapes, bodies, point: position, normal, approach_speed, impulse };
        if shapes[0] > shapes[1] {
            event.shapes.reverse();
            event.bodies.reverse();
            event.normal = -normal;
        }
        if began {
            push(&mut events.begins, event, most, &mut events.allowance, &mut events.lost);
        }
        if hit {
            push(&mut events.hits, event, most, &mut events.allowance, &mut events.lost);
        }
    }
}
