//! The triangles near a pair of shapes, gathered once for all that a step needs them for.
//!
//! For a body that slides along a mesh, a step finds the contacts where it is, then casts it along its path,
//! and where it hits something does both again: mostly among the same few triangles. Walking the tree and
//! gathering corners costs more than most of these tests.

use crate::memory::{Allowance, Buffer, bytes_of};
use crate::shape::{Corners, Ground};
use glam::Vec3;

/// The low and the high corner of a box in the mesh's frame.
pub(crate) type Extent = (Vec3, Vec3);

/// Up to eight triangles as they lie in memory, in the mesh's frame.
#[derive(Clone, Debug, Default)]
pub(crate) struct Eight {
    pub(crate) corners: Corners,
    pub(crate) index: [u32; 8],
    count: usize,
}

impl Eight {
    /// Adds a triangle; the caller ensures that there is space.
    #[inline(always)]
    pub(crate) fn push(&mut self, index: u32, corners: [Vec3; 3]) {
        let lane = self.count % 8;
        for (k, corner) in corners.into_iter().enumerate() {
            self.corners.put(lane, k, corner);
        }
        self.index[lane] = index;
        self.count = lane + 1;
    }
    pub(crate) fn clear(&mut self) {
        self.count = 0;
    }
    pub(crate) fn count(&self) -> usize {
        self.count
    }
    pub(crate) fn is_full(&self) -> bool {
        self.count == 8
    }
    /// One bit for each triangle.
    pub(crate) fn lanes(&self) -> u32 {
        (1u32 << self.count) - 1
    }
}

/// How many groups of eight triangles are kept. If there are more, each request walks the tree.
pub(crate) const CHUNK: usize = 16;

/// See the module.
#[derive(Debug, Default)]
pub(crate) struct Nearby {
    eights: Vec<Eight>,
    used: usize,
    /// The box whose triangles are all kept.
    held: Option<Extent>,
    /// The box that later requests will lie in.
    expected: Option<Extent>,
}

/// The triangles of a request, or a part of them.
pub(crate) struct Gathered<'a> {
    eights: &'a [Eight],
    /// Set if some of the triangles do not meet this box, which was requested.
    within: Option<Extent>,
}

impl Nearby {
    pub(crate) fn buffer(&mut self) -> &mut dyn Buffer {
        &mut self.eights
    }

    pub(crate) fn bytes(&self) -> (usize, usize) {
        bytes_of(&self.eights)
    }

    /// Forgets all, for another pair.
    pub(crate) fn forget(&mut self) {
        (self.held, self.expected) = (None, None);
    }

    /// Announces the box that later requests will lie in, if it is known.
    pub(crate) fn expect(&mut self, extent: Option<Extent>) {
        self.expected = extent;
    }

    /// Whether there is memory for the triangles.
    pub(crate) fn has_place(&mut self, allowance: &mut Allowance) -> bool {
        if allowance.fit(&mut self.eights, CHUNK) < CHUNK {
            return false;
        }
        self.eights.resize(CHUNK, Eight::default());
        true
    }

    /// Calls `look` with the triangles that meet a box, at once or, if they are many, in several calls. There
    /// has to be [memory](Self::has_place).
    pub(crate) fn gather(&mut self, ground: &Ground, wanted: Extent, look: &mut dyn FnMut(Gathered<'_>)) {
        let inside = |(min, max): Extent| min.cmple(wanted.0).all() && max.cmpge(wanted.1).all();
        if let Some(held) = self.held.filter(|held| inside(*held)) {
            let within = (held != wanted).then_some(wanted);
            look(Gathered { eights: &self.eights[..self.used], within });
            return;
        }
        let all = self.expected.map_or(wanted, |(min, max)| (min.min(wanted.0), max.max(wanted.1)));
        let within = (all != wanted).then_some(wanted);
        let Nearby { eights, used, .. } = self;
        *used = 0;
        let mut complete = true;
        ground.visit_box(all.0, all.1, &mut |index, corners| {
            if *used == 0 || eights[*used - 1].is_full() {
                if *used == eights.len() {
                    look(Gathered { eights, within });
                    (*used, complete) = (0, false);
                }
                eights[*used].clear();
                *used += 1;
            }
            if let Some(eight) = eights.get_mut(*used - 1) {
                eight.push(index, corners);
            }
        });
        look(Gathered { eights: &eights[..*used], within });
        self.held = complete.then_some(all);
    }
}

impl Gathered<'_> {
    /// Groups of eight, with one bit for each triangle that was requested.
    pub(crate) fn each(&self) -> impl Iterator<Item = (&Eight, u32)> {
        self.eights.iter().filter_map(|eight| {
            let lanes =
                self.within.map_or(u32::MAX, |(min, max)| eight.corners.meeting(min, max)) & eight.lanes();
            (lanes != 0).then_some((eight, lanes))
        })
    }
}
