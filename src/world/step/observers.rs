//! Observers: recorders of changes to a world, and meters of its steps. A world owns and calls them; how they
//! use the calls is up to them.

use crate::body::{BodyDesc, BodyKind};
use crate::config::{Continuous, RowGroup, Settings};
#[cfg(feature = "replay")]
use crate::constraint::Tweak;
use crate::handle::{BodyHandle, CharacterHandle, CouplingHandle, JointHandle, ShapeHandle};
use crate::joint::{Axes, Axis, CouplingDesc, Drive, Frame, JointDesc, Limit, Motion};
use crate::shape::{Filter, Geometry, HolePatch, MassProperties, Material, Patch, ShapeDesc};
use crate::world::{Resident, Stage, World};
use glam::{DVec3, Vec3};

/// A change that a call is about to make, named after the methods of [`World`].
#[derive(Clone, Copy, Debug)]
#[cfg_attr(not(feature = "replay"), allow(dead_code, reason = "nobody records it"))]
pub(crate) enum Change<'a> {
    SetSettings(&'a Settings),
    SetOrigin(DVec3),
    AddBody(&'a BodyDesc),
    AddBodies(&'a [BodyDesc]),
    RemoveBody(BodyHandle),
    AddShape(BodyHandle, &'a ShapeDesc),
    RemoveShape(ShapeHandle),
    SetMaterial(ShapeHandle, Material),
    SetFilter(ShapeHandle, Filter),
    SetListening(ShapeHandle, bool, bool),
    SetSensor(ShapeHandle, bool),
    SetSensesStatic(ShapeHandle, bool),
    SetPose(BodyHandle, DVec3, glam::Quat),
    SetVelocity(BodyHandle, Vec3, Vec3),
    AddForce(BodyHandle, Vec3, Vec3),
    ApplyImpulse(BodyHandle, Vec3, DVec3),
    SetGravityScale(BodyHandle, f32),
    SetContinuous(BodyHandle, Continuous),
    SolveBodyAfter(BodyHandle, Option<RowGroup>),
    SetMass(BodyHandle, MassProperties),
    AddJoint(&'a JointDesc),
    AddJoints(&'a [JointDesc]),
    RemoveJoint(JointHandle),
    SetJointDrive(JointHandle, Drive),
    RemoveJointDrive(JointHandle, Motion, Axis),
    SetJointTarget(JointHandle, Motion, Axis, [f32; 2]),
    SetJointLimit(JointHandle, Limit),
    RemoveJointLimit(JointHandle, Motion, Axes),
    SetJointLimits(JointHandle, &'a [Limit]),
    SetJointDrives(JointHandle, &'a [Drive]),
    SetJointFrames(JointHandle, [Frame; 2]),
    SetJointCollide(JointHandle, bool),
    SetJointStrength(JointHandle, [f32; 2]),
    SetJointThresholds(JointHandle, [f32; 2]),
    SetJointUserData(JointHandle, u64),
    SolveJointAfter(JointHandle, Option<RowGroup>),
    AddCoupling(&'a CouplingDesc),
    RemoveCoupling(CouplingHandle),
    SetCouplingFactors(CouplingHandle, [f64; 2]),
    SetCouplingRange(CouplingHandle, Option<[f64; 2]>),
    SetCouplingStrength(CouplingHandle, [f32; 2]),
    SetCouplingUserData(CouplingHandle, u64),
    Wake(BodyHandle),
    SendToSleep(BodyHandle),
    SetCanSleep(BodyHandle, bool),
    SetEnabled(BodyHandle, bool),
    SetKind(BodyHandle, BodyKind),
    SetUserData(BodyHandle, u64),
    SetDamping(BodyHandle, f32, f32),
    SetMaxSpeeds(BodyHandle, Option<f32>, Option<f32>),
    SetLocks(BodyHandle, [bool; 3], [bool; 3]),
    SetLinearVelocity(BodyHandle, Vec3),
    SetAngularVelocity(BodyHandle, Vec3),
    MoveKinematic(BodyHandle, DVec3, glam::Quat, f32),
    MoveKinematicAndStop(BodyHandle, DVec3, glam::Quat, f32),
    ApplyAngularImpulse(BodyHandle, Vec3),
    SetShapeUserData(ShapeHandle, u64),
    SetGeometry(ShapeHandle, &'a Geometry),
    SetShapePose(ShapeHandle, Vec3, glam::Quat),
    SetDensity(ShapeHandle, f32),
    SetHeights(ShapeHandle, &'a Patch<'a>),
    SetHoles(ShapeHandle, &'a HolePatch<'a>),
    AddCharacter(&'a Resident),
    RemoveCharacter(CharacterHandle),
    SetCharacter(CharacterHandle, &'a Resident),
    /// The state of a character after a walk.
    WalkCharacter(CharacterHandle, &'a [u32]),
    /// A snapshot, of which a world knows no more.
    Restore(&'a dyn std::any::Any),
}

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
    /// Who observes the solver.
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
