//! Closes the joints of trees that came apart within a substep.
//!
//! Velocities predict the end of a substep only to first order: a leg that turns by half a radian in it
//! leaves its joint by centimetres, and after an impact by more. So once bodies have moved, trees with open
//! joints are closed by Newton's method, with the exact solution that is used for velocities, applied to
//! displacements; it takes two or three rounds. Contacts with static geometry take part in so far as they
//! must not be crossed; where a joint can't be closed without crossing one, it stays open.

use super::contacts::{Request, TreeBody};
use super::node::TreeWidth;
use super::slots::TreeContacts;
use super::spatial::Twist;
use super::tree::TreeBatch;
use crate::constraint::contact::batch::Batch;
use crate::constraint::contact::row::{BodyPair, Motion, Response, relative, row};
use crate::lanes::{GatherLanes, Mask, Vec3};

/// Maximum number of rounds in a substep.
const ROUNDS: u32 = 8;
// Guard: beyond, the numbers are no motion.
/// A displacement [m] above this is no solution.
const FURTHEST: f32 = 1e6;

/// Tolerances for closing trees.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Closing {
    /// Errors up to this are left to the velocities [length units] or [rad].
    pub(crate) tolerance: f32,
    /// Overlap that contacts leave alone [m].
    pub(crate) slop: f32,
}

impl<L: TreeWidth> TreeBatch<L> {
    /// Closes the joints that are open.
    ///
    /// # Safety
    /// No other thread works on the bodies of the trees, and none writes their displacements.
    pub(crate) unsafe fn close(
        &mut self,
        motion: &Motion<'_, '_>,
        closing: &Closing,
        contacts: &[TreeContacts],
        mut touch: impl FnMut(&TreeContacts, Request<'_>, &mut TreeBody<'_, L>),
    ) {
        let own = &contacts[self.contacts.0 as usize..self.contacts.1 as usize];
        for _ in 0..ROUNDS {
            // SAFETY: by the contract.
            unsafe { self.follow(motion) };
            if !self.is_open(closing.tolerance) {
                return;
            }
            for node in &mut self.nodes {
                (node.velocity, node.pushed) = (Twist::zero(), Twist::zero());
            }
            self.factor();
            self.gather_up(|node, _| node.open());
            if !own.is_empty() {
                self.traverse(own, |batch, body| touch(batch, Request::Push(closing), body));
                self.gather_up(|node, _| node.open());
            }
            self.extra.shifts = true;
            self.answer_all();
            self.extra.shifts = false;
            let most =
                self.nodes.iter().fold(L::one(), |most, node| most.max(node.change.angular.length_squared()));
            // At most a radian: beyond that the linearisation says nothing.
            let share = L::one() / most.sqrt();
            self.nodes.iter_mut().for_each(|node| node.change = node.change.scaled(share));
            for batch in own {
                let node = &mut self.nodes[batch.node as usize];
                let mut body = TreeBody::new(node.change, &node.whole);
                touch(batch, Request::Stop(closing), &mut body);
                node.change = body.velocity();
            }
            // A tree stays open if the displacement of one of its bodies is not finite, because its joints
            // contradict each other.
            let sound = self.nodes.iter().fold(u32::MAX, |sound, node| {
                let square = node.change.linear.length_squared() + node.change.angular.length_squared();
                sound & (square.lt(L::splat(FURTHEST * FURTHEST)).bits() | !node.write)
            });
            let sound_lanes = L::Mask::from_bits(sound);
            for node in &mut self.nodes {
                let (zero, Twist { linear, angular }) = (Vec3::zero(), node.change);
                node.shift(Twist {
                    linear: Vec3::select(sound_lanes, linear, zero),
                    angular: Vec3::select(sound_lanes, angular, zero),
                });
            }
            // SAFETY: by the contract.
            unsafe { self.shift(motion, sound) };
        }
        self.place(L::zero());
    }

    /// Whether any joint is open by more than the tolerance.
    pub(crate) fn is_open(&self, tolerance: f32) -> bool {
        let most = self.tolerances(tolerance);
        self.nodes.iter().filter(|node| node.jointed).any(|node| {
            let open =
                node.apart_now.length_squared().gt(most[0]) | node.error_now.length_squared().gt(most[1]);
            open.bits() & node.write != 0
        })
    }

    /// The squares of the errors that may remain, as lengths and as angles; `share`: in length units, and in
    /// radians.
    pub(crate) fn tolerances(&self, share: f32) -> [L; 2] {
        [share * self.unit, share].map(|most| L::splat(most * most))
    }
}

/// Limits the displacement of body `a` of each lane so that it crosses contacts no further than the overlap
/// that is tolerated.
#[inline(always)]
pub(crate) fn keep_out<L: GatherLanes, const P: usize>(
    batch: &Batch<L, P, 0>,
    moved: &mut BodyPair<L>,
    closing: &Closing,
    response: &mut impl Response<L, P, 0>,
) {
    for (i, point) in batch.points.iter().enumerate() {
        let allowance = (point.now + L::splat(closing.slop)).max(L::zero());
        let over = relative::<L, 0>(batch.normal, moved) + row(moved, point) + allowance;
        let mass = response.mass(batch, i);
        let p = L::select(mass.gt(L::zero()), (-(over * mass)).max(L::zero()), L::zero());
        response.apply(batch, moved, batch.normal * p, point.arm_a * p, Vec3::zero());
    }
}
