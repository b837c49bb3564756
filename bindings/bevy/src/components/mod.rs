//! What entities say: components of bodies, shapes, joints, couplings and characters.

pub(crate) mod body;
pub(crate) mod character;
pub(crate) mod coupling;
pub(crate) mod joint;
pub(crate) mod shape;
