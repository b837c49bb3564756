//! One surface of many pieces: contacts with ground that is built of several colliders.
//!
//! Kernels see a pair at a time, so each seam between two pieces of a floor is an edge to them, and the side
//! of the next tile is a wall that a body in the least overlap strikes. Here the manifolds that a shape has
//! with all pieces of bodies that cannot be pushed are judged together, real and potential ones alike, and
//! those that the surface as a whole does not have are dropped:
//!
//! 1. *Behind a face* ([`rules`]). The piece lies behind the plane of a face of another piece that holds the
//!    shape, and would push along quite another direction: the side of the next tile of a floor.
//! 2. *Covered edges.* The normal comes from an edge, and at all points another piece, or another triangle of
//!    the same mesh, goes on beyond its plane: the edge of a chunk that goes on in the next one, level or
//!    not.
//! 3. *Faces for borders* ([`level`]). Where the edge is a border of a face that is nearly across the normal,
//!    and another piece covers some of it, the points act along the normal of the face, and those that the
//!    whole face has are added: a body that lies across a seam and leans by a hair keeps its support.
//!
//! Gaps and steps up to the distance that counts as touching are none. A shape that has only one piece near
//! it costs nothing but the count of its pieces.

mod level;
mod piece;
mod rules;

use super::contacts::admit::ContactMemory;
use super::contacts::contact::NO_CONTACT;
use super::contacts::store::Contacts;
use super::input::Input;
use super::pair_state::{PackedState, pairs_that};
use crate::broad_phase::Pair;
use crate::memory::{Allowance, Category, buffers};
use crate::threads::{Shared, Workers, per_block};
use level::{Found, find_again};
use rules::judge;

/// Shapes a block.
const BLOCK: usize = per_block(32, 1);

/// Buffers of one step.
#[derive(Debug, Default)]
pub(crate) struct Seams {
    /// Of each collider the end of its part of `pairs`.
    ends: Vec<u32>,
    /// Pairs with ground, in the order of the shapes that lie on it.
    pairs: Vec<Found>,
    /// Ranges of these that belong to a shape with several pieces.
    groups: Vec<[u32; 2]>,
}

buffers! { Seams { bytes { ends, pairs, groups } } }

impl Seams {
    #[cfg(debug_assertions)]
    pub(crate) fn spoil(&mut self) {
        use crate::memory::spoil;
        let Seams { ends, pairs, groups } = self;
        spoil(ends);
        spoil(pairs);
        spoil(groups);
    }

    /// Drops the manifolds of the step that a surface of several pieces does not have. Without memory for it
    /// all stay. Returns the number of points that got no place.
    pub(crate) fn judge(
        &mut self,
        workers: &Workers<'_>,
        input: &Input<'_>,
        pairs: &mut [Pair],
        states: &[PackedState],
        contacts: &mut Contacts,
        memory: &mut ContactMemory<'_>,
    ) -> u32 {
        let group = |allowance: &mut Allowance| self.group(input, pairs, states, allowance);
        if !memory.allowances.within(Category::Scratch, group) {
            return 0;
        }
        let Seams { pairs: order, groups, .. } = self;
        let (all, view, own) = (contacts.share(), &*pairs, Shared::new(order));
        workers.run(groups.len().div_ceil(BLOCK), &|block| {
            let end = groups.len().min((block + 1) * BLOCK);
            for &[first, last] in &groups[block * BLOCK..end] {
                // SAFETY: groups don't overlap, and this is the only one that runs the block.
                unsafe { judge(input, view, own.part(first as usize..last as usize), &all) };
            }
        });
        let mut shed = 0;
        for found in order.iter() {
            let pair = &mut pairs[found.pair() as usize];
            if let Some(gone) = found.to_level() {
                shed += find_again(input, pair, gone, contacts, memory);
            }
            if pair.contact != NO_CONTACT {
                pair.contact = contacts.remove_empty(pair.contact);
            }
        }
        shed
    }

    /// Finds the shapes that are near several pieces. Returns whether there are any.
    fn group(
        &mut self,
        input: &Input<'_>,
        pairs: &[Pair],
        states: &[PackedState],
        allowance: &mut Allowance,
    ) -> bool {
        let Seams { ends, pairs: order, groups } = self;
        order.clear();
        groups.clear();
        ends.clear();
        let count = states.iter().filter(|state| state.is_of_ground()).count();
        let colliders = input.colliders.len();
        if count < 2
            || pairs.len() > Found::MOST
            || allowance.fit(ends, colliders) < colliders
            || allowance.fit(order, count) < count
            || allowance.fit(groups, count / 2) < count / 2
        {
            return false;
        }
        ends.resize(colliders, 0);
        let of_ground = || pairs_that(states, PackedState::is_of_ground);
        for index in of_ground() {
            ends[lying(input, &pairs[index as usize]) as usize] += 1;
        }
        let mut start = 0;
        for end in ends.iter_mut() {
            let own = *end;
            *end = if own > 1 { start } else { u32::MAX };
            if own > 1 {
                groups.push([start, start + own]);
                start += own;
            }
        }
        order.resize(start as usize, Found::default());
        for index in of_ground() {
            let at = &mut ends[lying(input, &pairs[index as usize]) as usize];
            if *at != u32::MAX {
                order[*at as usize] = Found::new(index);
                *at += 1;
            }
        }
        !groups.is_empty()
    }
}

/// The collider of a pair with ground that is ground.
fn ground(input: &Input<'_>, pair: &Pair) -> u32 {
    if lying(input, pair) == pair.a { pair.b } else { pair.a }
}

/// The collider of a pair with ground that can be pushed.
fn lying(input: &Input<'_>, pair: &Pair) -> u32 {
    if input.is_pushed(pair.a) { pair.a } else { pair.b }
}
