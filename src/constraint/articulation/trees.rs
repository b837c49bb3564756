//! Finds the joints that form trees.

use super::cut::{MAX_ROWS, rows_of};
use super::node::Turns;
use crate::body::Bodies;
use crate::constraint::joint::ends::NONE;
use crate::constraint::schedule::order::Place;
use crate::joint::{Joints, LockKind};

/// A body of a tree, and the joint between it and its parent.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub(crate) struct Branch {
    /// Index of the parent; none for a root.
    pub(crate) parent: u32,
    /// Whether the body is the first or the second of the joint.
    pub(crate) side: u8,
    /// A root may hang on nothing.
    pub(crate) jointed: bool,
    /// Which rotation is locked.
    pub(crate) turns: Turns,
    /// Lock of the joint's point; for a root without a joint, any lock of its body, on the side `side`.
    pub(crate) lock: u32,
    /// Lock of its rotation.
    pub(crate) turn: u32,
    /// For a joint that closes a loop, the index of its body; otherwise none.
    pub(crate) own: u32,
}

impl Branch {
    fn shape(&self) -> Shape {
        (self.parent, self.side, self.jointed, self.turns, self.own)
    }
}

/// Bodies that are joined together.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(crate) struct Tree {
    /// The last of the places of its joints.
    pub(crate) place: Place,
    /// Parents before children, then joints that close loops.
    pub(crate) branches: Vec<Branch>,
    /// Branches whose hinges are driven, and the rows that drive them.
    pub(crate) motors: Vec<(u32, u32)>,
}

impl Tree {
    /// Number of bodies.
    pub(crate) fn bodies(&self) -> usize {
        self.branches.iter().filter(|branch| branch.own == NONE).count()
    }

    /// Number of rows of the joints that close loops.
    pub(crate) fn rows(&self) -> usize {
        self.branches.iter().filter(|branch| branch.own != NONE).map(|cut| rows_of(cut.turns)).sum()
    }

    /// The shape that trees must have in common to share lanes; sorted by it, equal trees come one after
    /// another.
    fn shape(&self) -> impl Iterator<Item = Shape> + '_ {
        let motors = self.motors.iter().map(|&(at, _)| (at, 0, false, Turns::Freely, NONE));
        self.branches.iter().map(Branch::shape).chain(motors)
    }
}

type Shape = (u32, u8, bool, Turns, u32);

/// Groups of at most eight trees of the same shape, and which locks and rows are in them.
pub(crate) struct Found {
    pub(crate) groups: Vec<Vec<Tree>>,
    pub(crate) locks: Vec<bool>,
    pub(crate) rows: Vec<bool>,
}

impl Found {
    /// No trees.
    pub(crate) fn none(joints: &Joints) -> Found {
        let (locks, rows) = (vec![false; joints.locks.len()], vec![false; joints.rows.len()]);
        Found { groups: Vec::new(), locks, rows }
    }
}

/// Finds trees of point joints, with the locks of their rotation. `place_of`: where a joint is solved;
/// `motor_of`: where a row is, if it drives a hinge.
///
/// Bodies with a locked axis and groups with many loops form no tree, nor do those of which a joint lets its
/// own bodies collide: their contact closes a loop of which the tree would know nothing, and the two, each
/// solved exactly against the other, threw light bodies apart at any speed.
///
/// Bodies are identified by their slots here: a restored world finds the same trees again, though its bodies
/// may be at other dense indices than when the trees were last searched for.
pub(crate) fn find(
    joints: &Joints,
    bodies: &Bodies,
    place_of: &dyn Fn(u32) -> Place,
    motor_of: &dyn Fn(u32) -> Option<Place>,
    enabled: &dyn Fn(u32) -> bool,
) -> Found {
    let graph = Graph::new(joints, bodies, enabled);
    let mut trees = graph.trees(place_of);
    graph.add_motors(&mut trees, motor_of);
    graph.drop_motors(&mut trees);
    let mut found = Found::none(joints);
    for tree in &trees {
        tree.motors.iter().for_each(|&(_, row)| found.rows[row as usize] = true);
        for branch in tree.branches.iter().filter(|branch| branch.jointed) {
            found.locks[branch.lock as usize] = true;
            if branch.turn != NONE {
                found.locks[branch.turn as usize] = true;
            }
        }
    }
    trees.sort_by(|a, b| a.place.cmp(&b.place).then_with(|| a.shape().cmp(b.shape())));
    let same = |a: &Tree, b: &Tree| a.place == b.place && a.shape().eq(b.shape());
    found.groups = trees.chunk_by(same).flat_map(|alike| alike.chunks(8)).map(<[Tree]>::to_vec).collect();
    found
}

/// Bodies, by their slots, and the points that join them.
struct Graph<'a> {
    joints: &'a Joints,
    bodies: &'a Bodies,
    enabled: &'a dyn Fn(u32) -> bool,
    /// The lock of rotation of each joint, if it is one.
    turn_of: Vec<(Turns, u32)>,
    /// Body and lock of each end of a point, sorted.
    ends: Vec<(u32, u32)>,
}

/// Bodies that are joined together.
struct Component {
    bodies: Vec<usize>,
    /// A body that hangs on one that joints can't push.
    anchor: Option<usize>,
    /// Number of joints beyond those that hold the component together.
    loops: usize,
    /// All bodies can move in any direction.
    free: bool,
}

impl<'a> Graph<'a> {
    fn new(joints: &'a Joints, bodies: &'a Bodies, enabled: &'a dyn Fn(u32) -> bool) -> Graph<'a> {
        let mut turn_of = vec![(Turns::Freely, NONE); joints.all.len()];
        for (i, lock) in joints.locks.iter().enumerate() {
            let turns = match lock.kind {
                LockKind::Weld => Turns::Not,
                LockKind::Hinge(_) => Turns::AboutAxis,
                LockKind::Point | LockKind::Line(_) => continue,
            };
            turn_of[lock.joint as usize] = (turns, i as u32);
        }
        let mut graph = Graph { joints, bodies, enabled, turn_of, ends: Vec::new() };
        let points = joints.locks.iter().enumerate();
        for (lock, _) in points.filter(|(_, l)| l.kind == LockKind::Point && enabled(l.joint)) {
            for body in graph.ends_of(lock as u32) {
                if graph.is_dynamic(body) {
                    graph.ends.push((body as u32, lock as u32));
                }
            }
        }
        graph.ends.sort_unstable();
        graph
    }

    fn dense(&self, slot: usize) -> usize {
        self.bodies.slots.dense(slot as u32) as usize
    }

    fn is_dynamic(&self, slot: usize) -> bool {
        self.dense(slot) < self.bodies.dynamic()
    }

    /// Whether a body can be moved in any direction.
    fn is_free(&self, slot: usize) -> bool {
        let (mass, traits) = (&self.bodies.mass[self.dense(slot)], &self.bodies.traits[self.dense(slot)]);
        mass.inverse > 0.0 && mass.inverse_inertia.min_element() > 0.0 && traits.locks == 0
    }

    fn joint_of(&self, lock: u32) -> u32 {
        self.joints.locks[lock as usize].joint
    }

    /// The bodies that a lock joins.
    fn ends_of(&self, lock: u32) -> [usize; 2] {
        self.joints.all[self.joint_of(lock) as usize].bodies.map(|slot| slot as usize)
    }

    /// Whether a body is the first or the second of a joint.
    fn side_of(&self, lock: u32, body: usize) -> u8 {
        u8::from(self.ends_of(lock)[1] == body)
    }

    fn turn_of(&self, lock: u32) -> (Turns, u32) {
        self.turn_of[self.joint_of(lock) as usize]
    }

    /// Whether any two bodies that are joined at a body collide.
    fn collides(&self, body: usize) -> bool {
        self.locks_of(body).any(|lock| self.joints.all[self.joint_of(lock) as usize].collide)
    }

    /// The points of a body, in the order of their locks.
    fn locks_of(&self, body: usize) -> impl Iterator<Item = u32> + '_ {
        let start = self.ends.partition_point(|e| (e.0 as usize) < body);
        self.ends[start..].iter().take_while(move |e| e.0 as usize == body).map(|e| e.1)
    }

    /// All trees with few enough loops.
    fn trees(&self, place_of: &dyn Fn(u32) -> Place) -> Vec<Tree> {
        let mut seen = vec![false; self.bodies.slots.count()];
        let mut at = vec![NONE; self.bodies.slots.count()];
        let mut trees: Vec<Tree> = Vec::new();
        for &(first, _) in &self.ends {
            if seen[first as usize] {
                continue;
            }
            let Component { bodies, anchor, loops, free } = self.component(first as usize, &mut seen);
            if !free || 3 * loops > MAX_ROWS || bodies.iter().any(|&body| self.collides(body)) {
                continue;
            }
            let most = |&body: &usize| (self.locks_of(body).count(), std::cmp::Reverse(body));
            let Some(root) = anchor.or_else(|| bodies.iter().copied().max_by_key(most)) else { continue };
            let branches = self.grow(root, &mut at);
            let jointed = branches.iter().filter(|branch| branch.jointed);
            let place = jointed.map(|branch| place_of(self.joint_of(branch.lock))).max();
            let tree = Tree { place: place.unwrap_or_default(), branches, motors: Vec::new() };
            if tree.rows() <= MAX_ROWS {
                trees.push(tree);
            }
        }
        trees
    }

    /// All bodies that are joined to a body, directly or not.
    fn component(&self, first: usize, seen: &mut [bool]) -> Component {
        let mut group = vec![first];
        seen[first] = true;
        let (mut between, mut anchor, mut anchors, mut next, mut free) = (0_usize, None, 0_usize, 0, true);
        while let Some(&body) = group.get(next) {
            next += 1;
            free &= self.is_free(body);
            for lock in self.locks_of(body) {
                let other = self.ends_of(lock).into_iter().find(|&b| b != body).unwrap_or(body);
                if !self.is_dynamic(other) {
                    (anchor, anchors) = (Some(body), anchors + 1);
                } else {
                    // Seen from both sides.
                    between += 1;
                    if !std::mem::replace(&mut seen[other], true) {
                        group.push(other);
                    }
                }
            }
        }
        // Each joint or anchor beyond those needed to hold the component together closes a loop.
        let loops = between / 2 + anchors.max(1) - group.len();
        Component { bodies: group, anchor, loops, free }
    }

    /// Adds the rows that drive hinges of trees, if they are solved before the joints.
    fn add_motors(&self, trees: &mut [Tree], motor_of: &dyn Fn(u32) -> Option<Place>) {
        let mut hinge_of: Vec<(u32, u32, u32)> = Vec::new();
        for (i, tree) in trees.iter().enumerate() {
            for (at, branch) in tree.branches.iter().enumerate().filter(|(_, b)| b.turns == Turns::AboutAxis)
            {
                hinge_of.push((self.joint_of(branch.turn), i as u32, at as u32));
            }
        }
        hinge_of.sort_unstable();
        let rows = 0..self.joints.rows.len();
        for (row, place) in rows.filter_map(|row| Some((row, motor_of(row as u32)?))) {
            let joint = self.joints.rows[row].joint;
            if let Ok(found) = hinge_of.binary_search_by_key(&joint, |hinge| hinge.0) {
                let (_, tree, at) = hinge_of[found];
                let tree = &mut trees[tree as usize];
                if place < tree.place {
                    tree.motors.push((at, row as u32));
                }
            }
        }
    }

    /// Removes the motors of trees that have no room for all of them, and of trees with other joints beside
    /// them, of which a motor would know nothing: the strut of a wheel is solved after it, row by row.
    fn drop_motors(&self, trees: &mut [Tree]) {
        let joints = self.joints;
        let mut tree_of = vec![NONE; self.bodies.slots.count()];
        let mut inside = vec![false; joints.all.len()];
        for (i, tree) in trees.iter().enumerate() {
            for branch in tree.branches.iter().filter(|branch| branch.jointed) {
                inside[self.joint_of(branch.lock) as usize] = true;
                self.ends_of(branch.lock).into_iter().for_each(|body| tree_of[body] = i as u32);
            }
        }
        for (i, joint) in joints.all.iter().enumerate().filter(|(i, joint)| !inside[*i] && joint.is_there()) {
            let held = |body: &u32| (self.enabled)(i as u32) && self.is_dynamic(*body as usize);
            for body in joint.bodies.into_iter().filter(held) {
                if let Some(tree) = trees.get_mut(tree_of[body as usize] as usize) {
                    tree.motors.clear();
                }
            }
        }
        for tree in trees {
            if tree.rows() + tree.motors.len() > MAX_ROWS {
                tree.motors.clear();
            }
            tree.motors.sort_unstable();
        }
    }

    /// The tree under a root, parents before children, followed by the joints that close loops. `places`:
    /// indices of bodies that are in trees already.
    fn grow(&self, root: usize, places: &mut [u32]) -> Vec<Branch> {
        let anchor =
            self.locks_of(root).find(|&lock| self.ends_of(lock).iter().any(|&b| !self.is_dynamic(b)));
        let lock = anchor.or_else(|| self.locks_of(root).next()).unwrap_or(NONE);
        let mut tree = vec![Branch {
            parent: NONE,
            side: self.side_of(lock, root),
            jointed: anchor.is_some(),
            turns: Turns::Freely,
            lock,
            turn: NONE,
            own: NONE,
        }];
        let mut cuts: Vec<Branch> = Vec::new();
        places[root] = 0;
        if let Some(anchor) = anchor {
            (tree[0].turns, tree[0].turn) = self.turn_of(anchor);
        }
        // Lock, body and index of the body of joints still to be followed: depth first, so that a subtree is
        // contiguous.
        let mut open: Vec<(u32, usize, u32)> = Vec::new();
        let follow = |at: usize, body: usize, own: Branch, open: &mut Vec<(u32, usize, u32)>| {
            let first = open.len();
            let on = self.locks_of(body).filter(|&lock| !own.jointed || lock != own.lock);
            open.extend(on.map(|lock| (lock, body, at as u32)));
            open[first..].reverse();
        };
        follow(0, root, tree[0], &mut open);
        while let Some((lock, body, parent)) = open.pop() {
            let child = self.ends_of(lock)[usize::from(self.side_of(lock, body) == 0)];
            let (turns, turn) = self.turn_of(lock);
            let branch = Branch { parent, side: 0, jointed: true, turns, lock, turn, own: NONE };
            let is_body = self.is_dynamic(child);
            if is_body && places[child] == NONE {
                let branch = Branch { side: self.side_of(lock, child), ..branch };
                places[child] = tree.len() as u32;
                tree.push(branch);
                follow(tree.len() - 1, child, branch, &mut open);
            } else if !tree.iter().chain(&cuts).any(|other| other.jointed && other.lock == lock) {
                let other = if is_body { places[child] } else { NONE };
                cuts.push(Branch { parent: other, side: self.side_of(lock, body), own: parent, ..branch });
            }
        }
        tree.extend(cuts);
        tree
    }
}
