//! Restores a world: first everything is read, and bytes from outside are checked; after that nothing can
//! fail.

use super::Snapshot;
use super::characters::{check_characters, restore_characters};
use super::check::check;
use super::geometry::{Known, found, here};
use super::part::{BodyRecord, Part, Records};
use super::view::{BALL, BODY, FORCE, PUSH, PUSHED, REST, RESTS, TARGET, View};
use crate::body::{AfterTarget, Bodies, Pose, Target};
use crate::error::Error;
use crate::finish::Clear;
use crate::lanes::Record;
use crate::math::Quat;
use crate::memory::Amounts;
use crate::narrow_phase::{ContactCount, most_points};
use crate::shape::{Kind, ROLLS};
use crate::words::record;
use crate::world::{Brings, Replacement, World};
use glam::{DVec3, Vec3};
use std::sync::Arc;

pub(super) fn restore(world: &mut World, snapshot: &Snapshot) -> Result<(), Error> {
    let view = View::read(&snapshot.words, &world.settings)?;
    let (parts, settle) = parts_of(world, snapshot)?;
    let poisoned = world.stage.is_some();
    let same = !poisoned && (settle || world.has_parts(&parts));
    let records = if same && snapshot.foreign.is_none() {
        None
    } else {
        let records = Records::read([&parts[0], &parts[1]], world)?;
        if snapshot.foreign.is_some() {
            check(&view, &records)?;
        }
        Some(records).filter(|_| !same)
    };
    let own;
    let forms = if snapshot.foreign.is_some() {
        own = found(&snapshot.forms, world)?;
        check_characters(view.characters, &own)?;
        &own
    } else {
        &snapshot.forms
    };
    let brings = brought(world, &view, records.as_ref(), forms, snapshot);
    if poisoned {
        // The broken step's data is dropped, once it is known that there is memory for a whole world.
        let mut whole = World::new(world.settings.clone())?;
        whole.reserve_to_restore(&brings)?;
        whole.report = std::mem::take(&mut world.report);
        #[cfg(feature = "replay")]
        {
            whole.recorder = world.recorder.take();
        }
        *world = whole;
    } else {
        world.reserve_to_restore(&brings)?;
    }
    world.clear_characters();
    if let Some(records) = records {
        let promised = world.promised_to(&records.joints, snapshot.joint_rows);
        install(world, records);
        world.joints.promise(promised);
    } else if settle && !poisoned {
        world.broad.settle_statics();
    }
    apply(world, &view, forms);
    let slots = world.colliders.all.len();
    if let Some(now) = world.now.change() {
        now.touch_all(slots);
    }
    world.joints.changed = snapshot.arrangement != Some(world.buffers.joints.arrangement);
    world.keep_parts(&parts);
    Ok(())
}

/// The parts that a snapshot needs, and whether static shapes have to be put into their tree for that.
fn parts_of(world: &World, snapshot: &Snapshot) -> Result<([Arc<Part>; 2], bool), Error> {
    if let [Some(fixed), Some(moving)] = &snapshot.parts {
        return Ok(([fixed.clone(), moving.clone()], false));
    }
    let own = world.parts();
    let Some([fixed, moving]) = snapshot.foreign else {
        return Err(crate::words::broken("it is empty"));
    };
    if own[0].prints()[0] != fixed[0] {
        return Err(Error::ForeignSnapshot { what: "other static bodies" });
    }
    if own[1].prints() != moving {
        return Err(Error::ForeignSnapshot { what: "other bodies, shapes or joints" });
    }
    if own[0].prints() == fixed {
        return Ok((own, false));
    }
    let settled = own[0].settled(world);
    if settled.prints() != fixed {
        return Err(Error::ForeignSnapshot { what: "static bodies that were added between other steps" });
    }
    let [_, moving] = own;
    Ok(([Arc::new(settled), moving], true))
}

/// The memory that the snapshot needs; that of contacts only if the world has a budget.
fn brought<'a>(
    world: &World,
    view: &'a View<'_>,
    records: Option<&'a Records>,
    forms: &'a [Known],
    snapshot: &Snapshot,
) -> Brings<'a> {
    let counts = &view.counts;
    let new = records.map(|records| {
        let all = || records.moving.iter().chain(&records.fixed);
        let shapes = all().flat_map(|record| &record.colliders);
        let (bodies, colliders) = (records.bodies.count, records.colliders.count);
        let geometries = shapes.map(|c| &c.collider.geometry).chain(here(forms));
        let mut new = Replacement::new(bodies, colliders, &records.joints, snapshot.joint_rows, geometries);
        for record in all() {
            let kinds = record.colliders.iter().map(|c| (c.collider.kind, c.collider.flags));
            new.add(&record.body, kinds);
        }
        new
    });
    let contacts = if world.settings.budget.is_none() {
        ContactCount::default()
    } else {
        let kinds = kinds(world, records);
        let room = |a: u32, b: u32| most_points(kinds[a as usize], kinds[b as usize]);
        ContactCount { contacts: counts.contacts as usize, points: view.pairs.places(&room) }
    };
    let rolling = records.map_or(world.needs.rolling > 0, |records| {
        let mut all = records.moving.iter().chain(&records.fixed).flat_map(|record| &record.colliders);
        all.any(|c| c.collider.flags & ROLLS != 0)
    });
    Brings {
        rolling,
        settings: &view.settings,
        pairs: (counts.pairs + counts.sleeping_pairs) as usize,
        sleeping_pairs: counts.sleeping_pairs as usize,
        contacts,
        forced: counts.has(FORCE),
        targets: counts.targets as usize,
        guarded: counts.guarded as usize,
        characters: counts.characters as usize,
        forms: if new.is_some() { Amounts::default() } else { world.cost_of(here(forms)) },
        over_budget: snapshot.over_budget,
        // Not by the number of sleepers: disabled bodies share their part of the columns.
        rests: counts.has(RESTS),
        new,
    }
}

/// The kinds of all colliders, as they will be: those of the world, or of the records that replace them.
fn kinds(world: &World, records: Option<&Records>) -> Vec<Kind> {
    let Some(records) = records else {
        return world.colliders.summaries.iter().map(|summary| summary.kind).collect();
    };
    let mut kinds = vec![Kind::Sphere; records.colliders.count];
    let all = records.moving.iter().chain(&records.fixed).flat_map(|record| &record.colliders);
    all.for_each(|c| kinds[c.index as usize] = c.collider.kind);
    kinds
}

/// Pairs, first those of the step and then those that islands keep, and all contacts.
fn read_pairs(world: &mut World, view: &View<'_>) {
    let World { broad, contacts, sleep, colliders, settings, .. } = world;
    contacts.clear();
    contacts.keep_rooms(!settings.budget.is_none());
    let kind = |c: u32| colliders.summaries[c as usize].kind;
    let room = |a: u32, b: u32| if settings.budget.is_none() { 0 } else { most_points(kind(a), kind(b)) };
    broad.pairs.clear();
    let mut islands = view.sleep.islands_of_pairs();
    let mut left = view.counts.pairs;
    broad.pairs.reserve(left as usize);
    let read = view.pairs.restore(contacts, &room, |pair| {
        if left > 0 {
            left -= 1;
            broad.pairs.push(pair);
        } else if let Some(island) = islands.next() {
            sleep.keep_pair(island, pair);
        }
    });
    debug_assert!(read.is_ok(), "what was written or checked can be read");
    broad.restore_pairs(view.counts.sleeping_pairs as usize);
}

/// Installs the parts that snapshots share.
fn install(world: &mut World, records: Records) {
    let Records { moving, fixed, bodies, colliders, joints, new, tree } = records;
    world.clear_colliders(colliders.count);
    world.bodies.clear();
    let mut taken = Vec::with_capacity(moving.len() + fixed.len());
    let mut put = |world: &mut World, body: BodyRecord, is_static: bool| {
        let index = world.bodies.len() as u32;
        let own: Vec<u32> = body.colliders.iter().map(|c| c.index).collect();
        taken.push((body.slot, body.generation, index));
        let disabled = body.body.traits.disabled;
        world.bodies.append(body.slot, body.body, &own);
        for (place, mut c) in body.colliders.into_iter().enumerate() {
            (c.collider.body, c.collider.place) = (index, place as u32);
            world.put_collider(c.index, &c.collider, c.rare, c.pose);
            if disabled {
                // It is disabled.
            } else if is_static {
                world.broad.restore_static(c.index, &c.bounds);
            } else {
                world.broad.count_mover();
            }
        }
    };
    let generations = |list: &[BodyRecord]| -> Vec<(u32, u32)> {
        list.iter().flat_map(|body| body.colliders.iter().map(|c| (c.index, c.generation))).collect()
    };
    let (of_moving, of_fixed) = (generations(&moving), generations(&fixed));
    moving.into_iter().for_each(|body| put(world, body, false));
    fixed.into_iter().for_each(|body| put(world, body, true));
    world.bodies.slots.rebuild(bodies.count, taken.into_iter(), &bodies.free);
    let taken = of_moving.into_iter().chain(of_fixed).map(|(slot, generation)| (slot, generation, slot));
    world.colliders.slots.rebuild(colliders.count, taken, &colliders.free);
    world.broad.restore_statics(&new, &tree);
    world.joints.restore_all(&joints);
    world.revisions.fixed += 1;
    world.revisions.moving += 1;
}

/// Applies the state; the shared parts are installed. No column is left out by `..`.
fn apply(world: &mut World, view: &View<'_>, forms: &[Known]) {
    let View {
        counts,
        settings,
        origin,
        last_h,
        usual_h,
        evenness,
        wait,
        pending,
        slots,
        // By [`restore_bodies`].
        bodies: _,
        rest: _,
        forces: _,
        targets,
        is_clear,
        clear,
        broad: saved_broad,
        // By [`read_pairs`], once it is known which islands there are.
        pairs: _,
        sleep: saved_sleep,
        joints: saved_joints,
        characters,
        events,
    } = view;
    let World { bodies, colliders, broad, joints, sleep, buffers, .. } = world;
    world.settings = settings.clone();
    world.origin = (*origin).into();
    (buffers.last_h, buffers.evenness, buffers.solver.usual_h) = (*last_h, *evenness, *usual_h);
    (buffers.statics.wait, buffers.statics.pending) = (*wait, *pending);
    // The rows of a step that was undone, which drawing would show.
    buffers.rows.stages.clear();

    bodies.line_up(slots, colliders);
    restore_bodies(bodies, view);
    restore_targets(bodies, targets);
    restore_clear(&mut buffers.finish.clear, counts.guarded as usize, is_clear, clear);

    let all = counts.bodies() as usize;
    for i in 0..all {
        for &c in bodies.colliders[i].as_slice() {
            colliders.place(c, &bodies.pose[i]);
        }
    }
    let own = bodies.colliders[..all].iter().flat_map(|own| own.as_slice()).copied();
    broad.restore(saved_broad, own);
    if !counts.has(RESTS) && counts.sleeping_pairs == 0 && counts.parts[2] == 0 && sleep.count() == 0 {
        // If sleeping is off, there is no state of it.
        sleep.switch_off(!world.settings.budget.is_none());
    }
    sleep.restore(saved_sleep);
    sleep.fell_asleep.clear();
    joints.restore(saved_joints);
    read_pairs(world, view);
    restore_characters(world, characters, forms);
    world.refresh_event_allowance();
    world.events.restore(events);
}

/// Restores the changing state of bodies, which are in their places.
fn restore_bodies(bodies: &mut Bodies, view: &View<'_>) {
    let View { counts, bodies: moving, rest, forces, .. } = view;
    bodies.set_parts(counts.parts);
    bodies.rests = counts.has(RESTS);
    for (i, body) in moving.as_chunks::<BODY>().0.iter().enumerate() {
        let [linear, angular]: [Vec3; 2] = record::<_, 6>(&body[10..]);
        bodies.pose[i] = pose_of(&body[..10]);
        bodies.velocity[i] = Record { linear, angular, ..Record::default() };
    }
    let (all, len) = (counts.bodies() as usize, bodies.len());
    if bodies.velocity[all..].iter().any(|v| *v != Record::default()) {
        bodies.velocity[all..].fill(Record::default());
    }
    fill(
        &mut bodies.rest,
        if counts.has(REST) { len } else { 0 },
        0.0,
        rest.iter().map(|&w| f32::from_bits(w)),
    );
    fill(&mut bodies.force, if counts.has(FORCE) { len } else { 0 }, Record::default(), std::iter::empty());
    (bodies.pushes, bodies.unpushed) = (u32::from(counts.has(FORCE)), u32::from(!counts.has(PUSHED)));
    for force in forces.as_chunks::<PUSH>().0 {
        let [linear, angular]: [Vec3; 2] = record::<_, 6>(&force[1..]);
        bodies.force[bodies.slots.dense(force[0]) as usize] = Record { linear, angular, ..Record::default() };
    }
}

/// Restores where kinematic bodies are to be after the next step.
fn restore_targets(bodies: &mut Bodies, targets: &[u32]) {
    bodies.rare.targets.clear();
    for words in targets.as_chunks::<TARGET>().0 {
        let Pose { position, rotation } = pose_of(&words[1..11]);
        let dt = f32::from_bits(words[11]);
        let after = AfterTarget::ALL.into_iter().find(|after| *after as u32 == words[12]);
        let after = after.unwrap_or(AfterTarget::MoveOn);
        bodies.rare.targets.set(words[0], Some(Target { position, rotation, dt, after }));
    }
}

/// Restores the balls in which bodies are clear of static shapes; `guarded`: number of bodies that the guard
/// checked.
fn restore_clear(out: &mut Vec<Clear>, guarded: usize, is_clear: &[u32], clear: &[u32]) {
    let mut clear = clear.as_chunks::<BALL>().0.iter().map(|ball| Clear {
        centre: DVec3::from_array(record::<_, 6>(&ball[..6])),
        radius: f32::from_bits(ball[6]),
    });
    let balls = (0..guarded).map(|i| {
        let is_clear = is_clear[i / 32] >> (i % 32) & 1 != 0;
        if is_clear { clear.next().unwrap_or_default() } else { Clear::default() }
    });
    out.clear();
    out.extend(balls);
}

fn pose_of(words: &[u32]) -> Pose {
    Pose {
        position: DVec3::from_array(record::<_, 6>(&words[..6])),
        rotation: Quat::from_array(record::<_, 4>(&words[6..10])),
    }
}

/// Resizes a column to `len` values: first those in `values`, then `other`.
fn fill<T: Clone>(column: &mut Vec<T>, len: usize, other: T, values: impl Iterator<Item = T>) {
    column.clear();
    if len > 0 {
        column.extend(values);
        column.resize(len, other);
    }
}
