//! Contacts and joints in, batches of rows out: ordered by importance, coloured, packed in lanes.

pub(crate) mod articulation;
pub(crate) mod contact;
mod impact_body;
pub(crate) mod joint;
mod restitution;
pub(crate) mod schedule;
mod tweak;

pub(crate) use articulation::contacts::guard;
pub(crate) use articulation::slots::{TreeRef, TreeSlot, TreeSlots};
pub(crate) use contact::batch::Batch;
pub(crate) use contact::expect::{lend, row_cost};
pub(crate) use contact::friction::impact::solve_impact_friction;
pub(crate) use contact::friction::{FrictionRow, RollingRow};
pub(crate) use contact::input::{Beside, PrepareInput};
pub(crate) use contact::prepare::prepare;
#[cfg(feature = "observe")]
pub(crate) use contact::readout::{ContactLane, FrictionLane};
pub(crate) use contact::rows::{Rows, Views, with_batch};
pub(crate) use contact::soft::bodies::move_by_mean;
pub(crate) use contact::step_lengths::{StepLengths, evenness, usual_substep};
pub(crate) use impact_body::ImpactBody;
pub(crate) use joint::arrange::{JointRows, arranged_alike};
#[cfg(feature = "observe")]
pub(crate) use joint::batch::RowImpulse;
pub(crate) use joint::ends::{JointPass, Recovery};
pub(crate) use joint::kinds::{JOINT_BYTES, JointStage, JointType, WIDEST_JOINT_BATCH};
pub(crate) use joint::nets::{NetInput, Nets};
pub(crate) use joint::run::{JointViews, TouchInput};
pub(crate) use restitution::{Bodies as Struck, Restitution, find};
pub(crate) use schedule::arrange::{PrepareScratch, Prepared};
pub(crate) use schedule::order::{Group, Stage};
pub(crate) use schedule::part::Part;
pub(crate) use tweak::{Tweak, tweak_of};
