//! The stages of a step, and their parts that only some worlds need.

/// A stage of a step.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Stage {
    Broad,
    Narrow,
    /// Its time counts as part of [`Stage::Narrow`].
    Hooks,
    Prepare,
    Solve,
    Finish,
}

/// A part of a stage that only some worlds need, and that is timed separately.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Part {
    Restitution,
    Joints,
    Sleeping,
    Events,
    Sensors,
    Hooks,
}

/// Times of parts in the last step [us]; zero for parts that were not needed.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct PartTimes {
    pub(crate) restitution: f32,
    pub(crate) joints: f32,
    pub(crate) sleeping: f32,
    pub(crate) events: f32,
    pub(crate) sensors: f32,
    pub(crate) hooks: f32,
}
