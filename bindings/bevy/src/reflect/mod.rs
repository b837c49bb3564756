//! Reflection: all components and messages in the app's type registry.

mod fields;
mod variants;

use crate::*;
use bevy_app::App;
use bevy_reflect::std_traits::ReflectDefault;

macro_rules! register {
    ($app:ident: $($name:ident),*) => {
        $($app.register_type::<$name>();)*
    };
}

/// All that can be shown as fields is. Scenes have what holds a type of the engine by serde.
pub(crate) fn register(app: &mut App) {
    register!(app: BodyDisabled, ConstantForce, Continuous, Damping, GravityScale, LockedAxes, Mass);
    register!(app: MaxSpeeds, NeverSleeps, NoInterpolation, PhysicsPose, RigidBody, Sleeping);
    register!(app: SolvedAfter, Velocity);
    register!(app: ContactHooked, ContactMessages, Density, Joint, SensesStatic, Sensor, Shape);
    register!(app: Extrapolation, ShapeFilter, ShapeMaterial, ShapeOffset);
    app.register_type::<Character>().register_type_data::<Character, ReflectDefault>();
    register!(app: CharacterGround, CharacterInput, CharacterState, CharacterTouch);
    register!(app: BodyFellAsleep, BodyWoke, Contact, ContactBegan, ContactEnded, ContactHit, Crossing);
    register!(app: Coupling, CouplingBroke, JointBroke, JointStrained, SensorEntered, SensorLeft);
}
