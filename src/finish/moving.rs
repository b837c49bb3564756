//! Moves each body independently: turned and moved to the end of the step, as far as the guard allows.

use super::beside::Beside;
use super::ends::Crossing;
use super::free::Clear;
use super::guard::{Guard, Held};
use super::turned::{BLOCK, Turned};
use crate::body::{ColliderList, FreeTurn, Mass, Pose, Traits, carry_spin, exp_map};
use crate::config::tuning::FREE_SPIN_IN_TOUCH;
use crate::constraint::{Restitution, TreeSlot, TreeSlots};
use crate::forces::{Forces, spins_freely};
use crate::lanes::{self, Record, Sym3};
use crate::limits::{MAX_LEFT_SPEED, MAX_POSITION};
use crate::math::Quat;
use crate::threads::Shared;
use glam::Vec3;
use std::sync::atomic::{AtomicBool, AtomicU32, Ordering};
use std::sync::{Mutex, PoisonError};

/// Shared by the threads that move bodies.
pub(super) struct Moving<'a> {
    pub(super) guard: &'a Guard<'a>,
    pub(super) velocity: Shared<'a, Record>,
    pub(super) pose: Shared<'a, Pose>,
    pub(super) delta: Shared<'a, Record>,
    pub(super) clear: Shared<'a, Clear>,
    pub(super) mass: &'a [Mass],
    pub(super) traits: &'a [Traits],
    pub(super) colliders: &'a [ColliderList],
    pub(super) forces: &'a Forces,
    pub(super) impacts: &'a Restitution,
    pub(super) tree_slots: &'a TreeSlots,
    pub(super) beside: &'a [Beside],
    pub(super) stacks: &'a [Mutex<Vec<u32>>],
    /// Bodies of trees whose paths were cut.
    pub(super) cut: &'a Mutex<Vec<(TreeSlot, f32)>>,
    /// A body that ends nearer to its predicted place than this is not off its path [m].
    pub(super) least: f32,
    /// Whether the axis of rotation of any body may change by itself.
    pub(super) uneven: bool,
    pub(super) movers: usize,
    pub(super) dynamic: usize,
    pub(super) dt: f32,
    /// Number of paths that were cut and of ends that were lifted, whether any body is off its predicted
    /// path, and which bodies were stopped.
    pub(super) cuts: AtomicU32,
    pub(super) lifts: AtomicU32,
    pub(super) any_off_path: AtomicBool,
    pub(super) stopped: Mutex<Vec<u32>>,
}

/// A body that is being moved.
struct Body<'a> {
    index: usize,
    pose: &'a mut Pose,
    velocity: &'a mut Record,
    /// Its displacement; the marks tell whether it was touched, and whether it is turned already.
    delta: &'a mut Record,
    /// Its colliders.
    own: &'a [u32],
}

impl Moving<'_> {
    /// Moves the bodies of a block.
    pub(super) fn move_block(&self, block: usize) {
        // Without the guard there are none, and nothing is allocated.
        let mut none = Vec::new();
        let mut own = self.stacks.get(block).and_then(|stack| stack.lock().ok());
        let stack = own.as_deref_mut().unwrap_or(&mut none);
        let (first, end) = (block * BLOCK, ((block + 1) * BLOCK).min(self.movers));
        let turned = Turned::of((first..end).filter(|&i| self.turns_freely(i)).filter_map(|i| {
            // SAFETY: each body is in one block.
            let (pose, d) = unsafe { (self.pose.get(i), self.delta.get(i)) };
            let (rotation, spin, inertia) =
                (pose.rotation, self.forces.start[i].angular, self.mass[i].inertia);
            (!d.is_touched()).then_some((i - first, FreeTurn { rotation, spin, inertia, time: self.dt }))
        }));
        for i in first..end {
            // SAFETY: each body is in one block.
            let (pose, velocity, delta) =
                unsafe { (self.pose.get(i), self.velocity.get(i), self.delta.get(i)) };
            let own = self.colliders.get(i).map_or(&[][..], |own| own.as_slice());
            self.move_body(Body { index: i, pose, velocity, delta, own }, &turned, stack);
        }
    }

    fn turns_freely(&self, i: usize) -> bool {
        self.uneven
            && i < self.dynamic
            && spins_freely(&self.mass[i], &self.traits[i], self.forces.start[i].angular, self.dt)
    }

    /// `turned`: rotations of the bodies in the block that turn freely.
    #[inline]
    fn move_body(&self, mut body: Body<'_>, turned: &Turned, stack: &mut Vec<u32>) {
        let (i, start) = (body.index, *body.pose);
        if !body.delta.is_within(FAR) || !body.velocity.is_within(MAX_LEFT_SPEED) {
            *body.delta = Record::default();
            self.stop(&mut body, start);
            return;
        }
        let slot = self.tree_slots.of(i);
        let precesses = self.turn(&mut body, turned, stack);
        let Some(moved) = self.moved(&mut body, precesses, slot, stack) else {
            // It stays where it was until it is settled.
            body.delta.set_off_path();
            self.any_off_path.store(true, Ordering::Relaxed);
            return;
        };
        body.pose.position += moved.as_dvec3();
        if slot.is_some()
            && self.guard.cuts
            && self.guard.wants(&self.traits[i], body.own)
            && let Some(crossing) = self.guard.crossing(stack, body.own, &start, body.pose)
        {
            self.cuts.fetch_add(1, Ordering::Relaxed);
            stop_end(body.velocity, &crossing, self.mass[i].inverse, &self.forces.inverse_inertia[i]);
            self.note_cut(slot, crossing.share);
        }
        if !is_in_range(body.pose) || !body.velocity.is_within(MAX_LEFT_SPEED) {
            // Its rotation or lift is not finite, although the motion was at first, or it left the range of
            // the world.
            self.stop(&mut body, start);
        }
    }

    /// Turns a body. Returns whether its axis changed near static geometry, which the predicted path does not
    /// account for.
    #[inline]
    fn turn(&self, body: &mut Body<'_>, turned: &Turned, stack: &mut Vec<u32>) -> bool {
        let Body { index: i, pose, velocity, delta: d, own } = body;
        let (i, own) = (*i, *own);
        if !d.is_touched() && self.turns_freely(i) {
            let before = pose.rotation;
            (pose.rotation, velocity.angular) = turned.of_place(i % BLOCK);
            return self.beside.get(i).is_some_and(|beside| *beside != Beside::Nothing)
                && self.strays(i, before, pose.rotation, own)
                && !self.guard.is_free(stack, own, pose.position, d.linear, self.reach(own));
        }
        // Looked up only if needed: most bodies don't need it.
        let inertia = || self.mass[i].inertia;
        if let Some((rotation, time)) = self.impacts.turned(i) {
            // It bounced, and has the angular velocity after the bounce.
            let turn =
                FreeTurn { rotation, spin: velocity.angular, inertia: inertia(), time: self.dt - time };
            (pose.rotation, velocity.angular) = turn.one();
            return false;
        }
        let mut turned = (exp_map(d.angular) * pose.rotation).normalize();
        // Bodies of trees that conserve energy turned with their angular momentum, substep by substep.
        let carried = d.is_turned();
        if self.uneven
            && i < self.dynamic
            && !carried
            && spins_freely(&self.mass[i], &self.traits[i], velocity.angular, self.dt)
        {
            if d.angular.length_squared() > FREE_SPIN_IN_TOUCH * FREE_SPIN_IN_TOUCH
                && self.guard.is_elastic(own)
            {
                // About a fixed axis a rod that spins about its own would hardly tilt, and sink into the
                // surface that lifts its end. The angular velocity keeps its energy, in the body's frame.
                let (rotation, spin) = (pose.rotation, d.angular / self.dt);
                let turn = FreeTurn { rotation, spin, inertia: inertia(), time: self.dt };
                turned = turn.one().0;
                let (own, spin) = FreeTurn { spin: velocity.angular, ..turn }.one();
                velocity.angular = turned * (own.conjugate() * spin);
            } else {
                velocity.angular = carry_spin(pose.rotation, turned, velocity.angular, inertia());
            }
        }
        pose.rotation = turned;
        false
    }

    /// Displacement of a body, as far as the guard allows [m]; `None` if it is off its predicted path.
    /// `precesses`: its axis changed.
    #[inline]
    fn moved(
        &self,
        body: &mut Body<'_>,
        precesses: bool,
        slot: Option<TreeSlot>,
        stack: &mut Vec<u32>,
    ) -> Option<Vec3> {
        let Body { index: i, pose, velocity, delta: d, own } = body;
        let (i, own, guard) = (*i, *own, self.guard);
        let touched = d.is_touched();
        let mut moved = d.linear;
        // An untouched body followed the path that the broad phase and the narrow phase checked.
        let alone =
            !touched && !precesses && self.beside.get(i).is_some_and(|beside| *beside != Beside::Static);
        if i >= self.dynamic || alone || !guard.wants(&self.traits[i], own) {
            return Some(moved);
        }
        let from = pose.position;
        // A body that bounced keeps its velocity and meets its next obstacle in the next step. Jointed bodies
        // can't be moved alone.
        let bounced = self.impacts.bounced(i);
        let never_settled = bounced || guard.is_elastic(own) || guard.joints.has_any(guard.slots[i]);
        // SAFETY: each body is in one block.
        let clear = unsafe { self.clear.get(i) };
        let mut off_path = !never_settled && (precesses || touched && self.is_left(i, d, own));
        if !off_path && (guard.cuts || !never_settled) && !guard.is_clear(stack, own, clear, from, moved) {
            let mut cut_velocity = **velocity;
            match guard.hold(stack, own, from, &mut moved, &mut cut_velocity) {
                Some((Held::Cut, _)) if !never_settled => off_path = true,
                Some((held, _)) if guard.cuts => {
                    let count = if held == Held::Cut { &self.cuts } else { &self.lifts };
                    count.fetch_add(1, Ordering::Relaxed);
                    self.note_cut(slot, moved.length() / d.linear.length());
                    if !bounced {
                        // A bounce that no row found is applied here.
                        let joined = guard.joints.has_any(guard.slots[i]);
                        let e = if joined { 0.0 } else { guard.restitution(own) };
                        velocity.linear += (cut_velocity.linear - velocity.linear) * (1.0 + e);
                    }
                }
                _ => moved = d.linear,
            }
        }
        (!off_path).then_some(moved)
    }

    /// Whether any point of a body ended far from where it was predicted, both with the acceleration of the
    /// step and without.
    fn is_left(&self, i: usize, went: &Record, own: &[u32]) -> bool {
        let reach = self.reach(own);
        let is_far = |linear: Vec3, angular: Vec3| {
            let swing = reach * (went.angular - angular).length().min(2.0);
            (went.linear - linear).length() + swing > self.least
        };
        let (meant, start) = (&self.forces.motion[i], &self.forces.start[i]);
        is_far(meant.linear, meant.angular) && is_far(start.linear * self.dt, start.angular * self.dt)
    }

    /// Whether the rotation of a freely turning body differs from the predicted one by so much that a point
    /// of it is far off.
    fn strays(&self, i: usize, before: Quat, after: Quat, own: &[u32]) -> bool {
        let meant = exp_map(self.forces.motion[i].angular) * before;
        // The chord of the angle between them.
        let chord = 2.0 * (1.0 - meant.dot(after).powi(2)).max(0.0).sqrt();
        self.reach(own) * chord > self.least
    }

    /// Maximum distance of a point of a body from its centre [m].
    fn reach(&self, own: &[u32]) -> f32 {
        own.iter().fold(0.0, |reach, &c| {
            let summaries = &self.guard.summaries[c as usize];
            reach.max(summaries.lever + summaries.radius)
        })
    }

    /// Records that a body of a tree went only a share of its path.
    fn note_cut(&self, slot: Option<TreeSlot>, share: f32) {
        if let (Some(slot), Ok(mut cut)) = (slot, self.cut.lock()) {
            // A lifted body may have gone further than its path, or to where it did not want to go.
            cut.push((slot, if share < 1.0 { share.max(0.0) } else { 1.0 }));
        }
    }

    #[cold]
    fn stop(&self, body: &mut Body<'_>, start: Pose) {
        stop_body(body.pose, body.velocity, start, body.index < self.dynamic);
        self.stopped.lock().unwrap_or_else(PoisonError::into_inner).push(body.index as u32);
    }
}

/// Puts a body back to where it was, at rest. A kinematic one keeps its velocity, which the caller sets.
#[cold]
pub(super) fn stop_body(pose: &mut Pose, velocity: &mut Record, start: Pose, is_dynamic: bool) {
    *pose = start;
    if is_dynamic {
        *velocity = Record::default();
    }
}

/// Whether a body is where a caller could put it: beyond, boxes and distances would soon overflow.
#[inline(always)]
pub(crate) fn is_in_range(pose: &Pose) -> bool {
    pose.is_finite() && pose.position.abs().max_element() <= MAX_POSITION
}

// Guard: beyond the range of positions.
/// Displacements beyond are out of the world, for any earlier position [m], [rad].
pub(super) const FAR: f32 = 4.0 * MAX_POSITION as f32;

/// Removes the velocity with which an end of a body enters a surface.
fn stop_end(velocity: &mut Record, crossing: &Crossing, inverse_mass: f32, inverse_inertia: &Sym3<f32>) {
    let Crossing { arm, normal, .. } = *crossing;
    let speed = normal.dot(velocity.linear + velocity.angular.cross(arm));
    let lever = arm.cross(normal);
    let turned = inverse_inertia.mul(lanes::Vec3::new(lever.x, lever.y, lever.z)).lane(0);
    let mobility = inverse_mass + lever.dot(turned);
    if speed < 0.0 && mobility > 0.0 {
        let impulse = -speed / mobility;
        velocity.linear += normal * (impulse * inverse_mass);
        velocity.angular += turned * impulse;
    }
}
