//! The time of day, where there is one.

#[cfg(not(all(target_arch = "wasm32", target_os = "unknown")))]
pub(crate) use std::time::Instant;

#[cfg(all(target_arch = "wasm32", target_os = "unknown", feature = "web-time"))]
pub(crate) use web_time::Instant;

/// Bare WebAssembly has no clock, and the standard library's panics there: all times are zero. The feature
/// `web-time` takes the clock of the browser.
#[cfg(all(target_arch = "wasm32", target_os = "unknown", not(feature = "web-time")))]
#[derive(Clone, Copy, Debug)]
pub(crate) struct Instant;

#[cfg(all(target_arch = "wasm32", target_os = "unknown", not(feature = "web-time")))]
impl Instant {
    pub(crate) fn now() -> Instant {
        Instant
    }

    pub(crate) fn elapsed(self) -> std::time::Duration {
        std::time::Duration::ZERO
    }
}

#[cfg(all(target_arch = "wasm32", target_os = "unknown", not(feature = "web-time")))]
impl std::ops::Sub for Instant {
    type Output = std::time::Duration;
    fn sub(self, _: Instant) -> std::time::Duration {
        std::time::Duration::ZERO
    }
}
