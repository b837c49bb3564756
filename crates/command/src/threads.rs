//! The thread pool that steps may use.

use anyhow::Context;

/// Runs `f` in a pool of `threads` threads.
pub(crate) fn with_threads<R: Send>(
    threads: usize,
    f: impl FnOnce() -> anyhow::Result<R> + Send,
) -> anyhow::Result<R> {
    if threads == 1 {
        return f();
    }
    let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build();
    pool.context("can't start threads")?.install(f)
}
