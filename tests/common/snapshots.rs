//! Makes the checksum of a changed snapshot right again.

#[path = "../../src/snapshot/checksum.rs"]
mod words;

/// Words of the head: the last two are the checksum.
const HEAD: usize = 14;

/// Makes the checksum that of the bytes, and their number a multiple of four.
pub(crate) fn fix_checksum(bytes: &mut Vec<u8>) {
    bytes.truncate(bytes.len() / 4 * 4);
    let mut words: Vec<u32> =
        bytes.chunks_exact(4).map(|four| u32::from_le_bytes(four.try_into().unwrap())).collect();
    if words.len() < HEAD {
        return;
    }
    words[HEAD - 2..HEAD].fill(0);
    let sum = words::hash(&words);
    bytes[(HEAD - 2) * 4..HEAD * 4].copy_from_slice(&sum.to_le_bytes());
}
