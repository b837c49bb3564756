//! The way back: a snapshot of each of the last steps.

use backstop::{Error, Grab, Snapshot, World};
use std::{any::Any, collections::VecDeque, rc::Rc};

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
    /// What the sample keeps beside its world.
    pub(crate) state: Option<Rc<dyn Any>>,
}

/// A moment, and the world at that time.
#[derive(Debug)]
struct Kept {
    moment: Moment,
    snapshot: Snapshot,
    /// Bytes of what it shares with those after it, if it is the first that has it: bodies and shapes.
    shared: usize,
}

impl Kept {
    fn bytes(&self) -> usize {
        self.snapshot.size() + self.shared
    }
}

/// Times to go back to, in the order of their steps, without a gap. After a step back those that lie ahead
/// are kept until a step or a change makes them another future.
#[derive(Debug)]
pub(crate) struct History {
    kept: VecDeque<Kept>,
    /// Of all that is kept.
    bytes: usize,
    most_bytes: usize,
    /// A snapshot whose buffer is used again.
    spare: Option<Snapshot>,
}

impl Default for History {
    fn default() -> History {
        History { kept: VecDeque::new(), bytes: 0, most_bytes: MOST_BYTES, spare: None }
    }
}

impl History {
    /// Keeps the world as it is at this moment, in place of what was kept of this step and of later ones.
    pub(crate) fn keep(&mut self, world: &World, moment: Moment) {
        self.forget_from(moment.step);
        while self.kept.len() >= MOST_STEPS || self.bytes > self.most_bytes {
            let Some(mut first) = self.kept.pop_front() else { break };
            if let Some(next) = self.kept.front_mut().filter(|next| next.shared == 0) {
                next.shared = std::mem::take(&mut first.shared);
            }
            self.bytes -= first.bytes();
            self.spare = Some(first.snapshot);
        }
        let mut snapshot = self.spare.take().unwrap_or_default();
        world.snapshot(&mut snapshot);
        // What has another size is another; what has the same is most probably shared.
        let before = self.kept.back().map(|last| last.snapshot.shared_size());
        let shared = Some(snapshot.shared_size()).filter(|&size| before != Some(size)).unwrap_or(0);
        let kept = Kept { moment, snapshot, shared };
        self.bytes += kept.bytes();
        self.kept.push_back(kept);
    }

    /// Forgets this step and later ones: the world has changed.
    pub(crate) fn forget_from(&mut self, step: u64) {
        while self.has_from(step)
            && let Some(last) = self.kept.pop_back()
        {
            self.bytes -= last.bytes();
            self.spare = Some(last.snapshot);
        }
    }

    /// Whether this step or a later one is kept.
    fn has_from(&self, step: u64) -> bool {
        self.kept.back().is_some_and(|last| last.moment.step >= step)
    }

    fn place(&self, step: u64) -> Option<usize> {
        self.kept.binary_search_by_key(&step, |kept| kept.moment.step).ok()
    }

    /// Whether this step is kept.
    pub(crate) fn has(&self, step: u64) -> bool {
        self.place(step).is_some()
    }

    /// Brings a step back, if it is kept.
    pub(crate) fn restore(&self, world: &mut World, step: u64) -> Result<Option<Moment>, Error> {
        let Some(place) = self.place(step) else { return Ok(None) };
        let Kept { moment, snapshot, .. } = &self.kept[place];
        world.restore(snapshot)?;
        Ok(Some(moment.clone()))
    }

    /// Steps before and after this one that are kept.
    pub(crate) fn around(&self, step: u64) -> [usize; 2] {
        let before = self.kept.partition_point(|kept| kept.moment.step < step);
        let upto = self.kept.partition_point(|kept| kept.moment.step <= step);
        [before, self.kept.len() - upto]
    }

    /// The first step that is kept.
    pub(crate) fn first(&self) -> Option<u64> {
        self.kept.front().map(|kept| kept.moment.step)
    }

    /// Bytes of all that is kept, but for geometry, which the world has.
    pub(crate) fn bytes(&self) -> usize {
        self.bytes
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use backstop::Settings;

    #[test]
    fn no_more_is_kept_than_there_is_room_for() {
        let world = World::new(Settings::default()).unwrap();
        let moment = |step: u64| Moment { step, time: 0.0, dt: 0.1, grab: None, state: None };
        let mut history = History::default();
        for step in 0..1000 {
            history.keep(&world, moment(step));
        }
        assert_eq!((history.first(), history.around(1000)), (Some(400), [600, 0]));
        let Kept { snapshot, shared, .. } = &history.kept[0];
        assert_eq!(history.bytes(), 600 * snapshot.size() + shared);
        history.most_bytes = 10 * snapshot.size() + shared;
        history.keep(&world, moment(1000));
        assert_eq!(history.around(1001), [11, 0]);
        // A step that is kept anew ends what was ahead of it.
        history.keep(&world, moment(995));
        assert_eq!((history.has(996), history.around(995)[1]), (false, 0));
        history.forget_from(0);
        assert_eq!((history.bytes(), history.first()), (0, None));
    }
}
