//! Decides which contacts get rows, and in which order: by importance, colour and size.

use super::budget::Ahead;
use super::colour::{Colouring, OVERFLOW};
use super::facts::{Fact, Facts, each_contact};
use super::keys::{KINDS, Keys};
use super::order::{Group, Stage};
use super::part::Part;
use crate::config::{FrictionModel, Order};
use crate::constraint::articulation::slots::{TreeContacts, TreeSlot};
use crate::constraint::contact::batch::BatchRef;
use crate::constraint::contact::crowd::Crowd;
use crate::constraint::contact::expect::row_cost;
use crate::constraint::contact::input::PrepareInput;
use crate::constraint::contact::rows::{Rows, Tally};
use crate::lanes::ones;
use crate::memory::{Allowance, Allowances, Amounts, Buffer, Category, bytes_of, sum_bytes};
use crate::narrow_phase::{Census, ContactCount, Cut, MAX_POINTS, RowKind};
use crate::threads::Workers;

/// Counts of the preparation.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct Prepared {
    pub(crate) manifolds: u32,
    /// Points that touch, and points that may touch within the step.
    pub(crate) real: u32,
    pub(crate) potential: u32,
    /// Points that bounced.
    pub(crate) impacts: u32,
    /// Points for which there was no room.
    pub(crate) shed: u32,
}

/// Buffers of one step.
#[derive(Debug, Default)]
pub(crate) struct PrepareScratch {
    colouring: [Colouring; 4],
    keys: Keys,
    pub(crate) crowd: Crowd,
    facts: Facts,
    /// Contact and sort key.
    entries: Vec<(Part, u32)>,
    pub(crate) sorted: Vec<Part>,
    /// First contact in `sorted` of each batch of the schedule, and how many.
    pub(crate) ranges: Vec<(u32, u32)>,
    /// Bytes of contacts and rows that only continuous collision makes: in the last step, and the maximum in
    /// any.
    ahead: (usize, usize),
    most_ahead: (usize, usize),
}

// Not by `buffers!`: there are four colourings.
impl PrepareScratch {
    /// Calls `f` with each buffer and the capacity that it needs for so many dynamic bodies, of which some
    /// may have rows that are solved after another group.
    pub(crate) fn each(
        &mut self,
        dynamic: usize,
        any_solved_after: bool,
        f: &mut dyn FnMut(&mut dyn Buffer, usize),
    ) {
        self.keys.each(any_solved_after, f);
        self.colouring.iter_mut().for_each(|c| c.each(dynamic, f));
        self.crowd.each(dynamic, f);
    }

    #[cfg(debug_assertions)]
    pub(crate) fn spoil(&mut self) {
        use crate::memory::spoil;
        spoil(&mut self.entries);
        spoil(&mut self.sorted);
        spoil(&mut self.ranges);
        self.facts.spoil();
    }

    /// There is no continuous collision any more.
    pub(crate) fn forget_ahead(&mut self) {
        (self.ahead, self.most_ahead) = ((0, 0), (0, 0));
    }

    /// Releases the memory for bodies whose rows are solved after another group.
    pub(crate) fn lower(&mut self) {
        self.keys = Keys::default();
    }

    /// Reserved bytes for bodies whose rows are solved after another group.
    pub(crate) fn solved_after_bytes(&self) -> usize {
        self.keys.solved_after_bytes()
    }

    /// Bytes that a part takes in the lists, and those that these have reserved.
    pub(crate) fn lists(&self) -> (usize, usize) {
        let reserved = bytes_of(&self.entries).1 + bytes_of(&self.sorted).1 + bytes_of(&self.ranges).1;
        (size_of::<(Part, u32)>() + size_of::<Part>() + size_of::<(u32, u32)>(), reserved)
    }

    /// Bytes that are missing in the lists for so many parts.
    pub(crate) fn missing(&self, parts: usize) -> usize {
        self.entries.missing(parts) + self.sorted.missing(parts) + self.ranges.missing(parts)
    }

    /// Maximum number of stages.
    pub(crate) fn most_stages(&mut self, input: Order) -> usize {
        self.keys.reset(input, std::iter::empty());
        self.keys.most_stages()
    }

    /// Bytes of contacts, and of rows, that only continuous collision makes: live, and the maximum so far.
    pub(crate) fn ahead_bytes(&self) -> ((usize, usize), (usize, usize)) {
        ((self.ahead.0, self.most_ahead.0), (self.ahead.1, self.most_ahead.1))
    }

    pub(crate) fn bytes(&self) -> (usize, usize) {
        let lists =
            [bytes_of(&self.entries), bytes_of(&self.sorted), bytes_of(&self.ranges), self.keys.bytes()];
        let bodies =
            self.colouring.iter().map(Colouring::bytes).chain([self.crowd.bytes(), self.facts.bytes()]);
        sum_bytes(lists.into_iter().chain(bodies))
    }
}

/// Sorts the contacts and reserves memory for their batches. Where it does not suffice for all, those that
/// are missed least get no rows.
pub(crate) fn arrange(
    workers: &Workers<'_>,
    input: &PrepareInput<'_>,
    rows: &mut Rows,
    scratch: &mut PrepareScratch,
    allowances: &mut Allowances,
) -> Prepared {
    let (prepared, batches) = if allowances.is_endless() {
        let prepared = colour_all(workers, input, scratch);
        (prepared, schedule(input, rows, scratch, false))
    } else {
        arrange_within(input, rows, scratch, allowances)
    };
    allowances.within(Category::Rows, |allowance| rows.resize(&batches, allowance));
    prepared
}

/// The same under a budget: if there is too little memory, batches that are mostly empty become single rows;
/// and if that is not enough, contacts are cut by rank until the rest fits.
fn arrange_within(
    input: &PrepareInput<'_>,
    rows: &mut Rows,
    scratch: &mut PrepareScratch,
    allowances: &mut Allowances,
) -> (Prepared, Tally) {
    // Maximum number of stages.
    scratch.keys.reset(input.order, input.bodies.solved_after_groups());
    let (ahead, beside) = (Ahead::new(input), input.beside);
    let mut parts = 0;
    each_contact(input, |_, contact| parts += if input.per_point { contact.count.into() } else { 1 });
    let place = scratch.reserve(parts, !input.tree_slots.is_empty(), rows, allowances);
    let (mut cut, mut thin, mut census, mut limit) = (None, false, None, 0);
    loop {
        let (prepared, fits) = colour_within(input, scratch, place, ahead, cut);
        let batches = schedule(input, rows, scratch, thin);
        let reserve = |allowance: &mut Allowance| rows.reserve(&batches, beside, allowance);
        if fits && allowances.within(Category::Rows, reserve) {
            return (prepared, batches);
        }
        if !std::mem::replace(&mut thin, true) {
            continue;
        }
        let census = census.get_or_insert_with(|| {
            let census = weigh(input);
            limit = census.rows();
            census
        });
        // As much less as there is too little memory; a little at least, because full batches are assumed.
        let left = rows.held().saturating_add(allowances.left(Category::Rows));
        let part = left as f64 / rows.size(&batches, beside).max(1) as f64;
        limit = (limit as f64 * part.min(1.0 - 1.0 / 32.0)) as usize;
        cut = Some(census.cut(&|all, bytes| {
            bytes <= limit && place >= if input.per_point { all.points } else { all.contacts }
        }));
    }
}

/// All contacts by weight.
fn weigh(input: &PrepareInput<'_>) -> Census {
    let model = if input.per_point { FrictionModel::Point } else { FrictionModel::default() };
    let cost = row_cost(input.friction, model, input.beside);
    let mut census = Census::new();
    each_contact(input, |slot, contact| {
        let is_static = Fact::of(input, slot, contact).group().is_static();
        let kind = RowKind::of(contact, contact.count.into(), is_static, input.measures.touch);
        census.add(Some(input.scale.of(contact)), kind, &cost);
    });
    census
}

impl PrepareScratch {
    /// Reserves memory for so many parts, as far as it suffices; returns for how many.
    fn reserve(
        &mut self,
        parts: usize,
        any_in_tree: bool,
        rows: &mut Rows,
        allowances: &mut Allowances,
    ) -> usize {
        let most_stages = self.keys.most_stages();
        if allowances.within(Category::Rows, |allowance| allowance.fit(&mut rows.stages, most_stages))
            < most_stages
        {
            return 0;
        }
        let missing = |parts: usize| {
            let contacts = rows.tree_contacts.missing(if any_in_tree { parts } else { 0 });
            let mut missing = Amounts::default();
            missing.add(Category::Scratch, self.missing(parts));
            missing.add(Category::Rows, rows.schedule.missing(parts) + contacts);
            missing
        };
        let place = allowances.most(0, parts, &missing);
        let missing = missing(place);
        allowances.take(&missing);
        self.entries.reserve_total(place);
        self.sorted.reserve_total(place);
        self.ranges.reserve_total(place);
        rows.schedule.reserve_total(place);
        rows.tree_contacts.reserve_total(if any_in_tree { place } else { 0 });
        place
    }

    /// Puts the entries in the order in which they are solved, and those of trees by their nodes.
    fn line_up(&mut self, input: &PrepareInput<'_>, allowance: &mut Allowance) {
        let PrepareScratch { keys, entries, sorted, .. } = self;
        keys.line_up();
        allowance.fit(sorted, entries.len());
        sorted.clear();
        sorted.resize(entries.len(), Part::NONE);
        for &(part, key) in entries.iter() {
            sorted[keys.place_of(key)] = part;
        }
        if !input.tree_slots.is_empty() {
            for (layer, colour) in keys.colours() {
                let ends = keys.ends(layer, colour);
                let in_tree = ends[KINDS - 2] as usize..ends[KINDS - 1] as usize;
                sorted[in_tree].sort_unstable_by_key(|part| tree_slot_of(input, *part));
            }
        }
    }

    /// Records the bytes of contacts that only continuous collision makes, and of their rows, a lane of a
    /// batch each. `ahead`: number of these with bodies that may move and with static ones, by number of
    /// points.
    fn note_ahead(&mut self, input: &PrepareInput<'_>, ahead: &[[usize; 4]; 2]) {
        let (ahead, batches) = (ahead.as_flattened(), ahead_lanes(input));
        let rows: usize = ahead.iter().zip(batches.as_flattened()).map(|(n, batch)| n * batch / 8).sum();
        let contacts = ahead
            .iter()
            .enumerate()
            .map(|(i, n)| n * ContactCount { contacts: 1, points: i % MAX_POINTS + 1 }.bytes());
        self.ahead = (contacts.sum(), rows);
        // The maximum of both together, which the limit of continuous collision bounds.
        let (now, most) = (self.ahead, &mut self.most_ahead);
        if now.0 + now.1 > most.0 + most.1 {
            *most = now;
        }
    }
}

/// Sorts all contacts by group, colour and number of points, and counts them.
fn colour_all(workers: &Workers<'_>, input: &PrepareInput<'_>, scratch: &mut PrepareScratch) -> Prepared {
    let mut facts = std::mem::take(&mut scratch.facts);
    let mut sorter = Sorter::new(input, scratch);
    facts.each(workers, input, |fact| sorter.add(&fact, (1 << fact.count) - 1));
    let prepared = sorter.finish(false);
    scratch.facts = facts;
    prepared
}

/// The same for contacts and points that a cut leaves, as far as there is place in lists, which is reserved.
/// Returns whether there was place for all that the cut leaves.
fn colour_within(
    input: &PrepareInput<'_>,
    scratch: &mut PrepareScratch,
    place: usize,
    mut granted: Ahead,
    mut cut: Option<Cut>,
) -> (Prepared, bool) {
    let mut fits = true;
    let mut sorter = Sorter::new(input, scratch);
    each_contact(input, |slot, contact| {
        let fact = Fact::of(input, slot, contact);
        let all = (1 << fact.count) - 1;
        let left = cut.as_mut().map_or(all, |cut| cut.points(contact, input.scale.of(contact)));
        let mut kept = if granted.admits(&fact) { left } else { 0 };
        let parts = if input.per_point { kept.count_ones() as usize } else { 1 };
        if kept > 0 && sorter.scratch.entries.len() + parts > place {
            (fits, kept) = (false, 0);
        }
        sorter.add(&fact, kept);
    });
    (sorter.finish(true), fits)
}

/// Gives contacts their colours and keys.
struct Sorter<'a> {
    input: &'a PrepareInput<'a>,
    scratch: &'a mut PrepareScratch,
    dynamic: usize,
    any_solved_after: bool,
    prepared: Prepared,
    /// Contacts that only continuous collision makes, with bodies that may move and with static ones, by
    /// number of points.
    ahead: [[usize; 4]; 2],
}

impl<'a> Sorter<'a> {
    fn new(input: &'a PrepareInput<'a>, scratch: &'a mut PrepareScratch) -> Sorter<'a> {
        let dynamic = input.bodies.dynamic();
        scratch.crowd.clear();
        scratch.colouring.iter_mut().for_each(|c| c.reset(dynamic));
        scratch.entries.clear();
        scratch.keys.reset(input.order, input.bodies.solved_after_groups());
        let any_solved_after = scratch.keys.any_solved_after();
        let (prepared, ahead) = (Prepared::default(), [[0; 4]; 2]);
        Sorter { input, scratch, dynamic, any_solved_after, prepared, ahead }
    }

    /// Adds the points of a contact that get rows, a bit each.
    #[inline(always)]
    fn add(&mut self, fact: &Fact, kept: u32) {
        let Sorter {
            input, scratch: PrepareScratch { colouring, keys, crowd, entries, .. }, prepared, ..
        } = self;
        let (group, a, b) = (fact.group(), fact.a as usize, fact.b as usize);
        if fact.is_deep() {
            crowd.overlap(a, b, self.dynamic);
        }
        let (count, touching) = (u32::from(fact.count), u32::from(fact.touching));
        let all = (1 << count) - 1;
        prepared.manifolds += 1;
        prepared.real += touching;
        prepared.potential += count - touching;
        prepared.shed += (all & !kept).count_ones();
        if kept == 0 {
            return;
        }
        if fact.is_ahead() {
            self.ahead[usize::from(group.is_static())][count as usize - 1] += 1;
        }
        let solved_after = if self.any_solved_after {
            let own = |body: usize| input.bodies.traits[body].solved_after;
            input.order.higher(own(a), own(b))
        } else {
            None
        };
        // Under a budget there is place.
        let mut allowance = Allowance::ENDLESS;
        let mut enter = |part: Part, count: usize| {
            let colour = colouring[group as usize].assign(a, b);
            let in_tree = fact.is_in_tree() && colour != OVERFLOW;
            let key = keys.count(group, solved_after, colour, (!in_tree).then_some(count));
            allowance.push(entries, (part, key));
        };
        if input.per_point {
            ones(kept).for_each(|point| enter(Part::point(fact.slot, point), 1));
        } else {
            enter(Part::of(fact.slot, if kept == all { 0 } else { kept }), kept.count_ones() as usize);
        }
    }

    /// Sorts the added rows. `bounded`: overlaps may be left out.
    fn finish(self, bounded: bool) -> Prepared {
        let Sorter { input, scratch, prepared, ahead, .. } = self;
        note_crowd(input, &mut scratch.crowd, bounded);
        // Under a budget there is place.
        scratch.line_up(input, &mut { Allowance::ENDLESS });
        scratch.note_ahead(input, &ahead);
        prepared
    }
}

/// Records for bodies that overlap several others which bodies they touch. `bounded`: overlaps may be left
/// out.
fn note_crowd(input: &PrepareInput<'_>, crowd: &mut Crowd, bounded: bool) {
    let limits = if bounded { !crowd.is_empty() } else { crowd.limits_any() };
    if !limits {
        return;
    }
    let movers = input.bodies.movers();
    each_contact(input, |_, contact| {
        let body = |c: u32| input.colliders.summaries[c as usize].body as usize;
        crowd.touch(body(contact.a), body(contact.b), &input.bodies.velocity, movers);
    });
}

/// Bytes of batches of potential contacts, with their friction: for bodies that may move and for static ones,
/// by number of points.
pub(super) fn ahead_lanes(input: &PrepareInput<'_>) -> [[usize; 4]; 2] {
    Rows::SIZES.map(|side| std::array::from_fn(|i| side[i] + if input.friction { side[7] } else { 0 }))
}

/// The tree slot of the body of a contact with static geometry.
fn tree_slot_of(input: &PrepareInput<'_>, part: Part) -> Option<TreeSlot> {
    let contact = input.contacts.at(part.slot() as u32);
    let body = |c: u32| input.colliders.summaries[c as usize].body as usize;
    input.tree_slots.of(body(contact.a).min(body(contact.b)))
}

/// Makes the schedule: the batches of each stage. Returns their numbers by kind. `thin`: contacts that fill
/// too little of a batch become single rows.
fn schedule(input: &PrepareInput<'_>, rows: &mut Rows, scratch: &mut PrepareScratch, thin: bool) -> Tally {
    let PrepareScratch { keys, sorted, ranges, .. } = scratch;
    let mut tally = Tally::default();
    let mut batch = |points: usize, group: Group| {
        let mut next = |kind: usize| {
            let count = &mut tally[usize::from(group.is_static())][kind];
            *count += 1;
            *count as u32 - 1
        };
        // Zero points: a batch of one lane.
        let single = points == 0;
        let index = next(if single { 4 } else { points - 1 });
        let kind = 5 + 2 * usize::from(group.is_potential()) + usize::from(single);
        let friction = if input.friction { next(kind) } else { 0 };
        BatchRef { points: points as u8, in_tree: false, index, friction }
    };
    rows.schedule.clear();
    rows.stages.clear();
    rows.tree_contacts.clear();
    ranges.clear();
    let mut start = 0;
    for (layer, colour) in keys.colours() {
        let ends = keys.ends(layer, colour);
        let (tree_start, end) = (ends[KINDS - 2], ends[KINDS - 1]);
        if start == end {
            continue;
        }
        let stage_start = rows.schedule.len() as u32;
        let serial = colour == OVERFLOW;
        let potential = layer.group.is_potential();
        let width = if serial { 1 } else { 8 };
        for at in (start..tree_start).step_by(width) {
            // The points of the first part, which has the most.
            let points = 4 - ends[..4].iter().filter(|&&end| at >= end).count();
            let count = (width as u32).min(tree_start - at);
            let worth = || Rows::worth(points, layer.group, input.friction, input.beside);
            // A single row has place for four points, with which one point comes to other bits than alone.
            if thin && !serial && points > 1 && (count as usize) < worth() {
                for at in at..at + count {
                    rows.schedule.push(batch(0, layer.group));
                    ranges.push((at, 1));
                }
                continue;
            }
            rows.schedule.push(batch(if serial { 0 } else { points }, layer.group));
            ranges.push((at, count));
        }
        let mut at = tree_start as usize;
        let in_tree = &sorted[at..end as usize];
        let place = |part: &Part| tree_slot_of(input, *part).map(TreeSlot::place);
        for batch_of in in_tree.chunk_by(|a, b| place(a) == place(b)) {
            let most = batch_of
                .iter()
                .map(|part| part.points(input.contacts.at(part.slot() as u32)).count_ones())
                .max()
                .unwrap_or(1);
            let Some((tree, node)) = place(&batch_of[0]) else { continue };
            let points = if tree.is_single() { 0 } else { most as usize };
            let contact = BatchRef { in_tree: true, ..batch(points, layer.group) };
            rows.schedule.push(contact);
            rows.tree_contacts.push(TreeContacts { tree, node, potential, batch: contact });
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
    rows.tree_contacts.sort_by_key(|contacts| (contacts.tree, contacts.node));
    tally
}
