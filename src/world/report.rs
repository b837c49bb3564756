//! Reports of steps.

use crate::broad_phase::BroadStats;
use crate::config::fields;
use crate::constraint::Prepared;
use crate::finish::Counts;
use crate::narrow_phase::NarrowStats;
use crate::time_of_impact::Impacts;

/// Times of the stages [us].
#[derive(Clone, Copy, Debug, Default, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct StageTimes {
    /// The whole step.
    pub step: f32,
    /// Forces, bounds, pairs.
    pub broad: f32,
    /// Manifolds.
    pub narrow: f32,
    /// Restitution; sorting, colouring and packing of rows.
    pub prepare: f32,
    /// Substeps.
    pub solve: f32,
    /// Poses, guard.
    pub finish: f32,
}

fields! {
    /// Counts and times of a step.
    #[derive(Clone, Copy, Debug, Default, PartialEq)]
    #[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
    #[non_exhaustive]
    pub struct StepReport {
        /// Times of the stages.
        pub times: StageTimes,
        /// Pairs that the broad phase keeps.
        pub pairs: u32,
        /// Movers whose box in the tree was renewed.
        pub moved: u32,
        /// Movers that were swept along their path.
        pub swept: u32,
        /// Manifolds with at least one point.
        pub manifolds: u32,
        /// Points that touch.
        pub real: u32,
        /// Points that may touch within the step.
        pub potential: u32,
        /// Potential manifolds that had to push.
        pub pushed: u32,
        /// Potential manifolds that pushed in the previous step without closing their gap: the body was
        /// pushed by something that it never touched.
        pub ghosts: u32,
        /// Pairs that kept their manifold without a new narrow phase.
        pub recycled: u32,
        /// Fast pairs whose first touch within the step was searched for.
        pub casts: u32,
        /// Points that bounced.
        pub impacts: u32,
        /// Batches of eight manifolds.
        pub batches: u32,
        /// Contacts that found no colour.
        pub uncoloured: u32,
        /// Bodies whose path the guard cut: a centre, or the end of a limb, would have crossed something.
        pub cut: u32,
        /// Bodies that crossed nothing, and that the guard lifted off a surface because they ended too close
        /// to it.
        pub lifted: u32,
        /// Bodies that rows pushed off their predicted path, and that would have entered or overlapped static
        /// geometry: they were led along it, and ended outside of it.
        pub settled: u32,
        /// Trees of joints in which a body counts as heavier than it is, because something more than 20,000
        /// times as heavy is attached to it, or because hinges and welds turn more than 1,000 times its
        /// moment of inertia with it: with its own mass the exact solution would lose its digits.
        pub weighted_trees: u32,
        /// Trees of joints that whip, because a body bears several times its mass: no velocities at the start
        /// of a substep leave them closed at its end, or only velocities that gain energy. They were closed
        /// all the same, and lost some energy. Also nets of joints that turn faster than a substep can
        /// follow, if they lost energy that their rows would have added.
        pub damped_trees: u32,
        /// Bodies whose new position or velocity was not finite, or beyond
        /// [`MAX_POSITION`](crate::limits::MAX_POSITION) or twice [`MAX_SPEED`](crate::limits::MAX_SPEED).
        /// They stay where they were, at rest, and the others move as if those had not moved at all: the
        /// result of a step is always finite. A count above zero means that forces, speeds or joints ask for
        /// the impossible; [`World::faulted_bodies`] lists their handles.
        pub faulted: u32,
        /// Impacts that were solved one by one at their times, by methods that do so
        /// ([`ContinuousMethod`](crate::ContinuousMethod)).
        pub struck: u32,
        /// Bodies that lost the rest of the step after too many of those.
        pub stood: u32,
        /// Bodies that are asleep.
        pub asleep: u32,
        /// Bodies that fell asleep in the step, or since the one before.
        pub slept: u32,
        /// Bodies that woke in the step, or since the one before.
        pub woke: u32,
        /// Number of events beyond the capacity.
        pub events_lost: u32,
        /// Points of contacts, and pairs with an unknown number of points, that were left out because memory
        /// was not allowed to grow.
        pub shed: u32,
    }
}

/// Counts of the stages of a step.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct StepCounts {
    pub(crate) broad: BroadStats,
    /// Contacts that pushed in the last step, and whose pairs ended.
    pub(crate) ghosts: u32,
    pub(crate) narrow: NarrowStats,
    pub(crate) prepared: Prepared,
    /// Contacts that pushed before they touched.
    pub(crate) pushed: u32,
    pub(crate) held: Counts,
    /// Impacts that were solved one by one.
    pub(crate) met: Impacts,
}

impl StepCounts {
    /// Adds the counts of a search for pairs.
    pub(crate) fn add_broad(&mut self, two: BroadStats) {
        let one = self.broad;
        self.broad = BroadStats {
            moved: one.moved + two.moved,
            added: one.added + two.added,
            removed: one.removed + two.removed,
            built: one.built + two.built,
            ..two
        };
    }

    /// Pairs and points beyond the allowance, up to the making of rows.
    pub(crate) fn shed(&self) -> u32 {
        self.broad.shed + self.narrow.shed + self.prepared.shed
    }

    /// Number of bodies that are faster than their boxes allow for. If pairs were shed, having no pair does
    /// not prove that the path is clear: then 0.
    pub(crate) fn fast(&self) -> u32 {
        if self.broad.shed > 0 { 0 } else { self.broad.fast }
    }
}

impl StepReport {
    /// Bodies that the guard held, by cut or lift.
    pub fn held(&self) -> u32 {
        self.cut + self.lifted
    }
}
