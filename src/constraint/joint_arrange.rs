//! Joints -> batches. Which rows share a batch is settled when joints come or go; what is in them, in every step.

use super::colour::{COLOURS, Colouring, OVERFLOW};
use super::joint_cut::{Extra, Motor};
use super::joint_ends::{NONE, Owned};
use super::joint_fill::{get_sym, line, point, row, tree, turn};
use super::joint_line::LineBatch;
use super::joint_lock::{PointBatch, TurnBatch};
use super::joint_measure::{Distance, Slide, Tilt, Turn, Twist};
use super::joint_nets::Nets;
use super::joint_row::RowBatch;
use super::joint_tree::{Node, TreeBatch};
use super::joint_trees::{Tree, find};
use super::order::Place;
use super::seats::{Seat, Seated, Seats, TreeRef};
use crate::body::Bodies;
use crate::broad_phase::Pair;
use crate::config::{Order, RowGroup};
use crate::joint::{Axes, Joints, Lock, LockKind, Motion, Row, RowKind};
use crate::lanes::{Lanes, Record, Sym3, f32x8};
use crate::memory::{Buffer, bytes_of};
use crate::narrow_phase::NONE as NO_CONTACT;
use crate::shape::Hot;
use crate::threads::{Crew, Shared, per_block};

/// A type of row. Those of one place are solved in this order.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub(crate) enum JointType {
    Slide,
    Distance,
    Twist,
    Tilt,
    Turn,
    Weld,
    Hinge,
    Line,
    Point,
    Tree,
}

impl JointType {
    /// Whether its directions turn by how its bodies move, and not only by how they turn.
    pub(crate) fn slides(self) -> bool {
        matches!(self, JointType::Slide | JointType::Distance | JointType::Line)
    }

    /// Whether it locks directions all at once, without bounds.
    pub(crate) fn is_lock(self) -> bool {
        matches!(self, JointType::Point | JointType::Weld | JointType::Hinge | JointType::Line)
    }
}

/// Batches of one type that may be solved at the same time: one colour of one group.
#[derive(Clone, Copy, Debug)]
pub(crate) struct JointStage {
    pub(crate) place: Place,
    pub(crate) kind: JointType,
    /// Range of the batches of this type; of the single ones, if it is serial.
    pub(crate) start: u32,
    pub(crate) end: u32,
    /// One lane: rows that found no colour, one after another, or trees that have no like.
    pub(crate) single: bool,
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
            (self.lanes, self.owners) = (Vec::new(), Vec::new());
        }
        if self.single_owners.is_empty() {
            (self.single, self.single_owners) = (Vec::new(), Vec::new());
        }
    }
    /// How many locks or rows there are.
    fn len(&self) -> u32 {
        let in_lanes = self.owners.iter().flatten().filter(|&&owner| owner != NONE).count();
        (in_lanes + self.single_owners.len()) as u32
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
            let first = block * BLOCK;
            for (i, owners) in owners.iter().enumerate().skip(first).take(BLOCK) {
                // SAFETY: each batch is in one block.
                one(unsafe { lanes.get(i) }, owners);
            }
        });
        for (batch, owner) in self.single.iter_mut().zip(&self.single_owners) {
            alone(batch, std::slice::from_ref(owner));
        }
    }
}

impl<T, B8: Owned<Load = T>, B1: Owned<Load = T>> Table<B8, B1> {
    /// Calls `f` with each owner and what its lane has for it.
    fn each(&self, f: &mut impl FnMut(u32, T)) {
        for batch in &self.lanes {
            for (lane, &own) in batch.owners().iter().enumerate().filter(|(_, own)| **own != NONE) {
                f(own, batch.load(lane));
            }
        }
        self.single.iter().for_each(|batch| f(batch.owners()[0], batch.load(0)));
    }
}

/// Batches a block.
const BLOCK: usize = per_block(8, 1);

/// Rows of one direction that measure the same.
type Measured<M8, M1> = Table<RowBatch<f32x8, M8>, RowBatch<f32, M1>>;

/// All rows of joints of a step.
#[derive(Debug, Default)]
pub(crate) struct JointRows {
    pub(super) points: Table<PointBatch<f32x8>, PointBatch<f32>>,
    pub(super) lines: Table<LineBatch<f32x8>, LineBatch<f32>>,
    pub(super) welds: Table<TurnBatch<f32x8, false>, TurnBatch<f32, false>>,
    pub(super) hinges: Table<TurnBatch<f32x8, true>, TurnBatch<f32, true>>,
    pub(super) slides: Measured<Slide<f32x8>, Slide<f32>>,
    pub(super) distances: Measured<Distance<f32x8>, Distance<f32>>,
    pub(super) twists: Measured<Twist<f32x8>, Twist<f32>>,
    pub(super) tilts: Measured<Tilt<f32x8>, Tilt<f32>>,
    pub(super) turns: Measured<Turn<f32x8>, Turn<f32>>,
    /// Trees of points: one alone, or up to eight alike.
    pub(super) trees: Vec<TreeBatch<f32x8>>,
    pub(super) tree: Vec<TreeBatch<f32>>,
    /// Dynamic bodies that have contacts, if there are trees.
    touching: Vec<bool>,
    /// Bodies whose contacts with what is static go along with trees.
    pub(crate) seats: Seats,
    /// What hangs together.
    pub(crate) nets: Nets,
    /// As they are solved.
    pub(crate) stages: Vec<JointStage>,
    /// A number of its own for each arrangement, whatever the world: what a snapshot found arranged it need not have arranged
    /// again. No other use: results don't depend on it.
    pub(crate) arrangement: u64,
}

/// The number of the last arrangement.
static ARRANGEMENTS: std::sync::atomic::AtomicU64 = std::sync::atomic::AtomicU64::new(0);

/// What preparing joints reads.
pub(crate) struct JointInput<'a> {
    pub(crate) bodies: &'a Bodies,
    pub(crate) inverse_inertia: &'a [Sym3<f32>],
    /// What pulls bodies; empty if nothing does.
    pub(crate) acceleration: &'a [Record],
    pub(crate) joints: &'a Joints,
    pub(crate) pairs: &'a [Pair],
    pub(crate) hot: &'a [Hot],
    /// Contacts that go along with trees.
    pub(crate) seated: &'a [Seated],
    /// In which order groups of rows are solved.
    pub(crate) order: Order,
    /// Factor on the impulses of the last step.
    pub(crate) warm: f32,
    /// Substep [s].
    pub(crate) h: f32,
    /// The length unit [m].
    pub(crate) unit: f32,
}

/// Share of a lasting load that a joint bears rigidly.
const SHARE: f32 = 0.9;

impl JointRows {
    /// Calls `f` with each buffer that has an entry for each body that can be pushed.
    pub(crate) fn each(&mut self, dynamic: usize, f: &mut dyn FnMut(&mut dyn Buffer, usize)) {
        f(&mut self.touching, dynamic);
        f(self.seats.buffer(), dynamic);
        self.nets.each(dynamic, f);
    }

    /// There are no joints any more.
    pub(crate) fn give_back(&mut self) {
        *self = JointRows { arrangement: self.arrangement, ..JointRows::default() };
    }

    /// Reserved bytes of what goes along with all, of trees, of locks that are in none, and of rows.
    pub(crate) fn parts(&self) -> [usize; 4] {
        let beside =
            [bytes_of(&self.stages), bytes_of(&self.touching), self.seats.bytes(), self.nets.bytes()];
        let trees = [bytes_of_trees(&self.trees), bytes_of_trees(&self.tree)];
        let locks = [self.points.bytes(), self.welds.bytes(), self.hinges.bytes(), self.lines.bytes()];
        let rows = [
            self.slides.bytes(),
            self.distances.bytes(),
            self.twists.bytes(),
            self.tilts.bytes(),
            self.turns.bytes(),
        ];
        [&beside[..], &trees, &locks, &rows].map(|all| all.iter().map(|bytes| bytes.1).sum())
    }

    /// How many trees have bodies that count as heavier than they are.
    pub(crate) fn weighted_trees(&self) -> u32 {
        let in_lanes = self.trees.iter().map(|tree| tree.weighted.count_ones()).sum::<u32>();
        in_lanes + self.tree.iter().map(|tree| tree.weighted).sum::<u32>()
    }

    /// Of how many trees a substep was done again.
    pub(crate) fn damped_trees(&self) -> u32 {
        let in_lanes = self.trees.iter().map(|tree| tree.damped.count_ones()).sum::<u32>();
        let single = self.tree.iter().map(|tree| tree.damped.count_ones()).sum::<u32>();
        in_lanes + single + self.nets.damped()
    }

    /// How many bodies are in trees, and how many locks are in none.
    pub(crate) fn counts(&self) -> [u32; 2] {
        let in_lanes = self.trees.iter().map(TreeBatch::bodies).sum::<u32>();
        let bodies = in_lanes + self.tree.iter().map(TreeBatch::bodies).sum::<u32>();
        let locks = self.points.len() + self.welds.len() + self.hinges.len() + self.lines.len();
        [bodies, locks]
    }

    /// Live and reserved bytes.
    pub(crate) fn bytes(&self) -> (usize, usize) {
        let all = [
            self.points.bytes(),
            self.welds.bytes(),
            self.hinges.bytes(),
            self.lines.bytes(),
            self.slides.bytes(),
            self.distances.bytes(),
            self.twists.bytes(),
            self.tilts.bytes(),
            self.turns.bytes(),
            bytes_of(&self.stages),
            bytes_of_trees(&self.trees),
            bytes_of_trees(&self.tree),
            bytes_of(&self.touching),
            self.seats.bytes(),
            self.nets.bytes(),
        ];
        all.into_iter().fold((0, 0), |s, b| (s.0 + b.0, s.1 + b.1))
    }

    /// Settles which rows share a batch, and in which order they are solved. `in_trees`: whether what makes trees is solved as such.
    pub(crate) fn arrange(&mut self, joints: &Joints, bodies: &Bodies, order: Order, in_trees: bool) {
        self.arrangement = 1 + ARRANGEMENTS.fetch_add(1, std::sync::atomic::Ordering::Relaxed);
        self.points.clear();
        self.welds.clear();
        self.hinges.clear();
        self.lines.clear();
        self.slides.clear();
        self.distances.clear();
        self.twists.clear();
        self.tilts.clear();
        self.turns.clear();
        self.stages.clear();
        let body =
            |joint: u32, side: usize| bodies.slots.dense(joints.all[joint as usize].bodies[side]) as usize;
        let raised = |joint: u32| {
            let of_body = |side: usize| bodies.traits[body(joint, side)].raised;
            order.higher(joints.all[joint as usize].raised, order.higher(of_body(0), of_body(1)))
        };
        let enabled = |joint: u32| [0, 1].iter().all(|&side| !bodies.traits[body(joint, side)].disabled);
        let place = |joint: u32, group: RowGroup| order.place(group, raised(joint));
        let motor = |row: u32| {
            let row = &joints.rows[row as usize];
            (enabled(row.joint) && row.drives_hinge()).then(|| place(row.joint, group_of(row)))
        };
        let of_joint = |joint| place(joint, RowGroup::Joints);
        let (trees, [taken, driven]) = if in_trees {
            find(joints, bodies, &of_joint, &motor, &enabled)
        } else {
            (Vec::new(), [vec![false; joints.locks.len()], vec![false; joints.rows.len()]])
        };
        // Rows of one place and type are coloured together.
        let mut entries: Vec<(Place, JointType, u32, u32)> = Vec::new();
        let awake =
            |joint: u32| enabled(joint) && [0, 1].iter().any(|&side| body(joint, side) < bodies.dynamic());
        let rows = joints.rows.iter().enumerate().filter(|(i, r)| !driven[*i] && awake(r.joint));
        entries.extend(rows.map(|(i, r)| (place(r.joint, group_of(r)), type_of_row(r), i as u32, r.joint)));
        let locks = joints.locks.iter().enumerate().filter(|(i, l)| !taken[*i] && awake(l.joint));
        entries.extend(locks.map(|(i, l)| (place(l.joint, RowGroup::Joints), type_of(l), i as u32, l.joint)));
        entries.sort_unstable();
        let mut colouring = Colouring::default();
        let mut parts: Vec<(usize, u32)> = Vec::new();
        for alike in entries.chunk_by(|a, b| (a.0, a.1) == (b.0, b.1)) {
            colouring.reset(bodies.dynamic());
            parts.clear();
            parts.extend(alike.iter().map(|&(.., owner, joint)| {
                let colour = colouring.assign(body(joint, 0), body(joint, 1));
                // What found no colour comes first.
                ((colour + 1) % (COLOURS + 1), owner)
            }));
            parts.sort_by_key(|part| part.0);
            self.add_stages(alike[0].0, alike[0].1, &parts);
        }
        self.plant(&trees);
        self.stages.sort_by_key(|stage| stage.place);
        self.points.resize();
        self.welds.resize();
        self.hinges.resize();
        self.lines.resize();
        self.slides.resize();
        self.distances.resize();
        self.twists.resize();
        self.tilts.resize();
        self.turns.resize();
    }

    /// Batches of trees, and their stages: no two share a body that they can move.
    fn plant(&mut self, groups: &[Vec<Tree>]) {
        self.trees.clear();
        self.tree.clear();
        for of_place in groups.chunk_by(|a, b| a[0].place == b[0].place) {
            let (lanes, single) = (self.trees.len(), self.tree.len());
            self.trees.extend(of_place.iter().filter(|group| group.len() > 1).map(|group| batch_of(group)));
            self.tree.extend(of_place.iter().filter(|group| group.len() == 1).map(|group| batch_of(group)));
            for (start, end, single) in [(lanes, self.trees.len(), false), (single, self.tree.len(), true)] {
                if start < end {
                    let (start, end) = (start as u32, end as u32);
                    let (place, kind) = (of_place[0][0].place, JointType::Tree);
                    self.stages.push(JointStage { place, kind, start, end, single });
                }
            }
        }
        self.trees.shrink_to_fit();
        self.tree.shrink_to_fit();
    }

    fn add_stages(&mut self, place: Place, kind: JointType, parts: &[(usize, u32)]) {
        let (owners, single) = match kind {
            JointType::Point => (&mut self.points.owners, &mut self.points.single_owners),
            JointType::Weld => (&mut self.welds.owners, &mut self.welds.single_owners),
            JointType::Hinge => (&mut self.hinges.owners, &mut self.hinges.single_owners),
            JointType::Line => (&mut self.lines.owners, &mut self.lines.single_owners),
            JointType::Slide => (&mut self.slides.owners, &mut self.slides.single_owners),
            JointType::Distance => (&mut self.distances.owners, &mut self.distances.single_owners),
            JointType::Twist => (&mut self.twists.owners, &mut self.twists.single_owners),
            JointType::Tilt => (&mut self.tilts.owners, &mut self.tilts.single_owners),
            JointType::Turn => (&mut self.turns.owners, &mut self.turns.single_owners),
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
            self.stages.push(JointStage {
                place,
                kind,
                start: start as u32,
                end: end as u32,
                single: serial,
            });
        }
    }

    /// Fills the batches of trees, gives their bodies seats, if contacts with what is static are more important than
    /// joints, and gives all that is prepared after the inertia of what is braced.
    pub(crate) fn fill_trees(
        &mut self,
        crew: &Crew<'_>,
        input: &JointInput<'_>,
        inverse_inertia: &mut [Sym3<f32>],
    ) {
        self.seats.clear();
        if self.trees.is_empty() && self.tree.is_empty() {
            return;
        }
        self.touching.clear();
        self.touching.resize(input.bodies.dynamic(), false);
        for pair in input.pairs.iter().filter(|pair| pair.contact != NO_CONTACT) {
            for c in [pair.a, pair.b] {
                let body = input.hot[c as usize].body as usize;
                self.touching.get_mut(body).into_iter().for_each(|touches| *touches = true);
            }
        }
        let (touching, inertia) = (self.touching.as_slice(), &*inverse_inertia);
        let (count, trees) = (self.trees.len(), Shared::new(&mut self.trees));
        // SAFETY: each batch is in one block.
        crew.run(count, &|i| tree(unsafe { trees.get(i) }, input, inertia, touching));
        self.tree.iter_mut().for_each(|batch| tree(batch, input, inertia, touching));
        let (seats, dynamic) = (&mut self.seats, input.bodies.dynamic());
        let mut put = |(loops, place): (bool, Place), seat: Seat, body: u32, inverse: Sym3<f32>| {
            inverse_inertia[body as usize] = inverse;
            let of_body = |group| input.order.place(group, input.bodies.traits[body as usize].raised);
            let first = of_body(RowGroup::StaticContacts).min(of_body(RowGroup::PotentialStaticContacts));
            if first > place && !loops {
                if seats.is_empty() {
                    seats.reset(dynamic);
                }
                seats.put(body as usize, seat);
            }
        };
        let lanes = self.trees.iter().enumerate();
        lanes.for_each(|(i, batch)| each_body(batch, TreeRef::new(i, false), &mut put));
        let single = self.tree.iter().enumerate();
        single.for_each(|(i, batch)| each_body(batch, TreeRef::new(i, true), &mut put));
    }

    /// Fills all batches.
    pub(crate) fn fill(&mut self, crew: &Crew<'_>, input: &JointInput<'_>) {
        self.points.fill(crew, |b, o| point(b, o, input), |b, o| point(b, o, input));
        self.welds.fill(crew, |b, o| turn(b, o, input), |b, o| turn(b, o, input));
        self.hinges.fill(crew, |b, o| turn(b, o, input), |b, o| turn(b, o, input));
        self.lines.fill(crew, |b, o| line(b, o, input), |b, o| line(b, o, input));
        self.slides.fill(crew, |b, o| row(b, o, input), |b, o| row(b, o, input));
        self.distances.fill(crew, |b, o| row(b, o, input), |b, o| row(b, o, input));
        self.twists.fill(crew, |b, o| row(b, o, input), |b, o| row(b, o, input));
        self.tilts.fill(crew, |b, o| row(b, o, input), |b, o| row(b, o, input));
        self.turns.fill(crew, |b, o| row(b, o, input), |b, o| row(b, o, input));
        let range = |tree: TreeRef| {
            let end =
                |before: &dyn Fn(TreeRef) -> bool| input.seated.partition_point(|s| before(s.tree)) as u32;
            (end(&|other| other < tree), end(&|other| other <= tree))
        };
        let (count, trees) = (self.trees.len(), Shared::new(&mut self.trees));
        // SAFETY: each batch is in one block.
        crew.run(count, &|i| unsafe { trees.get(i) }.take_along(range(TreeRef::new(i, false))));
        let single = self.tree.iter_mut().enumerate();
        single.for_each(|(i, batch)| batch.take_along(range(TreeRef::new(i, true))));
    }

    /// The bodies of a tree.
    pub(crate) fn bodies_of(&self, seat: Seat) -> impl Iterator<Item = usize> + '_ {
        let (tree, lane) = (seat.place().0, seat.lane());
        let (lanes, single) = if tree.is_single() {
            (&[][..], self.tree[tree.index()].of_bodies())
        } else {
            (self.trees[tree.index()].of_bodies(), &[][..])
        };
        let bodies = lanes.iter().map(move |node| node.body[lane] as usize);
        bodies.chain(single.iter().map(move |node| node.body[lane] as usize))
    }

    /// Writes impulses back, and what each joint bore. `inverse_h`: 1 / substep [1/s]; `hold`: share of a load that lasts
    /// that a step takes for one.
    pub(crate) fn store(&self, joints: &mut Joints, bodies: &Bodies, inverse_h: f32, hold: f32) {
        if self.stages.is_empty() {
            return;
        }
        let awake = |slot: &u32| *slot != NONE && (bodies.slots.dense(*slot) as usize) < bodies.dynamic();
        for joint in joints.all.iter_mut().filter(|joint| joint.bodies.iter().any(awake)) {
            (joint.force, joint.torque) = (glam::Vec3::ZERO, glam::Vec3::ZERO);
        }
        let Joints { all, locks, rows, .. } = joints;
        let mut lock = |owner: u32, impulse: glam::Vec3| {
            // Joints that contradict each other may have come to no number.
            let impulse = if impulse.is_finite() { impulse } else { glam::Vec3::ZERO };
            let lock = &mut locks[owner as usize];
            lock.steady = impulse.length().min(lock.impulse.length());
            lock.impulse = impulse;
            // A load that is gone is gone at once.
            let bears = impulse.length() * SHARE;
            let lasting = lock.held.min(bears);
            lock.held = lasting + (bears - lasting) * hold;
            let joint = &mut all[lock.joint as usize];
            match lock.kind {
                LockKind::Point | LockKind::Line(_) => joint.force += impulse * inverse_h,
                _ => joint.torque += impulse * inverse_h,
            }
        };
        self.points.each(&mut lock);
        self.lines.each(&mut lock);
        self.welds.each(&mut lock);
        self.hinges.each(&mut lock);
        self.trees.iter().for_each(|batch| impulses_of(batch, &mut lock));
        self.tree.iter().for_each(|batch| impulses_of(batch, &mut lock));
        let mut late = |owner: u32, lag: f32| locks[owner as usize].lag = lag;
        self.trees.iter().for_each(|batch| batch.each_lag(&mut late));
        self.tree.iter().for_each(|batch| batch.each_lag(&mut late));
        let mut row = |owner: u32, (impulse, along, about): ([f32; 2], glam::Vec3, glam::Vec3)| {
            let row = &mut rows[owner as usize];
            let impulse = impulse.map(|one| if one.is_finite() { one } else { 0.0 });
            row.impulse = impulse;
            let bears = (impulse[0] - impulse[1]) * SHARE;
            let lasting =
                if bears * row.held <= 0.0 { 0.0 } else { row.held.max(-bears.abs()).min(bears.abs()) };
            row.held = lasting + (bears - lasting) * hold;
            let (joint, p) = (&mut all[row.joint as usize], (impulse[0] - impulse[1]) * inverse_h);
            joint.force += along * p;
            joint.torque += about * p;
        };
        self.slides.each(&mut row);
        self.distances.each(&mut row);
        self.twists.each(&mut row);
        self.tilts.each(&mut row);
        self.turns.each(&mut row);
        self.trees.iter().for_each(|batch| motors_of(batch, &mut row));
        self.tree.iter().for_each(|batch| motors_of(batch, &mut row));
    }
}

/// Calls `f` with each body of a batch of trees, its seat and the inverse of its inertia as it is braced.
fn each_body<L: Lanes>(
    batch: &TreeBatch<L>,
    tree: TreeRef,
    f: &mut impl FnMut((bool, Place), Seat, u32, Sym3<f32>),
) {
    for (i, node) in batch.of_bodies().iter().enumerate() {
        for lane in (0..L::N).filter(|lane| node.write >> lane & 1 != 0) {
            f(
                (batch.loops || batch.is_cut(), batch.place),
                Seat::new(tree, i, lane),
                node.body[lane],
                get_sym(&node.braced_inverse, lane),
            );
        }
    }
}

fn group_of(row: &Row) -> RowGroup {
    match row.kind {
        RowKind::Limit { min, max } if min == max => RowGroup::Joints,
        RowKind::Limit { .. } => RowGroup::JointLimits,
        _ => RowGroup::SoftJoints,
    }
}

fn type_of_row(row: &Row) -> JointType {
    match (row.motion, row.axes) {
        (Motion::Linear, Axes::One(_)) => JointType::Slide,
        (Motion::Linear, _) => JointType::Distance,
        (Motion::Angular, Axes::One(_)) => JointType::Twist,
        (Motion::Angular, Axes::Around(_)) => JointType::Tilt,
        (Motion::Angular, Axes::All) => JointType::Turn,
    }
}

fn type_of(lock: &Lock) -> JointType {
    match lock.kind {
        LockKind::Point => JointType::Point,
        LockKind::Line(_) => JointType::Line,
        LockKind::Weld => JointType::Weld,
        LockKind::Hinge(_) => JointType::Hinge,
    }
}

fn bytes_of_trees<L>(trees: &Vec<TreeBatch<L>>) -> (usize, usize) {
    let extra = |tree: &TreeBatch<L>| (tree.extra.reserved(), tree.extra.reserved());
    let own = trees.iter().flat_map(|tree| [bytes_of(&tree.nodes), extra(tree)]);
    own.fold(bytes_of(trees), |s, b| (s.0 + b.0, s.1 + b.1))
}

/// The nodes of trees of one shape, a lane each.
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
    let loops = first.iter().any(|branch| branch.collides);
    let motors = group[0].motors.iter().enumerate().map(|(k, &(at, _))| {
        let mut motor = Motor::new(at);
        let own = group.iter().map(|tree| tree.motors[k].1);
        motor.owner.iter_mut().zip(own).for_each(|(owner, own)| *owner = own);
        motor
    });
    TreeBatch {
        nodes: (0..first.len()).map(node).collect(),
        real: group[0].bodies(),
        extra: Extra::new(motors.collect(), group[0].rows() + group[0].motors.len()),
        loops,
        place,
        ..TreeBatch::default()
    }
}

/// Calls `f` with each lock of a batch of trees and its impulse.
pub(super) fn impulses_of<L: Lanes>(batch: &TreeBatch<L>, f: &mut impl FnMut(u32, glam::Vec3)) {
    for node in batch.nodes.iter().filter(|node| node.jointed) {
        let sign = if node.side == 1 { 1.0 } else { -1.0 };
        for (lane, owner) in node.owner.into_iter().enumerate().filter(|(_, owner)| *owner != NONE) {
            f(owner, node.impulse.lane(lane) * sign);
            if node.turn_owner[lane] != NONE {
                f(node.turn_owner[lane], node.twist.lane(lane) * sign);
            }
        }
    }
}

/// Calls `f` with the row of each motor of a batch of trees, its impulse, and about what it turns the second body of its joint.
pub(super) fn motors_of<L: Lanes>(
    batch: &TreeBatch<L>,
    f: &mut impl FnMut(u32, ([f32; 2], glam::Vec3, glam::Vec3)),
) {
    for motor in &batch.extra.motors {
        let node = &batch.nodes[motor.node as usize];
        let sign = if node.side == 1 { 1.0 } else { -1.0 };
        for (lane, owner) in motor.owner.into_iter().enumerate().filter(|(_, owner)| *owner != NONE) {
            let (impulse, about) = (motor.impulse.lane(lane) * sign, node.axis_now[0].lane(lane));
            f(owner, ([impulse, 0.0], glam::Vec3::ZERO, about));
        }
    }
}

#[cfg(test)]
#[path = "joint_bytes_tests.rs"]
mod bytes_tests;
