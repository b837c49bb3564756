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

/// Time of each part in the last step [us]; zero for parts that were not needed.
pub(crate) type PartTimes = [f32; Part::Hooks as usize + 1];
