//! Impulses that rows hand back to contacts, and rows that are disabled within a step.

use crate::constraint::contact::row::{Motion, disable_lanes, store as store_batch};
use crate::constraint::{Batch, FrictionRow, Part, RollingRow, Rows, Stage, StepLengths, Views, with_batch};
use crate::lanes::{GatherLanes, kernel, with_best};
use crate::limits::MAX_LOAD;
use crate::narrow_phase::{ContactMut, Point, SharedContacts};
use crate::threads::{Workers, per_block};
use std::sync::atomic::{AtomicBool, AtomicU32, Ordering};

/// Batches in a block of work.
const STORED: usize = per_block(16, 1);

/// Adds the normal impulses of the substep to those of contacts whose events are recorded.
pub(crate) fn add_impulses(views: &Views<'_>, impulses: &mut [f32]) {
    fn of<L: GatherLanes, const P: usize, const B: usize>(batch: &Batch<L, P, B>, impulses: &mut [f32]) {
        for lane in (0..L::N).filter(|lane| batch.heard >> lane & 1 != 0) {
            let sum: f32 = batch.points.iter().map(|p| p.impulse.lane(lane)).sum();
            // Contacts beyond the reserved capacity are not recorded.
            impulses.get_mut(batch.contact[lane].slot()).into_iter().for_each(|impulse| *impulse += sum);
        }
    }
    for stage in views.stages {
        for &batch in &views.schedule[stage.start as usize..stage.end as usize] {
            // SAFETY: there is no other thread.
            unsafe { with_batch!(views, stage.group, batch, |batch, _friction| of(batch, impulses)) };
        }
    }
}

/// Disables the rows of bodies that are held after an impact, for the rest of the step. They would push such
/// a body out of overlap, which adds energy, and into others, which removes energy from those.
pub(crate) fn disable(views: &Views<'_>, motion: &Motion<'_, '_>, stands: &dyn Fn(u32) -> bool) {
    for stage in views.stages {
        for &batch in &views.schedule[stage.start as usize..stage.end as usize] {
            // SAFETY: there is no other thread.
            unsafe {
                with_batch!(views, stage.group, batch, |row, friction| {
                    let touching = if stage.group.is_potential() { None } else { friction.touching(batch) };
                    let rolling = views.rolling_of(row);
                    disable_lanes(row, touching, rolling, motion, stands);
                });
            }
        }
    }
}

/// Result of storing the impulses of a step.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct Stored {
    /// Number of contacts that pushed before they touched.
    pub(crate) pushed: u32,
    /// Whether some contact bears a load that `statics` has not estimated yet.
    pub(crate) unknown_load: bool,
}

/// Writes impulses back to the contacts.
pub(crate) fn store(
    workers: &Workers<'_>,
    rows: &mut Rows,
    lengths: StepLengths,
    contacts: &SharedContacts<'_>,
) -> Stored {
    let (pushed, unknown) = (AtomicU32::new(0), AtomicBool::new(false));
    let views = rows.views();
    let block = |stage: &Stage, index: usize| {
        let of = views.schedule[index];
        let potential = stage.group.is_potential();
        // SAFETY: each batch is in the schedule once. Potential contacts have no friction rows.
        let stored = unsafe {
            with_best!(Wide => with_batch!(Wide: views, stage.group, of, |batch, friction| {
                let rows = if potential { None } else { friction.touching(of) };
                if let (Some(rolling), Some(f)) = (views.rolling_of(batch), rows.as_deref()) {
                    store_rolling(batch, rolling, f, contacts);
                }
                store_in_contacts(batch, rows.as_deref(), potential, lengths, contacts)
            }))
        };
        if stored.pushed > 0 {
            pushed.fetch_add(stored.pushed, Ordering::Relaxed);
        }
        if stored.unknown_load {
            unknown.store(true, Ordering::Relaxed);
        }
    };
    for stage in views.stages {
        let (start, end) = (stage.start as usize, stage.end as usize);
        if stage.serial {
            // Several points of one contact may be in this stage.
            (start..end).for_each(|index| block(stage, index));
            continue;
        }
        workers.run((end - start).div_ceil(STORED), &|n| {
            let first = start + n * STORED;
            (first..(first + STORED).min(end)).for_each(|index| block(stage, index));
        });
    }
    Stored { pushed: pushed.into_inner(), unknown_load: unknown.into_inner() }
}

fn store_in_point(point: &mut Point, impulse: f32, lengths: StepLengths) {
    point.impulse = impulse;
    point.mean_force = lengths.follow(point.mean_force, impulse);
}

kernel! {
    /// Writes the impulses of a batch back to its contacts.
    fn store_in_contacts<'a, L: GatherLanes, const P: usize, const B: usize>(
        batch: &'a Batch<L, P, B>,
        friction: Option<&'a FrictionRow<L, B>>,
        potential: bool,
        lengths: StepLengths,
        contacts: &'a SharedContacts<'a>,
    ) -> Stored {
        let (mut stored, has_friction) = (Stored::default(), friction.is_some());
        store_batch(batch, friction, |part, impulses, peak, friction, twist| {
            // SAFETY: a contact is in one lane of one batch. If its points are solved separately, these are
            // in different stages, or in a serial one.
            let mut contact = unsafe { contacts.at(part.slot() as u32) };
            let pushed = potential && peak > 0.0;
            let friction = if has_friction { contact.frame.conjugate() * friction } else { glam::Vec3::ZERO };
            // If points are solved separately, another one may have pushed already.
            stored.pushed += u32::from(pushed && !contact.pushed);
            if let Some(point) = part.only() {
                store_in_point(&mut contact.points_mut()[point], impulses[0], lengths);
                contact.pushed |= pushed;
                contact.friction += friction;
                forget_unsound(&mut contact);
                return;
            }
            if part.is_cut() {
                let (solved, mut impulses) = (part.points(contact.as_ref()), impulses.iter());
                for (i, point) in contact.points_mut().iter_mut().enumerate() {
                    let impulse = if solved >> i & 1 != 0 { impulses.next() } else { None };
                    store_in_point(point, impulse.copied().unwrap_or(0.0), lengths);
                }
            } else {
                for (point, &impulse) in contact.points_mut().iter_mut().zip(impulses) {
                    store_in_point(point, impulse, lengths);
                }
            }
            contact.pushed = pushed;
            (contact.friction, contact.twist) = (friction, twist);
            let (before, now) = (contact.mean_friction.into(), friction.extend(twist));
            contact.mean_friction = lengths.follow(before, now).into();
            stored.unknown_load |= contact.bear(lengths.dt(), lengths.now());
            forget_unsound(&mut contact);
        });
        stored
    }
}

kernel! {
    /// Writes back angular impulses against rolling, which are those on the bodies `b` of the batch.
    fn store_rolling<'a, L: GatherLanes, const P: usize, const B: usize>(
        batch: &'a Batch<L, P, B>,
        rolling: &'a RollingRow,
        friction: &'a FrictionRow<L, B>,
        contacts: &'a SharedContacts<'a>,
    ) {
        let on_b = rolling.on_b(batch.normal, friction.tangent);
        for lane in (0..L::N).filter(|&lane| batch.contact[lane] != Part::NONE) {
            let part = batch.contact[lane];
            // SAFETY: as in `store_in_contacts`.
            let Some(own) = (unsafe { contacts.rolling(part.slot() as u32) }) else { continue };
            let sign = if batch.swapped >> lane & 1 != 0 { -1.0 } else { 1.0 };
            let rolling: glam::Vec3 = on_b.lane(lane) * sign;
            // The points of a contact that are solved separately start every step without an impulse.
            let is_sound = part.only().is_none() && rolling.abs().max_element() <= MAX_LOAD;
            *own = if is_sound { rolling } else { glam::Vec3::ZERO };
        }
    }
}

/// The loads of the heaviest bodies at the greatest speeds may overflow, even if these bodies are stopped.
fn forget_unsound(contact: &mut ContactMut<'_>) {
    if !contact.as_ref().has_sound_loads() {
        contact.forget_loads();
    }
}
