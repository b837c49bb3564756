//! Reflection: all components and messages in the app's type registry.

use crate::*;
use bevy_app::App;

macro_rules! register {
    ($app:ident: $($name:ident),*) => {
        $($app.register_type::<$name>();)*
    };
}

/// Components that hold a type of the engine are opaque, with serde; all others show their fields.
pub(crate) fn register(app: &mut App) {
    register!(app: BodyDisabled, ConstantForce, Continuous, Damping, GravityScale, LockedAxes, Mass);
    register!(app: MaxSpeeds, NeverSleeps, NoInterpolation, PhysicsPose, RigidBody, Sleeping);
    register!(app: SolvedAfter, Velocity);
    register!(app: ContactHooked, ContactMessages, Density, Joint, SensesStatic, Sensor, Shape);
    register!(app: ShapeFilter, ShapeMaterial);
    register!(app: Character, CharacterGround, CharacterInput, CharacterState, CharacterTouch);
    register!(app: BodyFellAsleep, BodyWoke, Contact, ContactBegan, ContactEnded, ContactHit, Crossing);
    register!(app: Coupling, CouplingBroke, JointBroke, JointStrained, SensorEntered, SensorLeft);
}
