//! Continuous collision: nothing gets through, and no body is pushed by one that it never touches.

mod bullets;
mod envelope;
mod ghosts;
mod methods;
mod modes;
mod passing;
mod tunnelling;
mod wedging;
