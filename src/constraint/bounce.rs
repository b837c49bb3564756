//! Restitution: impacts come first, with the velocities of the step before.
//!
//! A potential point takes away just the velocity that would cross, so that a fast body ends its step on the surface;
//! it has no restitution. In the next step the point is real and gives back `e` times the *previous* approach speed
//! (Vincent Robert's talk), here corrected by the work that acceleration did on the way to the surface, so that a
//! ball rises to e² of its height whatever the step. Impacts are few, so they are solved one by one, before the
//! substeps; what must not move into each other is then the substeps' business.

use super::prepare::GONE;
use crate::body::{Bodies, Pose};
use crate::broad_phase::Pair;
use crate::events::{Tweak, tweak_of};
use crate::lanes::{Record, Sym3};
use crate::memory::Room;
use crate::narrow_phase::{Contact, NONE};
use crate::shape::Collider;
use glam::Vec3;

/// A point that has to bounce.
#[derive(Clone, Copy, Debug)]
struct Impact {
    a: u32,
    b: u32,
    /// Of the contact.
    slot: u32,
    normal: Vec3,
    /// From the bodies' centres [m].
    ra: Vec3,
    rb: Vec3,
    /// Those x normal.
    arm_a: Vec3,
    arm_b: Vec3,
    /// Coefficient.
    friction: f32,
    /// Effective mass [kg].
    mass: f32,
    /// Separating speed to reach [m/s].
    target: f32,
    impulse: f32,
}

/// Buffers of one step.
#[derive(Debug, Default)]
pub(crate) struct BounceScratch {
    impacts: Vec<Impact>,
}

impl BounceScratch {
    pub(crate) fn bytes(&self) -> (usize, usize) {
        crate::memory::bytes_of(&self.impacts)
    }
}

/// What bouncing reads.
pub(crate) struct BounceInput<'a> {
    pub(crate) colliders: &'a [Collider],
    pub(crate) poses: &'a [Pose],
    pub(crate) pairs: &'a [Pair],
    pub(crate) inverse_inertia: &'a [Sym3<f32>],
    /// Acceleration of each body that can move.
    pub(crate) acceleration: &'a [Record],
    pub(crate) real: f32,
    /// Approach speeds below this don't bounce [m/s].
    pub(crate) threshold: f32,
    pub(crate) iterations: u32,
    /// What hooks said of each contact; empty if there are none.
    pub(crate) tweaks: &'a [Tweak],
}

/// Finds the impacts of this step and applies their impulses; adds these to those of their contacts, where these are kept.
/// Returns how many, and how many there was no room for.
pub(crate) fn bounce(
    input: &BounceInput<'_>,
    contacts: &mut [Contact],
    (bodies, impulses): (&mut Bodies, &mut [f32]),
    scratch: &mut BounceScratch,
    room: &mut Room,
) -> (usize, u32) {
    let mut shed = 0;
    scratch.impacts.clear();
    for pair in input.pairs {
        if pair.contact == NONE {
            continue;
        }
        let material = |c: u32| &input.colliders[c as usize].material;
        let restitution = material(pair.a).restitution_with(material(pair.b));
        if restitution <= 0.0 && input.tweaks.is_empty() {
            continue;
        }
        let friction = material(pair.a).friction_with(material(pair.b));
        let mut slot = pair.contact;
        while slot != NONE {
            let contact = &mut contacts[slot as usize];
            let next = contact.next;
            let tweak = tweak_of(input.tweaks, slot as usize);
            let (restitution, friction) = (tweak.restitution_or(restitution), tweak.friction_or(friction).1);
            let found = (restitution, friction, slot);
            find(input, contact, found, bodies, |impact| {
                let fits = room.push(&mut scratch.impacts, impact);
                shed += u32::from(!fits);
                fits
            });
            slot = next;
        }
    }
    // The hardest impact last: it is obeyed best.
    scratch.impacts.sort_by(|x, y| x.target.total_cmp(&y.target));
    for _ in 0..input.iterations {
        for impact in &mut scratch.impacts {
            solve(impact, input, bodies);
        }
    }
    for impact in &scratch.impacts {
        rub(impact, input, bodies);
        if let Some(sum) = impulses.get_mut(impact.slot as usize) {
            *sum += impact.impulse;
        }
    }
    (scratch.impacts.len(), shed)
}

fn find(
    input: &BounceInput<'_>,
    contact: &mut Contact,
    (restitution, friction, slot): (f32, f32, u32),
    bodies: &Bodies,
    mut add: impl FnMut(Impact) -> bool,
) {
    if restitution <= 0.0 {
        return;
    }
    let (a, b) = (input.colliders[contact.a as usize].body, input.colliders[contact.b as usize].body);
    let shape = &input.poses[contact.a as usize];
    let (pose_a, pose_b) = (&bodies.pose[a as usize], &bodies.pose[b as usize]);
    let normal = shape.rotation * contact.normal;
    let struck = contact.struck;
    let mut bounced = false;
    for point in &mut contact.points[..contact.count as usize] {
        if point.separation > input.real {
            continue;
        }
        let from_shape = shape.rotation * point.position;
        let ra = from_shape + (shape.position - pose_a.position).as_vec3();
        let rb = ra + (pose_a.position - pose_b.position).as_vec3();
        let speed = |v: &Bodies| {
            let at = |body: u32, r: Vec3| {
                v.velocity.get(body as usize).map_or(Vec3::ZERO, |v| v.linear + v.angular.cross(r))
            };
            -normal.dot(at(b, rb) - at(a, ra))
        };
        let mut approach = speed(bodies);
        if struck {
            approach = approach.max(previous_approach(input, bodies, normal, (a, ra), (b, rb)));
        }
        if approach <= input.threshold {
            continue;
        }
        let (arm_a, arm_b) = (ra.cross(normal), rb.cross(normal));
        let inertia = |body: u32, arm: Vec3| {
            input.inverse_inertia.get(body as usize).map_or(0.0, |i| arm.dot(apply(i, arm)))
        };
        let mass = |body: u32| inverse_mass(bodies, body, normal);
        let k = mass(a) + mass(b) + inertia(a, arm_a) + inertia(b, arm_b);
        if k > GONE * (bodies.mass[a as usize].inverse + bodies.mass[b as usize].inverse) {
            let mass = 1.0 / k;
            let target = restitution * approach;
            let impact =
                Impact { a, b, slot, normal, ra, rb, arm_a, arm_b, friction, mass, target, impulse: 0.0 };
            if add(impact) {
                (point.impulse, point.held) = (0.0, 0.0);
                bounced = true;
            }
        }
    }
    if bounced {
        (contact.friction, contact.twist) = (Vec3::ZERO, 0.0);
    }
}

/// Approach speed at the moment the gap closed in the last step: v² + 2 a d.
fn previous_approach(
    input: &BounceInput<'_>,
    bodies: &Bodies,
    normal: Vec3,
    (a, ra): (u32, Vec3),
    (b, rb): (u32, Vec3),
) -> f32 {
    let previous = |body: u32| bodies.previous.get(body as usize).copied().unwrap_or_default();
    let acceleration = |body: u32| input.acceleration.get(body as usize).map_or(Vec3::ZERO, |a| a.linear);
    let (pa, pb) = (previous(a), previous(b));
    let speed = -normal.dot(pb.linear + pb.angular.cross(rb) - pa.linear - pa.angular.cross(ra));
    let closed = -normal.dot(pb.moved - pa.moved);
    let pull = -normal.dot(acceleration(b) - acceleration(a));
    let squared = speed * speed.abs() + 2.0 * pull * closed.max(0.0);
    squared.max(0.0).sqrt()
}

fn solve(impact: &mut Impact, input: &BounceInput<'_>, bodies: &mut Bodies) {
    let n = impact.normal;
    let at = |body: u32, arm: Vec3| {
        bodies.velocity.get(body as usize).map_or(0.0, |v| n.dot(v.linear) + arm.dot(v.angular))
    };
    let speed = at(impact.b, impact.arm_b) - at(impact.a, impact.arm_a);
    let new = (impact.impulse + impact.mass * (impact.target - speed)).max(0.0);
    let change = new - impact.impulse;
    impact.impulse = new;
    push(impact, input, bodies, n * change, [impact.arm_a * change, impact.arm_b * change]);
}

/// Friction of the impulse that sends a point back: against the slip, and no more than stops it. What stopped the point had
/// its friction in the step before (`impact_friction.rs`).
fn rub(impact: &Impact, input: &BounceInput<'_>, bodies: &mut Bodies) {
    let at = |body: u32, r: Vec3| {
        bodies.velocity.get(body as usize).map_or(Vec3::ZERO, |v| v.linear + v.angular.cross(r))
    };
    let u = (at(impact.b, impact.rb) - at(impact.a, impact.ra)).reject_from_normalized(impact.normal);
    let Some(way) = u.try_normalize() else { return };
    let ease = |body: u32, r: Vec3| {
        let turned = r.cross(way);
        input
            .inverse_inertia
            .get(body as usize)
            .map_or(0.0, |i| inverse_mass(bodies, body, way) + turned.dot(apply(i, turned)))
    };
    let k = ease(impact.a, impact.ra) + ease(impact.b, impact.rb);
    if k > 0.0 {
        let q = way * -(impact.friction * impact.impulse).min(u.length() / k);
        push(impact, input, bodies, q, [impact.ra.cross(q), impact.rb.cross(q)]);
    }
}

/// Applies an impulse `p` on `b` and `-p` on `a`, with what they turn.
fn push(impact: &Impact, input: &BounceInput<'_>, bodies: &mut Bodies, p: Vec3, [ta, tb]: [Vec3; 2]) {
    for (body, p, t) in [(impact.a, -p, -ta), (impact.b, p, tb)] {
        if let Some(inertia) = input.inverse_inertia.get(body as usize) {
            let inverse = bodies.mass[body as usize].inverse;
            let velocity = &mut bodies.velocity[body as usize];
            velocity.linear += bodies.traits[body as usize].free(p) * inverse;
            velocity.angular += apply(inertia, t);
        }
    }
}

/// Of a body, along a direction [1/kg]: none of its locked axes.
fn inverse_mass(bodies: &Bodies, body: u32, along: Vec3) -> f32 {
    let (mass, traits) = (bodies.mass[body as usize].inverse, &bodies.traits[body as usize]);
    if traits.locks == 0 { mass } else { traits.free(along).length_squared() * mass }
}

fn apply(inertia: &Sym3<f32>, v: Vec3) -> Vec3 {
    inertia.mul(crate::lanes::Vec3::new(v.x, v.y, v.z)).lane(0)
}
