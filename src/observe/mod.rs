//! The inside of a step, to measure and compare it: the lab's access to the engine. Only [`Solved`] and
//! [`StateLayout::displace`] change something.
//!
//! - [`System`]: the rows of a step as one system, with laws and impulses.
//! - [`Observer`]: looks on while a world steps; it may put other impulses in the place of those that rows
//!   got ([`Solved`]).
//! - [`StateLayout`]: the state of a world at rest as numbers, to be displaced.
//! - [`BodyState`]: mass, inertia and motion of a body, as the solver has them.
//! - [`kept_points`]: which points of a contact the engine keeps.
//! - [`paths`]: where bodies went in the last step, and whether they got through something.
//!
//! A game has no use for any of it. Without the feature `observe` there is no code for it; with it, but
//! without an observer, a step has one more predictable branch.

mod body;
mod law;
pub mod paths;
mod reduction;
mod state;
mod system;
mod watch;

pub use body::BodyState;
pub use law::Law;
pub use reduction::kept_points;
pub use state::{BODY_VARIABLES, StateLayout};
pub use system::{
    JointRow, Owner, SIDES, System, SystemBody, SystemIsland, SystemLaw, SystemRow, Velocity, joint_rows,
    of_two,
};
pub use watch::{Observer, Solved};
