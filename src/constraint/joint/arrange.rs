//! Joints in, batches out. Which rows share a batch is decided when joints come or go; their content is
//! filled in in every step.

use super::coupling::block::CouplingBlock;
use super::coupling::plan::{Plan, PlanInput};
use super::ends::NONE;
use super::fill::fill_tree;
use super::kinds::{JointStage, JointType, Tables};
use super::nets::Nets;
use super::run::JointViews;
use super::table::{AnyTable, Owners};
use crate::body::Bodies;
use crate::config::{Order, RowGroup};
use crate::constraint::articulation::cut::{Extra, TreeMotor};
use crate::constraint::articulation::node::Node;
use crate::constraint::articulation::slots::{TreeContacts, TreeRef, TreeSlot, TreeSlots};
use crate::constraint::articulation::tree::TreeBatch;
use crate::constraint::articulation::trees::{Found, Tree, find};
use crate::constraint::contact::input::PrepareInput;
use crate::constraint::schedule::colour::{COLOURS, Colouring, OVERFLOW};
use crate::constraint::schedule::order::Place;
use crate::joint::{Joints, Row, RowKind};
use crate::lanes::{Lanes, Sym3, f32x8};
use crate::memory::{Buffer, bytes_of, sum_bytes};
use crate::narrow_phase::NO_CONTACT;
use crate::threads::{Shared, Workers};

/// All rows of joints of a step.
#[derive(Debug, Default)]
pub(crate) struct JointRows {
    pub(crate) tables: Tables,
    /// Trees of point joints: up to eight of the same shape, or a single one.
    pub(crate) trees: Vec<TreeBatch<f32x8>>,
    pub(crate) single_trees: Vec<TreeBatch<f32>>,
    /// Couplings, with motors of the coupled motions, by their place.
    pub(super) couplings: Vec<CouplingBlock>,
    /// Dynamic bodies that have contacts, if there are trees.
    touching: Vec<bool>,
    /// Bodies whose contacts with static geometry are solved along with trees.
    pub(crate) tree_slots: TreeSlots,
    /// Bodies that are joined together.
    pub(crate) nets: Nets,
    /// In the order in which they are solved.
    pub(crate) stages: Vec<JointStage>,
    /// A number that is unique to each arrangement, in any world: if a snapshot has the number of the current
    /// arrangement, joints need not be arranged again. Results don't depend on it.
    pub(crate) arrangement: u64,
}

/// The number of the last arrangement.
static ARRANGEMENTS: std::sync::atomic::AtomicU64 = std::sync::atomic::AtomicU64::new(0);

// Not by `buffers!`: trees and tables have buffers of several types within.
impl JointRows {
    /// Calls `f` with each buffer that has an entry for each body that can be pushed.
    pub(crate) fn each(&mut self, dynamic: usize, f: &mut dyn FnMut(&mut dyn Buffer, usize)) {
        f(&mut self.touching, dynamic);
        self.tree_slots.each(dynamic, f);
        self.nets.each(dynamic, f);
    }

    /// For several threads.
    pub(crate) fn views(&mut self) -> JointViews<'_> {
        JointViews {
            tables: self.tables.views(),
            trees: Shared::new(&mut self.trees),
            single_trees: Shared::new(&mut self.single_trees),
            couplings: Shared::new(&mut self.couplings),
        }
    }

    /// Releases all memory: there are no joints any more.
    pub(crate) fn release(&mut self) {
        *self = JointRows { arrangement: self.arrangement, ..JointRows::default() };
    }

    /// Reserved bytes of the rows of couplings.
    pub(crate) fn coupling_bytes(&self) -> usize {
        bytes_of(&self.couplings).1 + self.couplings.iter().map(CouplingBlock::reserved).sum::<usize>()
    }

    /// Reserved bytes of data that all joints share, of trees, of locks outside trees, and of other rows.
    pub(crate) fn parts(&self) -> [usize; 4] {
        let beside =
            [bytes_of(&self.stages), bytes_of(&self.touching), self.tree_slots.bytes(), self.nets.bytes()];
        let trees = [bytes_of_trees(&self.trees), bytes_of_trees(&self.single_trees)];
        let tables = |locks: bool| {
            let own = self.tables.all().into_iter().filter(move |table| table.is_lock() == locks);
            own.map(|table| table.bytes().1).sum::<usize>()
        };
        let [beside, trees] = [&beside[..], &trees].map(|all| all.iter().map(|bytes| bytes.1).sum());
        [beside, trees, tables(true), tables(false)]
    }

    /// Reserved bytes of arranged batches, without the buffers that have an entry for each body.
    pub(crate) fn arranged_bytes(&self) -> usize {
        let by_body = [bytes_of(&self.touching), self.tree_slots.bytes(), self.nets.bytes()];
        self.bytes().1 - by_body.iter().map(|bytes| bytes.1).sum::<usize>()
    }

    /// Number of trees with bodies that count as heavier than they are.
    pub(crate) fn weighted_trees(&self) -> u32 {
        let in_lanes = self.trees.iter().map(|tree| tree.weighted.count_ones()).sum::<u32>();
        in_lanes + self.single_trees.iter().map(|tree| tree.weighted).sum::<u32>()
    }

    /// Number of trees of which a substep was solved again, and of nets that lost energy.
    pub(crate) fn damped_trees(&self) -> u32 {
        let in_lanes = self.trees.iter().map(|tree| tree.damped.count_ones()).sum::<u32>();
        let single = self.single_trees.iter().map(|tree| tree.damped.count_ones()).sum::<u32>();
        in_lanes + single + self.nets.damped()
    }

    /// Number of bodies in trees, and of locks outside them.
    pub(crate) fn counts(&self) -> [u32; 2] {
        let in_lanes = self.trees.iter().map(TreeBatch::bodies).sum::<u32>();
        let bodies = in_lanes + self.single_trees.iter().map(TreeBatch::bodies).sum::<u32>();
        let locks = self.tables.all().into_iter().filter(|table| table.is_lock());
        [bodies, locks.map(AnyTable::len).sum()]
    }

    /// Live and reserved bytes.
    pub(crate) fn bytes(&self) -> (usize, usize) {
        let all = [
            bytes_of(&self.stages),
            bytes_of_trees(&self.trees),
            bytes_of_trees(&self.single_trees),
            (self.coupling_bytes(), self.coupling_bytes()),
            bytes_of(&self.touching),
            self.tree_slots.bytes(),
            self.nets.bytes(),
        ];
        let tables = self.tables.all().map(AnyTable::bytes);
        sum_bytes(all.into_iter().chain(tables))
    }

    /// Decides which rows share a batch, and in which order they are solved. `in_trees`: whether trees are
    /// solved as such.
    pub(crate) fn arrange(&mut self, joints: &Joints, bodies: &Bodies, order: Order, in_trees: bool) {
        self.arrangement = 1 + ARRANGEMENTS.fetch_add(1, std::sync::atomic::Ordering::Relaxed);
        for table in self.tables.all_mut() {
            table.owners().lanes.clear();
            table.owners().single.clear();
        }
        self.stages.clear();
        let body =
            |joint: u32, side: usize| bodies.slots.dense(joints.all[joint as usize].bodies[side]) as usize;
        let solved_after = |joint: u32| {
            let of_body = |side: usize| bodies.traits[body(joint, side)].solved_after;
            order.higher(joints.all[joint as usize].solved_after, order.higher(of_body(0), of_body(1)))
        };
        let enabled = |joint: u32| [0, 1].iter().all(|&side| !bodies.traits[body(joint, side)].disabled);
        let place = |joint: u32, group: RowGroup| order.place(group, solved_after(joint));
        let plan = Plan::new(&PlanInput {
            joints,
            place_of: &|joint, group| enabled(joint).then(|| place(joint, group)),
            is_pushed: &|slot| (bodies.slots.dense(slot) as usize) < bodies.dynamic(),
        });
        self.add_blocks(&plan);
        let is_coupled = |row: u32| plan.has_drive(row);
        let motor = |row: u32| {
            let (coupled, row) = (is_coupled(row), &joints.rows[row as usize]);
            (enabled(row.joint) && row.drives_hinge() && !coupled).then(|| place(row.joint, group_of(row)))
        };
        let of_joint = |joint| place(joint, RowGroup::Joints);
        let found =
            if in_trees { find(joints, bodies, &of_joint, &motor, &enabled) } else { Found::none(joints) };
        // Rows of the same place and type are coloured together.
        let mut entries: Vec<(Place, JointType, u32, u32)> = Vec::new();
        let awake =
            |joint: u32| enabled(joint) && [0, 1].iter().any(|&side| body(joint, side) < bodies.dynamic());
        let alone = |i: usize| !found.rows[i] && !is_coupled(i as u32);
        let rows = joints.rows.iter().enumerate().filter(|(i, r)| alone(*i) && awake(r.joint));
        entries.extend(
            rows.map(|(i, r)| (place(r.joint, group_of(r)), JointType::of_row(r), i as u32, r.joint)),
        );
        let locks = joints.locks.iter().enumerate().filter(|(i, l)| !found.locks[*i] && awake(l.joint));
        entries.extend(
            locks.map(|(i, l)| (place(l.joint, RowGroup::Joints), JointType::of_lock(l), i as u32, l.joint)),
        );
        entries.sort_unstable();
        let mut colouring = Colouring::default();
        let mut parts: Vec<(usize, u32)> = Vec::new();
        for alike in entries.chunk_by(|a, b| (a.0, a.1) == (b.0, b.1)) {
            colouring.reset(bodies.dynamic());
            parts.clear();
            parts.extend(alike.iter().map(|&(.., owner, joint)| {
                let colour = colouring.assign(body(joint, 0), body(joint, 1));
                // Rows without a colour come first.
                ((colour + 1) % (COLOURS + 1), owner)
            }));
            parts.sort_by_key(|part| part.0);
            self.add_stages(alike[0].0, alike[0].1, &parts);
        }
        self.build_tree_batches(&found.groups);
        self.stages.sort_by_key(|stage| stage.place);
        self.tables.all_mut().into_iter().for_each(AnyTable::resize);
    }

    /// Makes the blocks of couplings, and their stages.
    fn add_blocks(&mut self, plan: &Plan) {
        self.couplings = plan.blocks.iter().map(|(_, owners)| CouplingBlock::new(owners)).collect();
        let mut start = 0;
        for of_place in plan.blocks.chunk_by(|a, b| a.0 == b.0) {
            let (place, end) = (of_place[0].0, start + of_place.len() as u32);
            self.stages.push(JointStage { place, kind: JointType::Coupling, start, end, single: true });
            start = end;
        }
    }

    /// Makes the batches of trees, and their stages: no two share a body that they can push.
    fn build_tree_batches(&mut self, groups: &[Vec<Tree>]) {
        self.trees.clear();
        self.single_trees.clear();
        for of_place in groups.chunk_by(|a, b| a[0].place == b[0].place) {
            let (lanes, single) = (self.trees.len(), self.single_trees.len());
            self.trees.extend(of_place.iter().filter(|group| group.len() > 1).map(|group| batch_of(group)));
            self.single_trees
                .extend(of_place.iter().filter(|group| group.len() == 1).map(|group| batch_of(group)));
            for (start, end, single) in
                [(lanes, self.trees.len(), false), (single, self.single_trees.len(), true)]
            {
                if start < end {
                    let (start, end) = (start as u32, end as u32);
                    let (place, kind) = (of_place[0][0].place, JointType::Tree);
                    self.stages.push(JointStage { place, kind, start, end, single });
                }
            }
        }
        self.trees.shrink_to_fit();
        self.single_trees.shrink_to_fit();
    }

    fn add_stages(&mut self, place: Place, kind: JointType, parts: &[(usize, u32)]) {
        let Some(Owners { lanes: owners, single }) = self.tables.owners(kind) else { return };
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
            self.stages.push(JointStage {
                place,
                kind,
                start: start as u32,
                end: end as u32,
                single: serial,
            });
        }
    }

    /// Fills the batches of trees. Their bodies get tree slots if contacts with static geometry are more
    /// important than joints, and the inertia that is used by all that is prepared afterwards is the
    /// stiffened one.
    pub(crate) fn fill_trees(
        &mut self,
        workers: &Workers<'_>,
        input: &PrepareInput<'_>,
        inverse_inertia: &mut [Sym3<f32>],
    ) {
        self.tree_slots.clear();
        if self.trees.is_empty() && self.single_trees.is_empty() {
            return;
        }
        self.touching.clear();
        self.touching.resize(input.bodies.dynamic(), false);
        for pair in input.pairs.iter().filter(|pair| pair.contact != NO_CONTACT) {
            for c in [pair.a, pair.b] {
                let body = input.colliders.summaries[c as usize].body as usize;
                self.touching.get_mut(body).into_iter().for_each(|touches| *touches = true);
            }
        }
        let (touching, inertia) = (self.touching.as_slice(), &*inverse_inertia);
        let (count, trees) = (self.trees.len(), Shared::new(&mut self.trees));
        // SAFETY: each batch is in one block.
        workers.run(count, &|i| fill_tree(unsafe { trees.get(i) }, input, inertia, touching));
        self.single_trees.iter_mut().for_each(|batch| fill_tree(batch, input, inertia, touching));
        let (slots, dynamic) = (&mut self.tree_slots, input.bodies.dynamic());
        let mut put = |cut: bool, place: Place, slot: TreeSlot, body: u32, inverse: Sym3<f32>| {
            inverse_inertia[body as usize] = inverse;
            let of_body = |group| input.order.place(group, input.bodies.traits[body as usize].solved_after);
            let first = of_body(RowGroup::StaticContacts).min(of_body(RowGroup::PotentialStaticContacts));
            if first > place && !cut {
                if slots.is_empty() {
                    slots.reset(dynamic);
                }
                slots.put(body as usize, slot);
            }
        };
        let lanes = self.trees.iter().enumerate();
        lanes.for_each(|(i, batch)| each_body(batch, TreeRef::new(i, false), &mut put));
        let single = self.single_trees.iter().enumerate();
        single.for_each(|(i, batch)| each_body(batch, TreeRef::new(i, true), &mut put));
    }

    /// Fills all batches. `along`: the contacts that are solved along with trees.
    pub(crate) fn fill(&mut self, workers: &Workers<'_>, input: &PrepareInput<'_>, along: &[TreeContacts]) {
        for table in self.tables.all_mut() {
            table.fill(workers, input);
        }
        self.couplings.iter_mut().for_each(|block| block.fill(input));
        let range = |tree: TreeRef| {
            let end = |before: &dyn Fn(TreeRef) -> bool| along.partition_point(|s| before(s.tree)) as u32;
            (end(&|other| other < tree), end(&|other| other <= tree))
        };
        let (count, trees) = (self.trees.len(), Shared::new(&mut self.trees));
        // SAFETY: each batch is in one block.
        workers.run(count, &|i| unsafe { trees.get(i) }.take_along(range(TreeRef::new(i, false))));
        let single = self.single_trees.iter_mut().enumerate();
        single.for_each(|(i, batch)| batch.take_along(range(TreeRef::new(i, true))));
    }

    /// The bodies of a tree.
    pub(crate) fn bodies_of(&self, slot: TreeSlot) -> impl Iterator<Item = usize> + '_ {
        let (tree, lane) = (slot.place().0, slot.lane());
        let (lanes, single) = if tree.is_single() {
            (&[][..], self.single_trees[tree.index()].of_bodies())
        } else {
            (self.trees[tree.index()].of_bodies(), &[][..])
        };
        let bodies = lanes.iter().map(move |node| node.body[lane] as usize);
        bodies.chain(single.iter().map(move |node| node.body[lane] as usize))
    }
}

/// Calls `f` with each body of a batch of trees, its slot and the inverse of its stiffened inertia.
fn each_body<L: Lanes>(
    batch: &TreeBatch<L>,
    tree: TreeRef,
    f: &mut impl FnMut(bool, Place, TreeSlot, u32, Sym3<f32>),
) {
    for (i, node) in batch.of_bodies().iter().enumerate() {
        for lane in (0..L::N).filter(|lane| node.write >> lane & 1 != 0) {
            f(
                batch.is_cut(),
                batch.place,
                TreeSlot::new(tree, i, lane),
                node.body[lane],
                node.stiffened_inverse.lane(lane),
            );
        }
    }
}

/// Whether a row stays where it is in the batches if it becomes another.
pub(crate) fn arranged_alike(a: &Row, b: &Row) -> bool {
    let arranged = |row: &Row| (group_of(row), JointType::of_row(row), row.drives_hinge());
    arranged(a) == arranged(b)
}

fn group_of(row: &Row) -> RowGroup {
    match row.kind {
        RowKind::Limit { min, max } if min == max => RowGroup::Joints,
        RowKind::Limit { .. } => RowGroup::JointLimits,
        _ => RowGroup::SoftJoints,
    }
}

fn bytes_of_trees<L>(trees: &Vec<TreeBatch<L>>) -> (usize, usize) {
    let extra = |tree: &TreeBatch<L>| (tree.extra.reserved(), tree.extra.reserved());
    let own = trees.iter().flat_map(|tree| [bytes_of(&tree.nodes), extra(tree)]);
    sum_bytes(own.chain([bytes_of(trees)]))
}

/// A batch of trees of the same shape, a lane each.
fn batch_of<L: Lanes>(group: &[Tree]) -> TreeBatch<L> {
    let (first, place) = (&group[0].branches, group[0].place);
    let node = |i: usize| {
        let mut node = Node::default();
        (node.side, node.parent, node.jointed) = (first[i].side, first[i].parent, first[i].jointed);
        (node.turns, node.own) = (first[i].turns, first[i].own);
        for (lane, tree) in group.iter().enumerate() {
            let branch = &tree.branches[i];
            (node.owner[lane], node.turn_owner[lane]) = (branch.lock, branch.turn);
        }
        node
    };
    let motors = group[0].motors.iter().enumerate().map(|(k, &(at, _))| {
        let mut motor = TreeMotor::new(at);
        let own = group.iter().map(|tree| tree.motors[k].1);
        motor.owner.iter_mut().zip(own).for_each(|(owner, own)| *owner = own);
        motor
    });
    TreeBatch {
        nodes: (0..first.len()).map(node).collect(),
        real: group[0].bodies(),
        extra: Extra::new(motors.collect(), group[0].rows() + group[0].motors.len()),
        place,
        ..TreeBatch::default()
    }
}

#[cfg(test)]
mod bytes_tests;
