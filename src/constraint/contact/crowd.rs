//! Bodies that overlap several others: limits the speed that overlap gives them.
//!
//! Each contact pushes overlap apart at `Settings::push_speed` at most, and relaxing removes that from the
//! velocities again. But along a chain of contacts these speeds add up, and where there are many, a pass
//! leaves much of them: 500 boxes at one point left it at 114 m/s. Scaling the push of each contact does not
//! help: once the bodies have come apart into a line, each has few contacts. So the velocity itself is
//! limited, for such bodies only: to [`CROWD_PUSH`] times the push speed, to their own speed before, or to
//! that of the fastest of them and of the bodies that they touch, whichever is greatest: an impact may make
//! them as fast as that. A body that overlaps one other adds the push speed once more, so five times is the
//! maximum. Where a budget leaves contacts out, these are others in each step, and the speeds add up: there,
//! bodies that overlap one other are limited too. Bodies with joints are left to their joints.

use crate::config::tuning::CROWD_PUSH;
use crate::lanes::Record;
use crate::memory::buffers;

/// Number of overlaps of a body from which on its velocity is limited, if all are known.
const SEVERAL: u32 = 2;

#[derive(Debug, Default)]
pub(crate) struct Crowd {
    /// Number of overlaps of each dynamic body; empty while none is deep.
    overlaps: Vec<u32>,
    /// Speed of the fastest of these bodies and of those they touch [m/s].
    fastest: f32,
    /// Overlaps may have been left out.
    incomplete: bool,
}

buffers! { Crowd { each(dynamic: usize) { overlaps(dynamic) } } }

impl Crowd {
    pub(crate) fn clear(&mut self) {
        self.overlaps.clear();
        self.fastest = 0.0;
        self.incomplete = false;
    }

    /// Records that overlaps may have been left out.
    pub(crate) fn shed(&mut self) {
        self.incomplete = true;
    }

    pub(crate) fn is_empty(&self) -> bool {
        self.overlaps.is_empty()
    }

    /// Whether the velocity of any body is limited, if all overlaps are known.
    pub(crate) fn limits_any(&self) -> bool {
        self.overlaps.iter().any(|&overlaps| overlaps >= SEVERAL)
    }

    /// Records that two bodies overlap; `bodies`: number of dynamic bodies.
    pub(crate) fn overlap(&mut self, a: usize, b: usize, bodies: usize) {
        if a < bodies && b < bodies {
            if self.overlaps.is_empty() {
                self.overlaps.resize(bodies, 0);
            }
            self.overlaps[a] += 1;
            self.overlaps[b] += 1;
        }
    }

    /// Records that two bodies touch or may touch; the first `movers` have velocities. Called after all
    /// overlaps.
    pub(crate) fn touch(&mut self, a: usize, b: usize, velocity: &[Record], movers: usize) {
        let crowded = |body: usize| self.overlaps.get(body).is_some_and(|&n| n > 0);
        if crowded(a) || crowded(b) {
            let speed = |body: usize| if body < movers { velocity[body].linear.length() } else { 0.0 };
            self.fastest = self.fastest.max(speed(a)).max(speed(b));
        }
    }

    /// Excludes the bodies for which `skip` returns true.
    pub(crate) fn leave_out(&mut self, skip: impl Fn(usize) -> bool) {
        for (body, overlaps) in self.overlaps.iter_mut().enumerate() {
            if *overlaps > 0 && skip(body) {
                *overlaps = 0;
            }
        }
    }

    /// Limits velocities after a substep; `base`: those before any row acted.
    pub(crate) fn calm(&self, velocity: &mut [Record], base: &[Record], push_speed: f32) {
        let bound = (CROWD_PUSH * push_speed).max(self.fastest);
        let several = if self.incomplete { 1 } else { SEVERAL };
        for (i, _) in self.overlaps.iter().enumerate().filter(|(_, n)| **n >= several) {
            let (now, most) = (velocity[i].linear.length(), bound.max(base[i].linear.length()));
            if now > most {
                velocity[i].linear *= most / now;
            }
        }
    }
}
