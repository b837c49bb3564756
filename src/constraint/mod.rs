//! Contacts in, batches of rows out: ordered by importance, coloured, packed in lanes.

mod arrange;
mod batch;
mod colour;
pub(crate) mod contact_row;
pub(crate) mod crowd;
mod expect;
mod free_turn;
mod friction;
mod impact_friction;
mod joint_arrange;
mod joint_close;
mod joint_cut;
mod joint_damp;
mod joint_ends;
mod joint_fill;
mod joint_line;
mod joint_lock;
mod joint_measure;
mod joint_nets;
mod joint_rates;
mod joint_rattle;
mod joint_row;
mod joint_run;
mod joint_tour;
mod joint_tree;
mod joint_trees;
mod keys;
mod order;
mod prepare;
#[cfg(feature = "lab")]
mod readout;
mod restitution;
mod rows;
mod seats;
mod spatial;
mod step_lengths;
mod tweak;

pub(crate) use arrange::{Part, PrepareScratch, Prepared};
pub(crate) use batch::{Batch, BatchRef};
pub(crate) use expect::lend;
pub(crate) use friction::{FrictionRow, FrictionView};
pub(crate) use impact_friction::rub;
pub(crate) use joint_arrange::{JointInput, JointRows, JointStage, JointType};
pub(crate) use joint_ends::{JointPass, Recovery};
pub(crate) use joint_nets::{FOLLOWED, NetInput};
pub(crate) use joint_run::JointViews;
/// The most that a row of a joint takes in the batches: a lane of them all to itself, or a node of two trees that are alike
/// with the rows of a cut joint.
pub(crate) const WIDEST_JOINT_BATCH: usize = {
    let (row, node) = (
        size_of::<joint_row::RowBatch<crate::lanes::f32x8, joint_measure::Tilt<crate::lanes::f32x8>>>(),
        (size_of::<joint_tree::Node<crate::lanes::f32x8>>() + 3 * joint_cut::ROW_BYTES) / 2,
    );
    if row > node { row } else { node }
};
/// Bytes of a joint's lock and of another row of it in a lane that is filled, and of a body in a tree that has no like.
pub(crate) const JOINT_BYTES: [usize; 3] = {
    type Row = joint_row::RowBatch<crate::lanes::f32x8, joint_measure::Tilt<crate::lanes::f32x8>>;
    [
        size_of::<joint_lock::PointBatch<crate::lanes::f32x8>>() / 8 + size_of::<u32>(),
        size_of::<Row>() / 8 + size_of::<u32>(),
        size_of::<joint_tree::Node<f32>>(),
    ]
};
pub(crate) use joint_close::Closing;
pub(crate) use joint_tour::guard;
pub(crate) use order::{Group, Stage};
pub(crate) use prepare::{PrepareInput, prepare};
#[cfg(feature = "lab")]
pub(crate) use readout::{ContactLane, FrictionLane};
pub(crate) use restitution::{Bodies as Struck, FindInput, Restitution, find};
pub(crate) use rows::{Rows, Surface, Views, with_batch};
pub(crate) use seats::{Seat, Seats, TreeRef};
pub(crate) use step_lengths::{StepLengths, evenness, usual_substep};
pub(crate) use tweak::{Tweak, tweak_of};
