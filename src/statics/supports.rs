//! New contacts that support bodies, and the known loads on those bodies.

use super::{Burden, NOWHERE, Rest, Statics, Structure, Support, is_supported, point_velocity};
use crate::config::tuning::STEEPEST_SUPPORT;
use crate::narrow_phase::NO_CONTACT;
use glam::Vec3;

impl Structure<'_> {
    /// Finds contacts with unknown loads between bodies at rest, and the bodies above and below them. Returns
    /// whether any supports a body.
    pub(super) fn find_supports(&mut self, statics: &mut Statics, rest: &Rest) -> bool {
        let Statics { places, burdens, supports, .. } = statics;
        let dynamic = self.bodies.dynamic();
        supports.clear();
        for pair in self.pairs.iter().filter(|pair| !pair.is_idle(&self.colliders.summaries, dynamic)) {
            let mut slot = pair.contact;
            while slot != NO_CONTACT {
                let index = slot;
                let contact = self.contacts.at(slot);
                slot = contact.next;
                if !contact.touches_anew(rest.touching) {
                    continue;
                }
                let [a, b] = [contact.a, contact.b].map(|c| self.colliders.all[c as usize].body);
                // A rolling body is at rest at its contact: the velocity of its centre shows that it moves.
                let at = self.bodies.pose[if (b as usize) < dynamic { b } else { a } as usize].position;
                let velocity = |body: u32| point_velocity(self.bodies, body as usize, at);
                let moves = velocity(b) - velocity(a);
                let normal = contact.frame * contact.normal;
                let along = moves.dot(normal);
                let slip = moves - normal * along;
                if along.abs() > rest.closing || slip.length_squared() > rest.slip * rest.slip {
                    continue;
                }
                let [x, y] = [contact.a, contact.b].map(|c| &self.colliders.all[c as usize]);
                let origin = self.colliders.poses[contact.a as usize].position;
                // A body that bounces off with one end may have its centre at rest.
                let restitution = x.material.restitution_with(&y.surface(contact.material));
                let bounces = restitution > 0.0
                    && contact.points().iter().any(|point| {
                        let at = origin + (contact.frame * point.position).as_dvec3();
                        let [a, b] = [a, b].map(|body| point_velocity(self.bodies, body as usize, at));
                        point.separation <= rest.touching && (b - a).dot(normal).abs() > rest.closing
                    });
                if bounces {
                    continue;
                }
                let steep = normal.dot(rest.up);
                let (upper, lower) = if steep > 0.0 { (b, a) } else { (a, b) };
                if steep.abs() >= STEEPEST_SUPPORT && (upper as usize) < dynamic {
                    let number = supports.len() as u32;
                    supports.push(Support { upper, lower, contact: index, number, is_a: upper == a });
                } else {
                    // Nothing rests on it; its load, possibly of an impact, does not last.
                    self.contacts.at_mut(index).expect(0.0, 0.0, rest.touching);
                }
            }
        }
        if supports.is_empty() {
            return false;
        }
        supports.sort_unstable_by_key(|support| (support.upper, support.number));
        places.clear();
        places.resize(dynamic, NOWHERE);
        burdens.clear();
        let mut place = |body: u32, burdens: &mut Vec<Burden>| {
            let place = &mut places[body as usize];
            if *place == NOWHERE {
                *place = burdens.len() as u32;
                let mass = self.bodies.mass[body as usize].inverse;
                let pull = self.acceleration.get(body as usize);
                let force =
                    if mass > 0.0 { pull.map_or(Vec3::ZERO, |p| p.linear / mass) } else { Vec3::ZERO };
                burdens.push(Burden { body, force, ..Burden::default() });
            }
            *place as usize
        };
        let mut first = 0;
        for some in supports.chunk_by(|x, y| x.upper == y.upper) {
            let upper = place(some[0].upper, burdens);
            (burdens[upper].first, burdens[upper].count) = (first, some.len() as u32);
            first += some.len() as u32;
            for support in some.iter().filter(|support| (support.lower as usize) < dynamic) {
                place(support.lower, burdens);
            }
        }
        true
    }

    /// Adds the loads of known contacts above and below the bodies.
    pub(super) fn add_known_loads(&self, statics: &mut Statics, rest: &Rest) {
        let Statics { places, burdens, .. } = statics;
        for pair in self.pairs {
            let bodies = [pair.a, pair.b].map(|c| self.colliders.summaries[c as usize].body);
            let place = |body: u32| places.get(body as usize).copied().unwrap_or(NOWHERE);
            let of_pair = bodies.map(place);
            if of_pair == [NOWHERE; 2] {
                continue;
            }
            for (_, contact) in self.contacts.chain(pair.contact) {
                let normal = contact.frame * contact.normal;
                let steep = normal.dot(rest.up);
                if contact.is_unknown() || steep.abs() < STEEPEST_SUPPORT || contact.bears() == 0.0 {
                    continue;
                }
                for (side, at) in of_pair.into_iter().enumerate().filter(|(_, at)| *at != NOWHERE) {
                    let burden = &mut burdens[at as usize];
                    let sign = if side == 0 { -1.0 } else { 1.0 };
                    burden.supported |= steep * sign > 0.0;
                    let centre = self.bodies.pose[bodies[side] as usize].position;
                    let origin = self.origin(contact, side == 0, centre);
                    for point in contact.points() {
                        let arm = origin + contact.frame * point.position;
                        burden.add(normal * (sign * point.impulse / rest.h), arm);
                    }
                }
            }
        }
    }

    /// Finds the bodies that a static or kinematic one supports, directly or through others: bodies that fall
    /// together have no loads.
    pub(super) fn find_supported(&self, statics: &mut Statics, rest: &Rest) {
        let Statics { places, burdens, by_height, supports, .. } = statics;
        let up = rest.up.as_dvec3();
        let key = |place: u32| {
            let body = burdens[place as usize].body;
            (self.bodies.pose[body as usize].position.dot(up), body)
        };
        by_height.clear();
        by_height.extend(0..burdens.len() as u32);
        by_height.sort_unstable_by(|&i, &j| {
            let ((one, body), (other, next)) = (key(i), key(j));
            one.total_cmp(&other).then(body.cmp(&next))
        });
        for &place in by_height.iter() {
            let Burden { first, count, .. } = burdens[place as usize];
            let mut below = supports[first as usize..(first + count) as usize].iter();
            if below.any(|support| is_supported(support.lower, places, burdens)) {
                burdens[place as usize].supported = true;
            }
        }
    }
}
