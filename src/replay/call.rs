//! What a recording is made of: calls, by the names of the methods of `World`.

use super::geometry::{Form, StoredHull, StoredMesh};
use super::probe::StepRecord;
use super::tape::Sink;
use crate::body::{BodyDesc, BodyKind};
use crate::config::RowGroup;
use crate::config::{Continuous, Settings};
use crate::error::Error;
use crate::handle::{BodyHandle, CharacterHandle, CouplingHandle, JointHandle, ShapeHandle};
use crate::joint::{Axes, Axis, CouplingDesc, Drive, Frame, JointDesc, Limit, Motion};
use crate::shape::{
    BaseMaterial, Filter, HolePatch, MassProperties, Material, Patch, RareMaterial, ShapeDesc, StoredField,
};
use crate::world::{Change, World};
use glam::{DVec3, Vec3};
use serde::{Deserialize, Serialize};

/// Declares the calls, each with the method that makes it. One that changes a `body`, whose handle comes
/// first, or another that is the `same` when it is recorded and when it is played, needs no more than its
/// arguments. The others are told `apart`: `of` says what they are of a change, and `play.rs` plays them.
macro_rules! calls {
    (
        of($sink:ident) { $($of:tt)* }
        $(
            $(#[$doc:meta])*
            $call:ident $method:ident
            $(body($($of_body:ident: $body:ty),*))?
            $(same($($argument:ident: $same:ty),*))?
            $(apart($($apart:ty),*))?,
        )*
    ) => {
        /// A call that changed the world, or what one of them needs. New ones go to the end: their numbers
        /// are the format's.
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
                        $(Call::$call($($argument),*) => drop(world.$method($($argument),*)?),)?
                    )*
                    apart => return Ok(Some(apart)),
                }
                Ok(None)
            }

            /// The body that it changes, by itself and not only by what a step makes of it.
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
}

/// Columns and rows, of which a field has no more.
fn small(two: [usize; 2]) -> [u32; 2] {
    two.map(|n| n as u32)
}

calls! {
    of(sink) {
        Change::SetSettings(settings) => Call::SetSettings(settings.clone()),
        Change::AddBody(desc) => Call::AddBody(sink.body(desc)),
        Change::AddBodies(descs) => Call::AddBodies(descs.iter().map(|desc| sink.body(desc)).collect()),
        Change::AddShape(body, desc) => Call::AddShape(body, sink.shape(desc)),
        Change::AddJoint(desc) => Call::AddJoint(desc.clone()),
        Change::AddJoints(descs) => Call::AddJoints(descs.to_vec()),
        Change::SetJointTarget(joint, motion, axis, to) => Call::SetJointTarget(joint, motion, axis, to),
        Change::SetJointLimits(joint, limits) => Call::SetJointLimits(joint, limits.to_vec()),
        Change::SetJointDrives(joint, drives) => Call::SetJointDrives(joint, drives.to_vec()),
        Change::SetJointStrength(joint, strength) => Call::SetJointStrength(joint, strength),
        Change::SetJointThresholds(joint, bounds) => Call::SetJointThresholds(joint, bounds),
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

    Step step apart(StepRecord),
    /// Geometry that shapes share, written before the first call that uses it; numbered in this order.
    Hull hull apart(StoredHull),
    Mesh mesh apart(StoredMesh),
    Field height_field apart(StoredField),
    /// Another one of the same content as that of this number.
    Again again apart(u32),
    SetSettings set_settings apart(Settings),
    SetOrigin set_origin same(origin: DVec3),
    AddBody add_body apart(Body),
    AddBodies add_bodies apart(Vec<Body>),
    RemoveBody remove_body same(body: BodyHandle),
    AddShape add_shape apart(BodyHandle, Shape),
    RemoveShape remove_shape same(shape: ShapeHandle),
    SetMaterial set_material same(shape: ShapeHandle, material: Material),
    SetFilter set_filter same(shape: ShapeHandle, filter: Filter),
    SetListening set_listening same(shape: ShapeHandle, events: bool, hooks: bool),
    SetSensor set_sensor same(shape: ShapeHandle, sensor: bool),
    SetPose set_pose body(position: DVec3, rotation: glam::Quat),
    SetVelocity set_velocity body(linear: Vec3, angular: Vec3),
    AddForce add_force body(force: Vec3, torque: Vec3),
    ApplyImpulse apply_impulse body(impulse: Vec3, point: DVec3),
    SetGravityScale set_gravity_scale body(scale: f32),
    SetContinuous set_continuous body(mode: Continuous),
    SolveBodyAfter solve_body_after body(above: Option<RowGroup>),
    SetMass set_mass body(mass: MassProperties),
    AddJoint add_joint apart(JointDesc),
    AddJoints add_joints apart(Vec<JointDesc>),
    RemoveJoint remove_joint same(joint: JointHandle),
    SetJointDrive set_joint_drive same(joint: JointHandle, drive: Drive),
    RemoveJointDrive remove_joint_drive same(joint: JointHandle, motion: Motion, axis: Axis),
    SetJointTarget set_joint_target apart(JointHandle, Motion, Axis, [f32; 2]),
    SetJointLimit set_joint_limit same(joint: JointHandle, limit: Limit),
    RemoveJointLimit remove_joint_limit same(joint: JointHandle, motion: Motion, axes: Axes),
    SetJointLimits set_joint_limits apart(JointHandle, Vec<Limit>),
    SetJointDrives set_joint_drives apart(JointHandle, Vec<Drive>),
    SetJointFrames set_joint_frames same(joint: JointHandle, frames: [Frame; 2]),
    SetJointCollide set_joint_collide same(joint: JointHandle, collide: bool),
    SetJointStrength set_joint_strength apart(JointHandle, [f32; 2]),
    SetJointThresholds set_joint_thresholds apart(JointHandle, [f32; 2]),
    SetJointUserData set_joint_user_data same(joint: JointHandle, user_data: u64),
    SolveJointAfter solve_joint_after same(joint: JointHandle, above: Option<RowGroup>),
    Wake wake body(),
    SendToSleep send_to_sleep body(),
    SetCanSleep set_can_sleep body(can_sleep: bool),
    SetEnabled set_enabled body(enabled: bool),
    /// What a body is called in what is said of the replay.
    NameRecorded name_recorded apart(BodyHandle, String),
    /// A query was asked. It changes nothing but the memory that the world holds, which a budget counts.
    Asked asked apart(),
    SetKind set_kind body(kind: BodyKind),
    SetUserData set_user_data body(user_data: u64),
    SetDamping set_damping body(linear: f32, angular: f32),
    SetMaxSpeeds set_max_speeds body(linear: Option<f32>, angular: Option<f32>),
    SetLocks set_locks body(translation: [bool; 3], rotation: [bool; 3]),
    SetLinearVelocity set_linear_velocity body(linear: Vec3),
    SetAngularVelocity set_angular_velocity body(angular: Vec3),
    MoveKinematic move_kinematic body(at: DVec3, turned: glam::Quat, dt: f32),
    ApplyAngularImpulse apply_angular_impulse body(impulse: Vec3),
    SetShapeUserData set_shape_user_data same(shape: ShapeHandle, user_data: u64),
    SetGeometry set_geometry apart(ShapeHandle, Form),
    SetShapePose set_shape_pose same(shape: ShapeHandle, position: Vec3, rotation: glam::Quat),
    SetDensity set_density same(shape: ShapeHandle, density: f32),
    AddCharacter add_character apart(Option<Form>, Vec<u32>),
    RemoveCharacter remove_character same(character: CharacterHandle),
    SetCharacter set_character apart(CharacterHandle, Option<Form>, Vec<u32>),
    /// The state after the walk, which a filter of the caller's may decide.
    WalkCharacter walk_character apart(CharacterHandle, Vec<u32>),
    AddCoupling add_coupling apart(CouplingDesc),
    RemoveCoupling remove_coupling same(coupling: CouplingHandle),
    SetCouplingFactors set_coupling_factors same(coupling: CouplingHandle, factors: [f64; 2]),
    SetCouplingRange set_coupling_range same(coupling: CouplingHandle, range: Option<[f64; 2]>),
    SetCouplingStrength set_coupling_strength same(coupling: CouplingHandle, most: [f32; 2]),
    SetCouplingUserData set_coupling_user_data same(coupling: CouplingHandle, data: u64),
    /// Column and row of the first sample, columns and rows, heights.
    SetHeights set_heights apart(ShapeHandle, [u32; 2], [u32; 2], Vec<f32>),
    /// Column and row of the first cell, columns and rows, which are holes.
    SetHoles set_holes apart(ShapeHandle, [u32; 2], [u32; 2], Vec<bool>),
    SetSensesStatic set_senses_static same(shape: ShapeHandle, senses: bool),
    /// A part that snapshots share, and the geometry in it, before the first call that uses it; numbered in
    /// this order. Only the last [`PARTS`](super::geometry::PARTS) are kept.
    Part part apart(Vec<u8>, Vec<Form>),
    /// The state of a snapshot, the hulls of its characters, and its parts unless they are those of the
    /// world. A recording that begins in the middle of a run begins with it.
    Restore restore apart(Vec<u8>, Vec<Form>, Option<[u32; 2]>),
    MoveKinematicAndStop move_kinematic_and_stop body(at: DVec3, turned: glam::Quat, dt: f32),
}

/// [`BodyDesc`] with its geometries by number.
#[derive(Clone, Debug, Serialize, Deserialize)]
pub(crate) struct Body {
    kind: BodyKind,
    position: DVec3,
    rotation: glam::Quat,
    velocity: [Vec3; 2],
    pub(super) shapes: Vec<Shape>,
    mass: Option<MassProperties>,
    gravity_scale: f32,
    /// Linear and angular.
    damping: [f32; 2],
    max_speeds: [Option<f32>; 2],
    locks: [[bool; 3]; 2],
    continuous: Continuous,
    solved_after: Option<RowGroup>,
    can_sleep: bool,
    user_data: u64,
}

impl Body {
    pub(super) fn new(desc: &BodyDesc, mut form: impl FnMut(&ShapeDesc) -> Shape) -> Body {
        // By name and without a rest, here and below: a field that is new must not be forgotten.
        let BodyDesc {
            kind,
            position,
            rotation,
            linear_velocity,
            angular_velocity,
            ref shapes,
            mass,
            gravity_scale,
            linear_damping,
            angular_damping,
            max_linear_speed,
            max_angular_speed,
            lock_translation,
            lock_rotation,
            continuous,
            solved_after,
            can_sleep,
            user_data,
        } = *desc;
        Body {
            kind,
            position,
            rotation,
            velocity: [linear_velocity, angular_velocity],
            shapes: shapes.iter().map(&mut form).collect(),
            mass,
            gravity_scale,
            damping: [linear_damping, angular_damping],
            max_speeds: [max_linear_speed, max_angular_speed],
            locks: [lock_translation, lock_rotation],
            continuous,
            solved_after,
            can_sleep,
            user_data,
        }
    }

    pub(super) fn desc(&self, shapes: Vec<ShapeDesc>) -> BodyDesc {
        BodyDesc {
            kind: self.kind,
            position: self.position,
            rotation: self.rotation,
            linear_velocity: self.velocity[0],
            angular_velocity: self.velocity[1],
            shapes,
            mass: self.mass,
            gravity_scale: self.gravity_scale,
            linear_damping: self.damping[0],
            angular_damping: self.damping[1],
            max_linear_speed: self.max_speeds[0],
            max_angular_speed: self.max_speeds[1],
            lock_translation: self.locks[0],
            lock_rotation: self.locks[1],
            continuous: self.continuous,
            solved_after: self.solved_after,
            can_sleep: self.can_sleep,
            user_data: self.user_data,
        }
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
    /// Sensor, events, hooks, whether it senses what is static.
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
