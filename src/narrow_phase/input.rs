//! Input of the narrow phase of a step, and the approach of pairs within it.

use super::contacts::contact::{MatchLimits, NO_CONTACT};
use super::contacts::manifold::most_points;
use super::contacts::weight::Scale;
use crate::body::{Odometer, Pose, out_of_reach, reading};
use crate::broad_phase::Pair;
use crate::config::{ContinuousMode, Start};
use crate::lanes::Record;
use crate::shape::{Collider, ColliderSummary};

/// Input of the narrow phase.
pub(crate) struct Input<'a> {
    pub(crate) colliders: &'a [Collider],
    pub(crate) summaries: &'a [ColliderSummary],
    /// World pose of each collider at the start of the step.
    pub(crate) poses: &'a [Pose],
    /// See [`Colliders`](crate::body::Colliders).
    pub(crate) swings: &'a [f32],
    pub(crate) odometers: &'a [Odometer],
    /// Predicted displacement [m] and rotation vector [rad] of each body that can move, within the step.
    pub(crate) motion: &'a [Record],
    /// Displacement that gravity adds to a dynamic body within the step [m].
    pub(crate) fall: glam::Vec3,
    /// Bodies before this one are dynamic.
    pub(crate) dynamic: usize,
    /// Points nearer than this are always found [m].
    pub(crate) margin: f32,
    /// A separation up to this is a real contact [m].
    pub(crate) touch_distance: f32,
    /// The length unit [m].
    pub(crate) unit: f32,
    /// Relative motion in a step above which a pair that is apart counts as fast [m].
    pub(crate) fast: f32,
    /// How far a pair may move before its contact is computed anew [m]; negative: always.
    pub(crate) recycle: f32,
    /// The world's; a pair's is in [`Approach::mode`].
    pub(crate) mode: ContinuousMode,
    pub(crate) start: Start,
    /// Weights of contacts, for when there is not enough memory for all.
    pub(crate) scale: Scale<'a>,
    /// Whether a body has joints.
    pub(crate) has_joints: &'a (dyn Fn(u32) -> bool + Sync),
}

impl Input<'_> {
    /// The shapes of a pair.
    #[inline]
    pub(super) fn shapes(&self, pair: &Pair) -> (&Collider, &Collider) {
        (&self.colliders[pair.a as usize], &self.colliders[pair.b as usize])
    }

    /// Whether a collider is on a dynamic body.
    #[inline]
    pub(super) fn is_pushed(&self, collider: u32) -> bool {
        (self.summaries[collider as usize].body as usize) < self.dynamic
    }

    /// Displacement and rotation vector of a collider's body within the step.
    pub(crate) fn motion_of(&self, collider: u32) -> Record {
        let body = self.summaries[collider as usize].body as usize;
        self.motion.get(body).copied().unwrap_or_default()
    }

    /// The furthest that a collider's rotation moves its points within the step [m].
    fn swing_of(&self, collider: u32) -> f32 {
        let body = self.summaries[collider as usize].body as usize;
        if body < self.motion.len() { self.swings[collider as usize] } else { 0.0 }
    }

    /// Whether only one body of a pair can be pushed. Such contacts are shed last if memory runs out.
    pub(crate) fn is_static(&self, pair: &Pair) -> bool {
        !(self.is_pushed(pair.a) && self.is_pushed(pair.b))
    }

    /// For how many points a contact of a pair gets place, at least. Under a budget that is for as many as it
    /// may have later: admitted contacts hardly ever ask for memory again.
    pub(crate) fn room(&self, pair: &Pair, bounded: bool) -> usize {
        let kind = |c: u32| self.summaries[c as usize].kind;
        if bounded { most_points(kind(pair.a), kind(pair.b)) } else { 0 }
    }

    /// Whether a pair only reports overlaps with a sensor.
    pub(super) fn is_sensor(&self, pair: &Pair) -> bool {
        [pair.a, pair.b].iter().any(|&c| self.summaries[c as usize].is_sensor())
    }

    /// How a pair may approach within the step.
    pub(crate) fn approach(&self, pair: &Pair) -> Approach {
        let (a, b) = (self.motion_of(pair.a), self.motion_of(pair.b));
        let displacement = b.linear - a.linear;
        let own = |c: u32| self.summaries[c as usize].mode;
        let mode = self.mode.of(own(pair.a).max(own(pair.b)));
        Approach {
            displacement,
            length: displacement.length(),
            swing: self.swing_of(pair.a) + self.swing_of(pair.b),
            mode,
        }
    }

    /// Whether a pair without a contact surely gets none, by distances known from earlier steps.
    #[inline(always)]
    pub(super) fn is_known_apart(&self, pair: &Pair) -> bool {
        let odometer = |c: u32| self.odometers[c as usize];
        pair.contact == NO_CONTACT
            && !pair.fast
            && out_of_reach(odometer(pair.a), odometer(pair.b), pair.apart)
    }

    /// Notes that the shapes of a pair without a contact are at least so far apart [m].
    #[inline(always)]
    pub(super) fn note_apart(&self, pair: &mut Pair, gap: f32) {
        let odometer = |c: u32| self.odometers[c as usize];
        let spare = (gap - self.margin) / self.unit;
        pair.apart = reading(odometer(pair.a), odometer(pair.b), spare);
    }

    /// Limits within which the points of a pair's contact last.
    pub(crate) fn match_limits(&self, pair: &Pair) -> MatchLimits {
        let radius = |c: u32| self.summaries[c as usize].radius;
        let near = 0.1 * radius(pair.a).min(radius(pair.b));
        // A creeping pair is found anew once it has moved by `recycle`, and before it has moved by twice
        // that.
        let slides = if self.recycle > 0.0 { near.min(2.0 * self.recycle) } else { near };
        MatchLimits { near, slides }
    }
}

/// How two shapes may approach each other within the step.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Approach {
    /// Predicted displacement of `b`'s body relative to `a`'s, in the world [m].
    pub(crate) displacement: glam::Vec3,
    pub(crate) length: f32,
    /// The furthest that rotation moves points of the two towards each other [m].
    pub(crate) swing: f32,
    /// Mode of the pair: `Discrete` is never cast, `Volume` also keeps contacts that the path misses.
    pub(crate) mode: ContinuousMode,
}

impl Approach {
    pub(crate) fn is_continuous(&self) -> bool {
        self.mode != ContinuousMode::Discrete
    }

    /// How far beyond the margin points are found: as far as the two may approach, without casts no further
    /// than the margin again [m].
    #[inline(always)]
    pub(super) fn reach(&self, margin: f32) -> f32 {
        let most = self.max_closing();
        if self.is_continuous() { most } else { most.min(margin) }
    }

    /// The most that the distance of two points may shrink by [m].
    pub(crate) fn max_closing(&self) -> f32 {
        self.length + self.swing
    }
}
