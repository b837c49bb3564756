//! Values of this interface and their equivalents in the engine.

use super::status::Outcome;
use super::values::{BsBody, BsBool, BsDVec3, BsQuat, BsShape, BsVec3};
use backstop::glam::{DVec3, Quat, Vec3};
use backstop::{BodyHandle, ShapeHandle};

/// A value that is an `E` in the engine.
pub(crate) trait Twin<E>: Sized {
    /// What the engine has for it.
    ///
    /// # Errors
    /// If it is none.
    fn read(self) -> Outcome<E>;

    /// What this interface has for the engine's.
    fn write(engine: &E) -> Self;
}

macro_rules! twins {
    ($($own:ty = $engine:ty: $read:expr, $write:expr;)*) => {$(
        impl Twin<$engine> for $own {
            fn read(self) -> Outcome<$engine> {
                let read: fn($own) -> $engine = $read;
                Ok(read(self))
            }

            fn write(engine: &$engine) -> $own {
                let write: fn($engine) -> $own = $write;
                write(*engine)
            }
        }
    )*};
}

twins! {
    f32 = f32: |x| x, |x| x;
    i32 = i32: |x| x, |x| x;
    u32 = u32: |x| x, |x| x;
    u64 = u64: |x| x, |x| x;
    u32 = usize: |x| x as usize, |x| u32::try_from(x).unwrap_or(u32::MAX);
    BsBool = bool: |x| x != 0, BsBool::from;
    BsVec3 = Vec3: Vec3::from, BsVec3::from;
    BsDVec3 = DVec3: DVec3::from, BsDVec3::from;
    BsQuat = Quat: Quat::from, BsQuat::from;
    BsBody = BodyHandle: BodyHandle::from, BsBody::from;
    BsShape = ShapeHandle: ShapeHandle::from, BsShape::from;
}

/// Constants of the interface as twins of an enumeration of the engine.
macro_rules! codes {
    ($what:literal, $type:ty { $($code:ident = $variant:path),* $(,)? }) => {
        impl $crate::abi::twin::Twin<$type> for u32 {
            fn read(self) -> $crate::abi::status::Outcome<$type> {
                match self {
                    $($code => Ok($variant),)*
                    value => Err($crate::abi::status::Refusal::Constant { what: $what, value }),
                }
            }

            fn write(engine: &$type) -> u32 {
                match engine {
                    $($variant => $code,)*
                    // A value without a constant yet: no call takes it back.
                    #[allow(unreachable_patterns, reason = "not every enumeration may grow")]
                    _ => u32::MAX,
                }
            }
        }
    };
}
pub(crate) use codes;

/// A struct of this interface. `of ENGINE: TYPE` makes it the twin of a struct of the engine: fields of the
/// same name are converted both ways, and those that are not the engine's have `= VALUE`, what they are when
/// it is made of `ENGINE`. Fields that have no comment have the engine's in the header (tests/header.rs).
/// `default VALUE` is said of a description that may grow ([`Described`](super::sized::Described)).
macro_rules! record {
    (
        $(#[$meta:meta])*
        pub struct $name:ident of $engine:ident: $of:ty {
            $($(#[$about:meta])* pub $field:ident: $kind:ty $(= $own:expr)?,)+
        }
        $(default $defaults:expr)?
    ) => {
        $crate::abi::twin::record! {
            $(#[$meta])*
            #[allow(missing_docs, reason = "the engine's, in the header")]
            pub struct $name { $($(#[$about])* pub $field: $kind,)+ }
            $(default $defaults)?
        }

        impl $name {
            /// What this interface has for the engine's.
            pub(crate) fn of_engine($engine: &$of) -> $name {
                $name { $($field: $crate::abi::twin::record!(@write $engine $field $(, $own)?),)+ }
            }

            /// The engine's with all that this says, and the rest as it is.
            #[allow(dead_code, reason = "reports are not read")]
            #[allow(clippy::needless_update, reason = "this may be all")]
            pub(crate) fn on(self, mut engine: $of) -> $crate::abi::status::Outcome<$of> {
                $($crate::abi::twin::record!(@read self engine $field $(, $own)?);)+
                Ok(engine)
            }
        }
    };
    (
        $(#[$meta:meta])*
        pub struct $name:ident { $($(#[$about:meta])* pub $field:ident: $kind:ty,)+ }
        $(default $defaults:expr)?
    ) => {
        $(#[$meta])*
        pub struct $name { $($(#[$about])* pub $field: $kind,)+ }

        $crate::abi::twin::record!(@described $name [$($field)+] $($defaults)?);
    };
    (@write $engine:ident $field:ident) => { $crate::abi::twin::Twin::write(&$engine.$field) };
    (@write $engine:ident $field:ident, $own:expr) => { $own };
    (@read $own:ident $engine:ident $field:ident) => {
        $engine.$field = $crate::abi::twin::Twin::read($own.$field)?
    };
    (@read $own:ident $engine:ident $field:ident, $value:expr) => {};
    (@described $name:ident [$($field:ident)+]) => {};
    (@described $name:ident [$($field:ident)+] $defaults:expr) => {
        $crate::abi::sized::described! { $name, $defaults, [$($field),+] }
    };
}
pub(crate) use record;
