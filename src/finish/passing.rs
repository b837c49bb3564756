//! Pairs of moving bodies that would pass through each other.
//!
//! Potential points keep one pair apart exactly; where many fast bodies meet at once, few iterations don't,
//! and where a plate turns under a sliding body, fixed planes don't. So the path of each fast body's centre
//! is checked in the frame of the other body. If it enters the other's shape, more along its surface than
//! into it, the two are moved apart at their ends until the centre is back in front of the surface that it
//! crossed, by the radius of its body's inner ball; the lighter body moves more. If it goes straight into it,
//! or both have joints and can't be moved alone, both stop on their paths. The closing speed is removed, or
//! thrown back, as by an impulse there. A body at the surface from the start is moved aside even if it goes
//! straight into it: stopped, both would stay, and move the same way in each step, for ever.

use super::guard::{Guard, stop};
use crate::body::Bodies;
use crate::broad_phase::Pair;
use crate::config::tuning::{GUARD_DISTANCE, PASSING_STEEPNESS};
use crate::constraint::{ImpactBody, Restitution, TreeSlot, TreeSlots};
use crate::lanes::Record;
use crate::narrow_phase::segment_hits;
use glam::Vec3;

/// Number of passes over fast pairs: a body that is moved aside may get in the way of another.
const PASSES: usize = 8;
/// From this pass on, bodies go back to where they were: nothing in between helped.
const RETURNING: usize = 5;

/// The bodies, and the changes to them.
pub(super) struct Movers<'a> {
    pub(super) bodies: &'a mut Bodies,
    /// Displacements of the step.
    pub(super) delta: &'a mut [Record],
    pub(super) impacts: &'a Restitution,
    pub(super) tree_slots: &'a TreeSlots,
    /// For each tree that was stopped, the share of their paths that its bodies go.
    pub(super) cut: &'a mut Vec<(TreeSlot, f32)>,
    pub(super) stack: &'a mut Vec<u32>,
}

/// A centre that enters a shape.
#[derive(Clone, Copy, Debug)]
struct Passing {
    /// Collider of the body whose centre it is, and the one that it enters.
    one: u32,
    other: u32,
    /// Share of the two paths up to which it is still in front of the surface.
    stop: f32,
    /// Normal of the surface that it enters, at the end of the step, towards the centre.
    normal: Vec3,
    /// How far it has to be moved along the normal to be in front again, at the end of the step [m]; `None`
    /// if it goes more into the surface than along it, from some distance.
    lift: Option<f32>,
}

impl Guard<'_> {
    /// Keeps the centres of fast dynamic bodies out of each other's shapes. Returns how often it had to.
    /// Bodies of one tree may pass: better one through the other than a torn joint.
    pub(super) fn hold_movers(&self, pairs: &[Pair], movers: &mut Movers<'_>) -> u32 {
        let dynamic = movers.bodies.dynamic();
        let mut held = 0;
        for pass in 1..=PASSES {
            let before = held;
            for pair in pairs.iter().filter(|pair| pair.fast) {
                let [i, k] = [pair.a, pair.b].map(|c| self.summaries[c as usize].body as usize);
                let Movers { bodies, tree_slots, .. } = &*movers;
                let tree = |i: usize| tree_slots.of(i).map(TreeSlot::of_tree);
                if i >= dynamic
                    || k >= dynamic
                    || self.pass_by(pair, (i, k), bodies)
                    || tree(i).is_some() && tree(i) == tree(k)
                    || !self.parts(pair)
                {
                    continue;
                }
                // The centre of each against the shape of the other.
                let both = (self.passes(pair.a, pair.b, bodies), self.passes(pair.b, pair.a, bodies));
                let mut passing = match both {
                    (Some(a), Some(b)) if b.stop < a.stop => b,
                    (Some(a), _) => a,
                    (None, Some(b)) => b,
                    (None, None) => continue,
                };
                held += 1;
                if [i, k].iter().any(|&i| movers.delta[i].was_moved_aside()) {
                    // A body that is led along one may be led into another, and back.
                    passing.lift = None;
                }
                if pass >= RETURNING {
                    passing.stop = 0.0;
                }
                self.part(passing, movers);
            }
            if held == before {
                break;
            }
        }
        held
    }

    /// Whether the centres of two bodies pass each other at more than the size of either shape: by far the
    /// most pairs.
    fn pass_by(&self, pair: &Pair, (i, k): (usize, usize), bodies: &Bodies) -> bool {
        let [a, b] = [pair.a, pair.b].map(|c| &self.summaries[c as usize]);
        let start = (self.poses[pair.a as usize].position - self.poses[pair.b as usize].position).as_vec3();
        let way = (bodies.pose[i].position - bodies.pose[k].position).as_vec3() - start;
        let along = (-start.dot(way) / way.length_squared().max(f32::MIN_POSITIVE)).clamp(0.0, 1.0);
        // From shape to shape at the start, from centre to centre at the end, and a little beyond the motion,
        // as below.
        let reach = a.radius.max(b.radius) + 2.0 * (a.lever + b.lever);
        (start + way * along).length() > 1.01 * reach + GUARD_DISTANCE * a.radius.max(b.radius)
    }

    /// Moves two bodies apart, of which the centre of one enters a shape of the other.
    fn part(&self, passing: Passing, movers: &mut Movers<'_>) {
        let Passing { one, other, stop, normal, lift } = passing;
        let Movers { bodies, delta, impacts, tree_slots, cut, stack } = movers;
        let [i, k] = [one, other].map(|c| self.summaries[c as usize].body as usize);
        let gives = |i: usize| if self.joints.has_any(self.slots[i]) { 0.0 } else { bodies.mass[i].inverse };
        let (gi, gk) = if lift.is_some() { (gives(i), gives(k)) } else { (0.0, 0.0) };
        let [i_bounces, k_bounces] =
            [i, k].map(|i| impacts.bounced(i) || self.is_elastic(bodies.colliders[i].as_slice()));
        for (c, i, way, bounces) in [(one, i, normal * gi, i_bounces), (other, k, normal * -gk, k_bounces)] {
            if let Some(lift) = lift
                && gi + gk > 0.0
            {
                let mut way = bodies.traits[i].free(way * (lift / (gi + gk)));
                if way == Vec3::ZERO {
                    continue;
                }
                let own = bodies.colliders[i].as_slice();
                // A body that bounces off an obstacle to which it is moved does so in the next step.
                let mut cut_velocity = bodies.velocity[i];
                self.hold(stack, own, bodies.pose[i].position, &mut way, &mut cut_velocity);
                if !bounces {
                    bodies.velocity[i] = cut_velocity;
                }
                bodies.pose[i].position += way.as_dvec3();
            } else {
                let (from, turned) = (self.centre_before(c), self.turn_before(c));
                let pose = &mut bodies.pose[i];
                pose.position = from + (pose.position - from) * f64::from(stop);
                match tree_slots.of(i) {
                    // At most one entry per body: there is no capacity for more.
                    Some(slot) => match cut.iter_mut().find(|(other, _)| *other == slot) {
                        Some((_, share)) => *share = share.min(stop),
                        None => cut.push((slot, stop)),
                    },
                    // Otherwise a spinning rod would stop with its end in the other body. If it whirls, this
                    // is no orientation that it went through, and with its angular momentum it would have
                    // another energy there: it keeps its spin as seen from itself.
                    None => {
                        let end = pose.rotation;
                        pose.rotation = turned.lerp(end, stop);
                        let spin = &mut bodies.velocity[i].angular;
                        *spin = pose.rotation * (end.conjugate() * *spin);
                    }
                }
            }
            delta[i].set_moved_aside();
        }
        // A body that an impact threw there bounces again in the next step.
        if impacts.bounced(i) || impacts.bounced(k) {
            return;
        }
        // From the centres to where the inner ball of the first touches the second.
        let arm_i = normal * -self.inner(bodies.colliders[i].as_slice());
        let arm_k = (bodies.pose[i].position - bodies.pose[k].position).as_vec3() + arm_i;
        let (mut a, mut b) = (ImpactBody::now(bodies, i), ImpactBody::now(bodies, k));
        let closing = normal.dot(b.at(arm_k) - a.at(arm_i));
        let ease = a.ease(arm_i, normal) + b.ease(arm_k, normal);
        if closing > 0.0 && ease > 0.0 {
            let [first, second] = [one, other].map(|c| &self.colliders[c as usize].material);
            let impulse = normal * ((1.0 + first.restitution_with(second)) * closing / ease);
            a.push(arm_i, impulse);
            b.push(arm_k, -impulse);
            (bodies.velocity[i], bodies.velocity[k]) = (a.velocity, b.velocity);
        }
    }

    /// Whether the centre of the body of `one` enters the shape `other`, as that moves.
    fn passes(&self, one: u32, other: u32, bodies: &Bodies) -> Option<Passing> {
        let shape = &self.colliders[other as usize];
        let body = |c: u32| self.colliders[c as usize].body as usize;
        let (old, pose) = (&self.poses[other as usize], &bodies.pose[body(other)]);
        let new = pose.of_part(shape.position, shape.rotation);
        let own = bodies.colliders[body(one)].as_slice();
        if !self.wants(&bodies.traits[body(one)], own) {
            return None;
        }
        let start = old.rotation.conjugate() * (self.centre_before(one) - old.position).as_vec3();
        let end = new.rotation.conjugate() * (bodies.pose[body(one)].position - new.position).as_vec3();
        let moved = end - start;
        let length = moved.length();
        if length == 0.0 {
            return None;
        }
        let inner = self.inner(own);
        let keep = GUARD_DISTANCE * inner;
        let reach = moved * (1.0 + keep / length);
        // It misses the ball around the shape: by far the most pairs.
        let along = (-start.dot(reach) / reach.length_squared()).clamp(0.0, 1.0);
        if (start + reach * along).length() > 1.001 * shape.radius {
            return None;
        }
        let hit = segment_hits(shape, start, start + reach)?;
        let stop = stop(reach, length, keep, hit.fraction, hit.normal)?;
        let height = (end - (start + reach * hit.fraction)).dot(hit.normal);
        Some(Passing {
            one,
            other,
            stop: (stop * (length + keep) / length).min(1.0),
            normal: new.rotation * hit.normal,
            lift: (stop == 0.0 || height > -PASSING_STEEPNESS * length).then_some((inner - height).max(0.0)),
        })
    }
}

#[cfg(test)]
mod tests {
    use crate::{BodyDesc, Geometry, Settings, ShapeDesc, World};
    use glam::Vec3;

    /// A ball that lies on a floor is touched in every substep, and nothing moves it aside. With two substeps
    /// it was taken for moved: touches were counted where the mark was a number.
    #[test]
    fn a_body_that_two_substeps_touch_was_not_moved_aside() {
        for substeps in 1..=4 {
            let mut world = World::new(Settings::default().with_substeps(substeps)).unwrap();
            world.add_body(&BodyDesc::fixed().with_shape(ShapeDesc::new(Geometry::Plane))).unwrap();
            let ball = ShapeDesc::new(Geometry::Sphere { radius: 0.5 });
            world.add_body(&BodyDesc::dynamic().with_position(0.5 * Vec3::Y).with_shape(ball)).unwrap();
            world.step(1.0 / 60.0).unwrap();
            let delta = &world.buffers.solver.delta[0];
            assert!(delta.is_touched(), "{substeps} substeps");
            assert!(!delta.was_moved_aside(), "{substeps} substeps");
        }
    }
}
