//! Observers: recorders of changes to a world, and meters of its steps. A world owns and calls them; how they
//! use the calls is up to them.

use crate::body::{BodyDesc, BodyKind};
use crate::config::{ContinuousMode, RowGroup, Settings};
#[cfg(feature = "replay")]
use crate::constraint::Tweak;
use crate::handle::{BodyHandle, CharacterHandle, CouplingHandle, JointHandle, ShapeHandle};
use crate::joint::{Axes, Axis, CouplingDesc, Frame, JointDesc, Limit, Motion, Motor};
use crate::shape::{Filter, Geometry, HolePatch, MassProperties, Material, Patch, ShapeDesc};
use crate::world::{Resident, Stage, World};
use glam::{DVec3, Vec3};

/// Hands the list of all calls in a recording to a macro, after its other arguments: each call with its
/// method and its arguments. The first argument of `body` is the handle of the body that it changes. These,
/// and those of others that are the `same` for the method, in a [`Change`] and in a recording, are enough to
/// play a call; `as` has them where the method takes them in another form. A call that a recording has
/// `apart` is made `of` a change, if it is one, and played by itself.
///
/// New ones go to the end: their numbers are those of recordings.
macro_rules! each_call {
    ($list:ident { $($more:tt)* }) => {
        $list! {
            $($more)*

            Step step apart(StepRecord),
            /// Geometry that shapes share, written before the first call that uses it; numbered in this
            /// order.
            Hull hull apart(StoredHull),
            Mesh mesh apart(StoredMesh),
            Field height_field apart(StoredField),
            /// Another one of the same content as that of this number.
            Again again apart(u32),
            SetSettings set_settings apart(Settings) of(&'a Settings),
            SetOrigin set_origin same(origin: DVec3),
            AddBody add_body apart(Body) of(&'a BodyDesc),
            AddBodies add_bodies apart(Vec<Body>) of(&'a [BodyDesc]),
            RemoveBody remove_body same(body: BodyHandle),
            AddShape add_shape apart(BodyHandle, Shape) of(BodyHandle, &'a ShapeDesc),
            RemoveShape remove_shape same(shape: ShapeHandle),
            SetMaterial set_material same(shape: ShapeHandle, material: Material),
            SetFilter set_filter same(shape: ShapeHandle, filter: Filter),
            SetListening set_listening same(shape: ShapeHandle, events: bool, hooks: bool),
            SetSensor set_sensor same(shape: ShapeHandle, sensor: bool),
            SetPose set_pose body(position: DVec3, rotation: glam::Quat),
            SetVelocity set_velocity body(linear: Vec3, angular: Vec3),
            AddForce add_force_and_torque body(force: Vec3, torque: Vec3),
            ApplyImpulse apply_impulse_at body(impulse: Vec3, point: DVec3),
            SetGravityScale set_gravity_scale body(scale: f32),
            SetContinuous set_continuous body(mode: ContinuousMode),
            SetBodySolvedAfter set_body_solved_after body(above: Option<RowGroup>),
            SetMass set_mass body(mass: MassProperties),
            AddJoint add_joint apart(JointDesc) of(&'a JointDesc),
            AddJoints add_joints apart(Vec<JointDesc>) of(&'a [JointDesc]),
            RemoveJoint remove_joint same(joint: JointHandle),
            SetJointMotor set_joint_motor same(joint: JointHandle, drive: Motor),
            RemoveJointMotor remove_joint_motor same(joint: JointHandle, motion: Motion, axis: Axis),
            SetJointTarget set_joint_target same(joint: JointHandle, motion: Motion, axis: Axis, to: [f32; 2])
                as (joint, motion, axis, to[0], to[1]),
            SetJointLimit set_joint_limit same(joint: JointHandle, limit: Limit),
            RemoveJointLimit remove_joint_limit same(joint: JointHandle, motion: Motion, axes: Axes),
            SetJointLimits set_joint_limits apart(JointHandle, Vec<Limit>) of(JointHandle, &'a [Limit]),
            SetJointMotors set_joint_motors apart(JointHandle, Vec<Motor>) of(JointHandle, &'a [Motor]),
            SetJointFrames set_joint_frames same(joint: JointHandle, frames: [Frame; 2]),
            SetJointCollide set_joint_collide same(joint: JointHandle, collide: bool),
            SetJointBreakForce set_joint_break_force same(joint: JointHandle, most: [f32; 2])
                as (joint, most[0], most[1]),
            SetJointThresholds set_joint_thresholds same(joint: JointHandle, most: [f32; 2])
                as (joint, most[0], most[1]),
            SetJointUserData set_joint_user_data same(joint: JointHandle, user_data: u64),
            SetJointSolvedAfter set_joint_solved_after same(joint: JointHandle, above: Option<RowGroup>),
            Wake wake body(),
            Sleep sleep body(),
            SetCanSleep set_can_sleep body(can_sleep: bool),
            SetEnabled set_enabled body(enabled: bool),
            /// The name of a body in reports of the replay.
            NameRecorded name_recorded apart(BodyHandle, String),
            /// A query was asked. It changes nothing but the memory that the world holds, which a budget
            /// counts.
            Asked asked apart(),
            SetKind set_kind body(kind: BodyKind),
            SetUserData set_user_data body(user_data: u64),
            SetDamping set_damping body(linear: f32, angular: f32),
            SetMaxSpeeds set_max_speeds body(linear: Option<f32>, angular: Option<f32>),
            SetLockedAxes set_locked_axes body(translation: [bool; 3], rotation: [bool; 3]),
            SetLinearVelocity set_linear_velocity body(linear: Vec3),
            SetAngularVelocity set_angular_velocity body(angular: Vec3),
            MoveKinematic move_kinematic body(at: DVec3, turned: glam::Quat, dt: f32),
            ApplyAngularImpulse apply_angular_impulse body(impulse: Vec3),
            SetShapeUserData set_shape_user_data same(shape: ShapeHandle, user_data: u64),
            SetGeometry set_geometry apart(ShapeHandle, Form) of(ShapeHandle, &'a Geometry),
            SetShapePose set_shape_pose same(shape: ShapeHandle, position: Vec3, rotation: glam::Quat),
            SetDensity set_density same(shape: ShapeHandle, density: f32),
            AddCharacter add_character apart(Option<Form>, Vec<u32>) of(&'a Resident),
            RemoveCharacter remove_character same(character: CharacterHandle),
            SetCharacter set_character apart(CharacterHandle, Option<Form>, Vec<u32>)
                of(CharacterHandle, &'a Resident),
            /// The state after the walk, which a filter of the caller's may decide.
            WalkCharacter walk_character apart(CharacterHandle, Vec<u32>) of(CharacterHandle, &'a [u32]),
            AddCoupling add_coupling apart(CouplingDesc) of(&'a CouplingDesc),
            RemoveCoupling remove_coupling same(coupling: CouplingHandle),
            SetCouplingFactors set_coupling_factors same(coupling: CouplingHandle, factors: [f64; 2]),
            SetCouplingRange set_coupling_range same(coupling: CouplingHandle, range: Option<[f64; 2]>),
            SetCouplingBreakForce set_coupling_break_force same(coupling: CouplingHandle, most: [f32; 2]),
            SetCouplingUserData set_coupling_user_data same(coupling: CouplingHandle, data: u64),
            /// Column and row of the first sample, columns and rows, heights.
            SetHeights set_heights apart(ShapeHandle, [u32; 2], [u32; 2], Vec<f32>)
                of(ShapeHandle, &'a Patch<'a>),
            /// Column and row of the first cell, columns and rows, which are holes.
            SetHoles set_holes apart(ShapeHandle, [u32; 2], [u32; 2], Vec<bool>)
                of(ShapeHandle, &'a HolePatch<'a>),
            SetSensesStatic set_senses_static same(shape: ShapeHandle, senses: bool),
            /// A part that snapshots share, and the geometry in it, before the first call that uses it;
            /// numbered in this order. Only the last [`PARTS`](super::geometry::PARTS) are kept.
            Part part apart(Vec<u8>, Vec<Form>),
            /// The state of a snapshot, the hulls of its characters, and its parts unless they are those of
            /// the world. A recording that begins in the middle of a run begins with it.
            Restore restore apart(Vec<u8>, Vec<Form>, Option<[u32; 2]>) of(&'a dyn std::any::Any),
            MoveKinematicAndStop move_kinematic_and_stop body(at: DVec3, turned: glam::Quat, dt: f32),
        }
    };
}
#[cfg(feature = "replay")]
pub(crate) use each_call;

macro_rules! changes {
    ($(
        $(#[$doc:meta])*
        $call:ident $method:ident
        $(body($($of_body:ident: $body:ty),*))?
        $(same($($argument:ident: $same:ty),*) $(as ($($given:expr),*))?)?
        $(apart($($apart:ty),*) $(of($($of:ty),*))?)?,
    )*) => {
        /// A change that a call is about to make, named after the methods of [`World`].
        #[derive(Clone, Copy, Debug)]
        #[cfg_attr(not(feature = "replay"), allow(dead_code, reason = "nobody records it"))]
        pub(crate) enum Change<'a> {
            $(
                $($call(BodyHandle $(, $body)*),)?
                $($call($($same),*),)?
                $($($call($($of),*),)?)?
            )*
        }
    };
}

each_call! { changes {} }

/// Records the changes and the steps of a world.
#[cfg(feature = "replay")]
pub(crate) trait Recorder: std::any::Any + std::fmt::Debug + Send + Sync {
    /// Called before a call changes the world, when nothing can refuse it any more. `asked`: queries made the
    /// world hold more memory since the previous change.
    fn note(&mut self, change: Change<'_>, asked: bool);
    /// Called when a step begins; `asked` as for changes.
    fn begin_step(&mut self, asked: bool);
    /// Called after a stage of the step.
    fn look(&mut self, world: &World, stage: Stage);
    /// Records the changes of the next contact by hooks, and whether they vetoed it.
    fn record(&mut self, tweak: Tweak, vetoed: bool);
    /// Called at the end of a step of `dt` seconds.
    fn end_step(&mut self, world: &World, dt: f32);
}

/// Measures steps.
#[cfg(feature = "observe")]
pub(crate) trait StepMeter: std::any::Any + std::fmt::Debug + Send + Sync {
    /// The observer of the solver.
    fn witness(&mut self) -> &mut dyn crate::solver::Witness;
    /// Called before rows are solved, over a step of `dt` seconds.
    fn before_rows(&mut self, world: &mut World, dt: f32);
    /// Called after that; it may solve them more accurately.
    fn after_rows(&mut self, world: &mut World);
    /// Called once bodies have moved.
    fn after_step(&mut self, world: &World);
}

/// Without the features of observers there is no code for them; with the features, but no observer, a
/// predictable branch.
#[cfg_attr(
    not(all(feature = "replay", feature = "observe")),
    allow(unused_variables, clippy::unused_self, reason = "nobody looks on")
)]
impl World {
    /// Records a change, before anything is changed and when nothing can refuse it any more.
    #[inline]
    pub(crate) fn note(&mut self, change: Change<'_>) {
        #[cfg(feature = "replay")]
        if self.recorder.is_some() {
            let asked = self.was_asked();
            if let Some(recorder) = &mut self.recorder {
                recorder.note(change, asked);
            }
        }
    }

    #[inline]
    pub(crate) fn note_step_begins(&mut self) {
        #[cfg(feature = "replay")]
        {
            let asked = self.was_asked();
            if let Some(recorder) = &mut self.recorder {
                recorder.begin_step(asked);
            }
        }
    }

    #[inline]
    pub(crate) fn note_stage(&mut self, stage: Stage) {
        #[cfg(feature = "replay")]
        if let Some(mut recorder) = self.recorder.take() {
            recorder.look(self, stage);
            self.recorder = Some(recorder);
        }
    }

    #[inline]
    pub(crate) fn note_step_ends(&mut self, dt: f32) {
        #[cfg(feature = "replay")]
        if let Some(mut recorder) = self.recorder.take() {
            recorder.end_step(self, dt);
            self.recorder = Some(recorder);
        }
    }

    /// Measures the rows of a step of `dt` seconds before they are solved.
    #[inline]
    pub(crate) fn measure_rows(&mut self, dt: f32) {
        #[cfg(feature = "observe")]
        if let Some(mut meter) = self.meter.take() {
            meter.before_rows(self, dt);
            self.meter = Some(meter);
        }
    }

    /// Measures how accurately they were solved.
    #[inline]
    pub(crate) fn measure_solution(&mut self) {
        #[cfg(feature = "observe")]
        if let Some(mut meter) = self.meter.take() {
            meter.after_rows(self);
            self.meter = Some(meter);
        }
    }

    /// Measures the step, once bodies have moved.
    #[inline]
    pub(crate) fn measure_step(&mut self) {
        #[cfg(feature = "observe")]
        if let Some(mut meter) = self.meter.take() {
            meter.after_step(self);
            self.meter = Some(meter);
        }
    }

    /// Whether queries may have made the world hold more memory, which a budget counts.
    #[cfg(feature = "replay")]
    pub(crate) fn was_asked(&self) -> bool {
        !self.settings.budget.is_none() && self.now.is_fresh()
    }
}
