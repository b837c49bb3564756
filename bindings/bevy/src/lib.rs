#![doc = include_str!("../README.md")]

mod components;
#[cfg(feature = "mesh")]
mod constructor;
mod convert;
#[cfg(feature = "diagnostics")]
mod diagnostics;
#[cfg(feature = "gizmos")]
mod gizmos;
mod hooks;
mod messages;
mod observers;
#[cfg(feature = "picking")]
mod picking;
mod plugin;
mod poses;
mod prepare;
#[cfg(feature = "reflect")]
mod reflect;
mod report;
mod walk;
mod world;

pub use backstop;
pub use components::body::{
    BodyDisabled, ConstantForce, Continuous, Damping, Extrapolation, GravityScale, LockedAxes, Mass,
    MaxSpeeds, NeverSleeps, NoInterpolation, PhysicsPose, RigidBody, Sleeping, SolvedAfter, Velocity,
};
pub use components::character::{Character, CharacterGround, CharacterInput, CharacterState, CharacterTouch};
pub use components::coupling::Coupling;
pub use components::joint::Joint;
pub use components::shape::{
    ContactHooked, ContactMessages, Density, SensesStatic, Sensor, Shape, ShapeFilter, ShapeMaterial,
    ShapeOffset,
};
#[cfg(feature = "mesh")]
pub use constructor::{BackstopMeshPlugin, ShapeConstructor, ShapeConstructorHierarchy};
pub use convert::{ToBevy, ToEngine};
#[cfg(feature = "diagnostics")]
pub use diagnostics::BackstopDiagnosticsPlugin;
#[cfg(feature = "overlay")]
pub use diagnostics::{BackstopOverlayPlugin, PhysicsOverlay};
#[cfg(feature = "gizmos")]
pub use gizmos::{BackstopGizmosPlugin, PhysicsGizmos};
pub use hooks::{CollisionHooks, HookedContact};
pub use messages::{
    BodyFellAsleep, BodyWoke, Contact, ContactBegan, ContactEnded, ContactHit, CouplingBroke, Crossing,
    JointBroke, JointStrained, PhysicsError, Problem, SensorEntered, SensorLeft,
};
pub use observers::{CollisionEnd, CollisionStart, SensorEnd, SensorStart};
#[cfg(feature = "picking")]
pub use picking::{BackstopPickingPlugin, PhysicsPicking, PhysicsPickingCamera};
pub use plugin::{BackstopPlugin, PhysicsSystems};
pub use world::{PhysicsHooks, PhysicsWorld};

/// All that a game needs of the plugin, with what the engine calls the parts of a [`Joint`]; what its other
/// calls take is in [`backstop`]. Bevy's prelude has an `Axis` too, of gamepads: name the one that you mean.
pub mod prelude {
    pub use crate::*;
    pub use ::backstop::{Axes, Axis, Limit, Motion, Motor, Spring};
}
