//! Memory that the rows of contacts will need, before there are any: contacts must leave room for it.

use super::batch::BatchRef;
use super::input::Beside;
use super::rows::Rows;
use crate::config::FrictionModel;
use crate::constraint::schedule::arrange::PrepareScratch;
use crate::narrow_phase::{RowCost, RowSpace};

/// Bytes per lane of full batches. `friction`: some material has any. `beside`: other data of each batch.
pub(crate) fn row_cost(friction: bool, model: FrictionModel, beside: Beside) -> RowCost {
    let mut cost = RowCost { per_point: model == FrictionModel::Point, ..RowCost::default() };
    for (sizes, lanes) in Rows::SIZES.iter().zip(&mut cost.lanes) {
        for (potential, lanes) in lanes.iter_mut().enumerate() {
            let of_friction = if friction { sizes[5 + 2 * potential] } else { 0 };
            for (lane, size) in lanes.iter_mut().zip(sizes) {
                *lane = (size + of_friction + beside.bytes()).div_ceil(8);
            }
        }
    }
    cost
}

/// Adds to that the bytes of lists, and the memory of the last step's batches, which is returned before the
/// next are made. `lists`: bytes that other lists need for each contact, and have reserved.
pub(crate) fn lend(
    rows: &mut Rows,
    scratch: &PrepareScratch,
    mut cost: RowCost,
    lists: (usize, usize),
) -> RowSpace {
    let (each, reserved) = scratch.lists();
    cost.lists = each + size_of::<BatchRef>() + lists.0;
    cost.reserved = reserved + rows.schedule.capacity() * size_of::<BatchRef>() + lists.1;
    cost.reserved += rows.friction_bytes() + rows.beside_bytes();
    RowSpace { cost, slab: rows.lend() }
}
