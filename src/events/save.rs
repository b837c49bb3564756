//! Events in snapshots: the pairs that ended since the last step, which the next one reports.

use super::{Events, Gone};
use crate::error::Error;
use crate::handle::ShapeHandle;
use crate::words::{Reader, broken};

/// Words of a pair.
const GONE: usize = 5;

/// How many pairs ended since the last step, and how many of those there was no memory for.
#[derive(Clone, Copy, Debug, Default, bytemuck::Pod, bytemuck::Zeroable)]
#[repr(C)]
pub(crate) struct EventLists {
    gone: u32,
    missed: u32,
}

/// Saved events, in their words.
#[derive(Clone, Copy)]
pub(crate) struct SavedEvents<'a> {
    gone: &'a [u32],
    missed: u32,
}

impl Events {
    /// Writes the pairs that ended since the last step.
    pub(crate) fn save(&self, out: &mut Vec<u32>) -> EventLists {
        let Events {
            gone,
            missed,
            // Of the last step.
            begins: _,
            ends: _,
            hits: _,
            entered: _,
            left: _,
            impulses: _,
            tweaks: _,
            vetoed: _,
            lost: _,
            allowance: _,
        } = self;
        for Gone { shapes: [a, b], sensor } in gone {
            out.extend([a.slot, a.generation, b.slot, b.generation, u32::from(*sensor)]);
        }
        EventLists { gone: gone.len() as u32, missed: *missed }
    }

    /// Takes the pairs that ended before the snapshot, and forgets the events of a step that was undone.
    pub(crate) fn restore(&mut self, saved: &SavedEvents<'_>) {
        self.start();
        self.gone.clear();
        self.missed = saved.missed;
        for &[slot_a, generation_a, slot_b, generation_b, sensor] in saved.gone.as_chunks::<GONE>().0 {
            let handle = |slot, generation| ShapeHandle { slot, generation };
            let shapes = [handle(slot_a, generation_a), handle(slot_b, generation_b)];
            let gone = Gone { shapes, sensor: sensor != 0 };
            self.missed += u32::from(!self.allowance.push(&mut self.gone, gone));
        }
    }
}

impl<'a> SavedEvents<'a> {
    pub(crate) fn read(from: &mut Reader<'a>, lists: EventLists) -> Result<SavedEvents<'a>, Error> {
        Ok(SavedEvents { gone: from.table(lists.gone, GONE)?, missed: lists.missed })
    }

    /// Whether it can be counted how many were missed. Handles may be of any shape: those of removed ones
    /// are stale.
    pub(crate) fn check(&self) -> Result<(), Error> {
        let most = u32::MAX / 2;
        if self.missed < most { Ok(()) } else { Err(broken("the number of events")) }
    }
}
