//! Contacts in, sites of impacts out.

use super::{Link, NONE, Restitution, Site, Spot, Struck};
use crate::body::{Bodies, Pose};
use crate::broad_phase::Pair;
use crate::constraint::{Tweak, tweak_of};
use crate::joint::Joints;
use crate::lanes::Record;
use crate::memory::Room;
use crate::narrow_phase::Contact;
use crate::shape::Collider;
use glam::Vec3;

/// What finding impacts reads.
pub(crate) struct FindInput<'a> {
    pub(crate) bodies: &'a Bodies,
    pub(crate) colliders: &'a [Collider],
    pub(crate) poses: &'a [Pose],
    pub(crate) pairs: &'a [Pair],
    pub(crate) contacts: &'a [Contact],
    pub(crate) joints: &'a Joints,
    /// Predicted motion of each body that can move.
    pub(crate) motion: &'a [Record],
    /// Acceleration of each body that can move; may be empty.
    pub(crate) acceleration: &'a [Record],
    /// What hooks said of each contact; empty if there are none.
    pub(crate) tweaks: &'a [Tweak],
    /// Approach speeds below this don't bounce [m/s].
    pub(crate) threshold: f32,
    /// A separation up to this is one that touches [m].
    pub(crate) real: f32,
    pub(crate) dt: f32,
}

/// Lists the manifolds with restitution, if any of them closes within the step. Returns how many there was no room for.
pub(crate) fn find(input: &FindInput<'_>, impacts: &mut Restitution, room: &mut Room) -> u32 {
    impacts.clear();
    let (mut any, mut count) = (false, 0);
    for pair in input.pairs {
        each_spot(input, pair, &mut |spot| {
            any |= input.closes(&spot);
            count += 1;
            true
        });
    }
    // Whether anything closes or not: a scene past its densest moment does not grow any more.
    room.fit(&mut impacts.spots, count);
    room.fit(&mut impacts.sites, count);
    room.fit(&mut impacts.queue, count);
    room.fit(&mut impacts.wakeful, count);
    room.fit(&mut impacts.struck, input.bodies.dynamic());
    room.fit(&mut impacts.moved, input.bodies.dynamic());
    room.fit(&mut impacts.standing, input.bodies.dynamic());
    if !any {
        return 0;
    }
    let mut shed = 0;
    for pair in input.pairs {
        each_spot(input, pair, &mut |spot| {
            let spot = Spot { order: impacts.spots.len() as u32, ..spot };
            shed += u32::from(!room.push(&mut impacts.spots, spot));
            true
        });
    }
    let dynamic = input.bodies.dynamic() as u32;
    let pushed = |spot: &Spot| spot.pushed(dynamic);
    // By the bodies, and then in the order of the list, which has no two alike.
    let mut spots = std::mem::take(&mut impacts.spots);
    spots.sort_unstable_by_key(|spot| (pushed(spot), spot.order));
    let place = room.fit(&mut impacts.struck, dynamic as usize);
    let place = place.min(room.fit(&mut impacts.moved, dynamic as usize));
    let place = place.min(room.fit(&mut impacts.standing, dynamic as usize));
    if place < dynamic as usize {
        impacts.spots = spots;
        impacts.clear();
        return shed + 1;
    }
    let joints = input.joints;
    let struck = |i: u32| Struck {
        first: Link::NONE,
        joined: joints.has_any(input.bodies.slot[i as usize]),
        bounced: false,
        moved: Record::default(),
        listed: false,
        stands: false,
        kept: Record::default(),
        pull: Record::default(),
        turned: None,
    };
    impacts.struck.extend((0..dynamic).map(struck));
    let mut first = 0;
    for group in spots.chunk_by(|x, y| pushed(x) == pushed(y)) {
        let bodies = pushed(&group[0]);
        let wakeful = group.iter().any(|spot| input.closes(spot));
        let site = Site {
            first,
            count: group.len() as u32,
            bodies,
            next: [Link::NONE; 2],
            time: f32::INFINITY,
            approach: 0.0,
            place: NONE,
            hits: 0,
            wakeful,
        };
        first += group.len() as u32;
        let index = impacts.sites.len();
        let fits = room.fit(&mut impacts.queue, index + 1) > index
            && room.fit(&mut impacts.wakeful, index + 1) > index
            && room.push(&mut impacts.sites, site);
        if !fits {
            shed += group.len() as u32;
            continue;
        }
        if wakeful {
            impacts.wakeful.push(index as u32);
        }
        for (side, body) in bodies.into_iter().enumerate() {
            if let Some(struck) = impacts.struck.get_mut(body as usize) {
                let link = Link { site: index as u32, side: side as u32 };
                impacts.sites[index].next[side] = std::mem::replace(&mut struck.first, link);
            }
        }
    }
    impacts.spots = spots;
    shed
}

/// Calls `f` with the points of a pair that have restitution, until it says no.
fn each_spot(input: &FindInput<'_>, pair: &Pair, f: &mut dyn FnMut(Spot) -> bool) {
    let pushed = |c: u32| (input.colliders[c as usize].body as usize) < input.bodies.dynamic();
    if pair.contact == crate::narrow_phase::NONE || !(pushed(pair.a) || pushed(pair.b)) {
        return;
    }
    let [x, y] = [pair.a, pair.b].map(|c| &input.colliders[c as usize].material);
    let restitution = x.restitution_with(y);
    if restitution <= 0.0 && input.tweaks.is_empty() {
        return;
    }
    let friction = x.friction_with(y);
    let mut slot = pair.contact;
    while let Some(contact) = input.contacts.get(slot as usize) {
        let tweak = tweak_of(input.tweaks, slot as usize);
        let (restitution, friction) = (tweak.restitution_or(restitution), tweak.friction_or(friction).1);
        let shape = &input.poses[contact.a as usize];
        let bodies = [contact.a, contact.b].map(|c| input.colliders[c as usize].body);
        let [at_a, at_b] = bodies.map(|body| input.bodies.pose[body as usize].position);
        let normal = shape.rotation * contact.normal;
        let from_centre = (shape.position - at_a).as_vec3();
        let mut apart = (at_a - at_b).as_vec3();
        if contact.fraction > 0.0 {
            // Found at the touch, so the arms are those of the touch.
            let [moved_a, moved_b] =
                bodies.map(|body| input.motion.get(body as usize).map_or(Vec3::ZERO, |m| m.linear));
            apart += (moved_a - moved_b) * contact.fraction;
        }
        for point in contact.points() {
            let arm = shape.rotation * point.position + from_centre;
            // Midway between the surfaces as they were found; they touch each with its own.
            let half = if contact.fraction > 0.0 { Vec3::ZERO } else { normal * (0.5 * point.found) };
            let spot = Spot {
                bodies,
                normal,
                arms: [arm - half, arm + apart + half],
                separation: point.separation,
                restitution,
                friction,
                slot,
                order: 0,
            };
            if restitution > 0.0 && !f(spot) {
                return;
            }
        }
        slot = contact.next;
    }
}

impl FindInput<'_> {
    /// Whether a point may close within the step, fast enough to bounce; or within the next, if others of its manifold touch
    /// in this one: rows that touch come to rest as a whole.
    fn closes(&self, spot: &Spot) -> bool {
        let pull = spot.speed(|body| self.acceleration.get(body).copied().unwrap_or_default());
        let speed = spot.speed(|body| self.bodies.velocity.get(body).copied().unwrap_or_default());
        let approach = -speed + (-pull * self.dt).max(0.0);
        approach > self.threshold && spot.separation - 2.0 * approach * self.dt <= self.real
    }
}

impl Spot {
    /// How fast the second body moves away from the first along the normal, by the velocities that `of` says.
    pub(super) fn speed(&self, of: impl Fn(usize) -> Record) -> f32 {
        self.normal.dot(self.slip(of))
    }

    /// How fast the point of the second body moves past that of the first.
    pub(super) fn slip(&self, of: impl Fn(usize) -> Record) -> Vec3 {
        let [a, b] = [0, 1].map(|side| {
            let v = of(self.bodies[side] as usize);
            v.linear + v.angular.cross(self.arms[side])
        });
        b - a
    }

    /// The bodies that an impact changes, in an order of their own; the second is [`NONE`] if nothing moves the other.
    fn pushed(&self, dynamic: u32) -> [u32; 2] {
        let [a, b] = self.bodies.map(|body| if body < dynamic { body } else { NONE });
        [a.min(b), a.max(b)]
    }
}
