//! Whether a state from outside can be one of a world: every index in range, every number one that a step can begin with.

use super::part::{BodyRecord, Records, read_pose};
use super::view::{BALL, BODY, FORCE, PUSH, REST, RESTS, View};
use super::words::{Reader, all_finite, broken, record};
use crate::body::BodyKind;
use crate::error::Error;
use crate::shape::Kind;

/// A shape, for those who ask about pairs.
#[derive(Clone, Copy)]
struct Known {
    kind: Kind,
    body: u32,
    dynamic: bool,
    sensor: bool,
}

pub(super) fn check(view: &View<'_>, records: &Records) -> Result<(), Error> {
    let colliders = check_bodies(view, records)?;
    let mut known: Vec<Option<Known>> = vec![None; records.colliders.count];
    let mut fixed: Vec<Option<bool>> = vec![None; records.colliders.count];
    for body in records.moving.iter().chain(&records.fixed) {
        for c in &body.colliders {
            let (kind, dynamic) = (c.collider.kind, body.body.kind == BodyKind::Dynamic);
            let sensor = c.collider.is_sensor();
            known[c.index as usize] = Some(Known { kind, body: body.slot, dynamic, sensor });
        }
    }
    let mut absent: Vec<u32> = records
        .moving
        .iter()
        .filter(|body| body.body.traits.disabled)
        .flat_map(|body| body.colliders.iter().map(|c| c.index))
        .collect();
    absent.sort_unstable();
    let there = records.fixed.iter().filter(|body| !body.body.traits.disabled);
    for c in there.flat_map(|body| &body.colliders) {
        let bounded = crate::broad_phase::BroadPhase::is_bounded(&c.bounds);
        fixed[c.index as usize] = Some(!bounded);
    }
    view.broad.check(&colliders, &fixed, &absent)?;
    let mut disabled = vec![false; records.bodies.count];
    let all = records.moving.iter().chain(&records.fixed);
    all.for_each(|body| disabled[body.slot as usize] = body.body.traits.disabled);
    let of = |c: u32| known.get(c as usize).copied().flatten();
    let mut awake = vec![false; records.bodies.count];
    view.slots[..view.counts.movers() as usize].iter().for_each(|&slot| awake[slot as usize] = true);
    view.pairs.check(view.counts.contacts as usize, |i, a, b| {
        let (Some(one), Some(other)) = (of(a), of(b)) else { return false };
        // Who is awake has its pairs in the list, and who sleeps with its island.
        let listed = i < view.counts.pairs as usize;
        let any_awake = awake[one.body as usize] || awake[other.body as usize];
        (one.kind, a) < (other.kind, b)
            && one.body != other.body
            && (one.dynamic || other.dynamic || one.sensor != other.sensor)
            && (any_awake == listed || listed && one.sensor != other.sensor)
    })?;
    let mut asleep = view.slots[view.counts.movers() as usize..].to_vec();
    asleep.retain(|&slot| !disabled[slot as usize]);
    view.sleep.check(&asleep, view.counts.kept as usize)?;
    view.joints.check(records.joints.counts())
}

/// Whether the columns of bodies fit; returns their shapes in order.
fn check_bodies(view: &View<'_>, records: &Records) -> Result<Vec<u32>, Error> {
    let counts = &view.counts;
    let no = || broken("the number of bodies");
    let mut by_slot: Vec<Option<&BodyRecord>> = vec![None; records.bodies.count];
    records.moving.iter().for_each(|body| by_slot[body.slot as usize] = Some(body));
    let of_all: u64 = counts.parts.iter().map(|&n| u64::from(n)).sum();
    if of_all != records.moving.len() as u64 || counts.slots as usize != records.colliders.count {
        return Err(no());
    }
    let (awake, movers) = (counts.parts[0] as usize, counts.movers() as usize);
    let (mut colliders, mut sleepers) = (Vec::new(), 0);
    for (i, &slot) in view.slots.iter().enumerate() {
        // Each once: those that were found are taken.
        let body = by_slot.get_mut(slot as usize).and_then(Option::take).ok_or_else(no)?;
        let fits = if body.body.traits.disabled {
            i >= movers
        } else {
            sleepers += usize::from(i >= movers);
            (body.body.kind == BodyKind::Dynamic) != (awake..movers).contains(&i)
        };
        if !fits {
            return Err(no());
        }
        colliders.extend(body.colliders.iter().map(|c| c.index));
    }
    let sleeps = view.settings.sleeping && counts.has(REST) && counts.has(RESTS);
    if (sleepers > 0 && !sleeps) || (counts.forces > 0 && !counts.has(FORCE)) {
        return Err(broken("a column is missing"));
    }
    for body in view.bodies.as_chunks::<BODY>().0 {
        read_pose(&mut Reader(body))?;
        all_finite(&body[10..])?;
    }
    all_finite(view.rest)?;
    let taken = |slot: u32| records.moving.iter().chain(&records.fixed).any(|body| body.slot == slot);
    for force in view.forces.as_chunks::<PUSH>().0 {
        all_finite(&force[1..])?;
        if !taken(force[0]) {
            return Err(broken("a force on nothing"));
        }
    }
    check_clear(view, records.bodies.count)?;
    Ok(colliders)
}

fn check_clear(view: &View<'_>, most: usize) -> Result<(), Error> {
    let guarded = view.counts.guarded as usize;
    let ones: u32 = view.is_clear.iter().map(|word| word.count_ones()).sum();
    let beyond =
        !guarded.is_multiple_of(32) && view.is_clear.last().is_some_and(|word| word >> (guarded % 32) != 0);
    let balls = view.clear.as_chunks::<BALL>().0.iter().all(|ball| {
        let centre: [f64; 3] = record::<_, 6>(&ball[..6]);
        let radius = f32::from_bits(ball[6]);
        centre.iter().all(|x| x.is_finite()) && radius.is_finite() && radius > 0.0
    });
    if balls && !beyond && ones == view.counts.clear && guarded <= most {
        Ok(())
    } else {
        Err(broken("what is clear"))
    }
}
