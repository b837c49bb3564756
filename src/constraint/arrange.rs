//! Which contacts get rows, in which order: by importance, colour and size.

use super::batch::BatchRef;
use super::colour::{Colouring, OVERFLOW};
use super::crowd::Crowd;
use super::keys::{KINDS, Keys};
use super::order::{Group, Stage};
use super::prepare::PrepareInput;
use super::rows::{Rows, Tally};
use super::seats::{Seat, Seated};
use crate::config::Order;
use crate::lanes::ones;
use crate::memory::{Amounts, Buffer, Category, Room, Rooms, bytes_of};
use crate::narrow_phase::{Contact, NONE, Threshold, Weight};

/// What preparing counted.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct Prepared {
    pub(crate) manifolds: u32,
    /// Points that touch, and that may touch within the step.
    pub(crate) real: u32,
    pub(crate) potential: u32,
    /// Points that bounced.
    pub(crate) impacts: u32,
    /// Points that there was no room for.
    pub(crate) shed: u32,
}

/// A contact, or some of its points, in a lane of a batch.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) struct Part(pub(crate) u32);

impl Part {
    const SLOT: u32 = (1 << 27) - 1;
    /// Its other points have parts of their own.
    const APART: u32 = 1 << 27;
    /// The first of four bits, one for each point; none of them if the part has all.
    const POINTS: u32 = 28;
    /// An inert lane.
    pub(crate) const NONE: Part = Part(u32::MAX);

    /// Of points by bits, or of all.
    fn of(slot: u32, points: u32) -> Part {
        Part(slot | points << Self::POINTS)
    }
    fn point(slot: u32, point: usize) -> Part {
        Part(slot | Self::APART | 1 << (Self::POINTS + point as u32))
    }
    pub(crate) fn slot(self) -> usize {
        (self.0 & Self::SLOT) as usize
    }
    /// The point, if the others are not in this part but in others.
    pub(crate) fn only(self) -> Option<usize> {
        (self.0 & Self::APART != 0).then(|| (self.0 >> Self::POINTS).trailing_zeros() as usize)
    }
    /// Whether it is a contact of which some points have no rows.
    pub(crate) fn is_cut(self) -> bool {
        self.0 & Self::APART == 0 && self.0 >> Self::POINTS != 0
    }
    /// Its points, a bit each.
    pub(crate) fn points(self, contact: &Contact) -> u32 {
        let own = self.0 >> Self::POINTS;
        if own == 0 { (1 << contact.count) - 1 } else { own }
    }
}

/// Buffers of one step.
#[derive(Debug, Default)]
pub(crate) struct PrepareScratch {
    colouring: [Colouring; 4],
    keys: Keys,
    pub(crate) crowd: Crowd,
    /// Contact and sort key.
    entries: Vec<(Part, u32)>,
    pub(crate) sorted: Vec<Part>,
    /// First contact in `sorted` of each batch of the schedule, and how many.
    pub(crate) ranges: Vec<(u32, u32)>,
    /// Bytes of contacts and rows that continuous collision alone makes: in the last step, and the most in any.
    ahead: (usize, usize),
    most_ahead: (usize, usize),
}

impl PrepareScratch {
    /// Calls `f` with each buffer and the place that it needs for so many bodies that can be pushed, of which
    /// some may be raised.
    pub(crate) fn each(
        &mut self,
        dynamic: usize,
        any_raised: bool,
        f: &mut dyn FnMut(&mut dyn Buffer, usize),
    ) {
        self.keys.each(any_raised, f);
        self.colouring.iter_mut().for_each(|c| f(c.buffer(), dynamic));
        f(self.crowd.buffer(), dynamic);
    }

    /// Nothing is continuous any more.
    pub(crate) fn forget_ahead(&mut self) {
        (self.ahead, self.most_ahead) = ((0, 0), (0, 0));
    }

    /// Nothing is raised any more.
    pub(crate) fn lower(&mut self) {
        self.keys = Keys::default();
    }

    /// Reserved bytes of the order of what is raised.
    pub(crate) fn raised_bytes(&self) -> usize {
        self.keys.raised_bytes()
    }

    /// Bytes that a part takes in its lists, and what these have.
    pub(crate) fn lists(&self) -> (usize, usize) {
        let reserved = bytes_of(&self.entries).1 + bytes_of(&self.sorted).1 + bytes_of(&self.ranges).1;
        (size_of::<(Part, u32)>() + size_of::<Part>() + size_of::<(u32, u32)>(), reserved)
    }

    /// Bytes that its lists lack for so many parts.
    pub(crate) fn missing(&self, parts: usize) -> usize {
        self.entries.missing(parts) + self.sorted.missing(parts) + self.ranges.missing(parts)
    }

    /// How many stages there may be.
    pub(crate) fn most_stages(&mut self, input: Order) -> usize {
        self.keys.reset(input, std::iter::empty());
        self.keys.most_stages()
    }

    /// Bytes of contacts, and of rows, that continuous collision alone makes: live, and the most there ever were.
    pub(crate) fn ahead_bytes(&self) -> ((usize, usize), (usize, usize)) {
        ((self.ahead.0, self.most_ahead.0), (self.ahead.1, self.most_ahead.1))
    }

    pub(crate) fn bytes(&self) -> (usize, usize) {
        let lists =
            [bytes_of(&self.entries), bytes_of(&self.sorted), bytes_of(&self.ranges), self.keys.bytes()];
        let bodies = self.colouring.iter().map(Colouring::bytes).chain([self.crowd.bytes()]);
        lists.into_iter().chain(bodies).fold((0, 0), |s, b| (s.0 + b.0, s.1 + b.1))
    }
}

/// Overlap of two bodies from which on it counts for [`Crowd`] [slops]: what rests or was just hit has less.
const DEEP: f32 = 20.0;

/// What rows do without where there is no room for all, from what is missed least on. All of one comes before any of the next.
#[derive(Clone, Copy, Debug)]
struct Thrift {
    /// How many parts there is place for in the lists of the step.
    place: usize,
    /// Batches that are mostly empty are single rows: slower, and otherwise the same.
    thin: bool,
    /// Of contacts that nothing approaches, those that keep their rows.
    idle: Threshold,
    /// Of others, those that keep points that they don't need, and those that keep any.
    spare: Threshold,
    any: Threshold,
}

impl Thrift {
    const NONE: Thrift = Thrift {
        place: usize::MAX,
        thin: false,
        idle: Threshold::ALL,
        spare: Threshold::ALL,
        any: Threshold::ALL,
    };

    /// After so many of [`Thrift::steps`], with so many contacts of each weight.
    fn after(step: u32, counts: &[u32; Weight::COUNT], place: usize) -> Thrift {
        let (idle, needed) = Self::classes(counts);
        let mut left = step.saturating_sub(1);
        let mut next = |from: Weight, all: u32| {
            let gone = left.min(all);
            left -= gone;
            Threshold::without(counts, from, gone)
        };
        Thrift {
            place,
            thin: step > 0,
            idle: next(Weight::default(), idle),
            spare: next(Weight::NEEDED, needed),
            any: next(Weight::NEEDED, needed),
        }
    }

    /// How many steps there are until nothing is left.
    fn steps(counts: &[u32; Weight::COUNT]) -> u32 {
        let (idle, needed) = Self::classes(counts);
        1 + idle + 2 * needed
    }

    fn classes(counts: &[u32; Weight::COUNT]) -> (u32, u32) {
        let (idle, needed) = counts.split_at(Weight::NEEDED.index());
        (idle.iter().sum(), needed.iter().sum())
    }

    /// The points of a contact that keep their rows, a bit each. Asked of each in the same order.
    fn points(&mut self, contact: &Contact, weight: Weight) -> u32 {
        let all = (1 << contact.count) - 1;
        if !weight.is_needed() {
            return if self.idle.keeps(weight) { all } else { 0 };
        }
        match [&mut self.any, &mut self.spare].map(|floor| floor.keeps(weight)) {
            [false, _] => 0,
            [_, false] => contact.needed(),
            _ => all,
        }
    }
}

/// Sorts the contacts and makes place for their batches. Where there is no room for all, what is missed least does without.
pub(crate) fn arrange(
    input: &PrepareInput<'_>,
    rows: &mut Rows,
    scratch: &mut PrepareScratch,
    rooms: &mut Rooms,
) -> Prepared {
    if rooms.is_endless() {
        let (prepared, ..) = sort(input, scratch, None, Ahead::ANY);
        let batches = schedule(input, rows, scratch, false);
        rooms.within(Category::Rows, |room| rows.resize(&batches, room));
        return prepared;
    }
    // How many stages there may be.
    scratch.keys.reset(input.order, input.bodies.raises());
    let ahead = Ahead::new(input);
    let total = count(input, ahead);
    let place = scratch.make_place(total as usize, !input.seats.is_empty(), rows, rooms);
    let (mut prepared, lost, fits) = sort(input, scratch, Some(Thrift { place, ..Thrift::NONE }), ahead);
    let batches = schedule(input, rows, scratch, false);
    if fits && rooms.within(Category::Rows, |room| rows.make_place(&batches, room)) {
        rooms.within(Category::Rows, |room| rows.resize(&batches, room));
        prepared.shed = lost;
        return prepared;
    }
    let mut counts = [0; Weight::COUNT];
    each_contact(input, |_, contact| counts[input.scale.of(contact).index()] += 1);
    // The least number of steps after which the rest fits, to within a 64th of the contacts.
    let (mut too_few, mut enough) = (0, Thrift::steps(&counts));
    let near = 1 + total / 64;
    loop {
        let last = enough - too_few <= near;
        let step = if last { enough } else { too_few.midpoint(enough) };
        let thrift = Thrift::after(step, &counts, place);
        let (mut prepared, lost, fits) = sort(input, scratch, Some(thrift), ahead);
        let batches = schedule(input, rows, scratch, true);
        let fits = fits && rooms.within(Category::Rows, |room| rows.make_place(&batches, room));
        if last {
            rooms.within(Category::Rows, |room| rows.resize(&batches, room));
            prepared.shed = lost;
            return prepared;
        }
        *if fits { &mut enough } else { &mut too_few } = step;
    }
}

/// Bytes that are granted to contacts that only continuous collision makes: of bodies among themselves, and with what is
/// static.
#[derive(Clone, Copy, Debug)]
struct Ahead {
    left: [usize; 2],
    /// Bytes of the contact and a lane of a batch: with what may move and what is static, by the number of points.
    cost: [[usize; 4]; 2],
}

impl Ahead {
    /// Without a limit.
    const ANY: Ahead = Ahead { left: [usize::MAX; 2], cost: [[0; 4]; 2] };

    /// As much as is left, first for contacts with what is static.
    fn new(input: &PrepareInput<'_>) -> Ahead {
        if input.ahead == usize::MAX {
            return Ahead::ANY;
        }
        let whole = Ahead {
            left: [input.ahead, 0],
            cost: ahead_lanes(input).map(|side| side.map(|lane| lane.div_ceil(8) + size_of::<Contact>())),
        };
        let mut of_static = 0;
        each_contact(input, |_, contact| {
            let group = group_of(input, contact);
            if is_ahead(input, contact) && group.is_static() {
                of_static += whole.cost(contact, group);
            }
        });
        let of_static = of_static.min(input.ahead);
        Ahead { left: [input.ahead - of_static, of_static], ..whole }
    }

    fn cost(&self, contact: &Contact, group: Group) -> usize {
        self.cost[usize::from(group.is_static())][contact.count as usize - 1]
    }

    /// Whether there is enough left for a contact of a group; takes it off if so.
    fn admits(&mut self, contact: &Contact, group: Group) -> bool {
        let cost = self.cost(contact, group);
        let left = &mut self.left[usize::from(group.is_static())];
        let rest = left.checked_sub(cost);
        *left = rest.unwrap_or(*left);
        rest.is_some()
    }
}

/// Whether discrete physics would not look for any point of it.
fn is_ahead(input: &PrepareInput<'_>, contact: &Contact) -> bool {
    contact.points().iter().all(|p| p.separation > input.near)
}

/// How many parts there are, but for contacts beyond the limit of continuous collision.
fn count(input: &PrepareInput<'_>, mut ahead: Ahead) -> u32 {
    let mut parts = 0;
    each_contact(input, |_, contact| {
        if !is_ahead(input, contact) || ahead.admits(contact, group_of(input, contact)) {
            parts += if input.per_point { u32::from(contact.count) } else { 1 };
        }
    });
    parts
}

fn each_contact<'a>(input: &PrepareInput<'a>, mut f: impl FnMut(u32, &'a Contact)) {
    let dynamic = input.bodies.dynamic();
    for pair in input.pairs {
        let mut slot = if pair.is_idle(input.hot, dynamic) { NONE } else { pair.contact };
        while slot != NONE {
            let contact = &input.contacts[slot as usize];
            if contact.count > 0 {
                f(slot, contact);
            }
            slot = contact.next;
        }
    }
}

fn group_of(input: &PrepareInput<'_>, contact: &Contact) -> Group {
    let movers = input.bodies.movers();
    let still = |c: u32| input.hot[c as usize].body as usize >= movers;
    let potential = contact.points().iter().all(|p| p.separation > input.real);
    Group::of(still(contact.a) || still(contact.b), potential)
}

impl PrepareScratch {
    /// Makes place for so many parts, as far as there is room; says for how many.
    fn make_place(&mut self, parts: usize, seated: bool, rows: &mut Rows, rooms: &mut Rooms) -> usize {
        let most_stages = self.keys.most_stages();
        if rooms.within(Category::Rows, |room| room.fit(&mut rows.stages, most_stages)) < most_stages {
            return 0;
        }
        let missing = |scratch: &Self, rows: &Rows, parts: usize| {
            let seats = rows.seated.missing(if seated { parts } else { 0 });
            let mut missing = Amounts::default();
            missing.add(Category::Scratch, scratch.missing(parts));
            missing.add(Category::Rows, rows.schedule.missing(parts) + seats);
            missing
        };
        let (mut place, mut too_many) = (0, parts + 1);
        while too_many - place > 1 {
            let middle = usize::midpoint(place, too_many);
            *if rooms.fits(&missing(self, rows, middle)) { &mut place } else { &mut too_many } = middle;
        }
        if !rooms.fits(&missing(self, rows, place)) {
            return 0;
        }
        rooms.take(&missing(self, rows, place));
        self.entries.widen(place);
        self.sorted.widen(place);
        self.ranges.widen(place);
        rows.schedule.widen(place);
        rows.seated.widen(if seated { place } else { 0 });
        place
    }
}

/// Contacts by group, colour and number of points, and what they count. Says how many points are left out, and whether there was
/// place for all others.
fn sort(
    input: &PrepareInput<'_>,
    scratch: &mut PrepareScratch,
    mut thrift: Option<Thrift>,
    mut granted: Ahead,
) -> (Prepared, u32, bool) {
    let PrepareScratch { colouring, keys, crowd, entries, sorted, .. } = scratch;
    let dynamic = input.bodies.dynamic();
    crowd.clear();
    colouring.iter_mut().for_each(|c| c.reset(dynamic));
    entries.clear();
    keys.reset(input.order, input.bodies.raises());
    let (movers, any_raised) = (input.bodies.movers(), keys.any_raised());
    let (mut prepared, mut shed, mut fits) = (Prepared::default(), 0, true);
    let place = thrift.map_or(usize::MAX, |thrift| thrift.place);
    // Under a budget there is place for all.
    let mut room = Room::ENDLESS;
    // With what may move and what is static, by number of points.
    let mut ahead = [[0usize; 4]; 2];
    each_contact(input, |slot, contact| {
        let body = |c: u32| input.hot[c as usize].body as usize;
        let (a, b) = (body(contact.a), body(contact.b));
        let touching = contact.points().iter().map(|p| u32::from(p.separation <= input.real)).sum::<u32>();
        if contact.points().iter().any(|p| p.separation < -DEEP * input.slop) {
            crowd.overlap((a, b), dynamic);
        }
        let group = Group::of(a >= movers || b >= movers, touching == 0);
        prepared.manifolds += 1;
        prepared.real += touching;
        prepared.potential += u32::from(contact.count) - touching;
        if is_ahead(input, contact) {
            if !granted.admits(contact, group) {
                shed += u32::from(contact.count);
                return;
            }
            ahead[usize::from(group.is_static())][contact.count as usize - 1] += 1;
        }
        let raised = if any_raised {
            let raised = |body: usize| input.bodies.traits[body].raised;
            input.order.higher(raised(a), raised(b))
        } else {
            None
        };
        let all = (1 << contact.count) - 1;
        let kept = match &mut thrift {
            Some(thrift) if thrift.thin => thrift.points(contact, input.scale.of(contact)),
            _ => all,
        };
        shed += (all & !kept).count_ones();
        let mut enter = |part: Part, count: usize| {
            if entries.len() == place {
                fits = false;
                return;
            }
            let colour = colouring[group as usize].assign(a, b);
            let seated = group.is_static() && colour != OVERFLOW && input.seats.of(a.min(b)).is_some();
            let key = keys.count((group, raised), colour, (!seated).then_some(count));
            room.push(entries, (part, key));
        };
        if input.per_point {
            ones(kept).for_each(|point| enter(Part::point(slot, point), 1));
        } else if kept > 0 {
            enter(Part::of(slot, if kept == all { 0 } else { kept }), kept.count_ones() as usize);
        }
    });
    if !crowd.is_empty() {
        each_contact(input, |_, contact| {
            let body = |c: u32| input.hot[c as usize].body as usize;
            crowd.touch((body(contact.a), body(contact.b)), &input.bodies.velocity, movers);
        });
    }
    keys.line_up();
    room.fit(sorted, entries.len());
    sorted.clear();
    sorted.resize(entries.len(), Part::NONE);
    for &(part, key) in entries.iter() {
        sorted[keys.place_of(key)] = part;
    }
    if !input.seats.is_empty() {
        for (layer, colour) in keys.colours() {
            let ends = keys.ends(layer, colour);
            let seated = ends[KINDS - 2] as usize..ends[KINDS - 1] as usize;
            sorted[seated].sort_unstable_by_key(|part| seat_of(input, *part));
        }
    }
    // A lane of a batch each.
    let (ahead, batches) = (ahead.as_flattened(), ahead_lanes(input));
    let rows: usize = ahead.iter().zip(batches.as_flattened()).map(|(n, batch)| n * batch / 8).sum();
    scratch.ahead = (ahead.iter().sum::<usize>() * size_of::<Contact>(), rows);
    // The most of both together, which the limit of continuous collision bounds.
    let (now, most) = (scratch.ahead, &mut scratch.most_ahead);
    if now.0 + now.1 > most.0 + most.1 {
        *most = now;
    }
    (prepared, shed, fits)
}

/// Bytes of batches of contacts that may touch, with their friction: with what may move and what is static, by the number of
/// points.
fn ahead_lanes(input: &PrepareInput<'_>) -> [[usize; 4]; 2] {
    Rows::SIZES.map(|side| std::array::from_fn(|i| side[i] + if input.friction { side[7] } else { 0 }))
}

/// The seat of the body of a contact with what is static.
fn seat_of(input: &PrepareInput<'_>, part: Part) -> Option<Seat> {
    let contact = &input.contacts[part.slot()];
    let body = |c: u32| input.hot[c as usize].body as usize;
    input.seats.of(body(contact.a).min(body(contact.b)))
}

/// Batches of each stage. Says how many there are of each kind. `thin`: what would fill less of a batch than single rows take goes
/// into such.
fn schedule(input: &PrepareInput<'_>, rows: &mut Rows, scratch: &mut PrepareScratch, thin: bool) -> Tally {
    let PrepareScratch { keys, sorted, ranges, .. } = scratch;
    let mut tally = Tally::default();
    let mut batch = |points: usize, group: Group| {
        let mut next = |kind: usize| {
            let count = &mut tally[usize::from(group.is_static())][kind];
            *count += 1;
            *count as u32 - 1
        };
        // Without points: of one lane.
        let single = points == 0;
        let index = next(if single { 4 } else { points - 1 });
        let kind = 5 + 2 * usize::from(group.is_potential()) + usize::from(single);
        let friction = if input.friction { next(kind) } else { 0 };
        BatchRef { points: points as u8, seated: false, index, friction }
    };
    rows.schedule.clear();
    rows.stages.clear();
    rows.seated.clear();
    ranges.clear();
    let mut start = 0;
    for (layer, colour) in keys.colours() {
        let ends = keys.ends(layer, colour);
        let (unseated, end) = (ends[KINDS - 2], ends[KINDS - 1]);
        if start == end {
            continue;
        }
        let stage_start = rows.schedule.len() as u32;
        let serial = colour == OVERFLOW;
        let potential = layer.group.is_potential();
        let width = if serial { 1 } else { 8 };
        for at in (start..unseated).step_by(width) {
            // Of its first part, which has most.
            let points = 4 - ends[..4].iter().filter(|&&end| at >= end).count();
            let count = (width as u32).min(unseated - at);
            if thin && !serial && (count as usize) < Rows::worth(points, layer.group, input.friction) {
                for at in at..at + count {
                    rows.schedule.push(batch(0, layer.group));
                    ranges.push((at, 1));
                }
                continue;
            }
            rows.schedule.push(batch(if serial { 0 } else { points }, layer.group));
            ranges.push((at, count));
        }
        let mut at = unseated as usize;
        let seated = &sorted[at..end as usize];
        let place = |part: &Part| seat_of(input, *part).map(Seat::place);
        for batch_of in seated.chunk_by(|a, b| place(a) == place(b)) {
            let most = batch_of
                .iter()
                .map(|part| part.points(&input.contacts[part.slot()]).count_ones())
                .max()
                .unwrap_or(1);
            let Some((tree, node)) = place(&batch_of[0]) else { continue };
            let points = if tree.is_single() { 0 } else { most as usize };
            let contact = BatchRef { seated: true, ..batch(points, layer.group) };
            rows.schedule.push(contact);
            rows.seated.push(Seated { tree, node, potential, batch: contact });
            ranges.push((at as u32, batch_of.len() as u32));
            at += batch_of.len();
        }
        rows.stages.push(Stage {
            group: layer.group,
            place: layer.place,
            start: stage_start,
            end: rows.schedule.len() as u32,
            serial,
        });
        start = end;
    }
    rows.seated.sort_by_key(|seated| (seated.tree, seated.node));
    tally
}
