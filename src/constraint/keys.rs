//! Sort keys of contacts: where they are solved, their colour and number of points.

use super::colour::{COLOURS, OVERFLOW};
use super::order::{Group, Place};
use crate::config::{Order, RowGroup};
use crate::memory::{Buffer, bytes_of};

/// Kinds of contacts of a colour: four points before one, so that lanes of a batch are alike, and last those of bodies in
/// trees of joints, which have their lanes by the tree.
pub(super) const KINDS: usize = 5;

/// Keys of what is raised above the same.
const KEYS: usize = Group::ALL.len() * (COLOURS + 1) * KINDS;
/// What contacts may be raised above: nothing, or a group.
const RAISES: usize = 1 + Order::LEN;

/// Contacts of a group that are raised above the same.
#[derive(Clone, Copy, Debug)]
pub(super) struct Layer {
    pub(super) place: Place,
    pub(super) group: Group,
    raised: Option<RowGroup>,
}

impl Layer {
    /// The first of the keys of a colour.
    fn first(group: Group, raised: Option<RowGroup>, colour: usize) -> usize {
        let layer = raised.map_or(0, |above| 1 + above as usize) * Group::ALL.len() + group as usize;
        (layer * (COLOURS + 1) + colour) * KINDS
    }
}

/// What parts of contacts there are of each key.
#[derive(Debug, Default)]
pub(super) struct Keys {
    /// How many; once they are sorted, where they end.
    ends: Vec<u32>,
    /// How many colours each group uses: of hundreds of keys a small scene has a handful.
    colours: [usize; Group::ALL.len()],
    /// In the order in which they are solved.
    layers: Vec<Layer>,
}

impl Keys {
    /// Nothing is counted yet. `raises`: the groups that bodies are raised above.
    pub(super) fn reset(&mut self, order: Order, raises: impl Iterator<Item = RowGroup> + Clone) {
        self.layers.clear();
        for raised in std::iter::once(None).chain(raises.map(Some)) {
            let layer = |group: Group| Layer { place: order.place(group.named(), raised), group, raised };
            self.layers.extend(Group::ALL.map(layer));
        }
        self.layers.sort_by_key(|layer| layer.place);
        self.ends.clear();
        self.ends.resize(Self::len(self.any_raised()), 0);
        self.colours = [0; Group::ALL.len()];
    }

    /// Whether any body is raised.
    pub(super) fn any_raised(&self) -> bool {
        self.layers.len() > Group::ALL.len()
    }

    /// The most stages that there may be.
    pub(super) fn most_stages(&self) -> usize {
        self.layers.len() * (COLOURS + 1)
    }

    /// Counts one part of so many points, or one with a seat, and says its key.
    pub(super) fn count(
        &mut self,
        (group, raised): (Group, Option<RowGroup>),
        colour: usize,
        points: Option<usize>,
    ) -> u32 {
        if colour != OVERFLOW {
            let colours = &mut self.colours[group as usize];
            *colours = (*colours).max(colour + 1);
        }
        let key = Layer::first(group, raised, colour) + points.map_or(KINDS - 1, |points| 4 - points);
        self.ends[key] += 1;
        key as u32
    }

    /// Layers and colours in the order in which they are solved. Contacts without a colour come first in their layer: what
    /// is solved later wins.
    pub(super) fn colours(&self) -> impl Iterator<Item = (Layer, usize)> + '_ {
        self.layers.iter().flat_map(|&layer| {
            let colours = self.colours[layer.group as usize];
            std::iter::once(OVERFLOW).chain(0..colours).map(move |colour| (layer, colour))
        })
    }

    /// Where the kinds of a colour end.
    pub(super) fn ends(&self, layer: Layer, colour: usize) -> &[u32] {
        &self.ends[Layer::first(layer.group, layer.raised, colour)..][..KINDS]
    }

    /// Puts what was counted in the order in which it is solved: from here on [`Keys::place_of`] says where each goes.
    pub(super) fn line_up(&mut self) {
        let mut end = 0;
        for &Layer { group, raised, .. } in &self.layers {
            for colour in std::iter::once(OVERFLOW).chain(0..self.colours[group as usize]) {
                for place in &mut self.ends[Layer::first(group, raised, colour)..][..KINDS] {
                    end += std::mem::replace(place, end);
                }
            }
        }
    }

    /// The place of the next part of a key.
    pub(super) fn place_of(&mut self, key: u32) -> usize {
        let place = &mut self.ends[key as usize];
        *place += 1;
        *place as usize - 1
    }

    fn len(any_raised: bool) -> usize {
        if any_raised { KEYS * RAISES } else { KEYS }
    }

    /// Calls `f` with each buffer and the place that it needs.
    pub(super) fn each(&mut self, any_raised: bool, f: &mut dyn FnMut(&mut dyn Buffer, usize)) {
        f(&mut self.ends, Self::len(any_raised));
        f(&mut self.layers, Group::ALL.len() * if any_raised { RAISES } else { 1 });
    }

    /// Reserved bytes beyond those that it takes where nothing is raised.
    pub(super) fn raised_bytes(&self) -> usize {
        if !self.any_raised() {
            return 0;
        }
        let plain = KEYS * size_of::<u32>() + Group::ALL.len() * size_of::<Layer>();
        self.bytes().1 - plain
    }

    pub(super) fn bytes(&self) -> (usize, usize) {
        let (a, b) = (bytes_of(&self.ends), bytes_of(&self.layers));
        (a.0 + b.0, a.1 + b.1)
    }
}
