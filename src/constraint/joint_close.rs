//! Joints of trees that came apart within a substep, closed again.
//!
//! Velocities know of a substep's end only what is linear: a leg that turns by half a radian in it leaves its joint by
//! centimetres, and after an impact by more. So after bodies moved, trees whose joints are open are put together by Newton's
//! method, with the same exact solution as for velocities but of displacements: two or three rounds. Contacts with what is
//! static go along as far as they must not be crossed; where both can't be had, the joint stays open.

use super::batch::Batch;
use super::contact_row::{Motion, Pair, Response, follow, relative, row};
use super::joint_tour::{Along, Toured, Whole};
use super::joint_tree::TreeBatch;
use super::seats::Seated;
use super::spatial::Twist;
use crate::lanes::{GatherLanes, Mask, Vec3, f32x8, scatter};

/// The most rounds of a substep.
const ROUNDS: u32 = 8;

/// What closing trees needs to know.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Closing {
    /// Errors up to this are left to the velocities [m] or [rad].
    pub(crate) tolerance: f32,
    /// Overlap that contacts leave alone [m].
    pub(crate) slop: f32,
}

/// What is done with contacts of a body.
pub(super) enum Ask {
    /// They may push it.
    Push,
    /// They stop it, alone, where it would cross them.
    Stop,
}

impl<L: GatherLanes> TreeBatch<L> {
    /// Closes what is open.
    ///
    /// # Safety
    /// No other thread works on the bodies of the trees, and none writes their displacements.
    pub(super) unsafe fn close(
        &mut self,
        motion: &Motion<'_, '_>,
        closing: &Closing,
        contacts: &[Seated],
        mut touch: impl FnMut(&Seated, Ask, &mut Toured<'_, L>),
    ) {
        if self.loops {
            return;
        }
        let own = &contacts[self.contacts.0 as usize..self.contacts.1 as usize];
        for _ in 0..ROUNDS {
            // SAFETY: by the contract.
            unsafe { self.follow(motion) };
            if !self.is_open(closing.tolerance) {
                return;
            }
            for node in &mut self.nodes {
                (node.velocity, node.carried, node.change) = (Twist::zero(), Twist::zero(), Twist::zero());
            }
            self.factor();
            self.gather_up(|node| Twist { linear: node.apart_now, angular: node.error_now });
            if !own.is_empty() {
                self.tour(own, |seated, body| touch(seated, Ask::Push, body));
            }
            let mut most = L::one();
            for i in 0..self.nodes.len() {
                let (parent, node) = self.with_parent(i);
                node.change = node.answered(parent.map_or(Twist::zero(), |parent| parent.change)).0;
                most = most.max(node.change.angular.length_squared());
            }
            // By no more than a radian: beyond, what is linear says nothing.
            let share = L::one() / most.sqrt();
            self.nodes.iter_mut().for_each(|node| node.change = node.change.scaled(share));
            for seated in own {
                let node = &mut self.nodes[seated.node as usize];
                let mut body = Toured::new(node.change, &node.whole);
                touch(seated, Ask::Stop, &mut body);
                node.change = body.velocity();
            }
            // SAFETY: by the contract.
            unsafe { self.shift(motion) };
        }
    }

    /// Whether any joint is.
    fn is_open(&self, tolerance: f32) -> bool {
        let most = L::splat(tolerance * tolerance);
        self.nodes.iter().filter(|node| node.jointed).any(|node| {
            let open = node.apart_now.length_squared().max(node.error_now.length_squared()).gt(most);
            open.bits() & node.write != 0
        })
    }

    /// Adds what each body is to move by to its displacement.
    ///
    /// # Safety
    /// As for [`TreeBatch::close`].
    unsafe fn shift(&mut self, motion: &Motion<'_, '_>) {
        for node in &self.nodes {
            let out = scatter(node.change.linear, node.change.angular);
            for lane in (0..L::N).filter(|lane| node.write >> lane & 1 != 0) {
                // SAFETY: by the contract; no body is twice in a batch.
                let delta = unsafe { motion.delta.get(node.body[lane] as usize) };
                delta.linear += out[lane].linear;
                delta.angular = turned_on(delta.angular, out[lane].angular);
            }
        }
    }
}

/// The rotation vector of a rotation and then a further small one: to first order in that, by the inverse of the left
/// Jacobian of the rotations as a series, which serves up to half a turn.
fn turned_on(by: glam::Vec3, more: glam::Vec3) -> glam::Vec3 {
    let x = by.length_squared();
    if x > 10.0 {
        return by + more;
    }
    let c = 1.0 / 12.0 + x * (1.0 / 720.0 + x * (1.0 / 30_240.0 + x * (1.0 / 1_209_600.0)));
    let once = by.cross(more);
    by + more - 0.5 * once + c * by.cross(once)
}

impl Along<'_, '_> {
    /// Contacts of one body of each of up to eight trees, while these are closed.
    ///
    /// # Safety
    /// No other thread works on the trees.
    pub(super) unsafe fn close_lanes(
        &self,
        seated: &Seated,
        ask: Ask,
        body: &mut Toured<'_, f32x8>,
        motion: &Motion<'_, '_>,
        closing: &Closing,
    ) {
        let i = seated.batch.index as usize;
        // SAFETY: by the contract; a batch has the contacts of one batch of trees.
        unsafe {
            match seated.batch.points {
                1 => touch(self.p1.get(i), ask, body, motion, closing),
                2 => touch(self.p2.get(i), ask, body, motion, closing),
                3 => touch(self.p3.get(i), ask, body, motion, closing),
                _ => touch(self.p4.get(i), ask, body, motion, closing),
            }
        }
    }

    /// Contacts of one body of one tree.
    ///
    /// # Safety
    /// As for [`Along::close_lanes`].
    pub(super) unsafe fn close_single(
        &self,
        seated: &Seated,
        ask: Ask,
        body: &mut Toured<'_, f32>,
        motion: &Motion<'_, '_>,
        closing: &Closing,
    ) {
        let i = seated.batch.index as usize;
        // SAFETY: by the contract; a batch has the contacts of one tree.
        unsafe { touch(self.single.get(i), ask, body, motion, closing) }
    }
}

/// Contacts of a body of each tree: what they push it back by, or how much of its displacement does not cross them.
///
/// # Safety
/// The batch is no other thread's, and no thread writes the displacements of its bodies.
#[inline(always)]
unsafe fn touch<L: GatherLanes, const P: usize>(
    batch: &mut Batch<L, P>,
    ask: Ask,
    body: &mut Toured<'_, L>,
    motion: &Motion<'_, '_>,
    closing: &Closing,
) {
    // SAFETY: by the contract.
    unsafe { follow::<L, P, false>(batch, motion) };
    let (zero, moved) = (Vec3::zero(), body.velocity());
    let mut v = Pair { va: moved.linear, wa: moved.angular, vb: zero, wb: zero };
    // What is left of the way.
    let room = |batch: &Batch<L, P>, i: usize| (batch.points[i].now + L::splat(closing.slop)).max(L::zero());
    let mut whole = Whole::new::<false>(body.whole(), batch);
    for i in 0..P {
        let point = batch.points[i];
        let over = relative::<L, false>(batch.normal, &v) + row::<L, false>(&v, &point) + room(batch, i);
        let mass = match ask {
            Ask::Push => whole.mass(batch, i),
            Ask::Stop => point.mass,
        };
        let p = L::select(mass.gt(L::zero()), (-(over * mass)).max(L::zero()), L::zero());
        match ask {
            Ask::Push => whole.apply::<false>(batch, &mut v, batch.normal * p, point.arm_a * p, zero),
            Ask::Stop => v.apply::<P, false>(batch, batch.normal * p, point.arm_a * p, zero),
        }
    }
    body.moved(Twist { linear: v.va, angular: v.wa }, whole.push());
}
