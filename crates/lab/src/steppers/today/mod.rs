//! Methods of today's engines, a file each.

mod avbd;
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
mod xpbd;

pub use avbd::avbd;
pub use mass_splitting::mass_splitting;
pub use mujoco::mujoco;
pub use sap::sap;
pub use tgs::temporal_gauss_seidel;
pub use xpbd::xpbd;
