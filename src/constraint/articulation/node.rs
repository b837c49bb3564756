//! A body of a tree, and the joint between it and its parent; and operations on all nodes at once, in the
//! widths in which trees are solved.

use super::free_rotation::{Moments, exp, log_near};
use super::spatial::{Sym6, Twist, less_sandwich, plus};
use crate::constraint::joint::ends::{NONE, across, inverse};
use crate::lanes::{GatherLanes, Lanes, Quat, Sym3, Vec3, f32x8, kernel, with_best};
use bytemuck::{Zeroable, write_zeroes};

/// How a body turns on its parent.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
#[repr(u8)]
pub(crate) enum Turns {
    Freely,
    AboutAxis,
    Not,
}

/// How a body moves without joints.
#[derive(Clone, Copy, Debug)]
#[repr(C)]
pub(crate) struct Drift<L> {
    pub(crate) moments: Moments<L>,
    /// Principal axes after the last substep.
    pub(super) axes_now: Quat<L>,
    /// Acceleration by external forces [m/s²].
    pub(crate) pull: Vec3<L>,
    /// Change of the angular velocity by free rotation in the substep.
    pub(super) more: Vec3<L>,
    /// The velocity before the pass.
    pub(crate) before: Twist<L>,
    /// The velocity before joints acted in the substep, or in the part of it.
    pub(super) from: Twist<L>,
    /// The impulse at the joint and about it, before joints acted in a part of a substep.
    pub(super) borne: Twist<L>,
}

impl<L: Lanes> Default for Drift<L> {
    fn default() -> Self {
        let moments = Moments::default();
        let zero = Vec3::zero();
        let still = Twist::zero();
        Drift {
            axes_now: moments.axes,
            moments,
            pull: zero,
            more: zero,
            before: still,
            from: still,
            borne: still,
        }
    }
}

impl<L: Lanes> Drift<L> {
    /// The inertia and its inverse, after a rotation since the start of the step.
    #[inline(always)]
    pub(crate) fn turned(&mut self, by: Quat<L>) -> [Sym3<L>; 2] {
        self.axes_now = by.compose(self.moments.axes);
        self.moments.in_world(self.axes_now)
    }
}

/// State of a body from which its substep is solved again.
#[derive(Clone, Copy, Debug)]
#[repr(C)]
pub(crate) struct Start<L> {
    /// Displacement at the start of the substep.
    pub(crate) moved: Twist<L>,
    /// Velocity without the joints of the tree; in trees that conserve energy, that at the start of the
    /// substep.
    pub(crate) free: Twist<L>,
    /// Angular velocity that motors give it.
    pub(super) driven: Vec3<L>,
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
    /// Whether a traversal comes by it next (see [`TreeBatch::traverse`]).
    pub(super) is_ahead: bool,
    pub(crate) body: [u32; 8],
    /// The anchor of a root: a body that the joint can't push.
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
    /// The same for both bodies, where the parent is taken with all that hangs on it except for this branch
    /// and those before it; and the velocity of that parent per impulse on it.
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
    /// Velocity and displacement of the anchor of a root.
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

// SAFETY: it is numbers, flags and an enum with a variant that is zero; lanes are numbers.
unsafe impl<L: Lanes> Zeroable for Node<L> {}

impl<L: Lanes> Default for Node<L> {
    fn default() -> Self {
        let mut node = Node::zeroed();
        (node.owner, node.turn_owner) = ([NONE; 8], [NONE; 8]);
        (node.parent, node.own) = (NONE, NONE);
        node.set_to_identity();
        node
    }
}

impl<L: Lanes> Node<L> {
    /// Keeps its place in the tree and nothing else.
    pub(super) fn forget(&mut self) {
        let Node { owner, turn_owner, turns, side, parent, own, jointed, .. } = *self;
        // In place: a node is ten kilobytes, and to make another one and to copy it took 4 % of ragdolls.
        write_zeroes(self);
        (self.owner, self.turn_owner) = (owner, turn_owner);
        (self.turns, self.side) = (turns, side);
        (self.parent, self.own, self.jointed) = (parent, own, jointed);
        self.set_to_identity();
    }

    /// Makes inert lanes finite.
    fn set_to_identity(&mut self) {
        let one = L::one();
        self.inverse_mass = one;
        self.inertia = Sym3 { xx: one, yy: one, zz: one, ..Sym3::default() };
        self.axis = [Vec3::new(one, L::zero(), L::zero()); 2];
        self.axis_now = self.axis;
        self.drift = Drift::default();
        self.turn.w = one;
    }

    /// Impulse at a hinge or a weld per velocity that it forbids, for a mobility there.
    #[inline(always)]
    pub(super) fn held_by(&self, mobility: &Sym6<L>) -> Sym6<L> {
        mobility.inverse_with(if self.turns == Turns::Not {
            inverse(&mobility.angular)
        } else {
            across(&mobility.angular, self.axis_now[0])
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

/// Work on the nodes of a batch. All that it does in lanes has to be inlined, or be a kernel itself.
pub(crate) trait NodeWork {
    type Output;
    /// Implementations are `#[inline(always)]`.
    fn run<L: GatherLanes>(self, nodes: &mut [Node<L>]) -> Self::Output;
}

/// Widths in which trees are solved: eight at a time, or one.
pub(crate) trait TreeWidth: GatherLanes {
    /// Does work on nodes in lanes that suit the processor.
    fn on<W: NodeWork>(nodes: &mut [Node<Self>], work: W) -> W::Output;
}

impl TreeWidth for f32x8 {
    fn on<W: NodeWork>(nodes: &mut [Node<f32x8>], work: W) -> W::Output {
        with_best!(Wide => compute::<Wide, W>(in_lanes(nodes), work))
    }
}

impl TreeWidth for f32 {
    fn on<W: NodeWork>(nodes: &mut [Node<f32>], work: W) -> W::Output {
        compute(nodes, work)
    }
}

kernel! {
    fn compute<'a, L: GatherLanes; W: NodeWork>(nodes: &'a mut [Node<L>], work: W) -> W::Output {
        work.run(nodes)
    }
}

/// A function on the nodes of a batch, of any width, whose body is compiled for the lanes that suit the
/// processor. Its references have one lifetime.
macro_rules! on_nodes {
    ($(#[$attribute:meta])* $vis:vis unsafe fn $($rest:tt)*) => {
        $crate::constraint::articulation::node::on_nodes!(@ [$(#[$attribute])* $vis unsafe fn] $($rest)*);
    };
    ($(#[$attribute:meta])* $vis:vis fn $($rest:tt)*) => {
        $crate::constraint::articulation::node::on_nodes!(@ [$(#[$attribute])* $vis fn] $($rest)*);
    };
    (@ [$($head:tt)*] $name:ident<$a:lifetime, $L:ident>(
        $nodes:ident $(, $argument:ident: $of:ty)* $(,)?
    ) $(-> $output:ty)? $body:block) => {
        $($head)* $name<$a, T: $crate::constraint::articulation::node::TreeWidth>(
            $nodes: &mut [$crate::constraint::articulation::node::Node<T>] $(, $argument: $of)*
        ) $(-> $output)? {
            struct Work<$a> {
                $($argument: $of,)*
                lifetime: std::marker::PhantomData<&$a ()>,
            }
            impl<$a> $crate::constraint::articulation::node::NodeWork for Work<$a> {
                type Output = $crate::lanes::kernel!(@output $($output)?);
                #[inline(always)]
                fn run<$L: $crate::lanes::GatherLanes>(
                    self,
                    $nodes: &mut [$crate::constraint::articulation::node::Node<$L>],
                ) -> Self::Output {
                    let Work { $($argument,)* lifetime: _ } = self;
                    $body
                }
            }
            T::on($nodes, Work { $($argument,)* lifetime: std::marker::PhantomData })
        }
    };
}
pub(crate) use on_nodes;

/// The same nodes with another type of eight lanes.
fn in_lanes<W: Lanes>(nodes: &mut [Node<f32x8>]) -> &mut [Node<W>] {
    const { assert!(size_of::<Node<W>>() == size_of::<Node<f32x8>>()) };
    const { assert!(align_of::<Node<W>>() == align_of::<Node<f32x8>>()) };
    // SAFETY: nodes, and all that is in them, are laid out as in C. The two differ only in the type of lanes,
    // which are eight numbers of the same size and alignment in either.
    unsafe { &mut *(std::ptr::from_mut(nodes) as *mut [Node<W>]) }
}

on_nodes! {
    /// From the leaves to the root: the mobility of each body with all that hangs on it. `answers`: also how
    /// each body responds as part of the whole tree. `real`: how many nodes are bodies; they come first.
    pub(super) fn factor<'a, L>(nodes, real: usize, answers: bool) {
        for node in &mut *nodes {
            let mass = node.inverse_mass;
            let mass = Sym3 { xx: mass, yy: mass, zz: mass, ..Sym3::default() };
            node.free = Sym6 { linear: mass, mixed: [Vec3::zero(); 3], angular: node.stiffened_inverse };
        }
        for i in (0..real).rev() {
            let (parent, node) = with_parent(nodes, i);
            if node.jointed {
                let parent = parent.map(|parent| &mut parent.free);
                if node.turns == Turns::Freely { node.pin(parent) } else { node.join(parent) }
            }
        }
        for i in 0..if answers { real } else { 0 } {
            let (parent, node) = with_parent(nodes, i);
            node.answer(parent.map(|parent| &parent.whole));
        }
    }
}

impl<L: Lanes> Node<L> {
    /// Data of a joint that leaves rotations free. `parent`: the mobility of the parent, from which it
    /// subtracts the branch.
    #[inline(always)]
    fn pin(&mut self, parent: Option<&mut Sym6<L>>) {
        let [arm, above] = self.arm_now;
        let mobility = self.free.through(arm).at(arm);
        self.stiff.linear = inverse(&mobility);
        if let Some(parent) = parent {
            self.rest = *parent;
            let through = parent.through(above);
            self.joined.linear = inverse(&plus(&mobility, &through.at(above)));
            *parent = self.rest.pinned(&through, &self.joined.linear);
        }
    }

    /// The same of a hinge or a weld.
    #[inline(always)]
    fn join(&mut self, parent: Option<&mut Sym6<L>>) {
        let [arm, above] = self.arm_now;
        let mut mobility = self.free.mobility_at(arm);
        self.stiff = self.held_by(&mobility);
        if let Some(parent) = parent {
            self.rest = *parent;
            mobility.add(&parent.mobility_at(above));
            self.joined = self.held_by(&mobility);
            *parent = self.rest.joined_at(above, &self.joined);
        }
    }

    /// How the body responds to an impulse on it, as part of the whole tree. `parent`: how its parent does.
    #[inline(always)]
    fn answer(&mut self, parent: Option<&Sym6<L>>) {
        let [arm, other] = self.arm_now;
        if !self.jointed {
            self.whole = self.free;
        } else if self.turns == Turns::Freely {
            let mut held = self.stiff.linear;
            if let Some(parent) = parent {
                held = less_sandwich(&held, &parent.through(other).at(other));
            }
            self.whole = self.free.pinned(&self.free.through(arm), &held);
        } else {
            let mut held = self.stiff;
            if let Some(parent) = parent {
                held = held.less_sandwich(&parent.mobility_at(other));
            }
            self.whole = self.free.joined_at(arm, &held);
        }
    }

    /// The impulse of the joint that meets its request, by a response: `stiff` or `joined`.
    #[inline(always)]
    pub(crate) fn push(&self, response: &Sym6<L>, requested: &Twist<L>) -> Twist<L> {
        if self.turns == Turns::Freely {
            return Twist { linear: response.linear.mul(requested.linear), angular: Vec3::zero() };
        }
        response.mul(requested)
    }
}

on_nodes! {
    /// Collects from the leaves to the root, without cut joints, the request of each joint, less the effect
    /// of the joints below it.
    pub(super) fn gather_up<'a, L>(bodies) {
        for node in &mut *bodies {
            node.carried = Twist::zero();
        }
        for i in (0..bodies.len()).rev() {
            let (parent, node) = with_parent(bodies, i);
            if !node.jointed {
                continue;
            }
            let mut carried = node.carried;
            carried.add(node.pushed);
            let mut all = node.free.mul(&carried).seen_at(node.arm_now[0]);
            all.add(node.requested);
            node.requested = node.unspun(all);
            if let Some(parent) = parent {
                node.beside = parent.carried;
                parent.carried.add(node.push(&node.stiff, &node.requested).moved(node.arm_now[1]));
            }
        }
    }
}

on_nodes! {
    /// The same after requests have changed: the part that each joint passes on.
    pub(super) fn gather_again<'a, L>(bodies) {
        for node in &mut *bodies {
            node.carried = Twist::zero();
        }
        for i in (0..bodies.len()).rev() {
            let (parent, node) = with_parent(bodies, i);
            if !node.jointed {
                continue;
            }
            node.requested = node.unspun(node.requested);
            if let Some(parent) = parent {
                node.beside = parent.carried;
                parent.carried.add(node.push(&node.stiff, &node.requested).moved(node.arm_now[1]));
            }
        }
    }
}

on_nodes! {
    /// From the root to the leaves: the impulses of joints that meet the requests, and the changes of
    /// velocity by them and by other impulses, of nodes that are bodies.
    ///
    /// A joint's impulse follows from the mobility of both its bodies, and a body's change from its own
    /// inertia: the net impulse on a light body between heavy ones is a small difference of the impulses that
    /// pass through it, and would be lost otherwise.
    pub(super) fn pass_down<'a, L>(bodies) {
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
                    let force = node.unspun(node.push(&node.joined, &requested));
                    parent.pushes.add(force.moved(other));
                    force
                }
                None => node.unspun(node.push(&node.stiff, &node.requested)),
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
