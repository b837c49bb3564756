//! Contacts -> batches: sort by importance, colour and size, then fill the lanes.

use super::batch::{Batch, BatchRef, Rows, couple};
use super::colour::{COLOURS, Colouring, OVERFLOW};
use super::order::{Group, Stage};
use crate::body::{Bodies, Pose};
use crate::broad_phase::Pair;
use crate::lanes::{GatherLanes, Lanes, Mask, Record, Sym3, Vec3, gather};
use crate::memory::bytes_of;
use crate::narrow_phase::{Contact, NONE};
use crate::shape::Collider;
use crate::threads::{Crew, Shared};

/// What preparing reads.
pub(crate) struct PrepareInput<'a> {
    pub(crate) bodies: &'a Bodies,
    pub(crate) colliders: &'a [Collider],
    pub(crate) poses: &'a [Pose],
    pub(crate) contacts: &'a [Contact],
    pub(crate) pairs: &'a [Pair],
    /// Predicted displacement of each body that can move.
    pub(crate) motion: &'a [Record],
    /// World inverse inertia of each dynamic body.
    pub(crate) inverse_inertia: &'a [Sym3<f32>],
    /// A separation up to this is real [m].
    pub(crate) real: f32,
    /// Factor on the impulses of the last step: the ratio of the substeps; zero without warm starting.
    pub(crate) warm: f32,
    /// Slip speed below which friction is static [m/s].
    pub(crate) stick: f32,
    /// Friction at every point: each point then is a manifold of its own.
    pub(crate) per_point: bool,
}

/// A contact, or one point of it, in a lane of a batch.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) struct Part(pub(crate) u32);

impl Part {
    const SLOT: u32 = (1 << 29) - 1;
    /// An inert lane.
    pub(crate) const NONE: Part = Part(u32::MAX);

    fn whole(slot: u32) -> Part {
        Part(slot)
    }
    fn point(slot: u32, point: usize) -> Part {
        Part(slot | (point as u32 + 1) << 29)
    }
    pub(crate) fn slot(self) -> usize {
        (self.0 & Self::SLOT) as usize
    }
    /// The point, unless the part is the whole contact.
    pub(crate) fn only(self) -> Option<usize> {
        (self.0 >> 29).checked_sub(1).map(|p| p as usize)
    }
    /// First point and number of points.
    fn range(self, contact: &Contact) -> (usize, usize) {
        self.only().map_or((0, contact.count as usize), |p| (p, 1))
    }
}

/// Buffers of one step.
#[derive(Debug, Default)]
pub(crate) struct PrepareScratch {
    colouring: [Colouring; 4],
    /// Contact and sort key.
    entries: Vec<(Part, u32)>,
    sorted: Vec<Part>,
    /// First contact in `sorted` of each batch of the schedule, and how many.
    ranges: Vec<(u32, u32)>,
}

impl PrepareScratch {
    pub(crate) fn bytes(&self) -> (usize, usize) {
        let lists = [bytes_of(&self.entries), bytes_of(&self.sorted), bytes_of(&self.ranges)];
        let colours = self.colouring.iter().map(Colouring::bytes);
        lists.into_iter().chain(colours).fold((0, 0), |s, b| (s.0 + b.0, s.1 + b.1))
    }
}

/// Sort key: group, colour, then four points before one, so that lanes of a batch are alike.
const KEYS: usize = Group::ALL.len() * (COLOURS + 1) * 4;
/// Batches a block.
const BLOCK: usize = 8;

/// Builds all batches of the step.
pub(crate) fn prepare(
    crew: &Crew<'_>,
    input: &PrepareInput<'_>,
    rows: &mut Rows,
    scratch: &mut PrepareScratch,
) {
    sort(input, scratch);
    schedule(rows, scratch);
    let Rows { p1, p2, p3, p4, single, schedule, stages } = rows;
    let (p1, p2, p3, p4) = (Shared::new(p1), Shared::new(p2), Shared::new(p3), Shared::new(p4));
    let single = Shared::new(single);
    let (schedule, stages, scratch) = (&*schedule, &*stages, &*scratch);
    crew.run(schedule.len().div_ceil(BLOCK), &|block| {
        let mut stage = stages.partition_point(|s| s.end as usize <= block * BLOCK);
        for index in block * BLOCK..((block + 1) * BLOCK).min(schedule.len()) {
            while stages[stage].end as usize <= index {
                stage += 1;
            }
            let group = stages[stage].group;
            let (first, count) = scratch.ranges[index];
            let contacts = &scratch.sorted[first as usize..(first + count) as usize];
            let BatchRef { points, index } = schedule[index];
            let i = index as usize;
            // SAFETY: each batch stands in the schedule once, so no other block fills it.
            unsafe {
                match points {
                    1 => fill(p1.get(i), contacts, group, input),
                    2 => fill(p2.get(i), contacts, group, input),
                    3 => fill(p3.get(i), contacts, group, input),
                    4 => fill(p4.get(i), contacts, group, input),
                    _ => fill(single.get(i), contacts, group, input),
                }
            }
        }
    });
}

/// Contacts by group, colour and number of points.
fn sort(input: &PrepareInput<'_>, scratch: &mut PrepareScratch) {
    let PrepareScratch { colouring, entries, sorted, .. } = scratch;
    let dynamic = input.bodies.dynamic();
    colouring.iter_mut().for_each(|c| c.reset(dynamic));
    entries.clear();
    let mut starts = [0u32; KEYS + 1];
    for pair in input.pairs {
        let mut slot = pair.contact;
        while slot != NONE {
            let contact = &input.contacts[slot as usize];
            if contact.count > 0 {
                let body = |c: u32| input.colliders[c as usize].body as usize;
                let (a, b) = (body(contact.a), body(contact.b));
                let movers = input.bodies.movers();
                let potential = contact.points().iter().all(|p| p.separation > input.real);
                let group = Group::of(a >= movers || b >= movers, potential);
                let mut enter = |part: Part, count: usize| {
                    let colour = colouring[group as usize].assign(a, b);
                    let key = (group as usize * (COLOURS + 1) + colour) * 4 + 4 - count;
                    entries.push((part, key as u32));
                    starts[key + 1] += 1;
                };
                if input.per_point {
                    (0..contact.count as usize).for_each(|point| enter(Part::point(slot, point), 1));
                } else {
                    enter(Part::whole(slot), contact.count as usize);
                }
            }
            slot = contact.next;
        }
    }
    for key in 0..KEYS {
        starts[key + 1] += starts[key];
    }
    sorted.clear();
    sorted.resize(entries.len(), Part::NONE);
    for &(part, key) in entries.iter() {
        let at = &mut starts[key as usize];
        sorted[*at as usize] = part;
        *at += 1;
    }
    // `starts[key]` is now the end of the key's range; `schedule` reads it from the entries' counts again.
    scratch.ranges.clear();
    for key in 0..KEYS {
        let start = if key == 0 { 0 } else { starts[key - 1] };
        scratch.ranges.push((start, starts[key] - start));
    }
}

/// Batches of each stage. Contacts without a colour come first in their group: what is solved later wins.
fn schedule(rows: &mut Rows, scratch: &mut PrepareScratch) {
    let keys: [(u32, u32); KEYS] = std::array::from_fn(|key| scratch.ranges[key]);
    let contact_points = |key: usize| 4 - key % 4;
    let (mut counts, mut singles) = ([0u32; 4], 0u32);
    rows.schedule.clear();
    rows.stages.clear();
    scratch.ranges.clear();
    for group in Group::ALL {
        let colours = std::iter::once(OVERFLOW).chain(0..COLOURS);
        for colour in colours {
            let first = (group as usize * (COLOURS + 1) + colour) * 4;
            let start = keys[first].0;
            let end = keys[first + 3].0 + keys[first + 3].1;
            if start == end {
                continue;
            }
            let stage_start = rows.schedule.len() as u32;
            let serial = colour == OVERFLOW;
            let width = if serial { 1 } else { 8 };
            for at in (start..end).step_by(width) {
                let points =
                    (first..first + 4).find(|&k| at < keys[k].0 + keys[k].1).map_or(4, contact_points);
                let index = if serial {
                    singles += 1;
                    singles - 1
                } else {
                    counts[points - 1] += 1;
                    counts[points - 1] - 1
                };
                let points = if serial { 0 } else { points as u8 };
                rows.schedule.push(BatchRef { points, index });
                scratch.ranges.push((at, (width as u32).min(end - at)));
            }
            rows.stages.push(Stage { group, start: stage_start, end: rows.schedule.len() as u32, serial });
        }
    }
    rows.p1.resize(counts[0] as usize, Batch::default());
    rows.p2.resize(counts[1] as usize, Batch::default());
    rows.p3.resize(counts[2] as usize, Batch::default());
    rows.p4.resize(counts[3] as usize, Batch::default());
    rows.single.resize(singles as usize, Batch::default());
}

/// Fills the lanes of a batch; lanes without a contact get rows without mass.
fn fill<L: GatherLanes, const P: usize>(
    batch: &mut Batch<L, P>,
    parts: &[Part],
    group: Group,
    input: &PrepareInput<'_>,
) {
    let used = parts.len();
    let live = L::Mask::from_bits(((1u64 << used) - 1) as u32);
    let part = |lane: usize| parts[lane.min(used - 1)];
    let contact = |lane: usize| &input.contacts[part(lane).slot()];
    let point_of = |lane: usize, i: usize| {
        let (first, count) = part(lane).range(contact(lane));
        (i < count, &contact(lane).points[first + i.min(count - 1)])
    };
    let dynamic = input.bodies.dynamic() as u32;
    let movers = input.bodies.movers() as u32;
    let body_of = |c: u32| input.colliders[c as usize].body;
    (batch.write_a, batch.write_b, batch.swapped) = (0, 0, 0);
    for lane in 0..8 {
        let c = contact(lane.min(L::N - 1));
        // `a` is the body that can be pushed.
        let (mut a, mut b) = (body_of(c.a), body_of(c.b));
        if a >= dynamic {
            batch.swapped |= 1 << lane;
            (a, b) = (b, a);
        }
        // A static body has no record: its velocity is never read in a static group.
        (batch.a[lane], batch.b[lane]) = (a, if b < movers { b } else { a });
        batch.contact[lane] = if lane < used { parts[lane] } else { Part::NONE };
        if lane < used {
            batch.write_a |= u32::from(a < dynamic) << lane;
            batch.write_b |= u32::from(b < dynamic) << lane;
        }
    }
    let swapped = batch.swapped;
    let is_swapped = |lane: usize| swapped >> lane & 1 != 0;
    // Index of the real bodies, static ones included.
    let bodies_of = |lane: usize| {
        let c = contact(lane);
        let (a, b) = (body_of(c.a), body_of(c.b));
        if is_swapped(lane) { (b, a) } else { (a, b) }
    };
    let mass = |body: u32| if body < dynamic { input.bodies.mass[body as usize].inverse } else { 0.0 };
    let inertia = |body: u32| input.inverse_inertia.get(body as usize).copied().unwrap_or_default();
    let motion = |body: u32| input.motion.get(body as usize).map_or(glam::Vec3::ZERO, |m| m.linear);
    let sym = |of: &dyn Fn(usize) -> Sym3<f32>| Sym3 {
        xx: L::from_fn(|i| of(i).xx),
        yy: L::from_fn(|i| of(i).yy),
        zz: L::from_fn(|i| of(i).zz),
        xy: L::from_fn(|i| of(i).xy),
        xz: L::from_fn(|i| of(i).xz),
        yz: L::from_fn(|i| of(i).yz),
    };
    let (ma, mb) = (L::from_fn(|i| mass(bodies_of(i).0)), L::from_fn(|i| mass(bodies_of(i).1)));
    let ia = sym(&|i| inertia(bodies_of(i).0));
    let ib = sym(&|i| inertia(bodies_of(i).1));

    let turn = crate::lanes::Quat::<L>::from_fn(|i| input.poses[contact(i).a as usize].rotation);
    let sign = L::from_fn(|i| if is_swapped(i) { -1.0 } else { 1.0 });
    let n = turn.rotate(Vec3::from_fn(|i| contact(i).normal)) * sign;
    // From the batch's body a to the origin of the contact's shape a, and from body b to body a; at the fraction of
    // the step at which the contact was found.
    let origin = Vec3::<L>::from_fn(|i| {
        let c = contact(i);
        let shape = input.poses[c.a as usize].position;
        let of_a = body_of(c.a) as usize;
        let own = (shape - input.bodies.pose[of_a].position).as_vec3();
        if is_swapped(i) { own + between(c, input, &motion, body_of) } else { own }
    });
    let to_b = Vec3::<L>::from_fn(|i| {
        let c = contact(i);
        let d = between(c, input, &motion, body_of);
        if is_swapped(i) { -d } else { d }
    });

    batch.normal = n;
    (batch.inverse_mass_a, batch.inverse_mass_b) = (ma, mb);
    (batch.inverse_inertia_a, batch.inverse_inertia_b) = (ia, ib);
    let (mut ra, mut rb) = ([Vec3::<L>::zero(); P], [Vec3::<L>::zero(); P]);
    let (mut turned_a, mut turned_b) = ([Vec3::<L>::zero(); P], [Vec3::<L>::zero(); P]);
    let mut present = [L::zero(); P];
    let warm = L::splat(input.warm);
    for i in 0..P {
        let has = L::from_fn(|lane| if lane < used && point_of(lane, i).0 { 1.0 } else { 0.0 });
        present[i] = has;
        let is = has.gt(L::zero());
        let p = turn.rotate(Vec3::from_fn(|lane| point_of(lane, i).1.position));
        ra[i] = p + origin;
        rb[i] = ra[i] + to_b;
        let (arm_a, arm_b) = (ra[i].cross(n), rb[i].cross(n));
        (turned_a[i], turned_b[i]) = (ia.mul(arm_a), ib.mul(arm_b));
        let k = ma + mb + arm_a.dot(turned_a[i]) + arm_b.dot(turned_b[i]);
        let possible = k.gt(L::zero());
        let s = L::from_fn(|lane| point_of(lane, i).1.separation);
        let point = &mut batch.points[i];
        (point.arm_a, point.arm_b) = (arm_a, arm_b);
        point.separation = L::select(is, s, L::splat(f32::INFINITY));
        point.mass = L::select(is & possible, L::one() / k, L::zero());
        let old = L::from_fn(|lane| point_of(lane, i).1.impulse);
        point.impulse = L::select(is & possible, old * warm, L::zero());
        point.stiffness = L::select(is, k, L::zero());
        point.real = L::select(s.le(L::splat(input.real)), has, L::zero());
        for k in 0..i {
            let both = batch.points[k].arm_a.dot(turned_a[i]) + batch.points[k].arm_b.dot(turned_b[i]);
            batch.coupling[couple(k, i)] = L::select(is, ma + mb + both, L::zero());
        }
    }
    if group.is_potential() {
        return;
    }

    let count = present.iter().fold(L::zero(), |s, &x| s + x).max(L::one());
    let mean = |of: &[Vec3<L>; P]| {
        let sum = of.iter().zip(&present).fold(Vec3::zero(), |s, (&r, &x)| s + r * x);
        sum * (L::one() / count)
    };
    let (fa, fb) = (mean(&ra), mean(&rb));
    let radius = ra.iter().zip(&present).fold(L::zero(), |s, (&r, &x)| s + (r - fa).length() * x) / count;
    let (t1, t2) = n.tangents();
    let (a1, a2, b1, b2) = (fa.cross(t1), fa.cross(t2), fb.cross(t1), fb.cross(t2));
    let (ia1, ib1, ia2, ib2) = (ia.mul(a1), ib.mul(b1), ia.mul(a2), ib.mul(b2));
    let k11 = ma + mb + a1.dot(ia1) + b1.dot(ib1);
    let k12 = a1.dot(ia2) + b1.dot(ib2);
    let k22 = ma + mb + a2.dot(ia2) + b2.dot(ib2);
    let det = k11 * k22 - k12 * k12;
    let possible = live & det.gt(L::zero());
    let over = L::select(possible, L::one() / det, L::zero());
    let kt = n.dot(ia.mul(n)) + n.dot(ib.mul(n));
    let f = &mut batch.friction;
    f.tangent = t1;
    (f.arm_a, f.arm_b) = (fa, fb);
    f.mass = [k22 * over, -(k12 * over), k11 * over];
    f.twist_mass = L::select(live & kt.gt(L::zero()), L::one() / kt, L::zero());
    f.radius = radius;
    // Friction was stored in the frame of the contact's shape a; its points share it by their load.
    let share = L::from_fn(|i| {
        let (c, total) = (contact(i), contact(i).points().iter().map(|p| p.impulse).sum::<f32>());
        part(i).only().map_or(1.0, |p| if total > 0.0 { c.points[p].impulse / total } else { 0.0 })
    });
    let old = turn.rotate(Vec3::from_fn(|i| contact(i).friction)) * sign * warm * share;
    f.impulse = [old.dot(t1), old.dot(t2)].map(|x| L::select(possible, x, L::zero()));
    f.twist = L::select(live, L::from_fn(|i| contact(i).twist) * warm, L::zero());

    let material = |lane: usize| {
        let c = contact(lane);
        input.colliders[c.a as usize].material.friction_with(&input.colliders[c.b as usize].material)
    };
    let pair: [(f32, f32); 8] = std::array::from_fn(|lane| material(lane.min(L::N - 1)));
    let (sticking, sliding) = (L::from_fn(|i| pair[i].0), L::from_fn(|i| pair[i].1));
    // SAFETY of indices: a static body's lane reads body a, and its velocity is then not used.
    let velocity = &input.bodies.velocity;
    let ((va, wa), (vb, wb)) = (gather::<L>(velocity, &batch.a), gather::<L>(velocity, &batch.b));
    let at_b = if group.is_static() { Vec3::zero() } else { vb + wb.cross(fb) };
    let slip = at_b - (va + wa.cross(fa));
    let slip = slip - n * slip.dot(n);
    let stick = slip.length_squared().lt(L::splat(input.stick * input.stick));
    f.coefficient = L::select(stick, sticking, sliding);
}

/// From body `b` of a contact to its body `a`, at the fraction of the step at which the contact was found.
fn between(
    c: &Contact,
    input: &PrepareInput<'_>,
    motion: &dyn Fn(u32) -> glam::Vec3,
    body_of: impl Fn(u32) -> u32,
) -> glam::Vec3 {
    let (a, b) = (body_of(c.a), body_of(c.b));
    let apart = (input.bodies.pose[a as usize].position - input.bodies.pose[b as usize].position).as_vec3();
    apart + (motion(a) - motion(b)) * c.fraction
}
