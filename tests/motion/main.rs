//! How bodies move: contacts, friction, restitution, rest, rotation, continuous collision.

#[path = "../common/mod.rs"]
mod common;

mod contact;
mod continuous;
mod damping;
mod ground;
mod kinematic;
mod rotation;
mod seams;
mod speed_caps;
mod standing;
