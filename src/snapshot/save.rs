//! Writes the state of a world.

use super::characters::save_characters;
use super::contacts::{save_contacts, save_pairs};
use super::geometry::Known;
use super::settings;
use super::view::{BODY, COUNTS, Counts, FORCE, HEAD, Head, MAGIC, PUSHED, REST, RESTS, VERSION};
use crate::body::{Bodies, Pose, Target};
use crate::broad_phase::Pair;
use crate::finish::Clear;
use crate::lanes::Record;
use crate::words::words;
use crate::world::{State, World};

fn pose_words(pose: &Pose) -> [u32; 10] {
    let [a, b, c, d, e, f] = words::<6>(pose.position.to_array());
    let [x, y, z, w] = pose.rotation.to_array().map(f32::to_bits);
    [a, b, c, d, e, f, x, y, z, w]
}

fn motion_words(v: &Record) -> [u32; 6] {
    words([v.linear, v.angular])
}

/// Writes all that changes from step to step.
pub(super) fn save(world: &World, forms: &mut Vec<Known>, out: &mut Vec<u32>) {
    let State {
        settings,
        origin,
        bodies,
        colliders,
        broad,
        contacts,
        joints,
        characters,
        sleep,
        events,
        last_h,
        usual_h,
        evenness,
        statics: (wait, pending),
        clear,
    } = world.state();
    let all = bodies.asleep().end;
    let mut counts = Counts { parts: bodies.parts(), slots: colliders.all.len() as u32, ..Counts::default() };
    out.clear();
    out.resize(HEAD + COUNTS, 0);
    settings::save(settings, out);
    out.extend_from_slice(&words::<6>(origin.to_array()));
    out.extend([last_h, usual_h, evenness].map(f32::to_bits));
    out.push(wait << 1 | u32::from(pending));

    save_bodies(bodies, &mut counts, out);
    (counts.guarded, counts.clear) = (clear.len() as u32, save_clear(clear, out));
    counts.broad = broad.save(bodies.colliders[..all].iter().flat_map(|own| own.as_slice()).copied(), out);

    let pairs = broad.pairs.iter().chain(sleep.sleeping_pairs());
    // Awake bodies may be sent to sleep before the next step.
    let rests = |pair: &Pair| bodies.rests || pair.is_idle(&colliders.summaries, bodies.dynamic());
    let pairs = pairs.map(|pair| (pair, rests(pair)));
    (counts.pairs, counts.sleeping_pairs) = (broad.pairs.len() as u32, sleep.pair_count() as u32);
    let written = save_pairs(&|| broad.pairs.iter().chain(sleep.sleeping_pairs()), colliders.all.len(), out);
    debug_assert_eq!(written, counts.pairs + counts.sleeping_pairs);
    let start = out.len();
    counts.contacts = save_contacts(pairs, contacts, out);
    counts.contact_words = (out.len() - start) as u32;
    counts.sleep = sleep.save(out);
    counts.joints = joints.save(out);
    counts.characters = save_characters(characters, forms, out);
    counts.events = events.save(out);

    let head = Head { magic: MAGIC, version: VERSION, words: out.len() as u32, ..Head::default() };
    out[..HEAD].copy_from_slice(&words::<HEAD>(head));
    out[HEAD..HEAD + COUNTS].copy_from_slice(&words::<COUNTS>(counts));
}

/// Writes the changing state of bodies, and pending changes of some.
fn save_bodies(bodies: &Bodies, counts: &mut Counts, out: &mut Vec<u32>) {
    let (movers, all) = (bodies.movers(), bodies.asleep().end);
    out.extend(&bodies.slot[..all]);
    let start = out.len();
    out.resize(start + all * BODY, 0);
    let moving = bodies.pose[..all].iter().zip(&bodies.velocity);
    for (record, (pose, velocity)) in out[start..].as_chunks_mut::<BODY>().0.iter_mut().zip(moving) {
        record[..10].copy_from_slice(&pose_words(pose));
        record[10..].copy_from_slice(&motion_words(velocity));
    }
    counts.columns |= if bodies.rests { RESTS } else { 0 };
    if !bodies.rest.is_empty() {
        counts.columns |= REST;
        out.extend(bodies.rest[..movers].iter().map(|rest| rest.to_bits()));
    }
    counts.columns |= if bodies.is_pushed() { PUSHED } else { 0 };
    if !bodies.force.is_empty() {
        counts.columns |= FORCE;
        for (i, force) in bodies.force.iter().enumerate() {
            let force = motion_words(force);
            if force != [0; 6] {
                out.push(bodies.slot[i]);
                out.extend(force);
                counts.forces += 1;
            }
        }
    }
    for (slot, Target { position, rotation, dt, after }) in bodies.rare.targets.iter() {
        out.push(slot);
        out.extend(pose_words(&Pose { position, rotation }));
        out.extend([dt.to_bits(), after as u32]);
        counts.targets += 1;
    }
}

/// Writes which bodies are clear of static shapes, and in which balls; returns how many.
fn save_clear(clear: &[Clear], out: &mut Vec<u32>) -> u32 {
    let mut count = 0;
    for some in clear.chunks(32) {
        out.push(some.iter().rev().fold(0, |bits, ball| bits << 1 | u32::from(ball.radius > 0.0)));
    }
    for Clear { centre, radius } in clear.iter().filter(|ball| ball.radius > 0.0) {
        out.extend_from_slice(&words::<6>(centre.to_array()));
        out.push(radius.to_bits());
        count += 1;
    }
    count
}
