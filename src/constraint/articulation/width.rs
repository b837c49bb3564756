//! What is done with all nodes of a batch of trees at once, in the widths in which trees are solved: eight at a
//! time, or one.

use super::node::{Node, with_parent};
use super::spatial::{Map, Sym6, Twist};
use crate::lanes::{GatherLanes, Lanes, Sym3, Vec3, f32x8, kernel, with_best};

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
    /// inertia: the net impulse on a light body between heavy ones is a small difference of what passes through
    /// it, and would be lost otherwise.
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
