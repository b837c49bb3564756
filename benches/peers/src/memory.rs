//! Memory of this process, as Linux reports it.

/// A field of `/proc/self/status` [KiB], such as `VmRSS` or its peak `VmHWM`; nothing elsewhere.
pub(crate) fn status_kib(field: &str) -> Option<u64> {
    let status = std::fs::read_to_string("/proc/self/status").ok()?;
    let line = status.lines().find_map(|line| line.strip_prefix(field)?.strip_prefix(':'))?;
    line.trim().trim_end_matches("kB").trim().parse().ok()
}

/// Gives freed memory back to the system, so that later growth is seen.
#[cfg(target_env = "gnu")]
pub(crate) fn trim() {
    unsafe extern "C" {
        fn malloc_trim(pad: usize) -> i32;
    }
    // SAFETY: a function of the C library without conditions.
    unsafe { malloc_trim(0) };
}

/// Elsewhere there is no such call.
#[cfg(not(target_env = "gnu"))]
pub(crate) fn trim() {}
