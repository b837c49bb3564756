//! Calls of worlds of everything, in any order and with any numbers.
//!
//! [`generate`] makes a [`Sequence`] out of bytes, which [`judge`] plays. Calls are data, so that those which
//! matter are found by leaving others out ([`shrink`]).

mod budget;
mod call;
mod draw;
mod forms;
mod generate;
mod judge;
mod play;
mod shrink;
mod things;
mod told;

use super::input::Input;
pub use call::Sequence;
pub use shrink::{outcome, shrink};

/// The sequence of some bytes.
pub fn sequence(bytes: &[u8]) -> Sequence {
    generate::sequence(draw::Draw::new(Input::new(bytes)))
}

/// The bytes of a seed.
pub fn bytes_of(seed: u64) -> Vec<u8> {
    let mut state = seed;
    let words = (0..800).flat_map(|_| {
        // SplitMix64, as in src/random.rs.
        state = state.wrapping_add(0x9E37_79B9_7F4A_7C15);
        let z = (state ^ (state >> 30)).wrapping_mul(0xBF58_476D_1CE4_E5B9);
        let z = (z ^ (z >> 27)).wrapping_mul(0x94D0_49BB_1331_11EB);
        (z ^ (z >> 31)).to_le_bytes()
    });
    words.collect()
}

/// Plays the sequence of some bytes; what goes wrong panics with the fewest calls.
pub fn run(bytes: &[u8]) {
    let (sequence, nowhere) = (sequence(bytes), String::new);
    if let Some(finding) = outcome(&sequence, &nowhere) {
        let least = shrink(&sequence, &finding.kind, &nowhere);
        panic!("{}: {}\n{least}", finding.kind, finding.text);
    }
}
