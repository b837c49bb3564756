//! The C interface of backstop, 3D rigid-body physics for game runtimes.
//!
//! `include/backstop.h` is made from this crate, comments included; README.md says how to build and link it.
//! From Rust use the crate `backstop`.
//!
//! - Worlds, snapshots and characters are opaque and locked: a call that comes beside another which it must
//!   not is refused with `BS_ERROR_BUSY`.
//! - Handles are 8 bytes, by value. Hulls, meshes and height fields are counted references.
//! - Descriptions begin with their size: a shorter one means defaults for the rest, so that later versions
//!   can add to them. Fields follow each other without gaps. All other structs stay as they are.
//! - Flags are bytes, and what may be one of several constants is an integer: no bytes of a caller are
//!   undefined behaviour.
//! - Every function goes through `abi/guard.rs`, which turns errors and panics into a status.
//!
//! What the engine adds is added here: a field at the end of a description, an arm in
//! `abi/status.rs`, a function in the file of its subject.

#![allow(
    clippy::missing_safety_doc,
    reason = "one rule for all: pointers are what the header says, and objects are alive"
)]

mod abi;
mod asset;
mod body;
mod character;
mod draw;
mod events;
mod joint;
mod mass;
mod query;
mod ragdoll;
mod report;
mod settings;
mod shape;
mod snapshot;
mod world;

pub use abi::status::*;
pub use abi::values::*;
pub use asset::*;
pub use body::*;
pub use character::*;
pub use draw::*;
pub use events::*;
pub use joint::*;
pub use mass::*;
pub use query::*;
pub use ragdoll::*;
pub use report::*;
pub use settings::*;
pub use shape::*;
pub use snapshot::*;
pub use world::*;

use std::ffi::c_char;

/// Version of the interface: it grows with each release that changes it.
pub const BS_ABI_VERSION: u32 = 2;

/// The interface's version of this library; a program that was built with a later header than the library
/// finds a smaller number than its `BS_ABI_VERSION`.
#[unsafe(no_mangle)]
pub extern "C" fn bs_abi_version() -> u32 {
    BS_ABI_VERSION
}

/// The version of the package, as `0.1.0`. Valid for ever.
#[unsafe(no_mangle)]
pub extern "C" fn bs_version() -> *const c_char {
    concat!(env!("CARGO_PKG_VERSION"), "\0").as_ptr().cast()
}
