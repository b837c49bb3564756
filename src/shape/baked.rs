//! Hulls, meshes and height fields as bytes that are read without building anything.
//!
//! ```text
//! "backstop shape\n", kind (u8), version (u16), the output of `stored.rs`, CRC-32 of all before
//! ```
//!
//! Numbers of the frame are little-endian; the content is as postcard writes it, as in recordings.

use super::stored::{StoredField, StoredHull, StoredMesh};
use super::{ConvexHull, HeightField, TriangleMesh};
use crate::error::Error;
use serde::Serialize;
use serde::de::DeserializeOwned;

const MAGIC: [u8; 15] = *b"backstop shape\n";
/// Version of the format. It changes with anything that is written.
const VERSION: u16 = 1;
/// Magic, kind and version.
const HEAD: usize = MAGIC.len() + 3;

fn write(kind: u8, stored: &impl Serialize) -> Vec<u8> {
    let mut bytes = MAGIC.to_vec();
    bytes.push(kind);
    bytes.extend(VERSION.to_le_bytes());
    // Memory is all that writing to a vector could lack; bytes cut short are refused when they are read.
    let mut bytes = postcard::to_extend(stored, bytes).unwrap_or_default();
    bytes.extend(crc32fast::hash(&bytes).to_le_bytes());
    bytes
}

fn read<T: DeserializeOwned>(kind: u8, bytes: &[u8]) -> Result<T, Error> {
    let broken = |what: &'static str| Error::BrokenShape { what };
    let rest = bytes.strip_prefix(&MAGIC).ok_or(broken("it is none"))?;
    let Some((&[found_kind, low, high], rest)) = rest.split_first_chunk::<3>() else {
        return Err(broken("it is cut off"));
    };
    let found = u16::from_le_bytes([low, high]);
    if found != VERSION {
        return Err(Error::ShapeVersion { found, expected: VERSION });
    }
    let (content, sum) = rest.split_last_chunk::<4>().ok_or(broken("it is cut off"))?;
    if u32::from_le_bytes(*sum) != crc32fast::hash(&bytes[..HEAD + content.len()]) {
        return Err(broken("its checksum is wrong"));
    }
    if found_kind != kind {
        return Err(broken("it is of another kind"));
    }
    match postcard::take_from_bytes(content) {
        Ok((stored, [])) => Ok(stored),
        _ => Err(broken("its content is no list of numbers as it should be")),
    }
}

macro_rules! baked {
    ($($shape:ident $stored:ident $kind:literal),*) => { $(
        impl $shape {
            /// The built shape as bytes for a file: [`from_bytes`](Self::from_bytes) reads them without
            /// building it again. Needs the feature `bake`.
            pub fn to_bytes(&self) -> Vec<u8> {
                write($kind, &self.stored())
            }

            /// Reads the bytes of [`to_bytes`](Self::to_bytes): a world with the shape has the same bits as
            /// one with the original. Bytes may come from anywhere: every property that the engine relies on
            /// is checked. Needs the feature `bake`.
            ///
            /// # Errors
            /// [`Error::BrokenShape`] for bytes of another kind, or that are cut off or changed;
            /// [`Error::ShapeVersion`] for those of another version of the format; the errors of building
            /// one.
            pub fn from_bytes(bytes: &[u8]) -> Result<$shape, Error> {
                $shape::from_stored(read::<$stored>($kind, bytes)?)
            }
        }
    )* };
}

baked! { ConvexHull StoredHull 1, TriangleMesh StoredMesh 2, HeightField StoredField 3 }
