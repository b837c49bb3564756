//! Contacts: manifolds that last, how new ones get a slot, and which are shed where memory is short.

pub(crate) mod admit;
pub(crate) mod contact;
pub(crate) mod found;
pub(crate) mod manifold;
pub(crate) mod of_meshes;
mod places;
pub(crate) mod store;
mod way;
pub(crate) mod weight;
