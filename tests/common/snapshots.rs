//! The checksum of snapshots once more, so that tests can put a wrong one right.

/// Words of the head: the last two are the checksum.
const HEAD: usize = 14;

fn hash(words: &[u32]) -> u64 {
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

/// Makes the checksum that of the bytes, and their number a multiple of four.
pub(crate) fn fix_checksum(bytes: &mut Vec<u8>) {
    bytes.truncate(bytes.len() / 4 * 4);
    let mut words: Vec<u32> =
        bytes.chunks_exact(4).map(|four| u32::from_le_bytes(four.try_into().unwrap())).collect();
    if words.len() < HEAD {
        return;
    }
    words[HEAD - 2..HEAD].fill(0);
    let sum = hash(&words);
    bytes[(HEAD - 2) * 4..HEAD * 4].copy_from_slice(&sum.to_le_bytes());
}
