//! Snapshots as bytes, for a file or the network: little-endian, with a version and a checksum.

use super::Snapshot;
use super::checksum::hash;
use super::geometry::Known;
use super::part::Part;
use super::view::{HEAD, Head, MAGIC, VERSION};
use crate::error::Error;
use crate::words::{Reader, broken, words};
use std::sync::Arc;

fn halves(long: u64) -> [u32; 2] {
    words(long)
}

fn whole(halves: [u32; 2]) -> u64 {
    u64::from(halves[0]) | u64::from(halves[1]) << 32
}

impl Snapshot {
    /// The state as bytes: for a world that has the same bodies, shapes and joints, made by the same calls in
    /// the same order.
    pub fn to_bytes(&self) -> Vec<u8> {
        self.write(false)
    }

    /// The state and the content that snapshots share, as bytes: for any world that has the same hulls,
    /// meshes and height fields on some of its shapes. All other bodies, shapes and joints of that world go
    /// when it is restored.
    ///
    /// A snapshot that came from [`Snapshot::to_bytes`] has its state only.
    pub fn to_whole_bytes(&self) -> Vec<u8> {
        self.write(self.parts.iter().all(Option::is_some))
    }

    fn write(&self, with_parts: bool) -> Vec<u8> {
        let mut all = self.words.clone();
        let prints = match (&self.parts, self.foreign) {
            (_, Some(prints)) => prints,
            ([Some(fixed), Some(moving)], _) => [fixed.prints(), moving.prints()],
            _ => [[0; 2]; 2],
        };
        if !all.is_empty() {
            all.push(self.forms.len() as u32);
        }
        self.forms.iter().for_each(|known| all.extend(halves(known.print())));
        if with_parts {
            for part in self.parts.iter().flatten() {
                all.extend([part.words.len() as u32, part.geometry.len() as u32]);
                part.geometry.iter().for_each(|known| all.extend(halves(known.print())));
                all.extend(&part.words);
            }
        }
        if let Some(own) = all.get_mut(..HEAD) {
            let head = Head {
                magic: MAGIC,
                version: VERSION,
                words: self.words.len() as u32,
                whole: u32::from(with_parts),
                prints: prints.map(|part| part.map(halves)),
                checksum: [0; 2],
            };
            own.copy_from_slice(&words::<HEAD>(head));
        }
        let checksum = halves(hash(&all));
        if let Some(place) = all.get_mut(HEAD - 2..HEAD) {
            place.copy_from_slice(&checksum);
        }
        all.iter().flat_map(|word| word.to_le_bytes()).collect()
    }

    /// A snapshot from bytes of [`Snapshot::to_bytes`] or [`Snapshot::to_whole_bytes`]. Whether it fits a
    /// world is checked by [`World::restore`](crate::World::restore), which checks every number of it.
    ///
    /// # Errors
    /// If the bytes are cut off, were changed, or are of another version.
    pub fn from_bytes(bytes: &[u8]) -> Result<Snapshot, Error> {
        let (fours, rest) = bytes.as_chunks::<4>();
        let mut all: Vec<u32> = fours.iter().map(|&four| u32::from_le_bytes(four)).collect();
        let mut head: Head = Reader(&all).record::<_, HEAD>()?;
        if head.magic != MAGIC {
            return Err(broken("it does not begin as one"));
        }
        if head.version != VERSION {
            return Err(Error::SnapshotVersion { found: head.version, expected: VERSION });
        }
        let checksum = std::mem::take(&mut head.checksum);
        all[..HEAD].copy_from_slice(&words::<HEAD>(head));
        if !rest.is_empty() || whole(checksum) != hash(&all) {
            return Err(broken("its checksum is wrong"));
        }
        let mut from = Reader(&all);
        let state = from.take(head.words as usize)?.to_vec();
        let count = from.one()?;
        let forms = read_prints(&mut from, count)?;
        let parts = if head.whole == 0 {
            [None, None]
        } else {
            [Some(read_part(&mut from)?), Some(read_part(&mut from)?)]
        };
        if !from.0.is_empty() {
            return Err(broken("there is more than its counts say"));
        }
        let prints = head.prints.map(|part| part.map(whole));
        let foreign = Some(prints);
        Ok(Snapshot { words: state, parts, forms, foreign, ..Snapshot::default() })
    }
}

fn read_part(from: &mut Reader<'_>) -> Result<Arc<Part>, Error> {
    let [count, geometry]: [u32; 2] = from.record::<_, 2>()?;
    let known = read_prints(from, geometry)?;
    Ok(Arc::new(Part::new(from.table(count, 1)?.to_vec(), known)))
}

fn read_prints(from: &mut Reader<'_>, count: u32) -> Result<Vec<Known>, Error> {
    let prints = from.table(count, 2)?.as_chunks::<2>().0;
    Ok(prints.iter().map(|&print| Known::Print(whole(print))).collect())
}
