//! Closes the joints of trees that came apart within a substep.
//!
//! Velocities predict the end of a substep only to first order: a leg that turns by half a radian in it
//! leaves its joint by centimetres, and after an impact by more. So once bodies have moved, trees with open
//! joints are closed by Newton's method, with the exact solution that is used for velocities, applied to
//! displacements; it takes two or three rounds. Contacts with static geometry take part in so far as they
//! must not be crossed; where a joint can't be closed without crossing one, it stays open.

use super::contacts::{Request, TreeBody};
use super::node::{TreeWidth, gather_up, on_nodes};
use super::slots::TreeContacts;
use super::spatial::Twist;
use super::tree::TreeBatch;
use crate::config::tuning::JOINT_OPEN;
use crate::constraint::contact::batch::Batch;
use crate::constraint::contact::row::{BodyPair, Motion, Response, relative, row};
use crate::lanes::{GatherLanes, Mask, Vec3};

/// Maximum number of rounds in a substep.
const ROUNDS: u32 = 8;
// Guard: beyond, the numbers are no motion.
/// A displacement [m] above this is no solution.
const FURTHEST: f32 = 1e6;

impl<L: TreeWidth> TreeBatch<L> {
    /// Closes the joints that are open. `slop`: overlap that contacts leave alone [m].
    ///
    /// # Safety
    /// No other thread works on the bodies of the trees, and none writes their displacements.
    pub(crate) unsafe fn close(
        &mut self,
        motion: &Motion<'_, '_>,
        slop: f32,
        contacts: &[TreeContacts],
        mut touch: impl FnMut(&TreeContacts, Request<'_>, &mut TreeBody<'_, L>),
    ) {
        let own = &contacts[self.contacts.0 as usize..self.contacts.1 as usize];
        // SAFETY: by the contract.
        unsafe { self.follow(motion) };
        for _ in 0..ROUNDS {
            if !self.is_open(JOINT_OPEN) {
                return;
            }
            self.nodes.iter_mut().for_each(|node| node.velocity = Twist::zero());
            self.factor();
            self.request_closing();
            gather_up(&mut self.nodes[..self.real]);
            if !own.is_empty() {
                self.traverse(own, |batch, body| touch(batch, Request::Push(slop), body));
            }
            self.extra.shifts = true;
            self.answer_all();
            self.extra.shifts = false;
            limit(&mut self.nodes);
            for batch in own {
                let node = &mut self.nodes[batch.node as usize];
                let mut body = TreeBody::new(node.change, &node.whole);
                touch(batch, Request::Stop(slop), &mut body);
                node.change = body.velocity();
            }
            let sound = shift(&mut self.nodes);
            // SAFETY: by the contract.
            unsafe { self.shift(motion, sound) };
            self.place(0.0);
        }
    }

    /// Whether any joint is open by more than the tolerance.
    pub(crate) fn is_open(&mut self, tolerance: f32) -> bool {
        let lanes = self.nodes.first().map_or(0, |root| root.write);
        open_by(&mut self.nodes, squares(self.unit, tolerance))[0] & lanes != 0
    }

    /// Lanes in which a joint is open by more than the tolerance, or by an unknown amount.
    pub(crate) fn open_by(&mut self, tolerance: f32) -> L::Mask {
        L::Mask::from_bits(open_by(&mut self.nodes, squares(self.unit, tolerance))[1])
    }
}

/// The squares of the errors that may remain, as lengths and as angles; `share`: in length units, and in
/// radians.
pub(super) fn squares(unit: f32, share: f32) -> [f32; 2] {
    [share * unit, share].map(|most| most * most)
}

on_nodes! {
    /// Lanes in which a joint is open, and those in which one is not closed: NaN is neither open nor closed.
    fn open_by<'a, L>(nodes, most: [f32; 2]) -> [u32; 2] {
        let most = [L::splat(most[0]), L::splat(most[1])];
        let (mut open, mut closed) = (L::zero().gt(L::zero()), L::zero().eq(L::zero()));
        for node in nodes {
            if node.jointed {
                let (apart, error) = (node.apart_now.length_squared(), node.error_now.length_squared());
                open = open | apart.gt(most[0]) | error.gt(most[1]);
                closed = closed & apart.lt(most[0]) & error.lt(most[1]);
            }
        }
        [open.bits(), !closed.bits()]
    }
}

on_nodes! {
    /// Limits the displacements of the solution to a radian: beyond that the linearisation says nothing.
    fn limit<'a, L>(nodes) {
        let mut most = L::one();
        for node in &mut *nodes {
            most = most.max(node.change.angular.length_squared());
        }
        let share = L::one() / most.sqrt();
        for node in nodes {
            node.change = node.change.scaled(share);
        }
    }
}

on_nodes! {
    /// Moves the trees by the displacements of the solution, if these are finite: joints may contradict each
    /// other. Returns the lanes of trees that moved.
    fn shift<'a, L>(nodes) -> u32 {
        let mut sound = u32::MAX;
        for node in &mut *nodes {
            let square = node.change.linear.length_squared() + node.change.angular.length_squared();
            sound &= square.lt(L::splat(FURTHEST * FURTHEST)).bits() | !node.write;
        }
        let lanes = L::Mask::from_bits(sound);
        for node in nodes {
            node.shift(Twist::select(lanes, node.change, Twist::zero()));
        }
        sound
    }
}

/// How much room a displacement of body `a` of each lane leaves a point, with the overlap that is tolerated.
#[inline(always)]
fn room<L: GatherLanes, const P: usize>(
    batch: &Batch<L, P, 0>,
    i: usize,
    moved: &BodyPair<L>,
    slop: f32,
) -> L {
    let point = &batch.points[i];
    let allowance = (point.now + L::splat(slop)).max(L::zero());
    relative::<L, 0>(batch.normal, moved) + row(moved, point) + allowance
}

/// Whether a displacement crosses a contact further than is tolerated.
#[inline(always)]
pub(crate) fn crosses<L: GatherLanes, const P: usize>(
    batch: &Batch<L, P, 0>,
    moved: &BodyPair<L>,
    slop: f32,
) -> bool {
    let mut crosses = L::zero().gt(L::zero());
    for i in 0..P {
        let stands = batch.points[i].mass.gt(L::zero());
        crosses = crosses | (stands & room(batch, i, moved, slop).lt(L::zero()));
    }
    crosses.any()
}

/// Limits the displacement of body `a` of each lane so that it crosses contacts no further than the overlap
/// that is tolerated.
#[inline(always)]
pub(crate) fn keep_out<L: GatherLanes, const P: usize>(
    batch: &Batch<L, P, 0>,
    moved: &mut BodyPair<L>,
    slop: f32,
    response: &mut impl Response<L, P, 0>,
) {
    for i in 0..P {
        let (over, mass) = (room(batch, i, moved, slop), response.mass(batch, i));
        let p = L::select(mass.gt(L::zero()), (-(over * mass)).max(L::zero()), L::zero());
        response.apply(batch, moved, batch.normal * p, batch.points[i].arm_a * p, Vec3::zero());
    }
}
