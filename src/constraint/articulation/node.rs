//! A body of a tree, and the joint between it and its parent; and what is done with all nodes at once, in the
//! widths in which trees are solved.

use super::damp::Start;
use super::free_rotation::{exp, log_near};
use super::rattle::Drift;
use super::spatial::{Map, Sym6, Twist};
use crate::constraint::joint::ends::{NONE, across, inverse};
use crate::lanes::{GatherLanes, Lanes, Quat, Sym3, Vec3, f32x8, kernel, with_best};

/// How a body turns on its parent.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
#[repr(u8)]
pub(crate) enum Turns {
    Freely,
    AboutAxis,
    Not,
}

/// A body and the joint between it and its parent.
#[derive(Clone, Copy, Debug)]
#[repr(C)]
pub(crate) struct Node<L> {
    /// The lock of the joint's point in each lane, and that of its rotation. For a root that hangs on
    /// nothing, any lock of its body.
    pub(crate) owner: [u32; 8],
    pub(crate) turn_owner: [u32; 8],
    /// Which rotation is locked.
    pub(crate) turns: Turns,
    /// Whether the body is the first or the second of its joint, the same in all lanes.
    pub(crate) side: u8,
    /// Index of the parent in the tree; none for a root.
    pub(crate) parent: u32,
    /// For a cut joint, the index of its body.
    pub(crate) own: u32,
    /// Whether there is a joint.
    pub(crate) jointed: bool,
    pub(crate) body: [u32; 8],
    /// What a root hangs on: a body that the joint can't push.
    pub(crate) anchor: [u32; 8],
    /// Bit per lane: there is a body.
    pub(crate) write: u32,
    /// That of the body, or less: see [`TreeBatch::weigh`].
    pub(crate) inverse_mass: L,
    pub(crate) inertia: Sym3<L>,
    /// From the centre of mass to the joint, of the body and of its parent, at the start of the step [m].
    pub(crate) arm: [Vec3<L>; 2],
    /// From the parent's point to the body's [m].
    pub(crate) apart: Vec3<L>,
    /// Axis of a hinge, on the body and on its parent; and the rotation vector from the parent to a welded
    /// body [rad].
    pub(crate) axis: [Vec3<L>; 2],
    pub(crate) error: Vec3<L>,
    /// The same after the last substep.
    pub(crate) arm_now: [Vec3<L>; 2],
    pub(crate) apart_now: Vec3<L>,
    pub(crate) axis_now: [Vec3<L>; 2],
    pub(crate) error_now: Vec3<L>,
    /// By how much the mean speed at which the body leaves its parent over the next substep exceeds that at
    /// its start.
    pub(crate) bend: Twist<L>,
    /// How it moves without joints.
    pub(crate) drift: Drift<L>,
    /// Displacement since the start of the step, and its rotation; during prediction, those of the substep.
    pub(crate) moved: Twist<L>,
    pub(crate) turn: Quat<L>,
    /// Impulses on the body in the last substep: at the joint [N s], and about it [N m s].
    pub(crate) impulse: Vec3<L>,
    pub(crate) twist: Vec3<L>,
    /// Part of the impulse at the joint that is a steady load and not a blow [N s].
    pub(crate) steady: L,
    /// Inertia with geometric stiffness, its inverse, and the angular velocity that the tree gave in the last
    /// substep.
    pub(crate) stiffened: Sym3<L>,
    pub(crate) stiffened_inverse: Sym3<L>,
    pub(crate) gained: Vec3<L>,
    /// Inverse of the inertia of the body with all that hangs on it.
    pub(crate) free: Sym6<L>,
    /// Impulse at the joint per velocity that the joint forbids.
    pub(crate) stiff: Sym6<L>,
    /// The same for both bodies, where the parent is taken with what hangs on it except for this branch and
    /// those before it; and the velocity of that parent per impulse on it.
    pub(super) joined: Sym6<L>,
    pub(super) rest: Sym6<L>,
    /// Velocity of the body per impulse on it, with the whole tree; only if it has contacts that are solved
    /// along with the tree.
    pub(crate) whole: Sym6<L>,
    /// Stiffness times the square of the substep [kg m²]; before that is known, the mass that hangs on the
    /// body.
    pub(crate) pulled: L,
    /// State of one pass.
    pub(crate) velocity: Twist<L>,
    /// Velocity and displacement of what a root hangs on.
    pub(crate) anchored: Twist<L>,
    pub(crate) anchor_moved: Twist<L>,
    pub(crate) carried: Twist<L>,
    pub(crate) requested: Twist<L>,
    pub(crate) change: Twist<L>,
    pub(crate) pending: Twist<L>,
    /// Impulse of contacts that are solved along with the tree; the same with the impulses of its joints; and
    /// the part of `carried` that the parent had from the branches after this one.
    pub(crate) pushed: Twist<L>,
    pub(super) pushes: Twist<L>,
    pub(super) beside: Twist<L>,
    /// Impulse of the joint, subtracted from the body at its arm.
    pub(crate) force: Twist<L>,
    /// Change, force and impulses of the tree without the rows beside it.
    pub(crate) before: [Twist<L>; 2],
    pub(crate) pushed_before: Twist<L>,
    /// State from which a substep is solved again.
    pub(crate) start: Start<L>,
}

/// A node and its parent, which precedes it.
#[inline(always)]
pub(crate) fn with_parent<L>(nodes: &mut [Node<L>], i: usize) -> (Option<&mut Node<L>>, &mut Node<L>) {
    let (before, rest) = nodes.split_at_mut(i);
    let node = &mut rest[0];
    // Out of range for a root.
    (before.get_mut(node.parent as usize), node)
}

impl<L: Lanes> Default for Node<L> {
    fn default() -> Self {
        let (zero, one) = (Vec3::zero(), L::one());
        Node {
            owner: [NONE; 8],
            turn_owner: [NONE; 8],
            turns: Turns::Freely,
            side: 0,
            parent: NONE,
            own: NONE,
            jointed: false,
            body: [0; 8],
            anchor: [0; 8],
            write: 0,
            // Identity, so that inert lanes stay finite.
            inverse_mass: one,
            inertia: Sym3 { xx: one, yy: one, zz: one, ..Sym3::default() },
            arm: [zero; 2],
            apart: zero,
            axis: [Vec3::new(one, L::zero(), L::zero()); 2],
            error: zero,
            arm_now: [zero; 2],
            apart_now: zero,
            axis_now: [zero; 2],
            error_now: zero,
            bend: Twist::zero(),
            drift: Drift::default(),
            moved: Twist::zero(),
            turn: Quat { v: zero, w: one },
            impulse: zero,
            twist: zero,
            steady: L::zero(),
            stiffened: Sym3::default(),
            stiffened_inverse: Sym3::default(),
            gained: zero,
            free: Sym6::zero(),
            stiff: Sym6::zero(),
            whole: Sym6::zero(),
            pending: Twist::zero(),
            pushed: Twist::zero(),
            pushes: Twist::zero(),
            beside: Twist::zero(),
            force: Twist::zero(),
            before: [Twist::zero(); 2],
            pushed_before: Twist::zero(),
            start: Start::default(),
            joined: Sym6::zero(),
            rest: Sym6::zero(),
            pulled: L::zero(),
            velocity: Twist::zero(),
            anchored: Twist::zero(),
            anchor_moved: Twist::zero(),
            carried: Twist::zero(),
            requested: Twist::zero(),
            change: Twist::zero(),
        }
    }
}

impl<L: Lanes> Node<L> {
    /// Keeps its place in the tree and nothing else.
    pub(super) fn forget(&mut self) {
        let Node { owner, turn_owner, turns, side, parent, own, jointed, .. } = *self;
        *self = Node { owner, turn_owner, turns, side, parent, own, jointed, ..Node::default() };
    }

    /// Impulse at the joint per velocity that the joint forbids, for a mobility there.
    #[inline(always)]
    pub(super) fn held_by(&self, mobility: &Sym6<L>) -> Sym6<L> {
        mobility.inverse_with(match self.turns {
            Turns::Freely => Sym3::default(),
            Turns::AboutAxis => across(&mobility.angular, self.axis_now[0]),
            Turns::Not => inverse(&mobility.angular),
        })
    }

    /// For a hinge, removes the component about its axis. Twice: rounding leaves some of it, by which a rotor
    /// would spin ever faster.
    #[inline(always)]
    pub(super) fn unspun(&self, mut of: Twist<L>) -> Twist<L> {
        if self.turns == Turns::AboutAxis {
            let axis = self.axis_now[0];
            for _ in 0..2 {
                of.angular -= axis * axis.dot(of.angular);
            }
        }
        of
    }

    /// Error of the joint.
    #[inline(always)]
    pub(crate) fn open(&self) -> Twist<L> {
        Twist { linear: self.apart_now, angular: self.error_now }
    }

    /// Moves the body by a small displacement.
    #[inline(always)]
    pub(crate) fn shift(&mut self, by: Twist<L>) {
        self.moved.linear += by.linear;
        self.moved.angular = log_near(exp(by.angular).compose(exp(self.moved.angular)), self.moved.angular);
    }
}

/// Widths in which trees are solved: eight at a time, or one.
pub(crate) trait TreeWidth: GatherLanes {
    /// From the leaves to the root: the mobility of each body with all that hangs on it. `answers`: also how
    /// each body responds as part of the whole tree. `real`: how many nodes are bodies; they come first.
    fn factor(nodes: &mut [Node<Self>], real: usize, answers: bool);
    /// From the root to the leaves: the impulses of joints that meet what was requested, and the changes of
    /// velocity by them and by other impulses, of nodes that are bodies.
    fn pass_down(bodies: &mut [Node<Self>]);
}

impl TreeWidth for f32x8 {
    fn factor(nodes: &mut [Node<f32x8>], real: usize, answers: bool) {
        with_best!(Wide => factor::<Wide>(in_lanes(nodes), real, answers));
    }
    fn pass_down(bodies: &mut [Node<f32x8>]) {
        with_best!(Wide => pass_down::<Wide>(in_lanes(bodies)));
    }
}

impl TreeWidth for f32 {
    fn factor(nodes: &mut [Node<f32>], real: usize, answers: bool) {
        factor(nodes, real, answers);
    }
    fn pass_down(bodies: &mut [Node<f32>]) {
        pass_down(bodies);
    }
}

/// The same nodes with another type of eight lanes.
fn in_lanes<W: Lanes>(nodes: &mut [Node<f32x8>]) -> &mut [Node<W>] {
    const { assert!(size_of::<Node<W>>() == size_of::<Node<f32x8>>()) };
    const { assert!(align_of::<Node<W>>() == align_of::<Node<f32x8>>()) };
    // SAFETY: nodes, and all that is in them, are laid out as in C. The two differ only in the type of lanes,
    // which are eight numbers of the same size and alignment in either.
    unsafe { &mut *(std::ptr::from_mut(nodes) as *mut [Node<W>]) }
}

kernel! {
    /// See [`TreeWidth::factor`].
    fn factor<'a, L: Lanes>(nodes: &'a mut [Node<L>], real: usize, answers: bool) {
        for node in &mut *nodes {
            let mass = node.inverse_mass;
            let mass = Sym3 { xx: mass, yy: mass, zz: mass, ..Sym3::default() };
            node.free = Sym6 { linear: mass, mixed: [Vec3::zero(); 3], angular: node.stiffened_inverse };
        }
        for i in (0..real).rev() {
            let (parent, node) = with_parent(nodes, i);
            if !node.jointed {
                continue;
            }
            let [arm, above] = node.arm_now;
            let mut mobility = node.free.mobility_at(arm);
            node.stiff = node.held_by(&mobility);
            if let Some(parent) = parent {
                node.rest = parent.free;
                mobility.add(&node.rest.mobility_at(above));
                node.joined = node.held_by(&mobility);
                parent.free = node.rest.joined_at(above, &node.joined);
            }
        }
        if answers {
            for i in 0..real {
                let (parent, node) = with_parent(nodes, i);
                node.whole = Sym6::by_columns(&Answer { node, parent: parent.as_deref() });
            }
        }
    }
}

/// How a body responds to an impulse on it, as part of the whole tree.
struct Answer<'a, L> {
    node: &'a Node<L>,
    parent: Option<&'a Node<L>>,
}

impl<L: Lanes> Map<L> for Answer<'_, L> {
    #[inline(always)]
    fn of(&self, unit: Twist<L>) -> Twist<L> {
        let Answer { node, parent } = self;
        let mut push = unit;
        if node.jointed {
            let [arm, other] = node.arm_now;
            let mut requested = node.free.mul(&unit).seen_at(arm);
            if let Some(parent) = parent {
                let above = parent.whole.mul(&node.stiff.mul(&requested).moved(other));
                requested.subtract(above.seen_at(other));
            }
            push.subtract(node.stiff.mul(&requested).moved(arm));
        }
        node.free.mul(&push)
    }
}

kernel! {
    /// See [`TreeWidth::pass_down`].
    ///
    /// A joint's impulse follows from the mobility of both its bodies, and a body's change from its own
    /// inertia: the net impulse on a light body between heavy ones is a small difference of what passes
    /// through it, and would be lost otherwise.
    fn pass_down<'a, L: Lanes>(bodies: &'a mut [Node<L>]) {
        for i in 0..bodies.len() {
            let (parent, node) = with_parent(bodies, i);
            node.pushes = node.pushed;
            if !node.jointed {
                continue;
            }
            let [arm, other] = node.arm_now;
            node.force = match parent {
                Some(parent) => {
                    let mut requested = node.requested;
                    node.beside.add(parent.pushes);
                    requested.subtract(node.rest.mul(&node.beside).seen_at(other));
                    let force = node.unspun(node.joined.mul(&requested));
                    parent.pushes.add(force.moved(other));
                    force
                }
                None => node.unspun(node.stiff.mul(&node.requested)),
            };
            node.pushes.subtract(node.force.moved(arm));
        }
        for node in bodies {
            let Twist { linear, angular } = node.pushes;
            let turned = node.stiffened_inverse.mul(angular);
            node.change = Twist { linear: linear * node.inverse_mass, angular: turned };
        }
    }
}
