//! Statics: the loads of contacts that are new in a structure at rest, from the top down.
//!
//! Gauss-Seidel passes a load on by one contact in each pass over the rows, so a tower that is placed without
//! known loads sinks into its contacts, by half a metre if it is high, before its lowest rows know of its
//! weight; and if it sinks unevenly it leans. So the loads of new contacts are estimated: bodies are visited
//! from the highest to the lowest, and each passes its weight and the load on it to the contacts below it.
//! Shock propagation uses the same order (Guendelman et al., *Nonconvex Rigid Bodies with Stacking*, 2003),
//! but decides velocities; here the estimate is only where the solver starts (docs/decisions/statics.md).

mod again;
mod distribute;
mod supports;

use crate::body::{Bodies, Colliders};
use crate::broad_phase::Pair;
use crate::config::Settings;
use crate::config::tuning::REST_STEPS_OF_FALL;
use crate::constraint::StepLengths;
use crate::lanes::Record;
use crate::memory::{Allowance, Allowances, Category, buffers, bytes_of};
use crate::narrow_phase::{CHANGED_LOAD, ContactMut, ContactRef, Contacts};
pub(crate) use again::Remains;
use distribute::{PointLoad, distribute, with_friction};
use glam::{DVec3, Vec3};

/// Finding new contacts means checking all of them, so after a search as many steps pass as there are so many
/// pairs, up to a maximum.
const PAIRS_PER_STEP: usize = 64;
pub(crate) const LONGEST_WAIT: u32 = 16;
/// Initial capacity for the points below a body.
const POINTS: usize = 64;
/// In [`Statics::places`]: the body has no new contacts.
const NOWHERE: u32 = u32::MAX;

/// State and buffers that are kept from step to step.
#[derive(Debug, Default)]
pub(crate) struct Statics {
    /// Steps until the next estimate may be made.
    pub(crate) wait: u32,
    /// Some contact bears an unknown load, or may come to.
    pub(crate) pending: bool,
    /// For each dynamic body its index in `burdens`, or [`NOWHERE`].
    places: Vec<u32>,
    /// Bodies above and below new contacts.
    burdens: Vec<Burden>,
    /// Their indices, from the lowest to the highest.
    by_height: Vec<u32>,
    /// Sorted by the supported body.
    supports: Vec<Support>,
    points: Vec<PointLoad>,
}

/// The load on the new contacts below a body.
#[derive(Clone, Copy, Debug, Default)]
struct Burden {
    body: u32,
    /// The first of its supports, and their number.
    first: u32,
    count: u32,
    /// Whether a static or kinematic body supports it, directly or through others.
    supported: bool,
    force: Vec3,
    /// About its centre of mass.
    moment: Vec3,
}

/// A new contact that supports a body.
#[derive(Clone, Copy, Debug, Default)]
struct Support {
    /// The supported body, and the supporting one.
    upper: u32,
    lower: u32,
    contact: u32,
    /// Its number in the order of pairs: contacts may have other indices after a snapshot is restored.
    number: u32,
    /// Whether the supported body is the contact's `a`.
    is_a: bool,
}

/// Limits below which a body counts as resting.
#[derive(Clone, Copy, Debug)]
struct Rest {
    up: Vec3,
    /// Separation up to which points touch [m].
    touching: f32,
    /// Approach speed and slip speed [m/s].
    closing: f32,
    slip: f32,
    /// Length of the substep in which impulses act [s].
    h: f32,
}

buffers! {
    Statics {
        each(dynamic: usize) { places(dynamic), burdens(dynamic), by_height(dynamic) }
        missing(contacts: usize) { supports(contacts), points(POINTS) }
    }
}

impl Statics {
    #[cfg(debug_assertions)]
    pub(crate) fn spoil(&mut self) {
        use crate::memory::spoil;
        let Statics { wait: _, pending: _, places, burdens, by_height, supports, points } = self;
        [places, by_height].into_iter().for_each(spoil);
        spoil(burdens);
        spoil(supports);
        spoil(points);
    }

    /// Bytes that a contact takes, and bytes reserved for contacts.
    pub(crate) fn lists(&self) -> (usize, usize) {
        (size_of::<Support>(), bytes_of(&self.supports).1)
    }

    fn reserve(&mut self, dynamic: usize, contacts: usize, allowance: &mut Allowance) -> bool {
        allowance.fit(&mut self.places, dynamic) == dynamic
            && allowance.fit(&mut self.burdens, dynamic) == dynamic
            && allowance.fit(&mut self.by_height, dynamic) == dynamic
            && allowance.fit(&mut self.supports, contacts) == contacts
            && allowance.fit(&mut self.points, POINTS) == POINTS
    }
}

/// The bodies of a step, and the contacts that support them.
pub(crate) struct Structure<'a> {
    pub(crate) bodies: &'a Bodies,
    pub(crate) colliders: &'a Colliders,
    pub(crate) pairs: &'a [Pair],
    pub(crate) contacts: &'a mut Contacts,
    /// For each movable body; empty if nothing accelerates them [m/s²].
    pub(crate) acceleration: &'a [Record],
}

impl Statics {
    /// Estimates unknown loads, before rows are made.
    pub(crate) fn estimate(
        &mut self,
        structure: &mut Structure<'_>,
        settings: &Settings,
        lengths: StepLengths,
        allowances: &mut Allowances,
    ) {
        let gravity = settings.gravity.length();
        if gravity == 0.0 || !settings.warm_starting {
            return;
        }
        let (dynamic, contacts) = (structure.bodies.dynamic(), structure.contacts.capacity().contacts);
        self.wait = self.wait.saturating_sub(1);
        // Reserved in every step: an estimate in a scene that settled long ago must not be the first to
        // allocate.
        let fits =
            allowances.within(Category::Scratch, |allowance| self.reserve(dynamic, contacts, allowance));
        if !self.pending || self.wait > 0 {
            return;
        }
        let measures = settings.measures();
        let rest = Rest {
            up: settings.gravity / -gravity,
            touching: measures.slop,
            closing: REST_STEPS_OF_FALL * gravity * lengths.dt(),
            slip: measures.static_slip_speed,
            h: lengths.last(),
        };
        if fits && structure.find_supports(self, &rest) {
            structure.add_known_loads(self, &rest);
            structure.find_supported(self, &rest);
            allowances.within(Category::Scratch, |allowance| structure.hand_down(self, &rest, allowance));
        }
        let wait = (structure.pairs.len() / PAIRS_PER_STEP) as u32;
        (self.wait, self.pending) = (wait.clamp(1, LONGEST_WAIT), false);
    }
}

impl Structure<'_> {
    /// Passes the load of each supported body to the new contacts below it.
    fn hand_down(&mut self, statics: &mut Statics, rest: &Rest, allowance: &mut Allowance) {
        let Statics { places, burdens, by_height, supports, points, .. } = statics;
        let axes = rest.up.any_orthonormal_pair().into();
        for &place in by_height.iter().rev() {
            let Burden { body, first, count, supported, force, moment } = burdens[place as usize];
            if !supported {
                continue;
            }
            let supports = &supports[first as usize..(first + count) as usize];
            let centre = self.bodies.pose[body as usize].position;
            points.clear();
            for support in supports {
                if !is_supported(support.lower, places, burdens) {
                    continue;
                }
                let contact = self.contacts.at(support.contact);
                let origin = self.origin(contact, support.is_a, centre);
                let below = match places.get(support.lower as usize) {
                    Some(_) => self.bodies.pose[support.lower as usize].position,
                    None => centre,
                };
                let to_below = if contact.static_load == CHANGED_LOAD {
                    self.origin(contact, !support.is_a, below) - origin
                } else {
                    (centre - below).as_vec3()
                };
                let push = with_friction(support.upwards(contact), rest.up, self.friction(contact));
                for (i, point) in contact.points().iter().enumerate() {
                    let arm = origin + contact.frame * point.position;
                    let load = PointLoad {
                        contact: support.contact,
                        point: i as u32,
                        lower: support.lower,
                        push,
                        arm,
                        arm_below: to_below + arm,
                        ..PointLoad::default()
                    };
                    if point.separation <= rest.touching && !allowance.push(points, load) {
                        return;
                    }
                }
            }
            distribute(points, -force, -moment, rest.up, axes);
            for point in points.iter() {
                let Some(&lower) = places.get(point.lower as usize) else { continue };
                burdens[lower as usize].add(point.push * -point.force, point.arm_below);
            }
            for forces in points.chunk_by(|x, y| x.contact == y.contact) {
                assume(&mut self.contacts.at_mut(forces[0].contact), forces, rest);
            }
        }
    }

    /// Its coefficient of static friction.
    fn friction(&self, contact: ContactRef<'_>) -> f32 {
        let [a, b] = [contact.a, contact.b].map(|c| &self.colliders.all[c as usize]);
        a.material.friction_with(&b.surface(contact.material)).0
    }

    /// From a body's centre of mass to the point from which its contact's points are counted; `is_a`: the
    /// body is the contact's `a`. Of a contact that is weighed again it is where the rows have it: as if the
    /// bodies had not moved past each other since it was found. A leaning tower would otherwise get the
    /// forces that hold its lean, of which the rows know nothing, and swing to the other side, on weak
    /// springs further than it leaned. For all contacts that is worse: heaps of chairs slip on for a minute.
    fn origin(&self, contact: ContactRef<'_>, is_a: bool, centre: DVec3) -> Vec3 {
        let from = |collider: u32| (self.colliders.poses[collider as usize].position - centre).as_vec3();
        if is_a || contact.static_load != CHANGED_LOAD {
            from(contact.a)
        } else {
            from(contact.b) - contact.frame * contact.found_at.position
        }
    }
}

impl Burden {
    /// Adds a force [N] at a point, from the centre of mass [m].
    fn add(&mut self, force: Vec3, arm: Vec3) {
        self.force += force;
        self.moment += arm.cross(force);
    }
}

impl Support {
    /// The direction in which it pushes the supported body.
    fn upwards(&self, contact: ContactRef<'_>) -> Vec3 {
        contact.frame * contact.normal * if self.is_a { -1.0 } else { 1.0 }
    }
}

/// Whether a body below a new contact can support anything: a static or kinematic one, or one supported by
/// such.
fn is_supported(body: u32, places: &[u32], burdens: &[Burden]) -> bool {
    places.get(body as usize).is_none_or(|&place| burdens[place as usize].supported)
}

/// Velocity of a body's point at `at` [m/s]; zero for a static body.
fn point_velocity(bodies: &Bodies, body: usize, at: DVec3) -> Vec3 {
    let still = body >= bodies.movers();
    let Record { linear, angular, .. } = if still { Record::default() } else { bodies.velocity[body] };
    linear + angular.cross((at - bodies.pose[body].position).as_vec3())
}

/// Starts a contact with the estimated forces of its points.
fn assume(contact: &mut ContactMut<'_>, forces: &[PointLoad], rest: &Rest) {
    let load: f32 = forces.iter().map(|p| p.force).sum();
    if load > 0.0 {
        contact.points_mut().iter_mut().for_each(|point| point.share = 0.0);
        for &PointLoad { point, force, .. } in forces {
            contact.points_mut()[point as usize].share = force / load;
        }
    }
    let borne = contact.as_ref().bears() / rest.h;
    contact.expect(load, borne, rest.touching);
    if borne < load {
        let missing = (load - borne) / load;
        for &PointLoad { point, force, .. } in forces {
            contact.points_mut()[point as usize].impulse += force * missing * rest.h;
        }
    }
}
