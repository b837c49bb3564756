//! What a recording is made of: calls, by the names of the methods of `World`.

use super::geometry::{Form, StoredHull, StoredMesh};
use super::probe::StepRecord;
use super::tape::Sink;
use crate::body::{BodyDesc, BodyKind};
use crate::config::RowGroup;
use crate::config::{Continuous, Settings};
use crate::handle::{BodyHandle, CharacterHandle, CouplingHandle, JointHandle, ShapeHandle};
use crate::joint::{Axes, Axis, CouplingDesc, Drive, Frame, JointDesc, Limit, Motion};
use crate::shape::{
    BaseMaterial, Filter, HolePatch, MassProperties, Material, Patch, RareMaterial, ShapeDesc, StoredField,
};
use crate::world::Change;
use glam::{DVec3, Vec3};
use serde::{Deserialize, Serialize};

macro_rules! calls {
    ($($(#[$doc:meta])* $call:ident $name:literal ($($kind:ty),*),)*) => {
        /// A call that changed the world, or what one of them needs. New ones go to the end: their numbers
        /// are the format's.
        #[derive(Clone, Debug, Serialize, Deserialize)]
        pub(crate) enum Call {
            $($(#[$doc])* $call($($kind),*),)*
        }

        impl Call {
            /// The name of the method.
            pub(super) fn name(&self) -> &'static str {
                match self {
                    $(Call::$call(..) => $name,)*
                }
            }
        }
    };
}

calls! {
    Step "step" (StepRecord),
    /// Geometry that shapes share, written before the first call that uses it; numbered in this order.
    Hull "hull" (StoredHull),
    Mesh "mesh" (StoredMesh),
    Field "height_field" (StoredField),
    /// Another one of the same content as that of this number.
    Again "again" (u32),
    SetSettings "set_settings" (Settings),
    SetOrigin "set_origin" (DVec3),
    AddBody "add_body" (Body),
    AddBodies "add_bodies" (Vec<Body>),
    RemoveBody "remove_body" (BodyHandle),
    AddShape "add_shape" (BodyHandle, Shape),
    RemoveShape "remove_shape" (ShapeHandle),
    SetMaterial "set_material" (ShapeHandle, Material),
    SetFilter "set_filter" (ShapeHandle, Filter),
    SetListening "set_listening" (ShapeHandle, bool, bool),
    SetSensor "set_sensor" (ShapeHandle, bool),
    SetPose "set_pose" (BodyHandle, DVec3, glam::Quat),
    SetVelocity "set_velocity" (BodyHandle, Vec3, Vec3),
    AddForce "add_force" (BodyHandle, Vec3, Vec3),
    ApplyImpulse "apply_impulse" (BodyHandle, Vec3, DVec3),
    SetGravityScale "set_gravity_scale" (BodyHandle, f32),
    SetContinuous "set_continuous" (BodyHandle, Continuous),
    SolveBodyAfter "solve_body_after" (BodyHandle, Option<RowGroup>),
    SetMass "set_mass" (BodyHandle, MassProperties),
    AddJoint "add_joint" (JointDesc),
    AddJoints "add_joints" (Vec<JointDesc>),
    RemoveJoint "remove_joint" (JointHandle),
    SetJointDrive "set_joint_drive" (JointHandle, Drive),
    RemoveJointDrive "remove_joint_drive" (JointHandle, Motion, Axis),
    SetJointTarget "set_joint_target" (JointHandle, Motion, Axis, [f32; 2]),
    SetJointLimit "set_joint_limit" (JointHandle, Limit),
    RemoveJointLimit "remove_joint_limit" (JointHandle, Motion, Axes),
    SetJointLimits "set_joint_limits" (JointHandle, Vec<Limit>),
    SetJointDrives "set_joint_drives" (JointHandle, Vec<Drive>),
    SetJointFrames "set_joint_frames" (JointHandle, [Frame; 2]),
    SetJointCollide "set_joint_collide" (JointHandle, bool),
    SetJointStrength "set_joint_strength" (JointHandle, [f32; 2]),
    SetJointThresholds "set_joint_thresholds" (JointHandle, [f32; 2]),
    SetJointUserData "set_joint_user_data" (JointHandle, u64),
    SolveJointAfter "solve_joint_after" (JointHandle, Option<RowGroup>),
    Wake "wake" (BodyHandle),
    SendToSleep "send_to_sleep" (BodyHandle),
    SetCanSleep "set_can_sleep" (BodyHandle, bool),
    SetEnabled "set_enabled" (BodyHandle, bool),
    /// What a body is called in what is said of the replay.
    NameRecorded "name_recorded" (BodyHandle, String),
    /// A query was asked. It changes nothing but the memory that the world holds, which a budget counts.
    Asked "asked" (),
    SetKind "set_kind" (BodyHandle, BodyKind),
    SetUserData "set_user_data" (BodyHandle, u64),
    SetDamping "set_damping" (BodyHandle, f32, f32),
    SetMaxSpeeds "set_max_speeds" (BodyHandle, Option<f32>, Option<f32>),
    SetLocks "set_locks" (BodyHandle, [bool; 3], [bool; 3]),
    SetLinearVelocity "set_linear_velocity" (BodyHandle, Vec3),
    SetAngularVelocity "set_angular_velocity" (BodyHandle, Vec3),
    MoveKinematic "move_kinematic" (BodyHandle, DVec3, glam::Quat, f32),
    ApplyAngularImpulse "apply_angular_impulse" (BodyHandle, Vec3),
    SetShapeUserData "set_shape_user_data" (ShapeHandle, u64),
    SetGeometry "set_geometry" (ShapeHandle, Form),
    SetShapePose "set_shape_pose" (ShapeHandle, Vec3, glam::Quat),
    SetDensity "set_density" (ShapeHandle, f32),
    AddCharacter "add_character" (Option<Form>, Vec<u32>),
    RemoveCharacter "remove_character" (CharacterHandle),
    SetCharacter "set_character" (CharacterHandle, Option<Form>, Vec<u32>),
    /// The state after the walk, which a filter of the caller's may decide.
    WalkCharacter "walk_character" (CharacterHandle, Vec<u32>),
    AddCoupling "add_coupling" (CouplingDesc),
    RemoveCoupling "remove_coupling" (CouplingHandle),
    SetCouplingFactors "set_coupling_factors" (CouplingHandle, [f64; 2]),
    SetCouplingRange "set_coupling_range" (CouplingHandle, Option<[f64; 2]>),
    SetCouplingStrength "set_coupling_strength" (CouplingHandle, [f32; 2]),
    SetCouplingUserData "set_coupling_user_data" (CouplingHandle, u64),
    /// Column and row of the first sample, columns and rows, heights.
    SetHeights "set_heights" (ShapeHandle, [u32; 2], [u32; 2], Vec<f32>),
    /// Column and row of the first cell, columns and rows, which are holes.
    SetHoles "set_holes" (ShapeHandle, [u32; 2], [u32; 2], Vec<bool>),
    SetSensesStatic "set_senses_static" (ShapeHandle, bool),
    /// A part that snapshots share, and the geometry in it, before the first call that uses it; numbered in
    /// this order. Only the last [`PARTS`](super::geometry::PARTS) are kept.
    Part "part" (Vec<u8>, Vec<Form>),
    /// The state of a snapshot, the hulls of its characters, and its parts unless they are those of the
    /// world. A recording that begins in the middle of a run begins with it.
    Restore "restore" (Vec<u8>, Vec<Form>, Option<[u32; 2]>),
    MoveKinematicAndStop "move_kinematic_and_stop" (BodyHandle, DVec3, glam::Quat, f32),
}

/// Columns and rows, of which a field has no more.
fn small(two: [usize; 2]) -> [u32; 2] {
    two.map(|n| n as u32)
}

impl Call {
    /// A change, with its geometry by number.
    pub(super) fn of(change: Change<'_>, sink: &mut Sink) -> Call {
        match change {
            Change::SetSettings(settings) => Call::SetSettings(settings.clone()),
            Change::SetOrigin(origin) => Call::SetOrigin(origin),
            Change::AddBody(desc) => Call::AddBody(sink.body(desc)),
            Change::AddBodies(descs) => Call::AddBodies(descs.iter().map(|desc| sink.body(desc)).collect()),
            Change::RemoveBody(body) => Call::RemoveBody(body),
            Change::AddShape(body, desc) => Call::AddShape(body, sink.shape(desc)),
            Change::RemoveShape(shape) => Call::RemoveShape(shape),
            Change::SetMaterial(shape, material) => Call::SetMaterial(shape, material),
            Change::SetFilter(shape, filter) => Call::SetFilter(shape, filter),
            Change::SetListening(shape, events, hooks) => Call::SetListening(shape, events, hooks),
            Change::SetSensor(shape, sensor) => Call::SetSensor(shape, sensor),
            Change::SetSensesStatic(shape, senses) => Call::SetSensesStatic(shape, senses),
            Change::SetPose(body, position, rotation) => Call::SetPose(body, position, rotation),
            Change::SetVelocity(body, linear, angular) => Call::SetVelocity(body, linear, angular),
            Change::AddForce(body, force, torque) => Call::AddForce(body, force, torque),
            Change::ApplyImpulse(body, impulse, point) => Call::ApplyImpulse(body, impulse, point),
            Change::SetGravityScale(body, scale) => Call::SetGravityScale(body, scale),
            Change::SetContinuous(body, mode) => Call::SetContinuous(body, mode),
            Change::SolveBodyAfter(body, above) => Call::SolveBodyAfter(body, above),
            Change::SetMass(body, mass) => Call::SetMass(body, mass),
            Change::AddJoint(desc) => Call::AddJoint(desc.clone()),
            Change::AddJoints(descs) => Call::AddJoints(descs.to_vec()),
            Change::RemoveJoint(joint) => Call::RemoveJoint(joint),
            Change::SetJointDrive(joint, drive) => Call::SetJointDrive(joint, drive),
            Change::RemoveJointDrive(joint, motion, axis) => Call::RemoveJointDrive(joint, motion, axis),
            Change::SetJointTarget(joint, motion, axis, to) => Call::SetJointTarget(joint, motion, axis, to),
            Change::SetJointLimit(joint, limit) => Call::SetJointLimit(joint, limit),
            Change::RemoveJointLimit(joint, motion, axes) => Call::RemoveJointLimit(joint, motion, axes),
            Change::SetJointLimits(joint, limits) => Call::SetJointLimits(joint, limits.to_vec()),
            Change::SetJointDrives(joint, drives) => Call::SetJointDrives(joint, drives.to_vec()),
            Change::SetJointFrames(joint, frames) => Call::SetJointFrames(joint, frames),
            Change::SetJointCollide(joint, collide) => Call::SetJointCollide(joint, collide),
            Change::SetJointStrength(joint, strength) => Call::SetJointStrength(joint, strength),
            Change::SetJointThresholds(joint, bounds) => Call::SetJointThresholds(joint, bounds),
            Change::SetJointUserData(joint, user_data) => Call::SetJointUserData(joint, user_data),
            Change::SolveJointAfter(joint, above) => Call::SolveJointAfter(joint, above),
            Change::AddCoupling(desc) => Call::AddCoupling(*desc),
            Change::RemoveCoupling(coupling) => Call::RemoveCoupling(coupling),
            Change::SetCouplingFactors(coupling, factors) => Call::SetCouplingFactors(coupling, factors),
            Change::SetCouplingRange(coupling, range) => Call::SetCouplingRange(coupling, range),
            Change::SetCouplingStrength(coupling, most) => Call::SetCouplingStrength(coupling, most),
            Change::SetCouplingUserData(coupling, data) => Call::SetCouplingUserData(coupling, data),
            Change::Wake(body) => Call::Wake(body),
            Change::SendToSleep(body) => Call::SendToSleep(body),
            Change::SetCanSleep(body, can_sleep) => Call::SetCanSleep(body, can_sleep),
            Change::SetEnabled(body, enabled) => Call::SetEnabled(body, enabled),
            Change::SetKind(body, kind) => Call::SetKind(body, kind),
            Change::SetUserData(body, user_data) => Call::SetUserData(body, user_data),
            Change::SetDamping(body, linear, angular) => Call::SetDamping(body, linear, angular),
            Change::SetMaxSpeeds(body, linear, angular) => Call::SetMaxSpeeds(body, linear, angular),
            Change::SetLocks(body, translation, rotation) => Call::SetLocks(body, translation, rotation),
            Change::SetLinearVelocity(body, linear) => Call::SetLinearVelocity(body, linear),
            Change::SetAngularVelocity(body, angular) => Call::SetAngularVelocity(body, angular),
            Change::MoveKinematic(body, at, turned, dt) => Call::MoveKinematic(body, at, turned, dt),
            Change::MoveKinematicAndStop(body, at, turned, dt) => {
                Call::MoveKinematicAndStop(body, at, turned, dt)
            }
            Change::ApplyAngularImpulse(body, impulse) => Call::ApplyAngularImpulse(body, impulse),
            Change::SetShapeUserData(shape, user_data) => Call::SetShapeUserData(shape, user_data),
            Change::SetGeometry(shape, geometry) => Call::SetGeometry(shape, sink.form(geometry)),
            Change::SetShapePose(shape, position, rotation) => Call::SetShapePose(shape, position, rotation),
            Change::SetDensity(shape, density) => Call::SetDensity(shape, density),
            Change::SetHeights(shape, Patch { first, size, heights }) => {
                Call::SetHeights(shape, small(*first), small(*size), heights.to_vec())
            }
            Change::SetHoles(shape, HolePatch { first, size, holes }) => {
                Call::SetHoles(shape, small(*first), small(*size), holes.to_vec())
            }
            Change::AddCharacter(resident) => sink.resident(resident, Call::AddCharacter),
            Change::RemoveCharacter(character) => Call::RemoveCharacter(character),
            Change::SetCharacter(character, resident) => {
                sink.resident(resident, |form, words| Call::SetCharacter(character, form, words))
            }
            Change::WalkCharacter(character, words) => Call::WalkCharacter(character, words.to_vec()),
            Change::Restore(snapshot) => sink.restore(snapshot.downcast_ref()),
        }
    }

    /// The body that it changes, by itself and not only by what a step makes of it.
    pub(super) fn body(&self) -> Option<BodyHandle> {
        match self {
            Call::AddShape(body, ..)
            | Call::SetPose(body, ..)
            | Call::SetVelocity(body, ..)
            | Call::AddForce(body, ..)
            | Call::ApplyImpulse(body, ..)
            | Call::SetGravityScale(body, ..)
            | Call::SetContinuous(body, ..)
            | Call::SolveBodyAfter(body, ..)
            | Call::SetMass(body, ..)
            | Call::Wake(body)
            | Call::SendToSleep(body)
            | Call::SetCanSleep(body, ..)
            | Call::SetEnabled(body, ..)
            | Call::SetKind(body, ..)
            | Call::SetUserData(body, ..)
            | Call::SetDamping(body, ..)
            | Call::SetMaxSpeeds(body, ..)
            | Call::SetLocks(body, ..)
            | Call::SetLinearVelocity(body, ..)
            | Call::SetAngularVelocity(body, ..)
            | Call::MoveKinematic(body, ..)
            | Call::MoveKinematicAndStop(body, ..)
            | Call::ApplyAngularImpulse(body, ..) => Some(*body),
            _ => None,
        }
    }
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
