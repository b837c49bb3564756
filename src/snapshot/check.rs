//! Checks that a state from outside is valid for a world: every index in range, every number one that a step
//! can begin with.

use super::part::{BodyRecord, Records, read_pose};
use super::view::{BALL, BODY, FORCE, PUSH, PUSHED, REST, RESTS, TARGET, View};
use crate::body::{AfterTarget, BodyKind};
use crate::error::Error;
use crate::limits;
use crate::shape::Kind;
use crate::words::{Reader, broken, record};
use glam::Vec3;

/// A shape, for checks of pairs.
#[derive(Clone, Copy)]
struct Known {
    kind: Kind,
    body: u32,
    dynamic: bool,
    moves: bool,
    sensor: bool,
    senses_static: bool,
    disabled: bool,
}

pub(super) fn check(view: &View<'_>, records: &Records) -> Result<(), Error> {
    let colliders = check_bodies(view, records)?;
    let mut known: Vec<Option<Known>> = vec![None; records.colliders.count];
    let mut fixed: Vec<Option<bool>> = vec![None; records.colliders.count];
    for body in records.moving.iter().chain(&records.fixed) {
        for c in &body.colliders {
            let (kind, dynamic) = (c.collider.kind, body.body.kind == BodyKind::Dynamic);
            let (sensor, disabled) = (c.collider.is_sensor(), body.body.traits.disabled);
            let (moves, senses_static) = (body.body.kind != BodyKind::Static, c.collider.senses_static());
            let known = &mut known[c.index as usize];
            *known = Some(Known { kind, body: body.slot, dynamic, moves, sensor, senses_static, disabled });
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
    let of = |c: u32| known.get(c as usize).copied().flatten();
    let (movers, listed) = (view.counts.movers() as usize, view.counts.pairs as usize);
    // By slot: whether a body can be pushed, awake or asleep.
    let mut pushed = vec![false; records.bodies.count];
    for body in records.moving.iter().filter(|body| body.body.kind == BodyKind::Dynamic) {
        pushed[body.slot as usize] = !body.body.traits.disabled;
    }
    // Movable bodies that are neither awake nor asleep are disabled.
    let asleep: Vec<u32> =
        view.slots[movers..].iter().copied().filter(|&slot| pushed[slot as usize]).collect();
    view.sleep.check(&asleep, view.counts.sleeping_pairs as usize)?;
    let mut awake = vec![false; records.bodies.count];
    view.slots[..movers].iter().for_each(|&slot| awake[slot as usize] = true);
    let island_of = view.sleep.island_of(records.bodies.count);
    let islands: Vec<u32> = view.sleep.islands_of_pairs().collect();
    view.pairs.check(view.counts.contacts as usize, |i, a, b| {
        let (Some(one), Some(other)) = (of(a), of(b)) else { return false };
        let there = !(one.disabled || other.disabled);
        let collide = if one.sensor || other.sensor {
            let (sensor, visitor) = if one.sensor { (&one, &other) } else { (&other, &one) };
            !visitor.sensor && (visitor.moves || sensor.senses_static)
        } else {
            one.dynamic || other.dynamic
        };
        // Pairs of awake bodies are in the list; pairs of sleeping bodies are with their island, and are
        // among its bodies or with static ones.
        let any_awake = awake[one.body as usize] || awake[other.body as usize];
        let placed = if i < listed {
            any_awake || one.sensor != other.sensor
        } else {
            let own = |known: &Known| island_of[known.body as usize] == islands[i - listed];
            (own(&one) && (own(&other) || !other.moves)) || (own(&other) && !one.moves)
        };
        (one.kind, a) < (other.kind, b) && one.body != other.body && there && collide && placed
    })?;
    // Joined bodies sleep together.
    let torn = |[a, b]: [u32; 2]| {
        pushed[a as usize] && pushed[b as usize] && island_of[a as usize] != island_of[b as usize]
    };
    if records.joints.bodies().any(torn) {
        return Err(broken("an island"));
    }
    let torn_apart = |[a, b]: [[u32; 2]; 2]| a.into_iter().any(|a| b.into_iter().any(|b| torn([a, b])));
    if records.joints.coupled_bodies().any(torn_apart) {
        return Err(broken("an island"));
    }
    view.events.check()?;
    view.joints.check(&records.joints)
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
        // Each occurs once: found entries are removed.
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
    // The column has an entry for each body while bodies may sleep.
    if counts.has(REST) != (counts.has(RESTS) && !(records.moving.is_empty() && records.fixed.is_empty())) {
        return Err(broken("a column is missing"));
    }
    let sleeps = view.settings.sleeping && counts.has(REST) && counts.has(RESTS);
    if (sleepers > 0 && !sleeps)
        || (counts.forces > 0 && !counts.has(PUSHED))
        || (counts.has(PUSHED) && !counts.has(FORCE))
    {
        return Err(broken("a column is missing"));
    }
    for body in view.bodies.as_chunks::<BODY>().0 {
        read_pose(&mut Reader(body))?;
        let [linear, angular]: [Vec3; 2] = record::<_, 6>(&body[10..]);
        limits::left_speed("linear velocity", linear)?;
        limits::left_speed("angular velocity", angular)?;
    }
    if !view.rest.iter().all(|&rest| (0.0..f32::MAX).contains(&f32::from_bits(rest))) {
        return Err(broken("a time of rest"));
    }
    let taken = |slot: u32| records.moving.iter().chain(&records.fixed).any(|body| body.slot == slot);
    for force in view.forces.as_chunks::<PUSH>().0 {
        let [linear, angular]: [Vec3; 2] = record::<_, 6>(&force[1..]);
        limits::force("force", linear)?;
        limits::force("torque", angular)?;
        if !taken(force[0]) {
            return Err(broken("a force on nothing"));
        }
    }
    check_targets(view, records)?;
    check_clear(view, records.bodies.count)?;
    Ok(colliders)
}

/// Whether the poses that bodies are to have after the next step are valid, and the bodies kinematic.
fn check_targets(view: &View<'_>, records: &Records) -> Result<(), Error> {
    let mut last = None;
    for target in view.targets.as_chunks::<TARGET>().0 {
        let is_own = |body: &&BodyRecord| body.slot == target[0] && body.body.kind == BodyKind::Kinematic;
        let pose = read_pose(&mut Reader(&target[1..11]))?;
        limits::position(pose.position)?;
        limits::step(f32::from_bits(target[11]))?;
        let known = AfterTarget::ALL.iter().any(|after| *after as u32 == target[12]);
        let own = records.moving.iter().any(|body| is_own(&body));
        if !known || !own || last.is_some_and(|last| last >= target[0]) {
            return Err(broken("where a body is to be"));
        }
        last = Some(target[0]);
    }
    Ok(())
}

fn check_clear(view: &View<'_>, most: usize) -> Result<(), Error> {
    let guarded = view.counts.guarded as usize;
    let ones: u32 = view.is_clear.iter().map(|word| word.count_ones()).sum();
    let beyond =
        !guarded.is_multiple_of(32) && view.is_clear.last().is_some_and(|word| word >> (guarded % 32) != 0);
    let balls = view.clear.as_chunks::<BALL>().0.iter().all(|ball| {
        let centre: [f64; 3] = record::<_, 6>(&ball[..6]);
        let radius = f32::from_bits(ball[6]);
        limits::centre(centre.into()).is_ok() && radius > 0.0 && radius <= limits::MAX_LENGTH
    });
    if balls && !beyond && ones == view.counts.clear && guarded <= most {
        Ok(())
    } else {
        Err(broken("what is clear"))
    }
}
