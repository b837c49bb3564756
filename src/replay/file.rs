//! The file: a header, then blocks, each with its length and a checksum.
//!
//! ```text
//! "backstop replay\n", version (u16)
//! kind (u8), length (u32), so many bytes, CRC-32 of all three      any number of times
//! ```
//!
//! The first block says how the world starts, the last that the recording ends; between them are calls, back
//! to back, as postcard writes them: of a world that was not new, the first restores a snapshot. Numbers of
//! the frame are little-endian. A reader that meets a kind that it doesn't know refuses the file.

use super::error::ReplayError;
use crate::config::Settings;
use crate::load_limits::Count;
use glam::DVec3;
use serde::{Deserialize, Serialize};
use std::io::{Read, Write};
use std::sync::{Arc, Mutex, PoisonError};

const MAGIC: [u8; 16] = *b"backstop replay\n";
/// Version of the format. It changes with anything that is written: a call, a setting, a stage's hash
/// (`the_format_is_that_of_its_version`).
pub(super) const VERSION: u16 = 7;

/// How the world starts.
#[derive(Debug, Serialize, Deserialize)]
pub(super) struct Start {
    /// Version of backstop that recorded.
    pub(super) engine: String,
    pub(super) settings: Settings,
    pub(super) origin: DVec3,
}

/// The recording is complete.
#[derive(Debug, Default, Serialize, Deserialize)]
pub(super) struct End {
    pub(super) steps: u64,
    pub(super) calls: u64,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Block {
    Start = 1,
    Calls = 2,
    End = 3,
}

/// Writes the header; returns its length.
pub(super) fn write_header(to: &mut impl Write) -> std::io::Result<u64> {
    to.write_all(&MAGIC)?;
    to.write_all(&VERSION.to_le_bytes())?;
    Ok(MAGIC.len() as u64 + 2)
}

/// Writes a block; returns its length.
pub(super) fn write_block(to: &mut impl Write, block: Block, payload: &[u8]) -> std::io::Result<u64> {
    let length = u32::try_from(payload.len()).map_err(std::io::Error::other)?;
    let mut head = [block as u8; 5];
    head[1..].copy_from_slice(&length.to_le_bytes());
    to.write_all(&head)?;
    to.write_all(payload)?;
    to.write_all(&checksum(&head, payload).to_le_bytes())?;
    Ok(u64::from(length) + 9)
}

fn checksum(head: &[u8], payload: &[u8]) -> u32 {
    let mut crc = crc32fast::Hasher::new();
    crc.update(head);
    crc.update(payload);
    crc.finalize()
}

/// Reads the header.
pub(super) fn read_header(from: &mut impl Read) -> Result<(), ReplayError> {
    let mut bytes = Vec::new();
    from.take(MAGIC.len() as u64 + 2).read_to_end(&mut bytes)?;
    let version = bytes.strip_prefix(&MAGIC).ok_or(ReplayError::Foreign)?;
    match version.try_into().map(u16::from_le_bytes) {
        Ok(VERSION) => Ok(()),
        Ok(found) => Err(ReplayError::Version { found, known: VERSION }),
        Err(_) => Err(ReplayError::CutOff { steps: 0 }),
    }
}

/// Reads a block of at most `bytes`. `steps`: how many there were before, for errors.
pub(super) fn read_block(
    from: &mut impl Read,
    steps: u64,
    bytes: &Count,
) -> Result<(Block, Vec<u8>), ReplayError> {
    let cut_off = |error: std::io::Error| match error.kind() {
        std::io::ErrorKind::UnexpectedEof => ReplayError::CutOff { steps },
        _ => error.into(),
    };
    let mut head = [0; 5];
    from.read_exact(&mut head).map_err(cut_off)?;
    let [kind, length @ ..] = head;
    let length = u32::from_le_bytes(length);
    bytes.allow(length as usize).map_err(|source| ReplayError::Limit { steps, source })?;
    // Not reserved ahead: a damaged length must not ask for gigabytes.
    let mut payload = Vec::new();
    from.take(length.into()).read_to_end(&mut payload)?;
    let mut sum = [0; 4];
    from.read_exact(&mut sum).map_err(cut_off)?;
    if u32::from_le_bytes(sum) != checksum(&head, &payload) {
        return Err(ReplayError::Damaged { steps, what: "a checksum is wrong" });
    }
    let block = match kind {
        1 => Block::Start,
        2 => Block::Calls,
        3 => Block::End,
        _ => return Err(ReplayError::Damaged { steps, what: "there is no such sort of block" }),
    };
    Ok((block, payload))
}

/// A recording in memory. Clones share its bytes, so one is given to
/// [`World::start_recording`](crate::World::start_recording) and the other read.
#[derive(Clone, Debug, Default)]
pub struct RecordingBuffer(Arc<Mutex<Vec<u8>>>);

impl RecordingBuffer {
    /// The bytes so far. The recording is complete once it was stopped.
    pub fn bytes(&self) -> Vec<u8> {
        self.0.lock().unwrap_or_else(PoisonError::into_inner).clone()
    }
}

impl Write for RecordingBuffer {
    fn write(&mut self, bytes: &[u8]) -> std::io::Result<usize> {
        self.0.lock().unwrap_or_else(PoisonError::into_inner).write(bytes)
    }
    fn flush(&mut self) -> std::io::Result<()> {
        Ok(())
    }
}
