//! How bodies move: contacts, friction, restitution, rest, rotation, continuous collision.

#[path = "../common/mod.rs"]
mod common;

mod bullets;
mod elastic;
mod envelope;
mod extremes;
mod friction;
mod ghosts;
mod impact;
mod methods;
mod modes;
mod order;
mod overlap;
mod passing;
mod rest;
mod restitution;
mod rotation;
mod sliding;
mod stability;
mod tower;
mod tunnelling;
mod wedging;
