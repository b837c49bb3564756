//! Poses that kinematic bodies are to reach.

use super::Bodies;
use crate::lanes::Record;
use crate::math::Quat;
use glam::DVec3;

/// Where the origin of a kinematic body is to be at the end of the next step, if that takes `dt` seconds.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Target {
    pub(crate) position: DVec3,
    pub(crate) rotation: Quat,
    pub(crate) dt: f32,
    pub(crate) after: AfterTarget,
}

/// Motion of a kinematic body after the step in which it was to reach a pose.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[repr(u32)]
pub(crate) enum AfterTarget {
    MoveOn,
    Stop,
    /// That step is over: the next one takes its velocity away.
    Stops,
}

impl AfterTarget {
    pub(crate) const ALL: [AfterTarget; 3] = [AfterTarget::MoveOn, AfterTarget::Stop, AfterTarget::Stops];
}

impl Bodies {
    /// Begins a step: bodies that reached a pose in the last one, and were to stop there, do.
    pub(crate) fn stop_at_targets(&mut self) {
        let Bodies { rare, slots, velocity, .. } = self;
        rare.targets.retain(|slot, target| {
            let stops = target.after == AfterTarget::Stops;
            if stops {
                velocity[slots.dense(slot) as usize] = Record::default();
            }
            !stops
        });
    }

    /// Ends a step: poses that bodies were to reach in it are theirs, or no longer.
    pub(crate) fn end_targets(&mut self) {
        self.rare.targets.retain(|_, target| {
            let stop = target.after == AfterTarget::Stop;
            target.after = AfterTarget::Stops;
            stop
        });
    }
}
