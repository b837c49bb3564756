//! Continuous collision: nothing gets through, and nothing is pushed by what it never touches.

mod bullets;
mod envelope;
mod ghosts;
mod methods;
mod modes;
mod passing;
mod tunnelling;
mod wedging;
