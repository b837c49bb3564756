//! Sort keys of contacts: where they are solved, their colour and number of points.

use super::colour::{COLOURS, OVERFLOW};
use super::order::{Group, Place};
use crate::config::{Order, RowGroup};
use crate::memory::buffers;

/// Kinds of contacts of a colour: by points, most first, so that lanes of a batch are alike; and last those
/// of bodies in trees of joints, whose lanes are those of the trees.
pub(crate) const KINDS: usize = 5;

/// Keys of rows that are solved after the same group.
const KEYS: usize = Group::ALL.len() * (COLOURS + 1) * KINDS;
/// Groups that rows may be solved after, and none.
const AFTERS: usize = 1 + Order::LEN;

/// Contacts of a group that are solved after the same other group.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Layer {
    pub(crate) place: Place,
    pub(crate) group: Group,
    solved_after: Option<RowGroup>,
}

impl Layer {
    /// The first of the keys of a colour.
    fn first(group: Group, solved_after: Option<RowGroup>, colour: usize) -> usize {
        let layer = solved_after.map_or(0, |other| 1 + other as usize) * Group::ALL.len() + group as usize;
        (layer * (COLOURS + 1) + colour) * KINDS
    }
}

/// Counts of the parts of contacts by key.
#[derive(Debug, Default)]
pub(crate) struct Keys {
    /// The count of each key; after sorting, where its range ends.
    ends: Vec<u32>,
    /// Number of colours that each group uses: a small scene has a handful of hundreds of keys.
    colours: [usize; Group::ALL.len()],
    /// In the order in which they are solved.
    layers: Vec<Layer>,
}

buffers! {
    Keys {
        each(any_solved_after: bool) {
            ends(Self::len(any_solved_after)),
            layers(Group::ALL.len() * if any_solved_after { AFTERS } else { 1 }),
        }
    }
}

impl Keys {
    /// Resets the counts. `groups`: those that some bodies are solved after.
    pub(crate) fn reset(&mut self, order: Order, groups: impl Iterator<Item = RowGroup> + Clone) {
        self.layers.clear();
        for solved_after in std::iter::once(None).chain(groups.map(Some)) {
            let layer =
                |group: Group| Layer { place: order.place(group.named(), solved_after), group, solved_after };
            self.layers.extend(Group::ALL.map(layer));
        }
        self.layers.sort_by_key(|layer| layer.place);
        self.ends.clear();
        self.ends.resize(Self::len(self.any_solved_after()), 0);
        self.colours = [0; Group::ALL.len()];
    }

    /// Whether the rows of any body are solved after another group.
    pub(crate) fn any_solved_after(&self) -> bool {
        self.layers.len() > Group::ALL.len()
    }

    /// Maximum number of stages.
    pub(crate) fn most_stages(&self) -> usize {
        self.layers.len() * (COLOURS + 1)
    }

    /// Counts a part with so many points, or a part of a body in a tree, and returns its key.
    pub(crate) fn count(
        &mut self,
        group: Group,
        solved_after: Option<RowGroup>,
        colour: usize,
        points: Option<usize>,
    ) -> u32 {
        if colour != OVERFLOW {
            let colours = &mut self.colours[group as usize];
            *colours = (*colours).max(colour + 1);
        }
        let key = Layer::first(group, solved_after, colour) + points.map_or(KINDS - 1, |points| 4 - points);
        self.ends[key] += 1;
        key as u32
    }

    /// Layers and colours in the order in which they are solved. Contacts without a colour come first in
    /// their layer: rows that are solved last have the smallest error.
    pub(crate) fn colours(&self) -> impl Iterator<Item = (Layer, usize)> + '_ {
        self.layers.iter().flat_map(|&layer| {
            let colours = self.colours[layer.group as usize];
            std::iter::once(OVERFLOW).chain(0..colours).map(move |colour| (layer, colour))
        })
    }

    /// Where the kinds of a colour end.
    pub(crate) fn ends(&self, layer: Layer, colour: usize) -> &[u32] {
        &self.ends[Layer::first(layer.group, layer.solved_after, colour)..][..KINDS]
    }

    /// Turns counts into ranges, in the order in which they are solved: afterwards [`Keys::place_of`] returns
    /// the place of each part.
    pub(crate) fn line_up(&mut self) {
        let mut end = 0;
        for &Layer { group, solved_after, .. } in &self.layers {
            for colour in std::iter::once(OVERFLOW).chain(0..self.colours[group as usize]) {
                for place in &mut self.ends[Layer::first(group, solved_after, colour)..][..KINDS] {
                    end += std::mem::replace(place, end);
                }
            }
        }
    }

    /// The place of the next part of a key.
    pub(crate) fn place_of(&mut self, key: u32) -> usize {
        let place = &mut self.ends[key as usize];
        *place += 1;
        *place as usize - 1
    }

    fn len(any_solved_after: bool) -> usize {
        if any_solved_after { KEYS * AFTERS } else { KEYS }
    }

    /// Reserved bytes beyond those that are needed if no rows are solved after another group.
    pub(crate) fn solved_after_bytes(&self) -> usize {
        if !self.any_solved_after() {
            return 0;
        }
        let plain = KEYS * size_of::<u32>() + Group::ALL.len() * size_of::<Layer>();
        self.bytes().1 - plain
    }
}
