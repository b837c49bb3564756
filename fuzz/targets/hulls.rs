#![no_main]

#[path = "../bodies/mod.rs"]
#[allow(dead_code, reason = "each target uses one of them")]
mod bodies;

libfuzzer_sys::fuzz_target!(|bytes: &[u8]| bodies::hulls::run(bytes));
