//! Iterations that project: each improves the impulses and projects them onto those that their laws allow.

mod admm;
mod apgd;
mod gs_cone;
mod jacobi;
mod nncg;
mod pgs;
mod prox;
mod psor;
mod sweep;

pub use admm::admm;
pub use apgd::apgd;
pub use gs_cone::gs_cone;
pub use jacobi::jacobi;
pub use nncg::nncg;
pub use pgs::pgs;
pub use prox::prox;
pub use psor::psor;
