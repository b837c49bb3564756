//! Bodies that only soft contacts hold.
//!
//! Rows stop a body by its velocity at the end of a substep, and move it by that. A spring gives back the
//! energy that it took only if the body moves by the mean of its velocities at both ends; but to a rigid row
//! this mean is half of the velocity that it stopped. So bodies move by the mean where every contact that
//! they have is soft, and no joint holds them. At rest both are the same.

use crate::constraint::contact::input::PrepareInput;
use crate::lanes::Record;
use crate::memory::Allowance;

/// Bits of a body's mark: it has a soft contact; something else holds it.
const YIELDS: u8 = 1;
const HELD: u8 = 2;

/// Marks the dynamic bodies by the contacts and joints that hold them in this step. Without memory for that,
/// none is marked.
pub(crate) fn mark(marks: &mut Vec<u8>, input: &PrepareInput<'_>, allowance: &mut Allowance) {
    let &PrepareInput { bodies, colliders, pairs, contacts, joints, .. } = input;
    marks.clear();
    let dynamic = bodies.dynamic();
    if allowance.fit(marks, dynamic) < dynamic {
        return;
    }
    marks.resize(dynamic, 0);
    for pair in pairs {
        for (_, contact) in contacts.chain(pair.contact) {
            let [a, b] = [contact.a, contact.b].map(|c| &colliders.all[c as usize]);
            let is_soft = a.is_soft(0) || b.is_soft(contact.material);
            let mark = if is_soft { YIELDS } else { HELD };
            for body in [a.body, b.body].into_iter().filter(|_| contact.count > 0) {
                if let Some(own) = marks.get_mut(body as usize) {
                    *own |= mark;
                }
            }
        }
    }
    if joints.count > 0 {
        for (i, mark) in marks.iter_mut().enumerate().filter(|(_, mark)| **mark != 0) {
            if joints.has_any(bodies.slot[i]) {
                *mark |= HELD;
            }
        }
    }
}

/// Whether a body moves by the mean of its velocities at both ends of a substep, or does not move by rows.
pub(crate) fn moves_by_mean(marks: &[u8], body: u32, dynamic: usize) -> bool {
    body as usize >= dynamic || marks.get(body as usize) == Some(&YIELDS)
}

/// Corrects the displacements of a substep of `h` seconds for the bodies that move by the mean of their
/// velocities at both ends of it. `base`: velocities before any row acted, including those by `acceleration`.
/// A part of a velocity that no row changed is not corrected: its displacement takes acceleration into
/// account.
pub(crate) fn move_by_mean(
    marks: &[u8],
    velocity: &[Record],
    base: &[Record],
    delta: &mut [Record],
    acceleration: &[Record],
    h: f32,
) {
    for (i, _) in marks.iter().enumerate().filter(|(_, mark)| **mark == YIELDS) {
        let (now, before) = (velocity[i], base[i]);
        let pull = acceleration.get(i).copied().unwrap_or_default();
        if now.linear != before.linear {
            delta[i].linear += (before.linear - pull.linear * h - now.linear) * (0.5 * h);
        }
        if now.angular != before.angular {
            delta[i].angular += (before.angular - pull.angular * h - now.angular) * (0.5 * h);
        }
    }
}
