//! Time for which this thread works.

use std::time::Instant;

/// A clock, by the time of its start.
pub(super) struct Clock {
    processor: Option<u64>,
    wall: Instant,
}

impl Clock {
    pub(super) fn start() -> Clock {
        Clock { processor: processor_time(), wall: Instant::now() }
    }

    /// Time since the start [us]: processor time if the system provides it (Linux does), so that other load
    /// on the machine matters as little as possible; else wall time.
    pub(super) fn stop(&self) -> f64 {
        match (self.processor, processor_time()) {
            (Some(start), Some(end)) if end > start => (end - start) as f64 * 1e-3,
            _ => self.wall.elapsed().as_secs_f64() * 1e6,
        }
    }
}

/// Total processor time of this thread [ns].
fn processor_time() -> Option<u64> {
    // Linux updates the account when it schedules a thread.
    std::thread::yield_now();
    let text = std::fs::read_to_string("/proc/thread-self/schedstat").ok()?;
    // A kernel that keeps no account reports zero.
    text.split_whitespace().next()?.parse().ok().filter(|&time| time > 0)
}
