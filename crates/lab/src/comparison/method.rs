//! The methods that are compared.

use backstop::{Continuous, ContinuousMethod};

/// A method as a world's settings choose it.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Method {
    /// Its name in tables.
    pub name: &'static str,
    /// [`backstop::Settings::continuous`].
    pub continuous: Continuous,
    /// [`backstop::Settings::method`].
    pub method: ContinuousMethod,
}

/// What is compared, in the order of every result; the last is the reference of the others.
pub const METHODS: [Method; 7] = {
    use ContinuousMethod::{ConservativeAdvancement, LinearCast, OnePass, Speculative, Talk};
    const fn method(name: &'static str, continuous: Continuous, method: ContinuousMethod) -> Method {
        Method { name, continuous, method }
    }
    [
        method("discrete", Continuous::Discrete, OnePass),
        method("linear-cast", Continuous::Segment, LinearCast),
        method("speculative", Continuous::Segment, Speculative),
        method("talk-method", Continuous::Segment, Talk),
        method("segment", Continuous::Segment, OnePass),
        method("volume", Continuous::Volume, OnePass),
        method("conservative-advancement", Continuous::Segment, ConservativeAdvancement),
    ]
};

/// Index of the reference in [`METHODS`].
pub const REFERENCE: usize = METHODS.len() - 1;
