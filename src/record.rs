//! What a call or a stage says to a recording. Without the feature `replay` it is no code at all; with it, and no recording,
//! one branch that is always the same.

/// Notes a call, before it changes anything and when nothing can refuse it any more: `record!(self, Wake(body))`. Shapes need
/// the recording, which writes shared geometry once: `record!(self, |tape| AddBody(tape.body(desc)))`.
macro_rules! record {
    ($world:ident, $call:ident ($($argument:expr),*)) => {{
        #[cfg(feature = "replay")]
        if $world.tape.is_some() {
            $world.note(|_| crate::replay::Call::$call($($argument),*));
        }
    }};
    ($world:ident, |$tape:ident| $call:ident ($($argument:expr),*)) => {{
        #[cfg(feature = "replay")]
        if $world.tape.is_some() {
            $world.note(|$tape| crate::replay::Call::$call($($argument),*));
        }
    }};
}

/// Has what a stage of the step made hashed, if it is recorded or replayed.
macro_rules! probe {
    ($world:ident, $stage:ident) => {{
        #[cfg(feature = "replay")]
        if $world.tape.is_some() {
            $world.probe(crate::replay::Stage::$stage);
        }
    }};
}

pub(crate) use {probe, record};
