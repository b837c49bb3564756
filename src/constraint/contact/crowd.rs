//! Bodies that overlap several others: overlap alone makes them no faster than a bound.
//!
//! Each contact pushes its overlap apart at `Settings::push_speed` at most, and relaxing takes that out of the velocities again.
//! But along a chain of contacts these speeds add up, and of many a pass leaves much: 500 boxes at one point left it at
//! 114 m/s. A share of the push for each contact does not help: once the bodies have come apart into a line, each has few. So
//! it is the velocity that is bounded, of such bodies alone: what overlap gives them ends at [`MAX_FACTOR`] times the push speed, what
//! they had, or what the fastest has of them and of what they touch: by a push of that they may become as fast. A body that
//! overlaps one other adds that speed once more, so five times is what there is at all. Where a budget leaves contacts out, that is
//! another one in each step, which adds up: there these bodies are bounded too. Bodies with joints are left to these.

use crate::lanes::Record;
use crate::memory::{Buffer, bytes_of};

/// How often the push speed. Two bodies part at once that speed; this lets a pile that was made within itself part within a
/// second.
const MAX_FACTOR: f32 = 4.0;
/// Overlaps of a body from which on its velocity is bounded, where each is known.
const SEVERAL: u32 = 2;

#[derive(Debug, Default)]
pub(crate) struct Crowd {
    /// Overlaps of each body that can be pushed; empty while none is deep.
    overlaps: Vec<u32>,
    /// Speed of the fastest of these bodies and of what they touch [m/s].
    fastest: f32,
    /// Overlaps may have been left out.
    incomplete: bool,
}

impl Crowd {
    pub(crate) fn clear(&mut self) {
        self.overlaps.clear();
        self.fastest = 0.0;
        self.incomplete = false;
    }

    /// Notes that overlaps may have been left out.
    pub(crate) fn shed(&mut self) {
        self.incomplete = true;
    }

    pub(crate) fn is_empty(&self) -> bool {
        self.overlaps.is_empty()
    }

    /// Notes that two of so many bodies that can be pushed overlap.
    pub(crate) fn overlap(&mut self, (a, b): (usize, usize), bodies: usize) {
        if a < bodies && b < bodies {
            if self.overlaps.is_empty() {
                self.overlaps.resize(bodies, 0);
            }
            self.overlaps[a] += 1;
            self.overlaps[b] += 1;
        }
    }

    /// Notes that two bodies touch, or may, of which `movers` have velocities. After all overlaps.
    pub(crate) fn touch(&mut self, (a, b): (usize, usize), velocity: &[Record], movers: usize) {
        let crowded = |body: usize| self.overlaps.get(body).is_some_and(|&n| n > 0);
        if crowded(a) || crowded(b) {
            let speed = |body: usize| if body < movers { velocity[body].linear.length() } else { 0.0 };
            self.fastest = self.fastest.max(speed(a)).max(speed(b));
        }
    }

    /// Leaves out bodies of which `skip` says so.
    pub(crate) fn leave_out(&mut self, skip: impl Fn(usize) -> bool) {
        for (body, overlaps) in self.overlaps.iter_mut().enumerate() {
            if *overlaps > 0 && skip(body) {
                *overlaps = 0;
            }
        }
    }

    /// Bounds what a substep made of velocities; `base`: those before any row acted.
    pub(crate) fn calm(&self, velocity: &mut [Record], base: &[Record], push_speed: f32) {
        let bound = (MAX_FACTOR * push_speed).max(self.fastest);
        let several = if self.incomplete { 1 } else { SEVERAL };
        for (i, _) in self.overlaps.iter().enumerate().filter(|(_, n)| **n >= several) {
            let (now, most) = (velocity[i].linear.length(), bound.max(base[i].linear.length()));
            if now > most {
                velocity[i].linear *= most / now;
            }
        }
    }

    pub(crate) fn buffer(&mut self) -> &mut dyn Buffer {
        &mut self.overlaps
    }

    pub(crate) fn bytes(&self) -> (usize, usize) {
        bytes_of(&self.overlaps)
    }
}
