//! Finds the sites of possible impacts among the contacts of a step.

use super::{Link, NONE, Restitution, Site, Spot, Struck};
use crate::broad_phase::Pair;
use crate::config::Measures;
use crate::constraint::contact::input::PrepareInput;
use crate::constraint::tweak_of;
use crate::lanes::Record;
use crate::memory::Allowance;
use crate::narrow_phase::NO_CONTACT;
use glam::Vec3;

/// Lists the points with restitution, if any of them closes within the step. Returns for how many there was
/// no room.
pub(crate) fn find(input: &PrepareInput<'_>, impacts: &mut Restitution, allowance: &mut Allowance) -> u32 {
    impacts.clear();
    let (mut any, mut count) = (false, 0);
    for pair in input.pairs {
        each_spot(input, pair, &mut |spot| {
            any |= input.closes(&spot);
            count += 1;
        });
    }
    let dynamic = input.bodies.dynamic();
    if count == 0 {
        return 0;
    }
    // Reserved even if nothing closes: so a scene past its densest moment does not grow any more.
    let of_bodies = [
        allowance.fit(&mut impacts.struck, dynamic),
        allowance.fit(&mut impacts.moved, dynamic),
        allowance.fit(&mut impacts.standing, dynamic),
    ];
    let place = allowance
        .fit(&mut impacts.spots, count)
        .min(allowance.fit(&mut impacts.sites, count))
        .min(allowance.fit(&mut impacts.queue, count))
        .min(allowance.fit(&mut impacts.wakeful, count));
    if !any {
        return 0;
    }
    if of_bodies != [dynamic; 3] {
        return count as u32;
    }
    for pair in input.pairs {
        each_spot(input, pair, &mut |spot| {
            if impacts.spots.len() < place {
                impacts.spots.push(Spot { order: impacts.spots.len() as u32, ..spot });
            }
        });
    }
    // By bodies, and then in the order of the list, which is unique.
    let pushed = |spot: &Spot| spot.pushed(dynamic as u32);
    impacts.spots.sort_unstable_by_key(|spot| (pushed(spot), spot.order));
    list_bodies(input, impacts);
    list_sites(input, impacts);
    (count - place) as u32
}

/// Lists all dynamic bodies.
fn list_bodies(input: &PrepareInput<'_>, impacts: &mut Restitution) {
    let struck = |i: u32| Struck {
        first: Link::NONE,
        joined: input.joints.has_any(input.bodies.slot[i as usize]),
        bounced: false,
        moved: Record::default(),
        listed: false,
        stands: false,
        velocity_after: Record::default(),
        pull: Record::default(),
        turned: None,
    };
    impacts.struck.extend((0..input.bodies.dynamic() as u32).map(struck));
}

/// Makes a site of all points of the same bodies, and links it to these.
fn list_sites(input: &PrepareInput<'_>, impacts: &mut Restitution) {
    let pushed = |spot: &Spot| spot.pushed(input.bodies.dynamic() as u32);
    let mut first = 0;
    let spots = std::mem::take(&mut impacts.spots);
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
        impacts.sites.push(site);
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
}

/// Calls `f` with the points of a pair that have restitution.
fn each_spot(input: &PrepareInput<'_>, pair: &Pair, f: &mut dyn FnMut(Spot)) {
    let pushed = |c: u32| (input.colliders.all[c as usize].body as usize) < input.bodies.dynamic();
    if pair.contact == NO_CONTACT || !(pushed(pair.a) || pushed(pair.b)) {
        return;
    }
    let [x, y] = [pair.a, pair.b].map(|c| &input.colliders.all[c as usize]);
    let law = |part: u8| {
        let (x, y) = (&x.material, &y.surface(part));
        (x.restitution_with(y), x.friction_with(y))
    };
    let own = law(0);
    if own.0 <= 0.0 && input.tweaks.is_empty() && y.geometry.materials().is_empty() {
        return;
    }
    for (slot, contact) in input.contacts.chain(pair.contact) {
        // The spring of a soft contact throws bodies back by itself.
        if x.is_soft(0) || y.is_soft(contact.material) {
            continue;
        }
        let tweak = tweak_of(input.tweaks, slot as usize);
        let (restitution, friction) = if contact.material == 0 { own } else { law(contact.material) };
        let (restitution, friction) = (tweak.restitution_or(restitution), tweak.friction_or(friction).1);
        let shape = &input.colliders.poses[contact.a as usize];
        let bodies = [contact.a, contact.b].map(|c| input.colliders.all[c as usize].body);
        let [at_a, at_b] = bodies.map(|body| input.bodies.pose[body as usize].position);
        let normal = shape.rotation * contact.normal;
        let from_centre = (shape.position - at_a).as_vec3();
        let mut apart = (at_a - at_b).as_vec3();
        if contact.fraction > 0.0 {
            // The contact was found at the time of touch, and so are the arms.
            let [moved_a, moved_b] =
                bodies.map(|body| input.forces.motion.get(body as usize).map_or(Vec3::ZERO, |m| m.linear));
            apart += (moved_a - moved_b) * contact.fraction;
        }
        for point in contact.points() {
            let arm = shape.rotation * point.position + from_centre;
            // The point is midway between the surfaces as they were found; each body touches with its own
            // surface.
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
            if restitution > 0.0 {
                f(spot);
            }
        }
    }
}

impl PrepareInput<'_> {
    /// Whether a point may close within the step, fast enough to bounce; or within the next, if others of its
    /// manifold touch in this one: rows of a touching manifold come to rest as a whole.
    fn closes(&self, spot: &Spot) -> bool {
        let (dt, Measures { bounce_speed, touch, .. }) = (self.lengths.dt(), self.measures);
        let pull = spot.speed(|body| self.forces.acceleration.get(body).copied().unwrap_or_default());
        let speed = spot.speed(|body| self.bodies.velocity.get(body).copied().unwrap_or_default());
        let approach = -speed + (-pull * dt).max(0.0);
        approach > bounce_speed && spot.separation - 2.0 * approach * dt <= touch
    }
}

impl Spot {
    /// Separating speed along the normal; `of`: velocity of a body.
    pub(super) fn speed(&self, of: impl Fn(usize) -> Record) -> f32 {
        self.normal.dot(self.slip(of))
    }

    /// Velocity of the second body's point relative to that of the first.
    pub(super) fn slip(&self, of: impl Fn(usize) -> Record) -> Vec3 {
        let [a, b] = [0, 1].map(|side| {
            let v = of(self.bodies[side] as usize);
            v.linear + v.angular.cross(self.arms[side])
        });
        b - a
    }

    /// The bodies that an impact changes, sorted; the second is [`NONE`] if only one is dynamic.
    fn pushed(&self, dynamic: u32) -> [u32; 2] {
        let [a, b] = self.bodies.map(|body| if body < dynamic { body } else { NONE });
        [a.min(b), a.max(b)]
    }
}
