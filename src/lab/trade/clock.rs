//! Time that this thread works.

use std::time::Instant;

/// A start.
pub(super) struct Clock {
    processor: Option<u64>,
    wall: Instant,
}

impl Clock {
    pub(super) fn start() -> Clock {
        Clock { processor: processor_time(), wall: Instant::now() }
    }

    /// Since the start [us]: time on a processor where the system tells it (Linux does), so that others who use the machine count
    /// as little as they can; else wall time.
    pub(super) fn stop(&self) -> f64 {
        match (self.processor, processor_time()) {
            (Some(start), Some(end)) if end > start => (end - start) as f64 * 1e-3,
            _ => self.wall.elapsed().as_secs_f64() * 1e6,
        }
    }
}

/// That this thread ever had [ns].
fn processor_time() -> Option<u64> {
    // Linux brings its account up to date where it chooses a thread to run.
    std::thread::yield_now();
    let text = std::fs::read_to_string("/proc/thread-self/schedstat").ok()?;
    // A kernel that keeps no account says zero.
    text.split_whitespace().next()?.parse().ok().filter(|&time| time > 0)
}
