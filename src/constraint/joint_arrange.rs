//! Joints -> batches. Which rows share a batch is settled when joints come or go; what is in them, in every step.

use super::colour::{COLOURS, Colouring, OVERFLOW};
use super::contact_row::Motion as BodyMotion;
use super::joint_ends::{Ends, JointPass, NONE};
use super::joint_lock::{PointBatch, TurnBatch, mobility};
use super::joint_row::RowBatch;
use super::joint_tree::{Node, TreeBatch};
use super::joint_trees::{Tree, find};
use super::order::{Order, RowGroup};
use crate::body::Bodies;
use crate::joint::{Axes, Motion};
use crate::joint::{Joint, Joints, Lock, LockKind, Placed, Row, RowKind};
use crate::lanes::{GatherLanes, Lanes, Sym3, Vec3, f32x8};
use crate::memory::bytes_of;
use crate::threads::{Crew, Shared, per_block};

/// A type of row. Within a group they are solved in this order.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub(crate) enum JointType {
    Row,
    Weld,
    Hinge,
    Point,
    Tree,
}

impl JointType {
    /// Those that are coloured.
    const ROWS: [JointType; 4] = [JointType::Row, JointType::Weld, JointType::Hinge, JointType::Point];
}

/// Batches of one type that may be solved at the same time: one colour of one group.
#[derive(Clone, Copy, Debug)]
pub(crate) struct JointStage {
    pub(crate) group: RowGroup,
    pub(crate) kind: JointType,
    /// Range of the batches of this type; of the single ones, if it is serial.
    pub(crate) start: u32,
    pub(crate) end: u32,
    /// Rows that found no colour: one lane, one after another.
    pub(crate) serial: bool,
}

/// Batches of one type.
#[derive(Debug)]
pub(crate) struct Table<B8, B1> {
    pub(crate) lanes: Vec<B8>,
    pub(crate) single: Vec<B1>,
    /// The locks or rows in each lane.
    owners: Vec<[u32; 8]>,
    single_owners: Vec<u32>,
}

impl<B8, B1> Default for Table<B8, B1> {
    fn default() -> Self {
        Table { lanes: Vec::new(), single: Vec::new(), owners: Vec::new(), single_owners: Vec::new() }
    }
}

impl<B8: Default + Send, B1: Default> Table<B8, B1> {
    fn clear(&mut self) {
        self.owners.clear();
        self.single_owners.clear();
    }
    fn resize(&mut self) {
        self.lanes.resize_with(self.owners.len(), B8::default);
        self.single.resize_with(self.single_owners.len(), B1::default);
        if self.owners.is_empty() {
            self.lanes.shrink_to_fit();
        }
    }
    fn bytes(&self) -> (usize, usize) {
        let all = [
            bytes_of(&self.lanes),
            bytes_of(&self.single),
            bytes_of(&self.owners),
            bytes_of(&self.single_owners),
        ];
        all.into_iter().fold((0, 0), |s, b| (s.0 + b.0, s.1 + b.1))
    }
    fn fill(
        &mut self,
        crew: &Crew<'_>,
        one: impl Fn(&mut B8, &[u32]) + Sync,
        alone: impl Fn(&mut B1, &[u32]),
    ) {
        let (lanes, owners) = (Shared::new(&mut self.lanes), &self.owners);
        crew.run(owners.len().div_ceil(BLOCK), &|block| {
            for i in block * BLOCK..((block + 1) * BLOCK).min(owners.len()) {
                // SAFETY: each batch is in one block.
                one(unsafe { lanes.get(i) }, &owners[i]);
            }
        });
        for (batch, owner) in self.single.iter_mut().zip(&self.single_owners) {
            alone(batch, std::slice::from_ref(owner));
        }
    }
}

/// Batches a block.
const BLOCK: usize = per_block(8, 1);

/// All rows of joints of a step.
#[derive(Debug, Default)]
pub(crate) struct JointRows {
    pub(crate) points: Table<PointBatch<f32x8>, PointBatch<f32>>,
    pub(crate) welds: Table<TurnBatch<f32x8, false>, TurnBatch<f32, false>>,
    pub(crate) hinges: Table<TurnBatch<f32x8, true>, TurnBatch<f32, true>>,
    pub(crate) rows: Table<RowBatch<f32x8>, RowBatch<f32>>,
    /// Trees of points: one alone, or up to eight alike.
    trees: Vec<TreeBatch<f32x8>>,
    tree: Vec<TreeBatch<f32>>,
    /// Of soft rows, limits, then locks.
    pub(crate) stages: Vec<JointStage>,
}

/// What preparing joints reads.
pub(crate) struct JointInput<'a> {
    pub(crate) bodies: &'a Bodies,
    pub(crate) inverse_inertia: &'a [Sym3<f32>],
    pub(crate) joints: &'a Joints,
    /// In which order groups of rows are solved.
    pub(crate) order: Order,
    /// Factor on the impulses of the last step.
    pub(crate) warm: f32,
    /// Substep [s].
    pub(crate) h: f32,
}

impl JointRows {
    /// Live and reserved bytes.
    pub(crate) fn bytes(&self) -> (usize, usize) {
        let all = [
            self.points.bytes(),
            self.welds.bytes(),
            self.hinges.bytes(),
            self.rows.bytes(),
            bytes_of(&self.stages),
            bytes_of_trees(&self.trees),
            bytes_of_trees(&self.tree),
        ];
        all.into_iter().fold((0, 0), |s, b| (s.0 + b.0, s.1 + b.1))
    }

    /// Settles which rows share a batch.
    pub(crate) fn arrange(&mut self, joints: &Joints, bodies: &Bodies) {
        self.points.clear();
        self.welds.clear();
        self.hinges.clear();
        self.rows.clear();
        self.stages.clear();
        let (trees, taken) = find(joints, bodies);
        let mut colouring = Colouring::default();
        let mut parts: Vec<(usize, u32)> = Vec::new();
        let body =
            |joint: u32, side: usize| bodies.slots.dense(joints.all[joint as usize].bodies[side]) as usize;
        for group in [RowGroup::SoftJoints, RowGroup::JointLimits, RowGroup::Joints] {
            for kind in JointType::ROWS {
                colouring.reset(bodies.dynamic());
                parts.clear();
                let mut enter = |owner: usize, joint: u32| {
                    let colour = colouring.assign(body(joint, 0), body(joint, 1));
                    // What found no colour comes first.
                    parts.push(((colour + 1) % (COLOURS + 1), owner as u32));
                };
                if kind == JointType::Row {
                    let own = |row: &&Row| group_of(row) == group;
                    joints
                        .rows
                        .iter()
                        .enumerate()
                        .filter(|(_, r)| own(r))
                        .for_each(|(i, r)| enter(i, r.joint));
                } else if group == RowGroup::Joints {
                    let own = |(i, lock): &(usize, &Lock)| type_of(lock) == kind && !taken[*i];
                    joints.locks.iter().enumerate().filter(own).for_each(|(i, l)| enter(i, l.joint));
                }
                parts.sort_by_key(|part| part.0);
                self.add_stages(group, kind, &parts);
            }
        }
        self.plant(&trees);
        self.points.resize();
        self.welds.resize();
        self.hinges.resize();
        self.rows.resize();
    }

    /// Batches of trees, and their stages: no two share a body that they can move.
    fn plant(&mut self, groups: &[Vec<Tree>]) {
        self.trees = groups.iter().filter(|group| group.len() > 1).map(|group| batch_of(group)).collect();
        self.tree = groups.iter().filter(|group| group.len() == 1).map(|group| batch_of(group)).collect();
        for (count, serial) in [(self.trees.len(), false), (self.tree.len(), true)] {
            if count > 0 {
                let (group, kind) = (RowGroup::Joints, JointType::Tree);
                self.stages.push(JointStage { group, kind, start: 0, end: count as u32, serial });
            }
        }
    }

    fn add_stages(&mut self, group: RowGroup, kind: JointType, parts: &[(usize, u32)]) {
        let (owners, single) = match kind {
            JointType::Point => (&mut self.points.owners, &mut self.points.single_owners),
            JointType::Weld => (&mut self.welds.owners, &mut self.welds.single_owners),
            JointType::Hinge => (&mut self.hinges.owners, &mut self.hinges.single_owners),
            JointType::Row => (&mut self.rows.owners, &mut self.rows.single_owners),
            JointType::Tree => return,
        };
        for colour in parts.chunk_by(|a, b| a.0 == b.0) {
            let serial = colour[0].0 == (OVERFLOW + 1) % (COLOURS + 1);
            let start = if serial { single.len() } else { owners.len() };
            if serial {
                single.extend(colour.iter().map(|part| part.1));
            } else {
                owners.extend(
                    colour.chunks(8).map(|eight| std::array::from_fn(|i| eight.get(i).map_or(NONE, |p| p.1))),
                );
            }
            let end = if serial { single.len() } else { owners.len() };
            self.stages.push(JointStage { group, kind, start: start as u32, end: end as u32, serial });
        }
    }

    /// Fills all batches.
    pub(crate) fn fill(&mut self, crew: &Crew<'_>, input: &JointInput<'_>) {
        self.stages.sort_by_key(|stage| input.order.rank(stage.group));
        self.points.fill(crew, |b, o| point(b, o, input), |b, o| point(b, o, input));
        self.welds.fill(crew, |b, o| turn(b, o, input), |b, o| turn(b, o, input));
        self.hinges.fill(crew, |b, o| turn(b, o, input), |b, o| turn(b, o, input));
        self.rows.fill(crew, |b, o| row(b, o, input), |b, o| row(b, o, input));
        let (count, trees) = (self.trees.len(), Shared::new(&mut self.trees));
        // SAFETY: each batch is in one block.
        crew.run(count, &|i| tree(unsafe { trees.get(i) }, input));
        self.tree.iter_mut().for_each(|batch| tree(batch, input));
    }

    /// Applies the impulses of the last step, for one stage.
    ///
    /// # Safety
    /// No other thread writes the bodies of the batch.
    pub(crate) unsafe fn step(
        views: &JointViews<'_>,
        stage: &JointStage,
        i: usize,
        motion: &BodyMotion<'_, '_>,
        pass: Option<&JointPass>,
    ) {
        macro_rules! go {
            ($lanes:expr, $single:expr) => {
                // SAFETY: by the contract; each batch is in one stage.
                unsafe {
                    match (stage.serial, pass) {
                        (false, None) => $lanes.get(i).warm_start(motion),
                        (false, Some(pass)) => $lanes.get(i).solve(motion, pass),
                        (true, None) => $single.get(i).warm_start(motion),
                        (true, Some(pass)) => $single.get(i).solve(motion, pass),
                    }
                }
            };
        }
        match stage.kind {
            JointType::Point => go!(views.points, views.point),
            JointType::Weld => go!(views.welds, views.weld),
            JointType::Hinge => go!(views.hinges, views.hinge),
            JointType::Row => go!(views.rows, views.row),
            JointType::Tree => go!(views.trees, views.tree),
        }
    }

    /// For several threads.
    pub(crate) fn views(&mut self) -> JointViews<'_> {
        JointViews {
            points: Shared::new(&mut self.points.lanes),
            point: Shared::new(&mut self.points.single),
            welds: Shared::new(&mut self.welds.lanes),
            weld: Shared::new(&mut self.welds.single),
            hinges: Shared::new(&mut self.hinges.lanes),
            hinge: Shared::new(&mut self.hinges.single),
            rows: Shared::new(&mut self.rows.lanes),
            row: Shared::new(&mut self.rows.single),
            trees: Shared::new(&mut self.trees),
            tree: Shared::new(&mut self.tree),
        }
    }

    /// Writes impulses back, and what each joint bore. `inverse_h`: 1 / substep [1/s].
    pub(crate) fn store(&self, joints: &mut Joints, inverse_h: f32) {
        if self.stages.is_empty() {
            return;
        }
        for joint in &mut joints.all {
            (joint.force, joint.torque) = (glam::Vec3::ZERO, glam::Vec3::ZERO);
        }
        let Joints { all, locks, rows, .. } = joints;
        let mut lock = |owner: u32, impulse: glam::Vec3| {
            let lock = &mut locks[owner as usize];
            lock.impulse = impulse;
            let joint = &mut all[lock.joint as usize];
            match lock.kind {
                LockKind::Linear(_) => joint.force += impulse * inverse_h,
                _ => joint.torque += impulse * inverse_h,
            }
        };
        each(
            &self.points,
            |b| b.ends.owner,
            |b| b.ends.owner,
            |b, i| b.impulse.lane(i),
            |b, i| b.impulse.lane(i),
            &mut lock,
        );
        each(
            &self.welds,
            |b| b.ends.owner,
            |b| b.ends.owner,
            |b, i| b.impulse.lane(i),
            |b, i| b.impulse.lane(i),
            &mut lock,
        );
        each(
            &self.hinges,
            |b| b.ends.owner,
            |b| b.ends.owner,
            |b, i| b.impulse.lane(i),
            |b, i| b.impulse.lane(i),
            &mut lock,
        );
        self.trees.iter().for_each(|batch| impulses_of(batch, &mut lock));
        self.tree.iter().for_each(|batch| impulses_of(batch, &mut lock));
        let mut row = |owner: u32, (impulse, along, about): ([f32; 2], glam::Vec3, glam::Vec3)| {
            let row = &mut rows[owner as usize];
            row.impulse = impulse;
            let (joint, p) = (&mut all[row.joint as usize], (impulse[0] - impulse[1]) * inverse_h);
            match row.motion {
                Motion::Linear => joint.force += along * p,
                Motion::Angular => joint.torque += about * p,
            }
        };
        fn of<L: Lanes>(b: &RowBatch<L>, i: usize) -> ([f32; 2], glam::Vec3, glam::Vec3) {
            (b.impulse.map(|p| p.lane(i)), b.along.lane(i), b.arm[1].lane(i))
        }
        each(&self.rows, |b| b.ends.owner, |b| b.ends.owner, of, of, &mut row);
    }
}

/// Calls `f` with each owner and what its lane has for it.
fn each<B8, B1, T>(
    table: &Table<B8, B1>,
    owners: impl Fn(&B8) -> [u32; 8],
    owner: impl Fn(&B1) -> [u32; 8],
    lanes: impl Fn(&B8, usize) -> T,
    single: impl Fn(&B1, usize) -> T,
    f: &mut impl FnMut(u32, T),
) {
    for batch in &table.lanes {
        for (i, own) in owners(batch).into_iter().enumerate().filter(|(_, own)| *own != NONE) {
            f(own, lanes(batch, i));
        }
    }
    table.single.iter().for_each(|batch| f(owner(batch)[0], single(batch, 0)));
}

/// All batches, for several threads.
pub(crate) struct JointViews<'a> {
    points: Shared<'a, PointBatch<f32x8>>,
    point: Shared<'a, PointBatch<f32>>,
    welds: Shared<'a, TurnBatch<f32x8, false>>,
    weld: Shared<'a, TurnBatch<f32, false>>,
    hinges: Shared<'a, TurnBatch<f32x8, true>>,
    hinge: Shared<'a, TurnBatch<f32, true>>,
    rows: Shared<'a, RowBatch<f32x8>>,
    row: Shared<'a, RowBatch<f32>>,
    trees: Shared<'a, TreeBatch<f32x8>>,
    tree: Shared<'a, TreeBatch<f32>>,
}

fn group_of(row: &Row) -> RowGroup {
    match row.kind {
        RowKind::Limit { min, max } if min == max => RowGroup::Joints,
        RowKind::Limit { .. } => RowGroup::JointLimits,
        _ => RowGroup::SoftJoints,
    }
}

fn type_of(lock: &Lock) -> JointType {
    match lock.kind {
        LockKind::Linear(_) => JointType::Point,
        LockKind::Weld => JointType::Weld,
        LockKind::Hinge(_) => JointType::Hinge,
    }
}

fn put<L: Lanes>(v: &mut Vec3<L>, lane: usize, value: glam::Vec3) {
    v.x.set_lane(lane, value.x);
    v.y.set_lane(lane, value.y);
    v.z.set_lane(lane, value.z);
}

/// Enters a joint's bodies into a lane and says where its frames are.
fn place<L: Lanes>(
    ends: &mut Ends<L>,
    lane: usize,
    owner: u32,
    joint: &Joint,
    input: &JointInput<'_>,
) -> Placed {
    let bodies = input.bodies;
    let (dynamic, movers) = (bodies.dynamic(), bodies.movers());
    let dense = joint.bodies.map(|slot| bodies.slots.dense(slot) as usize);
    for (side, &i) in dense.iter().enumerate() {
        // What stands still has the record after all that move, which is zero.
        ends.body[side][lane] = i.min(movers) as u32;
        let pushed = i < dynamic;
        ends.write[side] |= u32::from(pushed) << lane;
        ends.inverse_mass[side].set_lane(lane, if pushed { bodies.mass[i].inverse } else { 0.0 });
        let inertia = if pushed { input.inverse_inertia[i] } else { Sym3::default() };
        let own = &mut ends.inverse_inertia[side];
        own.xx.set_lane(lane, inertia.xx);
        own.yy.set_lane(lane, inertia.yy);
        own.zz.set_lane(lane, inertia.zz);
        own.xy.set_lane(lane, inertia.xy);
        own.xz.set_lane(lane, inertia.xz);
        own.yz.set_lane(lane, inertia.yz);
    }
    ends.owner[lane] = owner;
    Placed::new(dense.map(|i| &bodies.pose[i]), &joint.frames)
}

/// Inert lanes repeat the bodies of the first.
fn close<L: Lanes>(ends: &mut Ends<L>) {
    for side in 0..2 {
        for lane in 1..8 {
            if ends.owner[lane] == NONE {
                ends.body[side][lane] = ends.body[side][0];
            }
        }
    }
}

fn point<L: GatherLanes>(batch: &mut PointBatch<L>, owners: &[u32], input: &JointInput<'_>) {
    *batch = PointBatch::default();
    let mut projected = [None; 8];
    for (lane, &owner) in owners.iter().enumerate().filter(|(_, o)| **o != NONE) {
        let lock = &input.joints.locks[owner as usize];
        let at = place(&mut batch.ends, lane, owner, &input.joints.all[lock.joint as usize], input);
        put(&mut batch.impulse, lane, lock.impulse * input.warm);
        let (mut arm_a, mut apart) = (at.arm[0], at.apart);
        match lock.kind {
            LockKind::Linear(Axes::Around(axis)) => {
                let n = at.axis(0, axis);
                let (t, s) = n.any_orthonormal_pair();
                // On the first body, the point where the second's is now.
                let slid = n * n.dot(apart);
                (arm_a, apart) = (arm_a + slid, apart - slid);
                projected[lane] = Some([t, s]);
            }
            LockKind::Linear(Axes::One(axis)) => {
                let n = at.axis(0, axis);
                let slid = apart - n * n.dot(apart);
                (arm_a, apart) = (arm_a + slid, apart - slid);
                projected[lane] = Some([n, glam::Vec3::ZERO]);
            }
            _ => batch.whole |= 1 << lane,
        }
        put(&mut batch.arm[0], lane, arm_a);
        put(&mut batch.arm[1], lane, at.arm[1]);
        put(&mut batch.apart, lane, apart);
    }
    close(&mut batch.ends);
    (batch.arm_now, batch.apart_now) = (batch.arm, batch.apart);
    batch.moment = [0, 1].map(|side| batch.arm[side].cross(batch.impulse));
    let all = mobility(&batch.ends, &batch.arm);
    batch.mass = super::joint_ends::inverse(&all);
    for (lane, axes) in projected.iter().enumerate() {
        if let Some(axes) = axes {
            put_sym(&mut batch.mass, lane, &within(&get_sym(&all, lane), axes));
        }
    }
}

fn bytes_of_trees<L>(trees: &Vec<TreeBatch<L>>) -> (usize, usize) {
    trees.iter().map(|tree| bytes_of(&tree.nodes)).fold(bytes_of(trees), |s, b| (s.0 + b.0, s.1 + b.1))
}

/// The nodes of trees of one shape, a lane each.
fn batch_of<L: Lanes>(group: &[Tree]) -> TreeBatch<L> {
    let first = &group[0];
    let node = |i: usize| {
        let mut node = Node::default();
        (node.side, node.parent, node.jointed) = (first[i].side, first[i].parent, first[i].jointed);
        for (owner, tree) in node.owner.iter_mut().zip(group) {
            *owner = tree[i].lock;
        }
        node
    };
    TreeBatch { nodes: (0..first.len()).map(node).collect() }
}

fn tree<L: GatherLanes>(batch: &mut TreeBatch<L>, input: &JointInput<'_>) {
    let bodies = input.bodies;
    let (dynamic, movers) = (bodies.dynamic(), bodies.movers());
    for node in &mut batch.nodes {
        let side = usize::from(node.side);
        for lane in 0..L::N {
            let owner = node.owner[lane];
            if owner == NONE {
                (node.body[lane], node.anchor[lane]) = (node.body[0], node.anchor[0]);
                continue;
            }
            let lock = &input.joints.locks[owner as usize];
            let joint = &input.joints.all[lock.joint as usize];
            let dense = joint.bodies.map(|slot| bodies.slots.dense(slot) as usize);
            let (own, other) = (dense[side], dense[1 - side]);
            node.body[lane] = own as u32;
            // Only a root's is looked at.
            node.anchor[lane] = if other < dynamic { own } else { other.min(movers) } as u32;
            node.write |= 1 << lane;
            let inverse = bodies.mass[own].inverse;
            node.inverse_mass.set_lane(lane, inverse);
            node.mass.set_lane(lane, 1.0 / inverse);
            put_sym(&mut node.inverse_inertia, lane, &input.inverse_inertia[own]);
            if node.jointed {
                let at = Placed::new(dense.map(|i| &bodies.pose[i]), &joint.frames);
                let sign = if side == 1 { 1.0 } else { -1.0 };
                put(&mut node.arm[0], lane, at.arm[side]);
                put(&mut node.arm[1], lane, at.arm[1 - side]);
                put(&mut node.apart, lane, at.apart * sign);
                put(&mut node.impulse, lane, lock.impulse * (sign * input.warm));
            }
        }
        node.inertia = super::joint_ends::inverse(&node.inverse_inertia);
    }
    batch.begin();
}

/// Calls `f` with each lock of a batch of trees and its impulse.
fn impulses_of<L: Lanes>(batch: &TreeBatch<L>, f: &mut impl FnMut(u32, glam::Vec3)) {
    for node in batch.nodes.iter().filter(|node| node.jointed) {
        let sign = if node.side == 1 { 1.0 } else { -1.0 };
        for (lane, owner) in node.owner.into_iter().enumerate().filter(|(_, owner)| *owner != NONE) {
            f(owner, node.impulse.lane(lane) * sign);
        }
    }
}

fn get_sym<L: Lanes>(m: &Sym3<L>, lane: usize) -> Sym3<f32> {
    let Sym3 { xx, yy, zz, xy, xz, yz } = *m;
    let [xx, yy, zz, xy, xz, yz] = [xx, yy, zz, xy, xz, yz].map(|x| x.lane(lane));
    Sym3 { xx, yy, zz, xy, xz, yz }
}

fn put_sym<L: Lanes>(m: &mut Sym3<L>, lane: usize, v: &Sym3<f32>) {
    m.xx.set_lane(lane, v.xx);
    m.yy.set_lane(lane, v.yy);
    m.zz.set_lane(lane, v.zz);
    m.xy.set_lane(lane, v.xy);
    m.xz.set_lane(lane, v.xz);
    m.yz.set_lane(lane, v.yz);
}

/// The inverse of a matrix along one or two axes, zero across them.
fn within(m: &Sym3<f32>, [t, s]: &[glam::Vec3; 2]) -> Sym3<f32> {
    let times = |v: glam::Vec3| m.mul(Vec3::new(v.x, v.y, v.z)).lane(0);
    let (mt, ms) = (times(*t), times(*s));
    let (a, b, d) = (t.dot(mt), t.dot(ms), s.dot(ms));
    let (a, b, d) = if *s == glam::Vec3::ZERO {
        (1.0 / a, 0.0, 0.0)
    } else {
        let over = 1.0 / (a * d - b * b);
        (d * over, -b * over, a * over)
    };
    let entry = |i: usize, k: usize| a * t[i] * t[k] + b * (t[i] * s[k] + s[i] * t[k]) + d * s[i] * s[k];
    Sym3 {
        xx: entry(0, 0),
        yy: entry(1, 1),
        zz: entry(2, 2),
        xy: entry(0, 1),
        xz: entry(0, 2),
        yz: entry(1, 2),
    }
}

fn turn<L: GatherLanes, const HINGE: bool>(
    batch: &mut TurnBatch<L, HINGE>,
    owners: &[u32],
    input: &JointInput<'_>,
) {
    *batch = TurnBatch::default();
    for (lane, &owner) in owners.iter().enumerate().filter(|(_, o)| **o != NONE) {
        let lock = &input.joints.locks[owner as usize];
        let at = place(&mut batch.ends, lane, owner, &input.joints.all[lock.joint as usize], input);
        put(&mut batch.impulse, lane, lock.impulse * input.warm);
        let [a, b] = [0, 1].map(|side| get_sym(&batch.ends.inverse_inertia[side], lane));
        let both = Sym3 {
            xx: a.xx + b.xx,
            yy: a.yy + b.yy,
            zz: a.zz + b.zz,
            xy: a.xy + b.xy,
            xz: a.xz + b.xz,
            yz: a.yz + b.yz,
        };
        let (error, mass) = if let LockKind::Hinge(axis) = lock.kind {
            let axes = [0, 1].map(|side| at.axis(side, axis));
            put(&mut batch.axis[0], lane, axes[0]);
            put(&mut batch.axis[1], lane, axes[1]);
            let (t, s) = axes[0].any_orthonormal_pair();
            (axes[0].cross(axes[1]), within(&both, &[t, s]))
        } else {
            (at.turn(), super::joint_ends::inverse(&both))
        };
        put(&mut batch.error, lane, error);
        put_sym(&mut batch.mass, lane, &mass);
    }
    close(&mut batch.ends);
    batch.error_now = batch.error;
}

fn row<L: GatherLanes>(batch: &mut RowBatch<L>, owners: &[u32], input: &JointInput<'_>) {
    *batch = RowBatch::default();
    let h = input.h;
    for (lane, &owner) in owners.iter().enumerate().filter(|(_, o)| **o != NONE) {
        let row = &input.joints.rows[owner as usize];
        let at = place(&mut batch.ends, lane, owner, &input.joints.all[row.joint as usize], input);
        let Some(displacement) = at.displacement(row.motion, row.axes) else { continue };
        put(&mut batch.along, lane, displacement.along);
        put(&mut batch.arm[0], lane, displacement.arm_a);
        put(&mut batch.arm[1], lane, displacement.arm_b);
        let ends = &batch.ends;
        let turns = |side: usize, arm: glam::Vec3| {
            let inertia = get_sym(&ends.inverse_inertia[side], lane);
            arm.dot(inertia.mul(Vec3::new(arm.x, arm.y, arm.z)).lane(0))
        };
        let slides = displacement.along.length_squared()
            * (ends.inverse_mass[0].lane(lane) + ends.inverse_mass[1].lane(lane));
        let mobility = slides + turns(0, displacement.arm_a) + turns(1, displacement.arm_b);
        if mobility <= 0.0 {
            continue;
        }
        batch.mobility.set_lane(lane, mobility);
        batch.value.set_lane(lane, displacement.value);
        let (mut most, mut target) = (f32::INFINITY, 0.0);
        let (min, max, spring) = match row.kind {
            RowKind::Limit { min, max } => (min, max, None),
            RowKind::Yielding { min, max, spring } => (min, max, Some(spring)),
            RowKind::Drive { position, velocity, spring, max_force } => {
                (most, target) = (max_force * h, velocity);
                (position, position, Some(spring))
            }
        };
        let drive = matches!(row.kind, RowKind::Drive { .. });
        if let Some(spring) = spring {
            let (mut k, mut c, per_mass) = spring.coefficients();
            if per_mass {
                (k, c) = (k / mobility, c / mobility);
            }
            let d = h * k + c;
            if d <= 0.0 {
                continue;
            }
            let rigid = d == f32::INFINITY;
            batch.pull.set_lane(lane, if rigid { 0.0 } else { k / d });
            batch.give.set_lane(lane, if rigid { 0.0 } else { 1.0 / (h * d) });
            batch.speed.set_lane(lane, if rigid { target } else { c / d * target });
        }
        batch.most.set_lane(lane, most);
        batch.min.set_lane(lane, min);
        batch.max.set_lane(lane, max);
        batch.drives |= u32::from(drive) << lane;
        batch.springs |= u32::from(spring.is_some() && !drive) << lane;
        batch.both |= u32::from(!drive && spring.is_none() && min == max) << lane;
        for (impulse, old) in batch.impulse.iter_mut().zip(row.impulse) {
            impulse.set_lane(lane, old * input.warm);
        }
    }
    close(&mut batch.ends);
    batch.now = batch.value;
}
