//! Impacts with friction, and those at the end of a motion.

pub(super) mod eccentric;
pub(super) mod rocking;
pub(super) mod superball;
