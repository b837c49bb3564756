//! The last line: the path of a body's centre never crosses static geometry.
//!
//! Potential points stop fast bodies, and do so well, but they are planes that the solver obeys only as far
//! as its iterations and the other rows allow. A body on the wrong side of a wall must never happen, so it is
//! checked on the path that a body really takes: if the segment from its old centre to its new one enters
//! static geometry, the motion is cut there. A body that was on the right side thus stays there, step after
//! step, under any push; and since its centre is on the right side, contacts push the rest of it out. The
//! check is one query of the box around the path, and a segment query if that is not empty, for each body
//! that moved further than a share of its inner ball, or further than it is known to be clear of static
//! geometry. A body at rest or creeping is checked seldom, but however slowly it is pressed, it does not get
//! through. The report counts bodies whose path was cut, and those whose end was lifted off a surface.
//!
//! Two dynamic bodies on a collision course are checked in the same way, and both stop on their paths.
//! Potential points do that exactly for one pair; where many fast bodies meet at once, a few iterations
//! don't.
//!
//! A kinematic body moves, so the path is checked in that body's frame, from its old pose to its new one, and
//! a body that is overrun is carried along.

use crate::body::{Bodies, Pose, Traits};
use crate::broad_phase::{BroadPhase, Pair};
use crate::config::ContinuousMode;
use crate::config::tuning::{GUARD_DISTANCE, GUARD_GRAZE, GUARD_HOLLOW};
use crate::joint::Joints;
use crate::lanes::Record;
use crate::math::Quat;
use crate::narrow_phase::{Relative, Support, distance, from_triangle, segment_hits};
use crate::shape::{Collider, ColliderSummary};
use glam::{DVec3, Vec3};

/// Input of the guard.
pub(crate) struct Guard<'a> {
    pub(crate) broad: &'a BroadPhase,
    pub(crate) colliders: &'a [Collider],
    pub(crate) summaries: &'a [ColliderSummary],
    pub(crate) poses: &'a [Pose],
    pub(crate) mode: ContinuousMode,
    /// Whether paths are cut and ends lifted where contacts failed.
    pub(crate) cuts: bool,
    /// Whether any shape is a sensor.
    pub(crate) senses: bool,
    /// Pairs that hooks let pass through each other, sorted.
    pub(crate) vetoed: &'a [(u32, u32)],
    pub(crate) joints: &'a Joints,
    /// Slot of each body: joints refer to bodies by it.
    pub(crate) slots: &'a [u32],
}

/// How the guard changed a body's path.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Held {
    /// The path was cut where it entered something.
    Cut,
    /// It entered nothing; its end was lifted off a surface.
    Lifted,
}

/// Number of bodies that the guard held, by the kind of hold.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct Counts {
    pub(crate) cut: u32,
    pub(crate) lifted: u32,
    /// Bodies off their predicted path that were led along a surface or moved out of it.
    pub(crate) settled: u32,
}

impl Guard<'_> {
    /// Radius of a ball that fits into the body [m].
    pub(super) fn inner(&self, own: &[u32]) -> f32 {
        own.iter().fold(0.0, |r, &c| r.max(self.inner_of(c)))
    }

    fn inner_of(&self, collider: u32) -> f32 {
        let c = &self.colliders[collider as usize];
        if c.is_sensor() {
            return 0.0;
        }
        if c.inner_radius > 0.0 { c.inner_radius } else { GUARD_HOLLOW * c.radius }
    }

    /// Whether a body bounces off others of its kind.
    pub(super) fn is_elastic(&self, own: &[u32]) -> bool {
        self.restitution(own) > 0.0
    }

    /// The greatest restitution of a body's surfaces.
    pub(super) fn restitution(&self, own: &[u32]) -> f32 {
        own.iter().fold(0.0, |most, &c| most.max(self.colliders[c as usize].material.restitution))
    }

    /// Whether a body has to be checked.
    pub(crate) fn wants(&self, traits: &Traits, own: &[u32]) -> bool {
        let solid = |&c: &u32| !self.colliders[c as usize].is_sensor();
        (if self.senses { own.iter().any(solid) } else { !own.is_empty() })
            && self.mode.of(traits.continuous) != ContinuousMode::Discrete
    }

    /// Distance of a point from the nearest static surface that `own` may collide with, and the direction
    /// away from it; `most` and no direction if there is none within that.
    pub(super) fn nearest(&self, stack: &mut Vec<u32>, own: &[u32], centre: DVec3, most: f32) -> (f32, Vec3) {
        let at = centre.as_vec3();
        let (mut least, mut away) = (most, Vec3::ZERO);
        self.broad.statics_on_path(stack, at, at, Vec3::splat(most), |c| {
            let (collider, pose) = (&self.colliders[c as usize], &self.poses[c as usize]);
            if !self.may_meet(own, c) {
                return;
            }
            let point = pose.rotation.conjugate() * (centre - pose.position).as_vec3();
            let tip = Support::triangle([point; 3]);
            let here = Relative::IDENTITY;
            let mut look = |gap: f32, normal: Vec3| {
                if gap < least {
                    (least, away) = (gap, pose.rotation * normal);
                }
            };
            let (low, high) = (point - most, point + most);
            if let Some(ground) = collider.geometry.ground() {
                ground.visit_box(low, high, &mut |_, corners| {
                    let from = from_triangle(point, corners);
                    look(from.length() as f32, from.normalize_or_zero().as_vec3());
                });
            } else if let Some(shape) = collider.geometry.support() {
                let gap = distance(&tip, &shape, &here, Vec3::ZERO);
                look(gap.distance.max(0.0), -gap.normal);
            } else {
                look(point.y.max(0.0), Vec3::Y);
            }
        });
        (least, away)
    }

    /// Cuts the motion where the centre would enter static geometry, and removes the velocity into it.
    /// Returns the kind of hold, and the normal of the surface at which it cut the motion.
    pub(crate) fn hold(
        &self,
        stack: &mut Vec<u32>,
        own: &[u32],
        from: DVec3,
        moved: &mut Vec3,
        velocity: &mut Record,
    ) -> Option<(Held, Vec3)> {
        let keep = GUARD_DISTANCE * self.inner(own);
        // Checked a little beyond the motion, so that the centre keeps its distance at the end too.
        let length = moved.length();
        let reach = *moved * (1.0 + keep / length);
        if self.is_free(stack, own, from, reach, GUARD_GRAZE * keep) {
            return None;
        }
        let Some((fraction, normal)) = self.first_static(stack, own, from, reach) else {
            return self
                .keep_off(stack, own, from, moved, GUARD_GRAZE * keep)
                .then_some((Held::Lifted, Vec3::ZERO));
        };
        let stop = stop(reach, length, keep, fraction, normal)?;
        *moved = reach * stop;
        // A path that grazes a surface ends closer to it, and a rounding error could later carry it through:
        // lift it.
        let above = (fraction - stop) * -reach.dot(normal);
        if above < 0.5 * keep {
            let lifted = *moved + normal * (keep - above);
            if self.first_static(stack, own, from, lifted).is_none() {
                *moved = lifted;
            }
        }
        let speed = velocity.linear.dot(normal);
        if speed < 0.0 {
            velocity.linear -= normal * speed;
        }
        Some((Held::Cut, normal))
    }

    /// A path along a surface that does not enter it may end so close that the next one begins on the other
    /// side, by rounding: such an end is lifted to `least` [m] from the surface. Returns whether it was.
    fn keep_off(&self, stack: &mut Vec<u32>, own: &[u32], from: DVec3, moved: &mut Vec3, least: f32) -> bool {
        let (gap, away) = self.nearest(stack, own, from + moved.as_dvec3(), least);
        if gap >= least {
            return false;
        }
        let lifted = *moved + away * (least - gap);
        let free = away != Vec3::ZERO && self.first_static(stack, own, from, lifted).is_none();
        *moved = if free { lifted } else { Vec3::ZERO };
        true
    }

    /// Whether a body and another one's shape collide at present: all of the body's solid shapes are
    /// considered, and joints that exclude the pair.
    pub(super) fn may_meet(&self, own: &[u32], other: u32) -> bool {
        let collider = |c: u32| &self.colliders[c as usize];
        let other_filter = &collider(other).filter;
        let meets = |&o: &u32| {
            collider(o).is_sensor() || collider(o).filter.allows(other_filter) && !self.is_vetoed(o, other)
        };
        !collider(other).is_sensor() && own.iter().all(meets) && !self.are_joined(own, other)
    }

    /// Whether a joint lets a body and another's shape pass through each other.
    fn are_joined(&self, own: &[u32], other: u32) -> bool {
        let slot = |c: u32| self.slots[self.summaries[c as usize].body as usize];
        self.joints.count > 0 && own.first().is_some_and(|&o| self.joints.keep_apart(slot(o), slot(other)))
    }

    fn is_vetoed(&self, one: u32, other: u32) -> bool {
        !self.vetoed.is_empty() && self.vetoed.binary_search(&(one.min(other), one.max(other))).is_ok()
    }

    /// Whether the bodies of a pair are to be kept apart.
    pub(super) fn parts(&self, pair: &Pair) -> bool {
        let sensor = |c: u32| self.colliders[c as usize].is_sensor();
        !(sensor(pair.a) || sensor(pair.b) || self.is_vetoed(pair.a, pair.b))
    }

    /// Where a path first enters static geometry: the share of the path, and the normal there.
    pub(super) fn first_static(
        &self,
        stack: &mut Vec<u32>,
        own: &[u32],
        from: DVec3,
        way: Vec3,
    ) -> Option<(f32, Vec3)> {
        let mut first: Option<(f32, Vec3)> = None;
        let (start, end) = (from.as_vec3(), (from + way.as_dvec3()).as_vec3());
        let slack = Vec3::splat(1e-6 * start.abs().max(end.abs()).max_element());
        self.broad.statics_on_path(stack, start, end, slack, |c| {
            let (collider, pose) = (&self.colliders[c as usize], &self.poses[c as usize]);
            if !self.may_meet(own, c) {
                return;
            }
            let back = pose.rotation.conjugate();
            let a = back * (from - pose.position).as_vec3();
            let b = a + back * way;
            if let Some(hit) = segment_hits(collider, a, b)
                && first.is_none_or(|(fraction, _)| hit.fraction < fraction)
            {
                first = Some((hit.fraction, pose.rotation * hit.normal));
            }
        });
        first
    }

    /// Keeps the centres of dynamic bodies on their side of the kinematic ones, all of which are at their new
    /// poses by now. Returns the number of bodies that it held.
    pub(crate) fn hold_kinematic(
        &self,
        pairs: &[Pair],
        bodies: &mut Bodies,
        stack: &mut Vec<u32>,
        dt: f32,
    ) -> u32 {
        let (dynamic, movers) = (bodies.dynamic(), bodies.movers());
        let mut held = 0;
        for pair in pairs {
            let body = |c: u32| self.summaries[c as usize].body as usize;
            let (mover, other) = if body(pair.a) < dynamic { (pair.a, pair.b) } else { (pair.b, pair.a) };
            let (i, k) = (body(mover), body(other));
            if i >= dynamic || k < dynamic || k >= movers || !self.parts(pair) {
                continue;
            }
            let wall = &self.colliders[other as usize];
            let old = &self.poses[other as usize];
            let from = self.centre_before(mover);
            let new = bodies.pose[k].of_part(wall.position, wall.rotation);
            let start = old.rotation.conjugate() * (from - old.position).as_vec3();
            let end = new.rotation.conjugate() * (bodies.pose[i].position - new.position).as_vec3();
            let moved = end - start;
            let length = moved.length();
            let own = bodies.colliders[i].as_slice();
            if length == 0.0 || !self.wants(&bodies.traits[i], own) {
                continue;
            }
            let keep = GUARD_DISTANCE * self.inner(own);
            let reach = moved * (1.0 + keep / length);
            let Some(hit) = segment_hits(wall, start, start + reach) else { continue };
            let Some(stop) = stop(reach, length, keep, hit.fraction, hit.normal) else { continue };
            held += 1;
            let at = bodies.pose[i].position;
            let to = new.position
                + (new.rotation * slid_along(wall, start, reach * stop, moved, hit.normal)).as_dvec3();
            // At least as fast as the body that carries it.
            let normal = new.rotation * hit.normal;
            let carried = ((to - from) / f64::from(dt)).as_vec3();
            let velocity = &mut bodies.velocity[i];
            let missing = (carried - velocity.linear).dot(normal);
            if missing > 0.0 {
                velocity.linear += normal * missing;
            }
            // Bodies that don't move at all come first.
            let mut way = (to - at).as_vec3();
            if way.length() > 0.0 {
                self.hold(stack, own, at, &mut way, velocity);
            }
            bodies.pose[i].position = at + way.as_dvec3();
        }
        held
    }
}

impl Guard<'_> {
    /// Centre of mass of a collider's body at the start of the step.
    pub(super) fn centre_before(&self, collider: u32) -> DVec3 {
        let (c, pose) = (&self.colliders[collider as usize], &self.poses[collider as usize]);
        pose.position - (pose.rotation * c.rotation.conjugate() * c.position).as_dvec3()
    }

    /// Rotation of its body at that time.
    pub(super) fn turn_before(&self, collider: u32) -> Quat {
        let (c, pose) = (&self.colliders[collider as usize], &self.poses[collider as usize]);
        pose.rotation * c.rotation.conjugate()
    }
}

/// Where a centre that was cut off after `way` of its motion from `start` gets to if it slides on along the
/// surface, for the rest of the motion. A turning surface moves on below a body within a step: one that
/// stayed where it was cut would be cut there again in each step, and gain speed by it without end.
fn slid_along(wall: &Collider, start: Vec3, way: Vec3, moved: Vec3, normal: Vec3) -> Vec3 {
    let at = start + way;
    let along = (moved - way).reject_from_normalized(normal);
    if segment_hits(wall, at, at + along).is_none() { at + along } else { at }
}

/// Share of `reach`, which is `length + keep`, that a centre may go if it would enter a surface at
/// `fraction`: it ends `keep` above it, and never goes backwards. `None`: all of it.
pub(super) fn stop(reach: Vec3, length: f32, keep: f32, fraction: f32, normal: Vec3) -> Option<f32> {
    let into = -reach.dot(normal);
    let stop = if into > 0.0 { fraction - keep / into } else { fraction };
    let whole = length / (length + keep);
    // An infinite length is not shortened.
    let stop = stop.clamp(0.0, if whole >= 0.0 { whole } else { 1.0 });
    (stop * (length + keep) < length).then_some(stop)
}
