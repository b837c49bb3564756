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

/// A dynamic body.
#[derive(Clone, Copy, Debug, Default)]
struct Member {
    /// Number of its overlaps.
    overlaps: u32,
    /// Its greatest speed in the substep, if it is limited [m/s].
    most: f32,
}

#[derive(Debug, Default)]
pub(crate) struct Crowd {
    /// All dynamic bodies; empty while no overlap is deep.
    members: Vec<Member>,
    /// Speed of the fastest of these bodies and of those they touch [m/s].
    fastest: f32,
    /// Overlaps may have been left out.
    incomplete: bool,
}

buffers! { Crowd { each(dynamic: usize) { members(dynamic) } } }

impl Crowd {
    pub(crate) fn clear(&mut self) {
        self.members.clear();
        self.fastest = 0.0;
        self.incomplete = false;
    }

    /// Records that overlaps may have been left out.
    pub(crate) fn shed(&mut self) {
        self.incomplete = true;
    }

    pub(crate) fn is_empty(&self) -> bool {
        self.members.is_empty()
    }

    /// Whether the velocity of any body is limited, if all overlaps are known.
    pub(crate) fn limits_any(&self) -> bool {
        self.members.iter().any(|member| member.overlaps >= SEVERAL)
    }

    /// Records that two bodies overlap; `bodies`: number of dynamic bodies.
    pub(crate) fn overlap(&mut self, a: usize, b: usize, bodies: usize) {
        if a < bodies && b < bodies {
            if self.members.is_empty() {
                self.members.resize(bodies, Member::default());
            }
            self.members[a].overlaps += 1;
            self.members[b].overlaps += 1;
        }
    }

    /// Records that two bodies touch or may touch; the first `movers` have velocities. Called after all
    /// overlaps.
    pub(crate) fn touch(&mut self, a: usize, b: usize, velocity: &[Record], movers: usize) {
        let crowded = |body: usize| self.members.get(body).is_some_and(|member| member.overlaps > 0);
        if crowded(a) || crowded(b) {
            let speed = |body: usize| if body < movers { velocity[body].linear.length() } else { 0.0 };
            self.fastest = self.fastest.max(speed(a)).max(speed(b));
        }
    }

    /// Excludes the bodies for which `skip` returns true.
    pub(crate) fn leave_out(&mut self, skip: impl Fn(usize) -> bool) {
        for (body, member) in self.members.iter_mut().enumerate() {
            if member.overlaps > 0 && skip(body) {
                member.overlaps = 0;
            }
        }
    }

    /// Finds the greatest speeds of a substep; `base`: velocities before any row acted.
    pub(crate) fn set_limits(&mut self, base: &[Record], push_speed: f32) {
        let bound = (CROWD_PUSH * push_speed).max(self.fastest);
        for (member, base) in self.members.iter_mut().zip(base) {
            member.most = bound.max(base.linear.length());
        }
    }

    /// Limits velocities. Those before any row acted are changed too: warm starting must not repeat the
    /// change by the limit, which would push bodies in each further substep.
    pub(crate) fn calm(&self, velocity: &mut [Record], base: &mut [Record]) {
        let several = if self.incomplete { 1 } else { SEVERAL };
        for (i, &Member { overlaps, most }) in self.members.iter().enumerate() {
            let now = velocity[i].linear;
            let speed = now.length();
            if overlaps >= several && speed > most {
                velocity[i].linear *= most / speed;
                base[i].linear += velocity[i].linear - now;
            }
        }
    }
}
