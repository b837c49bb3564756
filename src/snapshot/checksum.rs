//! The checksum of snapshots. Tests and fuzz targets include this file to make one right that they changed.

/// A hash of words: a folded product of 128 bits for each two words, as in wyhash (Wang Yi, *Modern
/// Non-Cryptographic Hash Function*, 2019), in four independent lanes.
pub(crate) fn hash(words: &[u32]) -> u64 {
    const KEYS: [u64; 4] =
        [0xa076_1d64_78bd_642f, 0xe703_7ed1_a0b4_28db, 0x8ebc_6af0_9c88_c6e3, 0x5899_65cc_7537_4cc3];
    let fold = |a: u64, b: u64| {
        let product = u128::from(a) * u128::from(b);
        product as u64 ^ (product >> 64) as u64
    };
    let mut lanes = KEYS;
    let two = |w: &[u32]| u64::from(w[0]) | u64::from(w.get(1).copied().unwrap_or(0)) << 32;
    for eight in words.chunks(8) {
        for (lane, pair) in eight.chunks(2).enumerate() {
            lanes[lane] = fold(lanes[lane] ^ two(pair), KEYS[lane] | 1).wrapping_add(two(pair));
        }
    }
    let ends =
        lanes.into_iter().fold(words.len() as u64, |h, lane| fold(h ^ lane, KEYS[0]).wrapping_add(lane));
    fold(ends ^ KEYS[1], KEYS[2])
}
