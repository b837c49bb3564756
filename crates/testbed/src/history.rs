//! The way back: a snapshot of each of the last steps.

use crate::tools::Grab;
use backstop::{Error, Snapshot, World};
use std::collections::VecDeque;

/// Steps that are kept, at most, and the bytes of their snapshots.
const MOST_STEPS: usize = 600;
const MOST_BYTES: usize = 128 << 20;

/// What belongs to a time beside the state of the world.
#[derive(Clone, Debug)]
pub(crate) struct Moment {
    /// Steps since the start.
    pub(crate) step: u64,
    /// Time since the start [s].
    pub(crate) time: f64,
    /// Length of the next step [s].
    pub(crate) dt: f32,
    /// What is held.
    pub(crate) grab: Option<Grab>,
}

/// Times to go back to, in the order of their steps, without a gap. After a step back those that lie ahead
/// are kept until a step or a change makes them another future.
#[derive(Debug)]
pub(crate) struct History {
    kept: VecDeque<(Moment, Snapshot)>,
    /// Of all that is kept.
    bytes: usize,
    most_bytes: usize,
    /// Snapshots whose buffers are used again.
    spare: Vec<Snapshot>,
}

impl Default for History {
    fn default() -> History {
        History { kept: VecDeque::new(), bytes: 0, most_bytes: MOST_BYTES, spare: Vec::new() }
    }
}

impl History {
    /// Keeps the world as it is at this moment, in place of what was kept of this step and of later ones.
    pub(crate) fn keep(&mut self, world: &World, moment: Moment) {
        self.forget_from(moment.step);
        while self.kept.len() >= MOST_STEPS || (self.bytes > self.most_bytes && !self.kept.is_empty()) {
            let first = self.kept.pop_front();
            self.drop_snapshots(first.into_iter());
        }
        let mut snapshot = self.spare.pop().unwrap_or_default();
        self.spare.clear();
        world.snapshot(&mut snapshot);
        self.bytes += size(&snapshot);
        self.kept.push_back((moment, snapshot));
    }

    /// Forgets this step and later ones: the world has changed.
    pub(crate) fn forget_from(&mut self, step: u64) {
        let from = self.kept.partition_point(|(moment, _)| moment.step < step);
        let gone: Vec<_> = self.kept.drain(from..).collect();
        self.drop_snapshots(gone.into_iter());
    }

    fn drop_snapshots(&mut self, gone: impl Iterator<Item = (Moment, Snapshot)>) {
        for (_, snapshot) in gone {
            self.bytes -= size(&snapshot);
            self.spare.push(snapshot);
        }
    }

    /// Whether this step is kept.
    pub(crate) fn has(&self, step: u64) -> bool {
        self.kept.binary_search_by_key(&step, |(moment, _)| moment.step).is_ok()
    }

    /// Brings a step back, if it is kept.
    pub(crate) fn restore(&self, world: &mut World, step: u64) -> Result<Option<Moment>, Error> {
        let Ok(place) = self.kept.binary_search_by_key(&step, |(moment, _)| moment.step) else {
            return Ok(None);
        };
        let (moment, snapshot) = &self.kept[place];
        world.restore(snapshot)?;
        Ok(Some(moment.clone()))
    }

    /// Steps before and after this one that are kept.
    pub(crate) fn around(&self, step: u64) -> [usize; 2] {
        let before = self.kept.partition_point(|(moment, _)| moment.step < step);
        let upto = self.kept.partition_point(|(moment, _)| moment.step <= step);
        [before, self.kept.len() - upto]
    }

    /// The first step that is kept.
    pub(crate) fn first(&self) -> Option<u64> {
        self.kept.front().map(|(moment, _)| moment.step)
    }

    /// Bytes of all that is kept. What snapshots share is counted for each of them, so this is too much.
    pub(crate) fn bytes(&self) -> usize {
        self.bytes
    }
}

fn size(snapshot: &Snapshot) -> usize {
    snapshot.size()
}

#[cfg(test)]
mod tests {
    use super::*;
    use backstop::Settings;

    #[test]
    fn no_more_is_kept_than_there_is_room_for() {
        let world = World::new(Settings::default()).unwrap();
        let moment = |step: u64| Moment { step, time: 0.0, dt: 0.1, grab: None };
        let mut history = History::default();
        for step in 0..1000 {
            history.keep(&world, moment(step));
        }
        assert_eq!((history.first(), history.around(1000)), (Some(400), [600, 0]));
        let one = history.bytes() / 600;
        history.most_bytes = 10 * one;
        history.keep(&world, moment(1000));
        assert_eq!(history.around(1001), [11, 0]);
        // A step that is kept anew ends what was ahead of it.
        history.keep(&world, moment(995));
        assert_eq!((history.has(996), history.around(995)[1]), (false, 0));
        history.forget_from(0);
        assert_eq!((history.bytes(), history.first()), (0, None));
    }
}
