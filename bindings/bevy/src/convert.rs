//! Bevy and the engine have different versions of glam: vectors and quaternions cross as arrays.

use backstop::glam;
use bevy_math::{DVec3, Quat, Vec3};

/// As the engine has it.
pub trait ToEngine {
    /// The engine's type.
    type Engine;
    /// The same numbers in the engine's type.
    fn to_engine(self) -> Self::Engine;
}

/// As Bevy has it.
pub trait ToBevy {
    /// Bevy's type.
    type Bevy;
    /// The same numbers in Bevy's type.
    fn to_bevy(self) -> Self::Bevy;
}

macro_rules! same_numbers {
    ($($name:ident),*) => {$(
        impl ToEngine for $name {
            type Engine = glam::$name;
            fn to_engine(self) -> glam::$name {
                glam::$name::from_array(self.to_array())
            }
        }
        impl ToBevy for glam::$name {
            type Bevy = $name;
            fn to_bevy(self) -> $name {
                $name::from_array(self.to_array())
            }
        }
    )*};
}

same_numbers!(Vec3, DVec3, Quat);
