//! The calls of a recording, by the names of the methods of `World`.

use super::geometry::{Form, StoredHull, StoredMesh};
use super::probe::StepRecord;
use super::tape::Sink;
use crate::body::{BodyDesc, BodyKind};
use crate::config::RowGroup;
use crate::config::{ContinuousMode, Settings};
use crate::error::Error;
use crate::handle::{BodyHandle, CharacterHandle, CouplingHandle, JointHandle, ShapeHandle};
use crate::joint::{Axes, Axis, CouplingDesc, Frame, JointDesc, Limit, Motion, Motor};
use crate::shape::{
    BaseMaterial, Filter, HolePatch, MassProperties, Material, Patch, RareMaterial, ShapeDesc, StoredField,
};
use crate::world::{Change, World};
use glam::{DVec3, Vec3};
use serde::{Deserialize, Serialize};

/// Declares the calls of [`each_call`](crate::world::each_call), and how most are recorded and made again.
/// For those that are `apart`, `of` converts a change, and `play.rs` plays them.
macro_rules! calls {
    (
        of($sink:ident) { $($of:tt)* }
        $(
            $(#[$doc:meta])*
            $call:ident $method:ident
            $(body($($of_body:ident: $body:ty),*))?
            $(same($($argument:ident: $same:ty),*) $(as ($($given:expr),*))?)?
            $(apart($($apart:ty),*) $(of($($of_change:ty),*))?)?,
        )*
    ) => {
        /// A call that changed the world, or data that one of them needs. New ones go to the end: their
        /// numbers are the format's.
        #[derive(Clone, Debug, Serialize, Deserialize)]
        pub(crate) enum Call {
            $($(#[$doc])* $call($(BodyHandle $(, $body)*)? $($($same),*)? $($($apart),*)?),)*
        }

        impl Call {
            /// The name of the method.
            pub(super) fn name(&self) -> &'static str {
                match self {
                    $(Call::$call(..) => stringify!($method),)*
                }
            }

            /// A change, with its geometry by number.
            pub(super) fn of(change: Change<'_>, $sink: &mut Sink) -> Call {
                match change {
                    $(
                        $(Change::$call(body $(, $of_body)*) => Call::$call(body $(, $of_body)*),)?
                        $(Change::$call($($argument),*) => Call::$call($($argument),*),)?
                    )*
                    $($of)*
                }
            }

            /// Makes a call that needs no more than its arguments, and gives back any other.
            pub(super) fn make(self, world: &mut World) -> Result<Option<Call>, Error> {
                match self {
                    $(
                        $(Call::$call(body $(, $of_body)*) => world.$method(body $(, $of_body)*)?,)?
                        $(Call::$call($($argument),*) => drop(
                            calls!(@make world $method ($($argument),*) $(as ($($given),*))?)?
                        ),)?
                    )*
                    apart => return Ok(Some(apart)),
                }
                Ok(None)
            }

            /// The body that it changes directly, and not only by the next step.
            pub(super) fn body(&self) -> Option<BodyHandle> {
                match self {
                    $($(Call::$call(body $(, calls!(@any $of_body))*) => Some(*body),)?)*
                    Call::AddShape(body, ..) => Some(*body),
                    _ => None,
                }
            }
        }
    };
    (@any $argument:ident) => { _ };
    (@make $world:ident $method:ident ($($argument:ident),*)) => { $world.$method($($argument),*) };
    (@make $world:ident $method:ident ($($argument:ident),*) as ($($given:expr),*)) => {
        $world.$method($($given),*)
    };
}

/// Columns and rows, of which a field has no more.
fn small(two: [usize; 2]) -> [u32; 2] {
    two.map(|n| n as u32)
}

crate::world::each_call! { calls {
    of(sink) {
        Change::SetSettings(settings) => Call::SetSettings(settings.clone()),
        Change::AddBody(desc) => Call::AddBody(sink.body(desc)),
        Change::AddBodies(descs) => Call::AddBodies(descs.iter().map(|desc| sink.body(desc)).collect()),
        Change::AddShape(body, desc) => Call::AddShape(body, sink.shape(desc)),
        Change::AddJoint(desc) => Call::AddJoint(desc.clone()),
        Change::AddJoints(descs) => Call::AddJoints(descs.to_vec()),
        Change::SetJointLimits(joint, limits) => Call::SetJointLimits(joint, limits.to_vec()),
        Change::SetJointMotors(joint, drives) => Call::SetJointMotors(joint, drives.to_vec()),
        Change::SetGeometry(shape, geometry) => Call::SetGeometry(shape, sink.form(geometry)),
        Change::AddCharacter(resident) => sink.resident(resident, Call::AddCharacter),
        Change::SetCharacter(character, resident) => {
            sink.resident(resident, |form, words| Call::SetCharacter(character, form, words))
        }
        Change::WalkCharacter(character, words) => Call::WalkCharacter(character, words.to_vec()),
        Change::AddCoupling(desc) => Call::AddCoupling(*desc),
        Change::SetHeights(shape, Patch { first, size, heights }) => {
            Call::SetHeights(shape, small(*first), small(*size), heights.to_vec())
        }
        Change::SetHoles(shape, HolePatch { first, size, holes }) => {
            Call::SetHoles(shape, small(*first), small(*size), holes.to_vec())
        }
        Change::Restore(snapshot) => sink.restore(snapshot.downcast_ref()),
    }
} }

/// Makes the recorded form of a description from the list of its fields, one of which is stored in another
/// form.
macro_rules! recorded {
    ($(#[$doc:meta])* $of:ident of $desc:ident {
        $($before:ident: $first:ty,)*
        [$own:ident: $kind:ty => $theirs:ty],
        $($after:ident: $last:ty,)*
    }) => {
        $(#[$doc])*
        #[derive(Clone, Debug, Serialize, Deserialize)]
        pub(crate) struct $of {
            $($before: $first,)*
            pub(super) $own: $kind,
            $($after: $last,)*
        }

        impl $of {
            pub(super) fn new(desc: &$desc, $own: $kind) -> $of {
                // By name and without a rest, here and below: a field that is new must not be forgotten.
                let $desc { $($before,)* $own: _, $($after,)* } = *desc;
                $of { $($before,)* $own, $($after,)* }
            }

            pub(super) fn desc(&self, $own: $theirs) -> $desc {
                let $of { $($before,)* $own: _, $($after,)* } = *self;
                $desc { $($before,)* $own, $($after,)* }
            }
        }
    };
}

recorded! {
    /// [`BodyDesc`] with its geometries by number.
    Body of BodyDesc {
        kind: BodyKind,
        position: DVec3,
        rotation: glam::Quat,
        linear_velocity: Vec3,
        angular_velocity: Vec3,
        [shapes: Vec<Shape> => Vec<ShapeDesc>],
        mass: Option<MassProperties>,
        gravity_scale: f32,
        linear_damping: f32,
        angular_damping: f32,
        max_linear_speed: Option<f32>,
        max_angular_speed: Option<f32>,
        lock_translation: [bool; 3],
        lock_rotation: [bool; 3],
        continuous: ContinuousMode,
        solved_after: Option<RowGroup>,
        can_sleep: bool,
        user_data: u64,
    }
}

/// [`ShapeDesc`] with its geometry by number.
#[derive(Clone, Debug, Serialize, Deserialize)]
pub(crate) struct Shape {
    pub(super) form: Form,
    position: Vec3,
    rotation: glam::Quat,
    density: f32,
    material: BaseMaterial,
    rare: Option<RareMaterial>,
    filter: Filter,
    /// Sensor, events, hooks, whether it senses static shapes.
    asks: [bool; 4],
    user_data: u64,
}

impl Shape {
    pub(super) fn new(desc: &ShapeDesc, form: Form) -> Shape {
        let ShapeDesc {
            geometry: _,
            position,
            rotation,
            density,
            material,
            filter,
            sensor,
            senses_static,
            events,
            hooks,
            user_data,
        } = *desc;
        Shape {
            form,
            position,
            rotation,
            density,
            material: material.base(),
            rare: Some(material.rare()).filter(|rare| rare.flags() != 0),
            filter,
            asks: [sensor, events, hooks, senses_static],
            user_data,
        }
    }

    pub(super) fn desc(&self, geometry: crate::shape::Geometry) -> ShapeDesc {
        let [sensor, events, hooks, senses_static] = self.asks;
        ShapeDesc {
            geometry,
            position: self.position,
            rotation: self.rotation,
            density: self.density,
            material: Material::of(self.material, self.rare.unwrap_or_default()),
            filter: self.filter,
            sensor,
            senses_static,
            events,
            hooks,
            user_data: self.user_data,
        }
    }
}
