//! What a step did.

use super::World;
use crate::broad_phase::BroadStats;
use crate::constraint::Prepared;
use crate::finish::Counts;
use crate::narrow_phase::NarrowStats;
use crate::time_of_impact::Impacts;

/// How long the stages took [us].
#[derive(Clone, Copy, Debug, Default, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct StageTimes {
    /// The whole step.
    pub step: f32,
    /// Forces, bounds, pairs.
    pub broad: f32,
    /// Manifolds.
    pub narrow: f32,
    /// Restitution; rows sorted, coloured and packed.
    pub prepare: f32,
    /// Substeps.
    pub solve: f32,
    /// Poses, guard.
    pub finish: f32,
}

/// Counts and times of a step.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[non_exhaustive]
pub struct StepReport {
    /// How long the stages took.
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
    /// Pushes of the step before whose gap was not closed: pushed by what was never touched.
    pub ghosts: u32,
    /// Pairs that kept their manifold without a new narrow phase.
    pub recycled: u32,
    /// Fast pairs whose first touch within the step was looked for.
    pub casts: u32,
    /// Points that bounced.
    pub impacts: u32,
    /// Batches of eight manifolds.
    pub batches: u32,
    /// Contacts that found no colour.
    pub uncoloured: u32,
    /// Bodies whose path the guard cut: a centre, or the end of a limb, would have crossed something.
    pub cut: u32,
    /// Bodies that crossed nothing, and that the guard lifted off a surface because they ended too close to it.
    pub lifted: u32,
    /// Bodies that rows threw off their predicted way and that would have entered or overlapped something static: they went on
    /// along it, and ended outside of it.
    pub settled: u32,
    /// Trees of joints in which a body counts as heavier than it is, because something hangs on it that is more than 20,000
    /// times as heavy: with its own mass nothing would be left of the digits that the exact solution needs.
    pub weighted_trees: u32,
    /// Trees of joints that whip, because a body bears several times its mass: there are no velocities at the start of a substep
    /// that leave them closed at its end, or only such that gain energy. They were closed all the same, and lost some. And nets of
    /// joints that turn faster than a substep follows, in so far as they lost energy that their rows would have added.
    pub damped_trees: u32,
    /// Bodies whose new place or velocity was no number or beyond [`MAX_POSITION`](crate::limits::MAX_POSITION) or twice
    /// [`MAX_SPEED`](crate::limits::MAX_SPEED). They stay where they were, at rest, and the others go on as if they had stood
    /// still all along: whatever a step returns, what it leaves is finite. More than none says that forces, speeds or joints
    /// ask for the impossible; [`World::stopped_bodies`] has their handles.
    pub stopped: u32,
    /// Impacts that were met one by one at their times, by methods that do so
    /// ([`ContinuousMethod`](crate::ContinuousMethod)).
    pub struck: u32,
    /// Bodies that lost what was left of the step after too many of those.
    pub stood: u32,
    /// Bodies that are asleep.
    pub asleep: u32,
    /// Bodies that fell asleep in the step, or since the one before.
    pub slept: u32,
    /// Bodies that woke in the step, or since the one before.
    pub woke: u32,
    /// Events that there was no place for.
    pub events_lost: u32,
    /// What was left out because memory was not allowed to grow: points of contacts, and pairs, of which it is not known
    /// how many points they have.
    pub shed: u32,
}

/// What the stages of a step counted.
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
    /// Impacts that were met one by one.
    pub(crate) met: Impacts,
}

impl StepCounts {
    /// Adds a look for pairs.
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

    /// Pairs and points that there was no room for, until rows were made.
    pub(crate) fn shed(&self) -> u32 {
        self.broad.shed + self.narrow.shed + self.prepared.shed
    }

    /// How many bodies outran their boxes. If pairs were shed, having no pair does not prove that the path is clear: then 0.
    pub(crate) fn fast(&self) -> u32 {
        if self.broad.shed > 0 { 0 } else { self.broad.fast }
    }
}

impl StepReport {
    /// Bodies that the guard held, in either way.
    pub fn held(&self) -> u32 {
        self.cut + self.lifted
    }

    pub(crate) fn new(world: &World, times: StageTimes, did: &StepCounts) -> StepReport {
        let StepCounts { broad, narrow, prepared, held, met, .. } = did;
        StepReport {
            times,
            pairs: world.broad.pairs.len() as u32,
            moved: broad.moved,
            swept: broad.fast,
            ghosts: narrow.ghosts + did.ghosts,
            recycled: narrow.recycled,
            casts: narrow.casts,
            impacts: prepared.impacts,
            manifolds: prepared.manifolds,
            real: prepared.real,
            potential: prepared.potential,
            pushed: did.pushed,
            cut: held.cut,
            lifted: held.lifted,
            settled: held.settled,
            weighted_trees: world.buffers.joints.weighted_trees(),
            damped_trees: world.buffers.joints.damped_trees(),
            stopped: world.faults.stopped.len() as u32,
            struck: met.struck,
            stood: met.stood,
            shed: did.shed() + met.shed,
            asleep: world.bodies.sleepers() as u32,
            slept: world.sleep.slept,
            woke: world.sleep.woke,
            events_lost: world.events.lost,
            uncoloured: world.buffers.rows.uncoloured() as u32,
            batches: world.buffers.rows.schedule.len() as u32,
        }
    }
}
