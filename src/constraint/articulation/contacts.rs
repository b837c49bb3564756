//! Contacts between a tree of joints and static geometry, solved along with the tree.
//!
//! A foot that lands at 30 m/s is stopped at once by the impulse that the foot alone requires; the bodies
//! above it follow a joint and a pass later, and meanwhile open the joints by decimetres. So while a tree is
//! solved, its contacts push against the effective mass of the body with the rest of the tree. How each body
//! responds to an impulse (`Node::whole`) follows from the sweep from the leaves to the root; a traversal of
//! the tree then passes the changes by the contacts of one body on to the next, so that each sees velocities
//! that all joints allow: Gauss-Seidel in joint coordinates, at the cost of one more solution.

use super::close::{crosses, keep_out};
use super::node::{Node, TreeWidth, gather_again, on_nodes, with_parent};
use super::slots::TreeContacts;
use super::spatial::{Sym6, Twist};
use super::tree::TreeBatch;
use crate::constraint::contact::batch::Batch;
use crate::constraint::contact::friction::FrictionRow;
use crate::constraint::contact::friction::impact::potential_load;
use crate::constraint::contact::row::{
    BodyPair, Free, FrictionResponse, Motion, Pass, Response, follow, is_idle, relative, row, sweep,
};
use crate::constraint::contact::rows::Views;
use crate::constraint::joint::ends::NONE;
use crate::lanes::{GatherLanes, Lanes, Mask, Vec3, f32x8, kernel, with_best};
use bytemuck::{must_cast_mut, must_cast_ref};

/// Traversals in a pass: the second corrects the effect of the contacts of one body on those of another.
const TRAVERSALS: u32 = 2;

/// Contacts of a body during a traversal of its tree.
#[derive(Clone, Copy)]
pub(crate) enum Request<'a> {
    /// One Gauss-Seidel step.
    Solve(&'a Pass<'a>),
    /// Push back a displacement that would cross them by more than an overlap [m].
    Push(f32),
    /// The same for each body alone, without the tree.
    Stop(f32),
}

/// Widths in which trees are solved, with the contacts of their bodies.
pub(crate) trait TreeLanes: TreeWidth {
    /// Solves the contacts of one body in each tree of a batch.
    ///
    /// # Safety
    /// No other thread works on the trees, and none writes displacements.
    unsafe fn solve_contacts(
        views: &Views<'_>,
        contacts: &TreeContacts,
        request: Request<'_>,
        body: &mut TreeBody<'_, Self>,
        motion: &Motion<'_, '_>,
    );
}

impl TreeLanes for f32x8 {
    unsafe fn solve_contacts(
        views: &Views<'_>,
        contacts: &TreeContacts,
        request: Request<'_>,
        body: &mut TreeBody<'_, Self>,
        motion: &Motion<'_, '_>,
    ) {
        let (i, lanes) = (contacts.batch.index as usize, &views.one.lanes);
        // SAFETY: by the contract; a batch has the contacts of one batch of trees.
        unsafe {
            with_best!(Wide => {
                let (own, whole) = (must_cast_mut(&mut body.own), must_cast_ref(body.whole));
                let rows = lanes.friction.cast::<Wide>();
                let friction = if contacts.potential { None } else { rows.touching(contacts.batch) };
                let (p1, p2, p3, p4) = (&lanes.p1, &lanes.p2, &lanes.p3, &lanes.p4);
                match contacts.batch.points {
                    1 => touch(p1.get(i).cast::<Wide>(), friction, request, own, whole, motion),
                    2 => touch(p2.get(i).cast::<Wide>(), friction, request, own, whole, motion),
                    3 => touch(p3.get(i).cast::<Wide>(), friction, request, own, whole, motion),
                    _ => touch(p4.get(i).cast::<Wide>(), friction, request, own, whole, motion),
                }
            })
        }
    }
}

impl TreeLanes for f32 {
    unsafe fn solve_contacts(
        views: &Views<'_>,
        contacts: &TreeContacts,
        request: Request<'_>,
        body: &mut TreeBody<'_, Self>,
        motion: &Motion<'_, '_>,
    ) {
        let (i, single) = (contacts.batch.index as usize, &views.one.single);
        // SAFETY: by the contract; a batch has the contacts of one tree.
        unsafe {
            let friction = if contacts.potential { None } else { single.friction.touching(contacts.batch) };
            touch(single.all.get(i), friction, request, &mut body.own, body.whole, motion);
        }
    }
}

/// A body of a tree while its contacts are solved.
pub(crate) struct TreeBody<'a, L> {
    /// Its velocity, and the impulse of its contacts.
    own: [Twist<L>; 2],
    whole: &'a Sym6<L>,
}

impl<'a, L: Lanes> TreeBody<'a, L> {
    pub(crate) fn new(velocity: Twist<L>, whole: &'a Sym6<L>) -> Self {
        TreeBody { own: [velocity, Twist::zero()], whole }
    }
    pub(crate) fn velocity(&self) -> Twist<L> {
        self.own[0]
    }
}

impl<L: TreeWidth> TreeBatch<L> {
    /// Visits the bodies from the root on and calls `solve` with the contacts of each, and with its velocity
    /// at that moment.
    pub(crate) fn traverse(
        &mut self,
        contacts: &[TreeContacts],
        mut solve: impl FnMut(&TreeContacts, &mut TreeBody<'_, L>),
    ) {
        let bodies = &mut self.nodes[..self.real];
        for _ in 0..TRAVERSALS {
            bodies.iter_mut().for_each(|node| node.pending = Twist::zero());
            let mut at = NONE;
            for batch in contacts {
                if batch.node != at {
                    walk(bodies, at, batch.node);
                    at = batch.node;
                }
                let node = &mut bodies[at as usize];
                let mut velocity = node.velocity;
                velocity.add(node.change);
                let mut body = TreeBody::new(velocity, &node.whole);
                solve(batch, &mut body);
                let [mut change, push] = body.own;
                change.subtract(velocity);
                node.change.add(change);
                node.pending.add(push);
                node.pushed.add(push);
            }
            walk(bodies, at, NONE);
        }
        gather_again(bodies);
    }
}

on_nodes! {
    /// Goes on from one body to one that comes after it, or from outside to the first, or back out: up to the
    /// body that both hang on, which takes in the impulses below, and down again. Each body on the way down
    /// has the change of velocity that follows from the impulses so far.
    fn walk<'a, L>(bodies, from: u32, to: u32) {
        let range = from.wrapping_add(1) as usize..to.wrapping_add(1) as usize;
        // A subtree is contiguous: ancestors of `to` that come after `from` are on the way.
        let mut next = to;
        for i in range.clone().rev() {
            let node = &mut bodies[i];
            node.is_ahead = i as u32 == next;
            if node.is_ahead {
                next = node.parent;
            }
        }
        let mut at = from;
        while at != next {
            at = towards_root(bodies, at);
        }
        for i in range {
            if bodies[i].is_ahead {
                let (parent, node) = with_parent(bodies, i);
                node.change = node.answered(parent.map(|parent| &parent.change));
            }
        }
    }
}

/// Adds the impulses that a body received to its parent, and returns the parent.
#[inline(always)]
fn towards_root<L: Lanes>(bodies: &mut [Node<L>], from: u32) -> u32 {
    let (parent, node) = with_parent(bodies, from as usize);
    node.carried.add(node.pending);
    if node.jointed {
        let [arm, other] = node.arm_now;
        let requested = node.free.mul(&node.pending).seen_at(arm);
        node.requested.add(requested);
        if let Some(parent) = parent {
            let push = node.push(&node.stiff, &requested).moved(other);
            parent.pending.add(push);
            parent.change.add(parent.whole.mul(&push));
        }
    }
    node.parent
}

impl<L: Lanes> Node<L> {
    /// The change of velocity that follows from the impulses carried up and the velocities requested of the
    /// joints. `above`: that of the parent.
    #[inline(always)]
    fn answered(&self, above: Option<&Twist<L>>) -> Twist<L> {
        let mut push = self.carried;
        if self.jointed {
            let [arm, other] = self.arm_now;
            let mut requested = self.requested;
            if let Some(above) = above {
                requested.subtract(above.seen_at(other));
            }
            push.subtract(self.push(&self.stiff, &requested).moved(arm));
        }
        self.free.mul(&push)
    }
}

/// The response of a body as part of its tree.
struct Whole<'a, L, const P: usize> {
    whole: &'a Sym6<L>,
    push: Twist<L>,
    mass: [L; P],
    stiffness: [[L; P]; P],
    friction: FrictionResponse<L>,
}

// Rounding: a joint may leave little of a mobility.
/// Share of a body's own mobility that must be left in the tree. Less is rounding: its joints hold the body
/// where it is.
const LEAST: f32 = 1e-4;

impl<'a, L: Lanes, const P: usize> Whole<'a, L, P> {
    #[inline(always)]
    fn new(whole: &'a Sym6<L>, batch: &Batch<L, P, 0>, row: Option<&FrictionRow<L, 0>>) -> Self {
        let n = batch.normal;
        let (zero, one) = (L::zero(), L::one());
        let mut stiffness = [[zero; P]; P];
        let mut mass = [zero; P];
        for i in 0..P {
            let point = &batch.points[i];
            let answer = whole.mul(&Twist { linear: n, angular: point.arm_a });
            for (stiffness, other) in stiffness[i].iter_mut().zip(&batch.points) {
                *stiffness = n.dot(answer.linear) + other.arm_a.dot(answer.angular);
            }
            let gives = stiffness[i][i].gt(point.stiffness * L::splat(LEAST)) & point.mass.gt(zero);
            mass[i] = L::select(gives, one / L::select(gives, stiffness[i][i], one), zero);
        }
        let mut friction =
            FrictionResponse { mass: [zero; 3], slide_mass: zero, twist_mass: zero, twist_by: [zero; 2] };
        if let Some(f) = row {
            let (t1, t2) = (f.tangent, n.cross(f.tangent));
            let along = [
                Twist { linear: t1, angular: f.arm_a.cross(t1) },
                Twist { linear: t2, angular: f.arm_a.cross(t2) },
            ];
            let answers = [whole.mul(&along[0]), whole.mul(&along[1])];
            let (k11, k12, k22) =
                (along[0].dot(&answers[0]), along[0].dot(&answers[1]), along[1].dot(&answers[1]));
            let det = k11 * k22 - k12 * k12;
            let some = det.gt(zero) & f.slide_mass.gt(zero);
            let over = L::select(some, one / L::select(some, det, one), zero);
            let mass = [k22 * over, -(k12 * over), k11 * over];
            let (half, apart) = ((mass[0] + mass[2]) * L::splat(0.5), (mass[0] - mass[2]) * L::splat(0.5));
            let slide_mass = (half - (apart * apart + mass[1] * mass[1]).sqrt()).max(zero);
            let kt = n.dot(whole.angular.mul(n));
            let turns = kt.gt(zero) & f.twist_mass.gt(zero);
            let twist_mass = L::select(turns, one / L::select(turns, kt, one), zero);
            let twist_by = [n.dot(answers[0].angular), n.dot(answers[1].angular)];
            friction = FrictionResponse { mass, slide_mass, twist_mass, twist_by };
        }
        Whole { whole, push: Twist::zero(), mass, stiffness, friction }
    }
}

impl<L: GatherLanes, const P: usize> Response<L, P, 0> for Whole<'_, L, P> {
    #[inline(always)]
    fn mass(&self, _: &Batch<L, P, 0>, i: usize) -> L {
        self.mass[i]
    }
    #[inline(always)]
    fn stiffness(&self, _: &Batch<L, P, 0>, i: usize, k: usize) -> L {
        self.stiffness[i][k]
    }
    #[inline(always)]
    fn friction(&self, _: &FrictionRow<L, 0>) -> FrictionResponse<L> {
        self.friction
    }
    #[inline(always)]
    fn apply(&mut self, _: &Batch<L, P, 0>, v: &mut BodyPair<L>, p: Vec3<L>, ta: Vec3<L>, _: Vec3<L>) {
        let push = Twist { linear: -p, angular: -ta };
        self.push.add(push);
        let change = self.whole.mul(&push);
        v.va += change.linear;
        v.wa += change.angular;
    }
}

kernel! {
    /// Solves the contacts of one body of each tree. `own`: its velocity, which changes, and the impulse of
    /// the contacts.
    ///
    /// # Safety
    /// No other thread works on the batch, and none writes displacements.
    unsafe fn touch<'a, L: GatherLanes, const P: usize>(
        batch: &'a mut Batch<L, P, 0>,
        friction: Option<&'a mut FrictionRow<L, 0>>,
        request: Request<'a>,
        own: &'a mut [Twist<L>; 2],
        whole: &'a Sym6<L>,
        motion: &'a Motion<'a, 'a>,
    ) {
        if !matches!(request, Request::Solve(Pass { relax: false, .. })) {
            // SAFETY: by the contract.
            unsafe { follow(batch, motion) };
        }
        let (zero, [v, push]) = (Vec3::zero(), own);
        let mut pair = BodyPair { va: v.linear, wa: v.angular, vb: zero, wb: zero };
        match (request, friction) {
            // Most potential contacts are idle, and how their body responds costs more than to see that.
            (Request::Solve(pass), None) if is_idle(batch, &pair, pass) => {}
            (Request::Solve(pass), None) => {
                let mut whole = Whole::new(whole, batch, None);
                sweep::<L, P, 0, false, _>(batch, None, None, &mut pair, pass, &mut whole);
                *push = whole.push;
            }
            (Request::Solve(pass), Some(friction)) => {
                let mut whole = Whole::new(whole, batch, Some(friction));
                // SAFETY: by the contract: each batch has a row of its own.
                let rolling = unsafe { pass.rolling.find(batch.rolling as usize) };
                sweep::<L, P, 0, true, _>(batch, Some(friction), rolling, &mut pair, pass, &mut whole);
                *push = whole.push;
            }
            (Request::Push(slop), _) if !crosses(batch, &pair, slop) => {}
            (Request::Push(slop), _) => {
                let mut whole = Whole::new(whole, batch, None);
                keep_out(batch, &mut pair, slop, &mut whole);
                *push = whole.push;
            }
            (Request::Stop(slop), _) => keep_out(batch, &mut pair, slop, &mut Free),
        }
        *v = Twist { linear: pair.va, angular: pair.wa };
    }
}

/// Checks the contacts that were solved along with trees once more, after rows that know nothing of the tree:
/// these must not push a body into static geometry. No impulse is kept, or requests that can't be met would
/// grow from pass to pass; instead the velocity before any row acted is changed too, as if the body had been
/// slower.
///
/// Returns whether potential points push.
///
/// # Safety
/// As for [`solve`](crate::constraint::contact::row::solve).
#[inline(always)]
pub(crate) unsafe fn guard<L: GatherLanes, const P: usize, const B: usize>(
    batch: &Batch<L, P, B>,
    views: &Views<'_>,
    motion: &Motion<'_, '_>,
    pass: &Pass<'_>,
) -> bool {
    let zero = Vec3::zero();
    // SAFETY: by the contract.
    let mut v = unsafe { BodyPair::load(batch, motion.velocity) };
    let (mut sum, mut moment) = (L::zero(), zero);
    let mut pushes = [L::zero(); P];
    for (point, kept) in batch.points.iter().zip(&mut pushes) {
        let u = relative::<L, B>(batch.normal, &v) + row(&v, point);
        let gap = (point.now * L::splat(pass.inverse_h)).max(L::zero());
        let push = L::select(point.mass.gt(L::zero()), (-((u + gap) * point.mass)).max(L::zero()), L::zero());
        v.apply(batch, batch.normal * push, point.arm_a * push, zero);
        sum += push;
        moment += point.arm_a * push;
        *kept = push;
    }
    if sum.gt(L::zero()).any() {
        // SAFETY: by the contract.
        unsafe {
            let mut base = BodyPair::load(batch, motion.base);
            base.apply(batch, batch.normal * sum, moment, zero);
            v.save(batch, motion.velocity);
            base.save(batch, motion.base);
            note(batch, &pushes, views);
        }
    }
    pass.relax && potential_load(batch, pass.touch_distance).0.gt(L::zero()).any()
}

/// Lets an observer of the step know of impulses that nothing keeps.
///
/// # Safety
/// No other thread works on the contacts of the batch.
#[inline(always)]
unsafe fn note<L: Lanes, const P: usize, const B: usize>(
    batch: &Batch<L, P, B>,
    pushes: &[L; P],
    views: &Views<'_>,
) {
    for lane in (0..L::N).filter(|lane| batch.write_a >> lane & 1 != 0) {
        // SAFETY: by the contract.
        if let Some(sums) = unsafe { views.guarded.find(batch.contact[lane].slot()) } {
            for (i, push) in pushes.iter().enumerate() {
                sums[batch.contact[lane].only().unwrap_or(i)] += push.lane(lane);
            }
        }
    }
}
