//! The methods that are compared.

use backstop::{ContinuousMethod, ContinuousMode};

/// A method as a world's settings choose it.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Method {
    /// Its name in tables.
    pub name: &'static str,
    /// [`backstop::Settings::continuous`].
    pub continuous: ContinuousMode,
    /// [`backstop::Settings::method`].
    pub method: ContinuousMethod,
}

/// The compared methods, in the order of every result; the last is the reference of the others.
pub const METHODS: [Method; 7] = {
    use ContinuousMethod::{ConservativeAdvancement, LinearCast, OnePass, Speculative, Talk};
    const fn method(name: &'static str, continuous: ContinuousMode, method: ContinuousMethod) -> Method {
        Method { name, continuous, method }
    }
    [
        method("discrete", ContinuousMode::Discrete, OnePass),
        method("linear-cast", ContinuousMode::Segment, LinearCast),
        method("speculative", ContinuousMode::Segment, Speculative),
        method("talk-method", ContinuousMode::Segment, Talk),
        method("segment", ContinuousMode::Segment, OnePass),
        method("volume", ContinuousMode::Volume, OnePass),
        method("conservative-advancement", ContinuousMode::Segment, ConservativeAdvancement),
    ]
};

/// Index of the reference in [`METHODS`].
pub const REFERENCE: usize = METHODS.len() - 1;
