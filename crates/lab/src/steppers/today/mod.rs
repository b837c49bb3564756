//! Methods of today's engines, a file each.

mod convex;
mod mass_splitting;
mod mujoco;
mod points;
mod posed;
mod relax;
mod sap;
#[cfg(test)]
mod tests;
mod tgs;

pub use mass_splitting::mass_splitting;
pub use mujoco::mujoco;
pub use sap::sap;
pub use tgs::temporal_gauss_seidel;
