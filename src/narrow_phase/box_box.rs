//! To be written.
use super::lanes_io::{ManifoldLanes, PairLanes};
use crate::lanes::Lanes;
pub(crate) fn box_box<L: Lanes>(p: &PairLanes<L>) -> ManifoldLanes<L> {
    todo!()
}
