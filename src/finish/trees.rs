//! Trees of joints of which the guard held a body: the whole tree stops with it.
//!
//! If the path of one body alone is cut, its joints open by the missing part, which may be half a metre. So
//! all bodies of its tree go no further on their paths than it does, joints that are open then are closed,
//! and each path is checked once more.

use super::FAR;
use super::guard::Guard;
use crate::body::{Bodies, Pose, exp_map};
use crate::config::tuning::{CENTRE_ASIDE, STUCK_TREE, STUCK_TREE_SPEED};
use crate::constraint::contact::row::Motion;
use crate::constraint::{JointRows, Rows, TreeSlot};
use crate::lanes::Record;
use crate::threads::Shared;
use glam::Vec3;

/// State that closing trees changes.
pub(super) struct Trees<'a> {
    pub(super) bodies: &'a mut Bodies,
    pub(super) delta: &'a mut [Record],
    pub(super) rows: &'a mut Rows,
    pub(super) joints: &'a mut JointRows,
    /// Overlap that contacts leave alone [m].
    pub(super) slop: f32,
}

impl Trees<'_> {
    /// Takes all bodies of the trees in `cut` back to the least share of their paths that a body of the tree
    /// could go.
    pub(super) fn mend(&mut self, guard: &Guard<'_>, cut: &mut [(TreeSlot, f32)], stack: &mut Vec<u32>) {
        cut.sort_unstable_by(|(a, s), (b, t)| a.of_tree().cmp(&b.of_tree()).then(s.total_cmp(t)));
        for alike in cut.chunk_by(|(a, _), (b, _)| a.of_tree() == b.of_tree()) {
            let (slot, share) = alike[0];
            for i in self.joints.bodies_of(slot) {
                self.bodies.pose[i] = guard.before(i, self.bodies, &self.delta[i]);
                let d = &mut self.delta[i];
                (d.linear, d.angular) = (d.linear * share, d.angular * share);
            }
            self.close(slot);
            // At the poses of the start of the step nothing had crossed anything.
            let Trees { bodies, delta, joints, .. } = &mut *self;
            let mut any = false;
            for i in joints.bodies_of(slot) {
                any |= crosses(guard, stack, bodies, &mut delta[i], i);
            }
            if any {
                for i in joints.bodies_of(slot) {
                    (delta[i].linear, delta[i].angular) = (Vec3::ZERO, Vec3::ZERO);
                }
            }
            if any || share < STUCK_TREE {
                // Damp a stuck tree, or it gains speed in every step. Slow enough bodies are not checked, and
                // slip off.
                for i in joints.bodies_of(slot) {
                    let v = &mut bodies.velocity[i];
                    (v.linear, v.angular) = (v.linear * STUCK_TREE_SPEED, v.angular * STUCK_TREE_SPEED);
                }
            }
            for i in self.joints.bodies_of(slot) {
                let d = &mut self.delta[i];
                if !d.is_within(FAR) {
                    *d = Record::default();
                }
                let pose = &mut self.bodies.pose[i];
                pose.position += d.linear.as_dvec3();
                pose.rotation = (exp_map(d.angular) * pose.rotation).normalize();
            }
        }
    }

    fn close(&mut self, slot: TreeSlot) {
        let along = self.rows.views();
        // Only the displacements of the solver's state are used.
        let (velocity, base) = (&mut [][..], &mut [][..]);
        let (velocity, base, delta) = (Shared::new(velocity), Shared::new(base), Shared::new(self.delta));
        let motion = Motion { velocity: &velocity, delta: &delta, base: &base };
        let views = self.joints.views();
        // SAFETY: there is no other thread.
        unsafe { views.close(slot.place().0, &motion, self.slop, &along) };
    }
}

/// Keeps a body's centre from crossing static geometry. Returns whether an end of it still would, or the
/// centre had to be moved far.
fn crosses(guard: &Guard<'_>, stack: &mut Vec<u32>, bodies: &mut Bodies, d: &mut Record, i: usize) -> bool {
    let own = bodies.colliders[i].as_slice();
    if d.linear == Vec3::ZERO || !guard.wants(&bodies.traits[i], own) {
        return false;
    }
    let (before, mut moved) = (&bodies.pose[i], d.linear);
    guard.hold(stack, own, before.position, &mut moved, &mut bodies.velocity[i]);
    let aside = (moved - d.linear).length() > CENTRE_ASIDE * guard.inner(own);
    d.linear = moved;
    let after = Pose {
        position: before.position + d.linear.as_dvec3(),
        rotation: (exp_map(d.angular) * before.rotation).normalize(),
    };
    aside || guard.crossing(stack, own, before, &after).is_some()
}

impl Guard<'_> {
    /// Pose of a body at the start of the step.
    fn before(&self, i: usize, bodies: &Bodies, d: &Record) -> Pose {
        let pose = &bodies.pose[i];
        match bodies.colliders[i].as_slice() {
            [] => Pose {
                position: pose.position - d.linear.as_dvec3(),
                rotation: (exp_map(-d.angular) * pose.rotation).normalize(),
            },
            [first, ..] => Pose { position: self.centre_before(*first), rotation: self.turn_before(*first) },
        }
    }
}
