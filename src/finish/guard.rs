//! The last line: the path of a body's centre never crosses static geometry.
//!
//! Potential points stop fast bodies, and do so well; but they are planes that the solver obeys as far as its iterations
//! and the other rows allow. What must never happen, a body on the wrong side of the world, is therefore checked on the
//! path that a body really takes: if the segment from its old centre to its new one enters static geometry, the motion
//! is cut there. A body that was on the right side thus stays there, step after step, whatever pushes it; and since its
//! centre is on the right side, contacts push the rest of it out. One segment query for each body that moved further
//! than the ball that fits into it; the report counts those that had to be held.

use crate::body::{Pose, Traits};
use crate::broad_phase::BroadPhase;
use crate::config::Continuous;
use crate::lanes::Record;
use crate::movers::mode_of;
use crate::query::segment_hits;
use crate::shape::Collider;
use glam::{DVec3, Vec3};

/// What the guard reads.
pub(crate) struct Guard<'a> {
    pub(crate) broad: &'a BroadPhase,
    pub(crate) colliders: &'a [Collider],
    pub(crate) poses: &'a [Pose],
    pub(crate) mode: Continuous,
}

/// Share of the inner ball that a centre keeps from a surface when it is held.
const KEEP: f32 = 0.25;
/// Share of the inner ball that a body may move without being looked at.
const FREE: f32 = 0.25;

impl Guard<'_> {
    /// Radius of a ball that fits into the body [m].
    fn inner(&self, own: &[u32]) -> f32 {
        own.iter().fold(0.0, |r, &c| r.max(self.colliders[c as usize].inner_radius))
    }

    /// Whether a body that moves so far must be looked at.
    pub(crate) fn wants(&self, traits: &Traits, own: &[u32], moved: f32) -> bool {
        !own.is_empty()
            && mode_of(self.mode, traits.continuous) != Continuous::Discrete
            && moved > FREE * self.inner(own)
    }

    /// Cuts the motion where the centre would enter static geometry; takes the velocity that leads there away. Says
    /// whether it had to.
    pub(crate) fn hold(
        &self,
        stack: &mut Vec<u32>,
        own: &[u32],
        from: DVec3,
        moved: &mut Vec3,
        velocity: &mut Record,
    ) -> bool {
        let keep = KEEP * self.inner(own);
        // A little further than the motion, so that the centre keeps its distance at the end too.
        let length = moved.length();
        let reach = *moved * (1.0 + keep / length);
        let start = from.as_vec3();
        let mut first: Option<(f32, Vec3)> = None;
        self.broad.statics_on_path(
            stack,
            start,
            (from + reach.as_dvec3()).as_vec3(),
            Vec3::splat(keep),
            |c| {
                let (collider, pose) = (&self.colliders[c as usize], &self.poses[c as usize]);
                if !own.iter().any(|&o| self.colliders[o as usize].filter.allows(&collider.filter)) {
                    return;
                }
                let back = pose.rotation.conjugate();
                let a = back * (from - pose.position).as_vec3();
                let b = a + back * reach;
                if let Some(hit) = segment_hits(collider, a, b)
                    && first.is_none_or(|(fraction, _)| hit.fraction < fraction)
                {
                    first = Some((hit.fraction, pose.rotation * hit.normal));
                }
            },
        );
        let Some((fraction, normal)) = first else { return false };
        // Back off so that the centre ends `keep` above the surface; never backwards.
        let into = -reach.dot(normal);
        let stop = if into > 0.0 { fraction - keep / into } else { fraction };
        let stop = stop.clamp(0.0, length / (length + keep));
        if stop * (length + keep) >= length {
            return false;
        }
        *moved = reach * stop;
        let speed = velocity.linear.dot(normal);
        if speed < 0.0 {
            velocity.linear -= normal * speed;
        }
        true
    }
}
