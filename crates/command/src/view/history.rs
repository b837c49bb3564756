//! The way back: snapshots of a run. What lies between two of them is stepped again, to the same bits.

use backstop::{Snapshot, World};

/// Bytes of all snapshots, at most; long runs of large worlds keep fewer.
const ROOM: usize = 256 << 20;

pub(super) struct History {
    /// One of every so many steps, from the start.
    snapshots: Vec<Snapshot>,
    every: u64,
    bytes: usize,
    room: usize,
}

impl History {
    pub(super) fn new() -> History {
        History { snapshots: Vec::new(), every: 1, bytes: 0, room: ROOM }
    }

    /// Keeps the world after so many steps, if it is the turn of this step.
    pub(super) fn keep(&mut self, world: &World, step: u64) {
        if step != self.snapshots.len() as u64 * self.every {
            return;
        }
        let mut snapshot = Snapshot::new();
        world.snapshot(&mut snapshot);
        self.bytes += snapshot.size();
        self.snapshots.push(snapshot);
        while self.bytes > self.room && self.snapshots.len() > 2 {
            let mut even = false;
            self.snapshots.retain(|_| {
                even = !even;
                even
            });
            self.every *= 2;
            self.bytes = self.snapshots.iter().map(Snapshot::size).sum();
        }
    }

    /// The last snapshot that is of this step or before, and its step.
    pub(super) fn before(&self, step: u64) -> Option<(u64, &Snapshot)> {
        let last = self.snapshots.len().checked_sub(1)? as u64;
        let index = (step / self.every).min(last);
        Some((index * self.every, &self.snapshots[index as usize]))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use backstop::Settings;

    #[test]
    fn what_outgrows_its_room_is_kept_half_as_often() {
        let world = World::new(Settings::default()).unwrap();
        let mut one = Snapshot::new();
        world.snapshot(&mut one);
        let mut history = History { room: 10 * one.size(), ..History::new() };
        for step in 0..100 {
            history.keep(&world, step);
            assert!(history.bytes <= history.room);
        }
        // 100 steps into ten places: every sixteenth.
        assert_eq!(history.every, 16);
        assert_eq!([0, 15, 16, 99, 1000].map(|step| history.before(step).unwrap().0), [0, 0, 16, 96, 96]);
    }
}
