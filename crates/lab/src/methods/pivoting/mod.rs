//! Direct methods that pivot: each exchanges variables of a basis until every row obeys its law.
//!
//! Dantzig's, Keller's, Murty's and the block methods pivot on a [tableau](super::tableau) of `w = M x + q`;
//! Lemke's and the path search on a [`dictionary`] with a lexicographic rule.

pub(super) mod block_pivoting;
pub(super) mod certificate;
mod dantzig;
mod dictionary;
mod keller;
mod lemke;
mod murty;
mod path;
mod principal;

pub use block_pivoting::block_pivoting;
pub use dantzig::dantzig;
pub use keller::keller;
pub use lemke::lemke;
pub use murty::murty;
pub use path::path;
