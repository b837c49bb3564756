//! The broad phase in a snapshot: boxes, the tree over them, and colliders still to be looked up.
//!
//! The order of pairs comes from the order in which walks find leaves, that is, from which node hangs on
//! which. So trees are kept as they are; the boxes of their nodes follow from those of the leaves, and the
//! table of pairs from the list.

use super::bvh::Tree;
use super::find::Change;
use super::pairs::PairTable;
use super::{Aabb, BroadPhase, NONE, Pair, Path, Proxy, Role, look_up};
use crate::error::Error;
use crate::words::{Packer, Reader, all_finite, broken, byte, record, words};
use glam::Vec3;
use std::mem::swap;

/// How long the lists of a saved broad phase are.
#[derive(Clone, Copy, Debug, Default, bytemuck::Pod, bytemuck::Zeroable)]
#[repr(C)]
pub(crate) struct Lists {
    /// Number of colliders that move or sleep, and of those with a box.
    colliders: u32,
    boxes: u32,
    paths: u32,
    unbounded: u32,
    changed: u32,
    nodes: u32,
    refreshed: u32,
}

/// A saved broad phase, in its words.
#[derive(Clone, Copy)]
pub(crate) struct SavedBroad<'a> {
    lists: Lists,
    roles: &'a [u32],
    boxes: &'a [u32],
    paths: &'a [u32],
    unbounded: &'a [u32],
    changed: &'a [u32],
    tree: &'a [u32],
}

/// The pairs, with the data of the search.
#[derive(Debug, Default)]
pub(crate) struct PairLists {
    pairs: Vec<Pair>,
    table: PairTable,
    changes: Vec<Change>,
}

/// Where the marks of a changed collider stand.
const MARKS: u32 = 30;

fn aabb(words: &[u32]) -> Aabb {
    let [min, max]: [Vec3; 2] = record::<_, 6>(words);
    Aabb { min, max }
}

fn has_box(role: Role) -> bool {
    role >= Role::Slow || role == Role::Endless
}

fn in_tree(role: Role) -> bool {
    role >= Role::Slow
}

fn role_of(byte: u8) -> Option<Role> {
    [Role::Absent, Role::New, Role::Endless, Role::Slow, Role::Fast, Role::Volume]
        .into_iter()
        .find(|&role| role as u8 == byte)
}

impl BroadPhase {
    /// Writes the state of these colliders, those of all that moves or sleeps.
    pub(crate) fn save(&self, colliders: impl Iterator<Item = u32> + Clone, out: &mut Vec<u32>) -> Lists {
        let BroadPhase {
            roles: all_roles,
            proxies,
            marks,
            changed,
            movers,
            unbounded,
            paths,
            refreshed,
            // Written with their contacts.
            pairs: _,
            // Written with the static colliders: see `save_statics`.
            statics: _,
            new_statics: _,
            // These follow from the others.
            table: _,
            away: _,
            counts: _,
            statics_changes: _,
            // A role says which are new; scratch of a search.
            new_movers: _,
            changes: _,
            blocks: _,
            block: _,
            #[cfg(test)]
                shuffle: _,
        } = self;
        let mut lists = Lists { refreshed: u32::from(*refreshed), ..Lists::default() };
        let mut roles = Packer::default();
        for c in colliders.clone() {
            lists.colliders += 1;
            roles.push(out, all_roles[c as usize] as u8);
        }
        roles.end(out);
        for c in colliders.filter(|&c| has_box(all_roles[c as usize])) {
            let Aabb { min, max } = proxies[c as usize].bounds;
            out.extend_from_slice(&words::<6>([min, max]));
            lists.boxes += 1;
        }
        // Colliders that were removed since have none any more.
        for path in paths.iter().filter(|path| all_roles[path.collider as usize] >= Role::Fast) {
            out.push(path.collider);
            lists.paths += 1;
        }
        out.extend(unbounded);
        out.extend(changed.iter().map(|&c| c | u32::from(marks[c as usize]) << MARKS));
        movers.save(out);
        lists.unbounded = unbounded.len() as u32;
        lists.changed = changed.len() as u32;
        lists.nodes = movers.node_count() as u32;
        lists
    }

    /// Takes the state of these colliders; pairs come by themselves.
    pub(crate) fn restore(&mut self, saved: &SavedBroad<'_>, colliders: impl Iterator<Item = u32> + Clone) {
        for c in self.changed.drain(..) {
            self.marks[c as usize] = 0;
        }
        let mut boxes = saved.boxes.as_chunks::<6>().0.iter();
        for (i, c) in colliders.enumerate() {
            let role = role_of(byte(saved.roles, i)).unwrap_or(Role::New);
            self.roles[c as usize] = role;
            let own = if has_box(role) { boxes.next() } else { None };
            self.proxies[c as usize] =
                own.map_or(Proxy::NONE, |own| Proxy { bounds: aabb(own), ..Proxy::NONE });
        }
        self.paths.clear();
        for (i, &c) in saved.paths.iter().enumerate() {
            self.proxies[c as usize].path = i as u32;
            self.paths.push(Path::past(c));
        }
        self.unbounded.clear();
        self.unbounded.extend(saved.unbounded);
        for &entry in saved.changed {
            let c = entry & ((1 << MARKS) - 1);
            self.marks[c as usize] = (entry >> MARKS) as u8;
            self.changed.push(c);
        }
        self.new_movers.clear();
        self.refreshed = saved.lists.refreshed != 0;
        let (bounds, place) = Proxy::boxes_and_places(&mut self.proxies);
        self.movers.restore(saved.tree, bounds, place);
    }

    /// Exchanges the lists of pairs for others.
    pub(crate) fn swap_pairs(&mut self, other: &mut PairLists) {
        swap(&mut self.pairs, &mut other.pairs);
        swap(&mut self.table, &mut other.table);
        swap(&mut self.changes, &mut other.changes);
    }

    /// The list of pairs is another; so many are kept elsewhere, and may come back.
    pub(crate) fn restore_pairs(&mut self, away: usize) {
        self.table.rebuild(&self.pairs);
        self.away = away;
    }

    /// Goes up when the tree of static colliders changes.
    pub(crate) fn statics_changes(&self) -> u64 {
        self.statics_changes
    }

    /// Writes the box of a static collider.
    pub(crate) fn save_static(&self, collider: u32, out: &mut Vec<u32>) {
        let Aabb { min, max } = self.proxies[collider as usize].bounds;
        out.extend_from_slice(&words::<6>([min, max]));
    }

    /// Writes the tree of static colliders, and those that wait for a place in it.
    pub(crate) fn save_statics(&self, out: &mut Vec<u32>) {
        out.push(self.new_statics.len() as u32);
        out.extend(&self.new_statics);
        out.push(self.statics.node_count() as u32);
        self.statics.save(out);
    }

    /// Whether a saved box has an end.
    pub(crate) fn is_bounded(words: &[u32; 6]) -> bool {
        aabb(words).is_bounded()
    }

    /// Makes room for so many colliders, none of which is there yet.
    pub(crate) fn reset(&mut self, colliders: usize) {
        self.roles.clear();
        self.roles.resize(colliders, Role::Absent);
        self.proxies.clear();
        self.proxies.resize(colliders, Proxy::NONE);
        self.marks.clear();
        self.marks.resize(colliders, 0);
        self.changed.clear();
        self.unbounded.clear();
        self.new_movers.clear();
        (self.counts.still, self.counts.moving) = (0, 0);
        self.statics_changes += 1;
    }

    /// Puts a static collider back.
    pub(crate) fn restore_static(&mut self, collider: u32, bounds: &[u32]) {
        let bounds = aabb(bounds);
        let bounded = bounds.is_bounded();
        self.counts.still += 1;
        self.roles[collider as usize] = if bounded { Role::Static } else { Role::Endless };
        let path = if bounded { NONE } else { look_up::ENDLESS_STATIC };
        self.proxies[collider as usize] = Proxy { bounds, place: NONE, path };
    }

    /// Counts a collider that may move.
    pub(crate) fn count_mover(&mut self) {
        self.counts.moving += 1;
    }

    /// Restores the tree of static colliders.
    pub(crate) fn restore_statics(&mut self, new: &[u32], tree: &[u32]) {
        self.new_statics.clear();
        self.new_statics.extend(new);
        let (bounds, place) = Proxy::boxes_and_places(&mut self.proxies);
        self.statics.restore(tree, bounds, place);
    }

    /// Puts waiting colliders into their tree, as the next update would.
    pub(crate) fn settle_statics(&mut self) {
        self.build_statics(|_, _| {});
    }

    /// The output of [`BroadPhase::save_statics`] after [`BroadPhase::settle_statics`].
    pub(crate) fn save_settled_statics(&self, out: &mut Vec<u32>) {
        let mut settled = BroadPhase {
            roles: self.roles.clone(),
            proxies: self.proxies.clone(),
            statics: self.statics.clone(),
            new_statics: self.new_statics.clone(),
            ..BroadPhase::default()
        };
        settled.settle_statics();
        settled.save_statics(out);
    }

    /// Whether words are a tree of static colliders, of which `bounded` says which there are; and those that
    /// wait for it.
    pub(crate) fn check_statics(new: &[u32], tree: &[u32], bounded: &[bool]) -> Result<(), Error> {
        let mut seen = vec![false; bounded.len()];
        let there = |c: u32| bounded.get(c as usize).copied().unwrap_or(false);
        let ok = Tree::check(tree, |c| there(c) && !std::mem::replace(&mut seen[c as usize], true));
        // Colliders in neither would never be found.
        new.iter().filter(|&&c| there(c)).for_each(|&c| seen[c as usize] = true);
        let known = new.iter().all(|&c| (c as usize) < bounded.len());
        if ok && known && seen == bounded { Ok(()) } else { Err(broken("the tree of static shapes")) }
    }
}

/// Words of a tree of so many nodes.
pub(crate) fn tree_words(nodes: u32) -> usize {
    Tree::HEAD + 4 * nodes as usize
}

impl<'a> SavedBroad<'a> {
    pub(crate) fn read(from: &mut Reader<'a>, lists: Lists) -> Result<SavedBroad<'a>, Error> {
        Ok(SavedBroad {
            lists,
            roles: from.take((lists.colliders as usize).div_ceil(4))?,
            boxes: from.table(lists.boxes, 6)?,
            paths: from.table(lists.paths, 1)?,
            unbounded: from.table(lists.unbounded, 1)?,
            changed: from.table(lists.changed, 1)?,
            tree: from.take(tree_words(lists.nodes))?,
        })
    }

    /// Whether all fits together. `colliders`: those that move or sleep, in order; `fixed`: for each collider
    /// slot, whether there is something static, and whether that is endless; `absent`: those of disabled
    /// bodies, sorted.
    pub(crate) fn check(
        &self,
        colliders: &[u32],
        fixed: &[Option<bool>],
        absent: &[u32],
    ) -> Result<(), Error> {
        let slots = fixed.len();
        if self.lists.colliders as usize != colliders.len() || self.lists.refreshed > 1 {
            return Err(broken("the number of shapes"));
        }
        let mut roles = vec![Role::Absent; slots];
        let mut boxes = self.boxes.as_chunks::<6>().0.iter();
        for (i, &c) in colliders.iter().enumerate() {
            let role = role_of(byte(self.roles, i)).ok_or_else(|| broken("the state of a shape"))?;
            if (role == Role::Absent) != absent.binary_search(&c).is_ok() {
                return Err(broken("who is there"));
            }
            roles[c as usize] = role;
            if has_box(role) {
                let own = boxes.next().ok_or_else(|| broken("a box is missing"))?;
                let Aabb { min, max } = aabb(own);
                if role != Role::Endless {
                    all_finite(own)?;
                }
                if !min.cmple(max).all() || aabb(own).is_bounded() == (role == Role::Endless) {
                    return Err(broken("a box"));
                }
            }
        }
        if boxes.next().is_some() {
            return Err(broken("there are too many boxes"));
        }
        let of = |c: u32| roles.get(c as usize).copied().unwrap_or(Role::Absent);
        // Each once, and all of them.
        let once = |list: &[u32], wanted: &dyn Fn(u32) -> bool| {
            let mut seen = vec![false; slots];
            let fits = list.iter().all(|&c| wanted(c) && !std::mem::replace(&mut seen[c as usize], true));
            fits && (0..slots as u32).filter(|&c| wanted(c)).count() == list.len()
        };
        let endless =
            |c: u32| (c as usize) < slots && (of(c) == Role::Endless || fixed[c as usize] == Some(true));
        if !once(self.paths, &|c| of(c) >= Role::Fast) || !once(self.unbounded, &endless) {
            return Err(broken("a list of shapes"));
        }
        let mut seen = vec![false; slots];
        for &entry in self.changed {
            let (c, marks) = (entry & ((1 << MARKS) - 1), entry >> MARKS);
            // Removed colliders may still be listed.
            if c as usize >= slots || marks == 0 || std::mem::replace(&mut seen[c as usize], true) {
                return Err(broken("the list of what changed"));
            }
        }
        let mut leaves = 0;
        let mut seen = vec![false; slots];
        let ok = Tree::check(self.tree, |c| {
            leaves += 1;
            in_tree(of(c)) && !std::mem::replace(&mut seen[c as usize], true)
        });
        let wanted = roles.iter().filter(|&&role| in_tree(role)).count();
        if ok && leaves == wanted { Ok(()) } else { Err(broken("the tree of boxes")) }
    }
}
