//! What every function of the interface uses: codes, the guard at the border, pointers, descriptions that
//! may grow, and plain values.

pub(crate) mod guard;
pub(crate) mod lock;
pub(crate) mod pointers;
pub(crate) mod sized;
pub(crate) mod status;
pub(crate) mod twin;
pub(crate) mod values;
