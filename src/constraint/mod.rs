//! Contacts in, batches of rows out: ordered by importance, coloured, packed in lanes.

pub(crate) mod articulation;
pub(crate) mod contact;
pub(crate) mod joint;
mod restitution;
pub(crate) mod schedule;

pub(crate) use contact::batch::{Batch, BatchRef};
pub(crate) use contact::expect::lend;
pub(crate) use contact::friction::{FrictionRow, FrictionView};
pub(crate) use contact::impact_friction::rub;
pub(crate) use joint::arrange::{JointInput, JointRows, JointStage, JointType};
pub(crate) use joint::ends::{JointPass, Recovery};
pub(crate) use joint::nets::{FOLLOWED, NetInput};
pub(crate) use joint::run::JointViews;
pub(crate) use schedule::arrange::{PrepareScratch, Prepared};
pub(crate) use schedule::part::Part;
/// The most that a row of a joint takes in the batches: a lane of them all to itself, or a node of two trees that are alike
/// with the rows of a cut joint.
pub(crate) const WIDEST_JOINT_BATCH: usize = {
    let (row, node) = (
        size_of::<
            crate::constraint::joint::row::RowBatch<
                crate::lanes::f32x8,
                crate::constraint::joint::measure::Tilt<crate::lanes::f32x8>,
            >,
        >(),
        (size_of::<crate::constraint::articulation::node::Node<crate::lanes::f32x8>>()
            + 3 * crate::constraint::articulation::cut::ROW_BYTES)
            / 2,
    );
    if row > node { row } else { node }
};
/// Bytes of a joint's lock and of another row of it in a lane that is filled, and of a body in a tree that has no like.
pub(crate) const JOINT_BYTES: [usize; 3] = {
    type Row = crate::constraint::joint::row::RowBatch<
        crate::lanes::f32x8,
        crate::constraint::joint::measure::Tilt<crate::lanes::f32x8>,
    >;
    [
        size_of::<crate::constraint::joint::lock::PointBatch<crate::lanes::f32x8>>() / 8 + size_of::<u32>(),
        size_of::<Row>() / 8 + size_of::<u32>(),
        size_of::<articulation::node::Node<f32>>(),
    ]
};
pub(crate) use articulation::close::Closing;
pub(crate) use articulation::contacts::guard;
pub(crate) use articulation::slots::{Seat, Seats, TreeRef};
pub(crate) use contact::prepare::{PrepareInput, prepare};
#[cfg(feature = "lab")]
pub(crate) use contact::readout::{ContactLane, FrictionLane};
pub(crate) use contact::rows::{Rows, Surface, Views, with_batch};
pub(crate) use contact::step_lengths::{StepLengths, evenness, usual_substep};
pub(crate) use restitution::{Bodies as Struck, FindInput, Restitution, find};
pub(crate) use schedule::order::{Group, Stage};
pub use schedule::order::{Order, RowGroup};
