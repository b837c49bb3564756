//! Which joints make trees.

use super::cut::{MOST_ROWS, rows_of};
use super::node::Turns;
use crate::body::Bodies;
use crate::constraint::joint::ends::NONE;
use crate::constraint::schedule::order::Place;
use crate::joint::{Joints, LockKind};

/// A body of a tree, and the joint between it and its parent.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub(crate) struct Branch {
    /// Place of the parent; none of a root.
    pub(crate) parent: u32,
    /// Which side of the joint the body is.
    pub(crate) side: u8,
    /// A root may hang on nothing.
    pub(crate) jointed: bool,
    /// What of its rotation is locked.
    pub(crate) turns: Turns,
    /// Lock of the joint's point; of a root without one any lock of its body, on the side `side`.
    pub(crate) lock: u32,
    /// Lock of its rotation.
    pub(crate) turn: u32,
    /// The joint lets the two collide.
    pub(crate) collides: bool,
    /// Of a joint that closes a loop, place of its body; of others, none.
    pub(crate) own: u32,
}

impl Branch {
    fn shape(&self) -> Shape {
        (self.parent, self.side, self.jointed, self.turns, self.collides, self.own)
    }
}

/// Bodies that hang together.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(crate) struct Tree {
    /// That of the joint that is raised most.
    pub(crate) place: Place,
    /// Parents before children, then joints that close loops.
    pub(crate) branches: Vec<Branch>,
    /// Branches whose hinges are driven, and by which rows.
    pub(crate) motors: Vec<(u32, u32)>,
}

impl Tree {
    /// How many bodies there are.
    pub(crate) fn bodies(&self) -> usize {
        self.branches.iter().filter(|branch| branch.own == NONE).count()
    }

    /// Rows of what closes loops.
    pub(crate) fn rows(&self) -> usize {
        self.branches.iter().filter(|branch| branch.own != NONE).map(|cut| rows_of(cut.turns)).sum()
    }

    /// What trees have in common that can be solved in the same lanes: they come one after another if this is sorted.
    fn shape(&self) -> impl Iterator<Item = Shape> + '_ {
        let motors = self.motors.iter().map(|&(at, _)| (at, 0, false, Turns::Freely, false, NONE));
        self.branches.iter().map(Branch::shape).chain(motors)
    }
}

type Shape = (u32, u8, bool, Turns, bool, u32);

/// Trees out of points that are joined, with what locks their rotation. Those of the same shape side by side, in groups of at
/// most eight; and which locks and rows are in them.
///
/// What has many loops or a locked axis is none.
///
/// Bodies are told apart by their slots here: a world that was restored finds the same trees again, though bodies may have
/// changed their places since the trees were last looked for.
pub(crate) fn find(
    joints: &Joints,
    bodies: &Bodies,
    place_of: &dyn Fn(u32) -> Place,
    motor_of: &dyn Fn(u32) -> Option<Place>,
    enabled: &dyn Fn(u32) -> bool,
) -> (Vec<Vec<Tree>>, [Vec<bool>; 2]) {
    let dense = |slot: usize| bodies.slots.dense(slot as u32) as usize;
    let is_dynamic = |slot: usize| dense(slot) < bodies.dynamic();
    let (mut taken, mut driven) = (vec![false; joints.locks.len()], vec![false; joints.rows.len()]);
    let ends = |lock: u32| {
        let joint = &joints.all[joints.locks[lock as usize].joint as usize];
        joint.bodies.map(|slot| slot as usize)
    };
    // The lock of rotation of each joint, if it is one.
    let mut turn_of = vec![(Turns::Freely, NONE); joints.all.len()];
    for (i, lock) in joints.locks.iter().enumerate() {
        let turns = match lock.kind {
            LockKind::Weld => Turns::Not,
            LockKind::Hinge(_) => Turns::AboutAxis,
            LockKind::Point | LockKind::Line(_) => continue,
        };
        turn_of[lock.joint as usize] = (turns, i as u32);
    }
    let turn_of = |lock: u32| turn_of[joints.locks[lock as usize].joint as usize];
    // Joints of each body, in the order of their locks.
    let mut of_body: Vec<(u32, u32)> = Vec::new();
    for (lock, _) in
        joints.locks.iter().enumerate().filter(|(_, l)| l.kind == LockKind::Point && enabled(l.joint))
    {
        for body in ends(lock as u32).into_iter().filter(|&b| is_dynamic(b)) {
            of_body.push((body as u32, lock as u32));
        }
    }
    of_body.sort_unstable();
    let locks_of = |body: usize| {
        let start = of_body.partition_point(|e| (e.0 as usize) < body);
        of_body[start..].iter().take_while(move |e| e.0 as usize == body).map(|e| e.1)
    };
    let is_free = |body: usize| {
        let (mass, traits) = (&bodies.mass[dense(body)], &bodies.traits[dense(body)]);
        mass.inverse > 0.0 && mass.inverse_inertia.min_element() > 0.0 && traits.locks == 0
    };
    let mut seen = vec![false; bodies.slots.count()];
    let mut at = vec![NONE; bodies.slots.count()];
    let mut trees: Vec<Tree> = Vec::new();
    for &(first, _) in &of_body {
        if seen[first as usize] {
            continue;
        }
        // All that hangs together.
        let mut group = vec![first as usize];
        seen[first as usize] = true;
        let (mut between, mut anchor, mut anchors, mut next, mut free) = (0_usize, None, 0_usize, 0, true);
        while let Some(&body) = group.get(next) {
            next += 1;
            free &= is_free(body);
            for lock in locks_of(body) {
                let other = ends(lock).into_iter().find(|&b| b != body).unwrap_or(body);
                if !is_dynamic(other) {
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
        // A loop is a joint or a thing to hang on that is not needed to hold all together.
        let loops = between / 2 + anchors.max(1) - group.len();
        if !free || 3 * loops > MOST_ROWS {
            continue;
        }
        let most = |&body: &usize| (locks_of(body).count(), std::cmp::Reverse(body));
        let Some(root) = anchor.or_else(|| group.iter().copied().max_by_key(most)) else { continue };
        let collides = |lock: u32| joints.all[joints.locks[lock as usize].joint as usize].collide;
        let branches = grow(root, &is_dynamic, &locks_of, &ends, &turn_of, &collides, &mut at);
        let jointed = branches.iter().filter(|branch| branch.jointed);
        let place = jointed.map(|branch| place_of(joints.locks[branch.lock as usize].joint)).max();
        let tree = Tree { place: place.unwrap_or_default(), branches, motors: Vec::new() };
        if tree.rows() <= MOST_ROWS {
            trees.push(tree);
        }
    }
    // What drives the hinges of trees, if it comes before their joints and there is room for all of a tree.
    let mut hinge_of: Vec<(u32, u32, u32)> = Vec::new();
    for (i, tree) in trees.iter().enumerate() {
        for (at, branch) in tree.branches.iter().enumerate().filter(|(_, b)| b.turns == Turns::AboutAxis) {
            hinge_of.push((joints.locks[branch.turn as usize].joint, i as u32, at as u32));
        }
    }
    hinge_of.sort_unstable();
    for (row, place) in (0..joints.rows.len()).filter_map(|row| Some((row, motor_of(row as u32)?))) {
        let joint = joints.rows[row].joint;
        if let Ok(found) = hinge_of.binary_search_by_key(&joint, |hinge| hinge.0) {
            let (_, tree, at) = hinge_of[found];
            let tree = &mut trees[tree as usize];
            if place < tree.place {
                tree.motors.push((at, row as u32));
            }
        }
    }
    // A motor would not know of what else holds the bodies: the strut of a wheel is solved after it, row by row.
    let mut tree_of = vec![NONE; bodies.slots.count()];
    let mut inside = vec![false; joints.all.len()];
    for (i, tree) in trees.iter().enumerate() {
        for branch in tree.branches.iter().filter(|branch| branch.jointed) {
            inside[joints.locks[branch.lock as usize].joint as usize] = true;
            ends(branch.lock).into_iter().for_each(|body| tree_of[body] = i as u32);
        }
    }
    for (i, joint) in joints.all.iter().enumerate().filter(|(i, joint)| !inside[*i] && joint.is_there()) {
        for body in joint.bodies.into_iter().filter(|&body| enabled(i as u32) && is_dynamic(body as usize)) {
            if let Some(tree) = trees.get_mut(tree_of[body as usize] as usize) {
                tree.motors.clear();
            }
        }
    }
    for tree in &mut trees {
        if tree.rows() + tree.motors.len() > MOST_ROWS {
            tree.motors.clear();
        }
        tree.motors.sort_unstable();
        tree.motors.iter().for_each(|&(_, row)| driven[row as usize] = true);
    }
    for branch in trees.iter().flat_map(|tree| &tree.branches).filter(|branch| branch.jointed) {
        taken[branch.lock as usize] = true;
        if branch.turn != NONE {
            taken[branch.turn as usize] = true;
        }
    }
    trees.sort_by(|a, b| a.place.cmp(&b.place).then_with(|| a.shape().cmp(b.shape())));
    let same = |a: &Tree, b: &Tree| a.place == b.place && a.shape().eq(b.shape());
    let groups = trees.chunk_by(same).flat_map(|alike| alike.chunks(8)).map(<[Tree]>::to_vec).collect();
    (groups, [taken, driven])
}

/// The tree under a root, parents before children, and behind them what closes loops. `places`: those of bodies that are in
/// trees already.
fn grow<I: Iterator<Item = u32>>(
    root: usize,
    is_dynamic: &impl Fn(usize) -> bool,
    locks_of: &impl Fn(usize) -> I,
    ends: &impl Fn(u32) -> [usize; 2],
    turn_of: &impl Fn(u32) -> (Turns, u32),
    collides: &impl Fn(u32) -> bool,
    places: &mut [u32],
) -> Vec<Branch> {
    let side_of = |lock: u32, body: usize| u8::from(ends(lock)[1] == body);
    let anchor = locks_of(root).find(|&lock| ends(lock).iter().any(|&b| !is_dynamic(b)));
    let lock = anchor.or_else(|| locks_of(root).next()).unwrap_or(NONE);
    let mut tree = vec![Branch {
        parent: NONE,
        side: side_of(lock, root),
        jointed: anchor.is_some(),
        turns: Turns::Freely,
        lock,
        turn: NONE,
        collides: anchor.is_some_and(collides),
        own: NONE,
    }];
    let mut cuts: Vec<Branch> = Vec::new();
    places[root] = 0;
    if let Some(anchor) = anchor {
        (tree[0].turns, tree[0].turn) = turn_of(anchor);
    }
    // Place and body of those whose joints are still to be followed: depth first, so that what hangs on a body stands
    // together.
    let mut open: Vec<(u32, usize, u32)> = Vec::new();
    let follow = |at: usize, body: usize, own: Branch, open: &mut Vec<(u32, usize, u32)>| {
        let first = open.len();
        let on = locks_of(body).filter(|&lock| !own.jointed || lock != own.lock);
        open.extend(on.map(|lock| (lock, body, at as u32)));
        open[first..].reverse();
    };
    follow(0, root, tree[0], &mut open);
    while let Some((lock, body, parent)) = open.pop() {
        let child = ends(lock)[usize::from(side_of(lock, body) == 0)];
        let (turns, turn) = turn_of(lock);
        let branch =
            Branch { parent, side: 0, jointed: true, turns, lock, turn, collides: collides(lock), own: NONE };
        let is_body = is_dynamic(child);
        if is_body && places[child] == NONE {
            let branch = Branch { side: side_of(lock, child), ..branch };
            places[child] = tree.len() as u32;
            tree.push(branch);
            follow(tree.len() - 1, child, branch, &mut open);
        } else if !tree.iter().chain(&cuts).any(|other| other.jointed && other.lock == lock) {
            let other = if is_body { places[child] } else { NONE };
            cuts.push(Branch { parent: other, side: side_of(lock, body), own: parent, ..branch });
        }
    }
    tree.extend(cuts);
    tree
}
